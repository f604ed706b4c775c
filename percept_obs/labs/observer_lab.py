"""The observer lab: a camera, a moving point, and observers that recover its distance while the hand moves."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from functools import lru_cache, partial, reduce
from typing import Any

import numpy as np
import sympy as sp
from scipy.linalg import expm

from percept_obs import scenarios
from percept_obs.compile import vectorised
from percept_obs.labs.base import (
    BY_NAME,
    OUTPUTS,
    SURFACES,
    Lab,
    Settings,
    Structure,
    model_for_the_page,
    number,
    numbers,
    observer_of,
    one_of,
    track_for_the_page,
    with_affine_motion,
)
from percept_obs.motion import affine
from percept_obs.observability import windowed
from percept_obs.recording import Camera, Gaussian, Recording, Scenario, Uniform, record
from percept_obs.surfaces import BehindCamera, plane
from percept_obs.tracking import Run, track

SCENARIOS = {make.__name__: make for make in (scenarios.ma2005_eq35, scenarios.ma2005_eq36)}
NOISES: dict[str, Any] = {"uniform": Uniform, "gaussian": Gaussian}
HOLDS = ("zero", "first", "exact")
STARTS = ("own", "zero", "chosen")
RANGES = {"dropout": (0, 0.95), "period": (1e-3, 1), "duration": (0.1, 200), "window": (0.1, 200), "threshold": (0, 10)}
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
            name: {**track_for_the_page(r), **_fitting(r), "kind": tracks[name].motion.name}
            for name, r in self._recordings.items()
        }
        one_of({"scenario": scenario}, "scenario", [*self._scenarios, *self._recordings])
        fit = dict(self._scenarios.get(scenario) or _fitting(self._recordings[scenario]))
        fit.pop("title", None)
        self._opening: Settings = {**_opening_settings(), **fit, "scenario": scenario}
        self._opening = self.check(self._opening | settings)
        super().__init__("observer_lab", self._model(), self._opening)

    def run(self) -> dict[str, Run]:
        """Runs of the same settings in Python, by the observers' names."""
        return runs(self.settings, self._recordings)

    def check(self, settings: Settings) -> Settings:
        """Complete settings, or a ValueError that says what is wrong."""
        unknown = sorted(set(settings) - set(self._opening))
        if unknown:
            raise ValueError(f"there is no setting {', '.join(unknown)}; there are {', '.join(self._opening)}")
        whole = self._opening | settings
        recording = self._recordings.get(one_of(whole, "scenario", [*self._scenarios, *self._recordings]))
        whole["gains"] = _checked_gains(whole["gains"])
        _check_choices(whole, recording)
        _check_numbers(whole)
        if whole["kept"] is not None:
            whole["kept"] = self.check({**whole["kept"], "kept": None})
        return whole

    def analyse(self, summary: Settings) -> Settings:
        """Sentences on excitation, error dynamics and the bias of noise for the present settings."""
        try:
            found = runs(self.settings, self._recordings)
        except BehindCamera as error:
            return {"sentences": [str(error)]}
        first = next(iter(found.values()))
        window = min(self.settings["window"], float(np.ptp(first.time)))
        sentences = [_excitation_in_words(first, window)]
        for name, run in found.items():
            sentences += _error_in_words((self.settings["surface"], tuple(self.settings["outputs"]), name), run, window)
        return {"sentences": sentences, "verdicts": {name: run.verdict() for name, run in found.items()}}

    def _model(self) -> Settings:
        return {
            **model_for_the_page(),
            "scenarios": self._scenarios,
            "recordings": self._tracks,
            "opening": self._opening,
            "pictures": PICTURES,
        }


observer_lab = ObserverLab


def runs(settings: Settings, recordings: Mapping[str, Recording]) -> dict[str, Run]:
    """Runs that lab settings stand for, by the observers' names."""
    recording = recordings.get(settings["scenario"]) or _simulated(settings)
    believed = settings["believed"] and affine(settings["believed"]["A"], settings["believed"]["b"])
    start: Any = {"own": None, "zero": [0.0] * 3, "chosen": settings["start"]["values"]}[settings["start"]["mode"]]
    found = {}
    for name in settings["observers"]:
        observer = observer_of(settings["surface"], tuple(settings["outputs"]), name)
        observer = observer.with_gains(**settings["gains"][name])
        found[name] = track(recording, observer, start, settings["hold"], believed or None)
    return found


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
        return simulate(times[_samples_in_front(scenario, times) - 1])


def _samples_in_front(scenario: Scenario, times: np.ndarray) -> int:
    """How many samples the camera takes before the point leaves the half-space in front of it, by bisection."""
    seen, unseen = 1, len(times)
    while unseen - seen > 1:
        middle = (seen + unseen) // 2
        try:
            scenario.coordinates(times[:middle])
            seen = middle
        except BehindCamera:
            unseen = middle
    if seen < 2:
        raise BehindCamera("the point leaves the half-space in front of the camera at once; move it or turn the motion")
    return seen


def _fitting(recording: Recording) -> Settings:
    """Settings that a recording brings with it."""
    duration = float(np.ptp(recording.time))
    surface = next(kind for kind in SURFACES if recording.surface.fits(SURFACES[kind]()))
    return {"surface": surface, "outputs": list(recording.names), "duration": duration, "window": min(duration, 2.0)}


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


