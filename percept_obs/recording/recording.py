"""Recordings of a camera: samples of the image, and the known motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Annotated, Any

import numpy as np

from percept_obs.compile import Array, Flags, vectorised
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.plausibility import ask_for_seconds, warn_if_implausible
from percept_obs.recording.pose_errors import VirtualLandmark
from percept_obs.recording.reckoning import point_on_rays, reckon
from percept_obs.recording.text_table import SECONDS, Clock, PathLike
from percept_obs.recording.track_table import fields_of_recordings, runs
from percept_obs.system.motion import Motion
from percept_obs.system.signal import readonly
from percept_obs.system.surfaces import BehindCamera, ImagingSurface, pinhole
from percept_obs.system.view import View, refuse_several
from percept_obs.validation import TABLE, TIMES, checked, load_pandas

USUAL_SPEED = 0.6
"""Speed in units of length a second that default gains are made for, about that of Ma's examples."""


@checked
@dataclass(frozen=True)
class Sighting:
    """Samples between which a point is in sight.

    Parameters
    ----------
    point, first, last : int
        Its number, and its first and its last sample.

    See Also
    --------
    percept_obs.recording.stereo_mat.StereoTracks : Has them.

    Examples
    --------
    >>> from percept_obs import Camera, record, scenarios
    >>> record(scenarios.planar(), 6, Camera(1.0)).without(2, 3).sightings(absence=1.5)[0]
    Sighting(point=0, first=0, last=1)
    """

    point: int
    first: int
    last: int


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Recording:
    """Samples of the images of one point or of several, with the known motion of the camera and the points.

    Parameters
    ----------
    time : array of shape (K,)
        Seconds, strictly increasing.
    outputs : array of shape (K, m), or (K, p, m) for p points
        Samples of the image coordinates; NaN where one was lost.  Of a table, the columns with the outputs' names.
    names : tuple of str
        Names of a point's outputs, such as ("y1", "y2").
    view : View
        View in which they were seen: an imaging surface, several points of one state, or a scaled inverse depth.
    motion : Motion
        Known motion, with numbers for all times.
    truth : array of shape (K, n), optional
        True coordinates of the view, such as image coordinates and inverse distance; NaN where they are not known.
    signal : function of times, optional
        The outputs without noise at any time, of shape (T, m) or (T, p, m), if they are known.
    noise_variance : float, optional
        Variance of the noise in each output; `effective_variance` adds that of the poses behind the motion.
    distances : mapping of names to arrays of shape (K,) or (K, p), optional
        Independent measurements of the depth or range in metres; NaN where there is none.
    source : str
        Where the recording comes from, its settings and its seed.
    unit : float
        Length, in the recording's own unit of length, by which observers and studies measure hidden lengths inside:
        gains and variances are numbers in it.  So nothing relative changes if all lengths and the unit are written in
        millimetres.  Without effect on several points, whose equations are linear.
    doubt : str
        Reason why images or motion are not as they are known, such as "the lens focuses anew"; no estimate is trusted
        then.

    Raises
    ------
    BehindCamera
        If a point that is seen is not in front of the camera by its truth.
    ValueError
        If shapes do not fit, times do not increase, values are not finite that must be, or one point is never seen.

    Warns
    -----
    Unlikely
        If the samples look like pixels, or a sampled motion has a hole while it is needed.

    See Also
    --------
    record : Simulates a recording.
    Recording.from_csv : Reads one from a table.

    Examples
    --------
    >>> from percept_obs import Recording, pinhole, rigid
    >>> still = rigid(camera_velocity=[0, 0, 0])
    >>> Recording([0.0, 0.1], [[0.1], [0.2]], ("y1",), pinhole(), still, source="two pictures")
    <Recording of y1 (pinhole): 2 samples from 0 to 0.1 s, without a truth; two pictures>
    """

    time: Annotated[Array, TIMES]
    outputs: Annotated[Array, TABLE]
    names: tuple[str, ...]
    view: View
    motion: Motion
    truth: Annotated[Array, TABLE] | None = None
    signal: Callable[[Array], Array] | None = None
    noise_variance: float | None = None
    distances: Mapping[str, Array] = field(default_factory=dict)
    source: str = ""
    unit: float = 1.0
    doubt: str = ""

    def __post_init__(self) -> None:
        outputs = _by_name("outputs", self.outputs, self.names)
        outputs = np.reshape(outputs, (-1, 1)) if len(self.names) == 1 == np.ndim(outputs) else outputs
        truth = _by_name("truth", self.truth, [symbol.name for symbol in self.view.coordinates])
        distances = MappingProxyType({name: readonly(values) for name, values in self.distances.items()})
        vars(self).update(
            time=readonly(self.time),
            outputs=readonly(outputs),
            names=tuple(self.names),
            truth=None if truth is None else readonly(truth),
            distances=distances,
        )
        self._check_times()
        self._check_outputs()
        self._check_truth()
        expected = (len(self.time), *self.view.point_shape)
        if taken := sorted({"", "time", "truth", *self.names} & set(distances)):
            raise ValueError(f"the distances have the name {taken[0]!r}, which stands for something else; rename them")
        for name, values in distances.items():
            if values.shape != expected or not (np.isnan(values) | (np.isfinite(values) & (values > 0))).all():
                raise ValueError(f"the distances {name!r} must be positive numbers or NaN, of shape {expected}")
        if self.noise_variance is not None and not 0 <= self.noise_variance < np.inf:
            raise ValueError(f"the noise_variance is {self.noise_variance}; a variance is finite and not negative")
        self.motion.known(self.time[[0, -1]])
        self.motion.refuse_unit(self.unit)
        warn_if_implausible(self.time, self.outputs, self.names, self.view, self.motion)

    def __repr__(self) -> str:
        return (
            f"<Recording of {', '.join(self.names)} ({self.view.name}): {len(self.time)} samples from "
            f"{self.time[0]:.6g} to {self.time[-1]:.6g} s, {'with' if self.truth is not None else 'without'} a truth; "
            f"{self.source or 'no source'}>"
        )

    def _check_times(self) -> None:
        time = self.time
        if time.ndim != 1 or len(time) < 2:
            raise ValueError(f"the recording has times of shape {time.shape}; at least two samples are needed")
        if not np.isfinite(time).all() or not (self.intervals > 0).all():
            k = int(np.argmin(self.intervals > 0)) if np.isfinite(time).all() else int(np.argmin(np.isfinite(time)))
            raise ValueError(
                f"the recording's times must increase strictly and be finite; look at row {k + 1}, "
                f"{float(time[k])!r} s: sort the rows and remove repeated ones"
            )
        ask_for_seconds(time, "the recording")

    def _check_outputs(self) -> None:
        expected = (len(self.time), *self.view.point_shape, len(self.names))
        if self.outputs.shape != expected or not self.names:
            raise ValueError(
                f"the recording has outputs of shape {self.outputs.shape}; expected {expected}: "
                f"one row a time, one column for each of the names, {', '.join(self.names) or 'at least one'}; the "
                "times come first"
            )
        known = [symbol.name for symbol in self.view.image_coordinates]
        if len(set(self.names)) != len(self.names) or not set(self.names) <= set(known):
            raise ValueError(f"the outputs are named {', '.join(self.names)}; there are {', '.join(known)}, each once")
        valueless = [str(symbol) for symbol in self.view.parameters if symbol not in self.view.values]
        if valueless:
            raise ValueError(f"the {self.view.name} has no values for {', '.join(valueless)}; give them numbers first")
        if np.isinf(self.outputs).any() or (not self.view.point_shape and np.isnan(self.outputs).all()):
            raise ValueError("outputs are finite, or NaN where a sample was lost; of one point one at least is needed")

    def _check_truth(self) -> None:
        if self.truth is None:
            return
        expected = (len(self.time), len(self.view.coordinates))
        names = ", ".join(map(str, self.view.coordinates))
        if self.truth.shape != expected:
            raise ValueError(f"the truth has shape {self.truth.shape}; expected {expected}: {names}")
        if np.isinf(self.truth).any():
            row = int(np.argwhere(np.isinf(self.truth))[0, 0])
            raise ValueError(f"the truth is infinite in row {row + 1}; give numbers, or NaN where it is not known")
        inverse = self.view.inverse(self.truth)
        behind = np.argwhere(self.seen & (inverse <= 0))
        if len(behind):
            where = tuple(behind[0])
            raise BehindCamera(
                f"the true inverse distance is {inverse[where]:.4g} at {self.time[where[0]]:.4g} s; only points in "
                "front of the camera, at positive inverse distances, are seen"
            )

    @cached_property
    def scale(self) -> Array:
        """Factors that turn the coordinates in metres into those in the recording's unit of length, shape (n,)."""
        return readonly(self.unit ** -np.array(self.view.lengths[: len(self.view.coordinates)], dtype=float))

    @cached_property
    def elapsed(self) -> Array:
        """Seconds since the first sample, shape (K,), as messages and figures give them."""
        return self.time - self.time[0]

    @cached_property
    def intervals(self) -> Array:
        """Seconds from each sample to the next, shape (K - 1,)."""
        return readonly(np.diff(self.time))

    @cached_property
    def longest_interval(self) -> float:
        """Longest time from a sample to the next, in seconds."""
        return float(self.intervals.max())

    @cached_property
    def last_outputs(self) -> Array:
        """Outputs, with the last one before where a sample was lost."""
        there = np.isfinite(self.outputs)
        if there.all():
            return self.outputs
        rows = np.arange(len(self.time)).reshape(-1, *[1] * (self.outputs.ndim - 1))
        return readonly(np.take_along_axis(self.outputs, np.maximum.accumulate(np.where(there, rows, 0)), axis=0))

    @property
    def seen(self) -> Flags:
        """True where all outputs of a point were sampled, shape (K,) or (K, p)."""
        return np.asarray(np.isfinite(self.outputs).all(axis=-1))

    @property
    def imaging_surface(self) -> ImagingSurface:
        """View of one point, with rays and distances; raises ValueError if it is no imaging surface."""
        refuse_several("this", self.view)
        if not isinstance(self.view, ImagingSurface):
            raise ValueError(f"this needs image coordinates of one point, but the recording shows the {self.view.name}")
        return self.view

    @property
    def points(self) -> Array | None:
        """True positions in metres, shape (K, 3) or (K, p, 3), if the truth is known."""
        return None if self.truth is None else self.view.locate(self.truth)

    @cached_property
    def distance(self) -> Array:
        """True depth or range in metres, shape (K,) or (K, p); raises ValueError without a truth."""
        if self.truth is None:
            raise ValueError("the recording has no truth to compare with")
        return 1 / self.view.inverse(self.truth)

    @cached_property
    def depth(self) -> float:
        """Typical distance in metres: the median of the true ones, of measured ones, or of the place where rays meet.

        Infinite where none of them is known.
        """
        known = [] if self.truth is None else [self.distance]
        for values in (*known, *self.distances.values()):
            if np.isfinite(values).any():
                return float(np.nanmedian(values))
        rows, surface = np.flatnonzero(self.seen), self.view
        if not isinstance(surface, ImagingSurface) or len(self.names) < len(surface.image_coordinates) or not len(rows):
            return math.inf
        ray = vectorised(surface.image_coordinates, surface.ray, surface.values)
        rays = np.stack(ray(*self.outputs[rows].T), axis=-1)
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        point, along, _ = point_on_rays(rays, reckon(self.motion, self.time)[rows, :3])
        return float(np.median(along) / point[3]) if point[3] > 0 else math.inf

    @cached_property
    def effective_variance(self) -> float | None:
        """Variance of white noise that harms an estimate as much as the errors of images and poses together do.

        It is what filters, bounds, trust and diagnosis take; None where the `noise_variance` is not known.  All points
        of a camera share the errors of its poses, so that a mean over points is no more certain of them.
        """
        if self.noise_variance is None or self.motion.errors is None:
            return self.noise_variance
        interval = float(np.median(self.intervals))
        return self.noise_variance + float(self.motion.errors.image_variance(self.depth, interval))

    @cached_property
    def landmark(self) -> VirtualLandmark:
        """Judgement of the motion by the poses that it comes from, with a virtual landmark at the typical distance."""
        if self.motion.errors is None or not math.isfinite(self.depth):
            return VirtualLandmark(0.0, 0.0)
        return self.motion.errors.landmark(self.motion, self.depth, float(self.time[0]), float(self.time[-1]))

    def reference(self, name: str) -> Array:
        """Return the true distances, "truth", or measured ones by name, in metres, shape (K,) or (K, p)."""
        if name != "truth" and name not in self.distances:
            known = ", ".join(["truth", *self.distances])
            raise ValueError(f"the recording {self.source!r} has no distance with the name {name!r}; it has {known}")
        return self.distance if name == "truth" else self.distances[name]

    def in_own_unit(self) -> Recording:
        """Return the recording with the unit from its translation, with which default gains suit any scene.

        It is the length in which b has the root mean square of `USUAL_SPEED` a second; 1 where nothing translates.
        """
        return replace(self, unit=self.motion.speed(self.time) / USUAL_SPEED or 1.0)

    def between(self, begin: float, end: float) -> Recording:
        """Return the part of the recording with begin <= time <= end in seconds, two samples at least."""
        keep = (self.time >= begin) & (self.time <= end)
        if keep.sum() < 2:
            raise ValueError(
                f"{keep.sum()} samples lie between the begin, {begin} s, and the end, {end} s; two are needed, "
                f"and there are some from {self.time[0]:.6g} to {self.time[-1]:.6g} s"
            )
        return replace(
            self,
            time=self.time[keep],
            outputs=self.outputs[keep],
            truth=None if self.truth is None else self.truth[keep],
            distances={name: values[keep] for name, values in self.distances.items()},
        )

    def without(self, begin: float, end: float, point: int = 0) -> Recording:
        """Return the recording without a point's images with begin <= time < end in seconds; points count from 0."""
        if not begin < end:
            raise ValueError(f"without() got the times from {begin} to {end} s; the end must come after the begin")
        outputs = self.outputs.copy()
        each = outputs.reshape(len(self.time), -1, len(self.names))
        if not 0 <= point < each.shape[1]:
            raise ValueError(f"there is no point {point}; there are 0 to {each.shape[1] - 1}")
        each[(self.time >= begin) & (self.time < end), point] = np.nan
        return replace(self, outputs=outputs)

    def to_pandas(self) -> Any:
        """Return the samples as a table: time in seconds, outputs, true coordinates as true_y1, and distances.

        Of several points the outputs and distances have a number as well, y1_0.
        """
        pd = load_pandas()
        points = [f"_{k}" for k in range(self.view.point_shape[0])] if self.view.point_shape else [""]
        parts = [(["time"], self.time), ([f"{name}{k}" for k in points for name in self.names], self.outputs)]
        if self.truth is not None:
            parts.append(([f"true_{symbol.name}" for symbol in self.view.coordinates], self.truth))
        parts += [([f"{name}{k}" for k in points], values) for name, values in self.distances.items()]
        arrays = [values.reshape(len(self.time), -1) for _, values in parts]
        return pd.DataFrame(np.hstack(arrays), columns=[name for names, _ in parts for name in names])

    def sightings(self, absence: float) -> tuple[Sighting, ...]:
        """Return when points are in sight, in the order of their beginnings.

        After `absence` seconds without a sample it is another sighting.
        """
        if not absence > 0:
            raise ValueError(f"the absence is {absence} s; it must be positive")
        found = []
        for point, seen in enumerate(self.seen.reshape(len(self.time), -1).T):
            parts = runs(self.time, np.flatnonzero(seen), absence)
            found += [Sighting(point, int(part[0]), int(part[-1])) for part in parts]
        return tuple(sorted(found, key=lambda sighting: (sighting.first, sighting.point)))

    @classmethod
    def from_csv(
        cls,
        path: PathLike,
        motion: Motion,
        surface: ImagingSurface | None = None,
        time: str = "time",
        *,
        point: str | None = None,
        depth: str | None = None,
        distances: Sequence[str] = (),
        camera: PixelCamera | None = None,
        pixels: Sequence[str] = ("u", "v"),
        pixel_sigma: float | None = None,
        clock: Clock = SECONDS,
        gap: float = math.inf,
        shortest: float = 0.0,
    ) -> Any:
        """Read the track of a point from a table with a header, or the tracks of several.

        Parameters
        ----------
        path : path
            A row for each sample, and columns for the times and the outputs (y1, y2, or pixels).  A column with the
            name of the inverse distance (y3 for the pinhole) is the truth.  Empty cells are lost samples, and lines
            that begin with # are comments.
        motion : Motion
            Known motion, with numbers, for instance ``read_tum("poses.txt").motion()``.
        surface : ImagingSurface, optional
            The pinhole when left out.
        time : str
            Name of the column of times.
        point : str, optional
            Name of a column that tells several points apart, by numbers or text.
        depth : str, optional
            Name of a column with the true distance of the surface in metres, for the pinhole the depth Z.
        distances : sequence of str
            Names of columns with distances in metres that were measured independently, such as ("stereo",).
        camera : PixelCamera, optional
            Converts pixels to image coordinates, its lens included.
        pixels : pair of str
            Names of the columns of pixels; read with a camera only.
        pixel_sigma : float, optional
            Standard deviation of the noise in pixels, if it is known.
        clock : Clock
            Of the table, so that its times are those of the motion.
        gap : float
            Seconds without a sample after which a point's track is another recording.
        shortest : float
            Seconds that a recording lasts at least.

        Returns
        -------
        Recording, or a tuple of them if a column of points is named
            One a point, from its first sample to its last, or several if there are longer gaps.  The image
            coordinates of the truth are the measured ones.

        Warns
        -----
        Unlikely
            If rows are left out, because the motion is not known there or a point is seen once.

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        BehindCamera
            If a distance is not positive.
        ValueError
            If a column is missing or named twice, a cell is not a number, the clocks do not overlap, or the rows are no
            recording.

        See Also
        --------
        percept_obs.read_tum, percept_obs.read_euroc : Poses of the camera.

        Examples
        --------
        >>> from percept_obs.recording.pose_files import read_tum
        >>> from percept_obs.recording.worked import WORKED_CAMERA, worked_folder
        >>> motion = read_tum(worked_folder() / "poses.txt").motion()
        >>> near, far = Recording.from_csv(
        ...     worked_folder() / "tracks.csv", motion, camera=WORKED_CAMERA, point="point_id", depth="depth",
        ...     clock=Clock(zero=500, tick=1e-3),
        ... )
        >>> near.source, len(near.time)
        ('tracks.csv, point near', 17)
        """
        columns = (time, point, depth, distances, camera, pixels)
        found = fields_of_recordings(path, motion, surface or pinhole(), *columns, pixel_sigma, clock, gap, shortest)
        recordings = tuple(cls(**fields) for fields in found)
        return recordings[0] if point is None else recordings


def _by_name(name: str, table: Any, expected: Sequence[str]) -> Any:
    """Columns of a table by their names, shape (K, m); what is no table as it is."""
    if not isinstance(table, Mapping):
        return table
    if missing := [column for column in expected if column not in table]:
        raise ValueError(
            f"{name} is a table with the columns {', '.join(table)}; it needs {', '.join(missing)}: rename them, or "
            "fill them with NaN"
        )
    return np.stack([table[column] for column in expected], axis=-1)
