"""A camera's poses over time, and the rigid motion that they make."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from percept_obs.compile import Array
from percept_obs.recording.derivatives import Derivative, Quadratic
from percept_obs.system.motion import Motion, rigid
from percept_obs.system.signal import readonly
from percept_obs.validation import checked, numbers, travels

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

UNIT = 0.01
"""Largest difference of a quaternion's length, or of R^T R, from 1: files are rounded."""

USUAL = Quadratic(0.1)
"""Default derivative, a compromise for a camera carried by hand."""


@checked
@dataclass(frozen=True, eq=False)
class Poses:
    """Poses of a camera, or of the body that carries it: X_world = R X_camera + p.

    Parameters
    ----------
    time : array of shape (K,)
        Seconds, strictly increasing.
    position : array of shape (K, 3)
        Places p in metres.
    orientation : array of shape (K, 4) or (K, 3, 3)
        R as quaternions (x, y, z, w) of length 1, or as matrices; kept as quaternions.

    Raises
    ------
    ValueError
        If shapes do not fit, values are not finite, times do not increase, or an orientation is no rotation.

    See Also
    --------
    read_tum, read_euroc : Poses from files.

    Examples
    --------
    A camera that rises by 0.1 m in a second while it looks along the world's z axis:

    >>> import numpy as np
    >>> t = np.linspace(0, 1, 11)
    >>> poses = Poses(t, np.outer(t, [0, -0.1, 0]), np.stack([np.eye(3)] * 11))
    >>> poses.path().velocity[5].round(9).tolist()
    [0.0, -0.1, 0.0]
    """

    time: Array
    position: Array
    orientation: Array

    def __post_init__(self) -> None:
        time, position, turns = (numbers(each, f"the poses' {name}") for name, each in vars(self).items())
        if time.ndim != 1 or len(time) < 2:
            raise ValueError(f"the poses have times of shape {time.shape}; expected a list of at least two seconds")
        expected: dict[str, list[tuple[int, ...]]] = {"time": [()], "position": [(3,)], "orientation": [(4,), (3, 3)]}
        for (name, shapes), values in zip(expected.items(), (time, position, turns), strict=True):
            if values.shape not in [(len(time), *shape) for shape in shapes]:
                raise ValueError(
                    f"the {name}s have the shape {values.shape}; expected {len(time)} rows, as the times have, of "
                    f"shape {' or '.join(map(str, shapes))}; a quaternion is x, y, z, w"
                )
            bad = ~np.isfinite(values.reshape(len(time), -1)).all(axis=1)
            if bad.any():
                raise ValueError(f"the {name} in row {bad.argmax() + 1} of the poses is not finite; leave the row out")
        late = np.diff(time) <= 0
        if late.any():
            raise ValueError(
                f"the poses' times must increase strictly; look at row {late.argmax() + 2}, "
                f"{float(time[late.argmax() + 1])!r} s: sort the rows and remove repeated ones"
            )
        vars(self).update(time=readonly(time), position=readonly(position), orientation=readonly(_quaternions(turns)))

    @cached_property
    def rotation(self) -> Rotation:
        """R as scipy's Rotation."""
        from scipy.spatial.transform import Rotation

        return Rotation.from_quat(self.orientation)

    def mounted(self, position: ArrayLike, orientation: ArrayLike) -> Poses:
        """Return the poses of a camera fixed to this body: X_body = R X_camera + p.

        Parameters
        ----------
        position : array of shape (3,)
            Of the camera in the body's frame, in metres.
        orientation : array of shape (4,) or (3, 3)
            Of the camera in the body's frame, as in `Poses`.

        Examples
        --------
        A camera 0.2 m in front of the body, which is at (1, 0, 0) and looks along the world's z axis:

        >>> import numpy as np
        >>> body = Poses(np.arange(2.0), np.array([[1.0, 0, 0]] * 2), np.stack([np.eye(3)] * 2))
        >>> body.mounted([0, 0, 0.2], [0, 0, 0, 1]).position[0].tolist()
        [1.0, 0.0, 0.2]
        """
        mount = Poses(np.arange(2.0), np.tile(position, (2, 1)), np.stack([orientation, orientation]))
        places = self.position + self.rotation.apply(mount.position[:1].copy())
        return Poses(self.time, places, (self.rotation * mount.rotation[0]).as_quat())

    def path(self, derivative: Derivative = USUAL) -> CameraPath:
        """Return the poses with their velocities.

        Parameters
        ----------
        derivative : Neighbours, Quadratic or SmoothingSpline

        Raises
        ------
        ValueError
            If there are too few poses for it.
        """
        if len(self.time) < derivative.fewest:
            raise ValueError(f"{len(self.time)} poses are too few for {derivative!r}; it needs {derivative.fewest}")
        position, orientation, velocity, turning = derivative.of(self.time, self.position, self.orientation)
        smoothed = Poses(self.time, position, orientation)
        return CameraPath(self.time, position, smoothed.orientation, smoothed.rotation.inv().apply(velocity), turning)

    def motion(self, derivative: Derivative = USUAL) -> Motion:
        """Return the motion of points at rest in the camera's frame, with the velocities of `path`."""
        return self.path(derivative).motion


