"""Files of poses: TUM's and EuRoC's, whose quaternions have different orders and whose clocks different ticks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from percept_obs.recording.poses import Poses
from percept_obs.recording.text_table import NANOSECONDS, SECONDS, Clock, PathLike, read_table, write_table
from percept_obs.validation import checked


@dataclass(frozen=True)
class _Format:
    """Names of the columns in their order; positions and quaternions are stated as x, y, z and x, y, z, w."""

    columns: tuple[str, ...]
    position: tuple[str, ...]
    orientation: tuple[str, ...]
    separator: str
    example: str

    def read(self, path: PathLike, clock: Clock) -> Poses:
        table = read_table(path, self.columns, self.separator, self.example)
        place, turn = (
            np.stack([table.numbers(name, gaps=False) for name in names], axis=-1)
            for names in (self.position, self.orientation)
        )
        try:
            return Poses(table.seconds(self.columns[0], clock), place, turn)
        except ValueError as error:
            raise ValueError(f"{table.file}: {error}") from None

    def write(self, path: PathLike, poses: Poses, clock: Clock, whole: bool) -> None:
        numbers = dict(zip(self.position, poses.position.T, strict=True))
        numbers |= dict(zip(self.orientation, poses.orientation.T, strict=True))
        cells = [clock.readings(poses.time, whole)]
        cells += [[repr(value) for value in numbers[name].tolist()] for name in self.columns[1:]]
        separator = "," if self.separator == "," else " "
        write_table(path, [f"#{separator.join(self.columns)}"], zip(*cells, strict=True), separator)


TUM = _Format(
    ("timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"),
    ("tx", "ty", "tz"),
    ("qx", "qy", "qz", "qw"),
    r"\s+",
    "1305031102.1758 1.3405 0.6266 1.6575 0.6574 0.6126 -0.2949 -0.3248",
)
EUROC = _Format(
    ("timestamp", "p_x", "p_y", "p_z", "q_w", "q_x", "q_y", "q_z"),
    ("p_x", "p_y", "p_z"),
    ("q_x", "q_y", "q_z", "q_w"),
    ",",
    "1403636580838555648,4.688319,-1.786938,0.783338,0.534108,-0.153029,-0.827383,-0.082152",
)


@checked
def read_tum(path: PathLike, clock: Clock = SECONDS) -> Poses:
    """Read poses from a file in the format of the TUM RGB-D benchmark.

    Parameters
    ----------
    path : path
        A pose a row, parted by spaces: seconds, position x y z, quaternion x y z w.  Lines with # are comments.
    clock : Clock
        How its times are read; give ``Clock(zero=...)`` to bring them onto the clock of the tracks.

    Returns
    -------
    Poses
        ``read_tum(path).motion()`` is the motion for `Recording.from_csv`.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it has too few columns, a cell is not a finite number, times do not increase, or a quaternion has not the
        length 1.

    Notes
    -----
    J. Sturm et al., A benchmark for the evaluation of RGB-D SLAM systems (IROS 2012).

    Examples
    --------
    >>> from percept_obs.recording.worked import worked_folder
    >>> len(read_tum(worked_folder() / "poses.txt").time)
    81
    """
    return TUM.read(path, clock)


@checked
def read_euroc(path: PathLike, clock: Clock = NANOSECONDS) -> Poses:
    """Read poses from a file in the format of the EuRoC benchmark's ``state_groundtruth_estimate0/data.csv``.

    Parameters
    ----------
    path : path
        A pose a row, parted by commas: nanoseconds, position x, y, z, quaternion w, x, y, z.  Further columns, such as
        velocities, are left out, and lines with # are comments.
    clock : Clock
        How its times are read.  ``Clock(zero=1403636580838555648, tick=1e-9)`` counts from there, exactly; without a
        zero 19 digits do not fit, and times are good to 0.2 microseconds.

    Returns
    -------
    Poses
        Of the body; `Poses.mounted` gives those of a camera on it.

    Raises
    ------
    FileNotFoundError, ValueError
        As for `read_tum`.

    Notes
    -----
    M. Burri et al., The EuRoC micro aerial vehicle datasets (International Journal of Robotics Research, 2016).

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from percept_obs.recording.worked import worked_folder
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder) / "data.csv"
    ...     write_euroc(file, read_tum(worked_folder() / "poses.txt"))
    ...     read_euroc(file).position[1].tolist()
    [0.011, 0.0044, 0.0025]
    """
    return EUROC.read(path, clock)


@checked
def write_tum(path: PathLike, poses: Poses, clock: Clock = SECONDS) -> None:
    """Write poses as `read_tum` reads them, with all their digits.

    Parameters
    ----------
    path : path
    poses : Poses
    clock : Clock
        Of the file.
    """
    TUM.write(path, poses, clock, whole=False)


@checked
def write_euroc(path: PathLike, poses: Poses, clock: Clock = NANOSECONDS) -> None:
    """Write poses as `read_euroc` reads them; times are rounded to whole ticks of the clock, as the format has them.

    Parameters
    ----------
    path : path
    poses : Poses
    clock : Clock
        Of the file.
    """
    EUROC.write(path, poses, clock, whole=True)
