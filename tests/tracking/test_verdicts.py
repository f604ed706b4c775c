"""Verdicts on runs are true, whatever the unit of length, the clock and the observer, with a truth or without."""

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
from examples import BOTH, NOISE, NOISY, ONE, OTHER, ZERO
from hypothesis import given
from hypothesis import strategies as st
from sample_sizes import sampled
from trust_study import figures

from percept_obs import (
    Camera,
    FirstSight,
    Gaussian,
    Motion,
    Recording,
    Scenario,
    StructureAndMotion,
    Uniform,
    affine,
    check_consistency,
    ekf,
    ibo,
    luenberger,
    pinhole,
    record,
    rigid,
    scenarios,
    smo,
    track,
    windowed,
)
from percept_obs.observers import OBSERVERS, linear_approximation, range_identification
from percept_obs.points import constant, riccati
from percept_obs.points.scenarios import moving_body
from percept_obs.recording import Unlikely
from percept_obs.structure import ScaledDepthCamera
from percept_obs.structure.scenarios import chwa2019_simulation
from percept_obs.studies.all_observers import all_observers
from percept_obs.studies.comparison import compare, relative_distance_errors
from percept_obs.studies.least_squares import moving_window_least_squares
from percept_obs.studies.tuning import best_setting
from percept_obs.system.signal import Signal
from percept_obs.tracking.following import StepTooLong
from percept_obs.tracking.verdict import SETTLED_PART, TOLERANCE, outcome

REST = Scenario("at rest", affine(np.zeros((3, 3)), [0, 0, 0]), (1, 2, 30), 5, pinhole())
SLOW = Scenario("1 mm/s", affine(np.zeros((3, 3)), [1e-3, 0, 0]), (1, 2, 5), 5, pinhole())
EXACT = 1 / 128
"""A period in seconds that every clock knows without rounding."""


def blind(recording):
    return replace(recording, truth=None)


def shifted(recording, seconds):
    """Return a recording by a clock that shows so many seconds more."""
    signal, motion = recording.motion.signal, recording.motion
    if callable(signal.samples):
        moved = Signal(lambda time: signal.samples(time - seconds))
    else:
        moved = signal if signal.times is None else Signal(signal.samples, signal.times + seconds)
    exact = recording.signal and (lambda times: recording.signal(np.asarray(times) - seconds))
    motion = Motion(motion.name, motion.A, motion.b, motion.parameters, moved)
    return replace(recording, time=recording.time + seconds, motion=motion, signal=exact)


def test_an_observer_that_is_switched_off_has_not_converged():
    off = track(record(scenarios.ma2005_eq36(), 40), ibo(BOTH, gain=1e-300, bound=1e-9), ZERO)
    assert off.settling_time(0.05, "y3") < 40  # what the absolute error of 1/Z says of a point that goes far away
    assert not off.outcome().converged
    assert off.outcome().kind in ("outside", "behind")


@pytest.mark.slow
def test_a_point_far_away_before_a_camera_at_rest_is_not_found():
    recording = record(REST)
    for make in OBSERVERS:
        observer = make(BOTH)
        for start in (None, {"y3": 0.1}):
            assert not track(recording, observer, start).outcome().converged, make.key


def test_a_wrong_scale_of_the_motion_is_not_converged():
    scenario = scenarios.ma2005_eq35()
    values = scenario.motion.values
    A, b = (np.array(block.subs(values), dtype=float) for block in (scenario.motion.A, scenario.motion.b))
    run = track(record(scenario, 20), ibo(BOTH), believed=affine(A, 1.5 * b.ravel()))
    assert run.outcome().kind == "outside"
    assert run.relative_error[-1] == pytest.approx(0.5, abs=0.02)
    assert "not converged: the relative error of the distance ends at" in run.verdict()


@given(st.integers(2, 60), st.integers(0, 59), st.sampled_from([np.inf, np.nan, 0.2]))
def test_one_rule_says_when_an_error_has_converged(count, last, wrong):
    """The last tenth must be inside, so that a run that is cut at its first sample inside is late."""
    elapsed = np.arange(count) / 4
    error = np.where(np.arange(count) <= last, wrong, 0.01)
    found = outcome(elapsed, error, TOLERANCE, elapsed[-1])
    if last >= count - 1:
        assert found.kind == {np.inf: "behind", 0.2: "outside"}.get(wrong, "none")
        assert np.isinf(found.settled)
    else:
        assert found.settled == elapsed[last + 1]
        assert found.converged == (elapsed[-1] - found.settled >= SETTLED_PART * elapsed[-1])
    if last == count - 2:
        assert found.kind == "late"


