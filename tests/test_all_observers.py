"""Every observer keeps its laws on motions drawn at random, and Ma's settings with one output tell observers apart."""

from functools import cache, partial
from itertools import pairwise, product

import numpy as np
import pytest
import sympy as sp
from examples import BOTH, NOISY, ONE, OTHER, ZERO
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from percept_obs import (
    Camera,
    DoesNotFit,
    PerspectiveSystem,
    Scenario,
    affine,
    chained,
    pinhole,
    record,
    rigid,
    scenarios,
    track,
    windowed,
)
from percept_obs.compile import vectorised
from percept_obs.observers import (
    OBSERVERS,
    de_luca,
    integral_sliding_mode,
    linear_approximation,
    range_identification,
    sliding_mode,
)

FORMS = {"y1": ONE, "y2": OTHER, "y1+y2": BOTH}

# a short cascade has all that a long one has
EVERY = {make.__name__: make for make in OBSERVERS} | {
    "linear_approximation": partial(linear_approximation, iterates=2)
}
NEED_BOTH = (range_identification, integral_sliding_mode)
ONE_OUTPUT = {name: make for name, make in EVERY.items() if make not in NEED_BOTH}
SMOOTH = EVERY | {
    # a wide layer, so that the steps resolve it, and switching gains that do not switch themselves
    "range_identification": partial(range_identification, boundary_layer=2.0),
    "sliding_mode": partial(sliding_mode, switch="hyperbolic tangent", boundary_layer=0.5, adaptation=0),
}
COPIES = [
    name for name in EVERY if name not in ("range_identification", "integral_sliding_mode", "linear_approximation")
]
"""Those whose equations hold the observed system as it is."""


def each(names, forms=FORMS):
    """Every one of these observers on every form that it can observe."""
    pairs = [(n, f) for n in names for f in forms if n in ONE_OUTPUT or f == "y1+y2"]
    return pytest.mark.parametrize(("name", "form"), pairs)


def drawn(examples):
    """The same examples each time, and none made smaller: a smaller motion explains nothing."""
    return settings(max_examples=examples, deadline=None, derandomize=True, database=None, phases=[Phase.generate])


@st.composite
def motions(draw):
    """A point that stays between 1 and 8 m in front of the camera, and within 60 degrees of its axis, for a second."""

    def numbers(shape, largest):
        return draw(arrays(float, shape, elements=st.floats(-largest, largest)))

    distance = draw(st.floats(2, 4))
    position = distance * np.array([*numbers(2, 0.4), 1.0])
    # sideways at 0.2 m/s at least, for an observer sees nothing from rest or on the way towards the point
    sideways = draw(st.floats(0.2, 0.5)) * np.array([1.0, 1.0, 0.0])
    return Scenario("drawn", affine(numbers((3, 3), 0.2), sideways + numbers(3, 0.1)), position, 1.0, pinhole())


@given(motions())
@drawn(50)
def test_the_drawn_points_stay_in_view(scenario):
    truth = record(scenario).truth
    assert np.abs(truth[:, :2]).max() < np.sqrt(3)
    assert 1 / 8 < truth[:, 2].min() <= truth[:, 2].max() < 1


@each(COPIES)
@given(scenario=motions())
@drawn(5)
def test_a_truthful_start_stays_true(name, form, scenario):
    recording = record(scenario)
    run = track(recording, EVERY[name](FORMS[form]), recording.truth[0], hold="exact", language="python")
    assert np.abs(run.error).max() < 1e-8


@given(scenario=motions())
@drawn(10)
def test_dixons_observer_stays_near_a_truthful_start(scenario):
    """It has no copy of the hidden rate, but learns w x2: its innovation must not leave the boundary layer."""
    recording = record(scenario)
    observer = range_identification(BOTH, boundary_layer=0.05)
    run = track(recording, observer, recording.truth[0], hold="exact", language="python")
    assert np.abs(run.innovation).max() < 0.05


