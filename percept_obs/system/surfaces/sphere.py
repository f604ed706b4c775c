"""A unit sphere around the camera's centre."""

from __future__ import annotations

import sympy as sp

from percept_obs.system.surfaces.base import POINT, ImagingSurface, X, Y, Z
from percept_obs.system.surfaces.lift import mu
from percept_obs.validation import checked


@checked
def sphere(outputs: int = 2) -> ImagingSurface:
    """Return the unit sphere: stereographic projection y = (X, Y) / (R + Z), or the unit direction y = (X, Y, Z) / R.

    The first sees every direction but straight back, the second every direction (Ma 2005, remark in section 5, p. 72).

    Parameters
    ----------
    outputs : 2 or 3
        3 for the unit direction, whose coordinates depend on each other: y . y = 1.

    Returns
    -------
    ImagingSurface
        With 2 or 3 image coordinates, and the range R as its distance.

    Raises
    ------
    ValueError
        If outputs is not 2 or 3.

    See Also
    --------
    unified, ellipsoid : Surfaces of which it is one.

    Examples
    --------
    >>> from percept_obs import sphere
    >>> sphere().project([2.0, 1.0, 2.0]).round(3).tolist()
    [0.4, 0.2, 0.333]
    """
    if outputs not in (2, 3):
        raise ValueError(f"a sphere has 2 or 3 outputs, not {outputs!r}")
    y1, y2, y3 = y = sp.symbols("y1:4", real=True)
    R = sp.sqrt(X**2 + Y**2 + Z**2)
    if outputs == 3:
        return ImagingSurface("sphere", [p / R for p in POINT], R, y, constraint=y1**2 + y2**2 + y3**2 - 1)
    lift = mu(y1, y2, sp.S.One)
    return ImagingSurface("sphere", (X / (R + Z), Y / (R + Z)), R, (lift * y1, lift * y2, lift - 1))
