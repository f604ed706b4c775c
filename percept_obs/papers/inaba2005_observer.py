"""Inaba, Abdursul and Ghosh 2005, sections 2 and 3: the system with many points, and the observer."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import sympy as sp

from percept_obs.papers.base import (
    column,
    dot,
    equal,
    explicit,
    filled_in,
    identities,
    is_identity,
    reader,
    vanishes,
    vectors,
)
from percept_obs.papers.entries import Finding, Known, Printed, Values, Verdict, at, judged
from percept_obs.points import LuenbergerObserver, PointsForm, luenberger
from percept_obs.system.motion import linear
from percept_obs.system.surfaces import POINT, pinhole

# Numbers
xi_11, xi_21, xi_31, xi_12, xi_22, xi_32 = XI = sp.symbols("xi_11 xi_21 xi_31 xi_12 xi_22 xi_32", real=True)
xihat_11, xihat_21, xihat_31, xihat_12, xihat_22, xihat_32 = XI_HAT = sp.symbols(
    "xihat_11 xihat_21 xihat_31 xihat_12 xihat_22 xihat_32", real=True
)
y_11, y_21, y_12, y_22 = Y = sp.symbols("y_11 y_21 y_12 y_22", real=True)

# Vectors and matrices
n, p = sp.symbols("n p", integer=True, positive=True)
x, xhat, v, rho, phi, r = vectors("x xhat v rho varphi r", n)
y = sp.MatrixSymbol("y", 2 * p, 1)
xi, xihat = vectors("xi xihat", 3 * p)
A, P = sp.MatrixSymbol("A", n, n), sp.MatrixSymbol("P", n, n)
B, C = sp.MatrixSymbol("B", 2 * p, 3 * p), sp.MatrixSymbol("C", 3 * p, n)
E, K = sp.MatrixSymbol("E", 2 * p, 2 * p), sp.MatrixSymbol("K", n, 2 * p)
C1, C2 = sp.MatrixSymbol("C1", 3, n), sp.MatrixSymbol("C2", 3, n)
y1, y2 = sp.MatrixSymbol("y1", 2, 1), sp.MatrixSymbol("y2", 2, 1)


class H(sp.MatrixExpr):
    """Images of points that stand one below the other; worked out by ``doit`` once the points are explicit."""

    def __new__(cls, points: Any) -> H:
        """Images of these points."""
        return sp.MatrixExpr.__new__(cls, points)

    @property
    def shape(self) -> tuple[sp.Expr, sp.Expr]:
        """Two rows for each three of the points."""
        return (2 * self.args[0].shape[0] / 3, sp.S.One)

    def doit(self, **hints: Any) -> sp.MatrixExpr | sp.MatrixBase:
        """The images, by the package's pinhole."""
        points = self.args[0].doit(**hints)
        if not isinstance(points, sp.MatrixBase):
            return self.func(points)
        one_by_one = (dict(zip(POINT, points[k : k + 3, :], strict=True)) for k in range(0, points.rows, 3))
        return column(*(entry.xreplace(point) for point in one_by_one for entry in pinhole().image))

    def _latex(self, printer: Any) -> str:
        return rf"{type(self).__name__}\left({printer.doprint(self.args[0])}\right)"


class h(H):
    """Image of a single point; without meaning for more."""

    def doit(self, **hints: Any) -> sp.MatrixExpr | sp.MatrixBase:
        """The image."""
        if isinstance(self.args[0].doit(**hints), sp.MatrixBase) and self.shape[0] != 2:
            raise sp.ShapeError(f"one point has three coordinates, not {self.args[0].shape[0]}")
        return super().doit(**hints)


# Any places do, as long as no minor of them vanishes by chance.
PLACES = (
    sp.ImmutableMatrix([[2, -1, 3], [5, 4, -2], [1, 7, 6]]),
    sp.ImmutableMatrix([[3, 2, -5], [-4, 1, 8], [6, 5, 9]]),
)


def letters(name: str, rows: int, columns: int) -> sp.ImmutableMatrix:
    """A matrix of letters."""
    return sp.ImmutableMatrix(rows, columns, lambda i, j: sp.Symbol(f"{name}{i + 1}{j + 1}", real=True))


@cache
def observer(points: int, states: int) -> LuenbergerObserver:
    """The package's observer; with two points the points' places are numbers, that proofs stay short."""
    blocks = [letters("c", 3, states)] if points == 1 else PLACES
    return luenberger(PointsForm(linear(states=states), [block[:, :states] for block in blocks]))


@cache
def known(points: int, states: int) -> Values:
    """Values of the vectors and matrices where the images are letters of their own."""
    made = observer(points, states)
    form = made.form
    estimate, truth = column(*made.estimate), column(*form.state)
    values: Values = {
        x: truth,
        xhat: estimate,
        v: form.motion.b,
        A: form.motion.A,
        C: form.stacked,
        B: form.B,
        E: form.E(made.estimate),
        y: column(*form.y),
        P.inv(): made.inverse,
        K: made.gain,
        dot(x): form.motion.A * truth + form.motion.b,
        dot(xhat): made.flow,
        phi: made.flow,
        r: explicit(made.gain * (column(*form.y) - form.H(made.estimate))),
        rho: column(*made.error),
        dot(rho): made.error_dynamics(),
    }
    return {letter: sp.ImmutableMatrix(value) for letter, value in values.items()}


