"""Running the loop: in Python, or in numba where compiling pays."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from percept_obs.compile.arrays import Array, Flags
from percept_obs.compile.equations import Equations
from percept_obs.compile.functions import executed
from percept_obs.compile.loop import source
from percept_obs.compile.machine_code import is_kept, machine_code
from percept_obs.validation import needed

Language = Literal["python", "numba"]

WORTH_COMPILING = 200_000
"""Number of steps that takes Python about as long as numba takes to compile and run them."""

_ready: dict[Equations, bool] = {}
"""Equations whose loop was looked for as machine code, True where it was found or made."""


def choose(language: Language | None, steps: float, equations: Equations | None = None) -> Language:
    """Choose the language of a loop: numba, if it is installed and these equations are compiled already.

    Otherwise for so many steps that they pay for its compiling.  The states of `solve` are the same bits in both
    languages.  To compile for several runs, pass the steps of all together, or ask for numba.
    """
    if language not in (None, "python", "numba"):
        raise ValueError(f"the language {language!r} is neither 'python' nor 'numba'")
    if language == "numba":
        needed("fast", "numba")
    if language is None and steps < WORTH_COMPILING and (equations is None or not _is_compiled(equations)):
        return "python"
    return language or ("numba" if find_spec("numba") else "python")


@dataclass(frozen=True)
class Table:
    """Known signals at the instants of each of N steps: its start, its end, and the method's nodes between."""

    steps: Array  # (N,), lengths in seconds
    measured: Array  # (N, EACH + 1, m), or (N, 1, m) when held from each step's start to its end
    parameters: Array  # (N EACH + 1, p), or (1, p) when constant: known motion and surface
    samples: Array  # (N + 1, m), new at the first start and the steps' ends, NaN where none is; for updates


@dataclass(frozen=True)
class Trace:
    """Result of a run of the loop."""

    states: Array  # (N + 1, n), at the first start and the end of every step; NaN from `diverged` on
    resets: Flags  # (N + 1,), where the state was reset
    diverged: int | None  # first step's end at which the state was no longer finite


def solve(
    equations: Equations,
    start: ArrayLike,
    table: Table,
    gains: ArrayLike = (),
    language: Language | None = None,
) -> Trace:
    """Step the equations through the table from a start of shape (n,), in the language that `choose` returns."""
    size, count = len(equations.state), len(table.steps) + 1
    blocks = (start, table.steps, table.measured, table.parameters, table.samples, gains)
    inputs = [np.asarray(block, dtype=float).ravel() for block in blocks]
    varying = len(table.parameters) > 1
    if choose(language, len(table.steps), equations) == "python":
        states: Any = [math.nan] * (size * count)
        resets: Any = [0.0] * count
        try:
            diverged = _python(equations)(*(block.tolist() for block in inputs), varying, states, resets)
        # Python raises where numba returns inf or NaN: the first row that is not filled is where it diverged
        except (ArithmeticError, ValueError):
            diverged = next(k for k in range(count) if math.isnan(states[size * k]))
    else:
        states, resets = np.empty(size * count), np.zeros(count, dtype=bool)
        diverged = _compiled(equations)(*inputs, varying, states, resets)
        # np.empty holds what was in memory before
        states[size * diverged if diverged >= 0 else size * count :] = np.nan
    return Trace(
        np.asarray(states).reshape(count, size),
        np.asarray(resets, dtype=bool),
        None if diverged < 0 else int(diverged),
    )


@lru_cache(maxsize=512)
def _python(equations: Equations) -> Callable[..., int]:
    return executed(source(equations, "python"))


def _text(equations: Equations) -> str:
    return f"import math\n\n\n{source(equations, 'python')}"


def _is_compiled(equations: Equations) -> bool:
    """True if the loop was compiled in this process, or is on the disk and numba loaded, which takes half a second."""
    if "numba" not in sys.modules:
        return False
    if equations not in _ready:
        _ready[equations] = is_kept(_text(equations))
    return _ready[equations]


@lru_cache(maxsize=512)
def _compiled(equations: Equations) -> Callable[..., int]:
    from numba import types

    array = types.Array(types.float64, 1, "C", readonly=True)  # also takes arrays that may be written to
    signature = (*[array] * 6, types.boolean, types.float64[::1], types.boolean[::1])
    _ready[equations] = True
    return machine_code(_text(equations), signature)
