"""Running a batch: many runs at once, in machine code where numba is, else in numpy, and the statistics of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from threading import Lock

import numpy as np

from percept_obs.compile.arrays import Array, Indices
from percept_obs.compile.batch_loop import BATCH, COLUMNS, BatchLoop, batch_source
from percept_obs.compile.functions import executed
from percept_obs.compile.kernels import Language
from percept_obs.compile.machine_code import machine_code

_COMPILING = Lock()
"""Held while a loop is compiled, so that threads that ask for the same one do not compile it twice."""
_contiguous = partial(np.ascontiguousarray, dtype=float)


@dataclass(frozen=True, eq=False)
class Batch:
    """Inputs of L runs of K samples and N steps: those of each run, and those that they share."""

    start: Array  # (L, n), states at the first sample
    first: Array  # (L, m), positive where a first sample corrects the start, 0 where it is the start
    gains: Array  # (L, number of gains)
    moves: Array  # (L, 3 + 12 + number of the surface's), of a `MovingPoint`: point, map [M | v], surface
    which: Indices  # (L, 3), index of the noise, the truth and the motion of each run
    noise: Array  # (R, K, m), of the samples; NaN where one was lost
    truth: Array  # (D, K, n), true coordinates, unless the points move on their own
    known: Array  # (B, 1, p) or (B, N EACH + 1, p), parameters of motion and surface, constant or at all instants
    lengths: Array  # (N,), of the steps in seconds
    arriving: Indices  # (N + 1,), index of the sample at each step's end, -1 if there is none; 0 first
    elapsed: Array  # (K,), seconds from the first sample to each
    reach: float = np.inf  # largest absolute image coordinate that is seen
    held: Array | None = None  # (L, N, EACH + 1, m), outputs at the instants; the last sample is held without it


def run_batch(loop: BatchLoop, batch: Batch, tolerance: float, late: int, language: Language) -> Array:
    """Run a batch; return a row of statistics for each of its L runs: a column for each of `COLUMNS`, two a mean.

    Errors count from the sample `late` on.  The columns are: the last sample outside of the tolerance, -1 if there is
    none; what is judged and the error at the last sample; sum of squares and largest value of the error; resets; the
    step, from 1 on, at whose end the state was no longer finite, or 0; how near a point came that moves on its own, and
    the largest change of its distance between samples; and of each mean the sum and the number of values.
    """
    runs, columns = len(batch.start), len(COLUMNS) + 2 * len(loop.statistics.means)
    # compiled code has a fixed width; numpy takes all runs at once
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


def compiled(loop: BatchLoop, language: Language) -> Callable[..., None]:
    """The loop as a function, made once even if several threads ask for it at the same time."""
    with _COMPILING:
        return _compiled(loop, language)


@lru_cache(maxsize=128)
def _compiled(loop: BatchLoop, language: Language) -> Callable[..., None]:
    text = batch_source(loop, language)
    if language == "python":
        return executed(text)
    one, two, three, four = (f"float64[{':, ' * further}::1]" for further in range(4))
    index, indices = "intp[::1]", "intp[:, ::1]"
    own, shared = ", ".join([two] * 4), ", ".join([three] * 3)
    signature = f"({own}, {shared}, {indices}, {one}, {index}, {four}, {one}, float64, float64, intp, {two})"
    return machine_code(text, signature, "batch")
