"""Bad calls of everything public: one argument of a call that works is replaced by what does not belong there.

As a program it makes the asked number of them, each within 5 s and all within 2 GiB, and prints what became of them.
"""

import atexit
import json
import os
import random
import shutil
import signal
import sys
import tempfile
import traceback
import warnings
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import sympy as sp
from camera_paths import write_stereo_mat

import percept_obs as po
from percept_obs import observers, points, structure
from percept_obs.compile.equations import Equations
from percept_obs.observability import empirical_gramian, error_gramian, instantaneous
from percept_obs.observers import gains
from percept_obs.observers.integral_sliding_mode import tolerable_amplification, ultimate_bound
from percept_obs.points import gramian
from percept_obs.points import scenarios as points_scenarios
from percept_obs.points.manoeuvre import Manoeuvre
from percept_obs.points.ray import ray_turning
from percept_obs.recording import render
from percept_obs.recording.pixels import PixelCamera
from percept_obs.recording.pose_files import write_tum
from percept_obs.recording.stereo_mat import read_stereo_mat
from percept_obs.structure import pixels
from percept_obs.structure import scenarios as structure_scenarios
from percept_obs.studies import chatter, comparison, least_squares, tuning
from percept_obs.system.signal import Signal

PACKAGE = str(Path(po.__file__).parent)
SECONDS, BYTES = 5, 2 << 30

CANARY = "__import__('os').environ.__setitem__('CANARY', 'sang')"
"""Text that leaves a trace in the environment if somebody runs it."""

ALIEN = (object(), 1j, [1j, 2.0, 3.0], b"bytes", CANARY, [CANARY, CANARY, CANARY], np.array([[1j]]))
"""What is right nowhere, but text where text is asked for."""
STRANGE = (
    *(True, None, "", "abc", ["y1", "y2"], {}, {"a": 1}, [], (), set(), lambda: None, int, range(0), [[1, 2], [3]]),
    *(float("nan"), float("inf"), -float("inf"), -1, 0, 0.5, 7, 1e308, -1e308, 10**12, 10**400, 5e-324),
    *(np.zeros((0, 3)), np.zeros((2, 2, 2, 2)), np.full(3, np.nan), np.ones(7), np.eye(3), np.float32(0.1)),
    *(sp.Symbol("q"), sp.oo, sp.Rational(1, 3), np.array(["a", "b"]), np.array([None, 1.0])),
)
"""What is right in some places."""


