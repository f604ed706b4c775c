"""Functions of every row of tables, in numpy or in one pass of machine code."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np
import sympy as sp

from percept_obs.compile.arrays import Array
from percept_obs.compile.equations import Symbols
from percept_obs.compile.functions import executed
from percept_obs.compile.kernels import Language
from percept_obs.compile.loop import take_out
from percept_obs.compile.machine_code import machine_code
from percept_obs.compile.many_runs import ManyRuns

Rows = Callable[[Sequence[Array], Array], Array]


@lru_cache(maxsize=512)
def by_row(
    tables: tuple[Symbols, ...], constants: Symbols, expressions: tuple[sp.Basic, ...], language: Language
) -> Rows:
    """Make a function of tables with K rows and of constants that gives expressions, shape (K, expressions).

    A condition gives 1 where it holds.  Python's function runs in numpy, and gives the same bits where the expressions
    have no other function than roots, exp and tanh.
    """
    text = _source(tables, constants, expressions, language)
    if language == "python":
        loop = executed(text)
    else:
        from numba import types

        table, flat = (types.Array(types.float64, *kind, readonly=True) for kind in ((2, "A"), (1, "C")))
        loop = machine_code(text, (*[table] * len(tables), flat, types.float64[:, ::1]), "inlined")

    def rows(arrays: Sequence[Array], numbers: Array) -> Array:
        values = np.empty((len(arrays[0]), len(expressions)))
        with np.errstate(all="ignore"):
            loop(*arrays, numbers, values)
        return values

    return rows


def _source(
    tables: tuple[Symbols, ...], constants: Symbols, expressions: tuple[sp.Basic, ...], language: Language
) -> str:
    """Text of the loop over the rows, in numpy over all at once; terms of constants only stand before it."""
    arguments = [f"table{k}" for k in range(len(tables))]
    text, fixed = ManyRuns(language, "len(values)"), dict[sp.Expr, sp.Symbol]()
    places = {s: f"{name}[i, {k}]" for name, of in zip(arguments, tables, strict=True) for k, s in enumerate(of)}
    names = {symbol: sp.Symbol(f"x{k}", real=True) for k, symbol in enumerate((*places, *constants))}
    # what depends on constants alone is computed once, before the loop
    left = [take_out(e.xreplace(names), {names[symbol] for symbol in constants}, fixed) for e in expressions]
    with text.function("run", f"{', '.join(arguments)}, numbers, values"):
        for k, symbol in enumerate(constants):
            text.assign(names[symbol].name, f"numbers[{k}]")
        for expression, name in fixed.items():
            text.assign(name.name, text.print(expression))
        with text.runs():
            for symbol, place in places.items():
                text.assign(names[symbol].name, place)
            text.formulas(left, "e")
            for k in range(len(left)):
                text.store(f"values[i, {k}]", f"e{k}")
    return str(text)
