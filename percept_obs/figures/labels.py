"""What figures say of runs: their labels and stories, and which of them can be told together."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from percept_obs.recording import Recording
from percept_obs.tracking.run import Run

Array = NDArray[np.float64]


def recording_of(data: Run | Recording) -> Recording:
    """The recording itself, or the one that a run followed.

    Raises
    ------
    ValueError
        If it is neither.
    """
    if not isinstance(data, Run | Recording):
        raise ValueError(f"a Run or a Recording is needed, not {data!r}; record() or track() makes one")
    return data.recording if isinstance(data, Run) else data


def list_of_runs(runs: Run | Sequence[Run]) -> list[Run]:
    """One run or several as a list.

    Raises
    ------
    ValueError
        If there is none, or something else among them.
    """
    found = list(runs) if isinstance(runs, Iterable) else [runs]
    if not found:
        raise ValueError("there are no runs to draw; give at least one, such as track(recording, observer)")
    for run in found:
        if not isinstance(run, Run):
            raise ValueError(f"a Run is needed, not {run!r}; track(recording, observer) makes one")
    return found


def same_point(runs: Sequence[Run]) -> None:
    """Refuse runs that did not follow the same point.

    Raises
    ------
    ValueError
        If times, surfaces or truths differ.
    """
    first = runs[0].recording
    for number, run in enumerate(runs[1:], 2):
        other = run.recording
        same = {
            "surfaces": other.view.fits(first.view),
            "times": np.array_equal(other.time, first.time),
            "truths": _equal(other.truth, first.truth),
        }
        differing = [what for what, alike in same.items() if not alike]
        if differing:
            raise ValueError(
                f"run {number} followed another point than run 1: their {' and '.join(differing)} differ; draw runs on "
                "one recording, or one figure for each"
            )


def _equal(one: Array | None, other: Array | None) -> bool:
    return one is other if one is None or other is None else np.array_equal(one, other)


def labels_for(items: Sequence[object], labels: Sequence[str] | None, otherwise: Sequence[str]) -> list[str]:
    """The labels if they are given, else the others, numbered if they repeat.

    Raises
    ------
    ValueError
        If there is not one for each item.
    """
    if labels is None:
        repeated = len(set(otherwise)) < len(otherwise)
        return [f"{name} [{k}]" if repeated else name for k, name in enumerate(otherwise, 1)]
    if isinstance(labels, str) or len(labels) != len(items):
        raise ValueError(f"labels= is {labels!r}; a list of {len(items)} is needed, one for each curve")
    return list(labels)


def story(run: Run, tolerance: float = 0.05) -> str:
    """What happened to a run, in sentences: its verdict, resets, divergence and lost samples."""
    if not tolerance > 0:
        raise ValueError(f"the tolerance is {tolerance}; it must be positive")
    verdict, diverged = run.verdict(tolerance), run.diverged_at is not None
    resets = "once" if len(run.resets) == 1 else f"{len(run.resets)} times"
    columns = [run.recording.names.index(name) for name in run.observer.form.measured]
    lost = int(np.isnan(run.recording.outputs[:, columns]).any(axis=1).sum())
    missing = int(np.isnan(run.estimate).any(axis=1).sum())
    sentences = [
        f"{verdict[0].upper()}{verdict[1:]}.",
        f"Before that it was reset {resets}." if diverged and len(run.resets) else "",
        f"From there on {missing} estimates are missing: the curve ends." if missing else "",
        f"{lost} of {len(run.time)} samples were lost." if lost else "",
    ]
    return " ".join(filter(None, sentences))


def time_in_words(run: Run) -> str:
    """From when to when a run goes."""
    return f"{run.time[0]:.4g} to {run.time[-1]:.4g} s"


def place_in_words(coordinates: Array) -> str:
    """Coordinates in brackets."""
    return f"({', '.join(f'{value:.3g}' for value in coordinates)})"
