"""Figures of structure and motion, and of many points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from percept_obs.figures import base, curves, describe, look
from percept_obs.figures.base import Array, Drawing, canvas, canvases, figure, legend_above, rows
from percept_obs.points import PointsRun
from percept_obs.points.gramian import DecayBound
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

    See Also
    --------
    cases : Several of them.
    """
    runs = base.require_several(runs, Run, "track()")
    labels = base.labels_for(labels, [run.observer.name for run in runs])
    first, choice = runs[0], _choice(runs[0])
    alike = (replace(_choice(run), scale=choice.scale) == choice for run in runs)
    if not all(alike) or not all(np.array_equal(run.elapsed, first.elapsed) for run in runs):
        raise ValueError("the runs have different unknowns or times; draw them one by one")
    if any(run.recording.truth is None for run in runs):
        raise ValueError("there is no truth to compare with; figures.signals(run) draws a run without one")
    true = _quantities(first, first.truth, image)
    found = [_quantities(run, run.estimate, image) for run in runs]
    stack = rows(axes, [1.5] * len(true), list(true))
    shown = "Image coordinates, inverse depth and unknown quantities" if image else "Unknown quantities"
    yield f"{shown} from {first.elapsed[0]:g} to {first.elapsed[-1]:g} s, a row each."
    for ax, (name, truth) in zip(stack, true.items(), strict=True):
        unit = UNITS.get(name, "m/s")
        estimates = np.array([each[name] for each in found])
        ax.plot(first.elapsed, truth, **look.TRUTH)
        curves.draw(ax, first.elapsed, estimates, labels)
        ax.set_ylabel(f"${name[0]}_{{{name[1:].lstrip('_')}}}$" + (f" ({unit})" if unit else ""))
        ends = [f"{label} {_end(one)}" for label, one in zip(labels, estimates, strict=True)]
        yield f"{name}{f' in {unit}' if unit else ''}: the truth, {describe.span(truth)}; at the end {', '.join(ends)}."
        yield curves.linear(ax, _values_around(truth), estimates, f"the estimates of {name}", reach=0.0)
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

    See Also
    --------
    quantities : One case.
    """
    runs_of = {name: [runs] if isinstance(runs, Run) else list(runs) for name, runs in columns.items()}
    unknown = {name: len(_choice(runs[0]).unknown) for name, runs in runs_of.items() if runs}
    if len(set(unknown.values())) != 1 or len(unknown) < len(runs_of):
        counts = {name: unknown.get(name, "no run") for name in runs_of}
        raise ValueError(f"cases with equally many unknown quantities are needed, not {counts}; draw them one by one")
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
    base.root_figure(axes[0]).legend(handles, names, loc="outside upper left", ncols=len(names), frameon=False)
    return axes


UNITS = {"d_s": "1/m", "y1": "", "y2": "", "y3": "1/m"}
"""Units of quantities that are no velocity."""


def _quantities(run: Run, coordinates: Array, image: bool) -> dict[str, Array]:
    """Return the unknown quantities by name, if `image` after the image y1, y2 and the inverse depth y3."""
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


def _values_around(truth: Array) -> Array:
    """Return values that an axis should hold: the truth plus and minus a quarter of its size, or 0.1 if it is 0."""
    size = np.abs(describe.finite(truth)).max()
    around = 0.25 * size if size > 0 else 0.1
    return np.concatenate([truth - around, truth + around])


def _end(estimates: Array) -> str:
    missing = int(np.isnan(estimates).sum())
    gaps = f" ({missing} of {len(estimates)} estimates are missing)" if missing else ""
    return ("nothing" if np.isnan(estimates[-1]) else f"{estimates[-1]:.4g}") + gaps


@figure("there is no run, one has no truth, or its error is not positive where it is fitted")
def error_norm(
    runs: PointsRun | Sequence[PointsRun],
    labels: Sequence[str] | None = None,
    bound: DecayBound | None = None,
    fitted: tuple[float, float] = (-np.inf, np.inf),
    ax: Axes | None = None,
) -> Drawing:
    """Norm of each run's error, with the exponential fitted to it, and what the proof guarantees of the first one.

    Parameters
    ----------
    runs : PointsRun or sequence of PointsRun
        On recordings with a truth.
    bound : DecayBound, optional
        Of the first run's observer, a multiple of the identity for P.
    fitted : two times
        Between which the exponential is fitted, in seconds.

    Examples
    --------
    >>> from percept_obs import Camera, figures, luenberger, record, track
    >>> from percept_obs.points.scenarios import moving_body
    >>> recording = record(moving_body(1), 4, Camera(0.1))
    >>> run = track(recording, luenberger(recording.view), recording.truth[0] + 0.1)
    >>> print(figures.error_norm(run).text.split(". ")[-1])
    Luenberger, constant P: from 0.17 to 0.095 in 4 s, decaying at 0.111 per second.

    See Also
    --------
    percept_obs.points.gramian.decay_bound : What the proof guarantees.
    """
    runs = base.require_several(runs, PointsRun, "track()")
    names = base.labels_for(labels, [run.observer.name for run in runs])
    rates = [run.decay_rate(*fitted) for run in runs]
    ax = canvas(ax, 3.6)
    yield "Norm of the error over time, on a logarithmic axis."
    for number, (run, name, rate) in enumerate(zip(runs, names, rates, strict=True)):
        own = look.style(number)
        ax.plot(run.time, run.deviation, color=own["color"], linewidth=1.5, label=f"{name}: {rate:.2g} per s")
        part = np.flatnonzero((run.time >= fitted[0]) & (run.time <= fitted[1]))
        middle = np.exp(np.mean(np.log(run.deviation[part])) - rate * (run.time[part] - run.time[part].mean()))
        ax.plot(run.time[part], middle, color=own["color"], linewidth=1, linestyle=own["linestyle"])
        yield (
            f"{name}: from {run.deviation[0]:.2g} to {run.deviation[-1]:.2g} in {run.time[-1] - run.time[0]:.3g} s, "
            f"decaying at {rate:.3g} per second."
        )
    if bound is not None:
        steps = np.sqrt(np.cumprod([1.0, *bound.contraction]))
        ends = [*bound.time, bound.time[-1] + bound.window]
        at = float(np.interp(bound.time[0], runs[0].time, runs[0].deviation))
        name = f"bound: {bound.rate:.2g} per s"
        ax.plot(ends, at * steps, label=name, color=look.BLACK, linewidth=1.2, linestyle=":")
        yield f"The proof guarantees {bound.rate:.2g} per second over windows of {bound.window:g} s."
    yield curves.log(ax, np.concatenate([run.deviation for run in runs]), "the errors")
    ax.set(xlabel="time (s)", ylabel=r"norm of the error $|\rho|$")
    legend_above(ax)
    return [ax]


@figure("there is none, or a name has none")
def depth_errors(errors: Mapping[str, ArrayLike], after: float, ax: Axes | None = None) -> Drawing:
    """Relative errors of depths, each one and their median, for several ways of estimating them.

    Parameters
    ----------
    errors : mapping of names to arrays
        From `percept_obs.studies.comparison.relative_distance_errors`; infinite where an estimate is behind the camera.
    after : float
        Seconds since first sight, for the describe.

    Examples
    --------
    >>> from percept_obs import figures
    >>> print(figures.depth_errors({"mine": [0.01, 0.03, 0.02]}, after=2).text.split(". ")[-1])
    mine: 3 sightings, median 2.0%, at most 3.0%.

    See Also
    --------
    percept_obs.structure.PatchDepth : One way of estimating.
    """
    known = {name: np.asarray(values, dtype=float).ravel() for name, values in errors.items()}
    if not known or not all(len(values) and (values >= 0).all() for values in known.values()):
        raise ValueError("each name needs relative errors, of at least one sighting, from 0 on and without NaN")
    ax = canvas(ax, 1.0 + 0.5 * len(known))
    ax.grid(False, axis="y")
    seen = describe.finite(np.concatenate(list(known.values())))
    low, high = max(seen.min(initial=1.0), 1e-4), max(seen.max(initial=0.0), 1.0)
    yield f"Relative errors of the depth {after:g} s after first sight, on a logarithmic axis."
    for row, (name, values) in enumerate(known.items()):
        median = float(np.median(values))
        shown, middle = np.clip(values, low, 2 * high), float(np.clip(median, low, 2 * high))
        ax.plot(shown, np.full_like(shown, row), color=look.SKY, linestyle="", marker="|", markersize=12)
        ax.plot(middle, row, color=look.VERMILLION, marker="o")
        ax.annotate(f"{median:.1%}", (middle, row), (0, 8), textcoords="offset points")
        behind = int(np.isinf(values).sum())
        worst = f"{behind} of them behind the camera" if behind else f"at most {values.max():.1%}"
        yield f"{name}: {len(values)} sightings, median {median:.1%}, {worst}."
    ax.set_xscale("log")
    ax.set_xlim(low / 1.5, 3 * high)
    ax.set_yticks(range(len(known)), list(known))
    ax.set_ylim(len(known) - 0.5, -0.7)
    ax.axvline(1.0, color=look.GREY, linewidth=0.8, linestyle=":")
    ax.set_xlabel(f"relative error of the depth after {after:g} s; the dots are medians")
    return [ax]
