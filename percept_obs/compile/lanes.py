"""The loop for many runs side by side: time outside, the runs inside, no branch that depends on a run.

A lane is one of the runs.  The text is written once: numba compiles it for `LANES` lanes, which the processor's vector
instructions take together; numpy runs the same lines on arrays of as many lanes as there are.  What is asked of a run
is counted on the way, so that no trajectory is kept.
"""

from __future__ import annotations

import inspect
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal, NamedTuple

import sympy as sp

from percept_obs.compile import vector_functions
from percept_obs.compile.equations import Equations, Expressions, Symbols
from percept_obs.compile.integrator import EACH, LARGEST_SQUARED_STATE, PLACES
from percept_obs.compile.loop import Formulas, take_out
from percept_obs.compile.text import Text, refuse_what_differs
from percept_obs.compile.watched import Watched

LANES = 16
"""Runs that numba's loop takes together: two or four of a processor's vectors, whose latencies then overlap."""

ARGUMENTS = (
    *("start", "first", "gains", "moves", "noise", "truth", "known", "which", "lengths", "arriving", "held", "elapsed"),
    *("reach", "tolerance", "late", "result"),
)

COUNTED = ("outside", "judged", "final", "squares", "worst", "resets", "diverged", "nearest", "drop")
"""What is counted of every run, before two columns, sum and number, for each of the means of `Watched`."""


@dataclass(frozen=True)
class Moving:
    """How a point is seen that moves on its own in every lane, by one linear map from each sample to the next.

    Parameters
    ----------
    point : symbols
    shape : symbols
        Of the surface.
    coordinates : expressions
        True coordinates, from both.
    distance : expression
        Of the point.
    """

    point: Symbols
    shape: Symbols
    coordinates: Expressions
    distance: sp.Expr


class _Rows:
    """Names of rows of the array in which the lanes keep their numbers."""

    def __init__(self) -> None:
        self.places: dict[str, int] = {}

    def __getitem__(self, name: str) -> str:
        return f"work[{self.places.setdefault(name, len(self.places))}, i]"


class LanesLoop(NamedTuple):
    """What a loop over runs side by side is made for.

    Parameters
    ----------
    equations : Equations
    watched : Watched
    moving : Moving or None
        How the truth is found, unless it comes from an array.
    held : bool
        Whether outputs between samples come from an array; otherwise the last sample is held.
    varying : bool
        Whether the parameters vary over time.
    noises_alike, truths_alike : bool
        Whether the noise, and the truth, are the same in all lanes.
    """

    equations: Equations
    watched: Watched
    moving: Moving | None
    held: bool
    varying: bool
    noises_alike: bool
    truths_alike: bool


