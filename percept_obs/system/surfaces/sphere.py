"""A unit sphere around the camera's centre."""

import sympy as sp

from percept_obs.system.surfaces.base import ImagingSurface, X, Y, Z


def sphere() -> ImagingSurface:
    """Unit sphere in stereographic projection: y = (X, Y) / (R + Z), inverse range 1/R.

    It sees every direction but straight back.  Ma 2005 wishes for it in a remark (section 5, p. 72).
    """
    y1, y2 = sp.symbols("y1 y2", real=True)
    R = sp.sqrt(X**2 + Y**2 + Z**2)
    squared = y1**2 + y2**2
    ray = (2 * y1 / (1 + squared), 2 * y2 / (1 + squared), (1 - squared) / (1 + squared))
    return ImagingSurface("sphere", (X / (R + Z), Y / (R + Z)), R, ray)
