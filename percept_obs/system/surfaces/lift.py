"""From an image point to the unit sphere around the camera's centre."""

from __future__ import annotations

import sympy as sp

from percept_obs.compile import Intermediate


class mu(Intermediate):
    """Factor that lifts an image point (y1, y2) to the unit sphere: (mu y1, mu y2, mu - xi) lies on it."""

    @staticmethod
    def value(y1: sp.Expr, y2: sp.Expr, xi: sp.Expr) -> sp.Expr:
        """Return mu as an expression, the root that lifts to the scene's side of the sphere."""
        squared = y1**2 + y2**2
        return (xi + sp.sqrt(1 + (1 - xi**2) * squared)) / (1 + squared)

    @staticmethod
    def equation(mu: sp.Expr, y1: sp.Expr, y2: sp.Expr, xi: sp.Expr) -> sp.Expr:
        """Return the squared length of the lifted point, minus 1."""
        return mu**2 * (y1**2 + y2**2) + (mu - xi) ** 2 - 1
