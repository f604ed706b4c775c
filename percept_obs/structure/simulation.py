"""Simulated pictures of an object, and the image coordinates and scaled inverse depth measured from them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from percept_obs.compile import Array
from percept_obs.recording import NO_NOISE, Camera, Gaussian, Noise, Recording, Scenario, Scene
from percept_obs.recording.pixels import PixelCamera
from percept_obs.structure.choice import StructureAndMotion
from percept_obs.structure.dynamics import OUTPUTS
from percept_obs.structure.linear import LinearView
from percept_obs.structure.pixels import SignalToNoise, homography
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import pinhole
from percept_obs.system.view import View
from percept_obs.validation import Chain, Times, checked, limit, numbers, set_fields

NAMES = tuple(symbol.name for symbol in OUTPUTS)


class DepthSource(Protocol):
    """Source of the scaled inverse depth, such as `GivenDepth` or `PatchDepth`.

    See Also
    --------
    GivenDepth, PatchDepth : Two of them.
    ScaledDepthCamera : Takes one.

    Examples
    --------
    >>> class Rounded(GivenDepth):
    ...     def depths(self, images, exact, time, generator):
    ...         return exact.round(2)
    >>> Rounded().depths(np.zeros((1, 1, 2)), np.array([0.123]), np.zeros(1), np.random.default_rng()).tolist()
    [0.12]
    """

    @property
    def offsets(self) -> Array:
        """Offsets of the object's points from the tracked one at time 0, shape (n, 3), in metres; zero first."""

    def depths(self, images: Array, exact: Array, time: Array, generator: np.random.Generator) -> Array:
        """Scaled inverse depths, shape (K,), from images of shape (K, n, 2), exact depths and times in seconds."""


@checked
@dataclass(frozen=True)
class GivenDepth:
    """Scaled inverse depth that is given with errors: ybar3 + bias + drift t + noise.

    Parameters
    ----------
    noise : Uniform or Gaussian
    bias : float
        In the unit of ybar3.  A constant factor would be no error: it only changes d_s.
    drift : float
        Per second.

    Raises
    ------
    ValueError
        If the bias or the drift is not finite.

    See Also
    --------
    PatchDepth : Measured from pictures.

    Examples
    --------
    >>> import numpy as np
    >>> from percept_obs.recording import seeded
    >>> from percept_obs.structure import GivenDepth
    >>> time, exact = np.array([0.0, 1.0]), np.array([0.5, 0.4])
    >>> GivenDepth(bias=0.01, drift=0.02).depths(np.zeros((2, 1, 2)), exact, time, seeded(0)).round(3).tolist()
    [0.51, 0.43]
    """

    noise: Noise = NO_NOISE
    bias: float = 0.0
    drift: float = 0.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.bias) and math.isfinite(self.drift)):
            raise ValueError(f"the bias is {self.bias} and the drift {self.drift}; both must be finite numbers")

    @property
    def offsets(self) -> Array:
        """Offset of the tracked point alone."""
        return np.zeros((1, 3))

    def depths(self, images: Array, exact: Array, time: Array, generator: np.random.Generator) -> Array:
        """See `DepthSource`."""
        if exact.shape != time.shape:
            raise ValueError(f"the exact depths have shape {exact.shape}, the times {time.shape}; expected the same")
        return exact + self.bias + self.drift * time + self.noise.draw(generator, exact.shape)