@cache
def calls():
    """Calls that work: name -> (function, arguments by name); "*" are positional ones."""
    motion = po.affine([[0, 0.1, 0], [0, 0, 0], [0, 0, 0.1]], [0.3, 0.1, 0.2])
    turning = po.rigid(camera_angular_velocity=[0, -0.1, -0.2], camera_velocity=[0.3, 0, 0.1])
    system = po.PerspectiveSystem(po.affine(), po.pinhole())
    form = system.measure("y1", "y2")
    scenario = po.Scenario("s", motion, (1, 1, 3), 2.0, po.pinhole())
    recording = po.record(scenario, 2, po.Camera(0.05, po.Uniform(0.01)))
    observer, filter_ = po.ibo(form), po.ekf(form)
    run, filtered = po.track(recording, observer), po.track(recording, filter_)
    bound, moving = po.cramer_rao(recording, form), po.PerspectiveSystem(motion, po.pinhole())
    body = points.rigid_body(2, [0, 0, 0.1], [0.1, 0, 0], [0, 0.2, 0])
    state = (0.2, 0.3, 2, 0.1, 0.2, 0.3)
    bodies = po.PointsScenario("b", body, state, 2.0)
    seen = po.record(bodies, 2, po.Camera(0.05))
    luenberger = po.luenberger(body, 0.5)
    followed = po.track(seen, luenberger, [0.0] * 6)
    choice = structure.StructureAndMotion(("v_p1", "v_p2", "v_p3"))
    case = structure_scenarios.chwa2019_simulation("IV.B")
    pictures = po.record(case, 0.1)
    camera = PixelCamera((720, 720), (320, 240))
    square = np.array([[0, 0], [1, 0], [0, 1], [1, 1.0]])
    ismo = po.ismo(form)
    poses = po.Poses(np.arange(9.0), np.zeros((9, 3)), np.tile([0, 0, 0, 1.0], (9, 1)))
    folder = Path(tempfile.mkdtemp())
    atexit.register(shutil.rmtree, folder)
    (folder / "tracks.csv").write_text("time,id,u,v,Z,laser\n0,a,320,240,2,2\n1,a,330,240,2,2\n2,a,340,250,2,2\n")
    write_tum(folder / "poses.txt", poses)
    (folder / "data.csv").write_text("0,0,0,0,1,0,0,0\n1000000000,0,0,1,1,0,0,0\n")
    mount = po.Poses(np.arange(2.0), np.zeros((2, 3)), np.stack([np.eye(3)] * 2))
    write_stereo_mat(folder / "s.mat", poses, mount, np.ones((len(poses.time), 2, 4)), camera, 0.1)
    good = [
        (po.affine, {"A": np.eye(3), "b": np.ones(3), "times": None}),
        (po.rigid, {"camera_angular_velocity": [0, 0, 1], "camera_velocity": [0, 0, 1], "point_velocity": [0, 0, 0]}),
        (po.linear, {"A": np.eye(2), "v": np.ones(2), "states": 2}),
        (Signal, {"samples": [[1.0], [2.0]], "times": [0.0, 1.0]}),
        (motion.known, {"times": [0.0, 1.0]}),
        (po.plane, {"normal": (0, 0.1, 1), "outputs": 2}),
        (po.ImagingSurface, _parts(po.pinhole(), "name", "image", "distance", "ray")),
        (po.pinhole().project, {"points": [[1.0, 2.0, 3.0]]}),
        (po.pinhole().locate, {"coordinates": [[1.0, 2.0, 3.0]]}),
        (po.PerspectiveSystem, {"motion": po.affine(), "surface": po.pinhole()}),
        (system.measure, {"*": ["y1"]}),
        (system.partition, {"*": ["y1"]}),
        *((make, {"form": form, make.gains[0].name: make.gains[0].value}) for make in observers.OBSERVERS),
        (po.smo, {"form": form, "switch": "sign"}),
        (observers.lao, {"form": form, "iterates": 2}),
        (observer.with_gains, {"gain": 5.0}),
        (observer.initial_state, {"outputs": {"y1": 0.0, "y2": 0.0}, "start": {"y3": 1.0}}),
        (observer.lambdify, {"motion": motion, "measured": lambda t: (0.0, 0.0)}),
        (po.with_point, {"observer": observer}),
        (Equations, {"state": (sp.Symbol("x"),), "flow": (1 - sp.Symbol("x"),)}),
        (ultimate_bound, {"observer": ismo, "disturbance": 0.5, "time": 1.0}),
        (tolerable_amplification, {"observer": ismo, "noise": 0.1, "hidden": 1.0, "time": 1.0}),
        (po.Camera, {"period": 0.1, "noise": po.Uniform(0.1), "dropout": 0.1, "reach": 3.0}),
        (po.Uniform, {"bound": 0.1}),
        (po.Gaussian, {"sigma": 0.1}),
        (po.Camera(0.1).times, {"duration": 1.0}),
        (po.Scenario, {"name": "s", "motion": motion, "position": (1, 1, 3), "duration": 1.0, "surface": po.pinhole()}),
        (scenario.points, {"times": [0.0, 1.0]}),
        (scenario.coordinates, {"times": [0.0, 1.0]}),
        (po.scenarios.ma2005_eq35, {"surface": po.pinhole()}),
        (po.record, {"scenario": scenario, "duration": 1.0, "camera": po.Camera(0.1), "seed": 1}),
        (po.Recording, _parts(recording, "time", "outputs", "names", "view", "motion", *FURTHER)),
        (recording.between, {"begin": 0.5, "end": 1.5}),
        (recording.without, {"begin": 0.5, "end": 1.5, "point": 0}),
        (recording.sightings, {"absence": 1.0}),
        (recording.reference, {"name": "truth"}),
        (
            po.track,
            {"recording": recording, "observer": observer, "start": [0.1, 0.1, 0.5], "hold": "zero", "step": 0.01}
            | {"believed": motion, "language": "python"},
        ),
        (run.settling_time, {"tolerance": 0.05}),
        (run.verdict, {"tolerance": 0.05}),
        (run.rms, {"begin": 0.0, "end": 1.0}),
        (po.PointsForm, {"motion": turning, "C": np.eye(3), "surface": po.pinhole(), "names": ("a", "b", "c")}),
        (points.independent_points, {"motion": turning, "points": 2, "surface": po.pinhole()}),
        (points.rigid_body, {"points": 2, "camera_angular_velocity": [0, 0, 1], "point_velocity": [0, 0, 1]}),
        (points.body_with_origin, {"points": 1, "camera_velocity": [0, 0, 1], "body_angular_velocity": _spinning}),
        (po.luenberger, {"form": body, "P": 1.0}),
        (points.constant, {"P": 1.0}),
        (points.scheduled, {"P": [[1.0], [2.0]], "times": [0.0, 1.0]}),
        (points.lyapunov, {"start": 1.0, "decrease": 0.0}),
        (points.riccati, {"start": 1.0, "forgetting": 0.3}),
        (po.FirstSight, {"depth": 3.0, "absence": 1.0}),
        (po.PointsScenario, {"name": "b", "form": body, "state": state, "duration": 1.0}),
        (points_scenarios.moving_body, {"points": 2}),
        (Manoeuvre, {"turning": 1.0, "spin": 0.5, "input": 1.0, "camera_velocity": (0.0, 0.0, 0.1)}),
        (body.locate, {"states": state}),
        (body.outputs, {"states": state}),
        (body.information, {"outputs": np.ones((2, 2))}),
        (body.coefficients, {"times": [0.0, 1.0]}),
        (body.E, {"state": body.state}),
        (body.H, {"state": body.state}),
        (bodies.coordinates, {"times": [0.0, 1.0]}),
        (followed.decay_rate, {"begin": 0.0, "end": 1.0}),
        (followed.conditions, {"epsilon": 1.0}),
        (ray_turning, {"form": body, "times": [0.0], "states": [state]}),
        (structure.StructureAndMotion, {"unknown": ("v_p1",), "zero": ("v_p2",), "earlier": (), "scale": 2.0}),
        (choice.theta_values, {"scale": 1.0, "motion": turning, "times": [0.0, 1.0]}),
        (structure.GivenDepth, {"noise": po.Uniform(0.1), "bias": 0.1, "drift": 0.1}),
        (structure.PatchDepth, {"offsets": structure.grid_patch(1.0)}),
        (structure.grid_patch, {"side": 1.0, "count": 3}),
        (structure.ScaledDepthCamera, {"period": 0.01, "pixels": camera, "ratio": pixels.SignalToNoise(60.0)}),
        (structure_scenarios.chwa2019_simulation, {"section": "IV.A", "chwa_rotation": (0.0, 0.0, 0.1)}),
        (structure_scenarios.chwa2019_semigeneral, {"set_up": "simulation"}),
        (structure.seen_as, {"recording": pictures, "choice": case.choice, "motion": case.motion, "scale": 4.0}),
        (structure.linear_view, {"recording": pictures}),
        (PixelCamera, {"focal": (720, 720), "centre": (320, 240), "size": (640, 480), "distortion": (0.1, 0, 0, 0)}),
        (camera.pixels, {"image": [[0.1, 0.2]]}),
        (camera.image, {"pixels": [[100.0, 200.0]]}),
        (camera.sees, {"pixels": [[100.0, 200.0]]}),
        (pixels.SignalToNoise, {"decibels": 60.0}),
        (pixels.SignalToNoise(60.0).sigma, {"pixels": [[100.0, 200.0]]}),
        (pixels.homography, {"reference": square, "images": square + 0.1}),
        (po.Poses, {"time": poses.time, "position": poses.position, "orientation": poses.orientation}),
        (po.Clock, {"zero": 5, "tick": 1e-3}),
        (poses.mounted, {"position": [0.0, 0.0, 1.0], "orientation": [0.0, 0.0, 0.0, 1.0]}),
        (poses.path, {}),
        (
            po.rigid_from_poses,
            {"times": poses.time, "positions": poses.position, "orientations": poses.orientation}
            | {"frame": "camera", "sigma": (0.001, 0.001), "correlated": 0.1},
        ),
        (po.read_tum, {"path": folder / "poses.txt", "clock": po.Clock()}),
        (po.read_euroc, {"path": folder / "data.csv", "clock": po.Clock(tick=1e-9)}),
        (read_stereo_mat, {"path": folder / "s.mat", "shortest": 0.5, "gap": 1.0}),
        (
            po.Recording.from_csv,
            {"path": folder / "tracks.csv", "motion": poses.motion(), "surface": po.pinhole(), "time": "time"}
            | {"point": "id", "depth": "Z", "distances": ["laser"], "camera": camera, "pixels": ("u", "v")}
            | {"pixel_sigma": 1.0, "clock": po.Clock(), "gap": 5.0, "shortest": 0.5},
        ),
        (camera.variance, {"sigma": 1.0}),
        (po.instantaneous, {"form": form}),
        (instantaneous(form).circle, {"threshold": 0.1}),
        (po.windowed, {"form": form, "recording": recording, "window": 1.0}),
        (po.how_observable, {"recording": recording, "system": form, "window": 1.0}),
        (po.cramer_rao, {"recording": recording, "system": form, "prior": np.eye(3), "doubt": 0.1}),
        (po.efficiency, {"runs": [run, replace(run)], "bound": bound}),
        (po.lie_derivatives, {"system": form, "orders": 1, "varying": False}),
        (error_gramian, {"recording": recording, "system": form, "window": 1.0}),
        (empirical_gramian, {"recording": recording, "system": form, "window": 1.0}),
        (
            po.bound_map,
            {"system": moving, "seconds": 1.0, "distance": 4.0, "measured": ("y1",), "y1": (-1, 1), "resolution": 4},
        ),
        (po.steering, {"system": system}),
        (po.steered, {"scenario": scenario}),
        (gramian.gramian, {"recording": seen, "window": 1.0}),
        (gramian.linear_gramian, {"recording": seen, "window": 1.0}),
        (gramian.decay_bound, {"recording": seen, "observer": luenberger, "window": 1.0}),
        (comparison.compare, {"recordings": [recording], "observers": [observer], "tolerance": 0.1, "after": 0.5}),
        (comparison.relative_distance_errors, {"runs": [run], "after": 1.0, "reference": "truth", "absence": 1.0}),
        (tuning.best_setting, {"recordings": [recording], "observers": [observer], "follow": po.track}),
        (po.check_consistency, {"run": filtered, "samples": 5, "after": 0.1}),
        (chatter.chatter, {"recording": recording, "observer": observer, "steps": [0.01], "after": 0.1}),
        (chatter.effort, {"scenario": scenario, "observer": observer, "duration": 0.5, "most": 300}),
        (least_squares.moving_window_least_squares, {"recording": recording, "window": 1.0}),
        (render, {"recording": recording, "count": 2, "size": 8}),
        (gains.grid, {"gain": [1.0, 2.0]}),
    ]
    return [(getattr(f, "__qualname__", type(f).__name__), f, arguments) for f, arguments in good]


