"""An observer that is a Python function follows recordings and stands in tables; what it gives is checked."""

from dataclasses import replace

import numpy as np
import pytest
from examples import BOTH, ONE
from refusals import refuses

from percept_obs import Camera, FunctionObserver, Gaussian, affine, ekf, record, scenarios, track
from percept_obs.compile import vectorised
from percept_obs.compile.integrator import step as step_of
from percept_obs.labs import observer_lab, structure_lab
from percept_obs.studies.all_observers import all_observers
from percept_obs.studies.comparison import compare
from percept_obs.tracking import DoesNotFit, transition

SEEN = record(scenarios.ma2005_eq35(), 2, Camera(0.01, Gaussian(0.01)))
START = {"y3": 0.5}


def extended_kalman(form, **changes):
    """The package's filter once more, as a function of its state, an array of mean and covariance."""
    other = ekf(form, noise_variance=1e-4)
    eq, gains, n = other.equations, other.gain_values, len(form.coordinates)
    mean, spread = eq.state[:n], other.covariance
    flow = vectorised((*eq.state, *eq.parameters), eq.flow, gains)
    updates = [vectorised((*eq.state, *form.x1), block, gains) for block in eq.update]

    def start(wanted):
        return other.initial_state(dict(zip(form.measured, wanted, strict=False)), {"y3": wanted[-1]})

    def step(state, sample, seconds, known):
        values = [known[str(symbol)] for symbol in eq.parameters]
        state = step_of(state, np.array(seconds), lambda _, x: np.array(flow(*x, *values)))
        for update in updates if sample is not None else []:
            state = np.array(update(*state, *sample))
        return state

    def covariance(state):
        return np.array(vectorised(eq.state, list(spread))(*state)).reshape(n, n)

    assert other.estimate == mean
    made = FunctionObserver("by hand", form, start, step, lambda state: state[:n], covariance)
    return replace(made, **changes)


@pytest.mark.slow
@pytest.mark.parametrize("unit", [1.0, 1000.0])
def test_a_filter_as_a_function_runs_as_the_filter_in_equations(unit):
    seen = replace(SEEN.without(1, 1.2), unit=unit)
    by_hand, known = (track(seen, each, START) for each in (extended_kalman(BOTH), ekf(BOTH, noise_variance=1e-4)))
    np.testing.assert_allclose(by_hand.estimate, known.estimate, rtol=0, atol=1e-10)
    np.testing.assert_allclose(by_hand.covariance, known.covariance, rtol=0, atol=1e-10)
    assert by_hand.trust().kind == known.trust().kind


@pytest.mark.slow
def test_it_stands_in_the_tables():
    by_hand = extended_kalman(BOTH)
    table = compare([SEEN], [by_hand, ekf(BOTH, noise_variance=1e-4)], START).summary
    assert table.loc["by hand", "final"] == pytest.approx(table.loc["extended Kalman", "final"])
    for truth in (SEEN.truth, None):
        seen = [replace(SEEN, truth=truth), replace(SEEN.between(0, 1.5), truth=None if truth is None else truth[:151])]
        found = all_observers(seen, candidates={ekf: [{}], by_hand: [{}]}, after=[1.0])
        assert found.side_by_side.loc["by hand", "diverged"] == "0"


def test_the_systems_own_step_moves_many_at_once():
    moved, known = transition(ONE), dict(zip(map(str, ONE.parameters), SEEN.motion.known(0)[0], strict=True))
    places = SEEN.truth[[0, 50, 100]]
    np.testing.assert_allclose(moved(places, 0.01, known), SEEN.truth[[1, 51, 101]], atol=1e-8)


def test_a_state_that_is_not_finite_has_diverged():
    def step(state, sample, seconds, known):
        return state if state[0] > 3 else state + 1 if state[0] < 3 else np.full(3, np.nan)

    def exploding(state, sample, seconds, known):
        return np.linalg.cholesky(-np.eye(3))[0]

    for each, time in ((step, 0.05), (exploding, 0.01)):
        run = track(SEEN, extended_kalman(BOTH, start=lambda wanted: np.zeros(3), step=each, covariance=None), START)
        assert run.diverged_at == pytest.approx(time, abs=0.011)
        assert np.isnan(run.estimate[-1]).all()
        assert "diverged" in run.verdict()


def failing(*arguments):
    raise KeyError("lost")


def dividing(*arguments):
    return 1 / 0


test_what_a_function_gives_is_checked = refuses(
    lambda changes, start: track(SEEN, extended_kalman(BOTH, **changes), start),
    (
        {"step": lambda *arguments: np.zeros(2)},
        START,
        r"step of the by hand observer gives shape \(2,\) at 0.01 s, not",
    ),
    (
        {"estimate": lambda state: state},
        START,
        r"estimate of the by hand observer gives shape \(9,\) at 0 s, not \(3,\)",
    ),
    ({"step": failing}, START, "step of the by hand observer fails at 0.01 s: KeyError: 'lost'"),
    ({"step": dividing}, START, "step of the by hand observer fails at 0.01 s: ZeroDivisionError: division by zero"),
    ({"covariance": lambda state: state}, START, r"covariance of .* not \(3, 3\)"),
    ({}, {"y4": 1.0}, "the start has no coordinate y4; give estimates of y1, y2, y3"),
)

test_the_page_refuses_it = refuses(
    lambda lab: lab(observers=[extended_kalman(BOTH)]),
    (observer_lab, "is a Python function, which the page cannot run; let it follow with track"),
    (structure_lab, "is a Python function, which the page cannot run"),
)


def test_a_step_knows_the_motion_in_its_middle():
    motion, seen = affine(np.zeros((3, 3)), lambda time: [np.sin(3 * time), time, 1]), []

    def step(state, sample, seconds, known):
        seen.append(known)
        return state

    watching = FunctionObserver("watching", BOTH, np.copy, step, np.copy)
    track(SEEN.between(0, 0.2), watching, START, believed=motion)
    middle = SEEN.time[:20] + 0.005
    np.testing.assert_allclose([known["b1"] for known in seen], np.sin(3 * middle), rtol=1e-12)
    np.testing.assert_allclose([known["b2"] for known in seen], middle, rtol=1e-12)


def test_a_claim_that_is_not_there_and_a_first_sample_that_was_lost():
    run = track(SEEN.between(0, 0.2), extended_kalman(BOTH, covariance=None), START)
    with pytest.raises(ValueError, match="claims no covariance; give it a function"):
        _ = run.covariance
    with pytest.raises(DoesNotFit, match="first sample was lost"):
        track(SEEN.without(0, 0.1), extended_kalman(BOTH), START)
