"""A derivation: sentences and formulas, shown one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, overload

import sympy as sp

from percept_obs.compile import definitions


@dataclass(frozen=True)
class Step:
    """One step of a derivation: why, and what follows.

    Parameters
    ----------
    reason, formula : str
        Why, and the formula in LaTeX.
    values : mapping of names to expressions
        What the step finds, so that it can be compared with somebody else's.
    follows : function of a list of values, optional
        For `onward`; linear in each of the values.
    """

    reason: str
    formula: str
    values: Mapping[str, sp.Expr] = field(default_factory=dict, hash=False)
    follows: Callable[[Sequence[sp.Expr]], sp.ImmutableMatrix] | None = field(default=None, compare=False)

    @property
    def leads_on(self) -> bool:
        """Whether it is known what follows from the step."""
        return self.follows is not None

    def onward(self, values: Sequence[sp.Expr]) -> sp.ImmutableMatrix:
        """The result of the whole derivation, a column, if this step had found these values instead.

        Raises
        ------
        ValueError
            If it is not known what follows from the step.
        """
        if self.follows is None:
            raise ValueError(f"it is not known what follows from {self.reason!r}; ask `leads_on` first")
        return self.follows(values)

    def __str__(self) -> str:
        return f"{self.reason}\n    {self.formula}"


@dataclass(frozen=True)
class Derivation(Sequence[Step]):
    """A sequence of steps that a notebook shows as text and formulas, and that prints as text; a slice is one too."""

    steps: tuple[Step, ...]

    @classmethod
    def of(cls, formulas: Mapping[str, str | tuple[Any, ...]]) -> Derivation:
        """A derivation of formulas by their reasons; a formula may come with what its step finds."""
        return cls(tuple(Step(why, *([part] if isinstance(part, str) else part)) for why, part in formulas.items()))

    @overload
    def __getitem__(self, index: int) -> Step: ...
    @overload
    def __getitem__(self, index: slice) -> Derivation: ...
    def __getitem__(self, index: int | slice) -> Step | Derivation:
        return Derivation(self.steps[index]) if isinstance(index, slice) else self.steps[index]

    def __len__(self) -> int:
        return len(self.steps)

    def __str__(self) -> str:
        return "\n".join(f"{k}. {step}" for k, step in enumerate(self, 1))

    def _repr_markdown_(self) -> str:
        # No list and nothing indented: four spaces make code of a formula, and front ends differ in how a list goes on.
        return "\n\n".join(f"**{k}.** {s.reason}\n\n$$ {s.formula} $$" for k, s in enumerate(self, 1))


def rates(symbols: Iterable[sp.Symbol], values: Iterable[sp.Expr]) -> dict[str, sp.Expr]:
    """Values by the names of the symbols whose rates they are: y1' for y1."""
    return {f"{symbol.name}'": value for symbol, value in zip(symbols, values, strict=True)}


def equals(left: str, right: object) -> str:
    """The formula ``left = right`` in LaTeX, the right side printed by sympy."""
    return f"{left} = {right if isinstance(right, str) else sp.latex(right)}"


def where(*expressions: sp.Basic) -> list[str]:
    """In LaTeX, what the intermediate results are whose letters expressions carry: a formula for each."""
    return [equals(sp.latex(letter), value) for letter, value in definitions(expressions).items()]


def joined(formulas: Iterable[str]) -> str:
    """Formulas in LaTeX side by side."""
    return r",\quad ".join(formulas)
