"""What people write is read, and judged right where it is right; what has two meanings is asked back."""

import re
from collections import Counter

import pytest
from formula_corpus import entries, target

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


def test_right_formulas_are_read_and_judged_right():
    found = [(entry, *outcome(entry)) for entry in entries("right")]
    counts = Counter(verdict for _, verdict, _ in found)
    print(f"\n{len(found)} right formulas: {dict(counts)}")
    for entry, verdict, why in found:
        if verdict != RIGHT:
            print(f"{verdict}: {entry.text}\n{why}")
    assert counts[NOT_READ] <= 0.02 * len(found)
    assert {verdict for entry, verdict, _ in found if entry.family != "known relations"} <= {RIGHT, NOT_READ}


@pytest.mark.parametrize("entry", entries("asked"), ids=lambda entry: entry.text[:40])
def test_what_has_two_meanings_is_asked_back(entry):
    with pytest.raises(ValueError, match=re.escape(entry.asked)):
        check(entry.text, target(entry.target))
