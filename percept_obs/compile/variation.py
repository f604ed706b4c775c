"""Variational equations: the change of a state with the parameters of its equations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import sympy as sp

from percept_obs.compile.equations import Equations, Expressions, Symbols


def slopes(symbols: Sequence[sp.Symbol]) -> Symbols:
    """Symbols of the changes of symbols: d_y1 for y1."""
    return tuple(sp.Symbol(f"d_{symbol.name}", real=True) for symbol in symbols)


def slope(expressions: Sequence[sp.Expr], symbols: Sequence[sp.Symbol]) -> Expressions:
    """Change of expressions, to first order, when symbols change by their `slopes`; a sign counts as constant.

    >>> x = sp.Symbol("x", real=True)
    >>> slope([x**2], [x])
    (2*d_x*x,)
    """
    gradient = sp.Matrix(expressions).jacobian(symbols)
    # a sign's derivative is a delta at its jump, which no step can resolve
    smooth = gradient.applyfunc(lambda entry: entry.replace(sp.DiracDelta, lambda *_: sp.S.Zero))
    return tuple(smooth * sp.Matrix(slopes(symbols)))


def variation(equations: Equations, moved: Sequence[sp.Symbol]) -> Equations:
    """Extend equations by the change of their state when some of their parameters change.

    With the state x, the parameters p and their changes dx and dp::

        x' = f(x, p),   dx' = (df/dx) dx + (df/dp) dp

    and alike at a sample and at a reset.  Stepped by the same method this is the derivative of the stepped state
    itself; a change that moves a reset by a step is left out.  The `slopes` of the parameters become parameters after
    all others.
    """
    unknown = [str(symbol) for symbol in moved if symbol not in equations.parameters]
    if unknown:
        known = ", ".join(map(str, equations.parameters)) or "none"
        raise ValueError(f"the equations have no parameter {', '.join(unknown)}; they have {known}")
    variables = (*equations.state, *moved)

    def both(expressions: Expressions) -> Expressions:
        return (*expressions, *slope(expressions, variables)) if expressions else ()

    return replace(
        equations,
        state=(*equations.state, *slopes(equations.state)),
        flow=both(equations.flow),
        parameters=(*equations.parameters, *slopes(moved)),
        update=tuple(map(both, equations.update)),
        reset=both(equations.reset),
    )
