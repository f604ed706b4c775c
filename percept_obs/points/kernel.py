"""The loop over points: one text that numpy runs as it is and numba compiles once, for any number of points."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache, partial
from importlib.util import find_spec
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from percept_obs.points.form import PointsForm

Array = NDArray[np.float64]
Language = Literal["python", "numba"]

LARGEST_SQUARED_STATE = 1e300
"""A state whose squared norm exceeds this, or is not a number, has diverged."""

SMALL_WORK = 1e5
"""Steps times states up to which Python is done before numba has compiled."""


class Arrays(NamedTuple):
    """A form as the loop takes it, in the order of its arguments: entries that are not 0, point by point for C.

    Parameters
    ----------
    rows, columns, which : integer arrays
        As in `Layout`; column n is v.
    begins : integer array of shape (p + 1,)
        Where each point's entries of C begin.
    axes, states : integer arrays
        Row in C_k and state of each entry of C.
    entries : array
        Entries of C.
    N, l : arrays of shape (m, 3) and (3,)
        One point's block.
    """

    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    which: NDArray[np.intp]
    begins: NDArray[np.intp]
    axes: NDArray[np.intp]
    states: NDArray[np.intp]
    entries: Array
    N: Array
    l: Array


def arrays(form: PointsForm, states: NDArray[np.intp], points: NDArray[np.intp]) -> Arrays:
    """Some states and points of a form as the loop takes them; the states' rates must not need others."""
    n = form.states
    place = np.full(n + 1, -1)
    place[states], place[n] = np.arange(len(states)), len(states)
    layout = form.layout
    within = place[layout.rows] >= 0
    rows, columns = place[layout.rows[within]], place[layout.columns[within]]
    blocks = form.blocks[points][:, :, states]
    owners, axes, used = np.nonzero(blocks)
    begins = np.searchsorted(owners, np.arange(len(points) + 1))
    N, l = form.surface_numbers
    return Arrays(rows, columns, layout.which[within], begins, axes, used, blocks[owners, axes, used], N, l)


def combine(target, first, factor, second):  # type: ignore[no-untyped-def]
    """Set the target to first + factor second; numba takes long to compile such a line, and each of them anew."""
    for i in range(len(target)):
        target[i] = first[i] + factor * second[i]


def combine_by_numpy(target: Array, first: Array, factor: float, second: Array) -> None:
    """The same with numpy, whose loops do not run in Python."""
    target[:] = first + factor * second


def rate(combine, solve, form, law, x, P, coefficients, y, dx, dP):  # type: ignore[no-untyped-def]
    """Fill the rates of the estimate x and of P; where P is not computed, its inverse stands for it."""
    rows, columns, which, begins, axes, states, entries, N, l = form
    computed, information, forgetting, pull = law
    n, m = len(x), len(N)
    dx[:] = 0.0
    for i in range(n if computed else 0):
        combine(dP[i], pull[i], -forgetting, P[i])
    for e in range(len(rows)):
        i, j, a = rows[e], columns[e], coefficients[which[e]]
        if j == n:
            dx[i] += a
        else:
            dx[i] += a * x[j]
            if computed:
                combine(dP[:, j], dP[:, j], -a, P[i])
                combine(dP[j], dP[j], -a, P[i])
    correction = np.zeros(n)
    xi, c, S = np.zeros(3), np.zeros(3), np.zeros((3, 3))
    anything = False
    for k in range(len(begins) - 1):
        seen = True
        for j in range(m):
            seen = seen and y[k, j] == y[k, j]
        if not seen:
            continue
        anything = True
        first, last = begins[k], begins[k + 1]
        for i in range(3):
            xi[i] = c[i] = 0.0
            for h in range(3):
                S[i, h] = 0.0
        for e in range(first, last):
            xi[axes[e]] += entries[e] * x[states[e]]
        distance = l[0] * xi[0] + l[1] * xi[1] + l[2] * xi[2]
        for j in range(m):
            innovation = y[k, j] * distance - N[j, 0] * xi[0] - N[j, 1] * xi[1] - N[j, 2] * xi[2]
            for i in range(3):
                b = N[j, i] - y[k, j] * l[i]
                c[i] += b * innovation
                for h in range(3 if computed else 0):
                    S[i, h] += b * (N[j, h] - y[k, j] * l[h])
        for e in range(first, last):
            correction[states[e]] += entries[e] * c[axes[e]]
            if computed:
                for f in range(first, last):
                    dP[states[e], states[f]] += information * entries[e] * entries[f] * S[axes[e], axes[f]]
    if anything and computed:
        combine(dx, dx, 1.0, solve(P, correction))
    elif anything:
        for i in range(n):
            combine(dx, dx, correction[i], P[i])


