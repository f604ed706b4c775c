"""The figure of one run: outputs, estimates and errors over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures import axis, curves, given, look, words
from percept_obs.figures.base import Array, Drawing, figure, legend_above, rows
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import TOLERANCE

RESIDUALS: tuple[dict[str, Any], ...] = (
    {"color": look.BLUE, "linestyle": "-"},
    {"color": look.GREEN, "linestyle": "-."},
    {"color": look.VERMILLION, "linestyle": "--"},
    {"color": look.PURPLE, "linestyle": ":"},
    {"color": look.ORANGE, "linestyle": (0, (5, 1, 1, 1, 1, 1))},
)
"""Looks of the errors of one run."""

JUDGED: dict[str, Any] = {"color": look.BLACK, "linestyle": "-"}
"""Look of the error that the verdict judges."""


@figure("it is no run, the number of axes is wrong, or the tolerance is not positive")
def signals(run: Run, axes: Sequence[Axes] | None = None, tolerance: float = TOLERANCE) -> Drawing:
    """Outputs, estimates and errors of a run over time.

    One row a coordinate, with samples as dots, the truth solid and the estimate dashed, in a band of two claimed
    standard deviations to either side if the observer claims a covariance; in the last row the absolute errors or, if
    the recording has no truth, the absolute innovations.  The black line is the relative error that the verdict judges,
    and the dotted one its tolerance.  Ticks along the top mark resets.

    Parameters
    ----------
    run : Run
    tolerance : float
        Bound on the relative error, see `Run.outcome`.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, ibo, pinhole, record, scenarios, track
    >>> run = track(record(scenarios.ma2005_eq35(), 20), ibo(PerspectiveSystem(affine(), pinhole())))
    >>> print(figures.signals(run).text.split(". ")[1])
    Converged: the relative error of the distance stays within 10 % after 1.91 s
    """
    given.one(run, Run, "track()")
    names = [symbol.name for symbol in run.view.coordinates]
    known = run.recording.truth is not None
    what = "error" if known else "innovation"
    *upper, last = rows(axes, [1.1] * len(names) + [1.6], [*names, f"the {what}"])
    yield (
        f"Outputs and estimates of the {run.observer.name} observer over {words.times(run)}, with "
        f"{', '.join(run.measured)} measured and {', '.join(run.observer.form.hidden)} hidden."
    )
    yield words.story(run, tolerance)
    for column, ax in enumerate(upper):
        yield _coordinate(ax, run, column)
    residuals = np.abs(run.error if known else run.innovation).T
    names = names if known else list(run.measured)
    looks = [RESIDUALS[number % len(RESIDUALS)] for number in range(len(residuals))]
    labels = [words.letter(name) for name in names]
    if known:  # the tolerance is one of the relative error
        relative = np.where(np.isfinite(run.relative_error), run.relative_error, np.nan)
        residuals, names = np.vstack([residuals, relative]), [*names, f"{run.view.judged}, relative"]
        looks, labels = [*looks, JUDGED], [*labels, names[-1]]
    curves.draw_errors(last, run.elapsed, residuals, labels, looks)
    if known:
        last.axhline(tolerance, color=look.GREY, linewidth=1, linestyle=(0, (2, 2)))
    last.set_ylabel(f"|{what}|")
    yield axis.log(last, residuals, f"the {what}s")
    yield _levels(run, residuals, names, what)
    legend_above(last)
    for ax in (*upper, last):
        _mark_resets_and_divergence(ax, run)
    legend_above(upper[0])
    _say_where_it_diverged(last, run)
    return [*upper, last]


def _coordinate(ax: Axes, run: Run, column: int) -> str:
    """Draw samples, truth and estimate of one coordinate, and say what they are."""
    recording = run.recording
    name = recording.view.coordinates[column].name
    estimate = run.estimate[:, column]
    firm, kind = axis.bulk(estimate), "estimated"
    if name in run.measured:
        firm, kind = recording.outputs[:, recording.names.index(name)], "measured"
        ax.plot(run.elapsed, firm, **look.dots(firm))
    if recording.truth is not None:
        firm, kind = recording.truth[:, column], "true"
        ax.plot(run.elapsed, firm, **look.TRUTH)
    ax.plot(run.elapsed, estimate, **look.ESTIMATE)
    ax.set_ylabel(words.label(name, recording.view))
    return words.joined(
        f"The {kind} {words.coordinate(name, recording.view)} is {words.span(firm)}.",
        axis.linear(ax, firm, estimate, f"the estimates of {name}"),
        curves.draw_claim_of_coordinate(ax, run, column, look.ESTIMATE["color"]),
    )


def _levels(run: Run, residuals: Array, names: Sequence[str], what: str) -> str:
    """Root mean square over the last half, where there is no gap in it."""
    late = {name: words.finite(each[len(run.elapsed) // 2 :]) for name, each in zip(names, residuals, strict=True)}
    levels = [f"{np.sqrt(np.mean(each**2)):.2g} ({name})" for name, each in late.items() if each.size]
    over = f"; root mean square over the last half: {', '.join(levels)}" if levels else ""
    return f"Below them the absolute {what}s on a logarithmic axis{over}."


def _mark_resets_and_divergence(ax: Axes, run: Run) -> None:
    ax.set_xlim(run.elapsed[0], run.elapsed[-1])
    if len(run.resets):
        top = ax.get_xaxis_transform()
        ax.vlines(
            run.resets - run.time[0],
            1,
            1.05,
            transform=top,
            color=look.PURPLE,
            linewidth=1,
            clip_on=False,
            label="reset",
        )
    if run.diverged_at is not None:
        diverged = run.diverged_at - run.time[0]
        ax.axvspan(diverged, run.elapsed[-1], color=look.PALE, zorder=0)
        ax.axvline(diverged, color=look.GREY, linewidth=1)


def _say_where_it_diverged(ax: Axes, run: Run) -> None:
    if run.diverged_at is None:
        return
    diverged = run.diverged_at - run.time[0]
    aside, ha = (6, "left") if diverged < run.elapsed[-1] / 2 else (-6, "right")
    place: dict[str, Any] = {
        "xycoords": ax.get_xaxis_transform(),
        "textcoords": "offset points",
        "ha": ha,
        "va": "center",
    }
    ax.annotate(f"diverged at {diverged:.3g} s", (diverged, 0.5), (aside, 0), **place)
