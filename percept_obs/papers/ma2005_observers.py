"""Ma, Chen and Moore 2005, sections 3.1 and 3.2: the observers, in vectors and coordinate by coordinate."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial

import sympy as sp

from percept_obs.observers import Observer, identifier_based, sliding_mode
from percept_obs.observers.identifier_based import A, G, P
from percept_obs.observers.parts import M, gamma, hats, sigma2
from percept_obs.observers.sliding_mode import alpha, alpha1, delta
from percept_obs.papers.base import column, dot, equal, explicit, identities, is_identity, reader, vanishes, vectors
from percept_obs.papers.entries import Finding, Known, Printed, Values, Verdict, at, judged
from percept_obs.papers.scalars import Norm
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import pinhole

SYSTEM = PerspectiveSystem(affine(), pinhole())
BOTH, FIRST, SECOND = SYSTEM.measure("y1", "y2"), SYSTEM.measure("y1"), SYSTEM.measure("y2")
OBSERVERS: dict[str, Callable[..., Observer]] = {"IBO": identifier_based, "SMO": sliding_mode}

# Numbers
a11, a12, a13, a21, a22, a23, a31, a32, a33, b1, b2, b3 = SYSTEM.motion.parameters
y1, y2, y3 = SYSTEM.coordinates
yhat1, yhat2, yhat3 = hats(SYSTEM.coordinates)
e1, e2, e3 = identifier_based(BOTH).error
f1, f2, fhat1, fhat2 = sp.symbols("f1 f2 fhat1 fhat2", real=True)
alphatilde, alpha2, delta1, delta2 = sp.symbols("alphatilde alpha2 delta1 delta2", real=True)
lambda1, lambda2 = sp.symbols("lambda1 lambda2", real=True)

# Vectors and matrices
n1, n2, n = sp.symbols("n1 n2 n", integer=True, positive=True)
x1, xhat1, y, phi = vectors("x1 xhat1 y phi", n1)
x2, xhat2, g, ghat = vectors("x2 xhat2 g ghat", n2)
xhat, xhat_plus = vectors("xhat xhatplus", n)
w = sp.MatrixSymbol("w", n2, n1)
A_, P_ = sp.MatrixSymbol("A", n1, n1), sp.MatrixSymbol("P", n1, n1)


def after_reset(symbol: sp.Symbol) -> sp.Symbol:
    """The symbol of an estimate just after a reset."""
    return sp.Symbol(symbol.name.replace("hat", "hatplus"), real=True)


RATES = dict(zip(SYSTEM.coordinates, SYSTEM.rate, strict=True))


@cache
def in_vectors(form: CanonicalForm) -> Values:
    """Values of the vectors of (10) and (11) in a form."""
    equations = identifier_based(form).equations
    k = len(form.x1)
    state, flow = column(*equations.state), column(*equations.flow).subs(sigma2, 0)
    return {
        x1: column(*form.x1),
        x2: column(*form.x2),
        y: column(*(s for s in form.coordinates if s.name in form.measured)),
        dot(x1): column(*(RATES[s] for s in form.x1)),
        dot(x2): column(*(RATES[s] for s in form.x2)),
        w: form.w,
        phi: form.phi,
        g: form.g,
        ghat: form.g.xreplace(dict(zip(form.x2, hats(form.x2), strict=True))),
        xhat: state,
        xhat1: state[:k, :],
        xhat2: state[k:, :],
        dot(xhat1): flow[:k, :],
        dot(xhat2): flow[k:, :],
        xhat_plus: column(*equations.reset),
        A_: sp.ImmutableMatrix(A * sp.eye(k)),
        P_: sp.ImmutableMatrix(P * sp.eye(k)),
    }


@cache
def in_coordinates(name: str, form: CanonicalForm) -> Values:
    """Flow and reset of an observer, coordinate by coordinate."""
    equations = OBSERVERS[name](form).equations
    flow = [entry.subs(sigma2, 0) for entry in equations.flow]
    # The package gives all outputs the same delta and alpha1; in print they carry the output's index.
    for k, (output, estimate) in enumerate(zip(form.x1, hats(form.x1), strict=True)):
        size, own = sp.Abs(output - estimate), {delta: (delta1, delta2)[k], alpha1: (alpha1, alpha2)[k]}
        flow = [entry.xreplace({size + delta: size + own[delta]}) for entry in flow]
        if name == "SMO":
            flow[len(form.coordinates) + k] = flow[len(form.coordinates) + k].xreplace(own)
    unknown = dict(zip(form.x2, hats(form.x2), strict=True))
    return {
        **{dot(s): entry for s, entry in zip(equations.state, flow, strict=True)},
        **{after_reset(s): entry for s, entry in zip(equations.state, equations.reset, strict=True)},
        **{line.lhs: line.rhs for line in ERRORS},
        alphatilde: RATES[y2].xreplace(unknown),
    }


def with_the_sign_of(form: CanonicalForm) -> Values:
    """The mended (11), coordinate by coordinate: the package's observer, whose A and P have the opposite signs."""
    return {s: value.xreplace({A: -A, P: -P}) for s, value in in_coordinates("IBO", form).items()}


