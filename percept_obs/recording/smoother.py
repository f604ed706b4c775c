"""Poses smoothed, with their rates: each coordinate is a random walk of its third derivative, the jerk."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.linalg import LinAlgError

from percept_obs.compile import Array

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

FEWEST = 5
"""Poses that are needed at least: they have two third differences, which tell the noise and the smoothness."""

SMOOTHNESS = np.logspace(-12, 6, 15)
"""Values of lambda = q h^5 / r that are tried first: smaller ones are lost in rounding, larger ones smooth nothing."""

ROUNDING = 1e-12
"""Least deviation of a pose's noise, over how far the poses spread: exact poses have the noise of their rounding."""

GAUSS = np.polynomial.legendre.leggauss(3)
"""Three places in [-1, 1] and weights: the integrals of splines and squares here are of the fourth power at most."""


@dataclass(frozen=True, eq=False)
class Smoothed:
    """Smoothed coordinates at K times, with their first and second derivatives, each of shape (K, a).

    `step` is the mean step h, `variance` that of a sample's noise, r, and `memory` the time in seconds over which
    samples are averaged: tau = (r h / q)^(1/6), with the jerk's density q.
    """

    value: Array
    rate: Array
    acceleration: Array
    step: float
    variance: float
    memory: float

    @property
    def error(self) -> float:
        """Variance of the smoothed values: r h / (3 tau), which is below that of a sample."""
        return self.variance * min(1.0, self.step / (3 * self.memory))

    @property
    def rate_error(self) -> float:
        """Variance of the rates, but for the ends, where it is up to 17 times as large: r h / (6 tau^3)."""
        return self.error / (2 * self.memory**2)


def smooth(time: Array, values: Array, floor: float = 0.0, memory: float | None = None) -> Smoothed:
    """Return the coordinates that are most probable, with one density of the jerk and one variance for all of them.

    The jerk is white with the density q, and samples have white noise with the variance r; the most probable curve is
    the natural quintic smoothing spline.  q and r are those with which the samples are most probable, where r is
    `floor` at least; a given `memory` sets their ratio.
    """
    from scipy.linalg import cho_solve_banded, cholesky_banded
    from scipy.optimize import minimize_scalar

    # in mean steps, so that lambda and the matrices have no unit and a usual size
    step = float(time[-1] - time[0]) / (len(time) - 1)
    t = (time - time[0]) / step
    differences, jerk, inside, weights = _third_differences(t)
    data = differences @ values
    free = data.size
    floor = max(floor, (ROUNDING * float(np.ptp(values, axis=0).max(initial=0.0))) ** 2, np.finfo(float).tiny)
    # both matrices are symmetric, with at most three diagonals below the main one
    squares = [np.asarray((differences @ differences.T).diagonal(-k)) for k in range(4)]
    overlaps = [np.asarray((jerk.T @ jerk.multiply(weights[:, None])).diagonal(-k)) for k in range(4)]
    band = [np.array([np.pad(row, (0, len(data) - len(row))) for row in rows]) for rows in (squares, overlaps)]

    def solved(smoothness: float) -> tuple[Array, float, float]:
        """Return A^-1 d, the variance r, and -2 log of the likelihood, for a value of lambda."""
        try:
            factor = cholesky_banded(band[0] + smoothness * band[1], lower=True)
        except LinAlgError:  # rounding makes the matrix indefinite, so that this value cannot be used
            return data, floor, np.inf
        weighted = cho_solve_banded((factor, True), data)
        total = float((data * weighted).sum())
        # for each lambda the likeliest variance is known in closed form, so that one number is searched for
        variance = max(total / free, floor)
        determinant = 2 * values.shape[1] * float(np.log(factor[0]).sum())
        return weighted, variance, total / variance + free * np.log(variance) + determinant

    if memory is None:
        # the likelihood may have several maxima: a coarse grid first, then a search around its best
        tried = np.log(SMOOTHNESS)
        best = tried[np.argmin([solved(each)[2] for each in SMOOTHNESS])]
        ends = (max(tried[0], best - (tried[1] - tried[0])), min(tried[-1], best + (tried[1] - tried[0])))
        best = minimize_scalar(lambda x: solved(np.exp(x))[2], bounds=ends, options={"xatol": 0.05}).x
        smoothness = float(np.exp(best))
    else:
        smoothness = (memory / step) ** -6
    weighted, variance, _ = solved(smoothness)
    value = values - differences.T @ weighted
    # the optimal jerk is the sum of the splines B_j, with the multipliers A^-1 d as weights
    third = smoothness * (jerk @ weighted).reshape(len(t) - 1, 3, -1)
    rate, acceleration = _rates(t, value, third, inside, weights.reshape(-1, 3))
    return Smoothed(value, rate / step, acceleration / step**2, step, variance, step * smoothness ** (-1 / 6))