@checked
@dataclass(frozen=True, eq=False)
class PatchDepth:
    """Scaled inverse depth from the homography between the first picture of a planar patch and each other.

    With H scaled as in `homography` and the point's first image m*, the depth has become (H m*)_3 times the first, so
    that ybar3 is its first value over (H m*)_3.  Noise in the first picture becomes a constant factor of d_s.

    Parameters
    ----------
    offsets : array of shape (n, 3)
        As from `grid_patch`.

    Raises
    ------
    ValueError
        If the offsets are not finite, or of fewer than four points.

    See Also
    --------
    grid_patch : Makes offsets.
    GivenDepth : With errors of one's choice.

    Examples
    --------
    >>> from percept_obs import record
    >>> from percept_obs.structure import PatchDepth, ScaledDepthCamera, grid_patch
    >>> from percept_obs.structure.scenarios import chwa2019_experiment
    >>> camera = ScaledDepthCamera(0.5, depth=PatchDepth(grid_patch(0.2)))
    >>> record(chwa2019_experiment("IV.A"), 1, camera).outputs.round(3).tolist()
    [[0.32, 0.3, 0.05], [0.377, 0.36, 0.05], [0.434, 0.42, 0.05]]
    """

    offsets: Array

    def __post_init__(self) -> None:
        offsets = numbers(self.offsets, "the offsets", "n", 3)
        if not np.isfinite(offsets).all() or len(np.unique(offsets, axis=0)) < 4:
            raise ValueError("the offsets are not finite, or of fewer than four points; take those of grid_patch()")

    def depths(self, images: Array, exact: Array, time: Array, generator: np.random.Generator) -> Array:
        """See `DepthSource`."""
        first = np.append(images[0, 0], 1.0)
        return exact[0] / (homography(images[0], images)[:, 2] @ first)


@checked
def grid_patch(side: float, count: int = 3) -> Array:
    """Return offsets in metres of a square grid's points from the tracked one in its centre, shape (count^2, 3).

    The grid faces the camera; the tracked one is first.

    Parameters
    ----------
    side : float
        Length of the square's side in metres.
    count : int
        Points along a side; odd, so that the tracked one is among them.

    Raises
    ------
    ValueError
        If the side is not positive, or the count is not odd and at least 3.

    See Also
    --------
    PatchDepth : Measures the depth of the patch.

    Examples
    --------
    >>> from percept_obs.structure import grid_patch
    >>> grid_patch(0.2).shape
    (9, 3)
    >>> grid_patch(0.2)[1].tolist()
    [0.1, 0.0, 0.0]
    """
    if not (np.isfinite(side) and side > 0) or count < 3 or count % 2 == 0:
        raise ValueError(f"a patch needs an odd count from 3 on and a positive side, not {count} points and {side} m")
    limit(float(count) ** 2, "points", "take fewer along a side", 10_000)
    ticks = np.linspace(-side / 2, side / 2, count)
    grid = np.array([(x, y, 0.0) for x in -ticks for y in ticks])
    return grid[np.argsort(np.abs(grid).sum(axis=1), kind="stable")]


