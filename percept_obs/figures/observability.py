"""Figures of what can be known: measures of observability side by side, and maps of the image."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.patches import Circle

from percept_obs.figures import axis, focus, given, look, words
from percept_obs.figures.base import Array, Drawing, canvas, figure, legend_above, rows
from percept_obs.observability.maps import BoundMap
from percept_obs.observability.measures import Observability


@figure("it is something else, or the number of axes is wrong")
def observability(found: Observability, axes: Sequence[Axes] | None = None) -> Drawing:
    """Each measure over time, one below the other: an instant, windows, derivatives, and the bound.

    Parameters
    ----------
    found : Observability

    Examples
    --------
    >>> from percept_obs import Camera, PerspectiveSystem, affine, figures, how_observable, pinhole, record, scenarios
    >>> found = how_observable(record(scenarios.planar(), 4, Camera(0.1)), PerspectiveSystem(affine(), pinhole()))
    >>> len(figures.observability(found).axes)
    4
    """
    given.one(found, Observability, "how_observable(recording, system)")
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
    ends: dict[str, Any] = {
        "linestyle": "",
        "marker": "o",
        "color": look.GREEN,
        "markersize": 4,
        "label": "by perturbed runs",
    }
    windows.plot(found.empirical.time - begun, np.maximum(found.empirical.smallest, axis.ROUND_OFF), **ends)
    windows.set_ylabel(f"{found.window:g} s windows")
    _draw(derivatives, found.lie.time - begun, found.lie.smallest, 0, "smallest singular value")
    derivatives.set_ylabel("derivatives")
    _draw(bound, found.bound.elapsed, found.bound.of(hidden), 1, f"bound of {words.letter(hidden)}")
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
    shown = np.maximum(values, axis.ROUND_OFF)
    ax.plot(time, shown, label=name, color=own["color"], linestyle=own["linestyle"] if number else "-")


def _logarithmic(ax: Axes) -> None:
    """A logarithmic axis over at most twelve powers of ten."""
    every = np.concatenate([np.ravel(np.asarray(line.get_ydata(), dtype=float)) for line in ax.lines] or [np.ones(1)])
    high = 3 * float(every.max())
    ax.set_yscale("log")
    ax.set_ylim(max(float(every.min()) / 3, 1e-12 * high), high)
    ax.minorticks_off()


@figure("it is something else, or the threshold is not positive")
def bound_map(found: BoundMap, threshold: float = 0.1, ax: Axes | None = None) -> Drawing:
    """How well the distance can be known at each place of the image, on a logarithmic scale of colours.

    Over it the focus of expansion, where there is one, with both outputs and a constant motion the circle
    |w| = threshold, and with one output the lines on which w vanishes.

    Parameters
    ----------
    found : BoundMap
    threshold : float
        Positive; in m/s, as w is.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, bound_map, figures, pinhole
    >>> forwards = PerspectiveSystem(affine([[0.0] * 3] * 3, [0, 0, -0.5]), pinhole())
    >>> print(figures.bound_map(bound_map(forwards, resolution=11)).text.split(". ")[-1])
    The circle |w| = 0.1 around it has the radius 0.2.
    """
    given.one(found, BoundMap, "bound_map(system)")
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
    ax.set(xlabel=words.label("y1", system.surface), ylabel=words.label("y2", system.surface))
    if own:
        whole: Any = ax.get_figure(root=True)
        bar = whole.colorbar(picture, ax=ax, shrink=0.8)
        bar.set_label("least error of the distance (%)")
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
    return words.place(np.array([found.y1[place[1]], found.y2[place[0]]]))


def _draw_zero_set(ax: Axes, found: BoundMap, threshold: float) -> str:
    """Draw where w vanishes or is small, and say it."""
    system = found.system
    centre = focus.of_expansion(system, np.zeros(1))[0] + 0.0  # so that no zero has a sign
    if not np.isfinite(centre).all():
        return "There is no focus of expansion in this plane."
    if len(found.measured) == 1:
        return focus.draw_blind_lines(ax, system, *found.measured)
    ax.plot(*centre, label="focus of expansion", **look.FOCUS)
    radius = focus.blind_radius(system, found.measured, threshold)
    told = f"The focus of expansion is at {words.place(centre)}."
    if not np.isfinite(radius):
        return told
    name = f"$|w| = {threshold:g}$"
    ax.add_patch(Circle(centre, radius, fill=False, edgecolor=look.VERMILLION, linewidth=1.4, label=name))
    return f"{told} The circle |w| = {threshold:g} around it has the radius {radius:.3g}."
