"""The least error that the noise leaves in a run of an ensemble, by its Cramer-Rao bound."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from percept_obs.observability import cramer_rao
from percept_obs.recording import Camera, Scenario, record
from percept_obs.recording.many import with_numbers
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.signal import from_the_start
from percept_obs.system.surfaces import BehindCamera

Values = tuple[tuple[str, float], ...]
"""Names with numbers, as a value that can be looked up."""


@lru_cache(maxsize=4096)
def least_error(
    scenario: Scenario,
    numbers: Values,
    form: PartitionedSystem,
    duration: float,
    camera: Camera,
    seed: int,
    prior: Values,
    after: float,
) -> float:
    """Root mean square over time of the least standard deviation of the inverse distance, in 1/m.

    Parameters
    ----------
    scenario : Scenario
    numbers : names and values
        What is different in it.
    form : PartitionedSystem
    duration : float
    camera : Camera
    seed : int
        Of the run, which says what samples are lost.
    prior : names and variances
        See `cramer_rao`.
    after : float
        Seconds from which on samples count.

    Returns
    -------
    float
        NaN without noise, or if the point does not stay in front of the camera.
    """
    if not camera.noise.variance:
        return np.nan
    try:
        recording = record(with_numbers(scenario, **dict(numbers)), duration, camera, seed)
    except BehindCamera:
        return np.nan
    bound = cramer_rao(recording, form, dict(prior))
    late = from_the_start(bound.elapsed, after)
    return float(np.sqrt(np.mean(bound.of(form.coordinates[-1].name)[late] ** 2)))
