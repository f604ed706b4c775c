"""The observer lab: a camera, a moving point, and observers that recover its distance while the hand moves."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import traitlets

from percept_obs.compile.integrator import LONGEST_STEP
from percept_obs.labs.observer.analysis import excitation_in_words, has_words, run_in_words
from percept_obs.labs.observer.registry import refuse_other_motion, registry_of, view_of, with_numbers
from percept_obs.labs.observer.settings import DRIVE, HOLDS, LOOKS, SCENARIOS, SCHEMA, STANDARD, as_settings, schema_of
from percept_obs.labs.observer.texts import BLOCKS, BY_NAME, MOTION, RADIUS, SIZE
from percept_obs.labs.observer.tracks import (
    VARIES,
    fitting,
    refused_for,
    table_of,
    track_for_the_page,
    tracks_of,
    typed_text,
    with_affine_motions,
)
from percept_obs.labs.shared.common_settings import window_in
from percept_obs.labs.shared.lab import NOISES, OF_ONE_POINT, Lab, record_while_seen, refuse_observers
from percept_obs.labs.shared.samples import table_for_the_page
from percept_obs.labs.shared.schema import Choice, Settings, in_run, only
from percept_obs.labs.shared.surfaces import SHAPES, numbers_of, shaped_surface
from percept_obs.labs.shared.typed_motion import read_motion
from percept_obs.labs.shared.user_observers import read_observers
from percept_obs.labs.shared.work import motion_work, too_much, within_reach
from percept_obs.observability.bound import HIDDEN_VARIANCE
from percept_obs.observers import Observer
from percept_obs.recording import Camera, Frames, Recording, Scenario
from percept_obs.recording.footage import Footage
from percept_obs.system.apparent_size import sized
from percept_obs.system.motion import Motion, affine
from percept_obs.system.signal import OverTime, Signal
from percept_obs.system.surfaces import BehindCamera, ImagingSurface
from percept_obs.tracking.following import StepTooLong, track
from percept_obs.tracking.run import Run
from percept_obs.validation import TooMuchWork, checked, listed


class ObserverLab(Lab):
    """The observer lab, shown by the page; `settings` define everything, and may be set from Python as well.

    Parameters
    ----------
    scenario : str, Scenario, Recording or Footage
        Opens the lab: the name of a scenario, or one of your own; without any argument it is a drive past a point.
        A motion in expressions of time becomes the setting `motion`; one that is sampled, or a function, is taken as
        samples that stay as they are after the last one.  Of a film, such as one of `percept_obs.film.read_film`, the
        lab offers up to 12 tracks, and opens with the longest one with a truth, the film behind it, and an extended
        Kalman filter.
    recordings : mapping of names to recordings, optional
        Tracks of a real camera that can be chosen as well.
    observers : list, optional
        Names, and observers of your own: functions of a form such as `percept_obs.observers.family.family` makes, or
        an `Observer` of the one form that it is made for.
    frames : Frames, or mapping of names of recordings to Frames, optional
        A film behind the track of the recording that it opens with, or of others.
    surface : str or ImagingSurface, optional
        The name of an imaging surface, or one of your own, or a function that gives it.
    **settings
        Those to open with, such as ``outputs=["y1"]``:

    {settings}

    See Also
    --------
    points_lab, structure_lab : Other labs.

    Examples
    --------
    >>> from percept_obs.labs import observer_lab
    >>> lab = observer_lab(outputs=["y1"])
    >>> lab.settings["outputs"], lab.settings["duration"]
    (['y1'], 80.0)
    """

    schema = SCHEMA
    title = "One point, a camera, and observers"
    blocks = BLOCKS
    looks = LOOKS
    frames: Any = traitlets.List(help="Films behind tracks, their frames as PNG or JPEG files.").tag(sync=True)

    @checked
    def __init__(
        self,
        scenario: str | Scenario | Recording | Footage | None = None,
        recordings: Mapping[str, Recording] | None = None,
        *,
        observers: Any = None,
        surface: Any = None,
        frames: Frames | Mapping[str, Frames] | None = None,
        **settings: Any,
    ) -> None:
        scenes = {name: make() for name, make in SCENARIOS.items()}
        tracks, observers = dict(recordings or {}), listed(observers)
        films: dict[str, Frames] = {}
        if scenario is None:
            plain = not (set(settings) - set(self.looks) or tracks or observers or surface)
            settings, scenario = (DRIVE | settings, "drive") if plain else (settings, STANDARD["scenario"])
        if isinstance(scenario, Scenario):
            scenes[scenario.name] = scenario
            scenario = scenario.name
        elif isinstance(scenario, Recording):
            tracks[scenario.source or "recording"] = scenario
            scenario = scenario.source or "recording"
        elif isinstance(scenario, Footage):
            film, (scenario, shown) = scenario.frames, tracks_of(scenario)
            tracks, films = tracks | shown, dict.fromkeys(shown, film)
            observers = ["extended_kalman"] if observers is None else observers
            settings = {"gains": {"extended_kalman": _gains_for(shown[scenario])}} | settings
        films |= {scenario: frames} if isinstance(frames, Frames) else frames or {}
        for name, film in films.items():
            _refuse_other_times(name, film, tracks)
        if same := sorted(set(scenes) & set(tracks)):
            raise ValueError(f"a recording and a scenario have the name {same[0]!r}; give the recording another name")
        asked, users = (None, {}) if observers is None else read_observers(observers, BY_NAME)
        refuse_other_motion(users)
        if surface is None and (view := view_of(users)):
            surface, outputs = view
            settings = {"outputs": outputs, **settings}
        given = [] if surface is None or isinstance(surface, str) else [surface]
        seen = [*given, *(s.surface for s in scenes.values()), *(_seen_on(n, r) for n, r in tracks.items())]
        self._registry, names = registry_of(seen, users, asked or STANDARD["observers"])
        if given:
            shape = numbers_of(given[0], names[0]) if isinstance(given[0], ImagingSurface) else {}
            settings = shape | settings
            surface = names[0]
        on = dict(zip((*scenes, *tracks), names[len(given) :], strict=True))
        self._tables = {n: t for n, s in scenes.items() if not typed_text(s.motion) and (t := table_of(s))}
        known = {n: {"motion": typed_text(s.motion), **as_settings(s, on[n])} for n, s in scenes.items()}
        self._recordings = with_affine_motions(tracks, {n: self._registry.surfaces[on[n]] for n in tracks})
        self.schema = schema_of(self._registry, {**known, **tracks})
        of_camera = dict.fromkeys(("X0", "duration", "noise", "seed", "period", "dropout"), only("scenario", *scenes))
        of_motion = dict.fromkeys("Ab", only("scenario", *(name for name in scenes if name not in self._tables)))
        shaped = {"normal": only("surface", "plane"), "xi": only("surface", "unified")}
        self.idle = of_camera | of_motion | shaped | {"window": in_run()}
        opening = str(self.schema["scenario"].read("scenario", scenario))
        motions = list(dict.fromkeys(recording.motion for recording in self._recordings.values()))
        shots = list(dict.fromkeys(films.values()))
        fit = known.get(opening) or fitting(self._recordings[opening], on[opening])
        chosen = {"observers": asked, "surface": surface, "scenario": opening}
        standard = STANDARD | {name: self.schema[name].opening for name in ("gains", "switches")}
        sampled = {n: {"track": table_for_the_page(motion)} for n, motion in self._tables.items()}
        super().__init__(
            "observer_lab",
            {**settings, **{name: value for name, value in chosen.items() if value is not None}},
            {**standard, **fit},
            standard,
            texts=self._registry.packed,
            scenarios={n: {"title": s.name, **known[n], **sampled.get(n, {})} for n, s in scenes.items()},
            recordings={
                n: track_for_the_page(recording, tracks[n].motion.name, on[n], self._registry)
                | {"motion": motions.index(recording.motion), "film": shots.index(films[n]) if n in films else None}
                for n, recording in self._recordings.items()
            },
            motions=[table_for_the_page(motion) for motion in motions],
            own=self._registry.for_the_page(),
            varies={n: VARIES.format("motion") for n, make in self._registry.observers.items() if make.constant_motion},
            drive=DRIVE,
            bound={"noise": {kind: make(1.0).variance for kind, make in NOISES.items()}, "hidden": HIDDEN_VARIANCE},
            **OF_ONE_POINT,
        )
        self.frames = [{"time": np.asarray(f.time).tolist(), "extent": f.extent, "images": f.images} for f in shots]

    def refuse(self, settings: Settings) -> None:
        """Raise a ValueError for settings that do not go together."""
        recording = self._recordings.get(settings["scenario"])
        surface, outputs = settings["surface"], settings["outputs"]
        allowed = self._registry.outputs(surface)
        if recording is not None:
            allowed = [o for o in allowed if set(o) <= set(recording.names)]
            Choice("zero", HOLDS[:2]).read("hold of a recording", settings["hold"])
        if outputs not in allowed:
            choices = ", ".join(map(str, allowed))
            raise ValueError(f"outputs is {outputs!r}; on the {surface} surface it must be one of {choices}")
        self._refuse_motion(settings)
        refused = self._registry.refused(surface, outputs)
        if recording is not None:
            refused |= refused_for(recording.motion, self._registry, "recording's")
        elif self._varies(settings):
            refused |= refused_for(self._motion_of(settings), self._registry, "motion")
        refuse_observers(settings, refused)
        if recording is not None and not recording.view.fits(self._registry.surfaces[surface]):
            raise ValueError(f"the recording was seen on the {recording.view.name}, not on the {surface}")
        if recording is not None and settings["believed"] is not None:
            raise ValueError("a recording's motion varies and is measured; believed must be None with it")

    def _refuse_motion(self, settings: Settings) -> None:
        """Raise a ValueError for a motion over time that is not read or not finite, or beside that of a scenario."""
        if settings["motion"].strip():
            scenario = settings["scenario"]
            if scenario in self._recordings or scenario in self._tables:
                raise ValueError(
                    f"motion is {settings['motion']!r}, but {scenario!r} has its own; choose another scenario"
                )
            self.refuse_poles(settings, lambda _: _numbers(settings))

    def _varies(self, settings: Settings) -> bool:
        return bool(settings["motion"].strip()) or settings["scenario"] in self._tables

    def _motion_of(self, settings: Settings) -> Motion:
        """The true motion of a simulated point."""
        if settings["scenario"] in self._tables:
            return self._tables[settings["scenario"]]
        return _motion(settings)

    def analyse(self) -> Settings:
        """Sentences on excitation, error dynamics and the bias of noise for the present settings."""
        settings = self.settings
        seen = (settings["surface"], tuple(settings["outputs"]))
        observers = {name: self._chosen(settings, name) for name in settings["observers"]}
        work = 0.0
        if settings["scenario"] not in self._recordings:
            duration, period = settings["duration"], settings["period"]
            work = motion_work(self._motion_of(settings), duration, period)
            if refusal := too_much(work, duration, period):
                return {"sentences": [refusal]}
        try:
            recording = self.recorded(settings)
        except (BehindCamera, TooMuchWork) as error:
            return {"sentences": [str(error)]}
        states = {
            name: len(chosen[0].equations.state)
            for name, chosen in observers.items()
            if recording.truth is None or has_words(chosen)
        }
        steps = np.ptp(recording.time) / min(np.diff(recording.time).min(), LONGEST_STEP)
        followed, beyond = within_reach(steps, states, work)
        window = window_in(recording, settings["window"])
        sentences = excitation_in_words(self._registry.form(*seen), recording, window)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", StepTooLong)
            found = self._followed(recording, {**settings, "observers": followed})
        for name, run in found.items():
            sentences += run_in_words(observers[name], run, window)
        return {"sentences": [*sentences, *(str(warning.message) for warning in caught), *beyond]}

    def runs(self, settings: Settings) -> dict[str, Run]:
        """Runs of settings, by the observers' names."""
        return self._followed(self.recorded(settings := self.check(settings)), settings)

    def _followed(self, recording: Recording, settings: Settings) -> dict[str, Run]:
        chosen, other = settings["start"], settings["believed"]
        size = recording.outputs[0, 2:].tolist()  # if it is seen, its estimate starts there
        values = [*chosen["values"][:2], *size, chosen["values"][2]]
        start = {"own": None, "zero": [0.0] * len(values), "chosen": values}[chosen["mode"]]
        believed = affine(other["A"], other["b"]) if other else None
        found = {}
        for name in settings["observers"]:
            observer, _ = self._chosen(settings, name)
            tuned = observer.with_gains(**{gain.name: settings["gains"][name][gain.name] for gain in observer.gains})
            found[name] = track(recording, tuned, start, settings["hold"], believed, language="python")
        return found

    def recorded(self, settings: Settings) -> Recording:
        """Recording of the camera, as far as the point stays in front of it."""
        settings = self.check(settings)
        if recording := self._recordings.get(settings["scenario"]):
            return recording
        return _simulated(settings, self._motion_of(settings), self._registry.surfaces[settings["surface"]])

    def _chosen(self, settings: Settings, name: str) -> tuple[Observer, str]:
        """An observer with its default gains, and its switch."""
        way = str(settings["switches"].get(name, ""))
        return self._registry.observer(settings["surface"], settings["outputs"], name, way), way


