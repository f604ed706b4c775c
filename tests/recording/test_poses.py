"""A motion from poses has the package's signs, keeps the fastest hand, and brings along the errors of the poses."""

from dataclasses import replace

import numpy as np
import pytest
from camera_paths import carried, poses, seen
from scipy.spatial.transform import Rotation

from percept_obs import (
    PerspectiveSystem,
    Recording,
    Scenario,
    ekf,
    figures,
    pinhole,
    rigid,
    rigid_from_poses,
    track,
)
from percept_obs.recording import Unlikely
from percept_obs.recording.poses import CameraPath, Poses
from percept_obs.recording.smoother import smooth, smooth_turns

TIME = np.arange(0, 8, 0.01)
UPRIGHT = np.tile([0, 0, 0, 1.0], (len(TIME), 1))
FORM = PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2")
PIXEL = 1 / 500


def error(found, exact):
    """Root mean square of the difference over that of the exact rows."""
    return np.linalg.norm(found - exact) / np.linalg.norm(exact)


@pytest.mark.parametrize("rate", [10, 30, 100, 300])
def test_the_motion_is_recovered_to_a_thousandth_at_any_rate_of_poses(rate):
    path = poses(np.arange(0, 8, 1 / rate)).path()
    *_, velocity, turning = carried(path.time)
    assert np.diff(path.time).max() <= 1 / 120 + 1e-9
    assert error(path.velocity, velocity) < 1e-3
    assert error(path.angular_velocity, turning) < 1e-3


def of_white_jerk(time, values, density, variance):
    """Position, velocity and their variances by a Kalman filter and Rauch, Tung and Striebel's smoother."""

    def moved(h):
        noise = [[h**5 / 20, h**4 / 8, h**3 / 6], [h**4 / 8, h**3 / 3, h**2 / 2], [h**3 / 6, h**2 / 2, h]]
        return np.array([[1, h, h * h / 2], [0, 1, h], [0, 0, 1.0]]), density * np.array(noise)

    x, P, forwards = np.zeros(3), 1e9 * np.eye(3), []
    for k, value in enumerate(values):
        if k:
            F, Q = moved(time[k] - time[k - 1])
            x, P = F @ x, F @ P @ F.T + Q
        predicted, gain = (x, P), P[:, 0] / (P[0, 0] + variance)
        x, P = x + gain * (value - x[0]), P - np.outer(gain, P[0])
        forwards.append((predicted, (x, P)))
    found = [(x, P)]
    for k in range(len(time) - 2, -1, -1):
        (ahead, ahead_P), (x, P) = forwards[k + 1][0], forwards[k][1]
        back = P @ moved(time[k + 1] - time[k])[0].T @ np.linalg.inv(ahead_P)
        found.append((x + back @ (found[-1][0] - ahead), P + back @ (found[-1][1] - ahead_P) @ back.T))
    x, P = (np.array(each)[::-1] for each in zip(*found, strict=True))
    return x, P


def test_the_smoother_is_that_of_a_random_walk_of_the_acceleration():
    rng = np.random.default_rng(0)
    time = np.cumsum(rng.uniform(0.02, 0.05, 150))
    values = np.sin(5 * time) + 0.01 * rng.standard_normal(150)
    found = smooth(time, values[:, None])
    step = np.ptp(time) / 149
    x, P = of_white_jerk(time, values, found.variance * step / found.memory**6, found.variance)
    np.testing.assert_allclose(found.value[:, 0], x[:, 0], atol=1e-6)
    np.testing.assert_allclose(found.rate[:, 0], x[:, 1], atol=1e-4)
    np.testing.assert_allclose(found.acceleration[:, 0], x[:, 2], atol=2e-4)
    inside = slice(40, -40)
    assert found.error == pytest.approx(P[inside, 0, 0].mean(), rel=0.1)
    assert found.rate_error == pytest.approx(P[inside, 1, 1].mean(), rel=0.15)


@pytest.mark.parametrize("rate", [30, 100])
@pytest.mark.parametrize("frequency", [0.3, 1, 2])
def test_noise_is_found_and_claims_are_right(rate, frequency):
    time, noise = np.arange(0, 12, 1 / rate), 1e-3
    phase = 2 * np.pi * frequency * time[:, None] + np.arange(3)
    values = 0.06 * np.sin(phase) + noise * np.random.default_rng(1).standard_normal((len(time), 3))
    found = smooth(time, values)
    inside = slice(rate, -rate)
    squares = (found.rate - 0.06 * 2 * np.pi * frequency * np.cos(phase))[inside] ** 2
    assert np.sqrt(found.variance) == pytest.approx(noise, rel=0.15)
    assert 0.3 < squares.mean() / found.rate_error < 1.5


