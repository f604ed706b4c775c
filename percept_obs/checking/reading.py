"""Reading a formula: text or LaTeX becomes sympy, built from listed letters and nothing else."""

import difflib
import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import pairwise
from math import prod
from pathlib import Path
from typing import Any, NoReturn

import sympy as sp
from lark import Lark, Token, Tree, UnexpectedCharacters, UnexpectedToken

from percept_obs.checking.deciding import MATRICES, degree, letters_in_a_row
from percept_obs.checking.points import key

LONGEST, LONGEST_NUMBER, LONGEST_WORD = 9000, 15, 60
DEEPEST, LARGEST_POWER, LARGEST_DEGREE, LONGEST_INTEGER, LONGEST_PRODUCT = 40, 20, 60, 40, 8

Functions = Mapping[str, Callable[..., Any]]
_NAMED = (sp.sin, sp.cos, sp.tan, sp.asin, sp.acos, sp.atan, sp.sinh, sp.cosh, sp.tanh, sp.sech, sp.exp, sp.log)
FUNCTIONS: Functions = {
    **{f.__name__: f for f in (*_NAMED, sp.sqrt, sp.sign)},
    **{"abs": sp.Abs, "sgn": sp.sign, "ln": sp.log, "arctan": sp.atan, "arcsin": sp.asin, "arccos": sp.acos},
}
_RELATIONS = {
    sp.StrictLessThan: ("<", r"\lt"),
    sp.LessThan: ("<=", r"\le", r"\leq"),
    sp.StrictGreaterThan: (">", r"\gt"),
    sp.GreaterThan: (">=", r"\ge", r"\geq"),
    sp.Ne: ("!=", r"\ne", r"\neq"),
}

_GREEK = """alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho sigma tau upsilon
phi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega"""
_ACCENTS = {"\u0302": "hat", "\u0304": "bar", "\u0307": "dot", "\u0303": "tilde"}
_REPLACED = {
    **dict(zip("αβγδεζηθικλμνξοπρστυφχψωΓΔΘΛΞΠΣΦΨΩ", _GREEK.split(), strict=True)),
    **dict(zip("₀₁₂₃₄₅₆₇₈₉", "0123456789", strict=True)),
    **dict(zip("−–·⋅×′’⟨⟩≠≤≥", ("-", "-", "*", "*", "*", "'", "'", "(", ")", "!=", "<=", ">="), strict=True)),
}
_NAME = r"NAME:(\w+)"
_LABEL = re.compile(
    rf"(D_DT )?({_NAME}( _POWER (LBRACE )?NAME:T( RBRACE)?)?|NAME:J LPAR {_NAME} RPAR|"
    rf"(LSQB )?_MATRIX {_NAME}( _ROW {_NAME})* _END_MATRIX( RSQB)?) EQUAL"
)
_OPENING, _CLOSING = (
    {"LPAR": "(", "LBRACE": "{", "LSQB": "[", "_BAR_OPEN": "|", "_MATRIX": r"\begin", "_CASES": r"\begin"},
    {"RPAR": "(", "RBRACE": "{", "RSQB": "[", "_BAR_CLOSE": "|", "_END_MATRIX": r"\begin", "_END_CASES": r"\begin"},
)


class CannotRead(ValueError):
    """A formula that cannot be read.

    Attributes
    ----------
    position : int
        Where, counted in characters from 0.

    See Also
    --------
    percept_obs.check : Raises it.
    """

    def __init__(self, text: str, position: int, message: str) -> None:
        self.position = position
        start = text.rfind("\n", 0, position) + 1
        end = text.find("\n", position) if "\n" in text[position:] else len(text)
        start, end = max(start, position - 50), min(end, position + 30)
        shown = "".join(c if c.isprintable() else " " for c in text[start:end])
        super().__init__(f"{message}\n    {shown}\n    {' ' * (position - start)}^")


