"""Ensembles: one scenario and one observer, run over whatever may vary, chunk by chunk."""

from __future__ import annotations

import json
import math
from collections.abc import Generator, Iterator, Mapping, Sequence, Sized
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from percept_obs.compile import Array, Language, choose
from percept_obs.compile.batch import compiled
from percept_obs.compile.integrator import LONGEST_STEP
from percept_obs.observers.base import Observer
from percept_obs.recording import Camera, Scenario, record
from percept_obs.recording.many import numbers_of
from percept_obs.studies.plan import CAMERA, DONE, OUTCOMES, STATISTICS, STATUS, Plan, camera_with, grid_of
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import POINT
from percept_obs.tracking.following import DoesNotFit, named_start, track
from percept_obs.tracking.verdict import TOLERANCE
from percept_obs.validation import bar, checked, limit, listed, needed, positive, workers

if TYPE_CHECKING:
    import xarray as xr

Start = Mapping[str, float] | Sequence[float] | None

CHUNK = 2048
"""Runs that are computed together unless asked otherwise."""

NUMPY_LINES, NUMPY_RUN = 10, 1 / 40
"""What numpy's loop costs in a step for each chunk and for each run in it, in steps of one run in Python."""

MOST_RUNS = 10_000_000
"""Runs that one ensemble may have: about 1 GiB of statistics."""


