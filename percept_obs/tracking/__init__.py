"""An observer follows a recording, and the run that it leaves."""

from percept_obs.tracking.following import DoesNotFit, StepTooLong, track
from percept_obs.tracking.run import Run

__all__ = ["DoesNotFit", "Run", "StepTooLong", "track"]
