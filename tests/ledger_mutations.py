"""Every formula that differs from a printed one in a single sign or a single symbol."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

import sympy as sp
from sympy.core.relational import Relational
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.matrices.expressions.applyfunc import ElementwiseApplyFunction

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
    """The formulas with one sign or one symbol changed."""
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
    parts = _parts(node)
    for k, part in enumerate(parts):
        changes = list(_slips(part, siblings))
        if _carries_a_sign(node, k) and not _is_sum(part) and part != 0:
            changes.append(-part)
        for change in changes:
            yield _rebuilt(node, [*parts[:k], change, *parts[k + 1 :]])


def _parts(node: sp.Basic) -> list[sp.Basic]:
    return list(node) if isinstance(node, sp.MatrixBase) else list(node.args)


def _is_sum(node: sp.Basic) -> bool:
    return isinstance(node, sp.Add | sp.MatAdd | sp.MatrixBase)


def _carries_a_sign(node: sp.Basic, k: int) -> bool:
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
