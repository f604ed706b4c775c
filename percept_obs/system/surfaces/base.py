"""Imaging surfaces: the image of a point of space, and the ray of an image point.

A surface is four expressions; `perspective.py` derives everything else from them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from types import MappingProxyType

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile import Array, Flags, definitions, vectorised
from percept_obs.system.view import OnePoint
from percept_obs.validation import checked, expression, expressions, numbers, set_fields

X, Y, Z = POINT = sp.symbols("X Y Z", real=True)


class BehindCamera(ValueError):
    """A point is not in front of the imaging surface, so it has no image there.

    See Also
    --------
    ImagingSurface.sees : Tells which points are in front of it.

    Examples
    --------
    >>> from percept_obs import pinhole
    >>> pinhole().project([0, 0, -1])  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    percept_obs.system.surfaces.base.BehindCamera: the point (0, 0, -1) has the distance -1 from the pinhole; ...
    """


@checked
@dataclass(frozen=True)
class ImagingSurface(OnePoint):
    """Imaging surface through which a camera sees points of space.

    With the ray m(y) and the inverse distance eta, the point seen at y is m(y) / eta.

    Parameters
    ----------
    name : str
        Name in messages.
    image : sequence of sympy expressions
        Image coordinates of the point (X, Y, Z), without unit; they stay when the point is scaled.
    distance : sympy expression
        Depth or range in metres of the point (X, Y, Z); it scales with the point.
    ray : sequence of three sympy expressions
        The point of the surface, at distance 1, in terms of its image coordinates y1, y2 and so on.
    values : mapping of sympy symbols to floats, optional
        Numbers for the symbols that shape the surface, such as a plane's normal vector.
    region : sequence of sympy expressions, optional
        Expressions that, like the distance, are positive where the point (X, Y, Z) is seen.
    roots : mapping of sympy expressions to sympy expressions, optional
        Values on the ray of roots of the point (X, Y, Z), besides the distance.
    constraint : sympy expression, optional
        0 for the image coordinates of every point, if they depend on each other.

    Raises
    ------
    ValueError
        If the point is not found again from its image coordinates and its distance.

    See Also
    --------
    pinhole, plane, sphere, unified, ellipsoid, chained : Make it.

    Examples
    --------
    >>> from percept_obs import pinhole
    >>> surface = pinhole()
    >>> surface.image_coordinates, surface.inverse_distance
    ((y1, y2), y3)
    >>> surface.project([2.0, 1.0, 4.0]).tolist()
    [0.5, 0.25, 0.25]
    """

    name: str
    image: Sequence[sp.Expr]
    distance: sp.Expr
    ray: Sequence[sp.Expr]
    values: Mapping[sp.Symbol, float] = field(default_factory=dict, hash=False)
    region: Sequence[sp.Expr] = ()
    roots: Mapping[sp.Expr, sp.Expr] = field(default_factory=dict, hash=False, compare=False)
    constraint: sp.Expr | None = None

    def __post_init__(self) -> None:
        constraint = self.constraint
        set_fields(
            self,
            image=expressions(self.image, "the surface's image"),
            ray=expressions(self.ray, "the surface's ray"),
            distance=expression(self.distance, "the surface's distance"),
            region=expressions(self.region, "the surface's region"),
            constraint=None if constraint is None else expression(constraint, "the surface's constraint"),
            roots=MappingProxyType(dict(self.roots)),
            values=MappingProxyType({s: float(v) for s, v in self.values.items()}),
        )
        if not self.image or len(self.ray) != 3:
            raise ValueError(
                f"the surface {self.name!r} has {len(self.image)} image coordinates and a ray of "
                f"{len(self.ray)} entries; it needs at least one image coordinate and a ray of three entries"
            )
        for symbol, value in self.values.items():
            if symbol not in (*self.parameters, *self.radii) or not np.isfinite(value):
                raise ValueError(
                    f"the surface {self.name!r} has {symbol} = {value}; give its own letters finite numbers"
                )
        self._refuse_a_wrong_ray()

    def __hash__(self) -> int:
        return hash((self.image, self.distance, self.ray))

    def fits(self, other: object) -> bool:
        """Return True if another surface has the same formulas, and the same numbers if this one has numbers."""
        if not isinstance(other, ImagingSurface):
            return False
        same = (self.image, self.distance, self.ray) == (other.image, other.distance, other.ray)
        return same and (not self.values or self.values == other.values)

    @cached_property
    def image_coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols y1, y2, ... of the image coordinates."""
        return sp.symbols(f"y1:{len(self.image) + 1}", real=True)

    @cached_property
    def inverse_distance(self) -> sp.Symbol:
        """Symbol of the inverse depth or range, numbered after the image coordinates."""
        return sp.Symbol(f"y{len(self.image) + 1}", real=True)

    @cached_property
    def coordinates(self) -> tuple[sp.Symbol, ...]:
        """Image coordinates and then the inverse distance."""
        return (*self.image_coordinates, self.inverse_distance)

    @cached_property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """Symbols that shape the surface, by name."""
        used = set().union(*(e.free_symbols for e in (*self.image, self.distance, *self.ray, *self.region)))
        return tuple(sorted(used - set(POINT) - set(self.image_coordinates), key=lambda s: s.name))

    @property
    def radii(self) -> dict[sp.Symbol, sp.Symbol]:
        """Symbols of unknown radii, each with the output that shows its size; empty but with `sized`."""
        return {}

    @cached_property
    def lengths(self) -> tuple[int, ...]:
        """Power of the unit of length in each coordinate, found by doubling the distance; 0 for parameters."""
        points = np.array([SOME_POINT, [2 * entry for entry in SOME_POINT]], dtype=float)
        near, far = np.stack(self._evaluate(POINT, (*self.image, 1 / self.distance), points), axis=-1)
        return (*np.log2(far / near).round().astype(int).tolist(), *(0 for _ in self.parameters))

    @property
    def intermediates(self) -> dict[sp.Symbol, sp.Expr]:
        """Values of the named roots of the ray, by their letters."""
        return definitions(self.ray)

    @property
    def multiplied_out(self) -> bool:
        """True if rates are to be multiplied out, which keeps them short if the distance is X, Y or Z."""
        return self.distance in POINT

    def project(self, points: ArrayLike) -> Array:
        """Return the image coordinates and then the inverse distance in 1/m of points of space, shape (..., n).

        Parameters
        ----------
        points : array of shape (..., 3)
            Points in metres, in the camera's frame.

        Raises
        ------
        BehindCamera
            If a point is not in front of the surface.
        ValueError
            If the shape is wrong, a point is not finite, or the surface has symbols without values.
        """
        points = np.asarray(points, dtype=float)
        if points.shape[-1:] != (3,) or not np.isfinite(points).all():
            raise ValueError(f"points have shape {points.shape}; expected (..., 3), all finite")
        distance, sees = self.distances(points), self.sees(points)
        if not sees.all():
            where = np.unravel_index(int(np.argmin(sees)), distance.shape) if distance.ndim else ()
            point = ", ".join(f"{entry:.4g}" for entry in points[where])
            at = "a positive distance" if distance[where] <= 0 else "a positive distance and in its field of view"
            raise BehindCamera(
                f"the point ({point}) has the distance {float(distance[where]):.4g} from the {self.name}; only points "
                f"at {at} are seen, so start the point in front of the camera or stop the motion before it passes"
            )
        return np.stack([*self._evaluate(POINT, self.image, points), 1 / distance], axis=-1)

    def sees(self, points: ArrayLike) -> Flags:
        """Flags, shape (...), of the points, shape (..., 3), that are finite and where each of `bounds` is positive."""
        points = numbers(points, "the points", 3)
        bounds = [bound > 0 for bound in self._evaluate(POINT, self.bounds, points)]
        return np.asarray(np.all([*bounds, np.isfinite(points).all(axis=-1)], axis=0))

    @property
    def bounds(self) -> tuple[sp.Expr, ...]:
        """Expressions that are positive where the point (X, Y, Z) is seen: its distance and the `region`."""
        return (self.distance, *self.region)

    def distances(self, points: ArrayLike) -> Array:
        """Depths or ranges in metres, shape (...), of points of shape (..., 3); not positive behind the camera."""
        return self._evaluate(POINT, (self.distance,), numbers(points, "the points", 3))[0]

    def inverse(self, coordinates: ArrayLike) -> Array:
        """Inverse distances in 1/m, shape (...): the last of the coordinates, of shape (..., n)."""
        return self._all(coordinates)[..., -1]

    def locate(self, coordinates: ArrayLike) -> Array:
        """Return points of space in metres, shape (..., 3), from their coordinates: the ray over the inverse distance.

        They are infinite in every coordinate where the inverse distance is not positive, for such a point is not in
        front of the camera.

        Parameters
        ----------
        coordinates : array of shape (..., n)
            Image coordinates and then the inverse distance in 1/m.

        Raises
        ------
        ValueError
            If the shape is wrong, or the surface has symbols without values.
        """
        coordinates = self._all(coordinates)
        ray = self.along(coordinates[..., :-1])
        inverse = coordinates[..., -1:]
        return np.divide(ray, inverse, out=np.full_like(ray, np.inf), where=inverse > 0)

    def along(self, image: ArrayLike) -> Array:
        """Points at the distance 1, shape (..., 3), along the rays of image points of shape (..., m); NaN for none."""
        image = numbers(image, "the image points", len(self.image_coordinates))
        with np.errstate(invalid="ignore"):  # no point of space has such an image
            return np.stack(self._evaluate(self.image_coordinates, self.ray, image), axis=-1)

    @cached_property
    def field_of_view(self) -> float:
        """Full angle in radians of the largest cone around the optical axis that is seen, up to 2 pi."""
        turns = np.linspace(0, 2 * np.pi, 720, endpoint=False)

        def seen(angle: float) -> bool:
            across = np.sin(angle) * np.stack([np.cos(turns), np.sin(turns)], axis=-1)
            return bool(self.sees(np.column_stack([across, np.full(len(turns), np.cos(angle))])).all())

        low, high = 0.0, np.pi
        if seen(high):
            return 2 * high
        for _ in range(50):
            middle = (low + high) / 2
            low, high = (middle, high) if seen(middle) else (low, middle)
        return 2 * low

    def _evaluate(self, symbols: Sequence[sp.Symbol], expressions: Sequence[sp.Expr], values: Array) -> list[Array]:
        missing = [str(s) for s in self.parameters if s not in self.values]
        if missing:
            raise ValueError(f"the {self.name} has no values for {', '.join(missing)}; give them numbers first")
        return vectorised(symbols, expressions, self.values)(*np.moveaxis(values, -1, 0))

    def _refuse_a_wrong_ray(self) -> None:
        found = _found_again(self.image, self.distance, self.ray, self.parameters)
        if not all(f.is_number and abs(f - p) < 1e-9 for f, p in zip(found, SOME_POINT, strict=True)):
            raise ValueError(
                f"on the surface {self.name!r} the point {tuple(map(float, SOME_POINT))} is seen along the ray "
                f"to {tuple(found)}; the ray at the image of a point, times its distance, must be the point"
            )


SOME_POINT = tuple(map(sp.Rational, ("0.2", "0.3", "1.7")))
"""A point in metres at which a surface's image and ray are tested against each other."""


@lru_cache(maxsize=64)  # surfaces are made anew again and again, with the same formulas
def _found_again(
    image: tuple[sp.Expr, ...], distance: sp.Expr, ray: tuple[sp.Expr, ...], parameters: tuple[sp.Symbol, ...]
) -> tuple[sp.Expr, ...]:
    """Return where the ray puts `SOME_POINT`, from its image and distance: there again if the ray is right."""
    point = dict(zip(POINT, SOME_POINT, strict=True))
    shape = {symbol: sp.Rational(k + 2, 7) for k, symbol in enumerate(parameters)}
    images = sp.symbols(f"y1:{len(image) + 1}", real=True)
    seen = {s: e.subs(point | shape) for s, e in zip(images, image, strict=True)}
    return tuple(sp.N((entry * distance).subs(point | shape | seen)) for entry in ray)
