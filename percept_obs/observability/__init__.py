"""What can be observed: at an instant, over a window of the trajectory, by the Gramian, and how well at best."""

from percept_obs.observability.bound import Bound, cramer_rao
from percept_obs.observability.efficiency import Efficiency, efficiency
from percept_obs.observability.pointwise import instantaneous
from percept_obs.observability.windowed import windowed

__all__ = ["Bound", "Efficiency", "cramer_rao", "efficiency", "instantaneous", "windowed"]
