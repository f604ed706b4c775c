"""Validation of what users pass: kinds of arguments, sympy expressions, limits of work, the machine's abilities."""

from percept_obs.validation.arguments import WrongKind as WrongKind
from percept_obs.validation.arguments import checked as checked
from percept_obs.validation.arguments import numbers as numbers
from percept_obs.validation.arguments import positive as positive
from percept_obs.validation.arguments import refuse_kind as refuse_kind
from percept_obs.validation.arguments import set_fields as set_fields
from percept_obs.validation.environment import bar as bar
from percept_obs.validation.environment import load_pandas as load_pandas
from percept_obs.validation.environment import missing as missing
from percept_obs.validation.environment import needed as needed
from percept_obs.validation.environment import warn as warn
from percept_obs.validation.environment import workers as workers
from percept_obs.validation.environment import write_whole as write_whole
from percept_obs.validation.expressions import derived as derived
from percept_obs.validation.expressions import expression as expression
from percept_obs.validation.expressions import expressions as expressions
from percept_obs.validation.expressions import matrix as matrix
from percept_obs.validation.expressions import refuse_names as refuse_names
from percept_obs.validation.kinds import Coefficients as Coefficients
from percept_obs.validation.kinds import Entries as Entries
from percept_obs.validation.kinds import Kind as Kind
from percept_obs.validation.kinds import are_numbers as are_numbers
from percept_obs.validation.limits import MOST_TERMS as MOST_TERMS
from percept_obs.validation.limits import TooMuchWork as TooMuchWork
from percept_obs.validation.limits import limit as limit
