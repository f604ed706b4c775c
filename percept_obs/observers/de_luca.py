"""Depth observers that copy the system and feed the innovation back linearly: De Luca's, and Spica's tuning of it."""

from __future__ import annotations

import sympy as sp

from percept_obs.compile.equations import Equations
from percept_obs.observers.base import About, Gain, Observer, hats, innovation, output_injection
from percept_obs.system.forms import CanonicalForm, PartitionedSystem

H, Lam = sp.symbols("H Lambda", real=True)

LAMBDA_GAIN = Gain(
    Lam,
    "hidden_gain",
    10,
    1,
    400,
    "weight of the innovation in the hidden part",
    Lam > 0,
    "it must correct, not push away",
)
GAINS = (
    Gain(H, "measured_gain", 5, 0.5, 50, "weight of the innovation in the measured part", H > 0, "it must damp"),
    LAMBDA_GAIN,
)


ABOUT_DE_LUCA = About(
    "Depth observer of De Luca",
    "De Luca, Oriolo and Robuffo Giordano 2008",
    "any outputs with a canonical form",
    "local and exponential, if w is persistently exciting",
)
ABOUT_SPICA = About(
    "Critically damped depth observer of Spica",
    "Spica and Robuffo Giordano 2013",
    "any outputs with a canonical form",
    "that of a critically damped oscillator with the frequency sqrt(Lambda) |w|, for slowly varying w",
)


def de_luca(form: PartitionedSystem, **gains: float) -> Observer:
    """Depth observer of De Luca, Oriolo and Robuffo Giordano.

    With e = x1 - x1hat::

        x1hat' = H e + w^T x2hat + phi
        x2hat' = Lambda w e + g(x1, x2hat)

    It is the identifier-based observer with H = G A and Lambda = -G^2 P, without its reset.

    Parameters
    ----------
    form : PartitionedSystem
        With a canonical form.
    measured_gain : float
        H, positive.  Default 5.
    hidden_gain : float
        Lambda, positive.  Default 10.

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
    A. De Luca, G. Oriolo, P. Robuffo Giordano, Feature depth observation for image-based visual servoing,
    Int. J. Robotics Research 27(10), 2008.
    """
    return _depth_observer("De Luca", form.canonical_form(), H, GAINS, ABOUT_DE_LUCA).with_gains(**gains)


def spica(form: PartitionedSystem, **gains: float) -> Observer:
    """Depth observer with the measured gain that damps critically: H = 2 sqrt(Lambda) |w|.

    The error then shrinks like a critically damped oscillator with the natural frequency sqrt(Lambda) |w|, if |w| were
    constant: fast where the point is well observable, and at rest where it is not.

    Parameters
    ----------
    form : PartitionedSystem
        With a canonical form.
    hidden_gain : float
        Lambda, positive.  Default 10.

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
    R. Spica, P. Robuffo Giordano, A framework for active estimation, IEEE CDC 2013.  |w| is the Frobenius norm.
    """
    form = form.canonical_form()
    damping = 2 * sp.sqrt(Lam) * sp.sqrt(sum(entry**2 for entry in form.w))
    return _depth_observer("Spica", form, damping, (LAMBDA_GAIN,), ABOUT_SPICA).with_gains(**gains)


def _depth_observer(
    name: str, form: CanonicalForm, damping: sp.Expr, gains: tuple[Gain, ...], about: About
) -> Observer:
    state = hats((*form.x1, *form.x2))
    flow = output_injection(form, innovation(form), damping, Lam)
    equations = Equations(state, flow, form.x1, form.parameters, tuple(gain.symbol for gain in gains))
    return Observer(name, form, equations, hats(form.coordinates), gains, state, about=about)
