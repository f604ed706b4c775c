"""The manoeuvre keeps a point on its path, and each of its parts can be taken away."""

import numpy as np
import pytest
import sympy as sp

from percept_obs import Camera, PointsScenario, record
from percept_obs.points import rigid_body
from percept_obs.points.manoeuvre import PATH, SPIN, TURNING, Manoeuvre
from percept_obs.system.motion import TIME


def path_at(time):
    return np.array([[float(entry.subs(TIME, t)) for entry in PATH] for t in time])


def test_path_and_spin_are_those_that_are_documented():
    t = np.linspace(0.0, 6.0, 7)
    described = np.transpose([1.5 * np.sin(t), 1.2 * np.cos(0.7 * t), 2.5 + 0.5 * np.sin(0.5 * t)])
    np.testing.assert_allclose(path_at(t), described, atol=1e-12)
    turns = [-0.2 * np.sin(0.3 * t), -0.3 * np.cos(0.4 * t), np.full(7, -0.5)]
    found = [[float(e.subs(TIME, s)) for s in t] for e in (*TURNING, *SPIN)]
    np.testing.assert_allclose(found, [*turns, 0.5 * np.sin(t), 0.4 * np.cos(t), np.full(7, 0.3)], atol=1e-12)


@pytest.mark.parametrize("turning", [0.0, 0.4, 1.0])
def test_a_point_that_begins_on_the_path_stays_on_it_however_the_camera_turns(turning):
    camera_turns, camera_moves, body_turns = Manoeuvre(turning=turning).velocities
    form = rigid_body(1, camera_turns, camera_moves, body_turns)
    recording = record(PointsScenario("path", form, path_at([0.0])[0], 6.0), camera=Camera(0.5))
    np.testing.assert_allclose(recording.truth, path_at(recording.time), atol=1e-9)


def test_each_part_is_taken_by_its_share():
    half = Manoeuvre(turning=0.5, spin=-2, input=0, camera_velocity=(0.1, 0.2, 0.3))
    camera_turns, camera_moves, body_turns = half.velocities
    assert sp.Matrix(camera_turns) == sp.Matrix(TURNING) * 0.5
    assert [float(v) for v in camera_moves] == [0.1, 0.2, 0.3]
    assert sp.Matrix(body_turns) == -2 * sp.Matrix(SPIN)


def test_without_any_part_nothing_moves():
    still = rigid_body(2, *Manoeuvre(turning=0, input=0).velocities)
    A, v = still.coefficients(1.0)
    assert not A.any()
    assert not v.any()
