"""Sampled velocities of a user of the structure lab, such as those that a robot has measured."""

from __future__ import annotations

import numpy as np

from percept_obs.compile.integrator import LONGEST_STEP
from percept_obs.labs.shared.samples import refuse_longer, refuse_unfit, times_of
from percept_obs.labs.shared.schema import Settings
from percept_obs.system.motion import Motion, rigid


def sampled(motion: Motion, duration: float | None = None) -> Motion | None:
    """The samples of velocities that vary; None of constant ones.

    Parameters
    ----------
    motion : Motion
        From `rigid`, with numbers.
    duration : float, optional
        Seconds up to which a function of time is sampled, every 10 ms; none is taken without it.

    Raises
    ------
    ValueError
        If it is another motion, or its samples do not suit a run.

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
        w, v_c, v_p = np.split(motion.known(times), 3, axis=1)
        motion = rigid(w, v_c, v_p, times)
    elif signal.times is None:
        return None
    refuse_unfit(motion)
    return motion


def zero_in(motion: Motion) -> list[str]:
    """Names of the velocities that are 0 in all samples."""
    columns = motion.known(times_of(motion)).T
    return [symbol.name for symbol, column in zip(motion.parameters, columns, strict=True) if not column.any()]


def refuse_samples(motion: Motion, settings: Settings) -> None:
    """Refuse settings that do not go with velocities in samples."""
    if settings["motion"].strip():
        raise ValueError(
            f"motion is {settings['motion']!r}, but the velocities are those of your samples; leave it empty, or take "
            'velocities="set"'
        )
    refuse_longer(motion, settings["duration"])
