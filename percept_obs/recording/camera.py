"""Sampling of a scene: a camera's clock, its noise, and the samples that it loses."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from percept_obs.compile import Array, Flags
from percept_obs.recording.plausibility import Unlikely
from percept_obs.system.motion import Motion
from percept_obs.system.view import View
from percept_obs.validation import INTEGER, Kind, Times, checked, columns, limit, warn

TOO_SHORT = "a duration of {duration} s holds no two samples {period} s apart; record longer"
"""Reason why a recording of one sample is refused, here and in live labs."""

SLOWEST = 10.0
"""Seconds between two pictures from which on so many pictures a second are more likely."""

_SIZES = Kind("a tuple of sizes from 0 on", lambda v: isinstance(v, tuple) and all(size >= 0 for size in v))
Shape = Annotated[tuple[int, ...], _SIZES]
_SEED = Kind(
    "a numpy Generator, a whole number from 0 to 2^32 - 1, or None for one drawn anew",
    lambda v: isinstance(v, np.random.Generator) or (INTEGER.fits(v) and 0 <= v < 2**32),
    made=lambda v: int(np.random.SeedSequence().generate_state(1)[0]) if v is None else INTEGER.made(v),
)
Seed = Annotated[np.random.Generator | int | None, _SEED]


class _Noise:
    """Independent noise of one spread, which is its bound or its standard deviation."""

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not 0 <= value <= 1e150:  # its square is a float
                raise ValueError(f"{name} is {value}; it must be finite and not negative, and at most 1e150")


@checked
@dataclass(frozen=True)
class Uniform(_Noise):
    """Uniform noise between -bound and bound.

    Parameters
    ----------
    bound : float
        Largest size, in the output's unit.

    Raises
    ------
    ValueError
        If the bound is not finite or negative.

    See Also
    --------
    Gaussian : The other noise.
    Camera : Takes a noise.

    Examples
    --------
    >>> from percept_obs import Uniform
    >>> print(f"{Uniform(0.3).variance:.3f}")
    0.030
    """

    bound: float

    @property
    def variance(self) -> float:
        """bound^2 / 3."""
        return self.bound**2 / 3

    def draw(self, generator: np.random.Generator, shape: Shape) -> Array:
        """Return independent samples of a shape."""
        return generator.uniform(-self.bound, self.bound, shape)


@checked
@dataclass(frozen=True)
class Gaussian(_Noise):
    """Gaussian noise of standard deviation sigma.

    Parameters
    ----------
    sigma : float
        In the output's unit.

    Raises
    ------
    ValueError
        If sigma is not finite or negative.

    See Also
    --------
    Uniform : The other noise.
    Camera : Takes a noise.

    Examples
    --------
    >>> from percept_obs import Gaussian
    >>> print(f"{Gaussian(0.1).variance:.3f}")
    0.010
    """

    sigma: float

    @property
    def variance(self) -> float:
        """sigma^2."""
        return self.sigma**2

    def draw(self, generator: np.random.Generator, shape: Shape) -> Array:
        """Return independent samples of a shape."""
        # Box and Muller's transform, so that other languages draw the same from the same uniform numbers
        first, second = generator.random((*shape, 2)).transpose(-1, *range(len(shape)))
        return self.sigma * np.sqrt(-2 * np.log1p(-first)) * np.cos(2 * np.pi * second)


Noise = Uniform | Gaussian
NO_NOISE = Uniform(0.0)


@checked
@dataclass(frozen=True)
class Camera:
    """Camera that samples a scene.

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

    Warns
    -----
    Unlikely
        If the period looks like pictures a second.

    See Also
    --------
    record : Records a scenario with a camera.
    Uniform, Gaussian : Noise.

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
        for holds, name, unit, expected in (
            (0 < self.period < math.inf, "period", " s", "it must be positive"),
            (0 <= self.dropout < 1, "dropout", "", "it is a probability, 0 or more and below 1"),
            (self.reach > 0, "reach", "", "the largest coordinate it sees must be positive"),
            (0 < self.field_of_view <= 2 * math.pi, "field_of_view", " rad", "it must be above 0 and at most 2 pi"),
        ):
            if not holds:
                raise ValueError(f"the camera's {name} is {getattr(self, name)}{unit}; {expected}")
        if self.period >= SLOWEST:
            each = f"{self.period:.4g}"
            warn(Unlikely(f"the camera takes a picture every {each} s; for {each} pictures a second, Camera(1/{each})"))

    def times(self, duration: float, each: int = 1) -> Array:
        """Return the times of the samples in seconds, from 0 on, shape (K,).

        The duration holds at least one period, and not too many samples for `each` numbers in every one.
        """
        if not math.isfinite(duration):
            raise ValueError(f"a duration of {duration} s holds no two samples; it must be finite")
        limit(
            duration / self.period * (each + 4),
            f"numbers, from {duration / self.period:.3g} samples",
            "shorten the duration or lengthen the camera's period",
        )
        if not duration >= self.period * (1 - 1e-9):
            raise ValueError(TOO_SHORT.format(duration=f"{duration:g}", period=f"{self.period:g}"))
        return self.period * np.arange(int(np.floor(duration / self.period + 1e-9)) + 1, dtype=float)

    def samples(self, scene: Scene, time: Array, truth: Array, generator: np.random.Generator) -> tuple[Array, float]:
        """Return samples of a scene, shape (K, ..., m), and the variance of their noise.

        The truth has the coordinates of its view at the times.  Noise is drawn first, then the lost samples.
        """
        exact = scene.view.outputs(truth)
        if len(exact) != len(time):
            raise ValueError(f"the truth has {len(exact)} rows for {len(time)} times; give a row for each time")
        outputs = exact + self.noise.draw(generator, exact.shape)
        lost = self.lost(generator, exact.shape[:-1]) | ~(np.abs(exact).max(axis=-1) <= self.reach)
        if self.field_of_view < 2 * math.pi:
            points = scene.view.locate(truth)
            lost |= points[..., 2] < math.cos(self.field_of_view / 2) * np.linalg.norm(points, axis=-1)
        outputs[lost] = np.nan
        return outputs, self.noise.variance

    def drawn(self, seeds: Sequence[int], shape: Shape) -> Array:
        """Return noise for each of S seeds, shape (S, K, ..., m); NaN where a sample is lost by chance."""
        noise = np.zeros((len(seeds), *shape))
        for k, generator in enumerate(_generators(seeds) if self.noise.variance or self.dropout else ()):
            noise[k] = self.noise.draw(generator, shape)
            if self.dropout:
                noise[k][self.lost(generator, shape[:-1])] = np.nan
        return noise

    def lost(self, generator: np.random.Generator, shape: Shape) -> Flags:
        """Return True for samples lost by chance; the first ones never are."""
        lost = generator.random(shape) < self.dropout
        lost[:1] = False
        return lost


