"""A part of an ensemble: some of its runs, computed by themselves, on this machine or on another one."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from percept_obs.compile import Array, Indices, Language, vectorised
from percept_obs.compile.batch import Batch, compiled, run_batch
from percept_obs.compile.batch_loop import BATCH, COLUMNS, BatchLoop
from percept_obs.compile.integrator import by_step, instants, step_grid
from percept_obs.observers.base import Observer
from percept_obs.observers.parts import first_seen, hats
from percept_obs.recording import Camera, Scenario
from percept_obs.recording.many import numbers_of, transitions, with_numbers
from percept_obs.recording.simulation import LONGEST_STEP_SHARE, coefficients
from percept_obs.studies.counting import STATISTICS, moving, told, watched
from percept_obs.studies.least_error import Values, least_error
from percept_obs.studies.varying import camera_with
from percept_obs.system.motion import Motion
from percept_obs.system.signal import from_the_start
from percept_obs.system.surfaces import POINT, BehindCamera
from percept_obs.tracking.grid import Hold
from percept_obs.tracking.verdict import SETTLED_PART

NOT_RUN, DONE, NOT_IN_FRONT = range(3)
STATUS = ("not_run", "done", "not_in_front")
"""What became of a run, in the order of its numbers; a point that does not stay in front of the camera is not seen."""

MOST_AT_ONCE = 2_000_000
"""Numbers of samples and truths that are kept at once, 16 MB."""

NEEDING = ("bound", "nees", "nis")
"""Statistics that not every ensemble has."""

DIP = 4.0
"""Largest changes of a distance between samples by which it must stay away from 0 to be sure not to dip below."""


@dataclass(frozen=True, eq=False)
class Plan:
    """What all runs of an ensemble have in common; see `ensemble`."""

    scenario: Scenario
    observer: Observer
    duration: float
    camera: Camera
    start: Mapping[str, float]
    hold: Hold
    believed: Motion
    step: float
    tolerance: float
    after: float
    coordinates: tuple[str, ...]
    prior: Values | None
    language: Language
    noises_alike: bool
    settled_part: float = SETTLED_PART

    @cached_property
    def means(self) -> tuple[str, ...]:
        """Names of the means that the observer's claims allow."""
        return ("nees", "nis")[: len(watched(self.observer).means)]

    @cached_property
    def statistics(self) -> tuple[str, ...]:
        """Names of what is known of every run, its status first."""
        bound = () if self.prior is None else ("bound",)
        return ("status", *(name for name in STATISTICS if name not in NEEDING or name in (*bound, *self.means)))

    def prepare(self, varied: Collection[str]) -> None:
        """Compile the loop here and now, where numba may set warning filters, rather than in a thread."""
        compiled(self._loop(varied), self.language)

    def _loop(self, varied: Collection[str]) -> BatchLoop:
        """The loop for runs in which these quantities vary."""
        alone = self._alone(varied)
        return BatchLoop(
            self.observer.equations,
            watched(self.observer, self.coordinates),
            moving(self.scenario.surface) if alone else None,
            self.hold != "zero",
            not self.believed.values,
            self.noises_alike,
            not alone and self._truths_alike(varied),
        )

    def compute(self, columns: Mapping[str, Array]) -> Array:
        """Run some runs.

        Parameters
        ----------
        columns : mapping of names to arrays of shape (L,)
            What varies, and the seeds.

        Returns
        -------
        array of shape (L, number of `statistics`)
        """
        runs = len(columns["seed"])
        found = np.full((runs, len(self.statistics)), np.nan)
        periods = columns.get("period", np.full(runs, self.camera.period))
        for period in np.unique(periods):
            same = np.flatnonzero(periods == period)
            camera = camera_with(self.camera, {"period": float(period)})
            own = [name for name in ("seed", "noise", "dropout", *self._scenes) if name in columns]
            different = len(_distinct({name: columns[name][same] for name in {*own, "seed"}}, own)[0])
            each = len(camera.times(self.duration)) * len(self.observer.form.coordinates)
            at_once = max(BATCH, MOST_AT_ONCE * len(same) // (each * different))
            for begin in range(0, len(same), at_once):
                part = same[begin : begin + at_once]
                found[part] = self._piece({name: values[part] for name, values in columns.items()}, camera)
        return found

    @property
    def _scenes(self) -> list[str]:
        """What can vary in the scenario."""
        return list(numbers_of(self.scenario))

    def _alone(self, varied: Collection[str]) -> bool:
        """Whether every point moves on its own, under a constant motion of its own."""
        return bool(self.scenario.motion.values) and not set(varied).isdisjoint(self._scenes)

    def _truths_alike(self, varied: Collection[str]) -> bool:
        """Whether all runs see the same scene."""
        return set(varied).isdisjoint(self._scenes)

    def _piece(self, columns: Mapping[str, Array], camera: Camera) -> Array:
        """The same for runs on one clock."""
        observer, time = self.observer, camera.times(self.duration)
        scenes = [name for name in self._scenes if name in columns]
        alone = self._alone(columns)
        rows, scene = _distinct(columns, [] if alone else scenes)
        truth = np.zeros((1, 1, 1)) if alone else self._truths(tuple(scenes), rows, time)
        moves, begins, turning = np.zeros((len(scene), 0)), truth[scene % len(truth), 0], np.zeros(len(scene))
        if alone:
            moves, begins, turning = self._moves(columns, camera.period)
        noise, film = self._noise(columns, camera, len(time))
        grid, index = step_grid(time, self.step)
        arriving = np.full(len(grid), -1)
        arriving[index] = np.arange(len(time))
        known, motion = self._known(columns, grid)
        gains = np.stack(_columns(columns, {gain.name: gain.value for gain in observer.gains}, len(scene)), axis=-1)
        places = [observer.form.coordinates.index(x) for x in observer.form.x1]
        start, corrects = self._start(columns, begins[:, places] + noise[film, 0], gains, known[motion, 0])
        batch = Batch(
            start,
            np.broadcast_to(corrects, (len(scene), len(corrects))),
            gains,
            moves,
            np.stack([film, scene, motion], axis=-1),
            noise,
            truth,
            known,
            np.diff(grid),
            arriving,
            time - time[0],
            camera.reach,
            self._held(columns, scenes, noise, film, time, grid),
        )
        late = int(np.argmax(from_the_start(time - time[0], self.after)))
        counts = run_batch(self._loop(columns), batch, self.tolerance, late, self.language)
        told_of = told(counts, time - time[0], grid - grid[0], late, self.means, self.settled_part)
        fine = self._in_front(columns, scenes, counts, turning, time) if alone else np.isfinite(truth[scene, 0, 0])
        status = np.where(fine, DONE, NOT_IN_FRONT).astype(float)
        if self.prior is not None:
            told_of["bound"] = self._bounds(columns, scenes, camera, self.prior)
        rest = [np.where(fine, told_of[name], np.nan) for name in self.statistics[1:]]
        return np.stack([status, *rest], axis=-1)

    def _bounds(self, columns: Mapping[str, Array], scenes: list[str], camera: Camera, prior: Values) -> Array:
        """The least error of each run; the seed matters only where samples are lost."""
        varied = [name for name in ("noise", "dropout") if name in columns]
        seed = ["seed"] if camera.dropout or "dropout" in columns else []
        rows, which = _distinct(columns, [*scenes, *varied, *seed])
        found = []
        for row in rows.tolist():
            values = dict(zip([*scenes, *varied, *seed], row, strict=True))
            numbers = tuple((name, values[name]) for name in scenes)
            taken = camera_with(camera, {name: values[name] for name in varied})
            form, drawn = self.observer.form, int(values.get("seed", 0))
            found.append(least_error(self.scenario, numbers, form, self.duration, taken, drawn, prior, self.after))
        return np.array(found)[which]

    def _truths(self, names: tuple[str, ...], rows: Array, time: Array) -> Array:
        """True coordinates of variants of the scenario, shape (D, K, n); NaN where the point is not seen throughout."""
        found = [_coordinates(self.scenario, names, tuple(row), time.tobytes()) for row in rows.tolist()]
        return np.stack(found)

    def _moves(self, columns: Mapping[str, Array], period: float) -> tuple[Array, Array, Array]:
        """Points, maps to the next sample and surfaces' numbers; first coordinates; how far a period leads."""
        scenario, surface, runs = self.scenario, self.scenario.surface, len(columns["seed"])
        numbers = numbers_of(scenario)
        values = dict(zip(numbers, _columns(columns, numbers, runs), strict=True))
        point = [values[symbol.name] for symbol in POINT]
        shape = [values[symbol.name] for symbol in surface.parameters]
        A, b = coefficients(scenario.motion, np.stack([values[s.name] for s in scenario.motion.parameters], axis=-1))
        A, b = (np.broadcast_to(each, (runs, *each.shape[1:])) for each in (A, b))
        across = transitions(A, b, period).reshape(runs, -1)
        with np.errstate(all="ignore"):
            seen = vectorised((*POINT, *surface.parameters), moving(surface).coordinates)(*point, *shape)
        turning = np.broadcast_to(period * np.abs(A).sum(axis=-1).max(axis=-1), runs)
        return np.column_stack([*point, across, *shape]), np.stack(seen, axis=-1), turning

    def _in_front(
        self, columns: Mapping[str, Array], scenes: list[str], counts: Array, turning: Array, time: Array
    ) -> Array:
        """Whether points stay in front of the camera: looked at closely where they may dip between samples."""
        nearest, drop = (counts[:, COLUMNS.index(name)] for name in ("nearest", "drop"))
        fine = nearest > 0
        for k in np.flatnonzero(fine & ~((nearest > DIP * drop) & (turning <= LONGEST_STEP_SHARE))):
            row = tuple(float(columns[name][k]) for name in scenes)
            fine[k] = np.isfinite(_coordinates(self.scenario, tuple(scenes), row, time.tobytes())).all()
        return np.asarray(fine)

    def _noise(self, columns: Mapping[str, Array], camera: Camera, count: int) -> tuple[Array, Indices]:
        """The noise of measured outputs, NaN where a sample is lost, shape (R, K, m), and which each run has."""
        varied = [name for name in ("noise", "dropout") if name in columns]
        rows, film = _distinct(columns, ["seed", *varied])
        form, names = self.observer.form, [symbol.name for symbol in self.scenario.view.image_coordinates]
        measured = [names.index(name) for name in form.measured]
        noise = np.empty((len(rows), count, len(measured)))
        kinds, of_kind = np.unique(rows[:, 1:], axis=0, return_inverse=True)
        for k, values in enumerate(kinds.tolist()):
            alike = of_kind.reshape(-1) == k
            taken = camera_with(camera, dict(zip(varied, values, strict=True)))
            noise[alike] = taken.drawn(rows[alike, 0].astype(int).tolist(), (count, len(names)))[..., measured]
        return noise, film

    def _known(self, columns: Mapping[str, Array], grid: Array) -> tuple[Array, Indices]:
        """Parameters that the observer believes in, shape (B, T, p), and which of them each run has."""
        runs, surface = len(columns["seed"]), self.scenario.surface
        shape = {symbol.name: value for symbol, value in surface.values.items()}
        if not self.believed.values:
            rows = self.believed.known(instants(grid))
            shown = np.broadcast_to([shape[symbol.name] for symbol in surface.parameters], (len(rows), len(shape)))
            return np.hstack([rows, shown])[None], np.zeros(runs, dtype=int)
        believed = {symbol.name: value for symbol, value in self.believed.values.items()}
        own = self.believed is self.scenario.motion
        taken = {}
        for name in believed:
            names = [f"believed_{name}", *([name] if own else [])]
            taken[name] = next((columns[n] for n in names if n in columns), None)
        taken |= {name: columns.get(name) for name in shape}
        values = {name: each for name, each in taken.items() if each is not None}
        order = [*believed, *(symbol.name for symbol in surface.parameters)]
        numbers = believed | shape
        together = _columns(values, {name: numbers[name] for name in order}, runs)
        return np.stack(together, axis=-1)[:, None], np.arange(runs)

    def _start(self, columns: Mapping[str, Array], first: Array, gains: Array, known: Array) -> tuple[Array, Array]:
        """States at the first sample, and which first samples correct them: those whose start is given."""
        observer, form = self.observer, self.observer.form
        names = [symbol.name for symbol in form.coordinates]
        varied = {name: columns[f"start_{name}"] for name in names if f"start_{name}" in columns}
        given = set(varied) | set(self.start)
        asked = dict.fromkeys(names, 0.0) | dict(self.start)
        values = dict(zip(names, _columns(varied, asked, len(first)), strict=True))
        values |= {name: first[:, k] for k, name in enumerate(form.measured) if name not in given}
        flags = [float(name not in given) for name in form.measured]
        symbols = (
            *form.x1,
            *(gain.symbol for gain in observer.gains),
            *form.parameters,
            *hats(form.coordinates),
            *first_seen(form.x1),
        )
        inputs = (*first.T, *gains.T, *known.T, *values.values(), *flags)
        start = np.stack(vectorised(symbols, observer.start)(*inputs), axis=-1)
        return start, np.array([name in given for name in form.measured])

    def _held(
        self, columns: Mapping[str, Array], scenes: list[str], noise: Array, film: Indices, time: Array, grid: Array
    ) -> Array | None:
        """Outputs at the instants of the steps, shape (L, N, EACH + 1, m), unless the last sample is held."""
        if self.hold == "zero":
            return None
        times, form = time if self.hold == "first" else instants(grid), self.observer.form
        rows, scene = _distinct(columns, scenes)
        places = [form.coordinates.index(x) for x in form.x1]
        exact = self._truths(tuple(scenes), rows, times)[..., places][scene]
        if self.hold == "first":
            seen = exact + noise[film]
            exact = np.stack([[_between(instants(grid), time, y) for y in each.T] for each in seen]).swapaxes(1, 2)
        return np.stack([by_step(each) for each in exact])


@lru_cache(maxsize=256)
def _coordinates(scenario: Scenario, names: tuple[str, ...], row: tuple[float, ...], times: bytes) -> Array:
    """True coordinates of a variant of a scenario, NaN if its point does not stay in front of the camera."""
    at = np.frombuffer(times)
    try:
        return with_numbers(scenario, **dict(zip(names, row, strict=True))).coordinates(at)
    except BehindCamera:
        return np.full((len(at), len(scenario.view.coordinates)), np.nan)


def _between(times: Array, known: Array, values: Array) -> Array:
    """Values on the lines between those that were not lost."""
    there = np.isfinite(values)
    return np.interp(times, known[there], values[there]) if there.any() else np.full(len(times), np.nan)


def _distinct(columns: Mapping[str, Array], names: list[str]) -> tuple[Array, Indices]:
    """Distinct rows of some columns, shape (D, number of names), and which of them each run has."""
    runs = len(columns["seed"])
    if not names:
        return np.empty((1, 0)), np.zeros(runs, dtype=int)
    rows, which = np.unique(np.stack([columns[name] for name in names], axis=-1), axis=0, return_inverse=True)
    return rows, which.reshape(-1)


def _columns(varied: Mapping[str, Array], values: Mapping[str, float], runs: int) -> list[Array]:
    """Values of every run, those that vary or those that are the same."""
    return [varied.get(name, np.full(runs, value)) for name, value in values.items()]
