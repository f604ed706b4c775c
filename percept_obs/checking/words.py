"""Words of a formula: names told apart, arguments of letters left out, lines begun and continued."""

import difflib
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import takewhile
from typing import Any

import sympy as sp
from lark import Token

from percept_obs.checking.dialects.symbols import GREEK
from percept_obs.checking.notation import LONGEST_WORD, Notation
from percept_obs.checking.points import key
from percept_obs.checking.refusing import CLOSING, CannotRead, about_command, two_meanings
from percept_obs.checking.spelling import LABELS, name_of, other_names, rate_of
from percept_obs.checking.tokens import FUNCTIONS, OPENING, bullet, partners, split, top_level

_CONTINUES = {"PLUS", "MINUS", "_TIMES", "SLASH", "EQUAL", "RELATION", "COMMA", "_POWER", "LPAR", "LSQB", "LBRACE"}
_GOES_ON = {"PLUS", "MINUS", "_TIMES", "SLASH", "EQUAL", "RELATION", "_POWER", "RPAR", "RSQB", "RBRACE"}
_N = r"NAME:(\w+)"
_MANY = rf"{_N}(?: (?:_ROW|COMMA|_LINE|_CELL) {_N})*"
_LABEL = re.compile(
    rf"(D_DT )?({_N}( _POWER (LBRACE )?NAME:T( RBRACE)?)?|NAME:J LPAR {_N} RPAR"
    rf"|(LSQB |LPAR )?_MATRIX {_MANY} _END_MATRIX( RSQB| RPAR)?"
    rf"|(LSQB|LPAR) {_MANY} (RSQB|RPAR)( _POWER (LBRACE )?NAME:T( RBRACE)?)?"
    rf"|LSQB LSQB {_N} RSQB( COMMA LSQB {_N} RSQB)* RSQB) EQUAL"
)


_NEVER_PROSE = {*FUNCTIONS, *GREEK.split(), "Piecewise", "Eq", "True", "otherwise"}


