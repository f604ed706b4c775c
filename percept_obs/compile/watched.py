"""What is looked at of each run of an ensemble while it goes on."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp
from sympy.logic.boolalg import Boolean

from percept_obs.compile.equations import Expressions, Symbols


@dataclass(frozen=True)
class Watched:
    """What is looked at of a run at its samples, in the symbols of its equations and those given here.

    Parameters
    ----------
    truth : symbols
        The true coordinates.
    elapsed : symbol
        Seconds since the first sample.
    begun : symbols
        What `first` was at the first sample.
    first : expressions, one for each of `begun`
    hidden : condition
        Where there is no estimate.
    judged : expressions
        The largest of which is to stay within the tolerance.
    behind : condition
        Where that is infinite.
    error : expression
        Whose last and largest value and mean square are asked for.
    means : expressions
        Whose means are asked for; a value that is not finite does not count.
    samples : symbols
        The samples that arrive, NaN where there is none, if the means use them.
    measured : tuple of int
        Which of the true coordinates each measured output is.
    """

    truth: Symbols
    elapsed: sp.Symbol
    begun: Symbols
    first: Expressions
    hidden: Boolean
    judged: Expressions
    behind: Boolean
    error: sp.Expr
    means: Expressions = ()
    samples: Symbols = ()
    measured: tuple[int, ...] = ()
