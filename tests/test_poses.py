"""A motion from poses has the package's signs, is right to 1e-3, and which derivative is best depends on the noise."""

import numpy as np
import pytest
from camera_paths import carried, poses, seen

from percept_obs import PerspectiveSystem, Recording, Scenario, ekf, figures, pinhole, rigid, rigid_from_poses, track
from percept_obs.recording.derivatives import Neighbours, Quadratic, SmoothingSpline
from percept_obs.recording.poses import CameraPath, Poses
from percept_obs.studies.comparison import relative_distance_errors

TIME = np.arange(0, 8, 0.01)
FORM = PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2")
PIXEL = 1 / 500
FILTER = ekf(FORM, noise_variance=PIXEL**2, measured_variance=1e-4, hidden_variance=1, process_noise=1e-4)


def error(found, exact):
    """Root mean square of the difference over that of the exact rows."""
    return np.linalg.norm(found - exact) / np.linalg.norm(exact)


def velocity_errors(path, pace=1.0):
    *_, velocity, turning = carried(path.time, pace)
    return error(path.velocity, velocity), error(path.angular_velocity, turning)


@pytest.mark.parametrize("derivative", [Neighbours(), Quadratic(0.05)], ids=repr)
def test_the_motion_is_recovered_to_a_thousandth(derivative):
    assert max(velocity_errors(poses(TIME).path(derivative))) < 1e-3


@pytest.mark.slow
def test_a_smoothing_spline_is_as_good_but_for_its_ends():
    path = poses(TIME[:150]).path(SmoothingSpline())
    *_, velocity, turning = carried(path.time)
    inside = slice(20, -20)
    assert error(path.velocity[inside], velocity[inside]) < 1e-3
    assert error(path.angular_velocity[inside], turning[inside]) < 1e-3


def test_errors_of_derivatives_are_those_of_their_formulas():
    """The cubic part is lost by h^2/10 of the third derivative; noise comes in by sigma sqrt(3/n)/h."""
    half_width, count, upright = 0.1, 21, np.tile([0, 0, 0, 1.0], (len(TIME), 1))
    blip = np.where(np.arange(len(TIME)) == 400, 1.0, 0.0)[:, None] * [1, 0, 0]  # how one pose comes into velocities
    by_window, by_neighbours = (Poses(TIME, blip, upright).path(each) for each in (Quadratic(half_width), Neighbours()))
    assert np.linalg.norm(by_window.velocity) == pytest.approx(np.sqrt(3 / count) / half_width, rel=0.06)
    assert np.linalg.norm(by_neighbours.velocity) == pytest.approx(1 / (np.sqrt(2) * 0.01))
    cubic = Poses(TIME, np.outer(TIME**3, [1, 0, 0]), upright).path(Quadratic(half_width)).velocity[:, 0]
    np.testing.assert_allclose((cubic - 3 * TIME**2)[20:-20], 6 * half_width**2 / 10, rtol=0.11)


@pytest.mark.parametrize("irregular", [False, True])
def test_differences_of_neighbours_are_exact_for_parabolas(irregular):
    time = np.cumsum(np.random.default_rng(0).uniform(0.005, 0.03, 50)) if irregular else TIME[:50]
    path = Poses(time, np.stack([time**2, -time, 0 * time], axis=1), np.tile([0, 0, 0, 1.0], (50, 1))).path(
        Neighbours()
    )
    expected = np.stack([2 * time, -np.ones(50), np.zeros(50)], axis=1)
    np.testing.assert_allclose(path.velocity, expected, atol=1e-11)


def test_signs_and_frame_are_those_of_rigid():
    """Points that the poses alone put before the camera move by the motion that is made of the poses."""
    time = TIME[:61]
    motion = poses(time).motion(Neighbours())
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


@pytest.mark.parametrize(
    "derivative", [Neighbours(), Quadratic(0.1), pytest.param(SmoothingSpline(), marks=pytest.mark.slow)], ids=repr
)
def test_a_quaternion_and_its_negative_are_the_same(derivative):
    whole = poses(TIME[:20])
    flipped = whole.orientation * np.where(np.arange(20) % 3 == 0, -1, 1)[:, None]
    one, two = (Poses(whole.time, whole.position, q).motion(derivative) for q in (whole.orientation, flipped))
    np.testing.assert_allclose(one.signal.samples, two.signal.samples, atol=1e-9)


