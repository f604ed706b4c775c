"""Observers of different papers are one another's special cases: what holds in symbols, and what in the limit."""

import numpy as np
import pytest
import sympy as sp
from examples import BOTH, FORMS, ONE
from scipy.linalg import expm, solve_continuous_are

from percept_obs.compile import Table, solve
from percept_obs.observers import (
    de_luca,
    extended_kalman,
    identifier_based,
    immersion_and_invariance,
    linear_approximation,
    range_identification,
    sliding_mode,
    spica,
)
from percept_obs.system.forms import partition

each_form = pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)

G, A, P, H, Lam, alpha, k, lam, delta, R, Q = sp.symbols("G A P H Lambda alpha k lambda delta R Q", real=True)
alpha1, gamma, sigma2 = sp.symbols("alpha1 gamma sigma^2", real=True)

STIFFNESS, DAMPING = 0.7, 0.2
position, velocity = sp.symbols("x v", real=True)
OSCILLATOR = partition(
    (position, velocity), sp.ImmutableMatrix([velocity, -STIFFNESS * position - DAMPING * velocity]), ["x"], ()
)
SYSTEM = np.array([[0, 1], [-STIFFNESS, -DAMPING]])
SLIDER = partition((position, velocity), sp.ImmutableMatrix([velocity, -DAMPING * velocity]), ["x"], ())
"""Nothing depends on the measured output."""


def flow(observer, size=None):
    return sp.Matrix(observer.equations.flow)[:size, :]


def stepped(observer, start, samples, period, finer=1):
    """States at samples that are held, of an observer of the oscillator or the slider."""
    steps = finer * (len(samples) - 1)
    held = np.repeat(samples[:-1], finer)[:, None, None] * np.ones((1, 3, 1))
    arriving = np.full((steps + 1, 1), np.nan)
    arriving[::finer, 0] = samples
    table = Table(np.full(steps, period / finer), held, np.zeros((1, 0)), arriving)
    trace = solve(observer.equations, start, table, [gain.value for gain in observer.gains], "python")
    return trace.states[::finer]


@pytest.mark.slow
@pytest.mark.parametrize(("form", "switch"), [(BOTH, "fraction"), (ONE, "hyperbolic tangent")], ids=["both", "one"])
def test_a_wide_boundary_layer_makes_the_sliding_mode_observer_linear(form, switch):
    """With s = H e in the limit it is De Luca's observer with Lambda = alpha H, and so the identifier-based one."""
    size = len(form.coordinates)
    e = sp.Matrix(form.x1) - sp.Matrix(sp.symbols([f"yhat{s.name[1]}" for s in form.x1], real=True))
    width = sp.Symbol("width", positive=True)
    wide = {sp.Symbol(f"lambda{n + 1}", real=True): H * width for n in range(len(e))} | {delta: width, sigma2: 0}
    smooth = flow(sliding_mode(form, switch=switch), size).subs(wide)
    linear = flow(de_luca(form)).subs(Lam, alpha * H)
    assert (smooth - linear).applyfunc(lambda entry: sp.limit(sp.expand(entry), width, sp.oo)) == sp.zeros(size, 1)
    identified = flow(identifier_based(form)).subs({sigma2: 0, A: H / G, P: -alpha * H / G**2})
    assert (identified - linear).expand() == sp.zeros(size, 1)


@each_form
def test_near_its_surface_the_sliding_mode_observer_is_the_linear_one(form):
    """Its Jacobian at e = 0 is De Luca's with H = lambda/delta, Lambda = alpha lambda/delta: narrow means fast."""
    size = len(form.coordinates)
    smooth = sliding_mode(form, switch="hyperbolic tangent")
    hats = smooth.equations.state[: len(form.x1)]
    at_zero = dict(zip(hats, form.x1, strict=True)) | {sigma2: 0}
    equal = {sp.Symbol(f"lambda{n + 1}", real=True): lam for n in range(len(form.x1))}
    derived = smooth.jacobian()[:size, :size].subs(at_zero, simultaneous=True).subs(equal)
    expected = (
        de_luca(form).jacobian().subs({H: lam / delta, Lam: alpha * lam / delta}).subs(at_zero, simultaneous=True)
    )
    assert (derived - expected).expand() == sp.zeros(size, size)


@each_form
def test_fast_measured_gains_make_de_lucas_observer_immersion_and_invariance(form):
    """For H to infinity, Lambda = lambda H: e1 follows its quasi-steady value, and e2 obeys the other's dynamics."""
    order = [form.coordinates.index(x) for x in (*form.x1, *form.x2)]
    n1 = len(form.x1)
    errors = [de_luca(form).error[place] for place in order]
    slow = de_luca(form).error_dynamics().extract(order, [0])
    steady = dict(zip(errors[:n1], form.w.T * sp.Matrix(errors[n1:]) / H, strict=True))
    fast = (slow[:n1, :] + H * sp.Matrix(errors[:n1]) - form.w.T * sp.Matrix(errors[n1:])).expand()
    assert fast == sp.zeros(n1, 1)
    reduced = slow[n1:, :].subs(Lam, lam * H).subs(steady)
    other = immersion_and_invariance(form).error_dynamics().extract(order, [0])[n1:, :]
    # its error of the measured part is 0
    assert (reduced - other).expand() == sp.zeros(len(form.x2), 1)


