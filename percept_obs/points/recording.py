"""Recordings of many points at once, some of which are out of sight for a while."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from percept_obs.points.form import PointsForm
from percept_obs.points.kernel import advance, arrays, choose
from percept_obs.recording import PLANT_STEP, Camera, Seed, halves, seeded, step_grid

Array = NDArray[np.float64]


class LeavesEveryBound(ValueError):
    """The state grows without end, so that nothing can be recorded of it."""


@dataclass(frozen=True, eq=False)
class PointsScenario:
    """A state in motion whose points a camera may see.

    Parameters
    ----------
    name : str
    form : PointsForm
        With numbers for its motion.
    state : sequence of n numbers
        The state at time 0.
    duration : float
        In seconds.
    source : str
        Where the set-up comes from.

    Raises
    ------
    ValueError
        If the state has another size or is not finite, or the duration is not positive.
    """

    name: str
    form: PointsForm
    state: Sequence[float]
    duration: float
    source: str = ""

    def __post_init__(self) -> None:
        state = np.asarray(self.state, dtype=float)
        if state.shape != (self.form.states,) or not np.isfinite(state).all():
            raise ValueError(
                f"the state of {self.name!r} has shape {state.shape}; expected {self.form.states} finite numbers: "
                f"{', '.join(self.form.names)}"
            )
        object.__setattr__(self, "state", tuple(state.tolist()))
        if not (np.isfinite(self.duration) and self.duration > 0):
            raise ValueError(f"the duration is {self.duration} s; it must be positive")

    def states(self, times: ArrayLike) -> Array:
        """States at times from 0 on that do not decrease, shape (K, n), integrated with steps of `PLANT_STEP` at most.

        Raises
        ------
        LeavesEveryBound
            If the state grows beyond all bounds before.
        """
        times = np.asarray(times, dtype=float)
        form = self.form
        grid, index = step_grid(np.concatenate([[0.0], times]), PLANT_STEP)
        count = len(grid) - 1
        unseen = np.full((count, 3, form.points, form.outputs), np.nan)
        path, _, diverged = advance(
            arrays(form, np.arange(form.states), np.arange(form.points)),
            (False, 0.0, 0.0, np.zeros((1, 1))),
            np.array(self.state),
            np.zeros((1, 1)),
            np.diff(grid),
            form.values(halves(grid)),
            np.eye(form.states)[None],
            unseen,
            choose(None, count * form.states),
        )
        if diverged is not None:
            raise LeavesEveryBound(
                f"the state of {self.name!r} leaves every bound at {grid[diverged]:.4g} s; shorten the duration"
            )
        return path[index[1:]]


@dataclass(frozen=True)
class Sighting:
    """A point in sight, from one sample to another.

    Parameters
    ----------
    point : int
    first, last : int
        Samples.
    """

    point: int
    first: int
    last: int


@dataclass(frozen=True, eq=False)
class PointsRecording:
    """Images of p points over time, and what is known of their motion.

    Parameters
    ----------
    time : array of shape (K,)
        Seconds, strictly increasing.
    outputs : array of shape (K, p, m)
        Image coordinates; NaN while a point is not seen.
    form : PointsForm
        The points and their known motion.
    truth : array of shape (K, n), optional
        True states; NaN where they are not known.
    signal : function of times, optional
        The outputs without noise at any time, shape (T, p, m), if they are known.
    noise_variance : float, optional
        Variance of the noise in each output.
    distances : mapping of names to arrays of shape (K, p), optional
        Independent measurements of the depths in metres; NaN where there is none.
    source : str
        Where the recording comes from, its settings and its seed.

    Raises
    ------
    ValueError
        If shapes do not fit, times do not increase, or values are infinite.
    """

    time: Array
    outputs: Array
    form: PointsForm
    truth: Array | None = None
    signal: Callable[[Array], Array] | None = None
    noise_variance: float | None = None
    distances: Mapping[str, Array] = field(default_factory=dict)
    source: str = ""

    def __post_init__(self) -> None:
        time, outputs = (_readonly(part) for part in (self.time, self.outputs))
        object.__setattr__(self, "time", time)
        if time.ndim != 1 or len(time) < 2 or not np.isfinite(time).all() or not (np.diff(time) > 0).all():
            raise ValueError(
                f"the recording has times of shape {time.shape}; it needs at least two, finite and strictly increasing"
            )
        expected = (len(time), self.form.points, self.form.outputs)
        if outputs.shape != expected:
            raise ValueError(f"the recording has outputs of shape {outputs.shape}; expected {expected}")
        if np.isinf(outputs).any():
            raise ValueError("outputs are finite, or NaN while a point is not seen")
        # a point that lost one of its coordinates is not seen
        lost = np.isnan(outputs).any(axis=-1, keepdims=True)
        if np.any(lost):
            outputs = np.where(lost, np.nan, outputs)
            outputs.setflags(write=False)
        object.__setattr__(self, "outputs", outputs)
        if self.truth is not None:
            truth = _readonly(self.truth)
            object.__setattr__(self, "truth", truth)
            if truth.shape != (len(time), self.form.states) or np.isinf(truth).any():
                raise ValueError(f"the truth has shape {truth.shape}; expected {(len(time), self.form.states)}, finite")
        distances = {name: _readonly(values) for name, values in self.distances.items()}
        object.__setattr__(self, "distances", MappingProxyType(distances))
        for name, values in distances.items():
            if values.shape != expected[:2] or not (np.isnan(values) | ((values > 0) & (values < np.inf))).all():
                raise ValueError(f"the distances {name!r} must be positive or NaN, of shape {expected[:2]}")
        self.form.motion.known(time[[0, -1]])

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Which points are seen at which sample, shape (K, p)."""
        return np.asarray(np.isfinite(self.outputs).all(axis=-1))

    @cached_property
    def depths(self) -> Array:
        """True depths in metres, shape (K, p); NaN where the truth is not known.

        Raises
        ------
        ValueError
            If the recording has no truth.
        """
        if self.truth is None:
            raise ValueError("the recording has no truth to compare with")
        return self.form.distances(self.truth)

    def sightings(self, absence: float) -> tuple[Sighting, ...]:
        """When points are in sight, in the order of their beginnings.

        Parameters
        ----------
        absence : float
            Seconds without a sample after which it is another sighting.
        """
        found = []
        for point, seen in enumerate(self.seen.T):
            samples = np.flatnonzero(seen)
            if len(samples):
                runs = np.split(samples, np.flatnonzero(np.diff(self.time[samples]) > absence) + 1)
                found += [Sighting(point, int(run[0]), int(run[-1])) for run in runs]
        return tuple(sorted(found, key=lambda sighting: (sighting.first, sighting.point)))

    def hidden(self, point: int, begin: float, end: float) -> PointsRecording:
        """The same without the images of a point with begin <= time < end.

        Parameters
        ----------
        point : int
            From 0 on.
        begin, end : float
            Seconds.

        Raises
        ------
        ValueError
            If there is no such point.
        """
        if not 0 <= point < self.form.points:
            raise ValueError(f"there is no point {point}; there are 0 to {self.form.points - 1}")
        outputs = self.outputs.copy()
        outputs[(self.time >= begin) & (self.time < end), point] = np.nan
        return replace(self, outputs=outputs)