def smooth_turns(time: Array, rotation: Rotation, floor: float = 0.0) -> tuple[Rotation, Smoothed]:
    """Return smoothed rotations, with the angular velocity and acceleration along the turned axes, (K, 3).

    Small turns between samples add up to angles, which are smoothed as coordinates are.  Angles about other axes at
    other times do not quite add (coning): a turn is the integral of w but for h^2/12 w_k x w_(k+1).  Noise of the
    rotations enters this correction, so that it is made with rotations that have been smoothed already.
    """
    from scipy.spatial.transform import Rotation

    smoothed, rate, memory = rotation, np.zeros((len(time), 3)), None
    for again in range(3):
        # the last pass keeps the second one's smoothing, and corrects the coning only
        turns = (smoothed[:-1].inv() * smoothed[1:]).as_rotvec()
        turns -= (np.diff(time) ** 2 / 12)[:, None] * np.cross(rate[:-1], rate[1:])
        angle = np.concatenate([np.zeros((1, 3)), np.cumsum(turns, axis=0)])
        found = smooth(time, angle + (smoothed.inv() * rotation).as_rotvec(), floor, memory if again == 2 else None)
        smoothed = smoothed * Rotation.from_rotvec(found.value - angle)
        rate, memory = found.rate, found.memory
    return smoothed, found


def _third_differences(t: Array) -> tuple:
    """Return the matrix of third divided differences times 6, and its splines: (D x)_j is the integral of B_j x'''.

    The quadratic splines B_j follow at the three points of Gauss in each interval, with the points' places between
    its ends, from 0 to 1, and their weights.
    """
    from scipy.interpolate import BSpline
    from scipy.sparse import diags_array

    n = len(t)
    near = np.lib.stride_tricks.sliding_window_view(t, 4)
    apart = near[:, :, None] - near[:, None, :] + np.eye(4)
    differences = diags_array(list((6 / apart.prod(axis=2)).T), offsets=[0, 1, 2, 3], shape=(n - 3, n)).tocsr()
    inside, steps = (1 + GAUSS[0]) / 2, np.diff(t)
    points = (t[:-1, None] + steps[:, None] * inside).ravel()
    knots = np.concatenate([[t[0]] * 2, t, [t[-1]] * 2])
    # natural splines: those that reach beyond the ends are left out
    basis = BSpline.design_matrix(points, knots, 2)[:, 2 : n - 1]
    jerk = basis @ diags_array(3 / (t[3:] - t[:-3]))
    return differences, jerk, inside, (steps[:, None] * GAUSS[1] / 2).ravel()


def _rates(t: Array, value: Array, third: Array, inside: Array, weights: Array) -> tuple[Array, Array]:
    """Return first and second derivatives at all times, from the values and the third derivative in between."""
    steps = np.diff(t)[:, None]
    # Taylor's remainder: what the third derivative adds to the next value and to the one before
    ahead = np.einsum("kg,kga->ka", weights * (1 - inside) ** 2 / 2, third) * steps**2
    behind = np.einsum("kg,kga->ka", weights * inside**2 / 2, third) * steps**2
    slope = np.diff(value, axis=0) / steps
    forwards, backwards = (slope - ahead / steps)[1:], (slope - behind / steps)[:-1]
    before, after = steps[:-1], steps[1:]
    rate, bend = np.empty_like(value), np.empty_like(value)
    rate[1:-1] = (forwards * before + backwards * after) / (before + after)
    bend[1:-1] = 2 * (forwards - backwards) / (before + after)
    jerk = [np.einsum("g,ga->a", weights[k] * part, third[k]) for k, part in ((0, inside), (-1, 1 - inside))]
    whole = [np.einsum("g,ga->a", weights[k], third[k]) for k in (0, -1)]
    # the ends have a neighbour on one side only: integrate the third derivative from there
    for end, near, sign in ((0, 1, -1), (-1, -2, 1)):
        step = steps[end]
        bend[end] = bend[near] + sign * whole[end]
        rate[end] = rate[near] + sign * bend[near] * step + step * jerk[end]
    return rate, bend
