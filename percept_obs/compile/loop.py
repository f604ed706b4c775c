"""Text of the loop: one Runge-Kutta loop, written once, printed in Python and in JavaScript.

The loop is unrolled down to scalars, so that the Python text runs as it is and numba compiles the same text.
Whatever a user may want to move (motion, gains, noise, start) is an argument; only a new structure compiles.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache
from math import lcm

import sympy as sp

from percept_obs.compile.equations import Equations
from percept_obs.compile.integrator import COUPLING, EACH, LARGEST_SQUARED_STATE, PLACES, WEIGHTS
from percept_obs.compile.text import Printed, Text, refuse_what_differs

LAST = len(WEIGHTS) - 1
ARGUMENTS = ("start", "steps", "measured", "parameters", "samples", "gains", "varying", "states", "resets")


@lru_cache(maxsize=512)
def source(equations: Equations, language: Printed = "python") -> str:
    """Text of the loop for these equations, ``run(start, ..., resets)`` with `ARGUMENTS`, flat arrays as in `Table`.

    It fills states and resets, and returns the index of the row at which the state was no longer finite, or -1.  Raises
    NotCompilable for an expression that would not mean the same in both languages.
    """
    loop = _Loop(Text(language), equations)
    text, n, m = loop.text, len(equations.state), len(equations.measured)
    with text.function("run", ARGUMENTS):
        for k in range(n):
            text.assign(f"s{k}", f"start[{k}]")
        loop.load("g", "gains")
        loop.load("p", "parameters")
        for expression, symbol in loop.fixed.items():
            text.assign(symbol.name, text.print(expression))
        text.assign("row", "0")
        if m and text.python:
            text.assign("each", f"{EACH + 1} if len(measured) > {m}*len(steps) else 1")
        loop.update_by_samples()
        loop.keep()
        with text.loop("k", "steps"):
            text.assign("h", "steps[k]")
            loop.step(loop.load_known)
            loop.update_by_samples(f"{m}*(k + 1) + ")
            if equations.reset:
                text.copy("x", "s", n)
                with text.block("if", text.print(loop.condition)):
                    text.formulas(loop.reset, "s")
                    text.store("resets[k + 1]", "1.0")
            text.assign("size", loop.size)
            with text.block("unless", f"size < {LARGEST_SQUARED_STATE!r}"):
                text.leave("k + 1")
            text.assign("row", f"row + {n}")
            loop.keep()
        text.leave("-1")
    return str(text)


class Formulas:
    """Equations in the loop's names, and the lines of a step by the Runge-Kutta method.

    State k is s{k} between stages and x{k} in formulas; these use y{k}, p{k} and g{k} for measured outputs, parameters
    and gains.  Terms that depend on gains only are taken out of the loop, to `fixed`.
    """

    def __init__(self, text: Text, equations: Equations) -> None:
        self.text = text
        groups = {"x": equations.state, "y": equations.measured, "p": equations.parameters, "g": equations.gains}
        self.groups: dict[str, tuple[sp.Symbol, ...]] = groups
        self.names = {
            s: sp.Symbol(f"{letter}{k}", real=True) for letter, group in groups.items() for k, s in enumerate(group)
        }
        self.fixed: dict[sp.Expr, sp.Symbol] = {}
        self.flow, self.reset = self.prepared(equations.flow), self.prepared(equations.reset)
        self.update = [self.prepared(block) for block in equations.update]
        (self.condition,) = self.prepared([equations.reset_condition])
        self.size = " + ".join(f"s{k}*s{k}" for k in range(len(equations.state)))

    def prepared(self, expressions: Sequence[sp.Expr]) -> list[sp.Expr]:
        """Expressions in the loop's names, without terms that depend on gains only."""
        renamed = [e.xreplace(self.names) for e in expressions]
        refuse_what_differs(renamed)
        variables = tuple(self.names[symbol] for letter in "xy" for symbol in self.groups[letter])
        gains = {self.names[symbol] for symbol in self.groups["g"]}
        return [take_out(_nested(e, variables), gains, self.fixed) for e in renamed]

    def step(self, look: Callable[[int], None]) -> None:
        """Write a step of the length h; `look` loads the known signals at one of its instants."""
        for stage, place in enumerate(PLACES):
            if stage == 0 or place != PLACES[stage - 1]:
                look(place)
            self._stage(stage)
        if PLACES[-1] != EACH:
            look(EACH)
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


class _Loop(Formulas):
    """The lines of the loop around a step."""

    def load(self, letter: str, array: str, rows: int = 0, row: int = 0) -> None:
        """Load a row of an array that has so many rows a step."""
        width = len(self.groups[letter])
        for k in range(width):
            first = f"{rows * width}*k + " if rows else ""
            self.text.assign(f"{letter}{k}", f"{array}[{first}{row * width + k}]")

    def load_outputs(self, instant: int) -> None:
        """Load the measured outputs at one of a step's instants, where Python's table may have one instant a step."""
        m = len(self.groups["y"])
        for k in range(m):
            self.text.assign(f"y{k}", f"measured[{m}*(each*k + {instant}) + {k}]")

    def load_known(self, instant: int) -> None:
        """Load all that is known at one of a step's instants."""
        if not self.text.python:  # the page's table has every instant
            self.load("y", "measured", EACH + 1, instant)
        elif instant == 0:
            self.load_outputs(0)
        elif self.groups["y"]:
            with self.text.block("if", "each > 1"):
                self.load_outputs(instant)
        if self.groups["p"]:
            with self.text.block("if", "varying"):
                self.load("p", "parameters", EACH, instant)

    def update_by_samples(self, first: str = "") -> None:
        """Update by each sample that is there, one output after the other."""
        for k, block in enumerate(self.update):
            value = f"samples[{first}{k}]"
            with self.text.block("if", f"{value} == {value}"):  # not NaN
                self.text.assign(f"y{k}", value)
                self.text.copy("x", "s", len(self.flow))
                self.text.formulas(block, "s")

    def keep(self) -> None:
        """Store the state in its row."""
        for k in range(len(self.flow)):
            self.text.store(f"states[row + {k}]" if k else "states[row]", f"s{k}")


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

    if not expression.args or not expression.free_symbols & gains:
        return expression
    if isinstance(expression, sp.Expr) and expression.free_symbols <= gains:
        return named(expression)
    if isinstance(expression, sp.Mul | sp.Add):
        constant = [e for e in expression.args if e.free_symbols and e.free_symbols <= gains]
        if len(constant) > 1:
            rest = [e for e in expression.args if e not in constant]
            expression = expression.func(named(expression.func(*constant)), *rest)
    return expression.func(*(take_out(e, gains, fixed, letter) for e in expression.args))
