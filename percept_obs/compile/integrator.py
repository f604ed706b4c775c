"""The integrator: one Runge-Kutta method and its constants, for the loops here and in the page."""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from percept_obs.compile.arrays import Array, Indices
from percept_obs.validation import limit

Shares = tuple[Fraction, ...]


def _row(entries: str) -> Shares:
    return tuple(map(Fraction, entries.split()))


COUPLING = (_row(""), _row("1/2"), _row("0 1/2"), _row("0 0 1"))
WEIGHTS = _row("1/6 1/3 1/3 1/6")
"""The classical method as Butcher's tableau: k_i = f(x + h sum_j a_ij k_j), and a step adds h sum_i b_i k_i.

To exchange the method, exchange these two, print what the page needs (``percept_obs.labs.printing``) and build it.
"""

NODES: Shares = tuple(sum(row, Fraction(0)) for row in COUPLING)
INSTANTS: Shares = tuple(sorted({Fraction(0), *NODES, Fraction(1)}))
"""The shares of a step at which known signals are laid out: its start, the stages' nodes between, its end."""

PLACES = tuple(map(INSTANTS.index, NODES))
"""Index of the instant of each stage."""

EACH = len(INSTANTS) - 1
"""Rows of a table of known signals for each step: its instants but the last, which is the next step's first."""

LONGEST_STEP = 0.01
"""Longest step in seconds with which an observer is integrated, unless another one is asked for."""

PLANT_STEP = 0.0025
"""Longest step, in seconds, with which the page integrates a motion that varies; a constant one it sums exactly."""

STEP_ROUNDING = 1e-4
"""Share of the longest step by which one may be longer: a clock that counts from 1970 knows times to 2e-7 s."""

LARGEST_STEP_RATE = 2.0
"""Largest product of a step and a decay rate: explicit Euler's limit of stability; Runge-Kutta's is 2.78."""

LARGEST_SQUARED_STATE = 1e300
"""A state whose squared norm reaches this, or is not a number, has diverged."""


def step_grid(times: Array, longest: float) -> tuple[Array, Indices]:
    """Divide the intervals between times into equal steps no longer than given: the steps' ends, and each time's index.

    >>> grid, index = step_grid(np.array([0.0, 1.0]), longest=0.4)
    >>> grid.round(2).tolist(), index.tolist()
    ([0.0, 0.33, 0.67, 1.0], [0, 3])
    """
    intervals = np.diff(times)
    limit(float((intervals / longest).sum()), "steps", "take longer steps or a shorter time")
    # times may repeat: such an interval of no length gets no step
    counts = np.where(intervals > 0, np.maximum(1, np.ceil(intervals / longest - STEP_ROUNDING)), 0).astype(int)
    index = np.concatenate([[0], np.cumsum(counts)])
    owner = np.repeat(np.arange(len(counts)), counts)
    # number of each step within its interval, from 1
    inside = np.arange(index[-1]) - index[owner] + 1
    grid = np.concatenate([times[:1], times[owner] + intervals[owner] * (inside / counts[owner])])
    # the given times themselves, not what rounding makes of them
    grid[index] = times
    return grid, index


def instants(grid: Array) -> Array:
    """Times of known signals, shape (N EACH + 1,), for a grid of steps of shape (N + 1,)."""
    times = np.empty(EACH * (len(grid) - 1) + 1)
    times[-1:] = grid[-1:]
    for k, share in enumerate(map(float, INSTANTS[:-1])):
        times[k:-1:EACH] = (1 - share) * grid[:-1] + share * grid[1:]
    return times


def by_step(rows: Array) -> Array:
    """Group values at the instants, shape (N EACH + 1, ...), by their steps, shape (N, EACH + 1, ...)."""
    last = len(rows) - 1
    return np.stack([rows[k : last + k : EACH] for k in range(EACH + 1)], axis=1)


def step(state: Array, lengths: Array, rate: Callable[[int, Array], Array]) -> Array:
    """States after a step of the given lengths; rate(instant, states) is their rate at one of its instants."""
    rates: list[Array] = []

    def moved(shares: Shares) -> Array:
        return state + lengths * sum(float(share) * rate for share, rate in zip(shares, rates, strict=True))

    for place, shares in zip(PLACES, COUPLING, strict=True):
        rates.append(rate(place, moved(shares)))
    return moved(WEIGHTS)


def step_along(state: Array, times: ArrayLike, lengths: ArrayLike, rate: Callable[[Array, Array], Array]) -> Array:
    """States after steps from times on; rate(times, states) is their rate."""
    begun, h = np.asarray(times), np.asarray(lengths)
    each = h.reshape(h.shape + (1,) * (state.ndim - h.ndim))
    return step(state, each, lambda instant, moved: rate(begun + float(INSTANTS[instant]) * h, moved))


def numbers() -> tuple[Array, Array, Indices]:
    """Coefficients a_ij, shape (stages, stages), b_i and the index of each stage's instant, as arrays."""
    square = [[*row, *[0] * (len(WEIGHTS) - len(row))] for row in COUPLING]
    return np.array(square, dtype=float), np.array(WEIGHTS, dtype=float), np.array(PLACES)


def for_the_page() -> str:
    """Text of the page's module ``engine/integrator.js``: the method and its constants."""
    square, weights, _ = numbers()
    constants: dict[str, Any] = {
        "COUPLING": square.tolist(),
        "WEIGHTS": weights.tolist(),
        "INSTANTS": list(map(float, INSTANTS)),
    }
    for name in ("PLACES", "LONGEST_STEP", "PLANT_STEP", "STEP_ROUNDING", "LARGEST_SQUARED_STATE"):
        constants[name] = globals()[name]
    lines = [f"export const {name} = {json.dumps(value)};" for name, value in constants.items()]
    return "\n".join(["// Printed by percept_obs/compile/integrator.py, which says what they mean.", *lines, ""])
