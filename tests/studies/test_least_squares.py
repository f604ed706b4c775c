"""A window of samples of a known affine motion determines the point, exactly without noise."""

import numpy as np
import pytest
from examples import NOISY, SURFACES

from percept_obs import Camera, Recording, Scenario, affine, pinhole, record, rigid, scenarios
from percept_obs.studies.least_squares import moving_window_least_squares


@pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
def test_without_noise_the_point_is_found(surface):
    recording = record(scenarios.ma2005_eq35(surface), 3, Camera(period=0.05))
    found = moving_window_least_squares(recording, 1.0)
    assert np.isfinite(found.distance[10:]).all()
    np.testing.assert_allclose(found.points[10:], recording.points[10:], rtol=1e-6)
    np.testing.assert_allclose(found.estimate[10:], recording.truth[10:], rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(found.distance[10:], 1 / recording.truth[10:, -1], rtol=1e-6)


def test_a_varying_motion_is_followed_between_samples_too():
    motion = rigid(
        camera_angular_velocity=lambda t: [-0.1, -0.2 * np.sin(t), 0], camera_velocity=lambda t: [np.cos(t), 0.3, 0]
    )
    scenario = Scenario("varying", motion, (0.5, 0, 4), 3, pinhole())
    recording = record(scenario, camera=Camera(period=0.1))
    found = moving_window_least_squares(recording, 1.0)
    assert np.abs(found.points - recording.points)[found.time >= 1].max() < 1e-4


@pytest.mark.parametrize(
    ("scenario", "window"),
    [
        (scenarios.ma2005_eq35(), 0.05),  # one sample
        (Scenario("towards", affine(np.zeros((3, 3)), [0.1, 0.05, 0.5]), (0.4, 0.2, 2.0), 3, pinhole()), 2.0),
    ],
    ids=["one sample", "focus of expansion"],
)
def test_what_determines_no_point_has_no_distance(scenario, window):
    found = moving_window_least_squares(record(scenario, 3, Camera(period=0.1)), window)
    assert np.isinf(found.points).all()
    assert np.isinf(found.distance).all()


def test_lost_samples_are_left_out():
    recording = record(scenarios.ma2005_eq35(), 3, Camera(period=0.05, dropout=0.4), seed=3)
    found = moving_window_least_squares(recording, 1.0)
    np.testing.assert_allclose(found.points[found.time > 1], recording.points[found.time > 1], rtol=1e-6)


@pytest.mark.slow
def test_a_longer_window_averages_noise():
    recording = record(scenarios.ma2005_eq35(), 10, NOISY, seed=1)
    errors = [
        np.median(np.abs(moving_window_least_squares(recording, w).distance * recording.truth[:, 2] - 1)[300:])
        for w in (0.5, 3.0)
    ]
    assert errors[1] < errors[0] / 3


@pytest.mark.parametrize("window", [0, -1, np.inf])
def test_windows_that_are_none_are_refused(window):
    with pytest.raises(ValueError, match="must be positive"):
        moving_window_least_squares(record(scenarios.ma2005_eq35(), 1), window)


def test_one_output_is_refused():
    whole = record(scenarios.ma2005_eq35(), 1)
    one = Recording(whole.time, whole.outputs[:, :1], ("y1",), pinhole(), whole.motion)
    with pytest.raises(ValueError, match="need the outputs y1, y2; there are y1"):
        moving_window_least_squares(one)
    with pytest.raises(ValueError, match="no truth"):
        moving_window_least_squares(Recording(whole.time, whole.outputs, ("y1", "y2"), pinhole(), whole.motion)).truth  # noqa: B018
