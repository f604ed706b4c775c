"""Nonlinear least squares: how well one point explains the samples of a recording, under the motion as it is known."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate

import numpy as np

from percept_obs.compile import Array, vectorised
from percept_obs.recording import Recording
from percept_obs.studies.least_squares import maps_between
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import POINT

SETTLED = 1e-3
"""Relative change of the sum of squares at which the iteration stops."""

FAR = 1e3
"""Image coordinate that stands for an infinite one."""


@dataclass(frozen=True, eq=False)
class Explained:
    """Residuals of samples when one point explains them best, shape (K, m); NaN where a sample was lost."""

    residuals: Array

    @property
    def squares(self) -> float:
        """Sum of squares."""
        return float(np.nansum(self.residuals**2))

    @property
    def count(self) -> int:
        """Number of values that were seen."""
        return int(np.isfinite(self.residuals).sum())

    @property
    def effective_count(self) -> float:
        """Effective sample size: the count, less for residuals that are correlated with their neighbours in time."""
        r = min(max(self.correlation, 0.0), 0.99)
        return self.count * (1 - r) / (1 + r)

    @property
    def correlation(self) -> float:
        """Correlation of residuals with their neighbours in time; 0 for white noise."""
        products = np.nansum(self.residuals[1:] * self.residuals[:-1])
        return float(products / max(self.squares, np.finfo(float).tiny))


def explain(recording: Recording) -> Explained:
    """Return what the point, in front of the camera or infinitely far away, leaves that explains all samples best.

    The unknowns are its image coordinates and inverse distance at the middle sample.  Images do not change with the
    length of a ray, so that a point infinitely far away needs no other formula.

    Parameters
    ----------
    recording : Recording
        Of a single point.

    See Also
    --------
    diagnose : Compares what is left.

    Examples
    --------
    >>> from percept_obs import record, scenarios
    >>> explain(record(scenarios.ma2005_eq35(), 4)).squares < 1e-8
    True
    """
    from scipy.optimize import leastsq

    surface, seen = recording.imaging_surface, np.isfinite(recording.outputs)
    unit = recording.unit
    middle, maps = len(seen) // 2, _maps_from_the_middle(recording.motion, recording.time.tobytes())
    order = [surface.image_coordinates.index(s) for s in surface.image_coordinates if s.name in recording.names]
    image = vectorised(POINT, surface.image, surface.values)
    ray = vectorised(surface.image_coordinates, surface.ray, surface.values)

    def residuals(x: Array) -> Array:
        with np.errstate(all="ignore"):
            points = maps[:, :3] @ np.array([*ray(*x[:-1]), x[-1] / unit], dtype=float)  # times the inverse distance
            found = np.stack(image(*points.T), axis=-1)[:, order]
        found = np.nan_to_num(found, nan=FAR, posinf=FAR, neginf=-FAR)
        return np.asarray(np.where(seen, recording.outputs - found, 0.0).ravel())

    whole = np.flatnonzero(seen.all(axis=1))
    start = np.zeros(len(surface.image_coordinates) + 1)
    start[order] = recording.outputs[whole[np.argmin(np.abs(whole - middle))]]
    best, _, about, *_ = leastsq(residuals, start, full_output=True, ftol=SETTLED)
    if best[-1] < 0:  # behind the camera: a point infinitely far away in front of it explains the samples next best
        _, _, about, *_ = leastsq(lambda x: residuals(np.append(x, 0.0)), start[:-1], full_output=True, ftol=SETTLED)
    return Explained(np.where(seen, about["fvec"].reshape(seen.shape), np.nan))


@lru_cache(maxsize=64)
def _maps_from_the_middle(motion: Motion, times: bytes) -> Array:
    """Affine maps of (X, 1) from the middle sample to each, shape (K, 4, 4)."""
    between = maps_between(motion, np.frombuffer(times))
    maps = np.stack(list(accumulate(between, lambda before, after: after @ before, initial=np.eye(4))))
    return np.asarray(maps @ np.linalg.inv(maps[len(maps) // 2]))
