"""The integral sliding mode observer of Chwa (2019)."""

from __future__ import annotations

import math

import sympy as sp

from percept_obs.observers.base import FastestRate, Observer
from percept_obs.observers.family import Derived, family
from percept_obs.observers.gains import Gain, grid
from percept_obs.observers.inversion import (
    AMPLIFICATION_GAIN,
    Unobservable,
    c_max,
    elapsed,
    first_innovation,
    inverted,
    needs_more_outputs,
)
from percept_obs.observers.parts import hats, innovation
from percept_obs.observers.switching import Switch, switch_named, switch_option
from percept_obs.system.forms import CanonicalForm
from percept_obs.validation import checked

k1, k2, gamma, a, b, delta = sp.symbols("k1 k2 gamma a b delta", real=True)
c = sp.Symbol("c", real=True)

BOUNDS, WIDTH = "it bounds a size", "it is a width"
BACK, SURFACE = "they must push back", "it must push towards s = 0"

IDEAL = "ideal"
"""Name of the switch that is infinitely fast, so that s = 0 at all times."""

GAINS = (
    Gain(k1, "feedback", 15, 1, 50, "1/s", "weight of the integral sliding surface", k1 > 0, "it must damp"),
    Gain(gamma, "switching_gain", 15, 1, 50, "1/s", "bound on what is not known of the rate", gamma > 0, BOUNDS),
    Gain(a, "sharpness", 1, 0.1, 10, "1", "slope of the hyperbolic tangents at the start", a > 0, BACK),
    Gain(b, "sharpening", 0.1, 0, 1, "1/s", "how fast that slope grows", b >= 0, "the slope may not turn around"),
    AMPLIFICATION_GAIN,
)
SWITCHING_GAINS = (
    Gain(k2, "reaching_gain", 1, 0.1, 20, "1/s^2", "size of the switching that remains", k2 > 0, SURFACE),
    Gain(delta, "boundary_layer", 0.5, 0.01, 2, "1/s", "width over which the sign is smoothed", delta > 0, WIDTH),
)


@family(
    name="integral sliding mode",
    title="Integral sliding mode observer (ISMO)",
    source="Chwa 2019, (8)-(14)",
    needs="at least as many outputs as hidden coordinates",
    claim="asymptotic, if gamma exceeds what is not known of the rate in every output, and the samples do not stand "
    "still in between: held for 10 ms, even without noise, it does not settle on Ma's example (35); held for 1 ms it "
    "is off by 1.5 to 2.4 % after 1 s in Chwa's case IV.A",
    gains=(*GAINS, *SWITCHING_GAINS),
    options=(switch_option(IDEAL, "What stands for sgn(s), see below"),),
    candidates=grid(feedback=(1, 2, 4), switching_gain=(0.25, 0.5), sharpening=(0,)),
    objection_of=needs_more_outputs,
    stays_at_truth=False,
)
def integral_sliding_mode(form: CanonicalForm, switch: str) -> Derived:
    """Integral sliding mode observer (ISMO).

    It takes all of g = w^T x2 for an unknown disturbance.  With e = x1 - x1hat, se = e + eI,
    s = v + gamma tanh(c se), and functions taken of each entry::

        x1hat' = phi + ghat                           ghat = k1 se - v + gamma tanh(c e)
        eI' = gamma tanh(c e)                         eI(0) = -e(0), so that se(0) = 0
        v' = gamma sech^2(c se) (c (ghat - gamma tanh(c e)) - b se)
             - (gamma^2 c sech^2(c se) + k2) sgn(s) - se,    v(0) = -gamma tanh(a se(0)), so that s(0) = 0
        c = a + b t

        x2hat solves w^T x2hat = ghat, with more outputs than hidden coordinates in the least-squares sense

    The ideal switch is infinitely fast and keeps s = 0, so that v = -gamma tanh(c se) is no state any more, and k2 and
    delta are no gains; the sign chatters by about gamma^2 c h at a step h, and the others smooth it over the boundary
    layer, as long as the step resolves that.

    It starts from estimates of the measured outputs only, and gives none of the hidden coordinates while what is left
    of that start in ghat may be half of them; the start counts no more once it has shrunk by c_max.  gamma must be
    larger than the absolute value of each entry of w^T x2.  With b = 0 the observer's gain, and so the noise that it
    passes on, does not grow with time; Theorem 1 asks b to be positive.

    See Also
    --------
    percept_obs.observers.range_identification, sliding_mode : Others that switch.
    percept_obs.observers.integral_sliding_mode.ultimate_bound : How large its error stays.
    percept_obs.observers.integral_sliding_mode.tolerable_amplification : Chooses c_max.

    Notes
    -----
    D. Chwa, Integral-sliding-mode-observer-based structure and motion estimation of a single object in general motion
    using a monocular dynamic camera, IEEE Access 8, 2020 (published in November 2019), section III.  The paper starts
    from ghat(0) = x1hat(0) = 0, but (9)-(14) give ghat(0) = gamma tanh(a e(0)), which is 0 only where e(0) is.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers import ismo
    >>> observer = ismo(PerspectiveSystem(affine(), pinhole()))
    >>> observer.equations.state
    (yhat1, yhat2, eI1, eI2, c)
    """
    x1_hat, e = hats(form.x1), innovation(form)
    integral, v = (sp.symbols(f"{name}1:{len(e) + 1}", real=True) for name in ("eI", "v"))
    se = e + sp.ImmutableMatrix(integral)
    push, pull = (gamma * surface.applyfunc(lambda entry: sp.tanh(c * entry)) for surface in (e, se))
    state, start = (*x1_hat, *integral, c), (*x1_hat, *-e, a)
    used: tuple[Gain, ...] = GAINS
    if switch == IDEAL:
        g_hat = k1 * se + pull + push
        flow = (*(form.phi + g_hat), *push, b)
    else:
        sgn = switch_named(switch)
        g_hat = k1 * se - sp.ImmutableMatrix(v) + push
        s = sp.ImmutableMatrix(v) + pull
        pseudo_input = [_pseudo_input(*row, sgn) for row in zip(g_hat - push, se, s, strict=True)]
        flow = (*(form.phi + g_hat), *push, b, *pseudo_input)
        state, start, used = (*state, *v), (*start, *(sp.S.Zero for _ in v)), (*GAINS, *SWITCHING_GAINS)
    hidden, unobservable = inverted(form, g_hat)
    return Derived(
        state,
        flow,
        start,
        (*x1_hat, *hidden),
        unobservable=(unobservable, _start_left_over(form, g_hat)),
        fastest=_fastest(switch),
        gains=used,
    )