def test_turns_about_changing_axes_add_up():
    """Without the correction for coning the error is 100 times as large."""
    time = np.arange(0, 6, 1 / 30)
    _, rotation, _, turning = carried(time, 2.0)
    smoothed, found = smooth_turns(time, rotation)
    np.testing.assert_allclose(found.rate[5:-5], turning[5:-5], atol=2e-4)
    assert np.abs((rotation.inv() * smoothed).as_rotvec()).max() < 1e-5


def test_a_given_deviation_is_a_floor_and_a_correlation_raises_it():
    whole = poses(TIME[::4])
    plain, floored, alike = (
        replace(whole, sigma=sigma, correlated=correlated).path().errors
        for sigma, correlated in (((0.0, 0.0), 0.0), ((2e-3, 1e-3), 0.0), ((2e-3, 1e-3), 0.1))
    )
    assert plain.image_variance(2.0, 0.1) < floored.image_variance(2.0, 0.1) < alike.image_variance(2.0, 0.1)
    # White noise of poses that are as frequent as images is noise of the image: sigma^2 / Z^2 + sigma^2 of angles.
    assert floored.image_variance(2.0, 0.04) == pytest.approx(2e-3**2 / 2**2 + 1e-3**2, rel=1e-3)
    assert alike.image_variance(2.0, 0.04) == pytest.approx(5 * floored.image_variance(2.0, 0.04), rel=1e-3)


def test_poses_that_are_nearly_at_one_time_and_repeated_ones():
    time = np.sort(np.concatenate([TIME[::4], TIME[::40] + 1e-7]))
    *_, velocity, _ = carried((path := poses(time).path()).time)
    assert error(path.velocity, velocity) < 1e-3
    held = poses(TIME[::3])
    with pytest.warns(Unlikely, match="poses are the ones before them again"):
        Poses(
            TIME, np.repeat(held.position, 3, axis=0)[: len(TIME)], np.repeat(held.orientation, 3, axis=0)[:800]
        ).path()


def shaken(rate, frequency, noise=0.0, seed=0, seconds=8.0, alike=0.0, drift=0.05):
    """Poses of a camera that a hand shakes by 6 cm and 5 degrees, and recordings of two points at rest."""
    rng, time, w = np.random.default_rng(seed), np.arange(0, seconds, 1 / rate), 2 * np.pi * frequency
    place = np.stack([0.06 * np.sin(w * time) + drift * time, 0.03 * np.sin(w * time + 1), 0 * time], axis=1)
    turns = np.stack([3 * np.sin(w * time + 0.5), 5 * np.sin(w * time), 0 * time], axis=1)
    rotation = Rotation.from_rotvec(np.radians(turns))
    errors = rng.standard_normal((2, len(time), 3))
    stay = np.exp(-1 / rate / alike) if alike else 0.0
    for k in range(1, len(time)):
        errors[:, k] = stay * errors[:, k - 1] + np.sqrt(1 - stay**2) * errors[:, k]
    turned = rotation * Rotation.from_rotvec(noise * errors[1])
    found = Poses(time, place + noise * errors[0], turned.as_quat())
    truths = [pinhole().project(rotation.inv().apply(point - place)) for point in ([0.2, 0.1, 1.0], [-0.2, 0.2, 2.5])]
    images = [truth[:, :2] + 0.5 * PIXEL * rng.standard_normal((len(time), 2)) for truth in truths]

    def recordings(motion):
        return [
            Recording(time, image, ("y1", "y2"), pinhole(), motion, truth, noise_variance=(0.5 * PIXEL) ** 2)
            for image, truth in zip(images, truths, strict=True)
        ]

    return found, recordings


def followed(recording, variance):
    return track(
        recording, ekf(FORM, noise_variance=variance, measured_variance=variance, hidden_variance=1), {"y3": 0.5}
    )


