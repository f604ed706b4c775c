"""The observer lab: a camera, a moving point, and observers that recover its distance while the hand moves."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping
from functools import lru_cache, partial
from typing import Any

import numpy as np

from percept_obs.labs.observer.texts import (
    BY_NAME,
    OWN_SWITCH,
    SURFACES,
    WAYS,
    form_of,
    key_of,
    keys,
    model_for_the_page,
    observer_of,
    structure_for_the_page,
    system_of,
    ways_of,
)
from percept_obs.labs.observer.tracks import track_for_the_page, with_affine_motion
from percept_obs.labs.observer.words import excitation_in_words, has_words, run_in_words
from percept_obs.labs.shared.checks import gains_of, known_names, number, numbers, one_of, some_of, whole_number
from percept_obs.labs.shared.kernels import with_all_gains
from percept_obs.labs.shared.lab import Lab, Settings
from percept_obs.labs.shared.printing import Printing
from percept_obs.labs.shared.sampling import samples_in_front
from percept_obs.recording import Camera, Gaussian, Recording, Scenario, Uniform, record, scenarios
from percept_obs.system.motion import affine
from percept_obs.system.surfaces import BehindCamera, plane
from percept_obs.tracking.following import StepTooLong, track
from percept_obs.tracking.run import SETTLED_PART, VERDICTS, Run

SCENARIOS = {make.__name__: make for make in (scenarios.ma2005_eq35, scenarios.ma2005_eq36, scenarios.planar)}
NOISES: dict[str, Any] = {"uniform": Uniform, "gaussian": Gaussian}
HOLDS = ("zero", "first", "exact")
STARTS = ("own", "zero", "chosen")
RANGES = {"dropout": (0, 0.95), "period": (1e-3, 1), "duration": (0.1, 200), "window": (0.1, 200), "threshold": (0, 10)}
PRINTING = Printing("percept_obs.labs.observer.texts")
PICTURES = ("outputs", "inverse", "distance", "error", "excitation")


class ObserverLab(Lab):
    """The observer lab, shown by the page; `settings` define everything, and may be set from Python as well.

    Parameters
    ----------
    scenario : str, Scenario or Recording
        What to open with: the name of a scenario, or one of your own; its motion must be constant.
    recordings : mapping of names to recordings, optional
        Tracks of a real camera that can be chosen as well.
    **settings
        Those to open with, such as ``outputs=["y1"]``:

    duration : seconds
    surface, normal : "pinhole", "chained" or "plane", and the plane's normal vector
    outputs, observers : lists of names
    gains : for each observer, its gains by name
    switches : for each observer that switches, how
    A, b, X0 : the true motion X' = A X + b and the point at time 0
    believed : None, or a mapping with the A and the b that the observers believe
    noise, dropout, seed, period : the camera; noise is a mapping of kind and size
    hold : "zero", "first" or "exact"
    start : a mapping of mode ("own", "zero", "chosen") and the chosen values
    window, threshold : seconds over which w w^T is gathered, and the |w| below which an instant tells too little
    pictures : which time charts are shown
    kept : None, or the settings of the run that is kept to compare with

    Raises
    ------
    ValueError
        If a setting is unknown or makes no sense.
    """

    def __init__(
        self,
        scenario: str | Scenario | Recording = "ma2005_eq35",
        recordings: Mapping[str, Recording] | None = None,
        **settings: Any,
    ) -> None:
        offered = {name: make() for name, make in SCENARIOS.items()}
        tracks = dict(recordings or {})
        if isinstance(scenario, Scenario):
            offered[scenario.name] = scenario
            scenario = scenario.name
        elif isinstance(scenario, Recording):
            tracks[scenario.source or "recording"] = scenario
            scenario = scenario.source or "recording"
        self._scenarios = {name: {"title": s.name, **_as_settings(s)} for name, s in offered.items()}
        self._recordings = {name: with_affine_motion(name, r) for name, r in tracks.items()}
        self._tracks = {
            name: {**track_for_the_page(r), **_fitting(r), "kind": tracks[name].motion.name, "refused": _refused(r)}
            for name, r in self._recordings.items()
        }
        one_of({"scenario": scenario}, "scenario", [*self._scenarios, *self._recordings])
        fit = dict(self._scenarios.get(scenario) or _fitting(self._recordings[scenario]))
        fit.pop("title", None)
        self._opening: Settings = {**_opening_settings(), **fit, "scenario": scenario}
        self._opening = self.check(self._opening | settings)
        near = sorted(keys(), key=lambda key: key.split()[0] != self._opening["surface"])
        here = key_of(self._opening["surface"], self._opening["outputs"])
        parts = sorted(near, key=lambda key: key != here)
        super().__init__("observer_lab", self._model(), self._opening, PRINTING, parts)

    def run(self) -> dict[str, Run]:
        """Runs of the same settings in Python, by the observers' names."""
        return runs(self.settings, self._recordings)

    def check(self, settings: Settings) -> Settings:
        """Complete settings, or a ValueError that says what is wrong."""
        known_names(settings, self._opening)
        whole = self._opening | settings
        recording = self._recordings.get(one_of(whole, "scenario", [*self._scenarios, *self._recordings]))
        whole["gains"] = gains_of(whole["gains"], {name: with_all_gains(ways_of(name)) for name in BY_NAME})
        whole["switches"] = _checked_switches(whole["switches"])
        _check_choices(whole, recording)
        _check_numbers(whole)
        if whole["kept"] is not None:
            whole["kept"] = self.check({**whole["kept"], "kept": None})
        return whole

    def analyse(self, summary: Settings) -> Settings:
        """Sentences on excitation, error dynamics and the bias of noise for the present settings."""
        settings = self.settings
        place = (settings["surface"], tuple(settings["outputs"]))
        structures = {name: (*place, name, _way(settings, name)) for name in settings["observers"]}
        told = [name for name, structure in structures.items() if has_words(structure)]
        try:
            recording = self._recordings.get(settings["scenario"]) or _simulated(settings)
        except BehindCamera as error:
            return {"sentences": [str(error)]}
        window = min(settings["window"], float(np.ptp(recording.time)))
        sentences = [excitation_in_words(form_of(*place), recording, window)]
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", StepTooLong)
            found = runs({**settings, "observers": told}, self._recordings)
        for name, run in found.items():
            sentences += run_in_words(structures[name], run, window)
        return {"sentences": [*sentences, *(str(warning.message) for warning in caught)]}

    def _model(self) -> Settings:
        return {
            **model_for_the_page(),
            "structures": self._structures_of_the_opening(),
            "scenarios": self._scenarios,
            "recordings": self._tracks,
            "opening": self._opening,
            "standard": self.check(_opening_settings()),
            "pictures": PICTURES,
            "verdicts": dict(VERDICTS),
            "settledPart": SETTLED_PART,
        }

    def _structures_of_the_opening(self) -> Settings:
        """Structures with the observers that are shown first; the whole ones follow as parts."""
        shown = [self._opening, *filter(None, [self._opening["kept"]])]
        structures: Settings = {}
        for settings in shown:
            place = (settings["surface"], tuple(settings["outputs"]))
            chosen = [(name, _way(s, name)) for s in shown for name in s["observers"]]
            structures[key_of(*place)] = structure_for_the_page(*place, tuple(dict.fromkeys(chosen)))
        return structures


