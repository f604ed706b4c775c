"""Figures of runs, recordings and excitation: each takes the data first, and has a text that says what it shows."""

from percept_obs.figures.base import Figure
from percept_obs.figures.over_time import compare, distance, signals
from percept_obs.figures.spatial import image_plane, scene
from percept_obs.figures.windows import excitation

__all__ = ["Figure", "compare", "distance", "excitation", "image_plane", "scene", "signals"]
