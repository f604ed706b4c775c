"""Text of the loop for a batch of runs: time outside, the runs inside, no branch that depends on a run.

The text is written once: numba compiles it for `BATCH` runs, which the processor's vector instructions take together;
numpy runs the same lines on arrays of any number of runs.  Statistics of a run accumulate on the way, so that no
trajectory is kept.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import sympy as sp
from sympy.logic.boolalg import Boolean

from percept_obs.compile.equations import Equations, Expressions, Symbols
from percept_obs.compile.integrator import EACH, PLACES
from percept_obs.compile.kernels import Language
from percept_obs.compile.loop import SMALL, Loop, numbered, renamed, take_out
from percept_obs.compile.many_runs import ManyRuns

BATCH = 16
"""Runs that numba's loop takes together: two or four of a processor's vectors, whose latencies then overlap."""

COLUMNS = ("outside", "judged", "final", "squares", "worst", "resets", "diverged", "nearest", "drop")
"""Columns of the result, before two, sum and number, for each of the means of `Statistics`."""


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
    means: Expressions = ()  # whose means are asked for; values that are not finite do not count
    samples: Symbols = ()  # those that arrive, NaN where there is none, if the means use them
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
    held: bool  # whether outputs between samples come from an array; if not, the last is held
    varying: bool  # whether the parameters vary over time
    noises_alike: bool  # in all runs
    truths_alike: bool  # in all runs


@lru_cache(maxsize=128)
def batch_source(loop: BatchLoop, language: Language) -> str:
    """Text of a function of the arguments that `percept_obs.compile.batch` describes; it fills `result`.

    It is for `BATCH` runs in machine code, or for any number of them as arrays of numpy.
    """
    return _ManyRuns(ManyRuns(language, str(BATCH)), loop).written()


class _ManyRuns(Loop):
    """The loop for a batch.

    More letters: t truth, u noise, v samples, z last outputs, m moving point, then its map and the surface's shape, b
    first values of the statistics, r what depends on these and gains only, e values.
    """

    text: ManyRuns
    arguments = (
        "start, first, gains, moves, noise, truth, known, which, lengths, arriving, held, elapsed, reach, "
        "tolerance, late, result"
    )
    lengths = "lengths"

    def __init__(self, text: ManyRuns, loop: BatchLoop) -> None:
        super().__init__(text, loop.equations)
        statistics = self.statistics = loop.statistics
        self.loop, self.moving = loop, loop.moving
        size = len(loop.moving.point) if loop.moving else 0
        self.count |= {"t": len(statistics.truth), "u": self.count["y"], "m": size}
        names = self.names | {statistics.elapsed: sp.Symbol("now", real=True)} | numbered("t", statistics.truth)
        names |= numbered("b", statistics.begun) | numbered("v", statistics.samples)
        lasting = {names[symbol] for symbol in (*statistics.begun, *self.equations.gains)}
        self.lasting: dict[sp.Expr, sp.Symbol] = {}
        self.first = renamed(statistics.first, names)
        every = (statistics.error, *statistics.means, *statistics.judged, statistics.hidden, statistics.behind)
        self.values = [take_out(each, lasting, self.lasting, "r") for each in renamed(every, names)]

    def begin(self) -> None:
        text = self.text
        with text.runs():
            self.load("x", "start[i, {}]", to="s")
            self.load("g", "gains[i, {}]")
            self.fix(self.fixed)
            self.load("y", "0.0", to="z")
            if self.loop.held:  # named here, for by the order of its rows numba rounds
                self.load("y", "0.0", to="y_0_")
            self.load("p", "known[which[i, 2], 0, {}]")
            size = self.count["m"]
            for k in range(size * (size + 2) + len(self.moving.shape) if self.moving else 0):
                text.assign(f"m{k}", f"moves[i, {k}]")
            zero = dict.fromkeys((*COLUMNS, *self.means), "0.0")
            for name, value in (zero | {"outside": "-1.0", "nearest": "math.inf", "alive": "1.0"}).items():
                text.assign(name, value)

    @property
    def means(self) -> list[str]:
        """Sums and numbers of the means."""
        return [f"mean{k}" for k in range(2 * len(self.statistics.means))]

    def look(self, instant: int) -> None:
        self.load("y", f"y_{instant}_{{}}" if self.loop.held else "z{}")
        if self.loop.varying:
            self.load("p", f"p_{instant}_{{}}")

    def step(self) -> None:
        text, loop = self.text, self.loop
        text.assign("c", "arriving[k + 1]")
        if loop.held or loop.varying:
            with text.runs():
                for instant in sorted({*PLACES, EACH}):
                    if loop.held:
                        self.load("y", f"held[i, k, {instant}, {{}}]", to=f"y_{instant}_")
                    if loop.varying:
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
            for k, name in enumerate((*COLUMNS, *self.means)):
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
        text, statistics = self.text, self.statistics
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
            for k in range(len(statistics.means)):
                text.assign("there", f"counts & (abs(e{1 + k}) < math.inf)")
                text.assign(f"mean{2 * k}", f"mean{2 * k} + where(there, e{1 + k}, 0.0)")
                text.assign(f"mean{2 * k + 1}", f"mean{2 * k + 1} + where(there, 1.0, 0.0)")

    def judge(self) -> None:
        """Find the error, and the largest of the values that are judged; both are NaN without an estimate."""
        text, statistics = self.text, self.loop.statistics
        first = 1 + len(statistics.means)
        hidden = first + len(statistics.judged)
        text.assign("seen", "alive > 0.0")
        if statistics.hidden != sp.false:
            text.assign("seen", f"where(e{hidden}, False, seen)")
        text.assign("largest", f"e{first}")
        for k in range(first + 1, hidden):
            text.assign("largest", f"where(e{k} > largest, e{k}, largest)")
        if statistics.behind != sp.false:
            text.assign("largest", f"where(e{hidden + 1}, math.inf, largest)")
        text.assign("largest", "where(seen, largest, math.nan)")
        text.assign("error", "where(seen, e0, math.nan)")
