"""Linear view of structure and motion: scaled positions, for which a Kalman filter needs no linearisation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile import Array
from percept_obs.structure.choice import StructureAndMotion
from percept_obs.structure.dynamics import d_s
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.motion import rigid
from percept_obs.system.view import OnePoint
from percept_obs.validation import checked, numbers

OUTPUTS = sp.symbols("xbar1:4", real=True)


@checked
@dataclass(frozen=True)
class LinearView(OnePoint):
    """Scaled positions xbar = (y1, y2, 1) / ybar3 = d_s X, which obey a linear equation.

    With X' = -w_c x X + v_p - v_c and a constant scale::

        xbar' = -w_c x xbar + d_s (v_p - v_c)

    The unknowns are those of the choice, and so is the condition that they are observable.  The extended Kalman filter
    on this form is the Kalman filter; the noise of the outputs, however, depends on where the point is seen.

    Parameters
    ----------
    choice : StructureAndMotion

    See Also
    --------
    linear_view : Recordings in it.
    percept_obs.StructureAndMotion : What it is made of.

    Examples
    --------
    >>> from percept_obs import StructureAndMotion
    >>> from percept_obs.structure import LinearView
    >>> view = LinearView(StructureAndMotion(("v_p1", "v_p2"), zero=("v_p3",)))
    >>> view.form.w
    Matrix([
    [d_s,   0, 0],
    [  0, d_s, 0]])
    """

    choice: StructureAndMotion
    image_coordinates = OUTPUTS

    @cached_property
    def form(self) -> CanonicalForm:
        """The canonical form, with x1 = xbar and x2 = theta; neither w nor the Jacobian of phi depends on them."""
        motion = rigid()
        rate = motion.A * sp.ImmutableMatrix(OUTPUTS) + d_s * motion.b
        return self.choice.split(OUTPUTS, rate, self)

    def scaled(self, ybar: ArrayLike) -> Array:
        """Scaled positions of (y1, y2, ybar3), shape (..., 3); NaN where ybar3 is not positive."""
        ybar = numbers(ybar, "the values of (y1, y2, ybar3)", 3)
        inverse = np.where(ybar[..., 2:] > 0, ybar[..., 2:], np.nan)
        return np.concatenate([ybar[..., :2], np.ones_like(inverse)], axis=-1) / inverse

    @property
    def name(self) -> str:
        """Name of the view and of the unknowns."""
        return f"linear view of the {self.choice.name}"

    @property
    def coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols of scaled position and theta."""
        return self.form.coordinates

    @property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """The scale, where it is known."""
        return self.choice.parameters

    @property
    def values(self) -> Mapping[sp.Symbol, float]:
        """The scale's number, if it has one."""
        return self.choice.values

    @property
    def lengths(self) -> tuple[int, ...]:
        """Powers of length, as of the choice."""
        return self.choice.lengths

    def fits(self, other: object) -> bool:
        """True if formulas derived for this view hold for the other."""
        return isinstance(other, LinearView) and self.choice.fits(other.choice)

    def inverse(self, coordinates: ArrayLike) -> Array:
        """Inverse depth in 1/m, shape (...), from xbar and theta; NaN where theta gives no positive d_s."""
        return self.choice.inverse(self._ybar(coordinates))

    def locate(self, coordinates: ArrayLike) -> Array:
        """Points in metres, shape (..., 3), from xbar and theta; infinite where no positive inverse depth follows."""
        return self.choice.locate(self._ybar(coordinates))

    @property
    def judged(self) -> str:
        """Names of the unknowns, as of the choice."""
        return self.choice.judged

    def relative_error(self, truth: Array, estimate: Array, known: Array) -> Array:
        """Largest relative error of the unknowns, shape (K,), as of the choice."""
        return self.choice.relative_error(self._ybar(truth), self._ybar(estimate), known)

    def _ybar(self, coordinates: ArrayLike) -> Array:
        """The choice's coordinates (ybar, theta) from (xbar, theta)."""
        position, theta = np.split(self._all(coordinates), [len(OUTPUTS)], axis=-1)
        depth = np.where(position[..., 2:] > 0, position[..., 2:], np.nan)
        return np.concatenate([position[..., :2] / depth, 1 / depth, theta], axis=-1)
