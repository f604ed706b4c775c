"""Ma, Chen and Moore 2005, sections 1, 2 and 3.4: the moving point, and how it is seen."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import sympy as sp

from percept_obs.papers.base import column, dot, identities, reader, vanishes
from percept_obs.papers.entries import Finding, Known, Printed, Values, Verdict, at, judged
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import chained, pinhole, plane
from percept_obs.system.surfaces.base import POINT, X, Y, Z

SYSTEM = PerspectiveSystem(affine(), pinhole())
CHAINED = PerspectiveSystem(affine(), chained())

y1, y2, y3 = SYSTEM.coordinates
n1, n2, n3 = plane().parameters
Xp, Yp, Zp, ell = sp.symbols("X_p Y_p Z_p l_p", real=True)
yg1, yg2, yg3, yg4 = sp.symbols("y_g1:5", real=True)
constant = sp.Symbol("c", real=True)
a_new, b_new = sp.MatrixSymbol("a", 3, 3), sp.MatrixSymbol("b", 3, 1)


def velocity() -> Values:
    """Velocity of the point."""
    rates = SYSTEM.motion.A * column(*POINT) + SYSTEM.motion.b
    return dict(zip(map(dot, POINT), rates, strict=True))


def seen_by(system: PerspectiveSystem) -> Callable[[], Values]:
    """Coordinates of the point."""
    image = (*system.surface.image, 1 / system.surface.distance)
    return lambda: dict(zip(system.coordinates, image, strict=True))


def rates_of(system: PerspectiveSystem) -> Callable[[], Values]:
    """Rates of the coordinates."""
    return lambda: dict(zip(map(dot, system.coordinates), system.rate, strict=True))


@cache
def on_the_plane() -> Values:
    """Projection and outputs on the general plane.

    The package's plane is n . X = 1; the printed one passes through (0, 0, 1), so the image is scaled until
    that point is its own image.
    """
    surface = plane(outputs=3)
    scale = 1 / surface.image[2].subs(dict(zip(POINT, (0, 0, 1), strict=True)))
    projection = [scale * entry for entry in surface.image]
    outputs = (*surface.image, 1 / surface.distance)
    letters = (Xp, Yp, Zp, ell, yg1, yg2, yg3, yg4)
    return dict(zip(letters, (*projection, surface.distance, *outputs), strict=True))


def on_the_usual_plane() -> Values:
    """Values of the letters with the normal vector along Z."""
    normal = {n1: sp.S.Zero, n2: sp.S.Zero, n3: sp.S.One}
    return {letter: sp.cancel(value.xreplace(normal)) for letter, value in on_the_plane().items()}


def stays_in_a_plane() -> Values:
    """Rate of y2 for a motion that keeps the plane Y = c Z, and the point in it."""
    (a21, _, a23), b2 = SYSTEM.motion.A[1, :], SYSTEM.motion.b[1]
    return {dot(y2): SYSTEM.rate[1].xreplace(KEPT | {y2: constant}), **{s: s for s in (a21, a23, b2)}}


def identified_together(printed: Printed) -> Finding:
    """The rate of y2 in a plane that the motion keeps, and the rank of y1 with two derivatives at some point of it."""
    found = identities(stays_in_a_plane)(printed)
    listed = dict(zip(SYSTEM.motion.parameters, map(sp.Integer, (-2, 4, -6, 1, -2, 3, 3, -4, 4, 5, 2, 3)), strict=True))
    here = {symbol: KEPT.get(symbol, symbol).subs(constant, 2).subs(listed) for symbol in SYSTEM.motion.parameters}
    rate = SYSTEM.rate.xreplace(here)
    derivative = known = column(y1)
    for _ in range(2):
        derivative = derivative.jacobian(SYSTEM.coordinates) * rate
        known = known.col_join(derivative)
    rank = known.jacobian(SYSTEM.coordinates).subs({y1: sp.Rational(1, 3), y2: 2, y3: sp.Rational(2, 5)}).rank()
    told = found.verdict == Verdict.HOLDS and rank == len(SYSTEM.coordinates)
    return judged(told, numbers={"rank of y1 with two derivatives": int(rank)})


def turned_axes(printed: Printed) -> Finding:
    """(34): with the new coefficients the pinhole's rate is that of the chained projection."""
    given = {line.lhs: line.rhs for line in printed}
    if set(given) != {a_new, b_new}:
        return judged(False)
    coefficients = (*SYSTEM.motion.A, *SYSTEM.motion.b)
    renamed = dict(zip(coefficients, (*given[a_new], *given[b_new]), strict=True))
    return judged(all(map(vanishes, SYSTEM.rate.xreplace(renamed) - CHAINED.rate)))


