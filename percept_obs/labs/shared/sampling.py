"""How long a simulated point can be seen, and how long a run Python follows for its words."""

from collections.abc import Callable, Mapping

import numpy as np

from percept_obs.compile import Array
from percept_obs.recording import Camera, Recording, Scenario, record
from percept_obs.system.surfaces import BehindCamera


def as_far_as_seen(scenario: Scenario, camera: Camera, seed: int) -> Recording:
    """What a camera records until the point leaves the half-space in front of it.

    Raises
    ------
    BehindCamera
        If it leaves at once.
    """
    try:
        return record(scenario, camera=camera, seed=seed)
    except BehindCamera:  # not asked for beforehand, for that takes as long as recording
        times = camera.times(scenario.duration)
    count = int(np.argmin(scenario.in_front(times)))
    if count < 2:
        raise BehindCamera("the point leaves the half-space in front of the camera at once; move it or turn the motion")
    return record(scenario, times[count - 1], camera, seed)


MOST_WORK = 300_000
"""Steps times states that are followed in about a second, so that the kernel answers."""


def exact_path(duration: float, period: float, fastest: float) -> float:
    """What it takes to move a point exactly, as `MOST_WORK` counts; see `looks`."""
    return 0.4 * duration * (1 / period + 4 * fastest)


def looks(duration: float, fastest: float, swings_at: float = 0.0) -> float:
    """How often a solver looks at a motion that varies, about.

    Parameters
    ----------
    duration : float
        In seconds.
    fastest : float
        Largest sum of a row of A without signs, in 1/s.
    swings_at : float
        In rad/s.
    """
    return duration * (60 + 47 * fastest + 18 * swings_at)


MOMENT = 1e-5
"""Seconds over which the rate of a motion is seen; far less than a period of whatever Python can follow."""


def swinging_at(known: Callable[[Array], Array], times: Array) -> float:
    """About how fast numbers swing, in rad/s: their largest rate over their size.

    Parameters
    ----------
    known : function of times
        Gives the numbers at T times, shape (T, n).
    times : array of shape (T,)
    """
    rows = known(times)
    rates = np.abs(known(times[:-1] + MOMENT) - rows[:-1]).max(axis=0) / MOMENT
    return float((rates / np.maximum(np.abs(rows).max(axis=0), 1e-12)).max())


def too_fast(work: float) -> str:
    """What Python says of a motion that takes it so much to simulate; nothing if it does simulate it."""
    slower = "slow it down, lengthen the period or shorten the duration"
    return f"Python says nothing on so fast or long a motion; {slower}." if work > MOST_WORK else ""


def too_short(duration: float, period: float) -> str:
    """What is said of a duration that is shorter than the period; nothing of a longer one."""
    return f"A duration of {duration:g} s holds no two samples {period:g} s apart." if duration < period else ""


def within_reach(steps: float, states: Mapping[str, float], before: float = 0.0) -> tuple[list[str], list[str]]:
    """Names of the observers that Python follows for its words, and what it says of the others.

    Parameters
    ----------
    steps : float
    states : mapping of names to numbers of states
    before : float
        Work that is done before any is followed.
    """
    names, work = [], before
    for name, count in states.items():
        if work + steps * count <= MOST_WORK:
            names.append(name)
            work += steps * count
    beyond = ", ".join(name.replace("_", " ") for name in states if name not in names)
    if not beyond:
        return names, []
    remedy = "show fewer observers, lengthen the period or shorten the duration"
    return names, [f"Python says nothing on {beyond}, for {steps:.2g} steps would take it too long; {remedy}."]
