"""Derivations: sentences and formulas, one step after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, overload

import sympy as sp

from percept_obs.compile import definitions
from percept_obs.validation import checked

__all__ = ["Derivation", "Step"]


@checked
@dataclass(frozen=True)
class Step:
    """Step of a derivation: a reason and a formula.

    Parameters
    ----------
    reason, formula : str
        A sentence, and the formula in LaTeX.
    values : mapping of names to expressions
        Results of the step, to be compared with somebody else's.
    follows : function of a list of values, optional
        Result of the whole derivation from this step's values, linear in each of them.

    See Also
    --------
    Derivation : All steps.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> derivation = PerspectiveSystem(affine(), pinhole()).derivation()
    >>> derivation[-2].reason, derivation[-2].values["y3'"]
    ('Multiplied out:', -a31*y1*y3 - a32*y2*y3 - a33*y3 - b3*y3**2)
    """

    reason: str
    formula: str
    values: Mapping[str, sp.Expr] = field(default_factory=dict, hash=False)
    follows: Callable[[Sequence[sp.Expr]], sp.ImmutableMatrix] | None = field(default=None, compare=False)

    @property
    def leads_on(self) -> bool:
        """True if `onward` can compute the result from other values of this step."""
        return self.follows is not None

    def onward(self, values: Sequence[sp.Expr]) -> sp.ImmutableMatrix:
        """Return the result of the whole derivation, a column, if this step had other values; see `leads_on`."""
        if self.follows is None:
            raise ValueError(f"it is not known what follows from {self.reason!r}; ask `leads_on` first")
        return self.follows(values)

    def __str__(self) -> str:
        return f"{self.reason}\n    {self.formula}"


@checked
@dataclass(frozen=True)
class Derivation(Sequence[Step]):
    """Sequence of steps, shown as text and formulas in a notebook; a slice is a derivation, too.

    Parameters
    ----------
    steps : tuple of Step

    See Also
    --------
    percept_obs.check : Compares one's own lines with it.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> derivation = PerspectiveSystem(affine(), pinhole()).derivation()
    >>> [sorted(step.values) for step in derivation[-2:]]
    [["y1'", "y2'", "y3'"], ['y1', 'y2']]
    """

    steps: tuple[Step, ...]

    @classmethod
    def of(cls, formulas: Mapping[str, str | tuple[Any, ...]]) -> Derivation:
        """Make a derivation of formulas by their reasons; a formula may come with `values` and `follows`."""
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
        # neither a list nor indented: four spaces make code of a formula, and front ends continue lists differently
        return "\n\n".join(f"**{k}.** {s.reason}\n\n$$ {s.formula} $$" for k, s in enumerate(self, 1))


def rates(symbols: Iterable[sp.Symbol], values: Iterable[sp.Expr]) -> dict[str, sp.Expr]:
    """Map names of rates, y1' for y1, to their values."""
    return {f"{symbol.name}'": value for symbol, value in zip(symbols, values, strict=True)}


def equals(left: str, right: object) -> str:
    """Formula ``left = right`` in LaTeX; sympy prints the right side."""
    return f"{left} = {right if isinstance(right, str) else sp.latex(right)}"


def where(*expressions: sp.Basic) -> list[str]:
    """Formulas in LaTeX of the intermediate results in expressions."""
    return [equals(sp.latex(letter), value) for letter, value in definitions(expressions).items()]


def joined(formulas: Iterable[str]) -> str:
    """Formulas in LaTeX in one line."""
    return r",\quad ".join(formulas)
