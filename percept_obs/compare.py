"""Comparing observers: how far their distances are off, and which setting is best on some of the recordings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from percept_obs.observers.base import Observer
from percept_obs.recording import Recording
from percept_obs.tracking import Run

Array = NDArray[np.float64]


def relative_distance_errors(runs: Iterable[Run], after: float, reference: str = "truth") -> Array:
    """Relative errors of the estimated distance, a given time after the start of each run.

    Parameters
    ----------
    runs : iterable of Run
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
            distance = 1 / run.truth[k, -1]
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
        return float(sum(np.median(relative_distance_errors(runs, seconds)) for seconds in after))

    return min(observers, key=score)
