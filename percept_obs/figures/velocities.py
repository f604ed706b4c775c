"""The figure of a camera's velocity, as several derivatives of its poses have it."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures import look, words
from percept_obs.figures.base import Drawing, canvas, figure, legend_above
from percept_obs.recording.poses import CameraPath

TRUTH = "truth"
"""The label of the path that the others are compared with."""


@figure("there are no paths, their times differ, or the axis is none of 0, 1 and 2")
def velocities(paths: Mapping[str, CameraPath], axis: int = 0, ax: Axes | None = None) -> Drawing:
    """Velocity along one of the camera's own axes, as several derivatives of the same poses have it.

    Parameters
    ----------
    paths : mapping of labels to CameraPath
        From `Poses.path`; one that is labelled "truth" is drawn solid, and the others are compared with it.
    axis : int
        0, 1 and 2 are x to the right, y down and z forward.

    Examples
    --------
    >>> from percept_obs import Neighbours, Quadratic, figures, read_tum
    >>> from percept_obs.recording.worked import worked_folder
    >>> poses = read_tum(worked_folder() / "poses.txt")
    >>> paths = {"narrow": poses.path(Quadratic(0.1)), "neighbours": poses.path(Neighbours())}
    >>> print(figures.velocities(paths).text.split(". ")[1])
    narrow: from -0.226 to 0.226
    """
    if not paths or not all(isinstance(path, CameraPath) for path in paths.values()):
        raise ValueError(f"paths are needed, each with a label, not {paths!r}; poses.path(derivative) makes one")
    time = next(iter(paths.values())).time
    if not all(np.array_equal(path.time, time) for path in paths.values()):
        raise ValueError("the paths have different times; draw derivatives of the same poses")
    if axis not in (0, 1, 2):
        raise ValueError(f"the axis is {axis!r}; it must be 0, 1 or 2")
    ax = canvas(ax, 2.6)
    elapsed, name = time - time[0], "xyz"[axis]
    ax.set_xlabel("time (s)")
    ax.set_ylabel(f"velocity along {name} (m/s)")
    ax.set_xlim(elapsed[0], elapsed[-1])
    yield f"Velocity of the camera along its {name} axis in m/s, over {elapsed[-1]:.3g} s."
    others = {label: path.velocity[:, axis] for label, path in paths.items() if label != TRUTH}
    true = paths[TRUTH].velocity[:, axis] if TRUTH in paths else None
    for number, (label, values) in enumerate(others.items()):
        style = {key: value for key, value in look.style(number).items() if key != "marker"}
        ax.plot(elapsed, values, label=label, linewidth=1.3, **style)
        off = "" if true is None else f", off by {np.sqrt(np.mean((values - true) ** 2)):.2g} m/s, root mean square"
        yield f"{label}: {words.span(values)}{off}."
    if true is not None:
        ax.plot(elapsed, true, **look.TRUTH)
        yield f"The truth: {words.span(true)}."
    legend_above(ax)
    return [ax]
