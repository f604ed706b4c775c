"""Figures of observability: measures over time and windows, maps of the image and of the field of view."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.patches import Circle

from percept_obs.figures import base, curves, describe, image, look
from percept_obs.figures.base import Array, Drawing, canvas, canvases, figure, legend_above, rows
from percept_obs.observability.maps import BoundMap
from percept_obs.observability.measures import Observability
from percept_obs.observability.windows import Excitation, Windows
from percept_obs.points.gramian import Gramian
from percept_obs.studies.consistency import Consistency
from percept_obs.studies.fields import FieldBound


@figure("it is something else, or the number of axes is wrong")
def observability(found: Observability, axes: Sequence[Axes] | None = None) -> Drawing:
    """Each measure over time, one below the other: an instant, windows, derivatives, and the bound.

    Parameters
    ----------
    found : Observability
        From `percept_obs.how_observable`.

    Examples
    --------
    >>> from percept_obs import Camera, PerspectiveSystem, affine, figures, how_observable, pinhole, record, scenarios
    >>> found = how_observable(record(scenarios.planar(), 4, Camera(0.1)), PerspectiveSystem(affine(), pinhole()))
    >>> len(figures.observability(found).axes)
    4
    """
    begun, hidden = found.recording.time[0], found.form.hidden[-1]
    parts = ["an instant", "windows", "derivatives", "the bound"]
    instant, windows, derivatives, bound = rows(axes, [1.4, 1.8, 1.1, 1.8], parts)
    if found.instant is not None:
        spread = found.instant.eigenvalues
        _draw(instant, found.instant.time - begun, spread[:, -1], 1, "largest eigenvalue of $w w^T$")
        if spread.shape[1] > 1:
            _draw(instant, found.instant.time - begun, spread[:, 0], 0, "smallest")
    else:
        instant.text(0.5, 0.5, "no canonical form, and so no w", ha="center", transform=instant.transAxes)
    instant.set_ylabel("instant")
    if found.excitation is not None:
        _draw(windows, found.excitation.time - begun, found.excitation.smallest, 0, "excitation (window's end)")
    _draw(windows, found.error.time - begun, found.error.smallest, 1, "error Gramian (beginning)")
    ends: dict[str, Any] = {"linestyle": "", "marker": "o", "color": look.GREEN, "markersize": 4}
    windows.plot(
        found.empirical.time - begun,
        np.maximum(found.empirical.smallest, curves.ROUND_OFF),
        label="by perturbed runs",
        **ends,
    )
    windows.set_ylabel(f"{found.window:g} s windows")
    _draw(derivatives, found.lie.time - begun, found.lie.smallest, 0, "smallest singular value")
    derivatives.set_ylabel("derivatives")
    _draw(bound, found.bound.elapsed, found.bound.of(hidden), 1, f"bound of {describe.letter(hidden)}")
    column = [symbol.name for symbol in found.form.coordinates].index(hidden)
    _draw(bound, found.bound.elapsed, found.bound.predicted_deviation[:, column], 0, "without samples")
    bound.set_ylabel("std. deviation")
    for ax in (instant, windows, derivatives, bound):
        _logarithmic(ax)
        legend_above(ax)
    bound.set_xlim(0, found.recording.elapsed[-1])
    yield f"Measures of observability of {', '.join(found.form.measured)} over time, on logarithmic axes."
    for measure in found.measures:
        name, _, says, least, lost = measure.cells
        yield f"{name}: {says}, {least}{f'; not seen: {lost}' if lost else ''}."
    yield " ".join(found.disagreements)
    return [instant, windows, derivatives, bound]


def _draw(ax: Axes, time: Array, values: Array, number: int, name: str) -> None:
    own = look.style(number)
    shown = np.maximum(values, curves.ROUND_OFF)
    ax.plot(time, shown, label=name, color=own["color"], linestyle=own["linestyle"] if number else "-")


def _logarithmic(ax: Axes) -> None:
    """Make the axis logarithmic, over at most twelve powers of ten."""
    every = np.concatenate([np.ravel(np.asarray(line.get_ydata(), dtype=float)) for line in ax.lines] or [np.ones(1)])
    high = 3 * float(every.max())
    ax.set_yscale("log")
    ax.set_ylim(max(float(every.min()) / 3, 1e-12 * high), high)
    ax.minorticks_off()


@figure("it is something else, or the threshold is not positive")
def bound_map(found: BoundMap, threshold: float = 0.1, ax: Axes | None = None) -> Drawing:
    """Least error of the distance at each place of the image, on a logarithmic scale of colours.

    Over it the focus of expansion, where there is one, with both outputs and a constant motion the circle
    |w| = threshold, and with one output the lines on which w vanishes.

    Parameters
    ----------
    found : BoundMap
        From `percept_obs.bound_map`.
    threshold : float
        Positive; in m/s, as w is.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, bound_map, figures, pinhole
    >>> forwards = PerspectiveSystem(affine([[0.0] * 3] * 3, [0, 0, -0.5]), pinhole())
    >>> print(figures.bound_map(bound_map(forwards, resolution=11)).text.split(". ")[-1])
    The circle |w| = 0.1 around it has the radius 0.2.
    """
    if not threshold > 0:
        raise ValueError(f"the threshold is {threshold}; it must be positive")
    own, system = ax is None, found.system
    ax = canvas(ax, 5.6)
    percent = np.ma.masked_invalid(100 * found.relative)
    ends = (found.y1[0], found.y1[-1], found.y2[0], found.y2[-1])
    scale = LogNorm(*np.nanpercentile(100 * found.relative, [2, 100]))  # what comes near has the rest for itself
    colours: dict[str, Any] = {"norm": scale, "cmap": "viridis_r", "origin": "lower", "interpolation": "bilinear"}
    picture = ax.imshow(percent, extent=ends, **colours)
    ax.grid(False)
    ax.set(xlabel=describe.label("y1", system.surface), ylabel=describe.label("y2", system.surface))
    if own:
        base.root_figure(ax).colorbar(picture, ax=ax, shrink=0.8, label="least error of the distance (%)")
    best, worst = (
        np.unravel_index(pick(found.relative), found.relative.shape) for pick in (np.nanargmin, np.nanargmax)
    )
    yield (
        f"Least relative standard deviation of the distance after {found.seconds:g} s at each place of the image, "
        f"{', '.join(found.measured)} measured, of points {found.distance:g} m away at the beginning: "
        f"{percent[best]:.3g} % at best, at {_where(found, best)}, and {percent[worst]:.3g} % at worst, at "
        f"{_where(found, worst)}."
    )
    behind = int(np.isnan(found.relative).sum())
    yield f"{behind} of {found.relative.size} places are empty: a point comes behind the camera." if behind else ""
    yield _draw_zero_set(ax, found, threshold)
    ax.set(xlim=ends[:2], ylim=ends[2:])
    if ax.get_legend_handles_labels()[1]:
        legend_above(ax, centred=True, fitting=66)
    return [ax]


def _where(found: BoundMap, place: Sequence[Any]) -> str:
    return describe.place(np.array([found.y1[place[1]], found.y2[place[0]]]))


def _draw_zero_set(ax: Axes, found: BoundMap, threshold: float) -> str:
    """Draw where w vanishes or is small; return a sentence on it."""
    system = found.system
    centre = image.focus_of_expansion(system, np.zeros(1))[0] + 0.0  # so that no zero has a sign
    if not np.isfinite(centre).all():
        return "There is no focus of expansion in this plane."
    if len(found.measured) == 1:
        return image.draw_blind_lines(ax, system, *found.measured)
    ax.plot(*centre, label="focus of expansion", **look.FOCUS)
    told = f"The focus of expansion is at {describe.place(centre)}."
    radius = image.blind_radius(system, found.measured, threshold)
    if not np.isfinite(radius):
        return told
    name = f"$|w| = {threshold:g}$"
    ax.add_patch(Circle(centre, radius, fill=False, edgecolor=look.VERMILLION, linewidth=1.4, label=name))
    return f"{told} The circle |w| = {threshold:g} around it has the radius {radius:.3g}."


@figure("there is none, one has no finite value, or the number of labels is wrong")
def excitation(
    excitations: Excitation | Sequence[Excitation], labels: Sequence[str] | None = None, ax: Axes | None = None
) -> Drawing:
    """Smallest eigenvalue of the information in a window, over the window's end, with its least value marked.

    Parameters
    ----------
    excitations : Excitation or sequence of Excitation
        From `percept_obs.windowed`.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, pinhole, record, scenarios, windowed
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> found = windowed(form, record(scenarios.ma2005_eq35(), 20), 5)
    >>> print(figures.excitation(found).text.split(". ")[-1])
    5 s window: the least is 0.485, at 20 s, the largest 7.2.
    """
    found = base.require_several(excitations, Excitation, "windowed(form, recording)")
    if not all(np.isfinite(one.smallest).any() for one in found):
        raise ValueError("an excitation has no finite value; were samples lost in a recording without the truth?")
    windows = [f"{one.window:g} s" for one in found]
    names = base.labels_for(labels, [f"{window} window" for window in windows])
    ax = canvas(ax, 3.2)
    yield "Smallest eigenvalue of the integral of w w^T over a window, on a logarithmic axis."
    low, high = _draw_smallest(ax, found, names)
    for one, name in zip(found, names, strict=True):
        yield f"{name}: {_annotate_least(ax, one)}"
    # A fifth of the axis stays free below, for what is written there.
    ax.set_ylim(low * min(0.3, (low / high) ** 0.2), 2 * high)
    ax.set_xlabel(f"end of the {windows[0]} window (s)" if len(set(windows)) == 1 else "end of the window (s)")
    ax.set_ylabel(r"smallest eigenvalue of $\int w\,w^{\mathsf{T}}dt$")
    if labels is not None or len(found) > 1:
        legend_above(ax)
    return [ax]


@figure("there is none, something else is among them, or the number of labels is wrong")
def gramian(found: Gramian | Sequence[Gramian], labels: Sequence[str] | None = None, ax: Axes | None = None) -> Drawing:
    """Smallest eigenvalue of the windowed Gramian over the window's beginning; the text tells its verdict.

    Parameters
    ----------
    found : Gramian or sequence of Gramian
        From `percept_obs.points.gramian.gramian`.

    Examples
    --------
    >>> from percept_obs import Camera, figures, record
    >>> from percept_obs.points.gramian import gramian
    >>> from percept_obs.points.scenarios import moving_body
    >>> found = gramian(record(moving_body(1), 5, Camera(0.1)), 2)
    >>> print(figures.gramian(found).text.split("; ")[1])
    least is seen in the 2 s from 0 s on, mainly of r_z, r_y, r_x.
    """
    found = base.require_several(found, Gramian, "points.gramian.gramian()")
    names = base.labels_for(labels, [f"{one.window:g} s window" for one in found])
    ax = canvas(ax, 3.2)
    yield "Smallest eigenvalue of the Gramian over the beginning of its window, on a logarithmic axis."
    low, high = _draw_smallest(ax, found, names)
    yield from (f"{name}: {one.verdict()}." for one, name in zip(found, names, strict=True))
    ax.set_ylim(low / 3, 3 * high)
    ax.set(xlabel="beginning of the window (s)", ylabel="smallest eigenvalue")
    legend_above(ax)
    return [ax]


@figure("it is something else")
def consistency(found: Consistency, ax: Axes | None = None) -> Drawing:
    """Normalised innovations over time, with their moving average and the interval that it should keep to.

    Parameters
    ----------
    found : Consistency
        From `percept_obs.check_consistency`.

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, check_consistency, ekf, figures, pinhole
    >>> from percept_obs import record, scenarios, track
    >>> recording = record(scenarios.ma2005_eq35(), 20, Camera(0.02, Gaussian(0.01)))
    >>> run = track(recording, ekf(PerspectiveSystem(affine(), pinhole()), noise_variance=1e-4))
    >>> print(figures.consistency(check_consistency(run, after=5)).text.split(". ")[1])
    Consistent: the innovations are as large as the filter claims
    """
    ax = canvas(ax, 3.2)
    low, high = found.interval(found.samples)
    ax.axhspan(low, high, color=look.GREEN, alpha=0.2, linewidth=0, label="95 % interval")
    ax.axhline(found.outputs, color=look.BLACK, linewidth=1, linestyle="--", label="expected mean")
    ax.plot(found.time, found.nis, **look.dots(found.nis, label="samples"))
    name = f"mean of {found.samples} samples"
    ax.plot(found.average_time, found.averages, color=look.BLUE, linewidth=1.6, label=name)
    ax.set_xlim(found.time[0], found.time[-1])
    ax.set(xlabel="time (s)", ylabel="normalised innovation")
    verdict = found.verdict()
    yield f"Normalised innovations from {found.time[0]:.4g} to {found.time[-1]:.4g} s."
    yield f"{verdict[0].upper()}{verdict[1:]}."
    firm = np.array([low, high, *found.averages, 0.0])
    yield curves.linear(ax, firm, found.nis, "the normalised innovations", reach=1.0)
    legend_above(ax)
    return [ax]


def _draw_smallest(ax: Axes, found: Sequence[Windows], names: Sequence[str]) -> tuple[float, float]:
    """Draw smallest eigenvalues, each least one marked; return the smallest and the largest value that is drawn."""
    for number, (one, name) in enumerate(zip(found, names, strict=True)):
        _draw(ax, one.time, one.smallest, number, name)
        at = np.nanargmin(one.smallest)
        ax.plot(one.time[at], max(one.smallest[at], curves.ROUND_OFF), **look.style(number))
    ax.set_yscale("log")
    ax.minorticks_off()
    every = np.maximum(describe.finite(np.concatenate([one.smallest for one in found])), curves.ROUND_OFF)
    return float(every.min()), float(every.max())


def _annotate_least(ax: Axes, one: Excitation) -> str:
    """Write the least value beside its mark; return a sentence on it, the largest one, and what is not drawn."""
    least, at = np.nanmin(one.smallest), one.time[np.nanargmin(one.smallest)]
    late = at > one.time[0] + 0.85 * (one.time[-1] - one.time[0])
    ha, right = ("right", 4) if late else ("center", 0)
    place = (at, max(least, curves.ROUND_OFF))
    ax.annotate(f"least {least:.2g}", place, (right, -7), textcoords="offset points", ha=ha, va="top")
    clipped, missing = int((one.smallest < curves.ROUND_OFF).sum()), int(np.isnan(one.smallest).sum())
    return describe.joined(
        f"the least is {least:.3g}, at {at:.3g} s, the largest {np.nanmax(one.smallest):.3g}.",
        f"Round-off: {clipped} values below {curves.ROUND_OFF:g} are drawn there." if clipped else "",
        f"Unknown: {missing} of {len(one.time)} windows, which are gaps." if missing else "",
    )


FINEST = 1.3
"""Least ratio between the ends of a scale of colours, so that round-off makes no pattern."""


@figure("there is none, something else is among them, or the number of labels or axes is wrong")
def fields(
    found: FieldBound | Sequence[FieldBound], labels: Sequence[str] | None = None, axes: Sequence[Axes] | None = None
) -> Drawing:
    """The least error of the range over the field of view, a map for each, with the same colours in all of them.

    Parameters
    ----------
    found : FieldBound or sequence of FieldBound
        From `percept_obs.studies.fields.field_bound`.

    Examples
    --------
    >>> from percept_obs import affine, figures, sphere
    >>> from percept_obs.studies.fields import field_bound
    >>> sideways = affine([[0.0] * 3] * 3, [0.5, 0, 0])
    >>> found = field_bound(sphere(), sideways, 2.0, angle=0.002, size=5)
    >>> print(figures.fields(found).text.split(". ")[1])
    sphere, y1, y2 measured: 0.53 % in the middle of the picture, 0.75 % near its edge, 0.53 to 96 % in all.
    """
    found = base.require_several(found, FieldBound, "field_bound()")
    names = base.labels_for(labels, [each.surface.name for each in found])
    percent = [100 * each.relative for each in found]
    low = min(float(np.nanmin(each)) for each in percent)
    # what leaves the field of view at once is hardly known, and would take all of the colours
    high = max(float(np.nanpercentile(each, 97)) for each in percent)
    own = axes is None
    columns = next(count for count in (3, 2, 1) if len(found) % count == 0)
    rows = -(-len(found) // columns)
    maps = canvases(axes, names, 2.7 * rows, nrows=rows, ncols=min(columns, len(found)), sharex=True, sharey=True)
    yield "Least relative standard deviation of the range in each direction, in degrees from the optical axis."
    for ax, each, values, name in zip(maps, found, percent, names, strict=True):
        edge = np.degrees(each.angles[-1])
        colours: dict[str, Any] = {"norm": LogNorm(low, max(high, FINEST * low)), "cmap": "viridis_r"}
        picture = ax.imshow(values, extent=(-edge, edge, -edge, edge), origin="lower", **colours)
        ax.grid(False)
        ax.set_title(name, fontsize="medium")
        ax.set_xlabel("to the right (°)")
        middle, rim = each.within(0, np.radians(edge) / 3), each.within(2 * np.radians(edge) / 3, np.radians(edge))
        yield (
            f"{name}, {', '.join(each.measured)} measured: {100 * middle:.2g} % in the middle of the picture, "
            f"{100 * rim:.2g} % near its edge, {np.nanmin(values):.2g} to {np.nanmax(values):.2g} % in all."
        )
    maps[0].set_ylabel("up (°)")
    if own:
        base.root_figure(maps[0]).colorbar(picture, ax=maps, shrink=0.8, label="least error of the range (%)")
    return maps
