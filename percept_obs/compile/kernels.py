"""Running the loop, in Python at once and in numba where compiling pays."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib.util import find_spec
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from percept_obs.compile.equations import Equations
from percept_obs.compile.loop import source

Array = NDArray[np.float64]

WORTH_COMPILING = 200_000
"""Steps that take Python about as long as numba takes to compile them and run them."""


@dataclass(frozen=True)
class Table:
    """What is known at the start, the middle and the end of every step.

    Parameters
    ----------
    steps : array of shape (N,)
        Lengths of the steps in seconds.
    measured : array of shape (N, 3, m)
        Measured outputs as they are held at the start, the middle and the end of each step.
    parameters : array of shape (2 N + 1, p), or (1, p) when constant
        Known motion and surface at the starts, middles and ends.
    samples : array of shape (N + 1, m)
        New samples at the steps' ends (and the first start); NaN where there is none.
    """

    steps: Array
    measured: Array
    parameters: Array
    samples: Array


@dataclass(frozen=True)
class Trace:
    """What a run of the loop leaves.

    Parameters
    ----------
    states : array of shape (N + 1, n)
        States at the first start and at the end of every step; NaN from `diverged` on.
    resets : array of shape (N + 1,) of bool
        Where the state was reset.
    diverged : int or None
        The first step's end at which the state was no longer finite.
    """

    states: Array
    resets: NDArray[np.bool_]
    diverged: int | None


def solve(
    equations: Equations,
    start: ArrayLike,
    table: Table,
    gains: ArrayLike = (),
    language: Literal["python", "numba"] | None = None,
) -> Trace:
    """Step the equations through the table.

    Parameters
    ----------
    equations : Equations
    start : array of shape (n,)
    table : Table
    gains : array of shape (number of gains,)
    language : "python" or "numba", optional
        Left out, Python until these equations have been asked for so many steps that compiling them would have paid,
        and from then on numba, if it is installed.

    Returns
    -------
    Trace

    Raises
    ------
    ModuleNotFoundError
        If numba is asked for and is not installed.
    """
    kernel = _kernel(equations)
    size, count = len(equations.state), len(table.steps) + 1
    inputs = [
        np.array(block, dtype=float).ravel()
        for block in (start, table.steps, table.measured, table.parameters, table.samples, gains)
    ]
    varying = len(table.parameters) > 1
    run = kernel.choose(language, len(table.steps))
    if run is kernel.python:
        states: Any = [math.nan] * (size * count)
        resets: Any = [0.0] * count
        try:
            diverged = run(*(block.tolist() for block in inputs), varying, states, resets)
        except (ArithmeticError, ValueError):
            diverged = next(k for k in range(count) if math.isnan(states[size * k]))
    else:
        states, resets = np.full(size * count, np.nan), np.zeros(count)
        diverged = run(*inputs, varying, states, resets)
    return Trace(
        np.array(states).reshape(count, size),
        np.array(resets) != 0,
        None if diverged < 0 else int(diverged),
    )


class _Kernel:
    """The same text for Python and, when it is there, numba."""

    def __init__(self, equations: Equations) -> None:
        self.text = source(equations, "python")
        namespace: dict[str, Any] = {"math": math}
        exec(compile(self.text, "<run>", "exec"), namespace)
        self.python: Callable[..., int] = namespace["run"]
        self.asked = 0

    def choose(self, language: str | None, steps: int) -> Callable[..., int]:
        if language not in (None, "python", "numba"):
            raise ValueError(f"the language {language!r} is neither 'python' nor 'numba'")
        self.asked += steps
        pays = self.asked >= WORTH_COMPILING or "compiled" in self.__dict__
        if language == "numba" or (language is None and pays and find_spec("numba")):
            return self.compiled
        return self.python

    # Not in a thread beside: numba sets Python's warning filters while it compiles, and every thread has the same.
    @cached_property
    def compiled(self) -> Callable[..., int]:
        import numba

        block = numba.float64[::1]
        signature = (block,) * 6 + (numba.boolean,) + (block,) * 2
        compiled: Callable[..., int] = numba.njit([signature], error_model="numpy")(self.python)
        return compiled


@lru_cache(maxsize=512)
def _kernel(equations: Equations) -> _Kernel:
    return _Kernel(equations)
