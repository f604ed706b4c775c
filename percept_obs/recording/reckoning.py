"""Dead reckoning: maps that move a point as the known motion does, and the point that they keep on given rays."""

from __future__ import annotations

import math
from itertools import accumulate

import numpy as np

from percept_obs.compile import Array
from percept_obs.recording.path import REACH, exponential
from percept_obs.system.motion import Motion, coefficients

LONGEST = 1 / 120
"""Seconds of a step at most; in each step the motion is as in its middle."""

MOST_STEPS = 20_000
"""Steps at most, so that hours take no longer than minutes."""

REWEIGHTED = 3
"""Number of times that the equations for a point are solved, each time weighted by the distances found last."""


def reckon(motion: Motion, times: Array) -> Array:
    """Return the maps of (X, 1) from the first of some times to each of them, shape (K, 4, 4)."""
    steps = maps_between(motion, times)
    return np.stack([*accumulate(steps, lambda before, step: step @ before, initial=np.eye(4))])


def maps_between(motion: Motion, times: Array) -> Array:
    """Return the maps of (X, 1) from each of some times to the next one, shape (K - 1, 4, 4)."""
    steps = np.diff(times)
    longest = max(LONGEST, abs(float(times[-1] - times[0])) / MOST_STEPS)
    parts = np.ceil(np.abs(steps) / longest * (1 - 1e-9)).astype(int)
    found = np.tile(np.eye(4), (len(steps), 1, 1))
    # intervals with the same number of steps go side by side
    for count in np.unique(parts):
        rows = np.flatnonzero(parts == count)
        length = (steps[rows] / count)[:, None]
        middles = times[rows, None] + (np.arange(count) + 0.5) * length
        A, b = coefficients(motion, motion.known(middles.ravel()))
        length = np.repeat(length, count, axis=0)
        maps = np.tile(np.eye(4), (len(length), 1, 1))
        maps[:, :3] = transitions(length[:, :, None] * A, length * b, 1.0)
        for part in range(count):
            found[rows] = maps[part::count] @ found[rows]
    return found


def transitions(A: Array, b: Array, length: float) -> Array:
    """Return maps [M | v] of a position to the one `length` seconds later, shape (D, 3, 4), under constant motions."""
    whole = np.zeros((len(A), 4, 4))  # of (X, 1), so that b is a part of the matrix
    whole[:, :3, :3], whole[:, :3, 3] = length * A, length * b
    fastest = float(np.abs(whole).sum(axis=1).max(initial=0.0))
    halvings = max(0, int(np.ceil(np.log2(max(fastest / REACH, 1.0)))))
    with np.errstate(over="ignore", invalid="ignore"):
        across = exponential(whole / 2**halvings)
        for _ in range(halvings):
            across = across @ across
    return np.ascontiguousarray(across[:, :3])


def point_on_rays(rays: Array, maps: Array) -> tuple[Array, Array, Array]:
    """Return (X, 1) times a factor, so that its maps lie on rays, the distances along these, and directions around it.

    A ray, shape (K, 3) and of length 1, and the position are parallel, so that their cross product is 0 (the direct
    linear transform).  The directions, shape (4, 3), are those of its singular vectors.
    """
    weight = np.linalg.norm(maps, axis=(1, 2))
    across = np.cross(rays[:, :, None], maps, axis=1)
    for _ in range(REWEIGHTED):  # by the distance of each position, so that angles are left and not lengths
        vectors = np.linalg.svd((across / weight[:, None, None]).reshape(-1, 4), full_matrices=False)[2]
        along = np.einsum("ki,kij,j->k", rays, maps, vectors[-1])
        weight = np.maximum(np.abs(along), 1e-6 * max(float(np.abs(along).max()), 1e-6))
    # a singular vector has either sign; the point is in front of the camera
    sign = math.copysign(1.0, float(np.median(along)))
    return vectors[-1] * sign, along * sign, vectors[:3].T
