"""A well-tuned filter passes the test of its innovations as often as promised; a wrong noise variance is told."""

from dataclasses import replace

import numpy as np
import pytest
from examples import BOTH, ONE, ZERO
from refusals import refuses

from percept_obs import Camera, Gaussian, affine, check_consistency, ekf, ibo, record, scenarios, track
from percept_obs.studies.consistency import claimed_distance, claimed_interval

SIGMA = 0.01
CAMERA = Camera(period=0.05, noise=Gaussian(SIGMA))
RECORDING = record(scenarios.ma2005_eq35(), 20, CAMERA, seed=1)


def filtered(form, recording=RECORDING, variance=SIGMA**2, **start):
    """A filter that begins near the truth, as far from it as it believes."""
    known = dict(zip((s.name for s in form.coordinates), recording.truth[0], strict=True))
    observer = ekf(form, noise_variance=variance, measured_variance=1e-4, hidden_variance=1e-4)
    return track(recording, observer, {**known, **start}, language="python")


@pytest.mark.night(reason="share of 200 recordings")
@pytest.mark.slow
@pytest.mark.parametrize("form", [ONE, BOTH], ids=["y1", "y1+y2"])
def test_a_right_claim_passes_in_about_95_of_100_recordings(form):
    """190 of 200 recordings should pass, with a standard deviation of 3.1."""
    count = 200
    recordings = [record(scenarios.ma2005_eq35(), 10, CAMERA, seed) for seed in range(count)]
    found = [check_consistency(filtered(form, each)) for each in recordings]
    passed = sum(one.judgement == "consistent" for one in found)
    assert abs(passed - 0.95 * count) <= 3 * np.sqrt(count * 0.95 * 0.05)
    low, high = found[0].interval(50)
    inside = np.mean([np.mean((one.averages > low) & (one.averages < high)) for one in found])
    assert inside == pytest.approx(0.95, abs=0.02)


@pytest.mark.parametrize("form", [ONE, BOTH], ids=["y1", "y1+y2"])
@pytest.mark.parametrize(("factor", "judgement"), [(1 / 4, "overconfident"), (1, "consistent"), (4, "conservative")])
def test_a_wrong_noise_variance_is_told(form, factor, judgement):
    found = check_consistency(filtered(form, variance=factor * SIGMA**2))
    assert found.judgement == judgement
    assert found.mean == pytest.approx(len(form.x1) / factor, rel=0.15)
    assert f"<Consistency: {judgement}: " in repr(found)
    assert f"of 401 samples is {found.mean:.3g}; {len(form.x1)} is expected" in found.verdict()


def test_the_interval_is_that_of_chi_squared():
    from scipy.stats import chi2  # only here, for it takes a while

    found = check_consistency(filtered(BOTH))
    for count in (1, 50, 401):
        inside = np.diff(chi2.cdf(count * np.array(found.interval(count)), 2 * count))
        assert inside == pytest.approx(0.95)


def test_whiteness_of_the_innovations_is_told():
    """A filter that believes its samples too little follows too slowly, so that its innovations drift."""
    right = check_consistency(filtered(BOTH))
    assert right.white
    assert abs(right.autocorrelation) < 0.07
    believed = affine(*(np.array(part, dtype=float) for part in (np.zeros((3, 3)), np.array([0.5, 0.25, 0.3]))))
    known = dict(zip(("y1", "y2", "y3"), RECORDING.truth[0], strict=True))
    run = track(RECORDING, ekf(BOTH, noise_variance=SIGMA**2, process_noise=0.01), known, believed=believed)
    wrong = check_consistency(run)
    assert not wrong.white
    assert "not white: each tells of the next" in wrong.verdict()
    np.testing.assert_allclose((right.whitened**2).sum(axis=1), right.nis)


