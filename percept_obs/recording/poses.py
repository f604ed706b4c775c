"""A camera's poses over time, and the rigid motion that they make."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from percept_obs.compile import Array
from percept_obs.recording.plausibility import Unlikely, ask_for_seconds
from percept_obs.recording.pose_errors import PoseErrors
from percept_obs.recording.smoother import FEWEST, Smoothed, smooth, smooth_turns
from percept_obs.system.motion import Motion, rigid
from percept_obs.system.signal import readonly
from percept_obs.validation import TABLE, TIMES, Times, checked, limit, numbers, warn

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation


@dataclass(frozen=True)
class _Limits:
    """Limits of times, places and turns that poses must keep to give a motion."""

    unit: float = 0.01  # largest difference of a quaternion's length, or of R^T R, from 1: files are rounded
    longest_row: float = 1 / 120  # seconds between two rows of a path: a motion is linear between them
    nearest: float = 1e-3  # mean steps to the next pose; of two that are nearer, rounding would be the velocity
    repeated: float = 0.25  # share of poses that are the one before them again, beyond which somebody has repeated them


LIMITS = _Limits()


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
        R as quaternions (x, y, z, w) of length 1, as matrices, or as scipy's Rotation; kept as quaternions.  A table
        is taken by the last letters of its columns' names, such as qw.
    sigma : pair of float
        Standard deviations of a position's coordinates in metres and of a rotation's angles in radians, at least;
        larger ones are found from the poses.
    correlated : float
        Seconds over which these errors stay alike, as those of poses that a filter has smoothed; 0 for white noise.
    mount : pair of arrays, optional
        Place and rotation of the camera on its body, if `mounted` has made the poses.

    Raises
    ------
    ValueError
        If shapes do not fit, values are not finite, times do not increase, an orientation is no rotation, or a
        deviation is negative.

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

    time: Annotated[Array, TIMES]
    position: Annotated[Array, TABLE]
    orientation: Annotated[Array, TABLE]
    sigma: tuple[float, float] = (0.0, 0.0)
    correlated: float = 0.0
    mount: tuple[Array, Array] | None = None

    def __post_init__(self) -> None:
        time = numbers(self.time, "the poses' time")
        position = numbers(_by_axes(self.position, "xyz"), "the poses' position")
        turns = numbers(_by_axes(self.orientation, "xyzw"), "the poses' orientation")
        known = numbers([*self.sigma, self.correlated], "sigma and correlated")
        if known.shape != (3,) or not (np.isfinite(known) & (known >= 0)).all() or known[1] > 1:
            raise ValueError(
                f"sigma is {self.sigma} and correlated is {self.correlated}; give a deviation in metres and one in "
                "radians (at most 1), and seconds, none of them negative"
            )
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
        ask_for_seconds(time, "a list of poses")
        vars(self).update(sigma=tuple(known[:2].tolist()))
        vars(self).update(time=readonly(time), position=readonly(position), orientation=readonly(_quaternions(turns)))

    @cached_property
    def rotation(self) -> Rotation:
        """R as scipy's Rotation."""
        from scipy.spatial.transform import Rotation

        return Rotation.from_quat(self.orientation)

    def mounted(
        self,
        position: Annotated[ArrayLike, TABLE],
        orientation: Annotated[ArrayLike, TABLE],
        shift: float = 0.0,
    ) -> Poses:
        """Return the poses of a camera fixed to this body, by the camera's clock: X_body = R X_camera + p.

        Parameters
        ----------
        position : array of shape (3,)
            Of the camera in the body's frame, in metres.
        orientation : array of shape (4,) or (3, 3)
            Of the camera in the body's frame, as in `Poses`.
        shift : float
            Seconds by which the body's clock is ahead of the camera's, Kalibr's timeshift_cam_imu.

        Examples
        --------
        A camera 0.2 m in front of the body, which is at (1, 0, 0) and looks along the world's z axis:

        >>> import numpy as np
        >>> body = Poses(np.arange(2.0), np.array([[1.0, 0, 0]] * 2), np.stack([np.eye(3)] * 2))
        >>> body.mounted([0, 0, 0.2], [0, 0, 0, 1]).position[0].tolist()
        [1.0, 0.0, 0.2]
        """
        place = numbers(_by_axes(position, "xyz"), "the position")
        turn = numbers(_by_axes(orientation, "xyzw"), "the orientation")
        place = place.ravel() if place.shape == (3, 1) else place
        finite = np.isfinite([*place.ravel(), *turn.ravel(), shift]).all()
        if place.shape != (3,) or turn.shape not in ((4,), (3, 3)) or not finite:
            raise ValueError(
                f"the position has shape {place.shape}, the orientation {turn.shape}, the shift is {shift} s; expected "
                "(3,), and (4,) of a quaternion x, y, z, w or (3, 3) of a matrix, all finite"
            )
        if (away := float(np.linalg.norm(place))) > 10:  # robots and cars are smaller
            warn(Unlikely(f"the camera sits {away:.3g} m from its body's origin; is its position in millimetres?"))
        mount = Poses(np.arange(2.0), np.tile(place, (2, 1)), np.stack([turn, turn]))
        place, turned = mount.position[0], mount.rotation[0]
        matrix = turned.as_matrix()
        matrix.setflags(write=False)
        return replace(
            self,
            time=self.time - shift,
            position=self.position + self.rotation.apply(place.copy()),
            orientation=(self.rotation * turned).as_quat(),
            mount=(place, matrix),
        )

    def path(self) -> CameraPath:
        """Return smoothed poses with their velocities, at the times of the poses and at least 120 times a second.

        Raises
        ------
        ValueError
            If there are fewer than five poses, or they last too long for a path.

        Warns
        -----
        Unlikely
            If many poses are the ones before them again.

        Notes
        -----
        Each coordinate of the position, and of the angle turned, is a random walk of its third derivative, seen with
        white noise.  The most probable path is a natural quintic spline; how smooth it is and how large the noise is
        follow from the poses, by their likelihood.  C. F. Ansley and R. Kohn, Estimation, filtering, and smoothing
        in state space models with incompletely specified initial conditions, The Annals of Statistics 13(4), 1985.
        """
        rows = (self.time[-1] - self.time[0]) / LIMITS.longest_row
        limit(rows, f"rows of a path of {rows * LIMITS.longest_row:g} s", "give seconds, or cut the poses")
        time, position, rotation = self._apart
        moving = (np.ptp(position, axis=0) > 0).any()
        again = (np.diff(position, axis=0) == 0).all(axis=1) & (np.diff(rotation.as_quat(), axis=0) == 0).all(axis=1)
        if moving and again.mean() > LIMITS.repeated:
            warn(
                Unlikely(
                    f"{again.sum()} of {len(time)} poses are the ones before them again, so that the camera seems to "
                    "move in steps; leave the repeated ones out"
                )
            )
        step = float(time[-1] - time[0]) / (len(time) - 1)
        floors = [sigma**2 * max(1.0, 2 * self.correlated / step) for sigma in self.sigma]
        placed = smooth(time, position, floors[0])
        turned, turning = smooth_turns(time, rotation, floors[1])
        raw = (self.time, self.position, readonly(self.rotation.as_matrix()))
        errors = PoseErrors(*raw, placed.error, placed.memory, turning.error, turning.memory, self.mount)
        return _densely(time, placed, turned, turning, errors)

    @cached_property
    def _apart(self) -> tuple[Array, Array, Rotation]:
        """Times, positions and rotations without poses that are too near to the one before them."""
        if len(self.time) < FEWEST:
            raise ValueError(f"{len(self.time)} poses are too few for velocities; {FEWEST} are needed")
        near = LIMITS.nearest * float(self.time[-1] - self.time[0]) / (len(self.time) - 1)
        rows = [0]
        if np.diff(self.time).min() > near:
            return self.time, self.position, self.rotation
        for row, time in enumerate(self.time.tolist()):
            if time - self.time[rows[-1]] > near:
                rows.append(row)
        return self.time[rows], self.position[rows], self.rotation[rows]

    def motion(self) -> Motion:
        """Return the motion of points at rest in the camera's frame, with the velocities of `path`."""
        return self.path().motion

    def judge(self, motion: Motion) -> Motion:
        """Return a motion with other velocities of this camera, judged by these poses wherever it is used.

        Examples
        --------
        Velocities that an encoder gives, a tenth too small, make distances a tenth too short:

        >>> import numpy as np
        >>> from percept_obs import Recording, pinhole, rigid
        >>> t = np.linspace(0, 2, 61)
        >>> poses = Poses(t, np.outer(np.sin(3 * t), [0.1, 0, 0]), np.stack([np.eye(3)] * 61))
        >>> v = np.outer(0.27 * np.cos(3 * t), [1, 0, 0])
        >>> motion = poses.judge(rigid(camera_velocity=v, times=t))
        >>> seen = Recording(t, np.zeros((61, 2)), ("y1", "y2"), pinhole(), motion, distances={"laser": 2 + 0 * t})
        >>> print(seen.landmark.sentence)
        the speeds do not move a point as the poses do, so that distances come out about 10 % too short
        """
        return replace(motion, errors=self.path().errors)


