"""The linear approximation observer: a cascade of linear time-varying filters."""

import sympy as sp

from percept_obs.observers.base import FastestRate
from percept_obs.observers.family import Derived, Option, family
from percept_obs.observers.gains import Gain, grid
from percept_obs.observers.parts import hats
from percept_obs.system.forms import CanonicalForm
from percept_obs.validation import limit, of_kind

Q, R, P0, kappa = sp.symbols("Q R P0 kappa", real=True)
HIDDEN = "how much more both are in the hidden part"
MOST_ITERATES = 100
"""Filters in a cascade: their equations are derived within a few seconds."""

WEIGHT, DIVIDES = "it is a weight", "the gain divides by it"


def not_quadratic(form: CanonicalForm) -> ValueError | None:
    """Return an error if the hidden rate is not quadratic in the hidden coordinates."""
    jacobian = form.g.jacobian(form.x2).expand()
    if any(sp.expand(entry.diff(a, b)) != 0 for entry in jacobian for a in form.x2 for b in form.x2):
        return ValueError("the hidden rate is not quadratic in the hidden coordinates; use the extended Kalman filter")
    return None


@family(
    name="linear approximation",
    title="Linear approximation observer (LAO)",
    source="Ma 2004",
    needs="any outputs with a hidden rate that is at most quadratic",
    claim="iterates converge on a finite time; none is claimed for one output",
    gains=(
        Gain(Q, "process_weight", 0.1, 1e-3, 10, "1/s", "how much the frozen model is doubted", Q >= 0, WEIGHT),
        Gain(R, "measurement_weight", 0.1, 1e-4, 10, "s", "how much the measurement is doubted", R > 0, DIVIDES),
        Gain(P0, "start_weight", 1, 1e-2, 10, "1", "how much the start is doubted", P0 > 0, WEIGHT),
        Gain(kappa, "hidden_weight", 1, 1e-2, 100, "1/m^2", HIDDEN, kappa > 0, WEIGHT),
    ),
    options=(Option("iterates", 6, "number of filters in the cascade, at least one"),),
    # only the ratios to the measurement's weight matter; the smallest need steps of 2 ms
    candidates=grid(process_weight=(0, 1e-3), measurement_weight=(0.02, 0.01, 0.005, 0.0025), start_weight=(1,)),
    objection_of=not_quadratic,
    stays_at_truth=False,
)
def linear_approximation(form: CanonicalForm, iterates: int) -> Derived:
    """Linear approximation observer (LAO).

    The hidden rate g is quadratic in x2, so that g(x2) = g(0) + (J(0) + J(x2)) x2 / 2 with its Jacobian J.  With J
    taken at the previous iterate the system is linear and time-varying; each iterate is a filter with a Riccati gain::

        xhat_i' = F_i xhat_i + (phi, g(0)) + P_i C^T R^-1 (x1 - C xhat_i)
        P_i' = F_i P_i + P_i F_i^T + Q W - P_i C^T R^-1 C P_i,    P_i(0) = P0 W,    W = diag(1, kappa)
        F_i = [[0, w^T], [0, (J(0) + J(x2hat_(i-1))) / 2]],   J(x2hat_0) = J(0)

    The iterates run side by side, as one cascade; the last one is the estimate.

    See Also
    --------
    extended_kalman

    Notes
    -----
    L. Ma, Vision-based measurements for dynamic systems and control, PhD thesis, Utah State University, 2004, after
    C. Navarro Hernandez, S. P. Banks, M. Aldeen, IMA J. Math. Control Inf. 20, 2003.
    With Q = 0 the estimate never settles.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.observers import lao
    >>> observer = lao(PerspectiveSystem(affine(), pinhole()), iterates=2)
    >>> len(observer.equations.state), observer.estimate
    (18, (yhat1_2, yhat2_2, yhat3_2))
    """
    of_kind("linear_approximation", "iterates", iterates, int)
    if iterates < 1:
        raise ValueError(f"the cascade has {iterates!r} iterates; it needs at least one")
    limit(iterates, "iterates", "take fewer", MOST_ITERATES)
    x, n1 = (*form.x1, *form.x2), len(form.x1)
    size = len(x)
    jacobian = form.g.jacobian(form.x2).expand()
    at_zero = dict.fromkeys(form.x2, sp.S.Zero)
    offset = sp.Matrix([*form.phi, *form.g.subs(at_zero)])
    C = sp.eye(size)[:n1, :]
    weights = [sp.S.One] * n1 + [kappa] * (size - n1)

    state: list[sp.Symbol] = []
    flow: list[sp.Expr] = []
    start: list[sp.Expr] = []
    previous: dict[sp.Symbol, sp.Expr] = at_zero
    for number in range(1, iterates + 1):
        estimate = tuple(sp.Symbol(f"{hat.name}_{number}", real=True) for hat in hats(x))
        names = [[f"P{min(i, j) + 1}{max(i, j) + 1}_{number}" for j in range(size)] for i in range(size)]
        P = sp.Matrix([[sp.Symbol(name, real=True) for name in row] for row in names])
        hidden_block = (jacobian.subs(at_zero) + jacobian.subs(previous, simultaneous=True)) / 2
        F = sp.Matrix(sp.BlockMatrix([[sp.zeros(n1), form.w.T], [sp.zeros(size - n1, n1), hidden_block]]))
        gain = P * C.T / R
        rate = F * sp.Matrix(estimate) + offset + gain * (sp.Matrix(form.x1) - C * sp.Matrix(estimate))
        P_rate = F * P + P * F.T + Q * sp.diag(*weights) - gain * C * P
        upper = [(i, j) for i in range(size) for j in range(i, size)]
        state += [*estimate, *(P[i, j] for i, j in upper)]
        flow += [*rate, *(P_rate[i, j] for i, j in upper)]
        start += [*hats(x), *(P0 * weights[i] if i == j else sp.S.Zero for i, j in upper)]
        previous = dict(zip(form.x2, estimate[n1:], strict=True))
    # where w is small P' = Q - P^2 / R: a step of 1.74 R / P0, a little below the 2 of a linear decay, makes P negative
    rate = sp.Rational(7, 6) * P0 / R + sp.sqrt(Q / R)
    remedy = "take a larger measurement_weight or a smaller start_weight"
    return Derived(tuple(state), tuple(flow), tuple(start), estimate, fastest=FastestRate(rate, remedy))


lao = linear_approximation
