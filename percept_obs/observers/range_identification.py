"""The range identification observer of Dixon, Fang, Dawson and Flynn (2003)."""

from __future__ import annotations

import sympy as sp

from percept_obs.equations import Equations
from percept_obs.forms import PartitionedSystem
from percept_obs.observers.base import About, Gain, Observer, hats, innovation
from percept_obs.switching import switch_named

alpha, k, gamma, delta = sp.symbols("alpha k gamma delta", real=True)

GAINS = (
    Gain(alpha, "filter_rate", 3, 0.5, 20, "how fast the filtered innovation forgets", alpha > 0, "it must forget"),
    Gain(k, "feedback", 5, 0.5, 30, "weight of the innovation", k > 0, "it must damp"),
    Gain(gamma, "switching_gain", 20, 0.1, 50, "size of the switching term", gamma > 0, "it must push towards e = 0"),
    Gain(
        delta, "boundary_layer", 0.05, 0.001, 0.5, "width over which the sign is smoothed", delta > 0, "it is a width"
    ),
)


class NeedsMoreOutputs(ValueError):
    """The observer recovers one hidden coordinate only."""


ABOUT = About(
    "Range identification observer (RIO)",
    "Dixon, Fang, Dawson and Flynn 2003",
    "all image coordinates",
    "asymptotic, if the switching gain exceeds the bounds on f' and f'' and the point stays off the focus of expansion",
)


def range_identification(form: PartitionedSystem, switch: str = "hyperbolic tangent", **gains: float) -> Observer:
    """Range identification observer (RIO).

    With e = x1 - x1hat, for one hidden coordinate x2::

        x1hat' = phi + f
        f' = -(k + alpha) f + gamma sgn(e) + alpha k e
        x2hat = w^T f / |w|^2

    Parameters
    ----------
    form : PartitionedSystem
        With a canonical form and one hidden coordinate.
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

    Returns
    -------
    Observer
        The estimate is not defined where w = 0, at the focus of expansion.

    Raises
    ------
    NotAffine
        If there is no canonical form.
    NeedsMoreOutputs
        If more than one coordinate is hidden.
    ValueError
        If a gain is unknown or out of its range, or the switch has no such name.

    Notes
    -----
    W. E. Dixon, Y. Fang, D. M. Dawson, T. J. Flynn, Range identification for perspective vision systems, IEEE Trans.
    Automatic Control 48(12), 2003; Ma, Chen and Moore 2005, p. 65.
    """
    form = form.canonical_form()
    if len(form.x2) != 1:
        raise NeedsMoreOutputs(
            f"the range identification observer recovers one hidden coordinate, but {', '.join(form.hidden)} are "
            "hidden; measure every image coordinate"
        )
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
    squared = sum(entry**2 for entry in form.w)
    hidden = (form.w * sp.ImmutableMatrix(f))[0] / squared
    by_coordinate = dict(zip((*form.x1, *form.x2), (*x1_hat, hidden), strict=True))
    estimate = tuple(by_coordinate[x] for x in form.coordinates)
    start = (*x1_hat, *(form.w.T * hats(form.x2)[0]))
    observer = Observer("range identification", form, equations, estimate, GAINS, start, about=ABOUT)
    return observer.with_gains(**gains)


rio = range_identification