def test_runs_that_are_cut_at_their_first_sample_inside_are_late_in_every_table():
    recording = record(scenarios.ma2005_eq35(), 5)
    settled = track(recording, ibo(BOTH), ZERO).settling_time()
    cut = recording.between(0, settled + 1e-6)
    run = track(cut, ibo(BOTH), ZERO)
    assert run.outcome().kind == "late"
    assert f"until {settled:.3g} s" in run.verdict()
    assert compare([cut], [ibo(BOTH)], ZERO).table["outcome"].tolist() == ["late"]


@pytest.mark.slow
def test_points_are_judged_where_they_are_and_structure_by_all_that_is_sought():
    points = record(moving_body(2), 10, Camera(0.05), seed=1)
    run = track(points, luenberger(points.view, riccati(1.0, 0.3)), FirstSight(1.5))
    true, found = (run.view.locate(x) for x in (run.truth, run.estimate))
    shares = np.linalg.norm(found - true, axis=-1) / np.linalg.norm(true, axis=-1)
    np.testing.assert_allclose(run.relative_error, shares.max(axis=1))
    seen = record(chwa2019_simulation("IV.A"), 1, ScaledDepthCamera(period=0.01))
    run = track(seen, ekf(seen.view.form, hidden_variance=100.0))
    true, found = (run.view.quantities(x[:, 3:]) for x in (run.truth, run.estimate))
    velocities = chwa2019_simulation("IV.A").motion.known(seen.time)[:, 3:]
    speed = np.linalg.norm(velocities[:, 3:] - velocities[:, :3], axis=1).max()
    with np.errstate(invalid="ignore"):
        shares = [np.abs(run.distance / seen.distance - 1)]
        shares += [np.abs(found[name] - true[name]) / speed for name in ("v_c2", "v_c3")]
        expected = np.where(np.isinf(shares[0]), np.inf, np.max(shares, axis=0))
    late = slice(20, None)
    np.testing.assert_allclose(run.relative_error[late], expected[late], rtol=1e-6)
    assert isinstance(run.view, StructureAndMotion)
    assert run.view.judged == "the distance, v_c2, v_c3"


@pytest.mark.parametrize("begin", [100.0, 1.7e9])
def test_people_are_told_times_since_the_beginning_by_any_clock(begin):
    here = record(scenarios.ma2005_eq35(), 5, Camera(0.01), seed=1)
    there = shifted(here, begin)
    for observer in (
        smo(BOTH, switching_gain=1e150, bound=1e160),
        ibo(BOTH, bound=0.5),
        ibo(BOTH),
        range_identification(BOTH, largest_amplification=3),
    ):
        words = [re.sub(r"-?[\d.]+(e[+-]?\d+)?", "#", track(r, observer, ZERO).verdict()) for r in (here, there)]
        assert words[0] == words[1]
        numbers = [
            [float(x) for x in re.findall(r"(\d[\d.]*) s\b", track(r, observer, ZERO).verdict())] for r in (here, there)
        ]
        np.testing.assert_allclose(*numbers, atol=0.011)
    tables = [compare([r], [ibo(BOTH)], ZERO, after=2).table for r in (here, there)]
    for column in ("settling_time", "rms", "worst"):
        np.testing.assert_allclose(*(table[column] for table in tables), rtol=1e-3, atol=0.011)
    runs = [track(r, ekf(BOTH), ZERO) for r in (here, there)]
    assert [len(check_consistency(run, after=2.0).nis) for run in runs] == [301, 301]
    assert len(relative_distance_errors(runs, 5.0)) == 2
    ends = [windowed(BOTH, r, 2.0).time - r.time[0] for r in (here, there)]
    np.testing.assert_allclose(*ends, atol=1e-6)


@pytest.mark.parametrize("begin", [0.0, 100.0, 1.7e9])
def test_motion_that_is_asked_for_too_early_is_refused_by_any_clock(begin):
    times = begin + 0.01 * np.arange(101)
    signal = Signal(np.zeros((101, 1)), times)
    signal.at([times[0] - 5e-7, times[-1] + 5e-7])
    for wrong in (times[0] - 0.5, times[-1] + 0.5, times[0] - 1e-3):
        with pytest.raises(ValueError, match="sample it longer or ask for less"):
            signal.at([wrong])


