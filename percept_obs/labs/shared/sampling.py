"""How long a simulated point can be seen."""

from __future__ import annotations

import numpy as np

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
    except BehindCamera:
        times = camera.times(scenario.duration)
        return record(scenario, times[samples_in_front(scenario, times) - 1], camera, seed)


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
