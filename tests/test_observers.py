"""Laws that every observer keeps, on every form: a truthful start stays true, and derivatives are right."""

import numpy as np
import pytest
import sympy as sp
from examples import AFFINE, BOTH, MOTIONS, ONE, OTHER, SURFACES, ZERO
from scipy.integrate import solve_ivp

from percept_obs import Camera, PerspectiveSystem, ekf, ibo, record, rigid, scenarios, smo, track, with_point
from percept_obs.compile import vectorised
from percept_obs.observers import OBSERVERS, noise_bias
from percept_obs.observers.base import Gain, hats, sigma2

FORMS = {"y1": ONE, "y2": OTHER, "y1+y2": BOTH}
NAMES = [make.__name__ for make in OBSERVERS]
SMOOTH = {"identifier-based": ibo, "extended Kalman": ekf}


def outputs_of(name):
    return ("y1", "y2", "y3") if "three" in name else ("y1", "y2")


def draw(symbols, seed):
    """Numbers for symbols, positive as covariances and gains need."""
    generator = np.random.default_rng(seed)
    return {s: sp.Float(generator.uniform(0.2, 1.0), 17) for s in symbols}


@pytest.mark.parametrize("make", OBSERVERS, ids=NAMES)
@pytest.mark.parametrize("surface", SURFACES)
def test_a_truthful_start_stays_true(make, surface):
    system = PerspectiveSystem(MOTIONS["affine"], SURFACES[surface])
    recording = record(scenarios.ma2005_eq35(SURFACES[surface]), 5)
    start = dict(zip(map(str, system.coordinates), recording.truth[0], strict=True))
    run = track(recording, make(system.measure(*outputs_of(surface))), start, hold="exact", language="python")
    assert np.abs(run.error).max() < 1e-7
    assert len(run.resets) == 0


@pytest.mark.parametrize("make", OBSERVERS, ids=NAMES)
@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_a_truthful_start_stays_true_with_less_measured(make, form):
    recording = record(scenarios.ma2005_eq36(), 10)
    run = track(recording, make(form), recording.truth[0], hold="exact", language="python")
    assert np.abs(run.error).max() < 1e-7


@pytest.mark.parametrize("make", SMOOTH.values(), ids=SMOOTH)
@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_halving_the_step_divides_the_error_by_sixteen(make, form):
    recording = record(scenarios.ma2005_eq35(), 2, Camera(period=0.2))
    coarse, fine, reference = (
        track(recording, make(form), ZERO, step=0.2 / n, language="python").estimate[-1] for n in (8, 16, 256)
    )
    ratio = np.linalg.norm(coarse - reference) / np.linalg.norm(fine - reference)
    assert 12 < ratio < 20


