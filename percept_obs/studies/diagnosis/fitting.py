"""Joint least squares of points and wrong numbers on the tracks of a camera, and how sure the numbers are."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from percept_obs.compile import Array
from percept_obs.recording.normal import NormalEquations, project_out
from percept_obs.studies.diagnosis.causes import NUMBERS
from percept_obs.studies.diagnosis.tracks import Track, across_of, guess, seen
from percept_obs.tracking.information import LIMITS

FINEST = LIMITS.camera
"""Standard deviation of the samples of the best camera, in focal lengths."""

BLOCKS = 10
"""Parts of the recordings over time in which errors may be correlated: few of them hold what changes slowly."""

MOST_STEPS = 30
"""Evaluations of a fit at most."""


@dataclass(frozen=True)
class Estimate:
    """Number of a cause, with its largest standard deviation if errors are white.

    `sure` is by how many standard deviations it differs from 0, the lesser of that for white errors and of that for
    errors that are correlated within tenths of the recordings and among tracks.
    """

    value: Array
    deviation: float
    sure: float


@dataclass(frozen=True, eq=False)
class Fit:
    """Points, one for each track, and wrong numbers by cause that explain the samples best."""

    tracks: Sequence[Track]
    mix_up: str
    wrong: Mapping[str, Array]
    points: Sequence[Array]

    @cached_property
    def residuals(self) -> list[Array]:
        """Residuals of each track's samples after the fit, shape (K, m), NaN where a value is not used."""
        pairs = zip(self.tracks, self.points, strict=True)
        images = ((track, seen(track, point, self.mix_up, self.wrong).outputs) for track, point in pairs)
        return [np.where(track.used, image - track.outputs, np.nan) for track, image in images]

    @cached_property
    def values(self) -> Array:
        """All residuals that are used."""
        return np.concatenate([each[np.isfinite(each)] for each in self.residuals])

    @property
    def squares(self) -> float:
        """Sum of their squares."""
        return float((self.values**2).sum())

    @property
    def unknowns(self) -> int:
        """Number of wrong numbers."""
        return sum(map(len, self.wrong.values()))

    @property
    def rms(self) -> float:
        """Root mean square, with the unknowns counted."""
        return _rms(self.values, 3 * len(self.points) + self.unknowns)

    @cached_property
    def each(self) -> Array:
        """Root mean square of each track's residuals."""
        return np.array([_rms(left[np.isfinite(left)], 3) for left in self.residuals])

    @property
    def typical(self) -> float:
        """Median of the tracks' root mean squares, of a few tracks the one of all values."""
        return float(np.median(self.each)) if len(self.each) > 2 else self.rms

    @cached_property
    def correlation(self) -> float:
        """Correlation of neighbours in time; 0 for white noise."""
        products = [float(np.nansum(left[1:] * left[:-1])) for left in self.residuals]
        return sum(products) / max(self.squares, np.finfo(float).tiny)

    def gain(self, other: Fit) -> float:
        """Logarithm by which the samples are more likely than with another fit, less the price of the unknowns.

        Residuals that are correlated with their neighbours in time count for less of them (effective sample size).
        """
        r = min(max(self.correlation, 0.0), 0.99)
        finest, count = FINEST**2 * len(self.values), len(self.values) * (1 - r) / (1 + r)
        ratio = (other.squares + finest) / (self.squares + finest)
        return count / 2 * math.log(ratio) - (self.unknowns - other.unknowns) / 2 * math.log(max(count, 2.0))

    def estimates(self, keys: Sequence[str]) -> dict[str, Estimate]:
        """Numbers of causes with their deviations, all points and the numbers that were fitted unknown as well.

        A number that was not fitted is estimated by one step of Gauss and Newton.
        """
        normal = self._normal([*dict.fromkeys([*self.wrong, *keys])])
        return {key: self._estimate(normal, key) for key in keys}

    def _normal(self, keys: Sequence[str]) -> NormalEquations:
        """Normal equations of some causes' numbers, with the scores of each tenth of the recordings."""
        rows, times = [], []
        for track, point in zip(self.tracks, self.points, strict=True):
            model = seen(track, point, self.mix_up, self.wrong, keys)
            rows.append(project_out(model.by_cause[track.used], model.by_point[track.used] @ across_of(point, 4)))
            times.append(np.broadcast_to(track.time[:, None], track.used.shape)[track.used])
        columns, time = np.concatenate(rows), np.concatenate(times)
        block = np.searchsorted(np.quantile(time, np.arange(1, BLOCKS) / BLOCKS), time)
        scores = columns.T @ (self.values[:, None] * (block[:, None] == np.arange(BLOCKS)))
        owner = np.repeat(keys, [NUMBERS[key].size for key in keys])
        return NormalEquations(owner, columns.T @ columns, scores, np.full(len(owner), np.inf))

    def _estimate(self, normal: NormalEquations, key: str) -> Estimate:
        """Estimate of one cause's number; clusters are blocks of time (Liang and Zeger)."""
        chosen, steps, covariance = normal.solved([*self.wrong, key])
        own, spread = normal.owner[chosen] == key, max(self.rms, FINEST)
        value, covariance, steps = self.wrong.get(key, np.zeros(own.sum())), covariance[np.ix_(own, own)], steps[own]
        if np.isinf(covariance).any():
            return Estimate(value, math.inf, 0.0)
        value = value - steps.sum(axis=1)
        apart = steps - steps.mean(axis=1, keepdims=True)
        white, clustered = covariance * spread**2, apart @ apart.T * BLOCKS / (BLOCKS - 1)
        both = [float(value @ np.linalg.lstsq(matrix, value, rcond=None)[0]) for matrix in (white, clustered + white)]
        largest = float(np.linalg.eigvalsh(covariance)[-1])
        return Estimate(value, spread * math.sqrt(largest), math.sqrt(max(0.0, min(both)) / len(value)))


