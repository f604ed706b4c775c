"""Simulation: a scene in motion, and the recording that a camera makes of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile import Array, Flags, Table, solve
from percept_obs.compile.equations import Equations
from percept_obs.compile.integrator import EACH, PLANT_STEP, instants, step_grid
from percept_obs.recording.camera import Camera, Scene, Seed, seeded
from percept_obs.recording.recording import Recording
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import POINT, BehindCamera, ImagingSurface
from percept_obs.system.view import View


@dataclass(frozen=True, eq=False)
class Scenario(Scene):
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
        object.__setattr__(self, "position", self._check("position", self.position, ("X", "Y", "Z")))
        self.surface.project(self.position)

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
        points = self._path(times)
        bounded = np.isfinite(points).all(axis=1)
        if not bounded.all():
            when = np.asarray(times)[np.argmin(bounded)]
            raise BehindCamera(f"the point leaves every bound at {when:.4g} s; shorten the duration")
        return points

    def in_front(self, times: ArrayLike) -> Flags:
        """At which times, as `points` takes them, the point is in front of the camera, shape (K,)."""
        return self.surface.distances(self._path(times)) > 0

    def _path(self, times: ArrayLike) -> Array:
        """Positions of the point, NaN from where it left every bound on."""
        grid, last = step_grid(np.concatenate([[0.0], np.asarray(times, dtype=float)]), PLANT_STEP)
        steps, known = np.diff(grid), self.motion.known(instants(grid))
        table = Table(steps, np.zeros((len(steps), EACH + 1, 0)), known, np.zeros((len(grid), 0)))
        equations = point_in_motion(self.motion.A, self.motion.b, self.motion.parameters)
        return solve(equations, self.position, table).states[last[1:]]

    @property
    def view(self) -> View:
        """The surface."""
        return self.surface

    @property
    def known_motion(self) -> Motion:
        """The whole motion."""
        return self.motion

    def coordinates(self, times: ArrayLike) -> Array:
        """Image coordinates and inverse distance of the point, shape (K, n).

        Raises
        ------
        BehindCamera
            If the point is not in front of the camera at one of the times.
        """
        points = self.points(times)
        try:
            return self.surface.project(points)
        except BehindCamera as error:
            when = np.asarray(times)[np.argmin(self.surface.distances(points) > 0)]
            raise BehindCamera(f"in the scenario {self.name!r}, at {when:.4g} s, {error}") from None


def record(scenario: Scene, duration: float | None = None, camera: Camera | None = None, seed: Seed = 0) -> Recording:
    """Simulate what a camera records of a scenario.

    Parameters
    ----------
    scenario : Scenario, PointsScenario or StructureScenario
    duration : float, optional
        Seconds; the scenario's own when left out.
    camera : Camera, optional
        The scenario's own when left out, which has no noise.
    seed : int or numpy Generator
        Of the noise and the lost samples, drawn in this order.

    Raises
    ------
    BehindCamera
        If a single point does not stay in front of the camera; several ones are not seen where they are behind it.
    ValueError
        If the duration is not positive or shorter than one period, or the motion grows without bounds.

    Examples
    --------
    >>> from percept_obs import Camera, Uniform, record, scenarios
    >>> recording = record(scenarios.ma2005_eq35(), 20, Camera(0.01, Uniform(0.01)), seed=1)
    >>> recording.outputs.shape
    (2001, 2)
    """
    camera = camera or scenario.camera
    duration = scenario.duration if duration is None else float(duration)
    time, view = camera.times(duration), scenario.view
    truth = scenario.coordinates(time)
    outputs, variance = camera.samples(scenario, time, truth, seeded(seed))
    named = "of a given generator" if isinstance(seed, np.random.Generator) else seed
    return Recording(
        time,
        outputs,
        tuple(s.name for s in view.image_coordinates),
        view,
        scenario.known_motion,
        truth,
        _signal(scenario),
        variance,
        source=f"{scenario.name}, {duration:g} s, {camera}, seed {named}",
    )


def _signal(scene: Scene) -> Callable[[Array], Array]:
    """The outputs at any times; the latest ones are kept, for observers ask for the same times again."""

    @lru_cache(maxsize=2)
    def outputs(times: bytes) -> Array:
        found = scene.view.outputs(scene.coordinates(np.frombuffer(times)))
        found.setflags(write=False)
        return found

    return lambda times: outputs(np.asarray(times, dtype=float).tobytes())


@lru_cache(maxsize=64)
def point_in_motion(A: sp.ImmutableMatrix, b: sp.ImmutableMatrix, parameters: tuple[sp.Symbol, ...]) -> Equations:
    """The motion of a single point as equations without outputs."""
    return Equations(POINT, tuple(A * sp.ImmutableMatrix(POINT) + b), (), parameters)
