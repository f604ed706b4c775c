"""Tracks of points in a table: which rows make which recording, and which columns are image, truth or distance."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from percept_obs.compile import Array, Flags, Indices
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.plausibility import LARGEST_USUAL, Unlikely
from percept_obs.recording.text_table import Clock, PathLike, TextTable, read_table
from percept_obs.system.motion import Motion
from percept_obs.system.signal import slack_of
from percept_obs.system.surfaces import BehindCamera, ImagingSurface
from percept_obs.validation import warn

AT_ONCE = 100_000
"""Rows that are projected at once, so that long tables take no more memory than they must."""


def fields_of_recordings(
    path: PathLike,
    motion: Motion,
    surface: ImagingSurface,
    time: str,
    point: str | None,
    depth: str | None,
    distances: Sequence[str],
    camera: PixelCamera | None,
    pixels: Sequence[str],
    pixel_sigma: float | None,
    clock: Clock,
    gap: float,
    shortest: float,
) -> Iterator[dict[str, Any]]:
    """Yield the fields of every `Recording` in a table; one with all rows if no column of points is named.

    The parameters are those of `Recording.from_csv`.
    """
    if len(pixels) != 2 or pixels[0] == pixels[1]:
        raise ValueError(f"pixels names the columns {pixels!r}; expected two names, such as ('u', 'v')")
    refuse_parts(gap, shortest)
    if pixel_sigma is not None and camera is None:
        raise ValueError("pixel_sigma is in pixels; give also camera=PixelCamera(...)")
    if point is None and (gap < math.inf or shortest):
        raise ValueError("gap and shortest split the tracks of points; name the column of these, such as point='id'")

    if camera is not None and surface.radii:
        raise ValueError(f"pixels say nothing of the size that the {surface.name} sees; give its columns, or no size")
    every = tuple(symbol.name for symbol in surface.image_coordinates)
    inverse = surface.inverse_distance.name
    example = ",".join([time, *([point] if point else []), *(pixels if camera else every)])
    wanted = {*(pixels if camera else every), *([] if depth else [inverse]), *distances, *([depth] if depth else [])}
    kept = {time, point, inverse, *(pixels if camera else every)}
    if taken := sorted(kept.intersection([depth, *distances]) - {None}):
        raise ValueError(f"the column {taken[0]!r} is read as something else; name one of distances in metres")
    table = read_table(path, example=example, numbers=sorted(wanted - {time, point}))
    _refuse_misspelt(table, [*(() if camera else every), *(() if depth else [inverse])])
    times = table.seconds(time, clock)
    if camera:
        names, outputs = every, _outputs_of_pixels(table, surface, camera, pixels)
    else:
        names = tuple(name for name in every if name in table.columns)
        if not names:
            raise ValueError(
                f"{table.file} has the columns {', '.join(table.columns)}; it needs {time!r} and at least one of "
                f"{', '.join(every)}, or a camera=PixelCamera(...) for pixels"
            )
        outputs = np.stack([table.numbers(name) for name in names], axis=-1)

    last = None
    if depth is not None or inverse in table.columns:
        last = table.numbers(inverse) if depth is None else 1 / _distances(table, depth, "depth")
    others = {name: _distances(table, name, "distances") for name in distances}
    variance = None if camera is None or pixel_sigma is None else camera.variance(pixel_sigma)

    file = os.fspath(path) if point is None else Path(path).name
    known = _known(motion, times, file)
    if not (np.isfinite(outputs).all(axis=1) & known).any():
        raise ValueError(f"{file} has no sample: in no row are all of {', '.join(names)} there; fill the cells")
    tracks = [(np.flatnonzero(known), file)]
    if point is not None:
        tracks = tracks_of_points(file, table.column(point, "point"), times, known, outputs, point, gap, shortest)
    del table  # a long one takes as much memory as all recordings
    places = [every.index(name) for name in names]
    for rows, source in tracks:
        truth = None
        if last is not None:
            truth = np.full((len(rows), len(surface.coordinates)), np.nan)
            truth[:, places], truth[:, -1] = outputs[rows], last[rows]
        yield {
            "time": times[rows],
            "outputs": outputs[rows],
            "names": names,
            "view": surface,
            "motion": motion,
            "truth": truth,
            "noise_variance": variance,
            "distances": {name: values[rows] for name, values in others.items()},
            "source": source,
        }


def refuse_parts(gap: float, shortest: float) -> None:
    """Raise ValueError unless gap and shortest length, in seconds, can divide tracks into parts."""
    if not gap > 0 or not 0 <= shortest < math.inf:
        raise ValueError(f"the gap is {gap} s and shortest is {shortest} s; expected a positive gap, and 0 or more")


def runs(time: Array, samples: Indices, gap: float) -> list[Indices]:
    """Divide indices of samples where a gap is longer than so many seconds."""
    ends = np.flatnonzero(np.diff(time[samples]) > gap) + 1
    return [run for run in np.split(samples, ends) if len(run)]


def _refuse_misspelt(table: TextTable, names: Sequence[str]) -> None:
    """Ask back about a column that is named nearly as one of these, which would be left out otherwise."""
    plain = {re.sub(r"[\W_]", "", column).lower(): column for column in table.columns}
    for name in names:
        if name not in table.columns and (column := plain.get(name)):
            raise ValueError(
                f"{table.file} has the column {column!r}; did you mean {name!r}?  Rename it, or leave it out"
            )


def _outputs_of_pixels(table: TextTable, surface: ImagingSurface, camera: PixelCamera, pixels: Sequence[str]) -> Array:
    """Image coordinates on the surface, shape (K, m), of the columns of pixels; NaN where a pixel is."""
    columns = [table.numbers(name, "pixels") for name in pixels]
    outputs = np.full((len(columns[0]), len(surface.image_coordinates)), np.nan)
    _ask_for_pixels(table.file, np.stack([column[:AT_ONCE] for column in columns], axis=-1), camera)
    for begin in range(0, len(outputs), AT_ONCE):
        part = slice(begin, begin + AT_ONCE)
        try:
            image = camera.image(np.stack([column[part] for column in columns], axis=-1))
        except ValueError as error:
            raise ValueError(f"{table.file}: {error}") from None
        seen = np.isfinite(image).all(axis=1)
        outputs[part][seen] = surface.project(np.column_stack([image[seen], np.ones(seen.sum())]))[:, :-1]
    return outputs


def _ask_for_pixels(file: str, pixels: Array, camera: PixelCamera) -> None:
    """Warn if most pixels lie outside of a camera's image, or in its corner as image coordinates do."""
    pixels = pixels[np.isfinite(pixels).all(axis=1)]
    corner = (np.abs(pixels) < 2).all(axis=1) & (min(camera.focal) > LARGEST_USUAL)
    if len(pixels) and np.mean(corner | ~camera.sees(pixels)) > 0.5:
        said = f"{file}: most pixels lie outside of the image {camera.size or ''} or in its corner"
        warn(Unlikely(f"{said}; are they of this camera?  For image coordinates leave camera= out"))


