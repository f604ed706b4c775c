"""Systems, surfaces and start values that several tests use."""

import sympy as sp

from percept_obs import (
    Camera,
    ImagingSurface,
    PerspectiveSystem,
    Uniform,
    affine,
    chained,
    pinhole,
    plane,
    rigid,
)
from percept_obs.system.surfaces.base import X, Y, Z

AFFINE = PerspectiveSystem(affine(), pinhole())
BOTH = AFFINE.measure("y1", "y2")
ONE = AFFINE.measure("y1")
OTHER = AFFINE.measure("y2")

ZERO = (0.0, 0.0, 0.0)
NOISE = Uniform(0.01)
NOISY = Camera(period=0.01, noise=NOISE)


def sphere() -> ImagingSurface:
    """A surface of one's own: the unit sphere seen through its stereographic chart."""
    y1, y2 = sp.symbols("y1 y2", real=True)
    q = y1**2 + y2**2
    distance = sp.sqrt(X**2 + Y**2 + Z**2)
    ray = (2 * y1 / (1 + q), 2 * y2 / (1 + q), (1 - q) / (1 + q))
    return ImagingSurface("sphere", (X / (distance + Z), Y / (distance + Z)), distance, ray)


SURFACES = {
    "pinhole": pinhole(),
    "chained": chained(),
    "plane": plane((0.1, -0.2, 0.9)),
    "plane with three outputs": plane((0.1, -0.2, 0.9), outputs=3),
    "sphere": sphere(),
}
ON_SPHERE = PerspectiveSystem(affine(), SURFACES["sphere"])
MOTIONS = {"affine": affine(), "rigid": rigid()}
