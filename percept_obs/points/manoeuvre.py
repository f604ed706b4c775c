"""Motion of a camera and a body: a manoeuvre that shows every direction of the state, and shares of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import sympy as sp

from percept_obs.system.motion import TIME as t
from percept_obs.validation import checked

Vectors = tuple[tuple[sp.Expr, ...], ...]

TURNING = (-sp.sin(3 * t / 10) / 5, -3 * sp.cos(2 * t / 5) / 10, -sp.Rational(1, 2))
"""Angular velocity w_c of the camera, in rad/s."""
PATH = (3 * sp.sin(t) / 2, 6 * sp.cos(7 * t / 10) / 5, sp.Rational(5, 2) + sp.sin(t / 2) / 2)
"""Path in metres on which the input keeps a point that starts there."""
SPIN = (sp.sin(t) / 2, 2 * sp.cos(t) / 5, sp.Rational(3, 10))
"""Angular velocity of the body in the world, in rad/s."""

SHARES = sp.symbols("turning spin input v_c1:4", real=True)
"""Shares of turning, spin and input, and a constant velocity of the camera in m/s."""


@lru_cache(maxsize=1)
def velocities() -> Vectors:
    """The camera's angular velocity and velocity and the body's angular velocity, in `TIME` and `SHARES`."""
    turning, spin, size, *constant = SHARES
    w_c, path = turning * sp.Matrix(TURNING), sp.Matrix(PATH)
    v_c = sp.Matrix(constant) - size * (path.diff(t) + w_c.cross(path))
    return tuple(w_c), tuple(v_c), tuple(spin * sp.Matrix(SPIN))


@checked
@dataclass(frozen=True)
class Manoeuvre:
    """Camera and body in motion, with all points kept in view.

    The camera turns by a share of w_c = -(0.2 sin 0.3t, 0.3 cos 0.4t, 0.5) rad/s, and the body spins in the world by
    one of (0.5 sin t, 0.4 cos t, 0.3).  A share of the input v_c = -(r' + w_c x r) keeps a point on r = (1.5 sin t,
    1.2 cos 0.7t, 2.5 + 0.5 sin 0.5t); the camera's velocity is a constant part of v_c, in m/s.
    """

    turning: float = 1.0
    spin: float = 0.0
    input: float = 1.0
    camera_velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        for name in vars(self):
            if not np.isfinite(getattr(self, name)).all():
                raise ValueError(f"the {name} is {getattr(self, name)}; it must be finite")

    @property
    def velocities(self) -> list[tuple[sp.Expr, ...]]:
        """Arguments of `rigid_body`: the camera's angular velocity and velocity, the body's angular velocity."""
        numbers = (self.turning, self.spin, self.input, *self.camera_velocity)
        # whole numbers as integers, so that factors 0 and 1 drop out of the formulas
        shares = {symbol: int(x) if x == int(x) else x for symbol, x in zip(SHARES, numbers, strict=True)}
        return [tuple(entry.subs(shares) for entry in vector) for vector in velocities()]
