"""Gains of an observer, chosen by its errors where there is a truth, or by the likelihood of a filter's innovations."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from percept_obs.compile import Array
from percept_obs.observers.base import Observer
from percept_obs.recording import Recording
from percept_obs.studies.comparison import Follow, relative_distance_errors
from percept_obs.system.signal import from_the_start
from percept_obs.tracking.following import AnyObserver, StepTooLong
from percept_obs.tracking.run import Run
from percept_obs.validation import bar, checked, of_kind, once

__all__ = ["Tuned", "best_setting", "tune_by_likelihood"]

EDGE = 0.02
"""Share of a range, in powers of ten, within which a gain counts as being at its end."""

MOST = 80
"""Largest number of settings that are tried from each start."""

STARTS = (0.5, 0.25, 0.75)
"""Shares of the ranges, in powers of ten, from which the largest likelihood is looked for."""

NEEDED = 1.92
"""Fall of the log-likelihood from which on a gain is not 0: half the 95 % quantile of chi-squared with one degree."""


@checked
def best_setting(
    recordings: Sequence[Recording],
    observers: Iterable[AnyObserver],
    follow: Follow,
    after: Sequence[float] = (2.0,),
    reference: str = "truth",
) -> Observer:
    """Return the observer with the least median relative distance error, summed over the given times.

    Choose on some recordings and report on others: errors on the recordings that were chosen on are too small.

    Parameters
    ----------
    recordings : sequence of Recording
        With a truth or the reference; those that end too early do not count.
    observers : iterable of Observer
        One structure with different gains, or several structures.
    follow : function of (recording, observer)
        Runs an observer, for instance ``lambda r, o: track(r, o, start)``; it is given recordings as far as `after`.
    after : sequence of float
        Seconds since the first sample.
    reference : str
        "truth", or the name of a measured distance of the recordings.

    Raises
    ------
    ValueError
        If recordings, observers or times are none or recur, no recording lasts as long, or another observer is run.

    See Also
    --------
    tune_by_likelihood : chooses a filter's gains without a truth
    percept_obs.studies.all_observers.all_observers : chooses the gains of every observer and reports its errors

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios, track
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> seen, settings = [record(scenarios.ma2005_eq35(), 3)], [ibo(form, gain=gain) for gain in (2, 10)]
    >>> best_setting(seen, settings, lambda recording, observer: track(recording, observer)) is settings[1]
    True
    """
    once(recordings=recordings)
    candidates = list(observers)
    if not (len(recordings) and candidates and len(after)):
        raise ValueError(
            f"{len(recordings)} recordings, {len(candidates)} observers and {len(after)} times: at least one of "
            "each is needed to choose the best"
        )

    parts = [_as_far_as(each, max(after)) for each in recordings]

    def score(observer: Observer) -> float:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", StepTooLong)  # a chattering candidate has large errors, so it is not chosen
            runs = _followed(parts, observer, follow)
        total = float(sum(np.median(relative_distance_errors(runs, seconds, reference)) for seconds in after))
        return math.inf if math.isnan(total) else total  # a run that diverged is never the best

    return candidates[int(np.argmin([score(each) for each in bar(candidates, "candidates")]))]


def _as_far_as(recording: Recording, seconds: float) -> Recording:
    """Part of a recording as far as errors are looked at, up to a sample so many seconds after the first one."""
    late = recording.time[1:][from_the_start(recording.elapsed[1:], seconds)]
    return recording.between(float(recording.time[0]), float(late[0])) if len(late) else recording


def _followed(recordings: Sequence[Recording], observer: AnyObserver, follow: Follow) -> list[Run]:
    """Runs of an observer; raise ValueError if they are of another one."""
    runs = [follow(recording, observer) for recording in recordings]
    for run in runs:
        of_kind("follow", "its result", run, Run)
    chosen = {gain.name: gain.value for gain in getattr(observer, "gains", ()) if gain.given}
    if chosen and any(chosen.items() - {(gain.name, gain.value) for gain in run.observer.gains} for run in runs):
        raise ValueError("follow runs another observer than it is given; make it track(recording, observer)")
    return runs


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Tuned:
    """Filter whose gains were chosen by the likelihood of its innovations.

    Parameters
    ----------
    observer : Observer
        With the chosen gains.
    gains : mapping of names to values
        The chosen gains.
    at_edge : tuple of str
        Names of gains at an end of their range, beyond which better ones may lie.
    log_likelihood : float
        Of all innovations of the recordings.

    See Also
    --------
    tune_by_likelihood : Makes it.

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, ekf, pinhole, record, scenarios, track
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> seen = record(scenarios.ma2005_eq35(), 4, Camera(0.05, Gaussian(0.01)), seed=1)
    >>> tune_by_likelihood([seen], ekf(form), {"noise_variance": (1e-6, 1e-5)}, lambda r, o: track(r, o)).at_edge
    ('noise_variance',)
    """

    observer: Observer
    gains: Mapping[str, float]
    at_edge: tuple[str, ...]
    log_likelihood: float

    def __repr__(self) -> str:
        gains = ", ".join(f"{name} {value:.3g}" for name, value in self.gains.items())
        edge = f"; at the edge of what was tried: {', '.join(self.at_edge)}" if self.at_edge else ""
        return f"<Tuned {self.observer.name}: {gains}, log-likelihood {self.log_likelihood:.5g}{edge}>"


@checked
def tune_by_likelihood(
    recordings: Sequence[Recording],
    observer: Observer,
    ranges: Mapping[str, Sequence[float]],
    follow: Follow,
) -> Tuned:
    """Return a filter with gains of maximum likelihood of its innovations; no truth is needed.

    A small claimed variance makes a large innovation unlikely, and a large one makes every innovation unlikely.  A gain
    that may be 0, such as a process noise, is 0 if the innovations do not clearly speak against it.  Choose on some
    recordings and report on others.

    Parameters
    ----------
    recordings : sequence of Recording
    observer : Observer
        That claims a covariance and has a measurement update, such as the extended Kalman filter.
    ranges : mapping of names of gains to pairs of their smallest and largest values
        Positive; powers of ten between them are searched, from the middle and from two other places.
    follow : function of (recording, observer)
        Runs an observer, for instance ``lambda r, o: track(r, o, start)``.

    Raises
    ------
    ValueError
        If recordings or gains are none or recur, a range is not positive, follow runs another observer, or all diverge.

    See Also
    --------
    best_setting : chooses by the errors, where there is a truth

    Notes
    -----
    Mehra, On the identification of variances and adaptive Kalman filtering, IEEE Trans. Automatic Control 15(2), 1970.

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, ekf, pinhole, record, scenarios, track
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> seen = [record(scenarios.ma2005_eq35(), 4, Camera(0.05, Gaussian(0.01)), seed=1)]
    >>> found = tune_by_likelihood(seen, ekf(form), {"noise_variance": (1e-6, 1e-2)}, lambda r, o: track(r, o))
    >>> 0.7e-4 < found.gains["noise_variance"] < 1.4e-4
    True
    """
    from scipy.optimize import minimize

    once(recordings=recordings)
    if not len(recordings) or not ranges:
        raise ValueError(f"{len(recordings)} recordings and {len(ranges)} gains: at least one of each is needed")
    for name, ends in ranges.items():
        if len(ends) != 2 or not 0 < ends[0] < ends[1] < math.inf:
            raise ValueError(f"the range of {name} is {tuple(ends)}; give a smallest and a largest positive value")
    names = tuple(ranges)
    low, high = np.log10(np.array([ranges[name] for name in names], dtype=float)).T

    @cache
    def unlikely(place: tuple[float, ...], zero: tuple[str, ...] = ()) -> float:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", StepTooLong)  # what chatters is not chosen
            filtered = observer.with_gains(**gains_at(place, zero))
            runs = _followed(recordings, filtered, follow)
        if any(run.diverged_at is not None for run in runs):
            return math.inf
        return -float(sum(np.nansum(run.log_likelihood) for run in runs))

    def gains_at(place: tuple[float, ...], zero: tuple[str, ...] = ()) -> dict[str, float]:
        return dict(zip(names, (10.0 ** np.array(place)).tolist(), strict=True)) | dict.fromkeys(zero, 0.0)

    tried = set()

    def objective(place: Array) -> float:
        inside = tuple(np.clip(place, low, high).tolist())
        tried.add(inside)
        return unlikely(inside)

    for share in bar(STARTS, "tuning by likelihood"):
        start = low + share * (high - low)
        corners = np.vstack([start, start + np.diag(np.where(share < 0.6, 0.2, -0.2) * (high - low))])
        options = {"initial_simplex": corners, "maxfev": MOST, "xatol": 0.02, "fatol": 0.05}
        minimize(objective, start, method="Nelder-Mead", options=options)
    best = min(tried, key=unlikely)
    if not math.isfinite(unlikely(best)):
        raise ValueError(f"the {observer.name} observer diverged with every setting in the ranges; try others")
    zero: tuple[str, ...] = ()
    for gain in observer.gains:
        may_be_zero = gain.name in names and gain.condition.subs(gain.symbol, 0)
        if may_be_zero and unlikely(best, (*zero, gain.name)) < unlikely(best, zero) + NEEDED:
            zero = (*zero, gain.name)
    gains, near = gains_at(best, zero), np.minimum(best - low, high - best) <= EDGE * (high - low)
    at_edge = tuple(name for name, is_near in zip(names, near.tolist(), strict=True) if is_near and gains[name])
    return Tuned(observer.with_gains(**gains), gains, at_edge, -unlikely(best, zero))
