"""Least squares of the poses, the lens and faults on a board's corners in a film, the poses being eliminated."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from percept_obs.compile import Array, Flags
from percept_obs.recording.normal import NormalEquations, project_out
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.poses import Poses
from percept_obs.validation import needed

POSE = 6
"""Numbers of a frame's pose; what frames share has a column each."""

LENS, SHUTTER, SHAPE, FOCUS, SHIFT = (0, 1, 2, 3, 6, 7, 8, 9, 10), (4, 5), (11, 12, 13, 14), (15,), (16, 17)
"""Columns: what the camera lacks of both focal lengths, of the second one and of the principal point, in focal lengths,
and of distortion; seconds of read-out along x and y; metres by which the board is bent (three) and stretched; over
time, the relative focal length, and the picture's shift against the lens in pixels."""

SINGLY = 18
"""Stands for shifts of single pictures, which have no numbers of the film."""

USUAL = np.array([0.1, 3e-3, 0.03, 0.03, 0.02, 0.02, 0.3, 0.2, 2e-3, 2e-3, 0.1, *[2e-3] * 4, 0.03, 20, 20])
"""Usual sizes of the columns, their standard deviations before anything is seen."""

ALONE = 6
"""First columns, focal lengths to read-out, that each frame has alone where the corners' noise is estimated: what is
left then is noise whatever the fault, since nothing but noise changes so much from corner to corner."""


@dataclass(frozen=True)
class Limits:
    """Numbers that are assumed of corners before a film is seen, and limits at which its fit ends."""

    jitter: float = 10.0  # pixels by which a stabilisation usually shifts one picture against its neighbours
    finest: float = 0.01  # pixels of noise that corners have at least: OpenCV finds none better
    worth: float = 20  # values of a frame for which the noise of all counts in that of one, which has few of its own
    far: float = 5.0  # times what is left of the median corner, of all and of its frame, that show a wrong corner
    lags: int = 30  # frames, a second, after which errors of corners are alike no more
    white: float = 0.03  # correlation that counts as none: four standard deviations of chance in 16,000 values
    settled: float = 0.02  # largest change in pixels that ends a fit, a tenth of the usual noise


LIMITS = Limits()


@dataclass(frozen=True, eq=False)
class Corners:
    """Corners at K frames with a pose, and functions of time, shape (K, m), of which each column is a combination.

    Frames are `even` if their neighbours are near in time, so that speeds are known.
    """

    time: Array
    pixels: Array
    seen: Flags
    even: Flags
    places: Array
    size: Array
    lens: Array
    bases: Sequence[Array]

    def lens_of(self, state: State) -> Array:
        """Return focal lengths, principal point and distortion."""
        lens, own = self.lens.copy(), state.own[0]
        lens[:9] += own[list(LENS)] * ([lens[0]] * 4 + [1] * 5)
        lens[1] += own[0] * self.lens[0]
        return lens


@dataclass(frozen=True, eq=False)
class State:
    """Poses X_camera = R X + p, columns of each frame, shape (K, 18), and the corners that are used, shape (K, n)."""

    R: Array
    p: Array
    own: Array
    used: Flags


def start(pixels: Array, places: Array, size: Array, camera: PixelCamera, poses: Poses) -> tuple[Corners, State]:
    """Corners at the frames of poses, NaN where unseen, and the state without faults."""
    time, seen = poses.time, np.asarray(np.isfinite(pixels).all(axis=-1))
    gap = np.diff(time) > 3 * np.median(np.diff(time))
    lens = np.zeros(4 + max(5, len(camera.distortion)))
    lens[: 4 + len(camera.distortion)] = *camera.focal, *camera.centre, *camera.distortion
    focus = np.hstack([_hats(time, 3.0, 60), _hats(time, 0.6, 100) / 4])  # fast changes are small ones
    bases = [*[np.ones((len(time), 1))] * FOCUS[0], focus, *[_hats(time, 0.35, 100)] * 2]
    even = ~(np.append(gap, False) | np.append(False, gap))
    R = np.swapaxes(poses.rotation.as_matrix(), 1, 2)
    state = State(R, -(R @ poses.position[..., None])[..., 0], np.zeros((len(time), len(bases))), seen)
    return Corners(time, np.where(seen[..., None], pixels, size / 2), seen, even, places, size, lens, bases), state


