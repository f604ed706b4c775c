"""What is hardly meant by a recording: pixels for image coordinates, a hole in the motion."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from percept_obs.compile import Array
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import ImagingSurface
from percept_obs.system.view import View

LARGEST_USUAL = 20.0
"""Absolute image coordinate, 3 degrees before the image plane ends, beyond which half of the samples hardly lie."""

HOLE = 10
"""Times the usual interval of a sampled motion that make a hole in it."""


def doubts(time: Array, outputs: Array, names: tuple[str, ...], view: View, motion: Motion) -> Iterator[str]:
    """What is hardly meant: pixels for image coordinates, a hole in the motion."""
    seen = np.abs(outputs[np.isfinite(outputs)])
    if isinstance(view, ImagingSurface) and len(seen) and np.median(seen) > LARGEST_USUAL:
        yield (
            f"half of the samples of {', '.join(names)} lie beyond {LARGEST_USUAL:g} focal lengths, up to "
            f"{seen.max():.4g}: are they pixels? Subtract the principal point and divide by the focal length"
        )
    times = None if motion.signal is None else motion.signal.times
    if times is None or len(times) < 3:
        return
    gaps = np.diff(times)
    holes = (gaps > HOLE * np.median(gaps)) & (times[1:] > time[0]) & (times[:-1] < time[-1])
    for k in np.flatnonzero(holes)[:1]:
        yield (
            f"between {times[k] - time[0]:.4g} and {times[k + 1] - time[0]:.4g} s after the first sample "
            f"the motion was not sampled, {gaps[k] / np.median(gaps):.3g} times its usual interval; it is taken to "
            "change evenly there: cut the recording with between(), or fill the hole"
        )
