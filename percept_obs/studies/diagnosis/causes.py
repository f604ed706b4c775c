"""Usual mistakes with a camera: wrong numbers, which are fitted, and mix-ups of axes and poses, which are compared."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import permutations, product
from types import MappingProxyType

import numpy as np

from percept_obs.compile import Array
from percept_obs.recording.pose_errors import PoseErrors

LARGEST_OFFSET = 0.25
"""Largest offset in seconds between images and motion that is tried."""

OFFSET, FOCAL, BEND = "time offset", "focal length", "distortion ignored"
BIAS, DRIFT, SHUTTER = "gyro bias", "scale drift", "rolling shutter"
CENTRE, MOUNT = "principal point", "mount"

DIVIDED = "the one by which the images were divided"
TURNING = "the angular velocity is wrong by a constant"
ROWS = "rows of an image are read one after another"


@dataclass(frozen=True)
class Cause:
    """Number that may be wrong, of a camera or of a film; it is 0 where nothing is wrong, and worth naming if larger.

    What is `said` names its size, and one of two `ends` by its sign.
    """

    key: str
    said: str
    smallest: float
    ends: tuple[str, str] = field(default=("late", "early"), kw_only=True)

    def sentence(self, value: Array) -> str:
        """Return the mistake in words, with its value."""
        first, listed = float(value[0]), ", ".join(f"{each:.4f}" for each in value)
        words = {"size": abs(first), "percents": 100 * abs(first), "millis": 1000 * abs(first), "listed": listed}
        signed = {"first": first, "ratio": math.exp(first), "percent": 100 * first, "milli": 1000 * first}
        return self.said.format(**words, **signed, end=self.ends[first <= 0])


@dataclass(frozen=True)
class WrongNumber(Cause):
    """Wrong number that all points of a camera share.

    It is fitted up to `largest`.  The motion can tell it if its deviation is clearly smaller than `usual`.
    """

    largest: float
    usual: float
    unit: str
    size: int = 1

    @property
    def size_in_words(self) -> str:
        """Usual size with its unit."""
        return f"{self.usual:g} {self.unit}".removesuffix(" 1")


CAUSES = MappingProxyType(
    {
        cause.key: cause
        for cause in (
            WrongNumber(
                OFFSET, "the images are {size:.3f} s {end} against the motion", 0.005, LARGEST_OFFSET, 0.05, "s"
            ),
            WrongNumber(FOCAL, f"the focal length is {{ratio:.3f}} times {DIVIDED}", 0.01, 1.0, 0.1, "1"),
            WrongNumber(BEND, "the lens bends the images, by the factor 1 {first:+.3f} |y|^2 ...", 0.02, 0.6, 0.1, "1"),
            WrongNumber(BIAS, f"{TURNING} ({{listed}}) rad/s", 0.003, 0.3, 0.02, "rad/s", 3),
            WrongNumber(DRIFT, "the translation grows too long by {percent:.2g} % a second", 0.003, 0.3, 0.03, "1/s"),
            WrongNumber(SHUTTER, f"{ROWS}, {{milli:.3g}} ms a focal length", 0.003, 0.1, 0.02, "s"),
        )
    }
)
"""Wrong numbers by key, the commonest first."""

OWN = MappingProxyType(
    {
        CENTRE: WrongNumber(CENTRE, "", 0.0, 1.5, 0.1, "1", 2),
        MOUNT: WrongNumber(MOUNT, "", 0.0, 1.5, 0.1, "1", 6),
    }
)
"""Numbers of a mix-up, fitted with it alone: the principal point over the focal lengths, and what a mount lacks.

The mount's are a rotation vector in radians and the camera's place in metres, along axes that the mix-up has turned.
"""
NUMBERS = MappingProxyType(CAUSES | OWN)

VEHICLE = np.array([[0.0, -1, 0], [0, 0, -1], [1, 0, 0]])


Mount = tuple[Array, Array] | None
Change = Callable[[Array, Array], tuple[Array, Array]]
"""Function of the motion's A and b, shapes (T, 3, 3) and (T, 3), as they are believed; it returns the right ones."""


def _axes(into: Array) -> Change:
    return lambda A, b: (into @ A @ into.T, b @ into.T)


def _same(A: Array, b: Array) -> tuple[Array, Array]:
    return A, b


def _inverted(poses: Array, mount: Mount) -> Array:
    return np.asarray(np.linalg.inv(poses))


def _back(poses: Array, mount: Mount) -> Array:
    """Poses, matrices of shape (T, 4, 4), with their rotations inverted."""
    found = poses.copy()
    found[:, :3, :3] = poses[:, :3, :3].swapaxes(1, 2)
    return found


def _rolled(steps: int) -> Callable[[Array, Mount], Array]:
    """Change of poses to those whose quaternions x, y, z, w are the believed ones' numbers, moved on by some places."""

    def right(poses: Array, mount: Mount) -> Array:
        from scipy.spatial.transform import Rotation

        found, quaternions = poses.copy(), Rotation.from_matrix(poses[:, :3, :3]).as_quat()
        found[:, :3, :3] = Rotation.from_quat(np.roll(quaternions, steps, axis=1)).as_matrix()
        return found

    return right