@pytest.mark.slow
def test_a_start_from_the_first_sample_is_as_uncertain_as_the_sample():
    """The normalised error squared is 1 an output at the start, and no innovation is counted twice."""
    sigma, errors, second = 0.01, [], []
    scenario, camera = scenarios.ma2005_eq35(), Camera(0.05, Gaussian(sigma))
    observer = ekf(BOTH, noise_variance=sigma**2, measured_variance=sigma**2, hidden_variance=1e-6)
    for seed in range(300):
        recording = record(scenario, 0.1, camera, seed)
        run = track(recording, observer, {"y3": recording.truth[0, 2]}, language="python")
        off, claimed = run.error[0, :2], run.covariance[0, :2, :2]
        errors.append(off @ np.linalg.solve(claimed, off))
        assert np.isnan(run.nis[0])
        second.append(run.nis[1])
    assert np.mean(errors) == pytest.approx(2, abs=3 * 2 / np.sqrt(300))
    assert np.mean(second) == pytest.approx(2, abs=3 * 2 / np.sqrt(300))


def test_a_given_start_is_corrected_by_the_first_sample():
    recording = record(scenarios.ma2005_eq35(), 1, NOISY, seed=1)
    run = track(recording, ekf(BOTH, measured_variance=1.0), (0.0, 0.0, 0.3))
    assert np.isfinite(run.nis[0])
    np.testing.assert_allclose(run.estimate[0, :2], recording.outputs[0], atol=1e-4)


