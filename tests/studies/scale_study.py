"""Scale of one landmark by a camera and an IMU: shares that are right, not observable yet, and trusted wrongly.

Run it by hand: `python tests/studies/scale_study.py --seeds 6 --first 0`; a run takes some seconds.
"""

import argparse
import warnings
from dataclasses import replace
from time import process_time

import numpy as np

from percept_obs import Camera, Gaussian, ekf, record, scenarios, track
from percept_obs.system.inertial import camera_with_imu

KINDS = {
    "constant speed": {"shake": 0.0},
    "0.03 m/s²": {"shake": 0.03},
    "0.1 m/s²": {"shake": 0.1},
    "0.3 m/s²": {"shake": 0.3},
    "1 m/s²": {"shake": 1.0},
    "stop and go": {"begin": 5.0},
}
DENSITIES = {"turning_noise": 1.6e-4**2, "velocity_noise": 2.8e-3**2}
LENGTH = 9
OBSERVER = ekf(camera_with_imu().partition("y1", "y2"), noise_variance=1e-6, **DENSITIES)


def filmed(kind, seed):
    """Return the recording of the telephone."""
    return record(scenarios.held_phone(seed=seed, **KINDS[kind]), LENGTH, Camera(1 / 30, Gaussian(1e-3)), seed=seed)


def judged(kind, seed, given=False):
    """A run, how many claimed deviations it is off at its end, and its trust without a truth; a start may be given."""
    recording = filmed(kind, seed)
    force = recording.motion.known(0.0)[0, 3:]
    start = {"y3": 0.5} | {f"q{k + 1}": -0.5 * force[k] for k in range(3)} if given else None
    run = track(recording, OBSERVER, start)
    deviation = np.sqrt(run.covariance[-1, -1, -1])
    trust = replace(run, recording=replace(recording, truth=None, signal=None)).trust()
    return run, float(run.error[-1, -1] / deviation), trust


def study(seeds, kinds, given):
    for kind in kinds:
        found = []
        for seed in seeds:
            before = process_time()
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                run, off, trust = judged(kind, seed, given)
            error = run.relative_error[-1]
            found.append((error, off, trust.trusted))
            begins = run.time[np.argmax(run.unobservable == 0)] if not run.unobservable.all() else np.nan
            print(
                f"{kind}, seed {seed}: from {begins:.1f} s on, {error:.2%} off, {off:.2f} deviations, {trust.kind}, "
                f"{process_time() - before:.1f} s",
                flush=True,
            )
        error, off, trusted = np.array(found, dtype=float).T
        began = np.isfinite(off)
        print(
            f"TOTAL {kind}: {(~began).sum()} of {len(off)} not observable yet, {(np.abs(off[began]) <= 2).sum()} of "
            f"{began.sum()} within two deviations, {(np.abs(off[began]) <= 3).sum()} within three; {trusted.sum():.0f} "
            f"trusted, of which {(error[trusted > 0] > 0.1).sum()} are over 10 % off",
            flush=True,
        )


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--kinds", nargs="+", default=list(KINDS))
    parser.add_argument("--given", action="store_true", help="start at 2 m, as a filter does without the smoother")
    asked = parser.parse_args()
    study(range(asked.first, asked.first + asked.seeds), asked.kinds, asked.given)
