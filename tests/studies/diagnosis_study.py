"""Recordings of a camera that a hand carries, clean ones and ones with mistakes, on which `diagnose` is measured."""

import warnings
from copy import deepcopy
from dataclasses import replace
from functools import cache

import numpy as np
from distrust_study import REST, waves

from percept_obs import Camera, Gaussian, Scenario, affine, diagnose, pinhole, record, rigid, scenarios
from percept_obs.studies.diagnosis.paths import SPINS
from percept_obs.system.motion import Motion, coefficients
from percept_obs.system.signal import OverTime, Signal
from percept_obs.system.surfaces import BehindCamera

FRAMES = [
    np.array(rows)
    for rows in (
        [[0, -1, 0], [0, 0, -1], [1, 0, 0]],
        [[0, 0, 1], [-1, 0, 0], [0, -1, 0]],
        [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
    )
]

MOTION_FAULTS = ("time offset", "sign of w_c", "sign of v", "frames swapped", "gyro bias", "scale drift")
IMAGE_FAULTS = ("focal length", "distortion ignored", "flipped axis", "rolling shutter", "mismatch", "outliers")
FAULTS = (*MOTION_FAULTS, *IMAGE_FAULTS, "pixels")
ORDER = (
    "rolling shutter",
    "mismatch",
    "distortion ignored",
    "focal length",
    "flipped axis",
    "outliers",
    "pixels",
    *MOTION_FAULTS,
)


def drawn(seed, points=5):
    """Recordings of several points by one camera, with the signal, and numbers to go on with."""
    return deepcopy(_drawn(seed, points))


@cache  # each mistake is made in the same ones
def _drawn(seed, points):
    draw = np.random.default_rng(seed)
    motion = rigid(
        camera_angular_velocity=waves(draw, -draw.uniform(0.1, 0.3)),
        camera_velocity=waves(draw, draw.uniform(0.3, 0.6)),
    )
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
            found.append(recording)
    return found, draw


def believed(motion, change):
    """The motion with its rates changed: a function of times, of A and of b, shapes (T, 3, 3) and (T, 3)."""

    def rows(times):
        A, b = change(times, *rates(motion, times))
        return np.hstack([A.reshape(-1, 9), b])

    entries = affine()
    return Motion("believed", entries.A, entries.b, entries.parameters, Signal(OverTime(rows)))


def rates(motion, times):
    """A and b of a motion at times."""
    return coefficients(motion, np.broadcast_to(motion.known(times), (len(times), len(motion.parameters))))


def spoiled(recordings, faults, draw):
    """The recordings as somebody brings them who made some mistakes, those of the images first."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for fault in sorted(faults, key=ORDER.index):
            recordings = _spoiled(recordings, fault, draw)
        return [replace(each, signal=None, truth=None) for each in recordings]


def _spoiled(recordings, fault, draw):
    motion, sign = recordings[0].motion, draw.choice([-1, 1])
    last = float(recordings[0].time[-1])
    late, rise, into = sign * draw.uniform(0.03, 0.2), draw.uniform(0.15, 0.4), FRAMES[draw.integers(len(FRAMES))].T
    bias = draw.normal(size=3)
    bias *= draw.uniform(0.01, 0.05) / np.linalg.norm(bias)
    changes = {
        "time offset": lambda t, A, b: rates(motion, t + late),
        "sign of w_c": lambda t, A, b: (np.swapaxes(A, 1, 2), b),
        "sign of v": lambda t, A, b: (A, -b),
        "frames swapped": lambda t, A, b: (into @ A @ into.T, b @ into.T),
        "gyro bias": lambda t, A, b: (A - np.tensordot(bias, SPINS, 1), b),
        "scale drift": lambda t, A, b: (A, b * (1 + rise * t / last)[:, None]),
    }
    wrong = believed(motion, changes[fault]) if fault in changes else motion
    bend, ratio, axis = sign * draw.uniform(0.1, 0.3), 1 + sign * draw.uniform(0.03, 0.15), draw.integers(2)
    readout = sign * draw.uniform(0.015, 0.03)
    image = {
        "focal length": lambda y: y * ratio,
        "pixels": lambda y: 500 * y + (320, 240),
        "distortion ignored": lambda y: y * (1 + bend * (y**2).sum(axis=-1, keepdims=True)),
        "flipped axis": lambda y: y * (1 - 2 * (np.arange(2) == axis)),
    }.get(fault, lambda y: y)
    found = [replace(each, motion=wrong, outputs=image(each.outputs)) for each in recordings]
    if fault == "rolling shutter":
        for k, each in enumerate(recordings):
            clean, rows = each.signal(each.time), each.signal(each.time)[:, 1]
            inside = np.clip(each.time + readout * rows, 0, last)
            moved = each.signal(np.sort(inside))[np.argsort(np.argsort(inside))]
            found[k] = replace(found[k], outputs=each.outputs - clean + moved)
    if fault == "mismatch":
        one, other = draw.choice(len(found), 2, replace=False)
        outputs, count = found[one].outputs.copy(), len(found[one].time)
        begin = int(count * draw.uniform(0.2, 0.6))
        end = draw.choice([count, begin + int(count * draw.uniform(0.2, 0.33))])
        outputs[begin:end] = found[other].outputs[begin:end]
        found[one] = replace(found[one], outputs=outputs)
    if fault == "outliers":
        for k, each in enumerate(found):
            outputs, wild = each.outputs.copy(), draw.random(len(each.time)) < draw.uniform(0.02, 0.08)
            outputs[wild] += draw.normal(size=(wild.sum(), 2)) * 0.3
            found[k] = replace(each, outputs=outputs)
    return found


def clean(seed):
    """A clean recording or several: of a known scenario, or of a camera that only shifts, only turns or is at rest."""
    draw = np.random.default_rng([seed, 1])
    noise = Camera(draw.choice([0.04, 0.05, 0.1]), Gaussian(draw.choice([0.0, 1e-3, 3e-3, 1e-2])))
    kinds = (
        scenarios.ma2005_eq35,
        scenarios.ma2005_eq36,
        scenarios.planar,
        scenarios.drive,
        "hand",
        "shift",
        "turn",
        "rest",
    )
    kind = kinds[seed % len(kinds)]
    told = bool(draw.integers(2))
    while True:
        duration = draw.uniform(2, 80 if seed % 3 else 10)
        try:
            if callable(kind):
                scene = kind()
                found = [record(scene, min(duration, scene.duration), noise, seed)]
            else:
                turning, velocity = waves(draw, -draw.uniform(0.05, 0.3)), waves(draw, draw.uniform(0.1, 0.6))
                if kind in ("shift", "rest"):
                    turning = REST
                if kind in ("turn", "rest"):
                    velocity = REST
                motion = rigid(camera_angular_velocity=turning, camera_velocity=velocity)
                found = []
                for number in range(draw.integers(1, 7)):
                    place = draw.uniform(2, 8) * np.array([*draw.uniform(-0.4, 0.4, 2), 1.0])
                    scene = Scenario(kind, motion, place, min(duration, 40), pinhole())
                    found.append(record(scene, None, noise, seed + 1000 * number))
                if max(np.abs(each.truth[:, :2]).max() for each in found) > 1.5:
                    continue
        except BehindCamera:
            continue
        return [replace(each, truth=None, noise_variance=each.noise_variance if told else None) for each in found]


def diagnosed(recordings):
    """The diagnosis without warnings."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return diagnose(recordings)


def alone(fault, seed):
    """The key named first where one mistake was made; "cannot tell" if the diagnosis says so of it."""
    recordings, draw = drawn(seed)
    found = diagnosed(spoiled(recordings, [fault], draw))
    rightly = fault in found.not_told or any(fault in each.instead for each in found.findings)
    return "cannot tell" if found.named != fault and rightly else found.named


PAIRS = [(a, b) for k, a in enumerate(FAULTS[:-1]) for b in FAULTS[k + 1 : -1]]


def together(seed):
    """Two mistakes that were made, and the diagnosis."""
    recordings, draw = drawn(seed)
    pair = PAIRS[draw.integers(len(PAIRS))]
    return pair, diagnosed(spoiled(recordings, pair, draw))
