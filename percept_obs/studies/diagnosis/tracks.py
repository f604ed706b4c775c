"""Tracks of points as a camera with some mistakes would see them, and how that depends on the mistakes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
import sympy as sp

from percept_obs.compile import Array, Flags, Indices, vectorised
from percept_obs.recording import Recording
from percept_obs.recording.reckoning import point_on_rays, transitions
from percept_obs.studies.diagnosis.causes import (
    BEND,
    BIAS,
    CENTRE,
    DRIFT,
    FOCAL,
    LARGEST_OFFSET,
    MIX_UPS,
    MOUNT,
    NUMBERS,
    OFFSET,
    SHUTTER,
)
from percept_obs.studies.diagnosis.paths import SPINS, Path, path
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import POINT, ImagingSurface

MOST_SAMPLES = 300
"""Samples of a track at most, evenly spread: more make a diagnosis slower and hardly surer."""

REACH = 1.5 * LARGEST_OFFSET
"""Seconds before and after a track for which the motion is needed at most."""

SPIKE = 12.0
"""Usual distances from the median of its neighbours that make a sample a spike: 8 deviations of normal noise."""

SMOOTH = 5e-3
"""Focal lengths that come on top: where a smooth track turns, a sample lies so far from its neighbours' median."""

FAR = 1e3
"""Image coordinate that stands for an infinite one."""


@dataclass(frozen=True, eq=False)
class Track:
    """Samples of one point: all image coordinates of the surface, shape (K, m), and which of them are used.

    Lengths are measured by the unit, that of the recording's own translation.
    """

    time: Array
    outputs: Array
    used: Flags
    sampled: Array
    surface: ImagingSurface
    motion: Motion
    unit: float

    @property
    def count(self) -> int:
        """Number of values that are used."""
        return int(self.used.sum())

    @cached_property
    def whole(self) -> Indices:
        """Samples with all coordinates."""
        return np.flatnonzero(self.used.all(axis=1))

    def parted(self, inside: Flags) -> tuple[Track, Track]:
        """Return the track outside of some samples, and inside."""
        outside, within = (
            replace(self, used=self.used & flags[:, None], sampled=np.where(flags[:, None], self.sampled, np.nan))
            for flags in (~inside, inside)
        )
        return outside, within

    @cached_property
    def spread(self) -> float:
        """Root mean square of the samples about their mean."""
        pairs = zip(self.outputs.T, self.used.T, strict=True)
        return float(np.sqrt(np.mean([np.var(column[used]) for column, used in pairs if used.any()])))

    @cached_property
    def rows(self) -> Array:
        """Vertical place in the image of each sample, by which a rolling shutter is late; 0 where it is not known."""
        return np.nan_to_num(self.outputs[:, 1]) if self.outputs.shape[1] > 1 else np.zeros(len(self.time))


def track_of(recording: Recording) -> Track:
    """Track of a recording where its motion is known at all offsets that are tried, without its spikes."""
    surface, time = recording.imaging_surface, recording.time
    if surface.radii:
        raise ValueError(f"the {surface.name} sees a size, and no usual mistake is of one; use seen_on() without it")
    known = recording.motion.signal.times if recording.motion.signal else None
    inside = np.ones(len(time), dtype=bool)
    if known is not None:
        inside = (time >= known[0] + LARGEST_OFFSET) & (time <= known[-1] - LARGEST_OFFSET)
    names = [symbol.name for symbol in surface.image_coordinates]
    outputs = np.full((len(time), len(names)), np.nan)
    outputs[:, [names.index(name) for name in recording.names]] = recording.outputs
    used = np.isfinite(outputs) & ~spikes(outputs) & inside[:, None]
    there = np.flatnonzero(inside)
    chosen = there[np.unique(np.linspace(0, len(there) - 1, min(MOST_SAMPLES, len(there))).round().astype(int))]
    sampled, unit = outputs[chosen], recording.in_own_unit().unit
    return Track(time[chosen], sampled, used[chosen], sampled, surface, recording.motion, unit)


