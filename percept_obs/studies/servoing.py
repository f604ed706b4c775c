"""Image-based visual servoing of four points, with the true depth, a constant one, or that of an observer."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile import Array, Flags, vectorised
from percept_obs.compile.integrator import LONGEST_STEP, STEP_ROUNDING, step
from percept_obs.observability.steering import Steering, steering
from percept_obs.observers.base import Observer
from percept_obs.observers.extended_kalman import ekf
from percept_obs.observers.parts import first_seen, hats
from percept_obs.recording import Recording
from percept_obs.recording.reckoning import transitions
from percept_obs.system.motion import rigid
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import pinhole
from percept_obs.validation import bar, checked, limit, one_of, positive

SYSTEM = PerspectiveSystem(rigid(), pinhole())
FORM = SYSTEM.measure("y1", "y2")
VELOCITIES = (*SYSTEM.motion.parameters[3:6], *SYSTEM.motion.parameters[:3])
"""Symbols of the commanded velocity v_c and angular velocity w_c of the camera."""

INTERACTION = SYSTEM.rate[:2, :].jacobian(VELOCITIES)
"""Interaction matrix L of y' = L (v_c, w_c) for a point at rest, shape (2, 6), derived."""

KNOWN = (*SYSTEM.coordinates, *SYSTEM.motion.parameters)
"""Arguments of functions of one point: its coordinates and the velocities."""
GOAL = np.array([[x, y, 1.0] for x in (-0.2, 0.2) for y in (-0.2, 0.2)])
"""Where the four points shall be in the camera's frame, in metres."""

PERIOD = 1 / 30
"""Seconds from one image to the next."""

FIELD = 1.0
"""Largest image coordinate that the camera sees: 45 degrees."""

BELIEVED = (0.1, 10.0)
"""Shares of the goal's inverse depth within which an observed one is believed."""


@checked
@dataclass(frozen=True, eq=False)
class Servoing:
    """Closed loops from S starts over K samples of p points.

    Parameters
    ----------
    time : array of shape (K,)
        Seconds.
    coordinates : array of shape (S, K, p, 3)
        True images and inverse depths, in 1/m.
    samples : array of shape (S, K, p, 2)
        Images as the camera sees them.
    believed : array of shape (S, K, p)
        Inverse depths that the controller believes, in 1/m.
    velocity : array of shape (S, K, 6)
        Commanded v_c in m/s and w_c in rad/s, as in `rigid`; each is held until the next sample.
    goal : array of shape (p, 3)
        Coordinates at the goal.
    lost : array of shape (S, K) of bool
        True once a point has left the image or was behind the camera, which then stands still.
    noise : float
        Standard deviation of each sample.

    See Also
    --------
    servo : Makes it.

    Examples
    --------
    >>> from percept_obs.studies.servoing import servo
    >>> run = servo([[0.1, 0.0, 0.5, 0.0, 0.0, 0.3]], "true", noise=0.0)
    >>> run.arrived_at().round(1).tolist(), run.overshoot.round(3).tolist()
    ([2.6], [0.0])
    >>> run.recording().outputs.shape
    (301, 2)
    """

    time: Array
    coordinates: Array
    samples: Array
    believed: Array
    velocity: Array
    goal: Array
    lost: Flags
    noise: float

    @cached_property
    def image_error(self) -> Array:
        """Difference y - y* of the true images, shape (S, K, 2 p)."""
        return (self.coordinates - self.goal)[..., :2].reshape(*self.lost.shape, -1)

    @property
    def depth_error(self) -> Array:
        """Relative error of the believed distance, shape (S, K, p)."""
        return self.coordinates[..., 2] / self.believed - 1

    def arrived_at(self, tolerance: float = 0.02) -> Array:
        """Seconds from which on |y - y*| stays below the tolerance, shape (S,); infinite if it does not."""
        positive(tolerance=tolerance)
        away = (np.linalg.norm(self.image_error, axis=-1) >= tolerance) | self.lost
        since = np.where(away.any(axis=1), away.shape[1] - np.argmax(away[:, ::-1], axis=1), 0)
        return np.append(self.time, np.inf)[since]

    @cached_property
    def overshoot(self) -> Array:
        """Largest share of the first image error by which the images pass the goal along it, shape (S,)."""
        first = self.image_error[:, :1]
        along = (self.image_error * first).sum(axis=-1) / (first**2).sum(axis=-1)
        return np.maximum(0, -along.min(axis=1))

    @cached_property
    def excitation(self) -> Array:
        """|w|^2 in m^2/s^2, which multiplies the inverse depth in the image's rate, shape (S, K, p); see `steering`."""
        seen = np.moveaxis(self.coordinates, -1, 0)
        return vectorised(KNOWN, [_steering().excitation])(*seen, *_parameters(self.velocity))[0]

    def camera(self, start: int = 0) -> Array:
        """Places of the camera in the axes that it has at the goal, in metres, shape (K, 3)."""
        one_of(len(self.coordinates), start=start)
        y1, y2, inverse = np.moveaxis(self.coordinates[start], -1, 0)
        points = np.stack([y1, y2, np.ones_like(y1)], axis=-1) / inverse[..., None]
        right, down = (points[:, k] - points[:, 0] for k in (2, 1))  # two sides of the square
        axes = np.stack([right, down, np.cross(right, down)], axis=1)
        axes /= np.linalg.norm(axes, axis=2, keepdims=True)
        return GOAL.mean(axis=0) - (axes @ points.mean(axis=1)[..., None])[..., 0]

    def recording(self, point: int = 0, start: int = 0) -> Recording:
        """Samples of one point, with its true motion in samples, for `track` and labs."""
        one_of(len(self.coordinates), start=start)
        one_of(self.coordinates.shape[2], point=point)
        ends = np.stack([self.time[:-1], self.time[1:] - 1e-6], axis=-1).ravel()  # each velocity is held
        held = np.repeat(self.velocity[start, :-1], 2, axis=0)
        motion = rigid(
            camera_angular_velocity=held[:, 3:], camera_velocity=held[:, :3], times=np.append(ends[:-1], self.time[-1])
        )
        seen, truth = self.samples[start, :, point], self.coordinates[start, :, point]
        said = f"servoing, start {start}, point {point}"
        return Recording(
            self.time, seen, ("y1", "y2"), pinhole(), motion, truth, noise_variance=self.noise**2, source=said
        )


