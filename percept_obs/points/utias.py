"""The UTIAS landmarks as one state: all of them at once, entering and leaving the camera's view."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from percept_obs.points.bodies import independent_points
from percept_obs.recording import Recording
from percept_obs.recording.utias import LONGEST_GAP, PIXEL_SIGMA, utias_tables
from percept_obs.system.motion import rigid


def load_utias_points(path: str | os.PathLike[str] | None = None, landmarks: Sequence[int] | None = None) -> Recording:
    """All landmarks that the moving camera follows, as points of one state in its frame.

    Parameters
    ----------
    path : path, optional
        See `find_utias`.
    landmarks : sequence of int, optional
        Which of them; all that have a track when left out, in increasing order.

    Returns
    -------
    Recording
        Images of the tracks of `utias_tables`, from the first track's beginning to the last one's end, NaN between
        them.  The truth has all landmarks at all times, from the fitted poses; `distances` has the independent
        ``"stereo"`` depth.

    Raises
    ------
    FileNotFoundError, DatasetUnavailable, ValueError
        See `find_utias`; also if a landmark has no track.
    """
    tables = utias_tables(path)
    camera, lens = tables.camera, tables.intrinsics
    followed = sorted({track.landmark_id for track in tables.tracks})
    chosen = followed if landmarks is None else list(landmarks)
    missing = sorted(set(chosen) - set(followed))
    if missing or len(set(chosen)) != len(chosen) or not chosen:
        raise ValueError(f"the landmarks are {chosen}; name some of {followed}, each once")
    tracks = [track for track in tables.tracks if track.landmark_id in chosen]
    first = min(int(track.sample[0]) for track in tracks)
    samples = np.arange(first, max(int(track.sample[-1]) for track in tracks) + 1)

    outputs = np.full((len(samples), len(chosen), 2), np.nan)
    stereo = np.full((len(samples), len(chosen)), np.nan)
    for track in tracks:
        rows, column = track.sample - first, chosen.index(track.landmark_id)
        outputs[rows, column] = (track.pixels - (lens.cx, lens.cy)) / (lens.fx, lens.fy)
        stereo[rows, column] = track.stereo_depth
    to_camera = Rotation.from_quat(camera.orientation[samples]).inv()
    places = [to_camera.apply(tables.landmarks[k] - camera.position[samples]) for k in chosen]
    motion = rigid(-camera.angular_velocity, camera.velocity, np.zeros(3), times=camera.time)
    return Recording(
        camera.time[samples],
        outputs,
        ("y1", "y2"),
        independent_points(motion, len(chosen)),
        motion,
        truth=np.hstack(places),
        noise_variance=float(np.mean((PIXEL_SIGMA / np.array([lens.fx, lens.fy])) ** 2)),
        distances={"stereo": stereo},
        source=f"UTIAS, {len(chosen)} landmarks, {len(tracks)} tracks",
    )


OUT_OF_SIGHT = LONGEST_GAP
"""Seconds without a sample after which a track has ended."""
