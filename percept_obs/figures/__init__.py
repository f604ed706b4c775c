"""Figures of runs, recordings, observability and studies; each takes the data first and comes with a text."""

from percept_obs.figures.base import Figure
from percept_obs.figures.image import image_plane
from percept_obs.figures.observability import bound_map, consistency, excitation, fields, gramian, observability
from percept_obs.figures.runs import distance, runs_over_time, signals
from percept_obs.figures.scene import scene, velocities
from percept_obs.figures.structure import cases, depth_errors, error_norm, quantities
from percept_obs.figures.studies import (
    camera_ways,
    causes,
    chatter,
    comparison,
    efficiencies,
    entries,
    servoing,
    settings_map,
)

__all__ = [
    "Figure",
    "bound_map",
    "camera_ways",
    "cases",
    "causes",
    "chatter",
    "comparison",
    "consistency",
    "depth_errors",
    "distance",
    "efficiencies",
    "entries",
    "error_norm",
    "excitation",
    "fields",
    "gramian",
    "image_plane",
    "observability",
    "quantities",
    "runs_over_time",
    "scene",
    "servoing",
    "settings_map",
    "signals",
    "velocities",
]
