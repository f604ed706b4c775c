"""Print how right distances are if a hand shakes at 0.3 to 3 Hz, what is trusted, and whether claims are kept.

python tests/studies/shake_study.py [--poses white AR0.1 AR0.5 mean0.1] [--seeds 0 1 ...] [--hertz ...] [--rates ...]

The camera shakes by 6 cm for 10 s, in the second half of the cases it turns by 5 and 3 degrees at the same pace.  Poses
have noise of 0, 0.5 or 2 mm, with 0.1 degrees a millimetre: white, correlated over 0.1 or 0.5 s ("AR0.1"), or means of
0.1 s.  Four points 1 to 3 m ahead are seen with half a pixel at 500 pixels, at the poses' times.
"""

import argparse
from itertools import product
from time import process_time

import numpy as np
from paths_study import DEGREES, disturbed, judged, told, totals
from scipy.spatial.transform import Rotation

from percept_obs.recording.poses import Poses

HERTZ, RATES, NOISES, LENGTH = (0.3, 0.5, 1, 1.5, 2, 2.5, 3), (30, 100), (0, 0.5, 2), 10
SHIFT, TURNS = 0.06, np.radians([5, 3])
"""Amplitudes in metres and radians: about the camera's y axis, in phase with the shift, and about its x axis."""


def shaken(hertz, rate, turns, draw):
    """Exact poses of a camera that shakes, and places ahead of it."""
    time = np.arange(LENGTH * rate + 1) / rate
    phase, along = 2 * np.pi * hertz * time + draw.uniform(0, 2 * np.pi), np.array([1, draw.uniform(-0.3, 0.3), 0.1])
    position = SHIFT * np.outer(np.sin(phase), along / np.linalg.norm(along))
    yaw, pitch = TURNS[:, None] * turns * [np.sin(phase), np.cos(phase)]
    rotation = Rotation.from_euler("yx", np.column_stack([yaw, pitch]))
    places = draw.uniform(1, 3, (4, 1)) * np.column_stack([draw.uniform(-0.3, 0.3, (4, 2)), np.ones(4)])
    return Poses(time, position, rotation.as_quat()), places


def study(kinds, seeds, hertz, rates):
    results = {}
    for kind, rate, noise, turns, f, seed in product(kinds, rates, NOISES, (False, True), hertz, seeds):
        name, seconds = kind.rstrip("0123456789."), kind.lstrip("whiteARmn")
        if name != "white" and not noise:
            continue
        draw = np.random.default_rng([seed, int(10 * f), rate, turns])
        exact, places = shaken(f, rate, turns, draw)
        noisy = 1e-3 * noise, np.radians(DEGREES * noise), name, float(seconds or 0)
        given = disturbed(exact, draw, *noisy) if noise else exact
        result = judged(exact, given, places, draw)
        moved = "turn" if turns else "shift"
        results.setdefault((kind, rate, noise, moved), []).append(result)
        print(f"{kind} {rate}/s {noise:g} mm {moved} {f:g} Hz, seed {seed}: {told(result)}", flush=True)
    for kind, rate, noise, moved in results:
        print(f"TOTAL {kind} {rate}/s {noise:g} mm {moved}, {totals(results[kind, rate, noise, moved])}")
    for kind in kinds:
        cases = [each for key, found in results.items() if key[0] == kind for each in found]
        good = np.mean([np.abs(each["error"]).max() <= 0.015 for each in cases])
        mean = np.mean([abs(each["error"].mean()) <= 0.015 for each in cases])
        print(f"ALL {kind}: all four within 1.5 % in {good:.1%}, their mean in {mean:.1%}; {totals(cases)}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--poses", nargs="+", default=["white", "AR0.1", "AR0.5", "mean0.1"])
    parser.add_argument("--seeds", nargs="+", type=int, default=[0])
    parser.add_argument("--hertz", nargs="+", type=float, default=HERTZ)
    parser.add_argument("--rates", nargs="+", type=int, default=RATES)
    asked = parser.parse_args()
    study(asked.poses, asked.seeds, asked.hertz, asked.rates)
    print(f"{process_time():.0f} s of computing")
