"""Recordings: what a camera leaves behind, from a simulation or from the world."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any, cast

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from percept_obs.compile import Table, solve
from percept_obs.equations import Equations
from percept_obs.motion import Motion
from percept_obs.surfaces import POINT, BehindCamera, ImagingSurface, pinhole

Array = NDArray[np.float64]
Seed = np.random.Generator | int

PLANT_STEP = 0.005
"""Longest step, in seconds, with which a point's motion is integrated."""


def _check_spread(name: str, value: float) -> None:
    if not (np.isfinite(value) and value >= 0):
        raise ValueError(f"the noise's {name} is {value}; it must be finite and not negative")


@dataclass(frozen=True)
class Uniform:
    """Uniform noise between -bound and bound."""

    bound: float

    def __post_init__(self) -> None:
        _check_spread("bound", self.bound)

    @property
    def variance(self) -> float:
        """bound^2 / 3."""
        return self.bound**2 / 3

    def draw(self, generator: np.random.Generator, shape: tuple[int, ...]) -> Array:
        """Independent samples."""
        return generator.uniform(-self.bound, self.bound, shape)


@dataclass(frozen=True)
class Gaussian:
    """Gaussian noise of standard deviation sigma."""

    sigma: float

    def __post_init__(self) -> None:
        _check_spread("sigma", self.sigma)

    @property
    def variance(self) -> float:
        """sigma^2."""
        return self.sigma**2

    def draw(self, generator: np.random.Generator, shape: tuple[int, ...]) -> Array:
        """Independent samples, by the Box-Muller transform of two uniform ones."""
        first, second = generator.random((*shape, 2)).transpose(-1, *range(len(shape)))
        return self.sigma * np.sqrt(-2 * np.log1p(-first)) * np.cos(2 * np.pi * second)


Noise = Uniform | Gaussian
NO_NOISE = Uniform(0.0)


@dataclass(frozen=True)
class Camera:
    """How a scene is sampled.

    Parameters
    ----------
    period : float
        Time between samples in seconds.
    noise : Uniform or Gaussian
        Added to every output, independently.
    dropout : float
        Probability that a sample is lost, from 0 to below 1; the first one never is.
    """

    period: float = 0.01
    noise: Noise = NO_NOISE
    dropout: float = 0.0

    def __post_init__(self) -> None:
        if not (np.isfinite(self.period) and self.period > 0):
            raise ValueError(f"the camera's period is {self.period} s; it must be positive")
        if not 0 <= self.dropout < 1:
            raise ValueError(f"the camera's dropout is {self.dropout}; it is a probability, 0 or more and below 1")


@dataclass(frozen=True, eq=False)
class Scenario:
    """A point in motion and the surface on which it is seen.

    Parameters
    ----------
    name : str
    motion : Motion
        With numbers.
    position : array of shape (3,)
        The point at time 0, in metres.
    duration : float
        In seconds.
    surface : ImagingSurface
    source : str
        Where the set-up comes from.
    """

    name: str
    motion: Motion
    position: Sequence[float]
    duration: float
    surface: ImagingSurface
    source: str = ""

    def __post_init__(self) -> None:
        position = np.asarray(self.position, dtype=float)
        if position.shape != (3,) or not np.isfinite(position).all():
            raise ValueError(f"the position {self.position!r} must be three finite numbers, in metres")
        object.__setattr__(self, "position", tuple(position.tolist()))
        if not (np.isfinite(self.duration) and self.duration > 0):
            raise ValueError(f"the duration is {self.duration} s; it must be positive")
        self.surface.project(position)

    def points(self, times: ArrayLike) -> Array:
        """Positions of the point, integrated with steps of at most `PLANT_STEP`.

        Parameters
        ----------
        times : array of shape (K,)
            Seconds, from 0 on, not decreasing.

        Returns
        -------
        array of shape (K, 3)
            Metres.
        """
        times = np.asarray(times, dtype=float)
        grid, last = step_grid(np.concatenate([[0.0], times]), PLANT_STEP)
        table = Table(
            np.diff(grid),
            np.zeros((len(grid) - 1, 3, 0)),
            self.motion.known(halves(grid)),
            np.zeros((len(grid), 0)),
        )
        equations = _point_in_motion(self.motion.A, self.motion.b, self.motion.parameters)
        trace = solve(equations, self.position, table)
        if trace.diverged is not None:
            raise BehindCamera(f"the point leaves every bound at {grid[trace.diverged]:.4g} s; shorten the duration")
        return trace.states[last[1:]]

    def coordinates(self, times: ArrayLike) -> Array:
        """Image coordinates and inverse distance of the point, shape (K, n).

        Raises
        ------
        BehindCamera
            If the point is not in front of the camera at one of the times.
        """
        times = np.asarray(times, dtype=float)
        points = self.points(times)
        try:
            return self.surface.project(points)
        except BehindCamera:
            self._say_when(times, points)
            raise

    def _say_when(self, times: Array, points: Array) -> None:
        for time, point in zip(times, points, strict=True):
            try:
                self.surface.project(point)
            except BehindCamera as error:
                raise BehindCamera(f"in the scenario {self.name!r}, at {time:.4g} s, {error}") from None


