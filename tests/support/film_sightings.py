"""Corners of a board as a camera in a hand would see them, with known faults, and what a reader makes of them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from percept_obs.film import Board
from percept_obs.film.faults import find_faults
from percept_obs.film.lens import find_lens, find_poses

BOARD = Board()
FOCAL, BEND = 1000.0, 0.05


def waves(draw, count, low, high):
    """A smooth function of time with `count` values, of size 1, whose frequencies lie between two."""
    frequency, phase = draw.uniform(low, high, (4, count)), draw.uniform(0, 2 * np.pi, (4, count))
    return lambda t: (np.sin(2 * np.pi * t[..., None, None] * frequency + phase)).sum(axis=-2) / np.sqrt(2)


def in_a_hand(draw, distance=0.5, sway=0.12, along=0.06, turn=0.04):
    """Path of a camera that looks at the board: it sways slowly and trembles; p and R at given times."""
    slow, aim, tremble, shake = (waves(draw, 3, *band) for band in ((0.1, 0.4), (0.1, 0.5), (3, 8), (3, 8)))
    middle = BOARD.points.mean(axis=0)

    def path(t):
        p = middle + [0, 0, -distance] + slow(t) * [sway, sway, along] + 0.0005 * tremble(t)
        z = middle + aim(t) * [0.03, 0.03, 0] - p
        z /= np.linalg.norm(z, axis=-1, keepdims=True)
        x = np.cross([0, 1.0, 0], z)
        x /= np.linalg.norm(x, axis=-1, keepdims=True)
        R = np.stack([x, np.cross(z, x), z], axis=-1)
        turned = aim(t) * [turn / 4, turn / 4, turn] + 0.002 * shake(t)
        return p, R @ Rotation.from_rotvec(turned.reshape(-1, 3)).as_matrix().reshape(R.shape)

    return path


def frames(path, time, size, readout=(0.0, 0.0), zoom=None, shift=None, roll=None, places=BOARD.points):
    """Exact pixels, shape (K, n, 2), of a camera whose rows (or columns) are read one after another."""
    late, centre = np.zeros((len(time), len(places))), np.array(size) / 2
    zoom, shift, roll = (zoom or np.zeros_like), (shift or (lambda t: np.zeros((*t.shape, 2)))), (roll or np.zeros_like)
    for _ in range(6 if any(readout) else 1):
        t = time[:, None] + late
        p, R = path(t)
        X = np.einsum("knji,knj->kni", R, places - p)
        y = X[..., :2] / X[..., 2:]
        y = y * (1 + BEND * (y**2).sum(axis=-1, keepdims=True)) * (1 + zoom(t)[..., None])
        c, s = np.cos(roll(t)), np.sin(roll(t))
        y = np.stack([c * y[..., 0] - s * y[..., 1], s * y[..., 0] + c * y[..., 1]], axis=-1)
        pixels = FOCAL * y + centre
        late = (pixels / size - 0.5) @ np.array(readout)
    return pixels + shift(time)[:, None]


def spoiled(draw, pixels, size, noise=0.2, correlated=0.0, outliers=0.0, lost=0.05):
    """Pixels with noise that is correlated over frames, wild ones, and none where the picture ends or they are lost."""
    error = draw.normal(0, 1, pixels.shape)
    for k in range(1, len(error)):
        error[k] = correlated * error[k - 1] + np.sqrt(1 - correlated**2) * error[k]
    found = pixels + noise * error
    wild = draw.random(pixels.shape[:2]) < outliers
    found[wild] += draw.normal(0, 10, (int(wild.sum()), 2))
    gone = (draw.random(pixels.shape[:2]) < lost) | ~((found > 0) & (found < size)).all(axis=-1)
    found[gone] = np.nan
    return found


def read(time, pixels, size):
    """The lens and a pose for each picture, as a reader of films has them."""
    camera = find_lens(pixels, BOARD.points, size).camera
    return camera, find_poses(time, pixels, BOARD.points, camera).poses


def shift(draw):
    """Shift of a picture that is stabilised, of 20 pixels or so, slow or fast."""
    wander, size = waves(draw, 2, *((0.3, 2) if draw.random() < 0.5 else (1, 6))), draw.uniform(10, 25) / np.sqrt(2)
    return lambda t: size * wander(t)


def smooth(draw):
    """Autofocus that comes and goes: 3 % from the shortest to the longest."""
    period, phase = draw.uniform(6, 15), draw.uniform(0, 2 * np.pi)
    return lambda t: 0.015 * np.sin(2 * np.pi * t / period + phase)


def step(draw):
    """Autofocus that jumps by 3 % once."""
    when = draw.uniform(4, 8)
    return lambda t: 0.03 * (t > when)


FAULTS = {
    "clean": {},
    "20 ms": {"readout": 0.02},
    "10 ms": {"readout": 0.01},
    "focus, smooth": {"zoom": smooth},
    "focus, step": {"zoom": step},
    "stabilised": {"shift": shift},
    "20 ms, focus": {"readout": 0.02, "zoom": smooth},
    "20 ms, stabilised": {"readout": 0.02, "shift": shift},
    "focus, stabilised": {"zoom": step, "shift": shift},
}


@dataclass(frozen=True)
class Sight:
    """A film, what a reader makes of it, and the truth about it."""

    time: np.ndarray
    pixels: np.ndarray
    size: tuple
    path: object
    readout: np.ndarray

    @cached_property
    def read(self):
        return read(self.time, self.pixels, self.size)

    @cached_property
    def found(self):
        return find_faults(self.time, self.pixels, BOARD, self.size, *self.read)


def sight(seed, fault="clean", correlated=(0, 0.5), time=None, places=BOARD.points, **moved):
    """Film of 12 to 20 s with a fault, from a hand that may have moved in another way."""
    draw = np.random.default_rng([seed, 5])
    size = (1280, 720) if draw.random() < 0.7 else (720, 1280)
    usual = np.arange(int(30 * draw.uniform(12, 20))) / 30
    far = {"distance": draw.uniform(0.4, 0.6)} if size[0] > size[1] else {"distance": 0.6, "sway": 0.08}
    path, time = in_a_hand(draw, **far | moved), usual if time is None else time
    noise, outliers, late = draw.uniform(0.05, 0.2), draw.choice([0, 0.01]), draw.choice([-1, 1])
    given = {key: value(draw) if callable(value) else value for key, value in FAULTS[fault].items()}
    readout = late * given.pop("readout", 0) * np.array([size[0] < size[1], size[0] > size[1]])
    pixels = frames(path, time, size, readout, places=places, **given)
    return Sight(time, spoiled(draw, pixels, size, noise, draw.choice(correlated), outliers), size, path, readout)
