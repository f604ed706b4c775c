"""Many runs side by side, in machine code where numba is, else in numpy: what is counted of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from threading import Lock
from typing import Any

import numpy as np

from percept_obs.compile.arrays import Array, Indices
from percept_obs.compile.equations import Equations
from percept_obs.compile.functions import executed
from percept_obs.compile.kernels import Language
from percept_obs.compile.lanes import COUNTED, LANES, LanesLoop, Moving, lanes_source
from percept_obs.compile.machine_code import machine_code
from percept_obs.compile.watched import Watched

_MAKING = Lock()


@dataclass(frozen=True, eq=False)
class Lanes:
    """What is known to each of the runs, and what they share.

    Parameters
    ----------
    start : array of shape (L, n)
        States at the first sample.
    first : array of shape (L, m)
        Positive where a first sample corrects the start, 0 where it is the start.
    gains : array of shape (L, number of gains)
    moves : array of shape (L, 3 + 12 + number of the surface's numbers)
        With `Moving`: the point, the map [M | v] to the next sample, row by row, and the surface.
    which : integer array of shape (L, 3)
        Which of the noises, of the truths and of the motions belongs to each run.
    noise : array of shape (R, K, m)
        Of the samples; NaN where one was lost.
    truth : array of shape (D, K, n)
        True coordinates, unless the points move on their own.
    known : array of shape (B, 1, p) or (B, N EACH + 1, p)
        Parameters of motion and surface, constant or at the instants of all steps.
    lengths : array of shape (N,)
        Lengths of the steps in seconds.
    arriving : integer array of shape (N + 1,)
        Which sample arrives at the end of each step, -1 if none does; 0 first.
    elapsed : array of shape (K,)
        Seconds from the first sample to each.
    reach : float
        Largest absolute image coordinate that is seen.
    held : array of shape (L, N, EACH + 1, m), optional
        Outputs at the instants of the steps; the last sample is held when left out.
    noises_alike, truths_alike : bool
        Whether there is one noise, or one truth, for all, so that none is looked up.
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
    noises_alike: bool = False
    truths_alike: bool = False


def count(
    equations: Equations,
    watched: Watched,
    moving: Moving | None,
    lanes: Lanes,
    tolerance: float,
    late: int,
    language: Language,
) -> Array:
    """Run the equations for every lane and count what is watched.

    Parameters
    ----------
    equations : Equations
    watched : Watched
    moving : Moving or None
        How points are seen that move on their own; otherwise truths come from an array.
    lanes : Lanes
    tolerance : float
        Bound on what is judged.
    late : int
        Sample from which on errors count.
    language : "python" or "numba"
        Python's runs in numpy.

    Returns
    -------
    array of shape (L, number of `COUNTED` + twice that of the watched means)
        Of each run: the last sample outside of the tolerance, -1 if there is none; what is judged and the error at the
        last sample; sum of squares and largest value of the error; resets; the step, from 1 on, at whose end the state
        was no longer finite, or 0; how near a point came that moves on its own, and the largest change of its distance
        between samples; and of each mean the sum and the number of values.
    """
    runs = len(lanes.start)
    result = np.empty((runs, len(COUNTED) + 2 * len(watched.means)))
    width = LANES if language == "numba" else max(runs, 1)
    truths_alike = moving is None and lanes.truths_alike
    held, varying = lanes.held is not None, lanes.known.shape[1] > 1
    kernel = function_of(
        LanesLoop(equations, watched, moving, held, varying, lanes.noises_alike, truths_alike), language
    )
    outputs = np.zeros((1, 1, 1, 1)) if lanes.held is None else lanes.held
    shared = (lanes.noise, lanes.truth, lanes.known)
    rest = (lanes.lengths, lanes.arriving)
    last = (lanes.elapsed, lanes.reach, float(tolerance), late)
    with np.errstate(all="ignore"):
        for begin in range(0, runs, width):
            part = slice(begin, begin + width)
            own: tuple[Array, ...] = (lanes.start[part], lanes.first[part], lanes.gains[part], lanes.moves[part])
            which, filled = lanes.which[part], result[part]
            between = outputs[part] if held else outputs
            if len(filled) < width:  # the last lanes stand twice, for all are always run
                lack = width - len(filled)
                own = tuple(np.pad(each, ((0, lack), (0, 0)), "edge") for each in own)
                which = np.pad(which, ((0, lack), (0, 0)), "edge")
                filled = np.empty((width, result.shape[1]))
                between = between if not held else np.pad(between, ((0, lack), *[(0, 0)] * 3), "edge")
            kernel(*own, *shared, which, *rest, between, *last, filled)
            result[part] = filled[: runs - begin]
    return result


def seized(lanes: Lanes) -> Lanes:
    """The same in the arrays that machine code takes: contiguous, of floats and of machine integers."""
    changes: dict[str, Any] = {}
    for name, value in vars(lanes).items():
        if isinstance(value, np.ndarray):
            kind = np.intp if name in ("which", "arriving") else float
            changes[name] = np.ascontiguousarray(value, dtype=kind)
    return replace(lanes, **changes)


def function_of(loop: LanesLoop, language: Language) -> Callable[..., None]:
    """The loop as a function, made once even if several threads ask for it at the same time."""
    with _MAKING:
        return _function_of(loop, language)


@lru_cache(maxsize=128)
def _function_of(loop: LanesLoop, language: Language) -> Callable[..., None]:
    if language == "python":
        text = lanes_source(loop, "numpy")
        return executed(text, math=np, np=np, where=np.where, some=np.any, exp=np.exp, tanh=np.tanh)
    one, two, three, four = (f"float64[{':, ' * further}::1]" for further in range(4))
    index, indices = "intp[::1]", "intp[:, ::1]"
    own, shared = ", ".join([two] * 4), ", ".join([three] * 3)
    signature = f"({own}, {shared}, {indices}, {one}, {index}, {four}, {one}, float64, float64, intp, {two})"
    return machine_code(lanes_source(loop, "numba"), signature, "lanes")
