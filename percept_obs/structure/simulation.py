"""Simulated pictures of an object, from which image coordinates and a scaled inverse depth are measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from percept_obs.recording import NO_NOISE, Camera, Gaussian, Noise, Recording, Scenario, Seed, seeded
from percept_obs.structure.choice import OUTPUTS, StructureAndMotion
from percept_obs.structure.linear import LinearView
from percept_obs.structure.pixels import PixelCamera, SignalToNoise, apparent_size, homography
from percept_obs.system.motion import Motion

Array = NDArray[np.float64]
NAMES = tuple(symbol.name for symbol in OUTPUTS)


class DepthSource(Protocol):
    """Where the scaled inverse depth comes from."""

    @property
    def offsets(self) -> Array:
        """The object's points minus the tracked one at time 0, shape (n, 3), in metres; the tracked one comes first."""

    def measure(self, images: Array, exact: Array, time: Array, generator: np.random.Generator) -> Array:
        """Scaled inverse depths, shape (K,).

        Parameters
        ----------
        images : array of shape (K, n, 2)
            Measured image coordinates of the object's points.
        exact : array of shape (K,)
            What would be measured without errors.
        time : array of shape (K,)
            Seconds.
        generator : numpy Generator
        """


@dataclass(frozen=True)
class GivenDepth:
    """A scaled inverse depth that is given, with errors of one's choice: ybar3 + bias + drift t + noise.

    Parameters
    ----------
    noise : Uniform or Gaussian
    bias : float
        In the unit of ybar3.  A constant factor would be no error: it changes what d_s is.
    drift : float
        Per second.
    """

    noise: Noise = NO_NOISE
    bias: float = 0.0
    drift: float = 0.0

    @property
    def offsets(self) -> Array:
        """The tracked point alone."""
        return np.zeros((1, 3))

    def measure(self, images: Array, exact: Array, time: Array, generator: np.random.Generator) -> Array:
        """See `DepthSource`."""
        return exact + self.bias + self.drift * time + self.noise.draw(generator, exact.shape)


@dataclass(frozen=True, eq=False)
class PatchDepth:
    """The scaled inverse depth from the homography between the first picture of a planar patch and each other.

    With H scaled as in `homography` and the point's first image m*, the depth has become (H m*)_3 times the first, so
    that ybar3 is its first value over (H m*)_3.  Noise in the first picture becomes a constant factor of d_s.

    Parameters
    ----------
    offsets : array of shape (n, 3)
        As from `grid_patch`.
    """

    offsets: Array

    def measure(self, images: Array, exact: Array, time: Array, generator: np.random.Generator) -> Array:
        """See `DepthSource`."""
        first = np.append(images[0, 0], 1.0)
        return exact[0] / (homography(images[0], images)[:, 2] @ first)


@dataclass(frozen=True, eq=False)
class SizeDepth:
    """The scaled inverse depth from the apparent size of an object whose size is constant and unknown.

    Exact if the object's points share one depth and neither it nor the camera turns, as `apparent_size` says.

    Parameters
    ----------
    offsets : array of shape (n, 3)
        As from `grid_patch`.
    """

    offsets: Array

    def measure(self, images: Array, exact: Array, time: Array, generator: np.random.Generator) -> Array:
        """See `DepthSource`."""
        size = apparent_size(images)
        return exact[0] * size / size[0]


def grid_patch(side: float, count: int = 3, normal: Sequence[float] = (0.0, 0.0, 1.0)) -> Array:
    """Points of a square grid around a tracked one, as offsets from it.

    Parameters
    ----------
    side : float
        Length of the square's side in metres.
    count : int
        Points along a side; odd, so that the tracked one is among them.
    normal : three floats
        Normal vector of the patch in the camera's frame; facing the camera when left out.

    Returns
    -------
    array of shape (count^2, 3)
        In metres, zero first.

    Raises
    ------
    ValueError
        If the side is not positive, the count is not odd and at least 3, or the normal vector is zero.
    """
    if not (np.isfinite(side) and side > 0) or count < 3 or count % 2 == 0:
        raise ValueError(f"a patch needs an odd count from 3 on and a positive side, not {count} points and {side} m")
    towards = np.asarray(normal, dtype=float)
    if towards.shape != (3,) or not np.isfinite(towards).all() or not towards.any():
        raise ValueError(f"the normal vector {normal!r} must be three finite numbers, not all zero")
    # an orthonormal basis that begins with the normal; the other two span the patch
    basis = np.linalg.svd(towards[None, :])[2][1:]
    ticks = np.linspace(-side / 2, side / 2, count)
    grid = np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)
    nearest_first = np.argsort(np.abs(grid).sum(axis=1), kind="stable")
    return grid[nearest_first] @ basis


@dataclass(frozen=True, eq=False)
class StructureScenario:
    """A point of an object in rigid motion, its scale, and what is known of them.

    Parameters
    ----------
    scenario : Scenario
        On the pinhole, with a motion from `rigid`.
    scale : float
        The true d_s in 1/m, so that ybar3 = y3 / d_s is measured.
    choice : StructureAndMotion
        What is unknown.  If it knows d_s, it is given the true one.
    """

    scenario: Scenario
    scale: float
    choice: StructureAndMotion

    def __post_init__(self) -> None:
        if not (np.isfinite(self.scale) and self.scale > 0):
            raise ValueError(f"d_s is {self.scale}; it is one over a distance in metres, finite and positive")
        if self.choice.parameters:
            object.__setattr__(self, "choice", replace(self.choice, scale=self.scale))
        self.choice.known_motion(self.scenario.motion)

    def ybar(self, times: ArrayLike) -> Array:
        """Exact (y1, y2, ybar3) at some times in seconds, shape (K, 3)."""
        return self.scenario.coordinates(times) / [1.0, 1.0, self.scale]


