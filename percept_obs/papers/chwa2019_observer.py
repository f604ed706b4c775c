"""Chwa 2019, section III: the integral sliding mode observer, and Theorem 1's Lyapunov argument.

The paper's functions act on each entry, and entries are coupled by the bound on g alone, so that one entry is enough.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import sympy as sp

from percept_obs.compile import vectorised
from percept_obs.observers import Observer
from percept_obs.observers.integral_sliding_mode import a, b, gamma, integral_sliding_mode, k1, k2
from percept_obs.papers.base import at_most, column, dot, equal, identities, reader, vanishes
from percept_obs.papers.entries import Check, Finding, Known, Printed, Values, Verdict, at, judged
from percept_obs.system.forms import CanonicalForm

t = sp.Symbol("t", real=True)
ybar, yhat, Omega, g, ghat, v, u, s = sp.symbols("ybar yhat Omega g ghat v u s", real=True)
e_s, s_e, e_sI, e_s0, s_e0, e_sI0, v0 = sp.symbols("e_s s_e e_sI e_s0 s_e0 e_sI0 v0", real=True)
V1dot, V2dot, Vdot, esbar = sp.symbols("Vdot1 Vdot2 Vdot esbar", real=True)
alpha = sp.Symbol("alpha", real=True)


@cache
def observer() -> Observer:
    """The package's observer of one measured entry whose rate is Omega + g."""
    form = CanonicalForm((ybar,), (g,), (Omega,), (ybar, g), w=column(1), phi=column(Omega), g=column(0))
    return integral_sliding_mode(form, "sign")


@cache
def equations() -> Values:
    """Values of the observer's letters; e_s, e_sI and v stay as they are."""
    made = observer()
    estimate, integral, slope, pseudo = made.equations.state
    letters = {estimate: ybar - e_s, integral: e_sI, slope: a + b * t, pseudo: v}
    rates = dict(zip(made.equations.state, (entry.xreplace(letters) for entry in made.equations.flow), strict=True))
    correction = rates[estimate] - Omega
    (switched,) = (node.args[0] for node in rates[pseudo].atoms(sp.sign))
    return {
        yhat: letters[estimate],
        dot(yhat): rates[estimate],
        ghat: correction,
        s_e: sp.expand(correction).coeff(k1),
        dot(e_sI): rates[integral],
        dot(v): rates[pseudo],
        u: rates[pseudo],
        s: switched,
    }


@cache
def error_dynamics() -> Values:
    """The true rates in terms of e_s, s_e and s."""
    values = equations()
    terms = {e_sI: s_e - e_s, v: s - (values[s] - v).xreplace({e_sI: s_e - e_s})}

    def put(expression: sp.Expr) -> sp.Expr:
        return expression.xreplace(terms)

    estimate = put(values[ghat])
    se_rate = g - estimate + put(values[dot(e_sI)])
    sliding = values[s].xreplace({e_sI: s_e - e_s})
    s_rate = put(values[u]) + sliding.diff(s_e) * se_rate + sliding.diff(t)
    return {
        ghat: estimate,
        u: put(values[u]),
        dot(s_e): se_rate,
        dot(s): s_rate,
        V1dot: s_e * se_rate,
        V2dot: s * s_rate,
        Vdot: s_e * se_rate + s * s_rate,
    }


def in_tanh(printed: Printed) -> Printed:
    """The formulas with sech^2 = 1 - tanh^2."""
    return tuple(
        line.func(
            *(side.replace(sp.sech, lambda x: sp.sqrt(1 - sp.tanh(x) ** 2)) for side in line.args), evaluate=False
        )
        for line in printed
    )


def follow(derive: Callable[[], Values]) -> Check:
    """A check that holds when every printed equation is an identity in the derived values."""

    def check(printed: Printed) -> Finding:
        """Put the package's equations in the place of each letter: both sides must be the same for all values."""
        return identities(derive)(in_tanh(printed))

    return check


def at_signs(expression: sp.Expr) -> list[sp.Expr]:
    """An expression where s_e and s have each of their signs."""
    return [
        expression.subs({sp.Abs(s_e): one * s_e, sp.Abs(s): two * s, sp.sign(s): two})
        for one in (1, -1)
        for two in (1, -1)
    ]


def drops(*gaps: sp.Expr) -> Check:
    """A check that each printed relation, an equality or a bound, drops just this from its left side, which is >= 0."""

    def check(printed: Printed) -> Finding:
        """Terms that each step drops from its left side, with the package's error dynamics put in."""
        values = error_dynamics()
        outcomes = [len(printed) == len(gaps)]
        for line, gap in zip(in_tanh(printed), gaps, strict=False):
            left, right = (side.xreplace(values) for side in line.args)
            kind = sp.Equality if gap == 0 else sp.LessThan
            outcomes.append(type(line) is kind)
            outcomes += [vanishes(difference) for difference in at_signs(right - left - gap)]
        return judged(all(outcomes))

    return check