@pytest.mark.slow
@pytest.mark.parametrize("frequency", [0.5, 2, 3])
@pytest.mark.parametrize("rate", [30, 100])
def test_a_hand_that_shakes_costs_no_distance(rate, frequency):
    found, recordings = shaken(rate, frequency, 1e-3)
    for recording in recordings(found.motion()):
        run = followed(recording, recording.effective_variance)
        assert abs(run.distance[-1] / recording.distance[-1] - 1) < 0.01
        assert run.nees("y3")[-1] < 9
        assert run.trust().trusted


def too_slow(found, half_width):
    """The motion from parabolas over so many poses, which lose what is fast."""
    from scipy.signal import savgol_filter

    path, count = found.path().at(found.time), 2 * half_width + 1
    step = found.time[1] - found.time[0]
    speed = savgol_filter(found.position, count, 2, deriv=1, delta=step, axis=0)
    speed = found.rotation.inv().apply(speed)
    return rigid(camera_angular_velocity=path.angular_velocity, camera_velocity=speed, times=found.time)


@pytest.mark.slow
@pytest.mark.parametrize(("half_width", "kind"), [(2, "agrees"), (5, "doubted")])
def test_speeds_that_lose_a_shake_are_found_by_a_virtual_landmark(half_width, kind):
    """The bias foretells the distance, whole periods in a second or not; a large one is doubted, a small one widens."""
    found, recordings = shaken(30, 1.0, drift=0.0)
    wrong, right = recordings(found.judge(too_slow(found, half_width)))[1], recordings(found.motion())[1]
    run = followed(wrong, wrong.effective_variance)
    assert run.distance[-1] / wrong.distance[-1] == pytest.approx(1 / (1 - wrong.landmark.bias), rel=0.02)
    assert wrong.landmark.error > 0.01
    assert right.landmark.error == 0
    trust = run.trust()
    assert trust.kind == kind
    assert ("too short" in trust.sentence) == (kind == "doubted")
    assert kind == "doubted" or trust.claimed > wrong.landmark.error


@pytest.mark.slow
def test_errors_of_poses_that_stay_alike_are_found_by_a_first_run():
    ratios = []
    for seed in range(6):
        found, recordings = shaken(100, 0.5, 1.5e-3, seed, alike=0.1)
        for recording in recordings(found.motion()):
            first = followed(recording, recording.effective_variance)
            second = followed(recording, first.effective_variance)
            assert first.effective_variance > recording.effective_variance
            ratios.append([run.nees("y3")[-1] for run in (first, second)])
    first, second = np.mean(ratios, axis=0)
    assert first > 4
    assert 0.2 < second < 2


def test_nothing_changes_with_the_unit_of_length_and_the_clock():
    found, recordings = shaken(30, 1.0, 1e-3, seconds=3.0)
    there = recordings(found.motion())[0]
    other = Poses(found.time + 1e4, 1000 * found.position, found.orientation).motion()
    scaled = replace(
        there, time=there.time + 1e4, motion=other, truth=there.truth * [1, 1, 1e-3], source="in millimetres"
    )
    assert scaled.effective_variance == pytest.approx(there.effective_variance, rel=1e-4)
    assert scaled.landmark.bias == pytest.approx(there.landmark.bias, abs=1e-6)


def test_a_typical_distance_follows_from_truth_measurements_or_rays():
    found, recordings = shaken(30, 1.0, 1e-3, seconds=3.0)
    known = recordings(found.motion())[1]
    blind = replace(known, truth=None)
    measured = replace(blind, distances={"laser": np.full(len(known.time), 4.0)})
    assert blind.depth == pytest.approx(known.depth, rel=0.1)
    assert measured.depth == 4.0
    assert replace(blind, outputs=blind.outputs[:, :1], names=("y1",)).depth == np.inf


def test_signs_and_frame_are_those_of_rigid():
    """Points that the poses alone put before the camera move by the motion that is made of the poses."""
    time = TIME[:61]
    motion = poses(time).motion()
    for points in seen(time)[:2]:
        follows = Scenario("p", motion, tuple(points[0]), 0.6, pinhole()).points(time)
        np.testing.assert_allclose(follows, points, atol=2e-5)


def test_frames_and_ways_to_write_a_rotation_mean_the_same():
    whole = poses(TIME[:50])
    motion = rigid_from_poses(whole.time, whole.position, whole.orientation)
    back = whole.rotation.inv()
    others = [
        rigid_from_poses(whole.time, whole.position, -whole.orientation),
        rigid_from_poses(whole.time, whole.position, whole.rotation.as_matrix()),
        rigid_from_poses(whole.time, -back.apply(whole.position.copy()), back.as_matrix(), "camera"),
    ]
    for other in others:
        np.testing.assert_allclose(other.signal.samples, motion.signal.samples, atol=1e-12)


