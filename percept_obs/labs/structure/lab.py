"""The lab of structure and motion: tick what you know, and see what can be estimated while it converges."""

from __future__ import annotations

import json
import warnings
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from percept_obs.compile import Array
from percept_obs.compile.integrator import LARGEST_STEP_RATE
from percept_obs.labs.shared.lab import NOISES, Lab
from percept_obs.labs.shared.printed import part
from percept_obs.labs.shared.sampling import as_far_as_seen, exact_path, looks, too_fast, too_short, within_reach
from percept_obs.labs.shared.schema import Schema, Settings, gains, standard_gains
from percept_obs.labs.structure.settings import PICTURES, SCHEMA, STANDARD, STANDARD_GAINS, VECTORS
from percept_obs.labs.structure.texts import LARGEST, OBSERVERS, PHASES, observer_of, swinging
from percept_obs.labs.structure.words import late_errors
from percept_obs.recording import Recording
from percept_obs.structure import (
    QUANTITIES,
    GivenDepth,
    ImpossibleChoice,
    ScaledDepthCamera,
    StructureAndMotion,
    StructureScenario,
)
from percept_obs.system.motion import Motion, rigid
from percept_obs.system.signal import OverTime, Signal
from percept_obs.system.surfaces import BehindCamera, pinhole
from percept_obs.system.view import DISTANCE
from percept_obs.tracking.following import TOO_LONG, StepTooLong, track
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import REMEDY, for_the_page

MOST_STEPS = 200_000
"""How many steps an observer takes at most, so that the page does not stand still."""


LOOK_WORK = 16
"""What a look at a motion that swings costs Python, as `MOST_WORK` counts; there are two paths."""


class StructureLab(Lab):
    """The lab of structure and motion; `settings` define everything, and may be set from Python as well.

    Unknowns that cannot be told apart are shown, with the reason.

    Parameters
    ----------
    **settings
        Those to open with, such as ``unknown=["v_p1", "v_p2", "v_p3"]``:

    {settings}
    """

    schema = SCHEMA
    title = "Structure and motion"

    def __init__(self, **settings: Any) -> None:
        standard = {name: own | STANDARD_GAINS.get(name, {}) for name, own in standard_gains("structure_lab").items()}
        self.schema = Schema(SCHEMA | {"gains": gains(standard, observer_of)})
        opening = {**STANDARD, "gains": self.schema["gains"].opening}
        super().__init__(
            "structure_lab",
            settings,
            opening,
            opening,
            pictures=PICTURES,
            **for_the_page(),
            judged=DISTANCE,
            remedy=REMEDY,
            tooLong=TOO_LONG,
            largestStepRate=LARGEST_STEP_RATE,
            mostSteps=MOST_STEPS,
        )

    def run(self) -> dict[str, Run]:
        """Runs of the same settings in Python, by the observers' names."""
        return runs(self.settings)

    def refuse(self, settings: Settings) -> None:
        """Raise a ValueError for settings that do not go together."""
        settings["unknown"].sort(key=QUANTITIES.index)
        steps = _steps(settings)
        if steps > MOST_STEPS:
            raise ValueError(
                f"{steps:.3g} steps are too many; shorten the duration, or take at most {MOST_STEPS} steps"
            )

    def analyse(self) -> Settings:
        """Sentences on the bias and the spread of the unknown quantities over the last tenth of the run."""
        settings = self.settings
        duration, fastest = settings["duration"], sum(sorted(map(abs, settings["w"]))[1:])
        moved = exact_path(duration, settings["period"], fastest)
        if _swings(settings):
            moved += LOOK_WORK * looks(duration, fastest, settings["rate"])
        if refusal := too_short(duration, settings["period"]) or too_fast(moved):
            return {"sentences": [refusal]}
        printed = part("structure_lab", f"forms/{LARGEST}")["observers"]
        states = {name: printed[name]["states"] for name in settings["observers"]}
        told, beyond = within_reach(_steps(settings), states, moved)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", StepTooLong)
                found = runs({**settings, "observers": told}) if told else {}
        except (BehindCamera, ImpossibleChoice) as error:
            return {"sentences": [str(error)]}
        lines = [line for name, run in found.items() for line in late_errors(OBSERVERS[name][0], run)]
        return {"sentences": [*lines, *beyond]}


structure_lab = StructureLab


def _steps(settings: Settings) -> float:
    return float(settings["duration"] / min(settings["period"], settings["step"]))


def unknowns_of(settings: Settings) -> StructureAndMotion:
    """What is unknown; what is known and stays 0 is known to be zero."""
    values = {
        f"{name}{axis}": settings[name][axis - 1] or settings[f"{name}_swing"][axis - 1]
        for name in ("v_c", "v_p")
        for axis in (1, 2, 3)
    }
    unknown = tuple(settings["unknown"])
    earlier = ("d_s",) if settings["earlier"] and "d_s" not in unknown else ()
    return StructureAndMotion(unknown, tuple(n for n, v in values.items() if v == 0 and n not in unknown), earlier)


def runs(settings: Settings) -> dict[str, Run]:
    """Runs that lab settings stand for, by the observers' names."""
    unknowns = unknowns_of(settings)
    recording = _recorded(settings, unknowns)
    start = {"y1": 0.0, "y2": 0.0, "ybar3": 0.0} if settings["start"] == "zero" else None
    found = {}
    for name in settings["observers"]:
        observer = OBSERVERS[name][1](unknowns.form).with_gains(**settings["gains"][name])
        found[name] = track(recording, observer, start, settings["hold"], step=settings["step"], language="python")
    return found


def _swings(settings: Settings) -> bool:
    return bool(settings["rate"] and np.any([settings[f"{name}_swing"] for name in PHASES]))


def motion_of(settings: Settings) -> Motion:
    """The true motion, constant unless a velocity swings."""
    around, swings = (np.ravel([settings[f"{name}{part}"] for name in PHASES]) for part in ("", "_swing"))

    def known(times: Array) -> Array:
        swung = swinging(around, swings, settings["rate"], _phases, times[:, None], np.sin)
        return np.hstack([np.tile(settings["w"], (len(times), 1)), swung])

    if _swings(settings):
        return replace(rigid(), signal=Signal(OverTime(known)))
    (still,) = known(np.zeros(1))
    return rigid(still[:3], still[3:6], still[6:])


_phases = np.array([*PHASES.values()], dtype=float).ravel()


def _recorded(settings: Settings, unknowns: StructureAndMotion) -> Recording:
    """What is measured, as far as the point stays in front of the camera."""
    keys = ("ybar", "scale", *VECTORS, "rate", "noise", "bias", "drift", "seed", "period", "duration")
    return _recorded_once(json.dumps({key: settings[key] for key in keys}), unknowns)


@lru_cache(maxsize=4)
def _recorded_once(text: str, unknowns: StructureAndMotion) -> Recording:
    settings = json.loads(text)
    (y1, y2, ybar3), scale = settings["ybar"], settings["scale"]
    depth = 1 / (scale * ybar3)
    place = (y1 * depth, y2 * depth, depth)
    scenario = StructureScenario(
        "the lab's", motion_of(settings), place, settings["duration"], pinhole(), scale=scale, choice=unknowns
    )
    make = NOISES[settings["noise"]["kind"]]
    source = GivenDepth(make(settings["noise"]["depth"]), settings["bias"], settings["drift"])
    camera = ScaledDepthCamera(settings["period"], make(settings["noise"]["size"]), depth=source)
    return as_far_as_seen(scenario, camera, settings["seed"])