@lru_cache(maxsize=128)
def lanes_source(loop: LanesLoop, language: Literal["numba", "numpy"]) -> str:
    """Text of the loop over runs side by side.

    Parameters
    ----------
    loop : LanesLoop
    language : "numba" or "numpy"
        For `LANES` lanes in machine code, or for any number of them as arrays.

    Returns
    -------
    str
        A function of `ARGUMENTS`, described in `percept_obs.compile.side_by_side`, that fills `result`.
    """
    equations, watched, moving, held, varying, noises_alike, truths_alike = loop
    text, rows = Text("lanes"), _Rows()
    formulas = Formulas(text, equations)
    n, m, parameters = len(equations.state), len(equations.measured), len(equations.parameters)
    numba = language == "numba"
    watch = _Watch(formulas, watched, moving)
    inner = f"range({LANES})" if numba else "(slice(None),)"

    def lanes() -> Any:
        return text.over(inner)

    def load(letter: str, count: int, row: str | None = None) -> None:
        for k in range(count):
            text.assign(f"{letter}{k}", rows[f"{row or letter}{k}"])

    def keep(letter: str, count: int) -> None:
        for k in range(count):
            text.store(rows[f"{letter}{k}"], f"{letter}{k}")

    def gather(row: str, array: str, column: int, index: str, count: int) -> None:
        for k in range(count):
            text.store(rows[f"{row}{k}"], f"{array}[which[i, {column}], {index}, {k}]")

    def gather_known(row: str, index: str) -> None:
        gather(row, "known", 2, index, parameters)

    def look(place: int) -> None:
        """Name what is known at one of a step's instants."""
        load("y", m, f"y_{place}_" if held else None)
        load("p", parameters, f"p_{place}_" if varying else None)

    def inputs() -> None:
        load("g", len(equations.gains))
        for name in formulas.fixed.values():
            text.assign(name.name, rows[name.name])

    def replace(condition: str, values: str) -> None:
        for k in range(n):
            text.assign(f"s{k}", f"where({condition}, {values}{k}, s{k})")

    def correct(values: list[str]) -> None:
        """The updates by samples that arrive, one output after the other; NaN corrects nothing."""
        for k, block in enumerate(formulas.update):
            text.assign("sample", values[k])
            text.assign("there", "sample == sample")
            text.assign(f"y{k}", f"where(there, sample, y{k})")
            text.copy("x", "s", n)
            text.formulas(block, "n")
            replace("there", "n")

    def look_whether_off() -> None:
        """Whether a reset is due in one of the lanes, or a state is no longer finite."""
        if equations.reset:
            text.copy("x", "s", n)
            text.assign("off", f"off | {text.print(formulas.condition)}")
        text.assign("size", formulas.size)
        text.assign("lost", f"where(size < {LARGEST_SQUARED_STATE!r}, False, {rows['alive']} > 0.0)")
        text.assign("off", "off | lost")

    def reset() -> None:
        """The reset where it is due, and whether the state is still finite."""
        text.assign("alive", rows["alive"])
        if equations.reset:
            text.copy("x", "s", n)
            text.assign("due", text.print(formulas.condition))
            text.formulas(formulas.reset, "n")
            replace("due", "n")
            text.store(rows["resets"], f"{rows['resets']} + where(due, alive, 0.0)")
        text.assign("size", formulas.size)
        text.assign("finite", f"size < {LARGEST_SQUARED_STATE!r}")
        text.assign("now_lost", "where(finite, 0.0, alive)")
        text.store(rows["diverged"], f"where(now_lost > 0.0, k + 1.0, {rows['diverged']})")
        text.store(rows["alive"], "where(finite, alive, 0.0)")

    def arrive(sample: str) -> None:
        """The truth at a sample, and the sample, NaN where there is none."""
        if truths_alike:
            for k in range(len(watched.truth)):
                text.assign(f"t{k}", f"truth[0, {sample}, {k}]")
        elif moving is None:
            with lanes():
                gather("t", "truth", 1, sample, len(watched.truth))
        if noises_alike:
            for k in range(m):
                text.assign(f"u{k}", f"noise[0, {sample}, {k}]")
        else:
            with lanes():
                gather("u", "noise", 0, sample, m)
        with lanes():
            if moving is not None:
                move(moving, sample)
            if not truths_alike:
                load("t", len(watched.truth))
            if not noises_alike:
                load("u", m)
            seen = " & ".join(f"(abs(t{k}) <= reach)" for k in range(len(watched.truth) - 1))
            text.assign("seen", seen)
            for k, place in enumerate(watched.measured):
                text.assign("sample", f"where(seen, t{place} + u{k}, math.nan)")
                if equations.update:
                    text.store(rows[f"v{k}"], "sample")
                if not equations.update or sample == "0":
                    text.store(rows[f"y{k}"], f"where(sample == sample, sample, {rows[f'y{k}']})")

    def move(moving: Moving, sample: str) -> None:
        """Move the point to the next sample, look at it, and remember how near it came and how fast."""
        point = len(moving.point)
        load("m", point)
        if sample != "0":
            for k in range(point):
                row = [rows[f"m{point + (point + 1) * k + j}"] for j in range(point + 1)]
                text.assign(f"X{k}", " + ".join(f"{row[j]}*m{j}" for j in range(point)) + f" + {row[point]}")
            text.copy("m", "X", point)
            keep("m", point)
        for k in range(len(moving.shape)):
            text.assign(f"w{k}", rows[f"m{point * (point + 2) + k}"])
        text.formulas(watch.coordinates, "t")
        keep("t", len(watched.truth))
        text.assign("distance", f"t{len(watched.truth)}")
        if sample != "0":
            text.assign("drop", f"abs(distance - {rows['distance']})")
            text.store(rows["drop"], f"where(drop > {rows['drop']}, drop, {rows['drop']})")
        text.store(rows["nearest"], f"where(distance >= {rows['nearest']}, {rows['nearest']}, distance)")
        text.store(rows["distance"], "distance")

    def look_at(sample: str) -> None:
        """What is counted at a sample."""
        with lanes():
            load("s", n)
            load("y", m)
            load("p", parameters, f"p_{EACH if sample != '0' else 0}_" if varying else None)
            inputs()
            if not truths_alike:
                load("t", len(watched.truth))
            load("v", len(watched.samples))
            text.assign("now", f"elapsed[{sample}]")
            text.copy("x", "s", n)
            if watched.begun:
                if sample == "0":
                    text.formulas(watch.first, "b")
                    for expression, symbol in watch.fixed.items():
                        text.store(rows[symbol.name], text.print(expression))
                load("r", len(watch.fixed))
            text.assign("alive", rows["alive"])
            watch.count(rows, sample)

    with text.function("run", ARGUMENTS):
        head = len(text.lines)
        with lanes():
            for letter, array, count in (("g", "gains", len(equations.gains)), ("s", "start", n)):
                for k in range(count):
                    text.assign(f"{letter}{k}", f"{array}[i, {k}]")
                    text.store(rows[f"{letter}{k}"], f"{letter}{k}")
            for expression, symbol in formulas.fixed.items():
                text.store(rows[symbol.name], text.print(expression))
            for k in range(m):
                text.store(rows[f"y{k}"], "0.0")
            for k in range(0 if moving is None else len(moving.point) * (len(moving.point) + 2) + len(moving.shape)):
                text.store(rows[f"m{k}"], f"moves[i, {k}]")
            gather_known("p_0_" if varying else "p", "0")
            begin = dict.fromkeys((*COUNTED, "alive"), "0.0")
            for name, value in (begin | {"outside": "-1.0", "nearest": "math.inf", "alive": "1.0"}).items():
                text.store(rows[name], value)
            for k in range(2 * len(watched.means)):
                text.store(rows[f"mean{k}"], "0.0")
        arrive("0")
        if equations.update:
            with lanes():
                for k in range(m):
                    text.store(rows[f"v{k}"], f"where(first[i, {k}] > 0.0, {rows[f'v{k}']}, math.nan)")
                load("s", n)
                load("y", m)
                load("p", parameters, "p_0_" if varying else None)
                inputs()
                correct([rows[f"v{k}"] for k in range(m)])
                keep("s", n)
        look_at("0")
        with text.loop("k", "lengths"):
            text.assign("h", "lengths[k]")
            text.assign("c", "arriving[k + 1]")
            if held or varying:
                with lanes():
                    for place in sorted({*PLACES, EACH}):
                        if held:
                            for j in range(m):
                                text.store(rows[f"y_{place}_{j}"], f"held[i, k, {place}, {j}]")
                        if varying:
                            gather_known(f"p_{place}_", f"{EACH}*k + {place}")
            text.assign("off", "False")
            with lanes():
                load("s", n)
                inputs()
                formulas.step(look)
                if not equations.update:
                    look_whether_off()
                keep("s", n)
            if equations.update:
                with text.block("if", "c >= 0"):
                    arrive("c")
                    with lanes():
                        load("s", n)
                        load("y", m)
                        load("p", parameters, f"p_{EACH}_" if varying else None)
                        inputs()
                        correct([rows[f"v{k}"] for k in range(m)])
                        keep("s", n)
                        keep("y", m)
                with lanes():
                    load("s", n)
                    inputs()
                    look_whether_off()
            with text.block("if", "some(off)"), lanes():  # resets are rare, and dear
                load("s", n)
                inputs()
                reset()
                keep("s", n)
            with text.block("if", "c >= 0"):
                if not equations.update:
                    arrive("c")
                look_at("c")
        names = (*COUNTED, *(f"mean{k}" for k in range(2 * len(watched.means))))
        with lanes():
            for k, name in enumerate(names):
                text.store(f"result[i, {k}]", rows[name])
    width = str(LANES) if numba else "len(start)"
    text.lines.insert(head, f"    work = np.empty(({len(rows.places)}, {width}))")
    return f"{inspect.getsource(vector_functions)}\n\n{text}" if numba else str(text)


