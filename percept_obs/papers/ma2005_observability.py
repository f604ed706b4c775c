"""Ma, Chen and Moore 2005, section 3.1: the assumptions, and what they say about observability."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import sympy as sp

from percept_obs.compile import vectorised
from percept_obs.observability import instantaneous, windowed
from percept_obs.observers import identifier_based
from percept_obs.observers.parts import M, gamma
from percept_obs.papers.base import (
    column,
    exactly,
    explicit,
    identities,
    reader,
    separates,
    strict_at_zero,
    vanishes,
    vectors,
    weakened,
)
from percept_obs.papers.entries import Check, Finding, Known, Printed, Values, Verdict, at, judged
from percept_obs.papers.scalars import Norm
from percept_obs.recording import Recording, Scenario, record
from percept_obs.recording.scenarios import ma2005_eq35, ma2005_eq36
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import pinhole
from percept_obs.tracking.following import track
from percept_obs.tracking.run import Run

SYSTEM = PerspectiveSystem(affine(), pinhole())
BOTH, FIRST = SYSTEM.measure("y1", "y2"), SYSTEM.measure("y1")
EXAMPLES = (ma2005_eq35(), ma2005_eq36())

# Numbers
b1, b2, b3 = SYSTEM.motion.b
y1, y2, y3 = SYSTEM.coordinates
abar, bbar, centre1, centre2, radius, t, tau = sp.symbols("abar bbar o1 o2 r t tau", real=True)
epsilon, alpha0, beta, rho = sp.symbols("epsilon alpha0 beta rho", positive=True)

# Vectors and matrices
n1, n2, n = sp.symbols("n1 n2 n", integer=True, positive=True)
x2, z2, g, gz = vectors("x2 z2 g gz", n2)
(x,) = vectors("x", n)
w = sp.MatrixSymbol("w", n2, n1)


def more(left: sp.Basic, right: sp.Basic) -> sp.StrictGreaterThan:
    """The inequality ``left > right`` as it is printed."""
    return sp.StrictGreaterThan(left, right, evaluate=False)


@cache
def through_the_foe() -> Recording:
    """The motion of (35) without noise, from a start at the focus of expansion."""
    motion = EXAMPLES[0].motion
    position = [5 * motion.values[symbol] for symbol in SYSTEM.motion.b]
    return record(Scenario("through the focus of expansion", motion, position, 10.0, pinhole()))


@cache
def one_direction_seen() -> Run:
    """The IBO where a12 = b1 = 1 and all else is 0: w = (1, 1) for ever, so that only y2 + y3 is seen."""
    motion = affine([[0, 1, 0], [0, 0, 0], [0, 0, 0]], [1, 0, 0])
    recording = record(Scenario("only y2 + y3 is seen", motion, (-8, 3, 8), 10.0, pinhole()))
    return track(recording, identifier_based(FIRST), (0, 0, 0))


def unseen_error() -> dict[str, float]:
    """The error e2 - e3 at the start and at the end of that run."""
    error = one_direction_seen().error
    return {"e2 - e3 at 0 s": float(error[0, 1] - error[0, 2]), "at 10 s": float(error[-1, 1] - error[-1, 2])}


def stays_unseen() -> bool:
    """Return True if the run leaves that error unchanged."""
    start, end = unseen_error().values()
    return abs(end - start) < 1e-9 < abs(start)


def state_is_bounded(printed: Printed) -> Finding:
    """Assumption 1: the largest norms of y in 80 s of both examples."""
    (line,) = printed
    bound = identifier_based(FIRST).gain_values[M]
    truths = [s.coordinates(np.arange(0, s.duration, 0.01)) for s in EXAMPLES]
    largest = [float(np.linalg.norm(truth, axis=1).max()) for truth in truths]
    holds = all(separates(line, Norm(x), norm, 1.01 * bound, {M: sp.Float(bound)}) for norm in largest)
    return judged(holds, Verdict.FALSE, {"largest |y| of (35)": largest[0], "of (36)": largest[1]})


def lipschitz(printed: Printed) -> Finding:
    """(13): g is a polynomial, so its slope is bounded in a ball; the constant for (35), y1 alone."""
    if strict_at_zero(printed, {Norm(g - gz): sp.S.Zero, Norm(x2 - z2): sp.S.Zero}):
        return judged(False, numbers={"left at x2 = z2": 0.0, "right": 0.0})
    return Finding(Verdict.HOLDS, {"alpha0 of (35)": lipschitz_constant(FIRST)})


def lipschitz_constant(form: CanonicalForm) -> float:
    """A bound on the slope of g in x2 for the motion of (35), where no coordinate is beyond gamma M."""
    gains = identifier_based(form).gain_values
    ball = gains[M] * gains[gamma]
    slope = form.g.jacobian(form.x2).xreplace(exactly(EXAMPLES[0].motion.values))
    polynomials = [sp.Poly(entry, *SYSTEM.coordinates) for entry in slope]
    return math.hypot(*(sum(abs(float(c)) * ball ** sum(powers) for powers, c in p.terms()) for p in polynomials))


def w_is_bounded(printed: Printed) -> Finding:
    """Assumption 1: the largest norms of w and of its rate in 80 s of (35), y1 alone."""
    rates = dict(zip(SYSTEM.coordinates, SYSTEM.rate, strict=True))
    rate = sum((FIRST.w.diff(s) * rates[s] for s in FIRST.x1), sp.zeros(2, 1))
    norms = [matrix.norm() for matrix in (FIRST.w, rate)]
    truth = EXAMPLES[0].coordinates(np.arange(0, EXAMPLES[0].duration, 0.01))
    largest = [float(v.max()) for v in vectorised(SYSTEM.coordinates, norms, EXAMPLES[0].motion.values)(*truth.T)]
    numbers = dict(zip(("largest |w|", "largest |dw/dt|"), largest, strict=True))
    return judged(bool(np.isfinite(largest).all()), Verdict.FALSE, numbers)


def excitation(printed: Printed) -> Finding:
    """(14): the proofs integrate |w^T e2|^2, so it bounds the matrix of that quadratic form, by a matrix."""
    (line,) = printed
    for form in (FIRST, BOTH):
        e2 = column(*sp.symbols(f"e1:{len(form.x2) + 1}", real=True))
        seen = sum(entry**2 for entry in form.w.T * e2)
        integrand = explicit(line.lhs.function, {w: form.w})
        if integrand.shape != (len(e2), len(e2)) or not vanishes((e2.T * integrand * e2)[0] - seen):
            values = exactly(one_direction_seen().recording.motion.values)
            trace = float(explicit(line.lhs.function, {w: FIRST.w.subs(values)})[0])
            return judged(False, numbers={"w^T w, y1 alone": trace, **unseen_error()})
    return judged(line.rhs == beta * sp.Identity(n2))


def not_at_every_instant(printed: Printed) -> Finding:
    """Through the focus of expansion the printed bound fails at an instant, and every window is excited."""
    (line,) = printed
    if not vanishes(line.lhs - instantaneous(BOTH).determinant):
        return judged(False)
    recording = through_the_foe()
    evaluate = vectorised(BOTH.x1, [line.lhs], recording.motion.values)
    least = float(evaluate(*recording.outputs.T)[0].min())
    gathered = windowed(BOTH, recording, 1.0).least
    numbers = {"least of the printed sum": least, "of the integrals over 1 s": gathered}
    return judged(not least < 1e-12 < 1e-2 < gathered, Verdict.FALSE, numbers)


def circle(*letters: sp.Symbol) -> Callable[[], Values]:
    """Centre and radius of the circle in which both outputs do not suffice; its centre is the FOE."""

    def derive() -> Values:
        centre, size = instantaneous(BOTH).circle(epsilon)
        values = dict(zip((centre1, centre2, radius), (*centre, size), strict=True))
        return {letter: values[letter] for letter in letters} if centre == tuple(SYSTEM.foe) else {}

    return derive


def ranks_at_the_foe(motion: dict[sp.Symbol, sp.Rational]) -> list[int]:
    """Rank of the outputs with their first derivatives, and with their second ones, at the focus of expansion."""
    rate = SYSTEM.rate.xreplace(motion)
    foe = dict(zip(BOTH.x1, SYSTEM.foe.xreplace(motion), strict=True)) | {y3: sp.Rational(2, 3)}
    derivative = known = column(*BOTH.x1)
    ranks = []
    for _ in range(2):
        derivative = derivative.jacobian(SYSTEM.coordinates) * rate
        known = known.col_join(derivative)
        ranks.append(int(known.jacobian(SYSTEM.coordinates).subs(foe).rank()))
    return ranks


def range_at_the_foe(printed: Printed) -> Finding:
    """Ranks for a point of (35) that passes the focus of expansion and one that stays there, and a run from there."""
    passing = exactly(EXAMPLES[0].motion.values)
    staying = passing | dict.fromkeys(SYSTEM.motion.A, sp.S.Zero)
    (first, second), (_, never) = ranks_at_the_foe(passing), ranks_at_the_foe(staying)
    settling = track(through_the_foe(), identifier_based(BOTH), (0, 0, 0)).settling_time(0.05, "y3")
    numbers = {
        "rank with first derivatives": first,
        "with second": second,
        "staying there": never,
        "IBO settles at s": settling,
    }
    depends = (first, second, never) == (2, 3, 2) and math.isfinite(settling)
    return Finding(Verdict.DEPENDS if depends else Verdict.FALSE, numbers)


def an_instant_suffices(form: CanonicalForm) -> Check:
    """Check whether the condition is the package's measure, and whether the form can fulfil it anywhere."""

    def check(printed: Printed) -> Finding:
        """The condition is the package's measure; and whether the rank of w w^T lets it be fulfilled anywhere."""
        line, positive = printed
        observability = instantaneous(form)
        gap = explicit(line.lhs, {w: form.w}) - line.rhs - (observability.determinant - epsilon)
        if not (isinstance(line, sp.StrictGreaterThan) and vanishes(gap) and positive.doit() == sp.true):
            return judged(False)
        numbers = {"rank of w w^T": observability.rank, "its size": len(form.x2)}
        return judged(observability.suffices, Verdict.FALSE, numbers)

    return check


