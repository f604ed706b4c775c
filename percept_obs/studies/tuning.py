"""Gains chosen on some recordings and errors reported on others, for every observer in one table."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from percept_obs.observability.windows import information_along
from percept_obs.observers import OBSERVERS, Observer
from percept_obs.observers.family import Family
from percept_obs.recording import Recording
from percept_obs.studies.comparison import Follow, best_setting, errors_of, timed
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.signal import from_the_start
from percept_obs.tracking.following import DoesNotFit, StepTooLong, require_match
from percept_obs.tracking.function import FunctionObserver
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import TOLERANCE
from percept_obs.validation import bar, checked, load_pandas

__all__ = ["choose_and_report", "side_by_side"]

if TYPE_CHECKING:
    import pandas as pd

Gains = Mapping[str, float]
Estimate = Callable[[Recording], Run]

QUANTILE = 0.9
"""Quantile of the errors that the table has next to the median."""

USUAL_SPEED = 0.2
"""Root mean square of |w|, in lengths a second, that the candidates' gains are made for."""

COLUMNS = (
    *("observer", "gains", "at_edge", "reference", "after", "median", "nine_in_ten"),
    *("behind", "reset", "diverged", "claimed", "trusted", "cost", "refusal", "warning"),
)
"""Columns of the table."""


@checked
def choose_and_report(
    choosing: Sequence[Recording],
    reporting: Sequence[Recording],
    form: PartitionedSystem,
    follow: Follow,
    candidates: Mapping[Family | FunctionObserver, Sequence[Gains]] | None = None,
    batch: Mapping[str, Estimate] | None = None,
    after: Sequence[float] = (1.0, 2.0, 3.0),
    references: Sequence[str] = ("truth",),
    length: float | None = None,
    judged: int = 0,
) -> pd.DataFrame:
    """Choose each observer's gains on some recordings, and report its errors of the distance on others.

    Parameters
    ----------
    choosing, reporting : sequences of Recording
        With a truth; none in both.
    form : PartitionedSystem
        The system that the observers observe.
    follow : function of (recording, observer)
        Runs an observer, for instance ``lambda r, o: track(r, o, start)``.
    candidates : mapping of families such as `identifier_based` to their gains, optional
        Those with the least sum of median errors after the given times are chosen; the candidates in every observer's
        own file when left out.
    batch : mapping of labels to functions of a recording, optional
        Further estimates for the table, such as `moving_window_least_squares`; nothing is chosen for them.
    after : sequence of float
        Seconds since the first sample.
    references : sequence of str
        "truth", or names of measured distances of the recordings; gains are chosen by the first of them.
    length : float, optional
        The recordings' unit of length for all observers, see `Recording`; `own_length` of those to choose on when left
        out.
    judged : int
        Number of reporting recordings, evenly sampled, whose runs are judged by `Run.trust`.

    Returns
    -------
    pandas.DataFrame
        One row for an observer, a reference and a time, with relative errors of the distance over those reporting
        recordings that last as long: observer, gains (the chosen ones, by the length), at_edge (names of gains at the
        smallest or largest of their candidates, beyond which better ones may lie), reference, after (s), median,
        nine_in_ten (the 90 % quantile), behind (number of recordings without an estimate in front of the camera
        then), reset, diverged (numbers of recordings), claimed (median of the relative standard deviations of the
        distance that the observer claims then, NaN if it claims none), trusted (share of the runs that are judged),
        cost (seconds of computing for a second of data), refusal (why the observer cannot follow these recordings, if
        it cannot; its numbers are then NaN) and warning (that the steps
        were too long for it, if they were).

    Raises
    ------
    ValueError
        If there are no recordings or candidates, a recording is in both halves, or all are too short or one has no
        such reference.
    DoesNotFit
        If a recording has another view, other outputs or another motion than the form.

    See Also
    --------
    side_by_side : the table as text, one row an observer
    percept_obs.studies.all_observers.all_observers : splits the recordings and chooses the start as well

    Examples
    --------
    >>> from percept_obs import Camera, PerspectiveSystem, Uniform, affine, ibo, pinhole, record, scenarios, track
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> seen = [record(scenarios.ma2005_eq35(), 3, Camera(0.05, Uniform(0.01)), seed) for seed in range(2)]
    >>> gains = {ibo: [{"gain": 2.0}, {"gain": 10.0}]}
    >>> table = choose_and_report(seen[:1], seen[1:], form, lambda r, o: track(r, o), gains, after=[1.0])
    >>> side_by_side(table).loc["identifier-based", "diverged"]
    '0'
    """
    pd = load_pandas()
    if not len(choosing) or not len(reporting):
        raise ValueError(f"{len(choosing)} recordings to choose on, {len(reporting)} to report on: both need some")
    for recording in (*choosing, *reporting):
        require_match(form, recording, recording.motion)
    if {id(recording) for recording in choosing} & {id(recording) for recording in reporting}:
        raise ValueError("a recording is in both halves: its errors would be too small if gains were chosen on it")
    if candidates is None:
        candidates = {make: make.candidates for make in OBSERVERS}
    if not candidates or not all(len(gains) for gains in candidates.values()):
        raise ValueError("every observer needs at least one candidate for its gains")
    if not len(references) or not len(after):
        raise ValueError(f"{len(references)} references and {len(after)} times: at least one of each is needed")
    if judged < 0:
        raise ValueError(f"judged is {judged}; it must be 0 or a number of recordings")
    unit = own_length(form, choosing) if length is None else length
    choosing, reporting = ([replace(each, unit=unit) for each in half] for half in (choosing, reporting))
    questions = list(product(references, after))
    rows: list[dict[str, Any]] = []
    for make, settings in bar(candidates.items(), "choosing gains", unit="observer"):
        refusal = make.refusal(form)
        try:
            tried = [] if refusal else [make(form, **gains) for gains in settings]
            chosen = best_setting(choosing, tried, follow, after, references[0]) if tried else None
        except DoesNotFit as error:
            refusal, chosen = str(error), None
        if chosen is None:
            about = {"observer": make.name, "gains": "", "at_edge": "", "refusal": refusal, "warning": ""}
            rows += [about | {"reference": reference, "after": seconds} for reference, seconds in questions]
            continue
        values = {gain.name: gain.value for gain in chosen.gains if gain.name in settings[0]}
        about = {
            "observer": chosen.name,
            "gains": ", ".join(f"{name} {value:.3g}" for name, value in values.items()),
            "at_edge": ", ".join(_at_edge(values, tried)),
        }

        def estimate(recording: Recording, observer: Observer = chosen) -> Run:
            return follow(recording, observer)

        rows += _errors(estimate, reporting, questions, about, judged)
    for label, batch_estimate in (batch or {}).items():
        rows += _errors(batch_estimate, reporting, questions, {"observer": label, "gains": "", "at_edge": ""}, judged)
    return pd.DataFrame(rows, columns=COLUMNS)


