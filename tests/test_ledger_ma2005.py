"""Each of the equations (1)-(40) of Ma 2005 has a computed verdict, which one wrong sign or symbol would change."""

import math
from collections import Counter
from dataclasses import replace

import pytest
import sympy as sp
from ledger_mutations import slips, symbols_in

from percept_obs import papers
from percept_obs.papers import MA2005, Ledger, Verdict, base, ma2005_examples
from percept_obs.papers.base import dot, equal

SLOW_CHECKS = {"figure 3", "figure 4", "figure 5", "figure 6", "speed", "gamma = 1"}
SLOW_SLIPS = {"(4)", "(15)", "(16)", "(21)", "(23)", "(27)", "(33)"}
POOL = set().union(*(symbols_in(formula) for entry in MA2005.entries for formula in entry.printed))


def each(chosen, slow=()):
    marked = [pytest.param(e, id=e.place, marks=[pytest.mark.slow] * (e.place in slow)) for e in chosen]
    return pytest.mark.parametrize("entry", marked)


def expected(*verdicts):
    return [entry for entry in MA2005.entries if entry.expected in verdicts]


FORMULAS_THAT_HOLD = [entry for entry in expected(Verdict.HOLDS) if entry.printed]


def test_every_number_has_one_entry_with_its_print():
    numbered = [entry for entry in MA2005.entries if entry.number]
    assert [entry.number for entry in numbered] == list(range(1, 41))
    assert all(entry.printed for entry in numbered)


def test_nearly_every_number_can_be_checked():
    numbered = [entry for entry in MA2005.entries if entry.number]
    assert sum(entry.expected != Verdict.NOT_CHECKABLE for entry in numbered) >= 0.95 * 40


@each(MA2005.entries, SLOW_CHECKS)
def test_the_computed_verdict_is_the_recorded_one(entry):
    assert entry.finding.verdict == entry.expected
    assert entry.agrees


@each(expected(Verdict.MISPRINT))
def test_a_misprint_is_mended_by_its_correction(entry):
    assert entry.corrected != entry.printed
    assert entry.check(entry.corrected).verdict in (Verdict.HOLDS, Verdict.NOT_CHECKABLE)
    assert entry.note


@each(expected(Verdict.FALSE), SLOW_CHECKS)
def test_what_is_called_false_comes_with_the_numbers_of_a_counter_example(entry):
    numbers = entry.finding.numbers
    assert numbers
    assert all(map(math.isfinite, numbers.values()))
    assert entry.note


@each(expected(Verdict.NOT_CHECKABLE))
def test_what_cannot_be_checked_says_why(entry):
    assert entry.note


@each(FORMULAS_THAT_HOLD, SLOW_SLIPS)
def test_one_slip_in_a_formula_that_holds_is_noticed(entry):
    changed = list(slips(entry.printed, POOL))
    assert changed
    unnoticed = [p for p in changed if replace(entry, printed=p).finding.verdict == Verdict.HOLDS]
    different = [p for p in unnoticed if not all(map(same, p, entry.printed))]
    assert not different, different
    # Only the signs inside the norm of a reset may change without a trace.
    assert len(unnoticed) in (0, 9)


def same(one, other):
    """Whether two relations are proven to say the same."""
    return one.func == other.func and base.is_identity(equal(one.lhs - one.rhs, other.lhs - other.rhs), {})


@pytest.mark.slow
def test_there_are_thousands_of_slips():
    assert sum(1 for entry in FORMULAS_THAT_HOLD for _ in slips(entry.printed, POOL)) > 3000


def test_slips_are_signs_and_siblings():
    y1, y2, yhat1, z = sp.symbols("y1 y2 yhat1 z", real=True)
    (formula,) = printed = (equal(y1, y2 - z * y1),)
    found = {changed for (changed,) in slips(printed, symbols_in(formula) | {yhat1})}
    left = {equal(s, formula.rhs) for s in (y2, yhat1, -y1)}
    signs = {equal(y1, -y2 - z * y1), equal(y1, y2 + z * y1)}
    first = {equal(y1, s - z * y1) for s in (y1, yhat1)}
    second = {equal(y1, y2 - z * s) for s in (y2, yhat1)}
    assert found == left | signs | first | second


def test_slips_enter_matrices_vectors_and_branches():
    n = sp.Symbol("n", integer=True, positive=True)
    e1, e2, w = (sp.MatrixSymbol(name, n, n) for name in ("e1", "e2", "w"))
    a1, a2 = sp.symbols("a1 a2", real=True)
    matrix = (equal(sp.ImmutableMatrix([a1, 0]), sp.ImmutableMatrix([1, a1 + 1])),)
    vectors = (equal(e1, w * e1 - w),)
    branches = (equal(a1, sp.Piecewise((a1, a1 > 0), (0, True))),)
    # a1 twice, its own sign, the sign of 1, both terms' signs.
    assert len(list(slips(matrix, {a1, a2}))) == 6
    changed = {(line.lhs, line.rhs.doit()) for (line,) in slips(vectors, {e1, e2, w})}
    left = {(e2, w * e1 - w), (-e1, w * e1 - w)}
    assert changed == left | {(e1, w * e2 - w), (e1, w * e1 + w), (e1, (-w * e1 - w).doit())}
    # a1 three times, the sign of both sides, of the branch, and of the condition's left side.
    assert len(list(slips(branches, {a1, a2}))) == 7


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
def test_the_report_shows_every_entry_in_120_columns_and_counts_verdicts():
    report = papers.report()
    assert max(map(len, report.splitlines())) <= 120
    assert all(f"\n({number})" in report for number in range(1, 41))
    counts = Counter(entry.expected for entry in MA2005.entries)
    assert report.splitlines()[-1] == ", ".join(f"{counts[verdict]} {verdict}" for verdict in Verdict)
    assert papers.all_hold()


def test_entries_show_themselves_as_latex():
    for entry in MA2005.entries:
        assert entry._repr_latex_().startswith(r"$\displaystyle \begin{gathered}")


def test_the_corrected_38_is_stable_with_the_listed_constants():
    corrected = MA2005["(38)"].corrected
    assert MA2005["(38) is stable"].check(corrected).verdict == Verdict.HOLDS
