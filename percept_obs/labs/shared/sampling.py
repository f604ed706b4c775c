"""How long a simulated point can be seen."""

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
    except BehindCamera:  # not asked for beforehand, for that takes as long as recording
        times = camera.times(scenario.duration)
    count = int(np.argmin(scenario.in_front(times)))
    if count < 2:
        raise BehindCamera("the point leaves the half-space in front of the camera at once; move it or turn the motion")
    return record(scenario, times[count - 1], camera, seed)