observer_lab = ObserverLab


def runs(settings: Settings, recordings: Mapping[str, Recording]) -> dict[str, Run]:
    """Runs that lab settings stand for, by the observers' names."""
    recording = recordings.get(settings["scenario"]) or _simulated(settings)
    believed = settings["believed"] and affine(settings["believed"]["A"], settings["believed"]["b"])
    start: Any = {"own": None, "zero": [0.0] * 3, "chosen": settings["start"]["values"]}[settings["start"]["mode"]]
    found = {}
    for name in settings["observers"]:
        observer = observer_of(settings["surface"], tuple(settings["outputs"]), name, _way(settings, name))
        gains = settings["gains"][name]
        observer = observer.with_gains(**{gain.name: gains[gain.name] for gain in observer.gains})
        found[name] = track(recording, observer, start, settings["hold"], believed or None)
    return found


def _way(settings: Settings, name: str) -> str:
    """How an observer switches; nothing if it does not."""
    return str(settings["switches"].get(name, ""))


def _simulated(settings: Settings) -> Recording:
    """What the camera records, as far as the point stays in front of it."""
    keys = ("surface", "normal", "A", "b", "X0", "noise", "dropout", "seed", "period", "duration")
    return _simulated_once(json.dumps({key: settings[key] for key in keys}))


