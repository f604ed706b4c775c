"""Write recordings as a table that `Recording.from_csv` reads."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from percept_obs.recording import Recording
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.text_table import PathLike
from percept_obs.validation import checked, load_pandas, write_whole


@checked
def write_tracks(path: PathLike, recordings: Sequence[Recording], camera: PixelCamera | None = None) -> None:
    """Write recordings of single points, so that ``Recording.from_csv(path, motion, point="point_id")`` reads them.

    Parameters
    ----------
    path : path
    recordings : sequence of Recording
        With the same outputs and the same measured distances.
    camera : PixelCamera, optional
        Then columns u and v of pixels are written, as its lens shows them; image coordinates when left out.

    Raises
    ------
    ValueError
        If there are no recordings, their outputs or views differ, the path is a folder, or pixels are asked for and it
        is no pinhole with both image coordinates.

    See Also
    --------
    Recording.from_csv : Reads the table.

    Notes
    -----
    The columns are time, point_id, the outputs, depth (of the surface, empty where it is not known; left out if no
    recording has a truth), and the measured distances by their names.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from percept_obs import Camera, record, scenarios
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder) / "tracks.csv"
    ...     write_tracks(file, [record(scenarios.ma2005_eq35(), 1, Camera(0.5))])
    ...     print(file.read_text().splitlines()[0])
    time,point_id,y1,y2,depth
    """
    if not len(recordings):
        raise ValueError("there are no recordings to write; give at least one")
    first = recordings[0]
    for each in recordings:
        if (each.names, set(each.distances)) != (first.names, set(first.distances)):
            raise ValueError(f"the recordings {first.source!r} and {each.source!r} have different outputs or distances")
        if not each.view.fits(first.view):
            raise ValueError(f"the recordings are of the {first.view.name} and the {each.view.name}; write two files")
        if each.outputs.ndim != 2:
            raise ValueError(f"the recording {each.source!r} is of several points; a table has recordings of one point")
    if camera is not None and (first.imaging_surface.name, first.names) != ("pinhole", ("y1", "y2")):
        raise ValueError(
            f"the recordings have {', '.join(first.names)} of the {first.view.name}; pixels need y1 and y2 of the "
            "pinhole: leave camera out"
        )
    pd = load_pandas()
    known = any(each.truth is not None for each in recordings)
    tables = []
    for number, each in enumerate(recordings):
        shown = camera.pixels(each.outputs) if camera else each.outputs
        columns = {"time": each.time, "point_id": number}
        columns |= dict(zip(("u", "v") if camera else first.names, shown.T, strict=True))
        if known:
            columns["depth"] = np.nan if each.truth is None else each.distance
        tables.append(pd.DataFrame(columns | {name: each.distances[name] for name in first.distances}))
    write_whole(path, pd.concat(tables).to_csv(index=False, lineterminator="\n").encode())
