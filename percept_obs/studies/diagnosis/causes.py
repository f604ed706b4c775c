"""Usual mistakes with a camera: wrong numbers, which are fitted, and mix-ups of axes, which are compared."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from percept_obs.compile import Array

LARGEST_OFFSET = 0.25
"""Largest offset in seconds between images and motion that is tried."""


@dataclass(frozen=True)
class Cause:
    """Wrong number that all points of a camera share; it is 0 where nothing is wrong.

    It is fitted up to `largest`, and worth naming from `smallest` on.  The motion can tell it if its deviation is
    clearly smaller than `usual`.
    """

    key: str
    sentence: Callable[[Array], str]
    largest: float
    smallest: float
    usual: float
    unit: str
    size: int = 1

    @property
    def size_in_words(self) -> str:
        """Usual size with its unit."""
        return f"{self.usual:g} {self.unit}".removesuffix(" 1")


def _offset(late: Array) -> str:
    return f"the images are {abs(late[0]):.3f} s {'late' if late[0] > 0 else 'early'} against the motion"


def _many(values: Array) -> str:
    return ", ".join(f"{value:.4f}" for value in values)


CAUSES = MappingProxyType(
    {
        cause.key: cause
        for cause in (
            Cause(
                "time offset",
                lambda late: (
                    f"the images are {abs(late[0]):.3f} s {'late' if late[0] > 0 else 'early'} against the motion"
                ),
                LARGEST_OFFSET,
                0.005,
                0.05,
                "s",
            ),
            Cause(
                "focal length",
                lambda more: f"the focal length is {1 + more[0]:.3f} times the one by which the images were divided",
                0.5,
                0.01,
                0.1,
                "1",
            ),
            Cause(
                "distortion ignored",
                lambda bend: f"the lens bends the images, by the factor 1 {bend[0]:+.3f} |y|^2",
                0.6,
                0.02,
                0.1,
                "1",
            ),
            Cause(
                "gyro bias",
                lambda bias: f"the angular velocity is wrong by a constant ({_many(bias)}) rad/s",
                0.3,
                0.003,
                0.02,
                "rad/s",
                3,
            ),
            Cause(
                "scale drift",
                lambda rate: f"the translation grows too long by {100 * rate[0]:.2g} % a second",
                0.3,
                0.003,
                0.03,
                "1/s",
            ),
            Cause(
                "rolling shutter",
                lambda rows: f"rows of an image are read one after another, {1000 * rows[0]:.3g} ms a focal length",
                0.1,
                0.003,
                0.02,
                "s",
            ),
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
