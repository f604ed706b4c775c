"""Ma, Chen and Moore 2005, section 3.3: the sliding mode observer's error dynamics and proof of convergence."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial

import numpy as np
import sympy as sp

from percept_obs.compile import vectorised
from percept_obs.observers import Observer, sliding_mode
from percept_obs.observers.parts import M, gamma, sigma2
from percept_obs.observers.sliding_mode import alpha, delta
from percept_obs.papers.base import (
    at_most,
    column,
    dot,
    equal,
    explicit,
    filled_in,
    identities,
    is_identity,
    reader,
    strict_at_zero,
    vanishes,
    vectors,
    weakened,
)
from percept_obs.papers.entries import Check, Finding, Known, Printed, Values, Verdict, at, judged
from percept_obs.papers.ma2005_observability import EXAMPLES, lipschitz_constant
from percept_obs.papers.scalars import Inner, Norm
from percept_obs.recording import Camera, record
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import pinhole
from percept_obs.tracking.following import track

SYSTEM = PerspectiveSystem(affine(), pinhole())
FORMS = (SYSTEM.measure("y1", "y2"), SYSTEM.measure("y1"), SYSTEM.measure("y2"))

# Numbers
lam, V1, V2, V2_at_24, V2_at_26, t, tau = sp.symbols("lambda V1 V2 V_24 V_26 t tau", real=True)
lambdabar, alphabar, lambdatilde, beta, window = sp.symbols("lambdabar alphabar lambdatilde beta delta", positive=True)
alpha0, c1, c2, c3, c4 = sp.symbols("alpha0 c1 c2 c3 c4", positive=True)
g_of_x, g_of_xhat = sp.symbols("g ghat", real=True)
e1_, e2_, w_, V1dot_ = (sp.Function(name, real=True) for name in ("e1", "e2", "w", "Vdot1"))

# Vectors and matrices
n1, n2, n = sp.symbols("n1 n2 n", integer=True, positive=True)
e1, xi1, dxi1 = vectors("e1 xi1 dxi1", n1)
e2, xi2, dxi2, x2, xhat2, g, ghat = vectors("e2 xi2 dxi2 x2 xhat2 g ghat", n2)
e, xi, slope = vectors("e xi dV2", n)
w, wbar = sp.MatrixSymbol("w", n2, n1), sp.MatrixSymbol("wbar", n2, n1)
A_, P_ = sp.MatrixSymbol("A", n1, n1), sp.MatrixSymbol("P", n1, n1)


def smallest_form() -> CanonicalForm:
    """The form with n1 = n2 = 1 and any w, phi and g(x2)."""
    p, q, slope_, rest = sp.symbols("p q w phi", real=True)
    rate = column(sp.Function("g", real=True)(q))
    return CanonicalForm((p,), (q,), (slope_, rest), (p, q), w=column(slope_), phi=column(rest), g=rate)


SMALL = smallest_form()


def with_g_left_out(form: CanonicalForm) -> CanonicalForm:
    """The form with g = 0, so that (25) is true."""
    return replace(form, g=sp.ImmutableMatrix.zeros(*form.g.shape))


def errors(observer: Observer) -> Values:
    """The error dynamics of an observer in vectors."""
    form = observer.form.canonical_form()
    letters = dict(zip(form.coordinates, observer.error, strict=True))
    parts = [[letters[s] for s in part] for part in (form.x1, form.x2)]
    rates = dict(zip(letters.values(), observer.error_dynamics().subs(sigma2, 0), strict=True))
    rate1, rate2 = (column(*(rates[letter] for letter in part)) for part in parts)
    estimated = {s: s - letters[s] for s in form.x2}
    ghat_ = form.g.subs(estimated, simultaneous=True)
    values = {e1: column(*parts[0]), e2: column(*parts[1]), dot(e1): rate1, dot(e2): rate2}
    return values | {w: form.w, g: form.g, ghat: ghat_}


@cache
def sliding(form: CanonicalForm) -> Values:
    """The sliding mode observer's error dynamics as its boundary layer vanishes, away from e1 = 0."""
    values = in_the_layer(form)
    # |e| = e / sgn(e)
    signs = {sp.Abs(error): error / sp.sign(error) for error in values[e1]}
    return {letter: value.subs(delta, 0).xreplace(signs) for letter, value in values.items()}


