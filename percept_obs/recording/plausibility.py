"""Warn about implausible recordings: pixels for image coordinates, a gap in the motion, times in other units."""

from __future__ import annotations

import numpy as np

from percept_obs.compile import Array
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import ImagingSurface
from percept_obs.system.view import View
from percept_obs.validation import warn

LARGEST_USUAL = 20.0
"""Focal lengths from the middle beyond which hardly a lens looks, 87 degrees aside: what is larger are pixels."""

LONG_GAP = 10
"""Usual intervals of a sampled motion that make a gap: clocks that stumble skip fewer."""

SHORTEST_STEP, USUAL_STEP, LONGEST_STEP = 1e-5, 0.03, 20.0
"""Seconds between two rows of a trajectory or an IMU: what is shorter or longer was counted in another unit."""


LATEST = 1e11
"""Seconds that no clock shows, 3,000 years."""


class Unlikely(UserWarning):
    """A recording can be followed, but is hardly what was meant."""


def ask_for_seconds(times: Array, what: str) -> None:
    """Refuse times that cannot be seconds, and warn of those that hardly are; a few may lie far apart."""
    if len(times) and np.abs(times).max() > LATEST:
        raise ValueError(
            f"{what} has times up to {times[-1]:.4g} s, which no clock shows; if they are nanoseconds since 1970, "
            "subtract the first one and multiply by 1e-9"
        )
    step = float(np.median(np.diff(times))) if len(times) > 5 else SHORTEST_STEP
    if not SHORTEST_STEP <= step <= LONGEST_STEP:
        warn(Unlikely(f"{what} has {step:.3g} s from one sample to the next; are its times seconds?"))


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
    ask_for_seconds(times, f"the {motion.name} motion")
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
