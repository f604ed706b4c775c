"""Efficiency of observers: the root mean square of their errors over the least standard deviation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from percept_obs.compile import Array, Flags
from percept_obs.observability.bound import Bound
from percept_obs.tracking.run import Run
from percept_obs.validation import checked, numbers, once, positive


@checked
@dataclass(frozen=True, eq=False)
class Efficiency:
    """Errors of several runs against the bound, for one coordinate, from `efficiency`.

    Parameters
    ----------
    time : array of shape (K,)
        Seconds since the first sample.
    errors : array of shape (N, K)
        Errors of N runs, in the coordinate's unit.
    bound : array of shape (K,)
        Least standard deviation, in the errors' unit.

    Raises
    ------
    ValueError
        If an argument is of another kind or shape, or the bound is not positive.

    See Also
    --------
    Bound : What the errors are compared with.

    Examples
    --------
    >>> import numpy as np
    >>> from percept_obs import Efficiency
    >>> time, bound = np.array([0.0, 1.0]), np.array([0.2, 0.1])
    >>> found = Efficiency(time, np.array([[0.3, 0.1], [-0.3, 0.2]]), bound)
    >>> found.ratio.round(2).tolist()
    [1.5, 1.58]
    """

    time: Array
    errors: Array
    bound: Array

    def __post_init__(self) -> None:
        numbers(self.errors, "the errors", "N", len(self.time))
        positive(bound=numbers(self.bound, "values of bound", len(self.time)).min())

    @property
    def rms(self) -> Array:
        """Root mean square of the errors over the runs, shape (K,)."""
        return np.asarray(np.sqrt(np.mean(self.errors**2, axis=0)))

    @property
    def ratio(self) -> Array:
        """Root mean square error over the bound, shape (K,): 1 for an observer that uses all information."""
        return self.rms / self.bound

    def mean(self, begin: float = -math.inf, end: float = math.inf) -> float:
        """Mean of the ratio over the samples between two times."""
        return float(self.ratio[self._between(begin, end)].mean())

    def scatter(self, begin: float = -math.inf, end: float = math.inf) -> float:
        """Standard deviation of `mean` over sets of as many runs, by the jackknife."""
        inside = self._between(begin, end)
        squares, count = (self.errors[:, inside] / self.bound[inside]) ** 2, len(self.errors)
        # the mean ratio with each run left out in turn
        without = np.sqrt((squares.sum(axis=0) - squares) / (count - 1)).mean(axis=1)
        return float(math.sqrt((count - 1) * np.mean((without - without.mean()) ** 2)))

    def _between(self, begin: float, end: float) -> Flags:
        """Samples between two times, shape (K,)."""
        inside = (self.time >= begin) & (self.time <= end)
        if not inside.any():
            raise ValueError(f"no sample lies between {begin} and {end} s after the first one")
        return np.asarray(inside)

    def __repr__(self) -> str:
        return f"<Efficiency of {len(self.errors)} runs: {self.mean():.3g} +- {self.scatter():.1g} bounds>"


@checked
def efficiency(runs: Sequence[Run], bound: Bound) -> Efficiency:
    """Root mean square error of the inverse distance over the bound: 1 at best, for observers without bias.

    Parameters
    ----------
    runs : sequence of Run
        Two or more on the same truth, each with noise and start of its own, drawn as the bound supposes.
    bound : Bound
        From `cramer_rao`, on a recording of the same truth and samples.

    Returns
    -------
    Efficiency
        Its `mean` is the ratio over a span of time.

    Raises
    ------
    ValueError
        If there are fewer than two runs, one stands twice, observers differ, or truth or outputs are not the bound's.

    See Also
    --------
    cramer_rao : The bound.

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, cramer_rao, efficiency, ekf, pinhole
    >>> from percept_obs import record, scenarios, track
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> seen = [record(scenarios.ma2005_eq35(), 10, Camera(0.05, Gaussian(0.01)), seed) for seed in range(20)]
    >>> runs = [track(each, ekf(form, noise_variance=1e-4), {"y3": 0.4}) for each in seen]
    >>> 0.8 < efficiency(runs, cramer_rao(seen[0], form)).mean(5, 10) < 1.3
    True
    """
    truth = bound.recording.truth
    once(runs=runs)
    if len(runs) < 2:
        raise ValueError(f"{len(runs)} runs tell no mean square; give two or more, with noise of their own")
    for number, run in enumerate(runs, 1):
        own = run.recording.truth
        if own is None or truth is None or own.shape != truth.shape or not np.allclose(own, truth):
            raise ValueError(f"run {number} is on another truth than the bound; both must follow the same point")
        if run.measured != bound.form.measured or run.observer.name != runs[0].observer.name:
            raise ValueError(
                f"run {number} is of the {run.observer.name} observer on {', '.join(run.measured)}; give runs of one "
                f"observer on the bound's {', '.join(bound.form.measured)}"
            )
    return Efficiency(bound.elapsed, np.array([run.error[:, -1] for run in runs]), bound.deviation[:, -1])
