"""Print how right distances are on clean paths through public poses, what is trusted, and of what `diagnose` accuses.

python tests/studies/paths_study.py FILE... [--rates 30 100] [--noise 0 0.5 2] [--length 8] [--most 3] [--seed 0]

The files are poses in the TUM format (t x y z qx qy qz qw).  A path goes through every tenth of a second of them by
splines, so that the truth is known; it is cut into windows of `length` seconds in which the camera moves.  Poses are
taken from it at the rates, with noise in millimetres (a millimetre goes with 0.1 degrees); images of four points at
rest, 1 to 4 m ahead, have half a pixel of noise and the poses' times.
"""

import argparse
import tempfile
import warnings
import zlib
from collections import Counter
from pathlib import Path
from time import process_time

import numpy as np
import pandas as pd
from scipy.interpolate import make_interp_spline
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation, RotationSpline

from percept_obs import PerspectiveSystem, PixelCamera, Recording, diagnose, ekf, pinhole, read_tum, rigid, track
from percept_obs.recording.poses import Poses

CAMERA = PixelCamera((500, 500), (320, 240))
PIXEL, DEGREES = 0.5, 0.1
"""Noise of the images in pixels, and degrees of the orientations' noise for each millimetre."""
FORM = PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2")
KNOTS, AROUND, GAP = 0.1, 1.0, 0.25
"""Seconds between the poses that a path goes through, seconds of it beside a window, and the longest gap."""
SHIFT, PACE, TURN, JOLT = 0.08, 0.08, 0.5, 12.0
"""A camera moves with such a deviation of its place in metres and such a median m/s at least, and turns by no more
radians from knot to knot; more m/s^2 are a jump in the file and not a motion."""
POINTS, WIDE, NEAR = 4, (0.75, 0.6), 0.5
AXES = {"z": np.eye(3), "x": [[0, 0, 1], [-1, 0, 0], [0, -1, 0]], "-z": np.diag([1, -1, -1])}
"""Where the camera may look in the frame of the poses; the first that keeps four points in view is taken."""
RIGHT = 0.05


def recordings(poses, pixels, camera=CAMERA):
    """Bring poses and images, shape (K, n, 2) in pixels, as a user does: speeds by default, noise as it is said."""
    count, points = pixels.shape[:2]
    rows = {"time": np.repeat(poses.time, points), "id": np.tile(np.arange(points), count)}
    with tempfile.TemporaryDirectory() as folder:
        tracks = Path(folder, "tracks.csv")
        pd.DataFrame(rows | dict(zip("uv", pixels.reshape(-1, 2).T, strict=True))).to_csv(tracks, index=False)
        return Recording.from_csv(tracks, poses.motion(), camera=camera, point="id", pixel_sigma=PIXEL)


def disturbed(poses, draw, metres, radians, kind="white", seconds=0.0):
    """The poses with noise: "white", "AR" (correlated over so many seconds) or the "mean" of so many seconds."""
    noise, step = draw.standard_normal((len(poses.time) + 500, 6)), np.median(np.diff(poses.time))
    if kind == "AR":
        stays = np.exp(-step / seconds)
        noise = lfilter([np.sqrt(1 - stays**2)], [1, -stays], noise, axis=0)
    if kind == "mean":
        width = max(1, round(seconds / step))
        noise = lfilter(np.ones(width) / np.sqrt(width), [1], noise, axis=0)
    shift, turn = np.split(noise[500:], 2, axis=1)
    turned = poses.rotation * Rotation.from_rotvec(radians * turn)
    return Poses(poses.time, poses.position + metres * shift, turned.as_quat())


def followed(recording, variance):
    """The run of a filter that takes so much noise."""
    return track(recording, ekf(FORM, noise_variance=variance, hidden_variance=0.25), {"y3": 0.2}, language="numba")


def judged(exact, given, places, draw):
    """Errors of the last distances, what is trusted and claimed, and the diagnosis, of places seen from exact poses."""
    seen = np.stack([exact.rotation.inv().apply(place - exact.position) for place in places], axis=1)
    pixels = CAMERA.pixels(seen[..., :2] / seen[..., 2:]) + draw.normal(0, PIXEL, (*seen.shape[:2], 2))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = recordings(given, pixels)
        runs = [followed(each, followed(each, each.effective_variance).effective_variance) for each in found]
        trusts, diagnosis = [run.trust() for run in runs], diagnose(found)
    off = np.array([run.distance[-1] for run in runs]) / seen[-1, :, 2] - 1
    claimed = np.array([np.nan if trust.claimed is None else trust.claimed for trust in trusts])
    return {
        **{"error": off, "claimed": claimed, "trusted": np.array([trust.trusted for trust in trusts])},
        "square": (off / claimed) ** 2,  # that of 1/Z over its claim: (1/found - 1/true) found is minus the error
        "named": diagnosis.named if diagnosis.findings else "-" if diagnosis.explained else "NOT AS KNOWN",
    }


def told(found):
    """A result in a line."""
    errors = " ".join(f"{100 * error:+6.1f}" for error in found["error"])
    claims = f"{200 * np.nanmean(found['claimed']):4.1f}" if np.isfinite(found["claimed"]).any() else "none"
    trusted = f"{found['trusted'].sum()}/{len(found['trusted'])}"
    square = np.mean(found["square"])
    return f"error {errors} %, claim {claims} %, square {square:7.1f}, trusted {trusted}, {found['named']}"


