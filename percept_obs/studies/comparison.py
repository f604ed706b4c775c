"""Comparing observers on the same recordings: a tidy table, its summary, distance errors, and the best setting."""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from percept_obs.compile import choose
from percept_obs.observers.base import Observer
from percept_obs.recording import Recording
from percept_obs.system.signal import from_the_start, slack_of
from percept_obs.tracking.following import StepTooLong, track
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import TOLERANCE
from percept_obs.validation import bar, checked

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]


MEASURES = ("settling_time", "final", "rms", "worst", "cost")
"""Columns of `compare` of which a summary has the median and quantiles."""


@checked
def compare(
    recordings: Sequence[Recording],
    observers: Mapping[str, Observer] | Sequence[Observer],
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
        outcome (a kind of `Outcome`), settling_time (s, infinite if it has not converged), final, rms, worst (after the
        given time), resets, diverged_at (s since the first sample, infinite if it does not), cost (s of computing for
        a s of data).

    Raises
    ------
    ValueError
        If there are no recordings or no observers, a recording has no truth, or an observer does not fit.
    """
    import pandas as pd

    if not isinstance(observers, Mapping):
        names = [observer.name for observer in observers]
        if len(set(names)) != len(names):
            raise ValueError(f"observers have the same name ({', '.join(names)}); pass a mapping of labels to them")
        observers = dict(zip(names, observers, strict=True))
    if not len(recordings) or not observers:
        raise ValueError(f"{len(recordings)} recordings and {len(observers)} observers: at least one of each is needed")
    language = choose(None, sum(len(recording.time) for recording in recordings))
    settings = {"language": language} | settings
    follow = {name: partial(track, observer=each, start=start, **settings) for name, each in observers.items()}
    brief = recordings[0].between(*recordings[0].time[:2].tolist())
    for run in bar(follow.values(), "compiling"):
        run(brief)  # so that compiling is no part of the cost
    rows = []
    for recording, label in bar([*product(recordings, follow)], "runs"):
        (run,), cost = timed(follow[label], [recording])
        surface, found = recording.imaging_surface, run.outcome(tolerance, *coordinates)
        error = np.abs(surface.inverse(run.error))
        late = error[from_the_start(run.elapsed, after)]
        if not len(late):
            raise ValueError(f"no sample of {recording.source!r} lies {after} s or more after its first one")
        rows.append(
            {
                "observer": label,
                "recording": recording.source,
                "outcome": found.kind,
                "settling_time": found.settled if found.converged else math.inf,
                "final": _known(error[-1]),
                "rms": _known(math.sqrt(np.mean(late**2))),
                "worst": _known(late.max()),
                "resets": len(run.resets),
                "diverged_at": math.inf if run.diverged_at is None else run.diverged_at - float(run.time[0]),
                "cost": cost,
            }
        )
    return pd.DataFrame(rows)


@checked
def summary(table: pd.DataFrame) -> pd.DataFrame:
    """What `compare` found, an observer a row.

    Parameters
    ----------
    table : pandas.DataFrame
        From `compare`.

    Returns
    -------
    pandas.DataFrame
        runs; failed (not converged), reset (runs with a reset), diverged; and for
        settling_time, final, rms, worst, cost the median with the 16 % and 84 % quantiles (columns name, name_low,
        name_high).
    """
    import pandas as pd

    observers = table.groupby("observer", sort=False)
    found = {
        "runs": observers.size(),
        "failed": observers["settling_time"].agg(lambda times: np.isinf(times).sum()),
        "reset": observers["resets"].agg(lambda counts: (counts > 0).sum()),
        "diverged": observers["diverged_at"].agg(lambda times: np.isfinite(times).sum()),
    }
    for column, (end, share) in product(MEASURES, (("", 0.5), ("_low", 0.16), ("_high", 0.84))):
        # by rank, for infinite values have no mean
        found[column + end] = observers[column].agg(np.quantile, share, method="nearest")
    return pd.DataFrame(found).rename_axis(None)


@checked
def described(found: pd.DataFrame) -> str:
    """A summary as text: counts, and medians with their quantiles."""
    import pandas as pd

    columns = {name: found[name].map("{:.0f}".format) for name in ("runs", "failed", "reset", "diverged")}
    for name in MEASURES[:-1]:
        ends = zip(found[name], found[name + "_low"], found[name + "_high"], strict=True)
        columns[name] = [f"{median:.2g} ({low:.2g} to {high:.2g})" for median, low, high in ends]
    columns["cost"] = (1e6 * found["cost"]).map("{:.0f} us/s".format)
    return str(pd.DataFrame(columns).to_string())


def _known(value: float) -> float:
    """An error, infinite where a diverged run has none."""
    return float(value) if math.isfinite(value) else math.inf


def timed(follow: Callable[[Recording], Run], recordings: Sequence[Recording]) -> tuple[list[Run], float]:
    """Runs on recordings, and how many seconds of computing a second of data takes."""
    begin = time.perf_counter()
    runs = [follow(recording) for recording in recordings]
    taken = time.perf_counter() - begin
    return runs, taken / sum(float(recording.time[-1] - recording.time[0]) for recording in recordings)


@checked
def relative_distance_errors(
    runs: Iterable[Run],
    after: float,
    reference: str = "truth",
    absence: float = math.inf,
    points: Container[int] | None = None,
) -> Array:
    """Relative errors of the estimated distance, a given time after points came into sight.

    Parameters
    ----------
    runs : iterable of Run
        Of one point or of several, on recordings with a truth or with measured distances.
    after : float
        Seconds since the first sample of a sighting; the first sample from then on whose reference is known counts.
    reference : str
        "truth", or the name of a measured distance of the recordings, such as "stereo".
    absence : float
        Seconds without a sample after which it is another sighting.
    points : container of int, optional
        Whose sightings count, if there are several; all of them when left out.

    Returns
    -------
    array of shape (number of sightings that last as long,)
        |estimate - reference| / reference; infinite where the estimate is not in front of the camera, NaN
        where there is none.

    Raises
    ------
    ValueError
        If the time is negative, no sighting lasts as long, or a recording has no such reference.
    """
    if not after >= 0:
        raise ValueError(f"after is {after} s; it must not be negative")
    errors: list[float] = []
    sources: list[str] = []
    for run in runs:
        sources.append(repr(run.recording.source))
        recording = run.recording
        shape = (len(recording.time), -1)
        there = set(range(recording.seen[0].size))
        asked = set(points) if isinstance(points, Iterable) else there
        if not asked <= there:
            raise ValueError(f"the points {sorted(asked - there)} are not there; there are 0 to {max(there)}")
        known, seen = recording.reference(reference).reshape(shape), recording.seen.reshape(shape)
        for sighting in recording.sightings(absence):
            samples = np.flatnonzero((seen & np.isfinite(known))[: sighting.last + 1, sighting.point])
            later = samples[run.time[samples] - run.time[sighting.first] >= after - slack_of(run.time)]
            if len(later) and (points is None or sighting.point in points):
                place = (later[0], sighting.point)
                errors.append(abs(run.distance.reshape(shape)[place] / known[place] - 1))
    if not errors:
        raise ValueError(f"no sighting in the recording {' or '.join(sources)} lasts {after} s; after must be shorter")
    return np.array(errors)


@checked
def best_setting(
    recordings: Sequence[Recording],
    observers: Iterable[Observer],
    follow: Callable[[Recording, Observer], Run],
    after: Sequence[float] = (2.0,),
    reference: str = "truth",
) -> Observer:
    """The observer whose median relative distance error is least, added up over the given times.

    Choose on some recordings and report on others, or the report flatters.

    Parameters
    ----------
    recordings : sequence of Recording
        With a truth or the reference; those that end too early do not count.
    observers : iterable of Observer
        One structure with different gains, or several structures.
    follow : function of (recording, observer)
        How an observer is run, for instance ``lambda r, o: track(r, o, start)``.
    after : sequence of float
        Seconds since the first sample.
    reference : str
        "truth", or the name of a measured distance of the recordings.

    Raises
    ------
    ValueError
        If there are no recordings, observers or times, or no recording lasts as long.
    """
    candidates = list(observers)
    if not (len(recordings) and candidates and len(after)):
        raise ValueError(
            f"{len(recordings)} recordings, {len(candidates)} observers and {len(after)} times: at least one of "
            "each is needed to choose the best"
        )

    def score(observer: Observer) -> float:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", StepTooLong)  # what chatters is not chosen
            runs = [follow(recording, observer) for recording in recordings]
        total = float(sum(np.median(relative_distance_errors(runs, seconds, reference)) for seconds in after))
        return math.inf if math.isnan(total) else total  # a run that diverged is never the best

    return min(candidates, key=score)
