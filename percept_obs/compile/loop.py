"""The loop that integrates equations: described once, and written for one run in Python and in JavaScript.

The loop is unrolled down to scalars, so that the Python text runs as it is and numba compiles the same text.
Whatever a user may want to move (motion, gains, noise, start) is an argument; only a new structure compiles.
For many runs side by side `percept_obs.compile.batch` writes it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import nullcontext
from fractions import Fraction
from functools import lru_cache
from math import lcm

import sympy as sp

from percept_obs.compile.equations import Equations, Symbols
from percept_obs.compile.integrator import COUPLING, EACH, LARGEST_SQUARED_STATE, PLACES, WEIGHTS
from percept_obs.compile.text import Printed, Text, refuse_what_differs

LAST = len(WEIGHTS) - 1
SMALL = f"size < {LARGEST_SQUARED_STATE!r}"


@lru_cache(maxsize=512)
def source(equations: Equations, language: Printed = "python") -> str:
    """Text of the loop for these equations, ``run(start, ..., resets)``, of flat arrays as in `Table`.

    It fills states and resets, and returns the index of the row at which the state was no longer finite, or -1.  Raises
    NotCompilable for an expression that would not mean the same in both languages.
    """
    return Loop(Text(language), equations).written()


class Loop:
    """The loop, as it is written for one run over flat arrays; a batch of runs extends it.

    State k is s{k} between stages and x{k} in formulas; these use y{k}, p{k} and g{k} for measured outputs, parameters
    and gains.  Terms that depend on gains only are taken out of the loop, to `fixed`.
    """

    arguments = "start, steps, measured, parameters, samples, gains, varying, states, resets"
    lengths = "steps"  # the argument that has the length of each step

    def __init__(self, text: Text, equations: Equations) -> None:
        self.text, self.equations = text, equations
        groups = {"x": equations.state, "y": equations.measured, "p": equations.parameters, "g": equations.gains}
        self.count = {letter: len(group) for letter, group in groups.items()}
        self.names = {s: name for letter, group in groups.items() for s, name in numbered(letter, group).items()}
        self.fixed: dict[sp.Expr, sp.Symbol] = {}
        self.flow, self.after_reset = self.prepared(equations.flow), self.prepared(equations.reset)
        self.updates = [self.prepared(block) for block in equations.update]
        (self.condition,) = self.prepared([equations.reset_condition])

    def prepared(self, expressions: Sequence[sp.Expr]) -> list[sp.Expr]:
        """Expressions in the loop's names, without terms that depend on gains only."""
        variables = tuple(self.names[symbol] for symbol in (*self.equations.state, *self.equations.measured))
        gains = {self.names[symbol] for symbol in self.equations.gains}
        return [take_out(_nested(e, variables), gains, self.fixed) for e in renamed(expressions, self.names)]

    def written(self) -> str:
        """Write the loop."""
        text = self.text
        with text.function("run", self.arguments):
            self.begin()
            self.take_samples("0")
            self.keep("0")
            with text.loop("k", self.lengths):
                text.assign("h", f"{self.lengths}[k]")
                self.step()
                self.take_samples("k + 1")
                self.reset()
                self.keep("k + 1")
            self.end()
        return str(text)

    def begin(self) -> None:
        """Load what the arguments hold, and compute what depends on gains only."""
        m = self.count["y"]
        self.load("x", "start[{}]", to="s")
        self.load("g", "gains[{}]")
        self.load("p", "parameters[{}]")
        self.fix(self.fixed)
        self.text.assign("row", "0")
        if m and self.text.python:
            self.text.assign("each", f"{EACH + 1} if len(measured) > {m}*len(steps) else 1")

    def look(self, instant: int) -> None:
        """Load the known signals at one of a step's instants."""
        text, m, p = self.text, self.count["y"], self.count["p"]
        if not text.python:  # the page's table has every instant
            self.load("y", f"measured[{(EACH + 1) * m}*k + {{}}]", first=instant * m)
        elif m:
            with text.block("if", "each > 1") if instant else nullcontext():
                self.load("y", f"measured[{m}*(each*k + {instant}) + {{}}]")
        if p:
            with text.block("if", "varying"):
                self.load("p", f"parameters[{EACH * p}*k + {{}}]", first=instant * p)

    def load(self, letter: str, place: str, first: int = 0, to: str = "") -> None:
        """Load numbers by their letter, or to another, from places {}, counted from the first one."""
        for k in range(self.count[letter]):
            self.text.assign(f"{to or letter}{k}", place.format(first + k))

    def fix(self, terms: Mapping[sp.Expr, sp.Symbol]) -> None:
        """Compute terms that `take_out` has taken out."""
        for expression, symbol in terms.items():
            self.text.assign(symbol.name, self.text.print(expression))

    def step(self) -> None:
        """Write a step of the length h by the Runge-Kutta method."""
        for stage, place in enumerate(PLACES):
            if stage == 0 or place != PLACES[stage - 1]:
                self.look(place)
            self._stage(stage)
        if PLACES[-1] != EACH:
            self.look(EACH)
        self.text.assign("part", _shared(WEIGHTS))
        for k in range(len(self.flow)):
            self.text.assign(f"s{k}", f"s{k} + part*({_summed(LAST, k)})")

    def _stage(self, stage: int) -> None:
        """Assign the rates at a stage, and add them up for the step."""
        shares, n = COUPLING[stage], len(self.flow)
        if any(shares):
            self.text.assign("part", _shared(shares))
        for k in range(n):
            rates = " + ".join(_scaled(shares, j, k) for j, share in enumerate(shares) if share)
            self.text.assign(f"x{k}", f"s{k} + part*({rates})" if rates else f"s{k}")
        self.text.formulas(self.flow, f"d{stage}_")
        for k in range(n if WEIGHTS[stage] and stage < LAST else 0):
            self.text.assign(f"q{k}", _summed(stage, k))

    def take_samples(self, end: str) -> None:
        """Update at the end of a step, counted from 1, or at the first start, 0."""
        self.update("samples[{}]" if end == "0" else f"samples[{self.count['y']}*({end}) + {{}}]")

    def update(self, sample: str) -> None:
        """Update by each sample that is there, one output after the other."""
        for k, block in enumerate(self.updates):
            value = sample.format(k)
            with self.text.only(f"{value} == {value}"):  # not NaN
                self.text.replace(f"y{k}", value)
                self.load("x", "s{}")
                self.text.formulas(block, "s")

    def reset(self) -> None:
        """Reset where it is due, and compute the squared norm of the state."""
        if self.equations.reset:
            self.load("x", "s{}")
            with self.text.only(self.text.print(self.condition)):
                self.text.formulas(self.after_reset, "s")
                self.note_reset()
        self.measure()

    def note_reset(self) -> None:
        """Note that the state was reset."""
        self.text.store("resets[k + 1]", "1.0")

    def keep(self, end: str) -> None:
        """Store the state in its row, if it is finite."""
        n = self.count["x"]
        if end != "0":
            with self.text.block("unless", SMALL):
                self.text.leave(end)
            self.text.assign("row", f"row + {n}")
        for k in range(n):
            self.text.store(f"states[row + {k}]" if k else "states[row]", f"s{k}")

    def end(self) -> None:
        """Return."""
        self.text.leave("-1")

    def measure(self) -> None:
        """Compute the squared norm of the state."""
        self.text.assign("size", " + ".join(f"s{k}*s{k}" for k in range(self.count["x"])))