@lru_cache(maxsize=1)
def _steering() -> Steering:
    """Excitation and its gradient, derived when asked for: figures import this module."""
    return steering(SYSTEM)


def _parameters(velocity: Array) -> Array:
    """Parameters of the motion from velocities of shape (..., 6), shape (9, ..., 1) for all points alike."""
    v, w = np.moveaxis(velocity[..., None, :], -1, 0).reshape(2, 3, *velocity.shape[:-1], 1)
    return np.concatenate([w, v, 0 * v])


def _points(poses: Array) -> Array:
    """Points at the starts, shape (S, p, 3): turned about the square's centre, and shifted."""
    from scipy.spatial.transform import Rotation

    centre = GOAL.mean(axis=0)
    turned = (GOAL - centre) @ Rotation.from_rotvec(poses[:, 3:]).as_matrix().swapaxes(1, 2)
    return turned + centre + poses[:, None, :3]


def _in_sight(points: Array) -> Flags:
    """True where all points are in front of the camera and within its field, shape (S,)."""
    return (np.abs(points[..., :2]).max(axis=-1) < FIELD * points[..., 2]).all(axis=-1)


def _functions(observer: Observer) -> tuple[Any, Any, Any]:
    """Return functions that start an observer, take it to the next sample, and give its inverse depth, on arrays."""
    form, eq, gains = observer.form, observer.equations, observer.gain_values
    symbols, parts = (*eq.state, *form.x1, *form.parameters), math.ceil(PERIOD / LONGEST_STEP - STEP_ROUNDING)
    begins = vectorised(
        (*form.x1, *hats(form.coordinates), *first_seen(form.x1), *form.parameters), observer.start, gains
    )
    condition = sp.Piecewise((1, eq.reset_condition), (0, True))
    flow, resets, condition, *updates = (
        vectorised(symbols, block, gains) for block in (eq.flow, eq.reset, [condition], *eq.update)
    )
    inverse = vectorised(symbols, [observer.estimate[-1]], gains)

    def begin(y: Array, start: Array, known: Array) -> Array:
        seen = np.moveaxis(y, -1, 0)
        return np.stack(begins(*seen, *seen, np.broadcast_to(start, seen[0].shape), 1.0, 1.0, *known))

    def advance(state: Array, before: Array, y: Array, known: Array) -> Array:
        held, seen = np.moveaxis(before, -1, 0), np.moveaxis(y, -1, 0)
        with np.errstate(all="ignore"):
            for _ in range(parts):
                state = step(state, np.array(PERIOD / parts), lambda _, x: np.stack(flow(*x, *held, *known)))
                if eq.reset:
                    state = np.where(condition(*state, *held, *known)[0], resets(*state, *held, *known), state)
            for update in updates:
                state = np.stack(update(*state, *seen, *known))
        return state

    return begin, advance, lambda state, y, known: inverse(*state, *np.moveaxis(y, -1, 0), *known)[0]