def starts_at_zero(printed: Printed) -> Finding:
    """e_sI(0) makes s_e zero: the package starts there."""
    made = observer()
    start = dict(zip(made.equations.state, made.start, strict=True))
    estimate, integral = made.equations.state[:2]
    return identities(lambda: {e_s0: ybar - estimate, e_sI0: start[integral]})(printed)


def slides_at_once(printed: Printed) -> Finding:
    """v(0) makes s zero, whatever s_e(0) is; the package has both zero."""
    (line,) = printed
    made = observer()
    start = dict(zip(made.equations.state, made.start, strict=True))
    slope, pseudo = made.equations.state[2:]
    same = start[slope] == a and start[pseudo] == 0 and line.lhs == v0
    at_zero = equations()[s].xreplace({v: line.rhs}).subs({t: 0, e_sI: s_e0 - e_s})
    return judged(same and vanishes(at_zero))


def rate_at_zero(printed: Printed) -> Finding:
    """Rate of s_e where s_e = s = 0: it is g, so that s_e leaves zero at once."""
    rate = error_dynamics()[dot(s_e)].subs({s_e: 0, s: 0})
    rests = rest(10.0, CASE_G)
    numbers = {"rate of s_e at s_e = s = 0": float(rate.subs(g, CASE_G)), "s_e at rest, 10 s": rests}
    return judged(vanishes(rate), Verdict.FALSE, numbers)


def rest(time: float, disturbance: float) -> float:
    """Where s_e comes to rest while s = 0, for a g that stays and the listed gains."""
    rate = error_dynamics()[dot(s_e)].subs(GAINS | {s: 0, t: time, g: disturbance})
    return float(sp.nsolve(rate, s_e, 0))


def attracts(printed: Printed) -> Finding:
    """Rate of |s| next to s = 0, where |g| <= gamma and |s_e| < gamma / k1 = k2; s_e never leaves that."""
    rate = error_dynamics()[dot(s)]
    beside = [(sign * rate).subs(sp.sign(s), sign).subs(GAINS | {s: 0}) for sign in (1, -1)]
    edge = [(sign * error_dynamics()[dot(s_e)]).subs(GAINS | {s: 0, s_e: sign}) for sign in (1, -1)]
    grid = np.meshgrid(np.linspace(-0.999, 0.999, 41), np.linspace(-15, 15, 41), (0.0, 1.0, 10.0, 100.0))
    largest = max(float(value.max()) for value in vectorised((s_e, g, t), beside)(*grid))
    outwards = max(float(value.max()) for value in vectorised((s_e, g, t), edge)(*grid))
    return judged(largest < 0 and outwards <= 0, Verdict.FALSE, {"largest rate of |s|": largest})


def stays_outside(printed: Printed) -> Finding:
    """Where s_e comes to rest and the printed bound, for a g that stays: inside, at all times."""
    bound, condition = printed
    numbers: dict[str, float] = {}
    outcomes = []
    for time in (1.0, 10.0, 100.0):
        at_rest = rest(time, CASE_G)
        edge = float(bound.rhs.subs(GAINS | {t: time, alpha: CASE_G / 15}))
        outcomes.append(condition.subs({s_e: at_rest, esbar: edge}) == sp.true)
        numbers |= {f"|s_e| at {time:g} s": at_rest, f"its bound at {time:g} s": edge}
    return judged(all(outcomes), Verdict.FALSE, numbers)


def decreases_outside(printed: Printed) -> Finding:
    """(21): the bound is where the last term of (20) changes its sign."""
    bound, decrease = printed
    slope = a + b * t
    turning = sp.tanh(slope * bound.rhs).rewrite(sp.exp)
    at_the_bound = vanishes(sp.powsimp(sp.cancel(turning)) - alpha)
    rest_of_20 = decrease.rhs - ENERGY.rhs - gamma * sp.Abs(s_e) * (sp.tanh(slope * sp.Abs(s_e)) - alpha)
    kinds = isinstance(decrease, sp.LessThan) and (bound.lhs, decrease.lhs) == (esbar, Vdot)
    return judged(at_the_bound and kinds and vanishes(rest_of_20))


GAINS = {gain.symbol: sp.Rational(str(gain.value)) for gain in observer().gains}
CASE_G = 0.05 * 10.4 * 0.23
"""The largest entry of g in the experiment's first case, in 1/s."""

SLOPE = a + b * t
PUSH, PULL = gamma * sp.tanh(SLOPE * e_s), gamma * sp.tanh(SLOPE * s_e)
SECH2 = sp.sech(SLOPE * s_e) ** 2
LEFT_OVER = -gamma * sp.Abs(s_e) * (sp.tanh(SLOPE * sp.Abs(s_e)) - alpha)
ENERGY = at_most(Vdot, -k1 * s_e**2 - k2 * sp.Abs(s) + LEFT_OVER)
LAYER = equal(esbar, sp.log((1 + alpha) / (1 - alpha)) / (2 * SLOPE))
OUTSIDE = (LAYER, at_most(Vdot, -k1 * s_e**2 - k2 * sp.Abs(s)))
# What |g| <= alpha gamma < gamma leaves over.
OF_SE = gamma * alpha * sp.Abs(s_e) - s_e * g
OF_S = gamma * SLOPE * (1 - sp.tanh(SLOPE * s_e) ** 2) * (gamma * sp.Abs(s) - s * g)
ONE_ENTRY = "for one entry; alpha is the bound of |g| over gamma"

