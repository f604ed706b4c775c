"""The image plane on which the dynamics are chained."""

import sympy as sp

from percept_obs.system.surfaces.base import ImagingSurface, X, Y, Z


def chained() -> ImagingSurface:
    """Return the image plane Y = 1: y1 = X/Y, y2 = Z/Y, inverse depth 1/Y (Ma 2005, (32), p. 69).

    Returns
    -------
    ImagingSurface
        With two image coordinates.

    See Also
    --------
    pinhole : The plane Z = 1.

    Examples
    --------
    >>> from percept_obs import chained
    >>> chained().image
    (X/Y, Z/Y)
    >>> chained().distance
    Y
    """
    y1, y2 = sp.symbols("y1 y2", real=True)
    return ImagingSurface("chained", (X / Y, Z / Y), Y, (y1, 1, y2))