@travels
@dataclass(frozen=True, eq=False)
class CameraPath:
    """A camera's poses and velocities at K times.

    Parameters
    ----------
    time, position, orientation : arrays of shape (K,), (K, 3), (K, 4)
        As in `Poses`, smoothed if the derivative smooths.
    velocity, angular_velocity : arrays of shape (K, 3)
        v in m/s and w in rad/s, along the camera's axes.

    See Also
    --------
    Poses.path : Makes one of poses.

    Examples
    --------
    >>> import numpy as np
    >>> upright = np.tile([0, 0, 0, 1.0], (5, 1))
    >>> Poses(np.arange(5.0), np.zeros((5, 3)), upright).path().sees([[0.1, 0, 2]])[4].tolist()
    [[0.1, 0.0, 2.0]]
    """

    time: Array
    position: Array
    orientation: Array
    velocity: Array
    angular_velocity: Array

    @cached_property
    def rotation(self) -> Rotation:
        """R as scipy's Rotation."""
        return Poses(self.time, self.position, self.orientation).rotation

    @cached_property
    def motion(self) -> Motion:
        """Motion of a point at rest in the camera's frame: X' = -v - w x X, so `rigid` takes -w."""
        return rigid(-self.angular_velocity, self.velocity, np.zeros(3), times=self.time)

    def sees(self, places: ArrayLike) -> Array:
        """Return points at rest in the world, shape (n, 3), in the camera's frame, in metres, shape (K, n, 3)."""
        places, back = numbers(places, "the places", "n", 3), self.rotation.inv()
        return np.stack([back.apply(place - self.position) for place in places], axis=1)


@checked
def rigid_from_poses(
    times: ArrayLike,
    positions: ArrayLike,
    orientations: ArrayLike,
    frame: Literal["world", "camera"] = "world",
    derivative: Derivative = USUAL,
) -> Motion:
    """Return the rigid motion of points at rest, from the poses of the camera that sees them.

    It is X' = [w]x X - v_c as of `rigid`, in the camera's frame; its w is minus the camera's angular velocity.

    Parameters
    ----------
    times : array of shape (K,)
        Seconds, strictly increasing.
    positions : array of shape (K, 3)
        In metres.
    orientations : array of shape (K, 4) or (K, 3, 3)
        Quaternions (x, y, z, w) of length 1, or matrices.
    frame : "world" or "camera"
        "world" for poses of the camera in the world, X_world = R X_camera + p, as files of trajectories have them;
        "camera" for poses of the world in the camera's frame, X_camera = R X_world + p, as calibration has them.
    derivative : Neighbours, Quadratic or SmoothingSpline
        For the velocities; a parabola over 0.1 s to either side when left out.

    Returns
    -------
    Motion
        Known from the first pose to the last: w in rad/s, v_c in m/s.

    Raises
    ------
    ValueError
        If there are too few poses or they are none, see `Poses`; if the frame is neither of the two.

    See Also
    --------
    read_tum, read_euroc : Poses from files.

    Examples
    --------
    A camera that moves along its own x axis at 0.2 m/s, and turns about it at 0.1 rad/s:

    >>> import numpy as np
    >>> t = np.arange(0, 1, 0.01)
    >>> turns = np.stack([np.sin(0.05 * t), 0 * t, 0 * t, np.cos(0.05 * t)], axis=1)
    >>> motion = rigid_from_poses(t, np.outer(t, [0.2, 0, 0]), turns)
    >>> motion.known([0.5]).round(9)[0, [0, 3]].tolist()
    [-0.1, 0.2]
    """
    if frame not in ("world", "camera"):
        raise ValueError(f"the frame {frame!r} is none of 'world' and 'camera'")
    poses = Poses(
        numbers(times, "the times"), numbers(positions, "the positions"), numbers(orientations, "the orientations")
    )
    if frame == "camera":
        back = poses.rotation.inv()
        poses = Poses(poses.time, -back.apply(poses.position.copy()), back.as_quat())
    return poses.motion(derivative)


def _quaternions(turns: Array) -> Array:
    """Return quaternions of length 1 of quaternions or matrices; refuse what is no rotation."""
    from scipy.spatial.transform import Rotation

    if turns.ndim == 2:
        off = np.abs(np.linalg.norm(turns, axis=1) - 1)
        if off.max() > UNIT:
            row = int(off.argmax())
            raise ValueError(
                f"the quaternion in row {row + 1} has the length {np.linalg.norm(turns[row]):.4g}, expected 1; is the "
                "order x, y, z, w, and does every row have an orientation?"
            )
        return turns / np.linalg.norm(turns, axis=1, keepdims=True)
    off = np.abs(turns @ np.swapaxes(turns, 1, 2) - np.eye(3)).max(axis=(1, 2))
    off = np.where(np.linalg.det(turns) > 0, off, np.inf)
    if off.max() > UNIT:
        raise ValueError(
            f"the matrix in row {int(off.argmax()) + 1} is no rotation: its columns must have length 1, be at right "
            "angles, and be right-handed"
        )
    return Rotation.from_matrix(turns).as_quat()
