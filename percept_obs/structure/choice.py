"""Structure and motion from a scaled inverse depth: choices of unknowns, and if they are observable."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from percept_obs.compile import Array, vectorised
from percept_obs.structure.dynamics import CAMERA, OBJECT, OUTPUTS, ROTATION, d_s, scaled_dynamics, ybar3
from percept_obs.system.forms import CanonicalForm, partition
from percept_obs.system.motion import Motion, rigid
from percept_obs.system.surfaces import pinhole
from percept_obs.system.view import DISTANCE, OnePoint, View
from percept_obs.validation import Times, checked, numbers, set_fields

QUANTITIES = (d_s.name, *(symbol.name for symbol in (*CAMERA, *OBJECT)))
"""Names of possible unknowns: the scale d_s in 1/m, the camera's velocity v_c and the object's v_p in m/s."""


class ImpossibleChoice(ValueError):
    """The unknowns cannot be told apart, or the statements about them contradict each other."""


@checked
@dataclass(frozen=True)
class StructureAndMotion(OnePoint):
    """Choice of unknowns among the scale, the camera's and the object's velocity.

    The measured rate is linear in at most three unknowns theta, whatever the choice::

        ybar' = Omega_g(ybar) theta + Omega(ybar),      theta' = 0

    so that it is a canonical form with w^T = Omega_g, phi = Omega and g = 0, and is observable where the columns of
    Omega_g are independent.  With d_s unknown, the velocities in theta are multiplied by it.

    Parameters
    ----------
    unknown : tuple of str
        At most three names of `QUANTITIES`; they are kept in the order of `QUANTITIES`.
    zero : tuple of str
        Velocity components known to be zero.  All others that are not unknown are known signals.
    earlier : tuple of str
        Known ones that were estimated in an earlier stage.  With d_s among them, the velocities in theta stay
        multiplied by d_s, and Omega_g free of its error.
    scale : float, optional
        The known d_s in 1/m.

    Raises
    ------
    ImpossibleChoice
        If the unknowns cannot be told apart, or the statements about a quantity contradict each other.
    WrongKind
        If an argument is of another kind.

    See Also
    --------
    semigeneral : Two choices, one after the other.

    Notes
    -----
    Chwa 2019, sections IV to VI: the corollaries are seven of these choices.

    Examples
    --------
    >>> from percept_obs import StructureAndMotion
    >>> choice = StructureAndMotion(("d_s", "v_c1", "v_c2"), zero=("v_p1", "v_p2", "v_p3"))
    >>> choice.determinant
    v_c3*ybar3**4
    >>> choice.condition
    Ne(v_c3, 0) & Ne(ybar3, 0)
    """

    unknown: tuple[str, ...]
    zero: tuple[str, ...] = ()
    earlier: tuple[str, ...] = ()
    scale: float | None = None
    image_coordinates = OUTPUTS

    def __post_init__(self) -> None:
        for group in ("unknown", "zero", "earlier"):
            names = tuple(getattr(self, group))
            if strange := [name for name in names if name not in QUANTITIES]:
                raise ImpossibleChoice(
                    f"{group}: there is no quantity {', '.join(map(str, strange))}; there are {', '.join(QUANTITIES)}"
                )
            if len(set(names)) != len(names):
                raise ImpossibleChoice(f"{group} names a quantity twice: {', '.join(names)}")
            set_fields(self, **{group: tuple(sorted(names, key=QUANTITIES.index))})
        if reason := self._objection():
            raise ImpossibleChoice(reason)

    def _objection(self) -> str:
        """Contradiction of statements, or reason why the unknowns cannot be told apart; empty if there is none."""
        if both := [name for name in self.unknown if name in (*self.zero, *self.earlier)]:
            return f"{', '.join(both)} cannot be unknown and known at once; take it out of one of the lists"
        if both := [name for name in self.earlier if name in self.zero]:
            return f"{', '.join(both)} cannot be zero and estimated earlier at once; take it out of one of the lists"
        if d_s.name in self.zero:
            return "d_s is one over a distance, so it is not zero; zero names velocity components"
        if self.scale is not None and d_s.name in self.unknown:
            return f"d_s cannot be unknown and known to be {self.scale}; leave out one of the two"
        if self.scale is not None and not (math.isfinite(self.scale) and self.scale > 0):
            return f"d_s is {self.scale}; it is one over a distance in metres, finite and positive"
        if not self.unknown:
            return f"nothing is unknown; name one to three of {', '.join(QUANTITIES)}"
        if len(self.unknown) > len(OUTPUTS):
            return (
                f"{len(self.unknown)} unknowns ({', '.join(self.unknown)}), but ybar has 3 components, which give "
                f"3 equations at an instant; know at least {len(self.unknown) - len(OUTPUTS)} of them"
            )
        for camera, object_ in zip(CAMERA, OBJECT, strict=True):
            if {camera.name, object_.name} <= set(self.unknown):
                return (
                    f"{camera} and {object_} act through their difference only, so det Omega_g is zero everywhere; "
                    "know one of them"
                )
        if d_s.name in self.unknown and not any(self.known_velocity):
            return (
                "the scale d_s multiplies every velocity, and none is known that is not zero along an axis without "
                "an unknown one, so det Omega_g is zero everywhere; know such a velocity, or d_s"
            )
        return ""

    @property
    def known_velocity(self) -> tuple[sp.Expr, ...]:
        """Components of v_c - v_p along the axes on which both are known, those that are zero left out."""
        axes = zip(CAMERA, OBJECT, strict=True)
        known = ((c - o).xreplace(self._zeros) for c, o in axes if not {c.name, o.name} & set(self.unknown))
        return tuple(filter(None, known))

    @property
    def theta(self) -> tuple[sp.Expr, ...]:
        """Hidden coordinates of the form in terms of d_s and the velocities."""
        scale = d_s if d_s.name in (*self.unknown, *self.earlier) else sp.S.One
        return tuple(d_s if name == d_s.name else scale * _symbol(name) for name in self.unknown)

    @cached_property
    def form(self) -> CanonicalForm:
        """The canonical form, with x1 = ybar and x2 = theta."""
        return self.split(OUTPUTS, scaled_dynamics().rate, self)

    def split(self, outputs: tuple[sp.Symbol, ...], rate: sp.ImmutableMatrix, view: View) -> CanonicalForm:
        """The canonical form of measured outputs whose rate is given in d_s and the velocities."""
        hidden = sp.symbols(f"theta1:{len(self.unknown) + 1}", real=True)
        rate = rate.xreplace(self._zeros).xreplace(self._in_theta(hidden))
        rate = sp.ImmutableMatrix([*rate, *sp.zeros(len(hidden), 1)])
        names, parameters = [symbol.name for symbol in outputs], (*self._known, *self.parameters)
        return partition((*outputs, *hidden), rate, names, parameters, view).canonical_form()

    @property
    def _known(self) -> tuple[sp.Symbol, ...]:
        """Parameters of the rigid motion that are known signals."""
        return tuple(s for s in (*ROTATION, *CAMERA, *OBJECT) if s.name not in (*self.unknown, *self.zero))

    def known_motion(self, motion: Motion) -> Motion:
        """Signals of the known parameters of a motion from `rigid`, with numbers.

        Those of unknown quantities are not used and may be anything; velocities that are said to be zero must be.
        """
        if motion.parameters != rigid().parameters:
            raise ValueError(f"the {motion.name} motion is none of rigid() with numbers for all of its parameters")
        if motion.signal is None:
            raise ValueError(
                "the motion has no numbers; build it with those that are known, rigid(camera_velocity=...)"
            )
        known = [motion.parameters.index(symbol) for symbol in self._known]
        absent = [motion.parameters.index(symbol) for symbol in self._zeros]
        signal = motion.signal.mapped(partial(self._select, known, absent))
        return Motion("rigid, partly known,", motion.A, motion.b, self._known, signal)

    def _select(self, known: list[int], absent: list[int], rows: Array) -> Array:
        if rows[..., absent].any():
            raise ImpossibleChoice(
                f"{', '.join(self.zero)} are said to be zero, but the motion has values up to "
                f"{np.abs(rows[..., absent]).max():.4g} m/s for them; take what is not zero out of zero"
            )
        return rows[..., known]

    def _in_theta(self, hidden: tuple[sp.Symbol, ...]) -> dict[sp.Symbol, sp.Expr]:
        """The unknown quantities in terms of theta."""
        by_name = dict(zip(self.unknown, hidden, strict=True))
        scale = by_name.get(d_s.name, d_s if d_s.name in self.earlier else sp.S.One)
        return {_symbol(n): theta if n == d_s.name else theta / scale for n, theta in by_name.items()}

    @property
    def _zeros(self) -> dict[sp.Symbol, sp.Expr]:
        return dict.fromkeys(map(_symbol, self.zero), sp.S.Zero)

    @property
    def translation(self) -> tuple[sp.ImmutableMatrix, sp.ImmutableMatrix]:
        """M and m such that d_s (v_p - v_c) = M theta + m, of shapes (3, n) and (3, 1).

        They hold known signals only, so that Omega_g = Omega3 M for every choice, with the same Omega3.
        """
        hidden = sp.ImmutableMatrix(self.form.x2)
        difference = sp.ImmutableMatrix([d_s * (o - c) for c, o in zip(CAMERA, OBJECT, strict=True)])
        moved = difference.xreplace(self._zeros).xreplace(self._in_theta(tuple(hidden))).expand()
        return moved.jacobian(hidden), moved.xreplace(dict.fromkeys(hidden, sp.S.Zero))

    @cached_property
    def determinant(self) -> sp.Expr:
        """Determinant of Omega_g, factored; with fewer unknowns than outputs, of Omega_g^T Omega_g."""
        w = self.form.w
        return sp.factor(w.T.det() if w.is_square else (w * w.T).det())

    @property
    def condition(self) -> sp.Basic:
        """Observability condition; it holds where the determinant is not zero, for d_s > 0."""
        finite = sp.Ne(ybar3, 0)
        if d_s.name not in self.unknown:
            return finite
        return sp.And(finite, sp.Or(*(sp.Ne(velocity, 0) for velocity in self.known_velocity)))

    @property
    def zero_set(self) -> str:
        """Places where the unknowns are not observable, in words."""
        far = "where ybar3 = 0: the point is infinitely far"
        if d_s.name not in self.unknown:
            return far
        stands_still = " and ".join(f"{velocity} = 0" for velocity in self.known_velocity)
        return f"{far}; and where {stands_still}: no known velocity is left that the scale could be compared with"

    def sensitivity(self) -> sp.ImmutableMatrix:
        """Return the sensitivity of theta to errors of ybar3 and of its rate, to first order, shape (n, 2).

        These are the derivatives of theta, as it is recovered from ybar and its rate, with respect to ybar3 and ybar3',
        in terms of ybar, theta and the known signals.
        """
        numerator, determinant = self.form.cramer
        changed = self.form.rate[: len(OUTPUTS), :].diff(ybar3)
        both = sp.ImmutableMatrix.hstack(-numerator * changed, numerator[:, OUTPUTS.index(ybar3)])
        return (both / determinant).applyfunc(sp.cancel)

    def theta_values(self, scale: ArrayLike, motion: Motion, times: Times) -> Array:
        """True theta of a rigid motion at some times, shape (K, n), for a true scale d_s in 1/m."""
        self.known_motion(motion)  # which refuses another one
        times, scale = np.atleast_1d(numbers(times, "the times")), numbers(scale, "the scale")
        if scale.shape not in ((), times.shape) or not (np.isfinite(scale) & (scale > 0)).all():
            raise ValueError(f"the scale d_s is {scale}; give a positive number, or one for each time")
        columns = np.broadcast_to(motion.known(times), (len(times), len(motion.parameters))).T
        return np.stack(vectorised((d_s, *motion.parameters), self.theta)(scale, *columns), axis=-1)

    def quantities(self, theta: ArrayLike) -> dict[str, Array]:
        """Return unknown quantities by name, d_s in 1/m and velocities in m/s, from values of theta.

        They are NaN where theta gives no positive d_s, so that no velocity follows.

        Parameters
        ----------
        theta : array of shape (..., n)

        Raises
        ------
        ValueError
            If theta has the wrong shape, or d_s was estimated earlier and its value is not set.
        """
        theta = numbers(theta, f"the values of theta = {self.theta}", len(self.unknown))
        by_name = dict(zip(self.unknown, np.moveaxis(theta, -1, 0), strict=True))
        if d_s.name not in (*self.unknown, *self.earlier):
            return by_name
        scale = by_name.get(d_s.name, self.scale)
        if scale is None:
            raise ValueError("the estimate of d_s from the earlier stage is missing; set scale to it")
        scale = np.where(np.asarray(scale) > 0, scale, np.nan)
        return {name: scale if name == d_s.name else values / scale for name, values in by_name.items()}

    @property
    def judged(self) -> str:
        """Names of the unknowns; for the scale, the distance."""
        return ", ".join(DISTANCE if name == d_s.name else name for name in self.unknown)

    def relative_error(self, truth: Array, estimate: Array, known: Array) -> Array:
        """Largest relative error of the unknowns, shape (K,); see `View`.

        Errors of velocities are relative to the greatest speed of the point relative to the camera.
        """
        error = np.where(np.isfinite(estimate).all(axis=-1), 0.0, np.nan)
        if d_s.name in self.unknown:
            error = super().relative_error(truth, estimate, known)
        true, found = (self.quantities(rows[:, len(OUTPUTS) :]) for rows in (truth, estimate))
        speed = self._greatest_speed(truth, known)
        for name in filter(lambda name: name != d_s.name, self.unknown):
            off = np.abs(found[name] - true[name])
            share = np.divide(off, speed, out=np.where(off > 0, np.inf, off), where=bool(speed > 0))
            error = np.where(np.isinf(error), error, np.maximum(error, share))
        return error

    def _greatest_speed(self, truth: Array, known: Array) -> float:
        """Greatest speed of the point relative to the camera, |v_p - v_c|, in m/s."""
        theta = truth[:, len(OUTPUTS) :]
        scale = [self.values[symbol] for symbol in self.parameters]
        columns = np.broadcast_to(known, (len(theta), known.shape[1])).T
        scaled = vectorised((*self.form.x2, *self.form.parameters), self._scaled_velocity)(*theta.T, *columns, *scale)
        d = self.scale or theta[:, self.unknown.index(d_s.name)]
        return float(np.nanmax(np.linalg.norm(np.stack(scaled, axis=-1), axis=-1) / d))

    @cached_property
    def _scaled_velocity(self) -> list[sp.Expr]:
        """Velocity of the point relative to the camera, times d_s."""
        M, m = self.translation
        return list(M * sp.ImmutableMatrix(self.form.x2) + m)

    @property
    def name(self) -> str:
        """Name of the view and of the unknowns."""
        return f"scaled pinhole with {', '.join(self.unknown)} unknown"

    @property
    def coordinates(self) -> tuple[sp.Symbol, ...]:
        """Symbols of measured outputs and theta."""
        return self.form.coordinates

    @property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """The scale, where it is known."""
        return () if d_s.name in self.unknown else (d_s,)

    @property
    def values(self) -> Mapping[sp.Symbol, float]:
        """The scale's number, if it has one."""
        return {} if self.scale is None else {d_s: self.scale}

    @cached_property
    def lengths(self) -> tuple[int, ...]:
        """Power of the unit of length in each coordinate and the scale, found by doubling all lengths."""
        double = {d_s: d_s / 2} | {velocity: 2 * velocity for velocity in (*CAMERA, *OBJECT)}
        products = (*OUTPUTS, *self.theta, *self.parameters)
        return tuple(int(sp.log(e.subs(double, simultaneous=True) / e, 2)) for e in products)

    def fits(self, other: object) -> bool:
        """True if formulas derived for this choice hold for the other: the same one, with the same scale if any."""
        return isinstance(other, StructureAndMotion) and self == replace(
            other, scale=None if self.scale is None else other.scale
        )

    def inverse(self, coordinates: ArrayLike) -> Array:
        """Inverse depth d_s ybar3 in 1/m, shape (...), from ybar and theta; NaN where theta is missing or d_s <= 0."""
        ybar, theta = np.split(self._all(coordinates), [len(OUTPUTS)], axis=-1)
        scale = self.quantities(theta).get(d_s.name, self.scale)
        if scale is None:
            raise ValueError("the scale d_s is neither unknown nor has it a number; set scale to it")
        inverse = np.asarray(scale) * ybar[..., 2]
        return np.where(np.isnan(theta).any(axis=-1), np.nan, inverse)

    def locate(self, coordinates: ArrayLike) -> Array:
        """Points in metres, shape (..., 3), from ybar and theta; infinite where no positive inverse depth follows."""
        image = self._all(coordinates)[..., :2]
        return pinhole().locate(np.concatenate([image, self.inverse(coordinates)[..., None]], axis=-1))


def _symbol(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)