class GainTooSmall(ValueError):
    """The switching gain does not exceed what it is to dominate, so that Theorem 1 says nothing."""


@checked
def ultimate_bound(observer: Observer, disturbance: float, time: float = 0.0) -> float:
    """Return a bound on each entry of se, outside of which Theorem 1 makes it shrink.

    With alpha = |g| / gamma < 1 it is ln((1 + alpha) / (1 - alpha)) / (2 (a + b t)), and goes to 0 with time if b > 0.
    It is in the unit of the outputs.

    Parameters
    ----------
    observer : Observer
        From `integral_sliding_mode`.
    disturbance : float
        Largest absolute value of the entries of g = w^T x2.
    time : float
        Seconds since the first sample.

    Raises
    ------
    GainTooSmall
        If alpha is 1 or more.
    ValueError
        If the time or the disturbance is negative or not finite, or the observer is another one.

    See Also
    --------
    integral_sliding_mode

    Notes
    -----
    Chwa 2019, (16)-(21), p. 5.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, integral_sliding_mode, pinhole
    >>> from percept_obs.observers.integral_sliding_mode import ultimate_bound
    >>> observer = integral_sliding_mode(PerspectiveSystem(affine(), pinhole()))
    >>> [round(ultimate_bound(observer, 5.0, time), 3) for time in (0, 10, 100)]
    [0.347, 0.173, 0.032]
    """
    if not 0 <= time < math.inf:
        raise ValueError(f"the time is {time} s; it must be finite, from 0 on")
    if not 0 <= disturbance < math.inf:
        raise ValueError(f"the disturbance is {disturbance}; it is the largest |g|, finite and from 0 on")
    gains = _gains(observer)
    alpha = disturbance / gains[gamma]
    if not alpha < 1:
        raise GainTooSmall(
            f"the disturbance g reaches {disturbance:.4g}, but the switching gain gamma is {gains[gamma]:.4g}; "
            "alpha = |g| / gamma must be below 1, so take a larger switching_gain"
        )
    return math.atanh(alpha) / (gains[a] + gains[b] * time)


