"""Inaba, Abdursul and Ghosh 2005, section 3: the assumptions, and what they say about observability."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import sympy as sp

from percept_obs.papers.base import at_most, column, equal, explicit, filled_in, identities, reader, vanishes
from percept_obs.papers.entries import Check, Finding, Printed, Values, Verdict, at, judged
from percept_obs.papers.scalars import Norm
from percept_obs.points import LuenbergerObserver, PointsForm, luenberger, point_block, rigid_body
from percept_obs.points.gramian import gramian as windowed
from percept_obs.points.gramian import linear_gramian as windowed_linear
from percept_obs.points.manoeuvre import Manoeuvre
from percept_obs.points.scenarios import along_the_line_of_sight, moving_body
from percept_obs.recording import record
from percept_obs.system.motion import linear
from percept_obs.system.surfaces import POINT, pinhole

BLOCK = point_block(pinhole())

# Numbers
t, s, tau, T, b = sp.symbols("t s tau T b", real=True)
epsilon, epsilontilde, ysup = sp.symbols("epsilon epsilontilde y_sup", positive=True)
lam, lambda1, lambda2, lambda3, lambdamax = sp.symbols("lambda lambda1 lambda2 lambda3 lambda_max", real=True)
y_11, y_21, y_12, y_22 = sp.symbols("y_11 y_21 y_12 y_22", real=True)
xi_1, xi_2, xi_3 = sp.symbols("xi_1 xi_2 xi_3", real=True)
Phi_ = sp.Function("Phi", real=True)

# Vectors and matrices
n, p = sp.symbols("n p", integer=True, positive=True)
B, C, Phi = sp.MatrixSymbol("B", 2 * p, 3 * p), sp.MatrixSymbol("C", 3 * p, n), sp.MatrixSymbol("Phi", n, n)
S = sp.MatrixSymbol("S", 3 * p, 3 * p)
x = sp.MatrixSymbol("x", n, 1)
y1, y2 = sp.MatrixSymbol("y1", 2, 1), sp.MatrixSymbol("y2", 2, 1)
IMAGES = {y1: column(y_11, y_21), y2: column(y_12, y_22)}


def stable_both_ways(printed: Printed) -> Finding:
    """Assumption 3.1 (i) for x' = -x, which is Lyapunov stable: its transition matrix both ways in time."""
    (line,) = printed
    decay = line.replace(Phi_, sp.Lambda((t, s), sp.exp(s - t)))
    forwards, backwards = (decay.lhs.subs({t: there, s: here}) for there, here in ((10, 0), (0, 10)))
    bounded = decay.subs({b: 1, t: 10, s: 0}) == sp.true and decay.subs({b: 1, t: 0, s: 10}) == sp.true
    numbers = {"|Phi(10 s, 0)| of x' = -x": float(forwards), "|Phi(0, 10 s)|": float(backwards)}
    return judged(bounded, Verdict.FALSE, numbers)


@cache
def one_point() -> LuenbergerObserver:
    """The package's observer of one point and two states, with letters for all coefficients."""
    letters = sp.ImmutableMatrix(3, 2, lambda i, j: sp.Symbol(f"c{i + 1}{j + 1}", real=True))
    return luenberger(PointsForm(linear(states=2), [letters]))


def gathers(what: str, bound: sp.Symbol) -> Check:
    """Check the integrand and the bound of a Gramian.

    A start that is off by e is off by Phi e later.  The integrand must be the square of what that does to the points
    ("points"), or to their images, times their distance ("images").
    """

    def check(printed: Printed) -> Finding:
        """The integrand is the square of what an error of the start does later to what is seen."""
        (line,) = printed
        if not (isinstance(line, sp.GreaterThan) and isinstance(line.lhs, sp.Integral)):
            return judged(False)
        observer = one_point()
        form = observer.form
        transition = sp.ImmutableMatrix(2, 2, lambda i, j: sp.Symbol(f"Phi{i + 1}{j + 1}", real=True))
        e = column(*sp.symbols("e1 e2", real=True))
        images = dict(zip(form.y, form.H(form.state), strict=True))
        if what == "points":
            effect = form.stacked * transition * e
        else:
            off = dict(zip(observer.estimate, column(*form.state) - transition * e, strict=True))
            effect = observer.scaled_innovation.xreplace(off).xreplace(images)
        values: Values = {Phi: transition, C: form.stacked, B: form.B.xreplace(images)}
        integrand = filled_in(line.lhs.function, values)
        if (
            integrand is None
            or integrand.shape != (2, 2)
            or not vanishes((e.T * integrand * e)[0] - sum(entry**2 for entry in effect))
        ):
            return judged(False)
        # An integrand of 1 makes T of the integral.
        whole = sp.Integral(1, *line.lhs.limits).doit()
        return judged(whole == T and line.rhs == bound * sp.Identity(n))

    return check


