"""Sampled motions of a user in a lab: checks, and tables for the page."""

from __future__ import annotations

from percept_obs.compile import Array
from percept_obs.labs.shared.schema import Settings
from percept_obs.system.motion import Motion
from percept_obs.system.signal import slack_of
from percept_obs.validation import limit

MOST_SAMPLES = 10_000
"""100 s at 100 Hz; page and Python end a step at each sample."""


def is_sampled(motion: Motion) -> bool:
    """Return True if a motion is sampled."""
    return motion.signal is not None and motion.signal.times is not None


def refuse_unfit(motion: Motion) -> None:
    """Raise a ValueError for samples that are too few or too many, or that do not begin at 0 s."""
    times = times_of(motion)
    if len(times) < 2:
        raise ValueError(
            f"the motion has one sample, at {times[0]:.6g} s; bring two at least, or leave the times out where it is "
            "constant"
        )
    if times[0] > slack_of(times):
        raise ValueError(
            f"the motion is sampled from {times[0]:.6g} to {times[-1]:.6g} s, but a run of the lab begins at 0 s; let "
            "the times begin there, such as times - times[0]"
        )
    limit(len(times), "samples of a motion", "bring fewer, such as every tenth", MOST_SAMPLES)


def refuse_longer(motion: Motion, duration: float) -> None:
    """Raise a ValueError for a run that is longer than samples."""
    if duration > _until(motion):
        raise ValueError(
            f"the run lasts {duration:g} s, but the motion is sampled up to {times_of(motion)[-1]:.6g} s only; shorten "
            "the duration or bring more samples"
        )


def table_for_the_page(motion: Motion) -> Settings:
    """A sampled motion in numbers."""
    signal = motion.signal
    assert signal is not None
    assert not callable(signal.samples)
    times = [0.0] if signal.times is None else signal.times.tolist()
    return {"times": times, "rows": signal.samples.tolist()}


def samples_for_the_page(motion: Motion) -> Settings:
    """A sampled motion in numbers, and the longest duration of a run."""
    return {**table_for_the_page(motion), "until": _until(motion)}


def times_of(motion: Motion) -> Array:
    """The times of samples, in seconds."""
    assert motion.signal is not None
    assert motion.signal.times is not None
    return motion.signal.times


def _until(motion: Motion) -> float:
    times = times_of(motion)
    return float(times[-1] + slack_of(times))
