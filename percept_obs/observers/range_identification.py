"""The range identification observer of Dixon, Fang, Dawson and Flynn (2003)."""

import sympy as sp

from percept_obs.observers.family import Derived, family
from percept_obs.observers.gains import Gain
from percept_obs.observers.inversion import AMPLIFICATION_GAIN, inverted, needs_more_outputs
from percept_obs.observers.parts import hats, innovation
from percept_obs.observers.switching import switch_named, switch_option
from percept_obs.system.forms import CanonicalForm

alpha, k, gamma, delta = sp.symbols("alpha k gamma delta", real=True)

FORGETS, PUSHES, WIDTH = "it must forget", "it must push towards e = 0", "it is a width"


@family(
    name="range identification",
    title="Range identification observer (RIO)",
    source="Dixon, Fang, Dawson and Flynn 2003",
    needs="all image coordinates",
    claim="asymptotic, if the switching gain exceeds the bounds on f' and f'' and the point stays off the focus of "
    "expansion",
    gains=(
        Gain(alpha, "filter_rate", 3, 0.5, 20, "1/s", "how fast the filtered innovation forgets", alpha > 0, FORGETS),
        Gain(k, "feedback", 5, 0.5, 30, "1/s", "weight of the innovation", k > 0, "it must damp"),
        Gain(gamma, "switching_gain", 20, 0.1, 50, "1/s^2", "size of the switching term", gamma > 0, PUSHES),
        Gain(delta, "boundary_layer", 0.05, 0.001, 0.5, "1", "width over which the sign is smoothed", delta > 0, WIDTH),
        AMPLIFICATION_GAIN,
    ),
    options=(switch_option("hyperbolic tangent", "What stands for sgn; the sign itself chatters at a fixed step"),),
    # the equations are symmetric in both rates: they are taken equal
    candidates=tuple(
        {"filter_rate": rate, "feedback": rate, "switching_gain": switching, "boundary_layer": layer}
        for rate in (3, 4, 6)
        for switching in (1, 3, 10)
        for layer in (0.05, 0.1, 0.2)
    ),
    objection_of=needs_more_outputs,
    stays_at_truth=False,
)
def range_identification(form: CanonicalForm, switch: str) -> Derived:
    """Range identification observer (RIO).

    It learns f = w^T x2.  With e = x1 - x1hat::

        x1hat' = phi + f
        f' = -(k + alpha) f + gamma sgn(e) + alpha k e
        x2hat solves w^T x2hat = f, with more outputs than hidden coordinates in the least-squares sense

    With both image coordinates measured there is no estimate near the focus of expansion, where w = 0.

    See Also
    --------
    integral_sliding_mode

    Notes
    -----
    W. E. Dixon, Y. Fang, D. M. Dawson, T. J. Flynn, Range identification for perspective vision systems, IEEE Trans.
    Automatic Control 48(12), 2003, for one hidden coordinate, where x2hat = w^T f / |w|^2; Ma, Chen and Moore 2005,
    p. 65.  For the theory to hold, gamma must be larger than the bounds on f' and f''.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers import rio
    >>> observer = rio(PerspectiveSystem(affine(), pinhole()), switch="sign")
    >>> observer.estimate
    (yhat1, yhat2, (f1*(b1 - b3*y1) + f2*(b2 - b3*y2))/((b1 - b3*y1)**2 + (b2 - b3*y2)**2))
    """
    sgn, x1_hat = switch_named(switch), hats(form.x1)
    f = sp.symbols(f"f1:{len(form.x1) + 1}", real=True)
    filters = [
        -(k + alpha) * fi + gamma * sgn(e, delta) + alpha * k * e for fi, e in zip(f, innovation(form), strict=True)
    ]
    hidden, unobservable = inverted(form, sp.ImmutableMatrix(f))
    return Derived(
        (*x1_hat, *f),
        (*(form.phi + sp.ImmutableMatrix(f)), *filters),
        (*x1_hat, *(form.w.T * sp.ImmutableMatrix(hats(form.x2)))),
        (*x1_hat, *hidden),
        unobservable=(unobservable,),
    )


rio = range_identification