@each(["linear_approximation"])
@given(scenario=motions())
@drawn(5)
def test_iterates_bring_the_cascade_nearer_to_a_truthful_start(name, form, scenario):
    recording = record(scenario)
    worst = [
        np.abs(
            track(
                recording, linear_approximation(FORMS[form], iterates=n), recording.truth[0], "exact", language="python"
            ).error
        ).max()
        for n in (1, 2, 3)
    ]
    assert all(later <= earlier / 2 + 1e-8 for earlier, later in pairwise(worst))


@each(SMOOTH)
@given(scenario=motions())
@drawn(3)
def test_halving_the_step_divides_the_error_by_sixteen(name, form, scenario):
    recording = record(scenario, camera=Camera(period=0.25))
    observer = SMOOTH[name](FORMS[form])
    coarse, fine, reference = (
        track(recording, observer, ZERO, step=0.25 / n, language="python").state[-1] for n in (16, 32, 256)
    )
    errors = np.linalg.norm([coarse - reference, fine - reference], axis=1)
    assert errors[1] < errors[0] / 12 + 1e-12


@cache
def derivatives(name, form):
    """Flow and Jacobian as functions of state, outputs, motion and gains, with the numbers of states and of all."""
    observer = EVERY[name](FORMS[form])
    eq = observer.equations
    symbols = (*eq.state, *eq.measured, *eq.parameters, *eq.gains)
    # a sign's derivative is 0 wherever the draw falls
    jacobian = [entry.replace(sp.DiracDelta, lambda *_: sp.S.Zero) for entry in observer.jacobian()]
    functions = (vectorised(symbols, entries) for entries in (eq.flow, jacobian))
    return *functions, len(eq.state), len(symbols)


@each(EVERY)
@given(seed=st.integers(0, 2**32 - 1))
@drawn(10)
def test_the_jacobian_against_a_finite_difference(name, form, seed):
    flow, jacobian, states, count = derivatives(name, form)
    # positive, as gains and covariances are; A and b are among them
    at = np.random.default_rng(seed).uniform(0.2, 1.0, count)
    steps = 1e-6 * np.eye(states, count)
    columns = [(np.array(flow(*(at + step))) - np.array(flow(*(at - step)))) / 2e-6 for step in steps]
    expected = np.reshape(jacobian(*at), (states, states))
    np.testing.assert_allclose(np.stack(columns, axis=1), expected, rtol=1e-6, atol=1e-6)


@pytest.mark.slow
@each(EVERY, ["y1+y2"])
@given(scenario=motions(), seed=st.integers(0, 2**32 - 1))
@drawn(5)
def test_python_and_numba_agree(name, form, scenario, seed):
    recording = record(scenario, camera=NOISY, seed=seed)
    python, compiled = (
        track(recording, EVERY[name](FORMS[form]), ZERO, language=language) for language in ("python", "numba")
    )
    np.testing.assert_allclose(compiled.state, python.state, rtol=1e-10, atol=1e-10)


def test_only_immersion_and_invariance_needs_a_constant_motion():
    form = PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2")
    motion = rigid(lambda t: [0, 0.1 * t, 0], lambda t: [0.5, 0.1 * t, 0], lambda t: [0, 0, 0])
    recording = record(Scenario("varying", motion, (0.3, 0.2, 4), 1, pinhole()))
    for make in OBSERVERS:
        if make(form).constant_motion:
            assert make.__name__ == "immersion_and_invariance"
            with pytest.raises(DoesNotFit, match="needs a motion with constant coefficients"):
                track(recording, make(form))
        else:
            run = track(recording, make(form), language="python")
            assert np.isfinite(run.estimate[run.unobservable == 0]).all()
            assert run.unobservable[-1] == 0


# ---- Ma's settings with one output


