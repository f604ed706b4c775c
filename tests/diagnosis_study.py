"""Recordings of a camera that a hand carries, clean ones and ones with a mistake, on which `diagnose` is measured."""

import warnings
from collections import Counter
from dataclasses import replace

import numpy as np
from distrust_study import REST, waves

from percept_obs import Camera, Gaussian, Scenario, diagnose, pinhole, record, rigid
from percept_obs.studies.diagnosis.experiments import FRAMES, later, turned
from percept_obs.system.surfaces import BehindCamera

FAULTS = (
    *("time offset", "focal length", "sign of w", "frames swapped"),
    *("pixels", "distortion ignored", "mismatch"),
)


def drawn(seed, points=5):
    """Recordings of several points by one camera, and numbers to go on with."""
    draw = np.random.default_rng(seed)
    motion = rigid(waves(draw, draw.uniform(0.1, 0.3)), waves(draw, draw.uniform(0.3, 0.6)), REST)
    duration, camera = draw.uniform(6, 10), Camera(draw.choice([0.04, 0.05]), Gaussian(10 ** draw.uniform(-3, -2.5)))
    found = []
    while len(found) < points:
        depth = draw.uniform(2, 8)
        place = depth * np.array([*draw.uniform(-0.5, 0.5, 2), 1.0])
        scenario = Scenario(f"point {len(found)}", motion, place, duration, pinhole())
        try:
            recording = record(scenario, camera=camera, seed=int(draw.integers(2**31)))
        except BehindCamera:
            continue
        if np.abs(recording.truth[:, :2]).max() < 1.2:
            found.append(replace(recording, truth=None, signal=None))
    return found, draw


def spoiled(recordings, fault, draw):
    """The recordings as somebody brings them who made one mistake."""
    motion, sign = recordings[0].motion, draw.choice([-1, 1])
    if fault == "time offset":
        wrong = later(motion, sign * draw.uniform(0.05, 0.2))
    elif fault == "sign of w":
        wrong = replace(motion, A=motion.A.T)
    elif fault == "frames swapped":
        wrong = turned(motion, [*FRAMES.values()][draw.integers(len(FRAMES))].T)
    else:
        wrong = motion
    bend = sign * draw.uniform(0.1, 0.3)
    change = {
        "focal length": lambda y: y * (1 + 0.12 * sign),
        "pixels": lambda y: 500 * y + (320, 240),
        "distortion ignored": lambda y: y * (1 + bend * (y**2).sum(axis=-1, keepdims=True)),
    }.get(fault, lambda y: y)
    found = [replace(recording, motion=wrong, outputs=change(recording.outputs)) for recording in recordings]
    if fault == "mismatch":
        one, other = draw.choice(len(found), 2, replace=False)
        outputs, place = found[one].outputs.copy(), int(len(found[one].time) * draw.uniform(0.2, 0.8))
        outputs[place:] = found[other].outputs[place:]
        found[one] = replace(found[one], outputs=outputs)
    return found


def named(fault, seed):
    """Key of the mistake that is named first; the fault "nothing" leaves the recordings as they are."""
    recordings, draw = drawn(seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return diagnose(spoiled(recordings, fault, draw)).named


def figures(count, clean):
    """Counts of the keys that are named first, by the mistake that was made."""
    found = {fault: Counter(named(fault, seed) for seed in range(count)) for fault in FAULTS}
    return found | {"nothing": Counter(named("nothing", 1000 + seed) for seed in range(clean))}
