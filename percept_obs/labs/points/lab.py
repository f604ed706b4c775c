"""The lab of many points: points of one state, dragged, hidden, added and removed while an observer follows them."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from percept_obs.labs.points.settings import PICTURES, SCHEMA
from percept_obs.labs.points.texts import form_of, state_of
from percept_obs.labs.points.words import in_words
from percept_obs.labs.shared.lab import NOISES, Lab
from percept_obs.labs.shared.sampling import looks, too_fast, within_reach
from percept_obs.labs.shared.schema import Settings
from percept_obs.observability.gramian import UNSEEN
from percept_obs.observability.gramian import VERDICTS as GRAMIAN_VERDICTS
from percept_obs.points import (
    FirstSight,
    LyapunovMatrix,
    PointsRun,
    PointsScenario,
    UnseenDirection,
    constant,
    luenberger,
    lyapunov,
    riccati,
    scheduled,
)
from percept_obs.points.form import JUDGED, PointsForm, points_form
from percept_obs.points.manoeuvre import Manoeuvre
from percept_obs.points.run import REMEDY
from percept_obs.recording import Camera, Recording, record
from percept_obs.tracking import track
from percept_obs.tracking.verdict import VERDICTS, for_the_page

STEP_WORK, STEP_WORK_WITH_P = 10, 20
"""Times that a state of many points takes Python longer than one of a single point: alone, and with a P to compute."""

LOOK_WORK = 26
"""What a look at a motion that varies costs Python, as `MOST_WORK` counts."""

ERROR = (0.3, -0.2, 0.5, 0.2, -0.1, 0.3)
"""Errors of the start, in metres, repeated for states with more entries."""

_WEIGHTS: Mapping[str, Callable[[Settings], LyapunovMatrix]] = MappingProxyType(
    {
        "constant": lambda s: constant(s["size"]),
        "scheduled": lambda s: scheduled(lambda t: s["size"] * (s["final"] / s["size"]) ** (t / s["duration"])),
        "lyapunov": lambda s: lyapunov(s["size"], s["decrease"]),
        "riccati": lambda s: riccati(s["size"], s["forgetting"]),
    }
)
"""P by its name in the settings; a scheduled one grows or shrinks by the same factor in equal times."""


class PointsLab(Lab):
    """The lab of many points, shown by the page; `settings` define everything, and may be set from Python as well.

    Parameters
    ----------
    **settings
        Those to open with, such as ``state="independent"``:

    {settings}
    """

    schema = SCHEMA
    title = "Many points of one state"

    def __init__(self, **settings: Any) -> None:
        super().__init__(
            "points_lab",
            settings,
            SCHEMA.opening,
            SCHEMA.opening,
            pictures=PICTURES,
            error=ERROR,
            **{**for_the_page(), "verdicts": {**VERDICTS, **GRAMIAN_VERDICTS}},
            remedy=REMEDY,
            judged=JUDGED,
            unseen=UNSEEN,
        )

    def run(self) -> PointsRun:
        """The run of the same settings in Python."""
        return run_of(self.settings)

    def check(self, settings: Settings) -> Settings:
        """Complete settings, or a ValueError that says what is wrong; points without a word on hiding are seen."""
        points = settings.get("points") if isinstance(settings, Mapping) else None
        if isinstance(points, list | tuple) and points and "hidden" not in settings:
            settings = {**settings, "hidden": [None] * len(points)}
        return super().check(settings)

    def refuse(self, settings: Settings) -> None:
        """Raise a ValueError for settings that do not go together."""
        points, hidden = len(settings["points"]), settings["hidden"]
        if len(hidden) != points:
            raise ValueError(f"hidden is {hidden!r}; it must have an entry for each of the {points} points")
        for k, times in enumerate(hidden, 1):
            if times is not None and not times[0] < times[1]:
                raise ValueError(f"hidden {k} is {times!r}; it must begin at 0 s or later and end after that")

    def analyse(self) -> Settings:
        """Sentences on the present settings, and the rate of decay that is guaranteed."""
        settings = self.settings
        steps = settings["duration"] / min(settings["period"], settings["step"])
        A, _ = form_of_settings(settings).coefficients(np.linspace(0, settings["duration"], 50))
        paths = 2 if settings["hold"] == "exact" else 1
        moved = LOOK_WORK * paths * looks(settings["duration"], float(np.abs(A).sum(axis=-1).max()))
        each = STEP_WORK_WITH_P if settings["weight"] in ("lyapunov", "riccati") else STEP_WORK
        _, beyond = within_reach(steps, {"these points": each * 3 * len(settings["points"])}, moved)
        beyond = [refusal] if (refusal := too_fast(moved)) else beyond
        return {"sentences": beyond, "bound": None} if beyond else in_words(self.run(), settings["window"])


points_lab = PointsLab


def form_of_settings(settings: Settings) -> PointsForm:
    """The form of the settings' points."""
    manoeuvre = Manoeuvre(settings["turning"], settings["spin"], settings["input"], tuple(settings["velocity"]))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnseenDirection)  # the lab says so in its own place
        return form_of(settings["state"], len(settings["points"]), manoeuvre)


def recording_of(settings: Settings) -> Recording:
    """What the camera records of the settings' points."""
    form = form_of_settings(settings)
    state = state_of(form, settings["points"]).tolist()
    scenario = PointsScenario("from the lab", form, state, settings["duration"])
    noise = NOISES[settings["noise"]["kind"]](settings["noise"]["size"])
    camera = Camera(settings["period"], noise, settings["dropout"], settings["view"])
    recording = record(scenario, camera=camera, seed=settings["seed"])
    for point, times in enumerate(settings["hidden"]):
        if times is not None:
            recording = recording.without(times[0], times[1], point)
    return recording


def run_of(settings: Settings) -> PointsRun:
    """The run that lab settings stand for."""
    recording = recording_of(settings)
    form = points_form(recording)
    assert recording.truth is not None
    begin: Any = FirstSight(settings["depth"]) if settings["start"] == "rays" else None
    if settings["start"] == "error":
        begin = recording.truth[0] - settings["error"] * np.resize(ERROR, form.states)
    observer = luenberger(form, _WEIGHTS[settings["weight"]](settings))
    run = track(recording, observer, begin, hold=settings["hold"], step=settings["step"], language="python")
    assert isinstance(run, PointsRun)
    return run
