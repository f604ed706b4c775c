"""Ma, Chen and Moore 2005, the appendix: the identifier-based observer's error dynamics and proof of convergence.

Each line is judged by the lines that the paper states before it: (10) and the mended (11), then the error dynamics as
they are displayed, then (37).
"""

from __future__ import annotations

from functools import cache, partial

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from scipy.linalg import expm, solve_continuous_lyapunov

from percept_obs.observers.identifier_based import G
from percept_obs.papers.base import column, dot, explicit, identities, reader, vanishes, weakened
from percept_obs.papers.entries import Finding, Known, Printed, Values, Verdict, at, judged, not_checkable
from percept_obs.papers.ma2005_observers import IBO_IN_VECTORS, IBO_MENDED, OBSERVED, phi, x1, x2, xhat1, xhat2
from percept_obs.papers.ma2005_observers import ghat as ghat_of_11
from percept_obs.papers.ma2005_proofs import (
    A_,
    P_,
    V1,
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
    g,
    ghat,
    slope,
    w,
    wbar,
    xi,
    xi1,
    xi2,
)
from percept_obs.papers.scalars import Norm

Array = NDArray[np.float64]

TINY = 1e-9
"""Room for rounding."""

s, tau = sp.symbols("s tau", real=True)
d1, d2, d3, rho = sp.symbols("d1 d2 d3 rho", positive=True)
V1dot_ = sp.Function("Vdot1", real=True)
SIZES = ((1, 1), (2, 1), (1, 2))
"""n1 and n2: one of each, both outputs, one output."""

OVER_A_WINDOW = sp.Integral(V1dot_(tau), (tau, s, s + rho))
reads = reader(
    (A_, P_, alpha0, c1, c2, c3, c4, dxi1, dxi2, e1, e2, g, ghat, slope, w, wbar, xi, xi1, xi2, d1, d2, d3),
    OVER_A_WINDOW=OVER_A_WINDOW,
)

DISPLAY = reads("e1' = G A e1 + w^T e2; e2' = -G^2 w P e1 + g - ghat")
TRANSFORMATION = reads("xi1 = e1 / G; xi2 = e2 / G^2")
SCALES = tuple(explicit(line.rhs, {e1: column(1), e2: column(1)})[0] for line in TRANSFORMATION)


def letters(symbol: sp.MatrixSymbol, rows: int, columns: int = 1) -> sp.ImmutableMatrix:
    """A matrix or vector with letters as entries."""
    return sp.ImmutableMatrix(rows, columns, lambda i, j: sp.Symbol(f"{symbol.name}_{i + 1}{j + 1}", real=True))


@cache
def of_any_size(n1: int, n2: int) -> Values:
    """Letters for A, P, w and what is measured or hidden; w at the time s is w at the time t."""
    values = {m: letters(m, n1, n1) for m in (A_, P_)} | {w: letters(w, n2, n1), wbar: letters(w, n2, n1)}
    values |= {v: letters(v, n1) for v in (e1, xi1, phi, x1)}
    return values | {v: letters(v, n2) for v in (e2, xi2, g, ghat, x2)} | {ghat_of_11: letters(ghat, n2)}


def from_10_and_11(n1: int, n2: int) -> Values:
    """Rates of the errors: (10) less (11), mended so that it feeds back the other sign."""
    values = of_any_size(n1, n2)
    estimates = {xhat1: values[x1] - values[e1], xhat2: values[x2] - values[e2]}
    lines = zip((e1, e2), OBSERVED, IBO_IN_VECTORS, strict=False)
    put_in = values | estimates
    rates = {e: explicit(true.rhs, put_in) - explicit(est.rhs.xreplace(IBO_MENDED), put_in) for e, true, est in lines}
    return values | {dot(e): rate.applyfunc(sp.expand) for e, rate in rates.items()}


def from_the_display(n1: int, n2: int, rest: bool = True) -> Values:
    """Rates of xi in t and in s = G t, from the displayed error dynamics; with (25) when the rest is left out."""
    values = of_any_size(n1, n2) if rest else of_any_size(n1, n2) | {ghat: letters(g, n2)}
    errors = {e: values[x] / scale for e, x, scale in zip((e1, e2), (xi1, xi2), SCALES, strict=True)}
    rates = [explicit(line.rhs, values | errors) * scale for line, scale in zip(DISPLAY, SCALES, strict=True)]
    rates = [rate.applyfunc(sp.expand) for rate in rates]
    in_s = [(rate / G).applyfunc(sp.expand) for rate in rates]
    return values | dict(zip((dot(xi1), dot(xi2), dxi1, dxi2), (*rates, *in_s), strict=True))


