"""The focus of expansion in the image, and where w is small or vanishes, so that an instant tells little."""

from dataclasses import replace
from typing import Any

import numpy as np
import sympy as sp
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from percept_obs.compile import Flags, vectorised
from percept_obs.figures import look, words
from percept_obs.figures.base import Array
from percept_obs.observability.pointwise import instantaneous
from percept_obs.system.perspective import PerspectiveSystem


def of_expansion(system: PerspectiveSystem, time: Array) -> Array:
    """Focus of expansion, shape (1, 2) if it stays, else (K, 2); not finite where there is none."""
    known = system.motion.known(time)
    with np.errstate(divide="ignore", invalid="ignore"):
        focus = vectorised(system.motion.parameters, list(system.foe), system.surface.values)(*known.T)
    rows = np.atleast_2d(np.stack(focus, axis=-1))
    return rows[:1] if (rows == rows[0]).all() else rows


def blind_radius(system: PerspectiveSystem, measured: tuple[str, ...], threshold: float) -> float:
    """Radius of the disk |w| < threshold around the focus of expansion; NaN if the region is no disk."""
    partition = system.partition(*measured)
    if partition.culprits:
        return np.nan
    found = instantaneous(partition)
    if found.growth is None:
        return np.nan
    growth = found.growth.subs(system.values)
    return abs(threshold) / float(growth) ** 0.5 if growth.is_number and growth > 0 else np.nan


def inside(ax: Axes, places: Array) -> Flags:
    """Which places are in the picture."""
    low, high = np.array([ax.get_xlim(), ax.get_ylim()]).T
    return ((places > low) & (places < high)).all(axis=1)


def draw(ax: Axes, focus: Array, path: Array, time: Array) -> str:
    """A diamond, a faint path or a pointer at the edge; in words where it is and how close the point comes."""
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
        where = f"The focus of expansion moves: y1 {words.span(focus[:, 0])}, y2 {words.span(focus[:, 1])}; {closest}."
    else:
        mark = look.FOCUS | ({} if visible else _pointer(ax, focus[0]))
        ax.plot(*(focus[0] if visible else _edge(ax, focus[0])), label=name, **mark)
        where = f"The focus of expansion is at {words.place(focus[0])}; {closest}."
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
    return {"marker": (3, 0, np.degrees(np.arctan2(away[1], away[0])) - 90), "markersize": 10}


def draw_disk(ax: Axes, focus: Array, radius: float, threshold: float, path: Array) -> str:
    """The disk in which |w| is below the threshold; in words how many samples lie in it."""
    low, high = np.array([ax.get_xlim(), ax.get_ylim()]).T
    visible = bool(np.linalg.norm(focus[0] - np.clip(focus[0], low, high)) < radius)
    name = f"{'' if visible else '_'}$|w| < {threshold:g}$"
    colours = {"facecolor": look.UNSEEN, "edgecolor": look.UNSEEN}
    ax.add_patch(Circle(focus[0], radius, **colours, linestyle=":", alpha=0.2, label=name))
    count = int((np.linalg.norm(path - focus, axis=1) < radius).sum())
    entered = f"{count} of {len(path)} samples lie in it" if count else "the path does not enter it"
    return f"The disk |w| < {threshold:g} around it has the radius {radius:.3g}; {entered}."


def draw_blind_lines(ax: Axes, system: PerspectiveSystem, measured: str) -> str:
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
        line = ax.axvline if measured == "y1" else ax.axhline
        line(place, color=look.UNSEEN, linewidth=1, linestyle="-.", label="$w = 0$")
    where = " and ".join(f"at {measured} = {place:.3g}" for place in places) or "nowhere"
    return f"Measuring {measured} alone, w vanishes {where}."
