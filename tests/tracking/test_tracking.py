"""An observer follows a recording as it was held, and is refused where it does not fit."""

import math
from dataclasses import replace

import numpy as np
import pytest
from examples import BOTH, NOISY, ONE, SURFACES, ZERO
from sample_sizes import slow_but

from percept_obs import (
    Camera,
    DoesNotFit,
    PerspectiveSystem,
    Recording,
    affine,
    chained,
    ekf,
    ibo,
    pinhole,
    plane,
    record,
    rigid,
    scenarios,
    smo,
    track,
)
from percept_obs.observers import equivariant_filter
from percept_obs.observers.extended_kalman import R

RECORDING = record(scenarios.ma2005_eq35(), 5)


def test_errors_estimates_and_metres_belong_together():
    run = track(RECORDING, ibo(BOTH), ZERO)
    np.testing.assert_allclose(run.error, run.truth - run.estimate)
    np.testing.assert_allclose(run.innovation, RECORDING.outputs - run.estimate[:, :2])
    np.testing.assert_allclose(
        run.points[-1], run.estimate[-1] @ np.diag([1, 1, 0]) / run.estimate[-1, 2] + [0, 0, run.distance[-1]]
    )
    assert np.isinf(run.distance[0])
    assert np.isinf(run.points[0]).all()
    assert run.time is RECORDING.time


def test_a_distance_is_infinite_only_where_the_estimate_is_finite_and_not_positive():
    estimate = np.array([[0.1, 0.2, 0.5], [0, 0, 0], [0, 0, -1], [0, 0, np.inf], [0, 0, np.nan], [np.nan, 0, 0.5]])
    recording = Recording(np.arange(6.0), np.zeros((6, 2)), ("y1", "y2"), pinhole(), RECORDING.motion)
    run = replace(track(recording, ibo(BOTH)), estimate=estimate)
    np.testing.assert_array_equal(run.distance, [2, np.inf, np.inf, np.nan, np.nan, 2])
    np.testing.assert_array_equal(run.points[:, 2], [2, np.inf, np.inf, np.nan, np.nan, np.nan])


def test_settling_time_is_when_the_error_stays_inside():
    run = track(RECORDING, ibo(BOTH), ZERO)
    settled = run.settling_time(0.05)
    relative = np.abs(run.distance / RECORDING.distance - 1)
    np.testing.assert_allclose(run.relative_error, relative, rtol=1e-12, atol=1e-15)
    absolute = np.abs(run.error[:, 2])
    for error, found in ((relative, settled), (absolute, run.settling_time(0.05, "y3"))):
        outside = error >= 0.05
        assert found == run.time[np.flatnonzero(outside)[-1] + 1]
    assert run.settling_time(10, "y3") == 0
    assert math.isinf(run.settling_time(1e-12))
    assert run.settling_time(0.05, "y1") < settled
    assert f"after {settled:.3g} s" in run.verdict(0.05)
    assert f"the error of y3 stays within 0.05 after {run.settling_time(0.05, 'y3'):.3g} s" in run.verdict(0.05, "y3")


def test_root_mean_square_over_a_part():
    run = track(RECORDING, ibo(BOTH), ZERO)
    part = (run.time >= 2) & (run.time <= 4)
    assert run.rms(2, 4) == pytest.approx(np.sqrt(np.mean(run.error[part, 2] ** 2)))
    with pytest.raises(ValueError, match="no sample with a truth lies between"):
        run.rms(90, 91)


def test_the_start_may_be_named_in_part():
    run = track(RECORDING, ibo(ONE), {"y3": 0.3})
    assert run.estimate[0].tolist() == [0.4, 0.0, 0.3]


def test_a_lost_sample_prolongs_the_hold():
    lost = RECORDING.outputs.copy()
    lost[10:12] = np.nan
    held = lost.copy()
    held[10:12] = lost[9]
    runs = [
        track(Recording(RECORDING.time, outputs, ("y1", "y2"), pinhole(), RECORDING.motion), ibo(BOTH), ZERO)
        for outputs in (lost, held)
    ]
    np.testing.assert_array_equal(runs[0].estimate, runs[1].estimate)
    assert np.isnan(runs[0].innovation[10:12]).all()


