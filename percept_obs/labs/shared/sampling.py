"""How long a simulated point can be seen."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from percept_obs.recording import Recording, Scenario
from percept_obs.system.surfaces import BehindCamera


def as_far_as_seen(simulate: Callable[[float], Recording], scenario: Scenario, period: float) -> Recording:
    """What a camera records until the point leaves the half-space in front of it.

    Parameters
    ----------
    simulate : function of a duration in seconds
    scenario : Scenario
    period : float
        Seconds between samples.

    Raises
    ------
    BehindCamera
        If it leaves at once.
    """
    try:
        return simulate(scenario.duration)
    except BehindCamera:
        times = period * np.arange(np.floor(scenario.duration / period + 1e-9) + 1)
        return simulate(times[samples_in_front(scenario, times) - 1])


def samples_in_front(scenario: Scenario, times: np.ndarray) -> int:
    """How many samples the camera takes before the point leaves the half-space in front of it, by bisection."""
    seen, unseen = 1, len(times)
    while unseen - seen > 1:
        middle = (seen + unseen) // 2
        try:
            scenario.coordinates(times[:middle])
            seen = middle
        except BehindCamera:
            unseen = middle
    if seen < 2:
        raise BehindCamera("the point leaves the half-space in front of the camera at once; move it or turn the motion")
    return seen
