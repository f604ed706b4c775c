"""A system of equations that can be stepped through time: flow, measurement update, reset."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property

import sympy as sp
from sympy.logic.boolalg import Boolean

from percept_obs.compile.intermediate import definitions
from percept_obs.validation import derived, iterable, refuse_names, set_fields, travels

Symbols = tuple[sp.Symbol, ...]
Expressions = tuple[sp.Expr, ...]


@travels
@dataclass(frozen=True)
class Equations:
    """Equations of a state between samples, at samples, and at resets.

    A ValueError says if an expression uses a symbol that is not listed, a symbol is listed twice, or lengths do not
    match.
    """

    state: Symbols
    flow: Expressions  # its time derivative
    measured: Symbols = ()
    parameters: Symbols = ()  # of the known motion and surface
    gains: Symbols = ()  # constants in the expressions
    update: tuple[Expressions, ...] = ()  # the state after the sample of each measured output; these take turns
    reset_condition: Boolean = sp.false  # when `reset` replaces the state; looked at between steps
    reset: Expressions = ()

    def __post_init__(self) -> None:
        names = ("state", "flow", "measured", "parameters", "gains", "reset")
        set_fields(self, **{name: derived(getattr(self, name), f"the equations' {name}") for name in names})
        set_fields(self, update=tuple(derived(block, "an update") for block in iterable(self.update, "update")))
        listed = (*self.state, *self.measured, *self.parameters, *self.gains)
        refuse_names(listed, "the equations")
        if len({symbol.name for symbol in listed}) != len(listed):
            raise ValueError(f"a symbol is listed twice among {', '.join(map(str, listed))}")
        blocks = (self.flow, *self.update, *((self.reset,) if self.reset else ()))
        if any(len(block) != len(self.state) for block in blocks):
            raise ValueError(f"flow, updates and reset need one expression for each of the {len(self.state)} states")
        if self.update and len(self.update) != len(self.measured):
            raise ValueError(f"{len(self.update)} updates were given for {len(self.measured)} measured outputs")
        used = sp.Tuple(*(e for block in blocks for e in block), self.reset_condition).free_symbols
        if used - set(listed):
            raise ValueError(f"the equations use {sorted(map(str, used - set(listed)))}, which nothing provides")

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        """Hash, which every run looks up and which takes long."""
        return hash(tuple(getattr(self, field.name) for field in fields(self)))

    def xreplace(self, rule: Mapping[sp.Basic, sp.Basic]) -> Equations:
        """Replace symbols in flow, updates, reset condition and reset."""
        return replace(
            self,
            flow=tuple(entry.xreplace(rule) for entry in self.flow),
            update=tuple(tuple(entry.xreplace(rule) for entry in block) for block in self.update),
            reset_condition=self.reset_condition.xreplace(rule),
            reset=tuple(entry.xreplace(rule) for entry in self.reset),
        )

    def _repr_latex_(self) -> str:
        lines = [rf"\dot{{{sp.latex(s)}}} &= {sp.latex(rate)}" for s, rate in zip(self.state, self.flow, strict=True)]
        for output, block in zip(self.measured, self.update, strict=False):
            lines += [
                rf"{sp.latex(s)}^+ &= {sp.latex(new)} \quad \text{{at a sample of }} {sp.latex(output)}"
                for s, new in zip(self.state, block, strict=True)
            ]
        if self.reset:
            before, after = zip(*((s, e) for s, e in zip(self.state, self.reset, strict=True) if e != s), strict=True)
            old, new = _stacked(before), _stacked(after)
            factors = {e / s for s, e in zip(before, after, strict=True)}
            if len(factors) == 1 and len(before) > 1:
                new = sp.MatMul(factors.pop(), old)
            when = sp.latex(self.reset_condition)
            lines.append(rf"{sp.latex(old)}^+ &= {sp.latex(new)} \quad \text{{when }} {when}")
        known = definitions((*self.flow, *self.reset, *(entry for block in self.update for entry in block)))
        lines += [f"{sp.latex(letter)} &= {sp.latex(value)}" for letter, value in known.items()]
        return r"$\displaystyle \begin{aligned}" + r" \\ ".join(lines) + r"\end{aligned}$"


def _stacked(expressions: Expressions) -> sp.Basic:
    """Column of several expressions, or the only one itself."""
    return expressions[0] if len(expressions) == 1 else sp.ImmutableMatrix(expressions)
