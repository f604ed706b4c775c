"""Kinds of files of poses, told by their first lines and not by their names."""

from __future__ import annotations

import os
import re
from types import MappingProxyType

import numpy as np

HEAD = 4096
"""Bytes that are looked at."""

MOST, FIRST = 100, 1e11
"""Most numbers in a line of a trajectory, and what no clock shows in seconds."""

KINDS = MappingProxyType(
    {
        "KITTI": "KITTI: poses as 12 numbers a line, without times; read it with percept_obs.read_kitti",
        "TUM": "a trajectory in TUM's format, seconds, x y z and a quaternion x y z w; read it with read_tum",
        "EuRoC": "a trajectory in EuRoC's format, nanoseconds,x,y,z and a quaternion w,x,y,z; read it with read_euroc",
        "IMU": "an IMU's table in EuRoC's format; read it with percept_obs.recording.imu.read_imu",
        "COLMAP": "images.txt of COLMAP, whose poses are of the world in the camera; read its folder with read_colmap",
        "images": "a list of images with their times, which has no poses: name the file of the trajectory",
        "times": "a list of times alone; of KITTI's it is the times= of read_kitti",
        "calibration": "a calibration of KITTI; read its folder with percept_obs.read_folder",
        "matrices": "matrices 4 x 4, 16 numbers a line: leave the last four out, and read it with read_kitti",
        "bag": "a bag of ROS: export its topic as a text file, for example with evo_traj bag FILE TOPIC --save_as_tum",
        "UTF-16": "text in UTF-16: save it as UTF-8",
        "decimal commas": "a table of numbers with decimal commas: write points, and commas or blanks between numbers",
        "packed": "a workbook or another archive: save its table as CSV, or unpack it",
        "twelve": "12 numbers a line, whose first three of each four are no rotation, as they are in KITTI's poses",
        "seconds": "8 numbers with commas and times in seconds: TUM's have blanks between them, EuRoC's nanoseconds",
        "wide": "lines of over a hundred numbers, and no trajectory",
        "binary": "no text: of COLMAP's *.bin and of recordings read the folder with percept_obs.read_folder",
    }
)
"""Sentences that say of a file what it is, and how to read it, by its kind."""


def kind_of(path: str | os.PathLike[str]) -> str:
    """Return the kind of a file, one of `KINDS`, or "" for another one."""
    with open(path, "rb") as file:
        head = file.read(HEAD)
    if head.startswith((b"#ROSBAG", b"\x89MCAP")):
        return "bag"
    if head.startswith((b"PK\3\4", b"\x1f\x8b")):
        return "packed"
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "UTF-16"
    if b"\0" in head:
        return "binary"
    text = head.decode("utf-8-sig", errors="replace")
    line = next((line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")), "")
    apart = re.split(r"[;\s]+", line.strip())
    if line.count(",") > 1 and len(apart) > 1 and all(re.fullmatch(r"-?\d+(,\d+)?", cell) for cell in apart):
        return "decimal commas"
    cells = [cell for cell in re.split(r"[,\s]+", line) if cell]
    numbers = [_number(cell) for cell in cells]
    count = sum(number is not None for number in numbers)
    if len(cells) == 13 and re.fullmatch(r"P\d:", cells[0]):
        return "calibration"
    if count < len(cells):
        if len(cells) == 10 and count == 9 and not cells[9][-1].isdigit():
            return "COLMAP"
        return "images" if len(cells) in (2, 4) and numbers[0] is not None and "." in cells[1] else ""
    if count > MOST:
        return "wide"
    if count in (12, 16):
        rows = np.array(numbers[:12], dtype=float).reshape(3, 4)[:, :3]
        if np.allclose(rows @ rows.T, np.eye(3), atol=0.01):
            return "KITTI" if count == 12 else "matrices"
    if count == 12 and "," not in line:
        return "twelve"
    if "," in line:
        poses = "seconds" if (numbers[0] or 0) < FIRST and re.search(r"(?m)^\s*\d+\.", text) else "EuRoC"
        return "IMU" if count == 7 else poses if count >= 8 else ""
    return "TUM" if count >= 8 else "times" if count == 1 else ""


def refuse_others(path: str | os.PathLike[str], wanted: str) -> None:
    """Raise ValueError if a file is of another kind than the wanted one, and not of an unknown one."""
    # EuRoC's format with another clock is read, too.
    also = "seconds" if wanted == "EuRoC" else ""
    if (kind := kind_of(path)) not in ("", wanted, also):
        raise ValueError(f"{os.fspath(path)}: this is {KINDS[kind]}")


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None