def record_points(
    scenario: PointsScenario,
    duration: float | None = None,
    camera: Camera | None = None,
    seed: Seed = 0,
    view: float = np.inf,
) -> PointsRecording:
    """Simulate what a camera records of many points.

    Parameters
    ----------
    scenario : PointsScenario
    duration : float, optional
        Seconds; the scenario's own when left out.
    camera : Camera, optional
        One sample every 10 ms without noise when left out.  Its dropout loses points independently.
    seed : int or numpy Generator
        Of the noise and the lost samples, drawn in this order.
    view : float
        Largest absolute image coordinate that the camera sees.

    Returns
    -------
    PointsRecording
        Points behind the camera or outside of its view are NaN.

    Raises
    ------
    LeavesEveryBound
        If the state grows beyond all bounds.
    ValueError
        If the duration is not positive or shorter than one period, or the view is not positive.
    """
    camera = camera or Camera()
    duration = scenario.duration if duration is None else float(duration)
    count = int(np.floor(duration / camera.period + 1e-9)) if np.isfinite(duration) else 0
    if count < 1:
        raise ValueError(f"a duration of {duration} s holds no two samples {camera.period} s apart; record longer")
    if not view > 0:
        raise ValueError(f"the view is {view}; the largest image coordinate that is seen must be positive")
    time: Array = camera.period * np.arange(count + 1, dtype=float)
    form = scenario.form
    truth = scenario.states(time)
    images = form.images(truth)
    generator = seeded(seed)
    outputs = images + camera.noise.draw(generator, images.shape)
    outputs[generator.random(images.shape[:2]) < camera.dropout] = np.nan
    outputs[np.abs(images).max(axis=-1) > view] = np.nan
    named = "of a given generator" if isinstance(seed, np.random.Generator) else seed
    return PointsRecording(
        time,
        outputs,
        form,
        truth,
        _images(scenario),
        camera.noise.variance,
        source=f"{scenario.name}, {duration:g} s, {camera}, seed {named}",
    )


def _images(scenario: PointsScenario) -> Callable[[Array], Array]:
    """The images at any times; the latest ones are kept, for observers ask for the same times again."""

    @lru_cache(maxsize=2)
    def images(times: bytes) -> Array:
        return _readonly(scenario.form.images(scenario.states(np.frombuffer(times))))

    return lambda times: images(np.asarray(times, dtype=float).tobytes())


def _readonly(values: Any) -> Array:
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array
