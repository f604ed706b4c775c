"""Simulation: a point in motion, and the camera that records it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, cast

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from percept_obs.compile import Table, solve
from percept_obs.compile.equations import Equations
from percept_obs.recording.recording import Recording, halves, step_grid
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import POINT, BehindCamera, ImagingSurface

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


@lru_cache(maxsize=64)
def _point_in_motion(A: sp.ImmutableMatrix, b: sp.ImmutableMatrix, parameters: tuple[sp.Symbol, ...]) -> Equations:
    return Equations(POINT, tuple(A * sp.ImmutableMatrix(POINT) + b), (), parameters)
