"""Observers, one family a file."""

from percept_obs.observers.base import About, Gain, Observer, noise_bias, with_point
from percept_obs.observers.de_luca import de_luca, spica
from percept_obs.observers.extended_kalman import ekf, extended_kalman
from percept_obs.observers.identifier_based import ibo, identifier_based
from percept_obs.observers.immersion_and_invariance import NotIntegrable, ii, immersion_and_invariance
from percept_obs.observers.integral_sliding_mode import integral_sliding_mode, ismo
from percept_obs.observers.linear_approximation import lao, linear_approximation
from percept_obs.observers.range_identification import range_identification, rio
from percept_obs.observers.sliding_mode import sliding_mode, smo
from percept_obs.system.forms import NeedsMoreOutputs

OBSERVERS = (
    identifier_based,
    sliding_mode,
    extended_kalman,
    de_luca,
    spica,
    immersion_and_invariance,
    range_identification,
    linear_approximation,
    integral_sliding_mode,
)
"""Every observer of a canonical form; the laws that tests hold run over this list."""

__all__ = [
    "OBSERVERS",
    "About",
    "Gain",
    "NeedsMoreOutputs",
    "NotIntegrable",
    "Observer",
    "de_luca",
    "ekf",
    "extended_kalman",
    "ibo",
    "identifier_based",
    "ii",
    "immersion_and_invariance",
    "integral_sliding_mode",
    "ismo",
    "lao",
    "linear_approximation",
    "noise_bias",
    "range_identification",
    "rio",
    "sliding_mode",
    "smo",
    "spica",
    "with_point",
]