def range_terms() -> Values:
    """The parts of the rates that carry y3, and their estimates by that of y3."""
    carrying = zip((f1, f2, fhat1, fhat2), (*BOTH.w.T * y3, *BOTH.w.T * yhat3), strict=True)
    return dict(carrying)


@cache
def error_rates() -> tuple[sp.ImmutableMatrix, sp.ImmutableMatrix]:
    """The IBO's error dynamics in terms of the errors, and as true rate less estimated rate."""
    observer = identifier_based(BOTH)
    difference = column(*BOTH.rate) - column(*observer.equations.flow)
    return observer.error_dynamics().subs(sigma2, 0), difference.subs(sigma2, 0)


def error_is_the_package_s(printed: Printed) -> Finding:
    """With the printed errors put in, the package's error dynamics are true rate less estimated rate."""
    dynamics, rate = error_rates()
    derived = dynamics.subs({line.lhs: line.rhs for line in printed}, simultaneous=True)
    return judged(all(map(vanishes, derived - rate)))


def feeds_back(printed: Printed) -> Finding:
    """(11): the package's flow but for the signs of A and P, and whether Hurwitz A and P > 0 make it stable."""
    as_typed = [in_vectors(form) for form in (FIRST, BOTH)]
    reversed_ = [values | {A_: -values[A_], P_: -values[P_]} for values in as_typed]
    same = any(all(is_identity(line, v) for line in printed for v in vs) for vs in (as_typed, reversed_))
    # The smallest case decides: n1 = n2 = 1, w = 1, phi = g = 0, A = -1, P = 1/2, so that Q = 1.
    one, truth, estimate, error = column(1), column(y1, y2), column(yhat1, yhat2), column(e1, e2)
    small = {w: one, phi: 0 * one, ghat: 0 * one, G: sp.Integer(10), A_: -one, P_: one / 2}
    small |= dict(zip((x1, x2, xhat1, xhat2), map(column, (*truth, *estimate)), strict=True))
    estimated = column(*(explicit(line.rhs, small)[0] for line in printed[:2]))
    true = column(y2, 0)
    rate = (true - estimated).subs(dict(zip(estimate, truth - error, strict=True)))
    largest = max(float(sp.re(value)) for value in rate.jacobian(error).eigenvals(multiple=True))
    return judged(same and largest < 0, numbers={"largest real part for A = -1, P = 1/2": largest})


def reset_condition(printed: Printed) -> Finding:
    """(12): the package compares the squares of both sides, neither of which is negative."""
    (line,) = printed
    equations = identifier_based(FIRST).equations
    positive = {s: sp.Symbol(s.name, positive=True) for s in (M, gamma)}
    pairs = zip(line.args, equations.reset_condition.args, strict=True)
    sides = [explicit(side, {xhat: column(*equations.state)}) - sp.sqrt(square) for side, square in pairs]
    same = all(vanishes(side.xreplace(positive)) for side in sides)
    return judged(same and isinstance(line, sp.GreaterThan))


