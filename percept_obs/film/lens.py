"""The lens of a camera and its pose in each picture, from the corners of a board."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from percept_obs.compile import Array, Flags, Indices
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.poses import Poses

FEWEST_CORNERS = 8
"""Corners of the board that a picture shows at least, for a pose."""


@dataclass(frozen=True)
class Limits:
    """Limits that corners of the board must keep so that a lens found from them is believed."""

    alike: float = 1.5  # ratio of two poses' errors up to which either may be true: a small plane looks alike from both
    unsure: float = 0.01  # deviation of the principal point, over the picture's size, from which on the middle is taken
    unsure_bend: float = 0.02  # relative deviation of what k2 changes in the corner, from which on there is no k2
    folded: float = 0.1  # least slope of a lens up to the corner; below it no direction may be seen there
    far: float = 5.0  # medians of the corners' errors beyond which one is left out
    trims: int = 3  # times that the lens is found, each without the corners that were far off the last one
    most_views: int = 40  # pictures from which the lens is found, as different as there are: more tell little


LIMITS = Limits()


@dataclass(frozen=True, eq=False)
class Lens:
    """Camera, and the relative standard deviation of its focal length."""

    camera: PixelCamera
    deviation: float


@dataclass(frozen=True, eq=False)
class Seen:
    """Poses of a camera in those of K pictures that show enough of the board.

    `index` are the pictures', `covariance` is of the turn along the camera's axes and of the position along the world's
    ones, shape (m, 6, 6), and `error` the root mean square error of the corners in pixels.
    """

    index: Indices
    poses: Poses
    covariance: Array
    error: float


def find_lens(corners: Array, places: Array, size: tuple[int, int]) -> Lens:
    """Return the lens that explains the corners, shape (K, n, 2), of places on a plane, shape (n, 3)."""
    import cv2

    views = _different(corners)
    pixels = corners[views]
    start = np.array([[max(size), 0, (size[0] - 1) / 2], [0, max(size), (size[1] - 1) / 2], [0, 0, 1.0]])
    plain = cv2.CALIB_FIX_K3 | cv2.CALIB_ZERO_TANGENT_DIST  # more is not told by a small board
    middle, flat = cv2.CALIB_FIX_PRINCIPAL_POINT, cv2.CALIB_FIX_K2
    fixed = [0, flat, middle, middle | flat, middle | flat | cv2.CALIB_FIX_K1]
    for _ in range(LIMITS.trims):
        for more in fixed:
            flags = cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_ASPECT_RATIO | plain | more
            matrix, lens, spread, off = _calibrated(pixels, places, size, start, flags)
            corner = float(np.hypot(*size)) / 2 / matrix[1, 1]
            told = spread[2:4].max() < LIMITS.unsure * max(size) and spread[5] * corner**4 < LIMITS.unsure_bend
            if told and reaches(lens[:2], corner):
                break
        pixels = np.where((off < LIMITS.far * np.nanmedian(off))[..., None], pixels, np.nan)
    camera = PixelCamera((matrix[0, 0], matrix[1, 1]), (matrix[0, 2], matrix[1, 2]), size, lens[:4].tolist())
    alike = np.sqrt(2 * np.isfinite(off).sum(axis=1).mean())  # the errors in one view are no independent ones
    return Lens(camera, float(alike * spread[1] / matrix[1, 1]))


def reaches(lens: Array, corner: float) -> bool:
    """Return True if a lens k1, k2 maps directions up to a distorted radius, both over the focal length.

    A direction at the radius r is seen at r (1 + k1 r^2 + k2 r^4), and this must still grow there.
    """
    k1, k2 = lens
    radius = np.linspace(0, 4 * corner, 1000)
    seen, slope = radius * (1 + k1 * radius**2 + k2 * radius**4), 1 + 3 * k1 * radius**2 + 5 * k2 * radius**4
    beyond = np.flatnonzero(seen >= corner)
    return bool(len(beyond) and slope[: beyond[0] + 1].min() > LIMITS.folded)


def _calibrated(
    pixels: Array, places: Array, size: tuple[int, int], start: Array, flags: int
) -> tuple[Array, Array, Array, Array]:
    """Return the camera's matrix, its lens, the deviations of both, and how far off each corner is, shape (K, n)."""
    import cv2

    seen = np.asarray(np.isfinite(pixels).all(axis=-1))
    views = np.flatnonzero(seen.sum(axis=1) >= FEWEST_CORNERS)
    there = [places[seen[k]].astype(np.float32) for k in views]
    shown = [pixels[k, seen[k]].astype(np.float32)[:, None] for k in views]
    _, matrix, lens, turns, shifts, spread, *_ = cv2.calibrateCameraExtended(
        there, shown, size, start.copy(), np.zeros(5), flags=flags
    )
    off = np.full(seen.shape, np.nan)
    for k, points, found, turn, shift in zip(views, there, shown, turns, shifts, strict=True):
        expected = cv2.projectPoints(points, turn, shift, matrix, lens)[0]
        off[k, seen[k]] = np.linalg.norm((expected - found)[:, 0], axis=1)
    return matrix, lens.ravel(), spread.ravel(), off


