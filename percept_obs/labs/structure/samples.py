"""Velocities in samples that somebody brings to the structure lab, such as those that a robot has measured."""

from __future__ import annotations

import numpy as np

from percept_obs.border import limit
from percept_obs.compile.integrator import LONGEST_STEP
from percept_obs.labs.shared.sampling import table_for_the_page
from percept_obs.labs.shared.schema import Settings
from percept_obs.system.motion import Motion, rigid
from percept_obs.system.signal import slack_of

MOST_SAMPLES = 10_000
"""100 s at 100 Hz: a kink for each, at which page and Python end a step."""

LOOKS_A_SAMPLE = 15
"""How often Python's solver looks at a motion between two of its samples, at least."""


def sampled(motion: Motion, duration: float | None = None) -> Motion | None:
    """The samples of a motion that varies; None of a constant one.

    Parameters
    ----------
    motion : Motion
        From `rigid`, with numbers.
    duration : float, optional
        Seconds up to which a function of time is sampled, every 10 ms; none is taken without it.

    Raises
    ------
    ValueError
        If it is another motion, has too few or too many samples, or does not begin at 0 s.

    Examples
    --------
    >>> sampled(rigid([0, 0, 0], [0.1, 0, 0], [0, 0, 0])) is None
    True
    >>> sampled(rigid([0, 0, 0], [[0.1, 0, 0], [0.3, 0, 0]], [0, 0, 0], times=[0, 2])).known(1)[0, 3].item()
    0.2
    """
    signal = motion.signal
    if motion.parameters != rigid().parameters or signal is None:
        raise ValueError(
            f"the velocities are a motion {motion.name!r} of {', '.join(map(str, motion.parameters)) or 'no letters'}, "
            f"{'without' if signal is None else 'with'} numbers; bring rigid(w, v_c, v_p, times) with numbers for all"
        )
    if callable(signal.samples):
        if duration is None:
            raise ValueError(
                "the velocities are functions of time, and nothing says how long they last; bring samples, "
                "rigid(w, v_c, v_p, times), or a StructureScenario, which has a duration"
            )
        times = np.linspace(0, duration, int(np.ceil(duration / LONGEST_STEP)) + 1)
        return rigid(*np.split(motion.known(times), 3, axis=1), times)
    if signal.times is None:
        return None
    times = signal.times
    if len(times) < 2:
        raise ValueError(
            f"the velocities have one sample, at {times[0]:.6g} s; bring two at least, or leave the times out where "
            "they are constant"
        )
    if times[0] > slack_of(times):
        raise ValueError(
            f"the velocities are sampled from {times[0]:.6g} to {times[-1]:.6g} s, but a run of the lab begins at 0 s; "
            "let the times begin there, such as times - times[0]"
        )
    limit(len(times), "samples of velocities", "bring fewer, such as every tenth", MOST_SAMPLES)
    return motion


def until(motion: Motion) -> float:
    """The time in seconds up to which samples reach."""
    times = _times(motion)
    return float(times[-1] + slack_of(times))


def zero_in(motion: Motion) -> list[str]:
    """Names of the velocities that are 0 in all samples."""
    moved = motion.known(_times(motion)).any(axis=0)
    return [symbol.name for symbol, there in zip(motion.parameters, moved, strict=True) if not there]


def for_the_page(motion: Motion) -> Settings:
    """The samples in numbers, up to when they reach, and what is 0 in all of them."""
    return {**table_for_the_page(motion), "until": until(motion), "zero": zero_in(motion)}


def looks_at(motion: Motion | None, duration: float) -> int:
    """How often Python's solver looks at samples up to a time, at least; never where there are none."""
    return LOOKS_A_SAMPLE * int((_times(motion) < duration).sum()) if motion else 0


def refuse_samples(motion: Motion, settings: Settings) -> None:
    """Refuse settings that do not go with velocities in samples."""
    if settings["motion"].strip():
        raise ValueError(
            f"motion is {settings['motion']!r}, but the velocities are those of your samples; leave it empty, or take "
            'velocities="set"'
        )
    if settings["duration"] > until(motion):
        raise ValueError(
            f"the run lasts {settings['duration']:g} s, but the velocities are sampled up to {_times(motion)[-1]:.6g} "
            "s only; shorten the duration or bring more samples"
        )


def _times(motion: Motion) -> np.ndarray:
    assert motion.signal is not None
    assert motion.signal.times is not None
    return motion.signal.times
