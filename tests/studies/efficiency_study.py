"""Every observer on five scenes beside the Cramer-Rao bound, gains chosen alike.

Run it as python tests/studies/efficiency_study.py [runs].

Prints the table and writes efficiencies.png.
"""

import sys

import numpy as np
from percept_obs.studies.efficiencies import Case, efficiencies

from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, figures, pinhole, record, rigid, scenarios
from percept_obs.system.inertial import camera_with_imu

TUNING = range(1000, 1005)
"""Seeds of the recordings on which gains are chosen."""


def cases(runs, real=True):
    """The scenes with so many runs each; the real one if it is at hand and wanted."""
    system, camera = PerspectiveSystem(affine(), pinhole()), Camera(0.02, Gaussian(0.01))

    def of(form, scenario, start, camera=camera):
        halves = ([record(scenario, 20, camera, seed) for seed in seeds] for seeds in (TUNING, range(runs)))
        return Case(form, *halves, start)

    far, eq35 = {"y3": 0.2}, scenarios.ma2005_eq35()
    found = {
        "Ma (35)": of(system.measure("y1", "y2"), eq35, far),
        "Ma (35), y1 alone": of(system.measure("y1"), eq35, far),
    }
    drives = (
        [record(scenarios.drive(), 4, Camera(0.02, Gaussian(0.002)), s) for s in seeds]
        for seeds in (TUNING, range(runs))
    )
    found["drive past"] = Case(system.measure("y1", "y2"), *drives, {"y3": 0.05})
    return found | ({"UTIAS": real_tracks(), "camera with an IMU": telephone(runs)} if real else {})


def real_tracks():
    """Landmarks of a real drive; gains are chosen on every other one."""
    from percept_obs.recording.utias import load_utias

    tracks = load_utias()
    start = 1 / (2 * np.median(np.concatenate([1 / track.truth[:, 2] for track in tracks])))
    form = PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2")
    return Case(form, tracks[::2], tracks[1::2], {"y3": start}, noise_variance=0.008**2)


def telephone(runs):
    """A landmark before a telephone with an IMU, whose biases nobody knows."""
    film = Camera(1 / 30, Gaussian(1e-3))
    halves = (
        [record(scenarios.held_phone(seed=seed), 10, film, seed) for seed in seeds] for seeds in (TUNING, range(runs))
    )
    start = {"y3": 0.5, "q2": 0.5 * 9.81}
    return Case(camera_with_imu().partition("y1", "y2"), *halves, start)


if __name__ == "__main__":
    table = efficiencies(cases(int(sys.argv[1]) if len(sys.argv) > 1 else 50))
    print(table.to_string())
    figures.efficiencies(table).save("efficiencies.png")
