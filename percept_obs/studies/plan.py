"""Plan of an ensemble: the grid of what varies, the settings of all runs, and the statistics of any chunk of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from percept_obs.compile import Array, Indices, Language, vectorised
from percept_obs.compile.batch import BATCH, COLUMNS, Batch, BatchLoop, MovingPoint, Statistics, run_batch
from percept_obs.compile.integrator import instants, step_grid
from percept_obs.observers.base import Observer
from percept_obs.observers.inversion import elapsed, first_innovation
from percept_obs.observers.parts import first_seen, hats
from percept_obs.recording import Camera, Scenario
from percept_obs.recording.many import numbers_of, with_numbers
from percept_obs.recording.reckoning import transitions
from percept_obs.recording.simulation import LONGEST_STEP_SHARE
from percept_obs.system.motion import Motion, coefficients
from percept_obs.system.signal import from_the_start
from percept_obs.system.surfaces import POINT, BehindCamera
from percept_obs.tracking.verdict import stays
from percept_obs.validation import numbers, once

if TYPE_CHECKING:
    import xarray as xr

DONE, NOT_IN_FRONT = range(2)
STATUS = ("done", "not_in_front")
"""Status of a run by its number; no run is made of a point that does not stay in front of the camera."""

OUTCOMES = ("converged", "late", "outside", "behind", "none", "diverged")
"""Kinds of `Outcome`, in the order of their numbers."""

CONVERGED, LATE, OUTSIDE, BEHIND, NONE, DIVERGED = range(6)

STATISTICS = MappingProxyType(
    {
        "status": ("1", "what became of the run"),
        "outcome": ("1", "what became of the error"),
        "settling_time": ("s", "time from which on the error stays within the tolerance"),
        "judged": ("1", "what the tolerance bounds, at the end"),
        "final": ("1/m", "error of the inverse distance at the end"),
        "rms": ("1/m", "root mean square of this error after the transient"),
        "worst": ("1/m", "its largest value after the transient"),
        "resets": ("1", "number of resets"),
        "diverged_at": ("s", "time at which the estimate grew beyond all bounds"),
    }
)
"""Unit and meaning of each statistic of a run."""

CAMERA = {"noise": "1", "period": "s", "dropout": "1"}
"""Settings of a camera that can vary, with units; the noise is its bound or its standard deviation."""

MOST_AT_ONCE = 2_000_000
"""Largest number of values of samples and truths that are in memory at once, 16 MB."""

SAFETY_FACTOR = 4.0
"""Least ratio of a distance to its largest change between samples at which it surely stays positive between them."""

Columns = Mapping[str, Array]
"""Values of what varies, one for each of L runs, by name; always with "seed"."""

Numbers = tuple[tuple[str, float], ...]
"""Numbers of a scenario that vary, by their names."""


def grid_of(over: Mapping[str, Any], seeds: Array, units: Mapping[str, str]) -> xr.Dataset:
    """Coordinates over which an ensemble goes, the seed first; a DataArray brings its dimensions."""
    import xarray as xr

    columns: dict[str, Any] = {"seed": ("seed", seeds, {"units": "1"})}
    for name, given in over.items():
        along = tuple(getattr(given, "dims", (name,)))
        values = numbers(given.values if hasattr(given, "dims") else given, f"over {name}")
        if along == (name,) and values.size == max(values.shape, default=1):  # a number, or a column
            values = values.ravel()
        if values.ndim != len(along) or not values.size or not np.isfinite(values).all():
            raise ValueError(
                f"over goes {name!r} through values of shape {values.shape}; give finite numbers, a list of them or a "
                "DataArray with named dimensions"
            )
        if along == (name,) and len(np.unique(values)) < len(values):
            once(**{f"over {name}": values.tolist()})
        columns[name] = (along, values, {"units": units[name]})
    return xr.Dataset(coords=columns)


def camera_with(camera: Camera, values: Mapping[str, float]) -> Camera:
    """Return the camera with another noise, period or dropout."""
    changes: dict[str, Any] = {name: values[name] for name in ("period", "dropout") if name in values}
    if "noise" in values:
        changes["noise"] = type(camera.noise)(values["noise"])
    return replace(camera, **changes)


@dataclass(frozen=True, eq=False)
class Plan:
    """Settings of all runs of an ensemble, and the grid of what varies; see `ensemble`."""

    grid: xr.Dataset
    scenario: Scenario
    observer: Observer
    duration: float
    camera: Camera
    start: Mapping[str, float]
    believed: Motion
    step: float
    tolerance: float
    after: float
    language: Language

    @cached_property
    def shape(self) -> dict[str, int]:
        """Lengths of the dimensions in the order of the runs' numbers, the seed first."""
        return {name: self.grid.sizes[name] for each in self.grid.coords.values() for name in each.dims}

    @cached_property
    def scale(self) -> Array:
        """Factors that turn coordinates in metres into those in the scenario's unit of length, shape (n,)."""
        surface = self.scenario.surface
        return self.scenario.unit ** -np.array(surface.lengths[: len(surface.coordinates)], dtype=float)

    @cached_property
    def scenes(self) -> list[str]:
        """Names of what varies in the scenario."""
        return [name for name in numbers_of(self.scenario) if name in self.grid.coords]

    @cached_property
    def loop(self) -> BatchLoop:
        """The loop to compile; a point under a constant motion that varies is moved by the loop itself."""
        surface, varied = self.scenario.surface, set(self.grid.coords)
        image = [entry.subs({radius: surface.values[radius] for radius in surface.radii}) for entry in surface.image]
        moving = MovingPoint(POINT, surface.parameters, (*image, 1 / surface.distance), surface.distance)
        return BatchLoop(
            self.observer.equations,
            accumulated(self.observer, self.scale.tolist()),
            moving if self.scenes and self.scenario.motion.values else None,
            varying=not self.believed.values,
            noises_alike=self.grid.sizes["seed"] == 1 and not {"noise", "dropout"} & varied,
            truths_alike=not self.scenes,
        )

    def compute(self, chunk: slice) -> Array:
        """Statistics of a chunk of runs, shape (L, number of statistics)."""
        numbers = np.unravel_index(np.arange(chunk.start, chunk.stop), tuple(self.shape.values()))
        places = dict(zip(self.shape, numbers, strict=True))
        columns = {
            str(name): each.values[tuple(places[along] for along in each.dims)]
            for name, each in self.grid.coords.items()
        }
        found = np.empty((chunk.stop - chunk.start, len(STATISTICS)))
        periods = columns.get("period", np.full(len(found), self.camera.period))
        for period in np.unique(periods).tolist():
            same, camera = np.flatnonzero(periods == period), replace(self.camera, period=period)
            own = [name for name in ("seed", "noise", "dropout", *self.scenes) if name in columns]
            different = len(_distinct({name: columns[name][same] for name in own}, own)[0])
            each = len(camera.times(self.duration)) * len(self.observer.form.coordinates)
            at_once = max(BATCH, MOST_AT_ONCE * len(same) // (each * different))
            for begin in range(0, len(same), at_once):
                runs = same[begin : begin + at_once]
                found[runs] = self._batch({name: values[runs] for name, values in columns.items()}, camera)
        return found

    def _batch(self, columns: Columns, camera: Camera) -> Array:
        """Statistics of runs whose samples have the same times, shape (L, number of statistics)."""
        loop, time = self.loop, camera.times(self.duration)
        surface = self.scenario.surface
        runs, elapsed = len(columns["seed"]), time - time[0]
        if loop.moving:
            scene, truth = np.zeros(runs, dtype=int), np.zeros((1, 1, 1))
            moves, begins, turning = self._moves(columns, camera.period)
        else:
            scene, truth = self._truths(columns, time)
            moves, begins, turning = np.zeros((runs, 0)), truth[scene, 0], np.zeros(runs)
        noise, film = self._noise(columns, camera, len(time))
        grid, index = step_grid(time, self.step)
        arriving = np.full(len(grid), -1)
        arriving[index] = np.arange(len(time))
        known, motion = self._known(columns, grid)
        known = known / np.float_power(self.scenario.unit, [*self.believed.lengths, *(0 for _ in surface.parameters)])
        gains = self._gains(columns)
        places = list(loop.statistics.measured)
        start, corrects = self._start(columns, begins[:, places] + noise[film, 0], gains, known[motion, 0])
        batch = Batch(
            start,
            np.broadcast_to(corrects, (runs, len(corrects))),
            gains,
            moves,
            np.stack([film, scene, motion], axis=-1),
            noise,
            truth,
            known,
            np.diff(grid),
            arriving,
            elapsed,
            camera.reach,
        )
        late = int(np.argmax(from_the_start(elapsed, self.after)))
        sums = run_batch(loop, batch, self.tolerance, late, self.language)
        in_front = np.isfinite(begins[:, 0])
        if loop.moving:
            in_front = self._in_front(columns, sums, turning, time)
        found = statistics_of(sums, elapsed, grid - grid[0], late)
        rest = [np.where(in_front, values, np.nan) for values in found.values()]
        return np.stack([np.where(in_front, DONE, NOT_IN_FRONT), *rest], axis=-1)

    def _truths(self, columns: Columns, time: Array) -> tuple[Indices, Array]:
        """Index of each run's scene, and true coordinates of the scenes, shape (D, K, n); NaN if not in front."""
        (rows, scene), at = _distinct(columns, self.scenes), time.tobytes()
        found = [_coordinates(self.scenario, tuple(zip(self.scenes, row, strict=True)), at) for row in rows.tolist()]
        return scene, np.stack(found)

    def _moves(self, columns: Columns, period: float) -> tuple[Array, Array, Array]:
        """Return rows of each run's point, map to the next sample and surface; first coordinates; |A| by the period."""
        scenario, surface = self.scenario, self.scenario.surface
        values = {name: _column(columns, name, value) for name, value in numbers_of(scenario).items()}
        point = [values[symbol.name] for symbol in POINT]
        shape = [values[symbol.name] for symbol in surface.parameters]
        A, b = coefficients(scenario.motion, np.stack([values[s.name] for s in scenario.motion.parameters], axis=-1))
        A, b = (np.broadcast_to(each, (len(point[0]), *each.shape[1:])) for each in (A, b))
        across = transitions(A, b, period).reshape(len(A), -1)
        assert self.loop.moving
        with np.errstate(all="ignore"):
            begins = vectorised((*POINT, *surface.parameters), self.loop.moving.coordinates)(*point, *shape)
        turning = period * np.abs(A).sum(axis=-1).max(axis=-1)
        return np.column_stack([*point, across, *shape]), np.stack(begins, axis=-1), turning

    def _in_front(self, columns: Columns, sums: Array, turning: Array, time: Array) -> Array:
        """True where a point stays in front of the camera; simulated where it may dip behind between samples."""
        nearest, drop = (sums[:, COLUMNS.index(name)] for name in ("nearest", "drop"))
        in_front = nearest > 0
        for k in np.flatnonzero(in_front & ~((nearest > SAFETY_FACTOR * drop) & (turning <= LONGEST_STEP_SHARE))):
            scene = tuple((name, float(columns[name][k])) for name in self.scenes)
            in_front[k] = np.isfinite(_coordinates(self.scenario, scene, time.tobytes())).all()
        return np.asarray(in_front)

    def _gains(self, columns: Columns) -> Array:
        """Numbers of the gains, shape (L, q); a filter that was not told the noise knows that of each run."""
        varied = ["noise"] if "noise" in columns else []
        rows, which = _distinct(columns, varied)
        cameras = [camera_with(self.camera, dict(zip(varied, row, strict=True))) for row in rows.tolist()]
        suited = [self.observer.suited_to(camera.noise.variance) for camera in cameras]
        found = np.array([[gain.value for gain in each.gains] for each in suited])[which]
        for k, gain in enumerate(self.observer.gains):
            found[:, k] = columns.get(gain.name, found[:, k])
        return found

    def _noise(self, columns: Columns, camera: Camera, samples: int) -> tuple[Array, Indices]:
        """Noise of measured outputs, NaN where a sample is lost, shape (R, K, m), and the index of each run's."""
        varied = [name for name in ("noise", "dropout") if name in columns]
        rows, film = _distinct(columns, ["seed", *varied])
        outputs = len(self.scenario.view.image_coordinates)
        noise = np.empty((len(rows), samples, len(self.observer.form.measured)))
        kinds, of_kind = np.unique(rows[:, 1:], axis=0, return_inverse=True)
        for k, values in enumerate(kinds.tolist()):
            alike = of_kind.reshape(-1) == k
            taken = camera_with(camera, dict(zip(varied, values, strict=True)))
            drawn = taken.drawn(rows[alike, 0].astype(int).tolist(), (samples, outputs))
            noise[alike] = drawn[..., list(self.loop.statistics.measured)]
        return noise, film

    def _known(self, columns: Columns, grid: Array) -> tuple[Array, Indices]:
        """Parameters that the observer believes in, shape (B, T, p), and the index of each run's."""
        runs, believed, surface = len(columns["seed"]), self.believed, self.scenario.surface
        if not believed.values:
            rows = believed.known(instants(grid))
            shape = [np.full(len(rows), surface.values[symbol]) for symbol in surface.parameters]
            return np.column_stack([rows, *shape])[None], np.zeros(runs, dtype=int)
        own = believed is self.scenario.motion  # which is believed in where it varies, too

        def column(name: str, value: float) -> Array:
            true = _column(columns, name, value) if own else np.full(runs, value)
            return columns.get(f"believed_{name}", true)

        motion = [column(symbol.name, value) for symbol, value in believed.values.items()]
        shape = [_column(columns, symbol.name, surface.values[symbol]) for symbol in surface.parameters]
        return np.stack([*motion, *shape], axis=-1)[:, None], np.arange(runs)

    def _start(self, columns: Columns, first: Array, gains: Array, known: Array) -> tuple[Array, Array]:
        """States at the first sample, and flags of the measured outputs that it corrects: those with a given start."""
        observer, form = self.observer, self.observer.form
        given = {name for name in map(str, form.coordinates) if f"start_{name}" in columns or name in self.start}
        estimates = [
            first[:, form.measured.index(name)]
            if name in form.measured and name not in given
            else _column(columns, f"start_{name}", self.start.get(name, 0.0)) * factor
            for name, factor in zip(map(str, form.coordinates), self.scale.tolist(), strict=True)
        ]
        symbols = (
            *form.x1,
            *(gain.symbol for gain in observer.gains),
            *form.parameters,
            *hats(form.coordinates),
            *first_seen(form.x1),
        )
        seen = [float(name not in given) for name in form.measured]
        start = vectorised(symbols, observer.start)(*first.T, *gains.T, *known.T, *estimates, *seen)
        return np.stack(start, axis=-1), np.array([name in given for name in form.measured])


@lru_cache(maxsize=256)
def _coordinates(scenario: Scenario, numbers: Numbers, times: bytes) -> Array:
    """True coordinates of a variant of a scenario, NaN if its point does not stay in front of the camera."""
    at = np.frombuffer(times)
    try:
        return with_numbers(scenario, **dict(numbers)).coordinates(at)
    except BehindCamera:
        return np.full((len(at), len(scenario.view.coordinates)), np.nan)


def _distinct(columns: Columns, names: Sequence[str]) -> tuple[Array, Indices]:
    """Distinct rows of some columns, shape (D, number of names), and the index of each run's."""
    if not names:
        return np.empty((1, 0)), np.zeros(len(columns["seed"]), dtype=int)
    rows, which = np.unique(np.stack([columns[name] for name in names], axis=-1), axis=0, return_inverse=True)
    return rows, which.reshape(-1)


def _column(columns: Columns, name: str, value: float) -> Array:
    """Values of every run, those that vary or those that are the same."""
    return columns[name] if name in columns else np.full(len(columns["seed"]), value)


def accumulated(observer: Observer, scale: Sequence[float]) -> Statistics:
    """Expressions to accumulate during a run, such as the relative error of the distance.

    The scale has the factors of the coordinates by the unit of length in which the observer runs, see `Recording`.
    """
    form, units = observer.form, [sp.S.One if factor == 1 else sp.Float(factor) for factor in scale]
    estimate = {x: e / unit for x, e, unit in zip(form.coordinates, observer.estimate, units, strict=True)}
    truth = {symbol: sp.Symbol(f"true_{symbol.name}", real=True) for symbol in form.coordinates}
    inverse = form.coordinates[-1]
    return Statistics(
        truth=tuple(truth.values()),
        elapsed=elapsed,
        begun=tuple(first_innovation(form)) if observer.unobservable else (),
        first=tuple(x - estimate[x] for x in form.x1) if observer.unobservable else (),
        hidden=sp.Or(*(where.condition for where in observer.unobservable)),
        judged=(sp.Abs(truth[inverse] / estimate[inverse] - 1),),
        behind=sp.Le(estimate[inverse], 0),
        error=sp.Abs(truth[inverse] - estimate[inverse]),
        measured=tuple(form.coordinates.index(x) for x in form.x1),
    )


def statistics_of(sums: Array, elapsed: Array, grid: Array, late: int) -> dict[str, Array]:
    """Statistics of L runs but their status, in the order of `STATISTICS`, from sums of `run_batch`.

    Seconds elapsed are those from the first sample to each and, of the grid, to the ends of the steps; `late` is the
    first sample whose error counts.
    """
    column = dict(zip(COLUMNS, sums.T, strict=True))
    last, judged, squares = len(elapsed) - 1, column["judged"], column["squares"]
    outside, diverged = column["outside"].astype(int), column["diverged"].astype(int)
    settled = np.where(outside < last, elapsed[np.minimum(outside + 1, last)], np.inf)
    outcome = np.select(
        [diverged > 0, stays(settled, elapsed[-1]), outside < last],
        [DIVERGED, CONVERGED, LATE],
        np.select([np.isnan(judged), np.isinf(judged)], [NONE, BEHIND], OUTSIDE),
    )

    def known(values: Array) -> Array:
        """Errors, infinite where a run that diverged has none."""
        return np.where(np.isfinite(values), values, np.inf)

    return {
        "outcome": outcome.astype(float),
        "settling_time": np.where(outcome == CONVERGED, settled, np.inf),
        "judged": judged,
        "final": known(column["final"]),
        "rms": known(np.sqrt(squares / (last + 1 - late))),
        "worst": np.where(np.isfinite(squares), column["worst"], np.inf),
        "resets": column["resets"],
        "diverged_at": np.where(diverged > 0, grid[diverged], np.inf),
    }