@cache
def in_the_layer(form: CanonicalForm) -> Values:
    """Values of the error letters with the boundary layer in place of the sign."""
    observer = sliding_mode(form)
    same = {s: lam for s in observer.equations.state if s.name.startswith("lambda")}
    return {letter: value.subs(same) for letter, value in errors(observer).items()}


def in_all_forms(derive: Callable[[CanonicalForm], Values], without_g: bool) -> list[Callable[[], Values]]:
    """One derivation for each choice of measured outputs."""
    forms = [with_g_left_out(form) if without_g else form for form in FORMS]
    return [partial(derive, form) for form in forms]


Dynamics = Callable[[CanonicalForm], Values]


def energy_rate(form: CanonicalForm, energy: sp.Expr, dynamics: Dynamics = sliding) -> tuple[Values, sp.Expr]:
    """The error dynamics (26) of a form, and the rate of an energy along them."""
    values = dynamics(with_g_left_out(form))
    worth = explicit(energy, values)
    pairs = zip((*values[e1], *values[e2]), (*values[dot(e1)], *values[dot(e2)]), strict=True)
    return values, sum(worth.diff(error) * rate for error, rate in pairs)


def energy_balance(printed: Printed) -> Finding:
    """(27): every line is the rate of the printed energy along (26)."""
    definition, *lines = printed
    squares = Inner(e1, e1), Inner(e2, e2)
    if definition.lhs != V1 or not definition.rhs.atoms(Inner) <= set(squares):
        return judged(False)
    rates = (energy_rate(form, definition.rhs) for form in FORMS)
    return judged(all(is_identity(line, values | {dot(V1): rate}) for values, rate in rates for line in lines))


def first_element(printed: Printed) -> Finding:
    """The rate of V1 along the dynamics with the boundary layer, with each single output."""
    rates = (energy_rate(form, ENERGY.rhs, in_the_layer) for form in FORMS[1:])
    return judged(all(is_identity(line, values | {dot(V1): rate}) for values, rate in rates for line in printed))


def can_grow(dynamics: Dynamics) -> Check:
    """Check (28) at e1 = 0.01, e2 = -1, w = 1."""

    def check(printed: Printed) -> Finding:
        """At e1 = 0.01, e2 = -1, w = 1 the energy grows, and the faster the larger alpha and lambda are."""
        values, rate = energy_rate(SMALL, ENERGY.rhs, dynamics)
        numbers, refuted = {}, []
        for gain in (5, 50, 500):
            at = dict(zip((*values[e1], *values[e2], *SMALL.w), (sp.Rational(1, 100), -1, 1), strict=True))
            at |= {alpha: gain, lam: gain, delta: sp.Rational(1, 5)}
            growth = rate.subs(at)
            here = {dot(V1): growth} | {letter: values[letter].subs(at) for letter in (e1, e2, w)}
            refuted.append(explicit(sp.And(*printed), here) == sp.false)
            numbers[f"dV1/dt, alpha = lambda = {gain}"] = float(growth)
        return judged(not all(refuted), Verdict.FALSE, numbers)

    return check


def where_g_is_the_same(printed: Printed) -> Finding:
    """Conditions on the coefficients of (4), with both outputs, for g not to depend on x2."""
    (line,) = printed
    values = sliding(FORMS[0])
    needed = sp.Poly((values[g] - values[ghat])[0], *FORMS[0].coordinates, *values[e2]).coeffs()
    zero = dict.fromkeys(SYSTEM.motion.A[2, :], sp.S.Zero) | {SYSTEM.motion.b[2]: sp.S.Zero}
    same = filled_in(line.lhs, {letter: value.xreplace(zero) for letter, value in values.items()})
    just_these = set().union(*(c.free_symbols for c in needed)) == set(zero)
    numbers = {"coefficients of the difference, none of which may be left": len(needed)}
    return Finding(
        Verdict.DEPENDS if just_these and same is not None and same.is_zero_matrix else Verdict.FALSE, numbers
    )


def stable_nearby(printed: Printed) -> Finding:
    """(26) for n1 = n2 = 1, w = 1, alpha = 5, lambda = 1: the rate of e2 on e1 = 0, and the largest there is."""
    values = sliding(SMALL)
    listed = {SMALL.w[0]: 1, alpha: 5, lam: 1}
    on_the_surface = (values[dot(e2)] - alpha * SMALL.w * values[dot(e1)])[0] - (values[g] - values[ghat])[0]
    rate = (on_the_surface.expand() / values[e2][0]).subs(listed)
    fastest = abs((values[dot(e2)] - values[g] + values[ghat])[0].subs(listed).subs(values[e1][0], 1))
    numbers = {"rate of e2 on e1 = 0, |e2| < lambda, in 1/s": float(rate)}
    numbers |= {f"e2 = {size} needs to halve, in s, at least": float(size / 2 / fastest) for size in (10, 100)}
    return Finding(Verdict.DEPENDS if rate < 0 < fastest else Verdict.FALSE, numbers)