def _hats(time: Array, spacing: float, most: int) -> Array:
    """Functions that are linear between nodes so many seconds apart, each with mean 0."""
    span = time[-1] - time[0]
    count = min(max(round(span / spacing), 1), most)
    hats = np.maximum(0, 1 - np.abs(count * (time[:, None] - time[0]) / span - np.arange(count + 1)))
    return np.asarray(hats - hats.mean(axis=0))


@dataclass(frozen=True, eq=False)
class Fit:
    """Normal equations, the second ones for pictures of which each is shifted by itself, and pixels that are left.

    Where frames may have a lens of their own, the mean square is 1 + `ratio` times the noise's, in `count` values.
    The shutter `moved` the corners so far; their `speed` is in pixels a second.
    """

    normals: tuple[NormalEquations, NormalEquations]
    noise: float
    left: float
    ratio: float
    count: int
    moved: Array
    speed: Array

    @property
    def excess(self) -> float:
        """Pixels that noise does not explain."""
        return self.noise * math.sqrt(max(self.ratio, 0.0))

    @property
    def sure(self) -> float:
        """Standard deviations of chance by which they are there."""
        return self.ratio * math.sqrt(self.count / 2)

    def normal(self, columns: Sequence[int]) -> NormalEquations:
        """Normal equations for some columns."""
        return self.normals[SINGLY in columns]


def adjusted(corners: Corners, state: State, columns: Sequence[int], passes: int) -> tuple[State, Fit]:
    """Return poses and columns that explain the corners best, all other columns being 0."""
    for _ in range(passes):
        state, fit, change = _step(corners, state, columns)
        if change < LIMITS.settled:
            break
    return state, fit


def _step(corners: Corners, state: State, columns: Sequence[int]) -> tuple[State, Fit, float]:
    """Take a step of Gauss and Newton; return the state after it, the equations before it, and the largest change."""
    from scipy.spatial.transform import Rotation

    (K, n), even = corners.seen.shape, corners.even
    rows, moved, speed = _rows(corners, state)
    used = (rows * state.used[..., None, None]).reshape(K, 2 * n, -1)
    poses, shared = used[..., :POSE], project_out(used[..., POSE:], used[..., :POSE])
    A, y = shared[..., :-1], shared[..., -1:]
    free = np.maximum(2 * state.used.sum(axis=1) - POSE - ALONE, 0) * even
    rest = project_out(y, A[..., :ALONE])[..., 0] * (free > 0)[:, None]
    noise = max(float((rest**2).sum() / free.sum()), LIMITS.finest**2)
    each = ((rest**2).sum(axis=1) + LIMITS.worth * noise) / (free + LIMITS.worth)
    weight = (even / each)[:, None, None]
    counted = np.swapaxes(A, 1, 2) * weight / _in_a_row(rest / np.sqrt(each)[:, None])
    M = counted @ A
    m = (counted @ y + M @ state.own[..., None])[..., 0]
    inner = np.linalg.inv(M[:, 16:, 16:] + np.eye(2) / LIMITS.jitter**2)
    normals = _normal(corners.bases, M, m), _shifted(corners.bases, M, m, inner)
    own = np.zeros_like(state.own)
    normal = normals[SINGLY in columns]
    chosen, values, _ = normal.solved(columns)
    for j in {*columns} - {SINGLY}:
        own[:, [j]] = corners.bases[j] @ values[normal.owner[chosen] == j]
    if SINGLY in columns:
        own[:, 16:] += (inner @ (m[..., None] - M @ own[..., None])[:, 16:])[..., 0]
    step = (own - state.own)[..., None]
    pose = np.linalg.pinv(poses) @ (used[..., -1:] - used[..., POSE:-1] @ step)
    turn = Rotation.from_rotvec(pose[:, :3, 0]).as_matrix()
    change = (rows[..., :-1] @ np.concatenate([pose, step], axis=1)[:, None])[..., 0]
    left = rows[..., -1] - change
    size = np.where(corners.seen, np.linalg.norm(left, axis=-1), np.nan)
    near = corners.seen & (size <= LIMITS.far * np.fmax(np.nanmedian(size), np.nanmedian(size, axis=1))[:, None])
    count = (ALONE - 2 * (SINGLY in columns)) * int(even.sum()) - len(values)
    after = y - A @ step  # of what is left, frames with a lens of their own would explain the difference
    ratio = float(((after**2 - project_out(after, A[..., :ALONE]) ** 2) * weight).sum()) / count - 1
    rms = float(np.sqrt(np.mean(left[near] ** 2)))
    fit = Fit(normals, math.sqrt(noise), rms, ratio, count, moved, speed)
    moved_on = State(turn @ state.R, (turn @ state.p[..., None] + pose[:, 3:])[..., 0], own, near)
    return moved_on, fit, float(np.abs(change[near]).max())


