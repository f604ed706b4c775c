"""A sign that is integrated chatters in proportion to the step or its square root, and stops adaptive solvers."""

from functools import cache

import numpy as np
import pytest
from examples import BOTH, ZERO
from refusals import refuses

from percept_obs import figures, record, scenarios
from percept_obs.observers import range_identification, sliding_mode
from percept_obs.studies.chatter import chatter, effort

EQ35 = scenarios.ma2005_eq35()
FROM_ZERO = dict(zip(("y1", "y2", "y3"), ZERO, strict=True))


@cache
def errors(make, switch, halvings=7, **gains):
    """Steps from 10 ms on, each half of the last, and the errors over 5 to 10 s."""
    steps = [0.01 / 2**n for n in range(halvings + 1)]
    return chatter(record(EQ35, 10), make(BOTH, switch=switch, **gains), steps, ZERO, after=5)


def order(table, name):
    """The power of the step that the errors follow."""
    return np.polyfit(np.log(table["step"]), np.log(table[name]), 1)[0]


@pytest.mark.slow
def test_chatter_of_dixons_observer_at_the_stated_steps():
    table = chatter(record(EQ35, 10), range_identification(BOTH, switch="sign"), [1e-2, 1e-3, 1e-4], ZERO, after=5)
    np.testing.assert_allclose(table["y3"], [0.114, 0.030, 0.0076], rtol=0.02)


@pytest.mark.slow
def test_a_boundary_layer_does_not_chatter():
    table = errors(range_identification, "hyperbolic tangent", 3)
    np.testing.assert_allclose(table["y3"], 0.005, atol=1e-4)
    assert np.ptp(table["y3"]) < 1e-7
    assert errors(sliding_mode, "fraction", 3)["y3"].max() < 1e-5


@pytest.mark.slow
def test_a_sign_in_the_rate_chatters_in_proportion_to_the_step():
    assert 0.8 < order(errors(sliding_mode, "sign", adaptation=0), "y3") < 1.2


@pytest.mark.slow
@pytest.mark.parametrize("gamma", [20, 40])
def test_a_sign_in_the_rate_of_the_rate_chatters_in_proportion_to_the_root_of_the_step(gamma):
    """Only its innovation is proportional to the step."""
    table = errors(range_identification, "sign", switching_gain=gamma)
    assert 0.45 < order(table, "y3") < 0.65
    assert 0.9 < order(table, "y1") < 1.3


@pytest.mark.slow
def test_chatter_is_proportional_to_the_switching_gain():
    ratios = errors(range_identification, "sign", switching_gain=40)["y3"]
    ratios /= errors(range_identification, "sign", switching_gain=20)["y3"]
    assert np.exp(np.mean(np.log(ratios))) == pytest.approx(2, rel=0.2)


@pytest.mark.night  # with fewer evaluations the solver has not begun to slide
@pytest.mark.slow
@pytest.mark.parametrize("make", [range_identification, sliding_mode], ids=["Dixon", "sliding mode"])
def test_an_adaptive_solver_is_stopped_by_the_sign_alone(make):
    smooth = effort(EQ35, make(BOTH), 5.0, FROM_ZERO)
    assert smooth.finished
    assert smooth.time[-1] == 5
    assert smooth.evaluations[-1] < 2000
    switching = effort(EQ35, make(BOTH, switch="sign"), 5.0, FROM_ZERO)
    assert not switching.finished
    assert switching.time[-1] < 2
    assert 20_000 <= switching.evaluations[-1] < 20_200
    # before it slides, it steps as the smooth one does
    assert switching.steps.max() > 1e-3
    assert np.median(switching.steps[-100:]) < 2e-4 < np.median(smooth.steps) / 10


test_bad_input_is_refused = refuses(
    lambda call: call(),
    (lambda: chatter(record(EQ35, 1), sliding_mode(BOTH), []), "no steps"),
    (lambda: chatter(record(EQ35, 1), sliding_mode(BOTH), [0.0]), "step is 0.0; it must be positive"),
    (lambda: chatter(record(EQ35, 1), sliding_mode(BOTH), [0.01], after=2), "after is 2.* shorter than the recording"),
    (lambda: effort(EQ35, sliding_mode(BOTH), -1), "duration is -1"),
    (lambda: effort(EQ35, sliding_mode(BOTH), 1, most=0), "most is 0"),
)


@pytest.fixture(scope="module")
def chattering():
    scenario = EQ35
    smooth, switching = sliding_mode(BOTH), sliding_mode(BOTH, switch="sign")
    errors = {"sign": chatter(record(scenario, 2), switching, [0.01, 0.005], ZERO, 1)}
    efforts = {"sign": effort(scenario, switching, 2, most=2000), "fraction": effort(scenario, smooth, 2)}
    return errors, efforts


def test_chatter_draws_errors_over_steps_and_steps_over_time(chattering):
    errors, efforts = chattering
    left, right = figures.chatter(errors, efforts).axes
    np.testing.assert_array_equal(left.lines[0].get_data(), errors["sign"][["step", "y3"]].T)
    for line, one in zip(right.lines, efforts.values(), strict=True):
        np.testing.assert_array_equal(line.get_data(), [one.time[1:], one.steps])
    assert left.lines[0].get_linestyle() == right.lines[0].get_linestyle() != right.lines[1].get_linestyle()
    names = [[text.get_text() for text in ax.get_legend().get_texts()] for ax in (left, right)]
    assert names == [["sign"], ["fraction"]]


def test_the_text_of_chatter_says_how_each_solver_got_on(chattering):
    errors, efforts = chattering
    text = figures.chatter(errors, efforts).text
    stopped = efforts["sign"]
    assert f"sign: error at a step of 0.01 s {errors['sign']['y3'][0]:.2g}" in text
    assert f"sign: RK45 gave up at {stopped.time[-1]:.2g} s after {stopped.evaluations[-1]} evaluations" in text
    assert f"fraction: RK45 arrived at 2 s after {efforts['fraction'].evaluations[-1]} evaluations" in text
    for given in ((errors, {}), ({}, efforts)):
        with pytest.raises(ValueError, match="at least one of each"):
            figures.chatter(*given)
