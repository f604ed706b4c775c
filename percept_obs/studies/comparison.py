"""Comparing observers on the same recordings: a tidy table, its summary, distance errors, and the best setting."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from percept_obs.compile import WORTH_COMPILING
from percept_obs.observers.base import Observer
from percept_obs.recording import Recording
from percept_obs.studies.least_squares import WindowEstimate
from percept_obs.tracking.following import track
from percept_obs.tracking.run import Run

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]


def compare(
    recordings: Sequence[Recording],
    observers: Mapping[str, Observer] | Sequence[Observer],
    start: Mapping[str, float] | Sequence[float] | None = None,
    tolerance: float = 0.05,
    after: float = 0.0,
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
        For the settling time of the inverse distance.
    after : float
        Seconds from which on errors count for their root mean square and their largest value.
    **settings
        Passed to `track`, such as ``hold`` and ``believed``.

    Returns
    -------
    pandas.DataFrame
        One row for a recording and an observer, with errors of the inverse distance in 1/m: observer, recording,
        settling_time (s, infinite if it does not settle), final, rms, worst (after the given time), resets,
        diverged_at (s, infinite if it does not), cost (s of computing for a s of data).

    Raises
    ------
    ValueError
        If there are no recordings or no observers, a recording has no truth, or an observer does not fit.
    """
    import pandas as pd
    from tqdm.auto import tqdm

    if not isinstance(observers, Mapping):
        names = [observer.name for observer in observers]
        if len(set(names)) != len(names):
            raise ValueError(f"observers have the same name ({', '.join(names)}); pass a mapping of labels to them")
        observers = dict(zip(names, observers, strict=True))
    if not len(recordings) or not observers:
        raise ValueError(f"{len(recordings)} recordings and {len(observers)} observers: at least one of each is needed")
    if sum(len(recording.time) for recording in recordings) >= WORTH_COMPILING and find_spec("numba"):
        settings = {"language": "numba"} | settings
    for observer in tqdm(observers.values(), desc="compiling", delay=2, leave=False):
        # so that compiling is no part of the cost
        track(recordings[0], observer, start, **settings)
    pairs = [(label, number) for number in range(len(recordings)) for label in observers]
    rows = []
    for label, number in tqdm(pairs, desc="runs", delay=2, leave=False):
        recording = recordings[number]
        begin = time.perf_counter()
        run = track(recording, observers[label], start, **settings)
        cost = (time.perf_counter() - begin) / (recording.time[-1] - recording.time[0])
        inverse = recording.imaging_surface.inverse_distance.name
        error = np.abs(run.error[:, -1])
        late = error[recording.time - recording.time[0] >= after - 1e-9]
        if not len(late):
            raise ValueError(f"no sample of {recording.source!r} lies {after} s or more after its first one")
        rows.append(
            {
                "observer": label,
                "recording": recording.source,
                "settling_time": run.settling_time(tolerance, inverse),
                "final": _known(error[-1]),
                "rms": _known(math.sqrt(np.mean(late**2))),
                "worst": _known(late.max()),
                "resets": len(run.resets),
                "diverged_at": math.inf if run.diverged_at is None else run.diverged_at,
                "cost": cost,
            }
        )
    return pd.DataFrame(rows)


def summary(table: pd.DataFrame) -> pd.DataFrame:
    """What `compare` found, an observer a row.

    Parameters
    ----------
    table : pandas.DataFrame
        From `compare`.

    Returns
    -------
    pandas.DataFrame
        runs; failed (not settled at the end, or diverged), reset (runs with a reset), diverged; and for
        settling_time, final, rms, worst, cost the median with the 16 % and 84 % quantiles (columns name, name_low,
        name_high).
    """
    import pandas as pd

    rows = {}
    for label, runs in table.groupby("observer", sort=False):
        row: dict[str, float] = {
            "runs": len(runs),
            "failed": int(np.isinf(runs["settling_time"]).sum()),
            "reset": int((runs["resets"] > 0).sum()),
            "diverged": int(np.isfinite(runs["diverged_at"]).sum()),
        }
        for column in ("settling_time", "final", "rms", "worst", "cost"):
            # by rank, for infinite values have no mean
            for name, share in (("", 0.5), ("_low", 0.16), ("_high", 0.84)):
                row[column + name] = float(np.quantile(runs[column], share, method="nearest"))
        rows[label] = row
    return pd.DataFrame.from_dict(rows, orient="index")


def described(found: pd.DataFrame) -> str:
    """A summary as text: counts, and medians with their quantiles."""
    import pandas as pd

    lines = {}
    for label, row in found.iterrows():
        line = {name: f"{row[name]:.0f}" for name in ("runs", "failed", "reset", "diverged")}
        for name in ("settling_time", "final", "rms", "worst"):
            line[name] = f"{row[name]:.2g} ({row[name + '_low']:.2g} to {row[name + '_high']:.2g})"
        line["cost"] = f"{1e6 * row['cost']:.0f} us/s"
        lines[label] = line
    return str(pd.DataFrame.from_dict(lines, orient="index").to_string())


def _known(value: float) -> float:
    """An error, infinite where a diverged run has none."""
    return float(value) if math.isfinite(value) else math.inf


def relative_distance_errors(runs: Iterable[Run | WindowEstimate], after: float, reference: str = "truth") -> Array:
    """Relative errors of the estimated distance, a given time after the start of each run.

    Parameters
    ----------
    runs : iterable of Run or WindowEstimate
        On recordings with a truth, or with measured distances.
    after : float
        Seconds since the first sample; the first sample from then on counts.
    reference : str
        "truth", or the name of a measured distance of the recordings, such as "stereo".

    Returns
    -------
    array of shape (number of runs,)
        |estimate - reference| / reference; infinite where the estimate is not in front of the camera.

    Raises
    ------
    ValueError
        If a recording is too short or has no such reference.
    """
    errors = []
    for run in runs:
        recording = run.recording
        since = run.time - run.time[0]
        if not 0 <= after <= since[-1] + 1e-9:
            raise ValueError(f"the recording {recording.source!r} lasts {since[-1]:.4g} s, not {after} s")
        k = min(int(np.searchsorted(since, after - 1e-9)), len(since) - 1)
        if reference == "truth":
            distance = 1 / float(recording.view.inverse(run.truth[k]))
        elif reference in recording.distances:
            distance = recording.distances[reference][k]
        else:
            known = ", ".join(["truth", *recording.distances])
            raise ValueError(f"the recording {recording.source!r} has no distance {reference!r}; it has {known}")
        errors.append(abs(run.distance[k] / distance - 1))
    return np.array(errors)


def best_setting(
    recordings: Sequence[Recording],
    observers: Iterable[Observer],
    follow: Callable[[Recording, Observer], Run],
    after: Sequence[float] = (2.0,),
) -> Observer:
    """The observer whose median relative distance error is least, added up over the given times.

    Choose on some recordings and report on others, or the report flatters.

    Parameters
    ----------
    recordings : sequence of Recording
        With a truth.
    observers : iterable of Observer
        One structure with different gains, or several structures.
    follow : function of (recording, observer)
        How an observer is run, for instance ``lambda r, o: track(r, o, start)``.
    after : sequence of float
        Seconds since the first sample.
    """

    def score(observer: Observer) -> float:
        runs = [follow(recording, observer) for recording in recordings]
        total = float(sum(np.median(relative_distance_errors(runs, seconds)) for seconds in after))
        return math.inf if math.isnan(total) else total  # a run that diverged is never the best

    return min(observers, key=score)
