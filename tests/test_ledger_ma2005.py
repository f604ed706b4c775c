"""Each of the equations (1)-(40) of Ma 2005 has a computed verdict, which one slip in a formula would change."""

import math
from collections import Counter
from dataclasses import replace

import pytest
import sympy as sp
from ledger_claims import (
    check_correction,
    check_numbers,
    check_numbers_of_a_counter_example,
    check_slips,
    check_verdict,
    each,
    formulas_that_hold,
    letters,
    recorded,
)
from ledger_mutations import say_the_same, slips, symbols_in

from percept_obs import papers
from percept_obs.papers import MA2005, Ledger, Verdict, base, ma2005_examples
from percept_obs.papers.base import dot, equal

SLOW_CHECKS = {"figure 3", "figure 4", "figure 5", "figure 6", "speed", "gamma = 1"}
SLOW_SLIPS = {"(4)", "(5)", "(10)", "(15)", "(16)", "(21)", "(23)", "(27)", "(33)", "P positive definite"}
FORMULAS_THAT_HOLD = formulas_that_hold(MA2005)
POOL = letters(MA2005)


def test_every_number_has_one_entry_with_its_print():
    check_numbers(MA2005, 40)


@each(MA2005.entries, SLOW_CHECKS)
def test_the_computed_verdict_is_the_recorded_one(entry):
    check_verdict(entry)


@each(recorded(MA2005, Verdict.MISPRINT))
def test_a_misprint_is_mended_by_its_correction(entry):
    check_correction(entry)


@each(recorded(MA2005, Verdict.FALSE), SLOW_CHECKS)
def test_what_is_called_false_comes_with_the_numbers_of_a_counter_example(entry):
    check_numbers_of_a_counter_example(entry)


@each(recorded(MA2005, Verdict.NOT_CHECKABLE))
def test_what_cannot_be_checked_says_why(entry):
    assert entry.note


@each(FORMULAS_THAT_HOLD, SLOW_SLIPS)
def test_one_slip_in_a_formula_that_holds_is_noticed(entry):
    check_slips(entry, POOL)


@pytest.mark.slow
def test_there_are_thousands_of_slips():
    assert sum(1 for entry in FORMULAS_THAT_HOLD for _ in slips(entry.printed, POOL)) > 3000


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
    nothing = base.column(0, 0, 0)
    assert say_the_same((equal(a, b + 1),), (equal(-a, -b - 1),))
    assert say_the_same((base.less(a, 0),), (base.less(2 * a, 0),))
    assert say_the_same((equal(a, a),), (equal(a, b),))
    assert say_the_same((equal(-v, nothing),), (equal(v, nothing),))
    assert say_the_same((base.less(2 * a, sp.oo),), (base.less(a, sp.oo),))
    assert not say_the_same((equal(2 * a, b),), (equal(a, b),))
    assert not say_the_same((base.less(-a, 0),), (base.less(a, 0),))
    assert not say_the_same((base.less(-a, sp.oo),), (base.less(a, sp.oo),))
    assert not say_the_same((base.at_most(a, b),), (equal(a, b),))


@pytest.mark.parametrize("twist", [sp.S.One, -sp.S.One])
def test_zero_is_told_from_nearly_zero(twist):
    a, b = sp.symbols("a b", real=True)
    assert base.vanishes((a + b) ** 2 - a**2 - 2 * a * b - b**2)
    assert base.vanishes(1 / a + 1 / b - (a + b) / (a * b))
    assert not base.vanishes((a + b) ** 2 - a**2 - 2 * a * b - b**2 + twist * sp.Rational(1, 10**12) * a)


def test_an_equation_with_an_unknown_letter_is_no_identity():
    n = sp.Symbol("n", integer=True, positive=True)
    (x, z), a = base.vectors("x z", n), sp.Symbol("a", real=True)
    known = {x: base.column(a), dot(x): base.column(a)}
    assert base.is_identity(equal(dot(x), x), known)
    assert not base.is_identity(equal(dot(x), z), known)
    assert not base.is_identity(equal(dot(x), x), known | {x: base.column(a, a)})
    assert not base.is_identity(base.at_most(a, a), known)


def test_a_printed_bound_must_admit_and_exclude():
    x, M = sp.symbols("x M", real=True)
    assert base.separates(base.at_most(x, M), x, 1, 3, {M: sp.Integer(2)})
    assert not base.separates(base.at_most(-x, M), x, 1, 3, {M: sp.Integer(2)})
    assert not base.separates(base.at_most(x, M), x, 1, 3, {})


@pytest.mark.slow
@pytest.mark.parametrize("name", ma2005_examples.OBSERVERS)
@pytest.mark.parametrize("period", [0.001, 0.02])
def test_figure_3_does_not_come_out_with_other_sampling_either(name, period):
    run = ma2005_examples.followed(35, name, "y1 alone", 0, period)
    assert math.isinf(run.settling_time())
    assert len(run.resets)


@pytest.fixture
def two_entries(monkeypatch):
    entries = (MA2005["(4)"], replace(MA2005["(20)"], expected=Verdict.HOLDS))
    monkeypatch.setattr(papers, "LEDGERS", (Ledger("a paper", entries),))
    return entries


def test_a_verdict_that_is_not_the_recorded_one_is_told(two_entries):
    assert not papers.all_hold()
    assert "false as stated;" in papers.report()
    assert "recorded: holds" in papers.report()


def test_a_correction_that_mends_nothing_is_told(monkeypatch):
    entry = MA2005["f1, f2"]
    assert entry.agrees
    b1, b2 = ma2005_examples.SYSTEM.motion.b[:2]
    assert not replace(entry, correction={b1: b2}).agrees


def test_two_entries_cannot_have_the_same_place():
    with pytest.raises(ValueError, match="same place"):
        Ledger("a paper", (MA2005["(4)"], MA2005["(4)"]))


def test_a_missing_entry_is_named():
    with pytest.raises(KeyError, match=r"no entry '\(41\)'; it has \(1\), \(2\)"):
        MA2005["(41)"]


@pytest.mark.slow
def test_the_report_shows_every_entry_of_every_paper_in_120_columns_and_counts_verdicts():
    tables = papers.report().split("\n\n\n")
    assert len(tables) == len(papers.LEDGERS)
    for ledger, table in zip(papers.LEDGERS, tables, strict=True):
        assert max(map(len, table.splitlines())) <= 120
        assert all(f"\n{entry.place[:10]}" in table for entry in ledger.entries)
        counts = Counter(entry.expected for entry in ledger.entries)
        assert table.splitlines()[-1] == ", ".join(f"{counts[verdict]} {verdict}" for verdict in Verdict)
    assert papers.all_hold()


def test_entries_show_themselves_as_latex():
    for entry in MA2005.entries:
        assert entry._repr_latex_().startswith(r"$\displaystyle \begin{gathered}")


def test_the_corrected_38_is_stable_with_the_listed_constants():
    corrected = MA2005["(38)"].corrected
    assert MA2005["(38) is stable"].check(corrected).verdict == Verdict.HOLDS
