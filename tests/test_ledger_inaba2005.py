"""Each of the equations (1)-(24) of Inaba 2005 has a computed verdict, which one slip in a formula would change."""

import pytest
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
from ledger_mutations import slips

from percept_obs.papers import INABA2005, Verdict

SLOW_CHECKS = {
    "(13)",
    "(18)",
    "(19)",
    "(24)",
    "Q1 and Q2",
    "less than (15)",
    "Theorem 3.4 (ii)",
    "Theorem 3.4 (ii), Lyapunov stable",
}
SLOW_SLIPS = {
    "(2)",
    "(6)",
    "(9)",
    "(13)",
    "(14)",
    "(18)",
    "(19)",
    "(23)",
    "(24)",
    "Q1 and Q2",
    "Theorem 3.4 (ii)",
    "rate of V",
}
FORMULAS_THAT_HOLD = formulas_that_hold(INABA2005)
POOL = letters(INABA2005)


def test_every_number_has_one_entry_with_its_print():
    check_numbers(INABA2005, 24)


@each(INABA2005.entries, SLOW_CHECKS)
def test_the_computed_verdict_is_the_recorded_one(entry):
    check_verdict(entry)


@each(recorded(INABA2005, Verdict.MISPRINT))
def test_a_misprint_is_mended_by_its_correction(entry):
    check_correction(entry)


@each(recorded(INABA2005, Verdict.FALSE), SLOW_CHECKS)
def test_what_is_called_false_comes_with_the_numbers_of_a_counter_example(entry):
    check_numbers_of_a_counter_example(entry)


@each(recorded(INABA2005, Verdict.NOT_CHECKABLE))
def test_what_cannot_be_checked_says_why(entry):
    assert entry.note


@each(FORMULAS_THAT_HOLD, SLOW_SLIPS)
def test_one_slip_in_a_formula_that_holds_is_noticed(entry):
    check_slips(entry, POOL)


@pytest.mark.slow
def test_there_are_many_slips():
    assert sum(1 for entry in FORMULAS_THAT_HOLD for _ in slips(entry.printed, POOL)) > 1000


def test_entries_show_themselves_as_latex():
    for entry in INABA2005.entries:
        assert entry._repr_latex_().startswith(r"$\displaystyle \begin{gathered}")