def _shared(shares: Sequence[Fraction]) -> str:
    """The step h over the common denominator of shares."""
    return f"h/{lcm(*(share.denominator for share in shares))}.0"


def _scaled(shares: Sequence[Fraction], stage: int, k: int) -> str:
    """Rate of state k at a stage, times the numerator of its share."""
    numerator = shares[stage] * lcm(*(share.denominator for share in shares))
    return f"d{stage}_{k}" if numerator == 1 else f"{numerator}.0*d{stage}_{k}"


def _summed(stage: int, k: int) -> str:
    """Weighted sum of the rates of state k up to a stage."""
    return (f"q{k} + " if any(WEIGHTS[:stage]) else "") + _scaled(WEIGHTS, stage, k)


@lru_cache(maxsize=4096)
def _nested(expression: sp.Basic, variables: tuple[sp.Symbol, ...]) -> sp.Basic:
    """Nest sums as in Horner's scheme: the variable that most terms share is multiplied last."""
    if not isinstance(expression, sp.Add):
        inner = tuple(_nested(e, variables) for e in expression.args)
        return expression if inner == expression.args else expression.func(*inner)
    sharing: dict[sp.Basic, set[int]] = {v: set() for v in variables}
    for k, term in enumerate(expression.args):
        for base, power in term.as_powers_dict().items():
            if base in sharing and power.is_Integer and power > 0:
                sharing[base].add(k)
    shared = max(variables, key=lambda v: len(sharing[v]), default=None)
    if shared is None or len(sharing[shared]) < 2:
        return sp.Add(*(_nested(term, variables) for term in expression.args))
    inside = sp.Add(*(expression.args[k] / shared for k in sorted(sharing[shared])))
    outside = sp.Add(*(term for k, term in enumerate(expression.args) if k not in sharing[shared]))
    return shared * _nested(inside, variables) + _nested(outside, variables)


def take_out(
    expression: sp.Basic, gains: set[sp.Symbol], fixed: dict[sp.Expr, sp.Symbol], letter: str = "f"
) -> sp.Basic:
    """Replace terms that depend on gains only by names with a letter, and add these to `fixed`."""

    def named(term: sp.Expr) -> sp.Symbol:
        return fixed.setdefault(term, sp.Symbol(f"{letter}{len(fixed)}", real=True))

    if not expression.args or not _symbols(expression) & gains:
        return expression
    if isinstance(expression, sp.Expr) and _symbols(expression) <= gains:
        return named(expression)
    if isinstance(expression, sp.Mul | sp.Add):
        constant = [e for e in expression.args if _symbols(e) and _symbols(e) <= gains]
        if len(constant) > 1:
            rest = [e for e in expression.args if e not in constant]
            expression = expression.func(named(expression.func(*constant)), *rest)
    return expression.func(*(take_out(e, gains, fixed, letter) for e in expression.args))


@lru_cache(maxsize=10_000)
def _symbols(expression: sp.Basic) -> frozenset[sp.Basic]:
    """Symbols of an expression, from those of its parts, which recur."""
    return frozenset({expression} if expression.is_Symbol else ()).union(*map(_symbols, expression.args))


def numbered(letter: str, symbols: Symbols) -> dict[sp.Symbol, sp.Symbol]:
    """Names of symbols in the loop: a letter and a number."""
    return {symbol: sp.Symbol(f"{letter}{k}", real=True) for k, symbol in enumerate(symbols)}


def renamed(expressions: Iterable[sp.Basic], names: Mapping[sp.Symbol, sp.Symbol]) -> list[sp.Basic]:
    """Expressions with other names of their symbols; NotCompilable if they would not mean the same everywhere."""
    found = [expression.xreplace(dict(names)) for expression in expressions]
    refuse_what_differs(found)
    return found
