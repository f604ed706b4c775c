"""Observability of a canonical form at an instant."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from percept_obs.compile import written_out
from percept_obs.system.forms import CanonicalForm, PartitionedSystem
from percept_obs.validation import checked, expression


@checked
@dataclass(frozen=True)
class InstantaneousObservability:
    """Information about the hidden coordinates of a canonical form at an instant, from w(x1) alone."""

    form: CanonicalForm

    @cached_property
    def information(self) -> sp.ImmutableMatrix:
        """The matrix w w^T, of shape (n2, n2)."""
        return self.form.w * self.form.w.T

    @cached_property
    def rank(self) -> int:
        """Largest rank that the information can have; below n2 no instant suffices."""
        return int(self.form.w.rank())

    @property
    def suffices(self) -> bool:
        """True if an instant can suffice at all."""
        return self.rank == len(self.form.x2)

    @cached_property
    def determinant(self) -> sp.Expr:
        """Determinant of the information, zero where an instant does not suffice."""
        return sp.factor(self.information.det()) if self.suffices else sp.S.Zero

    @cached_property
    def factors(self) -> sp.ImmutableMatrix:
        """Entries of w, factored: an instant shows nothing where all of them are zero."""
        return self.form.w.applyfunc(sp.factor)

    @cached_property
    def condition(self) -> sp.Expr:
        """Expression that is not zero where an instant suffices, and zero everywhere if it never does.

        With one hidden coordinate it is the sum of the squares of `factors`, else the determinant.
        """
        if len(self.form.x2) == 1:
            return sp.Add(*(entry**2 for entry in self.factors))
        return self.determinant

    @cached_property
    def eigenvalues(self) -> tuple[sp.Expr, ...]:
        """Eigenvalues of the information for one output or one hidden coordinate, zeros and |w|^2; else a ValueError.

        Ma 2005, (20), p. 67, prints the last and larger one as the condition for y1 alone; its (18) asks for the
        smallest one, which is 0 everywhere.
        """
        if 1 not in self.form.w.shape:
            raise ValueError(
                f"{len(self.form.x1)} outputs and {len(self.form.x2)} hidden coordinates have eigenvalues of no short "
                "form; look at the determinant"
            )
        return (*[sp.S.Zero] * (len(self.form.x2) - 1), sp.Add(*(entry**2 for entry in self.factors)))

    @cached_property
    def zero_set(self) -> list[dict[sp.Symbol, sp.Expr]]:
        """Measured outputs where all of w vanishes, as solutions; none if there is no such place."""
        return sp.solve([written_out(entry) for entry in self.form.w], self.form.x1, dict=True)

    @cached_property
    def growth(self) -> sp.Expr | None:
        """Factor c if |w|^2 = c |x1 - centre|^2, so that w is small in a circle; None otherwise."""
        x1 = self.form.x1
        if len(x1) < 2 or not all(entry.is_polynomial(*x1) for entry in self.form.w):
            return None
        # |w|^2 is a circle's quadratic if its Hessian is a multiple of the identity and w has one zero
        curvature = sp.hessian(sum(entry**2 for entry in self.form.w), x1) / 2
        growth = sp.factor(curvature[0, 0])
        if (curvature - growth * sp.eye(len(x1))).expand() != sp.zeros(len(x1)):
            return None  # tested before the zero set, which may take sympy minutes to find
        one_centre = len(self.zero_set) == 1 and set(self.zero_set[0]) == set(x1)
        return growth if one_centre else None

    def circle(self, threshold: sp.Expr | float) -> tuple[tuple[sp.Expr, ...], sp.Expr]:
        """Centre and radius of the region where |w| is below a threshold; a ValueError if it is no circle, or negative.

        With both image coordinates the centre is the focus of expansion (Ma 2005, p. 66).
        """
        if self.growth is None:
            raise ValueError(
                f"measuring {', '.join(self.form.measured)}, the region where w is small is no circle; "
                "look at the zero set and the window instead"
            )
        below = expression(threshold, "the threshold")
        if below.is_negative:
            raise ValueError(f"the threshold is {below}; |w| is never below a negative number: give one from 0 on")
        centre = tuple(sp.cancel(self.zero_set[0][x]) for x in self.form.x1)
        return centre, sp.Abs(below) / sp.sqrt(self.growth)

    def _repr_latex_(self) -> str:
        verdict = r"\text{an instant can suffice}"
        if not self.suffices:
            verdict = rf"\text{{rank }} {self.rank} < {len(self.form.x2)}\text{{: no instant suffices}}"
        vanishes = rf"\text{{nothing is seen where }} w = {sp.latex(self.factors)} = 0"
        return rf"$\displaystyle w w^T = {sp.latex(self.information)},\quad {verdict};\quad {vanishes}$"


@checked
def instantaneous(form: PartitionedSystem) -> InstantaneousObservability:
    """Observability at an instant, from w w^T (Ma 2005, (17)-(20), p. 67).

    Ma's test requires the smallest eigenvalue of w w^T to be positive.  With one output and two hidden coordinates its
    rank is 1, so that the smallest eigenvalue is 0 everywhere.

    Parameters
    ----------
    form : PartitionedSystem
        With symbols or numbers for its motion.

    Returns
    -------
    InstantaneousObservability
        With w w^T, its rank, and where it vanishes.

    Raises
    ------
    NotAffine
        If there is no canonical form, and so no w.
    WrongKind
        If the form is of another kind.

    See Also
    --------
    windowed : Over a window of a recording.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, instantaneous, pinhole
    >>> found = instantaneous(PerspectiveSystem(affine(), pinhole()).measure("y1", "y2"))
    >>> found.information
    Matrix([[(b1 - b3*y1)**2 + (b2 - b3*y2)**2]])
    >>> found.zero_set
    [{y1: b1/b3, y2: b2/b3}]
    """
    return InstantaneousObservability(form.canonical_form())
