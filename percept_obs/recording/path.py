"""Paths under a linear motion x' = A x + b: exact if it is constant, else by an adaptive solver."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from percept_obs.compile import Array
from percept_obs.compile.integrator import LARGEST_SQUARED_STATE
from percept_obs.validation import TooMuchWork, bar, limit

Rate = Callable[[float, Array], ArrayLike]

REACH = 0.5
"""Largest norm of a matrix whose exponential series is summed; exponentials of longer times are products."""
TERMS = 15
"""Terms of that series: the next one is below 1e-18 of the first."""

RELATIVE_ERROR, ABSOLUTE_ERROR = 1e-10, 1e-12
"""Tolerances of a step of the solver, for a motion that varies."""
LONGEST_SOLVER_STEP = 0.25
"""Longest step of the solver in seconds, however smooth the motion seems."""
MOST_EVALUATIONS = 400_000
"""Most evaluations of a motion that varies: about ten seconds of computing."""


def times_of(times: ArrayLike, states: int) -> Array:
    """Return times of a path as an array; refuse them unless finite, from 0 on, not decreasing and not too many."""
    array = np.atleast_1d(np.asarray(times, dtype=float))
    if array.ndim != 1 or not array.size or not np.isfinite(array).all() or (np.diff(array, prepend=0) < 0).any():
        raise ValueError("the times must be a list, not empty, of finite seconds from 0 on that do not decrease")
    limit(len(array) * (states + 4), "numbers along the path", "ask for fewer times")
    return array


def exponential(matrices: Array) -> Array:
    """Return exponentials of square matrices, shape (..., n, n), whose norm is at most `REACH`, by their series."""
    one = np.eye(matrices.shape[-1])
    found = one
    for k in range(TERMS, 0, -1):
        found = one + matrices @ found / k
    return found


def constant_path(A: Array, b: Array, start: Array, times: Array) -> Array:
    """Return states at the times under a constant motion, shape (K, n); NaN once they grow without bounds.

    The exponential of a short time is squared up to the last one; from the nearest state a series leads to each time.
    """
    from scipy.sparse import csr_array

    n, last = len(start), float(times[-1])
    whole = np.zeros((n + 1, n + 1))  # of (x, 1), so that b is a part of the matrix
    whole[:n, :n], whole[:n, n] = A, b
    size = float(np.abs(whole[:n, :n]).sum(axis=0).max())
    pieces = max(1, int(np.ceil(min(size * last / REACH, 1e18))))
    limit(
        pieces * (n + 1),
        f"numbers along a motion this fast, up to times of {last:.4g} s",
        "shorten the duration or slow the motion down",
    )
    length = last / pieces
    states = np.append(start, 1.0)[None]
    with np.errstate(over="ignore", invalid="ignore"):
        across = exponential(whole * length)
        # each pass doubles both the states known and the time that the exponential leads over
        while len(states) <= pieces:
            states = np.concatenate([states, states @ across.T])
            across = across @ across
        # from the nearest state before each time the series is short
        piece = np.minimum((times / length).astype(int) if last else 0 * times.astype(int), pieces)
        begin, share = states[piece].T, times - piece * length
        rate, path = csr_array(whole), begin
        for k in range(TERMS, 0, -1):
            path = begin + share / k * (rate @ path)
    return _bounded(np.ascontiguousarray(path[:n].T))


def varying_path(rate: Rate, start: Array, times: Array, breaks: ArrayLike = ()) -> Array:
    """Return states at the times under a motion that varies, shape (K, n), by scipy's DOP853 and its dense output.

    No step crosses the breaks, times at which the rate has a kink.
    """
    from scipy.integrate import DOP853

    last = float(times[-1])
    inner = np.asarray(breaks, dtype=float)
    ends = [*inner[(inner > 0) & (inner < last)].tolist(), last]
    path = np.full((len(times), len(start)), np.nan)
    begin, state, evaluations = 0.0, start, 0
    path[times == 0] = start
    with bar(None, "moving", last, unit="s") as progress, np.errstate(all="ignore"):
        for end in ends if last else ():
            longest = min(LONGEST_SOLVER_STEP, end - begin)
            solver = DOP853(rate, begin, state, end, longest, RELATIVE_ERROR, ABSOLUTE_ERROR, first_step=longest)
            while solver.status == "running":
                solver.step()
                made = evaluations + solver.nfev
                # stop early if the evaluations so far foretell more than five times the limit
                hopeless = made > MOST_EVALUATIONS / 20 and made * last > 5 * MOST_EVALUATIONS * solver.t
                if hopeless or made > MOST_EVALUATIONS or solver.status == "failed":
                    raise TooMuchWork(
                        f"up to {solver.t:.4g} s of {last:.4g} s the motion had to be evaluated {made} times; it "
                        "changes too fast: slow it down or shorten the duration"
                    )
                between = slice(*np.searchsorted(times, [solver.t_old, solver.t], side="right"))
                if between.start < between.stop:
                    path[between] = solver.dense_output()(times[between]).T
                progress.update(solver.t - solver.t_old)
                if not (solver.y**2).sum() < LARGEST_SQUARED_STATE:
                    return _bounded(path)
            begin, state, evaluations = end, solver.y, evaluations + solver.nfev
    return _bounded(path)


def _bounded(path: Array) -> Array:
    """Return a path with NaN once it has grown without bounds."""
    with np.errstate(over="ignore", invalid="ignore"):
        inside = (path**2).sum(axis=1) < LARGEST_SQUARED_STATE
    path[~np.logical_and.accumulate(inside)] = np.nan
    return path


def lowest_between(values: Array, rates: Array, times: Array) -> tuple[float, float]:
    """Return the lowest value between the times of a cubic through values and rates, and its time."""
    dips = np.flatnonzero((rates[:-1] < 0) & (rates[1:] > 0))
    if not len(dips):
        return float(np.inf), 0.0
    h, low, high = np.diff(times)[dips], values[dips], values[dips + 1]
    begin, end = h * rates[dips], h * rates[dips + 1]
    # The cubic is low + begin s + bend s^2 + turn s^3; its slope is negative at s = 0, positive at 1 and 0 once between
    turn, bend = begin + end - 2 * (high - low), 3 * (high - low) - 2 * begin - end
    root = np.sqrt(np.maximum(bend**2 - 3 * turn * begin, 0))
    with np.errstate(divide="ignore", invalid="ignore"):
        s = np.clip(np.where(bend < 0, (root - bend) / (3 * turn), -begin / (bend + root)), 0, 1)
    cubic = low + s * (begin + s * (bend + s * turn))
    least = int(np.argmin(cubic))
    return float(cubic[least]), float(times[dips[least]] + s[least] * h[least])
