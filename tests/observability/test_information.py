"""Information at the end of a run: least squares claim the errors that they make."""

import numpy as np
import pytest

from percept_obs import Camera, Gaussian, Recording, record
from percept_obs.points import information as of_points
from percept_obs.points.scenarios import moving_body
from percept_obs.tracking.information import _deviation, _inflation

BODY, SIGMA = moving_body(2), 0.005


def fitted(recording):
    return of_points.many_points(BODY.form, recording)(0, [])


@pytest.mark.slow
def test_many_points_claim_the_errors_that_they_have():
    """With 20 numbers for 6 states a sum of squares over all 20 would be a third too small."""
    drawn = [record(BODY, 4.0, Camera(1.0, Gaussian(SIGMA)), seed) for seed in range(40)]
    bare = [Recording(r.time, r.outputs, r.names, r.view, r.motion) for r in drawn]
    found, deviations, _, _ = zip(*map(fitted, bare), strict=True)
    places = BODY.form.locate([*found, drawn[0].truth[-1]])
    off = np.linalg.norm(places[:-1] - places[-1], axis=-1) / np.linalg.norm(places[-1], axis=-1)
    worst = np.sqrt((off**2).mean(axis=0)).max()
    assert np.mean(deviations) == pytest.approx(worst, rel=0.25)


def test_of_too_many_samples_every_so_many_are_taken(monkeypatch):
    whole = record(BODY, 6.0, Camera(0.5, Gaussian(SIGMA)))
    half = Recording(whole.time[::2], whole.outputs[::2], whole.names, whole.view, whole.motion, None, None, 1e-9)
    assert len(whole.time) % 2
    expected = fitted(half)
    monkeypatch.setattr(of_points, "LARGEST_TABLE", len(whole.time) * BODY.form.states**2 // 2)
    whole = Recording(whole.time, whole.outputs, whole.names, whole.view, whole.motion, None, None, 1e-9)
    for one, other in zip(fitted(whole), expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9)


def test_a_deviation_is_that_of_least_squares_infinite_where_two_unknowns_act_alike():
    J = np.random.default_rng(0).normal(size=(30, 3))
    expected = np.sqrt(np.diag(np.linalg.inv(J.T @ J)))
    np.testing.assert_allclose([_deviation(J, k) for k in range(3)], expected, rtol=1e-9)
    J[:, 2] = J[:, 0] - 2 * J[:, 1]
    assert [_deviation(J, k) for k in range(3)] == [np.inf] * 3
    J[:, 2] = 0
    assert [np.isinf(_deviation(J, k)) for k in range(3)] == [False, False, True]


def test_correlated_residuals_widen_a_deviation_and_white_ones_do_not():
    white = np.random.default_rng(0).normal(size=4000)
    walked = white.copy()
    for k in range(1, len(walked)):
        walked[k] += 0.8 * walked[k - 1]
    time = 0.01 * np.arange(4000)
    assert _inflation(white, time) == 1.0
    assert _inflation(walked, time) == pytest.approx(3.0, rel=0.1)
