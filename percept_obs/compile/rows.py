"""Functions of every row of tables, in numpy or in one pass of machine code."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np
import sympy as sp

from percept_obs.compile.arrays import Array
from percept_obs.compile.equations import Symbols
from percept_obs.compile.functions import vectorised
from percept_obs.compile.kernels import Language
from percept_obs.compile.loop import take_out
from percept_obs.compile.machine_code import machine_code
from percept_obs.compile.text import Text

Rows = Callable[[Sequence[Array], Array], Array]


@lru_cache(maxsize=512)
def by_row(
    tables: tuple[Symbols, ...], constants: Symbols, expressions: tuple[sp.Basic, ...], language: Language
) -> Rows:
    """Make a function of tables with K rows and of constants that gives expressions, shape (K, expressions).

    A condition gives 1 where it holds.  Python's function runs in numpy.
    """
    if language == "python":
        symbols = tuple(symbol for table in tables for symbol in table)

        def in_numpy(arrays: Sequence[Array], numbers: Array) -> Array:
            evaluate = vectorised(symbols, expressions, dict(zip(constants, numbers, strict=True)))
            with np.errstate(all="ignore"):
                return np.stack(evaluate(*(column for array in arrays for column in array.T)), axis=-1)

        return in_numpy
    from numba import types

    table, flat = (types.Array(types.float64, *kind, readonly=True) for kind in ((2, "A"), (1, "C")))
    signature = (*[table] * len(tables), flat, types.float64[:, ::1])
    machine = machine_code(_source(tables, constants, expressions), signature, "batch")

    def in_machine_code(arrays: Sequence[Array], numbers: Array) -> Array:
        values = np.empty((len(arrays[0]), len(expressions)))
        machine(*arrays, numbers, values)
        return values

    return in_machine_code


def _source(tables: tuple[Symbols, ...], constants: Symbols, expressions: tuple[sp.Basic, ...]) -> str:
    """Text of the loop over the rows; terms of constants only stand before it."""
    text, fixed, arguments = Text("python"), dict[sp.Expr, sp.Symbol](), [f"table{k}" for k in range(len(tables))]
    places = {s: f"{name}[i, {k}]" for name, of in zip(arguments, tables, strict=True) for k, s in enumerate(of)}
    names = {symbol: sp.Symbol(f"x{k}", real=True) for k, symbol in enumerate((*places, *constants))}
    # what depends on constants alone is computed once, before the loop
    left = [take_out(e.xreplace(names), {names[symbol] for symbol in constants}, fixed) for e in expressions]
    with text.function("run", [*arguments, "numbers", "values"]):
        for k, symbol in enumerate(constants):
            text.assign(names[symbol].name, f"numbers[{k}]")
        for expression, name in fixed.items():
            text.assign(name.name, text.print(expression))
        with text.loop("i", "values"):
            for symbol, place in places.items():
                text.assign(names[symbol].name, place)
            text.formulas(left, "e")
            for k in range(len(left)):
                text.store(f"values[i, {k}]", f"e{k}")
    return f"import math\n\n\n{text}"
