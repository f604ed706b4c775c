"""What is seen: the coordinates that a recording's columns stand for, whatever they are derived from."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile import Array

DISTANCE = "the distance"
"""What verdicts judge of a point; live labs use the same words."""


class View(Protocol):
    """Measured and hidden coordinates of what is seen.

    An imaging surface is a view of one point; a scaled inverse depth is one, and so are several points of one state.
    """

    @property
    def name(self) -> str:
        """What it is called."""

    @property
    def image_coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols of what can be measured of a point."""

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
        """Shape of what there is once a point: () for one point, (p,) for p of them."""

    def fits(self, other: Any) -> bool:
        """Whether what is derived for this view holds for the other."""

    def outputs(self, coordinates: ArrayLike) -> Array:
        """What a camera sees of points with the given coordinates, shape (..., m) or (..., p, m)."""

    def inverse(self, coordinates: ArrayLike) -> Array:
        """Inverse distances in 1/m, shape (...) or (..., p), of points with the given coordinates."""

    def locate(self, coordinates: ArrayLike) -> Array:
        """Points of space, shape (..., 3) or (..., p, 3), that have the given coordinates."""

    @property
    def judged(self) -> str:
        """What `relative_error` is an error of, in words."""

    def relative_error(self, truth: Array, estimate: Array, known: Array) -> Array:
        """Largest relative error of what is sought, the same in any unit of length.

        Parameters
        ----------
        truth, estimate : arrays of shape (K, n)
            Coordinates.
        known : array of shape (K, p) or (1, p)
            Parameters of the known motion at the same times.

        Returns
        -------
        array of shape (K,)
            Infinite where the estimate is infinitely far away or behind the camera, NaN where there is none.
        """


class OnePoint(ABC):
    """A view of one point, so that there is once what there is once a point; it begins with what can be measured."""

    @property
    @abstractmethod
    def image_coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols of what can be measured."""

    @abstractmethod
    def inverse(self, coordinates: ArrayLike) -> Array:
        """Inverse distances in 1/m, shape (...)."""

    point_shape: tuple[int, ...] = ()

    def outputs(self, coordinates: ArrayLike) -> Array:
        """What is measured, shape (..., m): the first of the coordinates, of shape (..., n)."""
        return np.asarray(coordinates, dtype=float)[..., : len(self.image_coordinates)]

    @property
    def judged(self) -> str:
        """The distance."""
        return DISTANCE

    def relative_error(self, truth: Array, estimate: Array, known: Array) -> Array:
        """|estimated distance / true distance - 1|, shape (K,); see `View`."""
        true, found = self.inverse(truth), self.inverse(estimate)
        there = np.isfinite(estimate).all(axis=-1)
        error = np.where(there, np.inf, np.nan)
        return np.abs(np.divide(true, found, out=error + 1, where=there & (found > 0)) - 1)
