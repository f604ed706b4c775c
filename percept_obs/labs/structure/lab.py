"""The lab of structure and motion: tick what you know, and see what can be estimated while it converges."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from functools import lru_cache, partial
from typing import Any

import numpy as np

from percept_obs.compile import vectorised
from percept_obs.labs.shared.checks import gains_of, known_names, number, numbers, one_of, some_of, whole_number
from percept_obs.labs.shared.lab import Lab, Settings
from percept_obs.labs.shared.printing import Printing
from percept_obs.labs.shared.sampling import samples_in_front
from percept_obs.labs.structure.texts import (
    CHOICES,
    OBSERVERS,
    PARTS,
    PHASES,
    SWING,
    SWINGING,
    choice_for_the_page,
    kernels_for_the_page,
    key_of,
    model_for_the_page,
    observer_of,
    refused,
)
from percept_obs.recording import Gaussian, Recording, Uniform, record
from percept_obs.structure import (
    COROLLARIES,
    QUANTITIES,
    GivenDepth,
    ImpossibleChoice,
    ScaledDepthCamera,
    StructureAndMotion,
    StructureScenario,
)
from percept_obs.structure.scenarios import chwa2019_experiment
from percept_obs.system.motion import Motion, rigid
from percept_obs.system.surfaces import BehindCamera, pinhole
from percept_obs.tracking.following import LARGEST_STEP_RATE, TOO_LONG, StepTooLong, track
from percept_obs.tracking.run import SETTLED_PART, VERDICTS, Run

NOISES: dict[str, Any] = {"uniform": Uniform, "gaussian": Gaussian}
HOLDS = ("zero", "first", "exact")
STARTS = ("own", "zero")
PICTURES = ("unknowns", "error", "image", "depth", "innovation", "determinant", "range")
RANGES = {
    "scale": (1e-3, 1e3),
    "rate": (0, 10),
    "period": (1e-4, 1),
    "step": (1e-5, 0.1),
    "duration": (0.1, 100),
    "tolerance": (1e-6, 10),
    "bias": (-1, 1),
    "drift": (-1, 1),
}
VECTORS = ("v_c", "v_p", "v_c_swing", "v_p_swing", "w")
MOST_STEPS = 200_000
"""How many steps an observer takes at most, so that the page does not stand still."""

PRINTING = Printing("percept_obs.labs.structure.texts")


class StructureLab(Lab):
    """The lab of structure and motion; `settings` define everything, and may be set from Python as well.

    Parameters
    ----------
    **settings
        Those to open with, such as ``unknown=["v_p1", "v_p2", "v_p3"]``:

    unknown : names of what is not known, of d_s, v_c1 to v_c3 and v_p1 to v_p3
    earlier : whether a known d_s was estimated in an earlier stage, so that theta holds d_s v
    observers : list of names
    gains : for each observer, its gains by name
    ybar, scale : the start (y1, y2, ybar3), and the true d_s in 1/m
    v_c, v_p, w : true velocities of camera and object in m/s, angular velocity in rad/s
    v_c_swing, v_p_swing, rate : how far the velocities swing around them, and how fast in rad/s
    noise : a mapping of its kind and its sizes, "size" in the image and "depth" in ybar3
    bias, drift : errors of ybar3, constant and per second
    seed, period, duration : the camera, in seconds
    hold, step : "zero", "first" or "exact", and the observers' longest step in seconds
    start : "own" for the first sample, or "zero"
    tolerance : the error of theta that counts as settled
    pictures : which time charts are shown
    kept : None, or the settings of the run that is kept to compare with

    Raises
    ------
    ValueError
        If a setting is unknown or makes no sense.  A choice that is impossible is shown, with the reason.
    """

    def __init__(self, **settings: Any) -> None:
        self._opening: Settings = _opening_settings()
        self._opening = self.check(self._opening | settings)
        super().__init__("structure_lab", self._model(), self._opening, PRINTING, PARTS)

    def run(self) -> dict[str, Run]:
        """Runs of the same settings in Python, by the observers' names.

        Raises
        ------
        ImpossibleChoice
            If the unknowns cannot be told apart.
        """
        return runs(self.settings)

    def check(self, settings: Settings) -> Settings:
        """Complete settings, or a ValueError that says what is wrong."""
        known_names(settings, self._opening)
        whole = self._opening | settings
        given = {name: {**STANDARD_GAINS.get(name, {}), **gains} for name, gains in whole["gains"].items()}
        whole["gains"] = gains_of(STANDARD_GAINS | given, {name: observer_of(name) for name in OBSERVERS})
        _check_choices(whole)
        _check_numbers(whole)
        if whole["kept"] is not None:
            whole["kept"] = self.check({**whole["kept"], "kept": None})
        return whole

    def analyse(self, summary: Settings) -> Settings:
        """Sentences on the bias and the spread of the unknown quantities over the last tenth of the run."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", StepTooLong)
                found = self.run()
        except (BehindCamera, ImpossibleChoice) as error:
            return {"sentences": [str(error)]}
        return {"sentences": [line for name, run in found.items() for line in _late_errors(OBSERVERS[name][0], run)]}

    def _model(self) -> Settings:
        shown = [self._opening, *filter(None, [self._opening["kept"]])]
        possible = [s for s in shown if key_of(s["unknown"], s["earlier"]) not in refused()] or [_opening_settings()]
        names = tuple(name for name in OBSERVERS if any(name in s["observers"] for s in possible))
        model = model_for_the_page()
        for corollary in model["corollaries"]:
            corollary["settings"] = case_of(corollary["number"])
        return {
            **model,
            CHOICES: {
                key_of(s["unknown"], s["earlier"]): choice_for_the_page(tuple(s["unknown"]), s["earlier"])
                for s in possible
            },
            "kernels": {len(s["unknown"]): kernels_for_the_page(len(s["unknown"]), names) for s in possible},
            "opening": self._opening,
            "standard": self.check(_opening_settings()),
            "pictures": PICTURES,
            "verdicts": dict(VERDICTS),
            "settledPart": SETTLED_PART,
            "tooLong": TOO_LONG,
            "largestStepRate": LARGEST_STEP_RATE,
            "mostSteps": MOST_STEPS,
            "ranges": RANGES,
        }


