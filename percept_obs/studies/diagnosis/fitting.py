"""Joint least squares of points and wrong numbers on the tracks of a camera, and how sure the numbers are."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from percept_obs.compile import Array, Indices
from percept_obs.studies.diagnosis.causes import CAUSES
from percept_obs.studies.diagnosis.tracks import Track, across_of, guess, seen

FINEST = 1e-4
"""Standard deviation of the samples of the best camera, in focal lengths: a twentieth of a pixel."""

BLOCKS = 10
"""Parts of the recordings over time in which errors may be correlated."""

MOST_STEPS = 30
"""Evaluations of a fit at most."""

ROUNDING = 1e-6
"""Share of a column's norm below which what is left of it is rounding."""


@dataclass(frozen=True, eq=False)
class Fit:
    """Points, one for each track, and wrong numbers by cause that explain the samples best.

    Residuals have the shape (K, m) for each track, NaN where a value is not used; `rows` are their derivatives by the
    causes asked for, less what the points explain, and `times` those of the rows.
    """

    tracks: Sequence[Track]
    mix_up: str
    wrong: Mapping[str, Array]
    points: Sequence[Array]
    residuals: Sequence[Array] = field(repr=False)

    @cached_property
    def values(self) -> Array:
        """All residuals that are used."""
        return np.concatenate([each[np.isfinite(each)] for each in self.residuals])

    @property
    def squares(self) -> float:
        """Sum of their squares."""
        return float((self.values**2).sum())

    @property
    def rms(self) -> float:
        """Root mean square, with the unknowns counted."""
        return rms(self.values, 3 * len(self.points) + sum(map(len, self.wrong.values())))

    @cached_property
    def each(self) -> Array:
        """Root mean square of each track's residuals."""
        return np.array([rms(left[np.isfinite(left)], 3) for left in self.residuals])

    @property
    def typical(self) -> float:
        """Median of the tracks' root mean squares, of a few tracks the one of all values."""
        return float(np.median(self.each)) if len(self.each) > 2 else self.rms

    @cached_property
    def correlation(self) -> float:
        """Correlation of neighbours in time; 0 for white noise."""
        products = [float(np.nansum(left[1:] * left[:-1])) for left in self.residuals]
        return sum(products) / max(self.squares, np.finfo(float).tiny)

    @property
    def effective_count(self) -> float:
        """Effective sample size: the count, less for residuals that are correlated with their neighbours in time."""
        r = min(max(self.correlation, 0.0), 0.99)
        return len(self.values) * (1 - r) / (1 + r)

    def gain(self, other: Fit) -> float:
        """Logarithm by which the samples are more likely than with another fit, less the price of the unknowns."""
        finest, count = FINEST**2 * len(self.values), self.effective_count
        more = sum(map(len, self.wrong.values())) - sum(map(len, other.wrong.values()))
        ratio = (other.squares + finest) / (self.squares + finest)
        return count / 2 * math.log(ratio) - more / 2 * math.log(max(count, 2.0))

    def estimates(self, keys: Sequence[str]) -> dict[str, Estimate]:
        """Numbers of causes with their deviations, each with all others of them, and all points, unknown as well."""
        rows: list[Array] = []
        parts: list[Array] = []
        for track, point, left in zip(self.tracks, self.points, self.residuals, strict=True):
            model = seen(track, point, self.mix_up, self.wrong, keys)
            wanted = np.concatenate([model.by_cause[key] for key in keys], axis=2)[track.used]
            rows.append(_less(wanted, model.by_point[track.used] @ across_of(point, 4)))
            parts.append(np.broadcast_to(track.time[:, None], left.shape)[track.used])
        stacked, times = np.concatenate(rows), np.concatenate(parts)
        block = np.searchsorted(np.quantile(times, np.arange(1, BLOCKS) / BLOCKS), times)
        ends = np.cumsum([0, *(CAUSES[key].size for key in keys)])
        spread = max(self.rms, FINEST)
        found = {}
        for key, begin, end in zip(keys, ends[:-1], ends[1:], strict=True):
            own, others = stacked[:, begin:end], np.delete(stacked, np.s_[begin:end], axis=1)
            value = self.wrong.get(key, np.zeros(end - begin))
            found[key] = _estimate(value, _less(own, others), self.values, block, spread)
        return found


@dataclass(frozen=True, eq=False)
class Estimate:
    """Number of a cause, with its largest standard deviation if errors are white.

    `sure` is by how many standard deviations it differs from 0, the lesser of that for white errors and of that for
    errors that are correlated within tenths of the recordings and among tracks.
    """

    value: Array
    deviation: float
    sure: float


