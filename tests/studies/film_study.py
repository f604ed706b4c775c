"""Films of quick hands, 10 to 20 s, rendered and read: errors of poses and distances, and faults by name.

`PYTHONPATH=tests/support python tests/studies/film_study.py [SEEDS [FAULT...]]` prints a line a film, and a
table at the end.
The faults are the keys of FAULTS.
"""

import sys
import tempfile
from time import process_time

import numpy as np
import pandas as pd
from film_renderer import standard_film

from percept_obs.film import read_film

FAULTS = {
    "clean": {},
    "shutter": {"readout": 0.02},
    "blur": {"exposure": 0.02},
    "soft": {"blur": 1.3},
    "focus": {"focus": 0.03},
    "step": {"focus_step": 0.03},
    "stabilised": {"stabilised": 15.0},
}
"""Faults of a telephone, as the renderer takes them."""

AFTER = 3.0
"""Seconds after which errors are looked at."""


def error(run, truth, film, late):
    """Relative error of a distance at the last sample seen until then, by the renderer's truth.

    A film's samples are put to the middle of their pictures' time.
    """
    seen = int(np.flatnonzero(np.isfinite(run.recording.outputs[: late + 1]).all(axis=1))[-1])
    pixel, frame = film.camera.pixels(run.recording.outputs[seen]), truth.frame(run.time[seen])
    return abs(run.distance[seen] / truth.distance_at(truth.time[frame], pixel[None])[0] - 1)


def judged(film, truth):
    """Figures of a film."""
    poses = film.seen.poses
    off = np.linalg.norm(film.path.at(poses.time).position - truth.poses.position[truth.frame(poses.time)], axis=1)
    found = {"pose": 1e3 * np.median(off), "focal": film.camera.focal[0] / truth.camera.focal[0] - 1}
    errors, sure = {True: [], False: []}, []
    for run in film.runs:
        late = int(np.searchsorted(run.elapsed, AFTER))
        if late < len(run.time):
            errors[run.recording.truth is not None].append(error(run, truth, film, late))
        if run.trust().trusted:
            sure.append(error(run, truth, film, len(run.time) - 1))
    for name, board in (("corners", True), ("others", False)):
        found |= {name: np.nanmedian(errors[board]), f"{name} 90 %": np.nanquantile(errors[board], 0.9)}
    return found | {
        "tracks": len(film),
        "trusted": len(sure),
        **{f"over {share:.0%}": int((np.array(sure) > share).sum()) for share in (0.1, 0.2)},
        "findings": ", ".join(each.key for each in film.findings),
    }


def study(seeds, faults):
    """Yield figures of films of every seed with every fault."""
    for fault in faults:
        for seed in range(seeds):
            with tempfile.TemporaryDirectory() as folder:
                path, truth = standard_film(seed, folder, **FAULTS[fault])
                begin = process_time()
                film = read_film(path)
                yield {"fault": fault, "seed": seed, "cpu": process_time() - begin, **judged(film, truth)}


if __name__ == "__main__":
    rows = []
    for row in study(int((sys.argv[1:] or [3])[0]), sys.argv[2:] or FAULTS):
        rows.append(row)
        print(
            *(f"{name} {value:.3g}" if isinstance(value, float) else f"{name} {value}" for name, value in row.items())
        )
    print(pd.DataFrame(rows).groupby("fault").median(numeric_only=True).to_string())
