"""The words of a formula that was typed, or that sympy printed as LaTeX."""

import re
import unicodedata
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from percept_obs.checking.points import key

LONGEST, LONGEST_NUMBER, LONGEST_WORD = 9000, 15, 60

_NAMES = """alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho sigma tau upsilon
phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega"""
GREEK = dict(zip("αβγδεζηθικλμνξοπρστυφχψωΓΔΘΛΞΠΣΦΨΩ", re.findall(r"\w+", _NAMES), strict=True))
_GREEK = rf"\\(?:{'|'.join(GREEK.values())})(?![A-Za-z])"
ACCENTS = ("hat", "bar", "dot", "tilde")
_MARKS = {"\u0302": "hat", "\u0304": "bar", "\u0307": "dot", "\u0303": "tilde"}
_SAME = str.maketrans("−–·⋅×′’⟨⟩", "--***''()") | {ord(c): str(k) for k, c in enumerate("₀₁₂₃₄₅₆₇₈₉")}
_RAISED = {c: str(k) for k, c in enumerate("⁰¹²³⁴⁵⁶⁷⁸⁹")}
_RELATIONS = {"neq": "!=", "ne": "!=", "leq": "<=", "le": "<=", "geq": ">=", "ge": ">=", "lt": "<", "gt": ">"}
_SPACE = {",", ";", "!", " ", ":", "displaystyle", "left", "right", "big", "Big", "limits", "{", "}"}
_INVISIBLE = ("aligned", "align", "align*", "gathered", "equation")

_FUNCTIONS = "sin cos tan asin acos atan sinh cosh tanh sech exp log sqrt sign"
Functions = Mapping[str, Callable[..., Any]]
FUNCTIONS: Functions = {
    **{name: getattr(sp, name) for name in _FUNCTIONS.split()},
    **{"abs": sp.Abs, "sgn": sp.sign, "ln": sp.log, "arctan": sp.atan, "arcsin": sp.asin, "arccos": sp.acos},
}


class CannotRead(ValueError):
    """A formula that cannot be read.

    Attributes
    ----------
    position : int
        Where, counted in characters from 0.
    """

    def __init__(self, text: str, position: int, what: str) -> None:
        self.position = position
        start = text.rfind("\n", 0, position) + 1
        end = text.find("\n", position) if "\n" in text[position:] else len(text)
        start, end = max(start, position - 50), min(end, position + 30)
        shown = "".join(c if c.isprintable() else " " for c in text[start:end])
        super().__init__(f"{what}\n    {shown}\n    {' ' * (position - start)}^")


@dataclass(frozen=True)
class Token:
    """A word of a formula: a number, a name, a command of LaTeX, or a sign, which is its own kind."""

    kind: str
    text: str
    position: int


def tokens(text: str) -> list[Token]:
    """The words of a text; it ends with the kind "end".

    Raises
    ------
    CannotRead
        If a character stands for nothing, or the text is too long.
    """
    if len(text) > LONGEST:
        raise CannotRead(text, LONGEST, f"the formula has {len(text)} characters; at most {LONGEST} are read")
    return [*_Words(text).all(), Token("end", "", len(text))]


class Cursor:
    """The words of a text, one after the other."""

    def __init__(self, text: str) -> None:
        self.text, self.tokens, self.at = text, tokens(text), 0

    @property
    def now(self) -> Token:
        """The next word."""
        return self.tokens[self.at]

    def takes(self, *kinds: str) -> Token | None:
        """The next word if it is of one of these kinds; then it is passed."""
        token = self.now
        if token.kind not in kinds:
            return None
        self.at += 1
        return token

    def needs(self, kind: str, what: str) -> Token:
        """The next word, of this kind; otherwise the formula is refused."""
        token = self.takes(kind)
        if token is None:
            raise self.refusal(what)
        return token

    def refusal(self, what: str, at: Token | None = None) -> CannotRead:
        """What is raised at the next word, or at another one."""
        return CannotRead(self.text, (at or self.now).position, what)


