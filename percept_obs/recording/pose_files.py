"""Files of poses: TUM's and EuRoC's, whose quaternions have different orders and whose clocks different ticks."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from percept_obs.recording.poses import Poses
from percept_obs.recording.text_table import NANOSECONDS, SECONDS, Clock, PathLike, read_table
from percept_obs.validation import checked, load_pandas, write_whole

TUM = ("timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw")
TUM_EXAMPLE = "1305031102.1758 1.3405 0.6266 1.6575 0.6574 0.6126 -0.2949 -0.3248"
EUROC = ("timestamp", "p_x", "p_y", "p_z", "q_w", "q_x", "q_y", "q_z")
EUROC_EXAMPLE = "1403636580838555648,4.688319,-1.786938,0.783338,0.534108,-0.153029,-0.827383,-0.082152"


@checked
def read_tum(path: PathLike, clock: Clock = SECONDS) -> Poses:
    """Return the poses in a file in the format of the TUM RGB-D benchmark.

    ``read_tum(path).motion()`` is the motion for `Recording.from_csv`.

    Parameters
    ----------
    path : path
        Rows of seconds, position x y z and quaternion x y z w, separated by spaces.  Lines with # are comments.
    clock : Clock
        Of the file; give ``Clock(zero=...)`` to bring its times onto the clock of the tracks.

    Returns
    -------
    Poses
        In seconds and metres.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is a file of COLMAP, it has too few columns, a cell is not a finite number, times do not increase, or a
        quaternion has not the length 1.

    See Also
    --------
    read_euroc : Poses of the EuRoC benchmark.
    rigid_from_poses : The motion from arrays.

    Notes
    -----
    J. Sturm et al., A benchmark for the evaluation of RGB-D SLAM systems (IROS 2012).

    Examples
    --------
    >>> from percept_obs.recording.worked import worked_folder
    >>> len(read_tum(worked_folder() / "poses.txt").time)
    81
    """
    if Path(path).is_file() and _is_colmap(Path(path)):
        raise ValueError(
            f"{os.fspath(path)} has the images of COLMAP, whose poses are of the world in the camera; read its folder "
            "with percept_obs.recording.colmap.read_colmap"
        )
    return _read(path, clock, TUM, r"\s+", TUM_EXAMPLE)


def _is_colmap(path: Path) -> bool:
    """Return True for a file whose rows are IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME."""
    with open(path, encoding="utf-8", errors="replace") as lines:
        first = next((line for line in lines if line.strip() and not line.startswith("#")), "").split()
    return len(first) == 10 and not first[9][-1].isdigit()


@checked
def read_euroc(path: PathLike, clock: Clock = NANOSECONDS) -> Poses:
    r"""Return the body's poses in a file of the EuRoC benchmark, ``state_groundtruth_estimate0/data.csv``.

    `Poses.mounted` gives those of a camera on it.

    Parameters
    ----------
    path : path
        Rows of nanoseconds, position x, y, z and quaternion w, x, y, z, separated by commas.  Further columns, such as
        velocities, are left out, and lines with # are comments.
    clock : Clock
        Of the file.  ``Clock(zero=1403636580838555648, tick=1e-9)`` counts from there, exactly; without a
        zero 19 digits do not fit, and times are good to 0.2 microseconds.

    Returns
    -------
    Poses
        In seconds and metres.

    Raises
    ------
    FileNotFoundError, ValueError
        As for `read_tum`.

    See Also
    --------
    read_tum : Poses of the TUM benchmark.

    Notes
    -----
    M. Burri et al., The EuRoC micro aerial vehicle datasets (International Journal of Robotics Research, 2016).

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder) / "data.csv"
    ...     _ = file.write_text("0,1,2,3,1,0,0,0\n5000000,1,2,4,1,0,0,0\n")
    ...     read_euroc(file).time.tolist()
    [0.0, 0.005]
    """
    return _read(path, clock, EUROC, ",", EUROC_EXAMPLE)


@checked
def write_tum(path: PathLike, poses: Poses) -> None:
    """Write poses as `read_tum` reads them, with all their digits.

    Parameters
    ----------
    path : path
    poses : Poses

    See Also
    --------
    read_tum : Reads the file.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from percept_obs.recording.worked import worked_folder
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_tum(pathlib.Path(folder) / "poses.txt", read_tum(worked_folder() / "poses.txt"))
    ...     print((pathlib.Path(folder) / "poses.txt").read_text().splitlines()[0])
    #timestamp tx ty tz qx qy qz qw
    """
    pd = load_pandas()
    cells = (poses.time, *poses.position.T, *poses.orientation.T)
    table = pd.DataFrame(dict(zip(TUM, cells, strict=True)))
    write_whole(Path(path), f"#{table.to_csv(sep=' ', index=False, lineterminator=chr(10))}".encode())


def _read(path: PathLike, clock: Clock, names: tuple[str, ...], separator: str, example: str) -> Poses:
    """Read poses from columns of these names: a time, positions x, y, z and a quaternion in any order."""
    table = read_table(path, names, separator, example)
    order = sorted(names[4:], key=lambda name: "xyzw".index(name[-1]))
    position, orientation = (
        np.stack([table.numbers(name, gaps=False) for name in columns], axis=-1) for columns in (names[1:4], order)
    )
    try:
        return Poses(table.seconds(names[0], clock), position, orientation)
    except ValueError as error:
        raise ValueError(f"{table.file}: {error}") from None
