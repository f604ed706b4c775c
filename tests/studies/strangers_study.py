"""Print which mistakes of files and calibration `diagnose` names on paths of real poses, and what is trusted then.

python tests/studies/strangers_study.py FILE... [--paths 20] [--faults "poses inverted" ...] [--length 8] [--seed 0]

The files are poses in the TUM or EuRoC format, or dataset3.mat of UTIAS; the paths are those of paths_study.py.  The
camera sits on a body with a mount such as EuRoC's; its poses have a millimetre and 0.05 degrees of noise, at 20 a
second, and the images of points at rest half a pixel.  Then somebody makes one mistake with them.
"""

import argparse
import warnings
import zlib
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np
from paths_study import CAMERA, FORM, PIXEL, disturbed, knots, recordings, window
from scipy.spatial.transform import Rotation

from percept_obs import PixelCamera, diagnose, ekf, read_euroc, read_tum, track
from percept_obs.recording.poses import Poses
from percept_obs.recording.utias import utias_tracks

RATE, METRES, RADIANS = 20, 1e-3, np.radians(0.05)
LENS = (-0.28, 0.07, 0.0, 0.0)
FAULTS = (
    *("poses inverted", "quaternion order", "u and v exchanged", "focal length twice", "focal length half"),
    *("image size", "mount inverted", "mount left out", "time offset", "flipped axis", "frames swapped"),
    "distortion ignored",
)
MORE = ("rotations inverted", "quaternion order, read as EuRoC", "fisheye ignored", "nothing")
WRONG = 0.2


def poses_of(file):
    """Poses in a file."""
    if file.endswith(".mat"):
        path = utias_tracks(file).path
        return Poses(path.time, path.position, path.orientation)
    if file.endswith(".csv"):
        return read_euroc(file, repeated="drop")
    return read_tum(file, repeated="drop")


def paths(files, count, length, seed):
    """As many windows of each file: the camera's exact poses, places that it sees, and seeds."""
    for file in files:
        poses, key = poses_of(file), zlib.crc32(Path(file).stem.encode())
        knot, begins = knots(poses), np.arange(poses.time[0] + 1, poses.time[-1] - length - 1, length)
        found = 0
        for begin in np.random.default_rng([seed, key]).permutation(begins):
            one = window(knot, begin, length, np.random.default_rng([seed, key, int(begin)]))
            if one is not None:
                found += 1
                _, places, turning, points = one
                time = begin + np.arange(int(length * RATE) + 1) / RATE
                exact = Poses(time - begin, places(time), turning(time).as_quat())
                yield f"{Path(file).stem} {begin:.0f} s", exact, points, [seed, key, int(begin)]
            if found == np.ceil(count / len(files)):
                break


def spoiled(poses, pixels, fault, draw):
    """Poses and images as somebody brings them who made a mistake."""
    mount = (
        draw.normal(0, 0.06, 3),
        Rotation.from_euler("z", 90, degrees=True) * Rotation.from_rotvec(draw.normal(0, 0.03, 3)),
    )
    place, turn = mount[0], mount[1].as_matrix()
    body = replace(poses.mounted(-turn.T @ place, turn.T), mount=None)
    back, quaternions, camera = poses.rotation.inv(), poses.orientation, CAMERA
    image = CAMERA.image(pixels)
    if fault == "poses inverted":
        poses = Poses(poses.time, -back.apply(poses.position.copy()), back.as_quat())
    elif fault == "rotations inverted":
        poses = Poses(poses.time, poses.position, back.as_quat())
    elif fault.startswith("quaternion order"):
        step = -1 if "EuRoC" in fault else 1
        poses = Poses(poses.time, poses.position, np.roll(quaternions, step, axis=1))
    elif fault == "u and v exchanged":
        pixels = pixels[..., ::-1]
    elif fault.startswith("focal length"):
        camera = PixelCamera(np.array(CAMERA.focal) * (2 if "twice" in fault else 0.5), CAMERA.centre)
    elif fault == "image size":
        pixels = (pixels + 0.5) / 2 - 0.5
    elif fault == "mount inverted":
        poses = body.mounted(-turn.T @ place, turn.T)
    elif fault == "mount left out":
        poses = body
    elif fault == "time offset":
        late = round(0.1 * RATE)  # images have the poses' times
        poses, pixels = Poses(poses.time[:-late], poses.position[late:], quaternions[late:]), pixels[:-late]
    elif fault == "flipped axis":
        pixels = [0, 480] + pixels * [1, -1]
    elif fault == "frames swapped":
        poses = Poses(poses.time, poses.position, (poses.rotation * Rotation.from_rotvec([np.pi, 0, 0])).as_quat())
    elif fault == "distortion ignored":
        pixels = PixelCamera(CAMERA.focal, CAMERA.centre, distortion=LENS).pixels(image)
    elif fault == "fisheye ignored":
        radius = np.linalg.norm(image, axis=-1, keepdims=True)
        pixels = CAMERA.pixels(image / radius * np.arctan(radius))
    return poses, pixels, camera


