"""Tokens of a formula: which open and close, where lines, exponents and arguments end; and the functions."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import sympy as sp
from lark import Token

from percept_obs.checking.refusing import CLOSING

Functions = Mapping[str, Callable[..., Any]]
_NAMED = (sp.sin, sp.cos, sp.tan, sp.asin, sp.acos, sp.atan, sp.sinh, sp.cosh, sp.tanh, sp.sech, sp.exp, sp.log)
_QUOTIENTS = {
    "sec": lambda x: 1 / sp.cos(x),
    "csc": lambda x: 1 / sp.sin(x),
    "cot": lambda x: sp.cos(x) / sp.sin(x),
    "coth": lambda x: sp.cosh(x) / sp.sinh(x),
}
FUNCTIONS: Functions = {
    **{f.__name__: f for f in (*_NAMED, sp.sqrt, sp.sign)},
    **{"abs": sp.Abs, "sgn": sp.sign, "ln": sp.log, "arctan": sp.atan, "arcsin": sp.asin, "arccos": sp.acos},
    **{"Abs": sp.Abs, "fabs": sp.Abs, **_QUOTIENTS},
}
OF_SEVERAL: Functions = {"max": sp.Max, "min": sp.Min}

OPENING = {
    "LPAR": "RPAR",
    "LBRACE": "RBRACE",
    "LSQB": "RSQB",
    "_BAR_OPEN": "_BAR_CLOSE",
    "_NORM_OPEN": "_NORM_CLOSE",
    "_MATRIX": "_END_MATRIX",
    "_CASES": "_END_CASES",
}
AROUND = {kind: OPENING[kind] for kind in ("_MATRIX", "_CASES", "LBRACE")}
"""Brackets that may stand around equations."""


SUMMAND_ENDS = {"PLUS", "MINUS", "EQUAL", "RELATION", "_LINE", "COMMA", "_CELL", "_ROW", "END", *CLOSING}


def indexed(token: Token, index: str, number: str) -> Token:
    """Put a number in place of an index of a sum."""
    if token.type != "NAME":
        return token
    if token == index:
        return token.update(type="NUMBER", value=number)

    def put(found: re.Match[str]) -> str:
        return re.sub(rf"(?<![A-Za-z\\]){index}(?![A-Za-z])|(?<=[ijklmn]){index}|{index}(?=[ijklmn])", number, found[0])

    return token.update(value=re.sub(r"_\s*(\{[^{}]*\}|[A-Za-z0-9]+)", put, token))


def systems(tokens: Sequence[Token]) -> set[int]:
    """Return where environments begin that have equations in them, not entries or branches."""
    found: set[int] = set()
    opened: list[int] = []
    branches: set[int] = set()
    for k, token in enumerate(tokens):
        if token.type in OPENING:
            opened.append(k)
        elif token.type in CLOSING and opened:
            opened.pop()
        elif opened and token.type in ("_FOR", "OTHERWISE"):
            branches.add(opened[-1])
        elif opened and token.type == "EQUAL" and tokens[opened[-1]].type in AROUND:
            found.add(opened[-1])
    return found - branches


def differential(tokens: Sequence[Token], k: int) -> int:
    """Return how many tokens d tau has at a place, 0 if it is not there."""
    if k + 1 < len(tokens) and (tokens[k] == "d" or re.fullmatch(r"\\mathrm\s*\{\s*d\s*\}", tokens[k])):
        return 2 if tokens[k + 1].type == "NAME" else 0
    return int(tokens[k].type == "NAME" and bool(re.fullmatch("d(t|s|tau|sigma)", tokens[k])))


def bullet(tokens: Sequence[Token], k: int) -> bool:
    """Return True if a sign at the start of a line stands before a line of a list."""
    token = tokens[k]
    if token.type not in ("MINUS", "_TIMES") or (k and tokens[k - 1].type != "_LINE") or len(tokens) < k + 3:
        return False
    apart = (token.end_pos or 0) < (tokens[k + 1].start_pos or 0)
    return apart and tokens[k + 1].type == "NAME" and tokens[k + 2].type == "EQUAL"


def split(tokens: Sequence[Token]) -> Iterator[tuple[list[Token], Token]]:
    """Yield lines with the token behind each."""
    line: list[Token] = []
    depth = 0
    for token in tokens:
        depth += (token.type in OPENING) - (token.type in CLOSING)
        if token.type == "END" or (depth == 0 and token.type in ("_LINE", "COMMA")):
            yield line, token
            line = []
        else:
            line.append(token)


def top_level(line: Sequence[Token], start: int, kind: str) -> int | None:
    """Return where the first token of a kind stands outside of brackets; None if nowhere."""
    depth = 0
    for k in range(start, len(line)):
        depth += (line[k].type in OPENING) - (line[k].type in CLOSING)
        if depth == 0 and line[k].type == kind:
            return k
    return None


def partners(tokens: Sequence[Token]) -> dict[int, int]:
    """Return where brackets that begin at a place end."""
    opened: list[int] = []
    found: dict[int, int] = {}
    for k, token in enumerate(tokens):
        if token.type in OPENING:
            opened.append(k)
        elif token.type in CLOSING and opened:
            found[opened.pop()] = k
    return found


def exponent_end(tokens: Sequence[Token], partner: Mapping[int, int], k: int) -> int:
    """Return the place behind an exponent that may stand at a place."""
    if tokens[k].type == "RAISED":
        return k + 1
    if tokens[k].type != "_POWER":
        return k
    k += 1 + (tokens[k + 1].type == "MINUS")
    return min(partner.get(k, k) + 1, len(tokens) - 1)


def unit_end(tokens: Sequence[Token], partner: Mapping[int, int], k: int) -> int | None:
    """Return the place behind 2 y1, a fraction, a root or bars, with an exponent; None if none stands there."""
    number = tokens[k].type == "NUMBER"
    k += number
    braces = {"_FRACTION": 2, "_ROOT": 1}.get(tokens[k].type, 0)
    if tokens[k].type in ("_BAR_OPEN", "_NORM_OPEN") and k in partner:
        k = partner[k] + 1
    elif tokens[k].type in ("NAME", "PI") or braces:
        k += 1
        for _ in range(braces):
            if k not in partner:
                return None
            k = partner[k] + 1
    elif not number:
        return None
    return exponent_end(tokens, partner, k)
