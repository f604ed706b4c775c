"""The loop over points: one text that numpy runs as it is and numba compiles once, for any number of points.

The correction of one point is printed from its block; the loop spreads it over the states.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from inspect import getsource
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from percept_obs.compile import Array, Indices, Language, executed, machine_code
from percept_obs.compile import choose as choose_for_steps
from percept_obs.compile.integrator import EACH, LARGEST_SQUARED_STATE, numbers
from percept_obs.points.block import PointBlock
from percept_obs.points.form import PointsForm

Law = tuple[bool, float, float, Array]
"""If P is computed, by P' = -A^T P - P A + information S - forgetting P + pull, and these three."""

COUPLING, WEIGHTS, PLACES = numbers()

STATE_WORK = 8
"""Cost of a step in Python for each state, in steps of the observer of one point."""


class Arrays(NamedTuple):
    """A form as arguments of the loop: its entries that are not 0."""

    rows: Indices  # of [A, v], as in `Layout`; column n is v
    columns: Indices
    which: Indices
    begins: Indices  # of each point's entries of C, shape (p + 1,)
    axes: Indices  # row in C_k of each entry of C
    states: Indices  # column in C_k of each entry of C
    entries: Array
    shape: Array  # numbers of the block's parameters
    block: PointBlock


def arrays(form: PointsForm, states: Indices, points: Indices) -> Arrays:
    """Return the loop's arguments for some states and points of a form; no other state may enter their rates."""
    n = form.states
    # place of each state among the chosen ones, -1 for the others; the last one is the column v
    place = np.full(n + 1, -1)
    place[states], place[n] = np.arange(len(states)), len(states)
    layout = form.layout
    within = place[layout.rows] >= 0
    rows, columns = place[layout.rows[within]], place[layout.columns[within]]
    blocks = form.blocks[points][:, :, states]
    # np.nonzero gives the entries point by point, so that each point's stand together from `begins` on
    owners, axes, used = map(np.ascontiguousarray, np.nonzero(blocks))
    begins = np.searchsorted(owners, np.arange(len(points) + 1))
    shape = np.array([form.surface.values[symbol] for symbol in form.block.parameters])
    entries = blocks[owners, axes, used]
    return Arrays(rows, columns, layout.which[within], begins, axes, used, entries, shape, form.block)


def combine_by_loops(target: Array, first: Array, factor: float, second: Array) -> None:
    """Set the target to first + factor second.  For numba, which compiles loops in half the time of numpy's lines."""
    for i in range(len(target)):
        target[i] = first[i] + factor * second[i]


def combine_by_numpy(target: Array, first: Array, factor: float, second: Array) -> None:
    """Set the target to first + factor second.  For Python, where loops are slow."""
    target[:] = first + factor * second


def solve_by_loops(P: Array, right: Array) -> Array:
    """Solve P x = right by Cholesky's method; NaN where P is not positive definite.

    For numba: LAPACK's takes twice as long to compile as all the rest.
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
    """Solve P x = right; NaN where P is not positive definite.  For Python, where loops are slow."""
    try:
        np.linalg.cholesky(P)
    except np.linalg.LinAlgError:
        return np.full_like(right, np.nan)
    return np.asarray(np.linalg.solve(P, right))


if TYPE_CHECKING:  # names in the text of the next functions, which `source` defines
    combine, solve = combine_by_numpy, solve_by_numpy

    def point(inputs: Array, values: Array) -> Array:
        """Fill an array with a point's correction and S, as in `PointBlock.source`."""


def move(target: Array, start: Array, length: float, shares: Array, rates: Array) -> None:
    """Set the target to start + length times the sum of the stages' rates, weighted by their shares."""
    for j in range(len(shares)):
        if shares[j] != 0.0:
            combine(target, start, length * shares[j], rates[j])
            start = target


def rate(form: Any, law: Law, x: Array, P: Array, coefficients: Array, y: Array, dx: Array, dP: Array) -> None:
    """Fill dx and dP with the rates of the estimate x and of P; if P is given, the argument P holds its inverse."""
    rows, columns, which, begins, axes, states, entries, shape = form
    computed, information, forgetting, pull = law
    n, m = len(x), y.shape[1]
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
                # A_ij takes a times row i of P off column j, for -P A, and off row j, for -A^T P
                combine(dP[:, j], dP[:, j], -a, P[i])
                combine(dP[j], dP[j], -a, P[i])
    correction, anything = np.zeros(n), False
    inputs, values = np.zeros(m + 3 + len(shape)), np.zeros(12)
    for j in range(len(shape)):
        inputs[m + 3 + j] = shape[j]
    for k in range(len(begins) - 1):
        seen = True
        for j in range(m):
            inputs[j] = y[k, j]
            # NaN, a point that is not seen, is not equal to itself
            seen = seen and y[k, j] == y[k, j]
        if not seen:
            continue
        anything = True
        # the estimated point C_k x, from the entries of C_k that are not 0
        inputs[m : m + 3] = 0.0
        for e in range(begins[k], begins[k + 1]):
            inputs[m + axes[e]] += entries[e] * x[states[e]]
        # values has the correction B^T (y l xi - N xi) and then S = B^T B, row by row
        point(inputs, values)
        for e in range(begins[k], begins[k + 1]):
            correction[states[e]] += entries[e] * values[axes[e]]
            for f in range(begins[k], begins[k + 1] if computed else 0):
                S = values[3 + 3 * axes[e] + axes[f]]
                dP[states[e], states[f]] += information * entries[e] * entries[f] * S
    if anything and computed:
        # a computed P changes at each stage, so that a system is solved; a given one comes inverted
        combine(dx, dx, 1.0, solve(P, correction))
    elif anything:
        for i in range(n):
            combine(dx, dx, correction[i], P[i])