def _rows(corners: Corners, state: State) -> tuple[Array, Array, Array]:
    """Derivatives of corners by pose and columns, and what is left of them, shape (K, n, 2, 25); moved, and speed."""
    needed("film", "cv2")
    import cv2
    from scipy.interpolate import CubicSpline

    (K, n), own, lens = corners.seen.shape, state.own, corners.lens_of(state)
    x, y, _ = (corners.places - corners.places.mean(axis=0)).T / np.ptp(corners.places, axis=0).max() * 2
    axes = state.R[:, None, :, [2, 2, 2, 0]] * np.stack([x * x, x * y, y * y, x], axis=1)[:, None]
    X = np.swapaxes(state.R @ corners.places.T, 1, 2) + state.p[:, None] + axes @ own[0, SHAPE]
    matrix = np.array([[lens[0], 0, lens[2]], [0, lens[1], lens[3]], [0, 0, 1]])
    seen, slopes = cv2.projectPoints(X.reshape(-1, 3), np.zeros(3), np.zeros(3), matrix, lens[4:])
    zoom = 1 + own[:, None, FOCUS]
    slopes, about = slopes.reshape(K, n, 2, -1) * zoom[..., None], seen.reshape(K, n, 2) - corners.lens[2:4]
    pixels = corners.lens[2:4] + zoom * about
    slopes[..., POSE] += slopes[..., POSE + 1]
    spline = CubicSpline(corners.time, pixels)
    speed, growth = spline(corners.time, 1), spline(corners.time, 2)
    share = corners.pixels / corners.size - 0.5
    late = (share @ own[0, SHUTTER])[..., None]
    moved = (speed + growth * late / 2) * late
    parts = (
        slopes[..., :POSE],
        corners.lens[0] * slopes[..., POSE:10],
        (speed + growth * late)[..., None] * share[:, :, None],
        slopes[..., 10:15],
        slopes[..., 3:6] @ axes,
        about[..., None],
        np.broadcast_to(np.eye(2), (K, n, 2, 2)),
        (corners.pixels - pixels - own[:, None, SHIFT] - moved)[..., None],
    )
    return np.concatenate(parts, axis=-1), moved, speed


def _in_a_row(white: Array) -> float:
    """Number of frames in a row whose noise counts as one, for it is correlated; 1 for white noise."""
    lags = range(min(LIMITS.lags, len(white) - 1) + 1)
    products = np.array([(white[k:] * white[: len(white) - k]).sum() for k in lags])
    end = int(np.argmax(np.append(products, 0) <= LIMITS.white * products[0]))
    return float(1 + 2 * products[1:end].sum() / max(products[0], np.finfo(float).tiny))


def _normal(bases: Sequence[Array], M: Array, m: Array, more: float = 0.0) -> NormalEquations:
    """Normal equations of the film from those of its frames, shapes (K, 18, 18) and (K, 18)."""
    owner = np.repeat(np.arange(len(bases)), [base.shape[1] for base in bases])
    matrix = np.block([[a.T @ (M[:, i, j, None] * b) for j, b in enumerate(bases)] for i, a in enumerate(bases)])
    score = np.concatenate([base.T @ m[:, [i]] for i, base in enumerate(bases)])
    return NormalEquations(owner, matrix, score, USUAL[owner], more)


def _shifted(bases: Sequence[Array], M: Array, m: Array, inner: Array) -> NormalEquations:
    """Normal equations without the shift of each single picture, of which `inner` is the covariance."""
    across, shift = M[:, :, 16:] @ inner, m[:, 16:, None]
    narrower = np.linalg.slogdet(inner / LIMITS.jitter**2)[1].sum()
    gain = float((np.swapaxes(shift, 1, 2) @ inner @ shift).sum() + narrower)
    return _normal(bases, M - across @ M[:, 16:], m - (across @ shift)[..., 0], gain / 2)
