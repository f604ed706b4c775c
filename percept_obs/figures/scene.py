"""Figures in space: the scene in metres, and a camera's velocity."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures import base, curves, describe, look
from percept_obs.figures.base import Array, Drawing, canvas, figure, legend_above
from percept_obs.recording import Recording
from percept_obs.recording.poses import CameraPath
from percept_obs.tracking.run import Run

_CORNERS = [(1, 0.75, 2), (-1, 0.75, 2), (-1, -0.75, 2), (1, -0.75, 2)]
_EDGES = [edge for corner in _CORNERS for edge in ((0, 0, 0), corner)]
CAMERA = np.array([*_EDGES, *_CORNERS]) / 2
"""Edges of a pyramid of height 1 that opens along Z, in one stroke."""


@figure("no place is known, `far` is not more than 1, or the axes are flat")
def scene(data: Run | Recording, far: float = 2.0, ax: Axes | None = None) -> Drawing:
    """The point's path in metres, with the camera at the origin and Z forward.

    Parameters
    ----------
    data : Run or Recording
        A recording alone must have its truth.
    far : float
        Estimates farther away than this many times the true distance, or not in front of the camera, are left out.
        Without the truth, the median of the estimated distances stands for it.

    Examples
    --------
    >>> from percept_obs import figures, record, scenarios
    >>> print(figures.scene(record(scenarios.ma2005_eq35(), 20)).text.split(". ")[-1])
    The point ends at X, Y, Z = (3.78, 10.1, 7.04) m.

    See Also
    --------
    image_plane : The path in the image.
    """
    recording, run = base.recording_and_run(data)
    if recording.points is None and run is None:
        raise ValueError("the recording has no truth, so no place is known; draw the run of an observer on it")
    if recording.outputs.ndim > 2:
        raise ValueError("a scene is of one point; image_plane() draws the images of several")
    if not far > 1:
        raise ValueError(f"far is {far}; it must be more than 1")
    if ax is not None and ax.name != "3d":
        raise ValueError("the axes are flat; make them with figure.add_subplot(projection='3d')")
    ax = canvas(ax, 5.6, projection="3d")
    truth = np.empty((0, 3)) if recording.points is None else recording.points
    estimate = np.empty((0, 3)) if run is None else _believable(run, far)
    path = curves.rows_without_nan(truth if len(truth) else estimate)
    camera = 0.1 * np.abs(path).max(initial=1e-3) * CAMERA
    _draw_in_space(ax, truth, **look.TRUTH)
    _draw_in_space(ax, estimate, **look.ESTIMATE | {"linewidth": 0.9, "zorder": 1})
    _draw_in_space(ax, camera, color=look.BLUE, linewidth=1, label="camera")
    if len(path):
        _draw_in_space(ax, np.array([(0, 0, 0), path[-1]]), color=look.GREY, linestyle=":", label="viewing ray")
    _draw_in_space(ax, path[:1], color=look.BLACK, **look.START)
    _draw_in_space(ax, path[-1:], color=look.BLACK, **look.END)
    _set_equal_scales(ax, curves.rows_without_nan(np.vstack([camera, truth, estimate])))
    legend_above(ax, centred=True, fitting=66)
    yield "Scene in metres, with the camera at the origin and Z forward."
    yield _approach(recording.elapsed, truth) if len(truth) else ""
    yield f"The point ends at X, Y, Z = {describe.place(path[-1])} m." if len(path) else "No place is known."
    yield "" if run is None else f"Estimate of the {run.observer.name} observer, dashed. {describe.story(run)}"
    if missing := len(estimate) - len(curves.rows_without_nan(estimate)):
        why = f"not in front of the camera or over {far:g} times as far away"
        yield f"Left out: {missing} of {len(estimate)} estimates, {why}."
    return [ax]


def _draw_in_space(ax: Axes, points: Array, **looks: Any) -> None:
    """Draw with Z to the right, X into the picture and Y upwards, which is right-handed."""
    if len(points):
        ax.plot(*points.T[[2, 0, 1]], **looks)


def _set_equal_scales(ax: Any, points: Array) -> None:
    """Set one scale for the three directions, with few ticks."""
    x, y, z = curves.widened_limits(*(curves.limits(column) for column in points.T[[2, 0, 1]]))
    ax.set(xlim=x, ylim=y, zlim=z)
    for set_label, name in ((ax.set_xlabel, "Z"), (ax.set_ylabel, "X"), (ax.set_zlabel, "Y")):
        set_label(f"${name}$ (m)", labelpad=12)
    ax.set_box_aspect(np.ptp([x, y, z], axis=1), zoom=0.76)
    ax.locator_params(nbins=4)
    ax.computed_zorder = False  # the truth stays above a noisy estimate


def _believable(run: Run, far: float) -> Array:
    """Return estimated places, shape (K, 3); NaN where they are not in front of the camera or too far away."""
    seen = describe.finite(run.distance)
    usual = np.median(seen) if seen.size else 0.0
    expected = usual if run.recording.truth is None else run.recording.distance
    return np.where((run.distance < far * expected)[:, None], run.points, np.nan)


def _approach(time: Array, points: Array) -> str:
    ranges = np.linalg.norm(points, axis=1)
    k = int(np.argmin(ranges))
    extents = ", ".join(f"{name} {describe.span(column)}" for name, column in zip("XYZ", points.T, strict=True))
    return f"The true path: {extents} m; closest to the camera at {time[k]:.3g} s, within {ranges[k]:.3g} m."


_TRUTH = "truth"
"""Label of the path that the others are compared with."""


@figure("there are no paths, one does not last as long as the truth, or the axis is none of 0, 1 and 2")
def velocities(paths: Mapping[str, CameraPath], axis: int = 0, ax: Axes | None = None) -> Drawing:
    """Velocity along one of the camera's own axes, by several paths of the same camera.

    Parameters
    ----------
    paths : mapping of labels to CameraPath
        From `Poses.path`; one that is labelled "truth" is drawn solid, and the others are compared with it.
    axis : int
        0, 1 and 2 are x to the right, y down and z forward.

    Examples
    --------
    >>> from percept_obs import figures, read_tum
    >>> from percept_obs.recording.worked import worked_folder
    >>> poses = read_tum(worked_folder() / "poses.txt")
    >>> print(figures.velocities({"smoothed": poses.path()}).text.split(". ")[1])
    smoothed: from -0.225 to 0.229.

    See Also
    --------
    percept_obs.rigid_from_poses : The motion from poses.
    """
    if not paths or not all(isinstance(path, CameraPath) for path in paths.values()):
        raise ValueError(f"paths are needed, each with a label, not {paths!r}; poses.path() makes one")
    if axis not in (0, 1, 2):
        raise ValueError(f"the axis is {axis!r}; it must be 0, 1 or 2")
    ax = canvas(ax, 2.6)
    true, name = paths.get(_TRUTH), "xyz"[axis]
    shown = true or next(iter(paths.values()))
    begin, length = shown.time[0], np.ptp(shown.time)
    ax.set_xlabel("time (s)")
    ax.set_ylabel(f"velocity along {name} (m/s)")
    ax.set_xlim(0, length)
    yield f"Velocity of the camera along its {name} axis in m/s, over {length:.3g} s."
    for number, (label, path) in enumerate((label, path) for label, path in paths.items() if label != _TRUTH):
        style = {key: value for key, value in look.style(number).items() if key != "marker"}
        ax.plot(path.time - begin, path.velocity[:, axis], label=label, linewidth=1.3, **style)
        off = ""
        if true is not None:
            wrong = (path.at(true.time).velocity - true.velocity)[:, axis]
            off = f", off by {np.sqrt(np.mean(wrong**2)):.2g} m/s, root mean square"
        yield f"{label}: {describe.span(path.velocity[:, axis])}{off}."
    if true is not None:
        ax.plot(true.time - begin, true.velocity[:, axis], **look.TRUTH)
        yield f"The truth: {describe.span(true.velocity[:, axis])}."
    legend_above(ax)
    return [ax]
