"""Depth observers that copy the system and feed the innovation back linearly: De Luca's, and Spica's tuning of it."""

import sympy as sp

from percept_obs.observers.family import Derived, family
from percept_obs.observers.gains import Gain, grid
from percept_obs.observers.parts import hats, innovation, output_injection
from percept_obs.system.forms import CanonicalForm

H, Lam = sp.symbols("H Lambda", real=True)

MEASURED_GAIN = Gain(
    H, "measured_gain", 5, 0.5, 50, "1/s", "weight of the innovation in the measured part", H > 0, "it must damp"
)
HIDDEN_GAIN = Gain(
    Lam, "hidden_gain", 10, 1, 400, "1/m^2", "weight of the innovation in the hidden part", Lam > 0, "it must correct"
)


@family(
    name="De Luca",
    title="Depth observer of De Luca",
    source="De Luca, Oriolo and Robuffo Giordano 2008",
    needs="any outputs with a canonical form",
    claim="local and exponential, if w is persistently exciting",
    gains=(MEASURED_GAIN, HIDDEN_GAIN),
    candidates=grid(measured_gain=(2, 3.5, 6, 10, 17), hidden_gain=(60, 120, 250, 500, 1000)),
    for_structure=True,
)
def de_luca(form: CanonicalForm) -> Derived:
    """Depth observer of De Luca, Oriolo and Robuffo Giordano.

    With e = x1 - x1hat::

        x1hat' = H e + w^T x2hat + phi
        x2hat' = Lambda w e + g(x1, x2hat)

    It is the identifier-based observer with H = G A and Lambda = -G^2 P, without its reset.  So whether it recovers a
    depth depends on the start: while the camera approaches, g holds v_z chihat^2 of the inverse depth chihat, and leads
    an estimate that begins too near to infinity.  While the camera only turns, or moves along the point's ray, w is 0
    and the image shows no depth; for a constant w other than 0 all errors decay.

    See Also
    --------
    identifier_based : with a reset
    spica : critically damped

    Notes
    -----
    A. De Luca, G. Oriolo, P. Robuffo Giordano, Feature depth observation for image-based visual servoing,
    Int. J. Robotics Research 27(10), 2008.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers import de_luca
    >>> observer = de_luca(PerspectiveSystem(affine(), pinhole()).measure("y1"))
    >>> observer.equations.flow[0]
    H*(y1 - yhat1) + a11*y1 + a13 - a31*y1**2 - a33*y1 + yhat2*(a12 - a32*y1) + yhat3*(b1 - b3*y1)
    """
    return _damped(form, H)


@family(
    name="Spica",
    title="Critically damped depth observer of Spica",
    source="Spica and Robuffo Giordano 2013",
    needs="any outputs with a canonical form",
    claim="that of a critically damped oscillator with the frequency sqrt(Lambda) |w|, for slowly varying w",
    gains=(HIDDEN_GAIN,),
    candidates=grid(hidden_gain=(20, 40, 60, 80, 110, 150, 200, 270, 370, 500, 700, 1000)),
)
def spica(form: CanonicalForm) -> Derived:
    """Depth observer of De Luca with the measured gain that damps critically: H = 2 sqrt(Lambda) |w|.

    The error then shrinks like a critically damped oscillator with the natural frequency sqrt(Lambda) |w|, if |w| were
    constant: fast where the point is well observable, and at rest where it is not.

    See Also
    --------
    de_luca

    Notes
    -----
    R. Spica, P. Robuffo Giordano, A framework for active estimation, IEEE CDC 2013.  |w| is the Frobenius norm.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers import spica
    >>> observer = spica(PerspectiveSystem(affine(), pinhole()), hidden_gain=20)
    >>> observer.gain_values
    {Lambda: 20.0}
    """
    return _damped(form, 2 * sp.sqrt(Lam) * sp.sqrt(sum(entry**2 for entry in form.w)))


def _damped(form: CanonicalForm, damping: sp.Expr) -> Derived:
    return Derived(hats((*form.x1, *form.x2)), output_injection(form, innovation(form), damping, Lam))