def _rms(values: Array, unknowns: int) -> float:
    """Root mean square of residuals; unknowns are taken from their number."""
    return math.sqrt(float((values**2).sum()) / max(len(values) - unknowns, 1)) if len(values) else 0.0


def fit(tracks: Sequence[Track], mix_up: str, keys: Sequence[str], start: Mapping[str, Array] | None = None) -> Fit:
    """Return the points and the numbers of some causes that explain the samples best.

    Points are in front of the camera or infinitely far away, and numbers within their causes' ranges.
    """
    begin = {key: np.zeros(NUMBERS[key].size) for key in keys} | {k: v for k, v in (start or {}).items() if k in keys}
    found = _solved(tracks, mix_up, begin, [guess(track, mix_up, begin) for track in tracks])
    behind = [point[3] < 0 for point in found.points]
    if any(behind):  # a point infinitely far away in front explains the samples next best
        again = []
        for track, point, is_behind in zip(tracks, found.points, behind, strict=True):
            far = np.append(point[:3], 0.0)
            again.append((far, across_of(far, 3)) if is_behind else guess(track, mix_up, found.wrong))
        found = _solved(tracks, mix_up, found.wrong, again)
    return found


def _solved(
    tracks: Sequence[Track], mix_up: str, begin: Mapping[str, Array], guesses: Sequence[tuple[Array, Array]]
) -> Fit:
    """Fit from guesses of the points, each with the directions in which it may change."""
    from scipy.linalg import block_diag
    from scipy.optimize import least_squares

    sizes = [*(NUMBERS[key].size for key in begin), *(across.shape[1] for _, across in guesses)]
    largest = np.repeat([*(NUMBERS[key].largest for key in begin), *(np.inf for _ in guesses)], sizes)
    start = np.concatenate([*begin.values(), np.zeros(sum(sizes[len(begin) :]))])

    def parted(x: Array) -> tuple[dict[str, Array], list[Array]]:
        pieces = np.split(x, np.cumsum(sizes)[:-1])
        moved = zip(guesses, pieces[len(begin) :], strict=True)
        return dict(zip(begin, pieces, strict=False)), [point + across @ change for (point, across), change in moved]

    @lru_cache(maxsize=1)  # scipy asks for the residuals, and then for their derivatives
    def at(x: bytes) -> tuple[Array, Array]:
        wrong, points = parted(np.frombuffer(x))
        models = [seen(track, point, mix_up, wrong, [*begin]) for track, point in zip(tracks, points, strict=True)]
        triples = [*zip(tracks, models, guesses, strict=True)]
        left = np.concatenate([(model.outputs - track.outputs)[track.used] for track, model, _ in triples])
        shared = np.concatenate([model.by_cause[track.used] for track, model, _ in triples])
        own = block_diag(*(model.by_point[track.used] @ across for track, model, (_, across) in triples))
        return left, np.hstack([shared, own])

    found = least_squares(
        lambda x: at(x.tobytes())[0],
        np.clip(start, -0.999 * largest, 0.999 * largest),
        lambda x: at(x.tobytes())[1],
        bounds=(-largest, largest),
        x_scale="jac",
        max_nfev=MOST_STEPS,
        ftol=1e-5,
        xtol=1e-8,
    )
    return Fit(tracks, mix_up, *parted(found.x))
