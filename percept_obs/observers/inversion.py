"""Hidden coordinates from an estimate of what they do to the measured ones, and where they do not follow from it."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp
from sympy.logic.boolalg import Boolean

from percept_obs.system.forms import CanonicalForm, PartitionedSystem

largest = sp.Symbol("c_max", real=True)
"""How much an error of the rate may be amplified at most."""


@dataclass(frozen=True)
class Gap:
    """Where an observer does not estimate the hidden coordinates, although it runs on.

    Parameters
    ----------
    condition : sympy condition
        On the state, the measured outputs, the parameters, the gains, and the `elapsed` time and the
        `first_innovation`.
    reason : str
        What is missing there.
    """

    condition: Boolean
    reason: str


elapsed = sp.Symbol("t", real=True)
"""Seconds since the first sample."""


def first_innovation(form: PartitionedSystem) -> sp.ImmutableMatrix:
    """Symbols of what the measured outputs were off their estimates at the first sample, shape (n1, 1)."""
    return sp.ImmutableMatrix([sp.Symbol(f"e0_{output.name}", real=True) for output in form.x1])


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


def starting(form: CanonicalForm, rate: sp.ImmutableMatrix, left: sp.ImmutableMatrix, shrunk: sp.Expr) -> Gap:
    """Where what is left of the start in an estimate of w^T x2 may be half of the hidden coordinates that follow.

    It compares what recovering the hidden coordinates makes of both, so that the same rest is of no account where they
    follow easily, and hides them where they hardly do.

    Parameters
    ----------
    form : CanonicalForm
    rate : matrix of shape (n1, 1)
        The estimate of w^T x2.
    left : matrix of shape (n1, 1)
        Bounds on what is left in it.
    shrunk : expression
        The factor by which that has shrunk; below 1 / c_max no recovery makes it what it was again.

    Returns
    -------
    Gap
    """
    numerator, _ = form.cramer
    squared = [sum(entry**2 for entry in matrix) for matrix in (numerator, left, numerator * rate)]
    half = sp.Ge(4 * squared[0] * squared[1], squared[2])
    return Gap(sp.And(half, sp.Ge(largest * shrunk, 1)), "what is left of the start may be half of what is found")
