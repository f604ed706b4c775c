"""Filters tuned by the likelihood of their innovations, and by their errors: errors and honesty of both."""

from dataclasses import dataclass, replace

import numpy as np
from distrust_study import drawn
from examples import BOTH
from percept_obs.studies.likelihood import tune_by_likelihood
from sample_sizes import sampled

from percept_obs import Camera, Gaussian, PerspectiveSystem, ekf, pinhole, record, rigid, scenarios, track
from percept_obs.observers.gains import grid
from percept_obs.studies.comparison import best_setting, relative_distance_errors

RIGID = PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2")
RANGES = {"noise_variance": (1e-7, 1e-2), "process_noise": (1e-9, 1e-2), "hidden_variance": (1e-3, 10)}
"""Ranges that are searched by likelihood."""

GRID = grid(
    noise_variance=(1e-6, 1e-5, 1e-4, 1e-3), process_noise=(0, 1e-6, 1e-5, 1e-4, 1e-3), hidden_variance=(0.1, 1)
)
"""Gains that are searched by the median error; they include the right ones."""


@dataclass(frozen=True)
class Report:
    """Result on other recordings: mean NIS over its expectation, median NEES, depth error, share within 2 sigma."""

    gains: dict
    nis: float
    nees: float
    error: float
    held: float

    def __str__(self):
        gains = ", ".join(f"{name} {value:.2g}" for name, value in self.gains.items())
        return (
            f"NIS {self.nis:.2f} of its expectation, NEES median {self.nees:.2f}, depth error {self.error:.2%}, "
            f"within 2 sigma {self.held:.0%} ({gains})"
        )


def reported(observer, recordings, follow, after):
    """Report of a filter on recordings."""
    runs = [follow(recording, observer) for recording in recordings]
    nis = np.concatenate([run.nis[np.isfinite(run.nis)] for run in runs])
    nees = np.concatenate([run.nees("y3") for run in runs])
    error = np.median(np.concatenate([relative_distance_errors(runs, seconds) for seconds in after]))
    gains = {gain.name: gain.value for gain in observer.gains if gain.name in RANGES}
    outputs = len(observer.form.x1)
    return Report(gains, nis.mean() / outputs, float(np.nanmedian(nees)), float(error), float(np.nanmean(nees < 4)))


def both_ways(form, choosing, reporting, start, after=(1.0, 2.0, 3.0)):
    """A report of tuning by likelihood, one of tuning by the median error, and what was found by likelihood."""

    def follow(recording, observer):
        return track(recording, observer, start, language="numba")

    tuned = tune_by_likelihood(choosing, ekf(form), RANGES, follow)
    by_error = best_setting(choosing, [ekf(form, **gains) for gains in GRID], follow, after)
    return *(reported(each, reporting, follow, after) for each in (tuned.observer, by_error)), tuned


def halves(make):
    """Twelve recordings to choose on and twenty-four to report on, or fewer for a sample."""
    choosing = sampled(6, 12)
    made = [make(seed) for seed in range(3 * choosing)]
    return made[:choosing], made[choosing:], {"y3": 0.3}


def near_ma():
    """Ma's (35) with noise of a hundredth of the focal length."""
    return BOTH, *halves(lambda seed: record(scenarios.ma2005_eq35(), 5, Camera(0.025, Gaussian(0.01)), seed))


def far_away():
    """Ma's (36), whose point moves away, with less noise."""
    return BOTH, *halves(lambda seed: record(scenarios.ma2005_eq36(), 5, Camera(0.025, Gaussian(0.003)), seed))


def by_hand():
    """A camera that a hand carries past points at several metres."""

    def make(seed):
        camera = Camera(0.04, Gaussian(0.002))
        exact, _ = drawn(seed, "good")
        noise = camera.noise.draw(np.random.default_rng(seed), exact.outputs.shape)
        outputs = exact.truth[:, :2] + noise
        return replace(exact, outputs=outputs, noise_variance=camera.noise.variance).between(0, 5)

    return RIGID, *halves(make)


SCENARIOS = (near_ma, far_away, by_hand)
