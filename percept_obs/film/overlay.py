"""A film with the distances of its points, and what is claimed of them, drawn in."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from percept_obs.compile import Array
from percept_obs.film.video import Video
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.text_table import PathLike
from percept_obs.tracking.run import Run
from percept_obs.validation import whole

TICKS = 90_000
"""Ticks of a film's clock in a second."""

MOST = 12
"""Largest number of points in one picture whose distance is written beside them."""

BLUE, WHITE, INK = (37, 99, 235), (255, 255, 255), (20, 20, 20)


def write_overlay(
    path: PathLike, video: Video, camera: PixelCamera, runs: Sequence[Run], claimed: Sequence[Array]
) -> None:
    """Write the film as MP4: a dot at each point, and beside it the distance and what is claimed, in metres."""
    import av
    from matplotlib import get_data_path
    from PIL import Image, ImageDraw, ImageFont

    width, height = (side // 2 * 2 for side in video.size)  # which H.264 needs
    size = max(12, max(width, height) // 55)
    font = ImageFont.truetype(str(Path(get_data_path(), "fonts/ttf/DejaVuSans.ttf")), size)
    shown = _labels(camera, runs, claimed, 7 * size)
    with whole(path) as other, av.open(str(other), "w", format="mp4") as file:
        stream: Any = file.add_stream("libx264", rate=30, options={"crf": "20", "preset": "veryfast"})
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        stream.codec_context.time_base = Fraction(1, TICKS)
        for seconds, shot in video.shots("drawing the film"):
            picture = Image.fromarray(shot(1.0, "rgb24")[:height, :width])
            draw = ImageDraw.Draw(picture)
            for (u, v), text in shown.get(seconds, ()):
                draw.ellipse((u - size / 4, v - size / 4, u + size / 4, v + size / 4), BLUE, WHITE, max(1, size // 10))
                if text:
                    left = u + size / 2 if u < width - 7 * size else u - 6.5 * size
                    box = draw.textbbox((left, v - size), text, font)
                    draw.rectangle((box[0] - 3, box[1] - 2, box[2] + 3, box[3] + 2), WHITE)
                    draw.text((left, v - size), text, INK, font)
            frame = av.VideoFrame.from_ndarray(np.asarray(picture), format="rgb24")
            frame.pts, frame.time_base = round(seconds * TICKS), Fraction(1, TICKS)
            file.mux(stream.encode(frame))
        file.mux(stream.encode())


def _labels(
    camera: PixelCamera, runs: Sequence[Run], claimed: Sequence[Array], apart: float
) -> dict[float, list[tuple[Any, str]]]:
    """Return pixels and texts by the time of the picture; labels are so many pixels apart, the longest tracks first."""
    found: dict[float, list[tuple[Any, str]]] = {}
    for run, claim in sorted(zip(runs, claimed, strict=True), key=lambda each: -len(each[1])):
        pixels = camera.pixels(run.recording.outputs)
        for seconds, pixel, text in zip(run.time.tolist(), pixels, _texts(run.distance, claim), strict=True):
            there = found.setdefault(seconds, [])
            if np.isfinite(pixel).all():
                labels = [other for other, said in there if said]
                free = all(np.abs((pixel - other) / (apart, apart / 4)).max() > 1 for other in labels)
                there.append((pixel, text if free and len(labels) < MOST else ""))
    return found


def _texts(distances: Array, claimed: Array) -> Iterator[str]:
    """Yield the distance at each time, once it is claimed to within a half."""
    for distance, claim in zip(distances, claimed, strict=True):
        yield f"{distance:.2f} ± {claim:.2f} m" if claim < distance / 2 else ""
