"""Chwa 2019, section II: the relative motion of camera and object, and its scaled image coordinates."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import sympy as sp

from percept_obs.checking import Target
from percept_obs.checking.lines import EQUATION, Line
from percept_obs.papers.base import column, dot, identities, reader, vectors
from percept_obs.papers.entries import Finding, Known, Printed, Values, Verdict, at, judged
from percept_obs.structure import COROLLARIES, scaled_dynamics
from percept_obs.structure.dynamics import CAMERA, OBJECT, OUTPUTS, ROTATION, d_s
from percept_obs.system.motion import rigid
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import pinhole
from percept_obs.system.surfaces.base import POINT, Z

TURNING = w1, w2, w3 = sp.symbols("w1:4", real=True)
"""The paper's w, minus the package's w_c."""
MINUS = {w_c: -w for w_c, w in zip(ROTATION, TURNING, strict=True)}
"""What the package's letters are in the paper's."""
SYSTEM = PerspectiveSystem(rigid(chwa_rotation=TURNING, camera_velocity=CAMERA, point_velocity=OBJECT), pinhole())

# Numbers
v_c1, v_c2, v_c3, v_p1, v_p2, v_p3 = (*CAMERA, *OBJECT)
y1, y2, y3 = SYSTEM.coordinates
_, _, ybar3 = OUTPUTS
t = sp.Symbol("t", real=True)
gamma = sp.Symbol("gamma", positive=True)
g_norm = sp.Symbol("g_norm", real=True)

# Vectors and matrices
THREE = sp.Integer(3)
p, m, mbar, x_f, x_O, v_r, v_c, v_p, w, w_camera = vectors("p m mbar x_f x_O v_r v_c v_p w w_camera", THREE)
y, ybar, Omega, g, Omega2 = vectors("y ybar Omega g Omega2", THREE)
A_c, R, w_cross, Omega1, Omega3 = (sp.MatrixSymbol(name, 3, 3) for name in ("A_c", "R", "w_cross", "Omega1", "Omega3"))


def letters(name: str) -> sp.ImmutableMatrix:
    """A column of three letters."""
    return column(*sp.symbols(f"{name}1:4", real=True))


def cross(vector: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Matrix of the cross product, as the rigid motion has it."""
    return SYSTEM.motion.A.xreplace(dict(zip(TURNING, vector, strict=True)))


def in_pixels() -> Values:
    """Projection of a point through the camera's matrix."""
    camera = sp.ImmutableMatrix(3, 3, lambda i, j: sp.Symbol(f"A_c{i + 1}{j + 1}", real=True) if i < 2 else int(j == 2))
    image = camera * column(*POINT)
    return {p: (image / image[2]).applyfunc(sp.cancel), A_c: camera, m: column(*SYSTEM.surface.image, 1)}


@cache
def in_motion() -> Values:
    """The package's rigid motion, in the paper's letters."""
    motion = SYSTEM.motion
    return {
        mbar: column(*POINT),
        dot(mbar): motion.A * column(*POINT) + motion.b,
        w_cross: motion.A,
        w: column(*TURNING),
        v_c: column(v_c1, v_c2, v_c3),
        v_p: column(v_p1, v_p2, v_p3),
        v_r: motion.b,
    }


