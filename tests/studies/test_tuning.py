"""Gains are chosen by errors, or by the likelihood of innovations: then claims hold, and an edge is told."""

from dataclasses import replace

import numpy as np
import pytest
from distrust_study import drawn
from examples import BOTH, ZERO
from refusals import refuses
from trust_study import posed

from percept_obs import Camera, Gaussian, PerspectiveSystem, ekf, ibo, pinhole, record, rigid, scenarios, smo, track
from percept_obs.observers.gains import grid
from percept_obs.recording.utias import UTIAS_CUT, load_utias
from percept_obs.studies.comparison import relative_distance_errors
from percept_obs.studies.tuning import best_setting, tune_by_likelihood

RIGID = PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2")
SIGMA = 0.01
RECORDINGS = [record(scenarios.ma2005_eq35(), 3, Camera(0.06, Gaussian(SIGMA)), seed) for seed in range(3)]


def follow(recording, observer):
    return track(recording, observer, {"y3": 0.3}, language="numba")


@pytest.mark.parametrize("others", [[ibo(BOTH, gain=2)], [smo(BOTH, switching_gain=1e150, bound=1e160)]])
def test_the_best_setting_has_the_least_median_error_and_has_not_diverged(others):
    settings = [*others, ibo(BOTH, gain=10), ibo(BOTH, gain=20)]
    errors = [relative_distance_errors([track(RECORDINGS[0], each, ZERO)], 1.0)[0] for each in settings]
    best = best_setting(RECORDINGS[:1], settings, lambda r, o: track(r, o, ZERO), (1.0,))
    assert best is settings[int(np.nanargmin(errors))]


@pytest.mark.slow
def test_the_noise_is_found_and_a_doubt_that_nothing_speaks_for_is_none():
    ranges = {"noise_variance": (1e-6, 1e-2), "process_noise": (1e-9, 1e-3)}
    found = tune_by_likelihood(RECORDINGS, ekf(BOTH), ranges, follow)
    assert found.gains["noise_variance"] == pytest.approx(SIGMA**2, rel=0.25)
    assert found.gains["process_noise"] == 0
    assert found.at_edge == ()
    near = found.observer.with_gains(noise_variance=2 * found.gains["noise_variance"])
    likely, less = (sum(np.nansum(follow(r, o).log_likelihood) for r in RECORDINGS) for o in (found.observer, near))
    assert found.log_likelihood == pytest.approx(likely, rel=1e-12)
    assert likely > less


@pytest.mark.slow
def test_an_edge_is_said():
    found = tune_by_likelihood(RECORDINGS[:1], ekf(BOTH), {"noise_variance": (1e-3, 1e-2)}, follow)
    assert found.at_edge == ("noise_variance",)
    assert "at the edge of what was tried: noise_variance" in repr(found)


# Twelve recordings to choose on and twenty-four to report on, or fewer for a sample.


def near_ma(seed):
    """Ma's (35) with noise of a hundredth of the focal length."""
    return record(scenarios.ma2005_eq35(), 5, Camera(0.025, Gaussian(0.01)), seed)


def far_away(seed):
    """Ma's (36), whose point moves away, with less noise."""
    return record(scenarios.ma2005_eq36(), 5, Camera(0.025, Gaussian(0.003)), seed)


def by_hand(seed):
    """A camera that a hand carries past points at several metres."""
    camera = Camera(0.04, Gaussian(0.002))
    exact, _ = drawn(seed, "good")
    outputs = exact.truth[:, :2] + camera.noise.draw(np.random.default_rng(seed), exact.outputs.shape)
    return replace(exact, outputs=outputs, noise_variance=camera.noise.variance).between(0, 5)


SCENES = ((BOTH, near_ma), (BOTH, far_away), (RIGID, by_hand))
RANGES = {"noise_variance": (1e-7, 1e-2), "process_noise": (1e-9, 1e-2), "hidden_variance": (1e-3, 10)}
GRID = grid(
    noise_variance=(1e-6, 1e-5, 1e-4, 1e-3), process_noise=(0, 1e-6, 1e-5, 1e-4, 1e-3), hidden_variance=(0.1, 1)
)
"""Gains that are searched by the median error; they include the right ones."""


@pytest.mark.night(reason="claims over 24 recordings of each scene")
@pytest.mark.slow
@pytest.mark.parametrize(("form", "make"), SCENES, ids=lambda one: getattr(one, "__name__", ""))
def test_claims_hold_and_errors_are_hardly_larger_than_those_of_tuning_by_error(form, make):
    count, after = 12, (1.0, 2.0, 3.0)
    made = [make(seed) for seed in range(3 * count)]
    tuned = tune_by_likelihood(made[:count], ekf(form), RANGES, follow).observer
    by_error = best_setting(made[:count], [ekf(form, **gains) for gains in GRID], follow, after)
    found = []
    for observer in (tuned, by_error):
        runs = [follow(recording, observer) for recording in made[count:]]
        nis = np.nanmean(np.concatenate([run.nis for run in runs])) / 2
        nees = np.nanmedian(np.concatenate([run.nees("y3") for run in runs]))
        found.append((nis, nees, np.median([relative_distance_errors(runs, seconds) for seconds in after])))
    (nis, nees, error), (other, _, least) = found
    assert nis == pytest.approx(1, abs=0.1)
    assert 0.3 < nees < 0.7
    assert error <= 1.15 * least
    assert abs(np.log(other)) > np.log(2)  # what the median error does to honesty


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


@pytest.mark.night(reason="claims over 36 recordings")
@pytest.mark.slow
def test_noise_of_the_velocities_explains_innovations_and_errors_with_noisy_poses():
    """Each recording has another noise of its poses, so that no setting is right for all."""
    believed = dict(posed(seed, "noisy", sigma=0.002)[:2] for seed in range(36))
    recordings = [*believed]
    third = len(recordings) // 3
    nis, nees = claims(
        *(recordings[:third], recordings[third:]),
        lambda r, o: track(r, o, {"y3": 0.3}, believed=believed[r], language="numba"),
        0.1,
    )
    assert 0.5 < nis < 2
    assert 0.5 < nees < 2


@pytest.mark.night(reason="claims over 22 real tracks")
@pytest.mark.slow
def test_noise_of_the_velocities_explains_innovations_and_errors_on_real_tracks():
    tracks = load_utias(UTIAS_CUT)
    start = {"y3": 1 / 1.8}
    nis, nees = claims(tracks[::8], tracks[1::2], lambda r, o: track(r, o, start, language="numba"), 1.0)
    assert 0.5 < nis < 2
    assert 0.4 < nees < 2


NOISE = {"noise_variance": (1e-3, 1)}

test_what_makes_no_sense_is_refused = refuses(
    lambda recordings, observer, ranges: tune_by_likelihood(
        recordings, observer, ranges, lambda r, o: track(r, o, {"y3": 0.3}, language="python")
    ),
    ([], ekf(BOTH), NOISE, "0 recordings"),
    (RECORDINGS, ekf(BOTH), {}, "0 gains"),
    (RECORDINGS, ekf(BOTH), {"noise_variance": (0, 1)}, "smallest and a larg"),
    (RECORDINGS, ekf(BOTH), {"noise": (1e-3, 1)}, "has no gain noise"),
    (RECORDINGS, ibo(BOTH), {"gain": (1, 20)}, "claims no covariance"),
)