def _less(columns: Array, others: Array) -> Array:
    """Columns less what others explain of them; 0 where that is all but rounding."""
    if not others.shape[1]:
        return columns
    size = np.linalg.norm(others, axis=0)
    basis = others[:, size > 0] / size[size > 0]
    left = columns - basis @ np.linalg.lstsq(basis, columns, rcond=ROUNDING)[0]
    alone = np.linalg.norm(left, axis=0) > ROUNDING * np.linalg.norm(columns, axis=0)
    return np.asarray(left * alone)


def _estimate(value: Array, columns: Array, left: Array, block: Indices, spread: float) -> Estimate:
    """Estimate of a number, from its own columns and the residuals; clusters are blocks of time (Liang and Zeger)."""
    information = columns.T @ columns
    least = float(np.linalg.eigvalsh(information)[0])
    if least <= np.finfo(float).eps * float(np.trace(information)) or not least > 0:
        return Estimate(value, math.inf, 0.0)
    scores = np.array([(columns * left[:, None])[block == k].sum(axis=0) for k in range(BLOCKS)])
    steps = np.linalg.solve(information, scores.T).T
    value = value - steps.sum(axis=0)  # to the least squares of a number that was not fitted
    apart = steps - steps.mean(axis=0)
    clustered = apart.T @ apart * BLOCKS / (BLOCKS - 1)
    white = np.linalg.inv(information) * spread**2
    both = [float(value @ np.linalg.lstsq(matrix, value, rcond=None)[0]) for matrix in (white, clustered + white)]
    return Estimate(value, spread / math.sqrt(least), math.sqrt(max(0.0, min(both)) / len(value)))


def rms(values: Array, unknowns: int = 0) -> float:
    """Root mean square of residuals; unknowns are taken from their number."""
    return math.sqrt(float((values**2).sum()) / max(len(values) - unknowns, 1)) if len(values) else 0.0


def fit(tracks: Sequence[Track], mix_up: str, keys: Sequence[str], start: Mapping[str, Array] | None = None) -> Fit:
    """Return the points and the numbers of some causes that explain the samples best.

    Points are in front of the camera or infinitely far away, and numbers within their causes' ranges.
    """
    begin = {key: np.zeros(CAUSES[key].size) for key in keys} | {k: v for k, v in (start or {}).items() if k in keys}
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
    from scipy.optimize import least_squares

    order = [*begin]
    ends = np.cumsum([0, *(CAUSES[key].size for key in order), *(across.shape[1] for _, across in guesses)])
    first = len(order)

    def parted(x: Array) -> tuple[dict[str, Array], list[Array]]:
        pieces = np.split(x, ends[1:-1])
        moved = zip(guesses, pieces[first:], strict=True)
        return dict(zip(order, pieces[:first], strict=True)), [point + across @ x for (point, across), x in moved]

    def at(x: Array) -> tuple[Array, Array]:
        wrong, places = parted(x)
        left, slopes = [], []
        for k, (track, point) in enumerate(zip(tracks, places, strict=True)):
            model = seen(track, point, mix_up, wrong, order)
            left.append((model.outputs - track.outputs)[track.used])
            rows = np.zeros((track.count, ends[-1]))
            for j, key in enumerate(order):
                rows[:, ends[j] : ends[j + 1]] = model.by_cause[key][track.used]
            rows[:, ends[first + k] : ends[first + k + 1]] = model.by_point[track.used] @ guesses[k][1]
            slopes.append(rows)
        return np.concatenate(left), np.concatenate(slopes)

    cache: dict[bytes, tuple[Array, Array]] = {}

    def evaluated(x: Array) -> tuple[Array, Array]:
        if x.tobytes() not in cache:
            cache.clear()
            cache[x.tobytes()] = at(x)
        return cache[x.tobytes()]

    low, high = np.full(ends[-1], -np.inf), np.full(ends[-1], np.inf)
    for j, key in enumerate(order):
        low[ends[j] : ends[j + 1]], high[ends[j] : ends[j + 1]] = -CAUSES[key].largest, CAUSES[key].largest
    begun = np.zeros(ends[-1])
    begun[: ends[first]] = np.concatenate([*begin.values(), []])
    found = least_squares(
        lambda x: evaluated(x)[0],
        np.clip(begun, 0.999 * low, 0.999 * high),
        lambda x: evaluated(x)[1],
        bounds=(low, high),
        x_scale="jac",
        max_nfev=MOST_STEPS,
        ftol=1e-5,
        xtol=1e-8,
    )
    wrong, places = parted(found.x)
    left = evaluated(found.x)[0]
    residuals = []
    for track, values in zip(tracks, np.split(left, np.cumsum([t.count for t in tracks])[:-1]), strict=True):
        each = np.full(track.outputs.shape, np.nan)
        each[track.used] = values
        residuals.append(each)
    return Fit(tracks, mix_up, wrong, places, residuals)
