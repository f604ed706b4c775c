"""Systems with a measured and a hidden part, and their canonical form, in which the hidden part is linear."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial, reduce
from itertools import product
from typing import Any

import sympy as sp

from percept_obs.compile import Intermediate
from percept_obs.system.derivation import Derivation, equals, rates, where
from percept_obs.system.motion import Motion
from percept_obs.system.view import View
from percept_obs.validation import checked, set_fields, travels


@travels
@checked
class NotAffine(ValueError):
    """The measured outputs' rate is not affine in the hidden coordinates.

    Parameters
    ----------
    measured : sequence of str
        Names of the measured outputs; an attribute, as a tuple.
    culprits : sequence of str
        Names of the hidden coordinates that do not enter linearly; an attribute, as a tuple.

    See Also
    --------
    CanonicalForm : What is missing then.

    Examples
    --------
    >>> from percept_obs import NotAffine, PerspectiveSystem, affine, ibo, unified
    >>> try:
    ...     ibo(PerspectiveSystem(affine(), unified(1.0)).partition("y1"))
    ... except NotAffine as error:
    ...     error.culprits
    ('y2', 'y3')
    """

    def __init__(self, measured: Sequence[str], culprits: Sequence[str]) -> None:
        self.measured, self.culprits = tuple(measured), tuple(culprits)
        super().__init__(
            f"measuring {', '.join(measured)} gives no canonical form: its rate is not affine in "
            f"{', '.join(culprits)}; measure {' or '.join(culprits[:-1]) or culprits[0]} as well, or use the extended "
            f"Kalman filter: extended_kalman(system.partition({', '.join(map(repr, measured))}))"
        )


@travels
class NeedsMoreOutputs(ValueError):
    """The measured outputs' rates do not determine the hidden coordinates."""

    def __init__(self, form: CanonicalForm) -> None:
        super().__init__(
            f"{', '.join(form.hidden)} are hidden; measure every image coordinate, for the rates of "
            f"{', '.join(form.measured)} do not determine them at an instant"
        )


@checked
@dataclass(frozen=True)
class PartitionedSystem:
    """System with measured and hidden coordinates: (x1, x2)' = f(x1, x2).

    Parameters
    ----------
    x1, x2 : tuples of n1 and n2 symbols
        Measured and hidden coordinates.
    rate : matrix of shape (n1 + n2, 1)
        Time derivative of (x1, x2).
    parameters : tuple of symbols
        Symbols of the known motion and of the view.
    coordinates : tuple of symbols
        All coordinates in the order of the view.
    view : View, optional
        View that the outputs belong to.
    motion : Motion, optional
        Motion X' = A X + b of the point behind it, for observers that need more than the rate; not compared.

    Raises
    ------
    ValueError
        If a coordinate stands twice, or the rate has another number of entries.
    NotAffine
        By `canonical_form`, if there is none.

    See Also
    --------
    CanonicalForm : Where the rate is affine in what is hidden.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, plane
    >>> system = PerspectiveSystem(affine(), plane()).partition("y1")
    >>> system.measured, system.hidden
    (('y1',), ('y2', 'y3'))
    """

    x1: tuple[sp.Symbol, ...]
    x2: tuple[sp.Symbol, ...]
    rate: sp.ImmutableMatrix
    parameters: tuple[sp.Symbol, ...]
    coordinates: tuple[sp.Symbol, ...]
    view: View | None = None
    motion: Motion | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        if sorted((*self.x1, *self.x2), key=str) != sorted(self.coordinates, key=str):
            raise ValueError(f"x1 is {self.x1}, x2 {self.x2}; each of {self.coordinates} is in one of them, once")
        n1, n2 = len(self.x1), len(self.x2)
        for name, shape in {"w": (n2, n1), "phi": (n1, 1), "g": (n2, 1), "rate": (n1 + n2, 1)}.items():
            found = getattr(vars(self).get(name), "shape", shape)  # a form's rate is made later, of the others
            if found != shape:
                raise ValueError(f"{name} has the shape {found}; expected {shape}: {n1} measured, {n2} hidden")

    @property
    def values(self) -> dict[sp.Symbol, float]:
        """Numbers of the view's symbols."""
        return dict(self.view.values) if self.view else {}

    @cached_property
    def measured(self) -> tuple[str, ...]:
        """Names of the measured coordinates."""
        return tuple(symbol.name for symbol in self.x1)

    @cached_property
    def hidden(self) -> tuple[str, ...]:
        """Names of the hidden coordinates."""
        return tuple(symbol.name for symbol in self.x2)

    def canonical_form(self) -> CanonicalForm:
        """Canonical form of the system, which most observers need; raises NotAffine if there is none."""
        if self.culprits:
            raise NotAffine(self.measured, self.culprits)
        n1, w = len(self.x1), self._weight
        away = dict.fromkeys(self.x2, sp.S.Zero)
        # a rate that is affine, but not written so, keeps hidden coordinates in w, where their value does not matter
        w = w if not w.free_symbols & set(self.x2) else w.subs(away)
        phi, g = _expanded(self.rate[:n1, :]).subs(away), self.rate[n1:, :]
        own = (self.x1, self.x2, self.parameters, self.coordinates, self.view, self.motion)
        return CanonicalForm(*own, w=w, phi=phi, g=g)

    @cached_property
    def culprits(self) -> tuple[str, ...]:
        """Names of the hidden coordinates that are not linear in the measured rate; none if a form exists."""
        return _culprits(self._weight, self.x2)

    @cached_property
    def _weight(self) -> sp.ImmutableMatrix:
        """Factors of the hidden coordinates in the measured rate, shape (n2, n1)."""
        return _expanded(_expanded(self.rate[: len(self.x1), :]).jacobian(self.x2).T)

    def _repr_latex_(self) -> str:
        n1 = len(self.x1)
        return self._displayed(sp.latex(self.rate[:n1, :]), sp.latex(self.rate[n1:, :]))

    def _displayed(self, *rates: str) -> str:
        """Show the rates of the measured and of the hidden part in LaTeX, one below the other."""
        parts = zip((self.x1, self.x2), rates, strict=True)
        lines = [rf"\frac{{d}}{{dt}} {sp.latex(sp.Matrix(part))} &= {rate}" for part, rate in parts]
        lines += [formula.replace("=", "&=", 1) for formula in where(self.rate)]
        return r"$\displaystyle \begin{aligned} " + r" \\ ".join(lines) + r" \end{aligned}$"


