"""Functions made of expressions: of numpy arrays, of a state for scipy's solvers, of an array in each language."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from types import FunctionType
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile.arrays import Array
from percept_obs.compile.equations import Equations
from percept_obs.compile.intermediate import common_subexpressions
from percept_obs.compile.text import Printed, Text, refuse_what_differs
from percept_obs.validation import derived


def vectorised(
    symbols: Sequence[sp.Symbol],
    expressions: Sequence[sp.Expr],
    values: Mapping[sp.Symbol, float] | None = None,
) -> Callable[..., list[Array]]:
    """Make a numpy function of arrays of several expressions; constants take the arrays' shape."""
    extra = tuple(values or ())
    function = _numpy_function((*symbols, *extra), tuple(expressions))
    constants = tuple((values or {}).values())

    def evaluate(*arrays: ArrayLike) -> list[Array]:
        columns = [np.asarray(a, dtype=float) for a in arrays]
        found = np.empty((len(expressions), *np.broadcast_shapes(*(column.shape for column in columns))))
        # an expression without symbols gives one number, which is spread over the arrays' shape
        for k, result in enumerate(function(*columns, *constants)):
            found[k] = result
        return list(found)

    return evaluate


def at_once(symbols: tuple[sp.Symbol, ...], expressions: tuple[sp.Expr, ...], values: Sequence[float]) -> Array:
    """Evaluate several expressions at one point, faster than by `vectorised`."""
    return np.array(_numpy_function(symbols, expressions)(*map(np.float64, values)), dtype=float)


@lru_cache(maxsize=512)
def _numpy_function(symbols: tuple[sp.Symbol, ...], expressions: tuple[sp.Expr, ...]) -> Callable[..., tuple[Any, ...]]:
    return sp.lambdify(symbols, expressions, "numpy", cse=_shared)


def _shared(expressions: Any, **_: Any) -> tuple[list[tuple[sp.Symbol, sp.Expr]], Any]:
    """`common_subexpressions` of one expression or several, as `sympy.lambdify` calls it."""
    if isinstance(expressions, sp.Basic):
        shared, (left,) = common_subexpressions([expressions])
        return shared, left
    return common_subexpressions(expressions)


def right_hand_side(equations: Equations, values: Mapping[sp.Symbol, float]) -> Callable[..., list[float]]:
    """Make the flow a function of (state, measured, parameters) with numbers for some symbols.

    Parameters without a number stay arguments, in their order.
    """
    numbers = {symbol: sp.Float(value, 17) for symbol, value in values.items()}
    left = [symbol for symbol in equations.parameters if symbol not in numbers]
    flow = [entry.xreplace(numbers) for entry in equations.flow]
    return sp.lambdify([equations.state, equations.measured, left], flow, "math", cse=_shared)


@lru_cache(maxsize=512)
def function_source(
    symbols: tuple[sp.Symbol, ...], expressions: tuple[sp.Expr, ...], language: Printed = "javascript"
) -> str:
    """Text of a function ``evaluate(x, out)`` that fills an array with the expressions' values and returns it.

    The array x holds the symbols in their order.  Raises NotCompilable for an expression that would not mean the same
    in Python and JavaScript.
    """
    text = Text(language)
    names = {symbol: sp.Symbol(f"x{k}", real=True) for k, symbol in enumerate(symbols)}
    with text.function("evaluate", "x, out"):
        for k, name in enumerate(names.values()):
            text.assign(name.name, f"x[{k}]")
        renamed = [e.xreplace(names) for e in derived(expressions, "an expression")]
        refuse_what_differs(renamed)
        text.formulas(renamed, "d")
        for k in range(len(expressions)):
            text.store(f"out[{k}]", f"d{k}")
        text.leave("out")
    return str(text)


def python_text(expression: sp.Expr) -> str:
    """Text of an expression in Python, with functions of `math`.

    >>> python_text(sp.sin(2 * sp.Symbol("t")) / 5)
    '((1.0/5.0))*math.sin(2.0*t)'
    """
    refuse_what_differs([expression])
    return Text("python").print(expression)


def executed(text: str, **names: Any) -> Callable[..., Any]:
    """Python function that a text defines last; it may use `math` and the names that are passed."""
    namespace: dict[str, Any] = {"math": math} | names
    exec(compile(text, "<printed>", "exec"), namespace)
    # helpers stand before the function that uses them, which so is the last one
    *_, function = (value for value in namespace.values() if isinstance(value, FunctionType))
    return function
