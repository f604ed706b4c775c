"""Usual mistakes with a camera, each as an experiment: the recordings as they would be without the mistake."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp

from percept_obs.compile import Array
from percept_obs.recording import Recording
from percept_obs.system.motion import Motion
from percept_obs.system.signal import OverTime, Signal

LARGEST_OFFSET = 0.25
"""Largest offset in seconds between images and motion that is tried."""

VEHICLE = sp.ImmutableMatrix([[0, -1, 0], [0, 0, -1], [1, 0, 0]])
FRAMES = {
    "is in a vehicle's frame (x forward, y left, z up)": VEHICLE,
    "was turned out of a vehicle's frame, but was the camera's before": VEHICLE.T,
    "is in a renderer's frame (x right, y up, z back)": sp.ImmutableMatrix.diag(1, -1, -1),
}
"""Wrong frames of a motion, each with the rotation into the camera's (x right, y down, z forward)."""

PASSES = 20
"""Fixed-point iterations that take out a distortion."""


@dataclass(frozen=True)
class Experiment:
    """Mistake of a value, and how to undo it; the sentence says it in words.

    The best of the values is refined between its neighbours if the mistake is `continuous`.  The value `none` changes
    nothing, and is NaN if values number alternatives; `smallest` is the smallest difference from it worth naming.
    """

    key: str
    sentence: Callable[[float], str]
    values: tuple[float, ...]
    undo: Callable[[Recording, float], Recording]
    none: float = math.nan
    smallest: float = 0.0

    @property
    def continuous(self) -> bool:
        """True if values between those that are tried make sense."""
        return not math.isnan(self.none)


def later(motion: Motion, offset: float) -> Motion:
    """Return the motion as it was `offset` seconds later."""
    signal = motion.signal
    assert signal is not None
    if callable(signal.samples):
        return replace(motion, signal=Signal(OverTime(lambda times: motion.known(times + offset))))
    if signal.times is None:
        return motion
    return replace(motion, signal=Signal(signal.samples, signal.times - offset))


def turned(motion: Motion, into: sp.ImmutableMatrix) -> Motion:
    """Return the motion in a frame with other axes."""
    return replace(motion, A=into * motion.A * into.T, b=into * motion.b)


def unbent(outputs: Array, bend: float) -> Array:
    """Image coordinates without the radial distortion y (1 + bend |y|^2) that they have."""
    straight = outputs
    for _ in range(PASSES):
        squared = (straight**2).sum(axis=-1, keepdims=True)
        straight = outputs / np.maximum(1 + bend * squared, 0.25)
    return np.asarray(straight)


EXPERIMENTS = (
    Experiment(
        "time offset",
        lambda offset: f"the images are {abs(offset):.3f} s {'late' if offset > 0 else 'early'} against the motion",
        tuple(np.linspace(-LARGEST_OFFSET, LARGEST_OFFSET, 11).tolist()),
        lambda recording, offset: replace(recording, motion=later(recording.motion, -offset)),
        none=0.0,
        smallest=0.01,
    ),
    Experiment(
        "focal length",
        lambda ratio: f"the focal length is {ratio:.3f} times the one by which the images were divided",
        tuple(np.linspace(0.7, 1.4, 8).tolist()),
        lambda recording, ratio: replace(recording, outputs=recording.outputs / ratio),
        none=1.0,
        smallest=0.03,
    ),
    Experiment(
        "sign of w",
        lambda _: "the angular velocity has the wrong sign",
        (0.0,),
        lambda recording, _: replace(recording, motion=replace(recording.motion, A=recording.motion.A.T)),
    ),
    Experiment(
        "frames swapped",
        lambda k: f"the motion {[*FRAMES][int(k)]}; it is needed in the camera's (x right, y down, z forward)",
        tuple(map(float, range(len(FRAMES)))),
        lambda recording, k: replace(recording, motion=turned(recording.motion, [*FRAMES.values()][int(k)])),
    ),
    Experiment(
        "distortion ignored",
        lambda bend: f"the lens bends the images, by the factor 1 {bend:+.3f} |y|^2",
        tuple(np.linspace(-0.45, 0.45, 10).tolist()),
        lambda recording, bend: replace(recording, outputs=unbent(recording.outputs, bend)),
        none=0.0,
        smallest=0.02,
    ),
)
"""Mistakes that all points of a camera share."""


def impossible(experiment: Experiment, recordings: Sequence[Recording]) -> str:
    """Reason why an experiment cannot be made with these recordings; empty if it can."""
    motions = [recording.motion for recording in recordings]
    if experiment.key == "time offset" and all(motion.signal and motion.signal.constant for motion in motions):
        return "the motion is constant, so that no offset shows"
    if experiment.key == "distortion ignored" and any(len(recording.names) < 2 for recording in recordings):
        return "both image coordinates are needed"
    return ""


def within_reach(recording: Recording) -> Recording:
    """Return the part of a recording whose motion is known at all offsets that are tried, without its truth."""
    bare = replace(recording, truth=None, signal=None, distances={})
    times = recording.motion.signal.times if recording.motion.signal else None
    if times is None:
        return bare
    first = max(recording.time[0], times[0] + LARGEST_OFFSET)
    last = min(recording.time[-1], times[-1] - LARGEST_OFFSET)
    return bare.between(first, last)
