"""MathML of what somebody types, in the order in which it stands there, also while it is not yet complete."""

import re
from collections.abc import Mapping
from html import escape
from types import MappingProxyType

import sympy as sp
from lark import Token

from percept_obs.labs.shared.markup import dotted, markup

DEEPEST = 40
GAP = "<mi>□</mi>"
"""Stands where something is still missing."""

_IN_BRACKETS = re.compile(r"<mrow><mo[^>]*>\(</mo>(.*)<mo[^>]*>\)</mo></mrow>", re.DOTALL)
_BRACKETS = {
    "LPAR": ("RPAR", "(", ")"),
    "LSQB": ("RSQB", "[", "]"),
    "LBRACE": ("RBRACE", "", ""),
    "_BAR_OPEN": ("_BAR_CLOSE", "|", "|"),
}
_SIGNS = {"-": "−", "<=": "≤", ">=": "≥", "!=": "≠", r"\le": "≤", r"\leq": "≤", r"\ge": "≥", r"\geq": "≥"}
_SIGNS |= {r"\ne": "≠", r"\neq": "≠", r"\lt": "<", r"\gt": ">"}
_BETWEEN = {"PLUS", "MINUS", "EQUAL", "RELATION", "COMMA"}
_ENDS = {closing for closing, _, _ in _BRACKETS.values()} | {"_LINE", "END"}


def typed_markup(tokens: list[Token], letters: Mapping[str, sp.Symbol] = MappingProxyType({})) -> str:
    """Return MathML of a formula's tokens, the last of which is "END"; it never fails.  Letters have no underscores."""
    return _Writer(tokens, letters).line()


class _Writer:
    def __init__(self, tokens: list[Token], letters: Mapping[str, sp.Symbol]) -> None:
        self.tokens, self.letters, self.at, self.depth = tokens, letters, 0, 0

    @property
    def kind(self) -> str:
        return self.tokens[self.at].type

    def take(self) -> Token:
        token = self.tokens[self.at]
        self.at += token.type != "END"
        return token

    def line(self) -> str:
        parts = [self.sum()]
        while self.kind != "END":
            parts += [_sign(self.take()), self.sum()]
        return f"<mrow>{''.join(parts)}</mrow>"

    def sum(self) -> str:
        parts: list[str] = []
        while self.kind not in _ENDS:
            if self.kind in _BETWEEN:
                parts.append(_sign(self.take()))
            parts.append(self.product())
        return "".join(parts)

    def product(self) -> str:
        parts = [self.power()]
        while self.kind not in _ENDS | _BETWEEN:
            if self.kind == "SLASH":
                self.take()
                above, below = "".join(map(_bare if len(parts) == 1 else str, parts)), _bare(self.power())
                parts = [f"<mfrac>{_one(above)}{_one(below)}</mfrac>"]
            elif self.kind == "_TIMES":
                self.take()
                parts += ["<mo>·</mo>", self.power()]
            else:
                parts += ["<mo>&#x2062;</mo>", self.power()]
        return "".join(parts)

    def power(self) -> str:
        base = self.atom()
        if self.kind == "RAISED":
            return _raised(base, f"<mn>{self.take()}</mn>")
        if self.kind != "_POWER":
            return base
        self.take()
        minus = _sign(self.take()) if self.kind == "MINUS" else ""
        return _raised(base, f"<mrow>{minus}{_bare(self.atom())}</mrow>")

    def atom(self) -> str:
        if self.kind in _ENDS | {"PLUS", "MINUS", "_TIMES", "SLASH", "_POWER", "EQUAL", "COMMA"}:
            return GAP
        token = self.take()
        if token.type in _BRACKETS:
            return self.bracket(*_BRACKETS[token.type])
        if token.type == "NUMBER":
            return f"<mn>{escape(token)}</mn>"
        if token.type == "NAME":  # a letter with its index and its accents
            stem = token.removesuffix("dot") or str(token)
            symbol = self.letters.get(stem, sp.Symbol(stem))
            return dotted(symbol) if stem != token else markup(symbol)
        if token.type == "_FRACTION":
            return f"<mfrac>{_one(_bare(self.atom()))}{_one(_bare(self.atom()))}</mfrac>"
        if token.type == "_ROOT" or token == "sqrt":
            return f"<msqrt>{_bare(self.atom())}</msqrt>"
        if token.type == "D_DT":
            return "<mfrac><mi>d</mi><mrow><mi>d</mi><mi>t</mi></mrow></mfrac>"
        return f"<mi>{escape(token)}</mi>"

    def bracket(self, closing: str, left: str, right: str) -> str:
        self.depth += 1
        inside = (self.sum() if self.depth < DEEPEST else "") or GAP
        self.depth -= 1
        closed = self.kind == closing and bool(self.take())
        if not left:
            return f"<mrow>{inside}</mrow>"
        # stretched by a browser without a mathematical font they would tower over letters
        kind = "<mo>" if "<mfrac>" in inside else '<mo stretchy="false">'
        return f"<mrow>{kind}{left}</mo>{inside}{f'{kind}{right}</mo>' if closed else ''}</mrow>"


def _sign(token: Token) -> str:
    return "<mo>;</mo>" if token.type == "_LINE" else f"<mo>{escape(_SIGNS.get(token, token))}</mo>"


def _raised(base: str, exponent: str) -> str:
    """Return a power; over an index, not beside it."""
    if base.startswith("<msub>") and base.endswith("</msub>"):
        return f"<msubsup>{base.removeprefix('<msub>').removesuffix('</msub>')}{exponent}</msubsup>"
    return f"<msup>{_one(base)}{exponent}</msup>"


def _bare(text: str) -> str:
    """Remove brackets where a line or a place already keeps their content together."""
    found = _IN_BRACKETS.fullmatch(text)
    return f"<mrow>{found[1]}</mrow>" if found else text


def _one(text: str) -> str:
    """Return one element, as fractions and powers take it."""
    return f"<mrow>{text}</mrow>"
