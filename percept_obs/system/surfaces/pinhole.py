"""The image plane of a pinhole camera."""

import sympy as sp

from percept_obs.system.surfaces.base import ImagingSurface, X, Y, Z


def pinhole() -> ImagingSurface:
    """Return the image plane Z = 1: y = (X/Z, Y/Z), inverse depth 1/Z (Ma 2005, (3), p. 64).

    Returns
    -------
    ImagingSurface
        With two image coordinates.

    See Also
    --------
    plane, unified : Surfaces of which it is one.

    Examples
    --------
    >>> from percept_obs import pinhole
    >>> pinhole().project([2.0, 1.0, 4.0]).tolist()
    [0.5, 0.25, 0.25]
    """
    y1, y2 = sp.symbols("y1 y2", real=True)
    return ImagingSurface("pinhole", (X / Z, Y / Z), Z, (y1, y2, 1))
