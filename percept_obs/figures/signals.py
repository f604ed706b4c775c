"""The figure of one run: outputs, estimates and errors over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

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
    bulk,
    claim_of_coordinate,
    dots,
    draw_errors,
    drawn,
    finite,
    label,
    legend_above,
    letter,
    linear_axis,
    log_axis,
    rows,
    span,
    words,
)
from percept_obs.figures.labels import story, time_in_words
from percept_obs.tracking.run import Run

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
    surface, form = run.recording.view, run.observer.form
    names = [symbol.name for symbol in surface.coordinates]
    known = run.recording.truth is not None
    what = "error" if known else "innovation"
    *upper, last = rows(axes, [1.1] * len(names) + [1.6], [*names, f"the {what}"])
    sentences = [
        f"Outputs and estimates of the {run.observer.name} observer over {time_in_words(run)}, with "
        f"{', '.join(form.measured)} measured and {', '.join(form.hidden)} hidden.",
        story(run, tolerance),
        *(_coordinate(ax, run, column) for column, ax in enumerate(upper)),
    ]
    residuals = np.abs(run.error if known else run.innovation).T
    drawn_names = names if known else form.measured
    looks = [RESIDUALS[number % len(RESIDUALS)] for number in range(len(residuals))]
    draw_errors(last, run.time, residuals, [letter(name) for name in drawn_names], looks)
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


def _coordinate(ax: Axes, run: Run, column: int) -> str:
    """Draw samples, truth and estimate of one coordinate, and say what they are."""
    recording = run.recording
    name = recording.view.coordinates[column].name
    said, estimate = words(name, recording.view), run.estimate[:, column]
    firm, kind = bulk(estimate), "estimated"
    if name in run.observer.form.measured:
        firm, kind = recording.outputs[:, recording.names.index(name)], "measured"
        ax.plot(run.time, firm, **dots(firm))
    if recording.truth is not None:
        firm, kind = recording.truth[:, column], "true"
        ax.plot(run.time, firm, **TRUTH)
    ax.plot(run.time, estimate, **ESTIMATE)
    ax.set_ylabel(label(name, recording.view))
    left_out = linear_axis(ax, firm, estimate, f"the estimates of {name}")
    claim = claim_of_coordinate(ax, run, column, ESTIMATE["color"])
    return " ".join(filter(None, [f"The {kind} {said} is {span(firm)}.", left_out, claim]))


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
