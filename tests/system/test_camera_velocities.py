"""Whatever takes velocities takes the camera's: from these the distance is right to 1 %, and old calls are refused."""

from functools import partial

import numpy as np
import pytest
from camera_paths import carried, poses, seen
from scipy.integrate import trapezoid
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

import percept_obs as po
from percept_obs.labs import points_lab, structure_lab
from percept_obs.points import independent_points, rigid_body
from percept_obs.structure import QUANTITIES, StructureAndMotion, scaled_dynamics
from percept_obs.validation import WrongKind

TIME = np.arange(0, 4, 0.01)
POSITION, ROTATION, VELOCITY, TURNING = carried(TIME)
IMAGES = seen(TIME)
FORM = po.PerspectiveSystem(po.rigid(), po.pinhole()).measure("y1", "y2")
PER_SECOND = CubicSpline(TIME, VELOCITY), CubicSpline(TIME, TURNING)


def both(make, **more):
    """What takes velocities as samples or as functions of time."""
    return make(VELOCITY, TURNING, times=TIME, **more), make(*PER_SECOND, **more)


def rigid(velocity, turning, **more):
    return po.rigid(camera_angular_velocity=turning, camera_velocity=velocity, **more)


def chwa(velocity, turning, **more):
    minus = (lambda t: -turning(t)) if callable(turning) else -turning
    return po.rigid(chwa_rotation=minus, camera_velocity=velocity, **more)


MOTIONS = dict(
    zip(
        ("samples", "functions", "Chwa's samples", "Chwa's functions", "poses", "arrays of poses"),
        (
            *both(rigid),
            *both(chwa),
            poses(TIME).motion(),
            po.rigid_from_poses(TIME, POSITION, ROTATION.as_matrix()),
        ),
        strict=True,
    )
)


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_the_distance_of_a_point_is_right_to_a_percent(motion):
    for X, Y, Z in IMAGES[:3].swapaxes(1, 2):
        images = np.stack([X, Y], axis=1) / Z[:, None]
        recording = po.Recording(TIME, images, ("y1", "y2"), po.pinhole(), motion, noise_variance=1e-8)
        run = po.track(recording, po.ekf(FORM))
        assert run.distance[-1] == pytest.approx(Z[-1], rel=0.01)


def independent(velocity, turning, times=None):
    return independent_points(rigid(velocity, turning, times=times), 3)


def body(velocity, turning, times=None):
    return rigid_body(3, turning, velocity, times=times)


@pytest.mark.parametrize("form", [*both(independent), *both(body)])
def test_many_points_move_as_they_are_seen_to(form):
    places = IMAGES[:3, 0]
    state = np.linalg.pinv(form.blocks.reshape(-1, form.states)) @ places.ravel()
    found = po.record(po.PointsScenario("mine", form, state.tolist(), 3.5), camera=po.Camera(0.1))
    there = (found.truth @ form.blocks.reshape(-1, form.states).T).reshape(-1, 3, 3)
    np.testing.assert_allclose(there, IMAGES[:3, :360:10].swapaxes(0, 1)[: len(there)], atol=1e-3)


W, V, DURATION = np.array([0.1, -0.2, 0.3]), np.array([0.2, 0.1, -0.1]), 1.0


def of_constant(place, time):
    """Place in the axes of a camera that begins in the world's and keeps its velocities along its own axes."""
    fine = np.linspace(0, time, 2001)
    along = Rotation.from_rotvec(np.outer(fine, W)).apply(V)
    return Rotation.from_rotvec(W * time).inv().apply(place - trapezoid(along, fine, axis=0))


def of_structure(**velocities):
    lab = structure_lab(duration=DURATION, ybar=[0.1, 0.2, 0.5], scale=1.0, unknown=["d_s", "v_c1"], **velocities)
    (run,) = lab.run().values()
    y1, y2, ybar3 = run.truth[-1, :3]
    return [(np.array([0.1, 0.2, 1]) / 0.5, np.array([y1, y2, 1]) / ybar3, run.time[-1])]


def of_points(**velocities):
    places = np.array([[0.1, 0.2, 2.0], [-0.3, 0.1, 3.0]])
    lab = points_lab(
        points=places.tolist(), hidden=[None, None], duration=DURATION, turning=0.0, input=0.0, spin=0.0, **velocities
    )
    run = lab.run()
    ends = run.recording.truth[-1] @ run.observer.form.blocks.reshape(6, -1).T
    return list(zip(places, ends.reshape(2, 3), [run.time[-1]] * 2, strict=True))


TYPED = "w_c = [0.1, -0.2, 0.3]; v_c = [0.2, 0.1, -0.1]"
LABS = {
    "structure": partial(of_structure, w_c=W.tolist(), v_c=V.tolist(), motion=""),
    "structure, typed": partial(of_structure, motion=TYPED),
    "points": partial(of_points, camera_velocity=V.tolist(), motion="w_c = [0.1, -0.2, 0.3]"),
    "independent points, typed": partial(of_points, state="independent", motion=TYPED),
}


@pytest.mark.parametrize("lab", LABS.values(), ids=LABS)
def test_points_of_a_lab_move_as_the_camera_of_its_settings_sees_them(lab):
    for place, end, time in lab():
        np.testing.assert_allclose(end, of_constant(place, time), atol=1e-5)


def test_structure_takes_the_letters_of_rigid():
    known = StructureAndMotion(("d_s",), zero=QUANTITIES[4:]).known_motion(MOTIONS["Chwa's samples"])
    np.testing.assert_allclose(known.known(TIME)[:, :3], TURNING)
    assert set(map(str, scaled_dynamics().rotation.free_symbols)) == {"y1", "y2", "ybar3"}


@pytest.mark.parametrize("call", [lambda: po.rigid(W, V, [0, 0, 0]), lambda: po.rigid(angular_velocity=W)])
def test_calls_that_meant_the_negative_are_refused_and_told(call):
    with pytest.raises(WrongKind, match=r"write rigid\(camera_angular_velocity=w_c.*which is minus what"):
        call()


def test_one_rotation_is_given_not_two():
    with pytest.raises(ValueError, match="give one of the two"):
        po.rigid(camera_angular_velocity=W, chwa_rotation=-W)
