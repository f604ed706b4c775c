"""The lab of many points: points of one state, dragged, hidden, added and removed while an observer follows them."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from percept_obs.labs.points.texts import MOST_POINTS, STATES, form_of, model_for_the_page, state_of
from percept_obs.labs.points.words import in_words
from percept_obs.labs.shared.checks import known_names, number, numbers, one_of, some_of, whole_number
from percept_obs.labs.shared.lab import Lab, Settings
from percept_obs.observability.gramian import UNSEEN
from percept_obs.observability.gramian import VERDICTS as GRAMIAN_VERDICTS
from percept_obs.points import (
    FirstSight,
    PointsRun,
    PointsScenario,
    UnseenDirection,
    Weight,
    constant,
    luenberger,
    lyapunov,
    riccati,
    scheduled,
)
from percept_obs.points.form import points_form
from percept_obs.points.manoeuvre import Manoeuvre
from percept_obs.recording import Camera, Gaussian, Recording, Uniform, record
from percept_obs.tracking import track
from percept_obs.tracking.run import VERDICTS

NOISES: dict[str, Any] = {"uniform": Uniform, "gaussian": Gaussian}
HOLDS = ("exact", "zero", "first")
STARTS = ("rays", "error", "zero")
PICTURES = ("error", "depth", "points", "gramian")
ERROR = (0.3, -0.2, 0.5, 0.2, -0.1, 0.3)
"""Errors of the start, in metres, repeated for states with more entries."""

WEIGHTS: Mapping[str, Callable[[Settings], Weight]] = MappingProxyType(
    {
        "constant": lambda s: constant(s["size"]),
        "scheduled": lambda s: scheduled(lambda t: s["size"] * (s["final"] / s["size"]) ** (t / s["duration"])),
        "lyapunov": lambda s: lyapunov(s["size"], s["decrease"]),
        "riccati": lambda s: riccati(s["size"], s["forgetting"]),
    }
)
"""P to choose from; a scheduled one grows or shrinks by the same factor in equal times."""

RANGES = {
    "turning": (-10, 10),
    "spin": (-10, 10),
    "input": (-10, 10),
    "size": (1e-4, 1e4),
    "final": (1e-4, 1e4),
    "decrease": (0, 100),
    "forgetting": (0, 100),
    "depth": (0.01, 100),
    "error": (-100, 100),
    "dropout": (0, 0.95),
    "view": (0.1, 100),
    "period": (5e-3, 1),
    "step": (1e-3, 0.1),
    "duration": (1, 120),
    "window": (0.1, 120),
}


class PointsLab(Lab):
    """The lab of many points, shown by the page; `settings` define everything, and may be set from Python as well.

    Parameters
    ----------
    **settings
        Those to open with, such as ``state="independent"``:

    state : "body" (r, d_2, ...), "independent" (X_1, X_2, ...) or "origin" (o, d_1, ...)
    points : places of 1 to 8 points at time 0, in metres in the camera's frame
    hidden : for each point None, or when it is hidden: two times in seconds
    turning, spin, input, velocity : the manoeuvre, as `Manoeuvre` takes it
    weight : "constant", "scheduled", "lyapunov" or "riccati", with its `size`, `final`, `decrease` and `forgetting`
    start : "rays" at a `depth` in metres, "error" with a share `error` of a given error, or "zero"
    noise, dropout, seed, period, view : the camera; noise is a mapping of kind and size
    hold : "exact", "zero" or "first"
    step, duration, window : longest step, time that is shown, and window of the Gramian, in seconds
    pictures : which time charts are shown
    kept : None, or the settings of the run that is kept to compare with

    Raises
    ------
    ValueError
        If a setting is unknown or makes no sense.
    """

    def __init__(self, **settings: Any) -> None:
        self._opening = _opening_settings()
        self._opening = self.check(settings)
        super().__init__("points_lab", self._model(), self._opening)

    def run(self) -> PointsRun:
        """The run of the same settings in Python."""
        return run_of(self.settings)

    def check(self, settings: Settings) -> Settings:
        """Complete settings, or a ValueError that says what is wrong."""
        known_names(settings, self._opening)
        if "points" in settings and "hidden" not in settings:
            settings = {**settings, "hidden": [None] * len(settings["points"])}
        whole = self._opening | settings
        for key, known in (("state", STATES), ("weight", WEIGHTS), ("hold", HOLDS), ("start", STARTS)):
            one_of(whole, key, known)
        some_of(whole, "pictures", PICTURES)
        one_of({"noise kind": whole["noise"].get("kind")}, "noise kind", NOISES)
        number({"noise size": whole["noise"].get("size")}, "noise size", 0, 1)
        for key, (low, high) in RANGES.items():
            number(whole, key, low, high)
        if whole["duration"] < whole["period"]:
            raise ValueError(f"a duration of {whole['duration']} s holds no two samples {whole['period']} s apart")
        numbers(whole, "velocity", (3,))
        _check_points(whole)
        whole_number(whole)
        if whole["kept"] is not None:
            whole["kept"] = self.check({**whole["kept"], "kept": None})
        return whole

    def analyse(self, summary: Settings) -> Settings:
        """Sentences on the present settings, and the rate of decay that is guaranteed."""
        return in_words(self.run(), self.settings["window"])

    def _model(self) -> Settings:
        return {
            **model_for_the_page(),
            "opening": self._opening,
            "standard": _opening_settings(),
            "pictures": PICTURES,
            "error": ERROR,
            "verdicts": {**VERDICTS, **GRAMIAN_VERDICTS},
            "unseen": UNSEEN,
        }


points_lab = PointsLab


def recording_of(settings: Settings) -> Recording:
    """What the camera records of the settings' points."""
    manoeuvre = Manoeuvre(settings["turning"], settings["spin"], settings["input"], tuple(settings["velocity"]))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnseenDirection)  # the lab says so in its own place
        form = form_of(settings["state"], len(settings["points"]), manoeuvre)
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
    run = track(
        recording,
        luenberger(form, WEIGHTS[settings["weight"]](settings)),
        begin,
        hold=settings["hold"],
        step=settings["step"],
    )
    assert isinstance(run, PointsRun)
    return run


