"""Words of a formula: names told apart, lines begun and continued, bars and bare arguments put in brackets."""

import difflib
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any, NoReturn

import sympy as sp
from lark import Token, UnexpectedCharacters

from percept_obs.checking.points import key
from percept_obs.checking.refusing import CLOSING, CannotRead, about_character, about_command, two_meanings
from percept_obs.checking.spelling import laid_out, lexed, name_of, other_names, rate_of, spelled

LONGEST, LONGEST_NUMBER, LONGEST_WORD, MOST_WORDS, DEEPEST = 9000, 15, 60, 9000, 40

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
    **{"Abs": sp.Abs, **_QUOTIENTS},
}
WRAPPERS = {"Matrix", "ImmutableMatrix", "array", "expand", "simplify", "factor"}
"""Calls that leave a formula as it is."""

OPENING = {
    "LPAR": "RPAR",
    "LBRACE": "RBRACE",
    "LSQB": "RSQB",
    "_BAR_OPEN": "_BAR_CLOSE",
    "_NORM_OPEN": "_NORM_CLOSE",
    "_MATRIX": "_END_MATRIX",
    "_CASES": "_END_CASES",
}
_AROUND = {kind: OPENING[kind] for kind in ("_MATRIX", "_CASES", "LBRACE")}
"""What may stand around equations."""
_CONTINUES = {"PLUS", "MINUS", "_TIMES", "SLASH", "EQUAL", "RELATION", "COMMA", "_POWER", "LPAR", "LSQB", "LBRACE"}
_GOES_ON = {"PLUS", "MINUS", "_TIMES", "SLASH", "EQUAL", "RELATION", "_POWER", "RPAR", "RSQB", "RBRACE"}
_OPERAND_ENDS = {"NAME", "NUMBER", "PI", "RAISED", "RPAR", "RBRACE", "RSQB", "_BAR_CLOSE", "_NORM_CLOSE", "_END_MATRIX"}
_OPERAND_STARTS = {"NAME", "NUMBER", "PI", "EULER", "LPAR", "LBRACE", "LSQB", "_FRACTION", "_ROOT", "SLASH", "RAISED"}
_N = r"NAME:(\w+)"
_MANY = rf"{_N}(?: (?:_ROW|COMMA|_LINE|_CELL) {_N})*"
_LABEL = re.compile(
    rf"(D_DT )?({_N}( _POWER (LBRACE )?NAME:T( RBRACE)?)?|NAME:J LPAR {_N} RPAR"
    rf"|(LSQB |LPAR )?_MATRIX {_MANY} _END_MATRIX( RSQB| RPAR)?"
    rf"|(LSQB|LPAR) {_MANY} (RSQB|RPAR)( _POWER (LBRACE )?NAME:T( RBRACE)?)?"
    rf"|LSQB LSQB {_N} RSQB( COMMA LSQB {_N} RSQB)* RSQB) EQUAL"
)


