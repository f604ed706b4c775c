"""Runs without a truth that the trust in their estimates is measured on: random motions, depths, noises, observers."""

import warnings
from dataclasses import replace

import numpy as np

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
        turning = draw.normal(size=3) * draw.choice([0.0, 0.05, 0.2])
        place = depth * np.array([*draw.uniform(-0.4, 0.4, 2), 1.0])
        duration, period = draw.uniform(4, 12), draw.choice([0.01, 0.02, 0.05])
        sigma = 10 ** draw.uniform(-4, -2)
        noise = draw.choice([Uniform(sigma * np.sqrt(3)), Gaussian(sigma)])
        form = FORMS[draw.choice(3, p=[0.7, 0.15, 0.15])]
        able = [make for make in OBSERVERS if not make.refusal(form)]
        make = able[draw.integers(len(able))]
        scenario = Scenario("drawn", rigid(turning, velocity, [0, 0, 0]), place, duration, pinhole())
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
    noise = recording.noise_variance if seed % 2 else None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = track(recording, observer, guess)
        blind = track(replace(recording, truth=None, noise_variance=noise, signal=None), observer, guess)
    return float(run.relative_error[-1]) if run.diverged_at is None else np.nan, blind.trust().trusted


def figures(seeds):
    """Shares of wrong ones that are trusted and of right ones that are not, with their numbers."""
    error, trusted = np.array([judged(seed) for seed in seeds]).T
    wrong, right = ~(error <= WRONG), error <= RIGHT
    return trusted[wrong].mean(), 1 - trusted[right].mean(), wrong.sum(), right.sum()
