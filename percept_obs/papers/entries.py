"""An entry of a ledger: what is printed, the verdict that a computation gives, and how it is known."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cache, cached_property
from typing import Any

import sympy as sp
from sympy.core.relational import Relational

from percept_obs.checking import Target, target_of
from percept_obs.checking.printed import matrix_target
from percept_obs.papers.base import Values, filled_in, is_identity
from percept_obs.papers.letters import Letters, Print
from percept_obs.papers.mathml import shown
from percept_obs.papers.scalars import FUNCTIONS, H, h


class Verdict(StrEnum):
    """Result of a computation about a printed statement."""

    HOLDS = "holds"
    MISPRINT = "misprint"
    FALSE = "false as stated"
    DEPENDS = "depends"
    NOT_CHECKABLE = "not checkable"


DEPENDS, NOT_CHECKABLE = Verdict.DEPENDS, Verdict.NOT_CHECKABLE


class Known(StrEnum):
    """Way in which a verdict is known.

    A derivation is exact, for all values of the letters or for one that refutes. A definition, a choice or an
    assumption has nothing to be derived from.  As implemented: the package's own equations or numbers are the printed
    ones.  Runs are simulations, of which there are as many as the note says.  Not reproduced: it is cited, lost by the
    scan, or our runs do not show what the paper's do.
    """

    DERIVED = "derived"
    DEFINITION = "definition"
    IMPLEMENTED = "as implemented"
    RUNS = "seen in runs"
    NOT_REPRODUCED = "not reproduced"


@dataclass(frozen=True)
class Finding:
    """The result of a check: a verdict, the numbers that it rests on, and what was derived in place of the print.

    Parameters
    ----------
    verdict, numbers
    derived : tuple of pairs of expressions
        Left and right sides, for an equation that is sent to another process is evaluated there.

    Examples
    --------
    >>> from percept_obs.papers import MA2005
    >>> print(MA2005["(10)"].finding.verdict)
    holds
    """

    verdict: Verdict
    numbers: Mapping[str, float] = field(default_factory=dict)
    derived: tuple[tuple[sp.Basic, sp.Basic], ...] = ()


Told = Any
"""What judges return: a truth or a verdict, or that with numbers, by names or in the order of those in the text."""
EQUAL = "Put what the package derives in the place of each letter: both sides must be the same for all values."


class Case(Values):
    """Values of letters in one derivation."""

    __hash__ = object.__hash__  # type: ignore[assignment]

    @cache  # noqa: B019
    def holds(self, relation: sp.Basic, drops: sp.Expr) -> bool:
        """Return True if sides are the same in these values, with what a bound drops."""
        return is_identity(relation, self, drops)


@cache
def derived(derivation: Callable[..., Any], arguments: tuple[str, ...], letters: Letters) -> list[Case]:
    """What a function derives."""
    found = derivation(*arguments)
    return [Case(letters.values(values)) for values in (found if isinstance(found, list) else [found])]


@dataclass(frozen=True, eq=False)
class Entry:
    """A printed statement and how it is judged; a notebook shows it with its derivation, correction and verdict.

    Parameters
    ----------
    place, page, section, says, typed, compared, given, drops, expected, known, note, mends, numbers, asked
        What the text says of it; see `CONTRIBUTING.md`.
    letters, computations, others
        Letters of the formulas, functions by their names, and the paper's entries by their places.

    Examples
    --------
    >>> from percept_obs.papers import MA2005
    >>> entry = MA2005["(38)"]
    >>> print(entry.expected, "on page", entry.page)
    misprint on page 73
    """

    place: str
    page: str
    section: str
    says: str
    typed: tuple[str, ...] = ()
    compared: str = ""
    expected: Verdict = Verdict.HOLDS
    known: Known = Known.DERIVED
    note: str = ""
    mends: tuple[str, ...] = ()
    given: tuple[str, ...] = ()
    drops: Mapping[int, str] = field(default_factory=dict)
    numbers: str = ""
    asked: str = ""
    letters: Letters = field(default_factory=Letters, repr=False)
    computations: Mapping[str, Callable[..., Any]] = field(default_factory=dict, repr=False)
    others: Mapping[str, Entry] = field(default_factory=dict, repr=False)

    @property
    def number(self) -> int | None:
        """Number of the equation, if it has one."""
        digits = re.fullmatch(r"\((\d+)\)", self.place)
        return int(digits[1]) if digits else None

    def named(self, place: str | int) -> bool:
        """Return True if this names the place: ``"(38)"``, ``38`` or ``"Figure 3"``."""
        return str(place).casefold() in (self.place.casefold(), str(self.number))

    @cached_property
    def printed(self) -> Print:
        """The formulas as they are printed."""
        return Print(self.letters.read(";".join(self.typed)) if self.typed else (), self.letters)

    @cached_property
    def corrected(self) -> Print:
        """The printed formulas with the correction put in."""
        if "< -> <=" in self.mends:
            return Print(tuple(sp.LessThan(*line.args, evaluate=False) for line in self.printed), self.letters)
        by = {self.letters[before]: self.letters[after] for before, after in (m.split(" -> ") for m in self.mends)}
        mended = (line.func(*(side.xreplace(by) for side in line.args), evaluate=False) for line in self.printed)
        return Print(tuple(map(by.get, self.printed, mended)), self.letters)

    @cached_property
    def calls(self) -> tuple[tuple[str, Callable[..., Any], tuple[str, ...]], ...]:
        """What the print is compared with: "=" for a derivation or "?" for a judge, the function, its arguments."""
        found = re.findall(r"([=?,]) (\w+)(?:\(([^)]*)\))?", self.compared)
        try:
            return tuple(
                (sign.replace(",", "="), self.computations[name], tuple(filter(None, given.split(", "))))
                for sign, name, given in found
            )
        except KeyError as name:
            raise ValueError(f"{self.place} is compared with {name}, and there is no such function; write it") from None

    @cached_property
    def cases(self) -> list[Case]:
        """Values of the letters in each derivation, with all that is given put in, bounds last and as equalities."""
        cases = [case for sign, *call in self.calls if sign == "=" for case in derived(*call, self.letters)]
        if not self.given:
            return cases
        cases = [Case(case) for case in cases or [Case()]]
        for text in self.given:
            lines = self.others[text].corrected[::-1] if text in self.others else self.letters.read(text)
            for line in sorted(lines, key=lambda line: isinstance(line, sp.LessThan)):
                for case in cases:
                    value = filled_in(line.rhs, case)
                    case |= {} if value is None or line.lhs == 0 else {line.lhs: value.expand()}
        return cases

    def check(self, printed: tuple[sp.Basic, ...]) -> Finding:
        """Judge formulas in the place of the printed ones.

        What does not hold is false as stated if numbers tell, and a misprint if they do not or a correction mends it.
        """
        cases = self.cases
        if not self.calls and not cases:
            return Finding(Verdict.NOT_CHECKABLE)
        derivation = tuple((line.lhs, cases[0][line.lhs]) for line in printed if cases and line.lhs in cases[0])
        dropped = [self.letters[self.drops.get(k, "0")] for k in range(len(printed))]
        found: Told = all(case.holds(*pair) for case in cases for pair in zip(printed, dropped, strict=True))
        for _, judge, arguments in (call for call in self.calls if found and call[0] == "?"):
            found = judge(Print(printed, self.letters), *arguments)
        verdict, numbers = found if isinstance(found, tuple) else (found, {})
        if not isinstance(numbers, Mapping):
            numbers = dict(zip(self.numbers.split("; "), numbers, strict=True))
        numbers = {name: float(value) for name, value in numbers.items()}
        if not isinstance(verdict, Verdict):
            refuted = Verdict.FALSE if numbers and not self.mends else Verdict.MISPRINT
            verdict = Verdict.HOLDS if verdict else refuted
        return Finding(verdict, numbers, derivation)

    @cached_property
    def finding(self) -> Finding:
        """Finding in the printed formulas."""
        return self.check(self.printed)

    @cached_property
    def agrees(self) -> bool:
        """Return True if the computed verdict is the recorded one and a misprint's correction is right."""
        if self.finding.verdict != self.expected or self.expected != Verdict.MISPRINT:
            return self.finding.verdict == self.expected
        return self.check(self.corrected).verdict in (Verdict.HOLDS, Verdict.NOT_CHECKABLE)

    @property
    def target(self) -> Target:
        """Target that `percept_obs.check` compares a formula of your own with: the print, or its correction."""
        if not self.typed and not self.asked:
            raise ValueError(f"nothing can be compared with {self.place}, a statement without a formula: {self.says}")
        asked: Any = tuple(self.corrected)
        if re.search("[=<]", self.asked):
            asked = self.letters.read(self.asked)
        elif self.asked:
            ((_, computation, arguments),) = replace(self, compared=f"? {self.asked}").calls
            asked = computation(*arguments)
        target = matrix_target(asked) if isinstance(asked, tuple) else target_of(asked)
        images = {each.__name__: each for each in (H, h) if any(line.atoms(each) for line in self.printed)}
        what = {Verdict.FALSE: "it is false as stated", Verdict.DEPENDS: "it depends"}.get(self.expected)
        said = f"as the paper has it, but {what}: {self.note}" if what and self.typed else ""
        return replace(target, functions=FUNCTIONS | images, note=said)

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
        if not self.calls and not self.given:
            return "Nothing is computed; the note says why."
        return "".join(judge.__doc__ or "" for sign, judge, _ in self.calls if sign == "?") or EQUAL

    @property
    def parts(self) -> dict[str, str | tuple[sp.Basic, ...]]:
        """All that there is to say of the entry, by what it is: texts, and formulas."""
        return {
            "says": f"{self.says} (page {self.page}, section {self.section})",
            "print": self.printed,
            "derivation": tuple(sp.Eq(*sides, evaluate=False) for sides in self.finding.derived),
            "correction": self.corrected if self.mends else (),
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


def _typed(formula: Relational) -> str:
    """A relation as one types it: ``left = right``."""
    return f"{formula.lhs} {formula.rel_op.replace('==', '=')} {formula.rhs}"