def not_needed(printed: Printed) -> Finding:
    """Remark 3.2 for x' = -x + v at rest: (14) fails along the line of sight, and the error along it decays."""
    observer, point = one_point(), column(1, 2)
    values = dict(zip(observer.form.state, point, strict=True)) | dict(zip(observer.error, point, strict=True))
    values |= dict(zip(observer.form.motion.parameters[:4], -sp.eye(2), strict=True))
    values |= dict(zip(observer.form.stacked, (1, 0, 0, 0, 0, 1), strict=True))
    images = dict(zip(observer.form.y, observer.form.H(observer.form.state).xreplace(values), strict=True))
    seen = (observer.form.B * observer.form.stacked).xreplace(values).xreplace(images) * point
    rate = observer.error_dynamics().xreplace(values).xreplace(images)
    numbers = {"what (14) gathers of it": float(seen.norm()), "rate of the error's logarithm in 1/s": float(rate[0])}
    decays = seen.is_zero_matrix and rate == -point
    return Finding(Verdict.NOT_CHECKABLE if decays else Verdict.FALSE, numbers)


@cache
def two_blocks() -> sp.ImmutableMatrix:
    """S = B^T B of two points, by the package."""
    one, two = (BLOCK.S.xreplace(dict(zip(BLOCK.y, image, strict=True))) for image in IMAGES.values())
    return sp.ImmutableMatrix(sp.diag(one, two))


def information() -> Values:
    """Values of S and B with two points."""
    B_both = sp.diag(*(BLOCK.B.xreplace(dict(zip(BLOCK.y, image, strict=True))) for image in IMAGES.values()))
    return {S: two_blocks(), B: sp.ImmutableMatrix(B_both)}


def characteristic(printed: Printed) -> Finding:
    """det(lambda I - S) of two points, at a letter."""
    (line,) = printed
    derived = (lam * sp.eye(6) - two_blocks()).det(method="berkowitz")
    printed_one = filled_in(line.rhs, IMAGES)
    same = printed_one is not None and vanishes(printed_one - derived)
    return judged(line.lhs == sp.Determinant(lam * sp.Identity(3 * p) - S) and same)


def eigenvalues() -> Values:
    """Eigenvalues of one point's block, by the package, smallest first."""
    image = dict(zip(BLOCK.y, IMAGES[y1], strict=True))
    found = sorted(
        (value.xreplace(image) for value in BLOCK.eigenvalues()), key=lambda value: (sp.count_ops(value), str(value))
    )
    return dict(zip((lambda1, lambda2, lambda3), found, strict=True)) | {y1: IMAGES[y1]}


def largest_at(size: sp.Expr) -> sp.Expr:
    """The largest eigenvalue of S where the image is at a distance from the centre."""
    return sp.factor(eigenvalues()[lambda3].subs({y_11: size, y_21: 0}))


def bounded_as_a_matrix(printed: Printed) -> Finding:
    """(1 + y_sup^2) I - S has no negative eigenvalue where |y| = y_sup, and one that is zero: no smaller bound does."""
    upper, lower = printed
    if not (isinstance(upper, sp.LessThan) and isinstance(lower, sp.LessThan)):
        return judged(False)
    block = BLOCK.S.xreplace(dict(zip(BLOCK.y, (ysup, sp.S.Zero), strict=True)))
    gaps = []
    for line in printed:
        left, right = (side.xreplace({p: sp.S.One}).xreplace({sp.MatrixSymbol("S", 3, 3): block}) for side in line.args)
        gap = explicit(right) - explicit(left)
        gaps.append(set(gap.eigenvals()))
    expected = ({sp.S.Zero, ysup**2, 1 + ysup**2}, {sp.S.Zero, sp.S.One, 1 + ysup**2})
    return judged(tuple(gaps) == expected)


