"""Letters of matrices written out entry by entry, also in integrals."""

from __future__ import annotations

from collections.abc import Mapping
from functools import reduce
from operator import add, mul
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from percept_obs.checking.deciding import on_sides

Matrices = Mapping[sp.Basic, Any]


def in_entries(formula: Any, matrices: Matrices) -> Any:
    """Replace letters of matrices by matrices in a formula or a relation, also in integrals."""
    if not matrices or not formula.has(sp.MatrixExpr, sp.MatrixBase, sp.Integral):
        return formula
    varying = {s for m in matrices.values() if isinstance(m, sp.MatrixBase) for s in m.free_symbols}
    return on_sides(lambda side: _side(side, matrices, varying), formula)


def _side(side: Any, matrices: Matrices, varying: set[sp.Basic]) -> Any:
    if isinstance(side, sp.Integral):
        integrand = _side(side.function, matrices, varying)
        if isinstance(integrand, sp.MatrixBase):
            return integrand.applyfunc(lambda entry: gathered(sp.Integral(entry, *side.limits), varying))
        return gathered(sp.Integral(integrand, *side.limits), varying)
    if side.has(sp.Integral):
        parts = [_side(part, matrices, varying) for part in side.args]
        if isinstance(side, sp.Add | sp.MatAdd):
            return reduce(add, parts)
        return reduce(mul, parts) if isinstance(side, sp.Mul | sp.MatMul) else side.func(*parts)
    side = side.xreplace(matrices).doit()
    return side.as_explicit() if isinstance(side, sp.MatrixExpr) else side


def gathered(integral: sp.Integral, varying: set[sp.Basic]) -> sp.Expr:
    """Return an integral as a sum of numbers times letters that stand for integrals, one for each term.

    Entries of matrices stand for functions of time there, so that nothing of them leaves the integral.  An integral of
    numbers and of the variable itself stays as it is.
    """
    integral = integral.as_dummy()
    inside = integral.function.free_symbols
    if not inside & varying and not integral.has(AppliedUndef):
        return integral
    variables = {v: sp.Symbol(f"tau{k or ''}", real=True) for k, v in enumerate(integral.variables)}
    function, limits = integral.function.xreplace(variables), [limit.xreplace(variables) for limit in integral.limits]
    moving = {*varying, *variables.values(), *function.atoms(AppliedUndef), *function.atoms(sp.Integral)}
    terms = (term.as_independent(*moving, as_Add=False) for term in sp.Add.make_args(sp.expand(function)))
    return sp.Add(*(c * sp.Symbol(sp.latex(sp.Integral(rest, *limits)), real=True) for c, rest in terms))
