"""Functions of every row of tables, in numpy or in one pass of machine code."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np
import sympy as sp

from percept_obs.compile import vector_functions
from percept_obs.compile.arrays import Array
from percept_obs.compile.batch_loop import BATCH
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
        count = len(arrays[0])
        if count < BATCH:  # the last row fills up the batch
            rows = np.minimum(np.arange(BATCH), count - 1)
            arrays = [array[rows] for array in arrays]
        values = np.empty((len(arrays[0]), len(expressions)))
        machine(*arrays, numbers, values)
        return values[:count]

    return in_machine_code


def _source(tables: tuple[Symbols, ...], constants: Symbols, expressions: tuple[sp.Basic, ...]) -> str:
    """Text of the loop over the rows, `BATCH` of them together; terms of constants only stand before it."""
    text, fixed, arguments = Text("batch"), dict[sp.Expr, sp.Symbol](), [f"table{k}" for k in range(len(tables))]
    places = {s: f"{name}_part[i, {k}]" for name, of in zip(arguments, tables, strict=True) for k, s in enumerate(of)}
    names = {symbol: sp.Symbol(f"x{k}", real=True) for k, symbol in enumerate((*places, *constants))}
    left = [take_out(e.xreplace(names), {names[symbol] for symbol in constants}, fixed) for e in expressions]
    used = [symbol for symbol in places if any(e.has(names[symbol]) for e in left)]
    work = [f"work[{k}, i]" for k in range(len(used) + len(left))]
    with text.function("run", [*arguments, "numbers", "values"]):
        text.assign("work", f"np.empty(({len(work)}, {BATCH}))")
        for k, symbol in enumerate(constants):
            text.assign(names[symbol].name, f"numbers[{k}]")
        for expression, name in fixed.items():
            text.assign(name.name, text.print(expression))
        with text.over(f"range(0, len(values), {BATCH})"):
            text.assign("row", f"min(i, len(values) - {BATCH})")
            for array in (*arguments, "values"):
                text.assign(f"{array}_part", f"{array}[row:row + {BATCH}]")
            with text.over(f"range({BATCH})"):
                for place, symbol in zip(work, used, strict=False):
                    text.store(place, places[symbol])
            with text.over(f"range({BATCH})"):
                for place, symbol in zip(work, used, strict=False):
                    text.assign(names[symbol].name, place)
                text.formulas(left, "e")
                for k, place in enumerate(work[len(used) :]):
                    text.store(place, f"e{k}")
            with text.over(f"range({BATCH})"):
                for k, place in enumerate(work[len(used) :]):
                    text.store(f"values_part[i, {k}]", place)
    return f"{inspect.getsource(vector_functions)}\n\n{text}"