def settling_times(form, recording):
    """Settling times of the inverse distance, of all observers that one output is enough for, from zero."""
    runs = {make.__name__: track(recording, make(form), ZERO, "exact") for make in OBSERVERS if make not in NEED_BOTH}
    return {name: run.settling_time(0.05, recording.view.inverse_distance.name) for name, run in runs.items()}


def test_on_a_line_of_the_image_the_output_that_moves_is_enough_for_all():
    """A point that moves on a plane through the camera (Ma 2005, Fig. 2), with y2 constant."""
    recording = record(scenarios.planar())
    assert np.ptp(recording.truth[:, 1]) < 1e-12
    found = settling_times(ONE, recording)
    assert found["extended_kalman"] < 0.5
    assert found["linear_approximation"] < 1.0
    # the constant gains wait for the same slow direction
    assert all(3.5 < time < 5 for name, time in found.items() if "kalman" not in name and "linear" not in name)


def test_on_a_line_of_the_image_the_output_that_rests_tells_nothing():
    recording = record(scenarios.planar())
    assert windowed(OTHER, recording, 10).smallest.max() < 1e-15
    assert all(np.isinf(time) for time in settling_times(OTHER, recording).values())


SLOPE = PerspectiveSystem(affine(), chained()).measure("y1")


def test_with_the_slope_alone_only_filters_follow_eq35():
    """The chained surface with y1 = X/Y alone (Ma 2005, (32)); no gain between 1 and 1000 saves De Luca's observer."""
    recording = record(scenarios.ma2005_eq35(chained()), 20)
    found = settling_times(SLOPE, recording)
    assert found["extended_kalman"] < 1
    assert all(np.isinf(time) for name, time in found.items() if "kalman" not in name and "linear" not in name)
    assert track(recording, linear_approximation(SLOPE), ZERO, "exact").settling_time(0.05, "y3") < 11
    for measured, hidden in product((1, 10, 100), (1, 30, 1000)):
        run = track(recording, de_luca(SLOPE, measured_gain=measured, hidden_gain=hidden), hold="exact")
        assert np.isinf(run.settling_time(0.05, "y3"))


def test_with_the_slope_alone_all_but_the_cascade_follow_eq36():
    found = settling_times(SLOPE, record(scenarios.ma2005_eq36(chained()), 40))
    assert found.pop("extended_kalman") < 1
    assert np.isinf(found.pop("linear_approximation"))
    assert all(5 < time < 20 for time in found.values())


def exchanged(scenario, order, surface):
    """The same point with its axes in another order, seen on a surface."""
    values = list(scenario.motion.values.values())
    A, b = np.reshape(values[:9], (3, 3)), np.array(values[9:])
    motion = affine(A[np.ix_(order, order)], b[order])
    return Scenario("exchanged", motion, np.array(scenario.position)[order], scenario.duration, surface)


@pytest.mark.parametrize("name", ONE_OUTPUT)
@given(scenario=motions())
@drawn(3)
def test_y2_alone_is_y1_alone_with_the_axes_exchanged(name, scenario):
    make = ONE_OUTPUT[name]
    here = track(record(scenario), make(ONE), ZERO, "exact", language="python")
    other = exchanged(scenario, [1, 0, 2], pinhole())
    there = track(record(other), make(OTHER), ZERO, "exact", language="python")
    np.testing.assert_allclose(there.estimate[:, [1, 0, 2]], here.estimate, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", ONE_OUTPUT)
def test_the_slope_alone_is_the_pinhole_with_the_axes_exchanged(name):
    """Ma 2005, (34), for every observer and one output."""
    make = ONE_OUTPUT[name]
    scenario = scenarios.ma2005_eq35(chained())
    here = track(record(scenario, 2), make(SLOPE), ZERO, language="python")
    there = track(record(exchanged(scenario, [0, 2, 1], pinhole()), 2), make(ONE), ZERO, language="python")
    np.testing.assert_allclose(there.estimate, here.estimate, rtol=1e-9, atol=1e-9)
