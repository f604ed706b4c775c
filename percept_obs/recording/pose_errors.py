"""Errors of a motion that was made from poses: noise that they put into images, and speeds that do not fit them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from percept_obs.compile import Array
from percept_obs.recording.normal import project_out
from percept_obs.recording.reckoning import reckon
from percept_obs.system.motion import Motion
from percept_obs.validation import checked

WINDOW = 1.0
"""Seconds over which a virtual landmark is followed; the next window begins half of it later."""

SMALLEST, SURELY = 0.01, 3.0
"""Relative error of the distance, and its standard deviations, beyond which speeds are said not to fit the poses."""

NEAR = 0.2
"""Share of its depth at which a virtual landmark is left out, for it comes too near to the camera."""


@checked
@dataclass(frozen=True, eq=False)
class PoseErrors:
    """Errors of the poses that a motion was made from.

    Parameters
    ----------
    time, position, turns : arrays of shape (K,), (K, 3), (K, 3, 3)
        The poses as they were given, their rotations as matrices.
    shift, turn : float
        Variances of the smoothed positions' coordinates in m^2 and of the smoothed rotations' angles in rad^2.
    shift_memory, turn_memory : float
        Seconds over which the smoother averages; three times as long its errors stay alike.
    mount : pair of arrays, optional
        Place and rotation of the camera on the body whose poses were given.

    See Also
    --------
    Poses.path : Makes them.

    Examples
    --------
    >>> from percept_obs import read_tum
    >>> from percept_obs.recording.worked import worked_folder
    >>> errors = read_tum(worked_folder() / "poses.txt").motion().errors
    >>> errors.image_variance(2.0, 0.1) < 1e-6
    True
    """

    time: Array
    position: Array
    turns: Array
    shift: float
    shift_memory: float
    turn: float
    turn_memory: float
    mount: tuple[Array, Array] | None = None

    def image_variance(self, depth: float, interval: float) -> float:
        """Return the variance of white noise of the image that is as bad for an observer as the errors of the poses.

        Smoothed speeds are the exact derivative of the smoothed path, and only the images are taken from the true one;
        so errors of the path are errors of the images, for points at a depth in metres, seen every so many seconds.
        """
        shift = self.shift / depth**2 * max(1.0, 3 * self.shift_memory / interval)
        return shift + self.turn * max(1.0, 3 * self.turn_memory / interval)

    def landmark(self, motion: Motion, depth: float, begin: float, end: float) -> VirtualLandmark:
        """Return by how much a motion misses virtual landmarks that rest at a depth in metres, between two times.

        In each window one rests ahead of the camera, in the middle pose.  The poses say where it is seen, and so does
        the motion, from the first pose on.  What the start explains is taken out of the difference and of its
        derivative by ln Z; the regression of the one on the other is the bias.
        """
        inside = (self.time >= begin) & (self.time <= end)
        if motion.signal is not None and motion.signal.times is not None and len(motion.signal.times) > 1:
            known = motion.signal.times
            inside &= (self.time >= known[0]) & (self.time <= known[-1])
        if inside.sum() < 3:
            return VirtualLandmark(0.0, 0.0)
        time, turns, position = self.time[inside], self.turns[inside], self.position[inside]
        maps = reckon(motion, time)
        gathered = np.zeros(3)
        count = 0
        last = max(float(time[-1]) - WINDOW, float(time[0]))
        for start in np.arange(time[0], last + 1e-9, WINDOW / 2):
            part = slice(*np.searchsorted(time, [start - 1e-9, start + WINDOW + 1e-9]))
            found = _missed(turns[part], position[part], maps[part], depth) if part.stop - part.start > 2 else None
            if found is not None:
                slope, missed = found
                gathered += [slope @ slope, slope @ missed, missed @ missed]
                count += len(slope)
        size, product, square = gathered
        if not size > 0:
            return VirtualLandmark(0.0, 0.0)
        bias = product / size
        return VirtualLandmark(float(bias), float(np.sqrt(max(square - bias * product, 0.0) / count / size)))


@dataclass(frozen=True)
class VirtualLandmark:
    """Miss of landmarks at rest: distances are found 1 / (1 - bias) times as long, with the bias's deviation."""

    bias: float
    deviation: float

    @property
    def error(self) -> float:
        """Relative error of distances that the speeds surely cause, 0 if they fit the poses."""
        return abs(self.bias) if abs(self.bias) > max(SMALLEST, SURELY * self.deviation) else 0.0

    @property
    def sentence(self) -> str:
        """The finding in words; empty if the speeds fit."""
        if not self.error:
            return ""
        which = "long" if self.bias > 0 else "short"
        return (
            f"the speeds do not move a point as the poses do, so that distances come out about "
            f"{100 * abs(1 / (1 - self.bias) - 1) if self.bias < 1 else 100:.2g} % too {which}"
        )


def _missed(turns: Array, position: Array, maps: Array, depth: float) -> tuple[Array, Array] | None:
    """Return the derivative of a landmark's images by ln Z, and by how much they are missed, both without its start."""
    middle = len(turns) // 2
    place = position[middle] + depth * turns[middle, :, 2]
    seen = np.einsum("kji,kj->ki", turns, place - position)  # R^T (place - p)
    onward = maps @ np.linalg.inv(maps[0])
    moved = seen[0] @ onward[:, :3, :3].swapaxes(1, 2) + onward[:, :3, 3]
    there = (seen[:, 2] > NEAR * depth) & (moved[:, 2] > NEAR * depth)
    if not there[0] or there.sum() < 3:
        return None
    seen, moved, onward = seen[there], moved[there], onward[there, :3, :3]
    image = moved[:, :2] / moved[:, 2:]
    changes = onward @ np.column_stack([seen[0], *(seen[0, 2] * np.eye(3)[:2])])  # by ln Z, y1 and y2 of the start
    slopes = ((changes[:, :2] - image[:, :, None] * changes[:, 2:]) / moved[:, 2, None, None]).reshape(-1, 3)
    missed = (seen[:, :2] / seen[:, 2:] - image).ravel()
    both = project_out(np.column_stack([slopes[:, 0], missed]), slopes[:, 1:])
    return both[:, 0], both[:, 1]
