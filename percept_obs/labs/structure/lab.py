"""The lab of structure and motion: tick what you know, and see what can be estimated while it converges."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from percept_obs.compile import Array
from percept_obs.compile.integrator import LARGEST_STEP_RATE
from percept_obs.labs.shared.common_settings import gains, offering, own_gains
from percept_obs.labs.shared.lab import NOISES, OF_ONE_POINT, Lab, record_while_seen, refuse_observers
from percept_obs.labs.shared.printed import Texts, part, with_texts
from percept_obs.labs.shared.samples import samples_for_the_page
from percept_obs.labs.shared.schema import Schema, Settings, only
from percept_obs.labs.shared.typed_motion import Typed, read_motion
from percept_obs.labs.shared.user_observers import UserObserver, loops_for_the_page, read_observers, texts_of_observer
from percept_obs.labs.shared.work import motion_work, too_much, within_reach
from percept_obs.labs.structure.settings import DRIVE, LOOKS, SCHEMA, STANDARD, STANDARD_GAINS, VELOCITIES
from percept_obs.labs.structure.texts import BLOCKS, LARGEST, OBSERVERS, PHASES, general_form, observer_of, swinging
from percept_obs.labs.structure.user_defined import Given, opening_of, refuse_samples, zero_in
from percept_obs.observers import Observer
from percept_obs.recording import Recording
from percept_obs.structure import (
    QUANTITIES,
    GivenDepth,
    ImpossibleChoice,
    ScaledDepthCamera,
    StructureAndMotion,
    StructureScenario,
)
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.motion import Motion, rigid
from percept_obs.system.signal import OverTime, Signal
from percept_obs.system.surfaces import BehindCamera, pinhole
from percept_obs.tracking.following import TOO_LONG, StepTooLong, track
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import SETTLED_PART
from percept_obs.validation import TooMuchWork

MOST_STEPS = 200_000
"""Largest number of steps of an observer, so that the page stays responsive."""


class StructureLab(Lab):
    """The lab of structure and motion; `settings` define everything, and may be set from Python as well.

    Unknowns that cannot be told apart are shown, with the reason.

    Parameters
    ----------
    form : StructureAndMotion, its form, StructureScenario, or Motion, optional
        A choice or a scenario of your own, with which the lab opens, or the velocities of camera and object from
        `rigid`; without any argument it is a drive past a car.  Velocities that are sampled,
        ``rigid(..., times=times)``, can be chosen beside those that the lab sets; a scenario's functions of time are
        sampled every 10 ms.
    observers : list, optional
        Names, and observers of your own: functions of a form, such as `percept_obs.observers.family.family` makes.
    **settings
        Those to open with, such as ``unknown=["v_p1", "v_p2", "v_p3"]``:

    {settings}

    See Also
    --------
    observer_lab : A point with a known motion.

    Examples
    --------
    >>> from percept_obs.labs import structure_lab
    >>> lab = structure_lab(duration=5)
    >>> lab.settings["duration"]
    5.0

    Velocities that a robot has measured, in m/s at times in s that begin at 0:

    >>> import numpy as np
    >>> from percept_obs import rigid
    >>> times = np.linspace(0, 4, 41)
    >>> v_c = np.column_stack([np.sin(times), 0.2 + 0 * times, -0.1 * times])
    >>> lab = structure_lab(rigid(camera_velocity=v_c, times=times), unknown=["v_p1", "v_p2"])
    >>> lab.settings["velocities"], lab.settings["duration"]
    ('samples', 4.0)
    """

    schema = SCHEMA
    title = "Structure and motion"
    blocks = BLOCKS
    looks = LOOKS

    def __init__(self, form: Given | None = None, *, observers: Sequence[Any] | None = None, **settings: Any) -> None:
        self.idle = {
            **dict.fromkeys(("v_c", "v_p", "v_c_swing", "v_p_swing", "w_c"), only("velocities", "set")),
            "rate": lambda whole: "" if any(whole["v_c_swing"] + whole["v_p_swing"]) else "no velocity swings",
            "earlier": lambda whole: "d_s is unknown" if "d_s" in whole["unknown"] else "",
        }
        plain = form is None and observers is None and not set(settings) - set(self.looks)
        found, self._samples = (DRIVE if plain else {}, None) if form is None else opening_of(form)
        ours = {name: make for name, (_, make) in OBSERVERS.items()}
        asked, self._user_observers = (None, {}) if observers is None else read_observers(observers, ours)
        self._makers = {**ours, **self._user_observers}
        if asked is not None:
            settings["observers"] = asked
        self._added = _printed_with(self._user_observers)
        printed = self._part("")["observers"]
        standard = {name: values | STANDARD_GAINS.get(name, {}) for name, values in own_gains(printed).items()}
        named = offering(SCHEMA["observers"], printed)
        self.schema = Schema(
            SCHEMA
            | {"observers": named, "gains": gains(standard, self._observer_of)}
            | ({"velocities": VELOCITIES} if self._samples else {})
        )
        opening = {**STANDARD, "gains": self.schema["gains"].opening}
        super().__init__(
            "structure_lab",
            settings,
            opening | found,
            opening,
            texts=with_texts("structure_lab", self._added),
            own={name: make.for_the_page() for name, make in self._user_observers.items()},
            samples=self._samples and {**samples_for_the_page(self._samples), "zero": zero_in(self._samples)},
            drive=DRIVE,
            **OF_ONE_POINT,
            tooLong=TOO_LONG,
            largestStepRate=LARGEST_STEP_RATE,
            mostSteps=MOST_STEPS,
        )

    def runs(self, settings: Settings) -> dict[str, Run]:
        """Runs of settings, by the observers' names."""
        unknowns = unknowns_of(settings := self.check(settings), self._samples)
        recording = _recorded(settings, unknowns, _used(settings, self._samples))
        start = {"y1": 0.0, "y2": 0.0, "ybar3": 0.0} if settings["start"] == "zero" else None
        observers = {
            name: _made(self._makers[name], unknowns).with_gains(**settings["gains"][name])
            for name in settings["observers"]
        }
        return {
            name: track(recording, observer, start, settings["hold"], step=settings["step"], language="python")
            for name, observer in observers.items()
        }

    def _part(self, place: str) -> Texts:
        return self._added.get(place) or part("structure_lab", place)

    def _observer_of(self, name: str) -> Observer:
        return observer_of(name) if name in OBSERVERS else _example(self._user_observers[name])

    def refuse(self, settings: Settings) -> None:
        """Raise a ValueError for settings that do not go together."""
        settings["unknown"].sort(key=QUANTITIES.index)
        steps = _steps(settings)
        if steps > MOST_STEPS:
            raise ValueError(
                f"{steps:.3g} steps are too many; shorten the duration, or take at most {MOST_STEPS} steps"
            )
        if samples := _used(settings, self._samples):
            refuse_samples(samples, settings)
        if settings["motion"].strip():
            self.refuse_poles(settings, lambda times: _velocities(settings, times))
        count = len(settings["unknown"])
        refused = self._part(f"forms/{count}").get("refused", {}) if 1 <= count <= LARGEST else {}
        refuse_observers(settings, refused)

    def analyse(self) -> Settings:
        """Sentences on the bias and the spread of the unknown quantities over the last tenth of the run."""
        settings = self.settings
        motion = motion_of(settings, _used(settings, self._samples))
        work = motion_work(motion, settings["duration"], settings["period"])
        if refusal := too_much(work, settings["duration"], settings["period"]):
            return {"sentences": [refusal]}
        printed = self._part(f"forms/{LARGEST}")["observers"]
        states = {name: printed.get(name, {"states": 6})["states"] for name in settings["observers"]}
        followed, beyond = within_reach(_steps(settings), states, work)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", StepTooLong)
                found = self.runs({**settings, "observers": followed}) if followed else {}
        except (BehindCamera, ImpossibleChoice, TooMuchWork) as error:
            return {"sentences": [str(error)]}
        titles = {name: OBSERVERS[name][0] if name in OBSERVERS else run.observer.name for name, run in found.items()}
        lines = [line for name, run in found.items() for line in _late_errors(titles[name], run)]
        return {"sentences": [*lines, *beyond]}


