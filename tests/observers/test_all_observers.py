"""Every observer keeps its laws, on every surface and on random motions; one output tells observers apart."""

from dataclasses import replace
from functools import cache, partial
from itertools import pairwise, product

import numpy as np
import pytest
import sympy as sp
from examples import BOTH, FORMS, MOTIONS, ONE, OTHER, SQUARE, SURFACES, ZERO
from hypothesis import Phase, example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from sample_sizes import across

from percept_obs import (
    Camera,
    DoesNotFit,
    NotAffine,
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
    NeedsMoreOutputs,
    NeedsMotion,
    NotIntegrable,
    de_luca,
    linear_approximation,
    range_identification,
    sliding_mode,
)

# a short cascade has all that a long one has
EVERY = {make.key: make for make in OBSERVERS} | {"linear_approximation": partial(linear_approximation, iterates=2)}
ONE_OUTPUT = {make.key: EVERY[make.key] for make in OBSERVERS if not make.refusal(ONE)}
SMOOTH = EVERY | {
    # a wide layer, so that the steps resolve it, and switching gains that do not switch themselves
    "range_identification": partial(range_identification, boundary_layer=2.0),
    "sliding_mode": partial(sliding_mode, switch="hyperbolic tangent", boundary_layer=0.5, adaptation=0),
}
COPIES = [make for make in OBSERVERS if make.stays_at_truth]
OUTPUTS = {name: [s.name for s in surface.image_coordinates] for name, surface in SURFACES.items()}
SEEN = [(name, "+".join(seen)) for name, every in OUTPUTS.items() for seen in (every[:1], every[1:2], every)]
EQ35 = replace(scenarios.ma2005_eq35(), duration=2.0)
FORMS_AND_SQUARE = FORMS | {"x": SQUARE}


@cache
def recorded(scenario, surface, duration):
    """One recording for all observers of what a surface shows."""
    return record(scenario(surface), duration)


@cache
def partitioned(surface, outputs):
    """Return the canonical form of an affine motion on a surface, where these outputs are measured."""
    return PerspectiveSystem(MOTIONS["affine"], SURFACES[surface]).partition(*outputs.split("+"))


@cache
def made(name, form, every=EVERY.get):
    """One observer of a form for all examples."""
    return every(name)(FORMS[form])


def each(names, forms=FORMS):
    """Every one of these observers on every form that it can observe."""
    known = {make.key: make for make in OBSERVERS}
    pairs = [(name, form) for name in names for form in forms if not known[name].refusal(FORMS_AND_SQUARE[form])]
    return pytest.mark.parametrize(("name", "form"), pairs)


def drawn(examples):
    """The same examples each time, and none made smaller: a smaller motion explains nothing."""
    return settings(
        max_examples=examples, deadline=None, derandomize=True, database=None, phases=[Phase.explicit, Phase.generate]
    )


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


@pytest.mark.slow
@given(motions())
@drawn(50)
def test_the_drawn_points_stay_in_view(scenario):
    truth = record(scenario).truth
    assert np.abs(truth[:, :2]).max() < np.sqrt(3)
    assert 1 / 8 < truth[:, 2].min() <= truth[:, 2].max() < 1


def assert_it_stays_at_the_truth(recording, observer):
    run = track(recording, observer, recording.truth[0], hold="exact", language="python")
    assert np.abs(run.error).max() < (1e-8 if np.ptp(run.time) < 2 else 1e-7)
    assert len(run.resets) == 0


@each([make.key for make in COPIES])
@given(scenario=motions())
@drawn(2)
def test_started_at_the_truth_it_stays_there(name, form, scenario):
    assert_it_stays_at_the_truth(record(scenario), made(name, form))


@pytest.mark.slow
@pytest.mark.parametrize(("make", "seen"), across(COPIES, SEEN), ids=lambda case: getattr(case, "key", None))
def test_started_at_the_truth_it_stays_there_on_every_surface(make, seen):
    form = partitioned(*seen)
    if make.refusal(form):
        with pytest.raises((NotAffine, NotIntegrable, NeedsMotion, NeedsMoreOutputs)):
            make(form)
    else:
        observer = make(form)
        for scenario, duration in ((scenarios.ma2005_eq35, 2), (scenarios.ma2005_eq36, 4)):
            assert_it_stays_at_the_truth(recorded(scenario, form.view, duration), observer)


