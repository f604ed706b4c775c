"""Inversion: hidden coordinates from an estimate of w^T x2, and where they do not follow from it."""

from dataclasses import dataclass

import sympy as sp
from sympy.logic.boolalg import Boolean

from percept_obs.observers.gains import Gain
from percept_obs.system.forms import CanonicalForm, NeedsMoreOutputs, PartitionedSystem

c_max = sp.Symbol("c_max", real=True)

AMPLIFIES = "how much the inversion that gives the hidden part may amplify an error of its rate"
AMPLIFICATION_GAIN = Gain(c_max, "largest_amplification", 1e5, 10, 1e7, "s/m", AMPLIFIES, c_max > 0, "it bounds a norm")
"""Gain of `inverted`."""


@dataclass(frozen=True)
class Unobservable:
    """Condition under which an observer has no estimate of the hidden coordinates, although it runs on.

    Parameters
    ----------
    condition : sympy condition
        On the state, the measured outputs, the parameters, the gains, and the `elapsed` time and the
        `first_innovation`.
    reason : str
        Reason for a verdict.
    """

    condition: Boolean
    reason: str


elapsed = sp.Symbol("t", real=True)
"""Seconds since the first sample."""


def first_innovation(form: PartitionedSystem) -> sp.ImmutableMatrix:
    """Symbols of the innovation at the first sample, shape (n1, 1)."""
    return sp.ImmutableMatrix([sp.Symbol(f"e0_{output.name}", real=True) for output in form.x1])


def needs_more_outputs(form: CanonicalForm) -> NeedsMoreOutputs | None:
    """Return the error of an observer that inverts w^T x2, if that never determines x2."""
    return None if form.determines_hidden else NeedsMoreOutputs(form)


def inverted(form: CanonicalForm, rate: sp.ImmutableMatrix) -> tuple[sp.ImmutableMatrix, Unobservable]:
    """Invert an estimate of w^T x2.

    Parameters
    ----------
    form : CanonicalForm
    rate : matrix of shape (n1, 1)
        The estimate of w^T x2.

    Returns
    -------
    matrix of shape (n2, 1)
        The hidden coordinates.
    Unobservable
        Where the inverse has a Frobenius norm of c_max or more, by which it may amplify an error of the rate.

    Raises
    ------
    NeedsMoreOutputs
        If w^T x2 never determines x2.
    """
    numerator, determinant = form.cramer
    # both sides are multiplied by the determinant squared, so that nothing is divided by zero
    too_large = sp.Ge(sum(entry**2 for entry in numerator), (c_max * determinant) ** 2)
    reason = f"{', '.join(form.hidden)} nearly drop out of what is seen"
    return numerator * rate / determinant, Unobservable(too_large, reason)


def start_left_over(
    form: CanonicalForm, rate: sp.ImmutableMatrix, left: sp.ImmutableMatrix, shrunk: sp.Expr
) -> Unobservable:
    """Condition under which the start may still make up half of the hidden coordinates.

    It compares the inverses of both, so that the same rest of the start does not matter where the hidden coordinates
    follow easily, and hides them where they hardly do.

    Parameters
    ----------
    form : CanonicalForm
    rate : matrix of shape (n1, 1)
        The estimate of w^T x2.
    left : matrix of shape (n1, 1)
        Bounds on the rest of the start in it.
    shrunk : expression
        Factor by which that has shrunk; below 1 / c_max no inversion brings it back.

    Returns
    -------
    Unobservable
    """
    numerator, _ = form.cramer
    squared = [sum(entry**2 for entry in matrix) for matrix in (numerator, left, numerator * rate)]
    half = sp.And(sp.Ge(4 * squared[0] * squared[1], squared[2]), sp.Ge(c_max * shrunk, 1))
    return Unobservable(half, "what is left of the start may be half of what is found")