def _remounted(poses: Array, mount: Mount) -> Array:
    """Poses of a camera whose believed mount is the inverse of the right one."""
    assert mount is not None
    believed = np.eye(4)
    believed[:3, 3], believed[:3, :3] = mount
    back = np.linalg.inv(believed)
    return np.asarray(poses @ back @ back)


@dataclass(frozen=True)
class MixUp:
    """Signs, axes, poses or files mixed up, and the motion without it.

    It undoes the motion's rates, or, if it has a function for it, the poses behind them.  Its `own` numbers are fitted
    with it, each from some start; `fisheye` says that the images are those of an equidistant lens.
    """

    key: str
    sentence: str
    undone: Change = _same
    poses: Callable[[Array, Mount], Array] | None = None
    own: Mapping[str, tuple[float, ...]] = field(default_factory=dict, kw_only=True)
    fisheye: bool = field(default=False, kw_only=True)

    @property
    def plain(self) -> bool:
        """True if it is of signs or axes alone, which any motion may have."""
        return not (self.own or self.poses or self.fisheye)

    def can_be(self, errors: PoseErrors | None) -> bool:
        """Return True if a motion with such errors of its poses may have it."""
        mounted = errors is not None and errors.mount is not None
        if MOUNT in self.own or self.poses is _remounted:
            return mounted is (self.poses is _remounted)
        return errors is not None or self.poses is None


CAMERA = "it is needed in the camera's (x right, y down, z forward)"
FISHEYE = "the lens is a fisheye, equidistant, and its images were divided as those of a pinhole"
OF_WORLD = "are those of the world in the camera, and were given as the camera's in the world"
SIZES = "the images have another size than those of the calibration, so that focal length and principal point are wrong"
LEFT_OUT = "the motion is that of another body, such as an IMU, and not of the camera on it: give its mount"
SIGNED = [np.diag(signs)[list(order)] for order in permutations(range(3)) for signs in product((1.0, -1), repeat=3)]
TURNS = [turn for turn in SIGNED if np.linalg.det(turn) > 0]
"""The 24 turns that bring axes onto axes."""

_MIX_UPS = {
    "nothing": MixUp("nothing", ""),
    "w": MixUp("sign of w_c", "the angular velocity has the wrong sign", lambda A, b: (np.swapaxes(A, 1, 2), b)),
    "v": MixUp("sign of v", "the translation has the wrong sign", lambda A, b: (A, -b)),
    "y": MixUp("flipped axis", "the y axis of the images is flipped", _axes(np.diag([1.0, -1, 1]))),
    "x": MixUp("flipped axis", "the x axis of the images is flipped", _axes(np.diag([-1.0, 1, 1]))),
    "xy": MixUp("flipped axis", "the images are upside down", _axes(np.diag([-1.0, -1, 1]))),
    "vehicle": MixUp(
        "frames swapped", f"the motion is in a vehicle's frame (x forward, y left, z up); {CAMERA}", _axes(VEHICLE)
    ),
    "out of vehicle": MixUp(
        "frames swapped",
        "the motion was turned out of a vehicle's frame, but was the camera's before",
        _axes(VEHICLE.T),
    ),
    "renderer": MixUp(
        "frames swapped",
        f"the motion is in a renderer's frame (x right, y up, z back); {CAMERA}",
        _axes(np.diag([1.0, -1, -1])),
    ),
    "world": MixUp("poses inverted", f"the poses {OF_WORLD}", poses=_inverted),
    "turned back": MixUp("rotations inverted", f"the rotations {OF_WORLD}", poses=_back),
    "w first": MixUp("quaternion order", "quaternions w, x, y, z were read as x, y, z, w", poses=_rolled(-1)),
    "w last": MixUp("quaternion order", "quaternions x, y, z, w were read as w, x, y, z", poses=_rolled(1)),
    "mount": MixUp(
        "mount inverted", "the mount is the body's in the camera, given as the camera's on the body", poses=_remounted
    ),
    "uv": MixUp(
        "u and v exchanged",
        "u and v are exchanged: v goes along the columns of the image",
        _axes(np.eye(3)[[1, 0, 2]]),
        own={CENTRE: (0.0, 0.0)},
    ),
    "fisheye": MixUp("fisheye ignored", FISHEYE, fisheye=True),
}
_MIX_UPS |= {
    f"size {ratio:g}": MixUp(
        "image size",
        SIZES,
        own={FOCAL: (math.log(ratio),), CENTRE: (0.6 * (ratio - 1), 0.4 * (ratio - 1))},
    )
    for ratio in (0.5, 1, 2)
}
_MIX_UPS |= {
    f"mount {k}": MixUp("mount left out", LEFT_OUT, _axes(turn), own={MOUNT: (0.0,) * 6})
    for k, turn in enumerate(TURNS)
}
MIX_UPS = MappingProxyType(_MIX_UPS)
"""Mix-ups by name."""