class Words:
    """A text's words, with the letters, labels and functions that are known; `tokens` are those that are parsed."""

    def __init__(self, text: str, letters: Mapping[str, Any], labels: Iterable[str], functions: Functions) -> None:
        self.text, self.letters, self.labels, self.functions = text, letters, set(labels), functions
        self.known = {*letters, *self.labels}
        if len(text) > LONGEST:
            raise CannotRead(text, LONGEST, f"the formula has {len(text)} characters; at most {LONGEST}")
        self.plain, self.origin = spelled(text)

    def refuse(self, message: str, at: Any = None) -> NoReturn:
        """Raise CannotRead at a token or a tree, or at the end of the text."""
        start = at.start_pos if isinstance(at, Token) else at.meta.start_pos if hasattr(at, "meta") else at
        position = self.origin[start] if start is not None and start < len(self.origin) else len(self.text)
        raise CannotRead(self.text, position, message)

    def tokens(self, strict: bool = True) -> list[Token]:
        """Tokens with names told apart, the last of them "END"; what is refused stays as it is unless strict."""
        found = self._raw()
        passes = (self._sums, self._names, self._numbers, self._environments, self._times, self._joined)
        lines = (self._lines,) if strict else ()
        for each in (*passes, *lines, self._told, self._bars, self._fractions, self._arguments):
            found = each(found) if strict else self._leniently(each, found)
        return found

    def _leniently(self, change: Callable[[list[Token]], list[Token]], tokens: list[Token]) -> list[Token]:
        """Change tokens, or those words that can be, and leave what is refused as it is."""
        with suppress(CannotRead):
            return change(tokens)
        if change != self._told:
            return tokens
        kinds = [token.type for token in tokens]
        out: list[Token] = []
        for token, before, after in zip(tokens, ["", *kinds], [*kinds[1:], ""], strict=False):
            try:
                out += self._told_apart(token, before, after)
            except CannotRead:
                out.append(token)
        return out

    def _raw(self) -> list[Token]:
        try:
            raw = [*lexed(laid_out(self.plain)), Token("END", "", len(self.plain), end_pos=len(self.plain))]
        except UnexpectedCharacters as error:
            position = self.origin[error.pos_in_stream or 0]
            raise CannotRead(self.text, position, about_character(self.text[position])) from None
        long = next((token for token in raw if token.type in ("NAME", "RATE") and len(token) > 4 * LONGEST_WORD), None)
        if long:
            self.refuse(f"a word has more than {LONGEST_WORD} letters; write * between letters", long)
        return raw

    def _sums(self, tokens: list[Token]) -> list[Token]:
        """Write sums with numbers as their bounds out."""
        for start in range(len(tokens) - 1, -1, -1):
            if tokens[start].type != "SUM":
                continue
            index, first, last = re.findall(r"(?<=[{\s])[A-Za-z](?=\s*=)|\d", tokens[start])
            end, depth = start + 1, 0
            while depth or tokens[end].type not in _SUMMAND_ENDS or end == start + 1:
                depth += (tokens[end].type in OPENING) - (tokens[end].type in CLOSING)
                if depth < 0 or tokens[end].type == "END":
                    break
                end += 1
            summand, at = tokens[start + 1 : end], tokens[start]
            terms = [[_indexed(t, index, str(k)) for t in summand] for k in range(int(first), int(last) + 1)]
            out = [at.update(type="LPAR", value="(")]
            for k, term in enumerate(terms):
                out += [at.update(type="PLUS", value="+")] * bool(k) + term
            tokens = [*tokens[:start], *out, at.update(type="RPAR", value=")"), *tokens[end:]]
            if not terms or len(tokens) > LONGEST:
                self.refuse("this sum has too many terms, or none", at)
        return tokens

    def _names(self, tokens: list[Token]) -> list[Token]:
        """Give names their keys, and put d/dt before a letter into the letter's name."""
        out: list[Token] = []
        kinds = [token.type for token in tokens]
        for k, token in enumerate(tokens):
            if token.type == "RATE":
                token = token.update(type="NAME", value=rate_of(token))
            elif token.type == "NAME":
                token = token.update(value=name_of(token))
                bare = kinds[max(k - 3, 0) : k]
                if bare[-1:] == ["D_DT"] or bare == ["LPAR", "D_DT", "RPAR"]:
                    del out[-1 if bare[-1:] == ["D_DT"] else -3 :]
                    token = token.update(value=key(f"{token}dot"))
                elif bare[-2:] == ["D_DT", "LPAR"] and "RPAR" in (kinds[k + 1], kinds[k + 4 : k + 5]):
                    del out[-2]
                    token = token.update(value=key(f"{token}dot"))
            out.append(token)
        return out

    def _numbers(self, tokens: list[Token]) -> list[Token]:
        """Decimal commas, digits with an exponent of ten, and the transpose; refuse long numbers and deep brackets."""
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
        if len(part) == 3 and whole != "0" and "{" not in token:
            self.refuse(two_meanings((whole + part, f"{whole}.{part}"), "type it without a comma"), token)
        return [token.update(type="NUMBER", value=f"{whole}.{part}")]

    def _environments(self, tokens: list[Token]) -> list[Token]:
        """Tell systems of equations behind a brace from matrices and branches; outside of those a row is a line."""
        systems = _systems(tokens)
        out: list[Token] = []
        opened: list[int] = []
        for k, token in enumerate(tokens):
            if token.type in _AROUND:
                opened.append(k)
            inside = any(tokens[each].type != "LBRACE" for each in opened[-1:] if each not in systems)
            begun = opened.pop() if opened and token.type in _AROUND.values() else k
            if begun in systems:
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

    def _times(self, tokens: list[Token]) -> list[Token]:
        """Leave out the time in brackets: y1(t), y_3^2(t), P(t)^T, B(y(t))."""
        out: list[Token] = []
        timed: set[int] = set()
        k = 0
        while k < len(tokens):
            braced = tokens[k].type == "LBRACE"
            kinds = [t.type for t in tokens[k + braced : k + braced + 3]]
            if kinds == ["LPAR", "NAME", "RPAR"] and tokens[k + braced + 1] == "t" and self._takes_time(out, tokens[k]):
                size = 3 + 2 * braced
                if "t" in self.letters and (k + size >= len(tokens) or tokens[k + size].type != "EQUAL"):
                    name = out[-1]
                    self.refuse(
                        two_meanings((f"{name} at the time t", f"{name} times t"), "write * or a blank between"),
                        tokens[k],
                    )
                timed.add(len(out) - 1)
                k += size
                continue
            if tokens[k].type == "RPAR" and len(out) - 1 in timed and len(out) > 2 and out[-2].type == "LPAR":
                bracket = out[-2]
                if self._takes_time(out[:-2], bracket):
                    del out[-2:]
                    k += 1
                    continue
            out.append(tokens[k])
            k += 1
        return out

    def _takes_time(self, before: Sequence[Token], bracket: Token) -> bool:
        """Return True if a bracket stands directly behind a letter or its exponent."""
        if not before:
            return False
        last = before[-1]
        between = self.plain[last.end_pos or 0 : bracket.start_pos]
        if between.strip().removeprefix(r"\left") or between[:1].isspace():
            return False
        if last.type == "NAME":
            return str(last) not in FUNCTIONS and str(last) not in self.functions
        exponent = len(before) > 1 and before[-2].type == "_POWER"
        return (
            last.type == "RAISED"
            or (last.type == "NUMBER" and exponent)
            or (last.type == "RBRACE" and "_POWER" in [t.type for t in before[-5:]])
        )

    def _lines(self, tokens: list[Token]) -> list[Token]:
        """Join continued lines, take bullets away, and put the left side of each line into one token."""
        out: list[Token] = []
        for line, end in self._unwrapped(_split(tokens)):
            line = self._without_remark(line)
            label = self._label(line)
            if label:
                at = next(k for k, token in enumerate(line) if token.type == "EQUAL")
                line = [label, *line[at:]]
            out += [*line, end]
        return out

    def _joined(self, tokens: list[Token]) -> list[Token]:
        """Leave out ends of lines where a formula goes on."""
        out: list[Token] = []
        opened: list[str] = []
        related = False  # the present line has a left side
        bullets = sum(_bullet(tokens, k) for k in range(len(tokens)))
        following = [len(tokens) - 1] * len(tokens)
        for k in range(len(tokens) - 2, -1, -1):
            following[k] = k + 1 if tokens[k + 1].type != "_LINE" else following[k + 1]
        for k, token in enumerate(tokens):
            if token.type in OPENING:
                opened.append(token.type)
            elif token.type in CLOSING and opened:
                opened.pop()
            if not opened and _bullet(tokens, k):
                if token.type == "MINUS" and bullets == 1:
                    self.refuse(
                        two_meanings(("a list", "a minus sign"), "leave the sign or the blank behind it out"), token
                    )
                continue
            if token.type != "_LINE" or ";" in token:
                related = related or token.type in ("EQUAL", "RELATION")
                related = related and (bool(opened) or token.type not in ("_LINE", "COMMA"))
                out.append(token)
                continue
            after = tokens[following[k]]
            before = out[-1].type if out else "_LINE"
            if opened:
                goes_on = opened[-1] != "LSQB" or before in _CONTINUES or after.type in _GOES_ON | {"COMMA"}
                goes_on = goes_on and not ("quad" in token and opened[-1] == "LSQB" and before not in _CONTINUES)
            elif _bullet(tokens, following[k]):
                goes_on = False
            else:
                goes_on = before in _CONTINUES - {"COMMA"} or (
                    after.type in _GOES_ON and before not in ("_LINE", "COMMA")
                )
                if goes_on and after.type == "MINUS" and before not in _CONTINUES and not related:
                    told = ("a line of its own", "going on with the line before")
                    self.refuse(two_meanings(told, "end the line before with ; or write both in one line"), after)
            if not goes_on:
                related = False
                out.append(token)
        return out

    def _unwrapped(self, lines: Iterable[tuple[list[Token], Token]]) -> Iterator[tuple[list[Token], Token]]:
        """Write Eq(left, right) as left = right."""
        for line, end in lines:
            start = 2 if len(line) > 2 and line[1].type == "EQUAL" else 0
            called = [str(t) for t in line[start : start + 2]] in (["Eq", "("], ["Equality", "("])
            comma = _top_level(line, start + 2, "COMMA") if called else None
            if comma is None or line[-1].type != "RPAR":
                yield line, end
            else:
                equal = line[comma].update(type="EQUAL", value="=")
                yield [*line[start + 2 : comma], equal, *line[comma + 1 : -1]], end

    def _without_remark(self, line: list[Token]) -> list[Token]:
        """Leave out words in brackets at the end of a line, "(quotient rule)"."""
        k = len(line) - 1
        while line and line[-1].type == "RPAR" and line[k - 1].type == "NAME":
            k -= 1
        words = line[k:-1]
        said = words and line[k - 1].type == "LPAR" and k > 1 and all(t.isalpha() and len(t) > 2 for t in words)
        return (
            line[: k - 1] if said and not any(self._spelled(t) in self.known or self._ways(t) for t in words) else line
        )

    def _label(self, line: Sequence[Token]) -> Token | None:
        """Return the left side of a line as one token if the line begins with one."""
        end = next((k for k, token in enumerate(line[:200]) if token.type == "EQUAL"), None)
        if end is None or line[0].type not in ("D_DT", "NAME", "LPAR", "LSQB", "_MATRIX"):
            return None
        kinds = [f"NAME:{t}" if t.type == "NAME" else t.type for t in line[: end + 1] if t not in WRAPPERS]
        text = " ".join(kinds)
        if kinds[0] == "LPAR" and kinds[-2] == "RPAR" and ("COMMA" not in kinds or kinds[1] == "LSQB"):
            text = " ".join([*kinds[1:-2], "EQUAL"])  # (y3') = ... and Matrix([...]) = ...
        match = _LABEL.fullmatch(text)
        if not match:
            return None
        vector = any(kind in kinds for kind in ("_MATRIX", "LSQB", "COMMA"))
        names = ["J"] if text.startswith("NAME:J LPAR") else re.findall(_N, text)
        if "_POWER" in kinds:
            names = names[:-1] if vector else ["".join(names)]
        names = [self._spelled(key(f"{name}dot") if kinds[0] == "D_DT" else name) for name in names]
        name = ",".join(names)
        if vector and "_MATRIX" not in kinds and all(part in self.letters for part in names):
            return None  # an equation of columns
        if not all(part in self.known for part in names):
            rate = re.fullmatch(r"[dD](\w+)", name)
            if rate and key(f"{rate[1]}dot") in self.labels:
                told = (f"the rate of {rate[1]}", "a letter of your own")
                self.refuse(two_meanings(told, f"for the rate write {rate[1]}' ="), line[0])
            if any(accent in name for accent in ("dot", "hat", ",")) or name in FUNCTIONS:
                there = ", ".join(sorted(self.labels))
                self.refuse(f'there is no line "{name}"; there are {there}', line[0])
            self.known.add(name)
        return line[0].update(type="LABEL", value=name)

    def _spelled(self, name: str) -> str:
        """Return a name as it is known, in another spelling if need be."""
        return next((each for each in (name, *other_names(name)) if each in self.known), name)

    def _told(self, tokens: list[Token]) -> list[Token]:
        """Replace names by letters, functions or several letters side by side, and refuse what has no meaning."""
        out: list[Token] = []
        for k, token in enumerate(tokens):
            after = tokens[k + 1].type if k + 1 < len(tokens) else ""
            out += self._told_apart(token, tokens[k - 1].type if k else "", after)
        return out

    def _told_apart(self, token: Token, before: str, after: str) -> list[Token]:
        name = str(token)
        if token.type == "COMMAND":
            name = re.sub(r"\\(operatorname|mathrm|textrm|text|rm)(?![A-Za-z])|\W", "", name)
            if name not in FUNCTIONS and name not in self.known and not (name == "e" and after == "_POWER"):
                self.refuse(about_command(name), token)
            token = token.update(type="NAME", value=name)
        transpose = name == "T" and before in ("_POWER", "LBRACE")
        if token.type != "NAME" or transpose:
            return [token]
        if name in WRAPPERS and after == "LPAR" and name not in self.known:
            return []
        name = self._spelled(name)
        if name in self.known:
            return [token.update(value=name)]
        kinds = {"pi": "PI"} | dict.fromkeys(FUNCTIONS, "FUNCTION") | dict.fromkeys(self.functions, "USER_FUNCTION")
        kinds |= {"e": "EULER"} if after == "_POWER" else {}
        kinds = {"norm": "FUNCTION"} | kinds if after == "LPAR" else kinds
        if name in kinds:
            return [token.update(type=kinds[name], value=name)]
        if len(name) > LONGEST_WORD:
            self.refuse(f"a word has more than {LONGEST_WORD} letters; write * between letters", token)
        ways = self._ways(name)
        if len(ways) == 1:  # words of their own, so that a power belongs to the last of them
            return [token.update(value=self._spelled(key(part))) for part in ways[0]]
        if ways:
            self.refuse(f'"{name}" can be read as {" or ".join(map(" ".join, ways))}; write * between', token)
        near = difflib.get_close_matches(name, self.letters, 1, 0.5)
        known = ", ".join(sorted(str(letter) for letter in self.letters.values() if letter.is_Symbol)[:40])
        guess = f', did you mean "{self.letters[near[0]]}"? There are' if near else "; there are"
        start = token.start_pos or 0
        typed = self.text[self.origin[start] : self.origin[(token.end_pos or start + 1) - 1] + 1]
        self.refuse(f'"{typed[:40]}" is no letter here{guess} {known}', token)

    def _ways(self, name: str) -> list[list[str]]:
        """Return ways to read a word as letters side by side, at most two."""
        ways: list[list[list[str]]] = [[[]], *([] for _ in name)]
        for end in range(1, len(name) + 1):
            for start in range(end):
                if ways[start] and self._spelled(key(name[start:end])) in self.letters:
                    ways[end] += [[*way, name[start:end]] for way in ways[start]]
            ways[end] = ways[end][:2]
        return ways[-1]

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

    def _fractions(self, tokens: list[Token]) -> list[Token]:
        r"""Put the digits of \frac12 in braces, and read a root before a bracket as a function."""
        out: list[Token] = []
        wanted = 0
        for k, token in enumerate(tokens):
            if token.type == "_ROOT" and tokens[k + 1].type == "LPAR":
                token = token.update(type="FUNCTION", value="sqrt")
            if token.type == "_FRACTION":
                wanted = 2
            elif wanted and token.type == "NUMBER" and token.isdigit() and len(token) <= wanted:
                for digit in token:
                    out += [
                        token.update(type="LBRACE", value="{"),
                        token.update(value=digit),
                        token.update(type="RBRACE", value="}"),
                    ]
                wanted -= len(token)
                continue
            elif wanted != 1 or token.type != "LBRACE":
                wanted = 0
            out.append(token)
        return out

    def _arguments(self, tokens: list[Token]) -> list[Token]:
        """Put arguments of functions without brackets in brackets, where it is clear how far they go."""
        partner = _partners(tokens)
        opens: set[int] = set()
        closes: set[int] = set()
        for k, token in enumerate(tokens):
            if token.type != "FUNCTION":
                continue
            start = _exponent_end(tokens, partner, k + 1)
            inverse = [str(t) for t in tokens[k + 1 : start] if t.type not in ("_POWER", "LBRACE", "RBRACE")]
            if inverse == ["-", "1"] and tokens[start].type != "END":
                self.refuse(
                    two_meanings((f"1/{token}", f"arc{token}"), f"write 1/{token}(...) or arc{token}(...)"), token
                )
            end = _unit_end(tokens, partner, start)
            if end is None:
                continue
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


