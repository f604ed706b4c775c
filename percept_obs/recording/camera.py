"""How a scene is sampled: a camera's clock, its noise, and what it loses."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from percept_obs.compile import Array, Flags
from percept_obs.system.motion import Motion
from percept_obs.system.view import View
from percept_obs.validation import checked, limit

Seed = np.random.Generator | int


def _check_spread(name: str, value: float) -> None:
    if not (np.isfinite(value) and value >= 0):
        raise ValueError(f"the noise's {name} is {value}; it must be finite and not negative")


@checked
@dataclass(frozen=True)
class Uniform:
    """Uniform noise between -bound and bound.

    Examples
    --------
    >>> from percept_obs import Uniform
    >>> print(f"{Uniform(0.3).variance:.3f}")
    0.030
    """

    bound: float

    def __post_init__(self) -> None:
        _check_spread("bound", self.bound)

    @property
    def variance(self) -> float:
        """bound^2 / 3."""
        return self.bound**2 / 3

    def draw(self, generator: np.random.Generator, shape: tuple[int, ...]) -> Array:
        """Independent samples."""
        return self._draw(generator, shape)

    def _draw(self, generator: np.random.Generator, shape: tuple[int, ...]) -> Array:
        return generator.uniform(-self.bound, self.bound, shape)


@checked
@dataclass(frozen=True)
class Gaussian:
    """Gaussian noise of standard deviation sigma.

    Examples
    --------
    >>> from percept_obs import Gaussian
    >>> print(f"{Gaussian(0.1).variance:.3f}")
    0.010
    """

    sigma: float

    def __post_init__(self) -> None:
        _check_spread("sigma", self.sigma)

    @property
    def variance(self) -> float:
        """sigma^2."""
        return self.sigma**2

    def draw(self, generator: np.random.Generator, shape: tuple[int, ...]) -> Array:
        """Independent samples, by the Box-Muller transform of two uniform ones."""
        return self._draw(generator, shape)

    def _draw(self, generator: np.random.Generator, shape: tuple[int, ...]) -> Array:
        first, second = generator.random((*shape, 2)).transpose(-1, *range(len(shape)))
        return self.sigma * np.sqrt(-2 * np.log1p(-first)) * np.cos(2 * np.pi * second)


Noise = Uniform | Gaussian
NO_NOISE = Uniform(0.0)


@checked
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
        Probability that a sample of a point is lost, from 0 to below 1; the first one never is.
    reach : float
        Largest absolute image coordinate that is seen; a point outside is not.
    field_of_view : float
        Full angle in radians of the cone around the optical axis that is seen, on whatever surface; all around at 2 pi.

    Raises
    ------
    ValueError
        If a number is out of its range.

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian
    >>> Camera(period=0.5, noise=Gaussian(0.01)).times(2).tolist()
    [0.0, 0.5, 1.0, 1.5, 2.0]
    """

    period: float = 0.01
    noise: Noise = NO_NOISE
    dropout: float = 0.0
    reach: float = np.inf
    field_of_view: float = 2 * math.pi

    def __post_init__(self) -> None:
        if not (np.isfinite(self.period) and self.period > 0):
            raise ValueError(f"the camera's period is {self.period} s; it must be positive")
        if not 0 <= self.dropout < 1:
            raise ValueError(f"the camera's dropout is {self.dropout}; it is a probability, 0 or more and below 1")
        if not self.reach > 0:
            raise ValueError(f"the camera's reach is {self.reach}; the largest coordinate it sees must be positive")
        if not 0 < self.field_of_view <= 2 * math.pi:
            raise ValueError(
                f"the camera's field of view is {self.field_of_view} rad; it must be above 0 and at most 2 pi: use "
                "np.radians(...) for degrees"
            )

    def times(self, duration: float, each: int = 1) -> Array:
        """Times of the samples in seconds, from 0 on.

        Parameters
        ----------
        duration : float
            In seconds.
        each : int
            Numbers that are kept of a sample.

        Raises
        ------
        ValueError
            If the duration holds no two of them.
        TooMuchWork
            If it holds too many.
        """
        if not math.isfinite(duration):
            raise ValueError(f"a duration of {duration} s holds no two samples; it must be finite")
        limit(
            duration / self.period * (each + 4),
            f"numbers, from {duration / self.period:.3g} samples",
            "shorten the duration or lengthen the camera's period",
        )
        if not duration >= self.period * (1 - 1e-9):
            raise ValueError(f"a duration of {duration} s holds no two samples {self.period} s apart; record longer")
        return self.period * np.arange(int(np.floor(duration / self.period + 1e-9)) + 1, dtype=float)

    def samples(self, scene: Scene, time: Array, truth: Array, generator: np.random.Generator) -> tuple[Array, float]:
        """Samples of a scene.

        Parameters
        ----------
        scene : Scene
        time : array of shape (K,)
            Seconds.
        truth : array of shape (K, n)
            Coordinates of the scene's view.
        generator : numpy Generator
            Of the noise and then of the lost samples.

        Returns
        -------
        outputs : array of shape (K, ..., m)
            NaN where a point is not seen.
        variance : float
            Of the noise in each output.
        """
        exact = scene.view.outputs(truth)
        outputs = exact + self.noise.draw(generator, exact.shape)
        lost = self.lost(generator, exact.shape[:-1])
        outputs[lost | ~(np.abs(exact).max(axis=-1) <= self.reach) | self._beside(scene.view, truth)] = np.nan
        return outputs, self.noise.variance

    def drawn(self, seeds: Sequence[int], shape: tuple[int, ...]) -> Array:
        """For each of S seeds the noise of outputs of a shape, (S, K, ..., m); NaN where a sample is lost by chance."""
        noise = np.zeros((len(seeds), *shape))
        for k, generator in enumerate(_generators(seeds) if self.noise.variance or self.dropout else ()):
            noise[k] = self.noise._draw(generator, shape)
            if self.dropout:
                noise[k][self._lost(generator, shape[:-1])] = np.nan
        return noise

    def _beside(self, view: View, truth: Array) -> Flags | bool:
        """Which points lie outside of the field of view, shape (K, ...)."""
        if self.field_of_view == 2 * math.pi:
            return False
        points = view.locate(truth)
        return np.asarray(points[..., 2] < math.cos(self.field_of_view / 2) * np.linalg.norm(points, axis=-1))

    def lost(self, generator: np.random.Generator, shape: tuple[int, ...]) -> Flags:
        """Which samples are lost by chance, the first ones never."""
        return self._lost(generator, shape)

    def _lost(self, generator: np.random.Generator, shape: tuple[int, ...]) -> Flags:
        lost = generator.random(shape) < self.dropout
        lost[0] = False
        return lost


