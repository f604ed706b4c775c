"""What a camera's owner may have got wrong, each as an experiment: the recordings as they are if it was so."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp

from percept_obs.compile import Array
from percept_obs.recording import Recording
from percept_obs.system.motion import Motion
from percept_obs.system.signal import OverTime, Signal

LARGEST_OFFSET = 0.25
"""Seconds up to which images may be late or early."""

VEHICLE = sp.ImmutableMatrix([[0, -1, 0], [0, 0, -1], [1, 0, 0]])
FRAMES = {
    "is in a vehicle's frame (x forward, y left, z up)": VEHICLE,
    "was turned out of a vehicle's frame, but was the camera's before": VEHICLE.T,
    "is in a renderer's frame (x right, y up, z back)": sp.ImmutableMatrix.diag(1, -1, -1),
}
"""What happens to frames, and how the motion's axes turn back into the camera's (x right, y down, z forward)."""

UNBENT = 20
"""Steps by which a distortion is taken out."""


@dataclass(frozen=True)
class Experiment:
    """One mistake, and how the recordings would have been without it.

    Parameters
    ----------
    key : str
        Such as "time offset".
    sentence : str
        What is wrong, in words, with places for the value, its size, "late" or "early", and the frame.
    values : tuple of float
        What is tried; between neighbours the best one is looked for if there are several and it is `continuous`.
    undone : function of a recording and a value
        The recording without the mistake.
    smallest : float
        Values closer to `none` than that are not worth a word.
    none : float
        The value that changes nothing.
    continuous : bool
    """

    key: str
    sentence: str
    values: tuple[float, ...]
    undone: Callable[[Recording, float], Recording]
    smallest: float = 0.0
    none: float = np.nan
    continuous: bool = True

    def worth_telling(self, value: float) -> bool:
        """Whether the value differs enough from none."""
        return not abs(value - self.none) < self.smallest


def later(motion: Motion, offset: float) -> Motion:
    """The motion as it was so many seconds later."""
    signal = motion.signal
    assert signal is not None
    if callable(signal.samples):
        return replace(motion, signal=Signal(OverTime(lambda times: motion.known(times + offset))))
    if signal.times is None:
        return motion
    return replace(motion, signal=Signal(signal.samples, signal.times - offset))


def turned(motion: Motion, into: sp.ImmutableMatrix) -> Motion:
    """The motion in a frame with other axes."""
    return replace(motion, A=into * motion.A * into.T, b=into * motion.b)


def unbent(outputs: Array, bend: float) -> Array:
    """Image coordinates without the radial distortion y (1 + bend |y|^2) that they have."""
    straight = outputs
    for _ in range(UNBENT):
        squared = (straight**2).sum(axis=-1, keepdims=True)
        straight = outputs / np.maximum(1 + bend * squared, 0.25)
    return np.asarray(straight)


EXPERIMENTS = (
    Experiment(
        "time offset",
        "the images are {size:.3f} s {late} against the motion",
        tuple(np.linspace(-LARGEST_OFFSET, LARGEST_OFFSET, 11).tolist()),
        lambda recording, offset: replace(recording, motion=later(recording.motion, -offset)),
        0.01,
        0.0,
    ),
    Experiment(
        "focal length",
        "the focal length is {value:.3f} times the one by which the images were divided",
        tuple(np.linspace(0.7, 1.4, 8).tolist()),
        lambda recording, ratio: replace(recording, outputs=recording.outputs / ratio),
        0.03,
        1.0,
    ),
    Experiment(
        "sign of w",
        "the angular velocity has the wrong sign",
        (0.0,),
        lambda recording, _: replace(recording, motion=replace(recording.motion, A=recording.motion.A.T)),
        continuous=False,
    ),
    Experiment(
        "frames swapped",
        "the motion {frame}; it is needed in the camera's (x right, y down, z forward)",
        tuple(map(float, range(len(FRAMES)))),
        lambda recording, k: replace(recording, motion=turned(recording.motion, [*FRAMES.values()][int(k)])),
        continuous=False,
    ),
    Experiment(
        "distortion ignored",
        "the lens bends the images, by the factor 1 {value:+.3f} |y|^2",
        tuple(np.linspace(-0.45, 0.45, 10).tolist()),
        lambda recording, bend: replace(recording, outputs=unbent(recording.outputs, bend)),
        0.02,
        0.0,
    ),
)
"""Mistakes that all points of a camera share."""


def possible(experiment: Experiment, recordings: Sequence[Recording]) -> str:
    """Why an experiment cannot be made with these recordings; empty if it can."""
    motions = [recording.motion for recording in recordings]
    if experiment.key == "time offset" and all(motion.signal and motion.signal.constant for motion in motions):
        return "the motion is constant, so that no offset shows"
    if experiment.key == "distortion ignored" and any(len(recording.names) < 2 for recording in recordings):
        return "both image coordinates are needed"
    return ""


def within_reach(recording: Recording) -> Recording:
    """The part of a recording whose motion is known at all offsets that are tried, without what is not needed."""
    bare = replace(recording, truth=None, signal=None, distances={})
    times = recording.motion.signal.times if recording.motion.signal else None
    if times is None:
        return bare
    first = max(recording.time[0], times[0] + LARGEST_OFFSET)
    last = min(recording.time[-1], times[-1] - LARGEST_OFFSET)
    return bare.between(first, last)
