"""Recordings from one film, with the film's frames and the names of its reference distances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import overload

from percept_obs.recording.frames import Frames
from percept_obs.recording.recording import Recording
from percept_obs.validation import checked


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Footage(Sequence[Recording]):
    """Sequence of the recordings of a film's points, with what is known of the whole film.

    Parameters
    ----------
    recordings : tuple of Recording
    references : tuple of str
        Names of the distances to which estimates are compared, the surest first.
    frames : Frames
        Undistorted pictures of the film, by the clock of the recordings.
    source : str
        Name of the film.

    See Also
    --------
    percept_obs.film.read_film : Makes it of a film.

    Examples
    --------
    >>> from percept_obs import record, scenarios
    >>> from percept_obs.recording import render
    >>> seen = record(scenarios.planar(), 2)
    >>> footage = Footage((seen,), ("truth",), render(seen, count=2, size=32), "a ball")
    >>> len(footage), footage[0].names
    (1, ('y1', 'y2'))
    """

    recordings: tuple[Recording, ...]
    references: tuple[str, ...]
    frames: Frames
    source: str

    def __post_init__(self) -> None:
        known = {"truth", *(name for each in self.recordings for name in each.distances)}
        if not self.recordings or not {*self.references} <= known:
            raise ValueError(f"references is {self.references}; give recordings, and names of their distances")

    @overload
    def __getitem__(self, index: int) -> Recording: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Recording, ...]: ...
    def __getitem__(self, index: int | slice) -> Recording | tuple[Recording, ...]:
        return self.recordings[index]

    def __len__(self) -> int:
        return len(self.recordings)
