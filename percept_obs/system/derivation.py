"""A derivation: sentences and formulas, shown one after the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import overload

import sympy as sp


@dataclass(frozen=True)
class Step:
    """One step of a derivation: why, and what follows."""

    reason: str
    formula: str

    def __str__(self) -> str:
        return f"{self.reason}\n    {self.formula}"


@dataclass(frozen=True)
class Derivation(Sequence[Step]):
    """A sequence of steps that a notebook shows as text and formulas, and that prints as text; a slice is one too."""

    steps: tuple[Step, ...]

    @classmethod
    def of(cls, formulas: Mapping[str, str]) -> Derivation:
        """A derivation of formulas by their reasons."""
        return cls(tuple(Step(reason, formula) for reason, formula in formulas.items()))

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


def equals(left: str, right: object) -> str:
    """The formula ``left = right`` in LaTeX, the right side printed by sympy."""
    return f"{left} = {right if isinstance(right, str) else sp.latex(right)}"
