"""How well a point explains what was seen of it, if the motion is as it is known: least squares over a recording."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate

import numpy as np

from percept_obs.compile import Array, vectorised
from percept_obs.recording import Recording
from percept_obs.system.motion import TIME, Motion
from percept_obs.system.surfaces import POINT, ImagingSurface

PASSES = 12
"""Steps of Gauss and Newton at most."""

SETTLED = 1e-3
"""Relative change of the sum of squares below which they stop."""

TERMS = 12
"""Terms of the exponential series, for intervals over which a motion turns by less than a radian."""

FAR = 1e3
"""Where image coordinates are taken to be that are beyond all bounds."""


@dataclass(frozen=True, eq=False)
class Explained:
    """What is left of a recording's samples when one point explains them best.

    Parameters
    ----------
    left : array of shape (K, m)
        NaN where a sample was lost.
    """

    left: Array

    @property
    def squares(self) -> float:
        """Sum of squares."""
        return float(np.nansum(self.left**2))

    @property
    def count(self) -> int:
        """Numbers that were seen."""
        return int(np.isfinite(self.left).sum())

    @property
    def correlation(self) -> float:
        """Of what is left with its neighbour in time; 0 for white noise."""
        together = np.nansum(self.left[1:] * self.left[:-1])
        return float(together / max(self.squares, np.finfo(float).tiny))


def explain(recording: Recording) -> Explained:
    """The point that explains all samples best, in front of the camera or infinitely far away, and what it leaves.

    The unknowns are its image coordinates and inverse distance at the middle sample; images do not change with the
    length of a ray, so that a point infinitely far away needs no other formula.
    """
    surface = recording.imaging_surface
    maps = _path(recording.motion, recording.time.tobytes())
    middle = len(maps) // 2
    maps = maps @ np.linalg.inv(maps[middle])
    turned, shifted = maps[:, :3, :3], maps[:, :3, 3]
    order = [surface.image_coordinates.index(s) for s in surface.image_coordinates if s.name in recording.names]
    seen = np.isfinite(recording.outputs)
    image, ray = _image(surface), _ray(surface)
    size = len(surface.image_coordinates)

    def looked(x: Array) -> tuple[Array, Array]:
        """Outputs and their derivative by the unknowns, shapes (K, m) and (K, m, n)."""
        m, slope_of_m = ray(x[:size])
        found, slope = image(turned @ m + x[-1] * shifted)
        along = np.concatenate([turned @ slope_of_m, shifted[:, :, None]], axis=2)
        return found[:, order], (slope @ along)[:, order]

    whole = np.flatnonzero(seen.all(axis=1))
    x = np.zeros(size + 1)
    x[order] = recording.outputs[whole[np.argmin(np.abs(whole - middle))]]
    step, last, left = np.zeros(size + 1), np.inf, recording.outputs
    for _ in range(PASSES):
        found, slope = looked(x + step)
        off = np.where(seen, recording.outputs - found, 0.0)
        squares = float((off**2).sum())
        if not squares < last:
            step = step / 4
            continue
        x, settled, last, left = x + step, squares > (1 - SETTLED) * last, squares, off
        if settled:
            break
        step = _step((slope * seen[:, :, None]).reshape(-1, size + 1), off.ravel(), x)
    return Explained(np.where(seen, left, np.nan))


def _step(rows: Array, off: Array, x: Array) -> Array:
    """By Gauss and Newton, but not behind the camera: to an inverse distance of 0 instead."""
    step = np.asarray(np.linalg.lstsq(rows, off, rcond=1e-9)[0], dtype=np.float64)
    if x[-1] + step[-1] < 0:
        step = np.asarray(np.linalg.lstsq(rows[:, :-1], off + rows[:, -1] * x[-1], rcond=1e-9)[0], dtype=np.float64)
        return np.append(step, -x[-1])
    return step


@lru_cache(maxsize=64)
def _path(motion: Motion, times: bytes) -> Array:
    """Maps of (X, 1) from the first time to each, shape (K, 4, 4); between two, the motion is that of their middle."""
    time = np.frombuffer(times)
    known = motion.known((time[1:] + time[:-1]) / 2)
    entries = vectorised(motion.parameters or (TIME,), (*motion.A, *motion.b))(*known.T)
    generator = np.zeros((len(time) - 1, 4, 4))
    rows = np.stack(np.broadcast_arrays(*entries), axis=-1)
    generator[:, :3, :3], generator[:, :3, 3] = rows[:, :9].reshape(-1, 3, 3), rows[:, 9:]
    generator *= np.diff(time)[:, None, None]
    across = np.broadcast_to(np.eye(4), generator.shape)
    for k in range(TERMS, 0, -1):
        across = np.eye(4) + generator @ across / k
    return np.stack(list(accumulate(across, lambda before, after: after @ before, initial=np.eye(4))))


@lru_cache(maxsize=16)
def _image(surface: ImagingSurface) -> Callable[[Array], tuple[Array, Array]]:
    """Image coordinates of points, and their derivative by the points, shapes (K, m) and (K, m, 3)."""
    m = len(surface.image)
    expressions = (*surface.image, *(entry.diff(x) for entry in surface.image for x in POINT))
    evaluate = vectorised(POINT, expressions, surface.values)

    def image(points: Array) -> tuple[Array, Array]:
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            found = np.nan_to_num(np.stack(evaluate(*points.T), axis=-1), nan=FAR, posinf=FAR, neginf=-FAR)
        return found[:, :m], found[:, m:].reshape(-1, m, 3)

    return image


@lru_cache(maxsize=16)
def _ray(surface: ImagingSurface) -> Callable[[Array], tuple[Array, Array]]:
    """The ray of image coordinates, and its derivative, shapes (3,) and (3, m)."""
    y = surface.image_coordinates
    evaluate = vectorised(y, (*surface.ray, *(entry.diff(x) for entry in surface.ray for x in y)), surface.values)

    def ray(x: Array) -> tuple[Array, Array]:
        found = np.array([float(part) for part in evaluate(*x)])
        return found[:3], found[3:].reshape(3, -1)

    return ray
