"""Hidden coordinates from an estimate of what they do to the measured ones, and where they do not follow from it."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp
from sympy.logic.boolalg import Boolean

from percept_obs.forms import CanonicalForm

largest = sp.Symbol("c_max", real=True)
"""How much an error of the rate may be amplified at most."""


@dataclass(frozen=True)
class Gap:
    """Where an observer does not estimate the hidden coordinates, although it runs on.

    Parameters
    ----------
    condition : sympy condition
        On the measured outputs, the parameters and the gains.
    reason : str
        What is missing there.
    """

    condition: Boolean
    reason: str


def recovered(form: CanonicalForm, rate: sp.ImmutableMatrix) -> tuple[sp.ImmutableMatrix, Gap]:
    """Hidden coordinates from an estimate of w^T x2, and where they do not follow from it.

    Parameters
    ----------
    form : CanonicalForm
    rate : matrix of shape (n1, 1)
        The estimate of w^T x2.

    Returns
    -------
    matrix of shape (n2, 1)
    Gap
        Where what turns the rate into hidden coordinates has a Frobenius norm of c_max or more, so that it would
        amplify an error of the rate by up to this norm.

    Raises
    ------
    NeedsMoreOutputs
        If w^T x2 never determines x2.
    """
    numerator, determinant = form.cramer
    # both sides times the determinant squared, so that nothing is divided by zero
    too_large = sp.Ge(sum(entry**2 for entry in numerator), (largest * determinant) ** 2)
    return numerator * rate / determinant, Gap(too_large, f"{', '.join(form.hidden)} nearly drop out of what is seen")
