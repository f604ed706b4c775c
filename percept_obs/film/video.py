"""Pictures of a film, upright, at the times that its file gives."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import count, islice
from pathlib import Path
from typing import Any

import numpy as np

from percept_obs.recording.text_table import PathLike
from percept_obs.validation import bar, needed

Shot = Callable[[float, str], Any]
"""Function from a scale and a format, "gray" or "rgb24", to an upright picture."""

LOOKED_AT = 20
"""Number of pictures at the beginning whose times show whether the file has times, in the pictures' order."""


@dataclass(frozen=True)
class Video:
    """File of a film: its upright size in pixels, turns of its pictures by 90 degrees, and their number as it says.

    `stream` is the number of the pictures' stream.  The `clock` are the times of pictures in seconds by their order,
    where the pictures themselves have none.
    """

    path: Path
    stream: int
    size: tuple[int, int]
    turns: int
    count: int
    clock: tuple[float, ...] | None

    def shots(self, label: str) -> Iterator[tuple[float, Shot]]:
        """Yield the time in seconds and the picture of every frame; a file that was cut off ends where it was."""
        import av

        width, height = self.size[::-1] if self.turns % 2 else self.size
        last, number = -np.inf, count()
        with av.open(f"file:{self.path}") as container:
            stream = container.streams.video[self.stream]
            stream.thread_type = "AUTO"
            try:
                for frame in bar(container.decode(stream), label, total=self.count or None):
                    seconds = _seconds(frame, self.clock, next(number))
                    if seconds is None or seconds <= last:
                        continue
                    last = seconds

                    def shot(scale: float, form: str, frame: Any = frame) -> Any:
                        shape = (max(1, round(scale * side)) for side in (width, height))
                        return np.ascontiguousarray(np.rot90(frame.reformat(*shape, form).to_ndarray(), self.turns))

                    yield last, shot
            except av.error.FFmpegError as error:
                if last == -np.inf:
                    raise ValueError(f"'{self.path}' has no picture that can be read: {error.strerror}") from None


def _seconds(frame: Any, clock: tuple[float, ...] | None, number: int) -> float | None:
    """Return a picture's time, by itself or by its number; None if it has none."""
    if clock is not None:
        return clock[number] if number < len(clock) else None
    return None if frame.pts is None else float(frame.pts * frame.time_base)


def open_film(path: PathLike) -> Video:
    """Return a film's file; refuse what has no pictures."""
    needed("film", "av", "cv2")
    import av

    file = Path(path)
    if not file.is_file():
        raise FileNotFoundError(f"there is no film '{file}'; name a file, such as film.mp4")
    try:
        with av.open(f"file:{file}") as container:
            streams = container.streams.video
            largest = max(range(len(streams)), key=lambda k: streams[k].width * streams[k].height, default=None)
            stream: Any = None if largest is None else streams[largest]
            begin = [] if largest is None else [*islice(container.decode(stream), LOOKED_AT)]
            if largest is None or not begin:
                raise ValueError(f"'{file}' has no pictures; name a film")
            seconds = float((stream.duration or 0) * (stream.time_base or 0))
            rate = float(stream.average_rate or 0)
            total = stream.frames or int(seconds * rate)
            aspect = float(stream.sample_aspect_ratio or 1)
        ticks = [frame.pts for frame in begin]
        clock = None
        if None in ticks or ticks != sorted(ticks):  # as in AVI files, or in streams without any times
            clock = _clock(file, largest, rate)
    except av.error.FFmpegError as error:
        raise ValueError(
            f"'{file}' is no film that can be read ({error.strerror}); film anew, or convert it to MP4"
        ) from None
    turns = round(begin[0].rotation / 90) % 4
    size = (round(begin[0].width * aspect), begin[0].height)
    return Video(file, largest, size[::-1] if turns % 2 else size, turns, total, clock)


def _clock(file: Path, number: int, rate: float) -> tuple[float, ...]:
    """Return the times of a file's pictures in their order, by its packets, or by its rate."""
    import av

    with av.open(f"file:{file}") as container:
        stream = container.streams.video[number]
        packets = [packet for packet in container.demux(stream) if packet.size]
        ticks = sorted({packet.pts for packet in packets} - {None})
        if len(ticks) == len(packets):
            return tuple(float(tick * stream.time_base) for tick in ticks)
    if not rate:
        raise ValueError(f"'{file}' gives no times of its pictures; convert it to MP4")
    return tuple((np.arange(len(packets)) / rate).tolist())
