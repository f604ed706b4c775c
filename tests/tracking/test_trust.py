"""Estimates that cannot be right are flagged without a truth, and good ones are not."""

from dataclasses import replace

import numpy as np
import pytest
from diagnosis_study import drawn as diagnosed
from diagnosis_study import spoiled
from distrust_study import FORM, RIGHT, WRONG, drawn, flagged, judged
from sample_sizes import sampled
from trust_study import POSES, blindly, posed, shares, trusted_with

from percept_obs import Camera, Gaussian, Scenario, ekf, pinhole, record, rigid, track
from percept_obs.observers import OBSERVERS
from percept_obs.recording.utias import UTIAS_CUT, load_utias
from percept_obs.tracking.verdict import percent

STILL = (0.0, 0.0, 0.0)
FILTER = ekf(FORM, noise_variance=4e-6, hidden_variance=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("make", OBSERVERS, ids=lambda make: make.key)
def test_what_cannot_be_right_is_flagged_and_good_ones_are_not(make):
    """100 of each with ALL_SAMPLES=1; of few, none may be right of an observer that rarely is."""
    count = sampled(1, 100)
    for kind in WRONG:
        assert flagged(make, kind, count)[0] >= 0.95, kind
    share, counted = flagged(make, "good", count)
    assert counted >= sampled(0, 1)
    assert not share > 0.05


@pytest.mark.slow
def test_an_object_that_moves_is_not_trusted_and_a_good_estimate_is():
    assert not judged(OBSERVERS[2], 0, "moving object")[1].trusted
    error, good = judged(OBSERVERS[2], 1, "good")
    assert error < RIGHT
    assert good.trusted


def test_a_longer_window_that_tells_something_else_is_said():
    recording, _ = drawn(1, "good")
    run = track(recording, FILTER, {"y3": 0.3})
    found = run.information
    assert 1 <= len(found.longer) <= 3
    known = recording.motion.known(recording.time[-1:])
    assert found.disagreement(run.view, known) < 0.05
    (other, *_) = found.longer
    far = replace(other, estimate=other.estimate * [1, 1, 2], deviation=0.01)
    apart = replace(found, longer=(far,)).disagreement(run.view, known)
    assert apart == pytest.approx(0.5, abs=0.03)
    lost = replace(other, deviation=np.inf)
    assert replace(found, longer=(lost,)).disagreement(run.view, known) == np.inf


@pytest.mark.slow
def test_a_pause_is_not_trusted_and_what_was_known_before_it_is():
    motion = rigid(camera_velocity=lambda t: [0.4 * max(0, -np.cos(t)), 0, 0])  # it stands for 1.6 s first
    seen = record(Scenario("paused", motion, (0.6, 0.2, 3), 4, pinhole()), camera=Camera(0.05, Gaussian(0.002)), seed=1)
    for whole in (seen, replace(seen, truth=None, signal=None)):
        early, late = (track(whole.between(0, end), FILTER, {"y3": 0.25}).trust() for end in (1.5, 4.0))
        assert not early.trusted
        assert early.information.unexcited == pytest.approx(1.5, abs=0.06)
        assert late.trusted


@pytest.mark.slow
@pytest.mark.night(reason="shares of 400 runs")
def test_with_errors_of_the_poses_few_wrong_ones_are_trusted_and_most_right_ones_are():
    """Of all observers and outputs; noise of the velocities that nobody told costs trust, as `Run.trust` says."""
    found = {poses: [trusted_with(seed, poses) for seed in range(200, 300)] for poses in POSES}
    for noisy, missed in ((True, 0.67), (False, 0.05)):
        some = [run for poses, runs in found.items() for run in runs if (poses == "noisy") is noisy]
        right = sum(error <= RIGHT for error, _ in some)
        for share, most, count in zip(shares(some), (0.01, 0.05, missed), (len(some), len(some), right), strict=True):
            assert share <= most + 2 * np.sqrt(most * (1 - most) / count)  # by chance


@pytest.mark.slow
def test_what_is_left_of_the_samples_is_flagged_where_it_may_move_the_distance():
    """Axes of the poses that are wrong by a degree, and a focal length that is wrong by a tenth."""
    error, little = trusted_with(207, "crooked")
    assert error < 0.01
    assert 0 < little.information.left < 0.1
    assert little.trusted
    clean, draw = diagnosed(3)
    short = spoiled(clean, ["focal length"], draw)[3]
    run = track(short, FILTER.with_gains(noise_variance=short.noise_variance), {"y3": 0.3})
    assert abs(run.distance[-1] / clean[3].distance[-1] - 1) > 0.15
    assert run.trust().kind == "unexplained"
    assert f"may move the distance by {percent(run.information.left)}" in str(run.trust())


@pytest.mark.night(reason="shares of 294 runs on real tracks")
@pytest.mark.slow
def test_on_real_tracks_few_wrong_ones_are_trusted():
    start = {"y3": 1 / 1.8}
    observer = ekf(FORM, noise_variance=7e-6, turning_noise=3.5e-4, measured_variance=1e-4, hidden_variance=1)
    tracks = load_utias(UTIAS_CUT)
    parts = [each.between(each.time[0], each.time[0] + length) for each in tracks for length in (1, 2, 3)]
    far_off, off, _ = shares([blindly(track(part, observer, start, language="numba")) for part in parts])
    assert far_off <= 0.01
    assert off <= 0.05


def test_a_scale_that_drifts_and_a_claim_that_is_wide_are_told():
    recording, known, _ = posed(0, "drifting")
    observer = FILTER.with_gains(noise_variance=recording.noise_variance)
    error, drifting = blindly(track(recording, observer, {"y3": 0.3}, believed=known), motion=known)
    assert error > 0.2
    assert drifting.kind == "drifting"
    assert drifting.disagreement > 0.2
    assert "the length of your translation drifts by" in str(drifting)
    good = blindly(track(recording, observer, {"y3": 0.3}))[1]
    assert good.kind == "agrees"
    assert str(good).endswith("; this rests on the length of your translation.")
    unsure = observer.with_gains(velocity_noise=0.1)
    wide = blindly(track(recording, unsure, {"y3": 0.3}))[1]
    assert wide.kind == "wide"
    assert 2 * wide.claimed > 0.1
    assert "is not sure enough of the distance" in wide.sentence
