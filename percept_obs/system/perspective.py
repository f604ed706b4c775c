"""Perspective dynamics: a motion seen on an imaging surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from itertools import combinations
from typing import Any

import sympy as sp

from percept_obs.system.derivation import Derivation, equals, joined, rates, where
from percept_obs.system.forms import CanonicalForm, PartitionedSystem, partition
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import POINT, ImagingSurface
from percept_obs.validation import Chain, checked


@checked
@dataclass(frozen=True)
class PerspectiveSystem:
    """Point in motion, seen on an imaging surface.

    With the ray m(y), the inverse distance eta and the point X = m(y) / eta,

        y'   = J(m) (A m + b eta),        J = d(image coordinates) / dX,
        eta' = -eta grad l(m) . (A m + b eta),        l = 1 / eta.

    Image coordinates do not change with the point's scale, so eta cancels by itself.

    Parameters
    ----------
    motion : Motion
        Of one point in space, with or without numbers.
    surface : ImagingSurface
        On which it is seen.

    Raises
    ------
    ValueError
        If the motion is not that of one point in space, or has a letter of the surface's.

    See Also
    --------
    CanonicalForm : With some coordinates measured.
    percept_obs.PointsForm : Many points.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> system = PerspectiveSystem(affine(), pinhole())
    >>> system.rate[2]
    -a31*y1*y3 - a32*y2*y3 - a33*y3 - b3*y3**2
    >>> system.foe
    Matrix([
    [b1/b3],
    [b2/b3]])
    """

    motion: Motion
    surface: ImagingSurface

    def __post_init__(self) -> None:
        states = self.motion.A.shape[0]
        if states != len(POINT):
            raise ValueError(
                f"the motion has {states} states, but an imaging surface sees a point, which has {len(POINT)}; pass "
                "affine() or rigid(), or see several points of one state with PointsForm(motion, C)"
            )
        own = {symbol.name for symbol in (*self.surface.coordinates, *POINT, *self.surface.parameters)}
        if taken := sorted(own & {symbol.name for symbol in self.motion.parameters}):
            raise ValueError(
                f"the motion has the letter {', '.join(taken)}, which is a coordinate or a number of the "
                f"{self.surface.name} surface; give it another"
            )

    @property
    def coordinates(self) -> tuple[sp.Symbol, ...]:
        """Image coordinates and then the inverse distance."""
        return self.surface.coordinates

    @property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """Symbols of the motion and of the surface."""
        return (*self.motion.parameters, *self.surface.parameters)

    @property
    def values(self) -> dict[sp.Symbol, float]:
        """Numbers of the parameters that have constant ones."""
        return {**self.motion.values, **self.surface.values}

    @cached_property
    def rate(self) -> sp.ImmutableMatrix:
        """Time derivative of `coordinates`.  Ma 2005, (4), p. 64 for affine motion and the pinhole.

        It is expanded, unless roots or letters of the surface's shape would make it long.
        """
        gradients = gradients_on(self.surface)
        moved = self._rate(gradients, self._velocity)
        if self.surface.multiplied_out:
            return moved.expand()
        if _image_over_distance(self.surface).free_symbols:
            return moved
        # an image u / l with u linear in the point: y' = grad u . V - y (grad l . V), for l = 1
        y, along = sp.ImmutableMatrix(self.surface.image_coordinates), (gradients[-1, :] * self._velocity)[0]
        image = _image_over_distance(self.surface) * self._velocity - y * along
        return sp.ImmutableMatrix([*image, -self.surface.inverse_distance * along])

    def jacobian(self) -> sp.ImmutableMatrix:
        """Derivative of `rate` with respect to `coordinates`."""
        return self.rate.jacobian(self.coordinates)

    @cached_property
    def foe(self) -> sp.ImmutableMatrix:
        """Focus of expansion: the image of the translation b."""
        direction = dict(zip(POINT, self.motion.b, strict=True))
        seen = [entry for entry in self.surface.image if not entry.has(*self.surface.radii)]  # a direction has no size
        return sp.ImmutableMatrix([entry.subs(direction, simultaneous=True) for entry in seen])

    def partition(self, *names: str) -> PartitionedSystem:
        """Divide the coordinates into measured and hidden ones.

        This is enough for the extended Kalman filter, for any outputs on any surface; see `measure` for the names.

        Raises
        ------
        ValueError
            If a name is unknown, repeated, or the inverse distance, or none is given.
        """
        known = [symbol.name for symbol in self.surface.image_coordinates]
        if not names or len(set(names)) != len(names) or not set(names) <= set(known):
            raise ValueError(
                f"cannot measure {', '.join(map(repr, names)) or 'nothing'}: the outputs of the {self.surface.name} "
                f"are {', '.join(known)}; name at least one of them, each once"
            )
        motion = replace(self.motion, signal=None)  # its numbers may be functions, which no other process can take
        return partition(self.coordinates, self.rate, names, self.parameters, self.surface, motion)

    def measure(self, *names: str) -> CanonicalForm:
        """Canonical form with some coordinates measured.

        Parameters
        ----------
        *names : str
            Names of the measured coordinates, such as "y1", "y2".

        Raises
        ------
        NotAffine
            If the measured outputs' rate is not affine in the hidden coordinates.
        ValueError
            If `partition` refuses the names.

        See Also
        --------
        output_choices : names that give a canonical form
        """
        return self.partition(*names).canonical_form()

    @cached_property
    def output_choices(self) -> tuple[tuple[str, ...], ...]:
        """Names of measured outputs that give a canonical form, those with most outputs first."""
        names = [symbol.name for symbol in self.surface.image_coordinates]
        choices = (chosen for count in range(len(names), 0, -1) for chosen in combinations(names, count))
        return tuple(chosen for chosen in choices if not self.partition(*chosen).culprits)

    def derivation(self) -> Derivation:
        """Derivation of the rate from X' = A X + b, step by step."""
        surface, motion, gradients = self.surface, self.motion, gradients_on(self.surface)
        y, point = sp.latex(sp.Matrix(surface.image_coordinates)), sp.latex(sp.Matrix(POINT))
        eta, directions = sp.latex(surface.inverse_distance), surface.image_coordinates[: len(self.foe)]
        ways = [f"{y_k} = {e}" for y_k, e in zip(surface.image_coordinates, surface.image, strict=True)]
        ways += [f"{surface.inverse_distance} = {1 / surface.distance}"]
        last = (
            "Multiplied out:" if surface.multiplied_out else "Written shortly, with the distance's own rate in front:"
        )
        rate = partial(self._rate, gradients)
        formulas: dict[str, str | tuple[Any, ...]] = {
            "The point moves:": (
                equals(rf"\frac{{d}}{{dt}} {point}", f"{sp.latex(motion.A)} {point} + {sp.latex(motion.b)}"),
                rates(POINT, motion.A * sp.ImmutableMatrix(POINT) + motion.b),
                Chain(self._seen_on_the_ray, rate),
            ),
            f"It is seen on the {surface.name} surface:": (
                rf"{y} = {sp.latex(sp.Matrix(surface.image))},\quad {eta} = {sp.latex(1 / surface.distance)}",
                dict(zip(map(str, surface.coordinates), (*surface.image, 1 / surface.distance), strict=True)),
            ),
            "Image and distance say where the point is:": (
                joined(
                    [
                        rf"{point} = \frac{{1}}{{{eta}}}\, m(y)",
                        equals("m", sp.Matrix(surface.ray)),
                        *where(*surface.ray),
                        *([] if surface.constraint is None else [equals(sp.latex(surface.constraint), "0")]),
                    ]
                ),
                {f"m{k}": entry for k, entry in enumerate(surface.ray, 1)},
                Chain(self._velocity_along, rate),
            ),
            "Derivatives of the image coordinates, and of the distance l, taken on the ray:": (
                rf"J(m) = {sp.latex(gradients[:-1, :])},\quad \nabla l(m) = {sp.latex(gradients[-1, :])}",
                {
                    f"the derivative of {way} with respect to {axis}": gradients[i, j]
                    for i, way in enumerate(ways)
                    for j, axis in enumerate(POINT)
                },
                Chain(partial(sp.ImmutableMatrix, len(ways), 3), partial(self._rate, velocity=self._velocity)),
            ),
            "The velocity, times the inverse distance:": (
                equals(rf"A m + b\,{eta}", self._velocity),
                {f"the velocity along {axis}": entry for axis, entry in zip(POINT, self._velocity, strict=True)},
                Chain(sp.ImmutableMatrix, rate),
            ),
            "Image coordinates do not change with scale, so the inverse distance cancels:": (
                rf"\dot y = J(m)\,(A m + b\,{eta}),\quad \dot{{{eta}}} = -{eta}\, \nabla l(m) \cdot (A m + b\,{eta})",
                rates(self.coordinates, self._rate(gradients, self._velocity)),
                sp.ImmutableMatrix,
            ),
            last: (
                equals(rf"\frac{{d}}{{dt}} {sp.latex(sp.Matrix(self.coordinates))}", self.rate),
                rates(self.coordinates, self.rate),
                sp.ImmutableMatrix,
            ),
            "The focus of expansion, where the distance drops out of the image's motion:": (
                equals(sp.latex(sp.Matrix(directions)), self.foe),
                dict(zip(map(str, directions), self.foe, strict=True)),
            ),
        }
        return Derivation.of(formulas)

    def _repr_latex_(self) -> str:
        rate = equals(rf"\frac{{d}}{{dt}} {sp.latex(sp.Matrix(self.coordinates))}", self.rate)
        return rf"$\displaystyle {joined([rate, *where(self.rate)])}$"

    @cached_property
    def _velocity(self) -> sp.ImmutableMatrix:
        return self._velocity_along(self.surface.ray)

    def _velocity_along(self, ray: Sequence[sp.Expr]) -> sp.ImmutableMatrix:
        """Return A m + b eta, eta times the velocity of the point m / eta on the ray m."""
        return self.motion.A * sp.ImmutableMatrix(ray) + self.motion.b * self.surface.inverse_distance

    def _seen_on_the_ray(self, velocity: Sequence[sp.Expr]) -> sp.ImmutableMatrix:
        """Velocity of the point m / eta, times eta, from a velocity in terms of the point."""
        eta = self.surface.inverse_distance
        point = {axis: entry / eta for axis, entry in zip(POINT, self.surface.ray, strict=True)}
        return sp.ImmutableMatrix([eta * entry.subs(point, simultaneous=True) for entry in velocity])

    def _rate(self, gradients: sp.ImmutableMatrix, velocity: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
        """Rate of the coordinates from the gradients of image and distance and the velocity times eta."""
        *image, distance = gradients * velocity
        return sp.ImmutableMatrix([*image, -self.surface.inverse_distance * distance])


@lru_cache(maxsize=64)  # surfaces are made anew again and again, with the same formulas
def gradients_on(surface: ImagingSurface) -> sp.ImmutableMatrix:
    """Gradients of the image and the distance at X = m(y), where the distance is 1, shape (n, 3)."""
    gradients = sp.ImmutableMatrix([*surface.image, surface.distance]).jacobian(POINT)
    ray = dict(zip(POINT, surface.ray, strict=True))
    at_one = gradients.subs(surface.distance, 1).subs(dict(surface.roots))
    return at_one.subs(ray, simultaneous=True).applyfunc(lambda entry: _with_plain_angles(sp.cancel(entry), surface))


def _with_plain_angles(entry: sp.Expr, surface: ImagingSurface) -> sp.Expr:
    """Return an entry with u in place of atan2(|sin(u)|, cos(u)), which equals it for the angle u from 0 to pi."""
    for y, image in zip(surface.image_coordinates, surface.image, strict=True):
        if isinstance(image, sp.asin | sp.atan):  # from -pi/2 to pi/2
            entry = entry.xreplace({sp.Abs(sp.cos(y)): sp.cos(y)})
    sines = {size: size.args[0] for size in entry.atoms(sp.Abs) if isinstance(size.args[0], sp.sin)}
    entry = entry.xreplace({size: sine for size, sine in sines.items() if sine.args[0].is_nonnegative})
    angles = {sp.atan2(sp.sin(u), sp.cos(u)): u for sine in sines.values() for u in sine.args}
    return sp.cancel(entry.xreplace(angles)) if sines else entry


@lru_cache(maxsize=64)
def _image_over_distance(surface: ImagingSurface) -> sp.ImmutableMatrix:
    """Gradient of the product of image and distance, on the ray; constant if the product is linear in the point."""
    y, gradients = sp.ImmutableMatrix(surface.image_coordinates), gradients_on(surface)
    return (gradients[:-1, :] + y * gradients[-1, :]).applyfunc(sp.cancel)
