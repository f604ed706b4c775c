"""Each of the equations (1)-(37) of Chwa 2019 has a computed verdict, which one slip in a formula would change."""

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

from percept_obs.papers import CHWA2019, Verdict

SLOW_CHECKS = {"100 dB", "Remark 1", "figures 9 to 11", "Theorem 1 (iv)"}
SLOW_SLIPS = {"(5)", "(7)", "(29)", "(31)"}
FORMULAS_THAT_HOLD = formulas_that_hold(CHWA2019)
POOL = letters(CHWA2019)


def test_every_number_has_one_entry_with_its_print():
    check_numbers(CHWA2019, 37)


@each(CHWA2019.entries, SLOW_CHECKS)
def test_the_computed_verdict_is_the_recorded_one(entry):
    check_verdict(entry)


@each(recorded(CHWA2019, Verdict.MISPRINT))
def test_a_misprint_is_mended_by_its_correction(entry):
    check_correction(entry)


@each(recorded(CHWA2019, Verdict.FALSE), SLOW_CHECKS)
def test_what_is_called_false_comes_with_the_numbers_of_a_counter_example(entry):
    check_numbers_of_a_counter_example(entry)


@each(recorded(CHWA2019, Verdict.NOT_CHECKABLE))
def test_what_cannot_be_checked_says_why(entry):
    assert entry.note


@each(FORMULAS_THAT_HOLD, SLOW_SLIPS)
def test_one_slip_in_a_formula_that_holds_is_noticed(entry):
    check_slips(entry, POOL)


@pytest.mark.slow
def test_there_are_many_slips():
    assert sum(1 for entry in FORMULAS_THAT_HOLD for _ in slips(entry.printed, POOL)) > 1000


def test_entries_show_themselves_as_latex():
    for entry in CHWA2019.entries:
        assert entry._repr_latex_().startswith(r"$\displaystyle \begin{gathered}")