def test_excitation_takes_the_truth_by_its_own_names():
    """A recording may name its outputs in any order, or only some of them."""
    whole = record(scenarios.ma2005_eq35(), 5)
    turned = replace(whole, outputs=whole.outputs[:, ::-1], names=("y2", "y1"), signal=None)
    only = replace(whole, outputs=whole.outputs[:, 1:], names=("y2",), signal=None)
    assert windowed(BOTH, turned, 2.0).least == pytest.approx(windowed(BOTH, whole, 2.0).least, rel=1e-12)
    assert windowed(OTHER, only, 2.0).least == pytest.approx(windowed(OTHER, whole, 2.0).least, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("camera", [Camera(0.05), Camera(0.05, NOISE)], ids=["exact", "noisy"])
@pytest.mark.parametrize("make", OBSERVERS, ids=lambda make: make.key)
def test_without_a_truth_no_observer_is_trusted_before_a_camera_at_rest(make, camera):
    observer, recording = make(BOTH), blind(record(REST, camera=camera, seed=0))
    for start in (None, {"y3": 0.1}):
        run = track(recording, observer, start)
        assert not run.trust().trusted
        assert re.search("do not trust|not observable yet", run.verdict())


@pytest.mark.slow
def test_without_a_truth_nobody_is_trusted_at_a_millimetre_a_second():
    recording = blind(record(SLOW, camera=NOISY, seed=0))
    for make in OBSERVERS:
        assert not track(recording, make(BOTH), {"y3": 0.1}).trust().trusted, make.key
    run = track(recording, ibo(BOTH), {"y3": 0.1})
    assert run.trust().kind == "vague"
    assert "hardly excited since" in run.verdict()


def test_a_camera_at_rest_tells_nothing_since_the_first_sample_whatever_the_clock():
    run = track(blind(shifted(record(REST, 2, Camera(0.1)), 100)), ibo(BOTH), {"y3": 0.1})
    assert run.trust().sentence.endswith("tell nothing of the distance, hardly excited since 0 s.")


def test_least_squares_near_the_focus_of_expansion_are_not_trusted():
    """43 pixels of 500 from the direction of travel, half a pixel of noise: half of the distance is guessed."""
    toward = Scenario("towards", affine(np.zeros((3, 3)), [0, 0, -1]), (43 / 500 * 30, 0, 30), 2, pinhole())
    recording = blind(record(toward, camera=Camera(0.1, Gaussian(1 / 500)), seed=3))
    trust = moving_window_least_squares(recording).trust()
    assert not trust.trusted
    assert trust.information is None or 2 * trust.information.deviation > TOLERANCE


@pytest.mark.slow
def test_a_good_estimate_is_trusted_for_points_and_structure_too():
    points = blind(record(moving_body(2), 15, Camera(0.05, Uniform(0.001)), seed=1))
    good, bad = (
        track(points, luenberger(points.view, P), FirstSight(1.5)) for P in (riccati(1.0, 0.3), constant(30.0))
    )
    assert good.trust().trusted
    assert not bad.trust().trusted
    seen = blind(record(chwa2019_simulation("IV.A"), 1, ScaledDepthCamera(period=0.01)))
    observer = ekf(seen.view.form, noise_variance=1e-7, hidden_process_noise=1.0, hidden_variance=100.0)
    assert track(seen, observer).trust().kind == "wide"  # hidden velocities that wander so much are never known well
    run = track(seen, observer.with_gains(hidden_process_noise=1e-4))
    assert run.trust().trusted
    assert run.trust().claimed > 0
    assert "(2σ)" in run.verdict()


@pytest.mark.slow
def test_trust_is_right_without_a_truth():
    """In 200 runs with ALL_SAMPLES=1; of 15 % false alarms two deviations of chance are allowed."""
    count = sampled(16, 200)
    missed, alarms, wrong, right = figures(range(count))
    assert missed <= 0.03
    assert alarms <= 0.15 + 2 * np.sqrt(0.15 * 0.85 / right)
    assert wrong > count / 4
    assert right > count / 4


def follow(recording, observer):
    return track(recording, observer, ZERO)


def test_gains_are_chosen_by_a_reference_and_short_recordings_do_not_count():
    recordings = [record(scenarios.ma2005_eq35(), 3, replace(NOISY, period=0.05), seed) for seed in range(4)]
    sonar = [replace(r, truth=None, distances={"sonar": r.distance}) for r in recordings]
    short = sonar[0].between(0, 0.5)
    candidates = {ibo: ({"gain": 5}, {"gain": 10}, {"gain": 20})}
    settings = {"references": ("sonar",), "after": (1.0,), "start": {"y3": 0.0}}
    found = all_observers(sonar[2:], choosing=[sonar[0], short], candidates=candidates, **settings)
    assert np.isfinite(found.table["sonar 1 s"]).all()
    remark = found.side_by_side.loc["identifier-based", "remark"]
    assert ("at the edge of what was tried: gain" in remark) == (found.table["at_edge"].iloc[0] == "gain")
    with pytest.raises(ValueError, match="0 observers"):
        best_setting(recordings, [], follow)
    with pytest.raises(ValueError, match="0 recordings"):
        best_setting([], [ibo(BOTH)], follow)


def test_what_makes_no_sense_is_refused():
    run = track(record(scenarios.ma2005_eq35(), 1), ibo(ONE))
    for wrong in (0, -1):
        for ask in (run.outcome, run.trust, run.verdict):
            with pytest.raises(ValueError, match="tolerance is"):
                ask(wrong)
    for length in (0, -1, np.inf):
        with pytest.raises(ValueError, match="unit of length"):
            replace(run.recording, unit=length)
    recording = Recording(run.time, run.recording.outputs, ("y1", "y2"), pinhole(), run.recording.motion)
    with pytest.raises(ValueError, match="no truth"):
        track(recording, ibo(ONE)).outcome()


def test_pixels_and_a_hole_in_the_motion_are_noticed():
    recording = record(scenarios.ma2005_eq35(), 5)
    with pytest.warns(Unlikely, match="are they pixels"):
        replace(recording, outputs=600 + 500 * recording.outputs, signal=None, truth=None)
    times = np.linspace(0, 5, 101)
    times = times[(times < 2) | (times > 3.5)]
    zero = np.zeros(3)
    with pytest.warns(Unlikely, match=r"between 1.95 and 3.55 s after the first sample the motion was not sampled"):
        replace(recording, motion=rigid(camera_angular_velocity=np.tile(zero, (len(times), 1)), times=times))


@pytest.mark.parametrize(("weight", "resolved"), [(0.0025, False), (0.0055, False), (0.006, True), (0.02, True)])
def test_a_cascade_that_a_step_does_not_resolve_says_so(weight, resolved):
    """Its gain begins at P0 / R; the loop blows up where that is more than the step can follow."""
    recording, observer = record(scenarios.ma2005_eq35(), 1), linear_approximation(BOTH, process_weight=0)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        run = track(recording, observer.with_gains(measurement_weight=weight))
    assert (run.diverged_at is None) == resolved
    assert [each.category for each in caught] == ([] if resolved else [StepTooLong])