def _spinning(time):
    return [np.sin(time), np.cos(time), 0.3]


EXTREME = (CANARY, *(value for value in STRANGE if isinstance(value, int | float) and abs(value) in (10**12, np.inf)))
"""What every argument meets."""


FURTHER = ("truth", "noise_variance", "distances", "source")


def _parts(value, *names):
    return {name: getattr(value, name) for name in names}


def drawn(count, seed=0):
    """So many of all bad calls: (name, function, arguments, the one that is bad)."""
    every = [
        (name, function, arguments, key, value)
        for name, function, arguments in calls()
        for key in arguments
        for value in (*ALIEN, *STRANGE, recorded(), po.pinhole)
        if not (callable(value) and key in ("follow", "measured", "P"))  # any function is right there, and may fail
    ]
    draw = random.Random(seed)
    draw.shuffle(every)
    # what is too large, not a number, or text comes first: every argument meets it
    every.sort(key=lambda call: not any(call[-1] is value for value in EXTREME))
    return every[:count]


def recorded():
    """A recording, which is right where recordings are."""
    return next(arguments["recording"] for name, _, arguments in calls() if name == "track")


def outcome(function, arguments, key, value):
    """What became of a call: "right", "ours", or in words what is wrong with it."""
    positional = arguments.get("*", [])
    named = {k: v for k, v in arguments.items() if k != "*"} | ({} if key == "*" else {key: value})
    os.environ.pop("CANARY", None)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = function(*([value] if key == "*" else positional), **named)
    except BaseException as error:
        verdict = _judged(error, key, value)
    else:
        unseen = function.__name__ in ("without", "read_stereo_mat", "image", "pixels")  # NaN is what was not seen
        verdict = "NaN without a word" if _has_nan(found) and not unseen else "right"
        if verdict == "right" and any(value is alien for alien in ALIEN) and not _may_be_text(function, key, value):
            verdict = "accepted"
    return "it ran text" if "CANARY" in os.environ else verdict


