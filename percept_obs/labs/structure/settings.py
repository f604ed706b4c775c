"""Settings of the lab of structure and motion."""

from dataclasses import replace

from percept_obs.labs.shared.common_settings import KEPT, SEED, noise
from percept_obs.labs.shared.schema import Choice, Flag, Group, Names, Number, Row, Schema, Settings, vector
from percept_obs.labs.shared.typed_motion import typed_setting
from percept_obs.labs.shared.view import view_of
from percept_obs.labs.structure.texts import OBSERVERS, case_of
from percept_obs.structure import QUANTITIES
from percept_obs.tracking.verdict import TOLERANCE

LOOKS = view_of(
    groups=("known", "observers", "gains", "scene", "camera", "run"),
    charts=("unknown1", "unknown2", "unknown3", "error", "image", "depth", "innovation", "determinant", "range"),
)
LONGEST = 100.0
"""Seconds that a run lasts at most."""

STANDARD_GAINS: dict[str, dict[str, float]] = {
    "extended_kalman": {"noise_variance": 1e-7, "hidden_process_noise": 1.0, "hidden_variance": 100.0},
    "identifier_based": {"bound": 1e3},
}
"""Gains that fit an unknown d_s, which is larger than the defaults expect."""


_IN_FRONT = "it must be positive, for the point is in front"
_SPEED: Settings = {"unit": "m/s", "usual": (-1, 1), "step": 0.01}
_SWING: Settings = {"unit": "m/s", "usual": (-0.5, 0.5), "step": 0.01}
_PLACE: Settings = {"usual": (-1, 1), "step": 0.01}
_CAMERA, _OBJECT = ([f"{letter}{axis}" for axis in (1, 2, 3)] for letter in ("v_c", "v_p"))

VELOCITIES = Choice(
    "set",
    ("set", "samples"),
    label="Velocities",
    about='"set" by the numbers and expressions here, or "samples", where you bring some',
)
"""Source of the true velocities, in a lab with samples."""

SCHEMA = Schema(
    unknown=Names([], QUANTITIES, 0, about=f"names of what is not known, of {', '.join(QUANTITIES)}"),
    earlier=Flag(about="whether a known d_s was estimated in an earlier stage, so that theta holds d_s v"),
    observers=Names(["ideal"], tuple(OBSERVERS), about="names"),
    gains=Group({}, about="for each observer, its gains by name"),
    ybar=Row(
        [
            *(Number(label=label, **_PLACE) for label in ("y1", "y2")),
            Number(0.05, 1e-9, 1e3, (0.005, 1), label="ȳ3", reason=_IN_FRONT),
        ],
        about="the start (y1, y2, ybar3)",
    ),
    scale=Number(1.0, 1e-3, 1e3, (0.5, 50), unit="1/m", label="true d_s"),
    v_c=vector(_CAMERA, "true velocity of the camera", **_SPEED),
    v_p=vector(_OBJECT, "true velocity of the object", **_SPEED),
    v_c_swing=vector(_CAMERA, "how far the camera's velocity swings around it", **_SWING),
    v_p_swing=vector(_OBJECT, "how far the object's does", **_SWING),
    w_c=vector(("w_c1", "w_c2", "w_c3"), "angular velocity of the camera", "rad/s", usual=(-0.5, 0.5), step=0.01),
    velocities=replace(
        VELOCITIES, names=("set",), reason='there is "samples" too where the lab is opened with rigid(..., times=times)'
    ),
    motion=typed_setting("v_c1 = 0.2 cos(t)^3; w_c3 = 0.1 sin(2t)"),
    rate=Number(1.0, 0, 10, (0, 1), 0.01, unit="rad/s", label="at a rate of", about="how fast velocities swing"),
    noise=noise(
        size=Number(0.0, 0, 1, (0, 1e-3), 5e-6, label="in y1, y2"),
        depth=Number(0.0, 0, 1, (0, 1e-4), 5e-7, label="in ȳ3"),
    ),
    bias=Number(0.0, -1, 1, (-0.01, 0.01), 1e-4, label="bias of ȳ3", topic="camera"),
    drift=Number(0.0, -1, 1, (-0.001, 0.001), 1e-5, unit="1/s", label="drift of ȳ3", topic="camera"),
    seed=SEED,
    period=Number(1e-3, 1e-4, 1, (1e-4, 0.1), unit="s"),
    duration=Number(3.0, 0.1, LONGEST, (1, 60), 0.5, unit="s"),
    hold=Choice("first", ("zero", "first", "exact")),
    step=Number(1e-3, 1e-5, 0.1, (1e-4, 0.01), unit="s", label="longest step", about="the observers' longest step"),
    start=Choice("zero", ("own", "zero"), label="ŷ starts at", about='"own" for the first sample, or "zero"'),
    tolerance=Number(TOLERANCE, 1e-6, 10, (1e-4, 1), about="the relative error that counts as settled", topic="run"),
    kept=KEPT,
)

STANDARD: Settings = SCHEMA.opening | case_of(1)
"""Settings of a lab that is given some."""

DRIVE: Settings = {
    **{"unknown": ["d_s", "v_c1", "v_c2", "v_c3"], "ybar": [0.75, 0.0, 0.25], "scale": 0.25},
    **{"v_c": [3.75, 0.0, 2.25], "v_p": [0.0, 0.0, 0.0], "duration": 4.0},
    "noise": {"kind": "uniform", "size": 2e-5, "depth": 2e-5},
    "gains": {"ideal": {"feedback": 2.0, "switching_gain": 6.0, "largest_amplification": 100.0}},
}
"""Settings of a lab that is given none, where they differ: a drive past a car of 4 m, of which only its rest is known.

ybar3 is the car's length in the image, and so d_s is one over its length.  The gains let no estimate pass that the
noise could spoil (`tolerable_amplification`).
"""
