"""A film of a board: what is known of its camera, and the distances of its points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from percept_obs.compile import Array
from percept_obs.film.board import Board
from percept_obs.film.lens import Seen
from percept_obs.film.overlay import write_overlay
from percept_obs.film.sighting import Sighting
from percept_obs.film.video import Video
from percept_obs.observers import Observer, ekf
from percept_obs.recording.footage import Footage
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.poses import CameraPath
from percept_obs.recording.text_table import PathLike
from percept_obs.studies.diagnosis import Finding
from percept_obs.system.motion import Motion
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.tracking.following import track
from percept_obs.tracking.run import Run
from percept_obs.validation import bar, checked, load_pandas, to_write

if TYPE_CHECKING:
    import pandas as pd

TRIANGULATION = "triangulation"
"""Name of the distance of a point at rest that is triangulated from the whole film."""

CUT_OFF = 0.95
"""Share of a film's pictures below which it is said that some are missing."""

BOARD = "board"
"""Name of the distance of a corner of the board."""


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Film(Footage):
    """Film with known poses of its camera, as a sequence of the recordings of its points.

    Parameters
    ----------
    recordings : tuple of Recording
        First the board's corners, whose distance is known, then other points.  All have the distance "triangulation",
        from the whole film.
    video : Video
    camera : PixelCamera
        In pixels of the film.
    path : CameraPath
        Smoothed poses and velocities; the world is the board: x along its rows, y down, z into it, in metres.
    findings : tuple of percept_obs.studies.diagnosis.Finding
        Mistakes that the pictures show.
    focal_deviation : float
        Standard deviation of the focal length, relative; the distance of the camera from the board has the same.
    board : Board, optional
    seen : Seen, optional
        Poses from the board with their covariance.
    sighting : Sighting
        Pixels of all corners.

    Raises
    ------
    ValueError
        If an entry of `recordings` is no recording, or one that is asked for is none of them.

    See Also
    --------
    read_film : Reads it.

    Examples
    --------
    >>> from percept_obs.film import example_film, read_film
    >>> film = read_film(example_film())
    >>> film.index(film[3])
    3
    """

    video: Video
    camera: PixelCamera
    path: CameraPath
    findings: tuple[Finding, ...]
    sighting: Sighting
    focal_deviation: float = 0.0
    board: Board | None = None
    seen: Seen | None = None

    def index(self, value: Any, start: int = 0, stop: int | None = None) -> int:
        """Return the number of one of the film's recordings."""
        if not any(each is value for each in self.recordings[start:stop]):
            raise ValueError("this is none of the film's recordings; give one of film.recordings")
        return self.recordings.index(value, start)

    @property
    def motion(self) -> Motion:
        """Motion of a point at rest in the camera's frame."""
        return self.path.motion

    @property
    def tracks(self) -> tuple[tuple[int, Array], ...]:
        """Corners off the board: the index of the first picture, and pixels, shape (k, 2)."""
        return self.sighting.tracks

    @property
    def sentence(self) -> str:
        """Sentence on what the film shows, and on what spoils it."""
        time, corners = self.sighting.time, sum(each.truth is not None for each in self)
        width, height = self.video.size
        first = (
            f"{self.source}: {len(time)} pictures of {width} x {height} in {time[-1] - time[0]:.1f} s; poses in "
            f"{100 * np.isin(time, self.path.time).mean():.0f} % of them"
        )
        if self.seen is not None:
            first += f", with corners to {self.seen.error:.2g} pixels"
        if self.focal_deviation:
            first += f" and the focal length to {100 * self.focal_deviation:.2g} %"
        said = [f"{first}; {corners} tracks of the board's corners, {len(self) - corners} of other points."]
        said += [f"{each.sentence[0].upper()}{each.sentence[1:]}: {each.evidence}." for each in self.findings]
        beyond = np.isnan(self.camera.directions(self.sighting.tracked)).any(axis=1).sum()
        if beyond:
            said.append(f"{beyond} of {len(self.sighting.tracked)} corners lie beyond the lens and are left out.")
        if len(time) < CUT_OFF * self.video.count:
            said.append(f"The file speaks of {self.video.count} pictures: it is damaged or cut off.")
        return " ".join(said)

    def __repr__(self) -> str:
        return f"<Film: {self.sentence}>"

    @cached_property
    def observer(self) -> Observer:
        """Extended Kalman filter of depth, which takes the noise of each track."""
        form = PerspectiveSystem(self.motion, self.recordings[0].imaging_surface).measure("y1", "y2")
        return ekf(form, hidden_variance=(1 / self.depth) ** 2)

    @cached_property
    def depth(self) -> float:
        """Median depth of all points in metres."""
        return float(np.median(np.concatenate([each.distances[TRIANGULATION] for each in self])))

    @cached_property
    def runs(self) -> tuple[Run, ...]:
        """Runs of the `observer`, which begin at twice the median depth."""
        start = {"y3": 0.5 / self.depth}
        return tuple(track(each, self.observer, start) for each in bar(self.recordings, "following points"))

    def distances(self) -> pd.DataFrame:
        """Return a table of the points at the end of their tracks, by the `observer`.

        Its columns are point, seconds (that it was seen), distance and claimed (two standard deviations) in metres,
        reference ("board" or "triangulation") and its distance, error (relative), and trusted with the reason.
        """
        pd = load_pandas()
        rows = []
        for run in bar(self.runs, "judging"):
            recording, trust = run.recording, run.trust()
            reference = BOARD if recording.truth is not None else TRIANGULATION
            distance, known = float(run.distance[-1]), float(recording.distances[reference][-1])
            rows.append(
                {
                    **{"point": recording.source, "seconds": float(recording.elapsed[-1]), "distance": distance},
                    **{"claimed": float(self.claimed(run)[-1]), "reference": reference, "known": known},
                    **{"error": abs(distance / known - 1), "trusted": trust.trusted, "why": trust.sentence},
                }
            )
        return pd.DataFrame(rows)

    def overlay(self, path: PathLike) -> None:
        """Write the film with the distances of its points and their claimed interval drawn in, as MP4."""
        to_write(path, ".mp4", ".m4v", ".mov")
        write_overlay(path, self.video, self.camera, self.runs, [self.claimed(run) for run in self.runs])

    def claimed(self, run: Run) -> Array:
        """Two standard deviations of a run's distances in metres, by its filter and the focal length."""
        self.index(run.recording)
        relative = np.sqrt(np.maximum(run.covariance[:, -1, -1], 0.0)) / np.maximum(run.estimate[:, -1], 1e-12)
        return np.asarray(2 * np.hypot(relative, self.focal_deviation) * run.distance)