@checked
def tolerable_amplification(observer: Observer, noise: float, hidden: float, time: float = 0.0) -> float:
    """Return the gain `largest_amplification` at which noise makes no spike that looks like an estimate.

    White noise of standard deviation sigma on the samples passes into ghat with the factor k1 + 2 gamma c, and from
    there into the hidden coordinates with the amplification.  The value keeps ten deviations of that below what is
    sought.  It is hidden / (10 noise (k1 + 2 gamma c)), with c at that time.

    Parameters
    ----------
    observer : Observer
        From `integral_sliding_mode`.
    noise : float
        Standard deviation of the noise in the outputs.
    hidden : float
        Size of the hidden coordinate that must not be lost in it.
    time : float
        Seconds at the end of the run; with b > 0 the factor grows.

    Raises
    ------
    ValueError
        If a number is not positive, or the observer is another one.

    See Also
    --------
    integral_sliding_mode, ultimate_bound

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, integral_sliding_mode, pinhole
    >>> from percept_obs.observers.integral_sliding_mode import tolerable_amplification
    >>> observer = integral_sliding_mode(PerspectiveSystem(affine(), pinhole()))
    >>> [round(tolerable_amplification(observer, noise, 0.2), 3) for noise in (1e-4, 1e-3)]
    [4.444, 0.444]
    """
    if not (noise > 0 and hidden > 0 and 0 <= time < math.inf):
        raise ValueError("noise and hidden must be positive and the time finite, from 0 on")
    gains = _gains(observer)
    return hidden / (10 * noise * (gains[k1] + 2 * gains[gamma] * (gains[a] + gains[b] * time)))


def _gains(observer: Observer) -> dict[sp.Symbol, float]:
    """Gains of an integral sliding mode observer; raise ValueError for another one."""
    if missing := {gain.name for gain in GAINS} - {gain.name for gain in observer.gains}:
        raise ValueError(f"the {observer.name} observer has no {', '.join(sorted(missing))}; give one of ismo()")
    return observer.gain_values


def _pseudo_input(estimated_rate: sp.Expr, se: sp.Expr, s: sp.Expr, sgn: Switch) -> sp.Expr:
    """Rate u of v for one output, (13), with the estimated rate k1 se - v of the surface."""
    sech2 = 1 - sp.tanh(c * se) ** 2
    return gamma * sech2 * (c * estimated_rate - b * se) - (gamma**2 * c * sech2 + k2) * sgn(s, delta) - se


def _start_left_over(form: CanonicalForm, g_hat: sp.ImmutableMatrix) -> Unobservable:
    """Condition under which the start may still make up half of the hidden coordinates.

    Its rest is bounded in ghat - g = gamma tanh(c e) - se'.  On the surface e' = -gamma tanh(c e) + se', so that
    sinh(a |e|) shrinks at least like exp(-gamma a t); and se' begins with the rate g, of which ghat is the estimate,
    and shrinks at least like exp(-(k1 + gamma a) t).  The bound and ghat are inverted alike, so that the same rest does
    not matter where the hidden coordinates follow easily.  Shrunk below 1 / c_max, no inversion brings it back.
    """
    slower, faster = (sp.exp(-rate * elapsed) for rate in (gamma * a, k1 + gamma * a))
    begun = first_innovation(form).applyfunc(lambda entry: gamma * sp.sinh(a * sp.Abs(entry)))
    left, (numerator, _) = begun * slower + g_hat.applyfunc(sp.Abs) * faster, form.cramer
    squared = [sum(entry**2 for entry in matrix) for matrix in (numerator, left, numerator * g_hat)]
    half = sp.And(sp.Ge(4 * squared[0] * squared[1], squared[2]), sp.Ge(c_max * slower, 1))
    return Unobservable(half, "what is left of the start may be half of what is found")


def _fastest(switch: str) -> FastestRate | None:
    """Fastest decay rate at se = 0: of se with the ideal switch, of s in a boundary layer; None with a sign."""
    slope = a + b * elapsed
    if switch == IDEAL:
        return FastestRate(k1 + gamma * slope, "take smaller gains, or keep the slope with sharpening=0")
    if switch == "sign":
        return None
    return FastestRate(
        gamma**2 * slope / delta,
        f"take the ideal switch (switch={IDEAL!r}), a wider boundary_layer, or keep the slope with sharpening=0",
    )


ismo = integral_sliding_mode