def reduced(printed: Printed, A: Array, P: Array, W: Array) -> Array:
    """The matrix of (38), as it is printed, with numbers."""
    n2, n1 = W.shape
    state = of_any_size(n1, n2)
    values = state | {A_: sp.ImmutableMatrix(A), P_: sp.ImmutableMatrix(P), wbar: sp.ImmutableMatrix(W)}
    rate = column(*(entry for line in printed for entry in explicit(line.rhs, values)))
    return np.array(rate.jacobian(column(*state[xi1], *state[xi2])), dtype=float)


ONE = (np.array([[-1.0]]), np.array([[0.5]]), np.array([[1.0]]))
HURWITZ = np.array([[-1.0, 2.0], [0.0, -2.0]])
TWO = (HURWITZ, solve_continuous_lyapunov(HURWITZ.T, -np.eye(2)), np.array([[1.0, 2.0]]))
"""A Hurwitz, P > 0 from the Lyapunov equation with Q = I, and a w that (14) admits."""


def reduced_dynamics_are_stable(printed: Printed) -> Finding:
    """Eigenvalues of (38) with two pairs of a Hurwitz A and the P > 0 of its Lyapunov equation, all to the left."""
    largest = [float(np.linalg.eigvals(reduced(printed, *case)).real.max()) for case in (ONE, TWO)]
    names = ("largest real part for A = -1, P = 1/2", "for n1 = 2, Q = I")
    return judged(max(largest) < 0, numbers=dict(zip(names, largest, strict=True)))


def fulfilled(printed: Printed, constants: dict[sp.Symbol, float], along: list[dict[sp.Basic, float]]) -> bool:
    """Return True if inequalities hold for all of these errors."""
    return all(line.xreplace(constants).xreplace(at).doit() == sp.true for at in along for line in printed)


def errors_around() -> Array:
    """Errors xi of all directions and several sizes, zero among them, shape (K, 2)."""
    angles = np.linspace(0, np.pi, 19)
    return np.concatenate([size * np.stack([np.cos(angles), np.sin(angles)], axis=1) for size in (0, 0.1, 1, 10)])


def rate_of_V1(n1: int, n2: int) -> bool:
    """Return True if V1 = xi1^T P xi1 + |xi2|^2 has the rate xi1^T (A^T P + P A) xi1 along the mended (38)."""
    values = of_any_size(n1, n2) | {P_: letters(P_, n1, n1)}
    P = (values[P_] + values[P_].T) / 2
    rates = [explicit(line.rhs.xreplace({P_: -P_}), values | {P_: P}) for line in REDUCED]
    rate = 2 * (values[xi1].T * P * rates[0] + values[xi2].T * rates[1])[0]
    return vanishes(rate - (values[xi1].T * (values[A_].T * P + P * values[A_]) * values[xi1])[0])


def first_function(printed: Printed) -> Finding:
    """V1 = xi1^T P xi1 + |xi2|^2 along the mended (38), and its d1, d2, d3 for A = -1, P = 1/2, w = 1, rho = 2."""
    F = reduced(MENDED, *ONE)
    weight, fall = np.diag([0.5, 1.0]), np.diag([1.0, 0.0])
    whole = solve_continuous_lyapunov(F.T, -fall)
    gathered = whole - expm(F * 2).T @ whole @ expm(F * 2)
    constants = dict(zip((d1, d2, d3), (0.5, 1.0, float(np.linalg.eigvalsh(gathered)[0]) - TINY), strict=True))
    along = [
        {Norm(xi): float(np.linalg.norm(x)), V1: float(x @ weight @ x), dot(V1): -float(x @ fall @ x)}
        | {OVER_A_WINDOW: -float(x @ gathered @ x)}
        for x in errors_around()
    ]
    holds = all(rate_of_V1(*sizes) for sizes in SIZES) and constants[d3] > 0 and fulfilled(printed, constants, along)
    return judged(holds, numbers={str(name): value for name, value in constants.items()})


