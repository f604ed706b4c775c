"""The figures of structure and motion: every unknown quantity over time, true and estimated; cases side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures import axis, curves, given, look, words
from percept_obs.figures.base import Array, Drawing, canvases, figure, legend_above, rows
from percept_obs.structure import LinearView, StructureAndMotion
from percept_obs.tracking.run import Run


@figure("runs, labels or axes do not fit each other, or there is no truth")
def quantities(
    runs: Run | Sequence[Run],
    labels: Sequence[str] | None = None,
    axes: Sequence[Axes] | None = None,
    image: bool = False,
) -> Drawing:
    """The scale and the velocities that were unknown, a row each.

    The axes show the truth's neighbourhood.  Curves have gaps where an estimate is missing, or its d_s is not positive.
    Where d_s was found in an earlier stage, the truth is drawn in the scale that the first run's stage found.

    Parameters
    ----------
    runs : Run or sequence of Run
        Of one choice of what is unknown, at the same times and with a truth; on (y1, y2, ybar3) or its linear view.
    image : bool
        Whether the image coordinates y1, y2 and the inverse depth y3 = 1/Z have a row each as well, above the others.

    Examples
    --------
    >>> from percept_obs import figures, ismo, record, track
    >>> from percept_obs.structure import ScaledDepthCamera
    >>> from percept_obs.structure.scenarios import chwa2019_experiment
    >>> recording = record(chwa2019_experiment("IV.A"), 1, ScaledDepthCamera(0.01))
    >>> run = track(recording, ismo(recording.view.form), step=0.01)
    >>> [ax.get_ylabel() for ax in figures.quantities(run).axes]
    ['$d_{s}$ (1/m)', '$v_{c2}$ (m/s)', '$v_{c3}$ (m/s)']
    """
    runs = given.several(runs, Run, "track()")
    labels = given.labels_for(labels, [run.observer.name for run in runs])
    first, choice = runs[0], _choice(runs[0])
    alike = (replace(_choice(run), scale=choice.scale) == choice for run in runs)
    if not all(alike) or not all(np.array_equal(run.elapsed, first.elapsed) for run in runs):
        raise ValueError("the runs have different unknowns or times; draw them one by one")
    if any(run.recording.truth is None for run in runs):
        raise ValueError("there is no truth to compare with; figures.signals(run) draws a run without one")
    true = _named(first, first.truth, image)
    found = [_named(run, run.estimate, image) for run in runs]
    stack = rows(axes, [1.5] * len(true), list(true))
    looks = [look.style(number) for number in range(len(runs))]
    shown = "Image coordinates, inverse depth and unknown quantities" if image else "Unknown quantities"
    yield f"{shown} from {first.elapsed[0]:g} to {first.elapsed[-1]:g} s, a row each."
    for ax, (name, truth) in zip(stack, true.items(), strict=True):
        unit = UNITS.get(name, "m/s")
        estimates = np.array([each[name] for each in found])
        ax.plot(first.elapsed, truth, **look.TRUTH)
        curves.draw(ax, first.elapsed, estimates, labels, looks)
        ax.set_ylabel(f"${name[0]}_{{{name[1:].lstrip('_')}}}$" + (f" ({unit})" if unit else ""))
        ends = [f"{label} {_end(one)}" for label, one in zip(labels, estimates, strict=True)]
        yield f"{name}{f' in {unit}' if unit else ''}: the truth, {words.span(truth)}; at the end {', '.join(ends)}."
        yield axis.linear(ax, _neighbourhood(truth), estimates, f"the estimates of {name}", reach=0.0)
    legend_above(stack[0])
    return stack


@figure("there is no case, their numbers of rows differ, or `quantities` refuses one of them")
def cases(
    columns: Mapping[str, Run | Sequence[Run]], labels: Sequence[str] | None = None, image: bool = False
) -> Drawing:
    """Several cases side by side, a column each with the rows of `quantities`.

    Parameters
    ----------
    columns : mapping of names to runs
        The runs of each case, as `quantities` takes them; equally many runs and rows in each.
    image : bool
        As in `quantities`.

    Examples
    --------
    >>> from percept_obs import figures, ismo, record, track
    >>> from percept_obs.structure import ScaledDepthCamera
    >>> from percept_obs.structure.scenarios import chwa2019_experiment
    >>> recording = record(chwa2019_experiment("IV.A"), 1, ScaledDepthCamera(0.01))
    >>> run = track(recording, ismo(recording.view.form), step=0.01)
    >>> len(figures.cases({"IV.A": run}).axes)
    3
    """
    runs_of = {name: [runs] if isinstance(runs, Run) else list(runs) for name, runs in columns.items()}
    unknown = {name: len(_choice(runs[0]).unknown) for name, runs in runs_of.items() if runs}
    if len(set(unknown.values())) != 1:
        raise ValueError(f"cases with equally many unknown quantities are needed, not {unknown}; draw them one by one")
    count = next(iter(unknown.values())) + 3 * image
    layout = {"nrows": count, "ncols": len(runs_of), "sharex": "col"}
    axes = canvases(None, [*runs_of] * count, 1.1 * count + 0.9, **layout)
    for number, (name, runs) in enumerate(runs_of.items()):
        column = axes[number :: len(runs_of)]
        yield f"{name}: {quantities(runs, labels, column, image).text}"
        legend: Any = column[0].get_legend()
        legend.remove()
        column[0].set_title(name)
    handles, names = axes[0].get_legend_handles_labels()
    whole: Any = axes[0].get_figure(root=True)
    whole.legend(handles, names, loc="outside upper left", ncols=len(names), frameon=False)
    return axes


UNITS = {"d_s": "1/m", "y1": "", "y2": "", "y3": "1/m"}
"""Of quantities that are no velocity."""


def _named(run: Run, coordinates: Array, image: bool) -> dict[str, Array]:
    """The unknown quantities, and if asked for the image coordinates and the inverse depth before them."""
    view, choice = run.view, _choice(run)
    found = choice.quantities(coordinates[:, -len(choice.unknown) :])
    if not image:
        return found
    y = coordinates[:, :2]
    if isinstance(view, LinearView):
        y = y / np.where(coordinates[:, 2:3] > 0, coordinates[:, 2:3], np.nan)
    return {"y1": y[:, 0], "y2": y[:, 1], "y3": view.inverse(coordinates)} | found


def _choice(run: Run) -> StructureAndMotion:
    view = run.view
    choice = view.choice if isinstance(view, LinearView) else view
    if not isinstance(choice, StructureAndMotion):
        raise ValueError(f"the run is of the {view.name}, not of structure and motion")
    return choice


def _neighbourhood(truth: Array) -> Array:
    """Values that an axis should hold: a quarter of its size around the truth, or 0.1 around zero."""
    size = np.abs(words.finite(truth)).max()
    around = 0.25 * size if size > 0 else 0.1
    return np.concatenate([truth - around, truth + around])


def _end(estimates: Array) -> str:
    missing = int(np.isnan(estimates).sum())
    gaps = f" ({missing} of {len(estimates)} estimates are missing)" if missing else ""
    return ("nothing" if np.isnan(estimates[-1]) else f"{estimates[-1]:.4g}") + gaps