def smallest_of_rank_one(printed: Printed) -> Finding:
    """(19): both matrices are right; the smallest eigenvalue of the second is 0 everywhere."""
    both, first = printed
    entries = dict(zip((abar, bbar), FIRST.w, strict=True))
    (matrix,) = first.lhs.args
    right = (
        *(explicit(matrix, entries) - instantaneous(FIRST).information),
        both.lhs - instantaneous(BOTH).determinant,
    )
    if not all(map(vanishes, right)):
        return judged(False)
    smallest = explicit(first.lhs, entries)
    return judged(not vanishes(smallest), Verdict.FALSE, {"smallest eigenvalue": float(smallest)})


def larger_of_rank_one(printed: Printed) -> Finding:
    """(20): the second sum is the larger eigenvalue; it is 2 where a direction is never seen."""
    both, first = printed
    right = (first.lhs - instantaneous(FIRST).information.trace(), both.lhs - instantaneous(BOTH).determinant)
    if not all(map(vanishes, right)):
        return judged(False)
    values = exactly(one_direction_seen().recording.motion.values)
    value = float(first.lhs.subs(values))
    return judged(not (value > 0 and stays_unseen()), Verdict.FALSE, {"printed sum": value, **unseen_error()})


SUM_BOTH = (b1 - b3 * y1) ** 2 + (b2 - b3 * y2) ** 2
reads = reader(epsilon, alpha0, x2, z2, g, gz, x, w, SUM_BOTH=SUM_BOTH)

