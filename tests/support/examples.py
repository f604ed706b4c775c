"""Systems, surfaces and start values that several tests use."""

from dataclasses import replace

import sympy as sp

from percept_obs import Camera, PerspectiveSystem, Uniform, affine, ellipsoid, pinhole, plane, rigid, sphere, unified
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
    return replace(surface, values={symbol: SHAPES[symbol.name] for symbol in surface.parameters})


SHAPES = {"n1": 0.1, "n2": -0.2, "n3": 0.9, "xi": 0.8}
SHAPES |= {"q11": 1.2, "q22": 0.9, "q33": 0.7, "q12": 0.2, "q13": -0.1, "q23": 0.3}
SURFACES = {make.__name__: shaped(make()) for make in surfaces.SURFACES}
SURFACES |= {f"{m.__name__} with three outputs": shaped(m(outputs=3)) for m in (plane, sphere, ellipsoid)}
SURFACES["unified beyond 1"] = unified(1.3)
ON_SPHERE = PerspectiveSystem(affine(), SURFACES["sphere"])
MOTIONS = {"affine": affine(), "rigid": rigid()}

x, z = sp.symbols("x z", real=True)
SQUARE = partition((x, z), sp.ImmutableMatrix([z**2 - x, x * z - z]), ["x"], ())
"""A small system without a canonical form."""
