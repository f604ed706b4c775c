"""Positions of a point along a motion without mix-ups, a bias of its rotation and a drift of its scale."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np

from percept_obs.compile import Array
from percept_obs.recording.pose_errors import PoseErrors
from percept_obs.recording.reckoning import transitions
from percept_obs.studies.diagnosis.causes import MIX_UPS
from percept_obs.system.motion import Motion, coefficients

if TYPE_CHECKING:
    from scipy.interpolate import CubicHermiteSpline

LONGEST = 0.05
"""Longest step in seconds by which the motion is integrated; there are at most `MOST_STEPS`."""

MOST_STEPS = 2000

SPINS = np.cross(np.eye(3)[:, None], np.eye(3)[None], axis=-1).transpose(0, 2, 1)
"""Matrices of the cross products with the three axes, shape (3, 3, 3)."""


@dataclass(frozen=True, eq=False)
class Path:
    """Maps of (X, 1) from the first of some times to each of them, shape (N, 4, 4), with A and b then."""

    times: Array
    maps: Array
    A: Array
    b: Array

    @cached_property
    def spline(self) -> CubicHermiteSpline:
        """Maps of (X, 1) to X at any time, shape (..., 3, 4)."""
        from scipy.interpolate import CubicHermiteSpline

        rates = self.A @ self.maps[:, :3]
        rates[:, :, 3] += self.b
        return CubicHermiteSpline(self.times, self.maps[:, :3], rates)

    @cached_property
    def back(self) -> Array:
        """Inverse maps."""
        return np.asarray(np.linalg.inv(self.maps))

    def change(self, times: Array, rates: Array) -> Array:
        """Changes of a position at some times, shape (K, 3, q), by additional rates at the nodes, shape (N, 3, q)."""
        from scipy.integrate import cumulative_trapezoid
        from scipy.interpolate import make_interp_spline

        total = cumulative_trapezoid(self.back[:, :, :3] @ rates, self.times, axis=0, initial=0)
        return np.asarray(make_interp_spline(self.times, self.maps[:, :3] @ total, k=1)(times))


@lru_cache(maxsize=256)
def _known(motion: Motion, begin: float, end: float, unit: float) -> tuple[Array, Array, Array, Array, Array]:
    """Times from begin to end, A and b (by the unit of length) then, and at the two Gauss points of each step."""
    count = min(max(8, math.ceil((end - begin) / LONGEST)), MOST_STEPS)
    times = np.linspace(begin, end, count + 1)
    gauss = (times[:-1, None] + (end - begin) / count * (0.5 + np.array([-1, 1]) / math.sqrt(12))).ravel()
    rows = motion.known(np.concatenate([times, gauss]))
    A, b = coefficients(motion, np.broadcast_to(rows, (len(times) + len(gauss), rows.shape[1])))
    b = b / unit
    return times, A[: count + 1], b[: count + 1], A[count + 1 :], b[count + 1 :]


def _poses(errors: PoseErrors, times: Array, maps: Array, unit: float) -> Array:
    """Poses of a path, matrices of shape (N, 4, 4): it begins at the mean of where the given poses say that it does."""
    from scipy.interpolate import make_interp_spline
    from scipy.spatial.transform import Rotation

    inside = (errors.time >= times[0]) & (errors.time <= times[-1])
    turns, moved = errors.turns[inside], make_interp_spline(times, maps, k=3)(errors.time[inside])
    begin = np.eye(4)
    begin[:3, :3] = Rotation.from_matrix(turns @ moved[:, :3, :3]).mean().as_matrix()
    begin[:3, 3] = (errors.position[inside] / unit + np.einsum("kij,kj->ki", turns, moved[:, :3, 3])).mean(axis=0)
    return np.asarray(begin @ np.linalg.inv(maps))


@lru_cache(maxsize=256)
def path(
    motion: Motion, begin: float, end: float, unit: float, mix_up: str, bias: tuple[float, ...], drift: float
) -> Path:
    """Path under a motion without a mix-up, a bias and a drift, of fourth order in the step (Magnus)."""
    times, A, b, A_gauss, b_gauss = _known(motion, begin, end, unit)
    change, step = MIX_UPS[mix_up].undone, times[1] - times[0]
    gauss = (times[:-1, None] + step * (0.5 + np.array([-1, 1]) / math.sqrt(12))).ravel()
    turning = np.tensordot(bias, SPINS, axes=1)
    (A, b), (A_gauss, b_gauss) = change(A + turning, b), change(A_gauss + turning, b_gauss)
    b, b_gauss = (rows * np.exp(-drift * (at - begin))[:, None] for rows, at in ((b, times), (b_gauss, gauss)))
    A1, A2, b1, b2 = A_gauss[::2], A_gauss[1::2], b_gauss[::2], b_gauss[1::2]
    twist = math.sqrt(3) / 12 * step**2
    A_step = step / 2 * (A1 + A2) + twist * (A2 @ A1 - A1 @ A2)
    b_step = step / 2 * (b1 + b2) + twist * (A2 @ b1[:, :, None] - A1 @ b2[:, :, None])[:, :, 0]
    steps = np.broadcast_to(np.eye(4), (len(A1), 4, 4)).copy()
    steps[:, :3] = transitions(A_step, b_step, 1.0)
    maps = np.stack(list(accumulate(steps, lambda before, step: step @ before, initial=np.eye(4))))
    if (right := MIX_UPS[mix_up].poses) and motion.errors:
        mount = motion.errors.mount and (motion.errors.mount[0] / unit, motion.errors.mount[1])
        poses = right(_poses(motion.errors, times, maps, unit), mount)
        maps = np.linalg.inv(poses) @ poses[0]
        rates = np.gradient(maps[:, :3], float(step), axis=0, edge_order=2)
        A = rates[:, :, :3] @ maps[:, :3, :3].swapaxes(1, 2)
        b = rates[:, :, 3] - np.einsum("nij,nj->ni", A, maps[:, :3, 3])
    return Path(times, maps, A, b)
