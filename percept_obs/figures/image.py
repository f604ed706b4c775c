"""Figure of the image: paths of points, the focus of expansion, and where an instant tells little of the distance."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import sympy as sp
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from percept_obs.compile import Flags, vectorised
from percept_obs.figures import base, curves, describe, look
from percept_obs.figures.base import Array, Drawing, canvas, figure, legend_above
from percept_obs.observability.pointwise import instantaneous
from percept_obs.recording import Recording
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.tracking.run import Run

NEARBY = 0.6
"""Largest distance from the path, in sides of its box, at which the focus of expansion is drawn at its place."""

KINDS = {"truth": "True", "samples": "Measured", "estimate": "Estimated"}


@figure("two image coordinates are not known, no point is seen, or the threshold is not positive")
def image_plane(data: Run | Recording, threshold: float = 0.1, ax: Axes | None = None) -> Drawing:
    """Paths in the image, and dashed their estimates.

    Of one point the focus of expansion is drawn as well, a diamond if the motion is constant and a faint path if it
    varies.  With both outputs measured and a constant motion there is the disk |w| < threshold, with one output the
    lines on which w vanishes.  Of several points each has its colour and number, and its estimate begins at first
    sight.

    Parameters
    ----------
    data : Run or Recording
        Seen with two image coordinates.
    threshold : float
        Positive; in 1/s or m/s, as w is.  For one point.

    Examples
    --------
    >>> from percept_obs import figures, record, scenarios
    >>> print(figures.image_plane(record(scenarios.ma2005_eq35(), 20)).text.split(". ")[-1])
    The disk |w| < 0.1 around it has the radius 0.333; the path does not enter it.

    See Also
    --------
    scene : The path in space.
    """
    recording, run = base.recording_and_run(data)
    view = recording.view
    if not threshold > 0:
        raise ValueError(f"the threshold is {threshold}; it must be positive")
    if len(view.image_coordinates) != 2:
        raise ValueError(f"the {view.name} has {len(view.image_coordinates)} image coordinates; an image plane has two")
    if not recording.seen.any() and (view.point_shape or recording.truth is None):
        raise ValueError("no point is seen in two image coordinates; record some points in front of the camera")
    y1, y2 = (describe.label(symbol.name, view) for symbol in view.image_coordinates)
    own, ax = ax is None, canvas(ax, 5.2)
    if view.point_shape:
        yield from _several_points(ax, recording, run)
    else:
        yield from _one_point(ax, recording, run, threshold, own)
    ax.set(aspect="equal", xlabel=y1, ylabel=y2)
    legend_above(ax, centred=True, fitting=66)
    return [ax]


def _several_points(ax: Axes, recording: Recording, run: Run | None) -> Iterator[str]:
    """Draw a coloured path for each point, with gaps where it is not seen."""
    kind = "measured" if recording.truth is None else "true"
    images = recording.outputs if recording.truth is None else recording.view.outputs(recording.truth)
    paths = np.where(recording.seen[..., None], images, np.nan)
    estimate = np.full_like(paths, np.nan) if run is None else run.view.outputs(run.estimate)
    for k, seen in enumerate(recording.seen.T):
        if not seen.any():
            continue
        colour, first = look.COLOURS[k % len(look.COLOURS)], int(np.argmax(seen))
        ax.plot(*paths[:, k].T, color=colour, linewidth=1.4)
        ax.plot(*estimate[first:, k].T, color=colour, linewidth=1.2, linestyle="--")
        ax.plot(*paths[first, k], color=colour, marker="o", markerfacecolor="white")
        ax.annotate(str(k + 1), paths[first, k], (5, 5), textcoords="offset points", color=colour)
    for name, line in ((kind, "-"), ("estimate", "--"))[: 1 if run is None else 2]:
        ax.plot([], [], color=look.BLACK, linestyle=line, label=name)
    ax.plot([], [], color=look.BLACK, **look.START | {"label": "first sight"})
    ax.set_xlim(curves.limits(paths[..., 0], estimate[..., 0], reach=0.3))
    ax.set_ylim(curves.limits(paths[..., 1], estimate[..., 1], reach=0.3))
    lost = 1 - recording.seen.mean(axis=0)
    gone = [f"point {k + 1} for {share:.0%} of the time" for k, share in enumerate(lost) if share > 0]
    yield (
        f"{kind.capitalize()} paths of {len(lost)} points in the image: y1 is {describe.span(paths[..., 0])}, y2 "
        f"{describe.span(paths[..., 1])}."
    )
    yield f"Out of sight: {', '.join(gone)}." if gone else "All of them are seen at all times."
    yield "" if run is None else f"Estimates, dashed: {run.verdict()}."


def _one_point(ax: Axes, recording: Recording, run: Run | None, threshold: float, own: bool) -> Iterator[str]:
    """Draw the path, the focus of expansion, and where w is small."""
    path, kind = _path(recording, run)
    estimate = np.empty((0, 2)) if run is None else run.estimate[:, :2]
    system = PerspectiveSystem(recording.motion, recording.imaging_surface)
    measured = recording.names if run is None else run.measured
    centre = focus_of_expansion(system, recording.time)
    radius = blind_radius(system, measured, threshold) if len(centre) == 1 else np.nan
    _set_limits(ax, path, estimate, centre, radius)
    if own:
        _fit_height(ax)
    if kind != "estimate":
        ax.plot(*path.T, **(look.TRUTH if kind == "truth" else look.dots(path)))
    if len(estimate):
        ax.plot(*estimate.T, **look.ESTIMATE)
    seen = curves.rows_without_nan(path)
    for end, place in ((look.START, seen[0]), (look.END, seen[-1])):
        ax.plot(*place, color=look.BLACK, zorder=3, **end)
    yield (
        f"{KINDS[kind]} path in the image of the {recording.view.name} surface: y1 is {describe.span(path[:, 0])}, y2 "
        f"{describe.span(path[:, 1])}, from the start at {describe.place(seen[0])} to the end at "
        f"{describe.place(seen[-1])}."
    )
    yield draw_focus(ax, centre, path, recording.elapsed)
    yield draw_disk(ax, centre, radius, threshold, seen) if np.isfinite(radius) else ""
    yield draw_blind_lines(ax, system, *measured) if len(measured) == 1 else ""
    if run is not None:
        yield f"Estimate of the {run.observer.name} observer, dashed. {describe.story(run)}"
    shown = curves.rows_without_nan(estimate)
    outside = len(shown) - int(inside(ax, shown).sum())
    yield f"Outside the picture: {outside} of {len(shown)} estimates." if outside else ""


def _path(recording: Recording, run: Run | None) -> tuple[Array, str]:
    """Return image coordinates over time, shape (K, 2), and their kind: truth, samples or estimate."""
    names = [symbol.name for symbol in recording.view.image_coordinates]
    if recording.truth is not None:
        return recording.truth[:, :2], "truth"
    if set(recording.names) == set(names):
        return recording.outputs[:, [recording.names.index(name) for name in names]], "samples"
    if run is not None:
        return run.estimate[:, :2], "estimate"
    raise ValueError(
        f"only {', '.join(recording.names)} was recorded, without the truth, so the path in the image is not known; "
        "draw the run of an observer on it"
    )


def _set_limits(ax: Axes, path: Array, estimate: Array, centre: Array, radius: float) -> None:
    """Fit the axes to the path, and to the focus of expansion and its disk if they are near."""
    low, high = np.nanmin(path, axis=0), np.nanmax(path, axis=0)
    size = (high - low).max()
    shown = path
    if len(centre) == 1 and ((centre > low - NEARBY * size) & (centre < high + NEARBY * size)).all():
        around = radius if radius < size / 2 else 0.0
        shown = np.vstack([path, centre - around, centre + around])
    ends = [curves.limits(*column, 0.5) for column in zip(shown.T, estimate.T, strict=True)]
    x, y = curves.widened_limits(*ends)
    ax.set(xlim=x, ylim=y)


def _fit_height(ax: Axes) -> None:
    """Make the figure of a wide picture lower, without empty margins."""
    width, height = np.ptp([ax.get_xlim(), ax.get_ylim()], axis=1)
    whole, lettering = base.root_figure(ax), 1.2  # inches above and below the axes
    whole.set_figheight(min(whole.get_figheight(), look.WIDTH * height / width + lettering))


def focus_of_expansion(system: PerspectiveSystem, time: Array) -> Array:
    """Return the focus of expansion, shape (1, 2) if it stays, else (K, 2); not finite where there is none."""
    known = system.motion.known(time)
    with np.errstate(divide="ignore", invalid="ignore"):
        focus = vectorised(system.motion.parameters, list(system.foe), system.surface.values)(*known.T)
    rows = np.atleast_2d(np.stack(focus, axis=-1))
    return rows[:1] if (rows == rows[0]).all() else rows


def blind_radius(system: PerspectiveSystem, measured: tuple[str, ...], threshold: float) -> float:
    """Return the radius of the disk |w| < threshold around the focus of expansion; NaN if the region is no disk."""
    partition = system.partition(*measured)
    if partition.culprits:
        return np.nan
    found = instantaneous(partition)
    if found.growth is None:
        return np.nan
    growth = found.growth.subs(system.values)
    return abs(threshold) / float(growth) ** 0.5 if growth.is_number and growth > 0 else np.nan


def inside(ax: Axes, places: Array) -> Flags:
    """Return True for places in the picture, shape (K,)."""
    low, high = np.array([ax.get_xlim(), ax.get_ylim()]).T
    return ((places > low) & (places < high)).all(axis=1)


def draw_focus(ax: Axes, focus: Array, path: Array, time: Array) -> str:
    """Draw the focus as a diamond, a path or a pointer at the edge; return a sentence on its place and distance."""
    distances = np.linalg.norm(path - focus, axis=1)
    if not np.isfinite(distances).any():
        ax.plot([], [], linestyle="", label="no focus of expansion")
        return "There is no focus of expansion in this plane: the translation is zero or parallel to it."
    k = int(np.nanargmin(distances))
    closest = f"closest approach {distances[k]:.3g} at {time[k]:.3g} s"
    visible = inside(ax, focus).any()
    name = "focus of expansion" if visible else "focus of expansion (outside)"
    if len(focus) > 1:
        ax.plot(*focus.T, **look.dots(focus, color=look.UNSEEN, alpha=0.4, label=name))
        y1, y2 = map(describe.span, focus.T)
        where = f"The focus of expansion moves: y1 {y1}, y2 {y2}; {closest}."
    else:
        shown, mark = focus[0], look.FOCUS
        if not visible:  # a triangle at the edge points to it
            shown = _edge(ax, focus[0])
            away = focus[0] - shown
            mark = mark | {"marker": (3, 0, np.degrees(np.arctan2(away[1], away[0])) - 90), "markersize": 10}
        ax.plot(*shown, label=name, **mark)
        where = f"The focus of expansion is at {describe.place(focus[0])}; {closest}."
    return where if visible else f"{where} It lies outside the picture."


def _edge(ax: Axes, place: Array) -> Array:
    """Return the point near the edge of the picture on the line from its middle to a place outside."""
    ends = np.array([ax.get_xlim(), ax.get_ylim()])
    centre, half = ends.mean(axis=1), np.diff(ends, axis=1)[:, 0] / 2
    away = place - centre
    return centre + 0.96 * away * min(half / np.maximum(np.abs(away), 1e-12 * half))


def draw_disk(ax: Axes, focus: Array, radius: float, threshold: float, path: Array) -> str:
    """Draw the disk in which |w| is below the threshold; return a sentence on how many samples lie in it."""
    low, high = np.array([ax.get_xlim(), ax.get_ylim()]).T
    visible = bool(np.linalg.norm(focus[0] - np.clip(focus[0], low, high)) < radius)
    name = f"{'' if visible else '_'}$|w| < {threshold:g}$"
    colours = {"facecolor": look.UNSEEN, "edgecolor": look.UNSEEN}
    ax.add_patch(Circle(focus[0], radius, **colours, linestyle=":", alpha=0.2, label=name))
    count = int((np.linalg.norm(path - focus, axis=1) < radius).sum())
    entered = f"{count} of {len(path)} samples lie in it" if count else "the path does not enter it"
    return f"The disk |w| < {threshold:g} around it has the radius {radius:.3g}; {entered}."


def draw_blind_lines(ax: Axes, system: PerspectiveSystem, measured: str) -> str:
    """Draw lines where w vanishes if one output is measured, in a constant motion; return a sentence on them."""
    # As fractions, roots of two entries are equal when they should be.
    numbers = {symbol: sp.Rational(repr(value)) for symbol, value in system.values.items()}
    if system.partition(measured).culprits:
        return ""
    form = system.measure(measured)
    w = form.w.subs(numbers)
    if not w.free_symbols <= set(form.x1):
        return ""
    if w.is_zero_matrix:
        return f"Measuring {measured} alone, w vanishes everywhere."
    solutions = [solution[form.x1[0]] for solution in instantaneous(replace(form, w=w)).zero_set]
    places = [float(place) for place in solutions if place.is_real]
    for place in places:
        line = ax.axvline if measured == "y1" else ax.axhline
        line(place, color=look.UNSEEN, linewidth=1, linestyle="-.", label="$w = 0$")
    where = " and ".join(f"at {measured} = {place:.3g}" for place in places) or "nowhere"
    return f"Measuring {measured} alone, w vanishes {where}."
