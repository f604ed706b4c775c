"""Velocities from poses; which derivative suits depends on the pace of the camera and the noise of its poses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from percept_obs.compile import Array, Indices
from percept_obs.validation import checked, positive

AT_ONCE = 200_000
"""Poses in windows that are fitted together, for about 50 MB of memory."""

Derived = tuple[Array, Array, Array, Array]
"""Positions and quaternions, smoothed, velocities along the world's axes, and angular velocities along the camera's."""


@checked
@dataclass(frozen=True)
class Neighbours:
    """Derivative from neighbours: the slope at each pose of the parabola through it and the next on either side.

    Poses are kept as they are.  It follows the fastest motion, and noise sigma in a position becomes sigma/(sqrt(2) h)
    in the velocity if the poses are h seconds apart.

    See Also
    --------
    Quadratic, SmoothingSpline : The other derivatives.

    Examples
    --------
    >>> from percept_obs import Neighbours, read_tum
    >>> from percept_obs.recording.worked import worked_folder
    >>> poses = read_tum(worked_folder() / "poses.txt")
    >>> poses.path(Neighbours()).velocity[50].round(2).tolist()
    [-0.14, -0.04, -0.01]
    """

    fewest = 3

    def of(self, time: Array, position: Array, orientation: Array) -> Derived:
        """Return poses and rates; see `Derived`."""
        begin = np.clip(np.arange(len(time)) - 1, 0, len(time) - 3)
        _, _, velocity, turning = _parabolas(time, position, orientation, begin, begin + 3)
        return position, orientation, velocity, turning


@checked
@dataclass(frozen=True)
class Quadratic:
    """Derivative from a window: the slope at each pose of a parabola fitted to all poses within a time to either side.

    Poses are smoothed.  With n poses in the window the noise in the velocity is about sigma sqrt(3/n)/half_width;
    what the motion does faster than the window is lost, about half_width^2/10 of the third derivative.

    Parameters
    ----------
    half_width : float
        Seconds to either side, positive; the nearest five poses are taken where fewer lie in the window.

    Raises
    ------
    ValueError
        If the half_width is not positive and finite.

    See Also
    --------
    Neighbours, SmoothingSpline : The other derivatives.

    Examples
    --------
    >>> from percept_obs.recording.pose_files import read_tum
    >>> from percept_obs.recording.worked import worked_folder
    >>> poses = read_tum(worked_folder() / "poses.txt")
    >>> wide, narrow = (poses.path(Quadratic(half_width)).velocity for half_width in (0.5, 0.1))
    >>> bool(abs(wide - narrow).max() < 0.05)
    True
    """

    half_width: float
    fewest = 5

    def __post_init__(self) -> None:
        positive(half_width=self.half_width)

    def of(self, time: Array, position: Array, orientation: Array) -> Derived:
        """Return smoothed poses and rates; see `Derived`."""
        return _parabolas(time, position, orientation, *self._windows(time))

    def _windows(self, time: Array) -> tuple[Indices, Indices]:
        """Return the first pose of each window and the one after its last."""
        width = self.half_width * (1 + 1e-9)  # a pose at the very edge is in, however its time was rounded
        begin, end = np.searchsorted(time, time - width), np.searchsorted(time, time + width)
        starts = np.arange(len(time))[:, None] + np.arange(1 - self.fewest, 1)
        starts = np.clip(starts, 0, len(time) - self.fewest)
        far = np.maximum(time[starts + self.fewest - 1] - time[:, None], time[:, None] - time[starts])
        nearest = starts[np.arange(len(time)), far.argmin(axis=1)]
        few = end - begin < self.fewest
        return np.where(few, nearest, begin), np.where(few, nearest + self.fewest, end)


@checked
@dataclass(frozen=True)
class SmoothingSpline:
    """Derivative of cubic smoothing splines, whose smoothness generalised cross-validation chooses.

    It needs no setting, but the noise must be white: correlated noise, as of poses that a filter has smoothed, is taken
    for motion.  The splines go through the entries of the quaternions.

    See Also
    --------
    Neighbours, Quadratic : The other derivatives.

    Examples
    --------
    >>> from percept_obs import SmoothingSpline, read_tum
    >>> from percept_obs.recording.worked import worked_folder
    >>> poses = read_tum(worked_folder() / "poses.txt")
    >>> poses.path(SmoothingSpline()).velocity[50].round(2).tolist()
    [-0.14, -0.04, -0.01]
    """

    fewest = 5

    def of(self, time: Array, position: Array, orientation: Array) -> Derived:
        """Return smoothed poses and rates; see `Derived`."""
        from scipy.interpolate import make_smoothing_spline

        quaternion = orientation.copy()
        flips = np.sign(np.sum(quaternion[1:] * quaternion[:-1], axis=1))  # q and -q are the same rotation
        quaternion[1:] *= np.cumprod(np.where(flips == 0, 1, flips))[:, None]
        splines = [make_smoothing_spline(time, column) for column in np.hstack([position, quaternion]).T]
        values = np.stack([spline(time) for spline in splines], axis=-1)
        rates = np.stack([spline.derivative()(time) for spline in splines], axis=-1)
        (u, s), (v, t) = ((each[:, 3:6], each[:, 6:]) for each in (values, rates))
        length = np.linalg.norm(values[:, 3:], axis=1, keepdims=True)
        turning = 2 * (s * v - t * u - np.cross(u, v)) / length**2  # 2 q* q' for a q of length 1
        return values[:, :3], values[:, 3:] / length, rates[:, :3], turning


Derivative = Neighbours | Quadratic | SmoothingSpline


def _parabolas(time: Array, position: Array, orientation: Array, begin: Indices, end: Indices) -> Derived:
    """Fit a parabola to the poses begin[k] to end[k] - 1 around each pose k, and return its value and slope there."""
    from scipy.spatial.transform import Rotation

    rotation, widest = Rotation.from_quat(orientation), int((end - begin).max())
    reach = np.maximum(time[end - 1] - time, time - time[begin])
    fit = np.empty((len(time), 2, 6))
    for rows in np.array_split(np.arange(len(time)), len(time) * widest // AT_ONCE + 1):
        near = begin[rows, None] + np.arange(widest)
        inside = near < end[rows, None]
        near = np.minimum(near, len(time) - 1)
        turned = rotation[np.repeat(rows, widest)].inv() * rotation[near.ravel()]
        shifted = position[near] - position[rows, None]
        values = np.concatenate([shifted, turned.as_rotvec().reshape(shifted.shape)], axis=-1)
        powers = (((time[near] - time[rows, None]) / reach[rows, None])[..., None] ** np.arange(3)) * inside[..., None]
        transposed = np.swapaxes(powers, 1, 2)
        fit[rows] = np.linalg.solve(transposed @ powers, transposed @ values)[:, :2]
    (shift, turn), (velocity, turning) = (np.split(fit[:, i], 2, axis=1) for i in (0, 1))
    velocity, turning = velocity / reach[:, None], turning / reach[:, None]
    smoothed = rotation * Rotation.from_rotvec(turn)
    # The first two terms of the series for w in the fit's correction; the others are of its second order.
    return position + shift, smoothed.as_quat(), velocity, turning - np.cross(turn, turning) / 2
