"""The likelihood of the innovations chooses gains whose claims hold, and says when they are at an edge."""

import numpy as np
import pytest
from examples import BOTH, ZERO
from percept_obs.studies.likelihood import log_likelihood, tune_by_likelihood
from sample_sizes import sampled
from trust_study import posed
from tuning_study import RIGID, SCENARIOS, both_ways

from percept_obs import Camera, Gaussian, ekf, ibo, record, scenarios, track
from percept_obs.recording.utias import UTIAS_CUT, load_utias

SIGMA = 0.01
RECORDINGS = [record(scenarios.ma2005_eq35(), 3, Camera(0.06, Gaussian(SIGMA)), seed) for seed in range(3)]


def follow(recording, observer):
    return track(recording, observer, {"y3": 0.3}, language="numba")


@pytest.mark.slow
def test_the_noise_is_found_and_a_doubt_that_nothing_speaks_for_is_none():
    ranges = {"noise_variance": (1e-6, 1e-2), "process_noise": (1e-9, 1e-3)}
    found = tune_by_likelihood(RECORDINGS, ekf(BOTH), ranges, follow)
    assert found.gains["noise_variance"] == pytest.approx(SIGMA**2, rel=0.25)
    assert found.gains["process_noise"] == 0
    assert found.at_edge == ()
    near = found.observer.with_gains(noise_variance=2 * found.gains["noise_variance"])
    assert found.log_likelihood > log_likelihood([follow(each, near) for each in RECORDINGS])
    assert found.log_likelihood == log_likelihood([follow(each, found.observer) for each in RECORDINGS])


@pytest.mark.slow
def test_an_edge_is_said():
    found = tune_by_likelihood(RECORDINGS[:1], ekf(BOTH), {"noise_variance": (1e-3, 1e-2)}, follow)
    assert found.at_edge == ("noise_variance",)
    assert "at the edge of what was tried: noise_variance" in repr(found)


@pytest.mark.slow
@pytest.mark.parametrize("scenario", SCENARIOS[: sampled(1, None)])
def test_claims_hold_and_errors_are_hardly_larger_than_those_of_tuning_by_error(scenario):
    likely, by_error, _ = both_ways(*scenario())
    assert likely.nis == pytest.approx(1, abs=0.1)
    assert 0.3 < likely.nees < 0.7
    assert likely.error <= 1.15 * by_error.error
    assert abs(np.log(by_error.nis)) > np.log(2)  # what the median error does to honesty


DOUBTS = {"noise_variance": (1e-7, 1e-3), "turning_noise": (1e-9, 1e-2), "velocity_noise": (1e-9, 1e-1)}


def claims(choosing, reporting, follow, start_variance):
    """Mean NIS and NEES over what is expected, of a filter tuned on other recordings; the first second is left out."""
    observer = ekf(RIGID, measured_variance=1e-4, hidden_variance=start_variance)
    tuned = tune_by_likelihood(choosing, observer, DOUBTS, follow).observer
    runs = [follow(each, tuned) for each in reporting]
    return [
        np.mean([np.nanmean(of(run)[run.elapsed >= 1]) for run in runs])
        for of in (lambda run: run.nis / 2, lambda run: run.nees())
    ]


@pytest.mark.slow
def test_noise_of_the_velocities_explains_innovations_and_errors_with_noisy_poses():
    """Each recording has another noise of its poses, so that no setting is right for all."""
    believed = {}
    for seed in range(sampled(12, 36)):
        recording, known, _ = posed(seed, "noisy", sigma=0.002)
        believed[recording] = known
    recordings = [*believed]
    third = len(recordings) // 3
    nis, nees = claims(
        *(recordings[:third], recordings[third:]),
        lambda r, o: track(r, o, {"y3": 0.3}, believed=believed[r], language="numba"),
        0.1,
    )
    assert 0.5 < nis < 2
    assert 0.5 < nees < 2


@pytest.mark.slow
def test_noise_of_the_velocities_explains_innovations_and_errors_on_real_tracks():
    tracks = load_utias(UTIAS_CUT)
    start = {"y3": 1 / 1.8}
    nis, nees = claims(tracks[::8], tracks[1::2], lambda r, o: track(r, o, start, language="numba"), 1.0)
    assert 0.5 < nis < 2
    assert 0.4 < nees < 2


@pytest.mark.slow
def test_what_makes_no_sense_is_refused():
    run = follow(RECORDINGS[0], ekf(BOTH))
    for ask, message in (
        (lambda: log_likelihood([]), "there is no run"),
        (lambda: log_likelihood([run], -1.0), "must not be negative"),
        (lambda: log_likelihood([run], 1e9), "nor beyond a run, which lasts"),
        (lambda: log_likelihood([track(RECORDINGS[0], ibo(BOTH), ZERO)]), "claims no covariance"),
        (lambda: tune_by_likelihood([], ekf(BOTH), {"noise_variance": (1e-3, 1)}, follow), "0 recordings"),
        (lambda: tune_by_likelihood(RECORDINGS, ekf(BOTH), {}, follow), "0 gains"),
        (lambda: tune_by_likelihood(RECORDINGS, ekf(BOTH), {"noise_variance": (0, 1)}, follow), "smallest and a larg"),
        (lambda: tune_by_likelihood(RECORDINGS, ekf(BOTH), {"noise": (1e-3, 1)}, follow), "has no gain noise"),
    ):
        with pytest.raises(ValueError, match=message):
            ask()