def test_the_linear_part_of_dixons_observer_has_the_poles_of_de_lucas():
    """Innovation dynamics without the sign, for a hidden part at rest: H = k + alpha and Lambda |w|^2 = k alpha.

    Equal rates k = alpha are Spica's critical damping.
    """
    s = sp.Symbol("s")
    dixon = flow(range_identification(BOTH)).subs(gamma, 0)
    state = range_identification(BOTH).equations.state
    poles = dixon.jacobian(state).charpoly(s).as_expr()
    one = s**2 + (k + alpha) * s + k * alpha
    assert sp.expand(poles - one**2) == 0
    w = sp.Symbol("w", positive=True)
    resting = partition(sp.symbols("y1 y3", real=True), sp.Matrix([w * sp.Symbol("y3", real=True), 0]), ["y1"], (w,))
    others = {H: k + alpha, Lam: k * alpha / w**2}
    assert sp.expand(de_luca(resting).jacobian().subs(others).charpoly(s).as_expr() - one) == 0
    critical = spica(resting).jacobian().subs(Lam, alpha**2 / w**2).applyfunc(lambda e: e.replace(sp.Abs, lambda a: a))
    positive = sp.Symbol("alpha", positive=True)
    found = critical.subs(alpha, positive).charpoly(s).as_expr()
    assert sp.expand(found - one.subs(k, alpha).subs(alpha, positive)) == 0


def test_without_the_sign_dixons_observer_keeps_an_innovation():
    """The rate f finds the constant w x2 only at the price e = (1/alpha + 1/k) w x2, which the sign takes away."""
    f, e, constant = sp.symbols("f1 e constant", real=True)
    observer = range_identification(BOTH)
    y1, hat = BOTH.x1[0], observer.equations.state[0]
    rate = observer.equations.flow[2].subs({gamma: 0, y1: hat + e, f: constant})
    assert sp.simplify(sp.solve(rate, e)[0] - (1 / alpha + 1 / k) * constant) == 0


def test_for_a_camera_that_nothing_hidden_moves_de_lucas_observer_is_luenbergers():
    """Third rows of A and b at 0: w is constant, the system linear, and so is the error, with eigenvalues to place."""
    third = dict.fromkeys(sp.symbols("a31 a32 a33 b3", real=True), 0)
    error = de_luca(ONE).error
    dynamics = de_luca(ONE).error_dynamics().subs(third)
    matrix = dynamics.jacobian(error)
    assert (dynamics - matrix * sp.Matrix(error)).expand() == sp.zeros(3, 1)
    assert not matrix.free_symbols & set(ONE.coordinates)


def test_one_iterate_of_the_cascade_is_the_kalman_bucy_filter():
    """Its covariance settles at the solution of the algebraic Riccati equation.

    The model is that of the slider: what depends on the output only, here the spring, is known and has no variance.
    """
    observer = linear_approximation(OSCILLATOR, iterates=1, process_weight=0.3, measurement_weight=0.5)
    start = observer.initial_state({"x": 0.0}, {})
    final = stepped(observer, start, np.zeros(4001), 0.01)[-1]
    output = np.array([[1.0, 0.0]])
    expected = solve_continuous_are(SYSTEM.T * [[1, 0], [1, 1]], output.T, 0.3 * np.eye(2), [[0.5]])
    np.testing.assert_allclose(final[2:], expected[np.triu_indices(2)], rtol=1e-6)


def test_without_measurements_one_iterate_predicts_like_the_extended_kalman_filter():
    cascade, kalman = linear_approximation(SLIDER, iterates=1), extended_kalman(SLIDER)
    names = dict(zip(cascade.equations.state, kalman.equations.state, strict=True))
    unmeasured = flow(cascade).subs(names, simultaneous=True).applyfunc(lambda entry: sp.limit(entry, R, sp.oo))
    unmeasured = unmeasured.subs(sp.Symbol("kappa", real=True), 1)
    alike = flow(kalman).subs(sp.Symbol("Q2", real=True), 0)
    assert (unmeasured - alike).expand() == sp.zeros(len(names), 1)


def test_frequent_samples_make_the_kalman_filter_continuous():
    """Samples of variance R / h every h are white noise of intensity R: both filters agree to first order."""
    misses = []
    for period in (0.02, 0.01):
        times = period * np.arange(round(10 / period) + 1)
        samples = np.sin(times)
        discrete = extended_kalman(SLIDER, noise_variance=0.5 / period, process_noise=0.1)
        continuous = linear_approximation(SLIDER, iterates=1, measurement_weight=0.5, process_weight=0.1)
        runs = [stepped(observer, [0.0, 0.0, 1.0, 0.0, 1.0], samples, period) for observer in (discrete, continuous)]
        misses.append(np.abs(runs[0] - runs[1]).max())
    assert misses[0] < 0.05
    assert misses[0] / misses[1] == pytest.approx(2, rel=0.1)


def test_without_process_noise_the_kalman_filter_is_least_squares_over_all_samples():
    period, count = 0.1, 60
    samples = np.random.default_rng(3).normal(0, 1, count)
    doubtful = extended_kalman(OSCILLATOR, noise_variance=0.01, measured_variance=1e6, hidden_variance=1e6)
    found = stepped(doubtful, [0.0, 0.0, 1e6, 0.0, 1e6], samples, period, finer=50)[-1]
    back = [expm(SYSTEM * period * (number - count + 1))[0] for number in range(count)]
    expected, *_ = np.linalg.lstsq(np.array(back), samples)
    np.testing.assert_allclose(found[:2], expected, rtol=1e-5)
    np.testing.assert_allclose(
        found[2:], (0.01 * np.linalg.inv(np.transpose(back) @ back))[np.triu_indices(2)], rtol=1e-4
    )
