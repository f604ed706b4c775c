"""Runs that cannot be right, and good ones, on which the trust in estimates without a truth is measured."""

import warnings
from dataclasses import replace
from functools import cache

import numpy as np

from percept_obs import Camera, Gaussian, PerspectiveSystem, Scenario, pinhole, record, rigid, track
from percept_obs.system.surfaces import BehindCamera

FORM = PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2")
REST, RIGHT = (0.0, 0.0, 0.0), 0.05


def waves(draw, size, count=3):
    """A vector that varies like what a hand carries: a few sines of 0.1 to 0.5 Hz with this root mean square."""
    rates, phases = 2 * np.pi * draw.uniform(0.1, 0.5, (count, 3)), draw.uniform(0, 2 * np.pi, (count, 3))
    scale = size * np.sqrt(2 / 3 / count)
    return lambda time: scale * np.sin(rates * time + phases).sum(axis=0)


def moved(draw, kind, constant):
    """The true motion, the believed one, and where the point is at first.

    Where the camera's motion is constant, an object that moves in the plane of the line of sight and of that motion
    leaves no trace: there the object moves across it.
    """
    depth, speed = draw.uniform(2, 6), draw.uniform(0.3, 0.7)
    place = depth * np.array([*draw.uniform(-0.3, 0.3, 2), 1.0])
    turning = waves(draw, -draw.choice([0.0, 0.1]))
    velocity = waves(draw, speed)
    if constant:
        turning = turning(0.0)
        velocity = speed * place_across(draw, place)
    if kind == "standing camera":
        return (rigid(camera_angular_velocity=turning),) * 2 + (place,)
    if kind == "focus of expansion":
        return (rigid(camera_velocity=speed / 4 * place / np.linalg.norm(place)),) * 2 + (place,)
    resting = rigid(camera_angular_velocity=turning, camera_velocity=velocity)
    if kind == "good":
        return resting, resting, place
    own = np.cross(place, velocity) if constant else draw.normal(size=3)
    own *= speed * draw.uniform(0.5, 1.5) / np.linalg.norm(own)
    return rigid(camera_angular_velocity=turning, camera_velocity=velocity, point_velocity=own), resting, place


def place_across(draw, place):
    """A direction that shows the point from the side, at 30 degrees at least to the line of sight."""
    while True:
        direction = draw.normal(size=3)
        direction /= np.linalg.norm(direction)
        if np.linalg.norm(np.cross(direction, place)) > 0.5 * np.linalg.norm(place):
            return direction


@cache
def drawn(seed, kind, constant=False):
    """A recording of some seconds in which the point stays in sight, and the believed motion."""
    draw = np.random.default_rng(seed)
    while True:
        true, believed, place = moved(draw, kind, constant)
        sigma, duration = 10 ** draw.uniform(-3.3, -2.3), draw.uniform(5, 8)
        camera = Camera(draw.choice([0.02, 0.04]), Gaussian(sigma))
        try:
            recording = record(Scenario(kind, true, place, duration, pinhole()), camera=camera, seed=seed)
        except BehindCamera:
            continue
        if np.abs(recording.truth[:, :2]).max() < 1.5 and recording.distance.min() > 0.8:
            return replace(recording, unit=0.7), believed


def observed(make, recording):
    """The observer with gains for a point some metres away that a hand's motion shows."""
    observer = make(FORM)
    if make.key == "extended_kalman":
        return observer.with_gains(noise_variance=recording.noise_variance, hidden_variance=0.05)
    return observer.with_gains(**GAINS.get(make.key, {}))


GAINS = {
    "de_luca": {"measured_gain": 6, "hidden_gain": 60},
    "spica": {"hidden_gain": 55},
    "integral_sliding_mode": {"feedback": 2, "switching_gain": 0.5, "sharpening": 0},
}
"""Gains for a camera that a hand carries, where the defaults are for another one."""


def judged(make, seed, kind):
    """Relative error at the end, and the trust in it of one who has no truth; half of them know no noise either."""
    recording, believed = drawn(seed, kind, constant=make.key == "immersion_and_invariance")
    observer = observed(make, recording)
    noise = recording.noise_variance if seed % 2 else None
    blind = replace(recording, truth=None, signal=None, noise_variance=noise, motion=believed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = track(recording, observer, {"y3": 0.3}, believed=believed, language="numba")
    error = float(run.relative_error[-1]) if run.diverged_at is None else np.nan
    return error, replace(run, recording=blind).trust()


WRONG = ("standing camera", "focus of expansion", "moving object")
MOST = 4


def flagged(make, kind, count):
    """The share of so many runs that is flagged, for the good ones of those that are right at the end, and its count.

    An observer that hardly ever is right is asked in at most `MOST` times as many runs.
    """
    found, seed = [], 0
    while len(found) < count and seed < MOST * count:
        error, trust = judged(make, seed, kind)
        if kind != "good" or error <= RIGHT:
            found.append(not trust.trusted)
        seed += 1
    return float(np.mean(found)) if found else np.nan, len(found)