observer_lab = ObserverLab


def _seen_on(name: str, recording: Recording) -> ImagingSurface:
    if not isinstance(recording.view, ImagingSurface):
        raise ValueError(
            f"the recording {name!r} was seen as {recording.view.name}; the lab shows one point on an imaging surface"
        )
    return with_numbers(recording.view)


def _gains_for(recording: Recording) -> Settings:
    """Gains of a Kalman filter in metres: the noise of a track, if it is known, and a start that suits its speed."""
    noise = {"noise_variance": recording.effective_variance} if recording.effective_variance else {}
    return noise | {"hidden_variance": recording.in_own_unit().unit ** -2}


def _refuse_other_times(name: str, film: Frames, tracks: Mapping[str, Recording]) -> None:
    """Raise a ValueError for frames of no recording, or of times at which it has no samples."""
    if name not in tracks:
        raise ValueError(f"frames are given for {name!r}, which is no recording of this lab; give its recording")
    times, elapsed = np.asarray(film.time) - tracks[name].time[0], tracks[name].elapsed
    if times[-1] < 0 or times[0] > elapsed[-1]:
        raise ValueError(
            f"the frames are from {times[0]:.4g} to {times[-1]:.4g} s after the recording's first sample, and none is "
            f"of its {elapsed[-1]:.4g} s; give their times by the recording's clock"
        )


def _numbers(settings: Settings) -> np.ndarray:
    return np.array([*np.ravel(settings["A"]), *settings["b"]], dtype=float)


def _motion(settings: Settings) -> Motion:
    """The motion of settings: constant, or as its expressions of time say."""
    if settings["motion"].strip():
        typed, numbers = read_motion(settings["motion"], BLOCKS), _numbers(settings)
        return replace(MOTION, signal=Signal(OverTime(partial(typed.rows, numbers=numbers), typed.breaks)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # the controls say their units
        return affine(settings["A"], settings["b"])


def _simulated(settings: Settings, motion: Motion, seen_on: ImagingSurface) -> Recording:
    """Recording of a simulated point, as far as it stays in front of the camera."""
    surface = shaped_surface(settings) if settings["surface"] in SHAPES else seen_on
    surface = sized(surface, RADIUS) if tuple(settings["outputs"]) == SIZE else surface
    scenario = Scenario("the lab's", motion, settings["X0"], settings["duration"], surface)
    noise = NOISES[settings["noise"]["kind"]](settings["noise"]["size"])
    camera = Camera(settings["period"], noise, settings["dropout"])
    return record_while_seen(scenario, camera, settings["seed"])
