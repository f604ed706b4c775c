"""What every observer tells of itself is so: its needs, gains, start, error dynamics; and what each is known for."""

import inspect
import re
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from examples import AFFINE, BOTH, FORMS, MOTIONS, ON_SPHERE, ONE, SQUARE, SURFACES, ZERO
from refusals import refuses
from scipy.integrate import solve_ivp

from percept_obs import (
    ImagingSurface,
    NotAffine,
    PerspectiveSystem,
    affine,
    ekf,
    ibo,
    record,
    rigid,
    scenarios,
    smo,
    track,
    with_point,
)
from percept_obs.compile import vectorised
from percept_obs.compile.equations import Equations
from percept_obs.observers import (
    OBSERVERS,
    Gain,
    NeedsMoreOutputs,
    NotIntegrable,
    Observer,
    de_luca,
    equivariant_filter,
    gpebo,
    immersion_and_invariance,
    integral_sliding_mode,
    linear_approximation,
    noise_bias,
    range_identification,
    spica,
)
from percept_obs.observers.parts import first_seen, hats, innovation, output_injection, sigma2
from percept_obs.system.forms import partition
from percept_obs.system.motion import TIME
from percept_obs.system.surfaces.base import X, Y, Z

PAIRS = [
    pytest.param(make, form, id=f"{make.key}-{name}")
    for make in OBSERVERS
    for name, form in FORMS.items()
    if not make.refusal(form)
]
WITHOUT_DYNAMICS = (integral_sliding_mode, gpebo, equivariant_filter)
"""Their estimates are not linear in the state."""
each_observer = pytest.mark.parametrize("make", OBSERVERS, ids=lambda make: make.key)


def draw(symbols, seed):
    """Numbers for symbols, positive as covariances and gains need."""
    generator = np.random.default_rng(seed)
    return {s: sp.Float(generator.uniform(0.2, 1.0), 17) for s in symbols}


@each_observer
def test_what_an_observer_needs_can_be_asked_and_is_told_when_it_is_made_anyway(make):
    forms = (*FORMS.values(), AFFINE.partition("y1"), ON_SPHERE.partition("y1"), ON_SPHERE.measure("y1", "y2"))
    for form in forms:
        refusal = make.refusal(form)
        if refusal:
            with pytest.raises(ValueError, match=re.escape(refusal)):
                make(form)
        else:
            assert make(form).form.coordinates == form.coordinates
    assert not make.refusal(BOTH)
    if not make.any_form:
        assert make(AFFINE.partition("y1", "y2")).equations == make(BOTH).equations
        with pytest.raises(NotAffine, match="or use the extended Kalman filter"):
            make(ON_SPHERE.partition("y1"))


