"""The range identification observer of Dixon, Fang, Dawson and Flynn (2003)."""

from __future__ import annotations

import sympy as sp

from percept_obs.compile.equations import Equations
from percept_obs.observers.base import RECOVERY_GAIN, About, Gain, Observer, hats, innovation
from percept_obs.observers.inversion import recovered
from percept_obs.observers.switching import switch_named
from percept_obs.system.forms import PartitionedSystem

alpha, k, gamma, delta = sp.symbols("alpha k gamma delta", real=True)

GAINS = (
    Gain(alpha, "filter_rate", 3, 0.5, 20, "how fast the filtered innovation forgets", alpha > 0, "it must forget"),
    Gain(k, "feedback", 5, 0.5, 30, "weight of the innovation", k > 0, "it must damp"),
    Gain(gamma, "switching_gain", 20, 0.1, 50, "size of the switching term", gamma > 0, "it must push towards e = 0"),
    Gain(
        delta, "boundary_layer", 0.05, 0.001, 0.5, "width over which the sign is smoothed", delta > 0, "it is a width"
    ),
    RECOVERY_GAIN,
)


ABOUT = About(
    "Range identification observer (RIO)",
    "Dixon, Fang, Dawson and Flynn 2003",
    "all image coordinates",
    "asymptotic, if the switching gain exceeds the bounds on f' and f'' and the point stays off the focus of expansion",
)


def range_identification(form: PartitionedSystem, switch: str = "hyperbolic tangent", **gains: float) -> Observer:
    """Range identification observer (RIO).

    It learns f = w^T x2.  With e = x1 - x1hat::

        x1hat' = phi + f
        f' = -(k + alpha) f + gamma sgn(e) + alpha k e
        x2hat solves w^T x2hat = f, with more outputs than hidden coordinates in the least-squares sense

    Parameters
    ----------
    form : PartitionedSystem
        With a canonical form and at least as many measured as hidden coordinates.
    switch : "hyperbolic tangent", "sign" or "fraction"
        What stands for sgn; the sign itself chatters at a fixed step.
    filter_rate : float
        alpha, positive.  Default 3.
    feedback : float
        k, positive.  Default 5.
    switching_gain : float
        gamma; larger than the bounds on f' and f'' for the theory to hold.  Default 20.
    boundary_layer : float
        delta, width of the boundary layer.  Default 0.05.
    largest_amplification : float
        c_max; where recovering x2 from f would amplify an error more than this, there is no estimate.  Default 1e5.

    Returns
    -------
    Observer
        With both image coordinates measured there is no estimate near the focus of expansion, where w = 0.

    Raises
    ------
    NotAffine
        If there is no canonical form.
    NeedsMoreOutputs
        If f never determines the hidden coordinates, as with one output for two of them.
    ValueError
        If a gain is unknown or out of its range, or the switch has no such name.

    Notes
    -----
    W. E. Dixon, Y. Fang, D. M. Dawson, T. J. Flynn, Range identification for perspective vision systems, IEEE Trans.
    Automatic Control 48(12), 2003, for one hidden coordinate, where x2hat = w^T f / |w|^2; Ma, Chen and Moore 2005,
    p. 65.
    """
    form = form.canonical_form()
    sgn = switch_named(switch)
    x1_hat = hats(form.x1)
    f = sp.symbols(f"f1:{len(form.x1) + 1}", real=True)
    rates = form.phi + sp.ImmutableMatrix(f)
    filters = [
        -(k + alpha) * fi + gamma * sgn(e, delta) + alpha * k * e for fi, e in zip(f, innovation(form), strict=True)
    ]
    equations = Equations(
        (*x1_hat, *f), (*rates, *filters), form.x1, form.parameters, tuple(gain.symbol for gain in GAINS)
    )
    hidden, gap = recovered(form, sp.ImmutableMatrix(f))
    by_coordinate = dict(zip((*form.x1, *form.x2), (*x1_hat, *hidden), strict=True))
    estimate = tuple(by_coordinate[x] for x in form.coordinates)
    start = (*x1_hat, *(form.w.T * sp.ImmutableMatrix(hats(form.x2))))
    observer = Observer("range identification", form, equations, estimate, GAINS, start, about=ABOUT, gaps=(gap,))
    return observer.with_gains(**gains)


rio = range_identification