@checked
@dataclass(frozen=True, eq=False)
class StructureScenario(Scenario):
    """Scenario of a point of an object in rigid motion, with its scale and a choice of unknowns.

    Parameters
    ----------
    name, motion, position, duration, surface, source
        See `Scenario`; on the pinhole, with a motion from `rigid`.
    scale : float
        The true d_s in 1/m, so that ybar3 = y3 / d_s is measured.
    choice : StructureAndMotion
        Choice of unknowns.  If it knows d_s, it is given the true one.

    Raises
    ------
    ValueError
        If d_s is not positive, or a scenario makes no sense.
    ImpossibleChoice
        If a velocity that is said to be zero is not.

    See Also
    --------
    ScaledDepthCamera : Records it.
    percept_obs.Scenario : Of a point with known motion.

    Examples
    --------
    >>> from percept_obs import StructureAndMotion, pinhole, rigid
    >>> from percept_obs.structure import StructureScenario
    >>> motion = rigid(camera_velocity=[0.3, 0.2, 0.1])
    >>> choice = StructureAndMotion(("d_s", "v_c2", "v_c3"), zero=("v_p1", "v_p2", "v_p3"))
    >>> scene = StructureScenario("a house", motion, (1, 1, 5), 3, pinhole(), scale=4, choice=choice)
    >>> scene.coordinates([0]).tolist()
    [[0.2, 0.2, 0.05, 4.0, 0.8, 0.4]]
    """

    scale: float = field(kw_only=True)
    choice: StructureAndMotion = field(kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (np.isfinite(self.scale) and self.scale > 0):
            raise ValueError(f"d_s is {self.scale}; it is one over a distance in metres, finite and positive")
        if self.choice.parameters:
            set_fields(self, choice=replace(self.choice, scale=self.scale))
        if not pinhole().fits(self.surface):
            raise ValueError(f"structure and motion are seen with a pinhole, not on the {self.surface.name} surface")
        self.choice.known_motion(self.motion)

    @property
    def view(self) -> View:
        """The choice."""
        return self.choice

    @property
    def known_motion(self) -> Motion:
        """Known part of the motion, by the choice."""
        return self.choice.known_motion(self.motion)

    @property
    def camera(self) -> Camera:
        """One picture a millisecond without noise."""
        return ScaledDepthCamera()

    def coordinates(self, times: Times) -> Array:
        """True (y1, y2, ybar3) and theta at some times in seconds, shape (K, 3 + n)."""
        ybar = super().coordinates(times) / [1.0, 1.0, self.scale]
        return np.hstack([ybar, self.choice.theta_values(self.scale, self.motion, times)])


IMAGE_PLANE = PixelCamera((1.0, 1.0))
"""A camera whose pixels are the image coordinates."""
EXACT_DEPTH = GivenDepth()


@checked
@dataclass(frozen=True)
class ScaledDepthCamera(Camera):
    """Camera that measures (y1, y2, ybar3) of an object's tracked point from its pictures.

    Parameters
    ----------
    period, noise, dropout, reach
        See `Camera`, of pictures; the noise is in pixels.
    pixels : PixelCamera
        One whose pixels are the image coordinates when left out.  Pictures in which a point of the object is outside
        the image are lost.
    ratio : SignalToNoise, optional
        Instead of the noise; the signal is the pixel coordinates of all points of the object.
    depth : DepthSource
        `GivenDepth` without errors when left out.

    Raises
    ------
    ValueError
        If a number is out of its range, as of `Camera`, or the noise is given twice.

    See Also
    --------
    percept_obs.Camera : Sees image coordinates only.
    record : Records a scenario with it.

    Examples
    --------
    >>> from percept_obs import Gaussian, PixelCamera, record
    >>> from percept_obs.structure import ScaledDepthCamera
    >>> from percept_obs.structure.scenarios import chwa2019_experiment
    >>> camera = ScaledDepthCamera(0.5, Gaussian(0.5), pixels=PixelCamera((720, 720), (320, 240)))
    >>> record(chwa2019_experiment("IV.A"), 1, camera).outputs.round(2).tolist()
    [[0.32, 0.3, 0.05], [0.38, 0.36, 0.05], [0.43, 0.42, 0.05]]
    """

    period: float = 1e-3
    pixels: PixelCamera = IMAGE_PLANE
    ratio: SignalToNoise | None = None
    depth: DepthSource = EXACT_DEPTH

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.ratio and self.noise != NO_NOISE) or self.field_of_view != 2 * math.pi:
            raise ValueError("give a noise or a ratio, and no field_of_view: the size of pixels=PixelCamera(...) is it")

    def samples(self, scene: Scene, time: Array, truth: Array, generator: np.random.Generator) -> tuple[Array, float]:
        """Samples as of `Camera`; noise is drawn for the pixels, then for the depth, then for the lost pictures.

        All points of the object must stay in front of the camera, and be inside the first picture.
        """
        if not isinstance(scene, StructureScenario):
            raise ValueError(f"a ScaledDepthCamera measures a StructureScenario, not {scene.name!r}; take a Camera")
        points = pinhole().project(_object_points(scene, self.depth.offsets, time))
        clean = self.pixels.pixels(points[..., :2])
        noise = Gaussian(self.ratio.sigma(clean)) if self.ratio else self.noise
        noisy = clean + noise.draw(generator, clean.shape)
        images = self.pixels.image(noisy)
        outputs = np.column_stack([images[:, 0], self.depth.depths(images, truth[:, 2], time, generator)])
        outside = ~self.pixels.sees(noisy).all(axis=1) | ~(np.abs(images).max(axis=(1, 2)) <= self.reach)
        if outside[0]:
            raise ValueError(f"the object is outside the first picture, at the pixels {noisy[0].round(1).tolist()}")
        outputs[self.lost(generator, time.shape) | outside] = np.nan
        return outputs, noise.variance / float(np.prod(self.pixels.focal))


