"""Simulation of a scene in motion, and of its recording by a camera."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Annotated

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile import Array, Flags, right_hand_side, vectorised
from percept_obs.compile.equations import Equations
from percept_obs.compile.integrator import step_grid
from percept_obs.recording.camera import Camera, Scene, Seed, seeded
from percept_obs.recording.path import constant_path, lowest_between, times_of, varying_path
from percept_obs.recording.recording import Recording
from percept_obs.system.motion import Motion, ask_for_degrees, coefficients
from percept_obs.system.surfaces import POINT, BehindCamera, ImagingSurface
from percept_obs.system.view import View
from percept_obs.validation import NAMED, Times, checked, travels

LONGEST_STEP_SHARE = 0.25
"""Longest interval between two checks of the distance, as a share of the motion's shortest time constant."""


@checked
@dataclass(frozen=True, eq=False)
class Scenario(Scene):
    """A point in motion and the surface on which it is seen.

    Parameters
    ----------
    name : str
        Name in messages.
    motion : Motion
        With numbers.
    position : array of shape (3,)
        The point at time 0, in metres.
    duration : float
        In seconds.
    surface : ImagingSurface
        On which it is seen.
    source : str
        Where the set-up comes from.
    unit : float
        Unit of length of its recordings, see `Recording`.

    Raises
    ------
    BehindCamera
        If the point does not start in front of the camera.
    ValueError
        If the position or the duration is not finite, the duration not positive, or the motion not of a point or
        without numbers.

    See Also
    --------
    record : Simulates a recording of it.
    percept_obs.recording.scenarios.ma2005_eq35 : A ready one.

    Examples
    --------
    >>> from percept_obs import Scenario, affine, pinhole
    >>> turning = affine([[0, -1, 0], [1, 0, 0], [0, 0, 0]], [0, 0, 0])
    >>> scenario = Scenario("a turn", turning, (1.0, 0.0, 2.0), 3.0, pinhole())
    >>> scenario.points([0.0, 1.0]).round(3).tolist()
    [[1.0, 0.0, 2.0], [0.54, 0.841, 2.0]]
    """

    name: str
    motion: Motion
    position: Annotated[Sequence[float], NAMED]
    duration: float
    surface: ImagingSurface
    source: str = ""
    unit: float = 1.0

    def __post_init__(self) -> None:
        vars(self)["position"] = self._check("position", self.position, ("X", "Y", "Z"))
        if self.motion.b.rows != len(POINT):
            raise ValueError(f"the {self.motion.name} motion is of {self.motion.b.rows} entries; a point has X, Y, Z")
        self.motion.refuse_unit(self.unit)
        self.surface.project(self.position)

    def points(self, times: Times) -> Array:
        """Return positions of the point in metres, shape (K, 3).

        They are exact if the motion is constant, else to a relative error of 1e-10 a step.

        Parameters
        ----------
        times : array of shape (K,)
            Seconds, from 0 on, not decreasing.

        Raises
        ------
        BehindCamera
            If the point goes to infinity before.
        TooMuchWork
            If there are too many times, or the motion is too fast.
        """
        points = self._path(times)
        bounded = np.isfinite(points).all(axis=1)
        if not bounded.all():
            when = np.asarray(times)[np.argmin(bounded)]
            raise BehindCamera(f"the point leaves every bound at {when:.4g} s; shorten the duration")
        return points

    def in_front(self, times: Times) -> Flags:
        """Return True for times, as in `points`, at which the point is in front of the camera, shape (K,)."""
        return self.surface.sees(self._path(times))

    def _path(self, times: Times) -> Array:
        """Positions of the point, shape (K, 3); NaN once it has gone to infinity."""
        times, start, motion = times_of(times, len(POINT)), np.array(self.position), self.motion
        motion.known(times[:1])
        if motion.signal is None or motion.signal.constant:
            A, b = coefficients(motion, motion.known(times[:1]))
            return constant_path(A[0], b[0], start, times)
        flow = _flow(point_in_motion(motion.A, motion.b, motion.parameters))

        def rate(time: float, state: Array) -> ArrayLike:
            try:
                return flow(state, (), motion.known(float(time))[0])
            except (ArithmeticError, ValueError) as error:
                raise ValueError(f"the motion of {self.name!r} has no value at {time:.6g} s: {error}") from None

        return varying_path(rate, start, times, motion.signal.breaks(times[-1]))

    @property
    def view(self) -> View:
        """Imaging surface on which the point is seen."""
        return self.surface

    @property
    def known_motion(self) -> Motion:
        """Motion, known completely."""
        return self.motion

    def coordinates(self, times: Times) -> Array:
        """Return image coordinates and inverse distance of the point, which must stay in front, shape (K, n)."""
        times = times_of(times, len(POINT))
        points = self.points(times)
        try:
            seen = self.surface.project(points)
        except BehindCamera as error:
            when = times[np.argmin(self.surface.sees(points))]
            raise BehindCamera(f"in the scenario {self.name!r}, at {when:.4g} s, {error}") from None
        self._refuse_a_dip(times, points)
        return seen

    def _refuse_a_dip(self, times: Array, points: Array) -> None:
        """Refuse a motion that takes the point behind the camera and back between two samples."""
        A, b = coefficients(self.motion, self.motion.known(times))
        fastest = float(np.abs(A).sum(axis=-1).max(initial=0))
        # a cubic between samples is true only if these are close against the motion's time constant
        grid, _ = step_grid(times, LONGEST_STEP_SHARE / max(fastest, 1e-9))
        if len(grid) > len(times):
            times, points = grid, self.points(grid)
            A, b = coefficients(self.motion, self.motion.known(times))
        velocities = (A @ points[:, :, None])[..., 0] + b
        surface = self.surface
        for bound in surface.bounds:
            height, *gradient = vectorised(POINT, (bound, *map(bound.diff, POINT)), surface.values)(*points.T)
            lowest, time = lowest_between(height, np.einsum("ik,ki->k", gradient, velocities), times)
            if lowest <= 0:
                raise BehindCamera(
                    f"in the scenario {self.name!r} the point dips behind the {surface.name} between two samples, at "
                    f"about {time:.4g} s; stop before, or change the motion"
                )


