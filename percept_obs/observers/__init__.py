"""Observers, one family a file.

The order of the imports is that in which tables and labs list the observers.
"""

from percept_obs.observers.base import About as About, Observer as Observer, with_point as with_point
from percept_obs.observers.family import Family
from percept_obs.observers.identifier_based import ibo as ibo, identifier_based as identifier_based
from percept_obs.observers.sliding_mode import sliding_mode as sliding_mode, smo as smo
from percept_obs.observers.extended_kalman import ekf as ekf, extended_kalman as extended_kalman
from percept_obs.observers.de_luca import de_luca as de_luca, spica as spica
from percept_obs.observers.immersion_and_invariance import (
    ii as ii,
    immersion_and_invariance as immersion_and_invariance,
)
from percept_obs.observers.range_identification import range_identification as range_identification, rio as rio
from percept_obs.observers.linear_approximation import lao as lao, linear_approximation as linear_approximation
from percept_obs.observers.integral_sliding_mode import integral_sliding_mode as integral_sliding_mode, ismo as ismo
from percept_obs.observers.gpebo import gpebo as gpebo
from percept_obs.observers.equivariant import equivariant_filter as equivariant_filter
from percept_obs.observers.gains import Gain as Gain
from percept_obs.observers.immersion_and_invariance import NotIntegrable as NotIntegrable
from percept_obs.observers.known_motion import NeedsMotion as NeedsMotion
from percept_obs.observers.parts import noise_bias as noise_bias
from percept_obs.system.forms import NeedsMoreOutputs as NeedsMoreOutputs

OBSERVERS = tuple(dict.fromkeys(value for value in list(globals().values()) if isinstance(value, Family)))
"""Every observer of a canonical form; tables, labs and the laws that tests hold run over this list."""
