"""What the ledger of every paper must keep: shared by the tests of the single papers."""

import math
from dataclasses import replace

import pytest
from ledger_mutations import say_the_same, slips, symbols_in

from percept_obs.papers import Verdict


def each(entries, slow=()):
    marked = [pytest.param(e, id=e.place, marks=[pytest.mark.slow] * (e.place in slow)) for e in entries]
    return pytest.mark.parametrize("entry", marked)


def recorded(ledger, verdict):
    return [entry for entry in ledger.entries if entry.expected == verdict]


def formulas_that_hold(ledger):
    return [entry for entry in recorded(ledger, Verdict.HOLDS) if entry.printed]


def letters(ledger):
    """All symbols that a slip may put in the place of another one."""
    return set().union(*(symbols_in(formula) for entry in ledger.entries for formula in entry.printed))


def check_numbers(ledger, count):
    """Every number has one entry with its print, and nearly all of them can be checked."""
    numbered = [entry for entry in ledger.entries if entry.number]
    assert [entry.number for entry in numbered] == list(range(1, count + 1))
    assert all(entry.printed for entry in numbered)
    assert sum(entry.expected != Verdict.NOT_CHECKABLE for entry in numbered) >= 0.95 * count


def check_verdict(entry):
    assert entry.finding.verdict == entry.expected
    assert entry.agrees


def check_correction(entry):
    assert entry.corrected != entry.printed
    assert entry.check(entry.corrected).verdict in (Verdict.HOLDS, Verdict.NOT_CHECKABLE)
    assert entry.note


def check_numbers_of_a_counter_example(entry):
    numbers = entry.finding.numbers
    assert numbers
    assert all(map(math.isfinite, numbers.values()))
    assert entry.note


def check_slips(entry, pool):
    """A slip changes the verdict, unless what it makes is proven to say the same."""
    changed = list(slips(entry.printed, pool))
    assert changed
    unnoticed = [p for p in changed if replace(entry, printed=p).finding.verdict == Verdict.HOLDS]
    different = [p for p in unnoticed if not say_the_same(p, entry.printed)]
    assert not different, different
