"""The sliding mode observer of Chen and Kano (2002)."""

import sympy as sp

from percept_obs.observers.family import Derived, family
from percept_obs.observers.gains import Gain, grid
from percept_obs.observers.parts import (
    BOUND_GAINS,
    NOISE_GAIN,
    hats,
    innovation,
    kept_within,
    noise_bias,
    output_injection,
)
from percept_obs.observers.switching import switch_named, switch_option
from percept_obs.system.forms import CanonicalForm

alpha, alpha1, delta, lambda0 = sp.symbols("alpha alpha1 delta lambda0", real=True)

WHY = "the hidden part must follow the switching term"
SHRINK = "the switching gains may not shrink"
DIVIDES = "with 0 the switching term divides by the error"
PUSHES = "the switching term must push towards the measurement"


@family(
    name="sliding mode",
    title="Sliding mode observer (SMO)",
    source="Chen and Kano 2002; Ma, Chen and Moore 2005, (23)",
    needs="any outputs with a canonical form",
    claim="exponential, if w is persistently exciting and the gains are large enough",
    gains=(
        Gain(
            alpha, "hidden_gain", 5, 0.5, 30, "s/m^2", "weight of the switching term in the hidden part", alpha > 0, WHY
        ),
        Gain(alpha1, "adaptation", 10, 0, 50, "1/s^2", "how fast the switching gains grow", alpha1 >= 0, SHRINK),
        Gain(delta, "boundary_layer", 0.2, 0.005, 1, "1", "width over which the sign is smoothed", delta > 0, DIVIDES),
        Gain(lambda0, "switching_gain", 1, 0.1, 10, "1/s", "the switching gains at the start", lambda0 > 0, PUSHES),
        *BOUND_GAINS,
        NOISE_GAIN,
    ),
    options=(
        switch_option("fraction", "What s is: lambda times the fraction above, the sign of e, or tanh(e / delta)"),
    ),
    candidates=grid(hidden_gain=(20, 50, 120), switching_gain=(0.7, 1.7, 4), boundary_layer=(0.1, 0.2, 0.5, 1)),
)
def sliding_mode(form: CanonicalForm, switch: str) -> Derived:
    """Sliding mode observer with adaptive switching gains (SMO).

    With e = x1 - x1hat and, for each measured output, s = lambda e / (|e| + delta)::

        x1hat' = s + w^T x2hat + phi
        x2hat' = alpha w s + g(x1, x2hat)
        lambda' = 2 alpha1 |e| where |e| > 2 delta, else 0
        when |xhat| >= gamma M:  xhat <- M xhat / |xhat|

    See Also
    --------
    identifier_based, integral_sliding_mode : Observers without and with more of a sliding mode.

    Notes
    -----
    Ma, Chen and Moore 2005, (21)-(23), pp. 67-68.  lambda starts at `switching_gain`.  `noise_variance`
    takes out the `noise_bias` of the correction s.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers import smo
    >>> observer = smo(PerspectiveSystem(affine(), pinhole()).measure("y1"))
    >>> {gain.name: gain.value for gain in observer.gains[:3]}
    {'hidden_gain': 5.0, 'adaptation': 10.0, 'boundary_layer': 0.2}
    """
    estimate = hats((*form.x1, *form.x2))
    lambdas = sp.symbols(f"lambda1:{len(form.x1) + 1}", real=True)
    e = innovation(form)
    smoothed = switch_named(switch)
    s = sp.ImmutableMatrix([lam * smoothed(ei, delta) for lam, ei in zip(lambdas, e, strict=True)])
    flow = output_injection(form, s, sp.S.One, alpha, noise_bias(form, s))
    growth = [sp.Piecewise((2 * alpha1 * sp.Abs(ei), sp.Abs(ei) > 2 * delta), (0, True)) for ei in e]
    state = (*estimate, *lambdas)
    start = (*estimate, *(lambda0 for _ in lambdas))
    return Derived(state, (*flow, *growth), start, reset=kept_within(state, estimate))


smo = sliding_mode
