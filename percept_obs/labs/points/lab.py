"""The lab of many points: points of one state, dragged, hidden, added and removed while an observer follows them."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.compile import vectorised
from percept_obs.labs.points.analysis import in_words
from percept_obs.labs.points.settings import DRIVE, LONGEST, LOOKS, SCHEMA
from percept_obs.labs.points.texts import (
    BLOCKS,
    STATES,
    coefficients_for_the_page,
    form_of,
    own_state_for_the_page,
    state_of,
    typed_velocities,
)
from percept_obs.labs.points.typed_weight import as_text, gives_P, read_weight, refuse_P, weight_for_the_page, weight_of
from percept_obs.labs.shared.common_settings import offering
from percept_obs.labs.shared.lab import NOISES, Lab
from percept_obs.labs.shared.printed import Texts, part, with_texts
from percept_obs.labs.shared.samples import is_sampled, refuse_longer, times_of
from percept_obs.labs.shared.schema import Schema, Settings, in_run, only
from percept_obs.labs.shared.typed_motion import read_motion
from percept_obs.labs.shared.work import solver_calls, too_much, within_reach
from percept_obs.observability.windows import UNSEEN
from percept_obs.points import FirstSight, PointsRun, PointsScenario, UnseenDirection, luenberger
from percept_obs.points.form import JUDGED, PointsForm, points_form
from percept_obs.points.gramian import VERDICTS as GRAMIAN_VERDICTS
from percept_obs.points.manoeuvre import Manoeuvre, velocities
from percept_obs.points.run import REMEDY
from percept_obs.recording import Camera, Recording, record
from percept_obs.system.motion import TIME
from percept_obs.tracking import track
from percept_obs.tracking.verdict import VERDICTS, for_the_page
from percept_obs.validation import checked

STEP_WORK, STEP_WORK_WITH_P = 10, 20
"""Times that a state of many points takes Python longer than one of a single point: alone, and with a P to compute."""

CALL_WORK = 26
"""Cost of one call of a varying motion by scipy's solver, in steps times states (`MOST_WORK`), for one path."""

ERROR = (0.3, -0.2, 0.5, 0.2, -0.1, 0.3)
"""Errors of the start, in metres, repeated for states with more entries."""


