"""Settings of the lab of many points."""

from percept_obs.labs.points.texts import MOST_POINTS, STATES
from percept_obs.labs.points.typed_weight import MOST_OF_P
from percept_obs.labs.shared.common_settings import AT_LEAST, DROPOUT, KEPT, SEED, noise
from percept_obs.labs.shared.schema import Choice, Number, Optional, Row, Schema, Settings, Several, Text, vector
from percept_obs.labs.shared.typed_motion import typed_setting
from percept_obs.labs.shared.view import view_of

LOOKS = view_of(
    groups=("points", "weight", "motion", "start", "camera"), charts=("error", "points", "depth", "gramian")
)
WEIGHTS = ("constant", "scheduled", "typed", "lyapunov", "riccati")
LONGEST = 120.0
"""Seconds that a run lasts at most."""

_SHARE: Settings = {"low": -10, "high": 10, "usual": (-2, 2), "step": 0.05}
_SIZE = (1.0, 1e-4, 1e4, (0.001, 100))
_PLACES = [[0.0, 1.2, 2.5], [0.5, 0.9, 2.9], [-0.5, 0.8, 2.7]]
_TIMES = [Number(label=label, low=0, unit="s") for label in ("from", "to")]

SCHEMA = Schema(
    state=Choice(
        "body", tuple(STATES), about='"body" (r, d_2, ...), "independent" (X_1, ...) or "origin" (o, d_1, ...)'
    ),
    points=Several(_PLACES, vector(("X", "Y", "Z")), MOST_POINTS, unit="m", about="places of the points at time 0"),
    hidden=Several(
        [None] * 3, Optional(Row(_TIMES)), MOST_POINTS, unit="s", about="None for each, or from when to when"
    ),
    turning=Number(
        1.0, label="camera turns", about="share of the manoeuvre's turning, as `Manoeuvre` takes it", **_SHARE
    ),
    spin=Number(label="body turns", about="share of the body's turning", **_SHARE),
    input=Number(1.0, about="share of the input", **_SHARE),
    camera_velocity=vector(("X", "Y", "Z"), "constant part of v_c", "m/s", usual=(-1, 1), step=0.02),
    motion=typed_setting("w_c = [0, 0.3 cos(t), 0.2]; v_c1 = v_c1 + 0.5 sin(2t)"),
    weight=Choice("constant", WEIGHTS, label="P is"),
    size=Number(*_SIZE, label="P", about="P, or P at the beginning, times the identity"),
    final=Number(*_SIZE, label="P at the end"),
    P=Text(
        "P = 1 + exp(-t)",
        MOST_OF_P,
        label="P over time: a number or a diagonal",
        about="P over time: a number, or a diagonal of three for each vector of three states; P stands for `size`",
    ),
    P0=Text(
        "",
        MOST_OF_P,
        label="P at the beginning: a diagonal",
        about="a Lyapunov or Riccati P at the beginning, given like P; empty for `size` times the identity",
    ),
    decrease=Number(0.0, 0, 100, (0, 0.5), 0.005, unit="1/s", about="of a Lyapunov P"),
    forgetting=Number(0.3, 0, 100, (0, 2), 0.02, unit="1/s", about="of a Riccati P"),
    start=Choice(
        "rays", ("rays", "error", "zero"), label="it starts", about='on "rays", with an "error", or at "zero"'
    ),
    depth=Number(1.5, 0.01, 100, (0.5, 6), 0.05, unit="m", label="at the depth", about="where rays start"),
    error=Number(1.0, -100, 100, (-3, 3), 0.05, label="error, times the given", about="share of a given error"),
    noise=noise(size=Number(0.0, 0, 1, (0, 0.05), 0.0005, label="bound or σ")),
    seed=SEED,
    period=Number(0.04, 5e-3, 1, (0.01, 0.2), unit="s", topic="camera"),
    dropout=DROPOUT,
    view=Number(2.0, 0.1, 100, (0.2, 4), 0.05, label="sees |y| up to", topic="camera"),
    hold=Choice("zero", ("zero", "first", "exact")),
    step=Number(
        0.05,
        1e-3,
        0.1,
        (0.002, 0.1),
        unit="s",
        label="longest step",
        about="the observer's longest step",
        topic="weight",
    ),
    duration=Number(30.0, 1, LONGEST, (4, 60), 1, unit="s"),
    window=Number(
        8.0,
        0.1,
        120,
        (0.5, 20),
        0.5,
        unit="s",
        label="window T",
        about=f"window of the Gramian, {AT_LEAST}",
        topic="charts",
    ),
    kept=KEPT,
)

DRIVE: Settings = {
    "points": [[1.3, -3.1, 8.0], [-2.3, -3.1, 7.1], [1.0, -3.1, 4.3]],
    "turning": 0.0,
    "input": 0.0,
    "camera_velocity": [5.5, 0.0, 0.0],
    "motion": "w_c2 = -0.05 cos(1.3t) - v_c1/6; w_b = [0, 2 w_b3 cos(t), 0]",
    "size": 1.66667,
    "start": "error",
    "error": 2.5,
    "hold": "first",
    "duration": 10.0,
    "window": 10.0,
}
"""Settings of a lab that is given none, where they differ: round a resting aeroplane, and turning with the travel.

Its marks are the nose, the left and the right wing tip.  How it heads decides how much the travel tells of it: headed
like this, its estimate is 0.04 m off after 10 s.
"""