structure_lab = StructureLab


def choice_of(settings: Settings) -> StructureAndMotion:
    """What is unknown; what is known and stays 0 is known to be zero.

    Raises
    ------
    ImpossibleChoice
        If the unknowns cannot be told apart.
    """
    values = {
        f"{name}{axis}": settings[name][axis - 1] or settings[f"{name}_swing"][axis - 1]
        for name in ("v_c", "v_p")
        for axis in (1, 2, 3)
    }
    unknown = tuple(settings["unknown"])
    earlier = ("d_s",) if settings["earlier"] and "d_s" not in unknown else ()
    return StructureAndMotion(unknown, tuple(n for n, v in values.items() if v == 0 and n not in unknown), earlier)


def case_of(number: int) -> Settings:
    """Settings in which a corollary holds: the paper's values where it states some, and velocities that swing."""
    corollary = COROLLARIES[number - 1]
    choice = corollary.choice()
    fixed: Settings = {"unknown": list(choice.unknown), "earlier": "d_s" in choice.earlier, "w": [0.0] * 3}
    if number in (3, 5):
        swings = [[0.3, 0.3, -0.1], [0.2, 0.2, 0.1 if number == 5 else 0.0]]
        return fixed | {
            **{"ybar": [0.4, 0.4, 0.05], "scale": 4.0, "v_c": [0.0, 0.0, -0.3], "v_p": [0.0] * 3, "rate": 1.0},
            **{"v_c_swing": swings[0], "v_p_swing": swings[1]},
        }
    case = chwa2019_experiment(corollary.section)
    known = case.motion.known(0.0)[0].tolist()
    return fixed | {
        **{"ybar": [0.32, 0.3, 0.05], "scale": case.scale, "v_c": known[3:6], "v_p": known[6:]},
        **{"v_c_swing": [0.0] * 3, "v_p_swing": [0.0] * 3},
    }


def runs(settings: Settings) -> dict[str, Run]:
    """Runs that lab settings stand for, by the observers' names."""
    choice = choice_of(settings)
    recording = _recorded(settings, choice)
    start = {"y1": 0.0, "y2": 0.0, "ybar3": 0.0} if settings["start"] == "zero" else None
    found = {}
    for name in settings["observers"]:
        observer = OBSERVERS[name][1](choice.form).with_gains(**settings["gains"][name])
        found[name] = track(recording, observer, start, settings["hold"], step=settings["step"])
    return found


def motion_of(settings: Settings) -> Motion:
    """The true motion, constant unless a velocity swings."""
    if not settings["rate"] or not any([*settings["v_c_swing"], *settings["v_p_swing"]]):
        still = {n: [_component(settings, n, k, 0.0) for k in range(3)] for n in PHASES}
        return rigid(settings["w"], still["v_c"], still["v_p"])

    def velocity(name: str) -> Callable[[float], list[float]]:
        return lambda time: [_component(settings, name, k, time) for k in range(3)]

    return rigid(lambda _: settings["w"], velocity("v_c"), velocity("v_p"))


_swinging = vectorised(SWING, (SWINGING,))


def _component(settings: Settings, name: str, axis: int, time: float) -> float:
    swing, phase = settings[f"{name}_swing"][axis], float(PHASES[name][axis])
    return float(_swinging(settings[name][axis], swing, settings["rate"], phase, time)[0])