@dataclass(frozen=True, eq=False)
class Recording:
    """Samples of a point's image, and what is known about the camera's and the point's motion.

    Parameters
    ----------
    time : array of shape (K,)
        Seconds, strictly increasing.
    outputs : array of shape (K, m)
        Samples of the image coordinates; NaN where one was lost.  The first row is complete.
    names : tuple of str
        Names of the outputs, such as ("y1", "y2").
    surface : ImagingSurface
        Where they were seen.
    motion : Motion
        Known motion, with numbers for all times.
    truth : array of shape (K, n), optional
        True image coordinates and inverse distance.
    signal : function of times, optional
        The outputs without noise at any time, shape (T, m), if they are known.
    noise_variance : float, optional
        Variance of the noise in each output.
    distances : mapping of names to arrays of shape (K,), optional
        Independent measurements of the depth or range in metres.
    source : str
        Where the recording comes from, its settings and its seed.
    """

    time: Array
    outputs: Array
    names: tuple[str, ...]
    surface: ImagingSurface
    motion: Motion
    truth: Array | None = None
    signal: Callable[[Array], Array] | None = None
    noise_variance: float | None = None
    distances: Mapping[str, Array] = field(default_factory=dict)
    source: str = ""

    def __post_init__(self) -> None:
        time = _readonly(self.time)
        outputs = _readonly(self.outputs)
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "outputs", outputs)
        object.__setattr__(self, "names", tuple(self.names))
        if time.ndim != 1 or len(time) < 2:
            raise ValueError(f"the recording has times of shape {time.shape}; at least two samples are needed")
        if outputs.shape != (len(time), len(self.names)) or not self.names:
            raise ValueError(
                f"the recording has outputs of shape {outputs.shape}; expected {(len(time), len(self.names))}: "
                f"one row a time, one column for each of {', '.join(self.names) or 'at least one name'}"
            )
        if not np.isfinite(time).all() or not (np.diff(time) > 0).all():
            k = int(np.argmin(np.diff(time) > 0)) if np.isfinite(time).all() else int(np.argmin(np.isfinite(time)))
            raise ValueError(
                f"the recording's times must increase strictly and be finite; look at row {k + 1}, "
                f"{time[k]!r} s: sort the rows and remove repeated ones"
            )
        known = [symbol.name for symbol in self.surface.image_coordinates]
        if len(set(self.names)) != len(self.names) or not set(self.names) <= set(known):
            raise ValueError(
                f"the recording names the outputs {', '.join(self.names)}; those of the {self.surface.name} are "
                f"{', '.join(known)}, each once"
            )
        if np.isinf(outputs).any() or not np.isfinite(outputs[0]).all():
            raise ValueError("outputs are finite, or NaN where a sample was lost; the first row must be complete")
        if self.truth is not None:
            truth = _readonly(self.truth)
            object.__setattr__(self, "truth", truth)
            if truth.shape != (len(time), len(self.surface.coordinates)) or not np.isfinite(truth).all():
                raise ValueError(
                    f"the truth has shape {truth.shape}; expected {(len(time), len(self.surface.coordinates))}, "
                    f"finite: {', '.join(map(str, self.surface.coordinates))}"
                )
            if not (truth[:, -1] > 0).all():
                k = int(np.argmin(truth[:, -1] > 0))
                raise BehindCamera(
                    f"the true inverse distance is {truth[k, -1]:.4g} at {time[k]:.4g} s; only points in front of the "
                    "camera, at positive inverse distances, are seen"
                )
        distances = {name: _readonly(values) for name, values in self.distances.items()}
        object.__setattr__(self, "distances", MappingProxyType(distances))
        for name, values in distances.items():
            if values.shape != time.shape or not (np.isfinite(values) & (values > 0)).all():
                raise ValueError(f"the distances {name!r} must be {len(time)} positive numbers, one a sample")
        self.motion.known(time[[0, -1]])

    @property
    def points(self) -> Array | None:
        """True positions in metres, shape (K, 3), if the truth is known."""
        return None if self.truth is None else self.surface.locate(self.truth)

    def between(self, begin: float, end: float) -> Recording:
        """The part of the recording with begin <= time <= end."""
        keep = (self.time >= begin) & (self.time <= end)
        return replace(
            self,
            time=self.time[keep],
            outputs=self.outputs[keep],
            truth=None if self.truth is None else self.truth[keep],
            distances={name: values[keep] for name, values in self.distances.items()},
        )

    @classmethod
    def from_csv(
        cls,
        path: str | os.PathLike[str],
        motion: Motion,
        surface: ImagingSurface | None = None,
        time: str = "time",
    ) -> Recording:
        """Read a recording from a table with a header.

        Parameters
        ----------
        path : path
            A column of times in seconds, columns named like the outputs (y1, y2), and if the truth is known a
            column with the name of the inverse distance (y3 for the pinhole) beside all of the outputs.  Empty
            cells are lost samples.
        motion : Motion
            Known motion, with numbers.
        surface : ImagingSurface, optional
            The pinhole when left out.
        time : str
            Name of the column of times.

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        ValueError
            If a column is missing, a cell is not a number, or the rows are no recording.
        """
        import pandas as pd

        surface = surface or pinhole()
        rows = pd.read_csv(path)
        names = tuple(s.name for s in surface.image_coordinates if s.name in rows)
        if time not in rows or not names:
            raise ValueError(
                f"{os.fspath(path)} has the columns {', '.join(map(str, rows.columns))}; it needs {time!r} and "
                f"at least one of {', '.join(s.name for s in surface.image_coordinates)}"
            )
        inverse = surface.inverse_distance.name
        try:
            values = rows[[time, *names, *([inverse] if inverse in rows else [])]].to_numpy(dtype=float)
        except ValueError as error:
            raise ValueError(f"{os.fspath(path)} has a cell that is not a number: {error}") from None
        if not len(values):
            raise ValueError(f"{os.fspath(path)} has a header and no rows; at least two samples are needed")
        complete = inverse in rows and len(names) == len(surface.image_coordinates)
        return cls(
            values[:, 0],
            values[:, 1 : 1 + len(names)],
            names,
            surface,
            motion,
            truth=values[:, 1:] if complete else None,
            source=os.fspath(path),
        )