def _distances(table: TextTable, name: str, meaning: str) -> Array:
    """Column of distances, which are positive or empty."""
    found = table.numbers(name, meaning)
    behind = np.flatnonzero(found <= 0)
    if len(behind):
        raise BehindCamera(
            f"{table.file} has the {name} {found[behind[0]]:g} in row {behind[0] + 1}; a point that is seen is in "
            "front of the camera: give a positive number of metres, or leave the cell empty"
        )
    return found


def _known(motion: Motion, time: Array, file: str) -> Flags:
    """Return True for the times at which the motion is known; warn if some rows are left out."""
    times = None if motion.signal is None else motion.signal.times
    if times is None or len(times) < 2:
        return np.ones(len(time), dtype=bool)
    slack = slack_of(times)
    known = np.asarray((time >= times[0] - slack) & (time <= times[-1] + slack))
    spans = (
        f"{file} has times from {time.min():.6g} to {time.max():.6g} s, the motion from {times[0]:.6g} to "
        f"{times[-1]:.6g} s"
    )
    if not known.any():
        raise ValueError(f"{spans}: the clocks do not overlap; give the tracks clock=Clock(zero=..., tick=...)")
    if not known.all():
        left_out = f"{np.sum(~known)} of {len(time)} rows are left out"
        warn(Unlikely(f"{spans}: {left_out}; if these are two clocks, give clock=Clock(zero=...), else cut the table"))
    return known


def tracks_of_points(
    file: str,
    points: Any,
    time: Array,
    known: Flags,
    outputs: Array,
    column: str,
    gap: float,
    shortest: float,
) -> list[tuple[Indices, str]]:
    """Rows and source of each track of each point, from its first sample to its last, in the order of the points."""
    empty = np.flatnonzero(points == "")
    if len(empty):
        raise ValueError(f"{file}: row {empty[0] + 1} has no {column}; every row needs the name of its point")
    seen, found, single, unseen = np.isfinite(outputs).all(axis=1) & known, [], 0, 0
    order = np.argsort(points.codes, kind="stable")
    of_each = np.split(order, np.flatnonzero(np.diff(points.codes[order])) + 1)
    for rows in sorted(of_each, key=lambda rows: int(rows[0])):
        point = points[rows[0]]
        back = np.flatnonzero(np.diff(time[rows]) <= 0)
        if len(back):
            raise ValueError(
                f"{file}: the times of the point {point} do not increase at row {rows[back[0] + 1] + 1}; sort the rows "
                "by time and remove repeated ones"
            )
        parts = runs(time, rows[seen[rows]], gap * (1 + 1e-9))
        lasting = [part for part in parts if len(part) > 1 and np.ptp(time[part]) >= shortest]
        single += sum(len(part) == 1 for part in parts)
        unseen += not parts
        for number, part in enumerate(lasting, 1):
            name = f"{file}, point {point}{f', part {number}' if len(lasting) > 1 else ''}"
            found.append((rows[known[rows] & (rows >= part[0]) & (rows <= part[-1])], name))
    if not found:
        raise ValueError(
            f"{file} has no point that is seen twice with a gap of at most {gap:g} s, and for {shortest:g} s at least; "
            f"take a longer gap, a smaller shortest, or another column of the points than {column!r}"
        )
    if single and not shortest:
        warn(Unlikely(f"{file}: {single} sightings of a single sample are left out, for nothing follows from one"))
    if unseen:
        warn(Unlikely(f"{file}: {unseen} points without any sample are left out"))
    return found
