"""Models of COLMAP, binary or text: its cameras, images and points become a camera's poses and tracks of points."""

from __future__ import annotations

import math
import os
import re
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from percept_obs.compile import Array, Indices
from percept_obs.recording import Recording
from percept_obs.recording.pixels import Lens, PixelCamera
from percept_obs.recording.poses import LIMITS, Poses
from percept_obs.recording.text_table import SECONDS, Clock, PathLike, existing
from percept_obs.recording.track_table import refuse_parts, tracks_of_points
from percept_obs.system.surfaces import pinhole
from percept_obs.validation import checked, load_pandas, positive

FISHEYES = ("OPENCV_FISHEYE", "SIMPLE_RADIAL_FISHEYE", "RADIAL_FISHEYE")
OWN_LENS = ("FOV", "THIN_PRISM_FISHEYE")
"""Models with a lens that no `PixelCamera` has."""
MODELS = MappingProxyType(
    {
        "SIMPLE_PINHOLE": (0, 0, 1, 2),
        "PINHOLE": (0, 1, 2, 3),
        "SIMPLE_RADIAL": (0, 0, 1, 2, 3),
        "RADIAL": (0, 0, 1, 2, 3, 4),
        "OPENCV": tuple(range(8)),
        "OPENCV_FISHEYE": tuple(range(8)),
        "FULL_OPENCV": tuple(range(12)),
        "FOV": tuple(range(5)),
        "SIMPLE_RADIAL_FISHEYE": (0, 0, 1, 2, 3),
        "RADIAL_FISHEYE": (0, 0, 1, 2, 3, 4),
        "THIN_PRISM_FISHEYE": tuple(range(12)),
    }
)
"""Places of fx, fy, cx, cy and the lens among the parameters of COLMAP's models, in the order of their numbers."""


@checked
@dataclass(frozen=True, eq=False)
class ColmapModel:
    """A camera's poses and the points that it saw, in the model's own unit of length.

    Parameters
    ----------
    poses : Poses
        Of the K images, in the order of their times.
    camera : PixelCamera
    points : array of shape (L, 3)
        Places in the world.
    seen : array of shape (N, 2) of int
        Image and point of each of N observations, by image.
    pixels : array of shape (N, 2)
        (u, v) of each.
    numbers : tuple of int
        Numbers of the points in the files.

    See Also
    --------
    read_colmap : Reads it.

    Examples
    --------
    >>> from percept_obs.recording.pose_files import read_tum
    >>> from percept_obs.recording.worked import WORKED_CAMERA, worked_folder
    >>> poses, seen = read_tum(worked_folder() / "poses.txt"), np.array([[0, 0], [1, 0]])
    >>> pixels = np.array([[320.0, 240.0], [322.0, 240.0]])
    >>> model = ColmapModel(poses, WORKED_CAMERA, np.array([[0.0, 0.0, 2.0]]), seen, pixels, (7,))
    >>> model.recordings()[0].source
    'COLMAP, point 7'
    """

    poses: Poses
    camera: PixelCamera
    points: Array
    seen: Indices
    pixels: Array
    numbers: tuple[int, ...]

    def recordings(
        self,
        name: str = "COLMAP",
        pixel_sigma: float | None = None,
        gap: float = math.inf,
        shortest: float = 0.0,
    ) -> tuple[Recording, ...]:
        """Return a recording of each point, its source named; the truth is the model's point from the smoothed pose.

        The noise is in pixels, if it is known; gap and shortest are those of `Recording.from_csv`.
        """
        pd = load_pandas()
        refuse_parts(gap, shortest)
        path, surface = self.poses.path(), pinhole()
        variance = None if pixel_sigma is None else self.camera.variance(pixel_sigma)
        image, place = self.seen.T
        outputs, time, there = self.camera.image(self.pixels), self.poses.time[image], path.at(self.poses.time)
        truths = surface.project(there.rotation[image].inv().apply(self.points[place] - there.position[image]))
        truths[truths[:, -1] <= 0] = np.nan  # a wrong match
        labels, known = pd.Categorical([str(self.numbers[k]) for k in place]), np.ones(len(time), dtype=bool)
        fields: dict[str, Any] = {"names": ("y1", "y2"), "view": surface, "motion": path.motion}
        fields["noise_variance"] = variance
        return tuple(
            Recording(time[rows], outputs[rows], truth=truths[rows], source=source, **fields)
            for rows, source in tracks_of_points(name, labels, time, known, outputs, "point", gap, shortest)
        )


