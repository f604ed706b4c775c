"""The figures of structure and motion: every unknown quantity over time, true and estimated; cases side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import matplotlib.figure
import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures.base import (
    TRUTH,
    WIDTH,
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
    runs: Run | Sequence[Run],
    labels: Sequence[str] | None = None,
    axes: Sequence[Axes] | None = None,
    image: bool = False,
) -> Figure:
    """The scale and the velocities that were unknown, a row each.

    The axes show the truth's neighbourhood.  Curves have gaps where an estimate is missing, or its d_s is not positive.
    Where d_s was found in an earlier stage, the truth is drawn in the scale that the first run's stage found.

    Parameters
    ----------
    runs : Run or sequence of Run
        Of one choice of what is unknown, at the same times and with a truth; on (y1, y2, ybar3) or its linear view.
    labels : sequence of str, optional
        One for each run; observers' names when left out.
    axes : axes, optional
        One for each row; new ones when left out.
    image : bool
        Whether the image coordinates y1, y2 and the inverse depth y3 = 1/Z have a row each as well, above the others.

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
    if any(
        replace(_choice(run), scale=choice.scale) != choice or not np.array_equal(run.time, first.time) for run in runs
    ):
        raise ValueError("the runs have different unknowns or times; draw them one by one")
    if any(run.recording.truth is None for run in runs):
        raise ValueError("there is no truth to compare with; figures.signals(run) draws a run without one")
    true = _named(first, first.truth, image)
    found = [_named(run, run.estimate, image) for run in runs]
    stack = rows(axes, [1.5] * len(true), list(true))
    looks = [style(number) for number in range(len(runs))]
    shown = "Image coordinates, inverse depth and unknown quantities" if image else "Unknown quantities"
    sentences = [f"{shown} from {first.time[0]:g} to {first.time[-1]:g} s, a row each."]
    for ax, (name, truth) in zip(stack, true.items(), strict=True):
        unit = UNITS.get(name, "m/s")
        measure = f" in {unit}" if unit else ""
        estimates = np.array([each[name] for each in found])
        ax.plot(first.time, truth, **TRUTH)
        draw_curves(ax, first.time, estimates, labels, looks)
        ax.set_ylabel(f"${name[0]}_{{{name[1:].lstrip('_')}}}$" + (f" ({unit})" if unit else ""))
        ends = [f"{label} {_end(one)}" for label, one in zip(labels, estimates, strict=True)]
        sentences.append(f"{name}{measure}: the truth, {span(truth)}; at the end {', '.join(ends)}.")
        sentences.append(linear_axis(ax, _neighbourhood(truth), estimates, f"the estimates of {name}", reach=0.0))
    legend_above(stack[0])
    return drawn(stack, sentences)


def cases(
    columns: Mapping[str, Run | Sequence[Run]], labels: Sequence[str] | None = None, image: bool = False
) -> Figure:
    """Several cases side by side, a column each with the rows of `quantities`.

    Parameters
    ----------
    columns : mapping of names to runs
        The runs of each case, as `quantities` takes them; equally many runs and rows in each.
    labels : sequence of str, optional
        One for each run of a case; observers' names when left out.
    image : bool
        As in `quantities`.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If there is no case, their numbers of rows differ, or `quantities` refuses one of them.
    """
    given = {name: [runs] if isinstance(runs, Run) else list(runs) for name, runs in columns.items()}
    unknown = {name: len(_choice(runs[0]).unknown) for name, runs in given.items() if runs}
    if len(set(unknown.values())) != 1:
        raise ValueError(f"cases with equally many unknown quantities are needed, not {unknown}; draw them one by one")
    count = next(iter(unknown.values())) + 3 * image
    figure = matplotlib.figure.Figure(figsize=(WIDTH, 1.1 * count + 0.9), layout="constrained")
    grid = figure.subplots(count, len(given), sharex="col", squeeze=False)
    parts = []
    for (name, runs), column in zip(given.items(), grid.T, strict=True):
        parts.append(f"{name}: {quantities(runs, labels, column, image).text}")
        column[0].get_legend().remove()
        column[0].set_title(name)
        figure.align_ylabels(column)
    handles, names = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside upper left", ncols=len(names), frameon=False)
    return drawn(list(grid.ravel()), parts)


UNITS = {"d_s": "1/m", "y1": "", "y2": "", "y3": "1/m"}
"""Of quantities that are no velocity."""


def _named(run: Run, coordinates: Array, image: bool) -> dict[str, Array]:
    """The unknown quantities, and if asked for the image coordinates and the inverse depth before them."""
    view, choice = run.recording.view, _choice(run)
    found = choice.quantities(coordinates[:, -len(choice.unknown) :])
    if not image:
        return found
    y = coordinates[:, :2]
    if isinstance(view, LinearView):
        y = y / np.where(coordinates[:, 2:3] > 0, coordinates[:, 2:3], np.nan)
    return {"y1": y[:, 0], "y2": y[:, 1], "y3": view.inverse(coordinates)} | found


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