def _judged(error, key, value):
    text, where = str(error), traceback.extract_tb(error.__traceback__)[-1]
    ours = type(error).__module__.startswith("percept_obs")
    raised = where.filename.startswith(PACKAGE) and (where.line or "").startswith("raise")
    plain = type(error) in (ValueError, FileNotFoundError) and raised
    if not (ours or plain):
        return f"{type(error).__name__} of another: {text[:150]}"
    told = text.lower().replace("_", " ").replace("the ", "")
    names = [name.replace("_", " ").lower() for name in (*([key] if key != "*" else ["measure"]), *ALSO.get(key, ()))]
    if not any(name in told for name in names):
        return f"does not name {key}: {text[:200]}"
    return "ours" if len(text) > 25 else f"says too little: {text}"


ALSO = {
    "*": ["names"],
    "begin": ["between"],
    "times": ["time"],
    "names": ["named"],
    "runs": ["run"],
    "end": ["between"],
    "set_up": ["set-up"],
    "decibels": ["db"],
    "scale": ["d_s"],
    "steps": ["step"],
    "reference": ["name"],
    "absence": ["sighting"],
}
"""What an argument is called in sentences, where that is another word."""


def _may_be_text(function, key, value):
    return isinstance(value, str) and key in ("name", "source", "language", "section")