def test_a_camera_on_a_body_sees_from_where_it_is_mounted():
    body, place, turn = poses(TIME[:5]), np.array([0.1, -0.2, 0.3]), [0, np.sqrt(0.5), 0, np.sqrt(0.5)]
    camera = body.mounted(place, turn)
    on_axis = camera.rotation.apply([0, 0, 1.0]) + camera.position
    expected = body.rotation.apply(place + np.eye(3)[0]) + body.position
    np.testing.assert_allclose(on_axis, expected, atol=1e-12)


def distance_errors(pace, noise, derivative):
    """Median errors in % of a filter's distance after 2 and 3 s, with motion from poses at 100 Hz, images at 20 Hz."""
    time = np.arange(0, 3.4, 0.01)
    motion, runs = poses(time, pace, noise).motion(derivative), []
    generator = np.random.default_rng(1)
    for points in seen(time, pace):
        truth = pinhole().project(points[10:320:5])
        outputs = truth[:, :2] + 0.5 * PIXEL * generator.standard_normal((62, 2))
        runs.append(
            track(Recording(time[10:320:5], outputs, ("y1", "y2"), pinhole(), motion, truth), FILTER, {"y3": 0.25})
        )
    return np.array([100 * np.median(relative_distance_errors(runs, after)) for after in (2, 3)])


@pytest.mark.slow
def test_which_derivative_suits_which_noise():
    """Fast and clean: a wide window loses motion, and no filter brings it back.  Slow and noisy: it averages."""
    near, wide = Neighbours(), Quadratic(0.2)
    fast = {each: distance_errors(3.0, 1e-3, each) for each in (near, wide)}
    assert (fast[wide] > 2 * fast[near]).all()
    assert (fast[wide] > 4).all()
    slow = {each: distance_errors(1.0, 1e-2, each) for each in (near, wide)}
    assert (slow[near] > 2 * slow[wide]).all()
    assert (slow[near] > 4).all()


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
        ({"derivative": Quadratic(0.1)}, r"3 poses are too few for Quadratic\(half_width=0.1\)"),
    ],
)
def test_what_are_no_poses_is_refused(changes, message):
    good = {"times": [0, 1, 2.0], "positions": np.zeros((3, 3)), "orientations": np.tile([0, 0, 0, 1.0], (3, 1))}
    with pytest.raises(ValueError, match=message):
        rigid_from_poses(**({"derivative": Neighbours()} | good | changes))


def test_a_window_that_is_none_is_refused():
    with pytest.raises(ValueError, match="half_width is 0"):
        Quadratic(0)


def test_velocities_are_drawn_and_told():
    *_, velocity, turning = carried(TIME)
    exact = CameraPath(TIME, poses(TIME).position, poses(TIME).orientation, velocity, turning)
    wide = poses(TIME).path(Quadratic(0.5))
    drawn = figures.velocities({"truth": exact, "wide": wide}, axis=2)
    by_label = {line.get_label(): line for line in drawn.axes[0].lines}
    np.testing.assert_array_equal(by_label["wide"].get_data(), [TIME, wide.velocity[:, 2]])
    np.testing.assert_array_equal(by_label["truth"].get_data(), [TIME, velocity[:, 2]])
    off = np.sqrt(np.mean((wide.velocity - velocity)[:, 2] ** 2))
    assert f"off by {off:.2g} m/s" in drawn.text
    assert "along its z axis" in drawn.text
    fewer = poses(TIME[::2]).path()
    for wrong, message in (
        ({}, "paths are needed"),
        ({"a": 1}, "expected a mapping from text to a CameraPath"),
        ({"a": exact, "b": fewer}, "times"),
    ):
        with pytest.raises(ValueError, match=message):
            figures.velocities(wrong)
    with pytest.raises(ValueError, match="the axis is 3"):
        figures.velocities({"a": exact}, axis=3)
