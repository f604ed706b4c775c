"""An observer follows a recording and leaves a run."""

from percept_obs.tracking.following import DoesNotFit, StepTooLong, track
from percept_obs.tracking.function import FunctionObserver, transition
from percept_obs.tracking.run import Run

__all__ = ["DoesNotFit", "FunctionObserver", "Run", "StepTooLong", "track", "transition"]
