"""Views: the coordinates of points as a camera sees them, one or several of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile import Array
from percept_obs.validation import numbers

DISTANCE = "the distance"
"""Quantity that verdicts judge; labs use the same words."""


def refuse_several(what: str, view: View, error: type[ValueError] = ValueError) -> None:
    """Raise an error where something of one point is asked of a view of several."""
    if view.point_shape:
        raise error(f"{what} is of one point; the recording shows {view.name}, for luenberger(recording.view)")


class View(Protocol):
    """Measured and hidden coordinates of one or several points.

    An imaging surface is a view of one point; a scaled inverse depth is one, and so are several points of one state.
    """

    @property
    def name(self) -> str:
        """Name in messages."""

    @property
    def image_coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols of the coordinates that can be measured."""

    @property
    def coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols of all coordinates, those that can be measured first."""

    @property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """Symbols of its constants."""

    @property
    def values(self) -> Mapping[sp.Symbol, float]:
        """Numbers of the constants."""

    @property
    def point_shape(self) -> tuple[int, ...]:
        """Shape of arrays with one entry a point: () for one point, (p,) for p of them."""

    @property
    def lengths(self) -> tuple[int, ...]:
        """Power of the unit of length in each coordinate, and then in each parameter: -1 for 1/m."""

    def fits(self, other: Any) -> bool:
        """Return True if formulas for this view hold for the other."""

    def outputs(self, coordinates: ArrayLike) -> Array:
        """Image coordinates of points from all coordinates, shape (..., m) or (..., p, m)."""

    def inverse(self, coordinates: ArrayLike) -> Array:
        """Inverse distances in 1/m, shape (...) or (..., p), from all coordinates."""

    def locate(self, coordinates: ArrayLike) -> Array:
        """Points of space, shape (..., 3) or (..., p, 3), from all coordinates."""

    @property
    def judged(self) -> str:
        """Quantity that `relative_error` is the error of, in words."""

    def relative_error(self, truth: Array, estimate: Array, known: Array) -> Array:
        """Return the largest relative error of the judged quantity, the same in any unit of length, shape (K,).

        It is infinite where the estimate is infinitely far away or behind the camera, NaN where there is none.  Known
        are the parameters of the motion at the same times, shape (K, p) or (1, p).
        """


class OnePoint(ABC):
    """View of one point; arrays lose the point axis, and the measured coordinates come first."""

    @property
    @abstractmethod
    def image_coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols of the coordinates that can be measured."""

    @property
    @abstractmethod
    def coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols of all coordinates."""

    @abstractmethod
    def inverse(self, coordinates: ArrayLike) -> Array:
        """Inverse distances in 1/m, shape (...)."""

    point_shape: tuple[int, ...] = ()

    def outputs(self, coordinates: ArrayLike) -> Array:
        """Measured coordinates, shape (..., m), the first of all coordinates, shape (..., n)."""
        return self._all(coordinates)[..., : len(self.image_coordinates)]

    def _all(self, coordinates: ArrayLike) -> Array:
        """Values of all coordinates, shape (..., n); ValueError for another shape."""
        names = [symbol.name for symbol in self.coordinates]
        return numbers(coordinates, f"the coordinates {', '.join(names)}", len(names))

    @property
    def judged(self) -> str:
        """The distance."""
        return DISTANCE

    def relative_error(self, truth: Array, estimate: Array, known: Array) -> Array:
        """|estimated distance / true distance - 1|, shape (K,); see `View`."""
        true, found = self.inverse(truth), self.inverse(estimate)
        if true.shape != found.shape:
            raise ValueError(
                f"the truth is of shape {np.shape(truth)}, the estimate {np.shape(estimate)}; make them fit"
            )
        there = np.isfinite(estimate).all(axis=-1)
        error = np.where(there, np.inf, np.nan)
        return np.abs(np.divide(true, found, out=error + 1, where=there & (found > 0)) - 1)