@cache
def seen(points: int, states: int) -> Values:
    """Values of the vectors and matrices where the images are those of the state, and rho is its error."""
    made, values = observer(points, states), known(points, states)
    form = made.form
    images = form.H(form.state)
    rays = dict(zip(form.y, images, strict=True))
    truth, estimate = column(*form.state), column(*made.estimate)
    values = values | {letter: value.xreplace(rays) for letter, value in values.items()}
    values |= {y: images, rho: truth - estimate, xi: form.stacked * truth, xihat: form.stacked * estimate}
    values |= dict(zip((C1, C2), form.C, strict=False))
    values |= {letter: images[2 * k : 2 * k + 2, :] for k, letter in enumerate((y1, y2)[:points])}
    values |= dict(zip((*XI, *XI_HAT), (*values[xi], *values[xihat]), strict=True)) if points == 2 else {}
    values |= dict(zip(Y, images, strict=True)) if points == 2 else {}
    return values


@cache
def at_the_truth() -> Values:
    """Rates where the estimate is the truth: that of the estimate, and phi as that of the truth."""
    made, values = observer(1, 2), seen(1, 2)
    agreed = dict(zip(made.estimate, made.form.state, strict=True))
    return {dot(xhat): values[dot(xhat)].xreplace(agreed), phi: values[dot(x)], r: values[r].xreplace(agreed)}


def no_correction(printed: Printed) -> Finding:
    """The package's correction where the estimate is the truth."""
    (line,) = printed
    found = filled_in(line.lhs, at_the_truth())
    nothing = line.rhs == sp.ZeroMatrix(n, 1) and line.lhs in (r, -r)
    return judged(isinstance(line, sp.Eq) and nothing and found is not None and vanishes(*found))


def needs_no_integral(printed: Printed) -> Finding:
    """The package's observer: as many states as x has, and the slope of their rate in v(t), which is the identity."""
    made = observer(1, 2)
    slope = made.flow.jacobian(made.form.motion.b)
    return judged(len(made.estimate) == len(made.form.state) and slope == sp.eye(len(made.estimate)))


def one_point() -> Values:
    """One point and two states."""
    return known(1, 2)


def two_points() -> Values:
    """Two points and three states."""
    return known(2, 3)


def one_point_seen() -> Values:
    """One point and two states, images of the truth."""
    return seen(1, 2)


def two_points_seen() -> Values:
    """Two points and two states, images of the truth."""
    return seen(2, 2)


def images_and_where(printed: Printed) -> Finding:
    """(2): the images are the pinhole's, and lose their meaning just where the condition is broken."""
    images, *conditions = printed
    values = {xi: column(*XI)}
    where = [images.rhs.xreplace({condition.lhs: condition.rhs}).has(sp.zoo) for condition in conditions]
    distances = {condition.lhs for condition in conditions if isinstance(condition, sp.Ne)}
    return judged(is_identity(images, values) and all(where) and len(distances) == 2)


def error_is_the_package_s(printed: Printed) -> Finding:
    """(8): with the printed error put in, the package's error dynamics are true rate less estimated rate."""
    (line,) = printed
    values = seen(1, 2)
    here = filled_in(line.rhs, values)
    if here is None or line.lhs != rho:
        return judged(False)
    rate = known(1, 2)[dot(rho)].xreplace(dict(zip(observer(1, 2).form.y, values[y], strict=True)))
    derived = rate.xreplace(dict(zip(observer(1, 2).error, here, strict=True)))
    same = all(map(vanishes, derived - (values[dot(x)] - values[dot(xhat)])))
    return judged(same)


def rows(point: int) -> sp.ImmutableMatrix:
    """The matrix [I, -y] of a point with its image as a quotient, as the third member of (6) has it."""
    one, two, three = XI[3 * point : 3 * point + 3]
    return sp.ImmutableMatrix([[1, 0, -one / three], [0, 1, -two / three]])


FRACTIONS = column(
    xi_11 / xi_31 - xihat_11 / xihat_31,
    xi_21 / xi_31 - xihat_21 / xihat_31,
    xi_12 / xi_32 - xihat_12 / xihat_32,
    xi_22 / xi_32 - xihat_22 / xihat_32,
)
FIRST_ROWS = rows(0) * column(xi_11 - xihat_11, xi_21 - xihat_21, xi_31 - xihat_31) / xihat_31
SECOND_ROWS = rows(1) * column(xi_12 - xihat_12, xi_22 - xihat_22, xi_32 - xihat_32) / xihat_32
INNOVATION = y - H(C * xhat)
GAIN = equal(K, P.inv() * C.T * B.T * E.inv())
ERROR_DYNAMICS = equal(dot(rho), (A - P.inv() * C.T * B.T * B * C) * rho)
BOTH: tuple[Callable[[], Values], ...] = (one_point, two_points)
REAL = "C* is C^T, for all is real"

