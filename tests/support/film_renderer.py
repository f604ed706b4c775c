"""Films of a printed board on a table with things around it, drawn from a known motion, with the whole truth.

Pixels are counted as in OpenCV: (0, 0) is the centre of the first one. A film higher than wide is stored turned, with a
display matrix, as telephones do; the truth is about the upright picture.
"""

from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from pathlib import Path

import av
import cv2
import numpy as np
from numba import njit
from scipy.interpolate import RectBivariateSpline
from scipy.spatial.transform import Rotation

from percept_obs import PixelCamera, Poses
from percept_obs.film import Board

BOARD = Board()
CENTRE = np.array([*BOARD.size, 0.0]) / 2
TICKS = 90_000
"""Ticks of the film's clock in a second."""
UPRIGHT = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1.0]])
"""From the camera's frame of an upright picture to the frame of the sensor, whose x axis points up."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """Textured rectangle: a corner and two edges in the world, in metres, and grey values."""

    corner: np.ndarray
    across: np.ndarray
    down: np.ndarray
    texture: np.ndarray = field(repr=False)

    @cached_property
    def sizes(self):
        """The texture and smaller ones, each by the square root of 2: all bytes, first bytes, and shapes (n, 2)."""
        sizes = [self.texture]
        while min(sizes[-1].shape) > 8:
            small = np.round(np.array(self.texture.shape[::-1]) / 2 ** (len(sizes) / 2)).astype(int)
            sizes.append(cv2.resize(self.texture, small.tolist(), interpolation=cv2.INTER_AREA))
        starts = np.cumsum([0, *[each.size for each in sizes[:-1]]])
        return np.concatenate([each.ravel() for each in sizes]), starts, np.array([each.shape for each in sizes])

    def maps(self, position, matrix):
        """Matrices that take rays (a, b, 1) of cameras to (s, t, 1) / Z, shape (n, 3, 3): s across, t down, Z depth."""
        towards, normal = self.corner - position, np.cross(self.across, self.down)
        rows = [np.cross(self.down, towards), np.cross(towards, self.across), np.broadcast_to(normal, towards.shape)]
        return np.stack(rows, axis=1) @ matrix / (towards @ normal)[:, None, None]

    @property
    def corners(self):
        """Its four corners, shape (4, 3)."""
        return self.corner + np.array([0 * self.across, self.across, self.across + self.down, self.down])


def _unit(vectors):
    """Vectors of length 1."""
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def _moved(matrix, pixels):
    """Pixels moved by matrices of shape (3, 3) or (n, 3, 3)."""
    return (matrix[..., :2, :2] @ pixels[..., None])[..., 0] + matrix[..., :2, 2]


def card(rng, corner, across, down, density, shade=1.0, plain=False):
    """Sheet with a random picture of so many pixels a metre: strong corners of many sizes, or a table's faint grain."""
    w, h = (max(16, round(np.linalg.norm(edge) * density)) for edge in (across, down))
    grey = np.full((h, w), rng.uniform(110, 190), np.float32)
    for cells in (4, 16, 64) if plain else (3,):  # longer along the grain
        coarse = rng.normal(size=(cells * (1 + 3 * plain), cells)).astype(np.float32)
        grey += 7 * cv2.resize(coarse, (w, h), interpolation=cv2.INTER_CUBIC)
    shapes = ((0.004, 300), (0.002, 700)) if plain else ((0.03, 1200), (0.012, 3000), (0.005, 6000))  # number in a m^2
    for size, number in shapes:
        for _ in range(round(number * w * h / density**2)):
            around = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, 6)))
            ring = np.stack([np.cos(around), np.sin(around)], axis=1) * rng.uniform(0.5, 1.2) * size * density
            points = np.round(ring + rng.uniform(0, [w, h])).astype(np.int32)
            cv2.fillPoly(grey, [points], rng.uniform(80, 200) if plain else rng.uniform(15, 245))
    return Sheet(corner, across, down, np.clip(shade * grey, 0, 255).astype(np.uint8))


