"""What somebody types, as mathematics: in the order in which it stands there, also while it is not yet complete."""

import re
from collections.abc import Mapping
from html import escape
from types import MappingProxyType

import sympy as sp

from percept_obs.checking.points import key
from percept_obs.checking.tokens import FUNCTIONS, Token
from percept_obs.labs.shared.markup import dotted, markup

DEEPEST = 40
GAP = "<mi>□</mi>"
"""What stands where something is still missing."""

_IN_BRACKETS = re.compile(r"<mrow><mo[^>]*>\(</mo>(.*)<mo[^>]*>\)</mo></mrow>", re.DOTALL)
_CLOSES = {"(": ")", "[": "]", "{": "}", "|left": "|right"}
_SIGNS = {"*": "·", "-": "−", "<=": "≤", ">=": "≥", "!=": "≠"}
_ENDS = {*_CLOSES.values(), "line", "end"}


def typed_markup(words: list[Token], letters: Mapping[str, sp.Symbol] = MappingProxyType({})) -> str:
    """MathML of a formula's words; it never fails.

    Parameters
    ----------
    words : list of Token
        As `Target.words` gives them; the last one is of the kind "end".
    letters : mapping of names without underscores to symbols

    Examples
    --------
    >>> from percept_obs.checking.tokens import tokens
    >>> typed_markup(tokens("x/2"))
    '<mrow><mfrac><mrow><mi>x</mi></mrow><mrow><mn>2</mn></mrow></mfrac></mrow>'
    """
    return _Writer(words, letters).line()


class _Writer:
    def __init__(self, words: list[Token], letters: Mapping[str, sp.Symbol]) -> None:
        self.words, self.letters, self.at, self.depth = words, letters, 0, 0

    @property
    def now(self) -> Token:
        return self.words[self.at]

    def take(self) -> Token:
        token = self.now
        self.at += token.kind != "end"
        return token

    def line(self) -> str:
        parts = [self.sum()]
        while self.now.kind != "end":
            parts += [_sign(self.take()), self.sum()]
        return f"<mrow>{''.join(parts)}</mrow>"

    def sum(self) -> str:
        parts: list[str] = []
        while self.now.kind not in _ENDS:
            if self.now.kind in ("+", "-", "=", "<", ">", "<=", ">=", "!=", ","):
                parts.append(_sign(self.take()))
            parts.append(self.product())
        return "".join(parts)

    def product(self) -> str:
        parts = [self.power()]
        while self.now.kind not in _ENDS and self.now.kind not in ("+", "-", "=", "<", ">", "<=", ">=", "!=", ","):
            if self.now.kind == "/":
                self.take()
                above, below = "".join(map(_bare if len(parts) == 1 else str, parts)), _bare(self.power())
                parts = [f"<mfrac>{_one(above)}{_one(below)}</mfrac>"]
            elif self.now.kind == "*":
                self.take()
                parts += ["<mo>·</mo>", self.power()]
            else:
                parts += ["<mo>&#x2062;</mo>", self.power()]
        return "".join(parts)

    def power(self) -> str:
        base = self.atom()
        if self.now.kind == "raised":
            return _raised(base, f"<mn>{self.take().text}</mn>")
        if self.now.kind != "^":
            return base
        self.take()
        minus = _sign(self.take()) if self.now.kind == "-" else ""
        return _raised(base, f"<mrow>{minus}{_bare(self.atom())}</mrow>")

    def atom(self) -> str:
        token = self.now
        if token.kind in _ENDS or token.kind in ("+", "-", "*", "/", "^", "=", ","):
            return GAP
        self.take()
        if token.kind in _CLOSES:
            return self.bracket(token)
        if token.kind == "number":
            return f"<mn>{escape(token.text)}</mn>"
        if token.kind == "name" and (token.text not in FUNCTIONS or self.now.kind not in ("(", "{", "^")):
            return self.letter(token.text)
        if token.text in ("frac", "dfrac", "tfrac"):
            return f"<mfrac>{_one(_bare(self.atom()))}{_one(_bare(self.atom()))}</mfrac>"
        if token.text == "sqrt":
            return f"<msqrt>{_bare(self.atom())}</msqrt>"
        if token.kind == "d/dt":
            return "<mfrac><mi>d</mi><mrow><mi>d</mi><mi>t</mi></mrow></mfrac>"
        return f"<mi>{escape(token.text or token.kind)}</mi>"

    def letter(self, name: str) -> str:
        """A letter with its index and its accents."""
        name = key(name)
        stem = name.removesuffix("dot") or name
        symbol = self.letters.get(stem, sp.Symbol(stem))
        return dotted(symbol) if stem != name else markup(symbol)

    def bracket(self, opened: Token) -> str:
        self.depth += 1
        inside = self.sum() if self.depth < DEEPEST else ""
        self.depth -= 1
        closed = self.now.kind == _CLOSES[opened.kind]
        if closed:
            self.take()
        left, right = {"{": ("", ""), "[": ("[", "]"), "|left": ("|", "|")}.get(opened.kind, ("(", ")"))
        if not left:
            return f"<mrow>{inside or GAP}</mrow>"
        # stretched by a browser without a mathematical font they would tower over letters
        kind = "<mo>" if "<mfrac>" in inside else '<mo stretchy="false">'
        return f"<mrow>{kind}{left}</mo>{inside or GAP}{f'{kind}{right}</mo>' if closed else ''}</mrow>"


def _sign(token: Token) -> str:
    if token.kind == "line":
        return "<mo>;</mo>"
    return f"<mo>{escape(_SIGNS.get(token.kind, token.kind))}</mo>"


def _raised(base: str, exponent: str) -> str:
    """A power; over an index, not beside it."""
    if base.startswith("<msub>") and base.endswith("</msub>"):
        return f"<msubsup>{base.removeprefix('<msub>').removesuffix('</msub>')}{exponent}</msubsup>"
    return f"<msup>{_one(base)}{exponent}</msup>"


def _bare(text: str) -> str:
    """What stands in brackets, without them, where a line or a place already keeps it together."""
    found = _IN_BRACKETS.fullmatch(text)
    return f"<mrow>{found[1]}</mrow>" if found else text


def _one(text: str) -> str:
    """One element, as fractions and powers take it."""
    return f"<mrow>{text}</mrow>"
