"""Every observer on five scenes beside the Cramer-Rao bound, gains chosen alike.

Run it as python tests/studies/efficiency_study.py [runs].

Prints the tables and writes efficiencies.png.
"""

import sys
from dataclasses import replace

from percept_obs import Camera, Gaussian, PerspectiveSystem, Run, affine, figures, pinhole, record, rigid, scenarios
from percept_obs.recording.utias import load_utias
from percept_obs.studies.all_observers import all_observers
from percept_obs.studies.comparison import over_bound
from percept_obs.system.inertial import camera_with_imu

TUNING = range(1000, 1005)
"""Seeds of the recordings on which gains are chosen."""


def compared(runs, candidates=None, real=True):
    """Comparisons by scene, with so many runs each; real tracks and a telephone with an IMU if they are wanted."""
    system, noisy = PerspectiveSystem(affine(), pinhole()), Camera(0.02, Gaussian(0.01))
    both, eq35, drive = system.measure("y1", "y2"), scenarios.ma2005_eq35(), scenarios.drive()

    def of(form, make, seconds, camera, start):
        choosing, seen = ([record(make(k), seconds, camera, k) for k in seeds] for seeds in (TUNING, range(runs)))
        return judged(form, choosing, seen, start)

    def judged(form, choosing, seen, start=None):
        last = min(each.elapsed[-1] for each in (*choosing, *seen))
        columns = {"settling_time": Run.settling_time, "over_bound": over_bound(form)}
        settings = {"choosing": choosing, "form": form, "start": start, "candidates": candidates, "columns": columns}
        return all_observers(seen, after=(last / 4, last / 2, last), **settings)

    found = {
        "Ma (35)": of(both, lambda _: eq35, 20, noisy, {"y3": 0.2}),
        "Ma (35), y1 alone": of(system.measure("y1"), lambda _: eq35, 20, noisy, {"y3": 0.2}),
        "drive past": of(both, lambda _: drive, 4, Camera(0.02, Gaussian(0.002)), {"y3": 0.05}),
    }
    if real:
        tracks = [replace(each, noise_variance=0.008**2) for each in load_utias()]
        found["UTIAS"] = judged(PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2"), tracks[::2], tracks[1::2])
        phone, start = camera_with_imu().partition("y1", "y2"), {"y3": 0.5, "q2": 0.5 * 9.81}
        found["camera with an IMU"] = of(
            phone, lambda k: scenarios.held_phone(seed=k), 10, Camera(1 / 30, Gaussian(1e-3)), start
        )
    return found


if __name__ == "__main__":
    cases = compared(int(sys.argv[1]) if len(sys.argv) > 1 else 50)
    for name, found in cases.items():
        print(f"{name}\n{found}\n")
    figures.efficiencies(cases).save("efficiencies.png")