def spikes(outputs: Array) -> Flags:
    """Samples that differ from the median of five neighbours by far more than the others do, shape (K, m)."""
    padded = np.pad(outputs, ((2, 2), (0, 0)), constant_values=np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(padded, 5, axis=0)
    with np.errstate(all="ignore"):
        apart = np.abs(outputs - np.ma.median(np.ma.masked_invalid(windows), axis=-1).filled(np.nan))
        apart = np.nan_to_num(apart)
        usual = np.array([np.median(column[column > 0]) if (column > 0).any() else 0 for column in apart.T])
    return np.asarray((apart > SPIKE * usual + SMOOTH).any(axis=1, keepdims=True) & np.isfinite(outputs))


@lru_cache(maxsize=16)
def _image(surface: ImagingSurface) -> Callable[..., list[Array]]:
    """Image of a point with its Jacobian as a numpy function."""
    image = sp.Matrix(surface.image)
    return vectorised(POINT, (*image, *image.jacobian(POINT)), surface.values)


@dataclass(frozen=True, eq=False)
class Seen:
    """Image coordinates of a track, shape (K, m), with their derivatives by the point and by causes' numbers."""

    outputs: Array
    by_point: Array
    by_cause: Array


def seen(track: Track, point: Array, mix_up: str, wrong: Mapping[str, Array], asked: Sequence[str] = ()) -> Seen:
    """Images of a point, given by its position (X, 1) at the beginning but for a factor, under wrong numbers.

    Derivatives are those by the point, shape (K, m, 4), and by the q numbers of the causes asked for, shape (K, m, q).
    """
    number = numbers_of(wrong)
    late, row, longer, bend = (float(number[key][0]) for key in (OFFSET, SHUTTER, FOCAL, BEND))
    way, (turn, _) = path_of(track, mix_up, number), _mount(track, number)
    times = np.clip(track.time - late + row * track.rows, way.times[0], way.times[-1])
    m, count, maps, ratio = track.outputs.shape[1], len(times), _maps(track, way, times, number), np.exp(longer)
    with np.errstate(all="ignore"):
        values = np.stack(_image(track.surface)(*(maps @ point).T), axis=-1)
    values = np.nan_to_num(values, nan=FAR, posinf=FAR, neginf=-FAR)
    y, by_position = values[:, :m], values[:, m:].reshape(count, m, 3)
    if MIX_UPS[mix_up].fisheye:
        y, slope = _through_fisheye(y)
        by_position = slope @ by_position
    square = (y**2).sum(axis=1)[:, None]
    factor, slope = 1 + bend * square + (bend * square) ** 2, bend + 2 * bend**2 * square  # as lenses of cameras do
    bent = y * factor
    lens = factor[:, :, None] * np.eye(m) + 2 * slope[:, :, None] * y[:, :, None] * y[:, None, :]
    by_position = ratio * lens @ by_position
    by_body = by_position @ turn
    found = {FOCAL: ratio * bent[:, :, None], BEND: (ratio * y * (square + 2 * bend * square**2))[:, :, None]}
    found[CENTRE] = np.broadcast_to(np.eye(m), (count, m, m))
    if MOUNT in asked:
        turned = np.einsum("aij,nj->nia", -SPINS, maps @ point) @ _turn_by_vector(-number[MOUNT][:3])
        shifted = np.broadcast_to(-turn * point[3] / track.unit, turned.shape)
        found[MOUNT] = by_position @ np.concatenate([turned, shifted], axis=2)
    if OFFSET in asked or SHUTTER in asked:
        moved = by_body @ (way.spline(times, 1) @ point)[:, :, None]
        found |= {OFFSET: -moved, SHUTTER: moved * track.rows[:, None, None]}
    if BIAS in asked or DRIFT in asked:
        spins, _ = MIX_UPS[mix_up].undone(SPINS, np.zeros((3, 3)))
        turned = np.einsum("aij,nj->nia", spins, way.maps[:, :3] @ point)
        shifted = -point[3] * (way.times - way.times[0])[:, None] * way.b
        changes = way.change(times, np.concatenate([turned, shifted[:, :, None]], axis=2))
        found |= {BIAS: by_body @ changes[:, :, :3], DRIFT: by_body @ changes[:, :, 3:]}
    by_cause = np.concatenate([np.empty((count, m, 0)), *(found[key] for key in asked)], axis=2)
    return Seen(ratio * bent + number[CENTRE][:m], by_position @ maps, by_cause)


def _mount(track: Track, number: Mapping[str, Array]) -> tuple[Array, Array]:
    """Matrix from the body's axes to the camera's, and the camera's place on the body by the unit of length."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(-number[MOUNT][:3]).as_matrix(), number[MOUNT][3:] / track.unit


def _turn_by_vector(vector: Array) -> Array:
    """Derivative of a rotation, as a turn after it, by its rotation vector: the mean of all rotations on the way."""
    turning = np.broadcast_to(np.tensordot(vector, SPINS, axes=1), (3, 3, 3))
    return transitions(turning, np.eye(3), 1.0)[:, :, 3].T


def _maps(track: Track, way: Path, times: Array, number: Mapping[str, Array]) -> Array:
    """Maps of (X, 1) on the body at the beginning to the camera's position at some times, shape (K, 3, 4)."""
    turn, place = _mount(track, number)
    maps = way.spline(times)
    maps[:, :, 3] -= place
    return np.asarray(turn @ maps)


def _through_fisheye(y: Array) -> tuple[Array, Array]:
    """Images of an equidistant lens, shape (K, m), of those of a pinhole, and their derivatives by these."""
    radius = np.linalg.norm(y, axis=1)[:, None] + 1e-9
    angle, axis = np.arctan(radius), y / radius
    along, across = 1 / (1 + radius**2), angle / radius
    slope = across[:, :, None] * np.eye(y.shape[1]) + (along - across)[:, :, None] * axis[:, :, None] * axis[:, None]
    return angle * axis, slope


def numbers_of(wrong: Mapping[str, Array]) -> dict[str, Array]:
    """All wrong numbers, 0 where there is none."""
    return {key: wrong.get(key, np.zeros(cause.size)) for key, cause in NUMBERS.items()}


def path_of(track: Track, mix_up: str, number: Mapping[str, Array]) -> Path:
    """Path of a track without a mix-up, and without the wrong numbers of the motion."""
    known = track.motion.signal.times if track.motion.signal else None
    begin, end = track.time[0] - REACH, track.time[-1] + REACH
    if known is not None:
        begin, end = max(begin, known[0]), min(end, known[-1])
    ends, bias, drift = (float(begin), float(end)), tuple(number[BIAS].tolist()), float(number[DRIFT][0])
    return path(track.motion, *ends, track.unit, mix_up, bias, drift)


def guess(track: Track, mix_up: str, wrong: Mapping[str, Array]) -> tuple[Array, Array]:
    """Position (X, 1) at the beginning, but for a factor, that explains a track nearly, and directions to change it.

    The three directions, shape (4, 3), are those that make a fit well conditioned.
    """
    surface, rows, number = track.surface, track.whole, numbers_of(wrong)
    way = path_of(track, mix_up, number)
    ray = vectorised(surface.image_coordinates, surface.ray, surface.values)
    if len(rows) >= 3:
        times = np.clip(track.time[rows] - float(number[OFFSET][0]), way.times[0], way.times[-1])
        images = (track.outputs[rows] - number[CENTRE][: track.outputs.shape[1]]) / np.exp(number[FOCAL][0])
        if MIX_UPS[mix_up].fisheye:
            angle = np.linalg.norm(images, axis=1, keepdims=True) + 1e-9
            images = images / angle * np.tan(np.minimum(angle, 1.5))
        rays = np.stack(ray(*images.T), axis=-1)
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        point, along, directions = point_on_rays(rays, _maps(track, way, times, number))
        if point[3] > 0 and np.median(np.abs(along)) > 1e-6:
            return point, directions
    first = [np.flatnonzero(column) for column in track.used.T]
    image = [track.outputs[rows[0], k] if len(rows) else 0.0 for k, rows in enumerate(first)]
    point = np.append(np.array(ray(*image), dtype=float), 0.0)
    return point, across_of(point, 4)


def across_of(point: Array, unknowns: int) -> Array:
    """Directions across a vector, among its first entries, shape (4, unknowns - 1)."""
    found = np.zeros((4, unknowns - 1))
    found[:unknowns] = np.linalg.svd(point[None, :unknowns])[2][1:].T
    return found
