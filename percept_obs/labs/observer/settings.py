"""What may be set in the observer lab."""

from __future__ import annotations

from typing import Any

import numpy as np

from percept_obs.labs.observer.texts import BY_NAME, OUTPUTS, OWN_SWITCH, SURFACES, WAYS
from percept_obs.labs.shared.schema import (
    Choice,
    Group,
    Names,
    Number,
    Optional,
    Row,
    Schema,
    Settings,
    Whole,
    noise,
    vector,
)
from percept_obs.recording import Scenario, scenarios

SCENARIOS = {make.__name__: make for make in (scenarios.ma2005_eq35, scenarios.ma2005_eq36, scenarios.planar)}
HOLDS = ("zero", "first", "exact")
PICTURES = ("outputs", "inverse", "distance", "error", "excitation")
_ROWS = [[f"a{i}{j}" for j in (1, 2, 3)] for i in (1, 2, 3)]


def _matrix(about: str) -> Row:
    return Row(entries=[vector(row, step=0.05) for row in _ROWS], label="Motion A", unit="1/s", about=about)


def _translation(about: str) -> Row:
    return vector(("b1", "b2", "b3"), usual=(-1, 1), step=0.01, unit="m/s", about=about)


def as_settings(scenario: Scenario) -> Settings:
    """A scenario's motion, point, surface and duration.

    Raises
    ------
    ValueError
        If the motion varies.
    """
    values = scenario.motion.values
    if not values:
        raise ValueError(
            f"the motion of the scenario {scenario.name!r} varies over time; record() it and open the lab with the "
            "recording"
        )
    A, b = (np.array(block.subs(values), dtype=float) for block in (scenario.motion.A, scenario.motion.b))
    normal = list(scenario.surface.values.values())
    surface = {"surface": scenario.surface.name, **({"normal": normal} if normal else {})}
    X0, duration = list(map(float, scenario.position)), scenario.duration
    return {"A": A.tolist(), "b": b.ravel().tolist(), "X0": X0, "duration": duration, **surface}


SCHEMA = Schema(
    scenario=Choice(opening="ma2005_eq35", names=tuple(SCENARIOS), label="Scenario", about="a name"),
    A=_matrix("of the true motion X' = A X + b, in 1/s"),
    b=_translation("of the true motion, in m/s"),
    X0=vector(("X", "Y", "Z"), usual=(-5, 10), step=0.05, unit="m", about="the point at time 0, in metres"),
    duration=Number(opening=80.0, low=0.1, high=200, usual=(2, 120), step=1, unit="s", about="seconds"),
    surface=Choice(opening="pinhole", names=tuple(SURFACES), label="Imaging surface"),
    normal=Row(
        entries=[
            Number(label="n1", usual=(-1, 1), step=0.05),
            Number(label="n2", usual=(-1, 1), step=0.05),
            Number(
                label="n3",
                opening=1.0,
                usual=(-1, 1),
                step=0.05,
                zero=False,
                reason="the plane must not hold the optical axis",
            ),
        ],
        about="the normal vector of a plane",
    ),
    outputs=Names(opening=["y1", "y2"], names=OUTPUTS[0], about="names of what is measured"),
    observers=Names(opening=["identifier_based"], names=tuple(BY_NAME), about="names"),
    gains=Group(of={}, about="for each observer, its gains by name"),
    switches=Group(
        of={name: Choice(opening=own, names=WAYS[name]) for name, own in OWN_SWITCH.items()},
        partial=True,
        about="for each observer that switches, how",
    ),
    believed=Optional(
        of=Group(of={"A": _matrix(""), "b": _translation("")}),
        about="None, or the A and the b that the observers believe",
    ),
    noise=noise(size=Number(low=0, high=1, usual=(0, 0.05), step=0.0005, label="bound or σ")),
    dropout=Number(low=0, high=0.95, usual=(0, 0.9), step=0.01, label="lost samples", about="share that is lost"),
    seed=Number(opening=0, low=0, high=2**32 - 1, usual=(0, 100), step=1, whole=True, about="of noise and losses"),
    period=Number(opening=0.01, low=1e-3, high=1, usual=(0.002, 0.2), log=True, unit="s", about="seconds"),
    hold=Choice(opening="zero", names=HOLDS, label="Hold"),
    start=Group(
        of={
            "mode": Choice(opening="own", names=("own", "zero", "chosen"), label="x̂ starts at"),
            "values": vector(("y1", "y2", "y3"), usual=(-2, 2), step=0.01),
        },
        about='a mapping of mode, "own", "zero" or "chosen", and the chosen values',
    ),
    window=Number(
        opening=10.0,
        low=0.1,
        high=200,
        usual=(0.5, 30),
        step=0.5,
        unit="s",
        about="seconds over which w w^T is gathered",
    ),
    threshold=Number(
        opening=0.1,
        low=0,
        high=10,
        usual=(0, 0.5),
        step=0.005,
        label="threshold of |w|",
        about="|w| below which an instant tells too little",
    ),
    pictures=Names(opening=["distance", "error", "excitation"], names=PICTURES, about="time charts that are shown"),
    kept=Optional(of=Whole(), about="None, or the settings of the run that is kept to compare with"),
)
"""The settings; a lab of its own scenarios and recordings knows more of the first, and all have gains."""

STANDARD: dict[str, Any] = SCHEMA.opening | as_settings(scenarios.ma2005_eq35())
"""What every preset begins with."""
