"""Notation that is written out before names are told apart: sums, decimals, environments, bars, arguments."""

import re
from collections.abc import Iterable, Mapping
from typing import Any, NoReturn

import sympy as sp
from lark import Token, UnexpectedCharacters

from percept_obs.checking.dialects import plain
from percept_obs.checking.points import key
from percept_obs.checking.refusing import CLOSING, CannotRead, about_character, two_meanings
from percept_obs.checking.spelling import lexed
from percept_obs.checking.tokens import (
    AROUND,
    OF_SEVERAL,
    OPENING,
    SUMMAND_ENDS,
    Functions,
    differential,
    exponent_end,
    indexed,
    partners,
    systems,
    unit_end,
)

LONGEST, LONGEST_NUMBER, LONGEST_WORD, DEEPEST, MOST_INTEGRALS = 9000, 15, 60, 40, 20
"""Most characters of a text, digits of a number, letters of a word, brackets in brackets, and integrals."""
_TOO_LONG = {
    r"'{9}": "more than 8 primes stand here",
    rf"[A-Za-z0-9_\u0302-\u0307]{{{4 * LONGEST_WORD}}}": f"a word has more than {LONGEST_WORD} letters",
}
"""Runs of signs that no formula has, and that would take long to read."""

_OPERAND_ENDS = {"NAME", "NUMBER", "PI", "RAISED", "RPAR", "RBRACE", "RSQB", "_BAR_CLOSE", "_NORM_CLOSE", "_END_MATRIX"}
_OPERAND_STARTS = {"NAME", "NUMBER", "PI", "EULER", "LPAR", "LBRACE", "LSQB", "_FRACTION", "_ROOT", "SLASH", "RAISED"}


