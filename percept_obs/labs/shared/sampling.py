"""How long a simulated point can be seen."""

from __future__ import annotations

import numpy as np

from percept_obs.recording import Scenario
from percept_obs.system.surfaces import BehindCamera


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
