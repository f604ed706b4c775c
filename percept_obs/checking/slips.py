"""Slips: every formula that differs from another one in a single sign, factor, exponent or letter."""

import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import chain

import sympy as sp
from sympy.core.relational import Relational
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.matrices.exceptions import ShapeError
from sympy.matrices.expressions.applyfunc import ElementwiseApplyFunction

# Letters that stand beside each other in the papers, besides those that differ in an index or a hat.
FAMILIES = ("XYZ", "GAP", ("M", "gamma"), ("alpha", "lambda"))

Siblings = dict[tuple[bool, str], list[sp.Basic]]


@dataclass(frozen=True)
class Moves:
    """Kinds of slips, besides a letter for its sibling and an inverse or a transpose left out.

    A term is multiplied by one of the factors, 0 drops it; exponents are added, counted away from 0.
    """

    factors: Sequence[sp.Rational]
    exponents: Sequence[int] = (1,)


MISTAKES = Moves((-sp.S.One, sp.Integer(2), sp.S.Zero))
"""Slips that a student makes: a term may be dropped."""
MENDS = Moves((-sp.S.One, sp.S.Half, sp.Integer(2), sp.S.Zero, sp.Rational(1, 3), sp.Integer(3)), (-1, 1))
"""Changes that mend a slip."""


@dataclass(frozen=True)
class Slip:
    """Place where a formula was changed: "sign", "factor", "dropped", "exponent", "letter" or "left out".

    The path leads there, as arguments of arguments.  The term is the innermost one in which it happened, before the
    change; the formula is the whole one with it.
    """

    kind: str
    before: sp.Basic
    after: sp.Basic
    path: tuple[int, ...]
    term: sp.Basic
    formula: sp.Basic


@lru_cache(maxsize=1024)
def family(symbol: sp.Symbol | sp.MatrixSymbol) -> tuple[bool, str]:
    """Return the part of a name that symbols share which may be mistaken for each other: all but index and hat."""
    stem = re.sub(r"\d+|hat", "", symbol.name)
    for letters in FAMILIES:
        for letter in letters:
            stem = re.sub(rf"^{letter}(?=_|dot|$)", letters[0], stem)
    return isinstance(symbol, sp.MatrixSymbol), stem


def is_symbol(node: sp.Basic) -> bool:
    """Return True for a letter."""
    return isinstance(node, sp.Symbol | sp.MatrixSymbol)


def symbols_in(node: sp.Basic) -> set[sp.Basic]:
    """Return the symbols of a formula without the sizes of matrices."""
    return {node} if is_symbol(node) else set().union(*map(symbols_in, node.args))


def siblings_in(pool: Iterable[sp.Basic]) -> Siblings:
    """Return letters by their families."""
    siblings: Siblings = {}
    for symbol in sorted(pool, key=str):
        siblings.setdefault(family(symbol), []).append(symbol)
    return siblings


def slips_in(node: sp.Basic, siblings: Siblings, moves: Moves) -> Iterator[Slip]:
    """Yield every single slip in a formula."""
    if is_symbol(node):
        for other in siblings.get(family(node), []):
            if other != node:
                yield Slip("letter", node, other, (), node, other)
        return
    if isinstance(node, sp.Inverse) or (isinstance(node, sp.Transpose) and node.is_square):
        yield Slip("left out", node, node.arg, (), node, node.arg)
    parts = _parts(node)
    for k, part in enumerate(parts):
        here: list[Slip] = []
        # of a sum, a side of a relation, an entry of a matrix, a branch
        is_term = _is_sum(node) or isinstance(node, Relational) or (isinstance(node, ExprCondPair) and k == 0)
        if is_term and not _is_sum(part) and part != 0:
            here += factored(part, moves)
        if isinstance(node, sp.Pow) and k == 1 and part.is_number:
            changed = (part + more * sp.sign(part) for more in moves.exponents)
            here += [Slip("exponent", part, new, (), part, new) for new in changed]
        for slip in chain(slips_in(part, siblings, moves), here):
            # What does not fit in size, or compares with what is no number, is no slip but no formula.
            with suppress(ShapeError, TypeError):
                formula = _rebuilt(node, [*parts[:k], slip.formula, *parts[k + 1 :]])
                # a slip in a sum inside the term has named its own term already
                term = slip.term if _has_term(part, slip) else part if is_term else node
                yield replace(slip, path=(k, *slip.path), term=term, formula=formula)


def factored(term: sp.Expr, moves: Moves) -> list[Slip]:
    """Return the slips of a whole term: another sign, another factor, or the term dropped."""
    kinds = {-1: "sign", 0: "dropped"}
    return [Slip(kinds.get(c, "factor"), term, c * term, (), term, c * term) for c in moves.factors]


def _has_term(part: sp.Basic, slip: Slip) -> bool:
    """Return True if a sum on the way down to the slip holds its term."""
    for index in slip.path:
        if _is_sum(part):
            return True
        part = _parts(part)[index]
    return False


def _parts(node: sp.Basic) -> list[sp.Basic]:
    return list(node) if isinstance(node, sp.MatrixBase) else list(node.args)


def _is_sum(node: sp.Basic) -> bool:
    return isinstance(node, sp.Add | sp.MatAdd | sp.MatrixBase)


def _rebuilt(node: sp.Basic, parts: list[sp.Basic]) -> sp.Basic:
    if isinstance(node, sp.MatrixBase):
        return sp.ImmutableMatrix(*node.shape, parts)
    if isinstance(node, Relational):
        return node.func(*parts, evaluate=False)
    if isinstance(node, ElementwiseApplyFunction):
        return parts[1].applyfunc(parts[0])
    return node.func(*parts)
