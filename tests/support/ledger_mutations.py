"""Tell formulas with a slip that say the same as before from those that do not."""

import sympy as sp

from percept_obs.checking.slips import Moves, siblings_in, slips_in
from percept_obs.papers.base import is_identity

PRINTS = Moves((-sp.S.One, sp.Integer(2)))
"""Slips in a printed formula."""


def slips(printed, pool):
    """Yield the formulas with one sign, factor, exponent or symbol changed; those of the pool may be mistaken."""
    siblings = siblings_in(pool)
    for k, formula in enumerate(printed):
        for slip in slips_in(formula, siblings, PRINTS):
            yield (*printed[:k], slip.formula, *printed[k + 1 :])


def say_the_same(one: tuple[sp.Basic, ...], other: tuple[sp.Basic, ...]) -> bool:
    """Return True if relations are proven to say the same; X = X says nothing, and so nothing wrong."""
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
        gap == 0
        or getattr(gap, "is_ZeroMatrix", False)
        or is_identity(sp.Eq(right, factor * left, evaluate=False), entries)
        for factor in factors
        for gap in [sp.expand(right - factor * left).doit()]
    )
