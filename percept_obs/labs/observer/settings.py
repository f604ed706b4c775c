"""Settings of the observer lab."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from percept_obs.labs.observer.registry import Registry
from percept_obs.labs.observer.texts import BY_NAME, OWN_SWITCH, SIZE, WAYS
from percept_obs.labs.shared.common_settings import AT_LEAST, DROPOUT, KEPT, SEED, gains, noise, offering, own_gains
from percept_obs.labs.shared.observer_texts import with_all_gains
from percept_obs.labs.shared.schema import Choice, Group, Names, Number, Optional, Row, Schema, Settings, vector
from percept_obs.labs.shared.surfaces import SURFACES, numbers_of
from percept_obs.labs.shared.typed_motion import typed_setting
from percept_obs.labs.shared.view import view_of
from percept_obs.recording import Scenario, scenarios

SCENARIOS = {
    make.__name__: make for make in (scenarios.drive, scenarios.ma2005_eq35, scenarios.ma2005_eq36, scenarios.planar)
}
FIRST_GUESS = 6.0
"""Metres from the camera at which the estimate of a drive starts: wrong, but near enough to be drawn."""
HOLDS = ("zero", "first", "exact")
LOOKS = view_of(
    groups=("observers", "gains", "scene", "camera", "start"),
    charts=("error", "inverse", "outputs", "innovation", "excitation"),
)
_ROWS = [[f"a{i}{j}" for j in (1, 2, 3)] for i in (1, 2, 3)]


def _matrix(about: str = "") -> Row:
    return Row([vector(row, step=0.05) for row in _ROWS], label="Motion A", unit="1/s", about=about)


def _translation(about: str = "") -> Row:
    return vector(("b1", "b2", "b3"), about, "m/s", usual=(-1, 1), step=0.01)


def as_settings(scenario: Scenario, surface: str = "") -> Settings:
    """Settings of a scenario by its unit: motion, point, duration, and its surface under the lab's name, if it has one.

    A motion that varies is taken at time 0.
    """
    motion = scenario.motion
    numbers = dict(zip(motion.parameters, motion.known(0.0)[0].tolist(), strict=True))
    A, b = (np.array(block.subs(numbers), dtype=float) for block in (motion.A, motion.b))
    surface = surface or scenario.surface.name
    shaped = {"surface": surface, **numbers_of(scenario.surface, surface)}
    b, X0 = ((each.ravel() / scenario.unit).tolist() for each in (b, np.array(scenario.position, dtype=float)))
    return {"A": A.tolist(), "b": b, "X0": X0, "duration": float(scenario.duration), **shaped}


_TILT: Settings = {"usual": (-1, 1), "step": 0.05}
_NOT_ALONG = "the plane must not hold the optical axis"
_WINDOW = f"over which w w^T is gathered, {AT_LEAST}"
_THRESHOLD = "|w| below which an instant tells too little"

SCHEMA = Schema(
    scenario=Choice("ma2005_eq35", tuple(SCENARIOS), about="a name"),
    A=_matrix("of the true motion X' = A X + b"),
    b=_translation("of the true motion"),
    motion=typed_setting("a12 = 0.4 cos(2t); b3 = b3 + 0.1 sin(t)"),
    X0=vector(("X", "Y", "Z"), "the point at time 0", "m", usual=(-5, 10), step=0.05),
    duration=Number(80.0, 0.1, 200, (2, 120), 1, unit="s"),
    surface=Choice("pinhole", tuple(SURFACES), label="Imaging surface"),
    normal=Row(
        [
            *(Number(label=label, **_TILT) for label in ("n1", "n2")),
            Number(1.0, label="n3", nonzero=True, reason=_NOT_ALONG, **_TILT),
        ],
        about="the normal vector of a plane",
    ),
    xi=Number(0.8, 0, 1, (0, 1), 0.01, label="ξ", about="of the mirror or lens of the unified model"),
    outputs=Names(["y1", "y2"], SIZE, label="Measured outputs", about="names of what is measured"),
    observers=Names(["identifier_based"], tuple(BY_NAME), about="names"),
    gains=Group({}, about="for each observer, its gains by name"),
    switches=Group({n: Choice(own, WAYS[n]) for n, own in OWN_SWITCH.items()}, partial=True, about="by observers"),
    believed=Optional(Group({"A": _matrix(), "b": _translation()}), about="None, or the motion that observers believe"),
    noise=noise(size=Number(0.0, 0, 1, (0, 0.05), 0.0005, label="bound or σ")),
    seed=SEED,
    period=Number(0.01, 1e-3, 1, (0.002, 0.2), unit="s", topic="camera"),
    dropout=DROPOUT,
    hold=Choice("zero", HOLDS),
    start=Group(
        {
            "mode": Choice("own", ("own", "zero", "chosen"), label="x̂ starts at"),
            "values": vector(("y1", "y2", "y3"), usual=(-2, 2), step=0.01),
        },
        about='a mapping of mode, "own", "zero" or "chosen", and the chosen values',
    ),
    window=Number(10.0, 0.1, 200, (0.5, 30), 0.5, unit="s", about=_WINDOW, topic="charts"),
    threshold=Number(0.1, 0, 10, (0, 0.5), 0.005, label="threshold of |w|", about=_THRESHOLD, topic="charts"),
    kept=KEPT,
)
"""The settings; a lab of its own scenarios and recordings knows more of the first, and all have gains."""


def schema_of(registry: Registry, scenarios_and_recordings: Mapping[str, Any]) -> Schema:
    """Settings of a lab with the surfaces and observers of a registry."""
    switches = {n: Choice(make.switches[0], make.switches) for n, make in registry.observers.items() if make.switches}
    standard = own_gains(registry.part()["observers"])
    return Schema(
        SCHEMA
        | {
            "scenario": Choice(STANDARD["scenario"], tuple(scenarios_and_recordings)),
            "surface": offering(SCHEMA["surface"], registry.surfaces),
            "observers": offering(SCHEMA["observers"], registry.observers),
            "gains": gains(standard, lambda name: with_all_gains(registry.examples(name))),
            "switches": Group(switches, partial=True),
        }
    )


def _drive() -> Settings:
    scenario = scenarios.drive()
    X, Y, Z = scenario.position
    start = {"mode": "chosen", "values": [X / Z, Y / Z, float(np.linalg.norm([X, Y, Z])) / Z / FIRST_GUESS]}
    return {"scenario": "drive", **as_settings(scenario), "start": start, "threshold": 0.2, "window": 2.0}


STANDARD: dict[str, Any] = SCHEMA.opening | as_settings(scenarios.ma2005_eq35())
"""Settings of a lab that is given some."""

DRIVE = _drive()
"""Settings of a lab that is given none, where they differ: a drive past a standing point."""
