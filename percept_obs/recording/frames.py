"""Frames of a film behind tracks, as PNG or JPEG files, and a film drawn from a recording."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from percept_obs.compile import Array
from percept_obs.recording.recording import Recording
from percept_obs.system.signal import frozen
from percept_obs.validation import Kind, Times, checked, limit, numbers

SIGNATURES = (b"\x89PNG", b"\xff\xd8\xff")
"""First bytes of a PNG file and of a JPEG file."""

MOST_BYTES = 20_000_000
"""Bytes of all frames together, which a notebook keeps with a lab."""


@checked
@dataclass(frozen=True, eq=False)
class Frames:
    """Frames of a film, each shown while it is the nearest in time.

    Parameters
    ----------
    images : folder of PNG or JPEG files, or sequence of their paths or bytes, or of arrays of shape (h, w) or (h, w, 3)
        A folder's files are taken in the order of their names; arrays hold 0 to 255, or 0.0 to 1.0.
    time : array of shape (K,)
        Times of the frames in seconds, increasing, by the recording's clock.
    extent : four floats
        The image coordinates y1 of the left and the right edge, and y2 of the lower and the upper edge.  Of a camera
        with the focal length f and the principal point (c1, c2) in pixels, whose y2 points down: (-c1 / f, (w - c1) /
        f, (h - c2) / f, -c2 / f).

    Raises
    ------
    ValueError
        If a file is no PNG or JPEG, a value is out of range, times are not as many as images, or do not increase.
    TooMuchWork
        If the frames are too large together.

    See Also
    --------
    render : Draws frames of a simulated recording.

    Examples
    --------
    >>> film = Frames([np.zeros((2, 3)), np.ones((2, 3))], [0.0, 0.5], (-1, 1, -1, 1))
    >>> len(film.images)
    2
    """

    images: Annotated[Any, Kind("a folder, or a sequence of files or arrays", lambda v: isinstance(v, Path | Iterable))]
    time: Times
    extent: Sequence[float]

    def __post_init__(self) -> None:
        folder = isinstance(self.images, str | Path)
        pictures = self.images
        if folder:
            pictures = sorted(p for p in Path(pictures).glob("*") if p.suffix.lower() in (".png", ".jpg", ".jpeg"))
        if folder and not pictures:
            raise ValueError(f"the folder {str(self.images)!r} holds no .png or .jpg files; give one with frames in it")
        images = tuple(_encoded(image, k) for k, image in enumerate(pictures, 1))
        limit(sum(map(len, images)), "bytes of frames", "take fewer or smaller ones", MOST_BYTES)
        time = frozen(np.asarray(self.time, dtype=float), "the times of the frames")
        extent = frozen(np.asarray(self.extent, dtype=float), "the edges of the frames")
        if time.shape != (len(images),) or not len(images) or not (np.diff(time) > 0).all():
            raise ValueError(
                f"there are {len(images)} frames and times of shape {time.shape}; give each frame a time, increasing"
            )
        if extent.shape != (4,) or extent[0] == extent[1] or extent[2] == extent[3]:
            raise ValueError(f"the extent is {self.extent!r}; give y1 of left and right, y2 of lower and upper edge")
        vars(self).update(images=images, time=time, extent=tuple(extent.tolist()))


def _encoded(image: Any, number: int) -> bytes:
    """Return the bytes of a PNG or JPEG file, or of pixels as a PNG file."""
    if isinstance(image, str | Path | bytes):
        data = image if isinstance(image, bytes) else Path(image).read_bytes()
        if not data.startswith(SIGNATURES):
            named = "" if isinstance(image, bytes) else f" {str(image)!r},"
            raise ValueError(f"frame {number},{named} is no PNG or JPEG file; convert it")
        return data
    pixels = numbers(image, f"the pixels of frame {number}")
    most = 1 if np.asarray(image).dtype.kind == "f" else 255
    if pixels.ndim not in (2, 3) or (pixels.ndim == 3 and pixels.shape[2] != 3) or not pixels.size:
        raise ValueError(f"frame {number} has the shape {pixels.shape}; expected (h, w), or (h, w, 3) for colours")
    if not (pixels.min() >= 0 and pixels.max() <= most):
        raise ValueError(f"frame {number} has values from {pixels.min()} to {pixels.max()}; expected 0 to {most}")
    from PIL.Image import fromarray  # matplotlib brings it

    written = io.BytesIO()
    fromarray(np.round(255 / most * pixels).astype(np.uint8)).save(written, "PNG")
    return written.getvalue()


BALL = 0.15
"""Radius of the ball that is drawn, in metres."""


@checked
def render(recording: Recording, count: int = 60, size: int = 160) -> Frames:
    """Return a film drawn of a recording with its truth: a ball around the point, which grows as it comes nearer.

    Parameters
    ----------
    recording : Recording
        Of one point, with its truth.
    count : int
        Number of frames, spread over the recording.
    size : int
        Side of a frame in pixels.

    Raises
    ------
    ValueError
        If the recording has no truth, or is not of one point.

    See Also
    --------
    Frames : The film.

    Examples
    --------
    >>> from percept_obs import record, scenarios
    >>> from percept_obs.recording import render
    >>> film = render(record(scenarios.planar(), 2), count=2, size=32)
    >>> len(film.images)
    2
    """
    truth = recording.truth
    known = np.flatnonzero(truth is not None and np.isfinite(truth).all(axis=-1))
    if truth is None or not len(known) or len(recording.imaging_surface.image) < 2:
        raise ValueError("the recording has no truth to draw in two dimensions; give frames of its camera instead")
    if count < 1 or size < 2:
        raise ValueError(f"{count} frames of {size} pixels a side are none; take at least 1 frame of 2 pixels")
    count = min(count, len(known))
    limit(float(size) ** 2 * count, f"pixels, from {count} frames of the size {size}", "take fewer or smaller frames")
    which = known[np.linspace(0, len(known) - 1, count).astype(int)]
    y1, y2, inverse = truth[which][:, [0, 1, -1]].T
    low, high = (np.array([bound(y1), bound(y2)]) for bound in (np.min, np.max))
    middle, half = (low + high) / 2, 0.65 * max(float((high - low).max()), 0.2)
    left, right, lower, upper = middle[0] - half, middle[0] + half, middle[1] - half, middle[1] + half
    along = np.linspace(left, right, size)[None, :], np.linspace(upper, lower, size)[:, None]
    floor = 0.8 + 0.06 * np.sign(np.sin(8 * np.pi * along[0]) * np.sin(8 * np.pi * along[1]))
    images = [_with_ball(floor, *along, each) for each in zip(y1, y2, BALL * inverse, strict=True)]
    return Frames(images, recording.time[which], (left, right, lower, upper))


def _with_ball(floor: Array, y1: Array, y2: Array, ball: tuple[float, float, float]) -> Array:
    """Return the floor's brightness with a ball of a centre and a radius, lit from the upper left."""
    at1, at2, size = ball
    away = np.hypot(y1 - at1, y2 - at2) / max(size, 1e-6)
    lit = 0.25 + 0.5 * np.clip(1 - np.hypot(y1 - at1 + size / 3, y2 - at2 - size / 3) / max(2 * size, 1e-6), 0, 1)
    return np.where(away < 1, lit, floor)
