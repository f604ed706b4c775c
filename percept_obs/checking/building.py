"""Building sympy from the tree of a formula, within limits of size and degree."""

import re
import unicodedata
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from math import prod
from typing import Any

import sympy as sp
from lark import Token, Tree

from percept_obs.checking.deciding import MATRICES, letters_in_a_row
from percept_obs.checking.limits import extent, refused, too_tall
from percept_obs.checking.points import key
from percept_obs.checking.refusing import two_meanings
from percept_obs.checking.tokens import FUNCTIONS
from percept_obs.checking.words import Words

LARGEST_POWER, LARGEST_DEGREE, LONGEST_INTEGER, LONGEST_PRODUCT = 20, 60, 40, 8
"""Largest exponent, degree of a power, digits of a power of an integer, and letters of matrices in a product."""

_RELATIONS = {
    sp.StrictLessThan: ("<", r"\lt"),
    sp.LessThan: ("<=", r"\le", r"\leq", r"\leqslant"),
    sp.StrictGreaterThan: (">", r"\gt"),
    sp.GreaterThan: (">=", r"\ge", r"\geq", r"\geqslant"),
    sp.Ne: ("!=", r"\ne", r"\neq"),
}


class Builder:
    """Turns a parsed tree into sympy: the method _x returns the value of a node that the grammar's rule x made.

    `sides` are the right sides of lines by the names on their left: a letter that has one is worth it.
    """

    def __init__(self, words: Words, sides: dict[str, tuple[Any, ...]]) -> None:
        self.words, self.letters, self.refuse, self.sides = words, words.letters, words.refuse, sides
        self.values: dict[str, tuple[Any, ...]] = {}
        self.uses: dict[str, set[str]] = {}
        self.rates: dict[str, sp.Symbol] = {}
        self.within: list[str] = []

    def side(self, name: str, at: Token) -> tuple[Any, ...]:
        """Return what a line says a letter is, computed once: a value for each part of a chain q = a = b."""
        if name in self.within:
            self.refuse(f'"{name}" is given by itself; begin with what is known', at)
        if name not in self.values:
            if len(self.within) >= LARGEST_POWER:
                self.refuse(f"more than {LARGEST_POWER} letters are given by each other; put some of them in", at)
            self.within.append(name)
            self.uses[name] = set()
            self.values[name] = tuple(self.written(self.value(side), side) for side in self.sides[name])
            self.within.pop()
        return self.values[name]

    def written(self, value: Any, node: Any) -> Any:
        """Return the value as it is; refuse its node if it is too large once all definitions are put in."""
        if isinstance(value, sp.Basic) and (why := refused(value)):
            self.refuse(why, node)
        return value

    def _letter(self, node: Token) -> Any:
        name = str(node)
        if self.within:
            self.uses[self.within[-1]].add(name)
        if name in self.letters:
            return self.letters[name]
        if name in self.words.bound:
            return self.words.bound[name]
        if name in self.sides:
            return self.side(name, node)[-1]
        if column := self.words.column(name):
            return sp.ImmutableMatrix(column)
        if name not in self.words.labels:
            self.refuse("only a matrix has a transpose, A^T", node)
        return self.rates.setdefault(name, sp.Symbol(name, real=True))

    def value(self, node: Any) -> Any:
        """Return the value of a tree or a token."""
        if isinstance(node, Tree):
            return getattr(self, f"_{node.data}")(node, *node.children)
        if node.type in ("NUMBER", "PI"):
            return sp.Rational(str(node)) if node.type == "NUMBER" else sp.pi
        return self._letter(node)

    def _scalar(self, node: Any) -> sp.Expr:
        value = self.value(node)
        if isinstance(value, MATRICES):
            if value.shape == (1, 1) and isinstance(value, sp.MatrixBase):
                return value[0, 0]
            self.refuse("a matrix cannot stand here", node)
        return value

    def _divisor(self, node: Any) -> sp.Expr:
        value = self.value(node)
        if isinstance(value, MATRICES) or value == 0:
            self.refuse("a matrix or zero cannot stand below a fraction", node)
        return value

    def related(self, left: Any, sign: str, right: Any, at: Any) -> sp.Basic:
        """Return an equation or an inequality of two values."""
        if sign in _EQUAL:
            return sp.Eq(left, right, evaluate=False)
        if any(side.has(sp.I) for side in (left, right)):
            self.refuse("a root of a negative number cannot be compared", at)
        sign = re.sub(r"\\not\s*=", "!=", sign)
        kind = next(relation for relation, signs in _RELATIONS.items() if sign in signs)
        return kind(left, right, evaluate=False)

    def _compared(self, left: Any, sign: Token, right: Any) -> sp.Basic:
        return self.related(self._scalar(left), sign, self._scalar(right), left)

    def _sum(self, tree: Tree, *parts: Any) -> Any:
        terms: list[Any] = []
        for sign, part in pairwise((None, *parts)):
            if isinstance(part, Token) and part.type in ("PLUS", "MINUS"):
                continue
            term = self.value(part)
            terms.append(-term if isinstance(sign, Token) and sign.type == "MINUS" else term)
            if getattr(term, "shape", ()) != getattr(terms[0], "shape", ()):
                shapes = {getattr(t, "shape", (1, 1)) for t in terms}
                if shapes != {(1, 1)}:
                    self.refuse("matrices of different shapes, or a matrix and a number, have no sum", part)
                terms = [t[0, 0] if isinstance(t, MATRICES) else t for t in terms]
        return sum(terms[1:], terms[0]) if isinstance(terms[0], MATRICES) else sp.Add(*terms)

    def _product(self, tree: Tree, *parts: Any) -> Any:
        factors: list[Any] = []
        size = 0
        for before, part in pairwise((None, *parts)):
            rule = part.data if isinstance(part, Tree) else ""
            if isinstance(before, Tree) and before.data == "over" and rule not in ("times", "over"):
                self._unclear(before, part)
            factor = self.value(part)
            if isinstance(factor, MATRICES):
                other = next((k for k in range(len(factors) - 1, -1, -1) if isinstance(factors[k], MATRICES)), None)
                if other is not None and factors[other].shape[1] != factor.shape[0]:
                    factors[other], factor = self._fitting(factors[other], before, factor, part)
                size += letters_in_a_row(factor)
                if size > LONGEST_PRODUCT:
                    self.refuse(f"more than {LONGEST_PRODUCT} letters of matrices stand in a row", part)
                if factors and isinstance(factors[-1], sp.MatrixBase) and isinstance(factor, sp.MatrixBase):
                    factors[-1] = self.written(factors[-1] * factor, part)
                    continue
            factors.append(factor)
        return (
            prod(factors[1:], start=factors[0]) if any(isinstance(f, MATRICES) for f in factors) else sp.Mul(*factors)
        )

    def _fitting(self, left: Any, before: Any, right: Any, part: Any) -> tuple[Any, Any]:
        """Return two factors that fit: [a, b] before a column is a row, [a, b]^T behind a matrix is a column."""
        part = part.children[0] if isinstance(part, Tree) and part.data == "times" else part
        rows, columns = _listed(before), isinstance(part, Tree) and part.data == "raised" and _listed(part.children[0])
        if rows and not _listed(part) and left.shape[0] == right.shape[0]:
            return left.T, right
        if columns and left.shape[1] == right.shape[1]:
            return left, right.T
        self.refuse("the sizes of these matrices do not fit", part)

    def _unclear(self, over: Tree, part: Any) -> None:
        """Refuse a/b c, where c may belong below or beside the fraction, but not 1/2 (a + b), where a blank tells."""
        divisor = over.children[0]
        end = divisor.end_pos if isinstance(divisor, Token) else divisor.meta.end_pos
        start = part.start_pos if isinstance(part, Token) else part.meta.start_pos
        between = self.words.plain[end:start]
        if isinstance(divisor, Token) and divisor.type == "NUMBER" and re.match(r"\s+(\\[A-Za-z]+\s*)?[(\[]", between):
            return
        told = ("only what stands directly behind the / is below it", "all that follows is below it")
        self.refuse(f"after a / it is not clear what is below it; {two_meanings(told, 'write brackets or *')}", part)

    def _times(self, tree: Tree, factor: Any) -> Any:
        return self.value(factor)

    def _over(self, tree: Tree, factor: Any) -> sp.Expr:
        return 1 / self._divisor(factor)

    def _negative(self, tree: Tree, sign: Token, factor: Any) -> Any:
        return -self.value(factor)

    def _raised(self, tree: Tree, base: Any, exponent: Any) -> sp.Expr:
        value = self.value(base)
        if exponent == "T" and (isinstance(value, MATRICES) or "T" not in self.letters):
            return value.T if isinstance(value, MATRICES) else value
        return self._power(tree, value, self._exponent_of(exponent))

    def _exponent_of(self, node: Any) -> sp.Expr:
        if isinstance(node, Token) and node.type == "RAISED":
            return sp.Rational(unicodedata.normalize("NFKC", node[:4]).replace("−", "-"))
        return self._scalar(node)

    def _power(self, tree: Tree, base: Any, exponent: sp.Expr) -> sp.Expr:
        if isinstance(base, sp.MatrixExpr) and exponent == -1 and not base.has(sp.MatAdd):
            return base.inv()
        if isinstance(base, MATRICES):
            self.refuse("of a matrix only the transpose is read, ^T", tree)
        if not exponent.is_Rational or exponent.q not in (1, 2) or abs(exponent) > LARGEST_POWER:
            self.refuse(f"exponents are whole or half numbers up to {LARGEST_POWER}", tree)
        if base == 0 and exponent <= 0:
            self.refuse("zero has no such power", tree)
        digits = max(map(len, map(str, base.as_numer_denom()))) if base.is_Rational else 0
        if extent(base).degree * abs(exponent) > LARGEST_DEGREE or digits * abs(exponent) > LONGEST_INTEGER:
            self.refuse("this power is too large to be compared; there must be a smaller way to write it", tree)
        return base**exponent

    def _rate(self, tree: Tree, sign: Token, inner: Any) -> sp.Expr:
        """Return the rate of an expression, d/dt (1/Z), by the rates of its letters; others are constant."""
        value = self._scalar(inner)
        names = {s: key(f"{s.name}dot") for s in value.free_symbols}
        known = (*self.letters, *self.words.labels)
        return sp.Add(
            *(value.diff(s) * self._letter(Token("NAME", name)) for s, name in names.items() if name in known)
        )

    def _exponential(self, tree: Tree, base: Token, exponent: Any) -> sp.Expr:
        return self._applied(sp.exp, exponent)

    def _applied(self, function: Callable[[sp.Expr], sp.Expr], argument: Any) -> sp.Expr:
        value = self._scalar(argument)
        if too_tall(value):
            self.refuse("no function of such a large number can be compared", argument)
        return function(value)

    def _absolute(self, tree: Tree, inner: Any) -> sp.Expr:
        value = self.value(inner)
        return self._norm(tree, inner) if isinstance(value, MATRICES) else self._applied(sp.Abs, inner)

    def _norm(self, tree: Tree, inner: Any) -> sp.Expr:
        """Return the Euclidean norm, by the function `norm` where vectors are letters."""
        value = self.value(inner)
        if not isinstance(value, MATRICES):
            return sp.Abs(value)
        if isinstance(value, sp.MatrixBase) and 1 in value.shape:
            return sp.sqrt(sp.Add(*(entry**2 for entry in value)))
        if "norm" not in self.words.functions:
            self.refuse("norms of vectors with one column are read", tree)
        return self.words.functions["norm"](value)

    def _fraction(self, tree: Tree, above: Any, below: Any) -> Any:
        return self.value(above) / self._divisor(below)

    def _root(self, tree: Tree, inner: Any) -> sp.Expr:
        return self._applied(sp.sqrt, inner)

    def _function(self, tree: Tree, name: Token, *parts: Any) -> sp.Expr:
        if name == "norm":
            return self._norm(tree, parts[-1])
        if name in ("sgn", "sign") and "signs" in self.words.functions:
            argument = self.value(parts[-1])
            return self.words.functions["signs"](argument) if isinstance(argument, MATRICES) else sp.sign(argument)
        value = self._applied(FUNCTIONS[name], parts[-1])
        if value.has(sp.zoo, sp.nan, sp.oo):
            self.refuse(f"{name} has no value there", tree)
        return self._power(tree, value, self._exponent_of(parts[0])) if len(parts) > 1 else value

    def _integral(self, tree: Tree, body: Any, letter: Token, lower: Any, upper: Any) -> Any:
        value, ends = self.value(body), (self._scalar(lower), self._scalar(upper))
        return sp.Integral(value, (self.value(letter), *ends))

    def _user_function(self, tree: Tree, name: Token, *arguments: Any) -> Any:
        function, values = self.words.functions[name], [*map(self.value, arguments)]
        of_matrices = isinstance(function, type) and issubclass(function, sp.MatrixExpr)
        if of_matrices and not all(isinstance(value, MATRICES) for value in values):
            self.refuse(f"{name} is of matrices", tree)
        return function(*values)

    def _listed(self, tree: Tree, *entries: Any) -> sp.ImmutableMatrix:
        return self._entries(tree, [[entry] for entry in entries])

    def _matrix(self, tree: Tree, *lists: Any) -> Any:
        rows = [each.children for each in lists]
        if len(rows) == 1:
            inner = [entry.data if isinstance(entry, Tree) else "" for entry in rows[0]]
            if len(rows[0]) == 1 and inner != ["matrix"] and isinstance(value := self.value(rows[0][0]), MATRICES):
                return value  # a bracket around matrices
            lines = [self._row(e) if d == "matrix" else [e] for e, d in zip(rows[0], inner, strict=True)]
            return self._entries(tree, lines)
        return self._entries(tree, [[e] for row in rows for e in row] if len({*map(len, rows)}) > 1 else rows)

    def _row(self, entry: Tree) -> Sequence[Any]:
        return [e for each in entry.children for e in each.children]

    def _printed_matrix(self, tree: Tree, *rows: Any) -> sp.ImmutableMatrix:
        return self._entries(tree, [row.children for row in rows])

    def _entries(self, tree: Tree, rows: Iterable[Sequence[Any]]) -> sp.ImmutableMatrix:
        values = [[self.value(entry) for entry in row] for row in rows]
        if all(len(row) == 1 for row in values):  # columns below each other are one
            values = [[e] for row in values for e in (row[0] if isinstance(row[0], sp.MatrixBase) else row)]
        if len({len(row) for row in values}) != 1 or any(isinstance(e, MATRICES) for row in values for e in row):
            self.refuse("the rows of a matrix have the same number of entries, all of them numbers", tree)
        return sp.ImmutableMatrix(values)

    def _cases(self, tree: Tree, *branches: Any) -> sp.Expr:
        return sp.Piecewise(*(self._branch(*branch.children) for branch in branches))

    def _branch(self, value: Any, *condition: Any) -> tuple[sp.Expr, sp.Basic]:
        parts = [part for part in condition if not (isinstance(part, Token) and part.type in ("COMMA", "DOT"))]
        return self._scalar(value), self._compared(*parts) if len(parts) > 1 else sp.true


_EQUAL = ("=", "==", ":=")


def _listed(node: Any) -> bool:
    """Return True for [a, b], typed with commas."""
    return (
        isinstance(node, Tree)
        and node.data == "matrix"
        and [len(part.children) > 1 for part in node.children] == [True]
    )
