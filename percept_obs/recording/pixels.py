"""Pixels and image coordinates: the camera's intrinsic matrix and the distortion of its lens."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Literal

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile import Array, Flags, vectorised
from percept_obs.recording.camera_files import fields_of_camera
from percept_obs.recording.plausibility import Unlikely
from percept_obs.recording.text_table import PathLike
from percept_obs.validation import checked, numbers, warn

LENS = sp.symbols("k1 k2 p1 p2 k3 k4 k5 k6", real=True)
"""Coefficients of a lens in OpenCV's order: k of the radius, p of a lens that is not centred."""

LENS_COUNTS = (0, 4, 5, 8)
"""Numbers of coefficients in OpenCV's files."""

Lens = Literal["radtan", "equidistant"]

ASIDE = 1.55
"""Radians from the optical axis beyond which an image has no place on a plane, nearly a right angle."""

MOST_TRIALS = 50
"""Most steps of Newton's method; about five are needed where the lens maps one to one."""


@checked
@dataclass(frozen=True)
class PixelCamera:
    """Pinhole camera with pixels: p = A_c m, m = (y1, y2, 1) (Chwa 2019, (1), p. 4), behind a lens that may distort.

    Parameters
    ----------
    focal : pair of floats
        Focal lengths in pixels, along a row and along a column; positive.
    centre : pair of floats
        Principal point in pixels.
    size : pair of ints, optional
        Width and height of the image in pixels; an image without borders when left out.
        A centre outside of it gets a warning.
    distortion : sequence of floats, optional
        Numbers k1, k2, p1, p2, then k3, then k4, k5, k6 of OpenCV's model, as its calibration gives them: four, five,
        eight, or none for images that are rectified.  Of an equidistant lens four, k1 to k4, or none.
    lens : "radtan" or "equidistant"
        Radial and tangential distortion of a pinhole, or a fisheye (Kannala and Brandt, ``cv2.fisheye``), where the
        angle a from the axis is seen at a (1 + k1 a^2 + k2 a^4 + k3 a^6 + k4 a^8).

    Raises
    ------
    ValueError
        If a number is not finite, a focal length or a size is not positive, their number is wrong, or the lens is none
        of the two.

    See Also
    --------
    Recording.from_csv : Takes a camera for tables of pixels.

    Notes
    -----
    The model is that of the OpenCV documentation, "Camera Calibration and 3D Reconstruction", without thin prisms
    and tilted sensors.  J. Kannala and S. S. Brandt, A generic camera model and calibration method for conventional,
    wide-angle, and fish-eye lenses, IEEE Transactions on Pattern Analysis and Machine Intelligence 28(8), 2006.

    Examples
    --------
    >>> lens = PixelCamera((500, 500), (320, 240), distortion=(-0.3, 0.1, 0, 0))
    >>> lens.pixels([0.5, 0.0]).round(3).tolist()
    [552.812, 240.0]
    >>> lens.image([552.8125, 240.0]).round(9).tolist()
    [0.5, 0.0]
    >>> PixelCamera((500, 500), (320, 240), lens="equidistant").pixels([1.0, 0.0]).round(3).tolist()
    [712.699, 240.0]
    """

    focal: Sequence[float]
    centre: Sequence[float] = (0.0, 0.0)
    size: Sequence[int] | None = None
    distortion: Sequence[float] = ()
    lens: Lens = "radtan"

    def __post_init__(self) -> None:
        for name, least, kind in (("focal", 0, "positive"), ("centre", -math.inf, "finite"), ("size", 0, "positive")):
            if name == "size" and self.size is None:
                continue
            values = np.asarray(getattr(self, name), dtype=float)
            if values.shape != (2,) or not ((values > least) & np.isfinite(values)).all():
                raise ValueError(f"{name} is {getattr(self, name)!r}; it must be two {kind} numbers of pixels")
            vars(self)[name] = tuple(map(int, values) if name == "size" else values.tolist())
        lens = np.asarray(self.distortion, dtype=float)
        counts = LENS_COUNTS[:2] if self.lens == "equidistant" else LENS_COUNTS
        if lens.size not in counts or not np.isfinite(lens).all():
            raise ValueError(
                f"the distortion is {self.distortion!r}; it must be {', '.join(map(str, counts[1:]))} finite "
                f"numbers, {self._coefficients}, or none"
            )
        vars(self)["distortion"] = tuple(lens.tolist())
        if 50 * min(self.focal) < max(self.centre):  # it would see all around
            warn(Unlikely(f"focal is {self.focal} and centre {self.centre}; are these pixels, and none millimetres?"))
        if not self.sees(self.centre):
            warn(Unlikely(f"the centre {self.centre} is outside of the image {self.size}; are both of one size?"))

    @classmethod
    def from_yaml(cls, path: PathLike, camera: str | None = None) -> Any:
        r"""Read a camera from a YAML file of OpenCV, ROS, Kalibr (camchain) or EuRoC (sensor.yaml).

        Parameters
        ----------
        path : path
        camera : str, optional
            Name of a camera, such as "cam0", in a file with several.

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        ValueError
            If it is no such file, or the lens of the camera is none that `PixelCamera` has.

        See Also
        --------
        percept_obs.recording.camera_files.read_mount : Where the camera sits on its body (T_BS).

        Examples
        --------
        >>> import pathlib, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     file = pathlib.Path(folder) / "sensor.yaml"
        ...     _ = file.write_text("resolution: [752, 480]\nintrinsics: [458.6, 457.3, 367.2, 248.4]\n")
        ...     PixelCamera.from_yaml(file).focal
        (458.6, 457.3)
        """
        return cls(**fields_of_camera(path, camera))

    @property
    def matrix(self) -> Array:
        """Intrinsic matrix A_c, shape (3, 3)."""
        return np.array([[self.focal[0], 0, self.centre[0]], [0, self.focal[1], self.centre[1]], [0, 0, 1.0]])

    @property
    def bends(self) -> bool:
        """True if pixels are no multiples of image coordinates."""
        return any(self.distortion) or self.lens == "equidistant"

    @property
    def straight(self) -> PixelCamera:
        """The camera with rectified images."""
        return replace(self, distortion=(), lens="radtan")

    @property
    def _coefficients(self) -> str:
        """Names of the distortion's numbers."""
        return "k1, k2, k3, k4" if self.lens == "equidistant" else ", ".join(map(str, LENS))

    def pixels(self, image: ArrayLike) -> Array:
        """Return the pixels of image coordinates (y1, y2), shape (..., 2)."""
        image = numbers(image, "the image coordinates", 2)
        if self.lens == "equidistant":
            radius = np.maximum(np.linalg.norm(image, axis=-1)[..., None], np.finfo(float).tiny)
            image = np.asarray(image * self._seen_at(np.arctan(radius))[0] / radius)
        elif any(self.distortion):
            image = np.stack(self._distorted_from_undistorted()(*np.moveaxis(image, -1, 0))[:2], axis=-1)
        return image * self.focal + self.centre

    def image(self, pixels: ArrayLike) -> Array:
        """Return the image coordinates (y1, y2) of pixels, shape (..., 2); NaN where a pixel is.

        It raises ValueError where the lens maps no direction to a pixel, so that the coefficients do not fit the
        images.
        """
        image = self.directions(pixels)
        lost = np.isnan(image).any(axis=-1) & np.isfinite(pixels).all(axis=-1)
        if lost.any():
            pixel = np.atleast_2d(np.asarray(pixels, dtype=float)[lost])[0]
            raise ValueError(
                f"no direction is seen at the pixel ({pixel[0]:.6g}, {pixel[1]:.6g}) through a lens with the "
                f"distortion {self.distortion}; are these the coefficients of this camera, in the order "
                f"{self._coefficients}?"
            )
        return image

    def directions(self, pixels: ArrayLike) -> Array:
        """Return what `image` does, with NaN where the lens maps no direction to a pixel."""
        distorted = (numbers(pixels, "the pixels", 2) - self.centre) / self.focal
        if self.lens == "equidistant":
            return self._image_of_angles(distorted)
        return self._undistorted_from_distorted(distorted) if any(self.distortion) else distorted

    def variance(self, sigma: float) -> float:
        """Return the variance of the image coordinates, the mean of both, for a standard deviation in pixels."""
        variance = float(np.mean(np.square(sigma / np.array(self.focal))))
        if not (math.isfinite(variance) and sigma >= 0):
            raise ValueError(f"the pixel sigma is {sigma}; it must be finite and not negative")
        return variance

    def sees(self, pixels: ArrayLike) -> Flags:
        """Return True for pixels in the image, shape (...)."""
        pixels = numbers(pixels, "the pixels", 2)
        if self.size is None:
            return np.ones(pixels.shape[:-1], dtype=bool)
        return np.all((pixels >= 0) & (pixels <= self.size), axis=-1)

    def _seen_at(self, angle: Array) -> tuple[Array, Array]:
        """Radii over the focal length at which an equidistant lens shows angles, and their derivatives."""
        powers = np.array([1.0, *(self.distortion or np.zeros(4))])
        odd = 2 * np.arange(5) + 1
        return (angle[..., None] ** odd) @ powers, (angle[..., None] ** (odd - 1)) @ (odd * powers)

    def _image_of_angles(self, distorted: Array) -> Array:
        """Image coordinates behind an equidistant lens, by Newton's method; NaN where no direction ahead is seen."""
        radius: Array = np.asarray(np.linalg.norm(distorted, axis=-1))[..., None]
        angle = np.minimum(radius, ASIDE)
        with np.errstate(all="ignore"):
            for _ in range(MOST_TRIALS):
                shown, slope = self._seen_at(angle)
                angle = angle - (shown - radius) / slope
                if not (np.abs(shown - radius) > 1e-15).any():
                    break
            shown, slope = self._seen_at(angle)
            ahead = (np.abs(shown - radius) < 1e-9) & (slope > 0) & (angle >= 0) & (angle < ASIDE)
            scale = np.where(radius > 0, np.tan(angle) / radius, 1.0)
        return np.where(ahead, distorted * scale, np.nan)

    def _distorted_from_undistorted(self) -> Callable[..., list[Array]]:
        """Return the function from undistorted coordinates to distorted ones and their derivatives."""
        lens = np.zeros(len(LENS))
        lens[: len(self.distortion)] = self.distortion
        return lambda y1, y2: distortion()(y1, y2, *lens)

    def _undistorted_from_distorted(self, distorted: Array) -> Array:
        """Return undistorted image coordinates, by Newton's method; NaN where no direction is seen."""
        found, lens = distorted.copy(), self._distorted_from_undistorted()
        with np.errstate(all="ignore"):
            for _ in range(MOST_TRIALS):
                d1, d2, a, b, c, d = lens(*np.moveaxis(found, -1, 0))
                off1, off2 = d1 - distorted[..., 0], d2 - distorted[..., 1]
                # Newton's step with the inverse of the 2 x 2 Jacobian written out
                step = np.stack([d * off1 - b * off2, a * off2 - c * off1], axis=-1) / (a * d - b * c)[..., None]
                found = found - step
                if not (np.abs(step) > 1e-15 * (1 + np.abs(found))).any():
                    break
            back = np.stack(lens(*np.moveaxis(found, -1, 0))[:2], axis=-1)
            a, b, c, d = lens(*np.moveaxis(found, -1, 0))[2:]
            lost = ~(np.abs(back - distorted) < 1e-9 * (1 + np.abs(distorted))).all(axis=-1)
            lost |= ~((a * d > b * c) & (a + d > 0))  # where the lens has folded or mirrored the image
        return np.where(lost[..., None], np.nan, found)


@lru_cache(maxsize=1)
def distortion() -> Callable[..., list[Array]]:
    """Return the function from undistorted coordinates and eight coefficients to distorted ones and derivatives."""
    y1, y2 = sp.symbols("y1 y2", real=True)
    k1, k2, p1, p2, k3, k4, k5, k6 = LENS
    r2 = y1**2 + y2**2
    radial = (1 + k1 * r2 + k2 * r2**2 + k3 * r2**3) / (1 + k4 * r2 + k5 * r2**2 + k6 * r2**3)
    seen = sp.Matrix(
        [
            y1 * radial + 2 * p1 * y1 * y2 + p2 * (r2 + 2 * y1**2),
            y2 * radial + p1 * (r2 + 2 * y2**2) + 2 * p2 * y1 * y2,
        ]
    )
    return vectorised((y1, y2, *LENS), [*seen, *seen.jacobian([y1, y2])])
