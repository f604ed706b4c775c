"""Figures over time: one run, several runs, and their distance in metres."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.lib.stride_tricks import sliding_window_view

from percept_obs.consistency import claimed_distance, claimed_interval
from percept_obs.figures.base import (
    BLUE,
    ESTIMATE,
    GREEN,
    GREY,
    PALE,
    PURPLE,
    TRUTH,
    VERMILLION,
    Array,
    Figure,
    depth_or_range,
    dots,
    drawn,
    finite,
    label,
    labels_for,
    legend_above,
    letter,
    linear_axis,
    list_of_runs,
    log_axis,
    note,
    rows,
    same_point,
    span,
    story,
    style,
    words,
)
from percept_obs.recording import Recording
from percept_obs.tracking import Run

SMOOTHING = 160
"""Noisy errors are averaged over the duration divided by this."""

CLAIM = r"$\pm 2\sigma$ claimed"
"""Name of the band that an observer's covariance claims."""

RESIDUALS: tuple[dict[str, Any], ...] = (
    {"color": BLUE, "linestyle": "-"},
    {"color": GREEN, "linestyle": "-."},
    {"color": VERMILLION, "linestyle": "--"},
    {"color": PURPLE, "linestyle": ":"},
)
"""Looks of the errors of one run."""


def signals(run: Run, axes: Sequence[Axes] | None = None, tolerance: float = 0.05) -> Figure:
    """Outputs, estimates and errors of a run over time.

    One row a coordinate, with samples as dots, the truth solid and the estimate dashed, in a band of two claimed
    standard deviations to either side if the observer claims a covariance; in the last row the absolute errors or, if
    the recording has no truth, the absolute innovations.  Ticks along the top mark resets.

    Parameters
    ----------
    run : Run
    axes : n + 1 axes, optional
        One for each of the n coordinates and one for the errors; new ones when left out.
    tolerance : float
        Bound on the hidden coordinates' errors, for the verdict.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If it is no run, the number of axes is wrong, or the tolerance is not positive.
    """
    if not isinstance(run, Run):
        raise ValueError(f"signals draws one Run, not {run!r}; track() makes it, and compare() draws several")
    surface, form = run.recording.surface, run.observer.form
    names = [symbol.name for symbol in surface.coordinates]
    known = run.recording.truth is not None
    what = "error" if known else "innovation"
    *upper, last = rows(axes, [1.1] * len(names) + [1.6], [*names, f"the {what}"])
    sentences = [
        f"Outputs and estimates of the {run.observer.name} observer over {_duration(run)}, with "
        f"{', '.join(form.measured)} measured and {', '.join(form.hidden)} hidden.",
        story(run, tolerance),
        *(_coordinate(ax, run, column) for column, ax in enumerate(upper)),
    ]
    residuals = np.abs(run.error if known else run.innovation).T
    drawn_names = names if known else form.measured
    looks = [RESIDUALS[number % len(RESIDUALS)] for number in range(len(residuals))]
    _errors(last, run.time, residuals, [letter(name) for name in drawn_names], looks)
    if known:
        last.axhline(tolerance, color=GREY, linewidth=1, linestyle=(0, (2, 2)))
    last.set_ylabel(f"|{what}|")
    sentences += [log_axis(last, residuals, f"the {what}s"), _levels(run, residuals, drawn_names, what)]
    legend_above(last)
    for ax in (*upper, last):
        _mark_resets_and_divergence(ax, run)
    legend_above(upper[0])
    _say_where_it_diverged(last, run)
    return drawn((*upper, last), sentences)


