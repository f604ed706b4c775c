"""The unified model of cameras with one centre: mirrors, fisheye lenses, the pinhole."""

from __future__ import annotations

import math

import sympy as sp

from percept_obs.system.surfaces.base import ImagingSurface, X, Y, Z
from percept_obs.system.surfaces.lift import mu
from percept_obs.validation import checked


@checked
def unified(xi: float | None = None) -> ImagingSurface:
    """Return the unified model of central catadioptric and fisheye cameras: y = (X, Y) / l, l = Z + xi R.

    R is the range.  A point is projected to the unit sphere, and from there to a plane, seen from xi behind the
    sphere's centre.  xi = 0 is the pinhole, 1 a parabolic mirror or the stereographic projection, 0 to 1 a hyperbolic
    mirror; many fisheye lenses have xi above 1.

    It sees what lies within arccos(-xi) of the optical axis, or within arccos(-1 / xi) if xi is above 1, where the
    image folds back.

    Parameters
    ----------
    xi : float, optional
        Parameter of the mirror or lens, 0 or more; the symbol xi when left out.

    Returns
    -------
    ImagingSurface
        With two image coordinates, and l as its distance.

    Raises
    ------
    ValueError
        If xi is negative or not finite.

    See Also
    --------
    pinhole, sphere : Those of xi = 0 and xi = 1.

    Notes
    -----
    C. Geyer, K. Daniilidis, A unifying theory for central panoramic systems and practical implications, ECCV 2000;
    J. P. Barreto, H. Araujo, Issues on the geometry of central catadioptric image formation, CVPR 2001.

    Examples
    --------
    >>> unified(1.0).project([0.0, 1.0, 0.0])
    array([0., 1., 1.])
    """
    if xi is not None and not 0 <= xi < math.inf:
        raise ValueError(f"xi of the unified model is {xi}; it must be 0 or more and finite")
    letter = sp.Symbol("xi", real=True)
    y1, y2 = sp.symbols("y1 y2", real=True)
    R = sp.sqrt(X**2 + Y**2 + Z**2)
    distance, lift = Z + letter * R, mu(y1, y2, letter)
    return ImagingSurface(
        "unified",
        (X / distance, Y / distance),
        distance,
        (y1, y2, 1 - letter / lift),
        {} if xi is None else {letter: xi},
        (R + letter * Z,),
        {R: 1 / lift},
    )
