"""Moving-window least squares: the batch reference that the observers are measured against."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from scipy.linalg import expm

from percept_obs.compile import vectorised
from percept_obs.recording import Recording
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import POINT

Array = NDArray[np.float64]

LARGEST_CONDITION = 1e6
"""A window whose normal equations are conditioned worse than this determines no point."""


@dataclass(frozen=True, eq=False)
class WindowEstimate:
    """Positions estimated from the samples of a window that ends at each sample.

    Parameters
    ----------
    recording : Recording
    points : array of shape (K, 3)
        Positions in metres; infinite where the window determines none in front of the camera.
    window : float
        Length of the window in seconds.
    """

    recording: Recording
    points: Array
    window: float

    @property
    def time(self) -> Array:
        """Times of the samples in seconds, shape (K,)."""
        return self.recording.time

    @property
    def determined(self) -> NDArray[np.bool_]:
        """Where the window determines a point in front of the camera, shape (K,)."""
        found: NDArray[np.bool_] = np.all(np.isfinite(self.points), axis=1)
        return found

    @cached_property
    def estimate(self) -> Array:
        """Image coordinates and inverse distance, shape (K, n); all 0 where no point is determined."""
        estimate = np.zeros((len(self.points), len(self.recording.view.coordinates)))
        estimate[self.determined] = self.recording.imaging_surface.project(self.points[self.determined])
        return estimate

    @cached_property
    def distance(self) -> Array:
        """Estimated depth or range in metres, shape (K,); infinite where no point is determined."""
        inverse = self.estimate[:, -1]
        return np.divide(1, inverse, out=np.full_like(inverse, np.inf), where=inverse > 0)

    @property
    def truth(self) -> Array:
        """True coordinates, shape (K, n).

        Raises
        ------
        ValueError
            If the recording has none.
        """
        if self.recording.truth is None:
            raise ValueError("the recording has no truth to compare with")
        return self.recording.truth


def moving_window_least_squares(
    recording: Recording, window: float = 2.0, believed: Motion | None = None
) -> WindowEstimate:
    """Least-squares position at the end of a window, from all samples in it.

    The point of each sample lies on its ray: the cross product of the ray and the position is zero.  With the known
    affine motion every position is affine in the one at the window's end, so that this is a linear problem.

    Parameters
    ----------
    recording : Recording
        With all image coordinates of its surface.
    window : float
        Seconds.
    believed : Motion, optional
        The motion that is believed in; the recording's own when left out.

    Returns
    -------
    WindowEstimate

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
    back = _back(recording, believed or recording.motion)

    matrix, right = np.zeros((count, 3, 3)), np.zeros((count, 3))
    # from the position at the window's end to that of the sample some places before it
    to_earlier = np.broadcast_to(np.eye(4), (count, 4, 4)).copy()
    for lag in range(count):
        ends = np.flatnonzero((time[lag:] - time[: count - lag]) <= window + 1e-9) + lag
        if not len(ends):
            break
        if lag:
            to_earlier[ends] = back[ends - lag] @ to_earlier[ends]
        seen = ends[np.isfinite(rays[ends - lag]).all(axis=1)]
        rows = on_ray[seen - lag] @ to_earlier[seen, :3, :3]
        matrix[seen] += np.swapaxes(rows, 1, 2) @ rows
        right[seen] -= (np.swapaxes(rows, 1, 2) @ (on_ray[seen - lag] @ to_earlier[seen, :3, 3:]))[:, :, 0]
    points = np.full((count, 3), np.inf)
    values = np.linalg.eigvalsh(matrix)
    good = values[:, 0] * LARGEST_CONDITION > values[:, -1]
    points[good] = np.linalg.solve(matrix[good], right[good][:, :, None])[:, :, 0]
    (distance,) = vectorised(POINT, (surface.distance,), surface.values)(*np.where(np.isfinite(points), points, -1).T)
    points[distance <= 0] = np.inf
    return WindowEstimate(recording, points, window)


def _back(recording: Recording, motion: Motion) -> Array:
    """Affine maps, shape (K - 1, 4, 4), from the position at a sample to that at the sample before it."""
    time = recording.time
    middle = (time[:-1] + time[1:]) / 2
    known = motion.known(middle)
    together = list(sp.Matrix.hstack(sp.Matrix(motion.A), sp.Matrix(motion.b)))
    entries = vectorised(motion.parameters, together)(*known.T)
    generator = np.zeros((len(middle), 4, 4))
    generator[:, :3, :] = np.stack(entries, axis=-1).reshape(-1, 3, 4)
    return expm(-generator * np.diff(time)[:, None, None])