def _densely(time: Array, placed: Smoothed, turned: Rotation, turning: Smoothed, errors: PoseErrors) -> CameraPath:
    """Return the path at some times and at evenly spaced ones between them, by Hermite's polynomials."""
    from scipy.interpolate import CubicHermiteSpline
    from scipy.spatial.transform import Rotation

    steps = np.diff(time)
    parts = np.ceil(steps / LIMITS.longest_row * (1 - 1e-9)).astype(int)
    row = np.repeat(np.arange(len(steps)), parts)
    share = (np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)) / parts[row]
    times = np.append(time[row] + share * steps[row], time[-1])
    if (parts == 1).all():
        position, rotation, speed, rate = placed.value, turned, placed.rate, turning.rate
    else:
        position = CubicHermiteSpline(time, placed.value, placed.rate)(times)
        speed = CubicHermiteSpline(time, placed.rate, placed.acceleration)(times)
        rate = CubicHermiteSpline(time, turning.rate, turning.acceleration)(times)
        turn, w = (turned[:-1].inv() * turned[1:]).as_rotvec(), turning.rate
        end = w[1:] + np.cross(turn, w[1:]) / 2 + np.cross(turn, np.cross(turn, w[1:])) / 12  # the turn's rate there
        u, h = share[:, None], steps[row, None]
        part = u**2 * (3 - 2 * u) * turn[row] + h * u * (1 - u) * ((1 - u) * w[:-1][row] - u * end[row])
        between = turned[row] * Rotation.from_rotvec(part)
        rotation = Rotation.concatenate([between, turned[-1:]])
    return CameraPath(times, position, rotation.as_quat(), rotation.inv().apply(speed), rate, errors)