structure_lab = StructureLab


def _late_errors(title: str, run: Run) -> list[str]:
    """Sentences on the errors of the unknown quantities over the last tenth of the run."""
    unknowns = run.recording.view
    assert isinstance(unknowns, StructureAndMotion)
    late = run.time >= run.time[-1] - SETTLED_PART * np.ptp(run.time)
    found, true = (unknowns.quantities(values[late, 3:]) for values in (run.estimate, run.truth))
    lines = []
    for name, values in found.items():
        error = (values - true[name])[np.isfinite(values)]
        unit = "1/m" if name == "d_s" else "m/s"
        if len(error):
            off = f"{error.mean():+.2g} {unit} on average and scatters by {error.std():.2g}"
            lines.append(f"{title}, last tenth of the run: {name} is off by {off}.")
        else:
            lines.append(f"{title}, last tenth of the run: no estimate of {name}.")
    return lines


def _example(make: UserObserver) -> Observer:
    """An observer of the first number of unknowns for which there is one."""
    forms = [general_form(count) for count in range(LARGEST, 0, -1)]
    refusals = [make.refusal(form) for form in forms]
    if all(refusals):
        raise ValueError(f"{make.name} cannot be used in this lab: {refusals[0]}")
    return make(forms[refusals.index("")])


def _printed_with(own: Mapping[str, UserObserver]) -> dict[str, Texts]:
    """Texts of the user's observers, in the places of the package's."""
    if not own:
        return {}
    model = part("structure_lab")
    texts = {name: texts_of_observer(make, {"": _example(make)}) for name, make in own.items()}
    found: dict[str, Texts] = {"": {**model, "observers": {**model["observers"], **texts}}}
    for count in range(1, LARGEST + 1):
        printed, added = part("structure_lab", f"forms/{count}"), loops_for_the_page(general_form(count), own)
        kernels = {name: next(iter(ways.values())) for name, ways in added["observers"].items()}
        found[f"forms/{count}"] = {
            **{**printed, "observers": {**printed["observers"], **kernels}},
            "refused": added["refused"],
        }
    return found


