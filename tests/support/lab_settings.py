"""Settings of the observer lab that its tests try, and the page's engine run on them in Node.js."""

import json
import warnings
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from javascript import run_script

import percept_obs.labs
from percept_obs.labs.observer.texts import BY_NAME, OWN_SWITCH, SURFACES, WAYS, key_of, system_of
from percept_obs.labs.shared.printed import file_of, unpacked
from percept_obs.system.motion import affine
from percept_obs.tracking.following import StepTooLong, track

FRONT = Path(percept_obs.labs.__file__).parent / "front"

NOISY = {"kind": "uniform", "size": 0.01}
SMOOTH = ["identifier_based", "extended_kalman"]
ALL = list(BY_NAME)
KEYS = [
    place.removeprefix("forms/")
    for place in unpacked(file_of("observer_lab").read_bytes())
    if place.startswith("forms/") and not place.endswith("+s")
]
"""Names of all forms without a size, as they were printed; deriving them takes a second."""
B_AT_THE_SIDE = [0.4, 0.3, 0.3]
PLANE = [0.2, -0.1, 0.9]

SMOOTH_CASES = {
    "opening": {},
    "both filters": {"observers": SMOOTH},
    "y1 alone": {"outputs": ["y1"], "observers": SMOOTH},
    "y2 alone": {"outputs": ["y2"], "observers": SMOOTH, "duration": 30.0},
    "noise and losses": {"noise": NOISY, "dropout": 0.2, "seed": 4, "observers": SMOOTH},
    "Gaussian noise": {"noise": {"kind": "gaussian", "size": 0.005}, "seed": 4294967295, "observers": SMOOTH},
    "a line to the next sample": {"hold": "first", "noise": NOISY, "dropout": 0.3, "period": 0.037},
    "the exact signal": {"hold": "exact", "period": 0.05},
    "start at zero": {"start": {"mode": "zero", "values": [0.0, 0.0, 0.0]}, "observers": SMOOTH},
    "chosen start": {"start": {"mode": "chosen", "values": [0.2, 0.7, 1.0]}, "observers": SMOOTH},
    "another b": {"b": B_AT_THE_SIDE, "observers": SMOOTH},
    "the point leaves": {"b": [0.5, 0.25, -0.9], "observers": SMOOTH, "noise": NOISY, "dropout": 0.1},
    "chained": {"surface": "chained", "observers": SMOOTH},
    "plane": {"surface": "plane", "normal": PLANE, "observers": SMOOTH, "outputs": ["y1"]},
    "sphere": {"surface": "sphere", "observers": SMOOTH},
    "unified": {"surface": "unified", "xi": 0.6, "observers": SMOOTH, "duration": 30.0},
    "switches": {
        "observers": ALL,
        "switches": {"sliding_mode": "sign", "range_identification": "fraction"},
        "duration": 9.0,
    },
    "planar motion": {"scenario": "planar", "observers": SMOOTH},
    "gains": {"gains": {"identifier_based": {"gain": 3.7, "noise_variance": 2e-5}}, "noise": NOISY},
    "a motion that is not the true one": {"believed": {"A": np.eye(3).tolist(), "b": [0.1, 0.2, 0.3]}},
    "(36)": {"scenario": "ma2005_eq36", "observers": SMOOTH, "outputs": ["y1"]},
    "few samples": {"period": 0.2, "duration": 1.0, "observers": SMOOTH},
}


def whole_model(lab):
    """A lab's model as the page has it: what was printed for it, and what Python hands over."""
    model = {}
    for place, texts in unpacked(lab.texts).items():
        group, _, name = place.partition("/")
        model.update({group: model.get(group, {}) | {name: texts}} if name else texts)
    return {**model, **json.loads(json.dumps({**lab.model, "written": lab.written}, allow_nan=False))}


SCRIPTS = {"observer_lab": "run_settings.js", "structure_lab": "run_structure.js", "points_lab": "run_points.js"}


def run_in_node(node, lab, tasks):
    """Answers of the page's engine to each of the settings of a lab."""
    return run_script(node, FRONT / "tests" / SCRIPTS[lab.kind], {"model": whole_model(lab), "tasks": tasks})


@lru_cache(maxsize=1)
def _lab():
    return percept_obs.labs.observer_lab("ma2005_eq35")


def runs(settings):
    """Python's runs of settings of the package's own lab, by the observers' names."""
    return _lab().runs(settings)


def python_runs(settings):
    """Python's runs of settings, chattering or not."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", StepTooLong)
        return runs(settings)


def as_array(numbers, width=None):
    """Numbers that came as JSON, where null stands for what is not finite, in rows of a width."""
    flat = np.array([np.nan if v is None else v for v in numbers], dtype=float)
    return flat if width is None else flat.reshape(-1, width)


def copied_runs(answer, settings, **names):
    """Runs of the code that the page copies, by the observers' names; `names` are those that the code lacks."""
    exec(answer["code"], names)
    several = len(settings["observers"]) > 1
    return {name: names[f"run_{name}" if several else "run"] for name in settings["observers"]}


