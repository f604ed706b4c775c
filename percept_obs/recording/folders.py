"""Folders of recordings: COLMAP's models, and the benchmarks EuRoC, TUM and KITTI."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from percept_obs.recording.camera_files import Mount, read_mount
from percept_obs.recording.colmap import ColmapModel, read_colmap
from percept_obs.recording.first_lines import kind_of
from percept_obs.recording.imu import read_imu
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.pose_files import read_euroc, read_kitti, read_tum
from percept_obs.recording.poses import Poses
from percept_obs.recording.text_table import PathLike, Repeated
from percept_obs.system.motion import Motion
from percept_obs.validation import checked


@dataclass(frozen=True, eq=False)
class Folder:
    """What a folder of a recording has; None for what it has not.

    Parameters
    ----------
    kind : str
        "COLMAP", "EuRoC", "TUM" or "KITTI".
    sentence : str
        What was found, and where.
    poses : Poses, optional
        Of the camera, if its mount is known, else of the body.
    camera : PixelCamera, optional
    mount : Mount, optional
        Of the camera on the body.
    imu : Motion, optional
    model : ColmapModel, optional

    See Also
    --------
    read_folder : Makes it.

    Examples
    --------
    >>> from percept_obs.recording.worked import worked_folder
    >>> read_folder(worked_folder()).kind
    'TUM'
    """

    kind: str
    sentence: str
    poses: Poses | None = None
    camera: PixelCamera | None = None
    mount: Mount | None = None
    imu: Motion | None = None
    model: ColmapModel | None = None


@checked
def read_folder(path: PathLike, rate: float | None = None, repeated: Repeated = "refuse") -> Folder:
    """Return what fits of a folder of COLMAP, EuRoC, TUM or KITTI, with a sentence that says what was found.

    Parameters
    ----------
    path : path
        A model's folder or one with ``sparse/0``, one with ``mav0``, one with a trajectory in TUM's format, or a
        sequence of KITTI's odometry, whose poses may be in ``../../poses``.
    rate : float, optional
        Images a second, where no file has their times.
    repeated : "refuse" or "drop"
        As for `read_tum`.

    Raises
    ------
    FileNotFoundError
        If there is no such folder.
    ValueError
        If it is none of them, or a file in it is refused.

    See Also
    --------
    read_tum, read_euroc, read_kitti : Files of poses.

    Examples
    --------
    >>> from percept_obs.recording.worked import worked_folder
    >>> read_folder(worked_folder()).sentence
    'This is a folder of TUM, with 81 poses in poses.txt.'
    """
    place = Path(path)
    if not place.is_dir():
        raise FileNotFoundError(f"there is no folder {os.fspath(path)!r}; name one of COLMAP, EuRoC, TUM or KITTI")
    readers: tuple[Callable[[Path, float | None, Repeated], Folder | None], ...] = (_colmap, _euroc, _kitti, _tum)
    for read in readers:
        if found := read(place, rate, repeated):
            return found
    there = ", ".join(sorted(each.name for each in place.iterdir())[:8]) or "nothing"
    raise ValueError(
        f"{os.fspath(path)} is no folder of COLMAP (cameras.bin or .txt), EuRoC (mav0), TUM (a trajectory) or KITTI "
        f"(times.txt and calib.txt); it has {there}"
    )


def _said(kind: str, *found: str) -> str:
    return f"This is a folder of {kind}, with {', '.join(found) or 'nothing that fits'}."


def _colmap(place: Path, rate: float | None, repeated: Repeated) -> Folder | None:
    """A model of COLMAP."""
    for folder in (place, place / "sparse", place / "sparse" / "0"):
        if any((folder / f"images.{ending}").is_file() for ending in ("bin", "txt")):
            model = read_colmap(folder, rate)
            said = _said("COLMAP", f"{len(model.poses.time)} images", f"{len(model.points)} points in {folder}")
            return Folder("COLMAP", said, model.poses, model.camera, model=model)
    return None


def _euroc(place: Path, rate: float | None, repeated: Repeated) -> Folder | None:
    """A sequence of EuRoC or TUM VI, of its first camera."""
    place = place / "mav0" if (place / "mav0").is_dir() else place
    truth = [*place.glob("state_groundtruth*/data.csv"), *place.glob("mocap0/data.csv")]
    imus, sensors = [*place.glob("imu0/data.csv")], [*place.glob("cam0/sensor.yaml")]
    if not (truth or imus):
        return None
    poses = read_euroc(truth[0], repeated=repeated) if truth else None
    camera, mount = (PixelCamera.from_yaml(sensors[0]), read_mount(sensors[0])) if sensors else (None, None)
    imu = read_imu(imus[0], repeated=repeated) if imus else None
    found = [f"{len(poses.time)} poses in {truth[0].parent.name}"] if poses else []
    found += ["the camera cam0 and its mount"] if sensors else ["no mount, so that the poses are the body's"]
    found += ["an IMU"] if imu else []
    if poses and mount:
        poses = poses.mounted(*mount)
    return Folder("EuRoC", _said("EuRoC", *found), poses, camera, mount, imu)


def _kitti(place: Path, rate: float | None, repeated: Repeated) -> Folder | None:
    """A sequence of KITTI's odometry, of its left camera."""
    near = [*place.glob("*.txt"), place.parent.parent / "poses" / f"{place.name}.txt"]
    files = [file for file in near if file.is_file() and kind_of(file) == "KITTI"]
    if not files:
        return None
    times = place / "times.txt"
    poses = read_kitti(files[0], times) if times.is_file() else read_kitti(files[0], rate=rate)
    camera, calib = None, place / "calib.txt"
    if calib.is_file() and kind_of(calib) == "calibration":
        first = calib.read_text(encoding="utf-8").partition("\n")[0].split()[1:]
        matrix = np.array(first, dtype=float).reshape(3, 4)
        camera = PixelCamera((matrix[0, 0], matrix[1, 1]), (matrix[0, 2], matrix[1, 2]))
    found = [f"{len(poses.time)} poses in {files[0].name}", *(["the left camera"] if camera else [])]
    return Folder("KITTI", _said("KITTI", *found), poses, camera)


def _tum(place: Path, rate: float | None, repeated: Repeated) -> Folder | None:
    """A sequence of TUM's benchmark; of several trajectories, the one named groundtruth."""
    files = [file for file in sorted(place.glob("*.txt")) if kind_of(file) == "TUM"]
    if not files:
        return None
    file = next((file for file in files if "groundtruth" in file.name), files[0])
    poses = read_tum(file, repeated=repeated)
    others = [f"not read: {', '.join(each.name for each in files if each != file)}"] if len(files) > 1 else []
    return Folder("TUM", _said("TUM", f"{len(poses.time)} poses in {file.name}", *others), poses)