def test_nis_nees_and_likelihood_are_those_of_the_innovations_before_the_update():
    """Recomputed from the covariance before each update, which the flow gives from the one after the last."""
    from scipy.stats import norm

    run = filtered(ONE)
    R, sizes = SIGMA**2, run.nis[np.isfinite(run.nis)]
    after = run.covariance[1:, 0, 0]
    S = R**2 / (R - after)  # of one output: P = R (S - R) / S after the update
    innovation = run.innovation[1:, 0] * S / R
    np.testing.assert_allclose(sizes[-400:], innovation**2 / S, rtol=1e-6)
    np.testing.assert_allclose(run.log_likelihood[1:], norm.logpdf(innovation, scale=np.sqrt(S)), rtol=1e-6)
    np.testing.assert_allclose(run.nees("y3"), run.error[:, 2] ** 2 / run.covariance[:, 2, 2])
    joint = run.error[:, None, 1:] @ np.linalg.inv(run.covariance[:, 1:, 1:]) @ run.error[:, 1:, None]
    np.testing.assert_allclose(run.nees(), joint[:, 0, 0], rtol=1e-6)


def test_averages_move_over_the_samples_that_there_are():
    lost = RECORDING.outputs.copy()
    lost[100:110] = np.nan
    run = filtered(BOTH, replace(RECORDING, outputs=lost))
    found = check_consistency(run, samples=20, after=2.0)
    assert len(found.nis) == 401 - 40 - 10
    assert found.time[0] == pytest.approx(2.0)
    np.testing.assert_allclose(found.averages[7], found.nis[7:27].mean())
    assert found.average_time[7] == found.time[26]
    assert len(found.averages) == len(found.average_time)


def test_the_interval_of_the_distance_is_that_of_its_inverse():
    run = filtered(ONE)
    state = run.state.copy()
    names = [symbol.name for symbol in run.observer.equations.state]
    state[:100, names.index("P33")] = 1.0  # two of these are more than any estimate here
    wide = replace(run, state=state)
    low, high = claimed_interval(wide)
    sigma = np.sqrt(wide.covariance[:, 2, 2])
    np.testing.assert_allclose(high[:, 2] - low[:, 2], 4 * sigma)
    np.testing.assert_allclose((high + low)[:, 2] / 2, wide.estimate[:, 2])
    nearest, farthest = claimed_distance(wide)
    assert np.isinf(farthest[:100]).all()
    np.testing.assert_allclose(nearest, 1 / high[:, 2])
    np.testing.assert_allclose(farthest[100:], 1 / low[100:, 2])
    assert (nearest < wide.distance).all()
    assert (wide.distance < farthest).all()


def test_behind_the_camera_and_where_a_run_diverged_no_distance_is_claimed():
    run = filtered(ONE)
    assert np.isinf(claimed_distance(replace(run, estimate=np.full_like(run.estimate, -5.0)))).all()
    lost = run.time[:, None] < 10
    state, estimate = (np.where(lost, values, np.nan) for values in (run.state, run.estimate))
    diverged = replace(run, estimate=estimate, state=state, diverged_at=10.0)
    for end in (*claimed_interval(diverged), *claimed_distance(diverged)):
        np.testing.assert_array_equal(np.isnan(end.T), np.broadcast_to(run.time >= 10, end.T.shape))
    with pytest.raises(ValueError, match="diverged at 10 s"):
        check_consistency(diverged)


test_what_makes_no_sense_is_refused = refuses(
    lambda arguments: check_consistency(filtered(BOTH), **arguments),
    ({"samples": 0}, "of 0 samples was asked for; there are 401"),
    ({"samples": 402}, "there are 401"),
    ({"after": 18.0}, "of 50 samples was asked for; there are 41"),
    ({"after": -1.0}, "must not be negative"),
)


@pytest.mark.parametrize("ask", [check_consistency, claimed_interval, claimed_distance])
def test_an_observer_without_a_claim_is_refused(ask):
    with pytest.raises(ValueError, match="claims no covariance"):
        ask(track(RECORDING, ibo(BOTH), ZERO))
