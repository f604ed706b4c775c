"""The Luenberger-type observer of many points, whose error obeys linear equations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.observers.base import About
from percept_obs.observers.parts import hats
from percept_obs.points.form import PointsForm
from percept_obs.points.lyapunov_matrix import LyapunovMatrix, constant, scheduled
from percept_obs.validation import checked

ABOUT = About(
    "Luenberger-type observer",
    "Inaba et al. 2005",
    "both image coordinates of at least one point, and the whole known motion A(t), v(t)",
    "global and exponential, if (14) holds, A is Lyapunov stable and A^T P + P A + P' <= 0",
)


@checked
@dataclass(frozen=True, eq=False)
class LuenbergerObserver:
    """An observer of a form with many points.

    Parameters
    ----------
    form : PointsForm
        System that it believes in.
    P : LyapunovMatrix

    See Also
    --------
    luenberger : Makes it.

    Examples
    --------
    >>> from percept_obs import luenberger
    >>> from percept_obs.points.scenarios import moving_body
    >>> observer = luenberger(moving_body(2).form, 0.1)
    >>> observer.P.name
    'constant P'
    """

    form: PointsForm
    P: LyapunovMatrix
    about: ClassVar[About] = ABOUT
    covariance: ClassVar[None] = None

    @property
    def name(self) -> str:
        """Name of the observer."""
        return f"Luenberger, {self.P.name}"

    @cached_property
    def estimate(self) -> tuple[sp.Symbol, ...]:
        """Symbols of the estimates."""
        return hats(self.form.state)

    @cached_property
    def inverse(self) -> sp.ImmutableMatrix:
        """Symbols of the inverse of P."""
        n = self.form.states
        return sp.ImmutableMatrix(n, n, lambda i, j: sp.Symbol(f"Q_{min(i, j) + 1}_{max(i, j) + 1}", real=True))

    @cached_property
    def gain(self) -> sp.ImmutableMatrix:
        """K = P^-1 C^T B^T E^-1, which multiplies y - H(C xhat); Inaba et al. 2005, (10) and (17)."""
        form = self.form
        distances = sp.diag(*(1 / e for e in form.E(self.estimate).diagonal()))
        return sp.ImmutableMatrix(self.inverse * form.stacked.T * form.B.T * distances)

    @cached_property
    def scaled_innovation(self) -> sp.ImmutableMatrix:
        """E^-1 (y - H(C xhat)) without a division: y_k l xi_k - N xi_k for each point, xi_k = C_k xhat."""
        form, block = self.form, self.form.block
        m, estimate = len(block.y), sp.ImmutableMatrix(self.estimate)
        rows = []
        for k, C in enumerate(form.C):
            values = (*form.y[k * m : (k + 1) * m], *(C * estimate))
            rows.append(block.innovation.xreplace(dict(zip((*block.y, *block.xi), values, strict=True))))
        return sp.ImmutableMatrix.vstack(*rows).expand()

    @cached_property
    def flow(self) -> sp.ImmutableMatrix:
        """Rate of the estimate: A xhat + v + P^-1 C^T B^T E^-1 (y - H(C xhat)); Inaba et al. 2005, (11)."""
        form, estimate = self.form, sp.ImmutableMatrix(self.estimate)
        correction = self.inverse * form.stacked.T * form.B.T * self.scaled_innovation
        return sp.ImmutableMatrix(form.motion.A * estimate + form.motion.b + correction).expand()

    @property
    def error(self) -> tuple[sp.Symbol, ...]:
        """Symbols rho1, rho2, ... of the errors x - xhat."""
        return sp.symbols(f"rho1:{self.form.states + 1}", real=True)

    def error_dynamics(self) -> sp.ImmutableMatrix:
        """Return the rate of the error rho = x - xhat, in terms of images and error; Inaba et al. 2005, (12).

        Notes
        -----
        The difference of the rates is affine in the state, which enters it through B(y) C x alone: 0, for y are the
        images of x.
        """
        form, rho = self.form, sp.ImmutableMatrix(self.error)
        x = sp.ImmutableMatrix(form.state)
        at_estimate = dict(zip(self.estimate, x - rho, strict=True))
        difference = form.motion.A * x + form.motion.b - self.flow.xreplace(at_estimate)
        difference = sp.ImmutableMatrix(difference).expand()
        seen = form.B * form.stacked
        without_state = difference.xreplace(dict.fromkeys(form.state, sp.S.Zero))
        # what is left of the state must be P^-1 C^T B^T B C x, which is 0 since y are the images of x
        rest = difference - without_state - self.inverse * seen.T * (seen * x)
        images = dict(zip(form.y, form.H(form.state), strict=True))
        on_rays = (seen * x).xreplace(images).applyfunc(sp.cancel)
        if any(rest.expand()) or any(on_rays):
            raise ArithmeticError("the state does not drop out of the error's rate; is y the image of C x?")
        return sp.ImmutableMatrix(without_state)

    def _repr_latex_(self) -> str:
        return (
            r"$\displaystyle \begin{aligned} \dot{\hat x} &= A \hat x + v + P^{-1} C^T B^T E^{-1} (y - H(C \hat x)) "
            rf"\\ B_k &= {sp.latex(self.form.block.B)} \end{{aligned}}$"
        )


@checked
def luenberger(
    form: PointsForm, P: ArrayLike | Callable[[float], ArrayLike] | LyapunovMatrix = 1.0
) -> LuenbergerObserver:
    """Return the Luenberger-type observer of a linear state seen through many points.

    ::

        xhat' = A xhat + v + P^-1 C^T B(y)^T E^-1 (y - H(C xhat))

    E^-1 (y - H) = y_k l xi_k - N xi_k has no division, and the error obeys rho' = (A - P^-1 C^T B^T B C) rho whatever
    the start.  Points that are not seen have no rows in B.

    Parameters
    ----------
    form : PointsForm
        Of n states.
    P : number, array of shape (n, n), function of time, or LyapunovMatrix
        A number stands for its multiple of the identity.  Others come from `constant`, `scheduled`, `lyapunov` and
        `riccati`.  A smaller P corrects more.

    Returns
    -------
    LuenbergerObserver
        With P of shape (n, n).

    Raises
    ------
    ValueError
        If P is not symmetric positive definite or of another size.

    See Also
    --------
    track : Let it follow a recording.

    Notes
    -----
    H. Inaba et al., Nonlinear observers for perspective time-varying linear systems with multiple observing points,
    IFAC 2005, (10), (11) and Theorem 3.4.

    Examples
    --------
    >>> from percept_obs import luenberger
    >>> from percept_obs.points import riccati
    >>> from percept_obs.points.scenarios import moving_body
    >>> luenberger(moving_body(2).form, riccati()).name
    'Luenberger, Riccati'
    """
    if not isinstance(P, LyapunovMatrix):
        P = scheduled(P) if callable(P) else constant(P)
    return LuenbergerObserver(form, P.sized(form.states))