@pytest.mark.parametrize("make", OBSERVERS, ids=NAMES)
@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_the_jacobian_against_a_finite_difference(make, form):
    eq = make(form).equations
    values = draw([*eq.state, *eq.measured, *eq.parameters, *eq.gains], 5)
    others = {s: v for s, v in values.items() if s not in eq.state}
    flow = vectorised(eq.state, [e.subs(others) for e in eq.flow])
    at = np.array([float(values[s]) for s in eq.state])
    step = 1e-6
    columns = [
        (np.array(flow(*(at + step * d))) - np.array(flow(*(at - step * d)))) / (2 * step) for d in np.eye(len(at))
    ]
    jacobian = np.array(make(form).jacobian().subs(values), dtype=float)
    np.testing.assert_allclose(np.stack(columns, axis=1), jacobian, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("make", OBSERVERS, ids=NAMES)
@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
def test_error_dynamics_are_the_difference_of_the_rates(make, form):
    observer = make(form)
    eq = observer.equations
    x = form.coordinates
    errors = draw(observer.error, 7)
    values = draw([*x, *eq.state, *eq.parameters, *eq.gains], 8)
    values |= {h: values[s] - e for h, s, e in zip(hats(x), x, errors.values(), strict=True)}
    rates = dict(zip((*form.x1, *form.x2), form.rate, strict=True))
    flows = dict(zip(eq.state, eq.flow, strict=True))
    expected = [(rates[s] - flows[h]).subs(values) for s, h in zip(x, hats(x), strict=True)]
    derived = observer.error_dynamics().subs({**values, **errors})
    np.testing.assert_allclose(np.array(derived, dtype=float).ravel(), np.array(expected, dtype=float), rtol=1e-12)


def test_the_error_dynamics_of_the_identifier_based_observer():
    G, A, P = sp.symbols("G A P", real=True)
    e1, e2, e3 = e = sp.symbols("e1:4", real=True)
    derived = ibo(BOTH).error_dynamics().subs(sigma2, 0)
    y3 = BOTH.coordinates[2]
    g = BOTH.g[0]
    expected = sp.Matrix(
        [
            *(-G * A * sp.Matrix([e1, e2]) + BOTH.w.T * e3),
            *(G**2 * P * BOTH.w * sp.Matrix([e1, e2]) + sp.Matrix([g - g.subs(y3, y3 - e3)])),
        ]
    )
    assert (derived - expected).expand() == sp.zeros(3, 1)
    assert ibo(BOTH).error == e


@pytest.mark.parametrize("make", SMOOTH.values(), ids=SMOOTH)
def test_lambdify_gives_the_flow_to_scipy(make):
    form = ONE
    observer = make(form)
    scenario = scenarios.ma2005_eq35()
    recording = record(scenario, 2)
    rhs = observer.lambdify(scenario.motion, lambda t: [0.4])
    state = observer.initial_state({"y1": 0.4}, {})
    values = dict(zip(observer.equations.state, state, strict=True))
    values |= scenario.motion.values | observer.gain_values | {form.x1[0]: 0.4}
    np.testing.assert_allclose(rhs(0.0, state), [float(e.subs(values)) for e in observer.equations.flow])
    assert recording.truth[0, 0] == 0.4


def test_lambdify_follows_a_motion_that_varies():
    system = PerspectiveSystem(MOTIONS["rigid"], SURFACES["pinhole"])
    moving = rigid(lambda t: [0, 0, t], [1.0, 0, 0], [0, 0, 0])
    rhs = with_point(ibo(system.measure("y1", "y2"))).lambdify(moving)
    state = [0.1, 0.2, 0.5, 0.1, 0.2, 0.5]
    # y1' = -w3 y2 - v_c1 y3, and the observer, at the truth, moves alike
    np.testing.assert_allclose(rhs(2.0, state)[0], -2.0 * 0.2 - 0.5)
    np.testing.assert_allclose(rhs(2.0, state)[:3], rhs(2.0, state)[3:])


def test_observer_and_point_integrated_together_by_scipy():
    scenario = scenarios.ma2005_eq35()
    together = with_point(ibo(BOTH))
    start = [*record(scenario, 1).truth[0], *ZERO]
    end = solve_ivp(together.lambdify(scenario.motion), (0, 10), start, rtol=1e-9, atol=1e-9).y[:, -1]
    run = track(record(scenario, 10), ibo(BOTH), ZERO, hold="exact")
    np.testing.assert_allclose(end[3:], run.state[-1], atol=1e-6)


def test_lambdify_needs_what_the_equations_use():
    with pytest.raises(ValueError, match="uses y1; pass measured="):
        ibo(ONE).lambdify(scenarios.ma2005_eq35().motion)


def test_noise_bias_of_one_output():
    y1 = ONE.x1[0]
    e = sp.Matrix([y1 - sp.Symbol("yhat1", real=True)])
    assert noise_bias(ONE, e) == sigma2 * ONE.w.diff(y1)


def test_noise_bias_of_both_outputs_against_a_draw():
    """E[w(y + n)(e + n)] = w e + bias for the pinhole, whose factors are affine."""
    x1_hat = hats(BOTH.x1)
    e = sp.Matrix(BOTH.x1) - sp.Matrix(x1_hat)
    values = draw([*BOTH.parameters, *x1_hat, *BOTH.x1], 2)
    product = vectorised(BOTH.x1, [(BOTH.w * e)[0].subs({s: v for s, v in values.items() if s not in BOTH.x1})])
    at = np.array([float(values[s]) for s in BOTH.x1])
    noise = np.random.default_rng(4).normal(0, 0.1, (2, 400_000))
    mean = np.mean(product(*(at[:, None] + noise))[0]) - product(*at)[0]
    predicted = float(noise_bias(BOTH, e)[0].subs({**values, sigma2: 0.01}))
    assert mean == pytest.approx(predicted, rel=0.05)


def test_noise_bias_of_the_sliding_mode_observer():
    alpha, lam, delta = sp.symbols("alpha lambda1 delta", real=True)
    y1, hat = ONE.x1[0], sp.Symbol("yhat1", real=True)
    flow = smo(ONE).equations.flow
    bias = [entry.diff(sigma2) for entry in flow[1:3]]
    e = y1 - hat
    expected = [-alpha * w.diff(y1) * lam * delta / (sp.Abs(e) + delta) ** 2 for w in ONE.w]
    at = draw([y1, hat, alpha, lam, delta, *ONE.parameters], 6)
    np.testing.assert_allclose([float(b.subs(at)) for b in bias], [float(b.subs(at)) for b in expected])


@pytest.mark.parametrize(
    ("make", "gains", "message"),
    [
        (ibo, {"reset_ratio": 1.0}, "reset_ratio = 1 is out of range: gamma > 1 is needed; at 1 the reset maps"),
        (ibo, {"reset_ratio": 0.5}, "gamma > 1"),
        (ibo, {"gain": 0}, "G > 0"),
        (ibo, {"gain": float("nan")}, "not finite"),
        (ibo, {"gain": float("inf")}, "not finite"),
        (ibo, {"gain": "much"}, "not a number"),
        (ibo, {"G": 3}, "no gain G; it has gain, injection, lyapunov"),
        (ibo, {"noise_variance": -1}, "it is a variance"),
        (smo, {"boundary_layer": 0}, "divides by the error"),
        (ekf, {"noise_variance": 0}, "R > 0"),
    ],
)
def test_gains_out_of_range_are_refused(make, gains, message):
    with pytest.raises(ValueError, match=message):
        make(ONE, **gains)


def test_other_gains_make_another_observer():
    observer = ibo(ONE)
    other = observer.with_gains(gain=3)
    assert {g.name: g.value for g in other.gains}["gain"] == 3
    assert {g.name: g.value for g in observer.gains}["gain"] == 10
    assert other.equations is observer.equations
    assert Gain(sp.Symbol("k"), "k", 1, 0, 2, "nothing").value == 1.0


@pytest.mark.parametrize("make", OBSERVERS, ids=NAMES)
def test_every_gain_lies_in_its_range_and_says_what_it_does(make):
    for gain in make(ONE).gains:
        assert gain.low <= gain.value <= gain.high
        assert gain.meaning
        assert gain.name in make.__doc__


@pytest.mark.parametrize("start", [{"z": 1.0}, {"y3": float("nan")}])
def test_a_start_that_is_none_is_refused(start):
    with pytest.raises(ValueError, match="no finite value"):
        ibo(ONE).initial_state({"y1": 0.1}, start)


def test_the_start_is_the_first_sample():
    assert smo(ONE, switching_gain=2).initial_state({"y1": 0.3}, {}).tolist() == [0.3, 0, 0, 2]
    assert ekf(ONE).initial_state({"y1": 0.3}, {"y3": 0.5})[:3].tolist() == [0.3, 0, 0.5]


def test_observers_show_their_equations():
    assert r"\dot{\hat{y}_{1}}" in ibo(ONE)._repr_latex_()
    assert "sample" in ekf(BOTH)._repr_latex_()
    assert AFFINE.coordinates == BOTH.coordinates
