"""Tracks in a table: which rows make which recording, and what of each is image, truth or another distance."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from percept_obs.compile import Array, Flags, Indices
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.text_table import Clock, PathLike, TextTable, read_table
from percept_obs.system.motion import Motion
from percept_obs.system.signal import slack_of
from percept_obs.system.surfaces import BehindCamera, ImagingSurface
from percept_obs.validation import warn


class Unlikely(UserWarning):
    """What a recording holds can be followed, but is hardly what was meant."""


@dataclass(frozen=True)
class Columns:
    """What a table's columns are called and how they are read; the parameters of `Recording.from_csv`."""

    time: str
    camera: PixelCamera | None
    pixels: Sequence[str]
    pixel_sigma: float | None
    point: str | None
    depth: str | None
    distances: Sequence[str]
    clock: Clock
    gap: float
    shortest: float


def recordings_in(path: PathLike, motion: Motion, surface: ImagingSurface, columns: Columns) -> list[dict[str, Any]]:
    """The parts of every `Recording` in a table; one that holds all rows if no column tells the points apart."""
    _refuse_settings(columns)
    names = columns.pixels if columns.camera else tuple(s.name for s in surface.image_coordinates)
    table = read_table(path, example=",".join([columns.time, *filter(None, [columns.point]), *names]))
    time = table.seconds(columns.time, columns.clock)
    measured, outputs = _outputs(table, surface, columns)
    truth = _truth(table, surface, columns, measured, outputs)
    others = {name: _distance(table, name, "distances") for name in columns.distances}
    variance = None
    if columns.camera and columns.pixel_sigma is not None:
        variance = columns.camera.variance(columns.pixel_sigma)
    file = os.fspath(path) if columns.point is None else Path(path).name

    def part(rows: Indices, source: str) -> dict[str, Any]:
        return {
            "time": time[rows],
            "outputs": outputs[rows],
            "names": measured,
            "view": surface,
            "motion": motion,
            "truth": None if truth is None else truth[rows],
            "noise_variance": variance,
            "distances": {name: values[rows] for name, values in others.items()},
            "source": source,
        }

    known = _within(motion, time, file)
    if columns.point is None:
        return [part(np.flatnonzero(known), file)]
    points = table.column(columns.point, "point")
    unnamed = [row for row, text in enumerate(points, 1) if not text]
    if unnamed:
        raise ValueError(f"{file}: row {unnamed[0]} has no {columns.point}; every row needs the name of its point")
    seen = np.isfinite(outputs).all(axis=1) & known
    return [part(rows, source) for rows, source in _sightings(file, points, time, seen, known, columns)]


def _refuse_settings(columns: Columns) -> None:
    """Refuse settings that no table can meet."""
    if len(columns.pixels) != 2:
        raise ValueError(f"pixels names the columns {columns.pixels!r}; expected two names, such as ('u', 'v')")
    if not columns.gap > 0 or math.isnan(columns.gap):
        raise ValueError(f"the gap is {columns.gap} s; it must be positive")
    if not (columns.shortest >= 0 and math.isfinite(columns.shortest)):
        raise ValueError(f"shortest is {columns.shortest} s; it must be finite and not negative")
    if columns.pixel_sigma is not None and columns.camera is None:
        raise ValueError("pixel_sigma is in pixels; give also camera=PixelCamera(...)")
    if columns.point is None and (columns.gap < math.inf or columns.shortest):
        raise ValueError("gap and shortest part the sightings of points; name the column of these, such as point='id'")


def _outputs(table: TextTable, surface: ImagingSurface, columns: Columns) -> tuple[tuple[str, ...], Array]:
    """Names of the image coordinates that the table has, and their numbers."""
    every = tuple(s.name for s in surface.image_coordinates)
    if columns.camera is not None:
        pixels = np.stack([table.numbers(name, "pixels") for name in columns.pixels], axis=-1)
        try:
            image = columns.camera.image(pixels)
        except ValueError as error:
            raise ValueError(f"{table.file}: {error}") from None
        seen = np.isfinite(image).all(axis=1)
        outputs = np.full((len(image), len(every)), np.nan)
        outputs[seen] = surface.project(np.column_stack([image, np.ones(len(image))])[seen])[:, : len(every)]
        return every, outputs
    names = tuple(name for name in every if name in table.columns)
    if not names:
        raise ValueError(
            f"{table.file} has the columns {', '.join(table.columns)}; it needs {columns.time!r} and at least one of "
            f"{', '.join(every)}, or a camera=PixelCamera(...) for pixels"
        )
    return names, np.stack([table.numbers(name) for name in names], axis=-1)


