"""Folders of recordings: COLMAP's models, and the benchmarks EuRoC, TUM and KITTI."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from percept_obs.recording.camera_files import Mount, read_mount
from percept_obs.recording.colmap import ColmapModel, read_colmap
from percept_obs.recording.first_lines import kind_of
from percept_obs.recording.imu import read_imu
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.pose_files import read_euroc, read_kitti, read_tum
from percept_obs.recording.poses import Poses
from percept_obs.recording.text_table import PathLike, Repeated
from percept_obs.system.motion import Motion
from percept_obs.validation import checked, positive


@checked
@dataclass(frozen=True, eq=False)
class Folder:
    """Contents of a recording's folder that could be read; None for each part that is not there.

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

    Returns
    -------
    Folder
        With its `sentence`.

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
    positive(rate=1.0 if rate is None else rate)
    if not os.path.isdir(place):
        raise FileNotFoundError(f"there is no folder {str(path)[:300]!r}; name one of COLMAP, EuRoC, TUM or KITTI")
    readers = {"COLMAP": _colmap, "EuRoC": _euroc, "KITTI": _kitti, "TUM": _tum}
    for kind, read in readers.items():
        if found := read(place, rate, repeated):
            said, fields = found
            return Folder(kind, f"This is a folder of {kind}, with {', '.join(said)}.", **fields)
    there = ", ".join(sorted(each.name for each in place.iterdir())[:8]) or "nothing"
    raise ValueError(
        f"{os.fspath(path)} is no folder of COLMAP (cameras.bin or .txt), EuRoC (mav0), TUM (a trajectory) or KITTI "
        f"(poses beside times.txt and calib.txt); it has {there}"
    )


Found = tuple[list[str], dict[str, Any]] | None
"""Parts of the sentence, and the fields of `Folder`; None where the folder is of another kind."""


def _colmap(place: Path, rate: float | None, repeated: Repeated) -> Found:
    """Model of COLMAP."""
    for folder in (place, place / "sparse", place / "sparse" / "0"):
        if any((folder / f"images.{ending}").is_file() for ending in ("bin", "txt")):
            model = read_colmap(folder, rate)
            said = [f"{len(model.poses.time)} images", f"{len(model.points)} points in {folder}"]
            return said, {"poses": model.poses, "camera": model.camera, "model": model}
    return None


def _euroc(place: Path, rate: float | None, repeated: Repeated) -> Found:
    """Sequence of EuRoC or TUM VI, of its first camera."""
    said: list[str] = []
    fields: dict[str, Any] = {}
    place = place / "mav0" if (place / "mav0").is_dir() else place
    for file in place.glob("cam0/sensor.yaml"):
        fields |= {"camera": PixelCamera.from_yaml(file), "mount": read_mount(file)}
        said.append("the camera cam0 and its mount")
    for file in place.glob("imu0/data.csv"):
        fields["imu"] = read_imu(file, repeated=repeated)
        said.append("an IMU")
    for file in [*place.glob("state_groundtruth*/data.csv"), *place.glob("mocap0/data.csv")][:1]:
        poses = read_euroc(file, repeated=repeated)
        fields["poses"] = poses.mounted(*fields["mount"]) if fields.get("mount") else poses
        said.append(
            f"{len(poses.time)} poses in {file.parent.name}, of the {'camera' if 'mount' in fields else 'body'}"
        )
    return (said, fields) if {"imu", "poses"} & {*fields} else None


def _kitti(place: Path, rate: float | None, repeated: Repeated) -> Found:
    """Sequence of KITTI's odometry, of its left camera."""
    near = [*place.glob("*.txt"), place.parent.parent / "poses" / f"{place.name}.txt"]
    files = [file for file in near if file.is_file() and kind_of(file) == "KITTI"]
    if not files:
        return None
    times, calibration = place / "times.txt", place / "calib.txt"
    poses = read_kitti(files[0], *((times, None) if times.is_file() else (None, rate)))
    said, fields = [f"{len(poses.time)} poses in {files[0].name}"], {"poses": poses}
    if calibration.is_file() and kind_of(calibration) == "calibration":
        first = calibration.read_text(encoding="utf-8").partition("\n")[0].split()
        fx, _, cx, _, _, fy, cy = map(float, first[1:8])
        return [*said, "the left camera"], {**fields, "camera": PixelCamera((fx, fy), (cx, cy))}
    return said, fields


def _tum(place: Path, rate: float | None, repeated: Repeated) -> Found:
    """Sequence of TUM's benchmark; of several trajectories, the one named groundtruth."""
    files = sorted(file for file in place.glob("*.txt") if kind_of(file) == "TUM")
    files.sort(key=lambda file: "groundtruth" not in file.name)
    if not files:
        return None
    poses = read_tum(files[0], repeated=repeated)
    others = ", ".join(file.name for file in files[1:])
    said = [f"{len(poses.time)} poses in {files[0].name}", *([f"and did not read {others}"] if others else [])]
    return said, {"poses": poses}
