"""Moving-window least squares: the batch reference that the observers are measured against."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp
from scipy.linalg import expm

from percept_obs.compile import Array, vectorised
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.signal import slack_of
from percept_obs.tracking.run import Run
from percept_obs.validation import checked

LARGEST_CONDITION = 1e6
"""A window whose normal equations are conditioned worse than this determines no point."""


@checked
@dataclass(frozen=True, eq=False)
class LeastSquares:
    """Least squares where a run asks for its observer: what they are called, and what they estimate.

    Parameters
    ----------
    recording : Recording
    window : float
        Seconds.
    """

    recording: Recording
    window: float
    covariance = None
    gains = ()
    unobservable = ()

    @property
    def name(self) -> str:
        """With the length of the window."""
        return f"least squares on {self.window:g} s"

    @cached_property
    def form(self) -> PartitionedSystem:
        """With all image coordinates measured."""
        recording = self.recording
        return PerspectiveSystem(recording.motion, recording.imaging_surface).measure(*recording.names)


@checked
def moving_window_least_squares(recording: Recording, window: float = 2.0) -> Run:
    """Least-squares position at the end of a window, from all samples in it.

    The point of each sample lies on its ray: the cross product of the ray and the position is zero.  With the known
    affine motion every position is affine in the one at the window's end, so that this is a linear problem.

    Parameters
    ----------
    recording : Recording
        With all image coordinates of its surface.
    window : float
        Seconds.

    Returns
    -------
    Run
        Its estimates are 0, so that they have no distance, where the window determines no point in front of the camera.

    Raises
    ------
    ValueError
        If an image coordinate was not recorded or the window is not positive.

    Notes
    -----
    Between samples the motion's coefficients are taken from the middle of the interval.
    """
    surface = recording.imaging_surface
    names = tuple(symbol.name for symbol in surface.image_coordinates)
    if recording.names != names:
        raise ValueError(f"least squares need the outputs {', '.join(names)}; there are {', '.join(recording.names)}")
    if not (np.isfinite(window) and window > 0):
        raise ValueError(f"the window is {window} s; it must be positive")
    time, count = recording.time, len(recording.time)
    rays = np.stack(vectorised(surface.image_coordinates, surface.ray, surface.values)(*recording.outputs.T), axis=-1)
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    on_ray = np.eye(3) - rays[:, :, None] * rays[:, None, :]
    back = _back(recording)

    matrix, right = np.zeros((count, 3, 3)), np.zeros((count, 3))
    # from the position at the window's end to that of the sample some places before it
    to_earlier = np.broadcast_to(np.eye(4), (count, 4, 4)).copy()
    for lag in range(count):
        ends = np.flatnonzero((time[lag:] - time[: count - lag]) <= window + slack_of(time)) + lag
        if not len(ends):
            break
        if lag:
            to_earlier[ends] = back[ends - lag] @ to_earlier[ends]
        seen = ends[np.isfinite(rays[ends - lag]).all(axis=1)]
        rows = on_ray[seen - lag] @ to_earlier[seen, :3, :3]
        matrix[seen] += np.swapaxes(rows, 1, 2) @ rows
        right[seen] -= (np.swapaxes(rows, 1, 2) @ (on_ray[seen - lag] @ to_earlier[seen, :3, 3:]))[:, :, 0]
    values = np.linalg.eigvalsh(matrix)
    good = np.flatnonzero(values[:, 0] * LARGEST_CONDITION > values[:, -1])
    points = np.linalg.solve(matrix[good], right[good][:, :, None])[:, :, 0]
    distance = surface.distances(points)
    estimate = np.zeros((count, len(surface.coordinates)))
    estimate[good[distance > 0]] = surface.project(points[distance > 0])
    always = np.zeros(count, dtype=int)
    return Run(recording, LeastSquares(recording, window), estimate, estimate, None, "zero", np.empty(0), always)


def _back(recording: Recording) -> Array:
    """Affine maps, shape (K - 1, 4, 4), from the position at a sample to that at the sample before it."""
    time, motion = recording.time, recording.motion
    middle = (time[:-1] + time[1:]) / 2
    known = motion.known(middle)
    together = list(sp.Matrix.hstack(sp.Matrix(motion.A), sp.Matrix(motion.b)))
    entries = vectorised(motion.parameters, together)(*known.T)
    generator = np.zeros((len(middle), 4, 4))
    generator[:, :3, :] = np.stack(entries, axis=-1).reshape(-1, 3, 4)
    return expm(-generator * np.diff(time)[:, None, None])
