"""Pictures of a film, upright, at the times that its file gives."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from percept_obs.recording.text_table import PathLike
from percept_obs.validation import bar, needed

Shot = Callable[[float, str], Any]
"""Function from a scale and a format, "gray" or "rgb24", to an upright picture."""


@dataclass(frozen=True)
class Video:
    """File of a film: its upright size in pixels, turns of its pictures by 90 degrees, and their number as it says."""

    path: Path
    size: tuple[int, int]
    turns: int
    count: int

    def shots(self, label: str) -> Iterator[tuple[float, Shot]]:
        """Yield the time in seconds and the picture of every frame; a file that was cut off ends where it was."""
        import av

        last = -np.inf
        with av.open(str(self.path)) as container:
            stream = container.streams.video[0]
            stream.thread_type = "AUTO"
            try:
                for frame in bar(container.decode(stream), label, total=self.count or None):
                    if frame.pts is None or frame.pts * stream.time_base <= last:
                        continue
                    last = frame.pts * stream.time_base

                    def shot(scale: float, form: str, frame: Any = frame) -> Any:
                        width, height = (max(1, round(scale * side)) for side in (frame.width, frame.height))
                        return np.ascontiguousarray(
                            np.rot90(frame.reformat(width, height, form).to_ndarray(), self.turns)
                        )

                    yield float(last), shot
            except av.error.FFmpegError as error:
                if last == -np.inf:
                    raise ValueError(f"'{self.path}' has no picture that can be read: {error.strerror}") from None


def open_film(path: PathLike) -> Video:
    """Return a film's file; refuse what has no pictures."""
    needed("film", "av", "cv2")
    import av

    file = Path(path)
    if not file.is_file():
        raise FileNotFoundError(f"there is no film '{file}'; name a file, such as film.mp4")
    try:
        with av.open(str(file)) as container:
            stream: Any = next(iter(container.streams.video), None)
            first = next(container.decode(stream), None) if stream else None
            if first is None:
                raise ValueError(f"'{file}' has no pictures; name a film")
            turns = round(first.rotation / 90) % 4
            seconds = float((stream.duration or 0) * (stream.time_base or 0))
            count = stream.frames or int(seconds * float(stream.average_rate or 0))
    except av.error.FFmpegError as error:
        raise ValueError(
            f"'{file}' is no film that can be read ({error.strerror}); film anew, or convert it to MP4"
        ) from None
    size = (first.width, first.height)
    return Video(file, size[::-1] if turns % 2 else size, turns, count)
