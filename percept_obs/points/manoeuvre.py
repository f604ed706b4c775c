"""How a camera and a body move while points are seen: a manoeuvre that tells everything, and parts of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from percept_obs.compile import scalar_function

Array = NDArray[np.float64]
Vector = tuple[sp.Expr, ...]

TIME = t = sp.Symbol("t", real=True)
TURNING = (sp.sin(3 * t / 10) / 5, 3 * sp.cos(2 * t / 5) / 10, sp.Rational(1, 2))
"""w(t) in rad/s, by which W = [w]x turns resting points in the camera's axes."""
PATH = (3 * sp.sin(t) / 2, 6 * sp.cos(7 * t / 10) / 5, sp.Rational(5, 2) + sp.sin(t / 2) / 2)
"""Where the input keeps a point that starts there, in metres."""
SPIN = (sp.sin(t) / 2, 2 * sp.cos(t) / 5, sp.Rational(3, 10))
"""Angular velocity of the body in the world, in rad/s."""

PARTS = sp.symbols("turning spin input v1:4", real=True)
"""What a manoeuvre takes of each, and a constant velocity in m/s."""


@lru_cache(maxsize=1)
def velocities() -> dict[str, Vector]:
    """Velocities of camera and body, in the camera's axes, as functions of `TIME` and `PARTS`."""
    turning, spin, size, *constant = PARTS
    w = turning * sp.Matrix(TURNING)
    path = sp.Matrix(PATH)
    input = size * (path.diff(TIME) - w.cross(path)) + sp.Matrix(constant)
    return {
        "camera_angular_velocity": tuple(-w),
        "camera_velocity": tuple(-input),
        "body_angular_velocity": tuple(spin * sp.Matrix(SPIN)),
    }


@lru_cache(maxsize=1)
def _functions() -> dict[str, Callable[..., list[float]]]:
    return {name: scalar_function((TIME, *PARTS), vector) for name, vector in velocities().items()}


@dataclass(frozen=True)
class Manoeuvre:
    """A camera and a body in motion, with all points kept in view; its methods are what `rigid_body` takes.

    Parameters
    ----------
    turning : float
        Share of W = [w]x, w = (0.2 sin 0.3t, 0.3 cos 0.4t, 0.5), by which the camera turns.
    spin : float
        Share of (0.5 sin t, 0.4 cos t, 0.3) rad/s, by which the body turns in the world.
    input : float
        Share of the input v = r' - W r, which keeps a point on r = (1.5 sin t, 1.2 cos 0.7t, 2.5 + 0.5 sin 0.5t).
    velocity : three numbers
        A constant part of v, in m/s.
    """

    turning: float = 1.0
    spin: float = 0.0
    input: float = 1.0
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def camera_angular_velocity(self, time: float) -> Array:
        """Angular velocity of the camera at a time, in rad/s."""
        return self._at("camera_angular_velocity", time)

    def camera_velocity(self, time: float) -> Array:
        """Velocity of the camera at a time, in m/s."""
        return self._at("camera_velocity", time)

    def body_angular_velocity(self, time: float) -> Array:
        """Angular velocity of the body at a time, in rad/s."""
        return self._at("body_angular_velocity", time)

    def _at(self, name: str, time: float) -> Array:
        return np.array(_functions()[name](time, self.turning, self.spin, self.input, *self.velocity))
