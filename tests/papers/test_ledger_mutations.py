"""Slips are found in every place of a formula, and what they make is told from what it says."""

from collections import Counter
from copy import copy

import pytest
import sympy as sp
from ledger_mutations import say_the_same, slips

from percept_obs.checking.places import at, put
from percept_obs.checking.slips import MISTAKES, siblings_in, slips_in, symbols_in
from percept_obs.papers.base import column, is_identity, vanishes
from percept_obs.papers.letters import Letters, Print


def equal(left, right):
    return sp.Eq(left, right, evaluate=False)


def less(left, right):
    return sp.StrictLessThan(left, right, evaluate=False)


def at_most(left, right):
    return sp.LessThan(left, right, evaluate=False)


def test_slips_are_signs_factors_and_siblings():
    y1, y2, yhat1, z = sp.symbols("y1 y2 yhat1 z", real=True)
    (formula,) = printed = (equal(y1, y2 - z * y1),)
    found = {changed for (changed,) in slips(printed, symbols_in(formula) | {yhat1})}
    left = {equal(s, formula.rhs) for s in (y2, yhat1, -y1, 2 * y1)}
    signs = {equal(y1, -y2 - z * y1), equal(y1, y2 + z * y1)}
    factors = {equal(y1, 2 * y2 - z * y1), equal(y1, y2 - 2 * z * y1)}
    first = {equal(y1, s - z * y1) for s in (y1, yhat1)}
    second = {equal(y1, y2 - z * s) for s in (y2, yhat1)}
    assert found == left | signs | factors | first | second


def test_slips_are_exponents_inverses_and_transposes():
    n = sp.Symbol("n", integer=True, positive=True)
    A, P = sp.MatrixSymbol("A", n, n), sp.MatrixSymbol("P", n, n)
    x, z = sp.symbols("x z", real=True)
    powers = {line.rhs for (line,) in slips((equal(z, x**2 / z),), {x, z})}
    assert {x**3 / z, x**2 / z**2} <= powers
    left_out = {line.rhs for (line,) in slips((equal(A, A.T * P.inv()),), {A, P})}
    assert {A * P.inv(), A.T * P} <= left_out


def test_slips_enter_matrices_vectors_and_branches():
    n = sp.Symbol("n", integer=True, positive=True)
    e1, e2, w = (sp.MatrixSymbol(name, n, n) for name in ("e1", "e2", "w"))
    a1, a2 = sp.symbols("a1 a2", real=True)
    matrix = (equal(sp.ImmutableMatrix([a1, 0]), sp.ImmutableMatrix([1, a1 + 1])),)
    vectors = (equal(e1, w * e1 - w),)
    branches = (equal(a1, sp.Piecewise((a1, a1 > 0), (0, True))),)
    # a1 twice; sign and factor of itself, of 1, and of both terms.
    assert len(list(slips(matrix, {a1, a2}))) == 10
    changed = {(line.lhs, line.rhs.doit()) for (line,) in slips(vectors, {e1, e2, w})}
    left = {(s, w * e1 - w) for s in (e2, -e1, 2 * e1)}
    signs = {(e1, w * e1 + w), (e1, (-w * e1 - w).doit())}
    factors = {(e1, (2 * w * e1 - w).doit()), (e1, (w * e1 - 2 * w).doit())}
    assert changed == left | signs | factors | {(e1, w * e2 - w)}
    # a1 three times; sign and factor of both sides, of the branch, and of the condition's left side.
    assert len(list(slips(branches, {a1, a2}))) == 11


def test_what_says_the_same_is_told_from_what_does_not():
    a, b = sp.symbols("a b", real=True)
    v = sp.MatrixSymbol("v", 3, 1)
    nothing = column(0, 0, 0)
    assert say_the_same((equal(a, b + 1),), (equal(-a, -b - 1),))
    assert say_the_same((less(a, 0),), (less(2 * a, 0),))
    assert say_the_same((equal(a, a),), (equal(a, b),))
    assert say_the_same((equal(-v, nothing),), (equal(v, nothing),))
    assert say_the_same((less(2 * a, sp.oo),), (less(a, sp.oo),))
    assert not say_the_same((equal(2 * a, b),), (equal(a, b),))
    assert not say_the_same((less(-a, 0),), (less(a, 0),))
    assert not say_the_same((less(-a, sp.oo),), (less(a, sp.oo),))
    assert not say_the_same((at_most(a, b),), (equal(a, b),))


@pytest.mark.parametrize("twist", [sp.S.One, -sp.S.One])
def test_zero_is_told_from_nearly_zero(twist):
    a, b = sp.symbols("a b", real=True)
    assert vanishes((a + b) ** 2 - a**2 - 2 * a * b - b**2)
    assert vanishes(1 / a + 1 / b - (a + b) / (a * b))
    assert not vanishes((a + b) ** 2 - a**2 - 2 * a * b - b**2 + twist * sp.Rational(1, 10**12) * a)


def test_an_equation_with_an_unknown_letter_is_no_identity():
    letters = Letters(("n: x z",))
    known = letters.values({"x": column(sp.Symbol("a")), "x'": column(sp.Symbol("a"))})
    (right,), (unknown,), (bound,) = map(letters.read, ("x' = x", "x' = z", "x' <= x"))
    assert is_identity(right, known)
    assert is_identity(bound, known)
    assert not is_identity(unknown, known)
    assert not is_identity(right, known | {letters["x"]: column(1, 1)})
    assert not is_identity(right, known, sp.S.One)


def test_a_printed_bound_must_admit_and_exclude():
    letters = Letters()
    bound = Print(letters.read("x <= M"), letters)
    assert copy(bound).separates("x", 1, 3, {"M": 2})
    assert not Print(letters.read("-x <= M"), letters).separates("x", 1, 3, {"M": 2})
    assert not bound.separates("x", 1, 3, {})


def test_a_slip_knows_its_place_its_kind_and_its_term():
    y1, y2, z = sp.symbols("y1 y2 z", real=True)
    formula = y2 + z * (y1 - y2)
    found = list(slips_in(formula, siblings_in({y1, y2, z}), MISTAKES))
    assert Counter(slip.kind for slip in found) == {"letter": 3, "sign": 4, "factor": 4, "dropped": 4}
    for slip in found:
        assert at(formula, slip.path) == slip.before
        assert put(formula, slip.path, slip.after) == slip.formula
        assert slip.term in (y2, z * (y1 - y2), y1, -y2)
    (inside,) = (slip for slip in found if slip.kind == "letter" and slip.before == y1)
    assert (inside.after, inside.term, inside.formula) == (y2, y1, y2)
