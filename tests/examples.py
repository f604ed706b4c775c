"""Systems, surfaces and start values that several tests use."""

from dataclasses import replace

import sympy as sp

from percept_obs import Camera, PerspectiveSystem, Uniform, affine, pinhole, plane, rigid
from percept_obs.system import surfaces
from percept_obs.system.forms import partition

AFFINE = PerspectiveSystem(affine(), pinhole())
BOTH = AFFINE.measure("y1", "y2")
ONE = AFFINE.measure("y1")
OTHER = AFFINE.measure("y2")
FORMS = {"y1": ONE, "y2": OTHER, "y1+y2": BOTH}

ZERO = (0.0, 0.0, 0.0)
NOISE = Uniform(0.01)
NOISY = Camera(period=0.01, noise=NOISE)


def shaped(surface):
    """The surface with numbers for the symbols that shape it."""
    return replace(surface, values=dict(zip(surface.parameters, (0.1, -0.2, 0.9), strict=False)))


SURFACES = {make.__name__: shaped(make()) for make in surfaces.SURFACES}
SURFACES["plane with three outputs"] = shaped(plane(outputs=3))
ON_SPHERE = PerspectiveSystem(affine(), SURFACES["sphere"])
MOTIONS = {"affine": affine(), "rigid": rigid()}

x, z = sp.symbols("x z", real=True)
SQUARE = partition((x, z), sp.ImmutableMatrix([z**2 - x, x * z - z]), ["x"], ())
"""A small system without a canonical form."""
