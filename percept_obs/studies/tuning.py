"""Gains chosen on some recordings, and what they do on others: every observer in one table."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from percept_obs.observability.windowed import information_along
from percept_obs.observers import OBSERVERS, Observer
from percept_obs.observers.family import Family
from percept_obs.recording import Recording
from percept_obs.studies.comparison import best_setting, relative_distance_errors, timed
from percept_obs.system.forms import PartitionedSystem
from percept_obs.tracking.following import DoesNotFit, StepTooLong
from percept_obs.tracking.run import Run
from percept_obs.validation import bar, checked

if TYPE_CHECKING:
    import pandas as pd

Gains = Mapping[str, float]
Follow = Callable[[Recording, Observer], Run]
Estimate = Callable[[Recording], Run]

SHARE = 0.9
"""The share of recordings whose errors the table bounds, beside half of them."""

USUAL_SPEED = 0.2
"""Lengths a second at which candidates are meant to be used: the root mean square of |w| that they were made for."""

COLUMNS = (
    *("observer", "gains", "at_edge", "reference", "after", "median", "nine_in_ten"),
    *("behind", "reset", "diverged", "cost", "refusal", "doubt"),
)
"""Columns of the table."""


@checked
def choose_and_report(
    choosing: Sequence[Recording],
    reporting: Sequence[Recording],
    form: PartitionedSystem,
    follow: Follow,
    candidates: Mapping[Family, Sequence[Gains]] | None = None,
    batch: Mapping[str, Estimate] | None = None,
    after: Sequence[float] = (1.0, 2.0, 3.0),
    references: Sequence[str] = ("truth",),
    length: float | None = None,
) -> pd.DataFrame:
    """Choose each observer's gains on some recordings, and report its errors of the distance on others.

    Parameters
    ----------
    choosing, reporting : sequences of Recording
        With a truth; none in both.
    form : PartitionedSystem
        What the observers observe.
    follow : function of (recording, observer)
        How an observer is run, for instance ``lambda r, o: track(r, o, start)``.
    candidates : mapping of families such as `identifier_based` to their gains, optional
        Those with the least sum of median errors after the given times are chosen; those of every observer's own file
        when left out.
    batch : mapping of labels to functions of a recording, optional
        Estimates to stand beside the observers, such as `moving_window_least_squares`; nothing is chosen for them.
    after : sequence of float
        Seconds since the first sample.
    references : sequence of str
        "truth", or names of measured distances of the recordings; gains are chosen by the first of them.
    length : float, optional
        The unit in metres in which the candidates' gains are stated; `own_length` of the recordings to choose on when
        left out, so that nothing depends on the unit of length.

    Returns
    -------
    pandas.DataFrame
        One row for an observer, a reference and a time, with relative errors of the distance over those reporting
        recordings that last as long: observer, gains (the chosen ones, in metres), at_edge (names of those that are
        the smallest or largest of their candidates, beyond which better ones may lie), reference, after (s), median,
        nine_in_ten (the 90 % quantile), behind (number of recordings that have no estimate in front of the camera
        then), reset, diverged (numbers of recordings), cost (s of computing for a s of data), refusal: why the
        observer cannot follow these recordings, if it cannot; its numbers are then NaN; and doubt: that the steps were
        too long for it, if they were.

    Raises
    ------
    ValueError
        If there are no recordings or candidates, a recording is in both halves, or all are too short or one has no
        such reference.
    """
    import pandas as pd

    if not len(choosing) or not len(reporting):
        raise ValueError(f"{len(choosing)} recordings to choose on, {len(reporting)} to report on: both need some")
    if {id(recording) for recording in choosing} & {id(recording) for recording in reporting}:
        raise ValueError("a recording is in both halves: gains flatter the report if they were chosen on it")
    if candidates is None:
        candidates = {make: make.candidates for make in OBSERVERS}
    if not candidates or not all(len(gains) for gains in candidates.values()):
        raise ValueError("every observer needs at least one candidate for its gains")
    questions = list(product(references, after))
    if not len(references) or not len(after):
        raise ValueError(f"{len(references)} references and {len(after)} times: at least one of each is needed")
    unit = own_length(form, choosing) if length is None else length
    rows: list[dict[str, Any]] = []

    def answer(label: str, gains: str, edge: str, estimate: Estimate) -> None:
        with warnings.catch_warnings(record=True) as doubts:
            warnings.simplefilter("always", StepTooLong)
            runs, cost = timed(estimate, reporting)
        chatters = [str(doubt.message) for doubt in doubts if issubclass(doubt.category, StepTooLong)]
        told = {"observer": label, "gains": gains, "cost": cost, "refusal": "", "doubt": "".join(chatters[:1])}
        told["at_edge"] = edge
        told["reset"] = sum(len(run.resets) > 0 for run in runs)
        told["diverged"] = sum(run.diverged_at is not None for run in runs)
        for reference, seconds in questions:
            errors = relative_distance_errors(runs, seconds, reference)
            errors = np.where(np.isnan(errors), np.inf, errors)  # no estimate is no better than one behind the camera
            # the quantile by rank, for infinite errors have no mean
            numbers = {"median": np.median(errors), "nine_in_ten": np.quantile(errors, SHARE, method="nearest")}
            numbers["behind"] = np.isinf(errors).sum()
            rows.append({**told, "reference": reference, "after": seconds, **numbers})

    runs_of = {make: len(settings) * len(choosing) + len(reporting) for make, settings in candidates.items()}
    with bar(None, "choosing gains", sum(runs_of.values()), unit="run") as progress:

        def counted(recording: Recording, observer: Observer) -> Run:
            progress.update()
            return follow(recording, observer)

        for make, settings in candidates.items():
            progress.set_postfix_str(make.name, refresh=False)
            goal, refusal, chosen = progress.n + runs_of[make], make.refusal(form), None
            try:
                observers = [] if refusal else [make(form, **gains).in_units(unit) for gains in settings]
                chosen = best_setting(choosing, observers, counted, after, references[0]) if observers else None
            except DoesNotFit as misfit:
                refusal = str(misfit)
            if chosen is None:
                told = {"observer": make.name, "gains": "", "at_edge": "", "refusal": refusal, "doubt": ""}
                rows += [{**told, "reference": reference, "after": seconds} for reference, seconds in questions]
            else:
                values = {gain.name: gain.value for gain in chosen.gains if gain.name in settings[0]}
                answer(
                    chosen.name,
                    ", ".join(f"{n} {v:.3g}" for n, v in values.items()),
                    ", ".join(_at_edge(values, observers)),
                    partial(_swapped, counted, chosen),
                )
            progress.update(goal - progress.n)
        for label, estimate in (batch or {}).items():
            answer(label, "", "", estimate)
    return pd.DataFrame(rows, columns=COLUMNS)


def own_length(form: PartitionedSystem, recordings: Sequence[Recording]) -> float:
    """The length in metres in which |w| has the root mean square `USUAL_SPEED` along recordings; 1 without a form.

    How fast the camera moves past a point, not how far away it is, decides what a hidden gain does: w e is fed back.
    """
    if form.culprits:
        return 1.0
    squares = [np.trace(information_along(form, recording), axis1=1, axis2=2) for recording in recordings]
    speed = float(np.sqrt(np.mean(np.concatenate(squares))))
    return speed / USUAL_SPEED if speed > 0 else 1.0


def _at_edge(chosen: Gains, observers: Sequence[Observer]) -> list[str]:
    """Names of chosen gains that are the smallest or the largest of several that were tried."""
    tried = {name: [g.value for o in observers for g in o.gains if g.name == name] for name in chosen}
    return [n for n, value in chosen.items() if value in (min(tried[n]), max(tried[n])) and len(set(tried[n])) > 1]


@checked
def side_by_side(table: pd.DataFrame) -> pd.DataFrame:
    """What `choose_and_report` found as text, an observer a row.

    Parameters
    ----------
    table : pandas.DataFrame
        From `choose_and_report`.

    Returns
    -------
    pandas.DataFrame
        A column for each reference and time, with the median error and in brackets what nine in ten stay below;
        behind (recordings, at the time with the most), reset, diverged, cost (us for a s of data), and a remark: the
        gains, those that lie at an edge of their candidates, steps that are too long, or why the observer cannot
        follow.
    """
    import pandas as pd

    lines = {}
    for label, rows in table.groupby("observer", sort=False):
        refusal = rows["refusal"].iloc[0]
        line = {}
        for row in rows.itertuples():
            told = "–" if refusal else f"{row.median:.1%} ({row.nine_in_ten:.0%})"
            line[f"{row.reference} {row.after:g} s"] = told.replace("inf%", "none")
        for name in ("behind", "reset", "diverged"):
            line[name] = "–" if refusal else f"{rows[name].max():.0f}"
        line["cost"] = "–" if refusal else f"{1e6 * rows['cost'].iloc[0]:.0f} us/s"
        gains, edge = rows["gains"].iloc[0], rows["at_edge"].iloc[0]
        remark = f"{gains}; at the edge of what was tried: {edge}" if edge else gains
        remark = "; ".join(filter(None, [remark, rows["doubt"].iloc[0]]))
        lines[label] = line | {"remark": f"cannot: {refusal}" if refusal else remark}
    return pd.DataFrame.from_dict(lines, orient="index")


def _swapped(follow: Follow, observer: Observer, recording: Recording) -> Run:
    return follow(recording, observer)
