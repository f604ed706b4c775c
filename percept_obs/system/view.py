"""What is seen: the coordinates that a recording's columns stand for, whatever they are derived from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray


class View(Protocol):
    """Measured and hidden coordinates of a point: an imaging surface is a view, and so is a scaled inverse depth."""

    @property
    def name(self) -> str:
        """What it is called."""

    @property
    def image_coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols of what can be measured."""

    @property
    def coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols of all coordinates, those that can be measured first."""

    @property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """Symbols of its constants."""

    @property
    def values(self) -> Mapping[sp.Symbol, float]:
        """Numbers of the constants."""

    def fits(self, other: Any) -> bool:
        """Whether what is derived for this view holds for the other."""

    def inverse(self, coordinates: ArrayLike) -> NDArray[np.float64]:
        """Inverse distances in 1/m, shape (...), of points with the given coordinates."""

    def locate(self, coordinates: ArrayLike) -> NDArray[np.float64]:
        """Points of space, shape (..., 3), that have the given coordinates; infinite where none is in front."""
