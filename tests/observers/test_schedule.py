"""A gain that is an expression of time stands in the equations, so that every language runs it as one that stays."""

import numpy as np
import pytest
import sympy as sp
from examples import BOTH, NOISY, ZERO
from refusals import refuses

from percept_obs import ekf, ibo, record, scenarios, scheduled, smo, track
from percept_obs.labs import observer_lab
from percept_obs.observers import ismo, lao
from percept_obs.observers.inversion import elapsed
from percept_obs.system.motion import TIME

SEEN = record(scenarios.ma2005_eq35(), 3, NOISY)
FADING = 2 + 8 * sp.exp(-TIME)


@pytest.mark.parametrize(
    ("make", "gain"),
    [(ibo, "gain"), (ibo, "bound"), (ekf, "noise_variance"), (ekf, "hidden_variance"), (smo, "hidden_gain")],
)
def test_a_gain_that_stays_gives_the_run_of_its_number(make, gain):
    observer = make(BOTH)
    value = next(each.value for each in observer.gains if each.name == gain)
    whole = scheduled(observer, **{gain: sp.Float(value)})
    np.testing.assert_allclose(track(SEEN, whole).estimate, track(SEEN, observer).estimate, rtol=0, atol=1e-12)


def test_the_clock_counts_from_the_first_sample_and_the_gain_follows_it():
    part = SEEN.between(1.0, 3.0)
    run = track(part, scheduled(ibo(BOTH), gain=FADING), ZERO)
    np.testing.assert_allclose(run.state[:, -1], run.elapsed, atol=1e-12)
    jump = scheduled(ibo(BOTH), gain=sp.Piecewise((2, TIME < 1), (10, True)))
    before, after = (track(SEEN, ibo(BOTH, gain=gain), ZERO).estimate for gain in (2, 10))
    found = track(SEEN, jump, ZERO).estimate
    np.testing.assert_allclose(found[SEEN.elapsed < 0.99], before[SEEN.elapsed < 0.99], atol=1e-12)
    assert np.abs(found[-1] - after[-1]).max() < np.abs(found[-1] - before[-1]).max()


def test_the_limit_of_the_step_follows_the_gain():
    weight = lao(BOTH).gains[1]
    rate = scheduled(lao(BOTH), measurement_weight=FADING).fastest.rate
    assert rate.subs(elapsed, 0) == lao(BOTH).fastest.rate.subs(weight.symbol, 10)


@pytest.mark.slow
def test_a_lab_takes_it():
    assert observer_lab(observers=[scheduled(ibo(BOTH), gain=FADING)])


test_what_is_no_gain_over_time_is_refused = refuses(
    lambda observer, gains: scheduled(observer, **gains),
    (ibo(BOTH), {"gain": 1 - TIME}, "gain = 1 - t is 0 at t = 1 s; it must be finite and G > 0"),
    (ibo(BOTH), {"gain": 1 / TIME}, "is inf at t = 0 s"),
    (ibo(BOTH), {"gain": "2 + t"}, "is the text .*; give a finite real number or a sympy expr"),
    (ibo(BOTH), {"gain": sp.Symbol("q")}, "depends on other things than t"),
    (ibo(BOTH), {"gian": TIME}, "has no gain gian; it has gain"),
    (ismo(BOTH), {"feedback": 1 + TIME}, "knows its limits for constant k1 only"),
)