def compare(
    runs: Run | Sequence[Run],
    labels: Sequence[str] | None = None,
    coordinate: str | None = None,
    axes: Sequence[Axes] | None = None,
    tolerance: float = 0.05,
) -> Figure:
    """One coordinate as several observers estimate it, and their errors.

    Around the estimates of an observer that claims a covariance there is a band of two standard deviations to either
    side.

    Parameters
    ----------
    runs : Run or sequence of Run
        On one recording, or on several of the same point, such as with and without noise.
    labels : sequence of str, optional
        One for each run; observers' names, measured outputs and differing gains when left out.
    coordinate : str, optional
        Such as "y1"; the inverse distance when left out.
    axes : two axes, optional
        For the estimates and for the errors; new ones when left out.
    tolerance : float
        Bound on the hidden coordinates' errors, for the verdicts.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If there are no runs, they followed different points, the truth is not known, there is no such coordinate,
        or the number of labels or axes is wrong.
    """
    runs = list_of_runs(runs)
    same_point(runs)
    labels = labels_for(runs, labels, _descriptions(runs))
    shown = _with_divergence(runs, labels)
    recording, surface = runs[0].recording, runs[0].recording.surface
    if recording.truth is None:
        raise ValueError(
            "the recording has no truth to compare with; distance(runs) and signals(run) draw runs without one"
        )
    names = [symbol.name for symbol in surface.coordinates]
    coordinate = coordinate or names[-1]
    if coordinate not in names:
        raise ValueError(f"there is no coordinate {coordinate!r}; there are {', '.join(names)}")
    column = names.index(coordinate)
    upper, lower = rows(axes, [2.2, 2.0], ["the estimates", "the errors"])
    truth = recording.truth[:, column]
    estimates = np.array([run.estimate[:, column] for run in runs])
    errors = np.abs(truth - estimates)
    looks = [style(number) for number in range(len(runs))]
    upper.plot(recording.time, truth, **TRUTH)
    _curves(upper, recording.time, estimates, shown, looks)
    _errors(lower, recording.time, errors, labels, looks)
    upper.set_ylabel(label(coordinate, surface))
    lower.set_ylabel(f"|error of {letter(coordinate)}|")
    said = words(coordinate, surface)
    outside = linear_axis(upper, truth, estimates, f"the estimates of {said}")
    claims = [_claim_of_coordinate(upper, run, column, look["color"]) for run, look in zip(runs, looks, strict=True)]
    legend_above(upper)
    return drawn(
        (upper, lower),
        [
            f"{said} over {_duration(runs[0])}: the truth, {span(truth)}, the estimates of {_counted(runs)}, "
            "and below them the absolute errors on a logarithmic axis.",
            *(
                f"{name}: {story(run, tolerance)} {claim}".rstrip()
                for name, run, claim in zip(labels, runs, claims, strict=True)
            ),
            outside,
            log_axis(lower, errors, "the errors"),
        ],
    )


