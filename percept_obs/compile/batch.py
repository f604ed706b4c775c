"""Many runs at once and the statistics of each: time outside, the runs inside, no branch that depends on a run.

numba compiles the loop for `BATCH` runs, which the processor's vector instructions take together; numpy runs the same
lines on arrays of any number of runs.  Statistics of a run accumulate on the way, so that no trajectory is kept.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from functools import lru_cache, partial
from threading import Lock
from typing import NamedTuple

import numpy as np
import sympy as sp
from sympy.logic.boolalg import Boolean

from percept_obs.compile.arrays import Array, Indices
from percept_obs.compile.equations import Equations, Expressions, Symbols
from percept_obs.compile.functions import executed
from percept_obs.compile.integrator import EACH, PLACES
from percept_obs.compile.kernels import Language
from percept_obs.compile.loop import SMALL, Loop, numbered, renamed, take_out
from percept_obs.compile.machine_code import machine_code
from percept_obs.compile.many_runs import ManyRuns

BATCH = 16
"""Runs that numba's loop takes together: two or four of a processor's vectors, whose latencies then overlap."""

COLUMNS = ("outside", "judged", "final", "squares", "worst", "resets", "diverged", "nearest", "drop")
"""Columns of the result."""

_COMPILING = Lock()
"""Held while a loop is compiled, so that threads that ask for the same one do not compile it twice."""
_contiguous = partial(np.ascontiguousarray, dtype=float)


@dataclass(frozen=True)
class Statistics:
    """Statistics accumulated during a run, in the symbols of its equations and those defined here."""

    truth: Symbols  # the true coordinates
    elapsed: sp.Symbol  # seconds since the first sample
    begun: Symbols  # the values of `first` at the first sample
    first: Expressions
    hidden: Boolean  # where there is no estimate
    judged: Expressions  # the largest of which is to stay within the tolerance
    behind: Boolean  # where that is infinite
    error: sp.Expr  # whose last and largest value and mean square are asked for
    measured: tuple[int, ...] = ()  # index of each measured output among the true coordinates


@dataclass(frozen=True)
class MovingPoint:
    """A point that moves in every run by a linear map of its own from each sample to the next."""

    point: Symbols
    shape: Symbols  # of the surface
    coordinates: Expressions  # true ones, from point and shape
    distance: sp.Expr


class BatchLoop(NamedTuple):
    """Everything that decides the text of a loop for a batch."""

    equations: Equations
    statistics: Statistics
    moving: MovingPoint | None  # source of the truth, unless it comes from an array
    varying: bool  # whether the parameters vary over time
    noises_alike: bool  # in all runs
    truths_alike: bool  # in all runs


class _ManyRuns(Loop):
    """The loop for a batch.

    More letters: t truth, u noise, v samples, z last outputs, m moving point, then its map and the surface's shape, b
    first values of the statistics, r what depends on these and gains only, e values.
    """

    text: ManyRuns
    arguments = (
        "start, first, gains, moves, noise, truth, known, which, lengths, arriving, elapsed, reach, tolerance, "
        "late, result"
    )
    lengths = "lengths"

    def __init__(self, text: ManyRuns, loop: BatchLoop) -> None:
        super().__init__(text, loop.equations)
        statistics = self.statistics = loop.statistics
        self.loop, self.moving = loop, loop.moving
        size = len(loop.moving.point) if loop.moving else 0
        self.count |= {"t": len(statistics.truth), "u": self.count["y"], "m": size}
        names = self.names | {statistics.elapsed: sp.Symbol("now", real=True)} | numbered("t", statistics.truth)
        names |= numbered("b", statistics.begun)
        lasting = {names[symbol] for symbol in (*statistics.begun, *self.equations.gains)}
        self.lasting: dict[sp.Expr, sp.Symbol] = {}
        self.first = renamed(statistics.first, names)
        every = (statistics.error, *statistics.judged, statistics.hidden, statistics.behind)
        self.values = [take_out(each, lasting, self.lasting, "r") for each in renamed(every, names)]

    def begin(self) -> None:
        text = self.text
        with text.runs():
            self.load("x", "start[i, {}]", to="s")
            self.load("g", "gains[i, {}]")
            self.fix(self.fixed)
            self.load("y", "0.0", to="z")
            self.load("p", "known[which[i, 2], 0, {}]")
            size = self.count["m"]
            for k in range(size * (size + 2) + len(self.moving.shape) if self.moving else 0):
                text.assign(f"m{k}", f"moves[i, {k}]")
            zero = dict.fromkeys(COLUMNS, "0.0")
            for name, value in (zero | {"outside": "-1.0", "nearest": "math.inf", "alive": "1.0"}).items():
                text.assign(name, value)

    def look(self, instant: int) -> None:
        self.load("y", "z{}")
        if self.loop.varying:
            self.load("p", f"p_{instant}_{{}}")

    def step(self) -> None:
        text, loop = self.text, self.loop
        text.assign("c", "arriving[k + 1]")
        if loop.varying:
            with text.runs():
                for instant in sorted({*PLACES, EACH}):
                    self.load("p", f"known[which[i, 2], {EACH}*k + {instant}, {{}}]", to=f"p_{instant}_")
        text.assign("off", "False")
        with text.runs():
            super().step()
            if not self.updates:
                self.look_whether_due()

    @contextmanager
    def at_sample(self, end: str) -> Iterator[str]:
        """Open a block for the sample at the end of a step, if there is one, and yield its index."""
        with nullcontext() if end == "0" else self.text.block("if", "c >= 0"):
            yield "0" if end == "0" else "c"

    def take_samples(self, end: str) -> None:
        if not self.updates:  # a sample is then known from the next step on
            return
        text = self.text
        with self.at_sample(end) as sample:
            self.arrive(sample)
            with text.runs():
                for k in range(self.count["y"] if end == "0" else 0):  # which corrects only a start that was given
                    text.assign(f"v{k}", f"where(first[i, {k}] > 0.0, v{k}, math.nan)")
                self.load("y", "z{}")
                self.update("v{}")
                self.load("y", "y{}", to="z")
        if end != "0":
            with text.runs():
                self.look_whether_due()

    def look_whether_due(self) -> None:
        """Find out whether a reset is due in one of the runs, or a state is no longer finite."""
        if self.equations.reset:
            self.load("x", "s{}")
            self.text.assign("off", f"off | {self.text.print(self.condition)}")
        self.measure()
        self.text.assign("off", f"off | where({SMALL}, False, alive > 0.0)")

    def reset(self) -> None:
        text = self.text
        with text.block("if", "some(off)"), text.runs():  # resets are rare, and dear
            super().reset()
            with text.only(f"where({SMALL}, False, alive > 0.0)"):
                text.replace("diverged", "k + 1.0")
                text.replace("alive", "0.0")

    def note_reset(self) -> None:
        self.text.replace("resets", "resets + alive")

    def keep(self, end: str) -> None:
        with self.at_sample(end) as sample:
            if not self.updates:
                self.arrive(sample)
            self.accumulate(sample)

    def end(self) -> None:
        with self.text.runs():
            for k, name in enumerate(COLUMNS):
                self.text.store(f"result[i, {k}]", name)

    def arrive(self, sample: str) -> None:
        """Find the truth at a sample, and the sample, NaN where there is none."""
        text, loop = self.text, self.loop
        sources = [("u", "noise", 0, loop.noises_alike)]
        if loop.moving is None:
            sources.append(("t", "truth", 1, loop.truths_alike))
        for letter, array, column, alike in sources:
            with nullcontext() if alike else text.runs():
                self.load(letter, f"{array}[{0 if alike else f'which[i, {column}]'}, {sample}, {{}}]")
        with text.runs():
            if loop.moving:
                self.move(loop.moving, sample)
            text.assign("seen", " & ".join(f"(abs(t{k}) <= reach)" for k in range(self.count["t"] - 1)))
            for k, place in enumerate(self.statistics.measured):
                text.assign(f"v{k}", f"where(seen, t{place} + u{k}, math.nan)")
                if not self.updates or sample == "0":
                    text.assign(f"z{k}", f"where(v{k} == v{k}, v{k}, z{k})")

    def move(self, moving: MovingPoint, sample: str) -> None:
        """Move the point to the next sample, and remember how near it came and how fast."""
        text, size = self.text, self.count["m"]
        if sample != "0":
            for k in range(size):
                row = [f"m{size + (size + 1) * k + j}" for j in range(size + 1)]
                text.assign(f"X{k}", " + ".join(f"{row[j]}*m{j}" for j in range(size)) + f" + {row[size]}")
            self.load("m", "X{}")
        shape = {symbol: sp.Symbol(f"m{size * (size + 2) + k}", real=True) for k, symbol in enumerate(moving.shape)}
        text.formulas(renamed((*moving.coordinates, moving.distance), numbered("m", moving.point) | shape), "t")
        near = f"t{self.count['t']}"
        if sample != "0":
            text.assign("change", f"abs({near} - distance)")
            text.assign("drop", "where(change > drop, change, drop)")
        text.assign("nearest", f"where({near} >= nearest, nearest, {near})")
        text.assign("distance", near)

    def accumulate(self, sample: str) -> None:
        """Accumulate the statistics at a sample; errors count from the sample `late` on."""
        text = self.text
        with text.runs():
            self.load("y", "z{}")
            text.assign("now", f"elapsed[{sample}]")
            self.load("x", "s{}")
            if sample == "0":
                text.formulas(self.first, "b")
                self.fix(self.lasting)
            text.formulas(self.values, "e")
            self.judge()
            text.assign("outside", f"where(largest < tolerance, outside, {sample} + 0.0)")
            text.assign("judged", "largest")
            text.assign("final", "error")
            text.assign("counts", f"{sample} >= late")
            text.assign("squares", "squares + where(counts, error*error, 0.0)")
            text.assign("worst", "where(counts & (error > worst), error, worst)")

    def judge(self) -> None:
        """Find the error, and the largest of the values that are judged; both are NaN without an estimate."""
        text, statistics = self.text, self.loop.statistics
        hidden = 1 + len(statistics.judged)
        text.assign("seen", "alive > 0.0")
        if statistics.hidden != sp.false:
            text.assign("seen", f"where(e{hidden}, False, seen)")
        text.assign("largest", "e1")
        for k in range(2, hidden):
            text.assign("largest", f"where(e{k} > largest, e{k}, largest)")
        if statistics.behind != sp.false:
            text.assign("largest", f"where(e{hidden + 1}, math.inf, largest)")
        text.assign("largest", "where(seen, largest, math.nan)")
        text.assign("error", "where(seen, e0, math.nan)")


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


def run_batch(loop: BatchLoop, batch: Batch, tolerance: float, late: int, language: Language) -> Array:
    """Run a batch; return a row of statistics for each of its L runs: a column for each of `COLUMNS`.

    Errors count from the sample `late` on.  The columns are: the last sample outside of the tolerance, -1 if there is
    none; what is judged and the error at the last sample; sum of squares and largest value of the error; resets; the
    step, from 1 on, at whose end the state was no longer finite, or 0; how near a point came that moves on its own, and
    the largest change of its distance between samples.
    """
    runs = len(batch.start)
    # compiled code has a fixed width; numpy takes all runs at once
    width = BATCH if language == "numba" else max(runs, 1)
    filled = -(-runs // width) * width
    rows = np.minimum(np.arange(filled), runs - 1)  # the last run stands in for those that fill up the last batch
    own = [_contiguous(each[rows]) for each in (batch.start, batch.first, batch.gains, batch.moves)]
    shared = [_contiguous(each) for each in (batch.noise, batch.truth, batch.known)]
    lengths, elapsed = _contiguous(batch.lengths), _contiguous(batch.elapsed)
    which, arriving = (np.ascontiguousarray(each, dtype=np.intp) for each in (batch.which[rows], batch.arriving))
    result, kernel = np.empty((filled, len(COLUMNS))), compiled(loop, language)
    with np.errstate(all="ignore"):
        for begin in range(0, filled, width):
            of = slice(begin, begin + width)
            kernel(
                *(*(each[of] for each in own), *shared, which[of], lengths, arriving, elapsed),
                *(batch.reach, float(tolerance), late, result[of]),
            )
    return result[:runs]


def compiled(loop: BatchLoop, language: Language) -> Callable[..., None]:
    """The loop as a function, made once even if several threads ask for it at the same time."""
    with _COMPILING:
        return _compiled(loop, language)


@lru_cache(maxsize=128)
def _compiled(loop: BatchLoop, language: Language) -> Callable[..., None]:
    text = _ManyRuns(ManyRuns(language, str(BATCH)), loop).written()
    if language == "python":
        return executed(text)
    one, two, three = (f"float64[{':, ' * further}::1]" for further in range(3))
    index, indices = "intp[::1]", "intp[:, ::1]"
    own, shared = ", ".join([two] * 4), ", ".join([three] * 3)
    signature = f"({own}, {shared}, {indices}, {one}, {index}, {one}, float64, float64, intp, {two})"
    return machine_code(text, signature, "batch")
