"""Simulated pictures of an object: its scaled inverse depth, with what noise, bias and drift do to the estimates."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from examples import NOISE
from refusals import refuses

from percept_obs import (
    BehindCamera,
    DoesNotFit,
    PerspectiveSystem,
    Recording,
    affine,
    pinhole,
    record,
    rigid,
    scenarios,
    track,
)
from percept_obs.observers import OBSERVERS, NeedsMotion, NotIntegrable, ekf, immersion_and_invariance, ismo
from percept_obs.recording.pixels import PixelCamera
from percept_obs.structure import (
    COROLLARIES,
    GivenDepth,
    ImpossibleChoice,
    LinearView,
    PatchDepth,
    ScaledDepthCamera,
    StructureAndMotion,
    grid_patch,
    linear_view,
    seen_as,
)
from percept_obs.structure.pixels import CHWA_CAMERA, SignalToNoise
from percept_obs.structure.scenarios import chwa2019_experiment, chwa2019_simulation
from percept_obs.studies.least_squares import moving_window_least_squares

CASE = chwa2019_experiment("IV.A")
STILL = (0.0, 0.0, 0.0)
W = (0.1, -0.2, 0.3)


def late_scale(recording, **gains):
    run = track(recording, ismo(recording.view.form, **gains), hold="first", step=1e-3, language="python")
    return run.estimate[recording.time >= 2, 3]


def test_a_recording_of_a_choice_holds_what_it_may_know():
    recording = record(CASE, 1)
    assert recording.names == ("y1", "y2", "ybar3")
    assert recording.truth.shape == (1001, 6)
    np.testing.assert_allclose(recording.truth[:, 3:], [[10.4, -0.23 * 10.4, 0]] * 1001)
    # of the motion, the unknown velocities are not there
    assert [s.name for s in recording.motion.parameters] == ["w_c1", "w_c2", "w_c3", "v_c1"]
    np.testing.assert_allclose(recording.truth[0, :3], [0.32, 0.30, 0.05])
    np.testing.assert_allclose(recording.points[0], np.array([0.32, 0.30, 1]) / 0.52)
    known = record(chwa2019_experiment("VI.B"), 1)
    assert known.view.scale == 10.4
    np.testing.assert_allclose(known.truth[0, 3:], [0, -0.22, -0.23])


@pytest.mark.slow
@pytest.mark.parametrize("make", OBSERVERS, ids=lambda make: make.__name__)
def test_every_observer_runs_on_the_form_as_it_is(make):
    recording = record(CASE, 1, ScaledDepthCamera(period=0.01))
    views = [recording, linear_view(recording)]
    if make is immersion_and_invariance:
        with pytest.raises(NotIntegrable, match="w has no potential"):
            make(views.pop(0).view.form)
    for seen in views:
        if isinstance(make.objection(seen.view.form), NeedsMotion):  # one point's motion is not all of this form
            continue
        run = track(seen, make(seen.view.form), language="python")
        assert np.isfinite(run.estimate[run.unobservable == 0]).all()
        assert run.unobservable[-1] == 0


@pytest.mark.slow
@pytest.mark.parametrize("angular_velocity", [STILL, W], ids=["w = 0", "w"])
@pytest.mark.parametrize("tilt", [(0, 0), (0.3, -0.2)], ids=["facing", "tilted"])
def test_the_homography_gives_the_scaled_inverse_depth(angular_velocity, tilt):
    setup = chwa2019_simulation("V.A", angular_velocity)
    patch = grid_patch(0.4) + np.outer(grid_patch(0.4)[:, :2] @ tilt, [0, 0, 1])
    recording = record(setup, 2, ScaledDepthCamera(depth=PatchDepth(patch)))
    np.testing.assert_allclose(recording.outputs, recording.truth[:, :3], rtol=1e-9)


def test_noise_in_pixels_and_as_a_ratio():
    recording = record(CASE, 10, ScaledDepthCamera(pixels=CHWA_CAMERA, ratio=SignalToNoise(100)), seed=1)
    error = (recording.outputs - recording.truth[:, :3])[:, :2] * 720
    assert error.std() == pytest.approx(0.0096, rel=0.02)
    assert recording.noise_variance == pytest.approx((0.0096 / 720) ** 2, rel=0.02)
    in_pixels = record(CASE, 10, ScaledDepthCamera(1e-3, NOISE, pixels=CHWA_CAMERA), seed=1)
    assert (in_pixels.outputs - in_pixels.truth[:, :3])[:, :2].std() == pytest.approx(0.01 / 3**0.5 / 720, rel=0.02)
    again = record(CASE, 10, ScaledDepthCamera(pixels=CHWA_CAMERA, ratio=SignalToNoise(100)), seed=1)
    np.testing.assert_array_equal(again.outputs, recording.outputs)


def test_pictures_without_the_object_are_lost():
    small = PixelCamera(CHWA_CAMERA.focal, CHWA_CAMERA.centre, (640, 480))
    recording = record(CASE, 1, ScaledDepthCamera(pixels=small))
    lost = np.isnan(recording.outputs).all(axis=1)
    assert not lost[:200].any()
    assert lost[300:].all()
    dropped = record(CASE, 1, ScaledDepthCamera(1e-3, dropout=0.3), seed=2)
    assert np.isnan(dropped.outputs[:, 0]).mean() == pytest.approx(0.3, abs=0.05)
    with pytest.raises(ValueError, match="outside the first picture"):
        record(chwa2019_simulation("V.A"), 1, ScaledDepthCamera(pixels=small))


def test_bias_and_drift_do_what_the_sensitivity_says():
    choice = CASE.choice
    derivatives = choice.sensitivity()
    for errors in ({"bias": 1e-4}, {"drift": 1e-5}):
        recording = record(CASE, 4, ScaledDepthCamera(depth=GivenDepth(**errors)))
        change = errors.get("bias", 0.0) + errors.get("drift", 0.0) * 4.0, errors.get("drift", 0.0)
        at = dict(zip(choice.form.coordinates, recording.truth[-1], strict=True))
        at |= dict(zip(choice.form.parameters, recording.motion.known(4.0)[0], strict=True))
        predicted = np.array(derivatives.subs(at) * sp.Matrix(change), dtype=float).ravel()
        found = late_scale(recording)[-1] - 10.4
        assert abs(predicted[0]) > 0.01
        assert found == pytest.approx(predicted[0], rel=0.05)


def test_a_constant_factor_of_the_inverse_depth_is_another_scale():
    """Twice ybar3 is half of d_s, and no velocity changes."""
    doubled = replace(CASE, scale=5.2)
    recording = record(doubled, 3)
    run = track(recording, ismo(CASE.choice.form), hold="first", step=1e-3)
    found = CASE.choice.quantities(run.estimate[-1, 3:])
    assert found["d_s"] == pytest.approx(5.2, rel=1e-3)
    assert found["v_c2"] == pytest.approx(-0.23, abs=1e-4)


@pytest.mark.slow
def test_noise_of_the_inverse_depth_in_proportion():
    spread = [
        late_scale(record(CASE, 4, ScaledDepthCamera(depth=GivenDepth(noise=type(NOISE)(bound))), seed=3)).std()
        for bound in (1e-7, 1e-6)
    ]
    assert spread[1] == pytest.approx(10 * spread[0], rel=0.05)
    assert spread[0] > 1e-3


def test_fewer_unknowns_are_found_in_the_least_squares_sense():
    choice = StructureAndMotion(("d_s", "v_c2"), ("v_p1", "v_p2", "v_p3"))
    recording = record(replace(CASE, choice=choice), 2)
    run = track(recording, ismo(choice.form), hold="first", step=1e-3)
    np.testing.assert_allclose(run.estimate[-1, 3:], [10.4, -0.23 * 10.4], rtol=1e-3)


def test_seen_as_another_choice():
    recording = record(chwa2019_experiment("IV.B"), 1)
    fifth = COROLLARIES[4].choice(scale=10.4)
    motion = chwa2019_experiment("IV.B").motion
    again = seen_as(recording, fifth, motion, 10.4)
    np.testing.assert_array_equal(again.outputs, recording.outputs)
    np.testing.assert_allclose(again.truth[:, 3:], [[-0.22, -0.23, 0]] * 1001)
    assert seen_as(recording, fifth, motion).truth is None
    with pytest.raises(ImpossibleChoice, match=r"v_p1, v_p2, v_p3 are said to be zero, .* up to 0.23 m/s"):
        seen_as(recording, COROLLARIES[0].choice(), motion)


def test_the_filter_on_the_linear_view_is_the_kalman_filter():
    """Against the discrete filter of the textbooks, with the transition of the linear system."""
    from scipy.linalg import expm

    period, R, Q2, P0 = 0.01, 1e-2, 1.0, 100.0
    recording = linear_view(record(chwa2019_simulation("IV.A", W), 1, ScaledDepthCamera(period), seed=4))
    form = recording.view.form
    observer = ekf(form, noise_variance=R, hidden_process_noise=Q2, hidden_variance=P0, measured_variance=1.0)
    run = track(recording, observer, step=1e-3)
    known = dict(zip(form.parameters, recording.motion.known(0.0)[0], strict=True))
    F = np.array(form.rate.jacobian(form.coordinates).subs(known), dtype=float)
    Q = np.diag([0, 0, 0, Q2, Q2, Q2])
    # Van Loan's transition and noise of a period
    block = expm(np.block([[-F, Q], [np.zeros((6, 6)), F.T]]) * period)
    transition = block[6:, 6:].T
    noise = transition @ block[:6, 6:]
    x, P, H = np.append(recording.outputs[0], np.zeros(3)), np.diag([1.0] * 3 + [P0] * 3), np.eye(3, 6)
    for k, sample in enumerate(recording.outputs):
        if k:
            x, P = transition @ x, transition @ P @ transition.T + noise
        gain = P @ H.T @ np.linalg.inv(H @ P @ H.T + R * np.eye(3))
        x, P = x + gain @ (sample - H @ x), P - gain @ H @ P
    np.testing.assert_allclose(run.estimate[-1], x, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(run.covariance[-1], P, rtol=1e-5, atol=1e-7)


def test_what_does_not_fit_is_refused():
    recording = record(CASE, 1)
    of_images, unscaled = record(scenarios.ma2005_eq35(), 1), COROLLARIES[4].choice()
    fourth = ismo(COROLLARIES[3].choice().form)
    for error, call, message in (
        (DoesNotFit, lambda: track(recording, fourth), "made for the scaled pinhole with d_s, v_c3, v_p1 unknown"),
        (DoesNotFit, lambda: track(of_images, ismo(CASE.choice.form)), "was made for the scaled pinhole"),
        (ValueError, lambda: moving_window_least_squares(recording, 0.5), "but the recording shows the scaled pinhole"),
        (ValueError, lambda: linear_view(of_images), "the linear view needs the outputs y1, y2, ybar3"),
        (ValueError, lambda: seen_as(recording, unscaled, rigid(point_velocity=STILL)), "has no values for d_s; give"),
    ):
        with pytest.raises(error, match=message):
            call()


test_scenarios_that_make_no_sense_are_refused = refuses(
    lambda call: call(),
    *((lambda s=s: replace(CASE, scale=s), "one over a distance in metres") for s in (0.0, -1.0, float("nan"))),
    (lambda: replace(CASE, motion=affine(np.eye(3), STILL)), r"the affine motion is none of rigid\(\)"),
    (lambda: CASE.choice.known_motion(rigid()), "the motion has no numbers"),
    *((lambda d=d: record(CASE, d), "holds no two samples") for d in (0.0, 1e-4, float("inf"))),
    (lambda: chwa2019_experiment("V.A"), r"no case .* 'V.A'; there are IV.A"),
    (lambda: chwa2019_simulation("V.A", (0.1, 0, 0)), "needs a positive third component"),
    (lambda: grid_patch(0.0), "positive side"),
    (lambda: grid_patch(0.1, 4), "odd count"),
    (lambda: grid_patch(0.1, 1), "odd count"),
)


def test_a_point_that_comes_behind_the_camera_is_refused():
    towards = replace(CASE, motion=rigid(camera_velocity=(0.1, 0, 1.0)), position=(0, 0, 1), scale=1.0)
    with pytest.raises(BehindCamera, match="only points at a positive distance are seen"):
        record(towards, 2.0)


def test_a_patch_begins_at_the_tracked_point_and_is_flat():
    patch = grid_patch(0.4, 5)
    assert patch.shape == (25, 3)
    np.testing.assert_array_equal(patch[0], 0)
    np.testing.assert_array_equal(patch[:, 2], 0)
    np.testing.assert_allclose(patch.mean(axis=0), 0, atol=1e-15)


def test_sampled_velocities_serve_as_well_as_functions():
    time = np.linspace(0, 1, 101)
    samples = np.column_stack([0.3 + 0 * time, 0.1 * time, -0.1 * time])
    sampled = rigid(
        camera_angular_velocity=np.zeros((101, 3)),
        camera_velocity=samples,
        point_velocity=np.zeros((101, 3)),
        times=time,
    )
    known = CASE.choice.known_motion(sampled)
    np.testing.assert_allclose(known.known([0.0, 0.5]), [[0, 0, 0, 0.3]] * 2)
    recording = record(replace(CASE, motion=sampled, position=(1, 1, 4), duration=1.0, scale=2.0))
    np.testing.assert_allclose(recording.truth[500, 3:], [2, 0.1, -0.1])


def test_a_recording_from_real_outputs():
    """Nothing is asked of what is unknown."""
    choice = COROLLARIES[0].choice()
    made = record(CASE, 2)
    motion = choice.known_motion(rigid(camera_velocity=(-0.22, 9.9, 9.9)))
    recording = Recording(made.time, made.outputs, made.names, choice, motion)
    assert recording.truth is None
    run = track(recording, ismo(choice.form), hold="first", step=1e-3)
    assert choice.quantities(run.estimate[-1, 3:])["v_c2"] == pytest.approx(-0.23, abs=1e-3)
    assert LinearView(choice).form.measured == ("xbar1", "xbar2", "xbar3")
    assert PerspectiveSystem(rigid(), pinhole()).coordinates[2].name == "y3"