def test_a_lost_first_sample_is_refused_where_it_is_measured():
    lost = RECORDING.outputs.copy()
    lost[0, 1] = np.nan
    recording = replace(RECORDING, outputs=lost)
    with pytest.raises(DoesNotFit, match=r"first sample of y2 was lost.*recording.between"):
        track(recording, ibo(BOTH))
    assert track(recording, ibo(ONE)).diverged_at is None
    assert track(recording.between(0.005, 9), ibo(BOTH)).diverged_at is None


def test_a_point_must_be_seen_all_the_time():
    with pytest.raises(DoesNotFit, match="leave longest_hold out"):
        track(RECORDING, ibo(BOTH), longest_hold=1.0)


def test_where_the_truth_is_not_known_nothing_is_judged():
    truth = RECORDING.truth.copy()
    truth[:3], truth[-3:] = np.nan, np.nan
    whole, part = (track(replace(RECORDING, truth=t), ibo(BOTH)) for t in (RECORDING.truth, truth))
    assert part.settling_time() == pytest.approx(whole.settling_time(), abs=0.05)
    assert part.verdict() == whole.verdict()
    unknown = track(replace(RECORDING, truth=np.full_like(truth, np.nan)), ibo(BOTH))
    assert "no truth" in unknown.verdict()


def test_the_filter_does_not_use_a_lost_sample():
    lost = RECORDING.outputs.copy()
    lost[10:] = np.nan
    recording = Recording(RECORDING.time, lost, ("y1", "y2"), pinhole(), RECORDING.motion)
    run = track(recording, ekf(BOTH), ZERO)
    full = track(RECORDING, ekf(BOTH), ZERO)
    np.testing.assert_array_equal(run.estimate[:10], full.estimate[:10])
    assert run.covariance[-1, 0, 0] > 2 * full.covariance[-1, 0, 0]
    assert not np.allclose(run.estimate[-1], full.estimate[-1], atol=1e-12)


def test_a_filter_takes_the_noise_of_the_recording_unless_it_was_told_one():
    noisy = record(scenarios.ma2005_eq35(), 1, NOISY)
    for make in (ekf, equivariant_filter):
        assumed = [track(seen, make(BOTH)).observer.gain_values[R] for seen in (noisy, RECORDING)]
        assert assumed == [noisy.noise_variance, make(BOTH).gain_values[R]]
        told = make(BOTH, noise_variance=make(BOTH).gain_values[R])
        assert track(noisy, told).observer == told


def test_first_order_hold_is_better_and_exact_is_best():
    coarse = record(scenarios.ma2005_eq35(), 10, Camera(period=0.1))
    zero, first, exact = (track(coarse, ibo(BOTH), ZERO, hold=h).rms(5, 10) for h in ("zero", "first", "exact"))
    assert exact < first / 2
    assert first < zero / 10


def test_the_hold_does_not_change_a_filter_that_uses_samples_only():
    runs = [track(RECORDING, ekf(BOTH), ZERO, hold=h) for h in ("zero", "first", "exact")]
    assert all(np.array_equal(runs[0].estimate, run.estimate) for run in runs)


def test_a_wrong_belief_biases_the_estimate():
    wrong = affine(np.zeros((3, 3)), [0.5, 0.25, 0.3])
    assert track(RECORDING, ibo(BOTH), ZERO, believed=wrong).rms(3) > 10 * track(RECORDING, ibo(BOTH), ZERO).rms(3)


@pytest.mark.parametrize("name", slow_but("plane", "sphere", "unified beyond 1", among=SURFACES))
def test_observers_follow_on_every_surface(name):
    surface = SURFACES[name]
    system = PerspectiveSystem(affine(), surface)
    names = [s.name for s in surface.image_coordinates]
    recording = record(scenarios.ma2005_eq35(surface), 5, NOISY, seed=1)
    run = track(recording, ibo(system.measure(*names)))
    assert run.settling_time(0.05, "y3") < 4


def test_an_observer_for_any_plane_follows_on_one():
    recording = record(scenarios.ma2005_eq35(plane((0.1, 0.2, 1))), 5)
    system = PerspectiveSystem(affine(), plane())
    assert track(recording, ibo(system.measure("y1", "y2"))).settling_time() < 3