class _Watch:
    """The lines that count what is watched."""

    def __init__(self, formulas: Formulas, watched: Watched, moving: Moving | None) -> None:
        self.text, self.watched = formulas.text, watched
        names = dict(formulas.names)
        names |= {symbol: sp.Symbol(f"t{k}", real=True) for k, symbol in enumerate(watched.truth)}
        names |= {symbol: sp.Symbol(f"b{k}", real=True) for k, symbol in enumerate(watched.begun)}
        names |= {symbol: sp.Symbol(f"v{k}", real=True) for k, symbol in enumerate(watched.samples)}
        names[watched.elapsed] = sp.Symbol("now", real=True)

        def renamed(expressions: tuple[sp.Basic, ...], names: dict[sp.Symbol, sp.Symbol] = names) -> list[sp.Basic]:
            found = [e.xreplace(names) for e in expressions]
            refuse_what_differs(found)
            return found

        lasting = {names[symbol] for symbol in (*watched.begun, *formulas.groups["g"])}
        self.fixed: dict[sp.Expr, sp.Symbol] = {}
        self.first = renamed(watched.first)
        looked_at = renamed((watched.error, *watched.means, *watched.judged, watched.hidden, watched.behind))
        self.values = [take_out(each, lasting, self.fixed, "r") for each in looked_at]
        if moving is not None:
            places = {s: sp.Symbol(f"m{k}", real=True) for k, s in enumerate(moving.point)}
            places |= {s: sp.Symbol(f"w{k}", real=True) for k, s in enumerate(moving.shape)}
            self.coordinates = renamed((*moving.coordinates, moving.distance), places)

    def count(self, rows: _Rows, sample: str) -> None:
        """Count what a sample tells; afterwards `late` tells from which sample on errors count."""
        text, watched = self.text, self.watched
        text.formulas(self.values, "e")
        text.assign("seen", "alive > 0.0")
        first = 1 + len(watched.means)
        hidden = first + len(watched.judged)
        if watched.hidden != sp.false:
            text.assign("seen", f"where(e{hidden}, False, seen)")
        text.assign("largest", f"e{first}")
        for k in range(first + 1, hidden):
            text.assign("largest", f"where(e{k} > largest, e{k}, largest)")
        if watched.behind != sp.false:
            text.assign("largest", f"where(e{hidden + 1}, math.inf, largest)")
        text.assign("largest", "where(seen, largest, math.nan)")
        text.assign("error", "where(seen, e0, math.nan)")
        text.store(rows["outside"], f"where(largest < tolerance, {rows['outside']}, {sample} + 0.0)")
        text.store(rows["judged"], "largest")
        text.store(rows["final"], "error")
        text.assign("counts", f"{sample} >= late")
        text.store(rows["squares"], f"{rows['squares']} + where(counts, error*error, 0.0)")
        text.store(rows["worst"], f"where(counts & (error > {rows['worst']}), error, {rows['worst']})")
        for k in range(len(watched.means)):
            text.assign("there", f"counts & (abs(e{1 + k}) < math.inf)")
            total, number = rows[f"mean{2 * k}"], rows[f"mean{2 * k + 1}"]
            text.store(total, f"{total} + where(there, e{1 + k}, 0.0)")
            text.store(number, f"{number} + where(there, 1.0, 0.0)")
