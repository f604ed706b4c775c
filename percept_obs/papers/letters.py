"""Letters in which a part of a paper is printed, and its formulas, read from text."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import sympy as sp
from sympy.core.function import UndefinedFunction

from percept_obs.checking.points import key
from percept_obs.checking.reading import FUNCTIONS as READ_FUNCTIONS
from percept_obs.checking.reading import read
from percept_obs.papers.base import Values, explicit, is_identity
from percept_obs.papers.scalars import FUNCTIONS, IN_PRINT


@dataclass(frozen=True)
class Letters:
    """Letters that are declared, and terms that stand in several prints; every other word is a real number.

    Args:
        declared: Such as ``"n x m: w"`` or ``"positive: G"``; ``v=v^1`` is typed v and shown v^1.
        terms: Such as ``"SLOPE = a + b t"``.
    """

    declared: tuple[str, ...] = ()
    terms: tuple[str, ...] = ()

    @cached_property
    def _declared(self) -> dict[str, Any]:
        parts = [part.split(": ") for part in self.declared]
        words = [(kind, *word.partition("=")) for kind, names in parts for word in names.split()]
        return {name: _letter(kind, printed or name) for kind, name, _, printed in words}

    @cached_property
    def _terms(self) -> dict[str, Any]:
        terms: dict[str, Any] = {}
        for name, text in (term.split(" = ") for term in self.terms):
            (terms[name],) = self._read(text, terms)
        return terms

    def read(self, text: str) -> tuple[sp.Basic, ...]:
        """Formulas that are typed, with semicolons between them; a letter with a prime is a rate.

        Examples
        --------
            >>> Letters(("2: e x",)).read("y1' = b1 y2 + norm(e); y1^2 < b1")
            (Eq(ydot1, b1*y2 + Norm(e)), y1**2 < b1)
        """
        return tuple(line for part in text.split(";") for line in self._read(part, self._terms))

    def _read(self, text: str, terms: Mapping[str, Any]) -> list[sp.Basic]:
        own = {n: each for n, each in self._declared.items() if isinstance(each, UndefinedFunction)}
        functions = FUNCTIONS | IN_PRINT | {key(n): each for n, each in own.items()}
        letters: dict[str, Any] = {word: sp.Symbol(word, real=True) for word in re.findall(r"[A-Za-z]\w*", text)}
        letters |= {"infty": sp.oo} | self._declared
        letters = {
            n: e for n, e in letters.items() if n not in (*READ_FUNCTIONS, *own, "pi") and key(n) not in functions
        }
        known = {key(f"{n}dot"): _rate(each) for n, each in letters.items()}
        known |= {key(n): each for n, each in (*letters.items(), *terms.items())}
        lines = read(text, known, list(known), functions).lines
        return [sp.Eq(known[r.name], r.formula, evaluate=False) if r.name else r.formula for r in lines]

    @cache  # noqa: B019
    def __getitem__(self, text: str) -> Any:
        """The letter or the expression that is typed so."""
        found = re.fullmatch(r"([A-Za-z]\w*)('?)", text)
        if not found:
            return self.read(text)[0]
        letter = (self._declared | self._terms).get(found[1], sp.Symbol(found[1], real=True))
        return _rate(letter) if found[2] else letter

    def values(self, values: Values) -> Values:
        """Values by their letters; both may be typed."""
        return {
            self[letter] if isinstance(letter, str) else letter: self[value] if isinstance(value, str) else value
            for letter, value in values.items()
        }


class Print(tuple[Any, ...]):
    """Printed formulas, with their letters."""

    letters: Letters

    def __new__(cls, lines: tuple[sp.Basic, ...], letters: Letters) -> Print:
        """Formulas in these letters."""
        made = super().__new__(cls, lines)
        made.letters = letters
        return made

    def __getnewargs__(self) -> tuple[Any, ...]:
        return tuple(self), self.letters

    def __getitem__(self, item: Any) -> Any:
        """A line by its number, or what is typed in these letters."""
        return self.letters[item] if isinstance(item, str) else super().__getitem__(item)

    @property
    def given(self) -> dict[str, Any]:
        """Right sides of equations by the names on their left, of columns entry by entry."""
        columns = (line.args if isinstance(line.lhs, sp.MatrixBase) else ([line.lhs], [line.rhs]) for line in self)
        return {str(letter): value for pair in columns for letter, value in zip(*pair, strict=True)}

    def put(self, part: sp.Basic, values: Values) -> Any:
        """A part with values put in and matrices multiplied out."""
        return explicit(part, self.letters.values(values))

    def separates(self, quantity: str, below: float, above: float, values: Mapping[Any, float]) -> bool:
        """Return True if the only line admits a quantity below it and excludes one above it."""
        rest = {letter: sp.Float(value) for letter, value in values.items()}
        return [self.put(self[0], rest | {quantity: sp.Float(v)}) for v in (below, above)] == [sp.true, sp.false]

    def hold(self, *cases: Values) -> bool:
        """Return True if all lines are identities with each of these values."""
        return all(is_identity(line, values) for values in map(self.letters.values, cases) for line in self)


def _rate(letter: Any) -> Any:
    """The letter of a time derivative: ydot1 for y1."""
    name = re.sub(r"(\d*)$", r"dot\1", str(letter), count=1)
    return sp.MatrixSymbol(name, *letter.shape) if isinstance(letter, sp.MatrixSymbol) else sp.Symbol(name, real=True)


def _letter(kind: str, name: str) -> Any:
    if kind in ("real", "positive"):
        return sp.Symbol(name, **{kind: True})
    if kind == "function":
        return sp.Function(name, real=True)
    special, rows, columns = re.fullmatch(r"(identity |zero |)(\w+)(?: x (\w+))?", kind).groups()  # type: ignore[union-attr]
    shape = _size(rows), _size(columns or "1")
    if special == "identity ":
        return sp.Identity(shape[0])
    return sp.ZeroMatrix(*shape) if special else sp.MatrixSymbol(name, *shape)


def _size(text: str) -> sp.Expr:
    """A number of rows, such as 3, n or 2p."""
    number, letter = re.fullmatch(r"(\d*)(\w*)", text).groups()  # type: ignore[union-attr]
    return sp.Integer(number or 1) * (sp.Symbol(letter, integer=True, positive=True) if letter else 1)