def constants_are_given(printed: Printed) -> Finding:
    """Return True if (35) admits it: on e1 = 0, e2' = -alpha |w|^2 e2, so (30) asks c3 / c4 <= alpha |w|^2."""
    recording = EXAMPLES[0].coordinates(np.arange(0, EXAMPLES[0].duration, 0.01))
    squares = vectorised(SYSTEM.coordinates, [FORMS[0].w.norm()], EXAMPLES[0].motion.values)(*recording.T)[0] ** 2
    least, listed = float(squares.min()), float(sliding_mode(FORMS[0]).gain_values[alpha])
    wanted = lipschitz_constant(FORMS[0])
    numbers = {"alpha0 of (35), y1 and y2": wanted, "c3 / c4 at most, alpha = 5": listed * least}
    enough = listed * least > wanted
    return Finding(Verdict.HOLDS if enough else Verdict.DEPENDS, numbers | {"alpha needed": wanted / least})


def rate_is_bounded(printed: Printed) -> Finding:
    """Largest |e1'| = |w^T e2 - s| of the SMO in the runs on both examples, and |w| (1 + gamma) M + lambda for each."""
    numbers: dict[str, float] = {}
    kept = []
    for name, example in zip(("(35)", "(36)"), EXAMPLES, strict=True):
        run = track(record(example, camera=Camera(0.01)), sliding_mode(FORMS[0]), [0, 0, 0])
        w_ = np.stack(vectorised(SYSTEM.coordinates, list(FORMS[0].w), example.motion.values)(*run.truth.T))
        gains, grown = run.observer.gain_values, run.state[:, 3:]
        pull = grown * run.error[:, :2] / (np.abs(run.error[:, :2]) + gains[delta])
        largest = float(np.linalg.norm(w_.T * run.error[:, 2:] - pull, axis=1).max())
        edge = np.linalg.norm(w_, axis=0).max() * (1 + gains[gamma]) * gains[M] + np.linalg.norm(grown.max(axis=0))
        kept.append(largest <= edge)
        numbers |= {f"largest |e1'| on {name}": largest, f"its bound on {name}": float(edge)}
    return judged(all(kept), Verdict.FALSE, numbers)


def energy_over_a_window(printed: Printed) -> Finding:
    """(29): the chain along the sliding motion e1 = 0 of (26), with w = alpha = 1, over 2 s."""
    values, _ = energy_rate(SMALL, ENERGY.rhs)
    # On e1 = 0 the switching term equals w^T e2; this combination is free of it.
    left = (values[dot(e2)] - alpha * SMALL.w * values[dot(e1)])[0].expand()
    decay = left.subs(alpha, 1).subs(SMALL.w[0], 1) / values[e2][0]
    hidden = sp.exp(decay * tau)
    path = {e1_: sp.S.Zero, e2_: hidden, w_: sp.S.One, V1dot_: sp.diff(hidden**2 / 2, tau)}
    excited = sp.integrate(path[w_] ** 2, (tau, 0, 2))
    constants = {t: 0, window: 2, beta: excited, lambdabar: 1, alphabar: 1}

    def worth(side: sp.Expr) -> float:
        for function, value in path.items():
            side = side.replace(function, sp.Lambda(tau, value))
        return float(side.subs(constants).doit())

    names = ("integral of dV1/dt", "first line", "second line", "its right side")
    members = [worth(printed[0].lhs), *(worth(line.rhs) for line in printed[:3])]
    left_side, first, second, right = members
    chain = left_side <= first + 1e-9 and first <= second + 1e-9 and abs(second - right) < 1e-9
    return judged(chain, Verdict.FALSE, dict(zip(names, members, strict=True)))


