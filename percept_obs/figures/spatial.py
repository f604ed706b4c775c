"""Figures in space: the point's path in the image, and in the scene in metres."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import sympy as sp
from matplotlib.axes import Axes
from matplotlib.patches import Circle
from numpy.typing import NDArray

from percept_obs.compile import vectorised
from percept_obs.figures.base import (
    BLACK,
    BLUE,
    ESTIMATE,
    GREY,
    SKY,
    TRUTH,
    WIDTH,
    Array,
    Figure,
    dots,
    drawn,
    finite,
    label,
    legend_above,
    limits,
    new_axes,
    recording_of,
    span,
    story,
    tidy,
)
from percept_obs.forms import NotAffine
from percept_obs.observability import instantaneous
from percept_obs.perspective import PerspectiveSystem
from percept_obs.recording import Recording
from percept_obs.tracking import Run

NARROWEST = 0.4
"""Least ratio of the two sides of the image that is shown."""

NEARBY = 0.6
"""How far outside the path, in sides of its box, the focus of expansion may lie to be shown in its place."""

KINDS = {"truth": "True", "samples": "Measured", "estimate": "Estimated"}

START: dict[str, Any] = {"marker": "o", "linestyle": "", "markerfacecolor": "white", "label": "start"}
END: dict[str, Any] = {"marker": "s", "linestyle": "", "label": "end"}
_CORNERS = [(1, 0.75, 2), (-1, 0.75, 2), (-1, -0.75, 2), (1, -0.75, 2)]
_EDGES = [edge for corner in _CORNERS for edge in ((0, 0, 0), corner)]
CAMERA = np.array([*_EDGES, *_CORNERS]) / 2
"""Edges of a pyramid of height 1 that opens along Z, in one stroke."""

FOCUS: dict[str, Any] = {"marker": "x", "linestyle": "", "markersize": 9, "markeredgewidth": 2}


def image_plane(data: Run | Recording, threshold: float = 0.1, ax: Axes | None = None) -> Figure:
    """The point's path in the image, the focus of expansion, and where an instant tells little.

    The focus of expansion is a cross if the motion is constant, and a faint path if it varies.  With both outputs
    measured and a constant motion the disk |w| < threshold is drawn; with one output the lines on which w vanishes.

    Parameters
    ----------
    data : Run or Recording
        Seen on a surface with two image coordinates.
    threshold : float
        Positive; in 1/s or m/s, as w is.
    ax : axes, optional
        New ones when left out.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If the surface has not two image coordinates, only one of them is known, or the threshold is not positive.
    """
    recording = recording_of(data)
    run = data if isinstance(data, Run) else None
    if not threshold > 0:
        raise ValueError(f"the threshold is {threshold}; it must be positive")
    path, kind = _path(recording, run)
    estimate = np.empty((0, 2)) if run is None else run.estimate[:, :2]
    system = PerspectiveSystem(recording.motion, recording.imaging_surface)
    measured = recording.names if run is None else run.observer.form.measured
    focus = _focus(system, recording.time)
    radius = _blind_radius(system, measured, threshold) if len(focus) == 1 else np.nan
    own, ax = ax is None, ax or new_axes(5.2)
    tidy(ax)
    _set_limits(ax, path, estimate, focus, radius)
    if own:
        _fit_height(ax)
    _draw_path(ax, path, kind, estimate)
    ax.set(aspect="equal", xlabel=label("y1", recording.surface), ylabel=label("y2", recording.surface))
    seen = _complete(path)
    sentences = [
        f"{KINDS[kind]} path in the image of the {recording.surface.name} surface: y1 is {span(path[:, 0])}, y2 "
        f"{span(path[:, 1])}, from the start at {_place(seen[0])} to the end at {_place(seen[-1])}.",
        _draw_focus(ax, focus, path, recording.time),
        _draw_disk(ax, focus, radius, threshold, seen) if np.isfinite(radius) else "",
        _draw_blind_lines(ax, system, *measured) if len(measured) == 1 else "",
        "" if run is None else f"Estimate of the {run.observer.name} observer, dashed. {story(run)}",
        _outside(ax, estimate),
    ]
    legend_above(ax, centred=True, fitting=66)
    return drawn((ax,), sentences)


def scene(data: Run | Recording, far: float = 2.0, ax: Axes | None = None) -> Figure:
    """The point's path in metres, with the camera at the origin and Z forward.

    Parameters
    ----------
    data : Run or Recording
        A recording alone must have its truth.
    far : float
        Estimates farther away than this many times the true distance, or not in front of the camera, are left out.
        Without the truth, the median of the estimated distances stands for it.
    ax : three-dimensional axes, optional
        New ones when left out.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If no place is known, `far` is not more than 1, or the axes are flat.
    """
    recording = recording_of(data)
    run = data if isinstance(data, Run) else None
    if recording.points is None and run is None:
        raise ValueError("the recording has no truth, so no place is known; draw the run of an observer on it")
    if not far > 1:
        raise ValueError(f"far is {far}; it must be more than 1")
    if ax is not None and ax.name != "3d":
        raise ValueError("the axes are flat; make them with figure.add_subplot(projection='3d')")
    ax = ax or new_axes(5.6, projection="3d")
    truth = np.empty((0, 3)) if recording.points is None else recording.points
    estimate = np.empty((0, 3)) if run is None else _believable(run, far)
    path = _complete(truth if len(truth) else estimate)
    camera = 0.1 * np.abs(path).max(initial=1e-3) * CAMERA
    _draw_places(ax, truth, TRUTH)
    _draw_places(ax, estimate, {**ESTIMATE, "linewidth": 0.9, "zorder": 1})
    _draw_places(ax, camera, {"color": BLUE, "linewidth": 1, "label": "camera"})
    if len(path):
        _draw_places(ax, np.array([(0, 0, 0), path[-1]]), {"color": GREY, "linestyle": ":", "label": "viewing ray"})
    _draw_places(ax, path[:1], {"color": BLACK, **START})
    _draw_places(ax, path[-1:], {"color": BLACK, **END})
    _set_equal_scales(ax, _complete(np.vstack([camera, truth, estimate])))
    legend_above(ax, centred=True, fitting=66)
    return drawn(
        (ax,),
        [
            "Scene in metres, with the camera at the origin and Z forward.",
            _approach(recording.time, truth) if len(truth) else "",
            f"The point ends at X, Y, Z = {_place(path[-1])} m." if len(path) else "No place is known.",
            "" if run is None else f"Estimate of the {run.observer.name} observer, dashed. {story(run)}",
            _gaps(estimate, far),
        ],
    )


def _path(recording: Recording, run: Run | None) -> tuple[Array, str]:
    """Image coordinates over time, shape (K, 2), and whether they are the truth, samples or estimates."""
    names = [symbol.name for symbol in recording.surface.image_coordinates]
    if len(names) != 2:
        raise ValueError(
            f"the {recording.surface.name} surface has {len(names)} image coordinates; an image plane has two"
        )
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


def _draw_path(ax: Axes, path: Array, kind: str, estimate: Array) -> None:
    if kind != "estimate":
        ax.plot(*path.T, **(TRUTH if kind == "truth" else dots(path)))
    if len(estimate):
        ax.plot(*estimate.T, **ESTIMATE)
    seen = _complete(path)
    for look, place in ((START, seen[0]), (END, seen[-1])):
        ax.plot(*place, color=BLACK, zorder=3, **look)


def _focus(system: PerspectiveSystem, time: Array) -> Array:
    """Focus of expansion, shape (1, 2) if it stays, else (K, 2); not finite where there is none."""
    known = system.motion.known(time)
    with np.errstate(divide="ignore", invalid="ignore"):
        focus = vectorised(system.motion.parameters, list(system.foe), system.surface.values)(*known.T)
    rows = np.atleast_2d(np.stack(focus, axis=-1))
    return rows[:1] if (rows == rows[0]).all() else rows


def _blind_radius(system: PerspectiveSystem, measured: tuple[str, ...], threshold: float) -> float:
    """Radius of the disk |w| < threshold around the focus of expansion; NaN if the region is no disk."""
    try:
        _, radius = instantaneous(system.measure(*measured)).circle(threshold)
        return float(radius.subs(system.values))
    except (ValueError, TypeError):  # no canonical form, another region, or no number
        return np.nan


def _set_limits(ax: Axes, path: Array, estimate: Array, focus: Array, radius: float) -> None:
    """Follow the path, and show the focus of expansion and the disk around it if they are near."""
    low, high = np.nanmin(path, axis=0), np.nanmax(path, axis=0)
    size = (high - low).max()
    shown = path
    if len(focus) == 1 and ((focus > low - NEARBY * size) & (focus < high + NEARBY * size)).all():
        around = radius if radius < size / 2 else 0.0
        shown = np.vstack([path, focus - around, focus + around])
    ends = [limits(firm, loose, 0.5) for firm, loose in zip(shown.T, estimate.T, strict=True)]
    x, y = _not_a_strip(*ends)
    ax.set(xlim=x, ylim=y)


def _fit_height(ax: Axes) -> None:
    """Make a figure lower whose picture is wide; it would have empty margins above and below."""
    width, height = np.ptp([ax.get_xlim(), ax.get_ylim()], axis=1)
    figure: Any = ax.get_figure(root=True)
    lettering = 1.2  # inches above and below the axes
    figure.set_figheight(min(figure.get_figheight(), WIDTH * height / width + lettering))


def _not_a_strip(*ends: tuple[float, float]) -> list[tuple[float, float]]:
    """Limits, the nearer ones drawn apart until no side is much shorter than another."""
    longest = max(high - low for low, high in ends)
    missing = [max(0.0, NARROWEST * longest - (high - low)) / 2 for low, high in ends]
    return [(low - m, high + m) for (low, high), m in zip(ends, missing, strict=True)]


def _inside(ax: Axes, places: Array) -> NDArray[np.bool_]:
    """Which places are in the picture."""
    low, high = np.array([ax.get_xlim(), ax.get_ylim()]).T
    return ((places > low) & (places < high)).all(axis=1)


def _draw_focus(ax: Axes, focus: Array, path: Array, time: Array) -> str:
    """A cross, a faint path or a pointer at the edge; in words where it is and how close the point comes."""
    distances = np.linalg.norm(path - focus, axis=1)
    if not np.isfinite(distances).any():
        ax.plot([], [], linestyle="", label="no focus of expansion")
        return "There is no focus of expansion in this plane: the translation is zero or parallel to it."
    k = int(np.nanargmin(distances))
    closest = f"closest approach {distances[k]:.3g} at {time[k]:.3g} s"
    visible = _inside(ax, focus).any()
    name = "focus of expansion" if visible else "focus of expansion (outside)"
    if len(focus) > 1:
        ax.plot(*focus.T, **dots(focus, color=BLUE, alpha=0.4, label=name))
        where = f"The focus of expansion moves: y1 {span(focus[:, 0])}, y2 {span(focus[:, 1])}; {closest}."
    else:
        look = FOCUS if visible else _pointer(ax, focus[0])
        ax.plot(*(focus[0] if visible else _edge(ax, focus[0])), color=BLUE, label=name, **look)
        where = f"The focus of expansion is at {_place(focus[0])}; {closest}."
    return where if visible else f"{where} It lies outside the picture."


def _edge(ax: Axes, place: Array) -> Array:
    """Where the line from the middle of the picture to a place outside meets the edge, nearly."""
    ends = np.array([ax.get_xlim(), ax.get_ylim()])
    centre, half = ends.mean(axis=1), np.diff(ends, axis=1)[:, 0] / 2
    away = place - centre
    return centre + 0.96 * away * min(half / np.maximum(np.abs(away), 1e-12 * half))


def _pointer(ax: Axes, place: Array) -> dict[str, Any]:
    """A triangle that points to a place outside."""
    away = place - _edge(ax, place)
    return {"marker": (3, 0, np.degrees(np.arctan2(away[1], away[0])) - 90), "linestyle": "", "markersize": 10}


def _draw_disk(ax: Axes, focus: Array, radius: float, threshold: float, path: Array) -> str:
    low, high = np.array([ax.get_xlim(), ax.get_ylim()]).T
    visible = bool(np.linalg.norm(focus[0] - np.clip(focus[0], low, high)) < radius)
    name = f"{'' if visible else '_'}$|w| < {threshold:g}$"
    ax.add_patch(Circle(focus[0], radius, facecolor=SKY, edgecolor=BLUE, alpha=0.35, label=name))
    inside = int((np.linalg.norm(path - focus, axis=1) < radius).sum())
    entered = f"{inside} of {len(path)} samples lie in it" if inside else "the path does not enter it"
    return f"The disk |w| < {threshold:g} around it has the radius {radius:.3g}; {entered}."


def _draw_blind_lines(ax: Axes, system: PerspectiveSystem, measured: str) -> str:
    """Where w vanishes if one output is measured, in a constant motion."""
    # As fractions, roots of two entries are equal when they should be.
    numbers = {symbol: sp.Rational(repr(value)) for symbol, value in system.values.items()}
    try:
        form = system.measure(measured)
    except NotAffine:
        return ""
    w = form.w.subs(numbers)
    if not w.free_symbols <= set(form.x1):
        return ""
    if w.is_zero_matrix:
        return f"Measuring {measured} alone, w vanishes everywhere."
    solutions = [solution[form.x1[0]] for solution in instantaneous(replace(form, w=w)).zero_set]
    places = [float(place) for place in solutions if place.is_real]
    for place in places:
        draw = ax.axvline if measured == "y1" else ax.axhline
        draw(place, color=BLUE, linewidth=1, linestyle="-.", label="$w = 0$")
    where = " and ".join(f"at {measured} = {place:.3g}" for place in places) or "nowhere"
    return f"Measuring {measured} alone, w vanishes {where}."


def _outside(ax: Axes, estimate: Array) -> str:
    seen = _complete(estimate)
    count = len(seen) - int(_inside(ax, seen).sum())
    return f"Outside the picture: {count} of {len(seen)} estimates." if count else ""


def _complete(rows: Array) -> Array:
    """The rows without a gap."""
    return rows[np.isfinite(rows).all(axis=1)]


def _place(coordinates: Array) -> str:
    return f"({', '.join(f'{value:.3g}' for value in coordinates)})"


def _draw_places(ax: Axes, points: Array, look: dict[str, Any]) -> None:
    """Z to the right, X into the picture and Y upwards, which is right-handed."""
    if len(points):
        ax.plot(*points.T[[2, 0, 1]], **look)


def _set_equal_scales(ax: Any, points: Array) -> None:
    """One scale for the three directions, and few numbers along them."""
    x, y, z = _not_a_strip(*(limits(column) for column in points.T[[2, 0, 1]]))
    ax.set(xlim=x, ylim=y, zlim=z)
    for set_label, axis in ((ax.set_xlabel, "Z"), (ax.set_ylabel, "X"), (ax.set_zlabel, "Y")):
        set_label(f"${axis}$ (m)", labelpad=12)
    ax.set_box_aspect(np.ptp([x, y, z], axis=1), zoom=0.76)
    ax.locator_params(nbins=4)
    ax.computed_zorder = False  # the truth stays above a noisy estimate


def _believable(run: Run, far: float) -> Array:
    """Estimated places, NaN where they are not in front of the camera or too far away."""
    seen = finite(run.distance)
    usual = np.median(seen) if seen.size else 0.0
    expected = usual if run.recording.truth is None else 1 / run.recording.truth[:, -1]
    return np.where((run.distance < far * expected)[:, None], run.points, np.nan)


def _gaps(estimate: Array, far: float) -> str:
    count = len(estimate) - len(_complete(estimate))
    if not count:
        return ""
    return (
        f"Left out: {count} of {len(estimate)} estimates, not in front of the camera or over {far:g} times as far away."
    )


def _approach(time: Array, points: Array) -> str:
    ranges = np.linalg.norm(points, axis=1)
    k = int(np.argmin(ranges))
    extents = ", ".join(f"{axis} {span(column)}" for axis, column in zip("XYZ", points.T, strict=True))
    return f"The true path: {extents} m; closest to the camera at {time[k]:.3g} s, within {ranges[k]:.3g} m."
