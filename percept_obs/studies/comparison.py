"""Comparison of observers on the same recordings: a table of runs, its summary, distance errors, the best setting."""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from percept_obs.compile import Array, choose
from percept_obs.observers.base import Observer
from percept_obs.recording import Recording
from percept_obs.system.signal import from_the_start, slack_of
from percept_obs.tracking.following import AnyObserver, StepTooLong, track
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import TOLERANCE
from percept_obs.validation import bar, checked, load_pandas

__all__ = ["best_setting", "compare", "relative_distance_errors", "summary"]

if TYPE_CHECKING:
    import pandas as pd

Follow = Callable[[Recording, Observer], Run]
"""Function that runs an observer on a recording, such as ``lambda r, o: track(r, o, start)``."""

MEASURES = ("settling_time", "final", "rms", "worst", "cost")
"""Columns of `compare` of which `summary` has the median and quantiles."""


@checked
def compare(
    recordings: Sequence[Recording],
    observers: Mapping[str, AnyObserver] | Sequence[AnyObserver],
    start: Mapping[str, float] | Sequence[float] | None = None,
    tolerance: float = TOLERANCE,
    after: float = 0.0,
    coordinates: Sequence[str] = (),
    **settings: Any,
) -> pd.DataFrame:
    """Run every observer on every recording, so that all see the same noise.

    Parameters
    ----------
    recordings : sequence of Recording
        With a truth.
    observers : mapping of labels to Observer, or sequence of Observer
        A sequence is labelled with the observers' names.
    start : see `track`
    tolerance : float
        Bound on the relative error of the distance, or on the absolute errors of the `coordinates`; see `Run.outcome`.
    after : float
        Seconds since the first sample from which on errors count for their root mean square and their largest value.
    coordinates : sequence of str, optional
        Such as ("y3",), whose absolute errors are to stay within the tolerance instead.
    **settings
        Passed to `track`, such as ``hold`` and ``believed``.

    Returns
    -------
    pandas.DataFrame
        One row for a recording and an observer, with errors of the inverse distance in 1/m: observer, recording,
        outcome (a kind of `Outcome`), settling_time (s, infinite if it has not converged), final, rms and worst (from
        `after` on), resets, diverged_at (s since the first sample, infinite if it does not), cost (seconds of computing
        for a second of data).

    Raises
    ------
    ValueError
        If there are no recordings or no observers, a recording has no truth, or an observer does not fit.

    See Also
    --------
    summary : medians and quantiles of the table
    percept_obs.ensemble : many runs of one observer

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ekf, ibo, pinhole, record, scenarios
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> table = compare([record(scenarios.ma2005_eq35(), 5)], [ibo(form), ekf(form)])
    >>> summary(table)["failed"].tolist()
    [0, 0]
    """
    pd = load_pandas()
    if not isinstance(observers, Mapping):
        names = [observer.name for observer in observers]
        if len(set(names)) != len(names):
            raise ValueError(f"observers have the same name ({', '.join(names)}); pass a mapping of labels to them")
        observers = dict(zip(names, observers, strict=True))
    if not len(recordings) or not observers:
        raise ValueError(f"{len(recordings)} recordings and {len(observers)} observers: at least one of each is needed")
    settings = {"language": choose(None, sum(len(recording.time) for recording in recordings))} | settings
    follow = {label: partial(track, observer=each, start=start, **settings) for label, each in observers.items()}
    brief = recordings[0].between(*recordings[0].time[:2].tolist())
    for run in bar(follow.values(), "compiling"):
        run(brief)  # so that the cost is without compiling
    rows = []
    for recording, label in bar([*product(recordings, follow)], "runs"):
        run, cost = timed(follow[label], recording)
        outcome = run.outcome(tolerance, *coordinates)
        error = np.abs(recording.imaging_surface.inverse(run.error))
        late = error[from_the_start(run.elapsed, after)]
        if not len(late):
            raise ValueError(f"no sample of {recording.source!r} lies {after} s or more after its first one")
        rows.append(
            {
                "observer": label,
                "recording": recording.source,
                "outcome": outcome.kind,
                "settling_time": outcome.settled if outcome.converged else math.inf,
                "final": error[-1],
                "rms": math.sqrt(np.mean(late**2)),
                "worst": late.max(),
                "resets": len(run.resets),
                "diverged_at": math.inf if run.diverged_at is None else run.diverged_at - float(run.time[0]),
                "cost": cost,
            }
        )
    # a run that diverged has no error
    return pd.DataFrame(rows).fillna({"final": math.inf, "rms": math.inf, "worst": math.inf})


@checked
def summary(table: pd.DataFrame) -> pd.DataFrame:
    """Summarise a comparison, one row an observer.

    Parameters
    ----------
    table : pandas.DataFrame
        From `compare`.

    Returns
    -------
    pandas.DataFrame
        runs; failed (not converged), reset (runs with a reset), diverged; and for settling_time, final, rms, worst and
        cost the median with the 16 % and 84 % quantiles (columns name, name_low, name_high).

    Raises
    ------
    ValueError
        If the table lacks columns of `compare`.

    See Also
    --------
    compare : Makes the table.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> table = compare([record(make(), 5) for make in (scenarios.ma2005_eq35, scenarios.planar)], [ibo(form)])
    >>> summary(table)[["runs", "failed", "diverged"]].values.tolist()
    [[2, 0, 0]]
    """
    pd = load_pandas()
    if missing := sorted({"observer", "settling_time", "resets", "diverged_at", *MEASURES} - set(table)):
        raise ValueError(f"the table has no columns {', '.join(missing)}; give one from compare()")
    observers = table.groupby("observer", sort=False)
    counts = {
        "failed": np.isinf(table["settling_time"]),
        "reset": table["resets"] > 0,
        "diverged": np.isfinite(table["diverged_at"]),
    }
    found = {"runs": observers.size()}
    found |= {name: flags.groupby(table["observer"], sort=False).sum() for name, flags in counts.items()}
    for column, (end, share) in product(MEASURES, (("", 0.5), ("_low", 0.16), ("_high", 0.84))):
        # by rank, for infinite values have no mean
        found[column + end] = observers[column].agg(np.quantile, share, method="nearest")
    return pd.DataFrame(found).rename_axis(None)


