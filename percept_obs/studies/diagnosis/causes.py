"""Usual mistakes with a camera: wrong numbers, which are fitted, and mix-ups of axes, which are compared."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from percept_obs.compile import Array

LARGEST_OFFSET = 0.25
"""Largest offset in seconds between images and motion that is tried."""

OFFSET, FOCAL, BEND = "time offset", "focal length", "distortion ignored"
BIAS, DRIFT, SHUTTER = "gyro bias", "scale drift", "rolling shutter"

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
        signed = {"first": first, "ratio": 1 + first, "percent": 100 * first, "milli": 1000 * first}
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
            WrongNumber(FOCAL, f"the focal length is {{ratio:.3f}} times {DIVIDED}", 0.01, 0.5, 0.1, "1"),
            WrongNumber(BEND, "the lens bends the images, by the factor 1 {first:+.3f} |y|^2", 0.02, 0.6, 0.1, "1"),
            WrongNumber(BIAS, f"{TURNING} ({{listed}}) rad/s", 0.003, 0.3, 0.02, "rad/s", 3),
            WrongNumber(DRIFT, "the translation grows too long by {percent:.2g} % a second", 0.003, 0.3, 0.03, "1/s"),
            WrongNumber(SHUTTER, f"{ROWS}, {{milli:.3g}} ms a focal length", 0.003, 0.1, 0.02, "s"),
        )
    }
)
"""Wrong numbers by key, the commonest first."""

VEHICLE = np.array([[0.0, -1, 0], [0, 0, -1], [1, 0, 0]])

Change = Callable[[Array, Array], tuple[Array, Array]]
"""Function of the motion's A and b, shapes (T, 3, 3) and (T, 3), as they are believed; it returns the right ones."""


def _axes(into: Array) -> Change:
    return lambda A, b: (into @ A @ into.T, b @ into.T)


@dataclass(frozen=True)
class MixUp:
    """Signs or axes mixed up, and the motion without it."""

    key: str
    sentence: str
    undone: Change


CAMERA = "it is needed in the camera's (x right, y down, z forward)"

MIX_UPS = MappingProxyType(
    {
        "nothing": MixUp("nothing", "", lambda A, b: (A, b)),
        "w": MixUp("sign of w_c", "the angular velocity has the wrong sign", lambda A, b: (np.swapaxes(A, 1, 2), b)),
        "v": MixUp("sign of v", "the translation has the wrong sign", lambda A, b: (A, -b)),
        "y": MixUp("flipped axis", "the y axis of the images is flipped", _axes(np.diag([1.0, -1, 1]))),
        "x": MixUp("flipped axis", "the x axis of the images is flipped", _axes(np.diag([-1.0, 1, 1]))),
        "xy": MixUp("flipped axis", "the images are upside down", _axes(np.diag([-1.0, -1, 1]))),
        "vehicle": MixUp(
            "frames swapped",
            f"the motion is in a vehicle's frame (x forward, y left, z up); {CAMERA}",
            _axes(VEHICLE),
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
    }
)
"""Mix-ups by name."""
