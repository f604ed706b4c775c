"""Places of points at rest, from all pictures in which they are seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from percept_obs.compile import Array, Flags

STEPS = 6
"""Steps of Gauss and Newton; about four are needed."""

FAR_OFF = 3.0
"""Standard deviations beyond which a sample is left out."""


@dataclass(frozen=True, eq=False)
class Place:
    """Place of a point in the world, the standard deviation of its distance relative to it, and samples that agree.

    `spread` is the standard deviation of the samples in image coordinates, by those that agree.
    """

    position: Array
    deviation: float
    spread: float
    agree: Flags


def triangulate(positions: Array, turns: Array, image: Array) -> Place:
    """Return the place that explains image coordinates best, shape (K, 2), from known poses X_world = R X_camera + p.

    Outliers are left out.  The deviation counts the samples of a fifth of a second as one, for a corner that is
    followed drifts.
    """
    rays = np.einsum("kij,kj->ki", turns, np.column_stack([image, np.ones(len(image))]))
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    across = np.eye(3) - rays[:, :, None] * rays[:, None]  # the nearest point to all rays is where to begin
    place = np.linalg.lstsq(across.sum(axis=0), np.einsum("kij,kj->i", across, positions), rcond=None)[0]
    agree = np.ones(len(image), dtype=bool)
    for _ in range(STEPS):
        seen = np.einsum("kji,kj->ki", turns, place - positions)
        depth = np.where(np.abs(seen[:, 2:]) > 1e-9, seen[:, 2:], 1e-9)
        off = image - seen[:, :2] / depth
        slope = (turns[:, :, :2].swapaxes(1, 2) - (seen[:, :2] / depth)[:, :, None] * turns[:, None, :, 2]) / depth[
            :, :, None
        ]
        size = np.linalg.norm(off, axis=1)
        spread = max(float(np.median(size)) / 1.1774, 1e-7)  # the median of a Rayleigh distribution
        agree = size < FAR_OFF * 1.1774 * spread
        normal = np.einsum("kij,kil->jl", slope[agree], slope[agree])
        place = place + np.linalg.lstsq(normal, np.einsum("kij,ki->j", slope[agree], off[agree]), rcond=None)[0]
    along = np.median(seen[agree, 2])
    variance = spread**2 * np.linalg.eigvalsh(np.linalg.pinv(normal))[-1]
    return Place(place, float(np.sqrt(variance)) / abs(float(along)), spread, agree)
