"""The observer lab: a camera, a moving point, and observers that recover its distance while the hand moves."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from percept_obs.compile.integrator import LONGEST_STEP
from percept_obs.labs.observer.settings import HOLDS, PICTURES, SCENARIOS, SCHEMA, STANDARD, as_settings
from percept_obs.labs.observer.texts import SURFACES, form_of, key_of, observer_of, with_every_gain
from percept_obs.labs.observer.tracks import fitting, refused_for, track_for_the_page, with_affine_motion
from percept_obs.labs.observer.words import excitation_in_words, has_words, run_in_words
from percept_obs.labs.shared.lab import NOISES, Lab
from percept_obs.labs.shared.printed import part
from percept_obs.labs.shared.sampling import as_far_as_seen, exact_path, too_fast, too_short, within_reach
from percept_obs.labs.shared.schema import Choice, Schema, Settings, gains, standard_gains
from percept_obs.recording import Camera, Recording, Scenario
from percept_obs.system.motion import affine
from percept_obs.system.surfaces import BehindCamera, plane
from percept_obs.system.view import DISTANCE
from percept_obs.tracking.following import StepTooLong, track
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import REMEDY, for_the_page


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

    {settings}
    """

    schema = SCHEMA
    title = "One point, a camera, and observers"

    def __init__(
        self,
        scenario: str | Scenario | Recording = STANDARD["scenario"],
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
        known = {name: as_settings(s) for name, s in offered.items()}
        self._recordings = {name: with_affine_motion(name, r) for name, r in tracks.items()}
        names = Choice(STANDARD["scenario"], (*known, *self._recordings))
        self.schema = Schema(
            SCHEMA | {"scenario": names, "gains": gains(standard_gains("observer_lab"), with_every_gain)}
        )
        opening = str(names.read("scenario", scenario))
        fit = known.get(opening) or fitting(self._recordings[opening])
        super().__init__(
            "observer_lab",
            settings,
            {**STANDARD, "gains": self.schema["gains"].opening, **fit, "scenario": opening},
            STANDARD,
            scenarios={name: {"title": s.name, **known[name]} for name, s in offered.items()},
            recordings={n: track_for_the_page(r, tracks[n].motion.name) for n, r in self._recordings.items()},
            pictures=PICTURES,
            **for_the_page(),
            judged=DISTANCE,
            remedy=REMEDY,
        )

    def run(self) -> dict[str, Run]:
        """Runs of the same settings in Python, by the observers' names."""
        return runs(self.settings, self._recordings)

    def refuse(self, settings: Settings) -> None:
        """Raise a ValueError for settings that do not go together."""
        recording = self._recordings.get(settings["scenario"])
        surface, outputs = settings["surface"], settings["outputs"]
        allowed = part("observer_lab")["surfaces"][surface]["outputs"]
        if recording is not None:
            allowed = [o for o in allowed if set(o) <= set(recording.names)]
            Choice("zero", HOLDS[:2]).read("hold of a recording", settings["hold"])
        if outputs not in allowed:
            told = ", ".join(map(str, allowed))
            raise ValueError(f"outputs is {outputs!r}; on the {surface} surface it must be one of {told}")
        refused = dict(part("observer_lab", f"forms/{key_of(surface, outputs)}")["refused"])
        if recording is not None:
            refused |= refused_for(recording)
        for name in settings["observers"]:
            if name in refused:
                raise ValueError(f"{name} cannot be used here: {refused[name]}; choose another observer")
        if recording is not None and not recording.view.fits(SURFACES[surface]()):
            raise ValueError(f"the recording was seen on the {recording.view.name}, not on the {surface}")
        if recording is not None and settings["believed"] is not None:
            raise ValueError("a recording's motion varies and is measured; believed must be None with it")

    def analyse(self) -> Settings:
        """Sentences on excitation, error dynamics and the bias of noise for the present settings."""
        settings = self.settings
        seen = (settings["surface"], tuple(settings["outputs"]))
        observers = {name: (*seen, name, _way(settings, name)) for name in settings["observers"]}
        moved, refusal = 0.0, ""
        if settings["scenario"] not in self._recordings:
            fastest = float(np.abs(settings["A"]).sum(axis=1).max())
            moved = exact_path(settings["duration"], settings["period"], fastest)
            refusal = too_short(settings["duration"], settings["period"]) or too_fast(moved)
        if refusal:
            return {"sentences": [refusal]}
        try:
            recording = self._recordings.get(settings["scenario"]) or _simulated(settings)
        except BehindCamera as error:
            return {"sentences": [str(error)]}
        talked_of = {
            name: len(observer_of(*chosen).equations.state)
            for name, chosen in observers.items()
            if recording.truth is None or has_words(chosen)
        }
        steps = np.ptp(recording.time) / min(np.diff(recording.time).min(), LONGEST_STEP)
        told, beyond = within_reach(steps, talked_of, moved)
        window = min(settings["window"], float(np.ptp(recording.time)))
        sentences = [excitation_in_words(form_of(*seen), recording, window)]
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", StepTooLong)
            found = runs({**settings, "observers": told}, self._recordings)
        for name, run in found.items():
            sentences += run_in_words(observers[name], run, window)
        return {"sentences": [*sentences, *(str(warning.message) for warning in caught), *beyond]}


observer_lab = ObserverLab


def runs(settings: Settings, recordings: Mapping[str, Recording]) -> dict[str, Run]:
    """Runs that lab settings stand for, by the observers' names."""
    recording = recordings.get(settings["scenario"]) or _simulated(settings)
    believed = settings["believed"] and affine(settings["believed"]["A"], settings["believed"]["b"])
    start: Any = {"own": None, "zero": [0.0] * 3, "chosen": settings["start"]["values"]}[settings["start"]["mode"]]
    found = {}
    for name in settings["observers"]:
        observer = observer_of(settings["surface"], tuple(settings["outputs"]), name, _way(settings, name))
        values = settings["gains"][name]
        observer = observer.with_gains(**{gain.name: values[gain.name] for gain in observer.gains})
        found[name] = track(recording, observer, start, settings["hold"], believed or None, language="python")
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
    motion = affine(settings["A"], settings["b"])
    scenario = Scenario("the lab's", motion, settings["X0"], settings["duration"], surface)
    noise = NOISES[settings["noise"]["kind"]](settings["noise"]["size"])
    camera = Camera(settings["period"], noise, settings["dropout"])
    return as_far_as_seen(scenario, camera, settings["seed"])
