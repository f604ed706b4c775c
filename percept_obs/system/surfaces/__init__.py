"""Imaging surfaces, one a file."""

from percept_obs.system.surfaces.base import POINT, BehindCamera, ImagingSurface
from percept_obs.system.surfaces.chained import chained
from percept_obs.system.surfaces.pinhole import pinhole
from percept_obs.system.surfaces.plane import plane
from percept_obs.system.surfaces.sphere import sphere

SURFACES = (pinhole, chained, plane, sphere)
"""Every surface; the laws that tests hold run over this list, and the labs offer it."""

__all__ = [
    "POINT",
    "SURFACES",
    "BehindCamera",
    "ImagingSurface",
    "X",
    "Y",
    "Z",
    "chained",
    "pinhole",
    "plane",
    "sphere",
]
