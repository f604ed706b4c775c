"""Pixels of Chwa's cameras: noise as a ratio of powers, and homographies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from percept_obs.compile import Array
from percept_obs.recording.pixels import PixelCamera
from percept_obs.validation import checked, numbers

CHWA_CAMERA = PixelCamera((720, 720), (320, 240))
"""The camera of Chwa 2019, section VII.A; the paper states no size of the image."""

CHWA_EXPERIMENT_CAMERA = PixelCamera((150, 150), (320, 240), (640, 480))
"""A camera that keeps the paper's experiment in view for ten seconds; that of the simulations would not."""


@checked
@dataclass(frozen=True)
class SignalToNoise:
    """White Gaussian noise, given by the signal's power over the noise's.

    The signal is the raw pixel coordinates, principal point included, and its power is their mean square over the
    recording, both coordinates together: sigma^2 = mean(p^2) / 10^(decibels / 10).

    Parameters
    ----------
    decibels : float

    Raises
    ------
    ValueError
        If the ratio is not a number of decibels from -3000 to 3000.

    See Also
    --------
    percept_obs.structure.ScaledDepthCamera : Takes it instead of a noise.
    percept_obs.Gaussian : Noise of given size.

    Examples
    --------
    >>> from percept_obs.structure.pixels import SignalToNoise
    >>> round(SignalToNoise(20.0).sigma([[300.0, 400.0]]), 2)
    35.36
    """

    decibels: float

    def __post_init__(self) -> None:
        if not abs(self.decibels) <= 3000:
            raise ValueError(f"the ratio is {self.decibels} dB; it must be finite, from -3000 to 3000")

    def sigma(self, pixels: ArrayLike) -> float:
        """Standard deviation of the noise on these pixel coordinates, in pixels."""
        if not (np.size(pixels) and np.isfinite(numbers(pixels, "the pixels")).all()):
            raise ValueError("the pixels must be finite, at least one; leave out the pictures in which one was lost")
        return float(np.sqrt(np.mean(np.square(pixels))) * 10 ** (-self.decibels / 20))


@checked
def homography(reference: ArrayLike, images: ArrayLike) -> Array:
    """Return homographies, shape (..., 3, 3), from the image of a planar patch in a reference picture to others.

    With the motion X = R X* + t of points on the plane n . X* = d they are H = R + t n^T / d.  They are found by the
    direct linear transform, on coordinates shifted and scaled to their centre and spread, up to a factor that makes the
    second singular value 1, as that of R + t n^T / d is, and the points stay in front of the camera.  Depth in the
    other picture over depth in the reference is the third entry of H m*.

    Parameters
    ----------
    reference : array of shape (n, 2)
        Image coordinates (y1, y2) of n >= 4 points, no three of four of them on a line.
    images : array of shape (..., n, 2)
        Those of the same points in other pictures.

    Raises
    ------
    ValueError
        If there are fewer than four points, shapes differ, values are not finite, or the points lie on a line.

    See Also
    --------
    percept_obs.structure.PatchDepth : The scaled inverse depth from it.

    Notes
    -----
    R. Hartley, A. Zisserman, Multiple View Geometry in Computer Vision (2004), section 4.1; Y. Ma, S. Soatto,
    J. Kosecka, S. Sastry, An Invitation to 3-D Vision (2004), section 5.3, for the factor.

    Examples
    --------
    >>> from percept_obs.structure.pixels import homography
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> round(float(homography(square, square / 2)[2, 2]), 3)  # twice as far away
    2.0
    """
    reference, images = np.asarray(reference, dtype=float), np.asarray(images, dtype=float)
    if reference.ndim != 2 or reference.shape[1] != 2 or images.shape[-2:] != reference.shape or len(reference) < 4:
        raise ValueError(
            f"the reference has shape {reference.shape} and the images {images.shape}; expected (n, 2) and "
            "(..., n, 2) with the same n of at least 4 points"
        )
    if not (np.isfinite(reference).all() and np.isfinite(images).all()):
        raise ValueError("image points are not finite; leave out the pictures in which one was lost")
    if np.linalg.matrix_rank(reference - reference.mean(axis=0), tol=1e-9) < 2:
        raise ValueError("the points lie on a line in the reference picture; take points that span the patch")
    if not np.ptp(images, axis=-2).max(axis=-1).min(initial=np.inf) > 0:
        raise ValueError("all points of a picture are the same one; leave that picture out")
    unit_from_reference, unit_from_images = _unit_from_points(reference), _unit_from_points(images)
    p = np.insert(images, 2, 1.0, axis=-1) @ np.swapaxes(unit_from_images, -1, -2)
    m = np.broadcast_to(np.insert(reference, 2, 1.0, axis=-1) @ unit_from_reference.T, p.shape)
    if np.linalg.svd(_equations(m, m), compute_uv=False)[..., 7].min(initial=np.inf) < 1e-9:
        raise ValueError("the points of the reference picture determine no map; take four, no three on a line")
    solution = np.linalg.svd(_equations(m, p))[2][..., -1, :]
    unit_images_from_unit_reference = solution.reshape(*solution.shape[:-1], 3, 3)
    H = np.linalg.inv(unit_from_images) @ unit_images_from_unit_reference @ unit_from_reference
    H = H / np.linalg.svd(H, compute_uv=False)[..., 1, None, None]
    depths = H[..., 2, :] @ np.insert(reference, 2, 1.0, axis=-1).T
    return H * np.sign(depths.sum(axis=-1))[..., None, None]


def _equations(m: Array, p: Array) -> Array:
    """Rows of the direct linear transform from points m to p, shape (..., 2 n, 9)."""
    zero = np.zeros_like(m)
    first = np.concatenate([m, zero, -p[..., :1] * m], axis=-1)
    second = np.concatenate([zero, m, -p[..., 1:2] * m], axis=-1)
    return np.concatenate([first, second], axis=-2)


def _unit_from_points(points: Array) -> Array:
    """Return the similarity after which the points' centre is 0 and their root mean square distance to it sqrt(2)."""
    centre = points.mean(axis=-2)
    squares = np.sum((points - centre[..., None, :]) ** 2, axis=-1)
    scale = np.sqrt(2 / squares.mean(axis=-1))
    transform = scale[..., None, None] * np.eye(3)
    transform[..., :2, 2] = -scale[..., None] * centre
    transform[..., 2, 2] = 1
    return transform
