"""Ensembles from a file, for machines without a notebook."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from percept_obs.observers import OBSERVERS
from percept_obs.recording import Camera, Uniform, scenarios
from percept_obs.studies.ensemble import ensemble
from percept_obs.system.perspective import PerspectiveSystem

SCENARIOS = {make.__name__: make for make in (scenarios.ma2005_eq35, scenarios.ma2005_eq36, scenarios.planar)}
MAKERS = {make.key: make for make in OBSERVERS}
PASSED = frozenset(
    ("seeds", "duration", "start", "hold", "step", "tolerance", "after", "coordinates", "prior", "language", "chunk")
)
"""What a file may say besides scenario, observer, outputs, gains, camera, over and store; see `ensemble`."""


def sweep(path: str | os.PathLike[str], client: Any = None) -> Any:
    """Run the ensemble that a file describes, and keep it in the store that it names.

    Parameters
    ----------
    path : path
        Of a TOML file with scenario (a name in `percept_obs.scenarios`), observer (its function's name), store (beside
        the file), and optionally outputs, gains, camera (period, dropout, and noise, the bound of uniform noise), over
        and further arguments of `ensemble`.  What varies is a list, or {from = 1.0, to = 2.0, count = 5}.
    client : distributed.Client, optional

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    ValueError
        If the file makes no sense.
    OSError
        If it cannot be read.
    """
    file = Path(path)
    try:
        said = tomllib.loads(file.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{file} is no TOML: {error}") from None
    unknown = sorted(set(said) - PASSED - {"scenario", "observer", "outputs", "gains", "camera", "over", "store"})
    if unknown:
        raise ValueError(f"{file}: a sweep does not know {', '.join(unknown)}; it knows {', '.join(sorted(PASSED))}")
    missing = [name for name in ("scenario", "observer", "store") if name not in said]
    if missing:
        raise ValueError(f"{file}: a sweep needs {', '.join(missing)}")
    scenario = _named(SCENARIOS, "scenario", said["scenario"])()
    family = _named(MAKERS, "observer", said["observer"])
    system = PerspectiveSystem(scenario.motion, scenario.surface)
    names = said.get("outputs", [symbol.name for symbol in scenario.surface.image_coordinates])
    observer = family(system.partition(*names), **_table(said, "gains"))
    camera = _table(said, "camera")
    if "noise" in camera:
        camera["noise"] = Uniform(camera["noise"])
    over = {name: _values(name, values) for name, values in _table(said, "over").items()}
    further = {name: said[name] for name in PASSED if name in said}
    store = file.parent / said["store"]
    return ensemble(scenario, observer, over, camera=Camera(**camera), client=client, store=store, **further)


def _named(known: Mapping[str, Any], what: str, name: Any) -> Any:
    if name not in known:
        raise ValueError(f"there is no {what} {name!r}; there are {', '.join(known)}")
    return known[name]


def _table(said: Mapping[str, Any], name: str) -> dict[str, Any]:
    value = said.get(name, {})
    if not isinstance(value, dict):
        raise ValueError(f"{name} is {value!r}; it must be a table of names and values")
    return dict(value)


def _values(name: str, given: Any) -> Any:
    """A list, or evenly spaced values."""
    if not isinstance(given, dict):
        return given
    if set(given) != {"from", "to", "count"}:
        raise ValueError(f"over has {given!r} for {name}; give a list, or from, to and count")
    return np.linspace(given["from"], given["to"], given["count"])