@pytest.mark.slow
@pytest.mark.parametrize(("make", "form"), [*(p for p in PAIRS if p.values[0] not in WITHOUT_DYNAMICS), (ekf, SQUARE)])
def test_error_dynamics_against_a_finite_difference(make, form):
    """Point and observer move a little along their rates; the error changes as its dynamics say."""
    observer = make(form)
    eq, x = observer.equations, form.coordinates
    values = draw([*x, *eq.state, *eq.parameters, *eq.gains], 8)
    rates = dict(zip((*form.x1, *form.x2, *eq.state), (*form.rate, *eq.flow), strict=True))
    at, step = np.array([*map(float, values.values())]), 1e-6
    velocity = np.array(vectorised([*values], [rates.get(s, sp.S.Zero) for s in values])(*at))
    errors = vectorised([*values], [s - e for s, e in zip(x, observer.estimate, strict=True)])
    expected = (np.array(errors(*(at + step * velocity))) - np.array(errors(*(at - step * velocity)))) / (2 * step)
    known = values | dict(zip(observer.error, errors(*at), strict=True))
    derived = vectorised([*known], [*observer.error_dynamics()])(*map(float, known.values()))
    np.testing.assert_allclose(derived, expected, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("make", WITHOUT_DYNAMICS, ids=lambda make: make.key)
def test_an_error_without_dynamics_of_its_own(make):
    with pytest.raises(ValueError, match="cannot be solved for its state"):
        make(BOTH).error_dynamics()


def test_lambdify_follows_a_motion_that_varies():
    system = PerspectiveSystem(MOTIONS["rigid"], SURFACES["pinhole"])
    moving = rigid(camera_angular_velocity=lambda t: [0, 0, -t], camera_velocity=[1.0, 0, 0])
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


test_gains_out_of_range_are_refused = refuses(
    lambda make, gains: make(ONE, **gains),
    (ibo, {"reset_ratio": 1.0}, "reset_ratio = 1 is out of range: gamma > 1 is needed; at 1 the reset maps"),
    (ibo, {"reset_ratio": 0.5}, "gamma > 1"),
    (ibo, {"gain": 0}, "G > 0"),
    (ibo, {"gain": float("inf")}, "not finite"),
    (ibo, {"gain": "much"}, "expected a real number"),
    (ibo, {"G": 3}, "no gain G; it has gain, injection, lyapunov"),
    (ibo, {"noise_variance": -1}, "it is a variance"),
    (smo, {"boundary_layer": 0}, "divides by the error"),
    (ekf, {"noise_variance": 0}, "R > 0"),
)


MARKUP = "k<img src=x onerror=alert(1)>"


def of_parts(**changes):
    """An observer of one output whose parts are changed."""
    x = (*ONE.x1, *ONE.x2)
    flow = output_injection(ONE, innovation(ONE), 1, 1)
    parts = {"state": hats(x), "flow": flow, "start": hats(x), "estimate": hats(ONE.coordinates), "gains": (), "k": ()}
    parts |= changes
    equations = Equations(parts["state"], parts["flow"], ONE.x1, ONE.parameters, parts["k"])
    return Observer("mine", ONE, equations, parts["estimate"], parts["gains"], parts["start"])


test_names_that_would_be_code_or_markup_are_refused_where_they_are_made = refuses(
    lambda make, name: make(name),
    *(
        (lambda name: Gain(sp.Symbol("k"), name, 1, 0, 2, "1", "nothing"), name, "a gain has the name")
        for name in ("k = 0; alert(1); var x", 'k"><img src=x onerror=alert(1)>', "", "lambda", "__proto__", "a b", 5)
    ),
    *(
        (make, MARKUP, "a symbol .*; give it a name of letters")
        for make in (
            lambda name: Gain(sp.Symbol(name), "k", 1, 0, 2, "1", "nothing"),
            lambda name: of_parts(state=(*hats(ONE.x1), sp.Symbol(name), sp.Symbol("c"))),
            lambda name: affine(sp.Symbol(name) * sp.eye(3), [0, 0, 0]),
            lambda name: affine(sp.Function(name)(TIME) * sp.eye(3), [0, 0, 0]),
            lambda name: ImagingSurface("s", (X / Z, Y / Z), Z * sp.Symbol(name), (1, 1, 1)),
        )
    ),
)
test_what_makes_no_gain_and_no_observer_is_refused = refuses(
    lambda call: call(),
    (lambda: Gain("k", "k", 1, 0, 1, "1", "text for a symbol"), "symbol is the text 'k'; expected a Symbol"),
    (lambda: replace(de_luca, derive=lambda form: 1)(ONE), "what it derives is the number 1; expected a Derived"),
)
test_parts_that_do_not_fit_together_are_refused = refuses(
    lambda changes: of_parts(**changes),
    ({"start": sp.symbols("wf1 wf2 wf3", real=True)}, "start of the mine observer uses wf1, wf2, wf3, which nothing"),
    ({"start": hats(ONE.x1)}, r"the start .* has 1 entries; pass start=: 3 entries in measured outputs"),
    ({"estimate": hats(ONE.x1)}, "the estimate of the mine observer has 1 entries"),
    ({"estimate": sp.symbols("a b c")}, "the estimate of the mine observer uses a, b, c"),
    ({"k": (sp.Symbol("k"),)}, "no Gain for k"),
)


def test_other_gains_make_another_observer():
    observer = ibo(ONE)
    other = observer.with_gains(gain=3)
    assert {g.name: g.value for g in other.gains}["gain"] == 3
    assert {g.name: g.value for g in observer.gains}["gain"] == 10
    assert other.equations is observer.equations
    assert Gain(sp.Symbol("k"), "k", 1, 0, 2, "1", "nothing").value == 1.0


@each_observer
def test_every_gain_lies_in_its_range_and_says_what_it_does(make):
    about = make(BOTH).about
    assert about is make.about
    assert all((about.title, about.source, about.needs, about.claim))
    for gain in make.gains:
        assert gain.low <= gain.value <= gain.high
        assert gain.meaning
        assert gain.unit
        assert f"{gain.meaning[1:]} ({gain.symbol}" in make.__doc__
        assert inspect.signature(make).parameters[gain.name].default == gain.value
    for option in make.options:
        assert f"\n{option.name} : " in make.__doc__
        assert inspect.signature(make).parameters[option.name].default == option.value
    assert {gain.name for switch in make.switches for gain in make(BOTH, switch=switch).gains} <= {
        gain.name for gain in make.gains
    }


def test_options_may_be_named_or_not_and_no_gain_may_go_without_its_name():
    assert smo(ONE, "sign", bound=3) == smo(ONE, switch="sign", bound=3)
    assert repr(smo).startswith("sliding_mode(form, switch='fraction', *, hidden_gain=5.0, adaptation=10.0, ")
    with pytest.raises(TypeError, match="takes 1 options, not 2; name the gains"):
        smo(ONE, "sign", 5)


@pytest.mark.parametrize("start", [{"z": 1.0}])
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


def test_terms_that_a_gain_of_zero_puts_out_are_not_shown():
    assert sp.latex(sigma2) not in ibo(BOTH)._repr_latex_()
    assert sp.latex(sigma2) in ibo(BOTH, noise_variance=1e-4)._repr_latex_()
    assert ibo(BOTH)._repr_latex_().count(r"\text{when }") == 1
    q = sp.Symbol("Q", real=True)
    assert q in sp.Tuple(*ekf(ONE).equations.flow).free_symbols
    assert " Q " not in ekf(ONE)._repr_latex_()


@each_observer
def test_the_start_is_what_its_expressions_say(make):
    observer = make(BOTH)
    values = draw([*BOTH.x1, *hats(BOTH.coordinates), *BOTH.parameters], 3)
    at = {s.name: float(v) for s, v in values.items()}
    state = observer.initial_state(
        {y.name: at[y.name] for y in BOTH.x1},
        {x.name: at[hat.name] for x, hat in zip(BOTH.coordinates, hats(BOTH.coordinates), strict=True)},
        {s: at[s.name] for s in BOTH.parameters},
    )
    given = dict.fromkeys(first_seen(BOTH.x1), 0)
    expected = [float(e.subs(values | given).subs(observer.gain_values)) for e in observer.start]
    np.testing.assert_allclose(state, expected, rtol=1e-14)


def test_a_start_that_needs_parameters_says_so():
    with pytest.raises(ValueError, match="needs b1, b2, b3; pass parameters="):
        range_identification(BOTH).initial_state({"y1": 0.1, "y2": 0.2}, {})


def test_spica_is_de_lucas_with_critical_damping():
    H, Lam = sp.symbols("H Lambda", real=True)
    damping = 2 * sp.sqrt(Lam) * sp.sqrt(sum(entry**2 for entry in BOTH.w))
    difference = sp.Matrix(spica(BOTH).equations.flow) - sp.Matrix(de_luca(BOTH).equations.flow).subs(H, damping)
    assert difference.expand() == sp.zeros(3, 1)


def test_de_lucas_depth_error_decays_where_w_is_not_zero():
    """With constant w and without g, the slowest pole is 0 at w = 0 and the faster, the longer w is."""
    w, (_, _, y3) = sp.symbols("w1:3", real=True), BOTH.coordinates
    observer = de_luca(partition(BOTH.coordinates, sp.Matrix([*(k * y3 for k in w), 0]), ["y1", "y2"], w))
    J = sp.lambdify([w], observer.jacobian().subs(observer.gain_values))
    slowest = [np.linalg.eigvals(J([0.3 * k, 0.4 * k])).real.max() for k in range(3)]
    assert slowest[2] < slowest[1] < slowest[0] == 0


def test_a_camera_that_turns_only_shows_the_focal_length_and_no_depth():
    """De Luca et al. 2008: w is 0, and the rate of a pixel f y1 holds f."""
    f, form = sp.Symbol("f"), PerspectiveSystem(rigid(), SURFACES["pinhole"]).measure("y1", "y2")
    still = dict.fromkeys(form.parameters[3:], 0)
    assert form.w.subs(still).is_zero_matrix
    pixels = (f * form.rate[:2, :].subs(still)).subs({y: y / f for y in form.x1}, simultaneous=True).expand()
    assert all(rate.has(f) and not rate.has(form.x2[0]) for rate in pixels)


def test_what_an_observer_cannot_do_is_refused():
    with pytest.raises(NeedsMoreOutputs, match="y2, y3 are hidden; measure every image coordinate"):
        range_identification(ONE)
    with pytest.raises(ValueError, match="is none of 'sign', 'hyperbolic tangent', 'fraction'"):
        range_identification(BOTH, switch="relay")
    with pytest.raises(ValueError, match="at least one"):
        linear_approximation(BOTH, iterates=0)
    curled = replace(BOTH, w=sp.ImmutableMatrix([[BOTH.x1[1], -BOTH.x1[0]]]))
    with pytest.raises(NotIntegrable, match="no potential"):
        immersion_and_invariance(curled)
    cubic = replace(BOTH, g=sp.ImmutableMatrix([BOTH.x2[0] ** 3]))
    with pytest.raises(ValueError, match="not quadratic"):
        linear_approximation(cubic)


SETTLES = {
    ibo: 2.0,
    smo: 2.5,
    immersion_and_invariance: 2.5,
    de_luca: 4.5,
    spica: 3.0,
    range_identification: 2.0,
    linear_approximation: 3.0,
}


@pytest.mark.parametrize(("make", "bound"), SETTLES.items(), ids=lambda v: getattr(v, "__name__", str(v)))
def test_settling_on_eq35_with_both_outputs(make, bound):
    run = track(record(scenarios.ma2005_eq35(), 40), make(BOTH), ZERO, hold="exact")
    assert run.settling_time(0.05, "y3") <= bound
