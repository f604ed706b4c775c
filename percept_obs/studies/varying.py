"""What an ensemble may vary: names, what they stand for, their units, and the values of each run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from percept_obs.compile import Array, Indices, vectorised
from percept_obs.observers.base import Observer
from percept_obs.recording import Camera, Scenario
from percept_obs.recording.many import numbers_of
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import POINT

CAMERA = {"noise": "1", "period": "s", "dropout": "1"}
"""What of a camera can vary, with units; the noise is its bound or its standard deviation."""


@dataclass(frozen=True, eq=False)
class Grid:
    """The values over which an ensemble goes; a run has an index along each dimension.

    Parameters
    ----------
    dimensions : mapping of names to lengths
        The seed first.
    columns : mapping of names to pairs of dimensions and values
        Values of an array with those dimensions.
    """

    dimensions: Mapping[str, int]
    columns: Mapping[str, tuple[tuple[str, ...], Array]]

    @property
    def runs(self) -> int:
        """How many runs there are."""
        return int(np.prod([float(length) for length in self.dimensions.values()]))

    def part(self, runs: Indices) -> dict[str, Array]:
        """The values of some runs, by their numbers in C order."""
        places = dict(zip(self.dimensions, np.unravel_index(runs, tuple(self.dimensions.values())), strict=True))
        return {name: values[tuple(places[d] for d in along)] for name, (along, values) in self.columns.items()}


def grid_of(over: Mapping[str, Any], seeds: Array) -> Grid:
    """The grid that is asked for: a list of values is a dimension of its own, a DataArray brings its dimensions.

    Raises
    ------
    ValueError
        If values are none, not finite, or lengths of a dimension differ.
    """
    dimensions = {"seed": len(seeds)}
    columns: dict[str, tuple[tuple[str, ...], Array]] = {"seed": (("seed",), seeds)}
    for name, given in over.items():
        along = tuple(map(str, getattr(given, "dims", (name,))))
        values = np.asarray(given, dtype=float)
        if values.ndim != len(along) or not values.size or not np.isfinite(values).all():
            raise ValueError(
                f"over goes {name!r} through values of shape {values.shape}; give finite numbers, a list of them or a "
                "DataArray with named dimensions"
            )
        for dimension, length in zip(along, values.shape, strict=True):
            if dimensions.setdefault(dimension, length) != length:
                raise ValueError(
                    f"over has {length} values of {name!r} along {dimension!r}, where others have "
                    f"{dimensions[dimension]}; give equally many, or another dimension"
                )
        columns[name] = (along, values)
    return Grid(dimensions, columns)


def units(scenario: Scenario, observer: Observer, believed: Motion, camera: Camera) -> dict[str, str]:
    """Every name that can vary, with its unit."""
    rates = set().union(*(entry.free_symbols for entry in scenario.motion.A))
    numbers = numbers_of(scenario)
    shape = {symbol.name for symbol in scenario.surface.values}
    turning = {symbol.name for symbol in rates}

    def unit(name: str) -> str:
        return "1/s" if name in turning else "1" if name in shape else "m" if name in map(str, POINT) else "m/s"

    found = {gain.name: gain.unit for gain in observer.gains}
    form = observer.form
    found |= {f"start_{s.name}": "1/m" if s is form.coordinates[-1] else "1" for s in form.coordinates}
    found |= {name: unit(name) for name in numbers} | CAMERA
    return found | {f"believed_{symbol.name}": unit(symbol.name) for symbol in believed.values}


def refuse_gains(observer: Observer, values: Mapping[str, Array]) -> None:
    """Refuse values of gains that are out of range, with what the observer says of the first of them."""
    for gain in observer.gains:
        if gain.name in values:
            given = np.unique(values[gain.name])
            (fine,) = vectorised((gain.symbol,), (gain.condition,))(given)
            for wrong in given[fine == 0][:1].tolist():
                observer.with_gains(**{gain.name: wrong})


def camera_with(camera: Camera, values: Mapping[str, float]) -> Camera:
    """The camera with another noise, period or dropout."""
    changes: dict[str, Any] = {name: values[name] for name in ("period", "dropout") if name in values}
    if "noise" in values:
        changes["noise"] = type(camera.noise)(values["noise"])
    return replace(camera, **changes)