def what_is_seen_of_the_state() -> Values:
    """B C x of a state whose images are those in B."""
    form = one_point().form
    images = dict(zip(form.y, form.H(form.state), strict=True))
    return {B: form.B.xreplace(images), C: form.stacked, x: column(*form.state), p: sp.S.One}


def nothing_of_another(printed: Printed) -> Finding:
    """Images that two states share: what B C makes of either is 0, so (14), of the difference, leaves none."""
    seen = explicit(B * C * x, what_is_seen_of_the_state())
    least = windowed(record(moving_body(1), 16.0), 8.0).least
    return judged(vanishes(*seen) and least > 0.1, Verdict.FALSE, {"least of (14) over 8 s, one point": least})


def in_a_cone(printed: Printed) -> Finding:
    """|y|^2 <= y_sup^2, multiplied by xi_3^2: the points of a cone, on both sides of the camera."""
    image = [entry.xreplace(dict(zip(POINT, (xi_1, xi_2, xi_3), strict=True))) for entry in pinhole().image]
    cone = (ysup**2 - sum(entry**2 for entry in image)) * xi_3**2
    return judged(vanishes(cone - (ysup**2 * xi_3**2 - xi_1**2 - xi_2**2)))


def without_input(printed: Printed) -> Finding:
    """With v = 0 the state is Phi x(t0), of which B C makes 0: (14) fails for any number of points."""
    seen = explicit(B * C * x, what_is_seen_of_the_state())
    numbers = {}
    for count in (1, 4):
        body, (turns, _, spin) = moving_body(count), Manoeuvre().velocities
        scenario = replace(body, form=rigid_body(count, turns, None, spin))
        recording = record(scenario, 8.0)
        numbers[f"least of (14), v = 0, p = {count}"] = windowed(recording, 8.0).least
        sizes = np.linalg.norm(scenario.coordinates(recording.time), axis=-1)
        numbers[f"largest |x(t)| / |x(0)|, p = {count}"] = float(sizes.max() / sizes[0])
    nothing = vanishes(*seen) and max(abs(v) for name, v in numbers.items() if "least" in name) < 1e-9
    return judged(nothing, Verdict.FALSE, numbers)


def bounded_by_its_edge(printed: Printed) -> Finding:
    """The bound is met by an image at the largest distance from the centre, and no smaller one would do."""
    (line,) = printed
    meets = isinstance(line, sp.LessThan) and vanishes(line.rhs - largest_at(ysup))
    return judged(line.lhs == lambdamax and meets)


def what_is_left() -> Values:
    """S is at most its largest eigenvalue, so (14) divided by that bounds the Gramian of (C, A)."""
    return {epsilontilde: epsilon / largest_at(ysup)}


def not_enough(printed: Printed) -> Finding:
    """A point that recedes along its line of sight, A = 0: the smallest eigenvalues of both Gramians over 1 s."""
    recording = record(along_the_line_of_sight(), 2.0)
    of_points, of_images = windowed_linear(recording, 1.0).least, windowed(recording, 1.0).least
    numbers = {"Gramian of (C, A)": of_points, "(14)": of_images}
    return judged(of_points > 0.9 and abs(of_images) < 1e-9, Verdict.FALSE, numbers)


def gramian(bound: sp.Symbol, *factors: sp.MatrixExpr) -> sp.GreaterThan:
    """A Gramian over T that is at least the bound times I."""
    integral = sp.Integral(sp.MatMul(*factors), (tau, 0, T))
    return sp.GreaterThan(integral, bound * sp.Identity(n), evaluate=False)


SUP = "y_sup for the largest |y(k)|; exponents lost by the scan"

reads = reader(epsilon, epsilontilde, ysup, B, S, y1)

