"""From sympy to code that runs, in Python, numba and JavaScript."""

from percept_obs.compile.arrays import Array as Array
from percept_obs.compile.arrays import Flags as Flags
from percept_obs.compile.arrays import Indices as Indices
from percept_obs.compile.functions import at_once as at_once
from percept_obs.compile.functions import executed as executed
from percept_obs.compile.functions import function_source as function_source
from percept_obs.compile.functions import python_text as python_text
from percept_obs.compile.functions import right_hand_side as right_hand_side
from percept_obs.compile.functions import vectorised as vectorised
from percept_obs.compile.intermediate import Intermediate as Intermediate
from percept_obs.compile.intermediate import definitions as definitions
from percept_obs.compile.intermediate import in_letters as in_letters
from percept_obs.compile.intermediate import intermediates as intermediates
from percept_obs.compile.intermediate import written_out as written_out
from percept_obs.compile.kernels import Language as Language
from percept_obs.compile.kernels import Table as Table
from percept_obs.compile.kernels import Trace as Trace
from percept_obs.compile.kernels import choose as choose
from percept_obs.compile.kernels import solve as solve
from percept_obs.compile.loop import source as source
from percept_obs.compile.machine_code import machine_code as machine_code
from percept_obs.compile.text import NotCompilable as NotCompilable
from percept_obs.compile.text import Printed as Printed
