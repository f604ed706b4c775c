"""Text of the loop for a batch of runs: time outside, the runs inside, no branch that depends on a run.

The text is written once: numba compiles it for `BATCH` runs, which the processor's vector instructions take together;
numpy runs the same lines on arrays of any number of runs.  Statistics of a run accumulate on the way, so that no
trajectory is kept.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import sympy as sp
from sympy.logic.boolalg import Boolean

from percept_obs.compile.equations import Equations, Expressions, Symbols
from percept_obs.compile.integrator import EACH, LARGEST_SQUARED_STATE, PLACES
from percept_obs.compile.kernels import Language, beginning
from percept_obs.compile.loop import Formulas, take_out
from percept_obs.compile.text import Text, refuse_what_differs

BATCH = 16
"""Runs that numba's loop takes together: two or four of a processor's vectors, whose latencies then overlap."""

ARGUMENTS = (
    *("start", "first", "gains", "moves", "noise", "truth", "known", "which", "lengths", "arriving", "held", "elapsed"),
    *("reach", "tolerance", "late", "result"),
)

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
    """Text of a function of `ARGUMENTS`, described in `percept_obs.compile.batch`, that fills `result`.

    It is for `BATCH` runs in machine code, or for any number of them as arrays of numpy.
    """
    return f"{beginning(language)}\n\n{_Writer(loop, language == 'numba').written()}"


class _Writer:
    """Writes the loop.  Local variables hold one run's numbers; rows of `work` keep them between the inner loops.

    Letters: s state, y outputs, p parameters, g gains, t truth, u noise, v samples, m moving point and its map.
    """

    def __init__(self, loop: BatchLoop, numba: bool) -> None:
        self.loop, self.text, self.places = loop, Text("batch"), dict[str, int]()
        self.formulas = Formulas(self.text, loop.equations)
        self.inner, self.width = (f"range({BATCH})", str(BATCH)) if numba else ("(slice(None),)", "len(start)")
        equations, statistics = loop.equations, loop.statistics
        self.count = {"s": len(equations.state), "y": len(equations.measured), "p": len(equations.parameters)}
        self.count |= {"g": len(equations.gains), "t": len(statistics.truth), "u": self.count["y"]}
        self.count |= {"v": len(statistics.samples), "m": len(loop.moving.point) if loop.moving else 0}
        names = self.formulas.names | {statistics.elapsed: sp.Symbol("now", real=True)}
        names |= _numbered("t", statistics.truth) | _numbered("b", statistics.begun)
        names |= _numbered("v", statistics.samples)
        lasting = {names[symbol] for symbol in (*statistics.begun, *equations.gains)}
        self.fixed: dict[sp.Expr, sp.Symbol] = {}
        self.first = _renamed(statistics.first, names)
        every = (statistics.error, *statistics.means, *statistics.judged, statistics.hidden, statistics.behind)
        self.values = [take_out(each, lasting, self.fixed, "r") for each in _renamed(every, names)]

    def row(self, name: str) -> str:
        """Place where a run's number is kept."""
        return f"work[{self.places.setdefault(name, len(self.places))}, i]"

    def runs(self) -> Any:
        """Loop over the runs."""
        return self.text.over(self.inner)

    def load(self, letters: str, row: str = "") -> None:
        """Load the numbers of some letters from their rows, or from other rows."""
        for letter in letters:
            for k in range(self.count[letter]):
                self.text.assign(f"{letter}{k}", self.row(f"{row or letter}{k}"))

    def keep(self, letters: str) -> None:
        """Keep the numbers of some letters in their rows."""
        for letter in letters:
            for k in range(self.count[letter]):
                self.text.store(self.row(f"{letter}{k}"), f"{letter}{k}")

    def load_parameters(self, place: int) -> None:
        """Load the parameters at one of a step's instants."""
        self.load("p", f"p_{place}_" if self.loop.varying else "")

    def load_gains(self) -> None:
        """Load the gains, and what depends on gains only."""
        self.load("g")
        for name in self.formulas.fixed.values():
            self.text.assign(name.name, self.row(name.name))

    def load_all(self, place: int) -> None:
        """Load whatever the equations use."""
        self.load("sy")
        self.load_parameters(place)
        self.load_gains()

    def gather(self, letter: str, array: str, column: int, index: str, row: str = "") -> None:
        """Keep the numbers of a letter that an array has for this run."""
        for k in range(self.count[letter]):
            self.text.store(self.row(f"{row or letter}{k}"), f"{array}[which[i, {column}], {index}, {k}]")

    def choose(self, condition: str, values: str) -> None:
        """Replace the state by other values where a condition holds."""
        for k in range(self.count["s"]):
            self.text.assign(f"s{k}", f"where({condition}, {values}{k}, s{k})")

    def written(self) -> Text:
        """Write the whole loop."""
        text, updates = self.text, self.loop.equations.update
        with text.function("run", ARGUMENTS):
            head = len(text.lines)
            self.begin()
            self.arrive("0")
            if updates:
                self.correct_first()
            self.accumulate("0")
            with text.loop("k", "lengths"):
                self.step()
                if updates:
                    with text.block("if", "c >= 0"):
                        self.arrive("c")
                        with self.runs():
                            self.load_all(EACH)
                            self.correct()
                            self.keep("sy")
                    with self.runs():
                        self.load("s")
                        self.load_gains()
                        self.look_whether_due()
                with text.block("if", "some(off)"), self.runs():  # resets are rare, and dear
                    self.reset()
                with text.block("if", "c >= 0"):
                    if not updates:
                        self.arrive("c")
                    self.accumulate("c")
            with self.runs():
                for k, name in enumerate((*COLUMNS, *self.means())):
                    text.store(f"result[i, {k}]", self.row(name))
        text.lines.insert(head, f"    work = np.empty(({len(self.places)}, {self.width}))")
        return text

    def means(self) -> list[str]:
        """Rows of sums and numbers of the means."""
        return [f"mean{k}" for k in range(2 * len(self.loop.statistics.means))]

    def begin(self) -> None:
        """Keep what the arguments hold for each run, and begin the statistics."""
        text, moving = self.text, self.loop.moving
        with self.runs():
            for letter, array in (("g", "gains"), ("s", "start")):
                for k in range(self.count[letter]):
                    text.assign(f"{letter}{k}", f"{array}[i, {k}]")
                    text.store(self.row(f"{letter}{k}"), f"{letter}{k}")
            for expression, symbol in self.formulas.fixed.items():
                text.store(self.row(symbol.name), text.print(expression))
            for k in range(self.count["y"]):
                text.store(self.row(f"y{k}"), "0.0")
            size = self.count["m"]
            for k in range(size * (size + 2) + len(moving.shape) if moving else 0):
                text.store(self.row(f"m{k}"), f"moves[i, {k}]")
            self.gather("p", "known", 2, "0", "p_0_" if self.loop.varying else "")
            zero = dict.fromkeys((*COLUMNS, "alive", *self.means()), "0.0")
            for name, value in (zero | {"outside": "-1.0", "nearest": "math.inf", "alive": "1.0"}).items():
                text.store(self.row(name), value)

    def step(self) -> None:
        """A step of the Runge-Kutta method, with what is known at its instants."""
        text, loop = self.text, self.loop
        text.assign("h", "lengths[k]")
        text.assign("c", "arriving[k + 1]")
        if loop.held or loop.varying:
            with self.runs():
                for place in sorted({*PLACES, EACH}):
                    for j in range(self.count["y"] if loop.held else 0):
                        text.store(self.row(f"y_{place}_{j}"), f"held[i, k, {place}, {j}]")
                    if loop.varying:
                        self.gather("p", "known", 2, f"{EACH}*k + {place}", f"p_{place}_")
        text.assign("off", "False")

        def look(place: int) -> None:
            self.load("y", f"y_{place}_" if loop.held else "")
            self.load_parameters(place)

        with self.runs():
            self.load("s")
            self.load_gains()
            self.formulas.step(look)
            if not loop.equations.update:
                self.look_whether_due()
            self.keep("s")

    def correct_first(self) -> None:
        """Correct the start by those first samples that are to correct it."""
        with self.runs():
            for k in range(self.count["y"]):
                sample = self.row(f"v{k}")
                self.text.store(sample, f"where(first[i, {k}] > 0.0, {sample}, math.nan)")
            self.load_all(0)
            self.correct()
            self.keep("s")

    def correct(self) -> None:
        """Update by the samples, one output after the other; NaN corrects nothing."""
        text = self.text
        for k, block in enumerate(self.formulas.update):
            text.assign("sample", self.row(f"v{k}"))
            text.assign("there", "sample == sample")
            text.assign(f"y{k}", f"where(there, sample, y{k})")
            text.copy("x", "s", self.count["s"])
            text.formulas(block, "n")
            self.choose("there", "n")

    def look_whether_due(self) -> None:
        """Find out whether a reset is due in one of the runs, or a state is no longer finite."""
        text = self.text
        if self.loop.equations.reset:
            text.copy("x", "s", self.count["s"])
            text.assign("off", f"off | {text.print(self.formulas.condition)}")
        text.assign("size", self.formulas.size)
        text.assign("lost", f"where(size < {LARGEST_SQUARED_STATE!r}, False, {self.row('alive')} > 0.0)")
        text.assign("off", "off | lost")

    def reset(self) -> None:
        """Reset where it is due, and note where the state is no longer finite."""
        text = self.text
        self.load("s")
        self.load_gains()
        text.assign("alive", self.row("alive"))
        if self.loop.equations.reset:
            text.copy("x", "s", self.count["s"])
            text.assign("due", text.print(self.formulas.condition))
            text.formulas(self.formulas.reset, "n")
            self.choose("due", "n")
            text.store(self.row("resets"), f"{self.row('resets')} + where(due, alive, 0.0)")
        text.assign("size", self.formulas.size)
        text.assign("finite", f"size < {LARGEST_SQUARED_STATE!r}")
        text.assign("now_lost", "where(finite, 0.0, alive)")
        text.store(self.row("diverged"), f"where(now_lost > 0.0, k + 1.0, {self.row('diverged')})")
        text.store(self.row("alive"), "where(finite, alive, 0.0)")
        self.keep("s")

    def arrive(self, sample: str) -> None:
        """Find the truth at a sample, and the sample, NaN where there is none."""
        text, loop = self.text, self.loop
        moving, updates = loop.moving, loop.equations.update
        alike = {"t": loop.truths_alike, "u": loop.noises_alike}
        for letter, array, column in (("t", "truth", 1), ("u", "noise", 0)):
            if alike[letter]:
                for k in range(self.count[letter]):
                    text.assign(f"{letter}{k}", f"{array}[0, {sample}, {k}]")
            elif letter == "u" or moving is None:
                with self.runs():
                    self.gather(letter, array, column, sample)
        with self.runs():
            if moving is not None:
                self.move(moving, sample)
            self.load("".join(letter for letter in "tu" if not alike[letter]))
            text.assign("seen", " & ".join(f"(abs(t{k}) <= reach)" for k in range(self.count["t"] - 1)))
            for k, place in enumerate(loop.statistics.measured):
                text.assign("sample", f"where(seen, t{place} + u{k}, math.nan)")
                if updates:
                    text.store(self.row(f"v{k}"), "sample")
                if not updates or sample == "0":
                    output = self.row(f"y{k}")
                    text.store(output, f"where(sample == sample, sample, {output})")

    def move(self, moving: MovingPoint, sample: str) -> None:
        """Move the point to the next sample, and remember how near it came and how fast."""
        text, size, truths = self.text, self.count["m"], self.count["t"]
        self.load("m")
        if sample != "0":
            for k in range(size):
                row = [self.row(f"m{size + (size + 1) * k + j}") for j in range(size + 1)]
                text.assign(f"X{k}", " + ".join(f"{row[j]}*m{j}" for j in range(size)) + f" + {row[size]}")
            text.copy("m", "X", size)
            self.keep("m")
        for k in range(len(moving.shape)):
            text.assign(f"w{k}", self.row(f"m{size * (size + 2) + k}"))
        names = _numbered("m", moving.point) | _numbered("w", moving.shape)
        text.formulas(_renamed((*moving.coordinates, moving.distance), names), "t")
        self.keep("t")
        text.assign("distance", f"t{truths}")
        distance, nearest, drop = map(self.row, ("distance", "nearest", "drop"))
        if sample != "0":
            text.assign("drop", f"abs(distance - {distance})")
            text.store(drop, f"where(drop > {drop}, drop, {drop})")
        text.store(nearest, f"where(distance >= {nearest}, {nearest}, distance)")
        text.store(distance, "distance")

    def accumulate(self, sample: str) -> None:
        """Accumulate the statistics at a sample; errors count from the sample `late` on."""
        text, statistics = self.text, self.loop.statistics
        with self.runs():
            self.load_all(EACH if sample != "0" else 0)
            self.load("v" if self.loop.truths_alike else "tv")
            text.assign("now", f"elapsed[{sample}]")
            text.copy("x", "s", self.count["s"])
            if statistics.begun and sample == "0":
                text.formulas(self.first, "b")
                for expression, symbol in self.fixed.items():
                    text.store(self.row(symbol.name), text.print(expression))
            for k in range(len(self.fixed) if statistics.begun else 0):
                text.assign(f"r{k}", self.row(f"r{k}"))
            text.assign("alive", self.row("alive"))
            text.formulas(self.values, "e")
            self.judge()
            outside, squares, worst = map(self.row, ("outside", "squares", "worst"))
            text.store(outside, f"where(largest < tolerance, {outside}, {sample} + 0.0)")
            text.store(self.row("judged"), "largest")
            text.store(self.row("final"), "error")
            text.assign("counts", f"{sample} >= late")
            text.store(squares, f"{squares} + where(counts, error*error, 0.0)")
            text.store(worst, f"where(counts & (error > {worst}), error, {worst})")
            for k in range(len(statistics.means)):
                text.assign("there", f"counts & (abs(e{1 + k}) < math.inf)")
                total, number = self.row(f"mean{2 * k}"), self.row(f"mean{2 * k + 1}")
                text.store(total, f"{total} + where(there, e{1 + k}, 0.0)")
                text.store(number, f"{number} + where(there, 1.0, 0.0)")

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


def _numbered(letter: str, symbols: Symbols) -> dict[sp.Symbol, sp.Symbol]:
    """Names of symbols in the loop: a letter and a number."""
    return {symbol: sp.Symbol(f"{letter}{k}", real=True) for k, symbol in enumerate(symbols)}


def _renamed(expressions: tuple[sp.Basic, ...], names: Mapping[sp.Symbol, sp.Symbol]) -> list[sp.Basic]:
    found = [expression.xreplace(dict(names)) for expression in expressions]
    refuse_what_differs(found)
    return found