@checked
@dataclass(frozen=True, eq=False)
class CameraPath:
    """A camera's poses and velocities at K times.

    Parameters
    ----------
    time, position, orientation : arrays of shape (K,), (K, 3), (K, 4)
        As in `Poses`, smoothed.
    velocity, angular_velocity : arrays of shape (K, 3)
        v in m/s and w in rad/s, along the camera's axes.
    errors : PoseErrors, optional
        Errors of the poses that it was made from.

    See Also
    --------
    Poses.path : Makes one of poses.

    Examples
    --------
    >>> import numpy as np
    >>> upright = np.tile([0, 0, 0, 1.0], (5, 1))
    >>> path = Poses(np.arange(5.0), np.zeros((5, 3)), upright).path()
    >>> path.at([4.0]).sees([[0.1, 0, 2]]).tolist()
    [[[0.1, 0.0, 2.0]]]
    """

    time: Array
    position: Array
    orientation: Array
    velocity: Array
    angular_velocity: Array
    errors: PoseErrors | None = None

    @cached_property
    def rotation(self) -> Rotation:
        """R as scipy's Rotation."""
        from scipy.spatial.transform import Rotation

        return Rotation.from_quat(self.orientation)

    @cached_property
    def motion(self) -> Motion:
        """Motion of a point at rest in the camera's frame: X' = -w x X - v."""
        motion = rigid(camera_angular_velocity=self.angular_velocity, camera_velocity=self.velocity, times=self.time)
        return replace(motion, errors=self.errors)

    def at(self, times: Times) -> CameraPath:
        """Return the path at some times in seconds, shape (T,); ValueError if one lies before or after it."""
        from scipy.interpolate import CubicHermiteSpline
        from scipy.spatial.transform import Slerp

        times = numbers(times, "the times", "T")
        if times.size and not (self.time[0] <= times.min() and times.max() <= self.time[-1]):
            raise ValueError(
                f"the path is known from {self.time[0]:.6g} to {self.time[-1]:.6g} s, but is asked for from "
                f"{times.min():.6g} to {times.max():.6g} s"
            )
        place = CubicHermiteSpline(self.time, self.position, self.rotation.apply(self.velocity))
        rates = np.hstack([self.velocity, self.angular_velocity])
        rates = np.stack([np.interp(times, self.time, column) for column in rates.T], axis=-1)
        turns = Slerp(self.time, self.rotation)(times).as_quat()
        return CameraPath(times, place(times), turns, rates[:, :3], rates[:, 3:], self.errors)

    def sees(self, places: ArrayLike) -> Array:
        """Return points at rest in the world, shape (n, 3), in the camera's frame, in metres, shape (K, n, 3)."""
        places, back = numbers(places, "the places", "n", 3), self.rotation.inv()
        return np.stack([back.apply(place - self.position) for place in places], axis=1)