@cache
def from_the_pose() -> Values:
    """Values of the letters for a camera that turns and moves: axes Q and centre c in F*, and the point x_O.

    To first order in t, from any attitude; the rates are those at t = 0.
    """
    rate, start = letters("a"), cross(letters("k"))
    attitude = sp.ImmutableMatrix((sp.eye(3) - start).inv() * (sp.eye(3) + start))  # any rotation but half turns
    R_t = (sp.eye(3) + t * cross(rate)) * attitude
    offset, place = letters("f") + t * letters("df"), letters("q") + t * letters("dq")
    Q, centre = R_t.T, -R_t.T * offset
    seen = Q.T * (place - centre)

    def at_zero(matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix(matrix.subs(t, 0))

    turning = at_zero(Q).T * at_zero(Q.diff(t))
    return {
        mbar: at_zero(seen),
        dot(mbar): at_zero(seen.diff(t)),
        R: at_zero(R_t),
        x_f: at_zero(offset),
        x_O: at_zero(place),
        w: rate,
        w_cross: cross(rate),
        w_camera: column(turning[2, 1], turning[0, 2], turning[1, 0]),
        v_c: at_zero(Q).T * at_zero(centre.diff(t)),
        v_p: at_zero(Q).T * at_zero(place.diff(t)),
        v_r: at_zero(Q).T * at_zero((place - centre).diff(t)),
    }


def from_a_patch() -> Values:
    """Scaled inverse depth from a plane's homography H = R + t n^T / d, with d_s one over the depth at the start."""
    turn, shift, normal = sp.ImmutableMatrix(3, 3, sp.symbols("r1:10", real=True)), letters("s"), letters("n")
    point = column(*POINT)
    distance = (normal.T * point)[0]
    homography = turn + shift * normal.T / distance
    ray = point / Z
    return {y3: 1 / (turn * point + shift)[2], d_s: 1 / Z, ybar3: 1 / (homography * ray)[2]}


def rates() -> Values:
    """Rate of the image coordinates and the inverse depth."""
    return {y: column(*SYSTEM.coordinates), dot(y): SYSTEM.rate}


def coordinates() -> Values:
    """Coordinates of a point."""
    return {y: column(*SYSTEM.surface.image, 1 / SYSTEM.surface.distance), **dict(zip(POINT, POINT, strict=True))}


def split_as(number: int) -> Callable[[], Values]:
    """Rate of ybar, split into what is known and unknown as in one of the corollaries."""

    def derive() -> Values:
        choice = COROLLARIES[number - 1].choice()
        form, dynamics = choice.form, scaled_dynamics()
        absent = dict.fromkeys((sp.Symbol(name, real=True) for name in choice.zero), sp.S.Zero)
        return {
            dot(ybar): dynamics.rate.xreplace(absent | MINUS),
            Omega: form.phi.xreplace(MINUS),
            g: form.w.T * column(*choice.theta),
            **omegas(),
            v_c: column(v_c1, v_c2, v_c3),
            v_p: column(v_p1, v_p2, v_p3).xreplace(absent),
        }

    return derive


def omegas() -> Values:
    """The three matrices, the second one times w."""
    dynamics, turning = scaled_dynamics(), column(*TURNING)
    return {Omega1: dynamics.camera, w: turning, Omega2: -dynamics.rotation * turning, Omega3: dynamics.object}


def all_have_full_rank(printed: Printed) -> Finding:
    """Ranks of the three matrices at a point."""
    dynamics = scaled_dynamics()
    here = dict(zip(OUTPUTS, (sp.Rational(2, 5), sp.Rational(1, 3), sp.Rational(1, 7)), strict=True))
    matrices = (dynamics.camera, dynamics.rotation, dynamics.object)
    ranks = [int(matrix.subs(here).rank()) for matrix in matrices]
    numbers = {f"rank of Omega{k}": rank for k, rank in enumerate(ranks, 1)}
    lost = all(entry == 0 for entry in (dynamics.rotation * column(y1, y2, 1)).expand())
    return judged(min(ranks) == 3 or not lost, Verdict.FALSE, numbers)


def nonsingular_ones() -> Target:
    """Target of the determinants of Omega1 and Omega3, each up to a number."""
    dynamics = scaled_dynamics()
    return Target(tuple(Line(f"det{k}", m.det(), EQUATION) for k, m in ((1, dynamics.camera), (3, dynamics.object))))


def bounded_by_velocities(printed: Printed) -> Finding:
    """A static point 5 m ahead, towards which the camera moves at 1 m/s: |g| of corollary 1 with d_s = 4."""
    (line,) = printed
    choice = COROLLARIES[0].choice()
    static = dict.fromkeys((v_c1, v_c2, y1, y2), sp.S.Zero) | {v_c3: sp.S.One, d_s: sp.Integer(4)}
    g_now = (choice.form.w.T * column(*choice.theta)).xreplace(static).xreplace({ybar3: 1 / (4 * (5 - t))})
    size = max(abs(entry) for entry in g_now if entry)
    sizes = {time: size.subs(t, sp.Rational(str(time))) for time in (0, 4.5, 4.9, 4.99)}
    holds = all(line.subs({g_norm: value, gamma: 15}) == sp.true for value in sizes.values())
    return judged(holds, Verdict.FALSE, {f"|g| at {time} s": float(value) for time, value in sizes.items()})


W_MATRIX = sp.ImmutableMatrix([[0, -w3, w2], [w3, 0, -w1], [-w2, w1, 0]])
MOTION = sp.ImmutableMatrix(
    [
        [-y3, 0, y1 * y3, -y1 * y2, 1 + y1**2, -y2, y3, 0, -y1 * y3],
        [0, -y3, y2 * y3, -(1 + y2**2), y1 * y2, y1, 0, y3, -y2 * y3],
        [0, 0, y3**2, -y2 * y3, y1 * y3, 0, 0, 0, -(y3**2)],
    ]
)
OMEGA2 = sp.ImmutableMatrix([[-y1 * y2, 1 + y1**2, -y2], [-(1 + y2**2), y1 * y2, -y2], [-y2 * ybar3, y1 * ybar3, 0]])
OMEGA2_MENDED = sp.ImmutableMatrix([*OMEGA2[:5], y1, *OMEGA2[6:]]).reshape(3, 3)

reads = reader(
    (gamma, p, m, mbar, x_f, x_O, v_r, v_c, v_p, w, w_camera, y, ybar, Omega, g, Omega2, A_c, R, w_cross),
    (Omega1, Omega3),
    W_MATRIX=W_MATRIX,
    MOTION=MOTION,
    OMEGA2=OMEGA2,
)

ENTRIES = (
    at("(1)", "3", "II", "pixels of a point")(reads("p = A_c m"), identities(in_pixels)),
    at("m", "3", "II", "normalised coordinates")(
        reads("m = [X / Z, Y / Z, 1]"), identities(in_pixels), known=Known.DEFINITION
    ),
    at("(2)", "3", "II", "the point in the camera's frame")(
        reads("mbar = x_f + R x_O"),
        identities(from_the_pose),
        "R is the transpose of the camera's attitude, x_f is not where the camera is",
    ),
    at("(3)", "3", "II", "relative motion")(
        reads("mbar' = w_cross mbar + v_r"),
        identities(in_motion, from_the_pose),
        "also from (2), with R' = [w] R",
    ),
    at("(4)", "3", "II", "matrix of the cross product")(
        reads("w_cross = W_MATRIX"), identities(in_motion), known=Known.DEFINITION
    ),
    at("v_r", "3", "II", "relative velocity")(
        reads("v_r = v_p - v_c"), identities(in_motion, from_the_pose), known=Known.DEFINITION
    ),
    at("w", "3", "II", "w is the camera's angular velocity")(
        reads("w = w_camera"),
        identities(from_the_pose),
        "with (3) it is the negative of it, as seen from a camera that turns",
        Verdict.MISPRINT,
        correction={w_camera: -w_camera},
    ),
    at("y", "3", "II", "coordinates")(
        reads("y = [X / Z, Y / Z, 1 / Z]"), identities(coordinates), known=Known.DEFINITION
    ),
    at("(5)", "3", "II", "rate of the coordinates")(
        reads("y' = MOTION [v_c1, v_c2, v_c3, w1, w2, w3, v_p1, v_p2, v_p3]"),
        identities(rates),
        "columns 6 to 9 merged by the scan",
    ),
    at("(6)", "4", "II", "scaled inverse depth")(
        reads("ybar3 = y3 / d_s"),
        identities(from_a_patch),
        "it takes several image points: here those of a planar patch, which give its homography",
    ),
    at("(7)", "4", "II", "rate of the scaled coordinates")(
        reads("ybar' = Omega + g; Omega + g = Omega1 v_c d_s + Omega2 + Omega3 v_p d_s"),
        identities(*map(split_as, range(1, 8))),
        "split as in each of the seven corollaries",
    ),
    at("Omega1", "4", "II", "what multiplies the camera's velocity")(
        reads("Omega1 = [[-ybar3, 0, y1 ybar3], [0, -ybar3, y2 ybar3], [0, 0, ybar3^2]]"),
        identities(omegas),
    ),
    at("Omega2", "4", "II", "what the camera's turning adds")(
        reads("Omega2 = OMEGA2 w"),
        identities(omegas),
        "second row: y1 in place of the last -y2, as in (5) (as scanned)",
        Verdict.MISPRINT,
        correction={OMEGA2: OMEGA2_MENDED},
    ),
    at("Omega3", "4", "II", "what multiplies the object's velocity")(
        reads("Omega3 = [[ybar3, 0, -y1 ybar3], [0, ybar3, -y2 ybar3], [0, 0, -ybar3^2]]"),
        identities(omegas),
    ),
    at("Omega1 to Omega3", "4", "II", "all three are nonsingular")(
        (),
        all_have_full_rank,
        "Omega2 is a vector, and its matrix sends the line of sight (y1, y2, 1) to 0",
        Verdict.FALSE,
        asks=nonsingular_ones,
    ),
    at("bound on g", "4", "III", "g is bounded, since the velocities are")(
        reads("g_norm < gamma"),
        bounded_by_velocities,
        "it grows as ybar3^2: a point that comes near breaks any gamma",
        Verdict.FALSE,
    ),
)