@dataclass(frozen=True)
class Reading:
    """Line that was read: its left side in letters and digits, such as "y1dot", or empty, and its formula."""

    name: str
    formula: sp.Basic


@dataclass(frozen=True)
class Definition:
    """Letter that a text gives a meaning, with its formulas, several in a chain q = a b = c, and if a line uses it."""

    name: str
    formulas: tuple[sp.Basic, ...]
    used: bool


@dataclass(frozen=True)
class Text:
    """All that was read: lines with the definitions put in, and these by themselves."""

    lines: tuple[Reading, ...]
    definitions: tuple[Definition, ...] = ()


def read(text: str, letters: Mapping[str, Any], labels: Iterable[str] = (), functions: Functions | None = None) -> Text:
    """Read the lines of a text, typed as "y1' = a13 + (a11 - a33) y1 + ..." or LaTeX as sympy prints it.

    A line that gives a new letter a meaning, "q = a31 y1 + a32 y2 + a33", is a definition; the letter has this meaning
    from there on.  Letters are named without underscores, matrices among them (the inverse of one is ``P^-1``); labels
    may stand on the left besides them, and functions besides the usual ones are of numbers or matrices: ``norm(e1)``.

    >>> x, y = sp.symbols("x y1")
    >>> read("y1' = 2x(x - 3/4)^2", {"x": x, "y1": y}, ["y1dot"]).lines
    (Reading(name='y1dot', formula=2*x*(x - 3/4)**2),)
    >>> read("x + z", {"x": x})
    Traceback (most recent call last):
        ...
    percept_obs.checking.reading.CannotRead: "z" is no letter here; there are x
        x + z
            ^
    """
    return _Reader(text, letters, labels, functions or {}).read()


def words_of(text: str, letters: Mapping[str, Any] | None = None, labels: Iterable[str] = ()) -> list[Token]:
    """Return the tokens of a text as `read` understands them, also where it is no formula; the last is "END"."""
    return _Reader(text, letters or {}, labels, {}).words(strict=False)


@cache
def _parser() -> Lark:
    grammar = (Path(__file__).parent / "formula.lark").read_text(encoding="utf-8")
    return Lark(grammar, parser="lalr", lexer="basic", start=["lines", "words"], propagate_positions=True)


@lru_cache(maxsize=256)
def _lexed(text: str) -> tuple[Token, ...]:
    return tuple(_parser().lex(text))


