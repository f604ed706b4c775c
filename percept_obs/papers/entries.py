"""An entry of a ledger: what is printed, the verdict that a computation gives, and how it is known."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property, partial
from typing import Any

import sympy as sp

from percept_obs.checking import Target, target_of
from percept_obs.checking.printed import matrix_target
from percept_obs.papers.mathml import shown
from percept_obs.papers.scalars import FUNCTIONS

Printed = tuple[sp.Basic, ...]
Values = dict[sp.Basic, sp.Basic]


class Verdict(StrEnum):
    """Result of a computation about a printed statement.

    See Also
    --------
    Known : Way in which it is known.

    Examples
    --------
    >>> from percept_obs.papers import Verdict
    >>> print(*Verdict, sep=", ")
    holds, misprint, false as stated, depends, not checkable
    """

    HOLDS = "holds"
    MISPRINT = "misprint"
    FALSE = "false as stated"
    DEPENDS = "depends"
    NOT_CHECKABLE = "not checkable"


class Known(StrEnum):
    """Way in which a verdict is known.

    A derivation is exact, for all values of the letters or for one that refutes.  A definition, a choice or an
    assumption has nothing to be derived from.  As implemented: the package's own equations or numbers are the printed
    ones.  Runs are simulations, of which there are as many as the note says.  Not reproduced: it is cited, lost by the
    scan, or our runs do not show what the paper's do.

    See Also
    --------
    Verdict : What is known.

    Examples
    --------
    >>> from percept_obs.papers import Known
    >>> print(*Known, sep=", ")
    derived, definition, as implemented, seen in runs, not reproduced
    """

    DERIVED = "derived"
    DEFINITION = "definition"
    IMPLEMENTED = "as implemented"
    RUNS = "seen in runs"
    NOT_REPRODUCED = "not reproduced"


@dataclass(frozen=True)
class Finding:
    """The result of a check: a verdict, the numbers that it rests on, and what was derived in place of the print.

    The derived is in pairs of sides, for an equation that is sent to another process is evaluated there.

    Parameters
    ----------
    verdict : Verdict
    numbers : mapping of names to floats
        Such as the largest difference of two sides.
    derived : tuple of pairs of expressions
        Left and right sides of what stands in place of the print.

    See Also
    --------
    Entry : What is checked.

    Examples
    --------
    >>> from percept_obs.papers import MA2005
    >>> print(MA2005["(10)"].finding.verdict)
    holds
    """

    verdict: Verdict
    numbers: Mapping[str, float] = field(default_factory=dict)
    derived: tuple[tuple[sp.Basic, sp.Basic], ...] = ()


Check = Callable[[Printed], Finding]


def judged(holds: bool, otherwise: Verdict = Verdict.MISPRINT, numbers: Mapping[str, float] | None = None) -> Finding:
    """The finding of a check that holds or not."""
    return Finding(Verdict.HOLDS if holds else otherwise, numbers or {})


def not_checkable(printed: Printed) -> Finding:
    """Nothing is computed; the note says why."""
    return Finding(Verdict.NOT_CHECKABLE)


@dataclass(frozen=True, eq=False)
class Entry:
    """A printed statement and how it is judged; a notebook shows it with its derivation, correction and verdict.

    Parameters
    ----------
    place : str
        Number of the equation, such as "(4)", or a few words that name the statement.
    page, section : str
        Where it stands; empty if that is not known.
    says : str
        What it says, in a few words.
    printed : tuple of sympy relations
        The formulas as they are printed; empty where the statement has none.
    check : function of the printed formulas
        Computes the finding; its docstring says how.
    note : str
        How the print was read, what is wrong, or why nothing can be computed.
    expected : Verdict
        The verdict that is recorded.
    correction : mapping of expressions to expressions
        What is to be put in the place of what, in a misprint.
    known : Known
        How the verdict is known.
    asks : function, optional
        Returns what a formula of your own is compared with, where the statement is printed in words: relations, or
        what `percept_obs.check` takes.

    See Also
    --------
    Ledger : The entries of a paper.
    Finding : What its check finds.

    Examples
    --------
    >>> from percept_obs.papers import MA2005
    >>> entry = MA2005["(38)"]
    >>> print(f"p. {entry.page}, {entry.expected}: {entry.says}")
    p. 73, misprint: the same with (25), in s = G t
    """

    place: str
    page: str
    section: str
    says: str
    printed: Printed
    check: Check
    note: str = ""
    expected: Verdict = Verdict.HOLDS
    correction: Values = field(default_factory=dict)
    known: Known = Known.DERIVED
    asks: Callable[[], Any] | None = None

    @property
    def number(self) -> int | None:
        """Number of the equation, if it has one."""
        digits = re.fullmatch(r"\((\d+)\)", self.place)
        return int(digits[1]) if digits else None

    def named(self, place: str | int) -> bool:
        """Return True if this names the place: ``"(38)"``, ``38`` or ``"Figure 3"``."""
        return str(place).casefold() in (self.place.casefold(), str(self.number))

    @cached_property
    def finding(self) -> Finding:
        """Findings of the check in the printed formulas."""
        return self.check(self.printed)

    @property
    def corrected(self) -> Printed:
        """The printed formulas with the correction put in."""
        return tuple(_replaced(formula, self.correction) for formula in self.printed)

    @cached_property
    def agrees(self) -> bool:
        """Return True if the computed verdict is the recorded one and a misprint's correction is right."""
        if self.finding.verdict != self.expected:
            return False
        mended = (Verdict.HOLDS, Verdict.NOT_CHECKABLE)
        return self.expected != Verdict.MISPRINT or self.check(self.corrected).verdict in mended

    @property
    def target(self) -> Target:
        """Target that `percept_obs.check` compares a formula of your own with: the print, or its correction.

        Raises
        ------
        ValueError
            If the statement has no formula; it says so.
        """
        if not self.printed and self.asks is None:
            raise ValueError(f"nothing can be compared with {self.place}, a statement without a formula: {self.says}")
        asked = self.asks() if self.asks else self.corrected
        target = matrix_target(asked) if isinstance(asked, tuple) else target_of(asked)
        own = {
            type(e) for formula in self.printed for e in sp.preorder_traversal(formula) if isinstance(e, sp.MatrixExpr)
        }
        named = {each.__name__: each for each in own if each.__module__.startswith(__package__)}
        return replace(target, functions=FUNCTIONS | named, note=self._said)

    @property
    def _said(self) -> str:
        """Words on a formula that is the printed one and not true."""
        what = {Verdict.FALSE: "it is false as stated", Verdict.DEPENDS: "it depends"}.get(self.expected)
        return f"as the paper has it, but {what}: {self.note}" if what and self.printed else ""

    @property
    def verdict(self) -> str:
        """The computed verdict, and the recorded one if that is another, with how it is known."""
        recorded = "" if self.agrees else f"; recorded: {self.expected}"
        return f"{self.finding.verdict}{recorded} ({self.known})"

    @property
    def reason(self) -> str:
        """The note, and the numbers that the verdict rests on."""
        numbers = ", ".join(f"{name}: {value:.4g}" for name, value in self.finding.numbers.items())
        return "; ".join(filter(None, (self.note, numbers)))

    @property
    def method(self) -> str:
        """Computation of the check, in a sentence."""
        return " ".join((self.check.__doc__ or "").split("\n\n")[0].split())

    @property
    def parts(self) -> dict[str, str | Printed]:
        """All that there is to say of the entry, by what it is: texts, and formulas."""
        correction = self.corrected if self.correction else ()
        return {
            "says": self.says + (f" (page {self.page}, section {self.section})" if self.page else ""),
            "print": self.printed,
            "derivation": tuple(sp.Eq(*sides, evaluate=False) for sides in self.finding.derived),
            "correction": correction,
            "verdict": self.verdict,
            "reason": self.reason,
            "computed": self.method,
        }

    def __str__(self) -> str:
        lines = [self.place]
        for name, part in self.parts.items():
            texts = [part] if isinstance(part, str) else [_typed(formula) for formula in part]
            lines += [f"  {name if k == 0 else '':<12}{text}" for k, text in enumerate(texts) if text]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><th>{name}<td>{shown(part)}" for name, part in self.parts.items() if part)
        return f"<table><caption>{shown(self.place)}</caption>{rows}</table>"

    def _repr_latex_(self) -> str:
        lines = r" \\ ".join(sp.latex(formula) for formula in self.printed)
        return rf"$\displaystyle \begin{{gathered}}{lines}\end{{gathered}}$"


def _replaced(formula: sp.Basic, by: Values) -> sp.Basic:
    """A relation with parts replaced, not evaluated."""
    if formula in by:
        return by[formula]
    return formula.func(*(side.xreplace(by) for side in formula.args), evaluate=False)


def at(place: str, page: str, section: str, says: str) -> Callable[..., Entry]:
    """An entry of this place, still to be given the rest: ``at("(4)", "64", "1", "dynamics")(printed, check, ...)``."""
    return partial(Entry, place, page, section, says)


def _typed(formula: sp.Basic) -> str:
    """A relation as one types it: ``left = right``."""
    return f"{formula.lhs} {formula.rel_op.replace('==', '=')} {formula.rhs}"
