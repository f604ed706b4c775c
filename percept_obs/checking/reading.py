"""Reading a formula: text or LaTeX becomes sympy, built from listed letters and nothing else.

lines    = line { newline | ";" | "," line }
line     = [ label "=" ] sum { "=" sum } | sum ("<" | "<=" | ">" | ">=" | "!=") sum
sum      = [ "+" | "-" ] product { ("+" | "-") product }
product  = power { ["*" | "/"] power }                 without a sign: times
power    = primary [ "^" number ]
primary  = number | name | function "(" sum ")" | "(" sum ")" | matrix | LaTeX's fraction, root, brackets
"""

import difflib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from math import prod
from typing import Any

import sympy as sp

from percept_obs.checking.deciding import MATRICES, degree, letters_in_a_row
from percept_obs.checking.points import key
from percept_obs.checking.tokens import FUNCTIONS, CannotRead, Cursor, Functions, Token

DEEPEST, LARGEST_POWER, LARGEST_DEGREE, LONGEST_INTEGER, LONGEST_PRODUCT = 40, 20, 60, 40, 8
_RELATIONS = {"<": sp.StrictLessThan, "<=": sp.LessThan, ">": sp.StrictGreaterThan, ">=": sp.GreaterThan, "!=": sp.Ne}
_BEGINS = {"name", "(", "{", "[", "command", "function", "|left", "begin matrix", "begin cases"}


@dataclass(frozen=True)
class Reading:
    """A line that was read.

    Parameters
    ----------
    name : str
        What stands on the left, in letters and digits: "y1dot"; empty if there is nothing.
    formula : sympy expression, matrix or relation
    """

    name: str
    formula: sp.Basic


def read(
    text: str, letters: Mapping[str, Any], labels: Sequence[str] = (), functions: Functions | None = None
) -> list[Reading]:
    """The lines of a text.

    Parameters
    ----------
    text : str
        As typed, "y1' = a13 + (a11 - a33) y1 + ...", or LaTeX as sympy prints it.  A line that gives a new letter a
        meaning, "q = a31 y1 + a32 y2 + a33", is not returned; the letter means that from there on.
    letters : mapping of names without underscores to symbols
        Symbols of matrices as well; the inverse of one is ``P^-1``.
    labels : sequence of str
        What may stand on the left besides letters.
    functions : mapping of names to functions, optional
        What may be taken besides the usual functions, of numbers or matrices: ``norm(e1)``, ``inner(e1, e2)``.

    Raises
    ------
    CannotRead
        If the text is no formula of these letters; it says where, and what is allowed.

    Examples
    --------
    >>> x, y = sp.symbols("x y1")
    >>> read("y1' = 2x(x - 3/4)^2", {"x": x, "y1": y}, ["y1dot"])
    [Reading(name='y1dot', formula=2*x*(x - 3/4)**2)]
    >>> read("x + z", {"x": x})
    Traceback (most recent call last):
        ...
    percept_obs.checking.tokens.CannotRead: "z" is no letter here; there are x
        x + z
            ^
    """
    return _Parser(text, letters, labels, functions or {}).lines()


def words_of(text: str, letters: Mapping[str, sp.Expr], labels: Sequence[str] = ()) -> list[Token]:
    """The words of a text as `read` understands them, letters side by side apart, as far as it can be read."""
    parser = _Parser(text, letters, labels, {})
    with suppress(CannotRead):
        parser.lines()
    return parser.tokens