def _steps(settings: Settings) -> float:
    return float(settings["duration"] / min(settings["period"], settings["step"]))


def _used(settings: Settings, samples: Motion | None) -> Motion | None:
    """The sampled velocities if the settings use them, else None."""
    return samples if settings["velocities"] == "samples" else None


def unknowns_of(settings: Settings, samples: Motion | None = None) -> StructureAndMotion:
    """The choice of unknowns of settings; a known velocity that stays 0 is known to be zero."""
    values = {
        f"{name}{axis}": settings[name][axis - 1] or settings[f"{name}_swing"][axis - 1]
        for name in ("v_c", "v_p")
        for axis in (1, 2, 3)
    }
    if settings["motion"].strip():
        changed = read_motion(settings["motion"], BLOCKS).changed
        values |= {name: int(entry != 0) for name, entry in changed.items() if name in values}
    if used := _used(settings, samples):
        values = {name: int(name not in zero_in(used)) for name in values}
    unknown = tuple(settings["unknown"])
    earlier = ("d_s",) if settings["earlier"] and "d_s" not in unknown else ()
    return _choice(unknown, tuple(n for n, v in values.items() if v == 0 and n not in unknown), earlier)


_choice = lru_cache(maxsize=16)(StructureAndMotion)  # it keeps its form, whose derivation takes longer than a run


@lru_cache(maxsize=64)
def _made(make: Callable[[CanonicalForm], Observer], unknowns: StructureAndMotion) -> Observer:
    return make(unknowns.form)


def motion_of(settings: Settings, samples: Motion | None = None) -> Motion:
    """The true motion: the samples, or else constant unless a velocity swings or is given over time."""
    if samples:
        return samples
    typed = read_motion(settings["motion"], BLOCKS) if settings["motion"].strip() else None
    known = partial(_known, settings, typed)
    swings = settings["rate"] and np.any([settings[f"{name}_swing"] for name in PHASES])
    if swings or typed:
        return replace(rigid(), signal=Signal(OverTime(known, typed.breaks if typed else None)))
    (still,) = known(np.zeros(1))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # the controls say their units
        return rigid(camera_angular_velocity=still[:3], camera_velocity=still[3:6], point_velocity=still[6:])


def _known(settings: Settings, typed: Typed | None, times: Array) -> Array:
    rows = _velocities(settings, times)
    return typed.rows(times, rows) if typed else rows


def _velocities(settings: Settings, times: Array) -> Array:
    """Rows of w_c, v_c and v_p as numbers and swings set them, shape (T, 9)."""
    around, swings = (np.ravel([settings[f"{name}{part}"] for name in PHASES]) for part in ("", "_swing"))
    swung = swinging(around, swings, settings["rate"], _phases, times[:, None], np.sin)
    return np.hstack([np.tile(settings["w_c"], (len(times), 1)), swung])


_phases = np.array([*PHASES.values()], dtype=float).ravel()


def _recorded(settings: Settings, unknowns: StructureAndMotion, samples: Motion | None) -> Recording:
    """Recording of the camera, as far as the point stays in front of it."""
    (y1, y2, ybar3), scale = settings["ybar"], settings["scale"]
    depth = 1 / (scale * ybar3)
    place = (y1 * depth, y2 * depth, depth)
    scenario = StructureScenario(
        "the lab's", motion_of(settings, samples), place, settings["duration"], pinhole(), scale=scale, choice=unknowns
    )
    make = NOISES[settings["noise"]["kind"]]
    source = GivenDepth(make(settings["noise"]["depth"]), settings["bias"], settings["drift"])
    camera = ScaledDepthCamera(settings["period"], make(settings["noise"]["size"]), depth=source)
    return record_while_seen(scenario, camera, settings["seed"])