reads = reader(x, xhat, v, rho, phi, r, A, P, B, C, E, K, FRACTIONS=FRACTIONS, INNOVATION=INNOVATION)

ENTRIES = (
    at("(1)", "2", "2", "linear motion of the state, many points seen")(
        (*reads("x' = A x + v"), equal(y, H(C * x))),
        identities(one_point_seen, two_points_seen),
        "initial values left out here and below: they name the start",
    ),
    at("(2)", "2", "2", "images of all points")(
        (
            equal(H(xi), column(xi_11 / xi_31, xi_21 / xi_31, xi_12 / xi_32, xi_22 / xi_32)),
            sp.Ne(xi_31, 0),
            sp.Ne(xi_32, 0),
        ),
        images_and_where,
        "written out for p = 2, the second index for the point; a camera asks for more: xi_3 > 0",
    ),
    at("(3)", "2", "2", "images point by point")(
        (equal(y1, h(C1 * x)), equal(y2, h(C2 * x)), equal(y, H(C * x))), identities(two_points_seen)
    ),
    at("(4)", "2", "3", "an observer keeps an estimate that is true")(
        reads("xhat' = varphi"),
        identities(at_the_truth),
        "where xhat = x the package's observer moves with the truth",
        known=Known.IMPLEMENTED,
    ),
    at("form of phi", "2", "3", "the known rate and a correction")(
        reads("varphi = A xhat + v + r"), identities(one_point), known=Known.IMPLEMENTED
    ),
    at("correction r", "2", "3", "the correction is a gain times the innovation")(
        (equal(r, K * (y - h(C * xhat))),),
        identities(*BOTH),
        "H in place of h, which takes the three coordinates of one point (as scanned)",
        Verdict.MISPRINT,
        correction={h(C * xhat): H(C * xhat)},
        known=Known.IMPLEMENTED,
    ),
    at("r at the truth", "2", "3", "the correction vanishes for images of the estimate")(
        (equal(r, sp.ZeroMatrix(n, 1)),), no_correction
    ),
    at("no integration of v", "2", "2", "the observer needs no integral of the input")(
        (), needs_no_integral, "its rate has v(t) as it is, with the factor 1, and its state is an estimate of x alone"
    ),
    at("stacked C", "2", "2", "C holds the points' matrices one below the other")(
        (equal(C, sp.BlockMatrix([[C1], [C2]])),), identities(two_points_seen), "for p = 2"
    ),
    at("(5)", "3", "3", "observer of the Luenberger type")(
        reads("xhat' = A xhat + v + K INNOVATION"), identities(*BOTH), known=Known.IMPLEMENTED
    ),
    at("(6)", "3", "3", "the innovation is linear in the error")(
        (
            equal(INNOVATION, H(xi) - H(xihat)),
            *reads("INNOVATION = FRACTIONS"),
            equal(INNOVATION, sp.ImmutableMatrix([*FIRST_ROWS, *SECOND_ROWS])),
            *reads("INNOVATION = E B C rho"),
        ),
        identities(two_points_seen),
        "written out for p = 2; letters in the matrices lost by the scan",
    ),
    at("(7)", "3", "3", "what E and B are")(
        (
            equal(E, sp.diag(1 / xihat_31, 1 / xihat_31, 1 / xihat_32, 1 / xihat_32).as_immutable()),
            *reads(
                "B = [[1, 0, -y_11, 0, 0, 0], [0, 1, -y_21, 0, 0, 0], [0, 0, 0, 1, 0, -y_12], [0, 0, 0, 0, 1, -y_22]]"
            ),
        ),
        identities(two_points_seen),
        "written out for p = 2, with xihat_3 for C_3 xhat",
    ),
    at("(8)", "3", "3", "the error")(reads("rho = x - xhat"), error_is_the_package_s, known=Known.DEFINITION),
    at("(9)", "3", "3", "the correction is linear in the error")(
        reads("K INNOVATION = K E B C rho"), identities(two_points_seen)
    ),
    at("(10)", "3", "3", "the gain")((GAIN,), identities(*BOTH), REAL, known=Known.IMPLEMENTED),
    at("no denominators", "3", "3", "the gain takes the denominators out")(
        reads("K E = P^-1 C^T B^T"), identities(*BOTH)
    ),
    at("(11)", "3", "3", "the observer")(
        reads("xhat' = A xhat + v + K INNOVATION"), identities(*BOTH), "K as in (10)", known=Known.IMPLEMENTED
    ),
    at("(12)", "3", "3", "error dynamics, linear")(
        (ERROR_DYNAMICS,), identities(*BOTH), "whatever the start: no linearisation"
    ),
    at("(16)", "4", "3", "the observer, its gain written out")(
        reads("xhat' = A xhat + v + P^-1 C^T B^T E^-1 INNOVATION"),
        identities(*BOTH),
        REAL,
        known=Known.IMPLEMENTED,
    ),
    at("(17)", "4", "3", "its gain")((GAIN,), identities(*BOTH), REAL, known=Known.IMPLEMENTED),
    at("Theorem 3.4 (i)", "5", "3", "error dynamics again")((ERROR_DYNAMICS,), identities(*BOTH), REAL),
)
