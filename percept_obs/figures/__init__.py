"""Figures of runs, recordings, excitation and comparisons: each takes the data first, and says what it shows."""

from percept_obs.figures.base import Figure
from percept_obs.figures.chatter import chatter
from percept_obs.figures.comparison import comparison
from percept_obs.figures.entries import entries
from percept_obs.figures.fields import fields
from percept_obs.figures.image_plane import image_plane
from percept_obs.figures.many_points import depth_errors, error_norm
from percept_obs.figures.map import settings_map
from percept_obs.figures.observability import bound_map, observability
from percept_obs.figures.over_time import distance, runs_over_time
from percept_obs.figures.scene import scene
from percept_obs.figures.signals import signals
from percept_obs.figures.structure import cases, quantities
from percept_obs.figures.trusting import scan, trust
from percept_obs.figures.velocities import velocities
from percept_obs.figures.windows import consistency, excitation, gramian

__all__ = [
    "Figure",
    "bound_map",
    "cases",
    "chatter",
    "comparison",
    "consistency",
    "depth_errors",
    "distance",
    "entries",
    "error_norm",
    "excitation",
    "fields",
    "gramian",
    "image_plane",
    "observability",
    "quantities",
    "runs_over_time",
    "scan",
    "scene",
    "settings_map",
    "signals",
    "trust",
    "velocities",
]