def record_structure(
    setup: StructureScenario,
    duration: float | None = None,
    camera: Camera | None = None,
    pixels: PixelCamera | None = None,
    ratio: SignalToNoise | None = None,
    depth: DepthSource | None = None,
    seed: Seed = 0,
) -> Recording:
    """Simulate what a camera measures of an object: (y1, y2, ybar3) of its tracked point.

    Parameters
    ----------
    setup : StructureScenario
    duration : float, optional
        Seconds; the scenario's own when left out.
    camera : Camera, optional
        Period, noise in pixels, and lost pictures; one picture a millisecond without noise when left out.
    pixels : PixelCamera, optional
        One whose pixels are the image coordinates when left out.  Pictures in which a point of the object is outside
        the image are lost.
    ratio : SignalToNoise, optional
        Instead of the camera's noise; the signal is the pixel coordinates of all points of the object.
    depth : DepthSource, optional
        `GivenDepth` without errors when left out.
    seed : int or numpy Generator
        Of the noise of the pixels, then of the depth source, then of the lost pictures.

    Returns
    -------
    Recording
        Of the setup's choice, with its true theta and with the known part of the motion only.

    Raises
    ------
    BehindCamera
        If a point of the object does not stay in front of the camera.
    ValueError
        If the duration holds no two pictures, or a point is outside the first one.
    """
    camera = camera or Camera(period=1e-3)
    pixels = pixels or PixelCamera((1.0, 1.0))
    depth = depth or GivenDepth()
    scenario = setup.scenario
    duration = scenario.duration if duration is None else float(duration)
    count = int(np.floor(duration / camera.period + 1e-9)) if np.isfinite(duration) else 0
    if count < 1:
        raise ValueError(f"a duration of {duration} s holds no two pictures {camera.period} s apart; record longer")
    time: Array = camera.period * np.arange(count + 1, dtype=float)
    seen = scenario.surface.project(_object_points(scenario, depth.offsets, time))
    exact, clean = seen[:, 0] / [1.0, 1.0, setup.scale], pixels.pixels(seen[..., :2])
    noise = Gaussian(ratio.sigma(clean)) if ratio else camera.noise
    generator = seeded(seed)
    noisy = clean + noise.draw(generator, clean.shape)
    images = pixels.image(noisy)
    samples = np.column_stack([images[:, 0], depth.measure(images, exact[:, 2], time, generator)])
    lost = generator.random(len(time)) < camera.dropout
    lost[0] = False
    lost |= ~pixels.sees(noisy).all(axis=1)
    if lost[0]:
        raise ValueError(f"the object is outside the first picture, at the pixels {noisy[0].round(1).tolist()}")
    samples[lost] = np.nan
    named = "of a given generator" if isinstance(seed, np.random.Generator) else seed
    choice = setup.choice
    return Recording(
        time,
        samples,
        NAMES,
        choice,
        choice.known_motion(scenario.motion),
        np.hstack([exact, choice.hidden(setup.scale, scenario.motion, time)]),
        setup.ybar,
        noise.variance / float(np.prod(pixels.focal)),
        source=f"{scenario.name}, {duration:g} s, {camera.period:g} s apart, {ratio or noise}, {depth}, seed {named}",
    )


def _object_points(scenario: Scenario, offsets: Array, time: Array) -> Array:
    """Positions of the object's points, shape (K, n, 3): offsets turn with the rotation, in which they are linear."""
    tracked = scenario.points(time)
    if not offsets.any():
        return tracked[:, None]
    beside = np.asarray(scenario.position) + np.eye(3)
    turned = [replace(scenario, position=point).points(time) - tracked for point in beside.tolist()]
    return tracked[:, None] + offsets @ np.stack(turned, axis=1)


def seen_as(recording: Recording, choice: StructureAndMotion, motion: Motion, scale: float | None = None) -> Recording:
    """The same samples, with another choice of what is known.

    Parameters
    ----------
    recording : Recording
        Of (y1, y2, ybar3).
    choice : StructureAndMotion
        With a number for d_s if it is known.
    motion : Motion
        From `rigid`; what is unknown in it is not used unless the truth is asked for.
    scale : float, optional
        The true d_s, if the true theta shall follow from the motion; it has no truth when left out.

    Returns
    -------
    Recording
    """
    truth = None
    if scale is not None:
        ybar = recording.outputs if recording.truth is None else recording.truth[:, : len(OUTPUTS)]
        truth = np.hstack([ybar, choice.hidden(scale, motion, recording.time)])
    return replace(recording, surface=choice, motion=choice.known_motion(motion), truth=truth)


def linear_view(recording: Recording) -> Recording:
    """The same recording in scaled positions, for the Kalman filter.

    Parameters
    ----------
    recording : Recording
        Of (y1, y2, ybar3).

    Raises
    ------
    ValueError
        If it is of something else.
    """
    choice = recording.surface
    if not isinstance(choice, StructureAndMotion) or recording.names != NAMES:
        raise ValueError(f"the linear view needs the outputs {', '.join(NAMES)}, not {', '.join(recording.names)}")
    view, truth, signal = LinearView(choice), recording.truth, recording.signal
    return replace(
        recording,
        outputs=view.outputs(recording.outputs),
        names=tuple(symbol.name for symbol in view.image_coordinates),
        surface=view,
        truth=None if truth is None else np.hstack([view.outputs(truth[:, :3]), truth[:, 3:]]),
        signal=None if signal is None else lambda times: view.outputs(signal(times)),
        noise_variance=None,
    )