def totals(results):
    """Figures of several results in a line."""
    error, trusted, square = (np.concatenate([each[key] for each in results]) for key in ("error", "trusted", "square"))
    off, named = np.abs(error), Counter(each["named"] for each in results)
    unknown, nothing = named.pop("NOT AS KNOWN", 0), named.pop("-", 0)
    accused = ", ".join(f"{key} {count}" for key, count in named.most_common())
    wrong = " / ".join(str((trusted & ~(off <= limit)).sum()) for limit in (0.03, 0.1, 0.2))
    return (
        f"{len(results)} cases: accused {named.total()} ({accused or '-'}), not as known {unknown}, nothing {nothing}; "
        f"of {len(off)} points: right & flagged {(~trusted & (off <= RIGHT)).sum()}, trusted {trusted.sum()}, "
        f"trusted & off > 3 / 10 / 20 %: {wrong}; error median {100 * np.median(off):.2f} %, "
        f"90 % {100 * np.quantile(off, 0.9):.2f} %, within 1.5 % {100 * np.mean(off <= 0.015):.1f} %; "
        f"squared error over claim {np.nanmean(square):.2f} (median {np.nanmedian(square):.2f})"
    )


def knots(poses):
    """Every tenth of a second of the poses."""
    wanted = np.arange(poses.time[0], poses.time[-1], KNOTS)
    rows = np.unique(np.clip(np.searchsorted(poses.time, wanted), 0, len(poses.time) - 1))
    rows = rows[np.r_[True, np.diff(poses.time[rows]) > KNOTS / 3]]
    return poses.time[rows], poses.position[rows], poses.rotation[rows]


def window(knot, begin, length, draw):
    """A path through the knots in a window, and places that stay in view; None if it moves too little or jumps."""
    time, position, rotation = knot
    inside = (time >= begin - AROUND) & (time <= begin + length + AROUND)
    time, position, rotation = time[inside], position[inside], rotation[np.flatnonzero(inside)]
    if len(time) < 8 or time[0] > begin or time[-1] < begin + length or np.diff(time).max() > GAP:
        return None
    turns = (rotation[:-1].inv() * rotation[1:]).magnitude()
    pace = np.linalg.norm(np.diff(position, axis=0), axis=1) / np.diff(time)
    if turns.max() > TURN or np.median(pace) < PACE or np.sqrt(position.var(axis=0).sum()) < SHIFT:
        return None
    places, turning = make_interp_spline(time, position, k=5), RotationSpline(time, rotation)
    look = np.arange(begin, begin + length, 1 / 30)
    if np.linalg.norm(places(look, 2), axis=1).max() > JOLT:
        return None
    for name, axes in AXES.items():
        at, turned = places(look), turning(look) * Rotation.from_matrix(axes)
        middle, ahead = len(look) // 2, np.column_stack([draw.uniform(-0.5, 0.5, (400, 2)), np.ones(400)])
        points = turned[middle].apply(draw.uniform(1, 4, (400, 1)) * ahead) + at[middle]
        seen = np.einsum("kji,knj->kni", turned.as_matrix(), points - at[:, None])
        good = ((np.abs(seen[..., :2]) < seen[..., 2:] * WIDE) & (seen[..., 2:] > NEAR)).all(axis=(0, 2))
        if good.sum() >= POINTS:
            return name, places, lambda t, axes=axes: turning(t) * Rotation.from_matrix(axes), points[good][:POINTS]
    return None


def study(files, rates, noises, length, most, seed):
    results = {}
    for file in files:
        poses, key = read_tum(file), zlib.crc32(Path(file).stem.encode())
        knot, found = knots(poses), []
        for begin in np.arange(poses.time[0], poses.time[-1] - length, length):
            one = window(knot, begin, length, np.random.default_rng([seed, key, int(begin)]))
            found += [] if one is None else [(begin, *one)]
        chosen = np.unique(np.linspace(0, len(found) - 1, min(most, len(found))).round().astype(int))
        for begin, axis, places, turning, points in [found[k] for k in chosen]:
            for rate in rates:
                time = begin + np.arange(int(length * rate) + 1) / rate
                exact = Poses(time - begin, places(time), turning(time).as_quat())
                for noise in noises:
                    draw = np.random.default_rng([seed, key, int(begin), int(rate), int(1000 * noise)])
                    given = disturbed(exact, draw, 1e-3 * noise, np.radians(DEGREES * noise)) if noise else exact
                    results.setdefault((rate, noise), []).append(result := judged(exact, given, points, draw))
                    case = f"{Path(file).stem} {begin:.0f} s {axis}, {rate:g}/s, {noise:g} mm"
                    print(f"{case}: {told(result)}", flush=True)
    for (rate, noise), each in results.items():
        print(f"TOTAL {rate:g}/s, {noise:g} mm, {totals(each)}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("files", nargs="+")
    parser.add_argument("--rates", nargs="+", type=float, default=[30, 100])
    parser.add_argument("--noise", nargs="+", type=float, default=[0])
    parser.add_argument("--length", type=float, default=8)
    parser.add_argument("--most", type=int, default=3)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    study(asked.files, asked.rates, asked.noise, asked.length, asked.most, asked.seed)
    print(f"{process_time():.0f} s of computing")
