"""A general image plane."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import sympy as sp

from percept_obs.system.surfaces.base import POINT, ImagingSurface
from percept_obs.validation import checked


@checked
def plane(normal: Sequence[float] | None = None, outputs: int = 2) -> ImagingSurface:
    """Return a general image plane n . X = 1, with the parameters n1, n2, n3 (Ma 2005, (5)-(8), p. 64).

    Parameters
    ----------
    normal : three floats, optional
        Normal vector n with n3 not zero; symbols n1, n2, n3 when left out.
    outputs : 2 or 3
        Image coordinates X/l, Y/l, and also Z/l, with l = n . X.  The third follows from n . y = 1.

    Returns
    -------
    ImagingSurface
        With 2 or 3 image coordinates, and the distance n . X.

    Raises
    ------
    ValueError
        If the normal vector is not three finite numbers with n3 not zero, or outputs is not 2 or 3.

    See Also
    --------
    pinhole, chained : Two of them.

    Examples
    --------
    >>> from percept_obs import plane
    >>> plane((0.0, 0.6, 0.8)).project([2.0, 1.0, 4.0]).round(3).tolist()
    [0.526, 0.263, 0.263]
    """
    n = sp.symbols("n1:4", real=True)
    y = sp.symbols("y1:4", real=True)
    distance = sum(a * b for a, b in zip(n, POINT, strict=True))
    if outputs not in (2, 3):
        raise ValueError(f"a plane has 2 or 3 outputs, not {outputs!r}")
    values = {}
    if normal is not None:
        entries = np.asarray(normal, dtype=float)
        if entries.shape != (3,) or not np.isfinite(entries).all() or entries[2] == 0:
            raise ValueError(f"the normal vector {normal!r} must be three finite numbers, the third not zero")
        values = dict(zip(n, entries.tolist(), strict=True))
    ray = y if outputs == 3 else (y[0], y[1], (1 - n[0] * y[0] - n[1] * y[1]) / n[2])
    constraint = sum(a * b for a, b in zip(n, y, strict=True)) - 1 if outputs == 3 else None
    image = [p / distance for p in POINT[:outputs]]
    return ImagingSurface("plane", image, distance, ray, values, constraint=constraint)
