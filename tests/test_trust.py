"""Estimates that cannot be right are flagged without a truth, good ones are not, and a picture says when."""

from dataclasses import replace

import numpy as np
import pytest
from distrust_study import FORM, RIGHT, WRONG, drawn, flagged, judged
from sample_sizes import sampled
from trust_study import POSES, blindly, posed, shares, trusted_with

from percept_obs import Camera, Gaussian, Scenario, ekf, pinhole, record, rigid, track
from percept_obs.figures import trust
from percept_obs.observers import OBSERVERS
from percept_obs.recording.utias import UTIAS_CUT, load_utias
from percept_obs.studies.trust import trust_over_time

STILL = (0.0, 0.0, 0.0)
FILTER = ekf(FORM, noise_variance=4e-6, hidden_variance=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("make", sampled(OBSERVERS[2:3], OBSERVERS), ids=lambda make: make.key)
def test_what_cannot_be_right_is_flagged_and_good_ones_are_not(make):
    """100 of each for every observer with ALL_SAMPLES=1."""
    count = sampled(3, 100)
    for kind in WRONG:
        assert flagged(make, kind, count)[0] >= 0.95, kind
    share, counted = flagged(make, "good", count)
    assert counted
    assert share <= 0.05


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


def paused(truth=True):
    """A camera that stands for 1.6 s and then moves."""
    motion = rigid(camera_velocity=lambda t: [0.4 * max(0, -np.cos(t)), 0, 0])
    seen = record(Scenario("paused", motion, (0.6, 0.2, 3), 4, pinhole()), camera=Camera(0.05, Gaussian(0.002)), seed=1)
    return seen if truth else replace(seen, truth=None, signal=None)


@pytest.mark.slow
def test_a_pause_is_shaded_and_not_trusted():
    found = trust_over_time(track(paused(), FILTER, {"y3": 0.25}), count=6)
    assert not found.trusted[0]
    assert found.unexcited[0] == pytest.approx(found.time[0], abs=0.06)
    assert found.trusted[-1]
    assert found.distance[-1] == pytest.approx(3, rel=0.1)
    assert np.isnan(found.distance[0])
    drawn_trust = trust(found)
    assert found.sentence in drawn_trust.text
    assert len(drawn_trust.axes[0].collections) >= 2
    blind = trust_over_time(track(paused(truth=False), FILTER, {"y3": 0.25}), count=6)
    np.testing.assert_array_equal(blind.trusted, found.trusted)
    assert "truth" not in [line.get_label() for line in trust(blind).axes[0].lines]


def test_it_says_what_was_known_then():
    """Later samples change nothing."""
    run = track(paused(), FILTER, {"y3": 0.25})
    early = trust_over_time(track(paused().between(0, run.time[50]), FILTER, {"y3": 0.25}), count=1)
    whole = trust_over_time(run, count=3)
    assert whole.index.tolist() == [20, 50, 80]
    assert str(early.trusts[0]) == str(whole.trusts[1])


def test_what_makes_no_sense_is_refused():
    run = track(paused(), FILTER)
    for ask, message in (
        (lambda: trust_over_time(run, count=0), "count is 0"),
        (lambda: trust_over_time(run, tolerance=0), "must be positive"),
        (lambda: trust_over_time(track(paused().between(0, 1), FILTER)), "40 are needed"),
        (lambda: trust(run), "expected a TrustOverTime"),
    ):
        with pytest.raises(ValueError, match=message):
            ask()


@pytest.mark.slow
def test_with_errors_of_the_poses_few_wrong_ones_are_trusted_and_most_right_ones_are():
    """400 runs with ALL_SAMPLES=1, of all observers and outputs; two deviations of chance are allowed."""
    found = [trusted_with(seed, poses) for poses in POSES for seed in range(200, 200 + sampled(8, 100))]
    right = sum(error <= RIGHT for error, _ in found)
    for share, most, count in zip(shares(found), (0.01, 0.05, 0.15), (len(found), len(found), right), strict=True):
        assert share <= most + 2 * np.sqrt(most * (1 - most) / count)


@pytest.mark.slow
def test_on_real_tracks_few_wrong_ones_are_trusted():
    start = {"y3": 1 / 1.8}
    observer = ekf(FORM, noise_variance=7e-6, turning_noise=3.5e-4, measured_variance=1e-4, hidden_variance=1)
    tracks = load_utias(UTIAS_CUT)[:: sampled(4, 1)]
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
