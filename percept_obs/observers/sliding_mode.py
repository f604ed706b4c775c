"""The sliding mode observer of Chen and Kano (2002)."""

from __future__ import annotations

import sympy as sp

from percept_obs.compile.equations import Equations
from percept_obs.observers.base import (
    BOUND_GAINS,
    NOISE_GAIN,
    About,
    Gain,
    Observer,
    hats,
    innovation,
    kept_within,
    noise_bias,
    output_injection,
)
from percept_obs.observers.switching import switch_named
from percept_obs.system.forms import PartitionedSystem

alpha, alpha1, delta, lambda0 = sp.symbols("alpha alpha1 delta lambda0", real=True)

GAINS = (
    Gain(
        alpha,
        "hidden_gain",
        5,
        0.5,
        30,
        "weight of the switching term in the hidden part",
        alpha > 0,
        "the hidden part must follow the switching term",
    ),
    Gain(
        alpha1,
        "adaptation",
        10,
        0,
        50,
        "how fast the switching gains grow",
        alpha1 >= 0,
        "the switching gains may not shrink",
    ),
    Gain(
        delta,
        "boundary_layer",
        0.2,
        0.005,
        1,
        "width over which the sign is smoothed",
        delta > 0,
        "with 0 the switching term divides by the error",
    ),
    Gain(
        lambda0,
        "switching_gain",
        1,
        0.1,
        10,
        "the switching gains at the start",
        lambda0 > 0,
        "the switching term must push towards the measurement",
    ),
    *BOUND_GAINS,
    NOISE_GAIN,
)


ABOUT = About(
    "Sliding mode observer (SMO)",
    "Chen and Kano 2002; Ma, Chen and Moore 2005, (23)",
    "any outputs with a canonical form",
    "exponential, if w is persistently exciting and the gains are large enough",
)


def sliding_mode(form: PartitionedSystem, switch: str = "fraction", **gains: float) -> Observer:
    """Sliding mode observer with adaptive switching gains (SMO).

    With e = x1 - x1hat and, for each measured output, s = lambda e / (|e| + delta)::

        x1hat' = s + w^T x2hat + phi
        x2hat' = alpha w s + g(x1, x2hat)
        lambda' = 2 alpha1 |e| where |e| > 2 delta, else 0
        when |xhat| >= gamma M:  xhat <- M xhat / |xhat|

    Parameters
    ----------
    form : PartitionedSystem
        With a canonical form.
    switch : "fraction", "sign" or "hyperbolic tangent"
        What s is: lambda times the fraction above, the sign of e, or tanh(e / delta).
    hidden_gain : float
        alpha, weight of s in the hidden part; positive.  Default 5.
    adaptation : float
        alpha1, how fast the switching gains grow; positive.  Default 10.
    boundary_layer : float
        delta, width over which the sign is smoothed; positive.  Default 0.2.
    switching_gain : float
        lambda(0), the switching gains at the start; positive.  Default 1.
    bound : float
        M, bound on the estimate's norm; positive.  Default 10.
    reset_ratio : float
        gamma, how far beyond the bound the estimate must be to be reset; more than 1.  Default 1.01.
    noise_variance : float
        Variance of the noise in each output, whose bias is then taken out of the hidden part.  Default 0.

    Returns
    -------
    Observer

    Raises
    ------
    NotAffine
        If there is no canonical form.
    ValueError
        If a gain is unknown or out of its range, or the switch has no such name.

    Notes
    -----
    Ma, Chen and Moore 2005, (21)-(23), pp. 67-68.  The bias is `noise_bias` of the correction s.
    """
    form = form.canonical_form()
    estimate = hats((*form.x1, *form.x2))
    lambdas = sp.symbols(f"lambda1:{len(form.x1) + 1}", real=True)
    e = innovation(form)
    smoothed = switch_named(switch)
    s = sp.ImmutableMatrix([lam * smoothed(ei, delta) for lam, ei in zip(lambdas, e, strict=True)])
    flow = output_injection(form, s, sp.S.One, alpha, noise_bias(form, s))
    growth = [sp.Piecewise((2 * alpha1 * sp.Abs(ei), sp.Abs(ei) > 2 * delta), (0, True)) for ei in e]
    state = (*estimate, *lambdas)
    equations = Equations(
        state,
        (*flow, *growth),
        form.x1,
        form.parameters,
        tuple(gain.symbol for gain in GAINS),
        (),
        *kept_within(state, estimate),
    )
    start = (*estimate, *(lambda0 for _ in lambdas))
    observer = Observer("sliding mode", form, equations, hats(form.coordinates), GAINS, start, about=ABOUT)
    return observer.with_gains(**gains)


smo = sliding_mode