class _Reader:
    """Reads one text; a method named like a rule of the grammar returns the rule's value."""

    def __init__(self, text: str, letters: Mapping[str, Any], labels: Iterable[str], functions: Functions) -> None:
        self.text, self.letters, self.labels, self.functions = text, dict(letters), set(labels), functions
        self.known = set(letters)
        self.defined: dict[str, tuple[sp.Basic, ...]] = {}
        self.uses: dict[str, set[str]] = {"": set()}  # by each definition, and by lines
        self.place = ""
        pieces = [
            _REPLACED.get(c) or "".join(_REPLACED.get(d, d) for d in unicodedata.normalize("NFD", c)) for c in text
        ]
        self.plain = "".join(pieces)
        self.origin = [k for k, piece in enumerate(pieces) for _ in piece]

    def refuse(self, message: str, at: Any = None) -> NoReturn:
        """Raise CannotRead at a token or a tree, or at the end of the text."""
        start = at.start_pos if isinstance(at, Token) else at.meta.start_pos if isinstance(at, Tree) else at
        position = self.origin[start] if start is not None and start < len(self.origin) else len(self.text)
        raise CannotRead(self.text, position, message)

    def words(self, strict: bool = True) -> list[Token]:
        """Tokens with names told apart; what is refused stays as it is unless strict."""
        if len(self.text) > LONGEST:
            raise CannotRead(self.text, LONGEST, f"the formula has {len(self.text)} characters; at most {LONGEST}")
        try:
            raw = [*_lexed(self.plain), Token("END", "", len(self.plain))]
        except UnexpectedCharacters as error:
            position = self.origin[error.pos_in_stream or 0]
            raise CannotRead(self.text, position, _about_character(self.text[position])) from None
        raw = [token.update(value=_name(token)) if token.type == "NAME" else token for token in raw]
        found: list[Token] = []
        depth = matrices = at = 0
        while at < len(raw):
            token = raw[at]
            starts_line = not depth and (not found or found[-1].type in ("_LINE", "COMMA"))
            label = self.label(raw[at:]) if strict and starts_line else None
            if label:
                found.append(label)
                at = next(k for k in range(at, len(raw)) if raw[k].type == "EQUAL")
                continue
            depth += (token.type in _OPENING) - (token.type in _CLOSING)
            matrices += (token.type in ("_MATRIX", "_CASES")) - (token.type in ("_END_MATRIX", "_END_CASES"))
            try:
                if depth > DEEPEST:
                    self.refuse(f"brackets are nested more than {DEEPEST} deep; write the formula flatter", token)
                if matrices or token.type not in ("_ROW", "_CELL"):
                    found += self.told_apart(
                        token, raw[at - 1].type if at else "", raw[at + 1].type if at + 1 < len(raw) else ""
                    )
                elif token.type == "_ROW":  # between lines of LaTeX
                    found.append(token.update(type="_LINE"))
            except CannotRead:
                if strict:
                    raise
                found.append(token)
            at += 1
        return found

    def label(self, tokens: Sequence[Token]) -> Token | None:
        """Return the left side of a line as one token if the line begins with one."""
        if tokens[0].type not in ("D_DT", "NAME", "LSQB", "_MATRIX"):
            return None
        end = next((k for k, token in enumerate(tokens) if token.type in ("EQUAL", "_LINE")), 0) + 1
        kinds = [f"NAME:{token}" if token.type == "NAME" else token.type for token in tokens[:end]]
        kinds = [kind for kind in kinds if kind != "_CELL"]
        match = _LABEL.fullmatch(" ".join(kinds))
        if not match:
            return None
        names = ["J"] if "LPAR" in kinds else re.findall(_NAME, match[0])
        if "_POWER" in kinds:
            names = ["".join(names)]
        name = ",".join(key(f"{name}dot") if kinds[0] == "D_DT" else name for name in names)
        if not all(part in self.labels or part in self.known for part in name.split(",")):
            if any(accent in name for accent in ("dot", "hat", ",")) or name in FUNCTIONS:
                there = ", ".join(sorted(self.labels))
                self.refuse(f'there is no line "{name}"; there are {there}', tokens[0])
            self.known.add(name)
        return tokens[0].update(type="LABEL", value=name)

    def told_apart(self, token: Token, before: str, after: str) -> list[Token]:
        """Replace a name by a letter, a function or several letters side by side, and refuse what has no meaning."""
        name = str(token)
        if token.type == "NUMBER" and len(name) > LONGEST_NUMBER:
            self.refuse(f"numbers have at most {LONGEST_NUMBER} digits", token)
        if token.type == "COMMAND":
            name = re.sub(r"\\operatorname|\W", "", name)
            if name not in FUNCTIONS:
                self.refuse(_about_command(name), token)
            return [token.update(type="FUNCTION", value=name)]
        transpose = name == "T" and before in ("_POWER", "LBRACE")
        if token.type != "NAME" or name in self.known or transpose:
            return [token]
        kinds = {"pi": "PI"} | dict.fromkeys(FUNCTIONS, "FUNCTION") | dict.fromkeys(self.functions, "USER_FUNCTION")
        kinds |= {"e": "EULER"} if after == "_POWER" else {}
        if name in kinds:
            return [token.update(type=kinds[name])]
        if len(name) > LONGEST_WORD:
            self.refuse(f"a word has more than {LONGEST_WORD} letters; write * between letters", token)
        ways = self.split(name)
        if len(ways) == 1:  # words of their own, so that a power belongs to the last of them
            return [token.update(value=key(part)) for part in ways[0]]
        if ways:
            self.refuse(f'"{name}" can be read as {" or ".join(map(" ".join, ways))}; write * between', token)
        near = difflib.get_close_matches(name, self.letters, 1, 0.5)
        known = ", ".join(sorted(str(letter) for letter in self.letters.values() if letter.is_Symbol)[:40])
        guess = f', did you mean "{self.letters[near[0]]}"? There are' if near else "; there are"
        start = token.start_pos or 0
        typed = self.text[self.origin[start] : self.origin[(token.end_pos or start + 1) - 1] + 1]
        self.refuse(f'"{typed[:40]}" is no letter here{guess} {known}', token)

    def split(self, name: str) -> list[list[str]]:
        """Return ways to read a word as letters side by side, at most two."""
        ways: list[list[list[str]]] = [[[]], *([] for _ in name)]
        for end in range(1, len(name) + 1):
            for start in range(end):
                if key(name[start:end]) in self.known:
                    ways[end] += [[*way, name[start:end]] for way in ways[start]]
            ways[end] = ways[end][:2]
        return ways[-1]

    def read(self) -> Text:
        state = _parser().parse_interactive(start="lines")
        *words, end = self.words()
        try:
            for token in words:
                state.feed_token(token)
            tree = state.feed_eof(end)
        except UnexpectedToken as error:
            self.refuse(_about_token(error.token, state.accepts()), error.token)
        found = [reading for line in tree.children for reading in self.value(line)]
        if not tree.children:
            self.refuse('there is no formula; type one, such as "y1 + 2 y2"')
        used = self.uses[""]
        for name in reversed(self.defined):
            used |= self.uses[name] if name in used else set()
        return Text(tuple(found), tuple(Definition(n, values, n in used) for n, values in self.defined.items()))

    def value(self, node: Any) -> Any:
        if isinstance(node, Tree):
            return getattr(self, node.data)(node, *node.children)
        if node.type in ("NUMBER", "PI"):
            return sp.Rational(str(node)) if node.type == "NUMBER" else sp.pi
        if node not in self.letters:
            self.refuse("only a matrix has a transpose, A^T", node)
        self.uses[self.place].add(str(node))
        return self.letters[node]

    def scalar(self, node: Any) -> sp.Expr:
        value = self.value(node)
        if isinstance(value, MATRICES):
            self.refuse("a matrix cannot stand here", node)
        return value

    def divisor(self, node: Any) -> sp.Expr:
        value = self.value(node)
        if isinstance(value, MATRICES) or value == 0:
            self.refuse("a matrix or zero cannot stand below a fraction", node)
        return value

    def named(self, tree: Tree, label: Token, *sides: Any) -> list[Reading]:
        known = all(part in self.labels or part in self.letters for part in label.split(","))
        self.place = "" if known else str(label)
        self.uses.setdefault(self.place, set())
        values = tuple(self.value(side) for side in sides)
        self.place = ""
        if known:
            return [Reading(str(label), value) for value in values]
        self.letters[str(label)] = values[-1]
        self.defined[str(label)] = values
        return []

    def unnamed(self, tree: Tree, side: Any) -> list[Reading]:
        return [Reading("", self.value(side))]

    def equation(self, tree: Tree, left: Any, right: Any) -> list[Reading]:
        return [Reading("", sp.Eq(self.value(left), self.value(right), evaluate=False))]

    def relation(self, tree: Tree, *parts: Any) -> list[Reading]:
        return [Reading("", self.compared(*parts))]

    def compared(self, left: Any, sign: Token, right: Any) -> sp.Basic:
        sides = self.value(left), self.value(right)
        if any(side.has(sp.I) for side in sides):
            self.refuse("a root of a negative number cannot be compared", left)
        return next(relation for relation, signs in _RELATIONS.items() if sign in signs)(*sides, evaluate=False)

    def sum(self, tree: Tree, *parts: Any) -> Any:
        terms: list[Any] = []
        for sign, part in pairwise((None, *parts)):
            if isinstance(part, Token) and part.type in ("PLUS", "MINUS"):
                continue
            term = self.value(part)
            terms.append(-term if isinstance(sign, Token) and sign.type == "MINUS" else term)
            if getattr(term, "shape", ()) != getattr(terms[0], "shape", ()):
                self.refuse("matrices of different shapes, or a matrix and a number, have no sum", part)
        return sum(terms[1:], terms[0]) if isinstance(terms[0], MATRICES) else sp.Add(*terms)

    def product(self, tree: Tree, *parts: Any) -> Any:
        factors: list[Any] = []
        for before, part in pairwise((None, *parts)):
            rule = part.data if isinstance(part, Tree) else ""
            if isinstance(before, Tree) and before.data == "over" and rule not in ("times", "over"):
                self.refuse("after a / it is not clear what is below it; write brackets or *", part)
            factors.append(self.value(part))
            shapes = [factor.shape for factor in factors if isinstance(factor, MATRICES)]
            if any(left[1] != right[0] for left, right in pairwise(shapes[-2:])):
                self.refuse("the sizes of these matrices do not fit", part)
            if isinstance(factors[-1], MATRICES) and sum(map(letters_in_a_row, factors)) > LONGEST_PRODUCT:
                self.refuse(f"more than {LONGEST_PRODUCT} letters of matrices stand in a row", part)
        return prod(factors[1:], start=factors[0]) if shapes else sp.Mul(*factors)

    def times(self, tree: Tree, factor: Any) -> Any:
        return self.value(factor)

    def over(self, tree: Tree, factor: Any) -> sp.Expr:
        return 1 / self.divisor(factor)

    def negative(self, tree: Tree, sign: Token, factor: Any) -> Any:
        return -self.value(factor)

    def raised(self, tree: Tree, base: Any, exponent: Any) -> sp.Expr:
        value = self.value(base)
        if exponent == "T" and isinstance(value, MATRICES):
            return value.T
        if isinstance(exponent, Token) and exponent.type == "RAISED":
            exponent = Token("NUMBER", unicodedata.normalize("NFKC", exponent[:4]), exponent.start_pos)
        return self.power(tree, value, self.scalar(exponent))

    def power(self, tree: Tree, base: Any, exponent: sp.Expr) -> sp.Expr:
        if isinstance(base, sp.MatrixExpr) and exponent == -1 and not base.has(sp.MatAdd):
            return base.inv()
        if isinstance(base, MATRICES):
            self.refuse("of a matrix only the transpose is read, ^T", tree)
        if not exponent.is_Rational or exponent.q not in (1, 2) or abs(exponent) > LARGEST_POWER:
            self.refuse(f"exponents are whole or half numbers up to {LARGEST_POWER}", tree)
        if base == 0 and exponent <= 0:
            self.refuse("zero has no such power", tree)
        digits = max(map(len, map(str, base.as_numer_denom()))) if base.is_Rational else 0
        if degree(base) * abs(exponent) > LARGEST_DEGREE or digits * abs(exponent) > LONGEST_INTEGER:
            self.refuse("this power is too large to be compared; there must be a smaller way to write it", tree)
        return base**exponent

    def exponential(self, tree: Tree, base: Token, exponent: Any) -> sp.Expr:
        return sp.exp(self.scalar(exponent))

    def absolute(self, tree: Tree, inner: Any) -> sp.Expr:
        return sp.Abs(self.scalar(inner))

    def fraction(self, tree: Tree, above: Any, below: Any) -> Any:
        return self.value(above) / self.divisor(below)

    def root(self, tree: Tree, inner: Any) -> sp.Expr:
        return sp.sqrt(self.scalar(inner))

    def function(self, tree: Tree, name: Token, *parts: Any) -> sp.Expr:
        value = FUNCTIONS[name](self.scalar(parts[-1]))
        if value.has(sp.zoo, sp.nan, sp.oo):
            self.refuse(f"{name} has no value there", tree)
        return self.power(tree, value, self.scalar(parts[0])) if len(parts) > 1 else value

    def user_function(self, tree: Tree, name: Token, *arguments: Any) -> Any:
        return self.functions[name](*map(self.value, arguments))

    def matrix(self, tree: Tree, *entries: Any) -> sp.ImmutableMatrix:
        inner = [entry.data if isinstance(entry, Tree) else "" for entry in entries]
        if inner == ["printed_matrix"]:
            return self.value(entries[0])
        return self.entries(tree, [e.children if d == "matrix" else [e] for e, d in zip(entries, inner, strict=True)])

    def printed_matrix(self, tree: Tree, *rows: Any) -> sp.ImmutableMatrix:
        return self.entries(tree, [row.children for row in rows])

    def entries(self, tree: Tree, rows: Iterable[Sequence[Any]]) -> sp.ImmutableMatrix:
        values = [[self.value(entry) for entry in row] for row in rows]
        if len({len(row) for row in values}) != 1 or any(isinstance(e, MATRICES) for row in values for e in row):
            self.refuse("the rows of a matrix have the same number of entries, all of them numbers", tree)
        return sp.ImmutableMatrix(values)

    def cases(self, tree: Tree, *branches: Any) -> sp.Expr:
        return sp.Piecewise(*(self.branch(*branch.children) for branch in branches))

    def branch(self, value: Any, *condition: Any) -> tuple[sp.Expr, sp.Basic]:
        return self.value(value), self.compared(*condition) if len(condition) > 1 else sp.true


