"""The figure of the scene: the point's path in metres, with the camera and the viewing ray."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures.base import (
    BLACK,
    BLUE,
    END,
    ESTIMATE,
    GREY,
    START,
    TRUTH,
    Array,
    Figure,
    complete,
    drawn,
    finite,
    legend_above,
    limits,
    new_axes,
    not_a_strip,
    span,
)
from percept_obs.figures.labels import place_in_words, recording_of, story
from percept_obs.recording import Recording
from percept_obs.tracking.run import Run

_CORNERS = [(1, 0.75, 2), (-1, 0.75, 2), (-1, -0.75, 2), (1, -0.75, 2)]
_EDGES = [edge for corner in _CORNERS for edge in ((0, 0, 0), corner)]
CAMERA = np.array([*_EDGES, *_CORNERS]) / 2
"""Edges of a pyramid of height 1 that opens along Z, in one stroke."""


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
    path = complete(truth if len(truth) else estimate)
    camera = 0.1 * np.abs(path).max(initial=1e-3) * CAMERA
    _draw_places(ax, truth, TRUTH)
    _draw_places(ax, estimate, {**ESTIMATE, "linewidth": 0.9, "zorder": 1})
    _draw_places(ax, camera, {"color": BLUE, "linewidth": 1, "label": "camera"})
    if len(path):
        _draw_places(ax, np.array([(0, 0, 0), path[-1]]), {"color": GREY, "linestyle": ":", "label": "viewing ray"})
    _draw_places(ax, path[:1], {"color": BLACK, **START})
    _draw_places(ax, path[-1:], {"color": BLACK, **END})
    _set_equal_scales(ax, complete(np.vstack([camera, truth, estimate])))
    legend_above(ax, centred=True, fitting=66)
    return drawn(
        (ax,),
        [
            "Scene in metres, with the camera at the origin and Z forward.",
            _approach(recording.time, truth) if len(truth) else "",
            f"The point ends at X, Y, Z = {place_in_words(path[-1])} m." if len(path) else "No place is known.",
            "" if run is None else f"Estimate of the {run.observer.name} observer, dashed. {story(run)}",
            _gaps(estimate, far),
        ],
    )


def _draw_places(ax: Axes, points: Array, look: dict[str, Any]) -> None:
    """Z to the right, X into the picture and Y upwards, which is right-handed."""
    if len(points):
        ax.plot(*points.T[[2, 0, 1]], **look)


def _set_equal_scales(ax: Any, points: Array) -> None:
    """One scale for the three directions, and few numbers along them."""
    x, y, z = not_a_strip(*(limits(column) for column in points.T[[2, 0, 1]]))
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
    expected = usual if run.recording.truth is None else 1 / run.recording.view.inverse(run.recording.truth)
    return np.where((run.distance < far * expected)[:, None], run.points, np.nan)


def _gaps(estimate: Array, far: float) -> str:
    count = len(estimate) - len(complete(estimate))
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
