"""The figure of the image: the point's path, the focus of expansion, and where an instant tells little."""

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
    END,
    ESTIMATE,
    SKY,
    START,
    TRUTH,
    WIDTH,
    Array,
    Figure,
    complete,
    dots,
    drawn,
    label,
    legend_above,
    limits,
    new_axes,
    not_a_strip,
    span,
    tidy,
)
from percept_obs.figures.labels import place_in_words, recording_of, story
from percept_obs.observability.pointwise import instantaneous
from percept_obs.recording import Recording
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.tracking.run import Run

NEARBY = 0.6
"""How far outside the path, in sides of its box, the focus of expansion may lie to be shown in its place."""

KINDS = {"truth": "True", "samples": "Measured", "estimate": "Estimated"}


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
    ax.set(aspect="equal", xlabel=label("y1", recording.view), ylabel=label("y2", recording.view))
    seen = complete(path)
    sentences = [
        f"{KINDS[kind]} path in the image of the {recording.view.name} surface: y1 is {span(path[:, 0])}, y2 "
        f"{span(path[:, 1])}, from the start at {place_in_words(seen[0])} to the end at {place_in_words(seen[-1])}.",
        _draw_focus(ax, focus, path, recording.time),
        _draw_disk(ax, focus, radius, threshold, seen) if np.isfinite(radius) else "",
        _draw_blind_lines(ax, system, *measured) if len(measured) == 1 else "",
        "" if run is None else f"Estimate of the {run.observer.name} observer, dashed. {story(run)}",
        _outside(ax, estimate),
    ]
    legend_above(ax, centred=True, fitting=66)
    return drawn((ax,), sentences)


def _path(recording: Recording, run: Run | None) -> tuple[Array, str]:
    """Image coordinates over time, shape (K, 2), and whether they are the truth, samples or estimates."""
    names = [symbol.name for symbol in recording.view.image_coordinates]
    if len(names) != 2:
        raise ValueError(
            f"the {recording.view.name} surface has {len(names)} image coordinates; an image plane has two"
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
    seen = complete(path)
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
    x, y = not_a_strip(*ends)
    ax.set(xlim=x, ylim=y)


def _fit_height(ax: Axes) -> None:
    """Make a figure lower whose picture is wide; it would have empty margins above and below."""
    width, height = np.ptp([ax.get_xlim(), ax.get_ylim()], axis=1)
    figure: Any = ax.get_figure(root=True)
    lettering = 1.2  # inches above and below the axes
    figure.set_figheight(min(figure.get_figheight(), WIDTH * height / width + lettering))


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
        where = f"The focus of expansion is at {place_in_words(focus[0])}; {closest}."
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
        draw = ax.axvline if measured == "y1" else ax.axhline
        draw(place, color=BLUE, linewidth=1, linestyle="-.", label="$w = 0$")
    where = " and ".join(f"at {measured} = {place:.3g}" for place in places) or "nowhere"
    return f"Measuring {measured} alone, w vanishes {where}."


def _outside(ax: Axes, estimate: Array) -> str:
    seen = complete(estimate)
    count = len(seen) - int(_inside(ax, seen).sum())
    return f"Outside the picture: {count} of {len(seen)} estimates." if count else ""
