"""Figures of studies: comparison, chatter, settings, believed motion, trust and diagnosis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter

from percept_obs.figures import base, curves, describe, look
from percept_obs.figures.base import Drawing, canvas, canvases, figure, legend_above
from percept_obs.studies.chatter import Effort
from percept_obs.studies.comparison import Comparison
from percept_obs.studies.diagnosis import Diagnosis
from percept_obs.studies.diagnosis.causes import CAUSES
from percept_obs.studies.sensitivity import SHARE, Sensitivity
from percept_obs.studies.servoing import GOAL, Servoing
from percept_obs.validation import Kind, are_numbers

if TYPE_CHECKING:
    import pandas as pd

PANELS = {"settling_time": "settling time (s)", "rms": "rms error of 1/distance (1/m)"}

AXIS_END = 4.0
"""Ends of the axis of causes, in usual sizes of a mistake to either side."""

_RUN: dict[str, Any] = {"color": look.SKY, "linestyle": "", "marker": "|", "markersize": 12}
_SPREAD: dict[str, Any] = {"color": look.BLACK, "linewidth": 1.6, "marker": "|", "markersize": 6}
_MEDIAN: dict[str, Any] = {"color": look.BLACK, "linestyle": "", "marker": "o", "markersize": 5}
_NONE: dict[str, Any] = {"color": look.VERMILLION, "linestyle": "", "marker": "X", "markersize": 8}
_KEY = {
    "a run": _RUN,
    "median": _MEDIAN,
    "16 to 84 % of the runs": _SPREAD,
    "none: half of the runs fail, or more": _NONE,
}


@figure("there are no runs or no settling times, or there are not two axes")
def comparison(found: Comparison, axes: Sequence[Axes] | None = None) -> Drawing:
    """Settling time and root mean square error of every observer: each run, the median, and 16 to 84 % of the runs.

    A run that does not settle has no settling time, and one that diverged has no error: what they lack stands at the
    right edge, and how many they are beside the observer's name.

    Parameters
    ----------
    found : Comparison
        From `percept_obs.studies.comparison.compare`.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, ibo, pinhole, record, scenarios
    >>> from percept_obs.studies.comparison import compare
    >>> observer = ibo(PerspectiveSystem(affine(), pinhole()))
    >>> print(figures.comparison(compare([record(scenarios.ma2005_eq35(), 5)], [observer])).text.split(". ")[0])
    Settling time and rms error of every observer, on logarithmic axes
    """
    if not len(found.table) or not {*PANELS} <= set(found.table.columns):
        raise ValueError("the comparison has no such runs; compare(recordings, observers) makes one that has")
    summary = found.summary
    pair = canvases(axes, ["settling time", "error"], 1.3 + 0.42 * len(summary), ncols=2, sharey=True)
    for ax, (column, title) in zip(pair, PANELS.items(), strict=True):
        _draw_runs(ax, found.table, summary, column)
        ax.set_xlabel(title)
        ax.set_yticks(range(len(summary)), [f"{label}\n{_counts(row)}" for label, row in summary.iterrows()])
        ax.set_ylim(len(summary) - 0.5, -0.5)
    picture = base.root_figure(pair[0])
    picture.legend(
        handles=[Line2D([], [], label=name, **looks) for name, looks in _KEY.items()],
        loc="outside upper center" if picture.get_layout_engine() else "upper center",
        ncols=2,
        frameon=False,
    )
    yield "Settling time and rms error of every observer, on logarithmic axes."
    for label, row in summary.iterrows():
        yield f"{label}: {_counts(row)}; {_medians(row)}."
    return pair


def _draw_runs(ax: Axes, table: pd.DataFrame, found: pd.DataFrame, column: str) -> None:
    ax.grid(False, axis="y")
    ax.set_xscale("log")
    seen = describe.finite(table[column])
    seen = seen[seen > 0]
    low, high = (seen.min(), seen.max()) if seen.size else (0.1, 1.0)
    margin = max((high / low) ** 0.08, 1.2)
    edge = high * margin
    ax.set_xlim(low / margin, edge * margin**0.7)
    for place, (label, row) in enumerate(found.iterrows()):
        # what is 0 has no logarithm, and what is infinite no place
        own = np.clip(describe.finite(table.loc[table["observer"] == label, column]), low, edge)
        low_end, middle, high_end = (np.clip(row[column + end], low, edge) for end in ("_low", "", "_high"))
        ax.plot(own, np.full_like(own, place), **_RUN)
        ax.plot([low_end, high_end], [place, place], **_SPREAD)
        ax.plot(middle, place, **(_MEDIAN if np.isfinite(row[column]) else _NONE))


def _counts(row: pd.Series) -> str:
    """Return the numbers of runs that failed, were reset or diverged as text."""
    counts = [f"{row['failed']:.0f} of {row['runs']:.0f} fail"]
    counts += [f"{row[name]:.0f} {how}" for name, how in (("reset", "reset"), ("diverged", "diverge")) if row[name]]
    return ", ".join(counts)


def _medians(row: pd.Series) -> str:
    """Return a sentence with the medians and the 16 and 84 % quantiles of settling time and rms error."""
    sentences = []
    for column, what, unit in (("settling_time", "settling time", "s"), ("rms", "rms error", "1/m")):
        values = (row[column + end] for end in ("", "_low", "_high"))
        middle, low, high = (f"{value:.2g} {unit}" if np.isfinite(value) else "none" for value in values)
        sentences.append(f"{what} {middle} in the median, {low} to {high} for 16 to 84 % of the runs")
    return "; ".join(sentences)


@figure("a comparison has no such columns, or the axes are too few")
def efficiencies(cases: Mapping[str, Comparison], axes: Sequence[Axes] | None = None) -> Drawing:
    """Error over the Cramer-Rao bound against the settling time of every observer, one panel a case.

    Fast ones stand on the left, efficient ones below; nobody stands below the line but by chance.  Observers of which
    half of the runs do not settle are left out, and named in the text.

    Parameters
    ----------
    cases : mapping of labels to Comparison
        With the columns settling_time and over_bound.

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, ekf, figures, pinhole, record, scenarios
    >>> from percept_obs.studies.comparison import compare, over_bound
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1")
    >>> seen = [record(scenarios.ma2005_eq35(), 8, Camera(0.05, Gaussian(0.01)), seed) for seed in range(2)]
    >>> found = compare(seen, [ekf(form)], columns={"over_bound": over_bound(form)})
    >>> figures.efficiencies({"one output": found}).text.split(". ")[0]
    'Error over the Cramer-Rao bound against the settling time, on logarithmic axes'
    """
    if not cases or not all({"settling_time", "over_bound"} <= set(each.table) for each in cases.values()):
        raise ValueError('give comparisons with "settling_time" and "over_bound"; compare(..., columns=...) makes them')
    columns = min(3, len(cases))
    lines = -(-len(cases) // columns)
    parts = [*cases, *["nothing"] * (lines * columns - len(cases))]
    panels = canvases(axes, parts, 2.6 * lines + 1.2, ncols=columns, nrows=lines, sharex=True, sharey=True)
    summaries = {case: each.summary for case, each in cases.items()}
    observers = dict.fromkeys(name for each in summaries.values() for name in each.index)
    looks = {
        name: {**look.style(k), "linestyle": "", "markersize": 9 - 4 * (k % 2)} for k, name in enumerate(observers)
    }
    for ax in panels[len(cases) :]:
        ax.set_axis_off()
    yield "Error over the Cramer-Rao bound against the settling time, on logarithmic axes."
    for ax, (case, rows) in zip(panels, summaries.items(), strict=False):
        ax.set(title=case, xscale="log", yscale="log", xlabel="settling time (s)", ylabel="error / bound")
        ax.label_outer()
        ax.tick_params(labelbottom=ax in panels[max(len(cases) - columns, 0) : len(cases)])
        ax.xaxis.set_minor_formatter(NullFormatter())
        ax.axhline(1, **look.BOUND)
        there = rows[np.isfinite(rows["settling_time"]) & np.isfinite(rows["over_bound"])]
        for row in there.itertuples():
            ax.plot([row.settling_time], [row.over_bound], **looks[row.Index])
        said = [f"{row.Index} {row.over_bound:.3g} after {row.settling_time:.2g} s" for row in there.itertuples()]
        rest = rows.index.difference(there.index, sort=False)
        yield f"{case}: {', '.join(said) or 'nobody settles'}" + (
            f"; not settled: {', '.join(rest)}." if len(rest) else "."
        )
    handles = [Line2D([], [], label=name, **each) for name, each in looks.items()]
    base.root_figure(panels[0]).legend(handles=handles, loc="outside upper center", ncols=3, frameon=False)
    return panels


@figure("there are no loops, or there are not three axes")
def servoing(loops: Mapping[str, Servoing], axes: Sequence[Axes] | None = None) -> Drawing:
    """Image error, error of the believed depth, and excitation of closed loops: medians over starts and points.

    Parameters
    ----------
    loops : mapping of labels to Servoing
        From `percept_obs.studies.servoing.servo`.

    Examples
    --------
    >>> from percept_obs import figures
    >>> from percept_obs.studies.servoing import servo, starts
    >>> loops = {depth: servo(starts(3), depth, duration=2.0) for depth in ("true", "constant")}
    >>> print(figures.servoing(loops).text.split(". ")[0])
    Image error, error of the believed depth and excitation of 2 closed loops over 2 s, on logarithmic axes
    """
    if not loops:
        raise ValueError("there are no loops to draw; servo(starts(20), 'true') makes one")
    panels = base.rows(axes, (1.6, 1.6, 1.6), ["image error", "error of the depth", "excitation"])
    names = (r"$|y - y^{*}|$", "|error of the depth|", r"$|w|^2$ (m$^2$/s$^2$)")
    time = next(iter(loops.values())).time
    yield (
        f"Image error, error of the believed depth and excitation of {len(loops)} closed loops over {time[-1]:.3g} s, "
        "on logarithmic axes."
    )
    for k, (label, run) in enumerate(loops.items()):
        size = np.median(np.linalg.norm(run.image_error, axis=-1), axis=0)
        shown = (size, *(np.median(np.abs(each), axis=(0, 2)) for each in (run.depth_error, run.excitation)))
        for ax, values in zip(panels, shown, strict=True):
            ax.plot(run.time, np.maximum(values, 1e-6), label=label, markevery=len(time) // 8 + 1, **look.style(k))
        said = ", ".join(f"{values[0]:.2g} to {values[-1]:.2g}" for values in shown)
        yield f"{label}, from the start to the end: {said}."
    for ax, name in zip(panels, names, strict=True):
        ax.set(yscale="log", ylabel=name)
    panels[-1].set_xlabel("time (s)")
    legend_above(panels[0])
    return panels


@figure("there are no loops, or there are not two axes")
def camera_ways(loops: Mapping[str, Servoing], start: int = 0, axes: Sequence[Axes] | None = None) -> Drawing:
    """The camera's way from above on the left, and on the right what it sees of its four points, from one start.

    Parameters
    ----------
    loops : mapping of labels to Servoing
        From `percept_obs.studies.servoing.servo`.
    start : int
        Which start of the loops.

    Examples
    --------
    >>> from percept_obs import figures
    >>> from percept_obs.studies.servoing import servo, starts
    >>> print(figures.camera_ways({"true depth": servo(starts(3), "true", duration=6.0)}).text.split(". ")[1])
    true depth: the camera begins 0.7 m from the goal, and ends 0.01 m from it.
    """
    if not loops:
        raise ValueError("there are no loops to draw; servo(starts(20), 'true') makes one")
    above, seen = canvases(axes, ["the camera's way", "its picture"], 4.2, ncols=2)
    yield "Left, the camera's way from above, with its goal at the origin; right, the points' ways in its picture."
    for k, (label, loop) in enumerate(loops.items()):
        looks = look.style(k) | {"marker": ""}
        way = loop.camera(start)
        above.plot(way[:, 0], way[:, 2], label=label, **looks)
        above.plot(*way[0, [0, 2]], color=look.BLACK, **look.START | {"label": "" if k else "start"})
        images = loop.coordinates[start, ..., :2]
        seen.plot(images[..., 0], images[..., 1], **looks)
        seen.plot(*images[0].T, color=look.BLACK, **look.START | {"label": ""})
        first, last = np.linalg.norm(way[[0, -1]], axis=1)
        yield f"{label}: the camera begins {first:.1f} m from the goal, and ends {abs(round(last, 2)):g} m from it."
    above.plot(GOAL[:, 0], GOAL[:, 2], color=look.BLACK, linestyle="", marker="x", label="points")
    above.plot(0, 0, color=look.BLACK, **look.END | {"label": "goal"})
    seen.plot(*next(iter(loops.values())).goal[:, :2].T, color=look.BLACK, **look.END | {"label": ""})
    above.set(xlabel="to the right (m)", ylabel="ahead (m)", aspect="equal")
    seen.set(xlabel="$y_{1}$", ylabel="$y_{2}$", aspect="equal")
    seen.invert_yaxis()  # as in a picture: y2 points down
    legend_above(above, fitting=40)
    return [above, seen]


@figure("there is nothing to draw on one of the sides, or there are not two axes")
def chatter(
    errors: Mapping[str, pd.DataFrame], efforts: Mapping[str, Effort], axes: Sequence[Axes] | None = None
) -> Drawing:
    """Errors over the step of integration on the left, steps of adaptive solvers over time on the right.

    Parameters
    ----------
    errors : mapping of labels to tables
        From `percept_obs.studies.chatter.chatter`; the last coordinate, the inverse distance, is drawn.
    efforts : mapping of labels to Effort
        From `percept_obs.studies.chatter.effort`.  Curves with the same label look the same on both sides.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, pinhole, record, scenarios, smo
    >>> from percept_obs.studies.chatter import chatter, effort
    >>> scene, observer = scenarios.ma2005_eq35(), smo(PerspectiveSystem(affine(), pinhole()))
    >>> errors = chatter(record(scene, 1), observer, [0.01, 0.005])
    >>> len(figures.chatter({"smo": errors}, {"smo": effort(scene, observer, 0.2)}).axes)
    2
    """
    if not errors or not efforts:
        raise ValueError(f"there are {len(errors)} tables and {len(efforts)} efforts; at least one of each is needed")
    left, right = canvases(axes, ["errors", "steps"], 3.6, ncols=2)
    looks = {label: look.style(number) for number, label in enumerate({**errors, **efforts})}
    yield "Left, rms error over the step of integration; right, steps of adaptive solvers; logarithmic axes."
    for label, table in errors.items():
        inverse = table.columns[-1]
        left.plot(table["step"], table[inverse], label=label, **looks[label])
        told = [f"{row['step']:.2g} s {row[inverse]:.2g}" for _, row in table.iterrows()]
        yield f"{label}: error at a step of {', '.join(told)}."
    left.set(xscale="log", yscale="log")
    left.set(xlabel="step of integration (s)", ylabel=f"rms error of {describe.letter(inverse)} (1/m)")
    for label, one in efforts.items():
        name = "_" + label if label in errors else label
        right.plot(one.time[1:], one.steps, linewidth=1.2, label=name, **looks[label] | {"marker": ""})
        how = "arrived at" if one.finished else "gave up at"
        yield (
            f"{label}: RK45 {how} {one.time[-1]:.2g} s after {one.evaluations[-1]} evaluations; its steps "
            f"were {one.steps.min():.2g} to {one.steps.max():.2g} s long."
        )
    right.set(yscale="log", xlabel="time (s)", ylabel="step that the solver took (s)")
    legend_above(left, fitting=40)
    if set(efforts) - set(errors):
        legend_above(right, fitting=40)
    return [left, right]


Values = Annotated[Any, Kind("an xarray.DataArray", lambda v: hasattr(v, "dims") and hasattr(v, "squeeze"))]


@figure("the values do not have exactly two dimensions of several settings")
def settings_map(values: Values, ax: Axes | None = None) -> Drawing:
    """A number over two settings; grey where it is infinite or there is none.

    Parameters
    ----------
    values : xarray.DataArray
        With two dimensions, such as ``ensemble(...).settling_time.isel(seed=0)``; the first one goes up.

    Examples
    --------
    >>> import xarray as xr
    >>> from percept_obs import figures
    >>> errors = xr.DataArray([[1.0, 2.0], [3.0, 4.0]], {"gain": [5, 10], "noise": [0.0, 0.1]}, name="error")
    >>> print(figures.settings_map(errors).text.split(". ")[-1])
    Largest: 4 at noise 0.1 and gain 10.
    """
    values = values.squeeze()
    if values.ndim != 2:
        raise ValueError(f"a map needs two dimensions; there are {values.ndim}: {', '.join(values.dims) or 'none'}")
    up, right = values.dims
    ax = canvas(ax, 3.6)
    if other := [each.name for each in (values, values[up], values[right]) if not are_numbers(each.values)]:
        raise ValueError(f"{other[0]} holds something else than real numbers; a map needs numbers over numbers")
    numbers = np.where(np.isfinite(values.values), values.values, np.nan)
    known = np.isfinite(numbers)
    ax.set_facecolor(look.LIGHT)
    drawn = ax.pcolormesh(values[right], values[up], numbers, shading="nearest", cmap="viridis")
    ax.grid(visible=False)
    ax.set(xlabel=_with_unit(values[right]), ylabel=_with_unit(values[up]))
    base.root_figure(ax).colorbar(drawn, ax=ax, label=_with_unit(values))
    yield f"{_with_unit(values)} over {_with_unit(values[right])} and, upwards, {_with_unit(values[up])}."
    if not known.any():
        yield "There is no finite value."
        return [ax]
    for word, place in (("Least", np.nanargmin(numbers)), ("Largest", np.nanargmax(numbers))):
        row, column = np.unravel_index(place, numbers.shape)
        at = f"{right} {values[right].values[column]:.3g} and {up} {values[up].values[row]:.3g}"
        yield f"{word}: {numbers[row, column]:.3g} at {at}."
    yield f"Finite at {100 * known.mean():.0f} % of the places; grey elsewhere." if not known.all() else ""
    return [ax]


def _with_unit(values: Any) -> str:
    """Return a name with its unit."""
    unit = values.attrs.get("units", "1")
    return str(values.name) if unit == "1" else f"{values.name} ({unit})"


@figure("it is something else, or fewer than one entry is asked for")
def entries(found: Sensitivity, most: int = 4, ax: Axes | None = None) -> Drawing:
    """By how much the distance moves when one entry of the motion is off, for those entries that matter most.

    It is off by a hundredth of the motion's size: of all of A, or of all of b.

    Parameters
    ----------
    found : Sensitivity
        From `percept_obs.studies.sensitivity.sensitivity`.
    most : int
        How many entries to draw.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, ibo, pinhole, record, scenarios
    >>> from percept_obs.studies.sensitivity import sensitivity
    >>> observer = ibo(PerspectiveSystem(affine(), pinhole()))
    >>> found = sensitivity(record(scenarios.ma2005_eq35(), 10), observer)
    >>> print(figures.entries(found, most=1).text.split(". ")[1])
    a32: 9.4 % in the median of the last half
    """
    if most < 1:
        raise ValueError(f"the {most} most important entries were asked for; draw one at least")
    ax = canvas(ax, 3.2)
    ranking, changes = found.ranking(), 100 * found.distance_change()
    drawn = list(ranking)[:most]
    shown = np.array([changes[:, found.entries.index(name)] for name in drawn])
    curves.draw(ax, found.run.elapsed, shown, [describe.letter(name) for name in drawn])
    ax.set(xlabel="time (s)", ylabel=f"{describe.depth_or_range(found.run.view)[0]} moves by (%)")
    size = f"{100 * SHARE:g} % of the motion's size"
    yield f"By how much the estimated distance moves when one entry of the motion is off by {size}, for {len(drawn)}."
    yield "; ".join(f"{name}: {100 * ranking[name]:.2g} % in the median of the last half" for name in drawn) + "."
    others = list(ranking)[most:]
    yield f"Less than these: {', '.join(others)}." if others else ""
    late = shown[:, len(found.run.time) // 10 :]
    yield curves.linear(ax, curves.bulk(late), shown, "the changes", reach=0.5)
    legend_above(ax)
    return [ax]


@figure("it is something else, or the samples are pixels, so that nothing was fitted")
def causes(found: Diagnosis, ax: Axes | None = None) -> Drawing:
    """Wrong numbers that a diagnosis fitted, with two standard deviations, in the size that mistakes usually have.

    Parameters
    ----------
    found : Diagnosis
        From `percept_obs.diagnose`.

    Examples
    --------
    >>> from dataclasses import replace
    >>> import numpy as np
    >>> from percept_obs import Camera, Gaussian, Scenario, diagnose, figures, pinhole, record, rigid
    >>> def motion(late=0):
    ...     turning = lambda t: [-0.3 * np.sin(2 * t - 2 * late), -0.3 * np.cos(t - late), 0]
    ...     return rigid(camera_angular_velocity=turning, camera_velocity=[1, 0, 0])
    >>> scene = Scenario("mine", motion(), (0.2, 0.1, 5), 4, pinhole())
    >>> seen = record(scene, camera=Camera(0.05, Gaussian(0.002)))
    >>> figures.causes(diagnose(replace(seen, motion=motion(0.1)))).figure.axes[0].get_yticklabels()[0]
    Text(0, 0, 'time offset (in 0.05 s)')
    """
    if not found.estimates:
        raise ValueError(f"nothing was fitted: {found.sentence}")
    ax = canvas(ax, 2.8)
    named = [each.key for each in found.findings]
    for row, (key, estimate) in enumerate(found.estimates.items()):
        cause = CAUSES[key]
        told = key not in found.not_told
        color = look.VERMILLION if key in named else look.BLUE if told else look.GREY
        value = float(np.linalg.norm(estimate.value)) if cause.size > 1 else float(estimate.value[0])
        width = min(2 * estimate.deviation / cause.usual, 2 * AXIS_END)
        ax.errorbar(value / cause.usual, row, xerr=width, color=color, marker="o", capsize=3)
    ax.axvline(0, color=look.BLACK, linewidth=1)
    labels = [f"{key} (in {CAUSES[key].size_in_words})" for key in found.estimates]
    ax.set_yticks(range(len(labels)), labels)
    ax.set(xlim=(-AXIS_END, AXIS_END), xlabel="wrong by so many times the usual size of the mistake")
    ax.invert_yaxis()
    yield "Numbers that may be wrong, each with two standard deviations; grey where the motion cannot tell."
    yield found.sentence
    return [ax]
