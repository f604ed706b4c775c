"""Right formulas that people write and papers print are read and judged right; two meanings are asked back."""

import re
from collections import Counter

import pytest
from formula_corpus import entries, prints, target
from sample_sizes import sampled

from percept_obs import CannotRead, check

RIGHT, NOT_READ = "judged right", "not read"


def outcome(entry):
    """Tell what the check made of an entry, and why."""
    try:
        right = check(entry.text, target(entry.target)).right
    except CannotRead as refusal:
        return NOT_READ, str(refusal)
    except ValueError as refusal:
        return "does not fit", str(refusal)
    return {True: RIGHT, False: "judged wrong", None: "cannot tell"}[right], ""


@pytest.mark.slow
def test_right_formulas_are_read_and_judged_right():
    found = [(entry, *outcome(entry)) for entry in entries("right")]
    counts = Counter(verdict for _, verdict, _ in found)
    print(f"\n{len(found)} right formulas: {dict(counts)}")
    for entry, verdict, why in found:
        if verdict != RIGHT:
            print(f"{verdict}: {entry.text}\n{why}")
    assert counts[NOT_READ] <= 0.02 * len(found)
    assert counts[RIGHT] + counts[NOT_READ] == len(found)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["people", "people_later"])
def test_what_people_and_programs_write_is_read_and_nothing_wrong_is_accepted(name):
    """Every sixth one; all of them with ALL_SAMPLES=1."""
    chosen = entries(name)[:: sampled(6, 1)]
    found = {True: Counter(), False: Counter()}
    for entry in chosen:
        verdict, why = outcome(entry)
        found[entry.right][verdict] += 1
        if (verdict == RIGHT) != entry.right:
            print(f"{verdict}: {entry.text}\n{why}")
    right, wrong = found[True], found[False]
    print(f"\n{name}: right {dict(right)}, wrong {dict(wrong)}")
    assert wrong[RIGHT] == right["judged wrong"] == 0
    assert right[RIGHT] >= 0.85 * right.total()


@pytest.mark.parametrize("entry", entries("asked"), ids=lambda entry: entry.text[:40])
def test_what_has_two_meanings_is_asked_back(entry):
    with pytest.raises(ValueError, match=re.escape(entry.asked)):
        check(entry.text, target(entry.target))


NOT_ASKED = {
    "ma2005 (12)": "a set of times, no formula",
    "ma2005 (29)": "V1 is a function of time in the ledger",
    "ma2005 (31)": "rates along two systems, told apart by their numbers",
    "inaba2005 (2)": "dots for the points between",
    "inaba2005 (3)": "dots for the points between",
    "inaba2005 (6)": "x is not a letter of the ledger's form",
    "inaba2005 (9)": "the ledger compares for other sizes",
    "inaba2005 (13)": "a set of functions, no formula",
    "inaba2005 (22)": "rho and Phi at several times",
    "inaba2005 (23)": "d t stands before the integrand",
}


@pytest.mark.slow
def test_prints_of_the_papers_are_read():
    refused = {}
    for place, text in prints().items():
        try:
            target(f"ledger {place}").read(text)
        except CannotRead as refusal:
            refused[place] = str(refusal).partition("\n")[0]
    print(f"\n{len(prints()) - len(refused)} of {len(prints())} numbered equations are read from print")
    assert refused.keys() <= NOT_ASKED.keys(), refused


@pytest.mark.parametrize("place", ["ma2005 (4)", "ma2005 (10)", "ma2005 (33)", "inaba2005 (12)", "chwa2019 (11)"])
def test_a_print_is_what_the_ledger_has(place):
    assert check(prints()[place], target(f"ledger {place}")).right
