"""From sympy to code that runs, in Python, numba and JavaScript."""

from percept_obs.compile.functions import function_source, right_hand_side, vectorised
from percept_obs.compile.kernels import WORTH_COMPILING, Table, Trace, solve
from percept_obs.compile.loop import LARGEST_PRODUCT, LARGEST_SQUARED_STATE, NotCompilable, source

__all__ = [
    "LARGEST_PRODUCT",
    "LARGEST_SQUARED_STATE",
    "WORTH_COMPILING",
    "NotCompilable",
    "Table",
    "Trace",
    "function_source",
    "right_hand_side",
    "solve",
    "source",
    "vectorised",
]