class Scene(ABC):
    """Scene in front of a camera: a point, the points of a state, or an object whose structure is sought.

    See Also
    --------
    percept_obs.Scenario, percept_obs.PointsScenario : Two of them.

    Examples
    --------
    >>> from percept_obs import scenarios
    >>> from percept_obs.recording import Scene
    >>> isinstance(scenarios.planar(), Scene)
    True
    """

    name: str
    duration: float
    unit: float = 1.0

    @property
    @abstractmethod
    def view(self) -> View:
        """View in which it is seen."""

    @property
    @abstractmethod
    def known_motion(self) -> Motion:
        """Motion as an observer may know it."""

    @abstractmethod
    def coordinates(self, times: Times) -> Array:
        """Return true coordinates of the view at times in seconds from 0 on, shape (K, n)."""

    @property
    def camera(self) -> Camera:
        """Default camera: one sample every 10 ms without noise."""
        return Camera()

    def _check(self, what: str, values: Sequence[float], names: Sequence[str]) -> tuple[float, ...]:
        """Return the scene's initial values as floats; refuse infinite ones and a duration <= 0."""
        labels = columns(values) or {}
        array = np.asarray([labels[name] for name in names] if set(labels) == set(names) else values, dtype=float)
        if array.shape != (len(names),) or not np.isfinite(array).all():
            raise ValueError(
                f"the {what} of {self.name!r} has shape {array.shape}; expected {len(names)} finite numbers: "
                f"{', '.join(names)}"
            )
        if not (np.isfinite(self.duration) and self.duration > 0):
            raise ValueError(f"the duration is {self.duration} s; it must be positive")
        self.known_motion.known(0.0)  # refuses a motion without numbers
        return tuple(array.tolist())


@checked
def seeded(seed: Seed) -> np.random.Generator:
    """Return the Mersenne Twister MT19937 with its reference seeding, the same in every language.

    Parameters
    ----------
    seed : int, numpy Generator or None
        A generator is returned as it is; with None, a seed is drawn.

    Raises
    ------
    ValueError
        If the seed is neither a Generator nor a whole number from 0 to 2^32 - 1.

    See Also
    --------
    record : Draws its noise from it.

    Examples
    --------
    >>> from percept_obs.recording import seeded
    >>> seeded(1).random(2).round(3).tolist()
    [0.417, 0.72]
    """
    assert seed is not None  # one was drawn
    return seed if isinstance(seed, np.random.Generator) else next(_generators([seed]))


def _generators(seeds: Iterable[int]) -> Iterator[np.random.Generator]:
    """Yield one generator, seeded anew each time, for making one takes longer than a hundred seedings."""
    bits = np.random.MT19937(0)
    generator, seeding = np.random.Generator(bits), np.random.RandomState(bits)
    for seed in seeds:
        seeding.seed(seed)
        yield generator