def perturbed_energy(printed: Printed) -> Finding:
    """(31) for n1 = n2 = 1: the first line against the chain rule, the others against (30) and (13)."""
    first, second, third = printed
    v1, v2, change = sp.symbols("v1 v2 c", real=True)
    # (24) less (26) is the change of g, in the hidden part only.
    full, reduced = sliding(SMALL), sliding(with_g_left_out(SMALL))
    increment = (full[dot(e2)] - reduced[dot(e2)])[0] - (full[g] - full[ghat])[0]
    by_chain_rule = vanishes(increment) and full[dot(e1)] == reduced[dot(e1)]
    here = {slope: column(v1, v2), V2_at_24: V2_at_26 + v2 * change, g_of_x - g_of_xhat: change}
    left, right = explicit(first.lhs, here), explicit(first.rhs, here)
    if isinstance(first, sp.Eq):
        holds = vanishes(right - left)
    else:
        # s |c| is at least v2 c if the difference of the squares is not negative.
        enough = right - V2_at_26
        holds = bool(sp.expand(enough**2 - (v2 * change) ** 2).is_nonnegative)
    bounds = {
        V2_at_26: -c3 * Norm(e) ** 2,
        Norm(slope): c4 * Norm(e),
        sp.Abs(g_of_x - g_of_xhat): alpha0 * Norm(x2 - xhat2),
        g_of_x - g_of_xhat: alpha0 * Norm(x2 - xhat2),
    }
    holds = holds and vanishes(second.rhs - first.rhs.xreplace(bounds))
    # The hidden error is at most the whole one.
    holds = holds and vanishes(third.rhs - second.rhs.xreplace({Norm(x2 - xhat2): Norm(e)}))
    at = {v1: 3, v2: 4, change: 1, V2_at_26: 0}
    return judged(by_chain_rule and holds, numbers={"left": float(left.subs(at)), "right": float(right.subs(at))})


def lyapunov_function(printed: Printed) -> Finding:
    """(30) and (39): strict inequalities contradict each other where all norms are zero; the rest is cited."""
    zero = {Norm(vector): sp.S.Zero for vector in (e, xi, slope)} | {dot(V2): sp.S.Zero}
    return Finding(Verdict.MISPRINT if strict_at_zero(printed, zero) else Verdict.NOT_CHECKABLE)


INTEGRAL = (tau, t, t + window)
E1_SQUARED, SEEN_SQUARED, E2_SQUARED = (
    sp.Integral(square, INTEGRAL) for square in (e1_(tau) ** 2, (w_(tau) * e2_(tau)) ** 2, e2_(tau) ** 2)
)
AT_THE_END = -(lambdabar * e1_(t) ** 2 + alphabar * beta * e2_(t) ** 2)
reads = reader(
    (lambdabar, alphabar, beta, alpha0, c1, c2, c3, c4, e1, e2, x2, xhat2, g, ghat, e, slope, w),
    E1_SQUARED=E1_SQUARED,
    SEEN_SQUARED=SEEN_SQUARED,
    E2_SQUARED=E2_SQUARED,
    AT_THE_END=AT_THE_END,
)
(ENERGY,) = reads("V1 = (inner(e1, e1) + inner(e2, e2)) / 2")
LYAPUNOV_30 = reads("c1 norm(e)^2 < V2; V2 < c2 norm(e)^2; V2' < -c3 norm(e)^2; norm(dV2) < c4 norm(e)")
PERTURBED = equal(V2_at_24, V2_at_26 + Norm(slope) * (g_of_x - g_of_xhat))
DECREASE = reads(
    """V1' <= -lambdabar norm(e1)^2 - alphabar norm(w^T e2)^2;
    -lambdabar norm(e1)^2 - alphabar norm(w^T e2)^2 <= 0"""
)