class Scene(ABC):
    """What a camera can be pointed at: a point, the points of a state, or an object whose structure is sought.

    Examples
    --------
    >>> from percept_obs import scenarios
    >>> from percept_obs.recording import Scene
    >>> isinstance(scenarios.planar(), Scene)
    True
    """

    name: str
    duration: float

    @property
    @abstractmethod
    def view(self) -> View:
        """As what it is seen."""

    @property
    @abstractmethod
    def known_motion(self) -> Motion:
        """What an observer may know of the motion."""

    @abstractmethod
    def coordinates(self, times: ArrayLike) -> Array:
        """True coordinates of the view at some times in seconds from 0 on, shape (K, n)."""

    @property
    def camera(self) -> Camera:
        """The camera that is taken if none is asked for: one sample every 10 ms without noise."""
        return Camera()

    def _check(self, what: str, values: Sequence[float], names: Sequence[str]) -> tuple[float, ...]:
        """The finite numbers that the scene begins with, one for each name, and a positive duration."""
        array = np.asarray(values, dtype=float)
        if array.shape != (len(names),) or not np.isfinite(array).all():
            raise ValueError(
                f"the {what} of {self.name!r} has shape {array.shape}; expected {len(names)} finite numbers: "
                f"{', '.join(names)}"
            )
        if not (np.isfinite(self.duration) and self.duration > 0):
            raise ValueError(f"the duration is {self.duration} s; it must be positive")
        return tuple(array.tolist())


def seeded(seed: Seed) -> np.random.Generator:
    """The Mersenne Twister MT19937 with its reference seeding, whose numbers are the same in every language.

    Raises
    ------
    ValueError
        If the seed is neither a Generator nor a whole number from 0 to 2^32 - 1.

    Examples
    --------
    >>> from percept_obs.recording import seeded
    >>> seeded(1).random(2).round(3).tolist()
    [0.417, 0.72]
    """
    if isinstance(seed, np.random.Generator):
        return seed
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or not 0 <= seed < 2**32:
        raise ValueError(f"the seed {seed!r} is neither a numpy Generator nor a whole number from 0 to 2^32 - 1")
    return next(_generators([int(seed)]))


def _generators(seeds: Iterable[int]) -> Iterator[np.random.Generator]:
    """One generator, seeded anew each time, for making one takes longer than a hundred seedings."""
    bits = np.random.MT19937(0)
    generator, seeding = np.random.Generator(bits), np.random.RandomState(bits)
    for seed in seeds:
        seeding.seed(seed)
        yield generator