def record(
    scenario: Scenario,
    duration: float | None = None,
    camera: Camera | None = None,
    seed: Seed = 0,
) -> Recording:
    """Simulate what a camera records of a scenario.

    Parameters
    ----------
    scenario : Scenario
    duration : float, optional
        Seconds; the scenario's own when left out.
    camera : Camera, optional
        One sample every 10 ms without noise when left out.
    seed : int or numpy Generator
        Of the noise and the lost samples, drawn in this order.

    Returns
    -------
    Recording

    Raises
    ------
    BehindCamera
        If the point does not stay in front of the camera.
    ValueError
        If the duration is not positive or shorter than one period.
    """
    camera = camera or Camera()
    duration = scenario.duration if duration is None else float(duration)
    count = int(np.floor(duration / camera.period + 1e-9)) if np.isfinite(duration) else 0
    if count < 1:
        raise ValueError(f"a duration of {duration} s holds no two samples {camera.period} s apart; record longer")
    time: Array = camera.period * np.arange(count + 1, dtype=float)
    truth = scenario.coordinates(time)
    outputs = len(scenario.surface.image_coordinates)
    generator = seeded(seed)
    samples = truth[:, :outputs] + camera.noise.draw(generator, (len(time), outputs))
    lost = generator.random(len(time)) < camera.dropout
    lost[0] = False
    samples[lost] = np.nan
    named = "of a given generator" if isinstance(seed, np.random.Generator) else seed
    return Recording(
        time,
        samples,
        tuple(s.name for s in scenario.surface.image_coordinates),
        scenario.surface,
        scenario.motion,
        truth,
        lambda times: scenario.coordinates(times)[:, :outputs],
        camera.noise.variance,
        source=f"{scenario.name}, {duration:g} s, {camera}, seed {named}",
    )


def seeded(seed: Seed) -> np.random.Generator:
    """The Mersenne Twister MT19937 with its reference seeding, whose numbers are the same in every language.

    Raises
    ------
    ValueError
        If the seed is neither a Generator nor a whole number from 0 to 2^32 - 1.
    """
    if isinstance(seed, np.random.Generator):
        return seed
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or not 0 <= seed < 2**32:
        raise ValueError(f"the seed {seed!r} is neither a numpy Generator nor a whole number from 0 to 2^32 - 1")
    bits = np.random.MT19937()
    bits.state = cast(Any, np.random.RandomState(int(seed)).get_state(legacy=False))
    return np.random.Generator(bits)


def step_grid(times: Array, longest: float) -> tuple[Array, NDArray[np.int_]]:
    """Divide the intervals between times into equal steps no longer than given.

    Returns
    -------
    grid : array
        Times of all steps' ends, from ``times[0]`` to ``times[-1]``.
    index : array of shape (len(times),)
        Where the times stand in the grid.
    """
    intervals = np.diff(times)
    counts = np.where(intervals > 0, np.maximum(1, np.ceil(intervals / longest - 1e-9)), 0).astype(int)
    index = np.concatenate([[0], np.cumsum(counts)])
    owner = np.repeat(np.arange(len(counts)), counts)
    inside = np.arange(index[-1]) - index[owner] + 1
    grid = np.concatenate([times[:1], times[owner] + intervals[owner] * (inside / counts[owner])])
    grid[index] = times
    return grid, index


def halves(grid: Array) -> Array:
    """The grid with the middles of its steps put between."""
    both = np.empty(2 * len(grid) - 1)
    both[::2] = grid
    both[1::2] = (grid[:-1] + grid[1:]) / 2
    return both


@lru_cache(maxsize=64)
def _point_in_motion(A: sp.ImmutableMatrix, b: sp.ImmutableMatrix, parameters: tuple[sp.Symbol, ...]) -> Equations:
    return Equations(POINT, tuple(A * sp.ImmutableMatrix(POINT) + b), (), parameters)


def _readonly(values: ArrayLike) -> Array:
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array
