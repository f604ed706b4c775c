"""The identifier-based observer of Jankovic and Ghosh (1995)."""

import sympy as sp

from percept_obs.observers.family import Derived, family
from percept_obs.observers.gains import Gain
from percept_obs.observers.parts import (
    BOUND_GAINS,
    NOISE_GAIN,
    hats,
    innovation,
    kept_within,
    noise_bias,
    output_injection,
)
from percept_obs.system.forms import CanonicalForm

G, A, P = sp.symbols("G A P", real=True)


@family(
    name="identifier-based",
    title="Identifier-based observer (IBO)",
    source="Jankovic and Ghosh 1995; Ma, Chen and Moore 2005, (11)",
    needs="any outputs with a canonical form",
    claim="exponential between resets, if w is persistently exciting and G is large enough; "
    "biased by noise that enters w",
    gains=(
        Gain(G, "gain", 10, 1, 30, "1/s", "how fast the observer is", G > 0, "the error feedback must damp"),
        Gain(A, "injection", 1, 0.1, 3, "1", "weight of the innovation in the measured part"),
        Gain(P, "lyapunov", -0.5, -5, -0.05, "s^2/m^2", "weight of the innovation in the hidden part"),
        *BOUND_GAINS,
        NOISE_GAIN,
    ),
    candidates=tuple(
        {"gain": gain, "lyapunov": -feedback / gain**2}
        for gain in (2, 3.5, 6, 10, 17)
        for feedback in (60, 120, 250, 500, 1000)
    ),
    for_structure=True,
)
def identifier_based(form: CanonicalForm) -> Derived:
    """Identifier-based observer (IBO).

    With e = x1 - x1hat::

        x1hat' = G A e + w^T x2hat + phi
        x2hat' = -G^2 P w e + g(x1, x2hat)
        when |xhat| >= gamma M:  xhat <- M xhat / |xhat|

    See Also
    --------
    percept_obs.observers.de_luca : Without the reset.

    Notes
    -----
    Ma, Chen and Moore 2005, (11)-(16), pp. 65-66.  A and P are factors of the identity; the printed P = -1/2 has a sign
    that repairs that of (11).  `noise_variance` takes out the `noise_bias` of the correction e.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers import ibo
    >>> observer = ibo(PerspectiveSystem(affine(), pinhole()), gain=5)
    >>> observer.gain_values
    {G: 5.0, A: 1.0, P: -0.5, M: 10.0, gamma: 1.01, sigma^2: 0.0}
    >>> observer.equations.reset_condition
    yhat1**2 + yhat2**2 + yhat3**2 >= M**2*gamma**2
    """
    state, e = hats((*form.x1, *form.x2)), innovation(form)
    flow = output_injection(form, e, G * A, -(G**2) * P, noise_bias(form, e))
    return Derived(state, flow, reset=kept_within(state, state))


ibo = identifier_based