_SUMMAND_ENDS = {"PLUS", "MINUS", "EQUAL", "RELATION", "_LINE", "COMMA", "_CELL", "_ROW", "END", *CLOSING}


def _indexed(token: Token, index: str, number: str) -> Token:
    """Put a number in place of an index of a sum."""
    if token.type != "NAME":
        return token
    if token == index:
        return token.update(type="NUMBER", value=number)

    def put(found: re.Match[str]) -> str:
        return re.sub(rf"(?<![A-Za-z\\]){index}(?![A-Za-z])|(?<=[ijklmn]){index}|{index}(?=[ijklmn])", number, found[0])

    return token.update(value=re.sub(r"_\s*(\{[^{}]*\}|[A-Za-z0-9]+)", put, token))


def _systems(tokens: Sequence[Token]) -> set[int]:
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
        elif opened and token.type == "EQUAL" and tokens[opened[-1]].type in _AROUND:
            found.add(opened[-1])
    return found - branches


def _bullet(tokens: Sequence[Token], k: int) -> bool:
    """Return True if a sign at the start of a line stands before a line of a list."""
    token = tokens[k]
    if token.type not in ("MINUS", "_TIMES") or (k and tokens[k - 1].type != "_LINE") or len(tokens) < k + 3:
        return False
    apart = (token.end_pos or 0) < (tokens[k + 1].start_pos or 0)
    return apart and tokens[k + 1].type == "NAME" and tokens[k + 2].type == "EQUAL"


