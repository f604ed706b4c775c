"""Imaging surfaces, one a file.

The order of the imports is that in which labs list the surfaces.
"""

from types import FunctionType

from percept_obs.system.surfaces.base import POINT as POINT, BehindCamera as BehindCamera
from percept_obs.system.surfaces.base import ImagingSurface as ImagingSurface
from percept_obs.system.surfaces.pinhole import pinhole as pinhole
from percept_obs.system.surfaces.chained import chained as chained
from percept_obs.system.surfaces.plane import plane as plane
from percept_obs.system.surfaces.sphere import sphere as sphere
from percept_obs.system.surfaces.ellipsoid import ellipsoid as ellipsoid
from percept_obs.system.surfaces.unified import unified as unified

SURFACES = tuple(value for value in list(globals().values()) if isinstance(value, FunctionType))
"""Every surface; the laws that tests hold run over this list, and the labs offer it."""
