"""Print how long a table of all observers of many tracks takes, and the memory, with a truth and without.

PYTHONPATH=tests/support python tests/studies/many_tracks_study.py [number of tracks, 2000] [samples of each, 600]
"""

import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pandas as pd
from camera_paths import poses, seen

from percept_obs import PixelCamera, Recording, read_tum
from percept_obs.recording.pose_files import write_tum
from percept_obs.studies.all_observers import all_observers

CAMERA = PixelCamera((500, 500), (320, 240))
RATE = 20.0  # samples a second


def write(folder, tracks, samples):
    """Write poses and tracks with half a pixel of noise, as another program would."""
    write_tum(folder / "poses.txt", poses(np.arange(-10, samples + 10) / RATE))
    rng, instants = np.random.default_rng(0), np.arange(samples) / RATE
    for number in range(tracks):
        (place,) = seen(instants, places=rng.uniform([-0.4, -0.4, 1.5], [0.4, 0.4, 3.0], (1, 3)))
        u, v = (CAMERA.pixels(place[:, :2] / place[:, 2:]) + rng.normal(0, 0.5, (samples, 2))).round(3).T
        rows = pd.DataFrame({"time": instants, "id": number, "u": u, "v": v, "depth": place[:, 2].round(4)})
        rows.to_csv(folder / "tracks.csv", index=False, mode="a" if number else "w", header=not number)


def told(what, begin, cpu):
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
    wall, computing = time.perf_counter() - begin, time.process_time() - cpu
    print(f"{what}: {wall:.1f} s, {computing:.1f} s of computing, at most {peak} MB")
    return time.perf_counter(), time.process_time()


if __name__ == "__main__":
    tracks, samples = (int(given) for given in [*sys.argv[1:], *["2000", "600"][len(sys.argv) - 1 :]])
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        write(folder, tracks, samples)
        now = (time.perf_counter(), time.process_time())
        motion = read_tum(folder / "poses.txt").motion()
        for truth in ({"depth": "depth"}, {}):
            recordings = Recording.from_csv(folder / "tracks.csv", motion, camera=CAMERA, point="id", **truth)
            now = told(f"{len(recordings)} tracks read, {'with' if truth else 'without'} a truth", *now)
            found = all_observers(recordings)
            now = told("table", *now)
            print(found)