def paper(density, middle=CENTRE, turn=0.0):
    """Sheet with the board at a place of the table, turned, and a margin of white paper."""
    pixels = 4 * round(BOARD.square * density / 4)
    texture = cv2.copyMakeBorder(BOARD.picture(pixels), *[pixels // 5] * 4, cv2.BORDER_CONSTANT, value=255)
    texture = (25 + 0.82 * texture).astype(np.uint8)  # ink is not black, nor paper as white as can be
    x, y, _ = Rotation.from_rotvec([0, 0, turn]).as_matrix().T * BOARD.square / pixels
    across, down = x * texture.shape[1], y * texture.shape[0]
    return Sheet(middle - (across + down) / 2, across, down, texture)


def scene(seed, heading=0.0, boards=1, density=2500):
    """Sheets: the table, boards on it, and boxes and cards around, high ones away from who stands at the heading."""
    rng = np.random.default_rng([seed, 1])
    side, towards, up = Rotation.from_rotvec([0, 0, heading]).as_matrix().T * [[1], [1], [-1]]
    corner = CENTRE - 1.2 * side - 1.1 * towards - 0.001 * up  # just below the paper
    sheets = [card(rng, corner, 2.4 * side, 1.8 * towards, min(density / 2, 2500), plain=True)]
    sheets += [paper(density), paper(density, CENTRE - 0.33 * side, heading + 0.1)][:boards]
    spots = np.array([[-0.07, -0.19], [0.23, -0.07], [0.09, -0.21], [0.25, 0.11], [-0.25, -0.14], [-0.24, 0.07]])
    for number, spot in enumerate(spots[: 4 if boards > 1 else 6]):
        x, y, _ = Rotation.from_rotvec([0, 0, heading + rng.uniform(-0.5, 0.5)]).as_matrix().T
        foot = CENTRE + np.array([*spot + rng.uniform(-0.02, 0.02, 2)]) @ [side, towards]
        w, d = rng.uniform(0.07, 0.11, 2)
        h = rng.uniform(0.02, 0.08) if spot[1] > 0 else rng.uniform(0.06, 0.22)
        if number < 2:  # a card that leans back
            lean = up * h - y * rng.uniform(0.02, 0.08)
            sheets.append(card(rng, foot - x * w / 2 + lean, x * w, -lean, density))
            continue
        corner = foot - x * w / 2 - y * d / 2 + up * h
        sheets.append(card(rng, corner, x * w, y * d, density))
        for start, edge, shade in ((0, x * w, 0.6), (y * d, x * w, 0.85), (0, y * d, 0.7), (x * w, y * d, 0.9)):
            sheets.append(card(rng, corner + start, edge, -up * h, density, shade))
    return tuple(sheets)


@dataclass(frozen=True)
class Motion:
    """Smooth path of a hand-held camera: "sweep", "axis" (along the optical axis), "turn" (only) or "sideways"."""

    kind: str = "sweep"
    seed: int = 0
    heading: float = 0.0
    tremor: float = 1.0
    quick: float = 0.0
    """Share of a hand that shakes: to and fro once in 1/3 to 3 s by 1 to 8 cm, and by some degrees."""

    @cached_property
    def shake(self):
        """Angular frequency in rad/s, amplitudes of the shift in metres and of the turn in radians, and phases."""
        rng = np.random.default_rng([self.seed, 8])
        frequency, reach = rng.uniform(0.3, 3), rng.uniform(0.01, 0.08)
        reach = min(reach, 0.08 / max(1.0, frequency))  # no arm is both that quick and that wide
        along, about = (each / np.linalg.norm(each) for each in rng.normal(size=(2, 3)) * [[1, 1, 0.5], [1, 1, 0.2]])
        turn = np.deg2rad(rng.uniform(0.5, 2.0)) / max(1.0, frequency)
        return 2 * np.pi * frequency, reach * along, turn * about, rng.uniform(0, 2 * np.pi, 2)

    def shaken(self, time):
        """Shift in metres and turn in radians of the shaking hand, each of shape (n, 3)."""
        rate, shift, turn, phase = self.shake
        waves = np.sin(np.multiply.outer(rate * time, [1, 1]) + phase) * self.quick
        return np.multiply.outer(waves[:, 0], shift), np.multiply.outer(waves[:, 1], turn)

    def tremors(self, time):
        """Shift in metres and turn in radians of the trembling hand, each of shape (n, 3)."""
        rng = np.random.default_rng([self.seed, 2])
        rate, phase = rng.uniform([2 * np.pi], 6 * np.pi, (3, 6)), rng.uniform(0, 2 * np.pi, (3, 6))
        waves = np.sin(np.multiply.outer(time, rate) + phase).sum(axis=1) * np.sqrt(2 / 3) * self.tremor
        return waves[:, :3] * 0.0015, waves[:, 3:] * np.deg2rad(0.2)

    def smooth(self, time):
        """Positions, shape (n, 3), and rotations without the tremor."""
        rng = np.random.default_rng([self.seed, 3])
        pace, phase, far = rng.uniform(0.85, 1.15, 8), rng.uniform(0, 2 * np.pi, 8), rng.uniform(0.57, 0.65)
        rate, swept = pace * [0.6, 0.45, 0.3, 0.6, 0.7, 0.4, 1, 1], self.kind == "sweep"
        side, slope, near, x, y, roll = np.sin(np.multiply.outer(swept * time, rate) + phase).T[:6]
        a, b = np.sin(np.multiply.outer(time, rate[6:]) + phase[6:]).T
        span = 1 if swept else 0.3
        away = np.stack([span * 0.55 * side, 0.42 + span * 0.3 * slope, near * 0 - 1], axis=1)
        position = _unit(away) * (far + swept * 0.06 * near)[:, None]
        z = _unit(0.03 * np.stack([x, y, 0 * x], axis=1) - position)
        right = _unit(np.cross([0, 1.0, 0], z))
        turned = Rotation.from_rotvec([0, 0, self.heading])
        rotation = turned * Rotation.from_matrix(np.stack([right, np.cross(z, right), z], axis=2))
        rotation *= Rotation.from_rotvec(np.multiply.outer(0.12 * roll, [0, 0, 1.0]))
        if self.kind == "turn":
            rotation *= Rotation.from_rotvec(np.stack([0.1 * a, 0.15 * b, 0 * a], axis=1))
        shift = np.multiply.outer(a, {"axis": [0, 0, 0.13], "sideways": [0.16, 0, 0]}.get(self.kind, [0, 0, 0]))
        return CENTRE + turned.apply(position) + rotation.apply(shift), rotation

    def pose(self, time):
        """Positions, shape (n, 3), and rotations: X_world = R X_camera + p, in the frame of the upright camera."""
        time = np.ravel(time).astype(float)
        position, rotation = self.smooth(time)
        for shift, turn in (self.shaken(time), self.tremors(time)):
            position, rotation = position + shift, rotation * Rotation.from_rotvec(turn)
        return position, rotation

    def velocity(self, time, step=1e-4):
        """Velocity in m/s and angular velocity in rad/s along the camera's axes, shapes (n, 3)."""
        time = np.ravel(time).astype(float)
        (p, before), (q, after) = self.pose(time - step), self.pose(time + step)
        turning = (before.inv() * after).as_rotvec() / (2 * step)
        return self.pose(time)[1].inv().apply((q - p) / (2 * step)), turning


@dataclass(frozen=True)
class Faults:
    """Whatever a telephone does to a film."""

    readout: float = 0.0  # s; row v is exposed at t + (v / h - 1 / 2) readout
    exposure: float = 0.0  # s
    blur: float = 0.0  # standard deviation in pixels
    focus: float = 0.0  # amplitude of a slow change of the focal length, relative
    focus_step: float = 0.0  # relative step of the focal length in the middle of the film, over about 0.3 s
    stabilised: float = 0.0  # pixels that the picture wanders against the lens, while the tremor is taken out
    noise: float = 2.0  # standard deviation in grey values
    brightness: float = 0.0  # relative amplitude
    uneven: float = 0.0  # intervals of frames vary by so much, relative, below 1
    black: tuple = ()  # numbers of black frames


@dataclass(frozen=True, eq=False)
class Truth:
    """All that is true of a film; pixels are those of the upright picture."""

    time: np.ndarray  # of the frames, when the row in the middle is exposed
    camera: PixelCamera
    sheets: tuple
    motion: Motion
    faults: Faults
    placed: np.ndarray = field(repr=False)  # (K, 3, 3) from the pixels of the lens to those of the picture, upright

    @property
    def poses(self):
        """Poses at the frames' times."""
        position, rotation = self.motion.pose(self.time)
        return Poses(self.time, position, rotation.as_matrix())

    def frame(self, time):
        """Number of the frame nearest in time."""
        return np.abs(np.subtract.outer(time, self.time)).argmin(axis=-1)

    def lens_pixels(self, frame, pixels):
        """Pixels without stabilisation or focusing, shape (n, 2)."""
        return _moved(np.linalg.inv(self.placed[frame]), np.asarray(pixels, float))

    def row_time(self, frame, pixels):
        """Time when pixels of a frame are exposed, shape (n,)."""
        w, h = self.camera.size
        u, v = self.lens_pixels(frame, pixels).T
        part = (w - 1 - u) / w if h > w else v / h  # a film higher than wide is read along its rows, from the right
        return self.time[frame] + (part - 0.5) * self.faults.readout

    def distance_at(self, time, pixels):
        """Depth Z in metres of what is seen at times and pixels, shapes (n,) and (n, 2); NaN for the background."""
        time = np.broadcast_to(time, len(pixels))
        position, rotation = self.motion.pose(time)
        rays = self.camera.image(self.lens_pixels(self.frame(time), pixels))
        rays, nearest = np.concatenate([rays, np.ones((len(rays), 1))], axis=1), np.zeros(len(rays))
        for sheet in self.sheets:
            with np.errstate(all="ignore"):
                s, t, inverse = (sheet.maps(position, rotation.as_matrix()) @ rays[..., None])[..., 0].T
                hit = (inverse > 0) & (s >= 0) & (s <= inverse) & (t >= 0) & (t <= inverse)
            nearest = np.where(hit, np.fmax(nearest, inverse), nearest)
        return np.divide(1, nearest, out=np.full(len(rays), np.nan), where=nearest > 0)

    def project(self, frame, places):
        """Pixels of places in a frame, at the times of their rows, shape (n, 2); NaN out of the picture."""
        time = np.full(len(places), self.time[frame])
        for _ in range(5):
            position, rotation = self.motion.pose(time)
            local = rotation.inv().apply(places - position)
            pixels = _moved(self.placed[frame], self.camera.pixels(local[:, :2] / local[:, 2:]))
            time = self.row_time(frame, pixels)
        inside = ((pixels > -0.5) & (pixels < np.array(self.camera.size) - 0.5)).all(axis=1) & (local[:, 2] > 0)
        return np.where(inside[:, None], pixels, np.nan)

    def corners(self, frame):
        """Pixels of the board's corners in a frame, shape (24, 2)."""
        return self.project(frame, BOARD.points)


@njit(cache=True, fastmath=True)
def paint(grey, near, rays, maps, focal, box, texture, starts, shapes):
    """Draw a sheet in a box where it is nearer than what is drawn; each row of pixels has its map."""
    top, bottom, left, right = box
    for v in range(top, bottom):
        m = maps[v - top]
        area = m[0, 0] * (m[1, 1] * m[2, 2] - m[1, 2] * m[2, 1]) - m[0, 1] * (m[1, 0] * m[2, 2] - m[1, 2] * m[2, 0])
        area = abs(area + m[0, 2] * (m[1, 0] * m[2, 1] - m[1, 1] * m[2, 0])) * shapes[0, 0] * shapes[0, 1] / focal**2
        start, h, w, used = 0, 0, 0, left - 16
        for u in range(left, right):
            a, b = rays[v, u]
            inverse = m[2, 0] * a + m[2, 1] * b + m[2, 2]
            if inverse <= near[v, u]:
                continue
            s = (m[0, 0] * a + m[0, 1] * b + m[0, 2]) / inverse
            t = (m[1, 0] * a + m[1, 1] * b + m[1, 2]) / inverse
            if min(min(s, 1 - s), min(t, 1 - t)) < -0.1:
                continue
            if u >= used + 16:  # the size that has about one pixel for each of the picture's
                used, k = u, int(np.log2(max(area / inverse**3, 1.0)) + 0.8)
                k = min(k, len(starts) - 1)
                start, h, w = starts[k], shapes[k, 0], shapes[k, 1]
            x, y = s * w, t * h
            part = min(min(x, w - x), min(y, h - y)) + 0.5  # of the pixel that the sheet covers
            if part <= 0:
                continue
            x, y = min(max(x - 0.5, 0.0), w - 1.001), min(max(y - 0.5, 0.0), h - 1.001)
            i, j = int(x), int(y)
            x, y, at = x - i, y - j, start + j * w + i
            value = (1 - y) * ((1 - x) * texture[at] + x * texture[at + 1])
            value += y * ((1 - x) * texture[at + w] + x * texture[at + w + 1])
            grey[v, u] += min(part, 1.0) * (value - grey[v, u])
            if part > 0.5:
                near[v, u] = inverse


class Renderer:
    """Draws pictures in a camera whose rows are exposed at times, with a margin around them."""

    def __init__(self, sheets, camera, margin=0):
        self.sheets, self.camera, self.margin = sheets, camera, margin
        w, h = map(int, camera.size)
        u, v = np.arange(-margin, w + margin), np.arange(-margin, h + margin)
        coarse = [np.linspace(line[0], line[-1], len(line) // 16 + 6) for line in (u, v)]
        image = camera.image(np.stack(np.meshgrid(*coarse), axis=-1))  # smooth, so a spline of some is exact enough
        fine = [RectBivariateSpline(*coarse[::-1], image[..., k])(v, u) for k in (0, 1)]
        self.rays = np.stack(fine, axis=-1).astype(np.float32)

    def box(self, sheet, position, matrix):
        """First and last row and column where a sheet may be seen."""
        h, w = self.rays.shape[:2]
        local = np.concatenate([(sheet.corners - p) @ r for p, r in zip(position, matrix, strict=True)])
        if local[:, 2].min() < 0.05:
            return 0, h, 0, w
        image = np.clip(local[:, :2] / local[:, 2:], -1.2, 1.2)
        pixels, slack = self.camera.pixels(image) + self.margin, 3 + 0.02 * w
        (left, top), (right, bottom) = pixels.min(axis=0) - slack, pixels.max(axis=0) + slack
        return (*np.clip([top, bottom], 0, h).astype(int).tolist(), *np.clip([left, right], 0, w).astype(int).tolist())

    def picture(self, position, matrix):
        """Grey values, shape (h, w), where each row has a pose of its own."""
        h, w = self.rays.shape[:2]
        grey, near = np.full((h, w), 60, np.float32), np.zeros((h, w), np.float32)
        away = [-np.linalg.norm(sheet.corners.mean(axis=0) - position[h // 2]) for sheet in self.sheets[1:]]
        for number in (0, *1 + np.argsort(away)):  # the table, then from far to near
            sheet = self.sheets[number]
            box = top, bottom, left, right = self.box(sheet, position[:: h // 2], matrix[:: h // 2])
            if top < bottom and left < right:
                maps = sheet.maps(position[top:bottom], matrix[top:bottom]).astype(np.float32)
                paint(grey, near, self.rays, maps, self.camera.focal[0], box, *sheet.sizes)
        return grey


def stored(camera):
    """Camera of the pictures as they are stored: those higher than wide lie on their side."""
    if camera.size[1] <= camera.size[0]:
        return camera
    k1, k2, p1, p2, *others = [*camera.distortion, *[0.0] * 4][: max(4, len(camera.distortion))]
    centre = camera.centre[1], camera.size[0] - 1 - camera.centre[0]
    size = [int(each) for each in camera.size[::-1]]
    return PixelCamera(camera.focal[::-1], centre, size, (k1, k2, -p2, p1, *others))


def placements(time, camera, motion, faults, seed):
    """Matrices (K, 3, 3) from pixels of the lens to those of the upright picture: focusing and stabilisation."""
    rng = np.random.default_rng([seed, 4])
    rate, phase = rng.uniform(1, 4, (3, 3)), rng.uniform(0, 2 * np.pi, (3, 3))
    wander = np.sin(np.multiply.outer(time, rate) + phase).sum(axis=1) / np.sqrt(1.5) * faults.stabilised
    zoom = 1 + faults.focus * np.sin(2 * np.pi * time / 5 + phase[0, 0])
    zoom += faults.focus_step * (1 + np.tanh((time - time.mean()) / 0.08)) / 2
    turn = motion.tremors(time)[1] * (faults.stabilised > 0)
    shift = wander[:, :2] + turn[:, 1::-1] * [1, -1] * camera.focal
    angle = turn[:, 2] + 0.0003 * wander[:, 2]
    placed = np.tile(np.eye(3), (len(time), 1, 1))
    placed[:, :2, :2] = Rotation.from_rotvec(np.multiply.outer(angle, [0, 0, 1])).as_matrix()[:, :2, :2]
    placed[:, :2, :2] *= zoom[:, None, None]
    placed[:, :2, 2] = shift + camera.centre - placed[:, :2, :2] @ camera.centre
    return placed


def pictures(truth, seed=0):
    """Stored pictures of a film, one after the other, as arrays of bytes, shape (h, w)."""
    faults, camera, rng = truth.faults, stored(truth.camera), np.random.default_rng([seed, 5])
    (w, h), upright = map(int, camera.size), camera == truth.camera
    moved = bool(faults.focus or faults.focus_step or faults.stabilised)
    margin = int(moved * np.ceil(4 * faults.stabilised + 0.03 * w))
    renderer = Renderer(truth.sheets, camera, margin)
    delay = (np.arange(-margin, h + margin) / h - 0.5) * faults.readout
    parts = (np.arange(5) - 2) / 5 * faults.exposure if faults.exposure else [0.0]
    pool = faults.noise * rng.standard_normal((h + 64, w + 64), dtype=np.float32)
    lie = np.eye(3) if upright else np.array([[0, 1, 0], [-1, 0, truth.camera.size[0] - 1], [0, 0, 1]])
    to_upright = np.eye(3) if upright else UPRIGHT.T
    for number, time in enumerate(truth.time):
        poses = (truth.motion.pose(time + part + delay) for part in parts)
        grey = sum(renderer.picture(p, r.as_matrix() @ to_upright) for p, r in poses) / len(parts)
        if moved:
            shift = np.array([[1, 0, -margin], [0, 1, -margin], [0, 0, 1]])
            placed = lie @ truth.placed[number] @ np.linalg.inv(lie) @ shift
            grey = cv2.warpAffine(grey, placed[:2], (w, h), flags=cv2.INTER_CUBIC)
        if faults.blur:
            grey = cv2.GaussianBlur(grey, (0, 0), faults.blur)
        grey *= 1 + faults.brightness * np.sin(2 * np.pi * time / 3.7)
        grey *= number not in faults.black
        y, x = rng.integers(0, 64, 2)
        yield np.clip(np.rint(grey + pool[y : y + h, x : x + w]), 0, 255).astype(np.uint8)


def write_film(path, sheets, motion, camera, duration, rate=30, faults=None, seed=0, bits=0.36):
    """Write an MP4 file of H.264 and return the truth."""
    faults, rng = faults or Faults(), np.random.default_rng([seed, 6])
    steps = (1 + faults.uneven * rng.uniform(-1, 1, round(duration * rate))) * TICKS / rate
    ticks = np.round(np.cumsum(steps) - steps[0]).astype(int)
    time = ticks / TICKS
    truth = Truth(time, camera, tuple(sheets), motion, faults, placements(time, camera, motion, faults, seed))
    with av.open(str(path), "w") as file:
        stream = file.add_stream("libx264", rate=rate, options={"preset": "superfast"})
        stream.width, stream.height = map(int, stored(camera).size)
        stream.bit_rate = round(bits * stream.width * stream.height * rate)  # 10 Mbit/s at 1280 x 720, as telephones do
        stream.pix_fmt, stream.codec_context.time_base = "yuv420p", Fraction(1, TICKS)
        if stored(camera) != camera:
            stream.set_display_rotation(-90)
        for tick, picture in zip(ticks, pictures(truth, seed), strict=True):
            frame = av.VideoFrame.from_ndarray(picture, format="gray")
            frame.pts, frame.time_base = int(tick), Fraction(1, TICKS)
            file.mux(stream.encode(frame))
        file.mux(stream.encode())
    return truth


def standard_film(
    seed,
    folder,
    kind="sweep",
    size=(1280, 720),
    duration=None,
    rate=30,
    boards=1,
    upside_down=False,
    tremor=1.0,
    quick=1.0,
    **faults,
):
    """Write the file SEED.mp4 of a film; camera, hand, path and scene vary with the seed.  Return path and truth."""
    rng = np.random.default_rng([seed, 7])
    heading = rng.uniform(-0.4, 0.4) + np.pi * upside_down
    focal, long = rng.uniform(900, 1200) / 1280 * max(size), rng.uniform(12, 18)
    centre = (np.array(size) - 1) / 2 + rng.uniform(-0.01, 0.01, 2) * max(size)
    lens = (rng.uniform(-0.05, 0.1), rng.uniform(-0.03, 0.03), *rng.uniform(-0.0005, 0.0005, 2))
    camera = PixelCamera((focal, focal), centre, size, lens)  # a telephone's pixels are square
    path = Path(folder) / f"{seed}.mp4"
    sheets, motion = scene(seed, heading, boards, focal / 0.45), Motion(kind, seed, heading, tremor, quick)
    return path, write_film(path, sheets, motion, camera, duration or long, rate, Faults(**faults), seed)


def quick_film(seed, folder, size=(640, 360), duration=5.0, rate=20, **others):
    """Write a small film as `standard_film` does."""
    return standard_film(seed, folder, size=size, duration=duration, rate=rate, **others)


def example_film(path):
    """Write the film that ships with the package, `percept_obs.film.example_film`, and return the truth."""
    camera = PixelCamera((405, 405), (239.5, 134.5), (480, 270), (0.03, -0.01, 0, 0))
    return write_film(path, scene(4, density=1200), Motion(seed=4), camera, 6, 12, Faults(noise=1.0), 4, bits=0.35)
