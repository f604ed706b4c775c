"""A camera that a hand carries: its exact poses and velocities at any times, and tables of what it sees."""

import numpy as np
from scipy.io import savemat
from scipy.spatial.transform import Rotation

from percept_obs.recording.poses import Poses

X_AXIS, Y_AXIS = np.eye(3)[:2]
PLACES = np.random.default_rng(3).uniform([-0.4, -0.4, 1.5], [0.4, 0.4, 3.0], (12, 3))
"""Points at rest in the world, in metres, in front of the camera at all times."""


def carried(time, pace=1.0):
    """Positions, rotations, velocities and angular velocities, both along the camera's axes."""
    t = pace * np.asarray(time)
    amplitude, rate, phase = np.array([0.3, 0.2, 0.25]), np.array([1.3, 0.9, 1.1]), np.array([0.0, 1.0, np.pi / 2])
    position = amplitude * np.sin(np.outer(t, rate) + phase)
    velocity = pace * amplitude * rate * np.cos(np.outer(t, rate) + phase)
    pitch, yaw = 0.6 * np.sin(0.8 * t), 0.4 * np.cos(1.2 * t)
    pitching, yawing = pace * 0.48 * np.cos(0.8 * t), -pace * 0.48 * np.sin(1.2 * t)
    turned = Rotation.from_rotvec(np.outer(yaw, Y_AXIS))
    rotation = Rotation.from_rotvec(np.outer(pitch, X_AXIS)) * turned
    turning = turned.inv().apply(np.outer(pitching, X_AXIS)) + np.outer(yawing, Y_AXIS)
    return position, rotation, rotation.inv().apply(velocity), turning


def poses(time, pace=1.0, noise=0.0, seed=0):
    """The poses, with white noise of so many metres and radians."""
    position, rotation, *_ = carried(time, pace)
    shift, turn = noise * np.random.default_rng(seed).standard_normal((2, len(time), 3))
    return Poses(time, position + shift, (rotation * Rotation.from_rotvec(turn)).as_quat())


def seen(time, pace=1.0, places=PLACES):
    """The places in the camera's frame, shape (n, K, 3), without any motion: from the poses alone."""
    position, rotation, *_ = carried(time, pace)
    return np.stack([rotation.inv().apply(place - position) for place in places])


def write_stereo_mat(path, body, mount, images, camera, baseline, landmarks=None):
    """Write a file that `read_stereo_mat` reads: poses of a body, the left camera's on it, and images, NaN if lost."""
    values = {
        **{"t": body.time[None], "r_i_vk_i": body.position.T, "theta_vk_i": body.rotation.as_rotvec().T},
        **{"C_c_v": mount.rotation[0].inv().as_matrix(), "rho_v_c_v": mount.position[0][:, None]},
        **{"y_k_j": np.moveaxis(np.nan_to_num(images, nan=-1.0), -1, 0), "b": baseline},
        **dict(zip(("fu", "fv", "cu", "cv"), (*camera.focal, *camera.centre), strict=True)),
    }
    savemat(path, values if landmarks is None else values | {"rho_i_pj_i": landmarks.T})
