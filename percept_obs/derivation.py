"""A derivation: sentences and formulas, shown one after the other."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp


@dataclass(frozen=True)
class Step:
    """One step of a derivation: why, and what follows."""

    reason: str
    formula: str

    def __str__(self) -> str:
        return f"{self.reason}\n    {self.formula}"


@dataclass(frozen=True)
class Derivation:
    """Steps that a notebook shows as text and formulas, and that print as text."""

    steps: tuple[Step, ...]

    def __str__(self) -> str:
        return "\n".join(f"{k}. {step}" for k, step in enumerate(self.steps, 1))

    def _repr_markdown_(self) -> str:
        return "\n\n".join(f"{k}. {s.reason}\n\n   $$ {s.formula} $$" for k, s in enumerate(self.steps, 1))


def equals(left: str, right: object) -> str:
    """The formula ``left = right`` in LaTeX, the right side printed by sympy."""
    return f"{left} = {right if isinstance(right, str) else sp.latex(right)}"