def _has_nan(found, depth=0):
    if isinstance(found, float | np.floating):
        return bool(np.isnan(found))
    if isinstance(found, np.ndarray):
        return found.dtype.kind == "f" and bool(np.isnan(found).any())
    if isinstance(found, dict):
        return any(_has_nan(each, depth + 1) for each in found.values())
    if isinstance(found, list | tuple):
        return any(_has_nan(each, depth + 1) for each in found)
    return depth < 2 and hasattr(found, "__dict__") and any(_has_nan(each, depth + 1) for each in vars(found).values())


class TooLong(BaseException):
    """A call took longer than it may."""


def _stop(*_):
    raise TooLong(f"longer than {SECONDS} s")


def main(count, seed):
    """Make the calls and print, as JSON, how many ended how, and those that ended wrong."""
    import resource  # which Windows has not

    chosen = drawn(count, seed)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + BYTES, used + BYTES))
    signal.signal(signal.SIGALRM, _stop)
    ends, wrong = {"right": 0, "ours": 0}, []
    for name, function, arguments, key, value in chosen:
        signal.setitimer(signal.ITIMER_REAL, SECONDS)
        end = outcome(function, arguments, key, value)
        signal.setitimer(signal.ITIMER_REAL, 0)
        if end in ends:
            ends[end] += 1
        else:
            wrong.append(f"{name}({key}={str(value)[:60]!r}): {end}")
    print(json.dumps(ends | {"others": wrong}))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