def _truth(
    table: TextTable, surface: ImagingSurface, columns: Columns, measured: tuple[str, ...], outputs: Array
) -> Array | None:
    """Measured image coordinates with the inverse distance, NaN for those that are not known."""
    inverse = surface.inverse_distance.name
    if columns.depth is not None:
        last = 1 / _distance(table, columns.depth, "depth")
    elif inverse in table.columns:
        last = table.numbers(inverse)
    else:
        return None
    truth = np.full((len(last), len(surface.coordinates)), np.nan)
    every = [s.name for s in surface.image_coordinates]
    truth[:, [*map(every.index, measured), -1]] = np.column_stack([outputs, last])
    return truth


def _distance(table: TextTable, name: str, of: str) -> Array:
    """A column of distances, which are positive or empty."""
    found = table.numbers(name, of)
    behind = np.flatnonzero(found <= 0)
    if len(behind):
        raise BehindCamera(
            f"{table.file} has the {name} {found[behind[0]]:g} in row {behind[0] + 1}; a point that is seen is in "
            "front of the camera: give a positive number of metres, or leave the cell empty"
        )
    return found


def _within(motion: Motion, time: Array, file: str) -> Flags:
    """Which times the motion is known at; all if it is known always."""
    times = None if motion.signal is None else motion.signal.times
    if times is None or len(times) < 2:
        return np.ones(len(time), dtype=bool)
    slack = slack_of(times)
    known = np.asarray((time >= times[0] - slack) & (time <= times[-1] + slack))
    spans = f"{file} has times from {time.min():.6g} to {time.max():.6g} s, the motion from {times[0]:.6g} to "
    if not known.any():
        raise ValueError(
            f"{spans}{times[-1]:.6g} s: the clocks do not overlap; bring the tracks onto the clock of the poses with "
            "clock=Clock(zero=..., tick=...)"
        )
    if not known.all():
        warn(
            Unlikely(
                f"{spans}{times[-1]:.6g} s: {np.sum(~known)} of {len(time)} rows are left out; if these are two "
                "clocks, give clock=Clock(zero=...), else cut the table"
            )
        )
    return known


def _sightings(
    file: str, points: Sequence[str], time: Array, seen: Flags, known: Flags, columns: Columns
) -> Iterator[tuple[Indices, str]]:
    """Rows and name of each sighting of each point, from its first sample to its last, in the order of the points."""
    found, short, names = 0, 0, np.array(points)
    for point in dict.fromkeys(points):
        own = np.flatnonzero(names == point)
        back = np.flatnonzero(np.diff(time[own]) <= 0)
        if len(back):
            raise ValueError(
                f"{file}: the times of the point {point} do not increase at row {own[back[0] + 1] + 1}; sort the rows "
                f"by {columns.time} and remove repeated ones"
            )
        own = own[known[own]]
        samples = np.flatnonzero(seen[own])
        long = np.diff(time[own][samples]) > columns.gap * (1 + 1e-9)
        runs = [run for run in np.split(samples, np.flatnonzero(long) + 1) if len(run)]
        lasting = [run for run in runs if len(run) > 1 and np.ptp(time[own][run]) >= columns.shortest]
        short += len(runs) - len(lasting)
        for number, run in enumerate(lasting, 1):
            found += 1
            part = f", part {number}" if len(lasting) > 1 else ""
            yield own[run[0] : run[-1] + 1], f"{file}, point {point}{part}"
    if not found:
        raise ValueError(
            f"{file} has no point that is seen twice with a gap of at most {columns.gap:g} s, and at shortest "
            f"for {columns.shortest:g} s; is "
            f"{columns.point!r} the column of the points, and are there samples?"
        )
    if short and not columns.shortest:
        warn(Unlikely(f"{file}: {short} sightings of a single sample are left out, for nothing follows from one"))
