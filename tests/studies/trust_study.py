"""Runs without a truth that the trust in their estimates is measured on: random motions, depths, noises, observers."""

import warnings
from dataclasses import replace

import numpy as np
from distrust_study import GAINS, place_across, waves
from scipy.spatial.transform import Rotation

from percept_obs import Camera, Gaussian, PerspectiveSystem, Uniform, pinhole, record, rigid, track
from percept_obs.observers import OBSERVERS
from percept_obs.recording import Scenario
from percept_obs.system.surfaces import BehindCamera

FORMS = [PerspectiveSystem(rigid(), pinhole()).measure(*names) for names in (("y1", "y2"), ("y1",), ("y2",))]
WRONG, RIGHT = 0.2, 0.05


def drawn(seed):
    """A recording with its truth, an observer whose gains suit how fast the camera moves, and a start."""
    draw = np.random.default_rng(seed)
    while True:
        unit = 10 ** draw.uniform(-2, 2)
        depth = unit * draw.uniform(1, 10)
        direction = draw.normal(size=3)
        speed = unit * 10 ** draw.uniform(-3, 0.3)
        velocity = speed * direction / np.linalg.norm(direction)
        turning = -draw.normal(size=3) * draw.choice([0.0, 0.05, 0.2])
        place = depth * np.array([*draw.uniform(-0.4, 0.4, 2), 1.0])
        duration, period = draw.uniform(4, 12), draw.choice([0.01, 0.02, 0.05])
        sigma = 10 ** draw.uniform(-4, -2)
        noise = draw.choice([Uniform(sigma * np.sqrt(3)), Gaussian(sigma)])
        form = FORMS[draw.choice(3, p=[0.7, 0.15, 0.15])]
        able = [make for make in OBSERVERS if not make.refusal(form)]
        make = able[draw.integers(len(able))]
        scenario = Scenario(
            "drawn", rigid(camera_angular_velocity=turning, camera_velocity=velocity), place, duration, pinhole()
        )
        try:
            recording = record(scenario, camera=Camera(period, noise), seed=int(seed))
        except BehindCamera:
            continue
        if np.abs(recording.truth[:, :2]).max() > 1.5 or recording.truth[:, 2].max() > 20 / depth:
            continue
        length = 1.0 if make.key == "linear_approximation" else speed / 0.7
        recording, observer = replace(recording, unit=length), make(form)
        names = {gain.name for gain in observer.gains}
        if "bound" in names:
            observer = observer.with_gains(bound=100 * length / depth)
        if make.key == "extended_kalman":
            observer = observer.with_gains(noise_variance=sigma**2, hidden_variance=(length / depth) ** 2)
        guess = {"y3": 1 / (depth * 10 ** draw.uniform(-0.5, 0.5))} if draw.random() < 0.7 else {}
        return recording, observer, guess


def judged(seed):
    """True relative error at the end, and whether the estimate is trusted without the truth."""
    recording, observer, guess = drawn(seed)
    recording = replace(recording, noise_variance=recording.noise_variance if seed % 2 else None)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = track(recording, observer, guess)
        blind = track(replace(recording, truth=None, signal=None), observer, guess)
    return float(run.relative_error[-1]) if run.diverged_at is None else np.nan, blind.trust().trusted


def figures(seeds):
    """Shares of wrong ones that are trusted and of right ones that are not, with their numbers."""
    error, trusted = np.array([judged(seed) for seed in seeds]).T
    wrong, right = ~(error <= WRONG), error <= RIGHT
    return trusted[wrong].mean(), 1 - trusted[right].mean(), wrong.sum(), right.sum()


POSES = ("exact", "noisy", "drifting", "crooked")
"""Errors of a camera's poses: none, white noise of velocities, a scale from 1 to 1.4, axes 0.3 to 2 degrees off."""


def believed(draw, poses, turning, velocity, duration):
    """The motion of a point at rest as it is known from poses with errors."""
    times = np.arange(-0.1, duration + 0.2, 0.04)
    w, v = (np.array([each(t) for t in times]) for each in (turning, velocity))
    if poses == "noisy":
        speed = np.sqrt((v**2).sum(axis=1).mean())
        w = w - draw.normal(0, draw.uniform(0.005, 0.05), w.shape)
        v = v + draw.normal(0, speed * draw.uniform(0.01, 0.1), v.shape)
    if poses == "drifting":
        v = v * (1 + 0.4 * np.clip(times / duration, 0, 1))[:, None]
    if poses == "crooked":
        axis = draw.normal(size=3)
        turn = Rotation.from_rotvec(np.radians(draw.uniform(0.3, 2)) * axis / np.linalg.norm(axis))
        w, v = turn.apply(w), turn.apply(v)
    return rigid(camera_angular_velocity=w, camera_velocity=v, times=times)


def posed(seed, poses, sigma=None):
    """A recording, the motion that is believed, and a generator; a hand carries the camera, or it moves evenly."""
    draw = np.random.default_rng(seed)
    while True:
        depth, speed = draw.uniform(2, 6), draw.uniform(0.3, 0.7)
        place = depth * np.array([*draw.uniform(-0.3, 0.3, 2), 1.0])
        turning, velocity = waves(draw, -draw.choice([0.0, 0.1, 0.2])), waves(draw, speed)
        if draw.random() < 0.3:
            w, v = turning(0.0), speed * place_across(draw, place)
            turning, velocity = (lambda t, w=w: w), (lambda t, v=v: v)
        noise, duration = Gaussian(sigma or 10 ** draw.uniform(-3.3, -2.3)), draw.uniform(5, 8)
        scenario = Scenario(
            poses, rigid(camera_angular_velocity=turning, camera_velocity=velocity), place, duration, pinhole()
        )
        try:
            seen = record(scenario, camera=Camera(draw.choice([0.02, 0.04]), noise), seed=seed)
        except BehindCamera:
            continue
        if np.abs(seen.truth[:, :2]).max() < 1.5 and seen.distance.min() > 0.8:
            return seen, believed(draw, poses, turning, velocity, duration), draw


def blindly(run, **known):
    """Relative error at the end, and the trust in it of one who has no truth."""
    error = float(run.relative_error[-1]) if run.diverged_at is None else np.nan
    return error, replace(run, recording=replace(run.recording, truth=None, signal=None, **known)).trust()


def trusted_with(seed, poses):
    """Error and trust of some observer with some outputs; half of them know the noise."""
    recording, known, draw = posed(seed, poses)
    form = FORMS[draw.choice(3, p=[0.7, 0.15, 0.15])]
    able = [make for make in OBSERVERS if not (make.refusal(form) or make.constant_motion)]
    make = able[draw.integers(len(able))]
    observer, variance = make(form), recording.noise_variance
    if make.key == "extended_kalman":
        doubt = draw.choice([0.0, 1e-5])
        observer = observer.with_gains(
            noise_variance=variance, hidden_variance=0.1, turning_noise=doubt, velocity_noise=doubt
        )
    else:
        recording, observer = replace(recording, unit=0.7), observer.with_gains(**GAINS.get(make.key, {}))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = track(recording, observer, {"y3": 0.3}, believed=known, language="numba")
        return blindly(run, motion=known, noise_variance=variance if seed % 2 else None)


def shares(found):
    """Shares that are trusted and over 20 % off, trusted and over 10 %, and flagged among those right to 5 %."""
    error, trusted = np.array([(error, trust.trusted) for error, trust in found]).T
    right, trusted = error <= RIGHT, trusted > 0
    return np.mean(trusted & ~(error <= WRONG)), np.mean(trusted & ~(error <= 0.1)), 1 - trusted[right].mean()
