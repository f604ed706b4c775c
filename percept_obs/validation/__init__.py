"""What comes in from outside: of which kind it must be, how a number becomes sympy's, and how much work is allowed."""

from percept_obs.validation.arguments import WrongKind, checked, numbers, positive, refuse_kind
from percept_obs.validation.expressions import derived, expression, expressions, matrix
from percept_obs.validation.files import write_whole
from percept_obs.validation.kinds import Coefficients, Entries, Kind, are_numbers
from percept_obs.validation.limits import MOST_TERMS, TooMuchWork, limit
from percept_obs.validation.modules import needed
from percept_obs.validation.progress import bar, workers
from percept_obs.validation.warning import warn

__all__ = [
    "MOST_TERMS",
    "Coefficients",
    "Entries",
    "Kind",
    "TooMuchWork",
    "WrongKind",
    "are_numbers",
    "bar",
    "checked",
    "derived",
    "expression",
    "expressions",
    "limit",
    "matrix",
    "needed",
    "numbers",
    "positive",
    "refuse_kind",
    "warn",
    "workers",
    "write_whole",
]
