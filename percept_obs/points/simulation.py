"""Scenarios of many points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from percept_obs.compile import Array
from percept_obs.points.form import PointsForm
from percept_obs.recording import Scene
from percept_obs.recording.path import constant_path, times_of, varying_path
from percept_obs.system.motion import Motion
from percept_obs.validation import checked


class LeavesEveryBound(ValueError):
    """The state grows without end, so that nothing can be recorded of it."""


@checked
@dataclass(frozen=True, eq=False)
class PointsScenario(Scene):
    """A state in motion whose points a camera may see.

    Parameters
    ----------
    name : str
    form : PointsForm
        With numbers for its motion.
    state : sequence of n numbers
        The state at time 0.
    duration : float
        In seconds.
    source : str
        Source of the set-up.

    Raises
    ------
    ValueError
        If the state has another size or is not finite, or the duration is not positive.

    Examples
    --------
    >>> from percept_obs import Camera, PointsScenario, rigid, record
    >>> from percept_obs.points import independent_points
    >>> motion = rigid([0.0, 0.1, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.0])
    >>> scenario = PointsScenario("two points", independent_points(motion, 2), (0, 0, 4, 1, 0, 5), 3.0)
    >>> record(scenario, camera=Camera(1.0)).truth[-1].round(2).tolist()
    [-0.3, 0.0, 4.04, 0.96, 0.0, 4.7]
    """

    name: str
    form: PointsForm
    state: Sequence[float]
    duration: float
    source: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "state", self._check("state", self.state, self.form.names))

    @property
    def view(self) -> PointsForm:
        """The form."""
        return self.form

    @property
    def known_motion(self) -> Motion:
        """The form's motion."""
        return self.form.motion

    def coordinates(self, times: ArrayLike) -> Array:
        """States at times from 0 on that do not decrease, shape (K, n), as exact as those of a `Scenario`.

        Raises
        ------
        LeavesEveryBound
            If the state grows beyond all bounds before.
        TooMuchWork
            If there are too many times, or the motion is too fast.
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

            path = varying_path(rate, start, times, () if signal.times is None else signal.times)
        bounded = np.isfinite(path).all(axis=1)
        if not bounded.all():
            when = times[np.argmin(bounded)]
            raise LeavesEveryBound(
                f"the state of {self.name!r} leaves every bound at {when:.4g} s; shorten the duration"
            )
        return path
