"""Files of poses: TUM's and EuRoC's, whose quaternions and clocks differ, and KITTI's, of matrices without times."""

from __future__ import annotations

import os

import numpy as np

from percept_obs.recording.poses import Poses
from percept_obs.recording.text_table import NANOSECONDS, SECONDS, Clock, PathLike, Repeated, read_table
from percept_obs.validation import checked, load_pandas, positive, write_whole

TUM = ("timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw")
TUM_EXAMPLE = "1305031102.1758 1.3405 0.6266 1.6575 0.6574 0.6126 -0.2949 -0.3248"
EUROC = ("timestamp", "p_x", "p_y", "p_z", "q_w", "q_x", "q_y", "q_z")
FASTEST = 1000.0
"""Metres a second beyond which positions were given in another unit."""
EUROC_EXAMPLE = "1403636580838555648,4.688319,-1.786938,0.783338,0.534108,-0.153029,-0.827383,-0.082152"


@checked
def read_tum(path: PathLike, clock: Clock = SECONDS, repeated: Repeated = "refuse") -> Poses:
    """Return the poses in a file in the format of the TUM RGB-D benchmark.

    ``read_tum(path).motion()`` is the motion for `Recording.from_csv`.

    Parameters
    ----------
    path : path
        Rows of seconds, position x y z and quaternion x y z w, separated by spaces.  Lines with # are comments.
    clock : Clock
        Of the file; give ``Clock(zero=...)`` to bring its times onto the clock of the tracks.
    repeated : "refuse" or "drop"
        What becomes of rows with the time of the row before; dropped ones are counted in a warning.

    Returns
    -------
    Poses
        In seconds and metres.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If its first lines are those of another kind of file, it has too few columns, a cell is not a finite number,
        times do not increase or cannot be, such as nanoseconds read as seconds, or a quaternion has not the length 1.

    Warns
    -----
    Unlikely
        If rows are dropped, or a spreadsheet has rounded the times.

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
    return _read(path, clock, repeated, TUM, r"\s+", TUM_EXAMPLE, "TUM")


@checked
def read_euroc(path: PathLike, clock: Clock = NANOSECONDS, repeated: Repeated = "refuse") -> Poses:
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
    repeated : "refuse" or "drop"
        As for `read_tum`.

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
    return _read(path, clock, repeated, EUROC, ",", EUROC_EXAMPLE, "EuRoC")


@checked
def read_kitti(path: PathLike, times: PathLike | None = None, rate: float | None = None) -> Poses:
    r"""Return the poses in a file of the KITTI odometry benchmark, such as ``poses/00.txt``, which has no times.

    Parameters
    ----------
    path : path
        Rows of 12 numbers, R beside p of the left camera, row by row.
    times : path, optional
        The sequence's ``times.txt``, a number of seconds in each row.
    rate : float, optional
        Poses a second instead; 10 of KITTI's cameras.

    Returns
    -------
    Poses
        Of the left camera, in metres.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If neither times nor a rate are given, or both, their number is another, or the file has no such rows.

    See Also
    --------
    read_tum : Poses with times.

    Notes
    -----
    A. Geiger, P. Lenz and R. Urtasun, Are we ready for autonomous driving? (CVPR 2012).

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder) / "00.txt"
    ...     _ = file.write_text("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0.9\n")
    ...     read_kitti(file, rate=10).position[1].tolist()
    [0.0, 0.0, 0.9]
    """
    names = tuple(f"{letter}{row}" for row in "123" for letter in ("r1", "r2", "r3", "p"))
    table = read_table(path, names, r"\s+", "1 0 0 0 0 1 0 0 0 0 1 0", kind="KITTI")
    rows = np.stack([table.numbers(name, gaps=False) for name in names], axis=-1).reshape(-1, 3, 4)
    if (times is None) == (rate is None):
        raise ValueError(f"{table.file}: KITTI's poses have no times; give times='times.txt', or rate=10, not both")
    if times is not None:
        time = read_table(times, ("time",), r"\s+", "1.036224e-01", kind="times").steps("time", SECONDS, "refuse")[0]
    elif rate is not None:
        positive(rate=rate)
        time = np.arange(len(rows)) / rate
    if len(time) != len(rows):
        raise ValueError(f"{table.file} has {len(rows)} poses, and {os.fspath(times or '')} {len(time)} times")
    try:
        return _moving(Poses(time, rows[:, :, 3], rows[:, :, :3]))
    except ValueError as error:
        raise ValueError(f"{table.file}: {error}") from None


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
    write_whole(path, f"#{table.to_csv(sep=' ', index=False, lineterminator=chr(10))}".encode())


def _read(
    path: PathLike, clock: Clock, repeated: Repeated, names: tuple[str, ...], separator: str, example: str, kind: str
) -> Poses:
    """Read poses from columns of these names: a time, positions x, y, z and a quaternion in any order."""
    table = read_table(path, names, separator, example, kind=kind)
    order = sorted(names[4:], key=lambda name: "xyzw".index(name[-1]))
    position, orientation = (
        np.stack([table.numbers(name, gaps=False) for name in columns], axis=-1) for columns in (names[1:4], order)
    )
    time, kept = table.steps(names[0], clock, repeated)
    try:
        return _moving(Poses(time, position[kept], orientation[kept]))
    except ValueError as error:
        raise ValueError(f"{table.file}: {error}") from None


def _moving(poses: Poses) -> Poses:
    """Return poses; refuse speeds that no camera has."""
    speed = float(np.median(np.linalg.norm(np.diff(poses.position, axis=0), axis=1) / np.diff(poses.time)))
    if speed > FASTEST:
        raise ValueError(f"a typical speed is {speed:.4g} m/s, which cannot be; are the positions in millimetres?")
    return poses
