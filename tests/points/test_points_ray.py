"""A constant P makes one point's error decay no faster than its ray turns; the matrix that says so is derived."""

import numpy as np
import pytest
from scipy.linalg import expm

from percept_obs import Camera, PointsForm, PointsScenario, linear, luenberger, record, rigid, track
from percept_obs.points import independent_points
from percept_obs.points.ray import ray_error, ray_turning

GAINS = (0.1, 0.3, 0.6, 1.2, 6.0)
TURNING = 0.3


def decay(gain):
    """Rate of the slower eigenvalue, by numpy."""
    found = ray_error()
    matrix = found.matrix.subs({found.gain: gain, found.turning: TURNING})
    return -np.linalg.eigvals(np.array(matrix, dtype=float)).real.max()


@pytest.mark.slow
def test_the_best_gain_is_critical_damping():
    found = ray_error()
    omega, k = found.turning, found.gain
    assert (found.best_gain, found.best_decay, found.over_gain) == (2 * omega, omega, omega**2 / k)
    assert decay(2 * TURNING) == pytest.approx(TURNING)
    assert max(map(decay, GAINS)) == decay(2 * TURNING)
    assert decay(6.0) == pytest.approx(TURNING**2 / 6.0, rel=0.01)
    assert decay(0.1) == pytest.approx(0.05)


@pytest.mark.parametrize(("gain", "known"), [(0.3, -0.2), (0.6, 0.0), (3.0, -0.2)])
def test_runs_of_the_observer_decay_so(gain, known):
    """A point that goes around the camera in a plane, with a P that keeps the gain: z' = M z, exactly."""
    found = ray_error()

    def angle(t):
        return (TURNING + known) * t - 1

    def across(t):
        return np.array([np.cos(angle(t)), 0, -np.sin(angle(t))])

    A = known * np.array([[0.0, 0, 1], [0, 0, 0], [-1, 0, 0]])
    form = PointsForm(linear(A, lambda t: 2.0 * TURNING * across(t)), np.eye(3))
    start = 2.0 * np.array([np.sin(-1), 0, np.cos(-1)])
    recording = record(PointsScenario("around", form, start, 2.0), camera=Camera(0.05))
    np.testing.assert_allclose(ray_turning(form, recording.time, recording.truth), TURNING, rtol=1e-6)

    def P(t):
        return (1 + np.tan(angle(t)) ** 2) / gain

    run = track(recording, luenberger(form, P), 1.3 * start, hold="exact", step=0.01)
    matrix = np.array(found.matrix.subs({found.gain: gain, found.turning: TURNING}), dtype=float)
    expected = expm(2 * matrix) @ [0, -0.3 * 2.0]
    along = np.array([np.sin(angle(2)), 0, np.cos(angle(2))])
    np.testing.assert_allclose(run.error[-1] @ np.transpose([across(2), along]), expected, atol=1e-6)


def test_the_derivation_names_what_it_finds():
    text = str(ray_error().derivation())
    assert r"k = 2 \omega" in text
    assert r"\frac{\omega^{2}}{k}" in text


def test_rays_turn_by_what_lies_across_them():
    form = independent_points(rigid(camera_angular_velocity=[-1.0, -2, -3], camera_velocity=[0, -0.3, 0.1]), 2)
    turning = ray_turning(form, np.zeros(1), np.array([[0.0, 0, 3, 0, 4, 0]]))
    np.testing.assert_allclose(turning, [[0.3 / 3, 0.1 / 4]])