@checked
def read_colmap(folder: PathLike, rate: float | None = None, clock: Clock = SECONDS) -> ColmapModel:
    r"""Return the model in a folder of COLMAP.

    The scale of such a model is arbitrary, and with it every distance.

    Parameters
    ----------
    folder : path
        With cameras.bin, images.bin and points3D.bin, or the same as .txt.
    rate : float, optional
        Images a second; the last number in an image's name counts them, or else their order.
    clock : Clock
        Without a rate the last number in an image's name is its time, by this clock: ``Clock(tick=1e-9)`` for EuRoC.

    Raises
    ------
    FileNotFoundError
        If a file is missing.
    ValueError
        If a file is none of COLMAP, there are several cameras or one of another model, or names give no times.

    See Also
    --------
    read_tum : Poses alone.

    Notes
    -----
    J. L. Schönberger and J.-M. Frahm, Structure-from-Motion Revisited (CVPR 2016).

    Examples
    --------
    >>> import pathlib, tempfile
    >>> files = {"cameras": "1 PINHOLE 640 480 500 500 320 240", "points3D": "7 0 0 2 255 255 255 0.5 1 0 2 0"}
    >>> files["images"] = "1 1 0 0 0 0 0 0 1 0.png\n320 240 7\n2 1 0 0 0 -0.1 0 0 1 1.png\n295 240 7"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     for name, text in files.items():
    ...         _ = (pathlib.Path(folder) / f"{name}.txt").write_text(text)
    ...     read_colmap(folder, rate=10).poses.position[1, 0].item()
    0.1
    """
    if rate is not None:
        positive(rate=rate)
        if clock != SECONDS:
            raise ValueError(f"the rate is {rate} and the clock {clock}; give one of the two for the images' times")
    place = Path(folder)
    try:
        lenses, heads, bodies, world = (_binary if os.path.isfile(place / "cameras.bin") else _text)(place)
        names = [head[9] for head in heads]
        numbers = np.array([head[1:8] for head in heads], dtype=float).reshape(len(heads), 7)
        used = {head[8] for head in heads}
        if (np.abs(np.linalg.norm(numbers[:, :4], axis=1) - 1) > LIMITS.unit).any():
            raise ValueError(
                "images without a quaternion w, x, y, z of the length 1; write it after the image's number"
            )
        if len(bodies) != len(heads) or not all(names) or len(heads) < 2:
            raise ValueError(f"{len(heads)} images, with {len(bodies)} rows of points; expected two images, and names")
        if len(used) > 1:
            raise ValueError(
                f"{len(used)} cameras, {', '.join(sorted(used)[:5])}; a recording is of one: make it with a single one"
            )
        (model, width, height, *parameters) = lenses[min(used)]
        if model not in MODELS or model in OWN_LENS:
            told = ", ".join(name for name in MODELS if name not in OWN_LENS)
            raise ValueError(f"a camera of the model {model}, none of {told}: undistort the images")
        if len(parameters) <= max(MODELS[model]):
            raise ValueError(f"a camera {model} with {len(parameters)} parameters, not {max(MODELS[model]) + 1}")
        time = _times(names, rate, clock)
        fx, fy, cx, cy, *lens = (float(parameters[k]) for k in MODELS[model])
        lens = [*lens, *[0.0] * (-len(lens) % 4)]
        kind: Lens = "equidistant" if model in FISHEYES else "radtan"
        camera = PixelCamera((fx, fy), (cx, cy), (int(width), int(height)), lens, kind)
    except (ValueError, KeyError, IndexError, struct.error) as error:
        said = error if type(error) is ValueError else "a file that ends too early or does not fit the others"
        raise ValueError(f"{os.fspath(folder)} is no model of COLMAP with one camera: it has {said}") from None
    order = np.argsort(time)
    turn = Poses(time[order], numbers[order, 4:], numbers[order][:, [1, 2, 3, 0]]).rotation.inv()
    poses = Poses(time[order], -turn.apply(numbers[order, 4:]), turn.as_quat())
    known = {number: k for k, number in enumerate(world)}
    seen: list[tuple[int, int]] = []
    pixels: list[list[float]] = []
    for k, row in enumerate(order):
        kept = {int(number): pixel for *pixel, number in bodies[row][::-1].tolist() if int(number) in known}
        for number, pixel in reversed(kept.items()):  # of a point seen twice, the first
            seen.append((k, known[number]))
            pixels.append(pixel)
    if not seen:
        raise ValueError(f"{os.fspath(folder)} has no point that an image sees")
    return ColmapModel(poses, camera, np.array([*world.values()]), np.array(seen), np.array(pixels), tuple(world))


