"""Warn about implausible recordings: pixels for image coordinates, a gap in the motion."""

from __future__ import annotations

import numpy as np

from percept_obs.compile import Array
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import ImagingSurface
from percept_obs.system.view import View
from percept_obs.validation import warn

LARGEST_USUAL = 20.0
"""Image coordinate 87 degrees from the optical axis: if half of the samples lie beyond, they are probably pixels."""

LONG_GAP = 10
"""Times the usual interval of a sampled motion above which an interval is a gap."""


class Unlikely(UserWarning):
    """A recording can be followed, but is hardly what was meant."""


def warn_if_implausible(time: Array, outputs: Array, names: tuple[str, ...], view: View, motion: Motion) -> None:
    """Warn if the outputs look like pixels, or the motion has a gap while it is needed."""
    seen = np.abs(outputs[np.isfinite(outputs)])
    if isinstance(view, ImagingSurface) and len(seen) and np.median(seen) > LARGEST_USUAL:
        warn(
            Unlikely(
                f"half of the samples of {', '.join(names)} lie beyond {LARGEST_USUAL:g} focal lengths, up to "
                f"{seen.max():.4g}: are they pixels? Subtract the principal point and divide by the focal length"
            )
        )
    times = None if motion.signal is None else motion.signal.times
    if times is None or len(times) < 3:
        return
    intervals = np.diff(times)
    usual = np.median(intervals)
    gaps = np.flatnonzero((intervals > LONG_GAP * usual) & (times[1:] > time[0]) & (times[:-1] < time[-1]))
    if len(gaps):
        begin, end = times[gaps[0]] - time[0], times[gaps[0] + 1] - time[0]
        warn(
            Unlikely(
                f"between {begin:.4g} and {end:.4g} s after the first sample the motion was not sampled, "
                f"{(end - begin) / usual:.3g} times its usual interval; it is taken to change evenly there: cut the "
                "recording with between(), or fill the gap"
            )
        )