def _name(token: Token) -> str:
    """Return the key of a name, accents at its end."""
    marks = "".join(_ACCENTS)
    accents = [*re.findall(r"\\(hat|bar|dot|tilde)", token), *(_ACCENTS[c] for c in token if c in _ACCENTS)]
    plain = re.sub(rf"\\(hat|bar|dot|tilde)\b|[{marks}',]", "", token)
    return key(plain + "".join(accents) + "dot" * token.count("'"))


def _about_character(c: str) -> str:
    name = unicodedata.name(c, "a control character")
    if c == "_":
        return "an index is letters and digits, as in y_1 or v_{c1}"
    if c.isalpha():
        return f"{c!r} is {name}; letters are Latin or Greek, so type the letter that it looks like"
    return f"{c!r} ({name.lower()}) has no meaning in a formula; there are letters, numbers and + - * / ^ ( ) ="


def _about_command(name: str) -> str:
    if name in _ACCENTS.values():
        return rf"\{name} stands over a letter, as in \{name}{{y}}_{{1}}"
    if name in ("begin", "end"):
        return "of LaTeX's environments matrix, cases and aligned are read"
    return rf"\{name} is not read; there are \frac, \sqrt, Greek letters, matrices"


def _about_token(token: Token, accepted: set[str]) -> str:
    """Say why a token cannot stand where it does, from the kinds that can."""
    open_brackets = [_CLOSING[kind] for kind in accepted if kind in _CLOSING]
    if accepted <= {"LPAR", "LBRACE", "_POWER", "RAISED"}:
        return "a function takes its argument in brackets, as in sin(...), and a command in braces"
    if "NAME" in accepted and "_TIMES" not in accepted:
        end = token.type == "$END"
        return f"{'the formula ends too early: ' if end else ''}a number, a letter or a bracket is expected here"
    if token.type == "_POWER" or token.type == "RAISED":
        return "a power of a power needs brackets: (x^2)^3"
    if token.type == "NUMBER":
        return "a number after a factor can mean two things; write * or ^ before it"
    if open_brackets:
        return f"the bracket {open_brackets[0]} is not closed"
    if token.type in _CLOSING:
        return "this bracket was never opened"
    return "an operator or the end of the line is expected here"
