"""An ellipsoid around the camera's centre."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import sympy as sp

from percept_obs.compile import Intermediate
from percept_obs.system.surfaces.base import POINT, ImagingSurface
from percept_obs.validation import checked

LETTERS = sp.symbols("q11 q12 q13 q22 q23 q33", real=True)


class zeta(Intermediate):
    """The third coordinate of the point (y1, y2, zeta) of the ellipsoid, on the side that faces the camera."""

    @staticmethod
    def value(y1: sp.Expr, y2: sp.Expr, *shape: sp.Expr) -> sp.Expr:
        """Return zeta as an expression, the larger root of X^T Q X = 1."""
        q11, q12, q13, q22, q23, q33 = shape
        slope = q13 * y1 + q23 * y2
        return (sp.sqrt(slope**2 + q33 * (1 - q11 * y1**2 - 2 * q12 * y1 * y2 - q22 * y2**2)) - slope) / q33

    @staticmethod
    def equation(zeta: sp.Expr, y1: sp.Expr, y2: sp.Expr, *shape: sp.Expr) -> sp.Expr:
        """Return X^T Q X - 1."""
        return quadratic_form((y1, y2, zeta), shape) - 1


@checked
def ellipsoid(Q: Sequence[Sequence[float]] | None = None, outputs: int = 2) -> ImagingSurface:
    """Return the ellipsoid X^T Q X = 1 around the camera's centre: y = (X, Y) / l, l = sqrt(X^T Q X).

    With two outputs it sees the side that faces the camera, with the third, Z/l, all around (Ma 2005, remark in section
    5, p. 72).

    Parameters
    ----------
    Q : array of shape (3, 3), optional
        Symmetric and positive definite, without unit; symbols q11, q12, ... q33 when left out.
    outputs : 2 or 3
        Image coordinates X/l, Y/l, and also Z/l, which follows from y^T Q y = 1 but for its sign.

    Returns
    -------
    ImagingSurface
        With 2 or 3 image coordinates, and l as its distance.

    Raises
    ------
    ValueError
        If Q is not symmetric and positive definite, or outputs is not 2 or 3.

    See Also
    --------
    sphere : That of Q = 1.

    Examples
    --------
    >>> ellipsoid([[1, 0, 0], [0, 1, 0], [0, 0, 4]]).project([0, 0, 2])
    array([0.  , 0.  , 0.25])
    """
    if outputs not in (2, 3):
        raise ValueError(f"an ellipsoid has 2 or 3 outputs, not {outputs!r}")
    y = sp.symbols("y1:4", real=True)
    distance = sp.sqrt(quadratic_form(POINT, LETTERS))
    values = {} if Q is None else dict(zip(LETTERS, _entries(Q), strict=True))
    if outputs == 3:
        image = [axis / distance for axis in POINT]
        return ImagingSurface("ellipsoid", image, distance, y, values, constraint=quadratic_form(y, LETTERS) - 1)
    ray = (*y[:2], zeta(*y[:2], *LETTERS))
    facing = sum(q * axis for q, axis in zip((LETTERS[2], LETTERS[4], LETTERS[5]), POINT, strict=True))
    return ImagingSurface("ellipsoid", [axis / distance for axis in POINT[:2]], distance, ray, values, (facing,))


def quadratic_form(point: Sequence[sp.Expr], shape: Sequence[sp.Expr]) -> sp.Expr:
    """Quadratic form of a point, from the entries q11, q12, q13, q22, q23, q33 of its matrix."""
    x, y, z = point
    q11, q12, q13, q22, q23, q33 = shape
    return q11 * x**2 + q22 * y**2 + q33 * z**2 + 2 * (q12 * x * y + q13 * x * z + q23 * y * z)


def _entries(Q: Sequence[Sequence[float]]) -> list[float]:
    array = np.asarray(Q, dtype=float)
    if array.shape != (3, 3) or not np.isfinite(array).all() or not np.allclose(array, array.T, rtol=1e-9, atol=0):
        raise ValueError(f"Q has shape {array.shape}; an ellipsoid needs a symmetric matrix of 3 x 3 finite numbers")
    least = float(np.linalg.eigvalsh(array)[0])
    if least <= 0:
        raise ValueError(f"Q has the eigenvalue {least:.4g}; that of an ellipsoid has positive ones only")
    return [float(array[i, j]) for i in range(3) for j in range(i, 3)]
