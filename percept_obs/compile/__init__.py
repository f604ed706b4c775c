"""From sympy to code that runs, in Python, numba and JavaScript."""

from percept_obs.compile.arrays import Array, Flags, Indices
from percept_obs.compile.functions import at_once, executed, function_source, python_text, right_hand_side, vectorised
from percept_obs.compile.intermediate import Intermediate, definitions, in_letters, intermediates, written_out
from percept_obs.compile.kernels import Language, Table, Trace, choose, solve
from percept_obs.compile.loop import source
from percept_obs.compile.machine_code import machine_code
from percept_obs.compile.text import NotCompilable, Printed

__all__ = [
    "Array",
    "Flags",
    "Indices",
    "Intermediate",
    "Language",
    "NotCompilable",
    "Printed",
    "Table",
    "Trace",
    "at_once",
    "choose",
    "definitions",
    "executed",
    "function_source",
    "in_letters",
    "intermediates",
    "machine_code",
    "python_text",
    "right_hand_side",
    "solve",
    "source",
    "vectorised",
    "written_out",
]