def _kept() -> dict[sp.Symbol, sp.Expr]:
    """Coefficients of a motion that keeps the plane Y = c Z: Y' - c Z' vanishes in it."""
    velocity_ = SYSTEM.motion.A * column(*POINT) + SYSTEM.motion.b
    leaves = (velocity_[1] - constant * velocity_[2]).subs(Y, constant * Z)
    unknown = (SYSTEM.motion.A[1, 0], SYSTEM.motion.A[1, 2], SYSTEM.motion.b[1])
    (solution,) = sp.linsolve(sp.Poly(leaves, X, Z).coeffs(), unknown)
    return dict(zip(unknown, solution, strict=True))


KEPT = _kept()
reads = reader(a_new, b_new)

ENTRIES = (
    at("(1)", "63", "1", "affine motion of the point")(
        reads("[X', Y', Z'] = [[a11, a12, a13], [a21, a22, a23], [a31, a32, a33]] [X, Y, Z] + [b1, b2, b3]"),
        identities(velocity),
    ),
    at("(2)", "63", "1", "homogeneous outputs")(reads("y1 = X / Z; y2 = Y / Z"), identities(seen_by(SYSTEM))),
    at("(3)", "64", "1", "coordinates y")(
        reads("[y1, y2, y3] = [X / Z, Y / Z, 1 / Z]"), identities(seen_by(SYSTEM)), known=Known.DEFINITION
    ),
    at("(4)", "64", "1", "perspective dynamics, pinhole")(
        reads(
            """y1' = a13 + (a11 - a33) y1 + a12 y2 - a31 y1^2 - a32 y1 y2 + (b1 - b3 y1) y3;
            y2' = a23 + a21 y1 + (a22 - a33) y2 - a31 y1 y2 - a32 y2^2 + (b2 - b3 y2) y3;
            y3' = -(a31 y1 + a32 y2 + a33) y3 - b3 y3^2"""
        ),
        identities(rates_of(SYSTEM)),
    ),
    at("(5)", "64", "2", "general plane through (0, 0, 1)")(
        reads("n1 X_p + n2 Y_p + n3 (Z_p - 1) = 0"), identities(on_the_plane)
    ),
    at("(6)", "64", "2", "a point and its projection are in line")(
        reads("X_p = Z_p X / Z; Y_p = Z_p Y / Z"), identities(on_the_plane)
    ),
    at("(7)", "64", "2", "projection on the plane")(
        reads("X_p = n3 X / l_p; Y_p = n3 Y / l_p; Z_p = n3 Z / l_p; l_p = n1 X + n2 Y + n3 Z"),
        identities(on_the_plane),
        "letter of the denominator lost by the scan",
    ),
    at("(8)", "64", "2", "outputs on the general plane")(
        reads("y_g1 = X / l_p; y_g2 = Y / l_p; y_g3 = Z / l_p; y_g4 = 1 / l_p"),
        identities(on_the_plane),
        "letter of the denominator lost by the scan",
        known=Known.DEFINITION,
    ),
    at("(9)", "64", "2", "the same with n = (0, 0, 1)")(
        reads("y_g1 = X / Z; y_g2 = Y / Z; y_g3 = 1; y_g4 = 1 / Z"), identities(on_the_usual_plane)
    ),
    at("(32)", "69", "3.4", "coordinates of the chained projection")(
        reads("[y1, y2, y3] = [X / Y, Z / Y, 1 / Y]"), identities(seen_by(CHAINED)), known=Known.DEFINITION
    ),
    at("(33)", "69", "3.4", "perspective dynamics, chained")(
        reads(
            """y1' = a11 y1 + a12 + a13 y2 - (a21 y1 + a22 + a23 y2) y1 + (b1 - b2 y1) y3;
            y2' = a31 y1 + a32 + a33 y2 - (a21 y1 + a22 + a23 y2) y2 + (b3 - b2 y2) y3;
            y3' = -(a21 y1 + a22 + a23 y2) y3 - b2 y3^2"""
        ),
        identities(rates_of(CHAINED)),
    ),
    at("(34)", "69", "3.4", "coefficients that turn (4) into (33)")(
        reads("a = [[a11, a13, a12], [a31, a33, a32], [a21, a23, a22]]; b = [b1, b3, b2]"),
        turned_axes,
    ),
    at("constant y2", "64", "2", "in a plane that is seen as a line y2 and y3 are identified from y1")(
        reads("y2' = 0"),
        identified_together,
        "for a motion that keeps the plane Y = c Z; y2 is then a constant that y1 and its derivatives tell with y3",
    ),
)