def _different(corners: Array) -> list[int]:
    """Return pictures with most of the corners that differ most from each other, at most `most_views`."""
    count = np.isfinite(corners).all(axis=2).sum(axis=1)
    rich = np.flatnonzero(count >= max(FEWEST_CORNERS, 0.7 * count.max()))
    filled = np.where(np.isfinite(corners[rich]), corners[rich], np.nanmean(corners[rich], axis=1, keepdims=True))
    shape = filled.reshape(len(rich), -1)
    chosen = [0]
    far = np.linalg.norm(shape - shape[0], axis=1)
    while len(chosen) < min(LIMITS.most_views, len(rich)):
        chosen.append(int(far.argmax()))
        far = np.minimum(far, np.linalg.norm(shape - shape[chosen[-1]], axis=1))
    return [int(rich[k]) for k in chosen]


def usable(corners: Array) -> Flags:
    """Return True for pictures that show enough of the board, not all in a line, shape (K,)."""
    return np.asarray(np.isfinite(corners).all(axis=2).sum(axis=1) >= FEWEST_CORNERS)


def find_poses(time: Array, corners: Array, places: Array, camera: PixelCamera) -> Seen:
    """Return the camera's poses in the pictures that show enough of the board."""
    import cv2
    from scipy.spatial.transform import Rotation

    matrix, lens = camera.matrix, np.array(camera.distortion or np.zeros(4))
    index, turns = np.flatnonzero(usable(corners)), np.empty((0, 3, 3))
    positions, normals, left = [], [], []
    for k in index:
        seen = np.isfinite(corners[k]).all(axis=1)
        there, pixels = places[seen], corners[k][seen]
        found = cv2.solvePnPGeneric(there, pixels, matrix, lens, flags=cv2.SOLVEPNP_IPPE)
        turn, shift = cv2.solvePnPRefineLM(there, pixels, matrix, lens, *_likely(*found[1:], turns[-1:]))
        shown, slope = cv2.projectPoints(there, turn, shift, matrix, lens)
        rotation = Rotation.from_rotvec(turn.ravel()).as_matrix()
        moved = slope[:, 3:6].reshape(-1, 2, 3)
        turned = np.cross((there @ rotation.T + shift.ravel())[:, None], moved)  # of the points about the camera
        J = np.concatenate([turned, moved @ rotation], axis=2).reshape(-1, 6)  # the board moves as the camera does
        turns = np.concatenate([turns, [rotation.T]])
        positions.append(-rotation.T @ shift.ravel())
        normals.append(J.T @ J)
        left.append((shown[:, 0] - pixels).ravel())
    rest = np.concatenate(left)
    sigma = float(np.median(np.abs(rest))) / 0.6745 * np.sqrt(len(rest) / (len(rest) - 6 * len(index)))
    poses = Poses(time[index], np.array(positions), turns)
    return Seen(index, poses, sigma**2 * np.linalg.inv(normals), float(np.sqrt(np.mean(rest**2))))


def _likely(turns: Any, shifts: Any, errors: Any, before: Array) -> tuple[Any, Any]:
    """Return the pose with the least error, or, of two that explain a small plane alike, the one nearer to before."""
    from scipy.spatial.transform import Rotation

    best = 0
    if len(turns) > 1 and len(before) and errors[1] < LIMITS.alike * errors[0]:
        found = Rotation.from_rotvec(np.reshape(turns, (-1, 3))).inv().as_matrix()
        best = int(np.linalg.norm(found - before, axis=(1, 2)).argmin())
    return turns[best], shifts[best]