LIPSCHITZ = reads("norm(g - gz) < alpha0 norm(x2 - z2)")

ENTRIES = (
    at("Assumption 1, x", "65", "3.1", "the state stays within M")(
        reads("norm(x) < M"), state_is_bounded, "80 s of both examples, M = 10", known=Known.RUNS
    ),
    at("(13)", "66", "3.1", "g is Lipschitz in x2")(
        LIPSCHITZ,
        lipschitz,
        "at most, not less: at x2 = z2 it reads 0 < 0 (as scanned)",
        Verdict.MISPRINT,
        correction=weakened(LIPSCHITZ),
    ),
    at("Assumption 1, w", "66", "3.1", "w and its rate are bounded")(
        (), w_is_bounded, "80 s of (35), y1 alone", known=Known.RUNS
    ),
    at("(14)", "66", "3.1", "persistency of excitation")(
        (sp.GreaterThan(sp.Integral(w.T * w, (tau, t, t + rho)), beta, evaluate=False),),
        excitation,
        "w w^T at least beta I is meant: with y1 alone w^T w is a number, positive where a direction is never seen",
        Verdict.MISPRINT,
        correction={w.T * w: w * w.T, beta: beta * sp.Identity(n2)},
    ),
    at("(14) at each instant", "66", "3.1", "equivalent of (14), y1 and y2")(
        reads("SUM_BOTH > epsilon^2"),
        not_at_every_instant,
        "sufficient, not equivalent: a path through the FOE excites every window",
        Verdict.FALSE,
    ),
    at("centre", "66", "3.1", "centre of the circle: the FOE")(
        reads("o1 = b1 / b3; o2 = b2 / b3"), identities(circle(centre1, centre2))
    ),
    at("radius", "66", "3.1", "radius of the circle")(
        reads("r = epsilon / b3"),
        identities(circle(radius)),
        "|b3| in place of b3, which may be negative",
        Verdict.MISPRINT,
        correction={epsilon / b3: epsilon / sp.Abs(b3)},
    ),
    at("range at the FOE", "66", "3.1", "range at the FOE is lost")(
        (),
        range_at_the_foe,
        "it is for a point that stays there; second derivatives tell the range of one that passes",
        Verdict.DEPENDS,
    ),
    at("(17)", "66", "3.1", "observability, y1 and y2")(
        reads("lambda_min(w w^T) > epsilon; epsilon > 0"), an_instant_suffices(BOTH)
    ),
    at("(18)", "66", "3.1", "observability, y1 alone")(
        reads("lambda_min(w w^T) > epsilon; epsilon > 0"),
        an_instant_suffices(FIRST),
        "w w^T has rank 1, so that its smallest eigenvalue is 0: never fulfilled",
        Verdict.FALSE,
    ),
    at("(19)", "67", "3.1", "the same, written out")(
        reads("SUM_BOTH > 0; lambda_min([[abar^2, abar bbar], [abar bbar, bbar^2]]) > 0"),
        smallest_of_rank_one,
        "the second line is never fulfilled, see (18)",
        Verdict.FALSE,
    ),
    at("(20)", "67", "3.1", "the same, simplified")(
        reads("SUM_BOTH > 0; (b1 - b3 y1)^2 + (a12 - a32 y1)^2 > 0"),
        larger_of_rank_one,
        "the second sum is the larger eigenvalue; for a12 = b1 = 1, else 0, it is 2 and e2 - e3 stays",
        Verdict.FALSE,
    ),
)