ENTRIES = (
    at("(24)", "68", "3.3", "error dynamics of the SMO with sgn")(
        reads("e1' = -lambda signs(e1) + w^T e2; e2' = -alpha lambda w signs(e1) + g - ghat"),
        identities(*in_all_forms(sliding, without_g=False)),
        "limit of the package's boundary layer",
    ),
    at("(25)", "68", "3.3", "g does not depend on x2")(
        (equal(g - ghat, sp.ZeroMatrix(n2, 1)),),
        where_g_is_the_same,
        "an assumption on the way, dropped again in (31); of (4) with y1 and y2 it is true just if a31 ="
        " a32 = a33 = b3 = 0",
        Verdict.DEPENDS,
    ),
    at("(26)", "68", "3.3", "(24) with (25)")(
        reads("e1' = -lambda signs(e1) + w^T e2; e2' = -alpha lambda w signs(e1)"),
        identities(*in_all_forms(sliding, without_g=True)),
    ),
    at("(27)", "68", "3.3", "rate of V1 = (e1^2 + e2^2)/2")(
        (
            ENERGY,
            *reads(
                """V1' = inner(e1, e1') + inner(e2, e2');
            V1' = -lambda inner(e1, signs(e1)) + inner(e1, w^T e2) - alpha lambda inner(e2, w signs(e1));
            V1' = -lambda norm1(e1) + inner(e2, w (e1 + alpha (e1' - w^T e2)));
            V1' = -lambda norm1(e1) - alpha norm(w^T e2)^2 + inner(e2, w (e1 + alpha e1'))"""
            ),
        ),
        energy_balance,
        "with the sum of absolute values as the norm of e1",
    ),
    at("(28)", "68", "3.3", "V1 decreases for large alpha, lambda")(
        DECREASE,
        can_grow(sliding),
        "near e1 = 0 with e1 w^T e2 < 0 the rate of V1 is about alpha lambda |w^T e2| > 0",
        Verdict.FALSE,
    ),
    at("(29)", "68", "3.3", "V1 decreases over a window")(
        (
            at_most(sp.Integral(V1dot_(tau), INTEGRAL), -(lambdabar * E1_SQUARED + alphabar * SEEN_SQUARED)),
            *reads(
                """-(lambdabar E1_SQUARED + alphabar SEEN_SQUARED)
                <= -(lambdabar E1_SQUARED + alphabar beta E2_SQUARED);
            -(lambdabar E1_SQUARED + alphabar beta E2_SQUARED) = AT_THE_END"""
            ),
            at_most(AT_THE_END, -lambdatilde * (e1_(t) ** 2 + e2_(t) ** 2) / 2),
        ),
        energy_over_a_window,
        "beta times the integral of |e2|^2 is no bound for that of |w^T e2|^2, nor is an integral an end value",
        Verdict.FALSE,
    ),
    at("(30)", "68", "3.3", "a Lyapunov function of (26)")(
        LYAPUNOV_30,
        lyapunov_function,
        "at most, not less: at e = 0 they contradict each other (as scanned); existence is cited",
        Verdict.MISPRINT,
        correction=weakened(LYAPUNOV_30),
    ),
    at("(31)", "68", "3.3", "its rate along (24)")(
        (
            PERTURBED,
            *reads("V_24 <= -c3 norm(e)^2 + c4 norm(e) alpha0 norm(x2 - xhat2); V_24 <= -(c3 - c4 alpha0) norm(e)^2"),
        ),
        perturbed_energy,
        "first line: at most, with the norm of the difference of g (read for n1 = n2 = 1)",
        Verdict.MISPRINT,
        correction={PERTURBED: at_most(V2_at_24, V2_at_26 + Norm(slope) * sp.Abs(g_of_x - g_of_xhat))},
    ),
    at("e1' is bounded", "68", "3.3", "e1, e2 and the rate of e1 are bounded")(
        (), rate_is_bounded, "80 s of both examples with y1 and y2, no noise; lambda grows as in (22)", known=Known.RUNS
    ),
    at("(26) is stable", "68", "3.3", "(26) is exponentially stable, by (28), (29)")(
        (),
        stable_nearby,
        "near 0, where e1 = 0 is kept; from far away e2 cannot fall faster than alpha lambda |w|; (28), (29) are false",
        Verdict.DEPENDS,
        asks=lambda: (equal(dot(e2), -alpha * w * w.T * e2),),
    ),
    at("c3 > c4 alpha0", "68", "3.3", "c3 can be chosen so that (24) is stable")(
        reads("c3 > c4 alpha0"),
        constants_are_given,
        "c3 and c4 come with V2 and are not chosen; with the listed alpha there is no such V2 on (35)",
        Verdict.DEPENDS,
    ),
    at("(27) with the boundary layer", "68", "3.3", "its first element with e1/(|e1| + delta)")(
        reads(
            """V1' = -lambda inner(e1, e1) / (norm(e1) + delta) + inner(e1, w^T e2) - alpha lambda inner(e2, w e1) /
            (norm(e1) + delta)"""
        ),
        first_element,
        "for one output; with two, each entry has its own absolute value in the place of the norm",
    ),
    at("(28) with the boundary layer", "69", "3.3", "(28) is true for large alpha, lambda again")(
        DECREASE,
        can_grow(in_the_layer),
        "as without it: where e1 w^T e2 < 0 the rate of V1 is about alpha lambda |w^T e2 e1| / (|e1| + delta) > 0",
        Verdict.FALSE,
    ),
)
