"""The loop's text: one Runge-Kutta loop, written once, printed in Python and in JavaScript.

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
    """Text of the loop for these equations.

    Parameters
    ----------
    equations : Equations
    language : "python" or "javascript"

    Returns
    -------
    str
        A function ``run(start, steps, measured, parameters, samples, gains, varying, states, resets)`` on flat
        arrays laid out as in `Table`.  It fills states and resets, and returns the index of the row at
        which the state was no longer finite, or -1.

    Raises
    ------
    NotCompilable
        If an expression would not mean the same in both languages.
    """
    n, m = len(equations.state), len(equations.measured)
    text = Text(language)
    formulas = Formulas(text, equations)

    def load(letter: str, array: str, rows: int = 0, row: int = 0) -> None:
        """Load a row of an array that has so many rows a step."""
        wide = len(formulas.groups[letter])
        for k in range(wide):
            first = f"{rows * wide}*k + " if rows else ""
            text.assign(f"{letter}{k}", f"{array}[{first}{row * wide + k}]")

    def load_outputs(instant: int) -> None:
        for k in range(m):
            text.assign(f"y{k}", f"measured[{m}*(each*k + {instant}) + {k}]")

    def look(instant: int) -> None:
        """Load what is known at one of a step's instants."""
        if not text.python:  # the page lays out every instant
            load("y", "measured", EACH + 1, instant)
        elif instant == 0:
            load_outputs(0)
        elif m:
            with text.block("if", "each > 1"):
                load_outputs(instant)
        if equations.parameters:
            with text.block("if", "varying"):
                load("p", "parameters", EACH, instant)

    def update_by_samples(first: str = "") -> None:
        for k, block in enumerate(formulas.update):
            value = f"samples[{first}{k}]"
            with text.block("if", f"{value} == {value}"):
                text.assign(f"y{k}", value)
                text.copy("x", "s", n)
                text.formulas(block, "s")

    def keep() -> None:
        for k in range(n):
            text.store(f"states[row + {k}]" if k else "states[row]", f"s{k}")

    with text.function("run", ARGUMENTS):
        for k in range(n):
            text.assign(f"s{k}", f"start[{k}]")
        load("g", "gains")
        load("p", "parameters")
        for expression, symbol in formulas.fixed.items():
            text.assign(symbol.name, text.print(expression))
        text.assign("row", "0")
        if m and text.python:
            text.assign("each", f"{EACH + 1} if len(measured) > {m}*len(steps) else 1")
        update_by_samples()
        keep()
        with text.loop("k", "steps"):
            text.assign("h", "steps[k]")
            formulas.step(look)
            update_by_samples(f"{m}*(k + 1) + ")
            if equations.reset:
                text.copy("x", "s", n)
                with text.block("if", text.print(formulas.condition)):
                    text.formulas(formulas.reset, "s")
                    text.store("resets[k + 1]", "1.0")
            text.assign("size", formulas.size)
            with text.block("unless", f"size < {LARGEST_SQUARED_STATE!r}"):
                text.leave("k + 1")
            text.assign("row", f"row + {n}")
            keep()
        text.leave("-1")
    return str(text)


class Formulas:
    """The equations in the loop's names, and the lines of a step by the Runge-Kutta method.

    State k is s{k} between stages and x{k} in formulas; these use y{k}, p{k} and g{k} for measured outputs, parameters
    and gains.  What depends on gains only is taken out, to `fixed`.
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
        """The expressions in the loop's names, with what depends on gains only taken out."""
        renamed = [e.xreplace(self.names) for e in expressions]
        refuse_what_differs(renamed)
        variables = tuple(self.names[symbol] for letter in "xy" for symbol in self.groups[letter])
        gains = {self.names[symbol] for symbol in self.groups["g"]}
        return [take_out(_nested(e, variables), gains, self.fixed) for e in renamed]

    def step(self, look: Callable[[int], None]) -> None:
        """A step of the length h, with what loads the known signals at one of its instants."""
        for stage, place in enumerate(PLACES):
            if stage == 0 or place != PLACES[stage - 1]:
                look(place)
            self._visit(stage)
        if PLACES[-1] != EACH:
            look(EACH)
        self.text.assign("part", _shared(WEIGHTS))
        for k in range(len(self.flow)):
            self.text.assign(f"s{k}", f"s{k} + part*({_gathered(LAST, k)})")

    def _visit(self, stage: int) -> None:
        """Assign the rates at a stage, and gather them for the step."""
        shares, n = COUPLING[stage], len(self.flow)
        if any(shares):
            self.text.assign("part", _shared(shares))
        for k in range(n):
            rates = " + ".join(_times(shares, j, k) for j, share in enumerate(shares) if share)
            self.text.assign(f"x{k}", f"s{k} + part*({rates})" if rates else f"s{k}")
        self.text.formulas(self.flow, f"d{stage}_")
        for k in range(n if WEIGHTS[stage] and stage < LAST else 0):
            self.text.assign(f"q{k}", _gathered(stage, k))


def _shared(shares: Sequence[Fraction]) -> str:
    """The step over the common denominator of shares of it."""
    return f"h/{lcm(*(share.denominator for share in shares))}.0"


def _times(shares: Sequence[Fraction], stage: int, k: int) -> str:
    """The rate of state k at a stage, times the numerator of its share."""
    numerator = shares[stage] * lcm(*(share.denominator for share in shares))
    return f"d{stage}_{k}" if numerator == 1 else f"{numerator}.0*d{stage}_{k}"


def _gathered(stage: int, k: int) -> str:
    """The sum of the rates of state k up to a stage, by their weights."""
    return (f"q{k} + " if any(WEIGHTS[:stage]) else "") + _times(WEIGHTS, stage, k)


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
    """Replace the parts that depend on gains only by names with a letter, which `fixed` collects."""

    def named(part: sp.Expr) -> sp.Symbol:
        return fixed.setdefault(part, sp.Symbol(f"{letter}{len(fixed)}", real=True))

    if not expression.args or not expression.free_symbols & gains:
        return expression
    if isinstance(expression, sp.Expr) and expression.free_symbols <= gains:
        return named(expression)
    if isinstance(expression, sp.Mul | sp.Add):
        fixed_parts = [e for e in expression.args if e.free_symbols and e.free_symbols <= gains]
        if len(fixed_parts) > 1:
            rest = [e for e in expression.args if e not in fixed_parts]
            expression = expression.func(named(expression.func(*fixed_parts)), *rest)
    return expression.func(*(take_out(e, gains, fixed, letter) for e in expression.args))