def brought(exact, places, fault, draw):
    """Recordings of places under a mistake, and their last true distances."""
    seen = np.stack([exact.rotation.inv().apply(place - exact.position) for place in places], axis=1)
    pixels = CAMERA.pixels(seen[..., :2] / seen[..., 2:]) + draw.normal(0, PIXEL, (*seen.shape[:2], 2))
    return recordings(*spoiled(disturbed(exact, draw, METRES, RADIANS), pixels, fault, draw)), seen[-1, :, 2]


def trusted(found, true):
    """For each track whether a filter's run is trusted, and whether it is wrong."""
    runs = [track(each, ekf(FORM, noise_variance=each.effective_variance), {"y3": 0.2}) for each in found]
    off = np.array([run.distance[-1] for run in runs]) / true - 1
    return np.array([run.trust().trusted for run in runs]), ~(np.abs(off) <= WRONG)


def study(files, count, faults, length, seed):
    """Print a row of each fault; what is trusted is asked where the mistake is not named first."""
    cases, rows = [*paths(files, count, length, seed)], []
    for fault in faults:
        wanted, found = fault.removesuffix(" twice").removesuffix(" half").split(",")[0], []
        for name, exact, points, seeds in cases:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                tracks, true = brought(exact, points, fault, np.random.default_rng(seeds))
                diagnosis = diagnose(tracks)
                said, left = diagnosis.named, not diagnosis.explained
                sure, wrong = np.zeros((2, len(tracks)), bool) if said == wanted else trusted(tracks, true)
            instead = [other for each in diagnosis.findings for other in each.instead]
            alike = said != wanted and (wanted in instead or (said == "nothing" and wanted in diagnosis.not_told))
            false = said not in (wanted, "nothing") and not alike
            found.append([said == wanted, alike, false, left, (sure & left).sum(), (sure & wrong & (not left)).sum()])
            if said != wanted:
                print(f"  {fault}: {name}: {diagnosis.sentence[:200]}", flush=True)
        rows.append((fault, np.sum(found, axis=0), len(found)))
        print(row(*rows[-1]), flush=True)
    print("\nfault, named first; alike, falsely named, unexplained; unexplained & trusted, explained & trusted & wrong")
    main = [(total, number) for fault, total, number in rows if fault in FAULTS]
    rows.append(("ALL OF THE TWELVE", np.sum([total for total, _ in main], axis=0), sum(number for _, number in main)))
    for each in rows:
        print(row(*each))


def row(fault, total, count):
    """A row of the table."""
    right, *others = np.atleast_1d(total)
    return f"{fault:34} {right:3.0f}/{count:3}; {' '.join(f'{each:4.0f}' for each in others)}"


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("files", nargs="+")
    parser.add_argument("--paths", type=int, default=20)
    parser.add_argument("--faults", nargs="+", default=[*FAULTS, *MORE])
    parser.add_argument("--length", type=float, default=8)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    study(asked.files, asked.paths, asked.faults, asked.length, asked.seed)
    print(f"{process_time():.0f} s of computing")
