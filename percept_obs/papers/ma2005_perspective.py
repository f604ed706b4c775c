"""Ma, Chen and Moore 2005, sections 1, 2 and 3.4: the moving point, and how it is seen."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import sympy as sp

from percept_obs.papers.base import column, dot, identities, reader, vanishes
from percept_obs.papers.entries import Finding, Printed, Values, Verdict, at, judged
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import chained, pinhole, plane
from percept_obs.system.surfaces.base import POINT, Y, Z

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


def in_a_plane() -> Values:
    """Second output of a point in the plane Y = c Z, which holds the camera's centre."""
    return {y2: SYSTEM.surface.image[1].xreplace({Y: constant * Z})}


def turned_axes(printed: Printed) -> Finding:
    """(34): with the new coefficients the pinhole's rate is that of the chained projection."""
    given = {line.lhs: line.rhs for line in printed}
    if set(given) != {a_new, b_new}:
        return judged(False)
    coefficients = (*SYSTEM.motion.A, *SYSTEM.motion.b)
    renamed = dict(zip(coefficients, (*given[a_new], *given[b_new]), strict=True))
    return judged(all(map(vanishes, SYSTEM.rate.xreplace(renamed) - CHAINED.rate)))


def third_output(printed: Printed) -> Finding:
    """Remark 2: three outputs of a plane depend on each other, so that two of them tell all."""
    surface = plane(outputs=3)
    seen = dict(zip(POINT, surface.image, strict=True))
    dependent = vanishes(surface.distance.subs(seen, simultaneous=True) - 1)
    point = dict(zip((*POINT, n1, n2, n3), map(sp.Integer, (1, 2, 7, 3, 4, 5)), strict=True))
    ranks = [int(column(*s.image).jacobian(POINT).subs(point).rank()) for s in (surface, pinhole())]
    numbers = {"independent outputs, plane": ranks[0], "pinhole": ranks[1]}
    return judged(not dependent or ranks[0] > ranks[1], Verdict.FALSE, numbers)


reads = reader(a_new, b_new)

ENTRIES = (
    at("(1)", "63", "1", "affine motion of the point")(
        reads("[X', Y', Z'] = [[a11, a12, a13], [a21, a22, a23], [a31, a32, a33]] [X, Y, Z] + [b1, b2, b3]"),
        identities(velocity),
    ),
    at("(2)", "63", "1", "homogeneous outputs")(reads("y1 = X / Z; y2 = Y / Z"), identities(seen_by(SYSTEM))),
    at("(3)", "64", "1", "coordinates y")(reads("[y1, y2, y3] = [X / Z, Y / Z, 1 / Z]"), identities(seen_by(SYSTEM))),
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
    ),
    at("(9)", "64", "2", "the same with n = (0, 0, 1)")(
        reads("y_g1 = X / Z; y_g2 = Y / Z; y_g3 = 1; y_g4 = 1 / Z"), identities(on_the_usual_plane)
    ),
    at("(32)", "69", "3.4", "coordinates of the chained projection")(
        reads("[y1, y2, y3] = [X / Y, Z / Y, 1 / Y]"), identities(seen_by(CHAINED))
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
    at("constant y2", "64", "2", "a plane through the centre is seen as a line")(
        reads("y2 = c"),
        identities(in_a_plane),
        "of the plane Y = c Z; y2' = 0 in (4) then gives y3 at once, but where b2 = b3 y2",
    ),
    at("Remark 2", "71", "4", "a tilted plane's third output helps")(
        (), third_output, "n1 yg1 + n2 yg2 + n3 yg3 = 1: the third output follows from the other two", Verdict.FALSE
    ),
)
