"""Measures of observability, and bounds on what any observer can know."""

from percept_obs.observability.bound import Bound, cramer_rao
from percept_obs.observability.efficiency import Efficiency, efficiency
from percept_obs.observability.error_gramian import ErrorGramian, empirical_gramian, error_gramian
from percept_obs.observability.lie import Codistribution, LieRanks, lie_derivatives
from percept_obs.observability.maps import BoundMap, bound_map
from percept_obs.observability.measures import Measure, Observability, how_observable
from percept_obs.observability.pointwise import instantaneous
from percept_obs.observability.steering import Steering, steered, steering
from percept_obs.observability.windows import windowed

__all__ = [
    "Bound",
    "BoundMap",
    "Codistribution",
    "Efficiency",
    "ErrorGramian",
    "LieRanks",
    "Measure",
    "Observability",
    "Steering",
    "bound_map",
    "cramer_rao",
    "efficiency",
    "empirical_gramian",
    "error_gramian",
    "how_observable",
    "instantaneous",
    "lie_derivatives",
    "steered",
    "steering",
    "windowed",
]
