"""Inaba, Abdursul and Ghosh 2005, section 3: the lines of Theorem 3.4's proof that need no run."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from math import prod
from typing import Any

import sympy as sp

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
    vanishes,
    vectors,
)
from percept_obs.papers.entries import Finding, Known, Printed, Values, Verdict, at, judged, not_checkable
from percept_obs.papers.scalars import Inner, Norm
from percept_obs.points import LuenbergerObserver, PointsForm, luenberger, point_block
from percept_obs.system.motion import linear
from percept_obs.system.surfaces import pinhole

# Numbers
t, t0, s, tau, T = sp.symbols("t t0 s tau T", real=True)
delta, gamma1, ysup = sp.symbols("delta gamma1 y_sup", positive=True)
Q1, Vdot = sp.symbols("Q1 Vdot", real=True)
rho_, theta_, seen_ = (sp.Function(name, real=True) for name in ("rho", "theta", "seen"))
Phi_ = sp.Function("Phi", real=True)

# Vectors and matrices
n, p = sp.symbols("n p", integer=True, positive=True)
rho, rho0, theta = vectors("rho rho0 theta", n)
A, P, P0, Pdot = (sp.MatrixSymbol(name, n, n) for name in ("A", "P", "P0", "Pdot"))
B, C = sp.MatrixSymbol("B", 2 * p, 3 * p), sp.MatrixSymbol("C", 3 * p, n)


@cache
def one_point() -> LuenbergerObserver:
    """The package's observer of one point and two states, with letters for all coefficients."""
    letters = sp.ImmutableMatrix(3, 2, lambda i, j: sp.Symbol(f"c{i + 1}{j + 1}", real=True))
    return luenberger(PointsForm(linear(states=2), [letters]))


def symmetric(name: str) -> sp.ImmutableMatrix:
    """A symmetric matrix of letters."""
    return sp.ImmutableMatrix(2, 2, lambda i, j: sp.Symbol(f"{name}{min(i, j) + 1}{max(i, j) + 1}", real=True))


@cache
def error_dynamics() -> Values:
    """The package's error dynamics, with theta for what they have besides A rho, and letters for P and its rate."""
    observer = one_point()
    weight, rate = map(symmetric, ("P", "Pdot"))
    inverse = dict(zip(observer.inverse, weight.inv(), strict=True))
    error = column(*observer.error)
    error_rate = observer.error_dynamics().xreplace(inverse)
    motion = observer.form.motion.A
    values = {rho: error, A: motion, B: observer.form.B, C: observer.form.stacked, P: weight, Pdot: rate}
    values |= {dot(rho): error_rate, theta: motion * error - error_rate}
    energy_rate = sum(sp.diff((error.T * weight * error)[0], e) * r for e, r in zip(error, error_rate, strict=True))
    values[Vdot] = energy_rate + (error.T * rate * error)[0]
    return {letter: sp.ImmutableMatrix(v) if isinstance(v, sp.MatrixBase) else v for letter, v in values.items()}


def energy_does_not_grow(printed: Printed) -> Finding:
    """(15): it is what the rate of rho^T P rho has besides what is seen."""
    (line,) = printed
    values = error_dynamics()
    change = filled_in(Inner(rho, line.lhs * rho), values)
    seen = explicit(Norm(B * C * rho), values) ** 2
    sufficient = isinstance(line, sp.LessThan) and line.rhs == sp.ZeroMatrix(n, n)
    return judged(sufficient and change is not None and vanishes(values[Vdot] - change + 2 * seen))


def rate_of_energy(printed: Printed) -> Finding:
    """The rate of rho^T P rho, and that (15) is just what the last step drops."""
    balance, bound = printed
    values = error_dynamics()
    dropped = explicit(Inner(rho, (A.T * P + P * A + Pdot) * rho), values)
    kept = filled_in(bound.rhs, values)
    same = is_identity(balance, values) and isinstance(bound, sp.LessThan) and (balance.lhs, bound.lhs) == (Vdot, Vdot)
    return judged(same and kept is not None and vanishes(values[Vdot] - dropped - kept))