def _checked_gains(given: Mapping[str, Mapping[str, float]]) -> dict[str, dict[str, float]]:
    unknown = sorted(set(given) - set(BY_NAME))
    if unknown:
        raise ValueError(f"there is no observer {', '.join(unknown)}; there are {', '.join(BY_NAME)}")
    observers = {name: observer_of("pinhole", OUTPUTS[0], name).with_gains(**given.get(name, {})) for name in BY_NAME}
    return {name: {gain.name: gain.value for gain in observer.gains} for name, observer in observers.items()}


def _check_choices(settings: Settings, recording: Recording | None) -> None:
    surface = one_of(settings, "surface", SURFACES)
    offered = [o for o in OUTPUTS if recording is None or set(o) <= set(recording.names)]
    if tuple(settings["outputs"]) not in offered:
        raise ValueError(
            f"outputs is {settings['outputs']!r}; it must be one of {', '.join(map(str, map(list, offered)))}"
        )
    for key, known in (("observers", BY_NAME), ("pictures", PICTURES)):
        wrong = [name for name in settings[key] if name not in known]
        if wrong or not settings[key] or len(set(settings[key])) != len(settings[key]):
            raise ValueError(f"{key} is {settings[key]!r}; name at least one of {', '.join(known)}, each once")
    one_of({"noise kind": settings["noise"].get("kind")}, "noise kind", NOISES)
    one_of({"start mode": settings["start"].get("mode")}, "start mode", STARTS)
    one_of(settings, "hold", HOLDS if recording is None else HOLDS[:2])
    if recording is not None and not recording.surface.fits(SURFACES[surface]()):
        raise ValueError(f"the recording was seen on the {recording.surface.name}, not on the {surface}")
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
    seed = settings["seed"]
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**32:
        raise ValueError(f"seed is {seed!r}; it must be a whole number from 0 to 2^32 - 1")


def _excitation_in_words(run: Run, window: float) -> str:
    least = windowed(run.observer.form, run.recording, window).least
    start = f"Over every window of {window:g} s the smallest eigenvalue of the integral of w wᵀ is at least {least:.2g}"
    if least > 1e-6:
        return f"{start}: persistently excited, so the outputs alone tell the hidden part."
    return f"{start}: not excited; one direction is seen only through the dynamics g, or not at all."


@lru_cache
def _at_the_truth(structure: Structure) -> Callable[..., list[np.ndarray]]:
    """The flow's Jacobian, and its derivative by the variance taken out, where the estimate is the truth."""
    observer = observer_of(*structure)
    form, equations = observer.form, observer.equations
    truth = (*form.x1, *form.x2)
    hats = equations.state[: len(truth)]
    flow = sp.ImmutableMatrix(equations.flow[: len(truth)])
    variance = next((gain.symbol for gain in observer.gains if gain.name == "noise_variance"), sp.Dummy())
    found = [*flow.jacobian(hats), *flow.diff(variance)]
    there = dict(zip(hats, truth, strict=True))
    symbols = (*truth, *equations.state[len(truth) :], *form.parameters, *equations.gains)
    return vectorised(symbols, [entry.subs(there, simultaneous=True) for entry in found])


def _error_in_words(structure: Structure, run: Run, window: float) -> list[str]:
    """How a small error grows or shrinks, and where noise pushes it, from the flow linearised at the truth."""
    observer, recording = run.observer, run.recording
    if run.diverged_at is not None:
        return []
    if observer.covariance is not None:
        spread = 2 * float(np.sqrt(max(0.0, run.covariance[-1, -1, -1])))
        return [f"{observer.name}: it claims to know the inverse distance to within {spread:.2g} (2σ) at the end."]
    if recording.truth is None:
        return []
    names = [s.name for s in observer.form.coordinates]
    order = [names.index(name) for name in (*observer.form.measured, *observer.form.hidden)]
    size = len(names)
    part = run.time >= run.time[-1] - window
    known = np.broadcast_to(recording.motion.known(run.time[part]), (int(part.sum()), 12))
    shape = [recording.surface.values[s] for s in recording.surface.parameters]
    gains = {gain.name: gain.value for gain in observer.gains}
    others = run.state[part, size:]
    entries = _at_the_truth(structure)(*recording.truth[part][:, order].T, *others.T, *known.T, *shape, *gains.values())
    J = np.stack(entries[: size**2], axis=-1).reshape(-1, size, size)
    with np.errstate(all="ignore"):  # what grows beyond all numbers is said so below
        steps = expm(J[:-1] * np.diff(run.time[part])[:, None, None])
        carried = np.eye(size) if not len(steps) else reduce(lambda before, step: step @ before, steps)
    factor = float(np.linalg.norm(carried, 2)) if np.isfinite(carried).all() else np.inf
    roots = ", ".join(f"{root:.3g}" for root in np.linalg.eigvals(J[-1]))
    does = "shrinks to" if factor < 1 else "may grow to"
    sentences = [
        f"{observer.name}: its error dynamics end with the eigenvalues {roots} per second; over the last {window:g} s "
        f"a small error {does} {factor:.2g} of its size."
    ]
    left = gains["noise_variance"] - (recording.noise_variance or 0.0)
    push = left * np.array([entry[-1] for entry in entries[size**2 :]])
    if np.abs(push).max() > 0:
        name, size_of = names[order[int(np.abs(push).argmax())]], push[np.abs(push).argmax()]
        sentences.append(
            f"{observer.name}: at the end noise pushes the estimate of {name} by {size_of:.2g} per second on average; "
            f"noise_variance takes it out where it equals the noise's variance, {recording.noise_variance or 0.0:.3g}."
        )
    return sentences
