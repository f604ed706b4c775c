"""Forms that fit a recording with a truth, along which is asked what can be known."""

from __future__ import annotations

import numpy as np

from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.tracking.following import require_match

System = PartitionedSystem | PerspectiveSystem


def as_form(system: System) -> PartitionedSystem:
    """Return the form itself, or a perspective system's with all image coordinates measured."""
    if isinstance(system, PartitionedSystem):
        return system
    return system.partition(*(symbol.name for symbol in system.surface.image_coordinates))


def matching_form(system: System, recording: Recording) -> PartitionedSystem:
    """Return the form of a system; raise ValueError if it does not fit the recording, or that has no truth."""
    form = as_form(system)
    if recording.truth is None or not np.isfinite(recording.truth).all():
        raise ValueError(
            "the recording has no truth at all of its samples; what can be known is asked along a true trajectory: "
            "simulate one with record(scenario), or cut the recording with between(begin, end)"
        )
    require_match(form, recording, recording.motion)
    return form