def norm_of_rows(printed: Printed) -> Finding:
    """|B|^2 is the largest eigenvalue of B^T B, and (1 + y_sup)^2 exceeds it by 2 y_sup."""
    (line,) = printed
    block = point_block(pinhole())
    at_the_edge = dict(zip(block.y, (ysup, sp.S.Zero), strict=True))
    largest = max((value.xreplace(at_the_edge) for value in block.eigenvalues()), key=sp.count_ops)
    exceeds = isinstance(line, sp.LessThan) and vanishes(line.rhs**2 - largest - 2 * ysup)
    return judged(line.lhs == Norm(B) and exceeds)


def one_state() -> Callable[[sp.Expr], sp.Expr]:
    """One state with A = cos t and theta = t exp(sin t), solved: rho = exp(sin t) (1 - t^2 / 2)."""
    solution = sp.Lambda(tau, sp.exp(sp.sin(tau)) * (1 - tau**2 / 2))
    known = {
        rho_: solution,
        theta_: sp.Lambda(tau, tau * sp.exp(sp.sin(tau))),
        Phi_: sp.Lambda((t, tau), sp.exp(sp.sin(t) - sp.sin(tau))),
    }

    def put_in(expression: sp.Expr) -> sp.Expr:
        for function, value in known.items():
            expression = expression.replace(function, value)
        return sp.powsimp(expression, deep=True)

    return put_in


def two_states() -> dict[Any, Callable[..., sp.MatrixBase]]:
    """Two states with A = [[0, t], [0, 1]], whose values at two times do not commute, and theta = (1, t), solved."""

    def transition(end: sp.Expr, start: sp.Expr) -> sp.MatrixBase:
        grown = ((end - 1) * sp.exp(end) - (start - 1) * sp.exp(start)) * sp.exp(-start)
        return sp.Matrix([[1, grown], [0, sp.exp(end - start)]])

    return {
        Phi_: transition,
        rho_: lambda time: sp.Matrix(
            [(time - 1) * sp.exp(time) + time**3 / 3 + time**2 / 2 - time, sp.exp(time) + time + 1]
        ),
        theta_: lambda time: sp.Matrix([1, time]),
    }


def as_matrices(side: sp.Expr, known: dict[Any, Callable[..., sp.MatrixBase]]) -> sp.MatrixBase:
    """A side of (22) with matrices, of which Phi stands before the vector that it moves."""
    if isinstance(side, sp.Add):
        first, *rest = (as_matrices(part, known) for part in side.args)
        return sum(rest, first)
    if isinstance(side, sp.Integral):
        return as_matrices(side.function, known).applyfunc(lambda entry: sp.integrate(entry, *side.limits))
    if isinstance(side, sp.Mul):
        ordered = sorted(side.args, key=lambda part: (not part.is_number, part.func != Phi_))
        return prod((part if part.is_number else as_matrices(part, known) for part in ordered), start=sp.S.One)
    return known[side.func](*side.args)


def variation_of_constants(printed: Printed) -> Finding:
    """(22) for one state whose A varies, and for two states whose A at two times do not commute."""
    (line,) = printed
    put_in = one_state()
    rate_is_right = vanishes(put_in(rho_(t)).diff(t) - sp.cos(t) * put_in(rho_(t)) + put_in(theta_(t)))
    left, right = (sp.expand(put_in(side).doit(), power_exp=False) for side in line.args)
    if not (isinstance(line, sp.Eq) and rate_is_right and vanishes(sp.powsimp(sp.expand(left - right)))):
        return judged(False)
    known = two_states()
    motion = sp.Matrix([[0, t], [0, 1]])
    solves = known[rho_](t).diff(t) - motion * known[rho_](t) + known[theta_](t)
    one, other = (as_matrices(side, known) for side in line.args)
    return judged(vanishes(*sp.powsimp(solves.expand()), *(one - other).applyfunc(lambda e: sp.powsimp(sp.expand(e)))))


@cache
def worth(side: sp.Expr, start: int) -> float:
    """A side of (23) for |B C rho|^2 = exp(-t), T = 2 and a t0."""
    number = side.replace(seen_, sp.Lambda(t, sp.exp(-t))).subs({t0: start, T: 2}).doit()
    return float(number) if number.is_number else math.nan


