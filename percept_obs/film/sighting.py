"""One pass over a film's pictures: corners of the board, tracks of other corners, small pictures; kept in a cache."""

from __future__ import annotations

import hashlib
import io
import json
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any
from zipfile import BadZipFile

import numpy as np

from percept_obs.compile import Array, Flags, Indices
from percept_obs.film.board import Board
from percept_obs.film.video import Video
from percept_obs.validation import write_whole

VERSION = 4
"""Number of the format of files in the cache."""


@dataclass(frozen=True)
class Limits:
    """Which corners of pictures are followed, and which pictures are kept."""

    widest: int = 1280  # pixels of the longer side in which corners are looked for; larger pictures are made smaller
    most: int = 60  # corners off the board that are followed at once
    shortest: float = 1.0  # seconds that a track lasts at least: a shorter one tells no distance
    often: int = 5  # pictures from one search for new corners to the next, for a search takes longer than following
    apart: int = 24  # pixels between two corners when they are found
    margin: float = 1.7  # size of the area around the board without others, over that of its inner corners
    back: float = 0.3  # pixels by which a corner may miss its place when it is followed forward and back
    small: int = 640  # pixels of the longer side of a small picture, which the lab shows,
    every: float = 0.1  # seconds between two of them,
    most_small: int = 240  # and how many are kept at most


LIMITS = Limits()


@dataclass(frozen=True, eq=False)
class Sighting:
    """Corners in K pictures of a film, in its own pixels.

    `corners` are the board's, shape (K, n, 2), NaN where one is not seen.  `width` is that of the board's edges in
    pixels, and `twice` is true where a marker was seen twice.  The tracks of other corners begin in the pictures
    `first`, last for `length` pictures, and lie one after the other in `tracked`, shape (N, 2).  Small pictures, JPEG
    files of the sizes `sizes` one after the other in `files`, are shown at the times `shown`.
    """

    time: Array
    corners: Array
    width: Array
    twice: Flags
    first: Indices
    length: Indices
    tracked: Array
    shown: Array
    sizes: Indices
    files: Any

    @cached_property
    def tracks(self) -> tuple[tuple[int, Array], ...]:
        """Tracks off the board: the first picture, and pixels, shape (k, 2)."""
        parts = np.split(self.tracked, np.cumsum(self.length)[:-1])
        return tuple(zip(self.first.tolist(), parts, strict=False))

    @cached_property
    def small(self) -> tuple[bytes, ...]:
        """Small pictures, as JPEG files."""
        ends = np.cumsum(self.sizes)
        return tuple(self.files[end - size : end].tobytes() for end, size in zip(ends, self.sizes, strict=True))


def sight(video: Video, board: Board) -> Sighting:
    """Return what is seen in a film, from the cache if it was read before."""
    from platformdirs import user_cache_path

    with open(video.path, "rb") as file:
        content = hashlib.file_digest(file, "sha256").hexdigest()
    squares = board.columns, board.rows, round(board.marker / board.square, 9)  # whose size in metres no picture shows
    name = hashlib.sha256(json.dumps([VERSION, content, squares]).encode()).hexdigest()
    kept = user_cache_path("percept_obs") / "films" / f"{name[:32]}.npz"
    try:
        with open(kept, "rb") as file, np.load(file) as parts:
            return Sighting(**parts)
    except (OSError, ValueError, TypeError, EOFError, BadZipFile):  # not there, or not whole
        sighting = _look(video, board)
    packed = io.BytesIO()
    np.savez(packed, **{name: values for name, values in vars(sighting).items()})
    try:
        kept.parent.mkdir(parents=True, exist_ok=True)
        write_whole(kept, packed.getvalue())
    except OSError:  # the disk is full or closed: the film is read anew next time
        pass
    return sighting


@dataclass
class _Track:
    """Track that is being followed: its first picture, and a pixel a picture."""

    first: int
    pixels: list[Any] = field(default_factory=list)

    def seconds(self, time: list[float]) -> float:
        return time[self.first + len(self.pixels) - 1] - time[self.first]


