"""Parts of observers' equations: estimates, innovation, output injection, bias of noise, a bound."""

import re
from collections.abc import Sequence

import sympy as sp
from sympy.logic.boolalg import Boolean

from percept_obs.compile.equations import Expressions, Symbols
from percept_obs.observers.gains import Gain
from percept_obs.system.forms import CanonicalForm
from percept_obs.validation import checked, matrix

M, gamma, sigma2 = sp.symbols("M gamma sigma^2", real=True)

VARIANCE = "it is a variance"
WHY = "at 1 the reset maps the bound to itself and the estimate sticks to it"
BOUND_GAINS = (
    Gain(M, "bound", 10, 1, 50, "1/m", "largest norm of the estimate", M > 0, "it bounds a norm"),
    Gain(gamma, "reset_ratio", 1.01, 1.001, 2, "1", "how far beyond the bound the estimate is reset", gamma > 1, WHY),
)
"""Gains of `kept_within`."""

NOISE_GAIN = Gain(
    sigma2, "noise_variance", 0, 0, 1e-3, "1", "variance of the noise whose bias is taken out", sigma2 >= 0, VARIANCE
)
"""Gain of `noise_bias`."""


@checked
def hats(symbols: Sequence[sp.Symbol]) -> tuple[sp.Symbol, ...]:
    """Return symbols of the estimates: yhat1 for y1.

    Parameters
    ----------
    symbols : sequence of symbols
        Such as y1; the hat goes before the number at the end.

    See Also
    --------
    innovation : Outputs minus their estimates.

    Examples
    --------
    >>> from percept_obs.observers.parts import hats
    >>> hats(sp.symbols("y1 q12 c"))
    (yhat1, qhat12, chat)
    """
    return tuple(sp.Symbol(re.sub(r"(\d*)$", r"hat\1", s.name, count=1), real=True) for s in symbols)


@checked
def first_seen(x1: Sequence[sp.Symbol]) -> tuple[sp.Symbol, ...]:
    """Return symbols s_y1 for y1 that are 1 where an output starts from its first sample, 0 where its start is set.

    Parameters
    ----------
    x1 : sequence of symbols
        Measured outputs.

    See Also
    --------
    percept_obs.observers.family.Derived : Has the start.

    Examples
    --------
    >>> from percept_obs.observers.parts import first_seen
    >>> first_seen(sp.symbols("y1:3"))
    (s_y1, s_y2)
    """
    return tuple(sp.Symbol(f"s_{output.name}", real=True) for output in x1)


@checked
def output_injection(
    form: CanonicalForm,
    correction: sp.ImmutableMatrix,
    measured_gain: sp.Expr,
    hidden_gain: sp.Expr,
    bias: sp.ImmutableMatrix | None = None,
) -> Expressions:
    """Return the flow of a copy of the system with feedback of a correction.

    With the correction c, the gains L1, L2 and the bias b of w c::

        x1hat' = L1 c + w^T x2hat + phi
        x2hat' = L2 (w c - b) + g(x1, x2hat)

    Parameters
    ----------
    form : CanonicalForm
    correction : matrix of shape (n1, 1)
        The innovation `innovation`, or a function of it.
    measured_gain, hidden_gain : expressions
    bias : matrix of shape (n2, 1), optional
        Such as `noise_bias`; none when left out.

    See Also
    --------
    innovation, percept_obs.observers.noise_bias : Parts of it.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers.parts import innovation, output_injection
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> output_injection(form, innovation(form), 2, 3)[0]
    a11*y1 + a12*y2 + a13 - a31*y1**2 - a32*y1*y2 - a33*y1 + 2*y1 - 2*yhat1 + yhat3*(b1 - b3*y1)
    """
    x2_hat, correction = hats(form.x2), matrix(correction, "the correction", len(form.x1), 1)
    injected = form.w * correction - (sp.zeros(len(x2_hat), 1) if bias is None else bias)
    measured_rate = measured_gain * correction + form.w.T * sp.ImmutableMatrix(x2_hat) + form.phi
    hidden_rate = hidden_gain * injected + form.g.subs(dict(zip(form.x2, x2_hat, strict=True)))
    return (*measured_rate, *hidden_rate)


@checked
def innovation(form: CanonicalForm) -> sp.ImmutableMatrix:
    """Return measured outputs minus their estimates, x1 - x1hat, shape (n1, 1).

    Parameters
    ----------
    form : CanonicalForm

    See Also
    --------
    output_injection : Feeds it back.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers.parts import innovation
    >>> innovation(PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")).T
    Matrix([[y1 - yhat1, y2 - yhat2]])
    """
    return sp.ImmutableMatrix(form.x1) - sp.ImmutableMatrix(hats(form.x1))


@checked
def kept_within(state: Symbols, estimate: Symbols) -> tuple[Boolean, Expressions]:
    """Return the reset condition and the reset that shrink an estimate to the bound M once its norm reaches gamma M.

    Ma 2005, (12), p. 65.  Other states stay.

    Parameters
    ----------
    state : symbols
    estimate : symbols
        Those of the state whose norm is bounded.

    Raises
    ------
    ValueError
        If there is no estimate, or it is none of the state.

    See Also
    --------
    identifier_based : Uses it.

    Examples
    --------
    >>> from percept_obs.observers.parts import kept_within
    >>> kept_within(hats(sp.symbols("y1 y3")), hats(sp.symbols("y3,")))
    (yhat3**2 >= M**2*gamma**2, (yhat1, M*yhat3/Abs(yhat3)))
    """
    if not estimate or not set(estimate) <= set(state):
        raise ValueError(f"the estimate is {estimate}; give symbols of the state {state}, at least one")
    squared = sum(hat**2 for hat in estimate)
    shrink = M / sp.sqrt(squared)
    return sp.Ge(squared, (gamma * M) ** 2), tuple(shrink * s if s in estimate else s for s in state)


@checked
def noise_bias(form: CanonicalForm, correction: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Return the bias of ``w(x1) correction(x1)``, shape (n2, 1), by white noise on the outputs.

    The same sample n enters both factors: with the variance sigma^2 in each output,
    E[w(x1 + n) correction(x1 + n)] = w correction + sigma^2 sum_j (dw/dx1_j) (d correction/dx1_j) + ...
    Exact when both are affine in the outputs, as for the identifier-based observer on the pinhole; otherwise the
    curvature of either factor is left out.

    Parameters
    ----------
    form : CanonicalForm
    correction : matrix of shape (n1, 1)
        Factor of w in the observer, in terms of the measured outputs.

    See Also
    --------
    percept_obs.observers.parts.output_injection : Takes it out.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers import noise_bias
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1")
    >>> noise_bias(form, form.phi)
    Matrix([
    [-a32*sigma^2*(a11 - 2*a31*y1 - a33)],
    [ -b3*sigma^2*(a11 - 2*a31*y1 - a33)]])
    """
    correction = matrix(correction, "the correction", len(form.x1), 1)
    # the derivative of a sign is 0 but at single instants
    smooth = {x: correction.diff(x).replace(sp.DiracDelta, lambda *_: sp.S.Zero) for x in form.x1}
    return sigma2 * sum((form.w.diff(x) * smooth[x] for x in form.x1), sp.zeros(len(form.x2), 1))
