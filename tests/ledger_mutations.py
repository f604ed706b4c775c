"""Every formula that differs from a printed one in a single sign, factor, exponent or symbol."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from contextlib import suppress

import sympy as sp
from sympy.core.relational import Relational
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.matrices.exceptions import ShapeError
from sympy.matrices.expressions.applyfunc import ElementwiseApplyFunction

from percept_obs.papers import base

# Letters that stand beside each other in the papers, besides those that differ in an index or a hat.
FAMILIES = ("XYZ", "GAP", ("M", "gamma"), ("alpha", "lambda"))


def family(symbol: sp.Symbol | sp.MatrixSymbol) -> tuple[bool, str]:
    """What a symbol shares with those that may be mistaken for it: all but its index and its hat."""
    stem = re.sub(r"\d+|hat", "", symbol.name)
    for letters in FAMILIES:
        for letter in letters:
            stem = re.sub(rf"^{letter}(?=_|dot|$)", letters[0], stem)
    return isinstance(symbol, sp.MatrixSymbol), stem


def is_symbol(node: sp.Basic) -> bool:
    return isinstance(node, sp.Symbol | sp.MatrixSymbol)


def symbols_in(node: sp.Basic) -> set[sp.Basic]:
    """Symbols as they are printed; the sizes of matrix symbols are not."""
    return {node} if is_symbol(node) else set().union(*map(symbols_in, node.args))


def slips(printed: tuple[sp.Basic, ...], pool: Iterable[sp.Basic]) -> Iterator[tuple[sp.Basic, ...]]:
    """The formulas with one sign, factor, exponent or symbol changed."""
    siblings: dict[tuple[bool, str], list[sp.Basic]] = {}
    for symbol in sorted(pool, key=str):
        siblings.setdefault(family(symbol), []).append(symbol)
    for k, formula in enumerate(printed):
        for changed in _slips(formula, siblings):
            yield (*printed[:k], changed, *printed[k + 1 :])


def _slips(node: sp.Basic, siblings: dict[tuple[bool, str], list[sp.Basic]]) -> Iterator[sp.Basic]:
    if is_symbol(node):
        yield from (other for other in siblings.get(family(node), []) if other != node)
        return
    if isinstance(node, sp.Inverse) or (isinstance(node, sp.Transpose) and node.is_square):
        yield node.arg
    parts = _parts(node)
    for k, part in enumerate(parts):
        changes = list(_slips(part, siblings))
        if _is_a_term(node, k) and not _is_sum(part) and part != 0:
            changes += [-part, 2 * part]
        if isinstance(node, sp.Pow) and k == 1 and part.is_number:
            changes.append(part + sp.sign(part))
        for change in changes:
            # What does not fit in size is no slip but no formula.
            with suppress(ShapeError):
                yield _rebuilt(node, [*parts[:k], change, *parts[k + 1 :]])


def _parts(node: sp.Basic) -> list[sp.Basic]:
    return list(node) if isinstance(node, sp.MatrixBase) else list(node.args)


def _is_sum(node: sp.Basic) -> bool:
    return isinstance(node, sp.Add | sp.MatAdd | sp.MatrixBase)


def _is_a_term(node: sp.Basic, k: int) -> bool:
    """Whether a part is a term: of a sum, a side of a relation, an entry of a matrix, a branch."""
    return _is_sum(node) or isinstance(node, Relational) or (isinstance(node, ExprCondPair) and k == 0)


def _rebuilt(node: sp.Basic, parts: list[sp.Basic]) -> sp.Basic:
    if isinstance(node, sp.MatrixBase):
        return sp.ImmutableMatrix(*node.shape, parts)
    if isinstance(node, Relational):
        return node.func(*parts, evaluate=False)
    if isinstance(node, ElementwiseApplyFunction):
        return parts[1].applyfunc(parts[0])
    return node.func(*parts)


def say_the_same(one: tuple[sp.Basic, ...], other: tuple[sp.Basic, ...]) -> bool:
    """Whether relations are proven to say the same; one that has become X = X says nothing, and so nothing wrong."""
    return all(map(_same, one, other))


def _same(one: sp.Basic, other: sp.Basic) -> bool:
    if one == other or (isinstance(one, sp.Eq) and one.lhs == one.rhs):
        return True
    if one.func != other.func:
        return False
    matrices = (m for m in one.atoms(sp.MatrixSymbol) if all(size.is_Integer for size in m.shape))
    entries = {m: sp.ImmutableMatrix(*m.shape, lambda i, j: sp.Dummy(real=True)) for m in matrices}
    # Both sides of an equation may change their sign, those of an inequality may be doubled only.
    factors = (1, 2, sp.Rational(1, 2), *((-1,) if isinstance(one, sp.Eq | sp.Ne) else ()))
    endless = one.rhs == other.rhs == sp.oo
    left, right = (relation.lhs if endless else relation.lhs - relation.rhs for relation in (one, other))
    return any(
        sp.expand(right - factor * left) == 0 or base.is_identity(base.equal(right, factor * left), entries)
        for factor in factors
    )
