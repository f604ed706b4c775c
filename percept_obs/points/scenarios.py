"""Scenarios of many points: two in which every direction of the state is seen, two in which one is not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from percept_obs.compile import Array
from percept_obs.points.bodies import rigid_body
from percept_obs.points.form import PointsForm
from percept_obs.points.manoeuvre import PATH, Manoeuvre
from percept_obs.recording import Scene
from percept_obs.recording.path import constant_path, times_of, varying_path
from percept_obs.system.motion import TIME, Motion, linear
from percept_obs.validation import NAMED, Times, checked, set_fields


class LeavesEveryBound(ValueError):
    """The state grows without end, so that nothing can be recorded of it."""


@checked
@dataclass(frozen=True, eq=False)
class PointsScenario(Scene):
    """A state in motion whose points a camera may see.

    Parameters
    ----------
    name : str
        Name in messages.
    form : PointsForm
        With numbers for its motion.
    state : array of shape (n,)
        The state at time 0, in the form's units.
    duration : float
        In seconds.
    source : str
        Source of the set-up.

    Raises
    ------
    ValueError
        If the state has another size or is not finite, or the duration is not positive.

    See Also
    --------
    record : Records it.
    percept_obs.Scenario : Of a single point.

    Examples
    --------
    >>> from percept_obs import Camera, PointsScenario, rigid, record
    >>> from percept_obs.points import independent_points
    >>> motion = rigid(camera_angular_velocity=[0.0, -0.1, 0.0], camera_velocity=[0.5, 0.0, 0.0])
    >>> scenario = PointsScenario("two points", independent_points(motion, 2), (0, 0, 4, 1, 0, 5), 3.0)
    >>> record(scenario, camera=Camera(1.0)).truth[-1].round(2).tolist()
    [-0.3, 0.0, 4.04, 0.96, 0.0, 4.7]
    """

    name: str
    form: PointsForm
    state: Annotated[Sequence[float], NAMED]
    duration: float
    source: str = ""

    def __post_init__(self) -> None:
        set_fields(self, state=self._check("state", self.state, self.form.names))

    @property
    def view(self) -> PointsForm:
        """The form."""
        return self.form

    @property
    def known_motion(self) -> Motion:
        """The form's motion."""
        return self.form.motion

    def coordinates(self, times: Times) -> Array:
        """States at times from 0 on that do not decrease, shape (K, n), as exact as those of a `Scenario`.

        It raises LeavesEveryBound if the state grows beyond all bounds before, and TooMuchWork if the motion is too
        fast.
        """
        form, start = self.form, np.array(self.state)
        times = times_of(times, form.states)
        signal = form.motion.signal
        if signal is None or signal.constant:
            A, v = form.coefficients(times[:1])
            path = constant_path(A[0], v[0], start, times)
        else:

            def rate(time: float, state: Array) -> Array:
                A, v = form.coefficients(float(time))
                return A[0] @ state + v[0]

            path = varying_path(rate, start, times, signal.breaks(times[-1]))
        bounded = np.isfinite(path).all(axis=1)
        if not bounded.all():
            when = times[np.argmin(bounded)]
            raise LeavesEveryBound(f"the state of {self.name!r} leaves every bound at {when:.4g} s; stop before")
        return path


OFFSET = (0.5, -0.3, 0.4)
"""Place of the second point from the first one, in metres, at time 0."""


@checked
def moving_body(points: int = 1) -> PointsScenario:
    """Return a scenario of a rigid body that stays in the view of a turning camera, for 60 s.

    The camera moves as in `Manoeuvre`, whose path the first point follows.  The second one is at `OFFSET` from it;
    further ones are drawn at random, always the same, from a cube of 1 m around it.

    Parameters
    ----------
    points : int
        Points of the body, from 1 on.

    See Also
    --------
    lost_offset, along_the_line_of_sight : Where something is not seen.

    Examples
    --------
    >>> from percept_obs.points.scenarios import moving_body
    >>> moving_body(2).coordinates([0, 30]).round(2).tolist()
    [[0.0, 1.2, 2.5, 0.5, -0.3, 0.4], [-1.48, -0.66, 2.83, 0.11, -0.44, 0.54]]
    """
    camera_turns, camera_moves, body_turns = Manoeuvre().velocities
    form = rigid_body(points, camera_turns, camera_moves, body_turns)
    drawn = np.random.default_rng(0).uniform(-0.5, 0.5, 3 * max(points - 2, 0))
    begin = [float(place.subs(TIME, 0)) for place in PATH]
    state = [*begin, *OFFSET, *drawn][: 3 * points]
    return PointsScenario(f"moving body, {points} points", form, state, 60.0)


@checked
def lost_offset() -> PointsScenario:
    """Return a scenario of two points of which the camera sees the first one: the second one's offset is lost.

    It warns of an `UnseenDirection`.

    See Also
    --------
    moving_body : Where both points are seen.

    Examples
    --------
    >>> from percept_obs.points.scenarios import lost_offset
    >>> import warnings
    >>> with warnings.catch_warnings(action="ignore"):  # of what is not seen
    ...     form = lost_offset().form
    >>> form.points, form.states
    (1, 6)
    """
    two = moving_body(2)
    form = PointsForm(two.form.motion, two.form.blocks[:1], names=two.form.names)
    return PointsScenario("the second point is not seen", form, two.state, 60.0)


@checked
def along_the_line_of_sight() -> PointsScenario:
    """Return a scenario of a point that recedes along its ray: the images stand still, and its depth is lost.

    Its coordinates are X, Y, Z in metres, for 60 s.

    See Also
    --------
    moving_body : Where everything is seen.

    Examples
    --------
    >>> from percept_obs.points.scenarios import along_the_line_of_sight
    >>> along_the_line_of_sight().coordinates([0, 10]).tolist()
    [[0.4, 0.2, 2.0], [0.8, 0.4, 4.0]]
    """
    form = PointsForm(linear(np.zeros((3, 3)), [0.04, 0.02, 0.2]), np.eye(3), names=("X", "Y", "Z"))
    return PointsScenario("along the line of sight", form, (0.4, 0.2, 2.0), 60.0)