PARTED = 1e-4
NUDGE = 1e-12
"""How far samples and gains are moved, relative to 1 or their size, to see how far a run carries a rounding error."""


def _nudged(values):
    signs = np.sign(np.random.default_rng(0).uniform(-1, 1, values.shape))
    return values + NUDGE * signs * np.fmax(1, np.abs(values))


def assert_follows_python(settings, told, tolerance=1e-8):
    """The page's runs of any settings are Python's, as far as numbers of 16 digits decide them.

    Random gains make observers unstable, stiff or switching without end; such a run multiplies the last digit, which
    two languages need not share.  How much it does is seen in Python alone, by moving samples and gains by 1e-12: page
    and Python may differ by the tolerance, relative to 1 or the value, and by as much as that; and once Python's own
    runs have parted by 1e-4, nothing is left to compare but whether they diverge.  Over the first second they may
    differ by 1e-6 and no more.  What is told is for each observer its "estimate", with None for what is not finite,
    and "divergedAt".  Python's runs are returned, by the observers' names.
    """
    believed = settings["believed"] and affine(settings["believed"]["A"], settings["believed"]["b"])
    ours = python_runs(settings)
    for name, run in ours.items():
        recording = run.recording
        y1, y2, inverse = settings["start"]["values"]
        values = [y1, y2, *recording.outputs[0, 2:], inverse]  # a size that is seen starts as it is seen
        start = {"own": None, "zero": np.zeros(len(values)), "chosen": values}[settings["start"]["mode"]]
        signal = recording.signal  # what an exact hold sees in place of samples
        nudged = replace(
            recording, outputs=_nudged(recording.outputs), signal=signal and (lambda t, of=signal: _nudged(of(t)))
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", StepTooLong)
            gains = {gain.name: gain.value * (1 + NUDGE) for gain in run.observer.gains}
            moved = track(nudged, run.observer.with_gains(**gains), start, run.hold, believed or None).estimate
        found = as_array(told[name]["estimate"], run.estimate.shape[1])
        assert found.shape == run.estimate.shape
        assert (told[name]["divergedAt"] is None) == (run.diverged_at is None)
        with np.errstate(all="ignore"):  # what grows without bounds is compared as far as it is finite
            size = np.fmax(1, np.abs(run.estimate))
            parted = np.nan_to_num(np.abs(moved - run.estimate) / size, nan=0.0).max(axis=1)
            off = np.abs(found - run.estimate) / size
        own = np.maximum.accumulate(parted)[:, None]
        decided = np.broadcast_to(own < PARTED, off.shape)
        there = np.isfinite(run.estimate)
        assert (np.isfinite(found) == there)[decided].all()
        assert (off <= tolerance + own)[decided & there].all(), (name, off[decided & there].max())
        early = decided & there & (run.time <= run.time[0] + 1)[:, None]
        assert (off[early] <= 1e-6).all(), (name, off[early].max())
    return ours


def random_settings(lab, seed):
    """Settings that make sense, drawn over every control of the lab."""
    rng = np.random.default_rng(seed)

    def one(*values):
        return values[rng.integers(len(values))]

    surface = one(*SURFACES)
    outputs = list(one(*system_of(surface).output_choices))
    model = whole_model(lab)
    refused = model["forms"][key_of(surface, outputs)]["refused"]
    chosen = [name for name in BY_NAME if rng.random() < 0.4 and name not in refused]
    gains = {
        name: {g["name"]: float(rng.uniform(g["low"], g["high"])) if rng.random() < 0.7 else g["value"] for g in known}
        for name, known in ((name, model["observers"][name]["gains"]) for name in BY_NAME)
    }
    return {
        "surface": surface,
        "normal": PLANE,
        "outputs": outputs,
        "observers": chosen or ["identifier_based"],
        "gains": gains,
        "switches": {name: one(*WAYS[name]) for name in OWN_SWITCH},
        "b": rng.uniform(-1, 1, 3).tolist(),
        "X0": [*rng.uniform(-2, 2, 2).tolist(), float(rng.uniform(3, 8))],
        "noise": {"kind": one("uniform", "gaussian"), "size": float(one(0, rng.uniform(0, 0.05)))},
        "dropout": float(one(0, rng.uniform(0, 0.9))),
        "seed": int(rng.integers(100)),
        "period": float(one(0.01, 0.02, 0.1, rng.uniform(0.005, 0.2))),
        "duration": float(rng.uniform(2, 20)),
        "hold": one("zero", "first", "exact"),
        "start": {"mode": one("own", "zero", "chosen"), "values": rng.uniform(-2, 2, 3).tolist()},
        "believed": one(None, None, {"A": np.eye(3).tolist(), "b": [0.1, 0.2, 0.3]}),
    }
