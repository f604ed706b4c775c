"""Image of one point without a division: the block that is repeated for every point."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from percept_obs.compile import Printed, function_source
from percept_obs.system.surfaces import POINT, ImagingSurface
from percept_obs.validation import checked


class NotLinear(ValueError):
    """The surface's images do not become linear in the point when they are multiplied by its distance."""


@dataclass(frozen=True, eq=False)
class PointBlock:
    """Image of one point without a division: l(xi) (y - h(xi)) = -B(y) xi.

    Here y are its m image coordinates, N xi = l(xi) h(xi) is the image times the distance, and l xi the distance.
    """

    y: tuple[sp.Symbol, ...]
    N: sp.ImmutableMatrix
    l: sp.ImmutableMatrix

    @property
    def B(self) -> sp.ImmutableMatrix:
        """The matrix N - y l, [I, -y] for the pinhole; B(y) xi = 0 where y is the image of xi."""
        return self.N - sp.ImmutableMatrix(self.y) * self.l

    @property
    def S(self) -> sp.ImmutableMatrix:
        """Information of an image about the point: B^T B."""
        return (self.B.T * self.B).expand()

    @property
    def xi(self) -> tuple[sp.Symbol, ...]:
        """Symbols of an estimate of the point."""
        return sp.symbols("xihat1:4", real=True)

    @property
    def innovation(self) -> sp.ImmutableMatrix:
        """The image minus the estimate's, times the estimate's distance: y l xi - N xi, without a division."""
        xi = sp.ImmutableMatrix(self.xi)
        return sp.ImmutableMatrix(self.y) * (self.l * xi)[0] - self.N * xi

    @property
    def correction(self) -> sp.ImmutableMatrix:
        """Correction B^T (y l xi - N xi), which C^T and P^-1 take to the state."""
        return self.B.T * self.innovation

    @property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """Parameters of the surface, by name."""
        return tuple(sorted(self.N.free_symbols | self.l.free_symbols, key=lambda symbol: symbol.name))

    def source(self, language: Printed) -> str:
        """Text of a function of y, xi and the surface's parameters that fills an array with the correction and S."""
        return function_source((*self.y, *self.xi, *self.parameters), (*self.correction, *self.S), language)

    def eigenvalues(self) -> dict[sp.Expr, int]:
        """Eigenvalues of S with their multiplicities; 0 belongs to the ray."""
        return {sp.factor(value): count for value, count in self.S.eigenvals().items()}


@checked
@lru_cache(maxsize=64)
def point_block(surface: ImagingSurface) -> PointBlock:
    """Return one point's block, derived from the surface.

    Parameters
    ----------
    surface : ImagingSurface
        The pinhole or a plane.

    Raises
    ------
    NotLinear
        If the distance, or the image times the distance, is not linear in the point, as on curved surfaces.

    See Also
    --------
    PointsForm : All points of a state.

    Examples
    --------
    >>> from percept_obs import pinhole
    >>> from percept_obs.points import point_block
    >>> point_block(pinhole()).B
    Matrix([
    [1, 0, -y1],
    [0, 1, -y2]])
    """
    # a linear function is its gradient times the point, and the gradient is free of the point
    l = sp.ImmutableMatrix([surface.distance]).jacobian(POINT)
    N = sp.ImmutableMatrix([sp.cancel(entry * surface.distance) for entry in surface.image]).jacobian(POINT)
    if (l.free_symbols | N.free_symbols) & set(POINT):
        raise NotLinear(
            f"on the {surface.name}, distance or image times distance is not linear in the point, so that many points "
            "have no common linear form; use the pinhole or a plane"
        )
    return PointBlock(surface.image_coordinates, N, l)
