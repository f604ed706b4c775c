"""Ensembles described by a file, for machines without a notebook."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from percept_obs.observers import OBSERVERS
from percept_obs.recording import Camera, Uniform, scenarios
from percept_obs.studies.ensemble import ensemble
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.validation import limit, refuse_kind

SCENARIOS = {make.__name__: make for make in (scenarios.ma2005_eq35, scenarios.ma2005_eq36, scenarios.planar)}
MAKERS = {make.key: make for make in OBSERVERS}
NEEDED = ("scenario", "observer", "store")
SETTINGS = {
    *("seeds", "duration", "start", "hold", "step", "tolerance", "after", "coordinates", "prior", "language", "chunk")
}
"""Arguments of `ensemble` that a file may have besides those of `KINDS`."""

KINDS: Mapping[str, Any] = {
    **dict.fromkeys(NEEDED, str),
    "outputs": Sequence[str],
    **dict.fromkeys(("gains", "camera"), Mapping[str, float]),
    "over": Mapping[str, Any],
}
"""Entries of a file that are read here, with their kinds."""


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
        If the file is no TOML, or has unknown, missing or wrong entries.
    OSError
        If it cannot be read.

    See Also
    --------
    percept_obs.ensemble : runs an ensemble from Python

    Examples
    --------
    >>> from tempfile import mkdtemp
    >>> file = Path(mkdtemp(), "mine.toml")
    >>> lines = ['scenario = "planar"', 'observer = "identifier_based"', 'store = "mine.zarr"', "seeds = 2"]
    >>> file.write_bytes(os.linesep.join(lines).encode()) and dict(sweep(file).sizes)
    {'seed': 2}
    """
    refuse_kind("sweep", "path", path, str | os.PathLike)
    file = Path(path)
    try:
        entries = tomllib.loads(file.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{file} is no TOML: {error}") from None
    if unknown := sorted(set(entries) - SETTINGS - set(KINDS)):
        raise ValueError(f"{file}: a sweep does not know {', '.join(unknown)}; it knows {', '.join(sorted(SETTINGS))}")
    if missing := [name for name in NEEDED if name not in entries]:
        raise ValueError(f"{file}: a sweep needs {', '.join(missing)}")
    for name in set(KINDS) & set(entries):
        refuse_kind("sweep", name, entries[name], KINDS[name])
    scenario = _named(SCENARIOS, "scenario", entries["scenario"])()
    family = _named(MAKERS, "observer", entries["observer"])
    outputs = entries.get("outputs", [symbol.name for symbol in scenario.surface.image_coordinates])
    gains, camera = entries.get("gains", {}), dict(entries.get("camera", {}))
    options = {option.name: gains.pop(option.name) for option in family.options if option.name in gains}
    form = PerspectiveSystem(scenario.motion, scenario.surface).partition(*outputs)
    observer = family(form, **options).with_gains(**gains)
    if "noise" in camera:
        camera["noise"] = Uniform(camera["noise"])
    over = {name: _values(name, values) for name, values in entries.get("over", {}).items()}
    settings = {name: entries[name] for name in SETTINGS if name in entries}
    store = entries["store"] and file.parent / entries["store"]
    return ensemble(scenario, observer, over, camera=Camera(**camera), client=client, store=store, **settings)


def _named(known: Mapping[str, Any], kind: str, name: Any) -> Any:
    if name not in known:
        raise ValueError(f"there is no {kind} {name!r}; there are {', '.join(known)}")
    return known[name]


def _values(name: str, values: Any) -> Any:
    """Return a list, or evenly spaced values."""
    if not isinstance(values, dict):
        return values
    if set(values) != {"from", "to", "count"}:
        raise ValueError(f"over has {values!r} for {name}; give a list, or from, to and count")
    for part, kind in (("from", float), ("to", float), ("count", int)):
        refuse_kind("sweep", f"{part} for {name}", values[part], kind)
    limit(values["count"], f"values of {name}", "take fewer")
    return np.linspace(values["from"], values["to"], max(values["count"], 0))