def run(
    form: Any,
    law: Law,
    x: Array,
    P: Array,
    steps: Array,
    coefficients: Array,
    inverses: Array,
    outputs: Array,
    path: Array,
) -> tuple[int, Array]:
    """Step the estimate, and P where it is computed, by the Runge-Kutta method, with the blocks of `advance`.

    The estimates go to `path`.  Returns its first row at which they were no longer finite, or -1, and the last P.
    """
    n = len(x)
    size = n if law[0] else 0
    # estimate and computed P in one vector, so that a step moves both at once
    now, stage = np.zeros(n + size * size), np.zeros(n + size * size)
    rates = np.zeros((len(WEIGHTS), len(now)))  # no list, which numba takes long to compile
    x_stage, P_stage = stage[:n], stage[n:].reshape(size, size)
    combine(now[:n], x, 0.0, x)
    for i in range(size):
        combine(now[n + i * size : n + (i + 1) * size], P[i], 0.0, P[i])
    combine(path[0], x, 0.0, x)
    for k in range(len(steps)):
        # the first stage has no rates before it, and `move` leaves it as it is
        combine(stage, now, 0.0, now)
        for i in range(len(WEIGHTS)):
            row = EACH * k + PLACES[i]
            known = coefficients[row if len(coefficients) > 1 else 0]
            move(stage, now, steps[k], COUPLING[i], rates)
            if not size:
                P_stage = inverses[row if len(inverses) > 1 else 0]
            dx, dP = rates[i, :n], rates[i, n:].reshape(size, size)
            rate(form, law, x_stage, P_stage, known, outputs[k, PLACES[i]], dx, dP)
        move(now, now, steps[k], WEIGHTS, rates)
        combine(path[k + 1], now[:n], 0.0, now[:n])
        squared = 0.0
        for i in range(n):
            squared += now[i] * now[i]
        # not <, so that NaN counts as diverged too
        if not squared < LARGEST_SQUARED_STATE:
            return k + 1, now[n:].reshape(size, size) if size else P
    return -1, now[n:].reshape(size, size) if size else P


def source(block: PointBlock, language: Language) -> str:
    """Text of the loop for points on one kind of surface, with all that it depends on, as `machine_code` needs it."""
    helpers = (combine_by_numpy, solve_by_numpy) if language == "python" else (combine_by_loops, solve_by_loops)
    return "\n".join(
        [
            "import math\n\nimport numpy as np\n",
            f"EACH, LARGEST_SQUARED_STATE = {EACH}, {LARGEST_SQUARED_STATE!r}",
            f"COUPLING, WEIGHTS, PLACES = map(np.array, {[table.tolist() for table in numbers()]})",
            block.source("python"),
            *(getsource(helper) for helper in helpers),
            f"point, combine, solve = evaluate, {', '.join(helper.__name__ for helper in helpers)}",
            *(getsource(function) for function in (move, rate, run)),
        ]
    )


@cache
def _loop(block: PointBlock, language: Language) -> Callable[..., tuple[int, Array]]:
    """The loop in Python or in machine code."""
    if language == "python":
        return executed(source(block, language))
    line, sheet, book, shelf = (f"float64[{':, ' * further}::1]" for further in range(4))
    form = f"Tuple(({'intp[::1], ' * 6}{line}, {line}))"
    law = f"Tuple((boolean, float64, float64, {sheet}))"
    signature = f"({form}, {law}, {line}, {sheet}, {line}, {sheet}, {book}, {shelf}, {sheet})"
    return machine_code(source(block, language), signature)


def choose(language: Language | None, work: float) -> Language:
    """The language to run in, for a number of steps times states; see `percept_obs.compile.choose`."""
    return choose_for_steps(language, STATE_WORK * work)


def advance(
    form: Arrays,
    law: Law,
    start: Array,
    P: Array,
    steps: Array,
    coefficients: Array,
    inverses: Array,
    outputs: Array,
    language: Language,
) -> tuple[Array, Array, int | None]:
    """Run the loop over N steps; return the path, P at the end, and the first row of the path that is not finite.

    With P computed it starts at the given one; else its inverses are given.  Coefficients, shape (N EACH + 1, u) or
    (1, u), and inverses, shape (N EACH + 1, n, n) or (1, n, n), belong to the instants of all steps.  The outputs,
    shape (N, EACH + 1, p, m), are NaN where a point is not seen.  The path, shape (N + 1, n), is NaN from where the
    estimate was no longer finite on.
    """
    path = np.full((len(steps) + 1, len(start)), np.nan)
    tables = (start, P, steps, coefficients, inverses, outputs)
    loop = _loop(form.block, language)
    with np.errstate(all="ignore"):
        diverged, P = loop(form[:-1], law, *(np.array(table, dtype=float, order="C") for table in tables), path)
    if diverged >= 0:
        path[diverged:] = np.nan
    return path, P, None if diverged < 0 else int(diverged)