ENTRIES = (
    at("Assumption 3.1 (i)", "3", "3", "Lyapunov stable: Phi is bounded for all t, s")(
        (at_most(sp.Abs(Phi_(t, s)), b),),
        stable_both_ways,
        "stability bounds it for t >= s only; Theorem 3.4 needs the print, see below",
        Verdict.FALSE,
    ),
    at("(14)", "4", "3", "what a window's images tell of the state")(
        (gramian(epsilon, Phi.T, C.T, B.T, B, C, Phi),),
        gathers("images", epsilon),
        "one point, two states, all letters; least eigenvalues of two examples in Theorem 3.4 (ii)",
    ),
    at("Remark 3.2", "4", "3", "the conditions are necessary and/or reasonable")(
        (),
        not_needed,
        "reasonable is a matter of taste; necessary they are not, for what decays by itself need not be seen",
        Verdict.NOT_CHECKABLE,
    ),
    at("Proposition 3.3", "4", "3", "(14) makes (C, A) uniformly observable")(
        (gramian(epsilontilde, Phi.T, C.T, C, Phi),), gathers("points", epsilontilde), "with the constant below"
    ),
    at("S(y)", "4", "3", "information of an instant")(
        (
            *reads("S = B^T B"),
            equal(
                S,
                sp.diag(
                    sp.Matrix([[1, 0, -y_11], [0, 1, -y_21], [-y_11, -y_21, y_11**2 + y_21**2]]),
                    sp.Matrix([[1, 0, -y_12], [0, 1, -y_22], [-y_12, -y_22, y_12**2 + y_22**2]]),
                ).as_immutable(),
            ),
        ),
        identities(information),
        "written out for p = 2; signs lost by the scan",
    ),
    at("det of S", "4", "3", "characteristic polynomial")(
        (
            equal(
                sp.Determinant(lam * sp.Identity(3 * p) - S),
                lam**2 * (lam - 1) ** 2 * (lam - 1 - Norm(y1) ** 2) * (lam - 1 - Norm(y2) ** 2),
            ),
        ),
        characteristic,
        "for p = 2",
    ),
    at("eigenvalues of S", "4", "3", "eigenvalues of a point's block")(
        reads("lambda1 = 0; lambda2 = 1; lambda3 = 1 + norm(y1)^2"),
        identities(eigenvalues),
        "0 belongs to the line of sight; exponents lost by the scan",
    ),
    at("bound on S", "4", "3", "largest eigenvalue")(reads("lambda_max <= 1 + y_sup^2"), bounded_by_its_edge, SUP),
    at("S below its bound", "4", "3", "S is between 0 and its largest eigenvalue times I")(
        (at_most(S, (1 + ysup**2) * sp.Identity(3 * p)), at_most(sp.ZeroMatrix(3 * p, 3 * p), S)),
        bounded_as_a_matrix,
        SUP,
    ),
    at("constant of 3.3", "4", "3", "what of epsilon is left")(
        reads("epsilontilde = epsilon / (1 + y_sup^2)"), identities(what_is_left), SUP
    ),
    at("converse of 3.3", "4", "3", "(C, A) observable does not give (14)")(
        (), not_enough, "A = 0, C = 1, v along the line of sight: the state's length is never seen"
    ),
    at("Remark 3.2 (i), v = 0", "4", "3", "without input the body stays in a bounded space")(
        (), without_input, "of rigid bodies; but v = 0 violates (14), whatever p is: the state's length is never seen"
    ),
    at("Remark 3.2 (ii)", "4", "3", "bounded images keep the body in a cone around the camera's axis")(
        (),
        in_a_cone,
        "and a cone bounds the images; that the motion is smooth too is more than continuous images say",
        asks=lambda: sp.LessThan(xi_1**2 + xi_2**2, ysup**2 * xi_3**2, evaluate=False),
    ),
    at("(14) along x(t)", "4", "3", "(14) makes the state observable along x(t)")(
        (),
        nothing_of_another,
        "two states with the same images differ by Phi rho(t0), of which (14) sees something, and B C nothing",
    ),
)