class PointsLab(Lab):
    """The lab of many points, shown by the page; `settings` define everything, and may be set from Python as well.

    Without any argument a camera travels round a resting body.

    Parameters
    ----------
    form : PointsForm, optional
        A form of your own that can be chosen as well, with a motion in numbers, expressions of time, or samples, such
        as ``independent_points(affine(A, b, times), 2)``.
    **settings
        Those to open with, such as ``state="independent"``:

    {settings}

    See Also
    --------
    observer_lab : One point.

    Examples
    --------
    >>> from percept_obs.labs import points_lab
    >>> lab = points_lab(points=[[0, 0, 4], [1, 0, 5]])
    >>> lab.settings["points"]
    [[0.0, 0.0, 4.0], [1.0, 0.0, 5.0]]
    """

    schema = SCHEMA
    title = "Many points of one state"
    blocks = BLOCKS
    looks = LOOKS

    @checked
    def __init__(self, form: PointsForm | None = None, **settings: Any) -> None:
        self._form = form
        self.idle = {
            **dict.fromkeys(("turning", "input", "camera_velocity"), only("state", *STATES)),
            "spin": only("state", "body", "origin"),
            **{"depth": only("start", "rays"), "error": only("start", "error")},
            **{"P": only("weight", "typed"), "P0": only("weight", "lyapunov", "riccati")},
            **{"decrease": only("weight", "lyapunov"), "forgetting": only("weight", "riccati")},
            **{"final": only("weight", "scheduled"), "window": in_run()},
            "hidden": in_run(lambda whole: max(times[0] if times else 0 for times in whole["hidden"])),
        }
        if form is None and not set(settings) - set(self.looks):
            settings = DRIVE | settings
        printed: dict[str, Texts] = {}
        opening = SCHEMA.opening
        if form is not None:
            model = part("points_lab")
            printed = {"": {**model, "states": {**model["states"], "own": own_state_for_the_page(form)}}}
            self.schema = Schema({**SCHEMA, "state": offering(SCHEMA["state"], (*STATES, "own"))})
            opening |= {"state": "own", "points": _spread(form.points), "hidden": [None] * form.points}
            if is_sampled(form.motion):
                opening["duration"] = min(float(times_of(form.motion)[-1]), LONGEST)
        super().__init__(
            "points_lab",
            settings,
            opening,
            SCHEMA.opening,
            texts=with_texts("points_lab", printed),
            drive=DRIVE,
            error=ERROR,
            **{**for_the_page(), "verdicts": {**VERDICTS, **GRAMIAN_VERDICTS}},
            remedy=REMEDY,
            judged=JUDGED,
            unseen=UNSEEN,
        )
        self.write_down(DRIVE)  # which questions are about, whatever the lab opens with

    def typed_for_the_page(self, text: str) -> Settings:
        """Texts of a given P, or of each state's coefficients under a motion over time."""
        if gives_P(text):
            return weight_for_the_page(read_weight(text))
        typed = read_motion(text, BLOCKS)
        moved = typed_velocities(typed, velocities())
        states = {state: coefficients_for_the_page(state, moved) for state in STATES}
        functions = {str(f.func) for entry in typed.changed.values() for f in entry.atoms(sp.Function)}
        told = {name: sp.sstr(entry) for name, entry in typed.changed.items()}
        return {**typed.for_the_page(), "states": states, "sympy": told, "functions": sorted(functions)}

    def check(self, settings: Settings) -> Settings:
        """Complete settings, or a ValueError that says what is wrong.

        Points are seen where `hidden` is missing, and `weight` is "typed" where P is given without it.
        """
        if isinstance(settings, Mapping):
            typed: Settings = {name: as_text(settings[name]) for name in ("P", "P0") if name in settings}
            settings = {**({"weight": "typed"} if "P" in typed else {}), **settings, **typed}
        points = settings.get("points") if isinstance(settings, Mapping) else None
        if isinstance(points, list | tuple) and points and "hidden" not in settings:
            settings = {**settings, "hidden": [None] * len(points)}
        return super().check(settings)

    def refuse(self, settings: Settings) -> None:
        """Raise a ValueError for settings that do not go together."""
        points, hidden = len(settings["points"]), settings["hidden"]
        if len(hidden) != points:
            raise ValueError(f"hidden is {hidden!r}; it must have an entry for each of the {points} points")
        if self._form is not None and settings["state"] == "own":
            if points != self._form.points:
                raise ValueError(f"there are {points} points; it must be {self._form.points}, as in your own form")
            if settings["motion"].strip():
                raise ValueError("motion is given, but it must be empty with your own form, which has its own")
            if is_sampled(self._form.motion):
                refuse_longer(self._form.motion, settings["duration"])
        self._refuse_motion(settings)
        refuse_P(settings)
        for k, times in enumerate(hidden, 1):
            if times is not None and not times[0] < times[1]:
                raise ValueError(f"hidden {k} is {times!r}; it must begin at 0 s or later and end after that")

    def _refuse_motion(self, settings: Settings) -> None:
        if not settings["motion"].strip():
            return
        if gives_P(settings["motion"]):
            raise ValueError('motion gives P; give it as P=..., which sets weight="typed"')
        moved = tuple(entry for vector in _manoeuvre(settings).velocities for entry in vector)
        function = vectorised((TIME,), moved)
        self.refuse_poles(settings, lambda times: np.stack(function(times), axis=-1))

    def analyse(self) -> Settings:
        """Sentences on the present settings, and the rate of decay that is guaranteed."""
        settings = self.settings
        steps = settings["duration"] / min(settings["period"], settings["step"])
        form = form_of_settings(settings, self._form)
        A, _ = form.coefficients(np.linspace(0, settings["duration"], 50))
        paths = 2 if settings["hold"] == "exact" else 1
        fastest = float(np.abs(A).sum(axis=-1).max())
        known = form.numbers if settings["motion"].strip() else None
        moved = CALL_WORK * paths * solver_calls(known, settings["duration"], fastest, form.motion)
        each = STEP_WORK_WITH_P if settings["weight"] in ("lyapunov", "riccati") else STEP_WORK
        _, beyond = within_reach(steps, {"these points": each * 3 * len(settings["points"])}, moved)
        beyond = [refusal] if (refusal := too_much(moved)) else beyond
        return {"sentences": beyond, "bound": None} if beyond else in_words(self.run(), settings["window"])

    def recorded(self, settings: Settings) -> Recording:
        """Recording of the settings' points."""
        form = form_of_settings(settings := self.check(settings), self._form)
        state = state_of(form, settings["points"]).tolist()
        scenario = PointsScenario("from the lab", form, state, settings["duration"])
        noise = NOISES[settings["noise"]["kind"]](settings["noise"]["size"])
        camera = Camera(settings["period"], noise, settings["dropout"], settings["view"])
        recording = record(scenario, camera=camera, seed=settings["seed"])
        for point, times in enumerate(settings["hidden"]):
            if times is not None:
                recording = recording.without(times[0], times[1], point)
        return recording

    def runs(self, settings: Settings) -> PointsRun:
        """The run of settings."""
        recording = self.recorded(settings := self.check(settings))
        form = points_form(recording)
        assert recording.truth is not None
        begin: Any = FirstSight(settings["depth"]) if settings["start"] == "rays" else None
        if settings["start"] == "error":
            begin = recording.truth[0] - settings["error"] * np.resize(ERROR, form.states)
        observer = luenberger(form, weight_of(settings, form.states))
        run = track(recording, observer, begin, hold=settings["hold"], step=settings["step"], language="python")
        assert isinstance(run, PointsRun)
        return run


points_lab = PointsLab


def _manoeuvre(settings: Settings) -> Manoeuvre:
    return Manoeuvre(settings["turning"], settings["spin"], settings["input"], tuple(settings["camera_velocity"]))


def _spread(points: int) -> list[list[float]]:
    """Positions of points in front of the camera: those that the lab opens with, and more around them."""
    more = [[0.5 * math.cos(2.4 * k), 1 + 0.4 * math.sin(2.4 * k), 2.5 + 0.1 * k] for k in range(3, points)]
    return [*SCHEMA.opening["points"], *more][:points]


def form_of_settings(settings: Settings, own: PointsForm | None = None) -> PointsForm:
    """The form of the settings' points."""
    if own is not None and settings["state"] == "own":
        return own
    typed = read_motion(settings["motion"], BLOCKS) if settings["motion"].strip() else None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnseenDirection)  # the lab says so in its own place
        return form_of(settings["state"], len(settings["points"]), _manoeuvre(settings), typed)
