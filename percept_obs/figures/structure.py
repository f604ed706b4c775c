"""The figure of structure and motion: every unknown quantity over time, true and estimated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures.base import (
    TRUTH,
    Array,
    Figure,
    draw_curves,
    drawn,
    finite,
    legend_above,
    linear_axis,
    rows,
    span,
    style,
)
from percept_obs.structure import LinearView, StructureAndMotion
from percept_obs.tracking.run import Run


def quantities(
    runs: Run | Sequence[Run], labels: Sequence[str] | None = None, axes: Sequence[Axes] | None = None
) -> Figure:
    """The scale and the velocities that were unknown, a row each.

    The axes show the truth's neighbourhood.  Curves have gaps where an estimate is missing, or its d_s is not positive.

    Parameters
    ----------
    runs : Run or sequence of Run
        Of one choice of what is unknown, at the same times and with a truth; on (y1, y2, ybar3) or its linear view.
    labels : sequence of str, optional
        One for each run; observers' names when left out.
    axes : axes, optional
        One for each unknown quantity; new ones when left out.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If there are no runs, they are of different choices or times, have no truth, or the number of labels or axes is
        wrong.
    """
    runs = [runs] if isinstance(runs, Run) else list(runs)
    if not runs:
        raise ValueError("there are no runs to draw; give one or more")
    labels = [run.observer.name for run in runs] if labels is None else list(labels)
    if len(labels) != len(runs):
        raise ValueError(f"there are {len(labels)} labels for {len(runs)} runs; give one for each")
    first, choice = runs[0], _choice(runs[0])
    if any(_choice(run) != choice or not np.array_equal(run.time, first.time) for run in runs):
        raise ValueError("the runs have different unknowns or times; draw them one by one")
    if any(run.recording.truth is None for run in runs):
        raise ValueError("there is no truth to compare with; figures.signals(run) draws a run without one")
    true = choice.quantities(first.truth[:, -len(choice.unknown) :])
    found = [choice.quantities(run.estimate[:, -len(choice.unknown) :]) for run in runs]
    stack = rows(axes, [1.5] * len(true), list(true))
    looks = [style(number) for number in range(len(runs))]
    sentences = [f"Unknown quantities from {first.time[0]:g} to {first.time[-1]:g} s, a row each."]
    for ax, (name, truth) in zip(stack, true.items(), strict=True):
        unit = "1/m" if name == "d_s" else "m/s"
        estimates = np.array([each[name] for each in found])
        ax.plot(first.time, truth, **TRUTH)
        draw_curves(ax, first.time, estimates, labels, looks)
        ax.set_ylabel(f"${name[0]}_{{{name[2:]}}}$ ({unit})")
        ends = [f"{label} {_end(one)}" for label, one in zip(labels, estimates, strict=True)]
        sentences.append(f"{name} in {unit}: the truth, {span(truth)}; at the end {', '.join(ends)}.")
        sentences.append(linear_axis(ax, _neighbourhood(truth), estimates, f"the estimates of {name}", reach=0.0))
    legend_above(stack[0])
    return drawn(stack, sentences)


def _choice(run: Run) -> StructureAndMotion:
    surface = run.recording.view
    choice = surface.choice if isinstance(surface, LinearView) else surface
    if not isinstance(choice, StructureAndMotion):
        raise ValueError(f"the run is of the {surface.name}, not of structure and motion")
    return choice


def _neighbourhood(truth: Array) -> Array:
    """Values that an axis should hold: a quarter of its size around the truth, or 0.1 around zero."""
    size = np.abs(finite(truth)).max()
    around = 0.25 * size if size > 0 else 0.1
    return np.concatenate([truth - around, truth + around])


def _end(estimates: Array) -> str:
    missing = int(np.isnan(estimates).sum())
    gaps = f" ({missing} of {len(estimates)} estimates are missing)" if missing else ""
    return ("nothing" if np.isnan(estimates[-1]) else f"{estimates[-1]:.4g}") + gaps