Parts = tuple[dict[str, list[Any]], list[list[Any]], list[Array], dict[int, list[float]]]
"""Cameras by number, a head and the observations (u, v, point) of each image, and points by number."""


def _text(place: Path) -> Parts:
    """Parts of a model in text files."""
    cameras, images, points = (place / name for name in ("cameras.txt", "images.txt", "points3D.txt"))
    lenses = {row[0]: row[1:] for row in _rows(cameras, 5)}
    lines = _rows(images, 9, every=2)
    heads = [[*head[:9], " ".join(head[9:])] for head in lines[::2]]
    if odd := [head[9] for head, row in zip(heads, lines[1::2], strict=False) if len(row) % 3]:
        raise ValueError(f"below the image {odd[0]!r} a row that is not three numbers for each point: u, v, number")
    bodies = [np.array(row, dtype=float).reshape(-1, 3) for row in lines[1::2]]
    return lenses, heads, bodies, {int(row[0]): [float(cell) for cell in row[1:4]] for row in _rows(points, 4)}


def _binary(place: Path) -> Parts:
    """Parts of a model in binary files, which are little-endian and packed."""
    lenses: dict[str, list[Any]] = {}
    heads, bodies, world = [], [], {}
    data, (count,), at = _packed(place / "cameras.bin")
    for _ in range(count):
        number, model, *size = struct.unpack_from("<iiQQ", data, at)
        name, places = [*MODELS.items()][model]
        many = places[-1] + 1
        lenses[str(number)] = [name, *size, *struct.unpack_from(f"<{many}d", data, at + 24)]
        at += 24 + 8 * many
    data, (count,), at = _packed(place / "images.bin")
    for _ in range(count):
        *head, camera = struct.unpack_from("<i7di", data, at)
        end = data.index(b"\0", at + 64)
        heads.append([*head, str(camera), data[at + 64 : end].decode("utf-8", "replace")])
        (many,) = struct.unpack_from("<Q", data, end + 1)
        seen = np.frombuffer(data, [("pixel", "<2f8"), ("point", "<i8")], many, end + 9)
        bodies.append(np.column_stack([seen["pixel"], seen["point"].astype(float)]))
        at = end + 9 + 24 * many
    data, (count,), at = _packed(place / "points3D.bin")
    for _ in range(count):
        number, *there, many = struct.unpack_from("<Q3d11xQ", data, at)
        world[number] = there
        at += 51 + 8 * many
    return lenses, heads, bodies, world


def _packed(file: Path) -> tuple[bytes, tuple[int], int]:
    """Content of a binary file, the number of things in it, and where the first begins."""
    existing(file, "a folder with cameras.bin, images.bin and points3D.bin")
    data = file.read_bytes()
    return data, struct.unpack_from("<Q", data), 8


def _rows(file: Path, least: int, every: int = 1) -> list[list[str]]:
    """Return the cells of each row, so many in every such one at least; comments are left out."""
    existing(file, "a folder with cameras.txt, images.txt and points3D.txt")
    with open(file, encoding="utf-8") as lines:
        numbered = [(number, line) for number, line in enumerate(lines, 1) if not line.startswith("#")]
    rows = [(number, line.split()) for number, line in numbered if every > 1 or line.strip()]
    if short := [number for number, cells in rows[::every] if len(cells) < least]:
        raise ValueError(f"a row too short, line {short[0]} of {file.name}; expected {least} cells at least")
    return [cells for _, cells in rows]


def _times(names: Sequence[str], rate: float | None, clock: Clock) -> Array:
    """Seconds of images, by the last number in their names or by their order."""
    found = [re.findall(r"\d+(?:\.\d+)?", Path(name).stem)[-1:] for name in names]
    if rate is not None:
        count = np.array([float(number) for each in found for number in each])
        if len(set(count)) < len(names):
            count = np.argsort(np.argsort(names)).astype(float)
        return np.asarray((count - count.min()) / rate)
    if not all(found):
        raise ValueError(f"the image {names[found.index([])]!r} without a number for its time; give its rate")
    time = clock.seconds([number for (number,) in found])
    if len(set(time.tolist())) < len(time):
        raise ValueError(f"images with the same time, among {', '.join(names[:3])}; give a rate")
    return time
