"""What a Luenberger-type observer estimated of a recording of many points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from percept_obs.points.conditions import Conditions, conditions
from percept_obs.points.luenberger import LuenbergerObserver
from percept_obs.points.recording import PointsRecording
from percept_obs.tracking.run import Hold

Array = NDArray[np.float64]

VERDICTS = MappingProxyType(
    {
        "diverged": "diverged at {time} s: the estimate grew beyond all bounds, or P is no longer positive definite; "
        "choose a larger P or shorter steps, and look at conditions()",
        "followed": "followed {time} s; no truth to compare with",
        "outside": "not converged: the error went from {first} to {last} in {time} s",
        "converged": "converged: the error stays within {tolerance} after {time} s",
    }
)
"""What may be said of a run."""


@dataclass(frozen=True, eq=False)
class PointsRun:
    """Estimates of a state at the samples of a recording.

    Parameters
    ----------
    recording : PointsRecording
    observer : LuenbergerObserver
    state : array of shape (K, n)
        Estimates; NaN from `diverged_at` on.
    began : array of shape (K, p) of bool
        Where a point was given a start.
    kept : integer array of shape (T,)
        Samples at which P was kept.
    P : array of shape (T, n, n)
        P at these samples.
    diverged_at : float or None
        When the estimate stopped being finite, in seconds.
    hold : "zero", "first" or "exact"
        How samples were held between them.
    """

    recording: PointsRecording
    observer: LuenbergerObserver
    state: Array
    began: NDArray[np.bool_]
    kept: NDArray[np.intp]
    P: Array
    diverged_at: float | None
    hold: Hold

    @property
    def time(self) -> Array:
        """Times of the samples in seconds, shape (K,)."""
        return self.recording.time

    @property
    def truth(self) -> Array:
        """True states, shape (K, n).

        Raises
        ------
        ValueError
            If the recording has none, or of a state of another size.
        """
        truth = self.recording.truth
        if truth is None:
            raise ValueError("the recording has no truth to compare with; give it one, or look at the innovation")
        if truth.shape[1] != self.observer.form.states:
            raise ValueError(
                f"the observer believes in {self.observer.form.states} states, the truth has {truth.shape[1]}; compare "
                "the points"
            )
        return truth

    @cached_property
    def error(self) -> Array:
        """rho, truth minus estimate, shape (K, n)."""
        return self.truth - self.state

    @cached_property
    def size(self) -> Array:
        """Norm of the error, shape (K,)."""
        return np.asarray(np.linalg.norm(self.error, axis=1))

    @cached_property
    def points(self) -> Array:
        """Estimated points in metres, shape (K, p, 3)."""
        return self.observer.form.positions(self.state)

    @cached_property
    def distance(self) -> Array:
        """Estimated depths of the points in metres, shape (K, p); not positive behind the camera."""
        return self.observer.form.distances(self.state)

    @cached_property
    def innovation(self) -> Array:
        """Images minus those of the estimate, shape (K, p, m); NaN where either is not in sight."""
        return self.recording.outputs - self.observer.form.images(self.state)

    def decay_rate(self, begin: float = -math.inf, end: float = math.inf) -> float:
        """Rate of the exponential fitted to the error's norm between two times, in 1/s; positive where it shrinks.

        Raises
        ------
        ValueError
            If fewer than two samples lie between the times, or the error is not finite and positive there.
        """
        part = (self.time >= begin) & (self.time <= end)
        size = self.size[part]
        if part.sum() < 2 or not (np.isfinite(size) & (size > 0)).all():
            raise ValueError(
                f"between {begin} and {end} s there are {part.sum()} samples, with errors from "
                f"{size.min(initial=0):.3g} to {size.max(initial=0):.3g}; an exponential needs two finite positive ones"
            )
        return float(-np.polyfit(self.time[part], np.log(size), 1)[0])

    def depth_errors(self, after: float, absence: float, points: Sequence[int], reference: str = "truth") -> Array:
        """Relative errors of the depth, a given time after points came into sight.

        Parameters
        ----------
        after : float
            Seconds since the beginning of a sighting; the first sample from then on counts.
        absence : float
            Seconds without a sample after which it is another sighting.
        points : sequence of int
            Whose sightings count.
        reference : str
            "truth", or the name of a measured distance of the recording.

        Returns
        -------
        array of shape (number of sightings that last as long,)
            |estimate - reference| / reference; infinite where the estimate is behind the camera.

        Raises
        ------
        ValueError
            If the recording has no such reference.
        """
        recording = self.recording
        if reference != "truth" and reference not in recording.distances:
            known = ", ".join(["truth", *recording.distances])
            raise ValueError(f"the recording has no distance {reference!r}; it has {known}")
        depths = recording.depths if reference == "truth" else recording.distances[reference]
        errors = []
        for sighting in recording.sightings(absence):
            samples = np.flatnonzero(recording.seen[: sighting.last + 1, sighting.point])
            since = self.time[samples] - self.time[sighting.first]
            later = samples[since >= after - 1e-9]
            if sighting.point in points and len(later):
                estimate, depth = self.distance[later[0], sighting.point], depths[later[0], sighting.point]
                errors.append(abs(estimate / depth - 1) if estimate > 0 else math.inf)
        return np.array(errors)

    def conditions(self, epsilon: float = 1.0) -> Conditions:
        """The inequality (15) and the weaker sufficient one along the run, apart.

        Parameters
        ----------
        epsilon : float
            Of the weaker one, A^T P + P A + P' <= (2 - epsilon) S, above 0 and at most 2.

        Raises
        ------
        ValueError
            If epsilon is out of its range.
        """
        return conditions(self.observer, self.time[self.kept], self.recording.outputs[self.kept], self.P, epsilon)

    def verdict(self, tolerance: float = 0.05) -> str:
        """What happened, in words."""
        if self.diverged_at is not None:
            return VERDICTS["diverged"].format(time=f"{self.diverged_at:.3g}")
        seconds = f"{self.time[-1] - self.time[0]:.3g}"
        if self.recording.truth is None:
            return VERDICTS["followed"].format(time=seconds)
        first, last = (f"{size:.2g}" for size in self.size[[0, -1]])
        outside = np.flatnonzero(~(self.size < tolerance))
        if len(outside) and outside[-1] == len(self.size) - 1:
            return VERDICTS["outside"].format(first=first, last=last, time=seconds)
        settled = self.time[outside[-1] + 1] - self.time[0] if len(outside) else 0.0
        return VERDICTS["converged"].format(tolerance=f"{tolerance:g}", time=f"{settled:.3g}")

    def __repr__(self) -> str:
        return f"<Run of {self.observer.name} on {self.recording.source}: {self.verdict()}>"