def _errors(
    estimate: Estimate,
    recordings: Sequence[Recording],
    questions: Sequence[tuple[str, float]],
    about: dict[str, Any],
    judged: int,
) -> list[dict[str, Any]]:
    """Rows of the table for one observer."""
    judges = {id(each) for each in evenly(recordings, judged)}
    errors: dict[tuple[str, float], list[float]] = {question: [] for question in questions}
    claims: dict[float, list[float]] = {seconds: [] for _, seconds in questions}
    reset = diverged = 0
    trusted, cost = [], []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", StepTooLong)
        for recording in bar(recordings, f"runs of {about['observer']}"):  # no run is kept
            run, each = timed(estimate, recording)
            cost.append((each, float(recording.elapsed[-1])))
            reset, diverged = reset + (len(run.resets) > 0), diverged + (run.diverged_at is not None)
            for reference, seconds in questions:
                errors[reference, seconds] += errors_of(run, seconds, reference)
            for seconds, found in claims.items():
                found.append(_claim(run, seconds))
            if id(recording) in judges:
                trusted.append(run.trust().trusted)
    too_long = [str(warning.message) for warning in caught if issubclass(warning.category, StepTooLong)]
    lengths = [length for _, length in cost]
    about = about | {"cost": np.average([each for each, _ in cost], weights=lengths), "refusal": ""}
    about |= {"reset": reset, "diverged": diverged, "warning": "".join(too_long[:1])}
    about["trusted"] = float(np.mean(trusted)) if judged else math.nan
    rows = []
    for reference, seconds in questions:
        if not errors[reference, seconds]:
            raise ValueError(f"no recording to report on lasts {seconds} s; after must be shorter")
        # no estimate is no better than one behind the camera
        of_all = np.nan_to_num(errors[reference, seconds], nan=np.inf, posinf=np.inf)
        known = np.array(claims[seconds])[np.isfinite(claims[seconds])]
        numbers = {
            **{"median": np.median(of_all), "claimed": np.median(known) if len(known) else math.nan},
            # by rank, for infinite errors have no mean
            **{"nine_in_ten": np.quantile(of_all, QUANTILE, method="nearest"), "behind": np.isinf(of_all).sum()},
        }
        rows.append({**about, "reference": reference, "after": seconds, **numbers})
    return rows


def _claim(run: Run, seconds: float) -> float:
    """Relative standard deviation of the distance that an observer claims some seconds after the first sample."""
    late = np.flatnonzero(from_the_start(run.elapsed, seconds))
    if run.observer.covariance is None or not len(late) or not run.estimate[late[0], -1]:
        return math.nan
    return math.sqrt(max(float(run.covariance[late[0], -1, -1]), 0.0)) / abs(float(run.estimate[late[0], -1]))


