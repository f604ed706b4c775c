"""The extended Kalman filter: continuous flow, correction at every sample."""

from __future__ import annotations

import sympy as sp

from percept_obs.compile.equations import Equations
from percept_obs.observers.base import About, Gain, Observer, hats
from percept_obs.system.forms import PartitionedSystem

R, Q, Q2, P1, P2 = sp.symbols("R Q Q2 P01 P02", real=True)

GAINS = (
    Gain(
        R,
        "noise_variance",
        1e-4 / 3,
        1e-7,
        1e-2,
        "variance of the noise in each output",
        R > 0,
        "with 0 the filter divides by the variance of what it knows exactly",
    ),
    Gain(
        Q,
        "process_noise",
        0,
        0,
        1e-2,
        "variance per second by which the motion is doubted",
        Q >= 0,
        "it is a variance",
    ),
    Gain(
        Q2,
        "hidden_process_noise",
        0,
        0,
        1,
        "what is added to it in the hidden part, which may change more than the motion says",
        Q2 >= 0,
        "it is a variance",
    ),
    Gain(
        P1,
        "measured_variance",
        1,
        1e-4,
        10,
        "variance of the start in the measured part",
        P1 > 0,
        "it is a variance, and a start known exactly is never corrected",
    ),
    Gain(
        P2,
        "hidden_variance",
        1,
        1e-4,
        10,
        "variance of the start in the hidden part",
        P2 > 0,
        "it is a variance, and a start known exactly is never corrected",
    ),
)


ABOUT = About(
    "Extended Kalman filter (EKF)",
    "Jazwinski 1970",
    "any outputs",
    "local: the covariance must stay bounded, as it does where the linearised system is observable",
)


def extended_kalman(form: PartitionedSystem, **gains: float) -> Observer:
    """Extended Kalman filter (EKF), for any measured outputs; it needs no canonical form.

    Between samples, with the system's rate f and its Jacobian F at the estimate::

        xhat' = f(xhat)
        P' = F P + P F^T + Q I + Q2 I2,      I2 = 1 for hidden coordinates, else 0

    At a sample of each measured output y_j in turn, with column P_j of P::

        k = P_j / (P_jj + R),  xhat <- xhat + k (y_j - xhat_j),  P <- P - k P_j^T

    Parameters
    ----------
    form : PartitionedSystem
    noise_variance : float
        R, variance of the noise in each output; positive.  Default 0.01^2 / 3, uniform noise of +-0.01.
    process_noise : float
        Q, variance per second added to every coordinate; not negative.  Default 0.
    hidden_process_noise : float
        Q2, what is added to it in the hidden coordinates, such as constants that may wander; not negative.  Default 0.
    measured_variance, hidden_variance : float
        Variances of the start in the measured and in the hidden coordinates; positive.  Default 1.

    Returns
    -------
    Observer

    Raises
    ------
    ValueError
        If a gain is unknown or out of its range.

    Notes
    -----
    Jazwinski, Stochastic Processes and Filtering Theory (1970), section 8.3.
    """
    x = (*form.x1, *form.x2)
    size = len(x)
    x_hat = hats(x)
    at_estimate = dict(zip(x, x_hat, strict=True))
    rate = form.rate.xreplace(at_estimate)
    F = rate.jacobian(x_hat)
    P = sp.ImmutableMatrix(size, size, lambda i, j: sp.Symbol(f"P{min(i, j) + 1}{max(i, j) + 1}", real=True))
    P_rate = F * P + P * F.T + sp.diag(*(Q for _ in form.x1), *(Q + Q2 for _ in form.x2))

    def state(estimate: sp.Matrix, covariance: sp.Matrix) -> tuple[sp.Expr, ...]:
        return (*estimate, *(covariance[i, j] for i in range(size) for j in range(i, size)))

    updates = []
    for k, y in enumerate(form.x1):
        gain = P.col(k) / (P[k, k] + R)
        updates.append(state(sp.Matrix(x_hat) + gain * (y - x_hat[k]), P - gain * P.row(k)))
    equations = Equations(
        state(sp.Matrix(x_hat), P),
        state(rate, P_rate),
        form.x1,
        form.parameters,
        tuple(gain.symbol for gain in GAINS),
        tuple(updates),
    )
    spread = sp.diag(*(P1 for _ in form.x1), *(P2 for _ in form.x2))
    start = state(sp.Matrix(x_hat), spread)
    order = [x.index(symbol) for symbol in form.coordinates]
    covariance = P.extract(order, order)
    observer = Observer(
        "extended Kalman", form, equations, hats(form.coordinates), GAINS, start, covariance, about=ABOUT
    )
    return observer.with_gains(**gains)


ekf = extended_kalman
