"""Observers of a canonical form, one family a file."""

from percept_obs.observers.base import Gain, Observer, noise_bias, with_point
from percept_obs.observers.extended_kalman import ekf, extended_kalman
from percept_obs.observers.identifier_based import ibo, identifier_based
from percept_obs.observers.sliding_mode import sliding_mode, smo

OBSERVERS = (identifier_based, sliding_mode, extended_kalman)
"""Every observer of a canonical form; the laws that tests hold run over this list."""

__all__ = [
    "OBSERVERS",
    "Gain",
    "Observer",
    "ekf",
    "extended_kalman",
    "ibo",
    "identifier_based",
    "noise_bias",
    "sliding_mode",
    "smo",
    "with_point",
]
