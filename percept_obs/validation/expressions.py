"""Numbers, symbols and expressions that are given become sympy's here, and nowhere else; text never does."""

from __future__ import annotations

import math
from collections.abc import Iterable
from numbers import Real
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.validation.arguments import WrongKind, came


def expression(value: Any, what: str) -> sp.Expr:
    """What is given for a number or an expression, as sympy's.

    Parameters
    ----------
    value : real number of Python, numpy or sympy, or expression
        Text is refused, for sympy would run it as code.
    what : str
        What it is given for.

    Raises
    ------
    WrongKind
        If it is something else, such as text, complex, infinite or not a number.
    """
    if isinstance(value, np.ndarray) and not value.ndim:
        value = value[()]
    if isinstance(value, sp.Expr):
        good = not value.has(sp.oo, -sp.oo, sp.zoo, sp.nan, sp.I)
    else:
        good = isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
    if not good:
        raise WrongKind(f"{what} is {came(value)}; give a finite real number or a sympy expression, never text")
    return sp.sympify(value)


def matrix(values: Any, what: str, rows: int | None = None, columns: int | None = None) -> sp.ImmutableMatrix:
    """What is given for a matrix, or for a column, as sympy's.

    Parameters
    ----------
    values : array, nested sequences or sympy matrix
        Of what `expression` takes.
    what : str
        What it is given for.
    rows, columns : int, optional
        Its shape; its own when left out.

    Raises
    ------
    WrongKind
        If an entry is none.
    ValueError
        If it has another shape.
    """
    array = np.array(values.tolist() if isinstance(values, sp.MatrixBase) else values, dtype=object)
    array = array.reshape(-1, 1) if array.ndim < 2 else array
    if isinstance(values, sp.MatrixBase):
        array = array.reshape(values.shape)
    shape = array.shape if rows is None else (rows, columns)
    if array.ndim != 2 or array.shape != shape:
        raise ValueError(
            f"{what} has the shape {array.shape}; expected {shape}, entries that are numbers or expressions"
        )
    return sp.ImmutableMatrix(*array.shape, expressions(array.ravel(), what))


def derived(values: Iterable[Any], what: str) -> tuple[sp.Basic, ...]:
    """The same of values that were derived before: what is sympy's already is not looked through again."""
    return tuple(value if isinstance(value, sp.Basic) else expression(value, what) for value in values)


def expressions(values: Iterable[Any], what: str) -> tuple[sp.Expr, ...]:
    """Each of several values as `expression` gives it."""
    return tuple(expression(value, f"{what}, entry {k},") for k, value in enumerate(values, 1))
