"""Set-ups with many points: two in which every direction of the state is seen, two in which one is not."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from percept_obs.motion import linear
from percept_obs.points.bodies import rigid_body
from percept_obs.points.form import PointsForm
from percept_obs.points.recording import PointsScenario

Array = NDArray[np.float64]

OFFSET = (0.5, -0.3, 0.4)
"""Place of the second point from the first one, in metres, at time 0."""


def moving_body(points: int = 1) -> PointsScenario:
    """A rigid body that stays in the view of a turning camera, for 60 s.

    The points turn with W = [w]x, w = (0.2 sin 0.3t, 0.3 cos 0.4t, 0.5), and the first one is kept at
    r = (1.5 sin t, 1.2 cos 0.7t, 2.5 + 0.5 sin 0.5t) by v = r' - W r.  The second one is at `OFFSET` from it; further
    ones are drawn at random, always the same, from a cube of 1 m around it.
    """
    form = rigid_body(points, lambda t: -_turning(t), lambda t: -_input(t))
    drawn = np.random.default_rng(0).uniform(-0.5, 0.5, 3 * max(points - 2, 0))
    state = [*_path(0.0), *OFFSET, *drawn][: 3 * points]
    return PointsScenario(f"moving body, {points} points", form, state, 60.0)


def lost_offset() -> PointsScenario:
    """The same body, of which the camera sees the first point only: the second one's place is lost."""
    two = moving_body(2)
    form = PointsForm(two.form.motion, two.form.blocks[:1], names=two.form.names)
    return PointsScenario("the second point is not seen", form, two.state, 60.0)


def along_the_line_of_sight() -> PointsScenario:
    """A point that recedes along its ray: the images stand still, and its depth is lost."""
    form = PointsForm(linear(np.zeros((3, 3)), [0.04, 0.02, 0.2]), np.eye(3), names=("X", "Y", "Z"))
    return PointsScenario("along the line of sight", form, (0.4, 0.2, 2.0), 60.0)


def _turning(t: float) -> Array:
    return np.array([0.2 * np.sin(0.3 * t), 0.3 * np.cos(0.4 * t), 0.5])


def _path(t: float) -> Array:
    return np.array([1.5 * np.sin(t), 1.2 * np.cos(0.7 * t), 2.5 + 0.5 * np.sin(0.5 * t)])


def _input(t: float) -> Array:
    (w1, w2, w3), (x, y, z) = _turning(t), _path(t)
    velocity = np.array([1.5 * np.cos(t), -0.84 * np.sin(0.7 * t), 0.25 * np.cos(0.5 * t)])
    return velocity - np.array([w2 * z - w3 * y, w3 * x - w1 * z, w1 * y - w2 * x])