def _called(name: str, matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Return a copy of a matrix that carries its name, w, phi or g, so that `check` refuses a line for another one."""
    matrix = sp.ImmutableMatrix(matrix)
    vars(matrix)["called"] = name
    return matrix


@checked
@dataclass(frozen=True)
class CanonicalForm(PartitionedSystem):
    """Canonical form x1' = w^T x2 + phi, x2' = g, with x1 measured and x2 hidden (Ma 2005, (10), p. 65).

    Parameters
    ----------
    x1, x2, parameters, coordinates, view, motion : as in PartitionedSystem
        Its rate follows from w, phi and g.
    w : matrix of shape (n2, n1)
        Factors of the hidden coordinates in the measured ones' rate.
    phi : matrix of shape (n1, 1)
        Rest of that rate.
    g : matrix of shape (n2, 1)
        Rate of the hidden coordinates.

    Raises
    ------
    NeedsMoreOutputs
        By `cramer`, if w^T x2 never determines x2.

    See Also
    --------
    PartitionedSystem : Needs no such structure.
    NotAffine : Raised where there is none.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, linear, pinhole, rigid
    >>> form = PerspectiveSystem(rigid(), pinhole()).measure("y1")
    >>> form.x1, form.x2
    ((y1,), (y2, y3))
    >>> form.w.T
    Matrix([[w_c1*y1 + w_c3, -v_c1 + v_c3*y1 + v_p1 - v_p3*y1]])
    """

    rate: sp.ImmutableMatrix = field(init=False)
    w: sp.ImmutableMatrix = field(kw_only=True)
    phi: sp.ImmutableMatrix = field(kw_only=True)
    g: sp.ImmutableMatrix = field(kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        rate = sp.ImmutableMatrix([*(self.w.T * sp.ImmutableMatrix(self.x2) + self.phi), *self.g])
        set_fields(self, rate=rate, **{part: _called(part, getattr(self, part)) for part in ("w", "phi", "g")})

    def canonical_form(self) -> CanonicalForm:
        """Return the form itself."""
        return self

    @property
    def culprits(self) -> tuple[str, ...]:
        """No names, since the form exists."""
        return ()

    @cached_property
    def determines_hidden(self) -> bool:
        """True if w^T x2 determines x2: there are enough outputs, and D of `cramer` is not zero everywhere."""
        return len(self.x2) <= len(self.x1) and not self._cramer[1].expand().is_zero

    @property
    def cramer(self) -> tuple[sp.ImmutableMatrix, sp.Expr]:
        """Return Cramer's rule for w^T x2: a matrix N and a determinant D such that x2 = N (w^T x2) / D.

        With as many outputs as hidden coordinates N / D is the inverse of w^T, with more (w w^T)^-1 w, the solution
        in the least-squares sense.

        Raises
        ------
        NeedsMoreOutputs
            If w^T x2 never determines x2: there are fewer outputs than hidden coordinates, or D is zero everywhere.
        """
        if not self.determines_hidden:
            raise NeedsMoreOutputs(self)
        return self._cramer

    @cached_property
    def _cramer(self) -> tuple[sp.ImmutableMatrix, sp.Expr]:
        # on curved surfaces w has denominators; multiplied by these, neither N nor D has a division
        divisor = reduce(sp.lcm, (sp.denom(sp.together(entry)) for entry in self.w), sp.S.One)
        w = self.w if divisor == 1 else (divisor * self.w).applyfunc(sp.cancel)
        square = w.T if w.is_square else w * w.T
        # not expanded, for small differences would be lost in the sum of large terms
        determinant, adjugate = square.det(method="laplace"), square.adjugate(method="laplace")
        return divisor * (adjugate if w.is_square else adjugate * w), determinant

    def derivation(self) -> Derivation:
        """Formulas of the form, one after the other."""
        x1, x2 = sp.Matrix(self.x1), sp.Matrix(self.x2)
        hidden, measured = ([s.name for s in part] for part in (self.x2, self.x1))
        shares = [f"what multiplies {h} in {m}'" for m in measured for h in hidden]
        formulas: dict[str, str | tuple[Any, ...]] = {
            "Measured and hidden:": rf"x_1 = {sp.latex(x1)},\quad x_2 = {sp.latex(x2)}",
            "What multiplies the hidden coordinates in the measured ones' rate:": (
                equals(r"w^T = \frac{\partial \dot x_1}{\partial x_2}", self.w.T),
                dict(zip(shares, self.w.T, strict=True)),
                partial(self._rate_with, "w"),
            ),
            "What is left of it without them:": (
                equals(r"\phi", self.phi),
                {f"what is left of {s}'": entry for s, entry in zip(measured, self.phi, strict=True)},
                partial(self._rate_with, "phi"),
            ),
            "How the hidden coordinates change:": (
                equals(r"g", self.g),
                rates(self.x2, self.g),
                partial(self._rate_with, "g"),
            ),
        }
        return Derivation.of(formulas)

    def _rate_with(self, part: str, entries: Sequence[sp.Expr]) -> sp.ImmutableMatrix:
        column = sp.ImmutableMatrix(entries)
        return replace(self, **{part: column.reshape(*self.w.T.shape).T if part == "w" else column}).rate

    def _repr_latex_(self) -> str:
        moved = rf"{sp.latex(self.w.T)} {sp.latex(sp.Matrix(self.x2))} + {sp.latex(self.phi)}"
        return self._displayed(moved, sp.latex(self.g))


def partition(
    coordinates: tuple[sp.Symbol, ...],
    rate: sp.ImmutableMatrix,
    measured: Sequence[str],
    parameters: tuple[sp.Symbol, ...],
    view: View | None = None,
    motion: Motion | None = None,
) -> PartitionedSystem:
    """Divide a system by the names of its measured coordinates; `rate` is in the order of `coordinates`."""
    rates = dict(zip(coordinates, rate, strict=True))
    by_name = {symbol.name: symbol for symbol in coordinates}
    x1 = tuple(by_name[name] for name in measured)
    x2 = tuple(symbol for symbol in coordinates if symbol not in x1)
    ordered = sp.ImmutableMatrix([rates[symbol] for symbol in (*x1, *x2)])
    return PartitionedSystem(x1, x2, ordered, parameters, coordinates, view, motion)


def _expanded(matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Expand a matrix, unless named intermediate results would make that long."""
    return matrix if matrix.has(Intermediate) else matrix.expand()


def _culprits(w: sp.ImmutableMatrix, x2: tuple[sp.Symbol, ...]) -> tuple[str, ...]:
    """Names of the hidden coordinates with a second derivative of the measured rate that is not zero."""
    draw = random.Random(0)  # an expression is zero if it vanishes at random points; simplifying would take long
    points = [{s: sp.Float(draw.uniform(0.1, 0.9), 30) for s in sorted(w.free_symbols, key=str)} for _ in range(3)]
    nonlinear: set[sp.Symbol] = set()
    for (row, hidden), other in product(enumerate(x2), x2):
        for entry in w.row(row):
            second = entry.diff(other)
            if any(abs(sp.N(second.xreplace(point), 30)) > 1e-20 for point in points):
                nonlinear |= {hidden, other}
    return tuple(symbol.name for symbol in x2 if symbol in nonlinear)