def _opening_settings() -> Settings:
    return {
        "state": "body",
        "points": [[0.0, 1.2, 2.5], [0.5, 0.9, 2.9], [-0.5, 0.8, 2.7]],
        "hidden": [None, None, None],
        "turning": 1.0,
        "spin": 0.0,
        "input": 1.0,
        "velocity": [0.0, 0.0, 0.0],
        "weight": "constant",
        "size": 1.0,
        "final": 1.0,
        "decrease": 0.0,
        "forgetting": 0.3,
        "start": "rays",
        "depth": 1.5,
        "error": 1.0,
        "noise": {"kind": "uniform", "size": 0.0},
        "dropout": 0.0,
        "seed": 0,
        "period": 0.05,
        "view": 2.0,
        "hold": "exact",
        "step": 0.05,
        "duration": 30.0,
        "window": 8.0,
        "pictures": ["error", "depth", "gramian"],
        "kept": None,
    }


def _check_points(settings: Settings) -> None:
    points, hidden = settings["points"], settings["hidden"]
    if not isinstance(points, list) or not 1 <= len(points) <= MOST_POINTS:
        raise ValueError(f"points is {points!r}; it must be a list of 1 to {MOST_POINTS} places")
    numbers(settings, "points", (len(points), 3))
    if not isinstance(hidden, list) or len(hidden) != len(points):
        raise ValueError(f"hidden is {hidden!r}; it must have an entry for each of the {len(points)} points")
    for k, times in enumerate(hidden):
        if times is None:
            continue
        name = f"hidden of point {k + 1}"
        numbers({name: times}, name, (2,))
        if not 0 <= times[0] < times[1]:
            raise ValueError(f"{name} is {times!r}; it must begin at 0 s or later and end after that")