@lru_cache(maxsize=4)
def _simulated_once(text: str) -> Recording:
    settings = json.loads(text)
    surface = plane(settings["normal"]) if settings["surface"] == "plane" else SURFACES[settings["surface"]]()
    scenario = Scenario(
        "the lab's", affine(settings["A"], settings["b"]), settings["X0"], settings["duration"], surface
    )
    noise: Uniform | Gaussian = NOISES[settings["noise"]["kind"]](settings["noise"]["size"])
    camera = Camera(settings["period"], noise, settings["dropout"])
    simulate = partial(record, scenario, camera=camera, seed=settings["seed"])
    try:
        return simulate(settings["duration"])
    except BehindCamera:
        times = camera.period * np.arange(np.floor(settings["duration"] / camera.period + 1e-9) + 1)
        return simulate(times[samples_in_front(scenario, times) - 1])


def _fitting(recording: Recording) -> Settings:
    """Settings that a recording brings with it."""
    duration = float(np.ptp(recording.time))
    surface = next(kind for kind in SURFACES if recording.view.fits(SURFACES[kind]()))
    return {"surface": surface, "outputs": list(recording.names), "duration": duration, "window": min(duration, 2.0)}


def _refused(recording: Recording) -> dict[str, str]:
    """Observers that cannot follow this recording, with the reasons."""
    signal = recording.motion.signal
    if signal is None or signal.constant:
        return {}
    reason = "it needs a motion with constant coefficients, but the recording's varies"
    return {name: reason for name, make in BY_NAME.items() if make.constant_motion}


def _as_settings(scenario: Scenario) -> Settings:
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


def _opening_settings() -> Settings:
    return {
        "scenario": "ma2005_eq35",
        **_as_settings(scenarios.ma2005_eq35()),
        "normal": [0.0, 0.0, 1.0],
        "outputs": ["y1", "y2"],
        "observers": ["identifier_based"],
        "gains": {},
        "switches": {},
        "believed": None,
        "noise": {"kind": "uniform", "size": 0.0},
        "dropout": 0.0,
        "seed": 0,
        "period": 0.01,
        "hold": "zero",
        "start": {"mode": "own", "values": [0.0, 0.0, 0.0]},
        "window": 10.0,
        "threshold": 0.1,
        "pictures": ["distance", "error", "excitation"],
        "kept": None,
    }


def _checked_switches(given: Mapping[str, str]) -> dict[str, str]:
    unknown = sorted(set(given) - set(OWN_SWITCH))
    if unknown:
        raise ValueError(f"{', '.join(unknown)} does not switch; {', '.join(OWN_SWITCH)} do")
    whole = {**OWN_SWITCH, **given}
    return {name: one_of({f"switch of {name}": way}, f"switch of {name}", WAYS[name]) for name, way in whole.items()}


def _check_choices(settings: Settings, recording: Recording | None) -> None:
    surface = one_of(settings, "surface", SURFACES)
    offered = [o for o in system_of(surface).output_choices if recording is None or set(o) <= set(recording.names)]
    if tuple(settings["outputs"]) not in offered:
        raise ValueError(
            f"outputs is {settings['outputs']!r}; it must be one of {', '.join(map(str, map(list, offered)))}"
        )
    some_of(settings, "pictures", PICTURES)
    refused = {} if recording is None else _refused(recording)
    for name in some_of(settings, "observers", BY_NAME):
        if name in refused:
            raise ValueError(f"{name} cannot follow this recording: {refused[name]}")
        observer_of(surface, tuple(settings["outputs"]), name, _way(settings, name))
    one_of({"noise kind": settings["noise"].get("kind")}, "noise kind", NOISES)
    one_of({"start mode": settings["start"].get("mode")}, "start mode", STARTS)
    one_of(settings, "hold", HOLDS if recording is None else HOLDS[:2])
    if recording is not None and not recording.view.fits(SURFACES[surface]()):
        raise ValueError(f"the recording was seen on the {recording.view.name}, not on the {surface}")
    if recording is not None and settings["believed"] is not None:
        raise ValueError("a recording's motion varies and is measured; believed must be None with it")


def _check_numbers(settings: Settings) -> None:
    for key, shape in (("A", (3, 3)), ("b", (3,)), ("X0", (3,)), ("normal", (3,))):
        numbers(settings, key, shape)
    if settings["normal"][2] == 0:
        raise ValueError("the normal's third entry is 0; the plane must not hold the optical axis")
    for key, shape in (("A", (3, 3)), ("b", (3,))) if settings["believed"] else ():
        numbers(settings["believed"], key, shape)
    numbers(settings["start"], "values", (3,))
    number({"noise size": settings["noise"].get("size")}, "noise size", 0, 1)
    for key, (low, high) in RANGES.items():
        number(settings, key, low, high)
    whole_number(settings)
