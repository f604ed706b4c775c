"""What can be observed: at an instant, over a window of the trajectory, and by the Gramian."""

from percept_obs.observability.pointwise import instantaneous
from percept_obs.observability.windowed import windowed

__all__ = ["instantaneous", "windowed"]