def _object_points(scenario: Scenario, offsets: Array, time: Array) -> Array:
    """Positions of the object's points, shape (K, n, 3): the offsets turn with the body."""
    tracked = scenario.points(time)
    if not offsets.any():
        return tracked[:, None]
    # the motion is affine in the position, so that unit offsets show how all offsets turn
    unit = np.asarray(scenario.position) + np.eye(3)
    turned = [replace(scenario, position=point).points(time) - tracked for point in unit.tolist()]
    return tracked[:, None] + offsets @ np.stack(turned, axis=1)


@checked
def seen_as(recording: Recording, choice: StructureAndMotion, motion: Motion, scale: float | None = None) -> Recording:
    """Return the recording of the same samples, times and noise with another choice of unknowns.

    Parameters
    ----------
    recording : Recording
        Of (y1, y2, ybar3).
    choice : StructureAndMotion
        With a number for d_s if it is known.
    motion : Motion
        From `rigid`; its unknown parameters are not used unless the truth is asked for.
    scale : float, optional
        The true d_s, if the true theta shall follow from the motion; it has no truth when left out.

    Raises
    ------
    ValueError
        If the recording is of something else, or the scale is not positive.
    ImpossibleChoice
        If a velocity that is said to be zero is not.

    See Also
    --------
    linear_view : In scaled positions.

    Examples
    --------
    >>> from percept_obs import StructureAndMotion, record
    >>> from percept_obs.structure import ScaledDepthCamera, seen_as
    >>> from percept_obs.structure.scenarios import chwa2019_experiment
    >>> scene = chwa2019_experiment("IV.A")
    >>> choice = StructureAndMotion(("v_p1", "v_p2", "v_p3"), scale=10.4)
    >>> other = seen_as(record(scene, 1, ScaledDepthCamera(0.5)), choice, scene.motion)
    >>> other.view.theta
    (v_p1, v_p2, v_p3)
    """
    if recording.names != NAMES:
        raise ValueError(f"another choice needs the outputs {', '.join(NAMES)}, not {', '.join(recording.names)}")
    truth = None
    if scale is not None:
        ybar = recording.outputs if recording.truth is None else recording.truth[:, : len(OUTPUTS)]
        truth = np.hstack([ybar, choice.theta_values(scale, motion, recording.time)])
    return replace(recording, view=choice, motion=choice.known_motion(motion), truth=truth)


@checked
def linear_view(recording: Recording) -> Recording:
    """Return the recording in scaled positions (y1, y2, 1) / ybar3, for the Kalman filter.

    It names no variance, for the noise is no longer the same in all outputs.

    Parameters
    ----------
    recording : Recording
        Of (y1, y2, ybar3).

    Raises
    ------
    ValueError
        If it is of something else.

    See Also
    --------
    seen_as : With other unknowns.

    Examples
    --------
    >>> from percept_obs import record
    >>> from percept_obs.structure import ScaledDepthCamera, linear_view
    >>> from percept_obs.structure.scenarios import chwa2019_experiment
    >>> recording = record(chwa2019_experiment("IV.A"), 1, ScaledDepthCamera(0.5))
    >>> linear_view(recording).outputs.round(2).tolist()
    [[6.4, 6.0, 20.0], [7.54, 7.2, 20.0], [8.69, 8.39, 20.0]]
    """
    choice = recording.view
    if not isinstance(choice, StructureAndMotion) or recording.names != NAMES:
        raise ValueError(f"the linear view needs the outputs {', '.join(NAMES)}, not {', '.join(recording.names)}")
    view, truth, signal = LinearView(choice), recording.truth, recording.signal
    return replace(
        recording,
        outputs=view.scaled(recording.outputs),
        names=tuple(symbol.name for symbol in view.image_coordinates),
        view=view,
        truth=None if truth is None else np.hstack([view.scaled(truth[:, :3]), truth[:, 3:]]),
        signal=None if signal is None else Chain(signal, view.scaled),
        noise_variance=None,
    )