def reset_leads_out(printed: Printed) -> Finding:
    """A reset leads out of its own condition for just the ratios that the print admits."""
    (line,) = printed
    equations = identifier_based(FIRST).equations
    reset = dict(zip(equations.state, equations.reset, strict=True))
    square, bound = equations.reset_condition.args
    square = sp.cancel(square.subs(reset, simultaneous=True))
    ratios = [sp.Rational(k, 100) for k in (50, 99, 100, 101, 200)]
    out = [(square >= bound).subs({gamma: ratio, M: 10}) == sp.false for ratio in ratios]
    return judged([line.subs(gamma, ratio) == sp.true for ratio in ratios] == out, Verdict.FALSE)


def switching_term(printed: Printed) -> Finding:
    """Remark 1: the package's switching term, and its limit on both sides of zero."""
    (line,) = printed
    values = in_coordinates("SMO", FIRST)
    same = vanishes(line.lhs.args[0].xreplace(values) - values[dot(yhat1)].coeff(lambda1))
    limits = (line.lhs.subs(e1, value).doit() - line.rhs.subs(e1, value) for value in (-2, 3))
    return judged(same and all(map(vanishes, limits)))


def reset(*estimates: sp.Symbol) -> sp.Eq:
    """The last line of each observer."""
    return equal(column(*map(after_reset, estimates)), M * column(*estimates) / Norm(column(*estimates)))


# Terms that two observers share in print.
W_BOTH, W_FIRST = column(b1 - b3 * y1, b2 - b3 * y2), column(a12 - a32 * y1, b1 - b3 * y1)
PHI_BOTH = (
    column(a13 + (a11 - a33) * y1 + a12 * y2, a23 + a21 * y1 + (a22 - a33) * y2)
    - column(a31 * y1**2 + a32 * y1 * y2, a31 * y1 * y2 + a32 * y2**2)
)  # fmt: skip
PHI_FIRST = a13 + (a11 - a33) * y1 - a31 * y1**2
G_BOTH = -(a31 * y1 + a32 * y2 + a33) * yhat3 - b3 * yhat3**2
G_FIRST = column(alphatilde, -(a31 * y1 + a32 * yhat2 + a33) * yhat3 - b3 * yhat3**2)
S1, S2 = lambda1 * e1 / (sp.Abs(e1) + delta1), lambda2 * e2 / (sp.Abs(e2) + delta2)
reads = reader(
    (x1, xhat1, y, phi, x2, xhat2, g, ghat, xhat, xhat_plus, w, A_, P_),
    W_BOTH=W_BOTH,
    W_FIRST=W_FIRST,
    PHI_BOTH=PHI_BOTH,
    G_FIRST=G_FIRST,
    S1=S1,
    S2=S2,
)
(ALPHATILDE,) = reads(
    "alphatilde = a23 + a21 y1 + (a22 - a33) yhat2 - a31 y1 yhat2 - a32 yhat2^2 + (b2 - b3 yhat2) yhat3"
)
ERRORS = reads("e1 = y1 - yhat1; e2 = y2 - yhat2; e3 = y3 - yhat3")
OBSERVED = reads("x1' = w^T x2 + phi; x2' = g")
IBO_IN_VECTORS = reads("xhat1' = G A (x1 - xhat1) + w^T xhat2 + phi; xhat2' = -G^2 w P (x1 - xhat1) + ghat")
IBO_MENDED: Values = {x1 - xhat1: xhat1 - x1}
RESET = reset(yhat1, yhat2, yhat3)