def second_function(printed: Printed) -> Finding:
    """V2 = xi^T S xi with F^T S + S F = -I for the mended (38), xi' = F xi, with its c1 to c4."""
    F = reduced(MENDED, *ONE)
    S = solve_continuous_lyapunov(F.T, -np.eye(2))
    least, largest = map(float, np.linalg.eigvalsh(S))
    constants = dict(zip((c1, c2, c3, c4), (least - TINY, largest + TINY, 1 - TINY, 2 * largest + TINY), strict=True))
    along = [
        {Norm(xi): float(np.linalg.norm(x)), V2: float(x @ S @ x), dot(V2): -float(x @ x)}
        | {Norm(slope): float(np.linalg.norm(2 * S @ x))}
        for x in errors_around()
    ]
    numbers = {str(name): value for name, value in constants.items()}
    return judged(constants[c1] > 0 and fulfilled(printed, constants, along), numbers=numbers)


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


LYAPUNOV_39 = reads("c1 norm(xi)^2 < V2; V2 < c2 norm(xi)^2; V2' < -c3 norm(xi)^2; norm(dV2) < c4 norm(xi)")
REDUCED = reads("dxi1 = A xi1 + wbar^T xi2; dxi2 = wbar P xi1")
MENDED = tuple(line.xreplace({P_: -P_}) for line in REDUCED)
V1_SANDWICH = reads("d1 norm(xi)^2 < V1; V1 < d2 norm(xi)^2")
V1_FALLS = reads("V1' <= 0; OVER_A_WINDOW <= -d3 norm(xi)^2")
SIGN_OF_P = "P with a minus sign, as in the error dynamics above: it is lost on the way from there"

ENTRIES = (
    at("error dynamics of the IBO", "73", "Appendix", "error dynamics from (10), (11)")(
        DISPLAY,
        identities(*(partial(from_10_and_11, *sizes) for sizes in SIZES)),
        "from the mended (11), which feeds back x1hat - x1; any A, P and w, for n1 + n2 = 2 and 3",
    ),
    at("xi = T e", "73", "Appendix", "new coordinates")(
        TRANSFORMATION,
        not_checkable,
        "(37), (38) and (40) are derived with it",
        Verdict.NOT_CHECKABLE,
        known=Known.DEFINITION,
    ),
    at("(37)", "73", "Appendix", "error dynamics in xi")(
        reads("xi1' = G (A xi1 + w^T xi2); xi2' = G w P xi1 + (g - ghat) / G^2"),
        identities(*(partial(from_the_display, *sizes) for sizes in SIZES)),
        SIGN_OF_P,
        Verdict.MISPRINT,
        correction={P_: -P_},
    ),
    at("(38)", "73", "Appendix", "the same with (25), in s = G t")(
        REDUCED,
        identities(*(partial(from_the_display, *sizes, rest=False) for sizes in SIZES)),
        SIGN_OF_P,
        Verdict.MISPRINT,
        correction={P_: -P_},
    ),
    at("(38) is stable", "73", "Appendix", "(38) is exponentially stable")(
        REDUCED,
        reduced_dynamics_are_stable,
        "with P's sign, see (37), it is: -1/2 +- i/2 for A = -1, P = 1/2, where the print has +0.366",
        Verdict.MISPRINT,
        correction={P_: -P_},
    ),
    at("V1 of the IBO", "73", "Appendix", "V1 decreases over a window")(
        (*V1_SANDWICH, *V1_FALLS),
        first_function,
        "at most, not less, at xi = 0; V1 = xi1^T P xi1 + |xi2|^2 follows from (38), d3 here for w = 1 and rho = 2",
        Verdict.MISPRINT,
        correction=weakened(V1_SANDWICH),
    ),
    at("(39)", "74", "Appendix", "a Lyapunov function of (38)")(
        LYAPUNOV_39,
        second_function,
        "at most, not less: see (30); V2 = xi^T S xi follows from (38), here for A = -1, P = 1/2 and w = 1",
        Verdict.MISPRINT,
        correction=weakened(LYAPUNOV_39),
    ),
    at("(40)", "74", "Appendix", "error dynamics in xi and s")(
        reads("dxi1 = A xi1 + wbar^T xi2; dxi2 = wbar P xi1 + (g - ghat) / G^3"),
        identities(*(partial(from_the_display, *sizes) for sizes in SIZES)),
        SIGN_OF_P,
        Verdict.MISPRINT,
        correction={P_: -P_},
    ),
    at("choice of G", "74", "Appendix", "rate of V2 along (40)")(
        reads("V2' <= (-c3 + c4 alpha0 / G) norm(xi)^2; G > c4 alpha0 / c3"),
        choice_of_gain,
        "given (39) and (13)",
    ),
)
