"""Set-ups with many points: two in which every direction of the state is seen, two in which one is not."""

from __future__ import annotations

import numpy as np

from percept_obs.points.bodies import rigid_body
from percept_obs.points.form import PointsForm
from percept_obs.points.manoeuvre import PATH, Manoeuvre
from percept_obs.points.simulation import PointsScenario
from percept_obs.system.motion import TIME, linear
from percept_obs.validation import checked

OFFSET = (0.5, -0.3, 0.4)
"""Place of the second point from the first one, in metres, at time 0."""


@checked
def moving_body(points: int = 1) -> PointsScenario:
    """Scenario of a rigid body that stays in the view of a turning camera, for 60 s.

    The camera moves as in `Manoeuvre`, whose path the first point follows.  The second one is at `OFFSET` from it;
    further ones are drawn at random, always the same, from a cube of 1 m around it.
    """
    camera_turns, camera_moves, body_turns = Manoeuvre().velocities
    form = rigid_body(points, camera_turns, camera_moves, body_turns)
    drawn = np.random.default_rng(0).uniform(-0.5, 0.5, 3 * max(points - 2, 0))
    begin = [float(place.subs(TIME, 0)) for place in PATH]
    state = [*begin, *OFFSET, *drawn][: 3 * points]
    return PointsScenario(f"moving body, {points} points", form, state, 60.0)


@checked
def lost_offset() -> PointsScenario:
    """Scenario of two points of which the camera sees the first one only: the second one's offset is lost."""
    two = moving_body(2)
    form = PointsForm(two.form.motion, two.form.blocks[:1], names=two.form.names)
    return PointsScenario("the second point is not seen", form, two.state, 60.0)


@checked
def along_the_line_of_sight() -> PointsScenario:
    """Scenario of a point that recedes along its ray: the images stand still, and its depth is lost."""
    form = PointsForm(linear(np.zeros((3, 3)), [0.04, 0.02, 0.2]), np.eye(3), names=("X", "Y", "Z"))
    return PointsScenario("along the line of sight", form, (0.4, 0.2, 2.0), 60.0)