def evenly(things: Sequence[Any], most: int) -> list[Any]:
    """Return at most so many of some things, evenly sampled."""
    few = np.linspace(0, len(things) - 1, min(most, len(things))).round().astype(int)
    return [things[k] for k in few]


def own_length(form: PartitionedSystem, recordings: Sequence[Recording]) -> float:
    """Length in which the part of |w| with one has the root mean square `USUAL_SPEED`; |b| without a form.

    The error of a hidden coordinate shrinks at a rate that grows with |w|, which depends on how fast the camera moves
    past a point and not on how far away the point is.
    """
    if form.culprits:
        squares = [np.array([recording.motion.speed(recording.time) ** 2]) for recording in recordings]
    else:
        lengths = dict(zip(form.coordinates, recordings[0].view.lengths, strict=False))
        found = [(each, np.diagonal(information_along(form, each), axis1=1, axis2=2)) for each in recordings]
        squares = [each.unit**2 * w[:, [lengths[x] != 0 for x in form.x2]].sum(axis=1) for each, w in found]
    speed = float(np.sqrt(np.mean(np.concatenate(squares))))
    return speed / USUAL_SPEED or 1.0


def _at_edge(chosen: Gains, observers: Sequence[Observer]) -> list[str]:
    """Names of chosen gains that are the smallest or the largest of several that were tried."""
    tried = {name: [g.value for o in observers for g in o.gains if g.name == name] for name in chosen}
    return [n for n, value in chosen.items() if value in (min(tried[n]), max(tried[n])) and len(set(tried[n])) > 1]


@checked
def side_by_side(table: pd.DataFrame) -> pd.DataFrame:
    """Format the table of `choose_and_report` as text, one row an observer.

    Parameters
    ----------
    table : pandas.DataFrame
        From `choose_and_report`.

    Returns
    -------
    pandas.DataFrame
        A column for each reference and time, with the median error and in brackets the 90 % quantile; usable after (the
        first of the times from which on the 90 % quantile of the first reference is within `TOLERANCE`); behind
        (recordings, at the time with the most), reset, diverged, claimed and trusted if runs were judged, cost (us for
        a second of data), and a remark: the gains, those at an edge of their candidates, steps that are too long, or
        why the observer cannot follow.

    See Also
    --------
    choose_and_report : Makes the table.
    percept_obs.studies.all_observers.all_observers : Shows it in this way.

    Examples
    --------
    >>> from percept_obs import Camera, PerspectiveSystem, Uniform, affine, ibo, pinhole, record, scenarios, track
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> seen = [record(scenarios.ma2005_eq35(), 3, Camera(0.05, Uniform(0.01)), seed) for seed in range(2)]
    >>> side_by_side(choose_and_report(seen[:1], seen[1:], form, track, {ibo: [{}]}, after=[1.0])).columns.tolist()
    ['truth 1 s', 'usable after', 'behind', 'reset', 'diverged', 'cost', 'remark']
    """
    blind = table["trusted"].notna().any()

    def share(value: float) -> str:
        return "–" if np.isnan(value) else f"{value:.1%}"

    def error(row: Any) -> str:
        return (
            "–"
            if row.refusal or np.isnan(row.median)
            else f"{row.median:.1%} ({row.nine_in_ten:.0%})".replace("inf%", "none")
        )

    def usable(rows: pd.DataFrame) -> str:
        rows = rows[rows["reference"] == rows["reference"].iloc[0]].sort_values("after")
        late = np.flatnonzero(~(rows["nine_in_ten"] <= TOLERANCE))  # errors that grow again do not count before
        begin = late[-1] + 1 if len(late) else 0
        last = f"not within {rows['after'].iloc[-1]:g} s"
        return "–" if rows["refusal"].any() else f"{rows['after'].iloc[begin]:g} s" if begin < len(rows) else last

    def line(rows: pd.DataFrame) -> dict[str, str]:
        first = rows.iloc[0]
        found = {f"{row.reference} {row.after:g} s": error(row) for row in rows.itertuples()}
        if not blind:
            found["usable after"] = usable(rows)
        for name in ("behind", "reset", "diverged"):
            found[name] = "–" if first.refusal else f"{rows[name].max():.0f}"
        if blind:
            found |= {f"claimed {row.after:g} s": share(row.claimed) for row in rows.itertuples()}
            found["trusted at the end"] = share(first.trusted)
        found["cost"] = "–" if first.refusal else f"{1e6 * first.cost:.0f} us/s"
        edge = first.at_edge and f"; at the edge of what was tried: {first.at_edge}"
        remark = "; ".join(filter(None, [first.gains + edge, first.warning]))
        return found | {"remark": f"cannot: {first.refusal}" if first.refusal else remark}

    lines = {label: line(rows) for label, rows in table.groupby("observer", sort=False)}
    return load_pandas().DataFrame.from_dict(lines, orient="index")
