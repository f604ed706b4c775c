"""The UTIAS landmarks as one state: all of them at once, entering and leaving the camera's view."""

from __future__ import annotations

import os

import numpy as np

from percept_obs.points.bodies import independent_points
from percept_obs.recording import Recording
from percept_obs.recording.stereo_mat import LONGEST_GAP
from percept_obs.recording.utias import PIXEL_SIGMA, utias_tracks
from percept_obs.validation import checked


@checked
def load_utias_points(path: str | os.PathLike[str] | None = None) -> Recording:
    """Read all landmarks that the moving camera follows, as points of one state in its frame.

    Parameters
    ----------
    path : path, optional
        See `find_utias`, also for the exceptions.

    Returns
    -------
    Recording
        Images of the tracks of `utias_tracks`, from the first track's beginning to the last one's end, NaN between
        them.  The truth has all landmarks at all times, from the fitted poses; `distances` has the independent
        ``"stereo"`` depth.

    See Also
    --------
    percept_obs.recording.utias.load_utias : Each track as a recording of one point.

    Examples
    --------
    >>> from percept_obs.points.utias import load_utias_points
    >>> from percept_obs.recording.utias import UTIAS_CUT
    >>> load_utias_points(UTIAS_CUT).outputs.shape
    (1366, 12, 2)
    """
    tables = utias_tracks(path)
    tracks, followed = tables.tracks, sorted({track.point for track in tables.tracks})
    rows = slice(min(track.first for track in tracks), max(track.last for track in tracks) + 1)
    truth = np.hstack([tables.points[rows, landmark] for landmark in followed])
    source = f"UTIAS, {len(followed)} landmarks, {len(tracks)} tracks"
    view = independent_points(tables.motion, len(followed))
    return tables.recording(rows, followed, view, truth, source, PIXEL_SIGMA)


OUT_OF_SIGHT = LONGEST_GAP
"""Seconds without a sample after which a track has ended."""