@checked
def described(found: pd.DataFrame) -> str:
    """Format a `summary` as text: counts, and medians with their quantiles."""
    pd = load_pandas()
    columns = {name: found[name].map("{:.0f}".format) for name in ("runs", "failed", "reset", "diverged")}
    for name in MEASURES[:-1]:
        ends = zip(found[name], found[name + "_low"], found[name + "_high"], strict=True)
        columns[name] = [f"{median:.2g} ({low:.2g} to {high:.2g})" for median, low, high in ends]
    columns["cost"] = (1e6 * found["cost"]).map("{:.0f} us/s".format)
    return str(pd.DataFrame(columns).to_string())


def timed(follow: Callable[[Recording], Run], recording: Recording) -> tuple[Run, float]:
    """Return the run on a recording, and the seconds of computing for a second of data."""
    begin = time.perf_counter()
    run = follow(recording)
    return run, (time.perf_counter() - begin) / float(recording.elapsed[-1])


@checked
def relative_distance_errors(
    runs: Iterable[Run],
    after: float,
    reference: str = "truth",
    absence: float = math.inf,
    points: Collection[int] | None = None,
) -> Array:
    """Return relative errors of the estimated distance, a given time after each point came into sight.

    There is one for each sighting that lasts as long, |estimate - reference| / reference: infinite where the estimate
    is not in front of the camera, NaN where there is none.

    Parameters
    ----------
    runs : iterable of Run
        Of one point or of several, on recordings with a truth or with measured distances.
    after : float
        Seconds since the first sample of a sighting; the first sample from then on whose reference is known counts.
    reference : str
        "truth", or the name of a measured distance of the recordings, such as "stereo".
    absence : float
        Seconds without a sample after which a new sighting begins.
    points : collection of int, optional
        Indices of the points to use; all of them when left out.

    Raises
    ------
    ValueError
        If the time is negative, no sighting lasts as long, or a recording has no such reference or point.

    See Also
    --------
    compare : errors of the inverse distance of several observers, over time

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios, track
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> run = track(record(scenarios.ma2005_eq35(), 5), ibo(form))
    >>> bool(relative_distance_errors([run], after=4)[0] < 0.05)
    True
    """
    if not after >= 0:
        raise ValueError(f"after is {after} s; it must not be negative")
    each = [(run.recording.source, errors_of(run, after, reference, absence, points)) for run in runs]
    errors = [error for _, found in each for error in found]
    if not errors:
        sources = " or ".join(repr(source) for source, _ in each)
        raise ValueError(f"no sighting in the recording {sources} lasts {after} s; after must be shorter")
    return np.array(errors)


def errors_of(
    run: Run, after: float, reference: str, absence: float = math.inf, points: Collection[int] | None = None
) -> list[float]:
    """Return the `relative_distance_errors` of one run, none if no sighting lasts as long."""
    recording, errors = run.recording, []
    shape = (len(recording.time), -1)
    known = range(recording.seen[0].size)
    used = known if points is None else points
    if not set(used) <= set(known):
        raise ValueError(f"there are no points {sorted(set(used) - set(known))}; there are 0 to {max(known)}")
    distance, estimate = (each.reshape(shape) for each in (recording.reference(reference), run.distance))
    seen = recording.seen.reshape(shape) & np.isfinite(distance)
    for sighting in recording.sightings(absence):
        samples = np.flatnonzero(seen[: sighting.last + 1, sighting.point])
        late = samples[run.time[samples] - run.time[sighting.first] >= after - slack_of(run.time)]
        if len(late) and sighting.point in used:
            place = (late[0], sighting.point)
            errors.append(float(abs(estimate[place] / distance[place] - 1)))
    return errors


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
        Runs an observer, for instance ``lambda r, o: track(r, o, start)``.
    after : sequence of float
        Seconds since the first sample.
    reference : str
        "truth", or the name of a measured distance of the recordings.

    Raises
    ------
    ValueError
        If there are no recordings, observers or times, or no recording lasts as long.

    See Also
    --------
    percept_obs.studies.tuning.choose_and_report : chooses the gains of several observers and reports their errors
    percept_obs.studies.likelihood.tune_by_likelihood : chooses a filter's gains without a truth

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios, track
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> seen, settings = [record(scenarios.ma2005_eq35(), 3)], [ibo(form, gain=gain) for gain in (2, 10)]
    >>> best_setting(seen, settings, lambda recording, observer: track(recording, observer)) is settings[1]
    True
    """
    candidates = list(observers)
    if not (len(recordings) and candidates and len(after)):
        raise ValueError(
            f"{len(recordings)} recordings, {len(candidates)} observers and {len(after)} times: at least one of "
            "each is needed to choose the best"
        )

    def score(observer: Observer) -> float:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", StepTooLong)  # a chattering candidate has large errors, so it is not chosen
            runs = [follow(recording, observer) for recording in recordings]
        total = float(sum(np.median(relative_distance_errors(runs, seconds, reference)) for seconds in after))
        return math.inf if math.isnan(total) else total  # a run that diverged is never the best

    return candidates[int(np.argmin([score(each) for each in bar(candidates, "candidates")]))]
