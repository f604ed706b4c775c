"""Trust in an estimate at several times of a run, by what was known then and without a truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from percept_obs.compile import Array, Flags
from percept_obs.system.surfaces import ImagingSurface
from percept_obs.tracking.information import FEWEST, Information
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import TOLERANCE, Trust
from percept_obs.validation import checked


@checked
@dataclass(frozen=True, eq=False, repr=False)
class TrustOverTime:
    """Trust in an estimate at some times.

    Parameters
    ----------
    run : Run
    tolerance : float
        Relative error up to which an estimate is to be trusted.
    index : array of shape (T,) of int
        Indices of the samples at which it was judged.
    trusts : tuple of T Trust
        Each by the samples up to then.

    See Also
    --------
    trust_over_time : Computes it.
    percept_obs.figures.trust : Draws it.

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, ibo, pinhole, record, scenarios, track
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> run = track(record(scenarios.ma2005_eq35(), 6, Camera(0.02, Gaussian(0.003)), seed=1), ibo(form))
    >>> trust_over_time(run, count=4).distance.round(1).tolist()
    [3.1, 4.2, 4.7, 3.9]
    """

    run: Run
    tolerance: float
    index: Array
    trusts: tuple[Trust, ...]

    @property
    def time(self) -> Array:
        """Seconds since the first sample, shape (T,)."""
        return np.asarray(self.run.elapsed[self.index])

    @property
    def trusted(self) -> Flags:
        """True where the estimate could be trusted, shape (T,)."""
        return np.array([trust.trusted for trust in self.trusts])

    @property
    def unexcited(self) -> Array:
        """Seconds at the end without information about the distance, shape (T,)."""
        return self._each(lambda information: information.unexcited, 0.0)

    @property
    def deviation(self) -> Array:
        """Relative standard deviation of the distance by the samples alone, shape (T,); infinite without any."""
        return self._each(lambda information: information.deviation, np.inf)

    @property
    def distance(self) -> Array:
        """Distance in metres by the samples alone, shape (T,); NaN where they give none."""
        inverse = self._each(lambda information: float(self.run.view.inverse(information.estimate)), np.nan)
        return 1 / np.where(self.deviation < 1, inverse, np.nan)

    def _each(self, value: Callable[[Information], float], none: float) -> Array:
        return np.array([none if each.information is None else value(each.information) for each in self.trusts])

    @property
    def sentence(self) -> str:
        """Share of times at which it could be trusted, and the verdict at the end."""
        share = f"{100 * self.trusted.mean():.0f} % of {len(self.trusts)} times"
        return (
            f"Trusted at {share}, hardly excited at {int(self.unexcited.sum())}. At the end: {self.trusts[-1].sentence}"
        )

    def __repr__(self) -> str:
        return f"<TrustOverTime of the {self.run.observer.name} observer: {self.sentence}>"


@checked
def trust_over_time(run: Run, tolerance: float = TOLERANCE, count: int = 24) -> TrustOverTime:
    """Return `Run.trust` at several times, each time with the samples up to then only.

    Parameters
    ----------
    run : Run
        Of one point.
    tolerance : float
        Relative, as for `Run.trust`.
    count : int
        Number of times, evenly spread from the first at which there are enough samples to the end.

    Raises
    ------
    ValueError
        If the run shows several points or has too few samples, or a number is out of range.

    See Also
    --------
    percept_obs.figures.trust : draws it over time

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, ibo, pinhole, record, scenarios, track
    >>> from percept_obs.studies.trust import trust_over_time
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> run = track(record(scenarios.ma2005_eq35(), 6, Camera(0.02, Gaussian(0.003)), seed=1), ibo(form))
    >>> trust_over_time(run, count=4).trusted.tolist()
    [False, True, True, True]
    """
    if not isinstance(run.view, ImagingSurface):
        raise ValueError(f"this needs a run of one point on an imaging surface, but it shows the {run.view.name}")
    length = len(run.time)
    if length < 2 * FEWEST:
        raise ValueError(f"the run has {length} samples; {2 * FEWEST} are needed to say how far it can be trusted")
    if not 1 <= count <= length:
        raise ValueError(f"count is {count}; from 1 to the {length} samples of the run make sense")
    index = np.unique(np.linspace(length - 1, FEWEST, count).astype(int))
    return TrustOverTime(run, tolerance, index, tuple(_until(run, int(k)).trust(tolerance) for k in index))


def _until(run: Run, last: int) -> Run:
    """The run as it was at one of its samples."""
    end = last + 1
    return replace(
        run,
        recording=run.recording.between(run.time[0], run.time[last]),
        estimate=run.estimate[:end],
        state=run.state[:end],
        resets=run.resets[run.resets <= run.time[last]],
        unobservable=run.unobservable[:end],
    )