class _Words:
    """A walk through a text."""

    def __init__(self, text: str) -> None:
        self.given, self.text, self.at = text, text.translate(_SAME), 0
        self.inside: list[str] = []

    def all(self) -> Iterator[Token]:
        while self.at < len(self.text):
            start = self.at
            token = self._next()
            if token is not None:
                yield Token(*token, start)

    def _match(self, pattern: str) -> re.Match[str] | None:
        found = re.compile(pattern).match(self.text, self.at)
        if found:
            self.at = found.end()
        return found

    def _next(self) -> tuple[str, str] | None:
        if found := self._match(r"[ \t\r\f$~]+"):
            return None
        if self._match(r"\\frac\s*{\s*d\s*}\s*{\s*d\s*t\s*}|d/dt\b"):
            return "d/dt", ""
        if found := self._match(r"\d+(\.\d*)?|\.\d+"):
            if len(found[0]) > LONGEST_NUMBER:
                raise self._refusal(found.start(), f"numbers have at most {LONGEST_NUMBER} digits")
            return "number", found[0]
        if self.text[self.at] in _RAISED:
            start = self.at
            while self.at < len(self.text) and self.text[self.at] in _RAISED:
                self.at += 1
            return "raised", "".join(_RAISED[c] for c in self.text[start : self.at])
        if found := self._match(r"\n+|;"):
            return "line", ""
        if found := self._match(r"\*\*|!=|<=|>=|≠|≤|≥|[-+*/^()\[\]{},=<>]"):
            return {"**": "^", "≠": "!=", "≤": "<=", "≥": ">="}.get(found[0], found[0]), ""
        if found := self._match(r"\\\\"):
            return ("row" if self.inside else "line"), ""
        if found := self._match("&"):
            return ("cell", "") if self.inside else None
        if self._starts_a_name():
            return "name", self._name()
        if found := self._match(r"\\([A-Za-z]+|.)"):
            return self._command(found[1], found.start())
        raise self._refusal(self.at, _of_character(self.given[self.at]))

    def _command(self, name: str, start: int) -> tuple[str, str] | None:
        if name in ("left", "right") and (bar := self._match(r"\s*(\||\\\{|\\\}|\.)")):
            return (f"|{name}", "") if bar[1] == "|" else None
        if name in _SPACE:
            return None
        if name in ("quad", "qquad"):
            return "line", ""
        if name in ("cdot", "times"):
            return "*", ""
        if name in _RELATIONS:
            return _RELATIONS[name], ""
        if name in ("begin", "end"):
            environment = self._match(r"\s*{(\w+\*?)}")
            kind = environment[1] if environment else ""
            if kind in _INVISIBLE:
                return None
            if kind not in ("matrix", "bmatrix", "pmatrix", "cases"):
                raise self._refusal(start, "of LaTeX's environments matrix, cases and aligned are read")
            self.inside = [*self.inside, kind] if name == "begin" else self.inside[:-1]
            return f"{name} {'cases' if kind == 'cases' else 'matrix'}", kind
        if name == "operatorname" and (found := self._match(r"\s*{(\w+)}")):
            return "function", found[1]
        return "command", name

    def _starts_a_name(self) -> bool:
        c = self.text[self.at]
        if c == "\\":
            found = re.compile(r"\\([A-Za-z]+)").match(self.text, self.at)
            return found is not None and (found[1] in ACCENTS or found[1] in GREEK.values() or found[1] == "nabla")
        return _plain(c) is not None

    def _name(self) -> str:
        """A name as one word, its accents at the end."""
        accents: list[str] = []
        stem = self._stem(accents)
        index = ""
        while self._match(r"\s*_"):
            found = self._match(rf"\s*{{((?:[A-Za-z0-9,\s_]|{_GREEK})+)}}|\s*({_GREEK}|[A-Za-z0-9]+)")
            if not found:
                raise self._refusal(self.at, "an index is letters and digits, as in y_1 or v_{c1}")
            index += key((found[1] or found[2]).replace("\\", "")).replace(",", "")
        accents += ["dot"] * len(found[0]) if (found := self._match("'+")) else []
        return stem + index + "".join(accents)

    def _stem(self, accents: list[str]) -> str:
        if found := self._match(r"\\([A-Za-z]+)\s*"):
            if found[1] not in ACCENTS:
                return found[1]
            braces = self._match(r"{\s*")
            if self.at >= len(self.text) or not self._starts_a_name():
                raise self._refusal(self.at, f"\\{found[1]} stands over a letter, as in \\{found[1]}{{y}}_{{1}}")
            inner = self._name() if braces else self._stem(accents)
            if braces and not self._match(r"\s*}"):
                raise self._refusal(self.at, "a brace } is missing after the letter")
            accents.append(found[1])
            return inner
        stem = ""
        while self.at < len(self.text):
            c = self.text[self.at]
            if len(stem) > LONGEST_WORD:
                raise self._refusal(self.at, f"a word has more than {LONGEST_WORD} letters; write * between letters")
            if c.isascii() and (c.isalpha() or (stem and c.isdigit())):
                stem += c
            elif c in _MARKS and stem:
                accents.append(_MARKS[c])
            elif (plain := _plain(c)) and not c.isascii():
                stem += plain[0]
                accents += plain[1]
            else:
                break
            self.at += 1
        return stem

    def _refusal(self, position: int, what: str) -> CannotRead:
        return CannotRead(self.given, position, what)


def _plain(c: str) -> tuple[str, list[str]] | None:
    """A letter without its accent, Greek ones in words; None for what is no letter of a formula."""
    parts = unicodedata.normalize("NFD", c)
    base, marks = parts[0], parts[1:]
    if not all(mark in _MARKS for mark in marks):
        return None
    letter = base if base.isascii() and base.isalpha() else GREEK.get(base)
    return (letter, [_MARKS[mark] for mark in marks]) if letter else None


def _of_character(c: str) -> str:
    if c == "":
        return "the formula ends too early"
    name = unicodedata.name(c, "a control character")
    if c.isalpha():
        return f"{c!r} is {name}; letters are Latin or Greek, so type the letter that it looks like"
    return f"{c!r} ({name.lower()}) stands for nothing in a formula; there are letters, numbers and + - * / ^ ( ) ="