@checked
def ensemble(
    scenario: Scenario,
    observer: Observer,
    over: Mapping[str, Any] | None = None,
    seeds: int | Sequence[int] = 1,
    duration: float | None = None,
    camera: Camera | None = None,
    start: Start = None,
    believed: Motion | None = None,
    step: float = LONGEST_STEP,
    tolerance: float = TOLERANCE,
    after: float = 0.0,
    language: Language | None = None,
    chunk: int = CHUNK,
) -> Any:
    """Record a scenario and follow it, for every combination of what varies and every seed.

    A run is what ``track(record(...), observer, ...)`` makes; its statistics are counted while it runs, so that the
    memory does not grow with its length.

    Parameters
    ----------
    scenario : Scenario
        Of one point.
    observer : Observer
        That follows it.
    over : mapping of names to values, optional
        What varies: a gain of the observer ("gain"); an estimate at the start ("start_y3"); the point's position
        ("X"), the true motion ("b1") or the surface, by the names of their symbols; what the observer believes of the
        motion ("believed_b1"); the camera's "noise" (bound or standard deviation), "period" and "dropout".  A list
        of values is a dimension; a DataArray brings its own, so that two of them on one dimension go together.
    seeds : int or sequence of int
        Seeds of the noise, or how many of them, from 0 on.
    duration, camera : as in record
        Seconds, the scenario's own when left out, and a camera.
    start, believed, step : as in track, which holds the last sample
        A true motion that varies is believed in unless `believed` is given.
    tolerance : float
        Bound on the relative error of the distance; see `Run.outcome`.
    after : float
        Seconds from which on errors count for their root mean square and their largest value.
    language : "python" or "numba", optional
        See `solve`; Python's runs in numpy.
    chunk : int
        Runs that are computed together.

    Returns
    -------
    xarray.Dataset
        With the dimension "seed" and those of `over`: status, outcome, settling_time (s, infinite if it has not
        converged), judged (what the tolerance bounds, at the end), final, rms, worst (errors of the inverse distance in
        1/m), resets, diverged_at (s, infinite if it does not).  `status` and `outcome` are numbers whose meanings are
        among their attributes.  A point that does not stay in front of the camera has the status "not_in_front" and
        NaN.  ``to_netcdf`` keeps it with all settings.

    Raises
    ------
    ValueError
        If nothing of the name can vary, or a value is out of range.
    DoesNotFit
        If the observer cannot follow the scenario.
    ModuleNotFoundError
        If xarray is not installed.

    See Also
    --------
    percept_obs.studies.comparison.compare : Several observers.

    Notes
    -----
    Products and sums are rounded once in machine code, so that a run differs from `track`'s by about 1e-14 relative,
    more only where a reset or a switch is met by a hair.  The same seeds give the same numbers, bit for bit, in any
    chunks and threads on processors of one kind.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ensemble, ibo, pinhole, scenarios
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> found = ensemble(scenarios.ma2005_eq35(), ibo(form), {"gain": [2.0, 10.0]}, duration=5)
    >>> round(found.settling_time.sel(gain=10.0, seed=0).item(), 2)
    1.91
    """
    needed("course", "xarray")
    camera, motion = camera or scenario.camera, believed or scenario.motion
    duration = scenario.duration if duration is None else float(duration)
    over = {name: listed(values) if isinstance(values, Iterator) else values for name, values in (over or {}).items()}
    sizes = {"seed": int(seeds) if isinstance(seeds, int | np.integer) else len(seeds)}
    for name, values in over.items():
        several_values = isinstance(values, Sized) and getattr(values, "shape", True)
        sizes |= getattr(values, "sizes", {name: len(values) if several_values else 1})
    limit(float(math.prod(sizes.values())), "runs", "take fewer values or seeds", MOST_RUNS)
    several: Array = np.asarray(range(seeds) if isinstance(seeds, int | np.integer) else seeds)
    names = units(scenario, observer, motion)
    if unknown := sorted(set(over) - set(names)):
        raise ValueError(f"over has {', '.join(unknown)}, which cannot vary here; there are {', '.join(names)}")
    if not several.size or several.ndim != 1 or several.dtype.kind not in "iu" or several.min() < 0:
        raise ValueError(f"the seeds are {seeds!r}; give whole numbers from 0 on, or how many of them")
    if len(np.unique(several)) < len(several):
        raise ValueError("a seed stands twice; the same seed gives the same run again, so give each once")
    starts = named_start(start, observer.form.coordinates)
    if clash := sorted(name for name in starts if f"start_{name}" in over):
        raise ValueError(f"over varies start_{clash[0]}, and start gives {clash[0]} as well; give one of the two")
    positive(step=step, duration=duration)
    steps = duration / min(step, camera.period)
    limit(steps, "steps", "take longer steps or a shorter time")
    grid = grid_of(over, several, names)
    runs = math.prod(grid.sizes.values())
    if chunk < 1:
        raise ValueError(f"a chunk of {chunk} runs is none; take at least 1")
    plan = Plan(
        grid,
        scenario,
        observer.suited_to(camera.noise.variance),
        duration,
        camera,
        starts,
        motion,
        step,
        tolerance,
        after,
        choose(language, steps * (runs * NUMPY_RUN + -(-runs // chunk) * NUMPY_LINES)),
    )
    _refuse_values(plan)
    results = np.zeros((runs, len(STATISTICS)))
    _run_all(plan, results, chunk)
    about = _settings(plan).items()
    attributes = {name: value if isinstance(value, str | float) else json.dumps(value) for name, value in about}
    return _dataset(plan, results).assign_attrs(attributes)


def units(scenario: Scenario, observer: Observer, believed: Motion) -> dict[str, str]:
    """Names that can vary, with their units."""
    numbers, form = numbers_of(scenario), observer.form
    metres, shape = set(map(str, POINT)), {symbol.name for symbol in scenario.surface.values}
    rates = {symbol.name for entry in scenario.motion.A for symbol in entry.free_symbols}

    def unit(name: str) -> str:
        return "1/s" if name in rates else "1" if name in shape else "m" if name in metres else "m/s"

    found = {gain.name: gain.unit for gain in observer.gains}
    found |= {f"start_{s.name}": "1/m" if s is form.coordinates[-1] else "1" for s in form.coordinates}
    found |= {name: unit(name) for name in numbers} | CAMERA
    return found | {f"believed_{symbol.name}": unit(symbol.name) for symbol in believed.values}


def _refuse_values(plan: Plan) -> None:
    """Refuse settings that no run could have, before any begins."""
    scenario, camera, observer = plan.scenario, plan.camera, plan.observer
    ends = {str(name): (float(each.values.min()), float(each.values.max())) for name, each in plan.grid.coords.items()}
    for gain in observer.gains:
        for value in ends.get(gain.name, ()):  # what lies between is allowed as well
            observer.with_gains(**{gain.name: value})
    for name in set(ends) & set(CAMERA):
        for value in ends[name]:
            camera_with(camera, {name: value}).times(plan.duration)
    shape = sorted({symbol.name for symbol in scenario.surface.values} & set(ends))
    if shape and observer.form.values:
        raise DoesNotFit(
            f"{', '.join(shape)} of the surface cannot vary, for the {observer.name} observer was derived with numbers "
            "for the surface; derive it for the surface with symbols"
        )
    plan.believed.known(np.array([0.0, plan.duration]))
    if camera.field_of_view < 2 * math.pi:
        raise ValueError("an ensemble knows no field of view; leave it out of the camera, or give it a reach")
    short = min(camera.period, plan.step)  # the point need not stay in front of the camera for longer
    first = record(scenario, short, replace(camera, period=short))
    run = track(first, observer, plan.start, believed=plan.believed, step=plan.step, language="python")
    run.outcome(plan.tolerance)
    if not 0 <= plan.after <= plan.duration:
        raise ValueError(f"after is {plan.after} s; errors count from then on, within the {plan.duration} s of a run")


def _settings(plan: Plan) -> dict[str, Any]:
    """All settings of an ensemble as text and numbers."""
    scenario, observer = plan.scenario, plan.observer

    def by_name(values: Mapping[Any, float]) -> dict[str, float]:
        return {symbol.name: value for symbol, value in values.items()}

    return {
        "scenario": scenario.name,
        "position": list(scenario.position),
        "motion": by_name(scenario.motion.values),
        "believed": by_name(plan.believed.values),
        "unit": scenario.unit,
        "surface": f"{scenario.surface.name} {by_name(scenario.surface.values)}",
        "observer": observer.name,
        "outputs": list(observer.form.measured),
        "gains": {gain.name: gain.value for gain in observer.gains},
        "duration": plan.duration,
        "camera": str(plan.camera),
        "start": dict(plan.start),
        "step": plan.step,
        "tolerance": plan.tolerance,
        "after": plan.after,
        "language": plan.language,
    }


def _dataset(plan: Plan, results: Array) -> xr.Dataset:
    """Results as variables on the grid, from an array of shape (number of runs, number of statistics)."""
    dimensions, shape = tuple(plan.shape), tuple(plan.shape.values())
    done, variables = results[:, 0] == DONE, {}
    for name, column in zip(STATISTICS, results.T, strict=True):
        unit, meaning = STATISTICS[name]
        about: dict[str, Any] = {"units": unit, "long_name": meaning}
        values = column if name == "status" else np.where(done, column, np.nan)
        if flags := {"status": STATUS, "outcome": OUTCOMES}.get(name):
            values = np.where(np.isfinite(values), values, -1).astype(np.int8)
            about |= {"flag_values": np.arange(len(flags), dtype=np.int8), "flag_meanings": " ".join(flags)}
        variables[name] = (dimensions, values.reshape(shape), about)
    return plan.grid.assign(variables)


def _run_all(plan: Plan, results: Array, chunk: int) -> None:
    """Compute all runs in chunks."""
    chunks = [slice(begin, min(begin + chunk, len(results))) for begin in range(0, len(results), chunk)]
    compiled(plan.loop, plan.language)  # here and now, where numba may set warning filters
    several = plan.language == "numba" and workers() > 1  # numpy's loop keeps the other threads waiting
    computed = _concurrent(plan, chunks) if several else ((each, plan.compute(each)) for each in chunks)
    with closing(computed), bar(None, "runs", len(results), unit="run") as progress:
        for each, found in computed:
            results[each] = found
            progress.update(len(found))


def _concurrent(plan: Plan, todo: Sequence[slice]) -> Generator[tuple[slice, Array]]:
    """Yield chunks as threads have done them."""
    executor = ThreadPoolExecutor(workers())
    try:
        begun = {executor.submit(plan.compute, each): each for each in todo}
        for future in as_completed(begun):
            yield begun.pop(future), future.result()
    finally:
        executor.shutdown(wait=False, cancel_futures=True)  # an interrupt waits for no chunk