def distance(
    runs: Run | Sequence[Run],
    labels: Sequence[str] | None = None,
    reference: str | None = None,
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """Depth or range in metres, and its relative error.

    Whatever else measured the distance, the recording's `distances`, is drawn as dots.  For an observer that claims a
    covariance there is a band of all distances whose inverse lies within two standard deviations of the estimate;
    where these reach zero, the band has no upper end.

    Parameters
    ----------
    runs : Run or sequence of Run
        On one recording, or on several of the same point.
    labels : sequence of str, optional
        One for each run; observers' names, measured outputs and differing gains when left out.
    reference : str, optional
        What the errors are relative to: "truth", or the name of one of the recording's `distances`.  The truth when
        left out or, if the recording has none, the first of the distances.
    axes : two axes, optional
        For the distance and for the error; new ones when left out.  Without any reference there is no error, and
        one is enough.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If there are no runs, they followed different points, there is no such reference, or the number of labels or
        axes is wrong.
    """
    runs = list_of_runs(runs)
    same_point(runs)
    labels = labels_for(runs, labels, _descriptions(runs))
    shown = _with_divergence(runs, labels)
    recording = runs[0].recording
    word, symbol = depth_or_range(recording.surface)
    estimates = np.array([np.where(np.isfinite(run.distance), run.distance, np.nan) for run in runs])
    known = _known_distances(recording)
    reference = reference or next(iter(known), None)
    if reference is not None and reference not in known:
        raise ValueError(f"there is no reference {reference!r}; there are {', '.join(known) or 'none'}")
    contents = [f"the {word}", *(["its relative error"] if reference else [])]
    upper, *lower = rows(axes, [2.2, 1.8][: len(contents)], contents)
    for name, values in known.items():
        upper.plot(recording.time, values, **(TRUTH if name == "truth" else dots(values, label=name)))
    looks = [style(number) for number in range(len(runs))]
    _curves(upper, recording.time, estimates, shown, looks)
    if np.isnan(estimates).all():
        upper.text(0.5, 0.5, "no estimate in front of the camera", ha="center", transform=upper.transAxes)
    upper.set_ylabel(f"{word} ${symbol}$ (m)")
    firm = known[reference] if reference else _bulk(estimates)
    outside = linear_axis(upper, firm, estimates, f"the estimated {word}", reach=0.5)
    claims = [_claim_of_distance(upper, run, look["color"]) for run, look in zip(runs, looks, strict=True)]
    legend_above(upper)
    errors = 100 * np.abs(estimates / firm - 1) if reference else np.full_like(estimates, np.nan)
    sentences = [
        f"Estimated {word} in metres over {_duration(runs[0])}, {_counted(runs)}.",
        *(f"By the {name} it is {span(values)} m." for name, values in known.items()),
        *(f"{name}: {_distance_story(*each)}" for name, *each in zip(labels, runs, errors, claims, strict=True)),
        outside,
    ]
    for ax in lower:
        _errors(ax, recording.time, errors, labels, looks)
        ax.set_ylabel("relative error (%)")
        sentences.append(f"Below, the errors relative to the {reference}, in per cent on a logarithmic axis.")
        sentences.append(log_axis(ax, errors, "the relative errors", highest=1000, ticks="{x:g}"))
    return drawn((upper, *lower), sentences)


def _known_distances(recording: Recording) -> dict[str, Array]:
    """The true distance, if there is one, and what else measured it."""
    truth = {} if recording.truth is None else {"truth": 1 / recording.truth[:, -1]}
    return {**truth, **recording.distances}


def _coordinate(ax: Axes, run: Run, column: int) -> str:
    """Draw samples, truth and estimate of one coordinate, and say what they are."""
    recording = run.recording
    name = recording.surface.coordinates[column].name
    said, estimate = words(name, recording.surface), run.estimate[:, column]
    firm, kind = _bulk(estimate), "estimated"
    if name in run.observer.form.measured:
        firm, kind = recording.outputs[:, recording.names.index(name)], "measured"
        ax.plot(run.time, firm, **dots(firm))
    if recording.truth is not None:
        firm, kind = recording.truth[:, column], "true"
        ax.plot(run.time, firm, **TRUTH)
    ax.plot(run.time, estimate, **ESTIMATE)
    ax.set_ylabel(label(name, recording.surface))
    left_out = linear_axis(ax, firm, estimate, f"the estimates of {name}")
    claim = _claim_of_coordinate(ax, run, column, ESTIMATE["color"])
    return " ".join(filter(None, [f"The {kind} {said} is {span(firm)}.", left_out, claim]))


def _claim_of_coordinate(ax: Axes, run: Run, column: int, colour: str) -> str:
    """Draw the interval that the observer claims for a coordinate, and say it; nothing if it claims none."""
    if run.observer.covariance is None:
        return ""
    low, high = (end[:, column] for end in claimed_interval(run))
    return _draw_claim(ax, run, low, high, None if run.recording.truth is None else run.truth[:, column], colour)


def _claim_of_distance(ax: Axes, run: Run, colour: str) -> str:
    """The same for the distance."""
    if run.observer.covariance is None:
        return ""
    low, high = claimed_distance(run)
    words = _draw_claim(ax, run, low, high, None if run.recording.truth is None else 1 / run.truth[:, -1], colour)
    unbounded = int(np.isposinf(high).sum())
    if not unbounded:
        return words
    return (
        f"{words} In {unbounded} of {len(high)} samples it has no upper end, as the interval of the inverse distance "
        "reaches zero."
    )


def _draw_claim(ax: Axes, run: Run, low: Array, high: Array, truth: Array | None, colour: str) -> str:
    """Draw a band whose infinite ends are at the edge of the axes, and say where it ends and what it holds."""
    reaching = np.where(np.isposinf(high), ax.get_ylim()[1], high)
    named = CLAIM in ax.get_legend_handles_labels()[1]
    name = "_claim" if named else CLAIM
    ax.fill_between(run.time, low, reaching, color=colour, alpha=0.2, linewidth=0, zorder=1, label=name)
    claimed = ~np.isnan(low)
    if not claimed.any():
        return ""
    last = np.flatnonzero(claimed)[-1]
    words = f"The band of two claimed standard deviations is from {low[last]:.3g} to {high[last]:.3g} at the end"
    if truth is None:
        return f"{words}."
    held = np.mean((low <= truth) & (truth <= high))
    return f"{words} and holds the truth in {100 * held:.0f} % of the samples."


def _curves(ax: Axes, time: Array, curves: Array, labels: Sequence[str], looks: Sequence[dict[str, Any]]) -> None:
    """Curves with sparse markers, none of which lies on another."""
    step = max(1, len(time) // 8)
    for number, (curve, name, look) in enumerate(zip(curves, labels, looks, strict=True)):
        every = (step * number // len(curves), step)
        ax.plot(time, curve, label=name, linewidth=1.5, markersize=5, markevery=every, **look)
    ax.set_xlim(time[0], time[-1])


def _errors(ax: Axes, time: Array, errors: Array, labels: Sequence[str], looks: Sequence[dict[str, Any]]) -> None:
    """Every error faintly, and over it the root mean square of its neighbourhood."""
    width = 2 * (len(time) // (2 * SMOOTHING)) + 1
    if width > 1:
        for error, look in zip(errors, looks, strict=True):
            ax.plot(time, error, color=look["color"], linewidth=0.5, alpha=0.25)
        errors = np.array([_root_mean_square(error, width) for error in errors])
        note(ax, f"bold: root mean square over {(time[-1] - time[0]) * width / len(time):.1g} s")
    _curves(ax, time, errors, labels, looks)


def _root_mean_square(values: Array, width: int) -> Array:
    """Of the finite values in a window around each; NaN where the value itself is."""
    windows = sliding_window_view(np.pad(values, width // 2, constant_values=np.nan), width)
    largest = np.fmax(np.fmax.reduce(windows, axis=1), np.finfo(float).tiny)
    parts = np.nan_to_num(windows / largest[:, None]) ** 2
    count = np.maximum(np.isfinite(windows).sum(axis=1), 1)
    return np.where(np.isnan(values), np.nan, largest * np.sqrt(parts.sum(axis=1) / count))


def _levels(run: Run, residuals: Array, names: Sequence[str], what: str) -> str:
    """Root mean square over the last half, where there is no gap in it."""
    half = residuals[:, len(run.time) // 2 :]
    levels = [
        f"{np.sqrt(np.mean(finite(values) ** 2)):.2g} ({name})"
        for name, values in zip(names, half, strict=True)
        if finite(values).size
    ]
    words = f"Below them the absolute {what}s on a logarithmic axis"
    return f"{words}; root mean square over the last half: {', '.join(levels)}." if levels else f"{words}."


def _bulk(values: Array) -> Array:
    """The values without the smallest and the largest twentieth, which may be a transient."""
    seen = np.sort(finite(values))
    return seen[len(seen) // 20 : len(seen) - len(seen) // 20]


def _mark_resets_and_divergence(ax: Axes, run: Run) -> None:
    ax.set_xlim(run.time[0], run.time[-1])
    if len(run.resets):
        along_the_top = ax.get_xaxis_transform()
        ax.vlines(run.resets, 1, 1.05, transform=along_the_top, color=PURPLE, linewidth=1, clip_on=False, label="reset")
    if run.diverged_at is not None:
        ax.axvspan(run.diverged_at, run.time[-1], color=PALE, zorder=0)
        ax.axvline(run.diverged_at, color=GREY, linewidth=1)


def _say_where_it_diverged(ax: Axes, run: Run) -> None:
    if run.diverged_at is None:
        return
    early = run.diverged_at < (run.time[0] + run.time[-1]) / 2
    ax.annotate(
        f"diverged at {run.diverged_at:.3g} s",
        (run.diverged_at, 0.5),
        (6 if early else -6, 0),
        xycoords=ax.get_xaxis_transform(),
        textcoords="offset points",
        ha="left" if early else "right",
        va="center",
    )


def _duration(run: Run) -> str:
    return f"{run.time[0]:.4g} to {run.time[-1]:.4g} s"


def _counted(runs: Sequence[Run]) -> str:
    return "1 run" if len(runs) == 1 else f"{len(runs)} runs"


def _descriptions(runs: Sequence[Run]) -> list[str]:
    """What tells the runs apart: observers, measured outputs and differing gains."""
    kinds = [f"{run.observer.name} ({', '.join(run.observer.form.measured)})" for run in runs]
    gains = [{gain.name: gain.value for gain in run.observer.gains} for run in runs]
    found = []
    for kind, own in zip(kinds, gains, strict=True):
        others = [other for other, same in zip(gains, kinds, strict=True) if same == kind]
        differing = [f"{name} {value:g}" for name, value in own.items() if any(o.get(name) != value for o in others)]
        found.append(", ".join([kind, *differing]))
    return found


def _with_divergence(runs: Sequence[Run], labels: Sequence[str]) -> list[str]:
    """Labels that say when a curve ends, and why."""
    ends = ["" if run.diverged_at is None else f", diverged at {run.diverged_at:.3g} s" for run in runs]
    return [f"{name}{end}" for name, end in zip(labels, ends, strict=True)]


def _distance_story(run: Run, error: Array, claim: str) -> str:
    later = finite(error[len(error) // 2 :])
    behind = int((~np.isfinite(run.distance)).sum())
    sentences = [
        story(run),
        f"Over the last half its median relative error is {np.median(later):.2g} %." if later.size else "",
        f"{behind} of {len(run.time)} estimates are not in front of the camera: gaps." if behind else "",
        claim,
    ]
    return " ".join(filter(None, sentences))