class Notation:
    """A text with the letters, labels and functions that are known, and what its notation stands for."""

    def __init__(self, text: str, letters: Mapping[str, Any], labels: Iterable[str], functions: Functions) -> None:
        self.text, self.letters, self.labels, self.functions = text, letters, set(labels), {**OF_SEVERAL, **functions}
        self.known = {*letters, *self.labels}
        if len(text) > LONGEST:
            raise CannotRead(text, LONGEST, f"the formula has {len(text)} characters; at most {LONGEST}")
        for pattern, what in _TOO_LONG.items():
            if found := re.search(pattern, text):
                raise CannotRead(text, found.start(), f"{what}; write * between letters")
        source, self.dialects = plain(text, self.is_name)
        self.plain, self.origin = source.text, source.origin
        self.bound: dict[str, sp.Symbol] = {}

    def is_name(self, word: str) -> bool:
        """Return True for a word that may be a letter or a function here."""
        return word in self.known

    def refuse(self, message: str, at: Any = None) -> NoReturn:
        """Raise CannotRead at a token or a tree, or at the end of the text."""
        start = at.start_pos if isinstance(at, Token) else at.meta.start_pos if hasattr(at, "meta") else at
        position = self.origin[start] if start is not None and start < len(self.origin) else len(self.text)
        raise CannotRead(self.text, position, message)

    def _raw(self) -> list[Token]:
        try:
            raw = [*lexed(self.plain), Token("END", "", len(self.plain), end_pos=len(self.plain))]
        except UnexpectedCharacters as error:
            position = self.origin[error.pos_in_stream or 0]
            raise CannotRead(self.text, position, about_character(self.text[position])) from None
        return raw

    def _sums(self, tokens: list[Token]) -> list[Token]:
        """Write out sums whose bounds are numbers, term by term."""
        for start in range(len(tokens) - 1, -1, -1):
            if tokens[start].type != "SUM":
                continue
            index, first, last = re.findall(r"(?<=[{\s])[A-Za-z](?=\s*=)|\d", tokens[start])
            end, depth = start + 1, 0
            while depth or tokens[end].type not in SUMMAND_ENDS or end == start + 1:
                depth += (tokens[end].type in OPENING) - (tokens[end].type in CLOSING)
                if depth < 0 or tokens[end].type == "END":
                    break
                end += 1
            summand, at = tokens[start + 1 : end], tokens[start]
            terms = [[indexed(t, index, str(k)) for t in summand] for k in range(int(first), int(last) + 1)]
            out = [at.update(type="LPAR", value="(")]
            for k, term in enumerate(terms):
                out += [at.update(type="PLUS", value="+")] * bool(k) + term
            tokens = [*tokens[:start], *out, at.update(type="RPAR", value=")"), *tokens[end:]]
            if not terms or len(tokens) > LONGEST:
                self.refuse("this sum has too many terms, or none", at)
        return tokens

    def _numbers(self, tokens: list[Token]) -> list[Token]:
        """Read decimal commas, exponents of ten and transposes; refuse long numbers and deeply nested brackets."""
        out: list[Token] = []
        opened: list[str] = []
        for token in tokens:
            if token.type in OPENING:
                call = token.type == "LPAR" and out and out[-1] in self.functions
                opened.append("LSQB" if call else token.type)
            elif token.type in CLOSING and opened:
                opened.pop()
            if len(opened) > DEEPEST:
                self.refuse(f"brackets are nested more than {DEEPEST} deep; write the formula flatter", token)
            if token.type in ("NUMBER", "DECIMAL") and len(token) > LONGEST_NUMBER:
                self.refuse(f"numbers have at most {LONGEST_NUMBER} digits", token)
            if token.type == "TRANSPOSE":
                out += [token.update(type="_POWER", value="^"), token.update(type="NAME", value="T")]
            elif token.type == "DECIMAL":
                out += self._decimal(token, bool(opened) and opened[-1] == "LSQB")
            elif token.type == "NUMBER" and (e := re.search("[eE]", token)):
                mantissa, exponent = token[: e.start()], token[e.end() :]
                letter = key(token[e.start() :]) if exponent.isdigit() else token[e.start()]
                if letter in self.known:
                    told = (
                        f"{mantissa} times ten to the power of {exponent}",
                        f"{mantissa} times {token[e.start() :]}",
                    )
                    self.refuse(two_meanings(told, "write * between, or 10^"), token)
                if len(exponent.lstrip("+-")) > 2:
                    self.refuse("exponents of ten have at most two digits", token)
                out.append(token)
            else:
                out.append(token)
        return out

    def _decimal(self, token: Token, listed: bool) -> list[Token]:
        whole, part = re.split(r",|\{,\}", token)
        if listed and "{" not in token:
            middle = (token.start_pos or 0) + len(whole)
            ends = Token("NUMBER", part, middle + 1, end_pos=middle + 1 + len(part))
            return [token.update(type="NUMBER", value=whole), Token("COMMA", ",", middle, end_pos=middle + 1), ends]
        if len(part) == 3 and part.isdigit() and whole != "0" and "{" not in token:
            self.refuse(two_meanings((whole + part, f"{whole}.{part}"), "type it without a comma"), token)
        return [token.update(type="NUMBER", value=f"{whole}.{part}")]

    def _environments(self, tokens: list[Token]) -> list[Token]:
        """Tell systems of equations behind a brace from matrices and branches; outside of those a row is a line."""
        braced = systems(tokens)
        out: list[Token] = []
        opened: list[int] = []
        for k, token in enumerate(tokens):
            if token.type in AROUND:
                opened.append(k)
            inside = any(tokens[each].type != "LBRACE" for each in opened[-1:] if each not in braced)
            begun = opened.pop() if opened and token.type in AROUND.values() else k
            if begun in braced:
                out += [token.update(type="_LINE", value="\n")] if "BRACE" not in token.type else []
            elif token.type == "_ROW" and not inside:
                out.append(token.update(type="_LINE", value="\n"))
            elif (token.type == "_CELL" and not inside) or (token.type == "_LINE" and inside):
                continue
            else:
                out.append(token)
        return self._braces(out)

    def _braces(self, tokens: list[Token]) -> list[Token]:
        """Make brackets of braces; one with nothing on the other side, as before a system, is left out."""
        opened: list[int] = []
        kinds: dict[int, str] = {}
        for k, token in enumerate(tokens):
            if token.type == "SET_OPEN":
                opened.append(k)
            elif token.type == "SET_CLOSE" and opened:
                kinds |= {opened.pop(): "LPAR", k: "RPAR"}
            elif token.type == "NOTHING":
                kinds |= {k: ""} | ({opened.pop(): ""} if opened and "right" in token else {})
        for k in opened:  # a brace that nothing closes stands before a system
            kinds[k] = ""
        out: list[Token] = []
        for k, token in enumerate(tokens):
            kind = kinds.get(k, token.type)
            if kind == "SET_CLOSE":
                self.refuse("this bracket was never opened", token)
            out += [token.update(type=kind) if kind != token.type else token] if kind else []
        return out

    def _integrals(self, tokens: list[Token]) -> list[Token]:
        """Write an integral over bounds, an integrand and d tau, as a function of them."""
        many = [token for token in tokens if token.type == "INTEGRAL"][MOST_INTEGRALS:]
        if many:
            self.refuse(f"more than {MOST_INTEGRALS} integrals stand here; write them in several texts", many[0])
        for start in range(len(tokens) - 1, -1, -1):
            if tokens[start].type != "INTEGRAL":
                continue
            partner = partners(tokens)
            last = len(tokens) - 1
            lower = min(partner.get(start + 1, start + 1) + 1, last)
            if tokens[lower].type != "_POWER":
                self.refuse("an integral has a lower and an upper bound, \\int_{0}^{t} ... d tau", tokens[start])
            upper = min(partner.get(lower + 1, lower + 1) + 1, last)
            k = upper
            while tokens[k].type not in ("END", "EQUAL", "RELATION", *CLOSING) and not differential(tokens, k):
                k = partner.get(k, k) + 1
            size = differential(tokens, k)
            if not size or k == upper:
                self.refuse("an integral ends with the letter that varies, as in d tau", tokens[start])
            variable = str(tokens[k + 1]) if size == 2 else tokens[k][1:]
            bounds = (str(t) for t in tokens[start + 1 : upper] if t.type == "NAME")
            self.bound |= {name: sp.Symbol(name, real=True) for name in (variable, *(set(bounds) - self.known))}
            self.bound |= {"infty": sp.oo} if any(t == r"\infty" for t in tokens[start + 1 : upper]) else {}
            self.known |= set(self.bound)

            def new(kind: str, value: str, at: Token = tokens[start]) -> Token:
                return at.update(type=kind, value=value)

            comma = new("COMMA", ",")
            parts = [tokens[upper:k], [new("NAME", variable)], tokens[start + 1 : lower], tokens[lower + 1 : upper]]
            inside = [token for part in parts for token in (*part, comma)][:-1]
            tokens = [
                *tokens[:start],
                *(new("_INTEGRAL", "int"), new("LPAR", "("), *inside, new("RPAR", ")")),
                *tokens[k + size :],
            ]
        return tokens

    def _bars(self, tokens: list[Token]) -> list[Token]:
        """Tell bars that open from those that close."""
        out: list[Token] = []
        opened: list[str] = []
        for token in tokens:
            if token.type not in ("BAR", "NORM_BAR"):
                if token.type in CLOSING and opened and not opened[-1].endswith("BAR"):
                    opened.pop()
                opened += [token.type] if token.type in OPENING else []
                out.append(token)
                continue
            # a bar closes if one is open and an operand stands before it, else it opens; \left and \right tell
            top = opened[-1] if opened else ""
            ended = bool(out) and out[-1].type in _OPERAND_ENDS
            if token == "||" and top == "BAR" and ended:  # |a||b|
                out += [token.update(type="_BAR_CLOSE", value="|"), token.update(type="_BAR_OPEN", value="|")]
                continue
            closes = "right" in token or "rv" in token or "rV" in token
            closes = closes or (top == token.type and ended and not ("left" in token or "lv" in token or "lV" in token))
            if closes and top == token.type:
                opened.pop()
            elif not closes:
                opened.append(token.type)
            kind = "_NORM" if token.type == "NORM_BAR" else "_BAR"
            out.append(token.update(type=f"{kind}_{'CLOSE' if closes else 'OPEN'}"))
        return out

    def _arguments(self, tokens: list[Token]) -> list[Token]:
        """Put arguments of functions without brackets in brackets, where it is clear how far they go."""
        partner = partners(tokens)
        opens: set[int] = set()
        closes: set[int] = set()
        for k, token in enumerate(tokens):
            if token.type != "FUNCTION":
                continue
            start = exponent_end(tokens, partner, k + 1)
            inverse = [str(t) for t in tokens[k + 1 : start] if t.type not in ("_POWER", "LBRACE", "RBRACE")]
            if inverse == ["-", "1"] and tokens[start].type != "END":
                self.refuse(
                    two_meanings((f"1/{token}", f"arc{token}"), f"write 1/{token}(...) or arc{token}(...)"), token
                )
            end = unit_end(tokens, partner, start)
            if end is None:
                continue
            # sin 2 y1 x may be sin(2 y1 x) or sin(2 y1) x
            if tokens[end].type in _OPERAND_STARTS:
                told = (f"{token} of all that follows", f"{token} times what follows")
                self.refuse(two_meanings(told, f"write brackets, {token}(...)"), tokens[end])
            opens.add(start)
            closes.add(end)
        out: list[Token] = []
        for k, token in enumerate(tokens):
            out += [token.update(type="RPAR", value=")")] * (k in closes)
            out += [token.update(type="LPAR", value="(")] * (k in opens)
            out.append(token)
        return out
