"""Run of a Luenberger-type observer on a recording of many points."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from percept_obs.compile import Array, Flags, Indices
from percept_obs.points.conditions import Conditions, conditions
from percept_obs.points.form import PointsForm
from percept_obs.points.information import many_points
from percept_obs.tracking import Run
from percept_obs.tracking.information import Fit
from percept_obs.validation import checked

REMEDY = "choose a larger P or shorter steps, and look at conditions() if P is no longer positive definite"
"""Advice for a run that diverged, also of live labs."""


@checked
@dataclass(frozen=True, eq=False)
class PointsRun(Run):
    """Estimates of a state at the samples of a recording of several points.

    Parameters
    ----------
    recording, observer, estimate, state, diverged_at, hold, resets, unobservable
        See `Run`; the estimate is the state of the observer.
    began : array of shape (K, p) of bool
        True where a point was given a start.
    kept : integer array of shape (T,)
        Samples at which P was kept.
    P : array of shape (T, n, n)
        P at these samples.

    See Also
    --------
    percept_obs.Run : Of a single point.
    track : Makes it.

    Examples
    --------
    >>> from percept_obs import Camera, luenberger, record, track
    >>> from percept_obs.points.scenarios import moving_body
    >>> recording = record(moving_body(2), 4, Camera(0.1))
    >>> run = track(recording, luenberger(recording.view), recording.truth[0] + 0.1)
    >>> run.deviation[[0, -1]].round(3).tolist()
    [0.245, 0.117]
    """

    began: Flags
    kept: Indices
    P: Array
    remedy: ClassVar[str] = REMEDY

    @property
    def view(self) -> PointsForm:
        """The form that the observer believes in."""
        view: PointsForm = self.observer.form
        return view

    @property
    def truth(self) -> Array:
        """True states, shape (K, n); raises ValueError if the recording has none, or of a state of another size."""
        truth, states = super().truth, len(self.view.coordinates)
        if truth.shape[1] != states:
            raise ValueError(f"the observer believes in {states} states, the truth has {truth.shape[1]}")
        return truth

    @property
    def measured(self) -> tuple[str, ...]:
        """Names of a point's outputs: all of them are used."""
        return self.recording.names

    @cached_property
    def deviation(self) -> Array:
        """Norm of the error rho, truth minus estimate, shape (K,)."""
        return np.asarray(np.linalg.norm(self.error, axis=1))

    @property
    def _least_squares(self) -> Fit:
        return many_points(self.view, self.recording)

    def decay_rate(self, begin: float = -math.inf, end: float = math.inf) -> float:
        """Rate of the exponential fitted to the error's norm between two times, in 1/s; positive where it shrinks.

        At least two samples must lie between them, with finite errors that are not zero.
        """
        inside = (self.time >= begin) & (self.time <= end)
        size = self.deviation[inside]
        if inside.sum() < 2 or not (np.isfinite(size) & (size > 0)).all():
            raise ValueError(
                f"between {begin} and {end} s there are {inside.sum()} samples, with errors from "
                f"{size.min(initial=0):.3g} to {size.max(initial=0):.3g}; an exponential needs two finite positive ones"
            )
        return float(-np.polyfit(self.time[inside], np.log(size), 1)[0])

    def conditions(self, epsilon: float = 1.0) -> Conditions:
        """Evaluate the inequality (15) and the weaker sufficient one along the run; 0 < epsilon <= 2."""
        return conditions(self.observer, self.time[self.kept], self.recording.outputs[self.kept], self.P, epsilon)