def _split(tokens: Sequence[Token]) -> Iterator[tuple[list[Token], Token]]:
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


def _top_level(line: Sequence[Token], start: int, kind: str) -> int | None:
    depth = 0
    for k in range(start, len(line)):
        depth += (line[k].type in OPENING) - (line[k].type in CLOSING)
        if depth == 0 and line[k].type == kind:
            return k
    return None


def _partners(tokens: Sequence[Token]) -> dict[int, int]:
    """Return where brackets that begin at a place end."""
    opened: list[int] = []
    found: dict[int, int] = {}
    for k, token in enumerate(tokens):
        if token.type in OPENING:
            opened.append(k)
        elif token.type in CLOSING and opened:
            found[opened.pop()] = k
    return found


def _exponent_end(tokens: Sequence[Token], partner: Mapping[int, int], k: int) -> int:
    """Return the place behind an exponent that may stand at a place."""
    if tokens[k].type == "RAISED":
        return k + 1
    if tokens[k].type != "_POWER":
        return k
    k += 1 + (tokens[k + 1].type == "MINUS")
    return min(partner.get(k, k) + 1, len(tokens) - 1)


def _unit_end(tokens: Sequence[Token], partner: Mapping[int, int], k: int) -> int | None:
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
    return _exponent_end(tokens, partner, k)
