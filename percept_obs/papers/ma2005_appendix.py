"""Ma, Chen and Moore 2005, the appendix: the identifier-based observer's error dynamics and proof of convergence."""

from __future__ import annotations

from functools import cache

import sympy as sp

from percept_obs.observers import identifier_based
from percept_obs.observers.identifier_based import G
from percept_obs.papers.base import (
    Entry,
    Finding,
    Norm,
    Printed,
    Values,
    Verdict,
    at_most,
    column,
    dot,
    equal,
    explicit,
    identities,
    judged,
    less,
    not_checkable,
    vanishes,
    weakened,
)
from percept_obs.papers.ma2005_proofs import (
    A_,
    P_,
    V2,
    alpha0,
    c1,
    c2,
    c3,
    c4,
    dxi1,
    dxi2,
    e1,
    e2,
    errors,
    g,
    ghat,
    in_all_forms,
    lyapunov_function,
    slope,
    w,
    wbar,
    xi,
    xi1,
    xi2,
)
from percept_obs.system.forms import CanonicalForm

TRANSFORMATION = (equal(xi1, e1 / G), equal(xi2, e2 / G**2))
SCALES = tuple(explicit(line.rhs, {e1: column(1), e2: column(1)})[0] for line in TRANSFORMATION)


@cache
def identifying(form: CanonicalForm) -> Values:
    """The identifier-based observer's error dynamics."""
    return errors(identifier_based(form))


@cache
def scaled(form: CanonicalForm) -> Values:
    """The same in the coordinates xi, which the paper defines."""
    return errors(identifier_based(form), SCALES)


def reduced_dynamics_are_stable(printed: Printed) -> Finding:
    """(38) for n1 = n2 = 1 and w = 1, which (14) admits: with Hurwitz A and P > 0, and as section 4 lists A, P."""
    state = column(*sp.symbols("p q", real=True))
    numbers = {}
    for a, p in ((-1, sp.Rational(1, 2)), (1, -sp.Rational(1, 2))):
        values = {A_: column(a), P_: column(p), wbar: column(1), xi1: state[:1, :], xi2: state[1:, :]}
        rate = column(*(explicit(line.rhs, values)[0] for line in printed))
        largest = max(sp.re(value) for value in rate.jacobian(state).eigenvals(multiple=True))
        numbers[f"largest real part for A = {a}, P = {p}"] = float(largest)
    return judged(min(numbers.values()) < 0, Verdict.FALSE, numbers)


def choice_of_gain(printed: Printed) -> Finding:
    """The rate of V2 along (40) with the bounds (39) and (13), and the gain at which it changes sign."""
    bound, choice = printed
    size = sp.Symbol("r", positive=True)
    # g enters (40) times scale2 / G; (13) bounds its change by alpha0 |e2|, and e2 = xi2 / scale2.
    change = (SCALES[1] / G) * alpha0 * (size / SCALES[1])
    derived = -c3 * size**2 + c4 * size * change
    same = isinstance(bound, sp.LessThan) and vanishes(bound.rhs.xreplace({Norm(xi): size}) - derived)
    turns = isinstance(choice, sp.StrictGreaterThan) and vanishes(derived.subs(G, choice.rhs))
    return judged(same and turns and (bound.lhs, choice.lhs) == (dot(V2), G))


LYAPUNOV_39 = (
    less(c1 * Norm(xi) ** 2, V2),
    less(V2, c2 * Norm(xi) ** 2),
    less(dot(V2), -c3 * Norm(xi) ** 2),
    less(Norm(slope), c4 * Norm(xi)),
)
REDUCED = (equal(dxi1, A_ * xi1 + wbar.T * xi2), equal(dxi2, wbar * P_ * xi1))
SIGN_OF_A = "from (10) and (11) A has a minus sign; with A = 1, P = -1/2 in place of Hurwitz A, P > 0"

ENTRIES = (
    Entry(
        "error dynamics of the IBO",
        "73",
        "Appendix",
        "error dynamics from (10), (11)",
        (
            equal(dot(e1), G * A_ * e1 + w.T * e2),
            equal(dot(e2), -(G**2) * w * P_ * e1 + g - ghat),
        ),
        identities(*in_all_forms(identifying, without_g=False)),
        Verdict.MISPRINT,
        "(10) and (11) give the opposite signs of A and P; these would follow from x1hat - x1 in (11)",
        {A_: -A_, P_: -P_},
    ),
    Entry(
        "xi = T e",
        "73",
        "Appendix",
        "new coordinates",
        TRANSFORMATION,
        not_checkable,
        Verdict.NOT_CHECKABLE,
        "a definition; (37), (38) and (40) are derived with it",
    ),
    Entry(
        "(37)",
        "73",
        "Appendix",
        "error dynamics in xi",
        (
            equal(dot(xi1), G * (A_ * xi1 + w.T * xi2)),
            equal(dot(xi2), G * w * P_ * xi1 + (g - ghat) / G**2),
        ),
        identities(*in_all_forms(scaled, without_g=False)),
        Verdict.MISPRINT,
        SIGN_OF_A,
        {A_: -A_},
    ),
    Entry(
        "(38)",
        "73",
        "Appendix",
        "the same with (25), in s = G t",
        REDUCED,
        identities(*in_all_forms(scaled, without_g=True)),
        Verdict.MISPRINT,
        "sign of A, see (37)",
        {A_: -A_},
    ),
    Entry(
        "(38) is stable",
        "73",
        "Appendix",
        "(38) is exponentially stable",
        REDUCED,
        reduced_dynamics_are_stable,
        Verdict.FALSE,
        "as printed for neither; with the corrected sign for A = 1, P = -1/2",
    ),
    Entry(
        "V1 of the IBO",
        "73",
        "Appendix",
        "V1 decreases over a window",
        (),
        not_checkable,
        Verdict.NOT_CHECKABLE,
        "cites Morgan and Narendra (1977), theorem 2",
    ),
    Entry(
        "(39)",
        "74",
        "Appendix",
        "a Lyapunov function of (38)",
        LYAPUNOV_39,
        lyapunov_function,
        Verdict.MISPRINT,
        "at most, not less: see (30); existence is cited, and needs a stable (38)",
        weakened(LYAPUNOV_39),
    ),
    Entry(
        "(40)",
        "74",
        "Appendix",
        "error dynamics in xi and s",
        (equal(dxi1, A_ * xi1 + wbar.T * xi2), equal(dxi2, wbar * P_ * xi1 + (g - ghat) / G**3)),
        identities(*in_all_forms(scaled, without_g=False)),
        Verdict.MISPRINT,
        "sign of A, see (37)",
        {A_: -A_},
    ),
    Entry(
        "choice of G",
        "74",
        "Appendix",
        "rate of V2 along (40)",
        (
            at_most(dot(V2), (-c3 + c4 * alpha0 / G) * Norm(xi) ** 2),
            sp.StrictGreaterThan(G, c4 * alpha0 / c3, evaluate=False),
        ),
        choice_of_gain,
        Verdict.HOLDS,
        "given (39) and (13)",
    ),
)
