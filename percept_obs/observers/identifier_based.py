"""The identifier-based observer of Jankovic and Ghosh (1995)."""

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
from percept_obs.system.forms import PartitionedSystem

G, A, P = sp.symbols("G A P", real=True)

GAINS = (
    Gain(G, "gain", 10, 1, 30, "how fast the observer is", G > 0, "the error feedback must damp"),
    Gain(A, "injection", 1, 0.1, 3, "weight of the innovation in the measured part"),
    Gain(P, "lyapunov", -0.5, -5, -0.05, "weight of the innovation in the hidden part"),
    *BOUND_GAINS,
    NOISE_GAIN,
)


ABOUT = About(
    "Identifier-based observer (IBO)",
    "Jankovic and Ghosh 1995; Ma, Chen and Moore 2005, (11)",
    "any outputs with a canonical form",
    "exponential between resets, if w is persistently exciting and G is large enough; biased by noise that enters w",
)


def identifier_based(form: PartitionedSystem, **gains: float) -> Observer:
    """Identifier-based observer (IBO).

    With e = x1 - x1hat::

        x1hat' = G A e + w^T x2hat + phi
        x2hat' = -G^2 P w e + g(x1, x2hat)
        when |xhat| >= gamma M:  xhat <- M xhat / |xhat|

    Parameters
    ----------
    form : PartitionedSystem
        With a canonical form.
    gain : float
        G, how fast the observer is; positive.  Default 10.
    injection : float
        A, weight of e in the measured part; the factor of the identity.  Default 1.
    lyapunov : float
        P, weight of e in the hidden part; the factor of the identity.  Default -1/2, the printed value, whose sign
        repairs that of (11).
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
        If a gain is unknown or out of its range.

    Notes
    -----
    Ma, Chen and Moore 2005, (11)-(16), pp. 65-66.  The bias is `noise_bias` of the correction e.
    """
    form = form.canonical_form()
    state = hats((*form.x1, *form.x2))
    e = innovation(form)
    flow = output_injection(form, e, G * A, -(G**2) * P, noise_bias(form, e))
    equations = Equations(
        state,
        flow,
        form.x1,
        form.parameters,
        tuple(gain.symbol for gain in GAINS),
        (),
        *kept_within(state, state),
    )
    observer = Observer("identifier-based", form, equations, hats(form.coordinates), GAINS, state, about=ABOUT)
    return observer.with_gains(**gains)


ibo = identifier_based
