"""What an ensemble found, as an xarray Dataset with dimensions, units and all settings."""

from __future__ import annotations

import json
from collections.abc import Mapping
from hashlib import sha256
from typing import TYPE_CHECKING, Any

import numpy as np

from percept_obs.compile import Array, source
from percept_obs.studies.counting import OUTCOMES, STATISTICS
from percept_obs.studies.part import STATUS, Plan
from percept_obs.studies.varying import Grid

if TYPE_CHECKING:
    import xarray as xr

LOOKS = 17
"""Times at which a motion that varies is looked at to tell whether it is the same."""


def settings(plan: Plan, grid: Grid) -> dict[str, Any]:
    """All settings of an ensemble as text and numbers, and a fingerprint of them and of the equations."""
    scenario, observer = plan.scenario, plan.observer
    said: dict[str, Any] = {
        "scenario": scenario.name,
        "position": list(scenario.position),
        "motion": _by_name(scenario.motion.values),
        "believed": _by_name(plan.believed.values),
        "surface": f"{scenario.surface.name} {_by_name(scenario.surface.values)}",
        "observer": observer.name,
        "outputs": list(observer.form.measured),
        "gains": {gain.name: gain.value for gain in observer.gains},
        "duration": plan.duration,
        "camera": str(plan.camera),
        "start": dict(plan.start),
        "hold": plan.hold,
        "step": plan.step,
        "tolerance": plan.tolerance,
        "after": plan.after,
        "judged_coordinates": list(plan.coordinates),
        "prior": None if plan.prior is None else dict(plan.prior),
        "language": plan.language,
    }
    parts: list[Any] = [
        source(observer.equations),
        repr(observer.estimate),
        repr(observer.start),
        repr(scenario.surface),
        said,
    ]
    times = np.linspace(0, plan.duration, LOOKS)
    for motion in (scenario.motion, plan.believed):
        parts += [repr(motion.A), repr(motion.b), motion.known(times).tolist()]
    parts += [(name, along, values.tolist()) for name, (along, values) in grid.columns.items()]
    said["fingerprint"] = sha256(json.dumps(parts).encode()).hexdigest()
    return said


def dataset(plan: Plan, grid: Grid, kept: Array, units: Mapping[str, str], said: Mapping[str, Any]) -> xr.Dataset:
    """The statistics of all runs.

    Parameters
    ----------
    plan : Plan
    grid : Grid
    kept : array of shape (number of runs, number of statistics)
    units : mapping of names of what varies to units
    said : mapping
        From `settings`.
    """
    import xarray as xr

    shape, meanings = tuple(grid.dimensions.values()), {"status": STATUS, "outcome": OUTCOMES}
    variables = {}
    for name, column in zip(plan.statistics, kept.T, strict=True):
        unit, meaning = STATISTICS.get(name, ("1", "what became of the run"))
        about: dict[str, Any] = {"units": unit, "long_name": meaning}
        values = column.reshape(shape)
        if name in meanings:
            values = np.where(np.isfinite(values), values, -1).astype(np.int8)
            about |= {"flag_values": np.arange(len(meanings[name]), dtype=np.int8)}
            about |= {"flag_meanings": " ".join(meanings[name])}
        elif name != "status":
            values = np.where(kept[:, 0].reshape(shape) == STATUS.index("done"), values, np.nan)
        variables[name] = (tuple(grid.dimensions), values, about)
    if "bound" in variables:
        error, least = (np.sqrt(np.mean(variables[name][1] ** 2, axis=0)) for name in ("rms", "bound"))
        about = {"units": "1", "long_name": "rms error over its bound, both in the mean square over the seeds"}
        variables["efficiency"] = (tuple(grid.dimensions)[1:], error / least, about)
    coordinates = {
        name: (along, values, {"units": units.get(name, "1")}) for name, (along, values) in grid.columns.items()
    }
    attributes = {name: value if isinstance(value, str | float) else json.dumps(value) for name, value in said.items()}
    return xr.Dataset(variables, coordinates, attributes)


def _by_name(values: Mapping[Any, float]) -> dict[str, float]:
    return {symbol.name: value for symbol, value in values.items()}