@checked
def servo(
    starts: ArrayLike,
    depth: str | Observer,
    ratio: float = 1.0,
    gain: float = 1.0,
    looking: float = 0.0,
    noise: float = 1e-3,
    duration: float = 10.0,
    seed: int = 0,
) -> Servoing:
    """Close the loop (v_c, w_c) = -lambda L(y, 1/Z)^+ (y - y*) from several starts.

    Parameters
    ----------
    starts : array of shape (S, 6)
        Where the points' frame is at the start, seen from that of the goal: translation in metres, and rotation vector
        about the square's centre in rad.
    depth : "true", "constant", or Observer of images of both coordinates in rigid motion
        Depth in L: the point's own; that of the goal; or that of one observer a point, which starts from the goal's,
        and knows the commanded velocities.
    ratio : float
        Factor of the depth that is not observed: believed over true, or over that of the goal.
    gain : float
        lambda in 1/s.
    looking : float
        Speed in m/s for an image error of 1 that is added where `steering` turns the velocity to see more, summed over
        the points; it vanishes with the error.
    noise : float
        Standard deviation of each image coordinate.
    duration : float
        Seconds; each command is held for the thirtieth part of one.
    seed : int

    Returns
    -------
    Servoing

    Raises
    ------
    ValueError
        If the depth is none of these, starts have another shape, or a number makes no sense.

    See Also
    --------
    starts : Draws some.

    Notes
    -----
    F. Chaumette and S. Hutchinson, Visual servo control, part I: basic approaches, IEEE RAM 13(4), 2006.

    Examples
    --------
    >>> from percept_obs import ekf
    >>> from percept_obs.studies.servoing import FORM, servo, starts
    >>> run = servo(starts(2), ekf(FORM), duration=2.0)
    >>> bool(abs(run.depth_error[:, 0]).min() > 0.1 > abs(run.depth_error[:, -1]).max())
    True
    """
    poses = np.asarray(starts, dtype=float)
    if poses.ndim != 2 or poses.shape[1] != 6 or not len(poses) or not np.isfinite(poses).all():
        raise ValueError(f"starts have shape {poses.shape}; give finite rows of a translation and a rotation, (S, 6)")
    if (most := np.linalg.norm(poses[:, 3:], axis=1).max(initial=0)) > 2 * math.pi:
        raise ValueError(f"a start turns by {most:.3g} rad, more than once around; were degrees meant?")
    positive(ratio=ratio, gain=gain, duration=duration)
    observed = depth if isinstance(depth, Observer) else None
    if observed and ratio != 1:
        raise ValueError(f"the ratio {ratio} is that of a depth that is not observed; leave it out with an observer")
    if observed is None and depth not in ("true", "constant"):
        raise ValueError(f"the depth {depth!r} is none of 'true', 'constant' and an Observer, such as ekf(FORM)")
    if observed and (observed.form.x1, observed.form.parameters) != (FORM.x1, FORM.parameters):
        raise ValueError(f"the {observed.name} observer is of another form; make it of servoing.FORM")
    limit(duration / PERIOD, "steps", "take a shorter duration", 1e6)
    if not 0 <= noise < FIELD or not 0 <= looking < math.inf or seed < 0:
        raise ValueError(
            f"noise is {noise}, looking {looking} and seed {seed}; give a noise in image coordinates, below "
            f"{FIELD:g}, and a speed and a whole number from 0 on"
        )
    interaction = vectorised(SYSTEM.coordinates, list(INTERACTION))
    generator, surface, steps = np.random.default_rng(seed), SYSTEM.surface, round(duration / PERIOD) + 1
    goal = surface.project(GOAL)
    points = _points(poses)
    rows: dict[str, list[Array]] = {name: [] for name in ("coordinates", "samples", "believed", "velocity", "lost")}
    if not _in_sight(points).all():
        raise ValueError(f"start {int(np.argmin(_in_sight(points)))} leaves a point out of sight; take another one")
    u, y, lost, state = np.zeros((len(poses), 6)), goal[:, :2], np.zeros(len(poses), dtype=bool), np.empty(0)
    begin, advance, estimated = _functions(observed or ekf(FORM))
    for k in bar(range(steps), "servoing"):
        x, before = surface.project(points), y
        y = x[..., :2] + generator.normal(0, noise, x[..., :2].shape)
        e = (y - goal[:, :2]).reshape(len(y), -1)
        if observed:
            state = advance(state, before, y, _parameters(u)) if k else begin(y, goal[:, 2], _parameters(u))
            believed = np.clip(estimated(state, y, _parameters(u)), *(share * goal[:, 2] for share in BELIEVED))
            believed = np.where(np.isfinite(believed), believed, goal[:, 2])
        else:
            believed = (x[..., 2] if depth == "true" else np.broadcast_to(goal[:, 2], y.shape[:2])) / ratio
        seen = np.moveaxis(np.concatenate([y, believed[..., None]], axis=-1), -1, 0)
        L = np.stack(interaction(*seen), axis=-1).reshape(len(y), -1, 6)
        u = -gain * (np.linalg.pinv(L) @ e[:, :, None])[..., 0]
        if looking:
            turn = np.stack(vectorised(KNOWN, list(_steering().turning))(*seen, *_parameters(u))).sum(axis=-1).T
            turn /= np.linalg.norm(turn, axis=1, keepdims=True)
            u[:, :3] += looking * np.linalg.norm(e, axis=1, keepdims=True) * np.nan_to_num(turn)
        u = np.where(lost[:, None], 0.0, u)
        for name, value in zip(rows, (x, y, believed, u, lost), strict=True):
            rows[name].append(value)
        moved = transitions(np.cross(u[:, None, 3:], np.eye(3)), -u[:, :3], PERIOD)  # by -[w_c]x and -v_c
        next_points = points @ moved[:, :, :3].swapaxes(1, 2) + moved[:, None, :, 3]
        lost = lost | ~_in_sight(next_points)
        points = np.where(lost[:, None, None], points, next_points)
    found: dict[str, Any] = {name: np.stack(values, axis=1) for name, values in rows.items()}
    return Servoing(np.linspace(0, (steps - 1) * PERIOD, steps), goal=goal, noise=noise, **found)


@checked
def starts(count: int, seed: int = 0) -> Array:
    """Return poses for `servo` with all points in sight, shape (count, 6).

    Up to 0.5 m to each side, up to 0.4 m nearer and 2 m farther than the goal, tilted by up to 0.4 rad and rolled by
    up to 1 rad.

    Parameters
    ----------
    count : int
    seed : int

    Raises
    ------
    ValueError
        If the count is not positive, or too large.

    See Also
    --------
    servo : Begins there.

    Examples
    --------
    >>> from percept_obs.studies.servoing import starts
    >>> starts(3).shape
    (3, 6)
    """
    if count < 1:
        raise ValueError(f"the count is {count}; give the number of poses, at least 1")
    limit(count, "poses", "take fewer", 2e4)
    generator, found = np.random.default_rng(seed), list[Array]()
    high = np.array([0.5, 0.5, 2.0, 0.4, 0.4, 1.0])
    while len(found) < count:
        pose = generator.uniform([-0.5, -0.5, -0.4, -0.4, -0.4, -1.0], high)
        found += [pose] if _in_sight(_points(pose[None]))[0] else []
    return np.array(found)