def run(rate, combine, solve, form, law, x, P, steps, coefficients, inverses, outputs, path):  # type: ignore[no-untyped-def]
    """Step the estimate, and P where it is computed, by the classical Runge-Kutta method.

    The blocks `coefficients` and `inverses` have a row for each start, middle and end of a step, or one row if
    constant; `outputs` has three rows a step.  The estimates go to `path`.  Returns the first row of `path` at which
    the estimate was no longer finite, or -1, and the last P.
    """
    computed, n = law[0], len(x)
    x_stage, dx = x.copy(), np.zeros(n)
    P_stage, dP = P.copy(), np.zeros(P.shape)
    path[0] = x
    for k in range(len(steps)):
        x_sum, P_sum = x.copy(), P.copy()
        for stage in range(4):
            place = (stage + 1) // 2
            row, share = 2 * k + place, 0.5 * steps[k] * place
            if computed:
                for i in range(n):
                    combine(P_stage[i], P[i], share, dP[i])
            else:
                P_stage = inverses[row if len(inverses) > 1 else 0]
            combine(x_stage, x, share, dx)
            known = coefficients[row if len(coefficients) > 1 else 0]
            rate(combine, solve, form, law, x_stage, P_stage, known, outputs[k, place], dx, dP)
            weight = steps[k] / (6.0 if stage % 3 == 0 else 3.0)
            combine(x_sum, x_sum, weight, dx)
            for i in range(n if computed else 0):
                combine(P_sum[i], P_sum[i], weight, dP[i])
        x, P = x_sum, P_sum
        path[k + 1] = x
        squared = 0.0
        for i in range(n):
            squared += x[i] * x[i]
        if not squared <= LARGEST_SQUARED_STATE:
            return k + 1, P
    return -1, P


def solve_by_loops(P, right):  # type: ignore[no-untyped-def]
    """Solve P x = right by Cholesky's method; NaN where P is not positive definite.

    LAPACK's takes numba twice as long to compile as all the rest.
    """
    n = len(right)
    L, x = np.zeros((n, n)), right.copy()
    for j in range(n):
        for i in range(j, n):
            total = P[i, j]
            for k in range(j):
                total -= L[i, k] * L[j, k]
            if i == j:
                L[j, j] = math.sqrt(total) if total > 0.0 else math.nan
            else:
                L[i, j] = total / L[j, j]
    for i in range(n):
        for k in range(i):
            x[i] -= L[i, k] * x[k]
        x[i] /= L[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] -= L[k, i] * x[k]
        x[i] /= L[i, i]
    return x


def solve_by_numpy(P: Array, right: Array) -> Array:
    """The same with numpy, whose loops do not run in Python."""
    try:
        np.linalg.cholesky(P)
    except np.linalg.LinAlgError:
        return np.full_like(right, np.nan)
    return np.asarray(np.linalg.solve(P, right))


@cache
def compiled() -> Callable[..., tuple[int, Array]]:
    """The loop in machine code."""
    import numba

    *parts, loop = (numba.njit(error_model="numpy")(text) for text in (rate, combine, solve_by_loops, run))
    line, sheet, book = numba.float64[::1], numba.float64[:, ::1], numba.float64[:, :, ::1]
    shelf = numba.float64[:, :, :, ::1]
    form = numba.types.Tuple((numba.intp[::1],) * 6 + (line, sheet, line))
    law = numba.types.Tuple((numba.boolean, numba.float64, numba.float64, sheet))
    loop.compile((*map(numba.typeof, parts), form, law, line, sheet, line, sheet, book, shelf, sheet))
    return partial(loop, *parts)


def choose(language: Language | None, work: float) -> Language:
    """The language to run in: numba if it is installed, unless the work is small and it has not compiled yet.

    Parameters
    ----------
    language : "python" or "numba", optional
        What is asked for.
    work : float
        Steps times states.

    Raises
    ------
    ValueError
        If the language is another one.
    """
    if language not in (None, "python", "numba"):
        raise ValueError(f"the language {language!r} is neither 'python' nor 'numba'")
    if language is not None:
        return language
    if not find_spec("numba"):
        return "python"
    return "numba" if work > SMALL_WORK or compiled.cache_info().currsize else "python"


def advance(
    form: Arrays,
    law: tuple[bool, float, float, Array],
    start: Array,
    P: Array,
    steps: Array,
    coefficients: Array,
    inverses: Array,
    outputs: Array,
    language: Language,
) -> tuple[Array, Array, int | None]:
    """Run the loop.

    Parameters
    ----------
    form : Arrays
    law : (computed, information, forgetting, pull)
        Whether P is computed, and then P' = -A^T P - P A + information S - forgetting P + pull.
    start : array of shape (n,)
    P : array of shape (n, n)
        At the start, where it is computed.
    steps : array of shape (N,)
        In seconds.
    coefficients : array of shape (2 N + 1, u) or (1, u)
        Numbers of the form's expressions at the starts, middles and ends.
    inverses : array of shape (2 N + 1, n, n) or (1, n, n)
        Inverse of P at the same times, where P is given.
    outputs : array of shape (N, 3, p, m)
        Images as they are held at the start, middle and end of each step; NaN where a point is not seen.
    language : "python" or "numba"

    Returns
    -------
    path : array of shape (N + 1, n)
        NaN from where the estimate was no longer finite on.
    P : array of shape (n, n)
        At the end.
    diverged : int or None
        The first row of the path that is not finite.

    Raises
    ------
    ModuleNotFoundError
        If numba is asked for and is not installed.
    """
    path = np.full((len(steps) + 1, len(start)), np.nan)
    blocks = (start, P, steps, coefficients, inverses, outputs)
    loop = compiled() if language == "numba" else _in_python
    diverged, P = loop(tuple(form), law, *(np.array(block, dtype=float, order="C") for block in blocks), path)
    if diverged >= 0:
        path[diverged:] = np.nan
    return path, P, None if diverged < 0 else int(diverged)


def _in_python(*arguments: Any) -> tuple[int, Array]:
    with np.errstate(all="ignore"):
        return run(rate, combine_by_numpy, solve_by_numpy, *arguments)