@pytest.mark.slow
@pytest.mark.parametrize("language", ["python", "numba"])
def test_a_run_that_diverges_says_when_and_why(language):
    blown = track(RECORDING, smo(BOTH, switching_gain=1e150, bound=1e160), ZERO, language=language)
    assert blown.diverged_at is not None
    assert f"diverged at {blown.diverged_at:.3g} s" in blown.verdict()
    first = int(np.searchsorted(blown.time, blown.diverged_at - 1e-9))
    assert np.isfinite(blown.estimate[:first]).all()
    assert np.isnan(blown.estimate[first:]).all()
    assert math.isinf(blown.settling_time())
    for metres in (blown.distance, blown.points):
        assert not np.isnan(metres[:first]).any()
        assert np.isnan(metres[first:]).all()


def test_resets_keep_the_estimate_within_the_bound_and_are_counted():
    run = track(RECORDING, ibo(BOTH, bound=0.5), ZERO)
    assert len(run.resets) > 0
    assert np.linalg.norm(run.estimate, axis=1).max() < 1.01 * 0.5 + 1e-9
    assert f"reset {len(run.resets)} times, first at {run.resets[0]:.3g} s" in run.verdict()


def test_without_truth_the_verdict_says_so():
    recording = Recording(RECORDING.time, RECORDING.outputs, ("y1", "y2"), pinhole(), RECORDING.motion)
    run = track(recording, ibo(BOTH), ZERO)
    assert "no truth to compare with" in repr(run)
    with pytest.raises(ValueError, match="has no truth"):
        run.error  # noqa: B018


def test_the_likelihood_is_that_of_a_normal_innovation():
    run = track(RECORDING, ekf(ONE, noise_variance=1e-4), ZERO)
    variance = run.nis[1:] * 1e-8 / run.innovation[1:, 0] ** 2  # S, for the residual is R / S of the innovation
    density = -(run.nis[1:] + np.log(2 * np.pi * variance)) / 2
    np.testing.assert_allclose(run.log_likelihood[1:], density, rtol=1e-6)


def test_the_claimed_covariance():
    run = track(RECORDING, ekf(ONE), ZERO)
    assert run.covariance.shape == (501, 3, 3)
    np.testing.assert_allclose(run.covariance, np.swapaxes(run.covariance, 1, 2))
    assert (np.linalg.eigvalsh(run.covariance) > 0).all()
    for wrong in (lambda r: r.covariance, lambda r: r.nis):
        with pytest.raises(ValueError, match="claims no covariance"):
            wrong(track(RECORDING, ibo(ONE), ZERO))


@pytest.mark.parametrize(
    ("observer", "arguments", "error", "message"),
    [
        (ibo(PerspectiveSystem(affine(), chained()).measure("y1")), {}, DoesNotFit, "made for the chained surface"),
        (ibo(PerspectiveSystem(rigid(), pinhole()).measure("y1")), {}, DoesNotFit, "same kind of motion"),
        (ibo(ONE), {"believed": affine()}, ValueError, "no values for a11"),
        (ibo(ONE), {"believed": rigid(point_velocity=[0] * 3)}, DoesNotFit, "same kind of motion"),
        (ibo(ONE), {"step": 0.0}, ValueError, "must be positive"),
        (ibo(ONE), {"start": (0, 0)}, ValueError, "expected 3: y1, y2, y3"),
        (ibo(ONE), {"start": (0, 0, np.nan)}, ValueError, "no finite value for y3"),
        (ibo(ONE), {"start": {"z": 1}}, ValueError, "no coordinate z"),
    ],
)
def test_what_does_not_fit_is_refused(observer, arguments, error, message):
    with pytest.raises(error, match=message):
        track(RECORDING, observer, **arguments)


def test_a_recording_with_too_few_outputs_is_refused():
    one = Recording(RECORDING.time, RECORDING.outputs[:, :1], ("y1",), pinhole(), RECORDING.motion)
    with pytest.raises(DoesNotFit, match=r"the recording has only y1; measure less: system.measure\('y1'\)"):
        track(one, ibo(BOTH))
    with pytest.raises(DoesNotFit, match="known in simulations only"):
        track(one, ibo(ONE), hold="exact")


@pytest.mark.parametrize("call", [lambda r: r.settling_time(0), lambda r: r.settling_time(0.1, "y9")])
def test_questions_that_make_no_sense_are_refused(call):
    with pytest.raises(ValueError, match=r"must be positive|no coordinate y9"):
        call(track(RECORDING, ibo(ONE), ZERO))