def _look(video: Video, board: Board) -> Sighting:
    """Return what is seen in the pictures, one after another."""
    import cv2

    from percept_obs.film.sharpness import edge_width

    scale, before = min(1.0, LIMITS.widest / max(video.size)), None
    live: list[_Track] = []
    lasting: list[_Track] = []
    time: list[float] = []
    corners: list[Array] = []
    shown: list[float] = []
    width, twice, small = [], [], []
    for k, (seconds, shot) in enumerate(video.shots("reading the film")):
        picture = shot(scale, "gray")
        time.append(seconds)
        numbers, pixels, doubled = board.detect(picture)
        twice.append(doubled)
        corners.append(np.full((len(board.points), 2), np.nan))
        corners[-1][numbers] = pixels
        width.append(edge_width(picture, corners[-1], board))
        if not shown or seconds - shown[-1] > LIMITS.every - 1e-6:
            coloured = cv2.cvtColor(shot(min(1.0, LIMITS.small / max(video.size)), "rgb24"), cv2.COLOR_RGB2BGR)
            shown.append(seconds)
            small.append(np.frombuffer(cv2.imencode(".jpg", coloured, [cv2.IMWRITE_JPEG_QUALITY, 80])[1], np.uint8))
        if live:
            found, places = _followed(before, picture, np.array([track.pixels[-1] for track in live]))
            lost = [track for track, there in zip(live, found, strict=True) if not there]
            lasting += [track for track in lost if track.seconds(time) >= LIMITS.shortest]
            live = [track for track, there in zip(live, found, strict=True) if there]
            for track, place in zip(live, places[found], strict=True):
                track.pixels.append(place)
        if k % LIMITS.often == 0 and len(live) < LIMITS.most:
            live += [_Track(k, [pixel]) for pixel in _new(picture, corners[-1], [track.pixels[-1] for track in live])]
        before = picture
    lasting += [track for track in live if track.seconds(time) >= LIMITS.shortest]
    lasting.sort(key=lambda track: track.first)
    rows = np.unique(np.linspace(0, len(shown) - 1, LIMITS.most_small).round().astype(int))
    return Sighting(
        np.array(time),
        (np.array(corners) + 0.5) / scale - 0.5,  # the first pixel's centre is at 0
        np.array(width) / scale,
        np.array(twice),
        np.array([track.first for track in lasting], dtype=int),
        np.array([len(track.pixels) for track in lasting], dtype=int),
        (np.concatenate([np.empty((0, 2)), *(track.pixels for track in lasting)]) + 0.5) / scale - 0.5,
        np.array(shown)[rows],
        np.array([len(small[row]) for row in rows]),
        np.concatenate([small[row] for row in rows]),
    )


def _followed(before: Any, now: Any, pixels: Array) -> tuple[Any, Array]:
    """Return which corners were found again, and where, by optical flow forward and back."""
    import cv2

    options: Any = {"winSize": (21, 21), "maxLevel": 3, "criteria": (3, 30, 0.01)}
    start = pixels.astype(np.float32)
    there, good, _ = cv2.calcOpticalFlowPyrLK(before, now, start, None, **options)
    back, well, _ = cv2.calcOpticalFlowPyrLK(now, before, there, None, **options)
    inside = ((there > 10) & (there < np.array(now.shape[::-1]) - 10)).all(axis=1)
    return (good & well).ravel().astype(bool) & (np.linalg.norm(back - start, axis=1) < LIMITS.back) & inside, there


def _new(picture: Any, corners: Array, followed: list[Any]) -> Any:
    """Return new corners, shape (n, 2), off those that are followed and off the board."""
    import cv2

    free = np.full(picture.shape, 255, np.uint8)
    for u, v in followed:
        cv2.circle(free, (round(float(u)), round(float(v))), LIMITS.apart, 0, -1)
    seen = corners[np.isfinite(corners).all(axis=1)]
    if len(seen) >= 3:
        around = seen.mean(axis=0) + LIMITS.margin * (seen - seen.mean(axis=0))
        cv2.fillConvexPoly(free, cv2.convexHull(around.round().astype(np.int32)), 0)
    found = cv2.goodFeaturesToTrack(picture, LIMITS.most - len(followed), 0.02, LIMITS.apart, mask=free)
    return np.empty((0, 2)) if found is None else found[:, 0]
