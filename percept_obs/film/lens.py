"""The lens of a camera and its pose in each picture, from the corners of a board."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from percept_obs.compile import Array, Flags, Indices
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.poses import Poses

FEWEST_CORNERS = 8
"""Fewest corners of the board in a picture from which a pose is found."""

LARGEST_AMBIGUOUS_RATIO = 1.5
"""Ratio of two poses' errors up to which either may be true, so that the pose before decides."""

MOST_CENTRE_SPREAD = 0.01
"""Largest standard deviation of a fitted principal point, over the picture's longer side; else it is the middle."""

MOST_BEND_SPREAD = 0.02
"""Largest standard deviation of k2 r^4 in the picture's corner, r over the focal length; else k2 is 0."""

LEAST_SLOPE = 0.1
"""Least slope of the distorted radius over the undistorted one, up to the corner; at 0 a lens folds the picture."""

FAR, TRIMS = 5.0, 3
"""Medians of the corners' errors beyond which one is left out, and how often the lens is found."""

MOST_VIEWS = 40
"""Largest number of pictures from which the lens is found; the most different ones are taken."""


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

    views = _varied_views(corners)
    pixels = corners[views]
    start = np.array([[max(size), 0, (size[0] - 1) / 2], [0, max(size), (size[1] - 1) / 2], [0, 0, 1.0]])
    plain = cv2.CALIB_FIX_K3 | cv2.CALIB_ZERO_TANGENT_DIST  # more is not told by a small board
    middle, flat = cv2.CALIB_FIX_PRINCIPAL_POINT, cv2.CALIB_FIX_K2
    fixed = [0, flat, middle, middle | flat, middle | flat | cv2.CALIB_FIX_K1]
    for _ in range(TRIMS):
        for more in fixed:
            flags = cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_ASPECT_RATIO | plain | more
            matrix, lens, spread, off = _calibrated(pixels, places, size, start, flags)
            corner = float(np.hypot(*size)) / 2 / matrix[1, 1]
            told = spread[2:4].max() < MOST_CENTRE_SPREAD * max(size) and spread[5] * corner**4 < MOST_BEND_SPREAD
            if told and reaches(lens[:2], corner):
                break
        pixels = np.where((off < FAR * np.nanmedian(off))[..., None], pixels, np.nan)
    camera = PixelCamera((matrix[0, 0], matrix[1, 1]), (matrix[0, 2], matrix[1, 2]), size, lens[:4].tolist())
    alike = np.sqrt(2 * np.isfinite(off).sum(axis=1).mean())  # the errors in one view are no independent ones
    return Lens(camera, float(alike * spread[1] / matrix[1, 1]))


def reaches(lens: Array, corner: float) -> bool:
    """Return True if a lens k1, k2 maps some direction to the distorted radius `corner` without folding the picture.

    A direction at the radius r is seen at r (1 + k1 r^2 + k2 r^4), and this must still grow there.
    """
    k1, k2 = lens
    radius = np.linspace(0, 4 * corner, 1000)
    seen, slope = radius * (1 + k1 * radius**2 + k2 * radius**4), 1 + 3 * k1 * radius**2 + 5 * k2 * radius**4
    beyond = np.flatnonzero(seen >= corner)
    return bool(len(beyond) and slope[: beyond[0] + 1].min() > LEAST_SLOPE)


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


def _varied_views(corners: Array) -> list[int]:
    """Return pictures with most of the corners that differ most from each other, at most `MOST_VIEWS`."""
    count = np.isfinite(corners).all(axis=2).sum(axis=1)
    rich = np.flatnonzero(count >= max(FEWEST_CORNERS, 0.7 * count.max()))
    filled = np.where(np.isfinite(corners[rich]), corners[rich], np.nanmean(corners[rich], axis=1, keepdims=True))
    shape = filled.reshape(len(rich), -1)
    chosen = [0]
    far = np.linalg.norm(shape - shape[0], axis=1)
    while len(chosen) < min(MOST_VIEWS, len(rich)):
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
        turn, shift = cv2.solvePnPRefineLM(there, pixels, matrix, lens, *_likelier_pose(*found[1:], turns[-1:]))
        shown, slope = cv2.projectPoints(there, turn, shift, matrix, lens)
        from_board = Rotation.from_rotvec(turn.ravel()).as_matrix()
        moved = slope[:, 3:6].reshape(-1, 2, 3)
        turned = np.cross((there @ from_board.T + shift.ravel())[:, None], moved)  # of points about the camera
        J = np.concatenate([turned, moved @ from_board], axis=2).reshape(-1, 6)  # the board moves as the camera does
        turns = np.concatenate([turns, [from_board.T]])
        positions.append(-from_board.T @ shift.ravel())
        normals.append(J.T @ J)
        left.append((shown[:, 0] - pixels).ravel())
    rest = np.concatenate(left)
    sigma = float(np.median(np.abs(rest))) / 0.6745 * np.sqrt(len(rest) / (len(rest) - 6 * len(index)))
    poses = Poses(time[index], np.array(positions), turns)
    return Seen(index, poses, sigma**2 * np.linalg.inv(normals), float(np.sqrt(np.mean(rest**2))))


def _likelier_pose(turns: Any, shifts: Any, errors: Any, before: Array) -> tuple[Any, Any]:
    """Return the pose with the least error, or, of two that explain a small plane alike, the one nearer to before."""
    from scipy.spatial.transform import Rotation

    best = 0
    if len(turns) > 1 and len(before) and errors[1] < LARGEST_AMBIGUOUS_RATIO * errors[0]:
        board_from_camera = Rotation.from_rotvec(np.reshape(turns, (-1, 3))).inv().as_matrix()
        best = int(np.linalg.norm(board_from_camera - before, axis=(1, 2)).argmin())
    return turns[best], shifts[best]