def exchanged(printed: Printed) -> Finding:
    """(23): the exchange of integrals for |B C rho|^2 = exp(-t) and two t0, and what its bounds drop."""
    definition, swap, bound, last = printed
    kinds = [type(line) for line in printed] == [sp.Equality, sp.Equality, sp.LessThan, sp.LessThan]
    if not kinds or any(line.lhs != Q1 for line in (definition, swap, bound)):
        return judged(False)
    outcomes = []
    for start in (0, 1):
        exact = math.exp(-start) * (1 - math.exp(-2))
        dropped = float(sp.integrate((2 - (tau - start)) * sp.exp(-tau), (tau, start, start + 2)))
        outcomes += [math.isclose(worth(side, start), exact) for side in (definition.rhs, swap.rhs)]
        outcomes += [math.isclose(worth(side, start) - exact, dropped) for side in (bound.rhs, last.lhs)]
        if not all(outcomes):
            return judged(False)
    # With (19) the last line is an equality for gamma1 = T |P(t0)| / 2.
    total = sp.Integral(seen_(t), (t, t0, sp.oo))
    gap = (last.rhs - last.lhs).xreplace({total: Norm(P0) * Norm(rho0) ** 2 / 2, gamma1: T * Norm(P0) / 2})
    return judged(vanishes(gap))


FROM_T0 = (t, t0, sp.oo)

reads = reader(ysup, rho, theta, A, P, Pdot, B, C)
RATE_OF_V = reads(
    """Vdot = inner(rho, (A^T P + P A + Pdot) rho) - 2 inner(rho, C^T B^T B C rho);
    Vdot <= -2 norm(B C rho)^2"""
)

ENTRIES = (
    at("(15)", "4", "3", "what P has to fulfil")(
        (at_most(A.T * P + P * A + Pdot, sp.ZeroMatrix(n, n)),),
        energy_does_not_grow,
        "sufficient, not necessary: V's rate has -2 |B C rho|^2 besides, of which a part could be given away",
    ),
    at("P bounded below", "4", "3", "P is at least delta I")(
        (sp.GreaterThan(P, delta * sp.Identity(n), evaluate=False),),
        not_checkable,
        "a choice; it leaves P free to grow, see Theorem 3.4 (ii)",
        Verdict.NOT_CHECKABLE,
        known=Known.DEFINITION,
    ),
    at("rate of V", "5", "3", "rate of rho^T P rho")(
        RATE_OF_V,
        rate_of_energy,
        "given (15)",
    ),
    at("norm of B", "5", "3", "B is bounded")(
        reads("norm(B) <= 1 + y_sup"), norm_of_rows, "y_sup for the largest |y(k)|"
    ),
    at("(20)", "5", "3", "(12) with theta")(reads("rho' = A rho - theta"), identities(error_dynamics)),
    at("(21)", "5", "3", "what theta is")(reads("theta = P^-1 C^T B^T B C rho"), identities(error_dynamics)),
    at("(22)", "5", "3", "variation of constants")(
        (equal(rho_(t + s), Phi_(t + s, t) * rho_(t) - sp.Integral(Phi_(t + s, tau) * theta_(tau), (tau, t, t + s))),),
        variation_of_constants,
        "for n = 1 with A = cos t, and for n = 2 with A = [[0, t], [0, 1]]",
    ),
    at("(23)", "5", "3", "bound on Q1")(
        (
            equal(Q1, sp.Integral(seen_(t + s), (s, 0, T), FROM_T0)),
            equal(Q1, sp.Integral(seen_(tau) * sp.Integral(1, (t, sp.Max(t0, tau - T), tau)), (tau, t0, sp.oo))),
            at_most(Q1, T * sp.Integral(seen_(t), FROM_T0)),
            at_most(T * sp.Integral(seen_(t), FROM_T0), gamma1 * Norm(rho0) ** 2),
        ),
        exchanged,
        "gamma1 = T |P(t0)| / 2 serves; seen is |B C rho|^2",
    ),
)