@checked
def record(scenario: Scene, duration: float | None = None, camera: Camera | None = None, seed: Seed = 0) -> Recording:
    """Return the simulated recording of a scenario by a camera.

    Parameters
    ----------
    scenario : Scenario, PointsScenario, StateScenario or StructureScenario
        What moves, and how it is seen.
    duration : float, optional
        Seconds; the scenario's own when left out.
    camera : Camera, optional
        The scenario's own when left out, which has no noise.
    seed : int, numpy Generator or None
        Of the noise and the lost samples, drawn in this order.  With None a seed is drawn, which the source names.

    Returns
    -------
    Recording
        With its truth, and the outputs without noise as its signal.

    Raises
    ------
    BehindCamera
        If a single point does not stay in front of the camera; several ones are not seen where they are behind it.
    ValueError
        If the duration is not positive or shorter than one period, or the motion grows without bounds.

    See Also
    --------
    Camera : Sampling, noise and lost samples.
    Recording.from_csv : A recording of one's own.

    Examples
    --------
    >>> from percept_obs import Camera, Uniform, record, scenarios
    >>> recording = record(scenarios.ma2005_eq35(), 20, Camera(0.01, Uniform(0.01)), seed=1)
    >>> recording.outputs.shape
    (2001, 2)
    """
    camera = camera or scenario.camera
    duration = scenario.duration if duration is None else float(duration)
    view = scenario.view
    time = camera.times(duration, len(view.coordinates) + len(view.image_coordinates) * math.prod(view.point_shape))
    known = scenario.known_motion
    if known.signal is not None and callable(known.signal.samples):
        ask_for_degrees(known, time)
    truth = scenario.coordinates(time)
    outputs, variance = camera.samples(scenario, time, truth, seeded(seed))
    name = "of a given generator" if isinstance(seed, np.random.Generator) else seed
    return Recording(
        time,
        outputs,
        tuple(s.name for s in view.image_coordinates),
        view,
        scenario.known_motion,
        truth,
        _Outputs(scenario),
        variance,
        source=f"{scenario.name}, {duration:g} s, {camera}, seed {name}",
        unit=scenario.unit,
    )


@travels
@dataclass(frozen=True, eq=False)
class _Outputs:
    """A scene's outputs as a function of times; two results are kept, for observers ask for the same times again."""

    scene: Scene

    def __call__(self, times: Array) -> Array:
        return self._kept(np.asarray(times, dtype=float).tobytes())

    @cached_property
    def _kept(self) -> Callable[[bytes], Array]:
        return lru_cache(maxsize=2)(self._found)

    def _found(self, times: bytes) -> Array:
        found = self.scene.view.outputs(self.scene.coordinates(np.frombuffer(times)))
        found.setflags(write=False)
        return found


@lru_cache(maxsize=64)
def point_in_motion(A: sp.ImmutableMatrix, b: sp.ImmutableMatrix, parameters: tuple[sp.Symbol, ...]) -> Equations:
    """Return the motion of a single point as equations without outputs."""
    return Equations(POINT, tuple(A * sp.ImmutableMatrix(POINT) + b), (), parameters)


@lru_cache(maxsize=64)
def _flow(equations: Equations) -> Callable[..., list[float]]:
    return right_hand_side(equations, {})