@given(scenario=motions())
@drawn(3)
def test_dixons_observer_started_at_the_truth_stays_near(scenario):
    """It has no copy of the hidden rate, but learns w x2: its innovation must not leave the boundary layer."""
    recording = record(scenario)
    observer = range_identification(BOTH, boundary_layer=0.05)
    run = track(recording, observer, recording.truth[0], hold="exact", language="python")
    assert np.abs(run.innovation).max() < 0.05


@pytest.mark.slow
@each(["linear_approximation"])
@given(scenario=motions())
@example(scenario=replace(EQ35, duration=5.0))
@drawn(2)
def test_every_iterate_of_the_cascade_stays_nearer_to_the_truth_it_started_at(name, form, scenario):
    recording = record(scenario)
    cascades = [linear_approximation(FORMS[form], iterates=n) for n in (1, 2, 3, 4)]
    runs = [track(recording, each, recording.truth[0], "exact", language="python") for each in cascades]
    worst = [np.abs(run.error).max() for run in runs]
    least = 3 if scenario.duration == 5 and form == "y1+y2" else 2
    assert all(later <= earlier / least + 1e-8 for earlier, later in pairwise(worst))


@pytest.mark.slow
@each(SMOOTH)
@given(scenario=motions())
@example(scenario=EQ35)
@drawn(3)
def test_halving_the_step_divides_the_error_by_sixteen(name, form, scenario):
    period = 0.2 if scenario is EQ35 else 0.25
    recording = record(scenario, camera=Camera(period=period))
    observer = made(name, form, SMOOTH.get)
    steps = (period / n for n in (32, 64, 256))  # so short that the next order of the error matters little
    coarse, fine, reference = (
        track(recording, observer, ZERO, step=step, language="python").state[-1] for step in steps
    )
    errors = np.linalg.norm([coarse - reference, fine - reference], axis=1)
    assert errors[1] < errors[0] / 12 + 1e-12
    assert scenario is not EQ35 or errors[1] > errors[0] / 21 - 1e-14  # rounding


@cache
def derivatives(name, form):
    """Flow and Jacobian as functions of state, outputs, motion and gains, with the numbers of states and of all."""
    observer = EVERY[name](FORMS_AND_SQUARE[form])
    eq = observer.equations
    symbols = (*eq.state, *eq.measured, *eq.parameters, *eq.gains)
    # a sign's derivative is 0 wherever the draw falls
    jacobian = [entry.replace(sp.DiracDelta, lambda *_: sp.S.Zero) for entry in observer.jacobian()]
    functions = (vectorised(symbols, entries) for entries in (eq.flow, jacobian))
    return *functions, len(eq.state), len(symbols)


@pytest.mark.slow
@each(EVERY, FORMS_AND_SQUARE)
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


@pytest.mark.parametrize("make", OBSERVERS, ids=lambda make: make.key)
def test_a_motion_that_varies_is_followed_or_refused(make):
    form = PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2")
    motion = rigid(camera_angular_velocity=lambda t: [0, -0.1 * t, 0], camera_velocity=lambda t: [0.5, 0.1 * t, 0])
    recording = record(Scenario("varying", motion, (0.3, 0.2, 4), 1, pinhole()))
    if make.constant_motion:
        with pytest.raises(DoesNotFit, match="needs a motion with constant coefficients"):
            track(recording, make(form))
    else:
        run = track(recording, make(form), language="python")
        assert np.isfinite(run.estimate[run.unobservable == 0]).all()
        assert run.unobservable[-1] == 0


# ---- Ma's settings with one output

PUSHED = ("identifier_based", "sliding_mode", "de_luca", "spica", "immersion_and_invariance")
"""Observers of the package that push along w with gains that stay; what is found of them binds no other."""


def settling_times(form, recording):
    """Settling times of the inverse distance, of all observers that one output is enough for, from zero."""
    whole = {make.key: make for make in OBSERVERS if make.key in ONE_OUTPUT}
    runs = {name: track(recording, make(form), ZERO, "exact") for name, make in whole.items()}
    return {name: run.settling_time(0.05, recording.view.inverse_distance.name) for name, run in runs.items()}


