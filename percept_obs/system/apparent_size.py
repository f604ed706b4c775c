"""Apparent size: how large a sphere of unknown radius is seen, as one more output of an imaging surface."""

from __future__ import annotations

from functools import cached_property

import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile import Array
from percept_obs.system.surfaces import ImagingSurface
from percept_obs.validation import checked, positive

r = sp.Symbol("r", positive=True)
s = sp.Symbol("s", real=True)


class Sized(ImagingSurface):
    """Imaging surface with the apparent size s between its image coordinates and the inverse distance.

    s = r eta, with the sphere's radius r, which is constant, and the inverse distance eta.  A world scaled so that the
    distance is 1 has a sphere of the radius s: so s stands for r on the ray, and r is in no rate.
    """

    @cached_property
    def image_coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols of the surface's own image coordinates, and s."""
        return (*super().image_coordinates[:-1], s)

    @property
    def inverse_distance(self) -> sp.Symbol:
        """Symbol of the inverse depth or range, numbered after the surface's own image coordinates."""
        return sp.Symbol(f"y{len(self.image)}", real=True)

    @cached_property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """Symbols that shape the surface; the radius is none of them, for nobody knows it."""
        return tuple(symbol for symbol in super().parameters if symbol != r)

    @property
    def radii(self) -> dict[sp.Symbol, sp.Symbol]:
        """The radius, and the size at which it is seen."""
        return {r: s}

    @cached_property
    def lengths(self) -> tuple[int, ...]:
        """Power of length of each coordinate: s has none, for a radius is a length as well."""
        return (*(0 for _ in self.image), 1, *(0 for _ in self.parameters))

    def fits(self, other: object) -> bool:
        """Return True if another surface has the same formulas, whatever the radius is."""
        if not isinstance(other, ImagingSurface):
            return False
        shape = [{p: each.values[p] for p in self.parameters if p in each.values} for each in (self, other)]
        return super().fits(other) or (self.image == other.image and self.ray == other.ray and shape[0] == shape[1])

    def project(self, points: ArrayLike) -> Array:
        """Return image coordinates, apparent size and inverse distance in 1/m, shape (..., n); needs the radius."""
        if r not in self.values:
            raise ValueError(f"the {self.name} has no radius, so that it projects no size; give it radius=")
        return super().project(points)


@checked
def sized(surface: ImagingSurface, radius: float | None = None) -> ImagingSurface:
    """Return a surface that also sees how large a sphere around the point is: s = r/Z on the pinhole.

    Its rate is s' = s eta'/eta, from which r is gone; its row of w does not vanish at the focus of expansion (Spica,
    Robuffo Giordano and Chaumette 2014).  The sphere's centre over its radius, p = (y1, y2, 1)/s, is seen as a whole,
    and p' = A p + b/r is linear in the constant 1/r: any translation shows it, in any direction.

    Parameters
    ----------
    surface : ImagingSurface
        On which the point is seen.
    radius : float, optional
        Radius r in metres of the simulated sphere.  No observer knows it.

    Returns
    -------
    ImagingSurface
        With s, without unit, after its image coordinates.

    Raises
    ------
    ValueError
        If the radius is not positive, or the surface sees the size already.

    See Also
    --------
    pinhole, unified : Surfaces that may see it.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole, sized
    >>> sized(pinhole(), radius=0.3).project([2.0, 1.0, 4.0]).tolist()
    [0.5, 0.25, 0.075, 0.25]
    >>> form = PerspectiveSystem(affine(), sized(pinhole())).measure("y1", "y2", "s")
    >>> form.w.T[2], form.phi[2]
    (-b3*s, -a31*s*y1 - a32*s*y2 - a33*s)
    """
    if surface.radii:
        raise ValueError(f"the {surface.name} sees the size already; pass a surface without it")
    values = dict(surface.values)
    if radius is not None:
        positive(radius=radius)
        values[r] = radius
    image, roots = (*surface.image, r / surface.distance), {**surface.roots, r: s}
    shape = (surface.distance, surface.ray, values, surface.region, roots, surface.constraint)
    return Sized(f"{surface.name} with size", image, *shape)