@checked
def rigid_from_poses(
    times: Times,
    positions: Annotated[ArrayLike, TABLE],
    orientations: Annotated[ArrayLike, TABLE],
    frame: Literal["world", "camera"] = "world",
    sigma: tuple[float, float] = (0.0, 0.0),
    correlated: float = 0.0,
) -> Motion:
    """Return the rigid motion of points at rest, from the poses of the camera that sees them.

    It is X' = -w_c x X - v_c as of `rigid`, in the camera's frame.

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
    sigma, correlated : pair of float, float
        Deviations of the poses, and how long their errors stay alike, as in `Poses`.

    Returns
    -------
    Motion
        Known from the first pose to the last: the camera's w_c in rad/s and v_c in m/s.

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
    [0.1, 0.2]
    """
    poses = Poses(times, positions, orientations, sigma, correlated)  # type: ignore[arg-type]
    if frame == "camera":
        back = poses.rotation.inv()
        poses = replace(poses, position=-back.apply(poses.position.copy()), orientation=back.as_quat())
    return poses.motion()


def _by_axes(table: Any, axes: str) -> Any:
    """Columns of a table in the order of the axes that their names end with, such as qw; no table as it is."""
    if not isinstance(table, Mapping):
        return table
    found = {re.sub(r"\W+$", "", name)[-1:].lower(): column for name, column in table.items()}
    return np.stack([found[axis] for axis in axes] if set(found) == set(axes) else [*table.values()], axis=-1)


def _quaternions(turns: Array) -> Array:
    """Return quaternions of length 1 of quaternions or matrices; refuse what is no rotation."""
    from scipy.spatial.transform import Rotation

    if turns.ndim == 2:
        off = np.abs(np.linalg.norm(turns, axis=1) - 1)
        if off.max() > LIMITS.unit:
            row = int(off.argmax())
            raise ValueError(
                f"the quaternion in row {row + 1} has the length {np.linalg.norm(turns[row]):.4g}, expected 1; is the "
                "order x, y, z, w, and does every row have an orientation?"
            )
        return turns / np.linalg.norm(turns, axis=1, keepdims=True)
    off = np.abs(turns @ np.swapaxes(turns, 1, 2) - np.eye(3)).max(axis=(1, 2))
    off = np.where(np.linalg.det(turns) > 0, off, np.inf)
    if off.max() > LIMITS.unit:
        raise ValueError(
            f"the matrix in row {int(off.argmax()) + 1} is no rotation: its columns must have length 1, be at right "
            "angles, and be right-handed"
        )
    return Rotation.from_matrix(turns).as_quat()