def test_a_quaternion_and_its_negative_are_the_same():
    whole = poses(TIME[:20])
    flipped = whole.orientation * np.where(np.arange(20) % 3 == 0, -1, 1)[:, None]
    one, two = (Poses(whole.time, whole.position, q).motion() for q in (whole.orientation, flipped))
    np.testing.assert_allclose(one.signal.samples, two.signal.samples, atol=1e-9)


def test_a_camera_on_a_body_sees_from_where_it_is_mounted():
    body, place, turn = poses(TIME[:5]), np.array([0.1, -0.2, 0.3]), [0, np.sqrt(0.5), 0, np.sqrt(0.5)]
    camera = body.mounted(place, turn)
    on_axis = camera.rotation.apply([0, 0, 1.0]) + camera.position
    expected = body.rotation.apply(place + np.eye(3)[0]) + body.position
    np.testing.assert_allclose(on_axis, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"times": [0, 1, 1.0]}, r"increase strictly; look at row 3, 1.0 s: sort"),
        ({"times": [0, np.nan, 2]}, "time in row 2 of the poses is not finite"),
        ({"times": []}, "times of shape"),
        ({"positions": np.zeros((2, 3))}, r"positions have the shape \(2, 3\); expected 3 rows, as the times"),
        ({"positions": np.full((3, 3), np.inf)}, "position in row 1 of the poses is not finite"),
        ({"orientations": np.zeros((3, 4))}, "quaternion in row 1 has the length 0, expected 1"),
        ({"orientations": 2 * np.eye(4)[:3]}, "length 2, expected 1"),
        ({"orientations": np.full((3, 3, 3), np.nan)}, "orientation in row 1 of the poses is not finite"),
        ({"orientations": np.tile(np.diag([1.0, 1, -1]), (3, 1, 1))}, "row 1 is no rotation: .*right-handed"),
        (
            {"orientations": np.zeros((3, 3))},
            r"orientations have the shape \(3, 3\); expected 3 rows, .* \(4,\) or \(3, 3\)",
        ),
        ({}, "3 poses are too few for velocities; 5 are needed"),
        ({"sigma": (-1.0, 0.0)}, "sigma is .* none of them negative"),
    ],
)
def test_what_are_no_poses_is_refused(changes, message):
    good = {"times": [0, 1, 2.0], "positions": np.zeros((3, 3)), "orientations": np.tile([0, 0, 0, 1.0], (3, 1))}
    with pytest.raises(ValueError, match=message):
        rigid_from_poses(**(good | changes))


def test_velocities_are_drawn_and_told():
    position, rotation, velocity, turning = carried(TIME)
    exact = CameraPath(TIME, position, rotation.as_quat(), velocity, turning)
    found = poses(TIME, noise=1e-3).path()
    drawn = figures.velocities({"truth": exact, "smoothed": found}, axis=2)
    by_label = {line.get_label(): line for line in drawn.axes[0].lines}
    np.testing.assert_array_equal(by_label["smoothed"].get_data(), [found.time, found.velocity[:, 2]])
    np.testing.assert_array_equal(by_label["truth"].get_data(), [TIME, velocity[:, 2]])
    off = np.sqrt(np.mean((found.at(TIME).velocity - velocity)[:, 2] ** 2))
    assert f"off by {off:.2g} m/s" in drawn.text
    assert "along its z axis" in drawn.text
    for wrong, message in (
        ({}, "paths are needed"),
        ({"a": 1}, "expected a mapping from text to a CameraPath"),
        ({"truth": exact, "b": poses(TIME[:90]).path()}, "is known from 0 to 0.89 s"),
    ):
        with pytest.raises(ValueError, match=message):
            figures.velocities(wrong)
    with pytest.raises(ValueError, match="the axis is 3"):
        figures.velocities({"a": exact}, axis=3)


def test_turns_between_poses_about_two_axes_are_those_of_the_camera():
    """With the wrong sign where rotations do not commute the error is 26 times as large."""
    path = poses(np.arange(0, 3, 0.1), pace=2.0).path()
    inside = (path.time > 0.5) & (path.time < 2.4)
    rotation = carried(path.time[inside], 2.0)[1]
    assert (rotation.inv() * path.rotation[inside]).magnitude().max() < 3e-5