class Words(Notation):
    """A text's words; `tokens` are those that are parsed."""

    def tokens(self, strict: bool = True) -> list[Token]:
        """Tokens with names told apart, the last of them "END"; what is refused stays as it is unless strict."""
        found = self._raw()
        passes = (
            self._sums,
            self._names,
            self._numbers,
            self._environments,
            self._integrals,
            self._times,
            self._joined,
        )
        lines = (self._lines,) if strict else ()
        for each in (*passes, *lines, self._told, self._bars, self._arguments):
            found = each(found) if strict else self._leniently(each, found)
        return found

    def _leniently(self, change: Callable[[list[Token]], list[Token]], tokens: list[Token]) -> list[Token]:
        """Return changed tokens; if that is refused, those with the words changed that can be."""
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

    def _names(self, tokens: list[Token]) -> list[Token]:
        """Give names their keys, and put d/dt before a letter into the letter's name."""
        out: list[Token] = []
        kinds = [token.type for token in tokens]
        for k, token in enumerate(tokens):
            if token.type == "RATE":
                token = token.update(type="NAME", value=rate_of(token))
            elif token.type == "CROSS":
                token = token.update(type="NAME", value="wcross")
            elif (
                token.type == "NAME"
                and kinds[k - 1] == "_POWER"
                and re.match("T[A-Za-z]", token)
                and token not in self.known
            ):
                middle = (token.start_pos or 0) + 1  # C^TB is C^T B
                out.append(Token("NAME", "T", middle - 1, end_pos=middle))
                token = Token("NAME", name_of(token[1:]), middle, end_pos=token.end_pos)
            elif token.type == "NAME":
                variant = name_of(token.replace("\\var", "var"))
                token = token.update(value=variant if variant in self.letters else name_of(token))
                bare = kinds[max(k - 3, 0) : k]
                if bare[-1:] == ["D_DT"] or bare == ["LPAR", "D_DT", "RPAR"]:
                    del out[-1 if bare[-1:] == ["D_DT"] else -3 :]
                    token = token.update(value=key(f"{token}dot"))
                elif bare[-2:] == ["D_DT", "LPAR"] and "RPAR" in (kinds[k + 1], kinds[k + 4 : k + 5]):
                    del out[-2]
                    token = token.update(value=key(f"{token}dot"))
            out.append(token)
        return out

    def _times(self, tokens: list[Token]) -> list[Token]:
        """Leave out arguments behind letters: y1(t), y_3^2(t), B(y(t)), w(x1, u); g(x1, xhat2) is ghat, x(t_0) x0."""
        out: list[Token] = []
        first: dict[str, list[str]] = {}  # arguments that a letter has in this text
        partner = partners(tokens)
        k = 0
        while k < len(tokens):
            end = partner.get(k, k)
            inner = tokens[k + 1 : end]
            if tokens[k].type == "LBRACE" and [t.type for t in inner] == ["LPAR", "NAME", "RPAR"]:
                inner = inner[1:2]
            if end == k or not self._takes_time(out, tokens[k]) or not (name := self._applied(out, inner, first)):
                out.append(tokens[k])
                k += 1
                continue
            at = max(j for j, token in enumerate(out) if token.type in ("NAME", "RBRACE") and token != "T")
            if name != out[at] and out[at].type == "NAME":
                out[at] = out[at].update(value=name)
            k = end + 1
        return out

    def _applied(self, before: Sequence[Token], inner: Sequence[Token], first: dict[str, list[str]]) -> str:
        """Return the letter that x(t) or g(x1, xhat2) stands for, x or ghat; empty if the bracket is a factor."""
        letter = next((str(t) for t in reversed(before[-6:]) if t.type == "NAME" and t != "T"), "")
        text = "".join(map(str, inner))
        if re.fullmatch(r"ti\^?\{?\^?\{?[+-]\}?\}?", text):
            return key(f"{letter}plus") if "+" in text else letter
        if text == "t0":
            return f"{letter}0"
        if text == "t" and "t" in self.letters and letter in self.letters:
            told = (f"{letter} at the time t", f"{letter} times t")
            self.refuse(two_meanings(told, "write * or a blank between"), before[-1])
        if text == "t" or self._only_times(inner):
            return letter
        if self._spelled(letter) not in self.known and not self._ways(letter):
            return ""
        words = [str(t) for t in inner if t.type == "NAME"]
        unknown = [word for word in words if self._spelled(word) not in self.letters and not self._ways(word)]
        numbers = self.letters.get(self._spelled(letter))
        of_numbers = isinstance(numbers, sp.Expr) and not isinstance(numbers, sp.MatrixExpr)  # b3(y4) is a mistake
        if top_level(inner, 0, "COMMA") is None:
            timed = (
                len(inner) > 3 and inner[0].type == "NAME" and self._only_times(inner[2:-1]) and inner[1].type == "LPAR"
            )
            return letter if timed or (unknown == words and words and not of_numbers) else ""
        if of_numbers and not unknown:
            return ""
        if any("hat" in word for word in words) and key(f"{letter}hat") in self.known:
            return key(f"{letter}hat")
        known = first.setdefault(letter, words)
        return letter + next((word for word in words if word not in known), "").rstrip("0123456789")

    def _only_times(self, inner: Sequence[Token]) -> bool:
        """Return True for t, t + tau, s: times that are no letters of the target."""
        times = {"t", "s", "tau"} - set(self.letters)
        names = [t for t in inner if t.type == "NAME"]
        return bool(names) and all(t.type in ("PLUS", "MINUS") or t in times for t in inner)

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
        for line, end in split(tokens):
            rest = next((k for k, token in enumerate(line[:2]) if token.type == "EQUAL"), 0) + 1
            if rest == 2 and line[2:3] and line[2].type in ("LSQB", "LPAR") and (vector := self._label(line[2:])):
                line = [vector, *line[2 + next(k for k, t in enumerate(line[2:]) if t.type == "EQUAL") :]]
                out += [*line, end]
                continue
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
        related, begins = False, 0  # the present line has a left side, and begins there
        bullets = sum(bullet(tokens, k) for k in range(len(tokens)))
        following = [len(tokens) - 1] * len(tokens)
        for k in range(len(tokens) - 2, -1, -1):
            following[k] = k + 1 if tokens[k + 1].type != "_LINE" else following[k + 1]
        for k, token in enumerate(tokens):
            if token.type in OPENING:
                opened.append(token.type)
            elif token.type in CLOSING and opened:
                opened.pop()
            if not opened and bullet(tokens, k):
                if token.type == "MINUS" and bullets == 1:
                    self.refuse(
                        two_meanings(("a list", "a minus sign"), "leave the sign or the blank behind it out"), token
                    )
                continue
            if token.type != "_LINE" or ";" in token:
                related = related or token.type in ("EQUAL", "RELATION")
                related = related and (bool(opened) or token.type not in ("_LINE", "COMMA"))
                out.append(token)
                begins = len(out) if token.type == "_LINE" else begins
                continue
            after = tokens[following[k]]
            before = out[-1].type if out else "_LINE"
            if opened:
                goes_on = opened[-1] != "LSQB" or before in _CONTINUES or after.type in _GOES_ON | {"COMMA"}
                goes_on = goes_on and not ("quad" in token and opened[-1] == "LSQB" and before not in _CONTINUES)
            elif bullet(tokens, following[k]):
                goes_on = False
            else:
                goes_on = before in _CONTINUES - {"COMMA"} or (
                    after.type in _GOES_ON and before not in ("_LINE", "COMMA")
                )
                if goes_on and after.type == "MINUS" and before not in _CONTINUES:
                    if not related:
                        told = ("a line of its own", "going on with the line before")
                        self.refuse(two_meanings(told, "end the line before with ; or write both in one line"), after)
                    own = out[begins] if out[begins] not in self.known and out[begins + 1].type == "EQUAL" else None
                    # q = ..., and below it -q y3: q is not given by itself
                    below = takewhile(lambda each: each.type != "_LINE", tokens[following[k] :])
                    goes_on = own is None or own not in below
            if not goes_on:
                related, begins = False, len(out) + 1
                out.append(token)
        return out

    def _label(self, line: Sequence[Token]) -> Token | None:
        """Return the left side of a line as one token if the line begins with one."""
        end = next((k for k, token in enumerate(line[:200]) if token.type == "EQUAL"), None)
        if end is None or line[0].type not in ("D_DT", "NAME", "LPAR", "LSQB", "_MATRIX"):
            return None
        kinds = [f"NAME:{t}" if t.type == "NAME" else t.type for t in line[: end + 1]]
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
            if rate and key(f"{rate[1]}dot") in self.labels and "d" in self.letters:
                told = (f"the rate of {rate[1]}", "a letter of your own")
                self.refuse(two_meanings(told, f"for the rate write {rate[1]}' ="), line[0])
            if any(accent in name for accent in ("dot", "hat", ",")) or name in FUNCTIONS:
                there = ", ".join(re.sub("dot$", "'", each) for each in sorted(self.labels) if each not in LABELS)
                asked = f"asked for are {there}" if there else "one formula is asked for, so leave the left side out"
                self.refuse(f"the line {re.sub('dot$', chr(39), name)} is not asked for here; {asked}", line[0])
            self.known.add(name)
        return line[0].update(type="LABEL", value=name)

    def _spelled(self, name: str) -> str:
        """Return a name as it is known, in another spelling if need be."""
        if name in self.known or (name.startswith("d") and "d" in self.letters):
            return name
        return next((each for each in other_names(name) if each in self.known), name)

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
            if name == "sech" and " " in token and "h" in self.known:
                self.refuse(two_meanings(("sech", "sec of h"), "write sech(...) or sec(h)"), token)
            if name not in {*FUNCTIONS, *self.known} and not (name == "e" and after == "_POWER"):
                self.refuse(about_command(name), token)
            token = token.update(type="NAME", value=name)
            if name == "infty" and "infty" in self.bound:
                return [token]
        transpose = name == "T" and before in ("_POWER", "LBRACE")
        if token.type != "NAME" or transpose:
            return [token]
        name = self._spelled(name)
        if name in self.known or self.column(name):
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
        called = [each for each in FUNCTIONS if name.endswith(each) and len(self._ways(name.removesuffix(each))) == 1]
        if after == "LPAR" and len(called) == 1:  # ksin(y1)
            (way,) = self._ways(name.removesuffix(called[0]))
            return [*(token.update(value=part) for part in way), token.update(type="FUNCTION", value=called[0])]
        near = difflib.get_close_matches(name, self.letters, 1, 0.5)
        known = ", ".join(sorted(str(letter) for letter in self.letters.values() if letter.is_Symbol)[:40])
        guess = f', did you mean "{self.letters[near[0]]}"? There are' if near else "; there are"
        start = token.start_pos or 0
        typed = self.text[self.origin[start] : self.origin[(token.end_pos or start + 1) - 1] + 1]
        self.refuse(f'"{typed[:40]}" is no letter here{guess} {known}', token)

    def is_name(self, word: str) -> bool:
        """Return True for a word that may be a letter or a function here, or nearly one."""
        name = self._spelled(name_of(word))
        named = name in self.known or name in _NEVER_PROSE or name in self.functions or bool(self._ways(name))
        return named or bool(len(name) > 3 and difflib.get_close_matches(name, self.known, 1, 0.8))

    def column(self, name: str) -> list[Any]:
        """Return the letters that a letter without an index stands for: b1, b2, b3 for b; empty if it has none."""
        found = [self.letters[f"{name}{k}"] for k in range(1, 10) if f"{name}{k}" in self.letters]
        return found if len(found) > 1 and name not in self.letters else []

    def _ways(self, name: str) -> list[list[str]]:
        """Return ways to read a word as letters side by side, at most two."""
        ways: list[list[list[str]]] = [[[]], *([] for _ in name)]
        for end in range(1, len(name) + 1):
            for start in range(end):
                if ways[start] and self._spelled(key(name[start:end])) in self.letters:
                    ways[end] += [[*way, name[start:end]] for way in ways[start]]
            ways[end] = ways[end][:2]
        return ways[-1]
