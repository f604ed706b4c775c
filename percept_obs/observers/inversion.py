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
    """Condition under which an observer has no estimate of the hidden coordinates, although it runs on, and why.

    It depends on the state, the outputs, the parameters, the gains, `elapsed` and `first_innovation`.
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
    """Invert an estimate of w^T x2, shape (n1, 1), to the hidden coordinates, shape (n2, 1).

    They are unobservable where the inverse has a Frobenius norm of c_max or more, by which it may amplify an error.
    """
    numerator, determinant = form.cramer
    # both sides are multiplied by the determinant squared, so that nothing is divided by zero
    too_large = sp.Ge(sum(entry**2 for entry in numerator), (c_max * determinant) ** 2)
    reason = f"{', '.join(form.hidden)} nearly drop out of what is seen"
    return numerator * rate / determinant, Unobservable(too_large, reason)
