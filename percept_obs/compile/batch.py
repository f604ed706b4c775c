"""Running a batch: many runs at once, in machine code where numba is, else in numpy, and the statistics of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from threading import Lock

import numpy as np

from percept_obs.compile.arrays import Array, Indices
from percept_obs.compile.batch_loop import BATCH, COLUMNS, BatchLoop, batch_source
from percept_obs.compile.functions import executed
from percept_obs.compile.kernels import Language
from percept_obs.compile.machine_code import machine_code

_COMPILING = Lock()


@dataclass(frozen=True, eq=False)
class Batch:
    """Inputs of L runs: those of each, and those that they share.

    Parameters
    ----------
    start : array of shape (L, n)
        States at the first sample.
    first : array of shape (L, m)
        Positive where a first sample corrects the start, 0 where it is the start.
    gains : array of shape (L, number of gains)
    moves : array of shape (L, 3 + 12 + number of the surface's numbers)
        With `MovingPoint`: the point, the map [M | v] to the next sample, row by row, and the surface.
    which : integer array of shape (L, 3)
        Index of the noise, the truth and the motion of each run.
    noise : array of shape (R, K, m)
        Of the samples; NaN where one was lost.
    truth : array of shape (D, K, n)
        True coordinates, unless the points move on their own.
    known : array of shape (B, 1, p) or (B, N EACH + 1, p)
        Parameters of motion and surface, constant or at the instants of all steps.
    lengths : array of shape (N,)
        Lengths of the steps in seconds.
    arriving : integer array of shape (N + 1,)
        Index of the sample that arrives at the end of each step, -1 if none does; 0 first.
    elapsed : array of shape (K,)
        Seconds from the first sample to each.
    reach : float
        Largest absolute image coordinate that is seen.
    held : array of shape (L, N, EACH + 1, m), optional
        Outputs at the instants of the steps; the last sample is held when left out.
    """

    start: Array
    first: Array
    gains: Array
    moves: Array
    which: Indices
    noise: Array
    truth: Array
    known: Array
    lengths: Array
    arriving: Indices
    elapsed: Array
    reach: float = np.inf
    held: Array | None = None


def run_batch(loop: BatchLoop, batch: Batch, tolerance: float, late: int, language: Language) -> Array:
    """Run the equations for a batch and accumulate its statistics.

    Parameters
    ----------
    loop : BatchLoop
    batch : Batch
    tolerance : float
        Bound on what is judged.
    late : int
        Sample from which on errors count.
    language : "python" or "numba"
        Python's runs in numpy.

    Returns
    -------
    array of shape (L, number of `COLUMNS` + twice that of the means)
        Of each run: the last sample outside of the tolerance, -1 if there is none; what is judged and the error at the
        last sample; sum of squares and largest value of the error; resets; the step, from 1 on, at whose end the state
        was no longer finite, or 0; how near a point came that moves on its own, and the largest change of its distance
        between samples; and of each mean the sum and the number of values.
    """
    runs, columns = len(batch.start), len(COLUMNS) + 2 * len(loop.statistics.means)
    width = BATCH if language == "numba" else max(runs, 1)
    filled = -(-runs // width) * width
    rows = np.minimum(np.arange(filled), runs - 1)  # the last run stands in for those that fill up the last batch
    held = np.zeros((1, 1, 1, 1)) if batch.held is None else _contiguous(batch.held)
    own = [_contiguous(each[rows]) for each in (batch.start, batch.first, batch.gains, batch.moves)]
    shared = [_contiguous(each) for each in (batch.noise, batch.truth, batch.known)]
    lengths, elapsed = _contiguous(batch.lengths), _contiguous(batch.elapsed)
    which, arriving = (np.ascontiguousarray(each, dtype=np.intp) for each in (batch.which[rows], batch.arriving))
    result, kernel = np.empty((filled, columns)), compiled(loop, language)
    with np.errstate(all="ignore"):
        for begin in range(0, filled, width):
            of = slice(begin, begin + width)
            outputs = held if not loop.held else held[of] if begin + width <= runs else held[rows[of]]
            kernel(
                *(*(each[of] for each in own), *shared, which[of], lengths, arriving, outputs, elapsed),
                *(batch.reach, float(tolerance), late, result[of]),
            )
    return result[:runs]


def _contiguous(array: Array) -> Array:
    return np.ascontiguousarray(array, dtype=float)


def compiled(loop: BatchLoop, language: Language) -> Callable[..., None]:
    """The loop as a function, made once even if several threads ask for it at the same time."""
    with _COMPILING:
        return _compiled(loop, language)


@lru_cache(maxsize=128)
def _compiled(loop: BatchLoop, language: Language) -> Callable[..., None]:
    if language == "python":
        text = batch_source(loop, "numpy")
        return executed(text, math=np, np=np, where=np.where, some=np.any, exp=np.exp, tanh=np.tanh)
    one, two, three, four = (f"float64[{':, ' * further}::1]" for further in range(4))
    index, indices = "intp[::1]", "intp[:, ::1]"
    own, shared = ", ".join([two] * 4), ", ".join([three] * 3)
    signature = f"({own}, {shared}, {indices}, {one}, {index}, {four}, {one}, float64, float64, intp, {two})"
    return machine_code(batch_source(loop, "numba"), signature, "batch")