reads = reader(SLOPE=SLOPE, PUSH=PUSH, PULL=PULL, SECH2=SECH2, LEFT_OVER=LEFT_OVER)

ENTRIES = (
    at("(8)", "4", "III", "estimate of ybar")(
        reads("yhat' = Omega + ghat"), follow(equations), known=Known.IMPLEMENTED
    ),
    at("e_s", "4", "III", "estimation error")(reads("e_s = ybar - yhat"), follow(equations), known=Known.DEFINITION),
    at("(9)", "4", "III", "integral sliding surface")(
        reads("s_e = e_s + e_sI"), follow(equations), known=Known.IMPLEMENTED
    ),
    at("(10)", "4", "III", "its integral")(reads("e_sI' = PUSH"), follow(equations), known=Known.IMPLEMENTED),
    at("e_sI(0)", "4", "III", "start of the integral")(reads("e_sI0 = -e_s0"), starts_at_zero, "so that s_e(0) = 0"),
    at("s_e = 0 for ever", "4", "III", "s_e starts at zero and stays there")(
        reads("s_e = 0"), rate_at_zero, "s = 0 can be kept, s_e not: it leaves zero at the rate g", Verdict.FALSE
    ),
    at("(11)", "4", "III", "estimate of g")(
        reads("ghat = k1 s_e - v + PUSH"), follow(equations), known=Known.IMPLEMENTED
    ),
    at("(12)", "4", "III", "pseudo-input")(reads("v' = u"), follow(equations), known=Known.IMPLEMENTED),
    at("(13)", "4", "III", "its rate")(
        reads("u = gamma SECH2 (SLOPE (ghat - PUSH) - b s_e) - gamma^2 SLOPE SECH2 sgn(s) - k2 sgn(s) - s_e"),
        follow(equations),
        known=Known.IMPLEMENTED,
    ),
    at("(14)", "4", "III", "second sliding surface")(reads("s = v + PULL"), follow(equations), known=Known.IMPLEMENTED),
    at("v(0)", "4", "III", "start of the pseudo-input")(
        reads("v0 = -gamma tanh(a s_e0)"), slides_at_once, "so that s(0) = 0"
    ),
    at("s = 0 for ever", "5", "III", "s remains at zero")(
        (), attracts, "with the listed gains, where |g| <= gamma", asks=lambda: reads("s = 0")
    ),
    at("(15)", "6", "III", "rate of s_e")(
        reads("s_e' = g - ghat + PUSH; s_e' = g - k1 s_e + s - PULL"), follow(error_dynamics)
    ),
    at("(16)", "6", "III", "rate of V1 = s_e^2 / 2")(
        reads("Vdot1 <= -k1 s_e^2 + s_e s + LEFT_OVER"), drops(OF_SE), ONE_ENTRY
    ),
    at("(17)", "6", "III", "rate of s")(
        reads("s' = u + gamma SECH2 (SLOPE (g - ghat + PULL) + b s_e)"),
        follow(error_dynamics),
        "e_s in place of s_e in the hyperbolic tangent, as in (15); (18) follows from that only",
        Verdict.MISPRINT,
        correction={g - ghat + PULL: g - ghat + PUSH},
    ),
    at("(18)", "6", "III", "rate of s with (13) put in")(
        reads("s' = gamma SECH2 SLOPE g - gamma^2 SLOPE SECH2 sgn(s) - k2 sgn(s) - s_e"),
        follow(error_dynamics),
    ),
    at("(19)", "6", "III", "rate of V2 = s^2 / 2")(
        reads(
            """Vdot2 = gamma s SECH2 SLOPE g - gamma^2 SLOPE SECH2 abs(s) - k2 abs(s) - s s_e;
            Vdot2 <= -k2 abs(s) - s s_e"""
        ),
        drops(sp.S.Zero, OF_S),
        ONE_ENTRY,
    ),
    at("(20)", "6", "III", "rate of V = V1 + V2")((ENERGY,), drops(OF_SE + OF_S), ONE_ENTRY),
    at("(21)", "6", "III", "V decreases where s_e is beyond a bound")(
        OUTSIDE, decreases_outside, "for one entry, where |s_e| is at least the bound"
    ),
    at("end of the proof", "6", "III", "|s_e| is beyond its bound as time goes on")(
        (LAYER, *reads("abs(s_e) >= esbar")),
        stays_outside,
        "it rests inside, so (21) does not hold there; s_e falls as 1/(a + b t) with the bound, no faster",
        Verdict.FALSE,
    ),
)