ENTRIES = (
    at("f1, f2", "65", "3", "what the RIO estimates first")(
        reads("f1 = (b1 - b3 y1) y3; f2 = (b1 - b3 y2) y3"),
        identities(range_terms),
        "b2 is meant in f2, in place of b1",
        Verdict.MISPRINT,
        correction={b1 - b3 * y2: b2 - b3 * y2},
    ),
    at("RIO, two outputs", "65", "3", "y3 from f1 and f2")(
        reads("yhat3^2 = (fhat1^2 + fhat2^2) / ((b1 - b3 y1)^2 + (b2 - b3 y2)^2)"), identities(range_terms)
    ),
    at("RIO, one output", "65", "3", "y3 from f1 alone")(
        reads("yhat3^2 = fhat1^2 / (b1 - b3 y1)^2"), identities(range_terms)
    ),
    at("(10)", "65", "3.1", "canonical form: measured x1, hidden x2")(
        (*OBSERVED, *reads("y = x1")),
        identities(*(partial(in_vectors, form) for form in (BOTH, FIRST, SECOND))),
        "y1 and y2, y1 alone, y2 alone",
    ),
    at("(11)", "65", "3.1", "IBO and its reset")(
        (*IBO_IN_VECTORS, *reads("xhatplus = M xhat / norm(xhat)")),
        feeds_back,
        "unstable for Hurwitz A, P > 0: feed back x1hat - x1, or take A = 1, P = -1/2 as section 4 does",
        Verdict.MISPRINT,
        correction=IBO_MENDED,
    ),
    at("(12)", "65", "3.1", "when the estimate is reset")(
        reads("norm(xhat) >= gamma M"),
        reset_condition,
        "looked at between steps",
        known=Known.IMPLEMENTED,
    ),
    at("gamma > 1", "65", "3.1", "gamma is more than 1")(
        reads("gamma > 1"),
        reset_leads_out,
        "for just these a reset leads out of its own condition",
    ),
    at("e1, e2, e3", "66", "3.1", "errors of the estimates")(ERRORS, error_is_the_package_s, known=Known.DEFINITION),
    at("(15)", "66", "3.1", "IBO, y1 and y2")(
        (
            equal(column(dot(yhat1), dot(yhat2)), G * A * column(e1, e2) + W_BOTH * yhat3 + PHI_BOTH),
            equal(dot(yhat3), (-(G**2) * W_BOTH.T * P * column(e1, e2))[0] + G_BOTH),
            RESET,
        ),
        identities(partial(with_the_sign_of, BOTH)),
        "yhat - y in place of e, as in (11); hats on the left lost by the scan; A, P are multiples of the identity",
        Verdict.MISPRINT,
        correction={e1: -e1, e2: -e2},
    ),
    at("(16)", "66", "3.1", "IBO, y1 alone")(
        (
            equal(dot(yhat1), G * A * e1 + (W_FIRST.T * column(yhat2, yhat3))[0] + PHI_FIRST),
            equal(column(dot(yhat2), dot(yhat3)), -(G**2) * W_FIRST * P * e1 + G_FIRST),
            RESET,
            ALPHATILDE,
        ),
        identities(partial(with_the_sign_of, FIRST)),
        "yhat1 - y1 in place of e1, as in (11); hats lost by the scan, on the left and over y2, y3",
        Verdict.MISPRINT,
        correction={e1: -e1},
    ),
    at("(21)", "67", "3.2", "SMO, y1 and y2")(
        (
            *reads("[yhat1', yhat2'] = [S1, S2] + W_BOTH yhat3 + PHI_BOTH"),
            equal(dot(yhat3), (alpha * W_BOTH.T * column(S1, S2))[0] + G_BOTH),
            RESET,
        ),
        identities(partial(in_coordinates, "SMO", BOTH)),
        known=Known.IMPLEMENTED,
    ),
    at("(22)", "67", "3.2", "growth of the SMO's gains")(
        tuple(
            (
                equal(dot(gain), sp.Piecewise((2 * rate * sp.Abs(e), sp.Abs(e) > 2 * width), (0, True)))
                for gain, rate, e, width in ((lambda1, alpha1, e1, delta1), (lambda2, alpha2, e2, delta2))
            )
        ),
        identities(partial(in_coordinates, "SMO", BOTH)),
        known=Known.IMPLEMENTED,
    ),
    at("(23)", "67", "3.2", "SMO, y1 alone")(
        (
            equal(dot(yhat1), S1 + (W_FIRST.T * column(yhat2, yhat3))[0] + PHI_FIRST),
            *reads("[yhat2', yhat3'] = alpha W_FIRST S1 + G_FIRST"),
            RESET,
            ALPHATILDE,
        ),
        identities(partial(in_coordinates, "SMO", FIRST)),
        "fraction bars in place of brackets by the scan",
        known=Known.IMPLEMENTED,
    ),
    at("Remark 1", "69", "3.3", "e/(|e| + delta) tends to sgn e")(
        (equal(sp.Limit(e1 / (sp.Abs(e1) + delta1), delta1, 0), sp.sign(e1)),), switching_term
    ),
)
