"""Equivariant filter beside the extended Kalman filter from wrong first ranges.

    PYTHONPATH=tests/support python tests/studies/basin_study.py

Share of runs on (35) that settle within 10 % in 10 s, and the mean NEES of the inverse depth from 1 s on, which is 1 if
the claims are right.
"""

import sys

import numpy as np
from examples import BOTH, NOISY

from percept_obs import ekf, record, scenarios, track
from percept_obs.observers import equivariant_filter

WRONG = (0.1, 0.3, 1.0, 3.0, 10.0)
"""First range over the true one."""


def study(seeds, wrong=WRONG):
    """Rows of wrong range, observer: share that settles, median settling time, median and mean NEES."""
    films = [record(scenarios.ma2005_eq35(), 10, NOISY, seed) for seed in range(seeds)]
    observers = {make.key: make(BOTH) for make in (equivariant_filter, ekf)}
    for factor in wrong:
        for key, observer in observers.items():
            runs = [track(each, observer, {"y3": each.truth[0, 2] / factor}) for each in films]
            times = np.array([run.settling_time(0.1) for run in runs])
            squared = np.array([run.nees("y3")[100:] for run in runs])
            yield factor, key, np.isfinite(times).mean(), np.median(times), np.median(squared), squared.mean()


if __name__ == "__main__":
    for row in study(int(sys.argv[1]) if len(sys.argv) > 1 else 50):
        print(*(f"{value:.3g}" if isinstance(value, float) else value for value in row), flush=True)