def _recorded(settings: Settings, choice: StructureAndMotion) -> Recording:
    """What is measured, as far as the point stays in front of the camera."""
    keys = ("ybar", "scale", *VECTORS, "rate", "noise", "bias", "drift", "seed", "period", "duration")
    return _recorded_once(json.dumps({key: settings[key] for key in keys}), choice)


@lru_cache(maxsize=4)
def _recorded_once(text: str, choice: StructureAndMotion) -> Recording:
    settings = json.loads(text)
    y1, y2, ybar3 = settings["ybar"]
    depth = 1 / (settings["scale"] * ybar3)
    position, duration = (y1 * depth, y2 * depth, depth), settings["duration"]
    scenario = StructureScenario(
        "the lab's", motion_of(settings), position, duration, pinhole(), scale=settings["scale"], choice=choice
    )
    make, period = NOISES[settings["noise"]["kind"]], settings["period"]
    depth = GivenDepth(make(settings["noise"]["depth"]), settings["bias"], settings["drift"])
    camera = ScaledDepthCamera(period, make(settings["noise"]["size"]), depth=depth)
    simulate = partial(record, scenario, camera=camera, seed=settings["seed"])
    try:
        return simulate(settings["duration"])
    except BehindCamera:
        times = period * np.arange(np.floor(settings["duration"] / period + 1e-9) + 1)
        return simulate(times[samples_in_front(scenario, times) - 1])


def _late_errors(title: str, run: Run) -> list[str]:
    """How far the estimates of the unknown quantities lie from the truth over the last tenth of the run."""
    choice = run.recording.view
    assert isinstance(choice, StructureAndMotion)
    late = run.time >= run.time[-1] - SETTLED_PART * np.ptp(run.time)
    found, true = (choice.quantities(values[late, 3:]) for values in (run.estimate, run.truth))
    lines = []
    for name, values in found.items():
        error = (values - true[name])[np.isfinite(values)]
        unit = "1/m" if name == "d_s" else "m/s"
        if len(error):
            told = f"{error.mean():+.2g} {unit} on average and scatters by {error.std():.2g}"
            lines.append(f"{title}, last tenth of the run: {name} is off by {told}.")
        else:
            lines.append(f"{title}, last tenth of the run: no estimate of {name}.")
    return lines


STANDARD_GAINS: dict[str, dict[str, float]] = {
    "extended_kalman": {"noise_variance": 1e-7, "hidden_process_noise": 1.0, "hidden_variance": 100.0},
    "identifier_based": {"bound": 1e3},
}
"""Gains that fit an unknown d_s, which is larger than what the observers were made for."""


def _opening_settings() -> Settings:
    return {
        **case_of(1),
        "rate": 1.0,
        "observers": ["ideal"],
        "gains": {},
        "noise": {"kind": "gaussian", "size": 0.0, "depth": 0.0},
        "bias": 0.0,
        "drift": 0.0,
        "seed": 0,
        "period": 1e-3,
        "duration": 3.0,
        "hold": "first",
        "step": 1e-3,
        "start": "zero",
        "tolerance": 0.05,
        "pictures": ["unknowns", "error", "determinant"],
        "kept": None,
    }


def _check_choices(settings: Settings) -> None:
    unknown = settings["unknown"]
    if len(set(unknown)) != len(unknown) or not set(unknown) <= set(QUANTITIES):
        raise ValueError(f"unknown is {unknown!r}; it names some of {', '.join(QUANTITIES)}, each once")
    settings["unknown"] = sorted(unknown, key=QUANTITIES.index)
    if not isinstance(settings["earlier"], bool):
        raise ValueError(f"earlier is {settings['earlier']!r}; it must be True or False")
    some_of(settings, "observers", OBSERVERS)
    some_of(settings, "pictures", PICTURES)
    one_of({"noise kind": settings["noise"].get("kind")}, "noise kind", NOISES)
    one_of(settings, "hold", HOLDS)
    one_of(settings, "start", STARTS)


def _check_numbers(settings: Settings) -> None:
    for key in ("ybar", *VECTORS):
        numbers(settings, key, (3,))
    if not settings["ybar"][2] > 0:
        raise ValueError(f"ybar3 starts at {settings['ybar'][2]}; it must be positive, for the point is in front")
    for size in ("size", "depth"):
        number({f"noise {size}": settings["noise"].get(size)}, f"noise {size}", 0, 1)
    for key, (low, high) in RANGES.items():
        number(settings, key, low, high)
    steps = settings["duration"] / min(settings["period"], settings["step"])
    if steps > MOST_STEPS:
        raise ValueError(f"{steps:.3g} steps are too many; shorten the duration, or take at most {MOST_STEPS} steps")
    whole_number(settings)
