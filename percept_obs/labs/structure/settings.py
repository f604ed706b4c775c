"""What may be set in the lab of structure and motion."""

from __future__ import annotations

from typing import Any

from percept_obs.labs.shared.schema import (
    Choice,
    Flag,
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
from percept_obs.labs.structure.cases import case_of
from percept_obs.labs.structure.texts import OBSERVERS
from percept_obs.structure import QUANTITIES

PICTURES = ("unknowns", "error", "image", "depth", "innovation", "determinant", "range")
VECTORS = ("v_c", "v_p", "v_c_swing", "v_p_swing", "w")
STANDARD_GAINS: dict[str, dict[str, float]] = {
    "extended_kalman": {"noise_variance": 1e-7, "hidden_process_noise": 1.0, "hidden_variance": 100.0},
    "identifier_based": {"bound": 1e3},
}
"""Gains that fit an unknown d_s, which is larger than what the observers were made for."""


def _velocity(letter: str, about: str, **kind: Any) -> Row:
    return vector([f"{letter}{axis}" for axis in (1, 2, 3)], step=0.01, about=about, **kind)


_IN_FRONT = "it must be positive, for the point is in front"
_SPEED: Settings = {"usual": (-1, 1), "unit": "m/s"}
_SWING: Settings = {"usual": (-0.5, 0.5), "unit": "m/s"}

SCHEMA = Schema(
    unknown=Names(names=QUANTITIES, least=0, about="names of what is not known, of d_s, v_c1 to v_c3, v_p1 to v_p3"),
    earlier=Flag(about="whether a known d_s was estimated in an earlier stage, so that theta holds d_s v"),
    observers=Names(opening=["ideal"], names=tuple(OBSERVERS), about="names"),
    gains=Group(of={}, about="for each observer, its gains by name"),
    ybar=Row(
        entries=[
            Number(label="y1", usual=(-1, 1), step=0.01),
            Number(label="y2", usual=(-1, 1), step=0.01),
            Number(label="ȳ3", low=1e-9, usual=(0.005, 1), log=True, reason=_IN_FRONT),
        ],
        about="the start (y1, y2, ybar3)",
    ),
    scale=Number(low=1e-3, high=1e3, usual=(0.5, 50), log=True, unit="1/m", label="true d_s", about="true d_s in 1/m"),
    v_c=_velocity("v_c", "true velocity of the camera in m/s", **_SPEED),
    v_p=_velocity("v_p", "true velocity of the object in m/s", **_SPEED),
    v_c_swing=_velocity("v_c", "how far the camera's velocity swings around it, in m/s", **_SWING),
    v_p_swing=_velocity("v_p", "how far the object's does", **_SWING),
    w=_velocity("w", "angular velocity in rad/s", usual=(-0.5, 0.5), unit="rad/s"),
    rate=Number(opening=1.0, low=0, high=10, usual=(0, 1), step=0.01, unit="rad/s", about="of the swing, in rad/s"),
    noise=noise(
        size=Number(low=0, high=1, usual=(0, 1e-3), step=5e-6, label="in y1, y2"),
        depth=Number(low=0, high=1, usual=(0, 1e-4), step=5e-7, label="in ȳ3"),
    ),
    bias=Number(low=-1, high=1, usual=(-0.01, 0.01), step=1e-4, label="bias of ȳ3", about="constant error of ybar3"),
    drift=Number(
        low=-1, high=1, usual=(-0.001, 0.001), step=1e-5, unit="1/s", label="drift of ȳ3", about="its error per second"
    ),
    seed=Number(opening=0, low=0, high=2**32 - 1, usual=(0, 100), step=1, whole=True, about="of the noise"),
    period=Number(opening=1e-3, low=1e-4, high=1, usual=(1e-4, 0.1), log=True, unit="s", about="seconds"),
    duration=Number(opening=3.0, low=0.1, high=100, usual=(1, 60), step=0.5, unit="s", about="seconds"),
    hold=Choice(opening="first", names=("zero", "first", "exact"), label="Hold"),
    step=Number(
        opening=1e-3,
        low=1e-5,
        high=0.1,
        usual=(1e-4, 0.01),
        log=True,
        unit="s",
        label="longest step",
        about="the observers' longest step in seconds",
    ),
    start=Choice(
        opening="zero", names=("own", "zero"), label="ŷ starts at", about='"own" for the first sample, or "zero"'
    ),
    tolerance=Number(
        opening=0.05, low=1e-6, high=10, usual=(1e-4, 1), log=True, about="the error of theta that counts as settled"
    ),
    pictures=Names(opening=["unknowns", "error", "determinant"], names=PICTURES, about="time charts that are shown"),
    kept=Optional(of=Whole(), about="None, or the settings of the run that is kept to compare with"),
)


STANDARD: Settings = SCHEMA.opening | case_of(1)
"""What every preset begins with."""
