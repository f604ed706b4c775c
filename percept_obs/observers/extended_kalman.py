"""The extended Kalman filter: continuous flow, correction at every sample."""

import sympy as sp

from percept_obs.observers.family import Derived, family
from percept_obs.observers.gains import Gain
from percept_obs.observers.parts import first_seen, hats
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.motion import rigid
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.state_view import StateView
from percept_obs.system.surfaces import ImagingSurface

R, Q, Q2, QW, QV, P1, P2 = sp.symbols("R Q Q2 Q_w Q_v P01 P02", real=True)

EXACT = "with 0 the filter divides by the variance of what it knows exactly"
HIDDEN_DOUBT = "what is added to it in the hidden part, which may change more than the motion says"
TURNING = "density of the noise in the known angular velocity: variance times the time between samples"
VELOCITY = "density of the noise in the known velocity"
GIVEN = "variance of a given start in the measured part"
WHY = "it is a variance"
NEVER = "it is a variance, and a start known exactly is never corrected"


@family(
    name="extended Kalman",
    title="Extended Kalman filter (EKF)",
    source="Jazwinski 1970",
    needs="any outputs",
    claim="local: the covariance must stay bounded, as it does where the linearised system is observable",
    gains=(
        Gain(R, "noise_variance", 1e-4 / 3, 1e-7, 1e-2, "1", "variance of the noise in each output", R > 0, EXACT),
        Gain(Q, "process_noise", 0, 0, 1e-2, "1/s", "variance per second by which the motion is doubted", Q >= 0, WHY),
        Gain(Q2, "hidden_process_noise", 0, 0, 1, "1/(m^2 s)", HIDDEN_DOUBT, Q2 >= 0, WHY),
        Gain(QW, "turning_noise", 0, 0, 1e-2, "1/s", TURNING, QW >= 0, WHY),
        Gain(QV, "velocity_noise", 0, 0, 1e-2, "m^2/s", VELOCITY, QV >= 0, WHY),
        Gain(P1, "measured_variance", 1, 1e-4, 10, "1", GIVEN, P1 > 0, NEVER),
        Gain(P2, "hidden_variance", 1, 1e-4, 10, "1/m^2", "variance of the start in the hidden part", P2 > 0, NEVER),
    ),
    candidates=tuple(
        {"noise_variance": deviation**2, "process_noise": doubt, "measured_variance": 1e-4, "hidden_variance": 1}
        for deviation in (0.004, 0.008, 0.016, 0.032)
        for doubt in (0, 1e-4, 1e-3)
    ),
    any_form=True,
    for_structure=True,
)
def extended_kalman(form: PartitionedSystem) -> Derived:
    """Extended Kalman filter (EKF), for any measured outputs; it needs no canonical form.

    Between samples, with the system's rate f and its Jacobian F at the estimate::

        xhat' = f(xhat)
        P' = F P + P F^T + Q I + Q2 I2 + G diag(Q_w, Q_w, Q_w, Q_v, Q_v, Q_v) G^T

    with I2 = 1 for hidden coordinates, else 0, and G, the Jacobian of the rate with respect to angular velocity and
    velocity: their noise moves each coordinate by what it does to the image there.  In a `StateView` they are its known
    signals; in other views G is 0.

    At a sample of each measured output y_j in turn, with column P_j of P::

        k = P_j / (P_jj + R),  xhat <- xhat + k (y_j - xhat_j),  P <- P - k P_j^T

    A measured output that starts from its first sample has the variance R of that sample, which then corrects nothing;
    `measured_variance` is that of a start that is given.

    See Also
    --------
    percept_obs.observers.linear_approximation : A cascade of linear filters.

    Notes
    -----
    Jazwinski, Stochastic Processes and Filtering Theory (1970), section 8.3.  If R is not given, a run takes the
    recording's variance; where that is not known either, R is that of uniform noise of +-0.01.  Q2 suits constants that
    may wander.  White noise of the variance s^2 in velocities that are known every T seconds has the density s^2 T.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers import ekf
    >>> observer = ekf(PerspectiveSystem(affine(), pinhole()), noise_variance=1e-4)
    >>> observer.covariance
    Matrix([
    [P11, P12, P13],
    [P12, P22, P23],
    [P13, P23, P33]])
    """
    x = (*form.x1, *form.x2)
    x_hat, size = hats(x), len(x)
    rate = form.rate.xreplace(dict(zip(x, x_hat, strict=True)))
    F = rate.jacobian(x_hat)
    P = sp.ImmutableMatrix(size, size, lambda i, j: sp.Symbol(f"P{min(i, j) + 1}{max(i, j) + 1}", real=True))
    G, densities = _of_the_motion(form)
    G = G.xreplace(dict(zip(x, x_hat, strict=True)))
    doubt = sp.diag(*(Q for _ in form.x1), *(Q + Q2 for _ in form.x2)) + G * sp.diag(*densities) * G.T
    P_rate = F * P + P * F.T + doubt

    def state(estimate: sp.Matrix, covariance: sp.Matrix) -> tuple[sp.Expr, ...]:
        return (*estimate, *(covariance[i, j] for i in range(size) for j in range(i, size)))

    updates = []
    for k, y in enumerate(form.x1):
        gain = P.col(k) / (P[k, k] + R)
        updates.append(state(sp.Matrix(x_hat) + gain * (y - x_hat[k]), P - gain * P.row(k)))
    usual = form.view.usual if isinstance(form.view, StateView) else {}
    hidden = [P2 * sp.Float(usual.get(symbol, 1)) ** 2 if symbol in usual else P2 for symbol in form.x2]
    spread = sp.diag(*(P1 + (R - P1) * seen for seen in first_seen(form.x1)), *hidden)
    return Derived(state(x_hat, P), state(rate, P_rate), state(x_hat, spread), update=tuple(updates), covariance=P)


def _of_the_motion(form: PartitionedSystem) -> tuple[sp.ImmutableMatrix, list[sp.Expr]]:
    """Derivative of the rate with respect to known velocities, shape (n, q), and the densities of their noise.

    On an imaging surface they are angular velocity and velocity; there are none if nothing is known of the view.
    """
    x = (*form.x1, *form.x2)
    if isinstance(form.view, StateView):
        motion = form.view.motion
        return form.rate.jacobian(motion.parameters), [QV if length else QW for length in motion.lengths]
    if not isinstance(form.view, ImagingSurface):
        return sp.ImmutableMatrix.zeros(len(x), 0), []
    moved = PerspectiveSystem(rigid(), form.view)
    order = [moved.coordinates.index(symbol) for symbol in x]
    return moved.rate.extract(order, [0]).jacobian(moved.motion.parameters[:6]), [QW] * 3 + [QV] * 3


ekf = extended_kalman
