"""What may be set in the lab of many points."""

from __future__ import annotations

from percept_obs.labs.points.texts import MOST_POINTS, STATES
from percept_obs.labs.shared.schema import (
    Choice,
    Names,
    Number,
    Optional,
    Row,
    Schema,
    Settings,
    Several,
    Whole,
    noise,
    vector,
)

PICTURES = ("error", "depth", "points", "gramian")
WEIGHTS = ("constant", "scheduled", "lyapunov", "riccati")
_SHARE: Settings = {"low": -10, "high": 10, "usual": (-2, 2), "step": 0.05}
_SIZE: Settings = {"opening": 1.0, "low": 1e-4, "high": 1e4, "usual": (0.001, 100), "log": True}
_TIMES = [Number(label=label, low=0, unit="s") for label in ("from", "to")]

SCHEMA = Schema(
    state=Choice(
        opening="body",
        names=tuple(STATES),
        about='"body" (r, d_2, ...), "independent" (X_1, X_2, ...) or "origin" (o, d_1, ...)',
    ),
    points=Several(
        opening=[[0.0, 1.2, 2.5], [0.5, 0.9, 2.9], [-0.5, 0.8, 2.7]],
        of=vector(("X", "Y", "Z"), unit="m"),
        most=MOST_POINTS,
        about="places of 1 to 8 points at time 0, in metres in the camera's frame",
    ),
    hidden=Several(
        opening=[None] * 3,
        of=Optional(of=Row(entries=_TIMES)),
        most=MOST_POINTS,
        about="for each point None, or when it is hidden: two times in seconds",
    ),
    turning=Number(
        opening=1.0, label="camera turns", about="share of the manoeuvre, as `Manoeuvre` takes it", **_SHARE
    ),
    spin=Number(label="body turns", about="share of it", **_SHARE),
    input=Number(opening=1.0, label="input", about="share of it", **_SHARE),
    velocity=vector(("X", "Y", "Z"), usual=(-1, 1), step=0.02, unit="m/s", about="constant part of v, in m/s"),
    weight=Choice(opening="constant", names=WEIGHTS, label="P is", about="P of the observer"),
    size=Number(label="P", about="P, or P at the beginning, times the identity", **_SIZE),
    final=Number(label="P at the end", about="P at the end, where it is scheduled", **_SIZE),
    decrease=Number(low=0, high=100, usual=(0, 0.5), step=0.005, unit="1/s", about="of a Lyapunov P, in 1/s"),
    forgetting=Number(
        opening=0.3, low=0, high=100, usual=(0, 2), step=0.02, unit="1/s", about="of a Riccati P, in 1/s"
    ),
    start=Choice(
        opening="rays",
        names=("rays", "error", "zero"),
        label="it starts",
        about='"rays" at a depth, "error" with a share of a given error, or "zero"',
    ),
    depth=Number(
        opening=1.5, low=0.01, high=100, usual=(0.5, 6), step=0.05, unit="m", label="at the depth", about="metres"
    ),
    error=Number(
        opening=1.0,
        low=-100,
        high=100,
        usual=(-3, 3),
        step=0.05,
        label="error, times the given",
        about="share of the given error",
    ),
    noise=noise(size=Number(low=0, high=1, usual=(0, 0.05), step=0.0005, label="bound or σ")),
    dropout=Number(low=0, high=0.95, usual=(0, 0.9), step=0.01, label="lost samples", about="share that is lost"),
    seed=Number(opening=0, low=0, high=2**32 - 1, usual=(0, 100), step=1, whole=True, about="of noise and losses"),
    period=Number(
        opening=0.05, low=5e-3, high=1, usual=(0.01, 0.2), log=True, unit="s", about="seconds between samples"
    ),
    view=Number(
        opening=2.0,
        low=0.1,
        high=100,
        usual=(0.2, 4),
        step=0.05,
        label="sees |y| up to",
        about="largest |y| that is seen",
    ),
    hold=Choice(opening="exact", names=("exact", "zero", "first"), label="Hold"),
    step=Number(
        opening=0.05,
        low=1e-3,
        high=0.1,
        usual=(0.002, 0.1),
        log=True,
        unit="s",
        label="longest step",
        about="the observer's longest step in seconds",
    ),
    duration=Number(opening=30.0, low=1, high=120, usual=(4, 60), step=1, unit="s", about="seconds that are shown"),
    window=Number(
        opening=8.0,
        low=0.1,
        high=120,
        usual=(0.5, 20),
        step=0.5,
        unit="s",
        label="window T",
        about="of the Gramian, in seconds",
    ),
    pictures=Names(opening=["error", "depth", "gramian"], names=PICTURES, about="time charts that are shown"),
    kept=Optional(of=Whole(), about="None, or the settings of the run that is kept to compare with"),
)
