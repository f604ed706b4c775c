"""Condition (14) and the decay of the error are as they were verified, and what is not seen is named."""

from functools import lru_cache

import numpy as np
import pytest

from percept_obs import Camera, PointsScenario, luenberger, record, track
from percept_obs.points import riccati, rigid_body
from percept_obs.points.gramian import decay_bound, gramian, linear_gramian
from percept_obs.points.scenarios import along_the_line_of_sight, moving_body

START_ERROR = np.array([0.3, -0.2, 0.5, 0.2, -0.1, 0.3])
RATES = {1: {1 / 3: 0.086, 1: 0.179, 10: 0.067}, 2: {1 / 3: 0.032, 1: 0.085, 10: 0.029}}


@lru_cache
def recording(points, duration=60.0, period=0.01):
    return record(moving_body(points), duration, Camera(period))


@pytest.mark.slow
@pytest.mark.parametrize(("points", "at_start", "least", "when"), [(1, 2.44, 0.749, 7.2), (2, 0.90, 0.277, 47.8)])
def test_the_smallest_eigenvalue(points, at_start, least, when):
    found = gramian(recording(points), 8)
    assert found.holds
    assert found.smallest[0] == pytest.approx(at_start, rel=0.01)
    assert found.least == pytest.approx(least, rel=0.01)
    assert found.time[found.smallest.argmin()] == pytest.approx(when, abs=0.1)
    assert "(14) holds" in found.verdict()


@pytest.mark.slow
@pytest.mark.parametrize("points", [1, 2])
def test_the_decay_rates(points):
    """Fitted to log|rho| from 20 to 60 s; too much gain, a small P, slows the decay as too little does."""
    rates, whole = {}, recording(points, 60.0, 0.05)
    for P, expected in RATES[points].items():
        start = whole.truth[0] - START_ERROR[: 3 * points]
        run = track(whole, luenberger(whole.view, P), start, hold="exact", step=0.05)
        rates[P] = run.decay_rate(20, 60)
        assert rates[P] == pytest.approx(expected, rel=0.02)
    assert rates[1 / 3] < rates[1] > rates[10]


@pytest.mark.slow
@pytest.mark.parametrize("points", [1, 2])
def test_the_bound_on_the_decay_lies_below_it_and_has_a_best_gain_too(points):
    whole = recording(points, 12.0, 0.05)
    bounds = [decay_bound(whole, luenberger(whole.view, P), 4) for P in (*RATES[points], 300)]
    for bound, (P, measured) in zip(bounds, RATES[points].items(), strict=False):
        assert 0 < bound.rate < measured, P
    rates = [bound.rate for bound in bounds]
    assert rates[0] < max(rates) > rates[-1]
    # the larger P, the less is seen relatively to it, and the less do corrections hide
    assert (np.diff([bound.seen.min() for bound in bounds]) < 0).all()
    assert (np.diff([bound.feedback.max() for bound in bounds]) < 0).all()


@pytest.mark.slow
def test_the_bound_holds_window_by_window():
    whole, window = recording(1, 60.0, 0.05), 4.0
    run = track(whole, luenberger(whole.view, 1.0), whole.truth[0] - START_ERROR[:3], hold="exact", step=0.05)
    bound = decay_bound(whole, run.observer, window)
    V = run.deviation**2
    at = np.searchsorted(whole.time, [*bound.time, bound.time[-1] + window])
    assert (V[at[1:]] / V[at[:-1]] <= bound.contraction).all()


def test_a_depth_that_is_not_seen_is_named():
    found = gramian(record(along_the_line_of_sight(), 20), 8)
    assert not found.holds
    (direction,) = found.unseen(0).T
    np.testing.assert_allclose(np.abs(direction), np.array([0.4, 0.2, 2]) / np.linalg.norm([0.4, 0.2, 2]), atol=1e-9)
    assert "1 direction is not seen: 0.2 X + 0.1 Y + Z; this is the state itself" in found.verdict()


def test_a_camera_that_only_turns_sees_no_depth_of_any_point():
    offsets = np.random.default_rng(0).uniform(-0.4, 0.4, 6)
    form = rigid_body(3, [0.02, 0.03, 0.1])
    found = gramian(record(PointsScenario("turning only", form, [0.2, -0.1, 3.0, *offsets], 8)), 6)
    assert found.unseen(0).shape[1] == 3
    assert "the state itself is among them" in found.verdict()


def test_the_input_decides_at_equal_a():
    """The same A and C, and three inputs: nothing, along the ray, across it."""
    least = []
    for velocity in ([0.0, 0, 0], [0.0, 0, 0.2], [0.3, 0, 0]):
        form = rigid_body(1, [0.0, 0, 0], velocity)
        found = gramian(record(PointsScenario("input", form, [0.0, 0, 3], 4)), 3)
        least.append(found.least)
        assert linear_gramian(record(PointsScenario("input", form, [0.0, 0, 3], 4)), 3).least == pytest.approx(3)
    assert max(abs(least[0]), abs(least[1])) < 1e-9 < 1e-3 < least[2]


@pytest.mark.slow
def test_a_window_without_images_shows_nothing():
    whole = recording(1).without(10, 20)
    found = gramian(whole, 8)
    assert not found.holds
    assert found.unseen(int(np.searchsorted(found.time, 11))).shape[1] == 3
    assert found.smallest[0] == pytest.approx(gramian(recording(1), 8).smallest[0])


def test_windows_agree_with_their_plain_sums():
    whole = recording(2, 6.0)
    found = gramian(whole, 2)
    A, _ = whole.view.coefficients(whole.time)
    for first in (0, 150, 400):
        Phi, total = np.eye(6), np.zeros((6, 6))
        S = whole.view.information(whole.outputs)
        for k in range(first, first + 200):
            middle = (A[k] + A[k + 1]) / 2 * 0.01
            step = np.eye(6) + middle + middle @ middle / 2 + middle @ middle @ middle / 6
            total += 0.005 * Phi.T @ (S[k] + step.T @ S[k + 1] @ step) @ Phi
            Phi = step @ Phi
        np.testing.assert_allclose(found.matrices[first], total, atol=1e-4)


@pytest.mark.parametrize("window", [0, -1, 61])
def test_windows_that_do_not_fit_are_refused(window):
    with pytest.raises(ValueError, match="must be positive and at most 60 s"):
        gramian(recording(1), window)


def test_the_bound_needs_what_the_proof_needs():
    with pytest.raises(ValueError, match=r"rests on \(15\)"):
        decay_bound(recording(1), luenberger(recording(1).view, riccati()), 4)
    with pytest.raises(ValueError, match=r"rests on \(15\)"):
        decay_bound(recording(1), luenberger(recording(1).view, lambda t: 1 + t), 4)