@pytest.mark.slow
def test_on_a_line_of_the_image_the_output_that_moves_is_enough_for_all():
    """A point that moves on a plane through the camera (Ma 2005, Fig. 2), with y2 constant."""
    recording = record(scenarios.planar())
    assert np.ptp(recording.truth[:, 1]) < 1e-12
    found = settling_times(ONE, recording)
    assert found["extended_kalman"] < 0.5
    assert found["linear_approximation"] < 1.0
    # the constant gains wait for the same slow direction
    assert all(3.5 < found[name] < 5 for name in PUSHED)


def test_on_a_line_of_the_image_the_output_that_rests_tells_nothing():
    recording = record(scenarios.planar())
    assert windowed(OTHER, recording, 10).smallest.max() < 1e-15
    assert all(np.isinf(time) for time in settling_times(OTHER, recording).values())


SLOPE = PerspectiveSystem(affine(), chained()).measure("y1")


@pytest.mark.slow
def test_with_the_slope_alone_only_filters_follow_eq35():
    """The chained surface with y1 = X/Y alone (Ma 2005, (32)); no gain between 1 and 1000 saves De Luca's observer."""
    recording = record(scenarios.ma2005_eq35(chained()), 20)
    found = settling_times(SLOPE, recording)
    assert found["extended_kalman"] < 1
    assert all(np.isinf(found[name]) for name in PUSHED)
    assert track(recording, linear_approximation(SLOPE), ZERO, "exact").settling_time(0.05, "y3") < 11
    for measured, hidden in product((1, 10, 100), (1, 30, 1000)):
        run = track(recording, de_luca(SLOPE, measured_gain=measured, hidden_gain=hidden), hold="exact")
        assert np.isinf(run.settling_time(0.05, "y3"))


@pytest.mark.slow
def test_with_the_slope_alone_all_but_the_cascade_follow_eq36():
    found = settling_times(SLOPE, record(scenarios.ma2005_eq36(chained()), 40))
    assert found["extended_kalman"] < 1
    assert np.isinf(found["linear_approximation"])
    assert all(5 < found[name] < 20 for name in PUSHED)


def exchanged(scenario, order, surface):
    """The same point with its axes in another order, seen on a surface."""
    values = list(scenario.motion.values.values())
    A, b = np.reshape(values[:9], (3, 3)), np.array(values[9:])
    motion = affine(A[np.ix_(order, order)], b[order])
    return Scenario("exchanged", motion, np.array(scenario.position)[order], scenario.duration, surface)


@pytest.mark.parametrize("name", ONE_OUTPUT)
@given(scenario=motions())
@drawn(1)
def test_y2_alone_is_y1_alone_with_the_axes_exchanged(name, scenario):
    make = ONE_OUTPUT[name]
    here = track(record(scenario), make(ONE), ZERO, "exact", language="python")
    other = exchanged(scenario, [1, 0, 2], pinhole())
    there = track(record(other), make(OTHER), ZERO, "exact", language="python")
    np.testing.assert_allclose(there.estimate[:, [1, 0, 2]], here.estimate, rtol=1e-9, atol=1e-9)


CHAINED = {"y1": SLOPE, "y2": PerspectiveSystem(affine(), chained()).measure("y2")}
CHAINED["y1+y2"] = PerspectiveSystem(affine(), chained()).measure("y1", "y2")


@pytest.mark.slow
@each(EVERY)
def test_chained_is_the_pinhole_with_the_axes_exchanged(name, form):
    """Ma 2005, (34), for every observer and all outputs."""
    scenario = scenarios.ma2005_eq35(chained())
    here = track(record(scenario, 2), EVERY[name](CHAINED[form]), ZERO, language="python")
    exchanged_scenario = exchanged(scenario, [0, 2, 1], pinhole())
    there = track(record(exchanged_scenario, 2), made(name, form), ZERO, language="python")
    np.testing.assert_allclose(there.estimate, here.estimate, rtol=1e-9, atol=1e-9)
