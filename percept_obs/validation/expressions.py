"""Numbers, symbols and expressions of users become sympy's here, and nowhere else; text never does."""

from __future__ import annotations

import math
from collections.abc import Iterable
from numbers import Real
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.validation.arguments import WrongKind, described


def expression(value: Any, name: str) -> sp.Expr:
    """Number or expression as sympy's.

    Parameters
    ----------
    value : real number of Python, numpy or sympy, or expression
        Text is refused, for sympy would run it as code.
    name : str
        Its name in messages.

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
        raise WrongKind(f"{name} is {described(value)}; give a finite real number or a sympy expression, never text")
    return sp.sympify(value)


def expressions(values: Iterable[Any], name: str) -> tuple[sp.Expr, ...]:
    """Several values, each as `expression` gives it."""
    return tuple(expression(value, f"{name}, entry {k},") for k, value in enumerate(values, 1))


def derived(values: Iterable[Any], name: str) -> tuple[sp.Basic, ...]:
    """Several values as sympy's, without a look into those that are sympy's already, which takes long."""
    return tuple(value if isinstance(value, sp.Basic) else expression(value, name) for value in values)


def matrix(values: Any, name: str, rows: int | None = None, columns: int | None = None) -> sp.ImmutableMatrix:
    """Matrix, or column, of what `expression` takes as sympy's.

    Parameters
    ----------
    values : array, nested sequences or sympy matrix
    name : str
        Its name in messages.
    rows, columns : int, optional
        Its shape; its own when left out.

    Raises
    ------
    WrongKind
        If an entry is neither a number nor an expression.
    ValueError
        If it has another shape.
    """
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
