"""Numbers, symbols and expressions of users become sympy's here, and nowhere else; text never does."""

from __future__ import annotations

import math
from collections.abc import Iterable
from numbers import Real
from typing import Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from percept_obs.validation.arguments import WrongKind, described

UNFIT = set('<>&"`') | {chr(code) for code in range(32)}
"""Characters that no symbol's name has, for they would be read as markup."""


def refuse_names(symbols: Iterable[sp.Basic], name: str) -> None:
    """Raise a ValueError for a symbol whose name is empty, or would be read as markup where it is shown."""
    for symbol in symbols:
        if not str(symbol) or UNFIT & set(str(symbol)):
            raise ValueError(f"{name} has a symbol {str(symbol)!r}; give it a name of letters, digits, _ or ^")


def expression(value: Any, name: str) -> sp.Expr:
    """Real number of Python, numpy or sympy, or expression, as sympy's; `name` stands in messages.

    Raises `WrongKind` for anything else, such as infinity, or text, which sympy would run as code.
    """
    if isinstance(value, np.ndarray) and not value.ndim:
        value = value[()]
    if isinstance(value, sp.Expr):
        refuse_names({*value.free_symbols, *(each.func for each in value.atoms(AppliedUndef))}, name)
        good = not value.has(sp.oo, -sp.oo, sp.zoo, sp.nan, sp.I)
    else:
        good = isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
    if not good:
        raise WrongKind(f"{name} is {described(value)}; give a finite real number or a sympy expression, never text")
    return sp.sympify(value)


def expressions(values: Iterable[Any], name: str) -> tuple[sp.Expr, ...]:
    """Several values, each as `expression` gives it."""
    return tuple(expression(value, f"{name}, entry {k},") for k, value in enumerate(values, 1))


def derived(values: Iterable[Any], name: str) -> tuple[sp.Basic, ...]:
    """Several values as sympy's, without a look into those that are sympy's already, which takes long."""
    each = iterable(values, name)
    return tuple(value if isinstance(value, sp.Basic) else expression(value, name) for value in each)


def iterable(values: Any, name: str) -> Iterable[Any]:
    """Values that can be gone through as they are; `WrongKind` for a single one."""
    if not isinstance(values, Iterable):
        raise WrongKind(f"{name} is {described(values)}; give a sequence of numbers or sympy expressions")
    return values


def matrix(values: Any, name: str, rows: int | None = None, columns: int | None = None) -> sp.ImmutableMatrix:
    """Matrix, or column, of what `expression` takes as sympy's; a ValueError if it has another shape than given."""
    symbolic = isinstance(values, sp.MatrixBase)
    array = np.array(values.tolist() if symbolic else values, dtype=object)
    if symbolic or array.ndim < 2:
        array = array.reshape(values.shape if symbolic else (-1, 1))
    shape = array.shape if rows is None else (rows, columns)
    if array.ndim != 2 or array.shape != shape:
        raise ValueError(
            f"{name} has the shape {array.shape}; expected {shape}, entries that are numbers or expressions"
        )
    return sp.ImmutableMatrix(*array.shape, expressions(array.ravel(), name))