class _Parser(Cursor):
    def __init__(self, text: str, letters: Mapping[str, Any], labels: Sequence[str], functions: Functions) -> None:
        super().__init__(text)
        self.letters, self.labels, self.functions, self.depth = dict(letters), set(labels), functions, 0

    def lines(self) -> list[Reading]:
        found: list[Reading] = []
        while self.now.kind != "end":
            if not self.takes("line", ","):
                found += self.line()
                if self.now.kind not in ("line", ",", "end"):
                    raise self.refusal(self.stray())
        if not found:
            raise self.refusal('there is no formula; type one, such as "y1 + 2 y2"')
        return found

    def stray(self) -> str:
        if self.now.kind in (")", "]", "}", "|right"):
            return "this bracket was never opened"
        if self.now.kind == "number":
            return "a number after a factor can mean two things; write * or ^ before it"
        return "an operator or the end of the line is expected here"

    def line(self) -> list[Reading]:
        start = self.at
        name, end = self.label()
        if not name:
            self.at = start
            first, left = self.now, self.sum()
            if self.now.kind in _RELATIONS:
                return [Reading("", self.relation(left, first))]
            if not self.takes("="):
                return [Reading("", left)]
            return [Reading("", sp.Eq(left, self.sum(), evaluate=False))]
        values = [self.sum()]
        while self.takes("="):
            values.append(self.sum())
        if not all(part in self.labels or part in self.letters for part in name.split(",")):
            if any(accent in name for accent in ("dot", "hat", ",")) or name in FUNCTIONS:
                raise self.refusal(f'there is no line "{name}"; there are {", ".join(sorted(self.labels))}', end)
            self.letters[name] = values[-1]
            return []
        return [Reading(name, value) for value in values]

    def label(self) -> tuple[str, Token]:
        """What stands on the left of a line, if it is a name; of a column of rates all entries."""
        first, rate = self.now, self.takes("d/dt") is not None
        names: list[str] = []
        bracket = self.takes("[")
        column = self.takes("begin matrix")
        while token := self.takes("name"):
            names.append(key(token.text))
            if not column or not self.takes("row"):
                break
        if column and not (self.takes("end matrix") and (not bracket or self.takes("]"))):
            return "", first
        if names and self.takes("^") and (self.takes("{") or True):
            power = self.takes("name")
            names[-1] += power.text if power and power.text == "T" else " "
            self.takes("}")
        if names == ["J"] and self.takes("("):
            self.takes("name")
            self.takes(")")
        joined = ",".join(key(f"{name}dot") if rate else name for name in names)
        return (joined, first) if names and " " not in joined and self.takes("=") else ("", first)

    def sum(self) -> Any:
        terms: list[Any] = []
        sign = self.takes("+", "-")
        while True:
            start = self.now
            term = self.product()
            terms.append(-term if sign and sign.kind == "-" else term)
            if len({getattr(t, "shape", ()) for t in terms}) > 1:
                raise self.refusal("matrices of different shapes, or a matrix and a number, have no sum", start)
            sign = self.takes("+", "-")
            if sign is None:
                return sum(terms[1:], terms[0]) if isinstance(terms[0], MATRICES) else sp.Add(*terms)

    def product(self) -> Any:
        factors, divided = [self.power()], False
        while True:
            operator = self.takes("*", "/")
            if operator is None:
                if self.now.kind not in _BEGINS:
                    break
                if divided:
                    raise self.refusal("after a / it is not clear what is below it; write brackets or *")
            start, negative = self.now, operator is not None and self.takes("-") is not None
            factor = -self.power() if negative else self.power()
            divided = operator is not None and operator.kind == "/"
            factors.append(1 / self.divisor(factor, start) if divided else factor)
            self.refuse_sizes(factors, start)
        if any(isinstance(factor, MATRICES) for factor in factors):
            return prod(factors[1:], start=factors[0])
        return sp.Mul(*factors)

    def divisor(self, value: Any, start: Token) -> sp.Expr:
        if isinstance(value, MATRICES) or value == 0:
            raise self.refusal("a matrix or zero cannot stand below a fraction", start)
        return value

    def scalar(self, value: Any, start: Token) -> sp.Expr:
        if isinstance(value, MATRICES):
            raise self.refusal("a matrix cannot stand here", start)
        return value

    def refuse_sizes(self, factors: Sequence[Any], start: Token) -> None:
        shapes = [factor.shape for factor in factors if isinstance(factor, MATRICES)]
        if any(left[1] != right[0] for left, right in pairwise(shapes)):
            raise self.refusal("the sizes of these matrices do not fit", start)
        if sum(map(letters_in_a_row, factors)) > LONGEST_PRODUCT:
            raise self.refusal(f"more than {LONGEST_PRODUCT} letters of matrices stand in a row", start)

    def power(self) -> sp.Expr:
        start = self.now
        base = self.primary()
        if raised := self.takes("raised"):
            return self.raised(base, sp.Integer(int(raised.text[:4])), start)
        if not self.takes("^"):
            return base
        if start.kind == "name" and start.text == "e" and "e" not in self.letters:
            return sp.exp(self.exponent())
        if self.now.kind in ("name", "{") and isinstance(base, MATRICES):
            braces, letter = self.takes("{"), self.takes("name")
            if letter and letter.text == "T" and (not braces or self.takes("}")):
                return base.T
        exponent = self.exponent()
        if self.now.kind in ("^", "raised"):
            raise self.refusal("a power of a power needs brackets: (x^2)^3")
        return self.raised(base, exponent, start)

    def exponent(self) -> sp.Expr:
        start, negative = self.now, self.takes("-") is not None
        value = self.scalar(self.primary(), start)
        return -value if negative else value

    def raised(self, base: sp.Expr, exponent: sp.Expr, start: Token) -> sp.Expr:
        if isinstance(base, sp.MatrixExpr) and exponent == -1 and not base.has(sp.MatAdd):
            return base.inv()
        if isinstance(base, MATRICES):
            raise self.refusal("of a matrix only the transpose is read, ^T", start)
        if not exponent.is_Rational or exponent.q not in (1, 2) or abs(exponent) > LARGEST_POWER:
            raise self.refusal(f"exponents are whole or half numbers up to {LARGEST_POWER}", start)
        if base == 0 and exponent <= 0:
            raise self.refusal("zero has no such power", start)
        if degree(base) * abs(exponent) > LARGEST_DEGREE or (
            base.is_Rational and max(map(len, map(str, base.as_numer_denom()))) * abs(exponent) > LONGEST_INTEGER
        ):
            raise self.refusal("this power is too large to be compared; there must be a smaller way to write it", start)
        return base**exponent

    def primary(self) -> Any:
        self.depth += 1
        if self.depth > DEEPEST:
            raise self.refusal(f"brackets are nested more than {DEEPEST} deep; write the formula flatter")
        result = self.atom()
        self.depth -= 1
        return result

    def atom(self) -> Any:
        token = self.now
        self.at += token.kind != "end"
        if token.kind == "number":
            return sp.Rational(token.text)
        if token.kind == "name":
            return self.letter(token)
        if token.kind in ("(", "{"):
            inner = self.sum()
            self.needs({"(": ")", "{": "}"}[token.kind], f"the bracket {token.kind} is not closed")
            return inner
        if token.kind == "|left":
            inner = self.scalar(self.sum(), token)
            self.needs("|right", "the bar | is not closed")
            return sp.Abs(inner)
        if token.kind == "[":
            matrix = self.printed_matrix() if self.takes("begin matrix") else self.rows()
            self.needs("]", "the bracket [ is not closed")
            return matrix
        if token.kind == "begin matrix":
            return self.printed_matrix()
        if token.kind == "begin cases":
            return self.cases()
        if token.kind in ("command", "function"):
            return self.command(token)
        if token.kind == "end":
            raise self.refusal("the formula ends too early: a number, a letter or a bracket is expected", token)
        raise self.refusal("a number, a letter or a bracket is expected here", token)

    def command(self, token: Token) -> Any:
        if token.text in ("frac", "dfrac", "tfrac"):
            above, below_at = self.group(), self.now
            below = self.group()
            return above / self.divisor(below, below_at)
        if token.text == "sqrt":
            return sp.sqrt(self.scalar(self.group(), token))
        if token.text in FUNCTIONS:
            return self.function(token)
        raise self.refusal(f"\\{token.text} is not read; there are \\frac, \\sqrt, Greek letters, matrices", token)

    def group(self) -> Any:
        self.needs("{", "a brace { is expected here")
        inner = self.sum()
        self.needs("}", "the brace { is not closed")
        return inner

    def own_function(self, token: Token) -> Any:
        self.needs("(", f"what {token.text} is taken of stands in brackets: {token.text}(...)")
        parts = [self.sum()]
        while not self.takes(")"):
            self.needs(",", "the bracket ( is not closed")
            parts.append(self.sum())
        return self.functions[token.text](*parts)

    def function(self, token: Token) -> sp.Expr:
        exponent = self.exponent() if self.takes("^") else sp.S.One
        if self.now.kind not in ("(", "{"):
            raise self.refusal(f"what {token.text} is taken of stands in brackets: {token.text}(...)")
        value = FUNCTIONS[token.text](self.scalar(self.atom(), token))
        if value.has(sp.zoo, sp.nan, sp.oo):
            raise self.refusal(f"{token.text} has no value there", token)
        return value if exponent == 1 else self.raised(value, exponent, token)

    def letter(self, token: Token) -> Any:
        name = token.text
        if key(name) in self.letters:
            return self.letters[key(name)]
        if name in self.functions:
            return self.own_function(token)
        if name in FUNCTIONS and self.now.kind in ("(", "{", "^"):
            return self.function(token)
        if name == "pi" or (name == "e" and self.now.kind == "^"):
            return sp.pi if name == "pi" else sp.E
        ways = self.split(name)
        if len(ways) == 1:
            # the letters become words of their own, so that a power belongs to the last of them
            self.tokens[self.at - 1 : self.at] = [Token("name", part, token.position) for part in ways[0]]
            return self.letters[key(ways[0][0])]
        if ways:
            raise self.refusal(f'"{name}" can be read as {" or ".join(map(" ".join, ways))}; write * between', token)
        near = difflib.get_close_matches(name, self.letters, 1, 0.5)
        known = ", ".join(sorted(str(letter) for letter in self.letters.values() if letter.is_Symbol)[:40])
        guess = f', did you mean "{self.letters[near[0]]}"? There are' if near else "; there are"
        raise self.refusal(f'"{name[:40]}" is no letter here{guess} {known}', token)

    def split(self, name: str) -> list[list[str]]:
        """Ways to read a word as letters side by side; two are enough to know that there are several."""
        ways: list[list[list[str]]] = [[[]], *([] for _ in name)]
        for end in range(1, len(name) + 1):
            for start in range(end):
                if key(name[start:end]) in self.letters:
                    ways[end] += [[*way, name[start:end]] for way in ways[start]]
            ways[end] = ways[end][:2]
        return ways[-1]

    def rows(self) -> sp.ImmutableMatrix:
        """[a, b] is a column, [[a, b], [c, d]] has rows."""
        opened, rows = self.now, []
        while True:
            nested = self.takes("[")
            rows.append([self.sum()])
            while nested and self.takes(","):
                rows[-1].append(self.sum())
            if nested:
                self.needs("]", "the bracket [ is not closed")
            if not self.takes(",", "line"):
                return self.matrix(rows, opened)

    def printed_matrix(self) -> sp.ImmutableMatrix:
        opened, rows = self.now, [[self.sum()]]
        while separator := self.takes("cell", "row"):
            if separator.kind == "row":
                rows.append([])
            rows[-1].append(self.sum())
        self.needs("end matrix", "the matrix is not closed")
        return self.matrix(rows, opened)

    def matrix(self, rows: list[list[sp.Expr]], opened: Token) -> sp.ImmutableMatrix:
        if len({len(row) for row in rows}) != 1 or any(isinstance(e, MATRICES) for row in rows for e in row):
            raise self.refusal("the rows of a matrix have the same number of entries, all of them numbers", opened)
        return sp.ImmutableMatrix(rows)

    def cases(self) -> sp.Expr:
        branches = []
        while True:
            value = self.sum()
            self.needs("cell", "a branch is a value & its condition")
            words = self.needs("command", "the condition begins with \\text{for} or is \\text{otherwise}")
            branches.append((value, self.condition(words)))
            if not self.takes("row"):
                self.needs("end cases", "the cases are not closed")
                return sp.Piecewise(*branches)

    def condition(self, words: Token) -> sp.Basic:
        self.needs("{", "\\text{for} or \\text{otherwise} is expected")
        said = self.needs("name", "\\text{for} or \\text{otherwise} is expected").text
        self.needs("}", "the brace { is not closed")
        if said == "otherwise":
            return sp.true
        first, left = self.now, self.sum()
        if words.text != "text" or said != "for" or self.now.kind not in _RELATIONS:
            raise self.refusal("a condition is two sides with <, <=, >, >= or != between them")
        return self.relation(left, first)

    def relation(self, left: Any, first: Token) -> sp.Basic:
        sign = self.needs(self.now.kind, "a relation is expected here")
        start, right = self.now, self.sum()
        sides = self.scalar(left, first), self.scalar(right, start)
        if any(side.has(sp.I) for side in sides):
            raise self.refusal("a root of a negative number cannot be compared", first)
        return _RELATIONS[sign.kind](*sides, evaluate=False)
