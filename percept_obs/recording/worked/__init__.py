"""Worked example of a recording of one's own: poses.txt, and tracks.csv with all kinds of columns."""

from pathlib import Path

from percept_obs.recording.pixels import PixelCamera

WORKED_CAMERA = PixelCamera((484.5, 484.5), (321.7, 247.5), (640, 480), (-0.28, 0.09, 0.001, -0.0005))
"""The camera of the worked example, with the distortion of its lens."""


def worked_folder() -> Path:
    """Return the folder with poses.txt and tracks.csv: a camera slides to and fro past two points for four seconds.

    See Also
    --------
    percept_obs.read_tum : Reads the poses.
    percept_obs.Recording : Reads the tracks by ``from_csv``.

    Examples
    --------
    >>> lines = (worked_folder() / "tracks.csv").read_text().splitlines()
    >>> len(lines), lines[5], lines[6]
    (40, 'time,point_id,u,v,depth,laser,remark', '600,near,348.9,265.1,1.196,1.19,')
    """
    return Path(__file__).parent
