"""What people write is read, and judged right where it is right; what has two meanings is asked back."""

from collections import Counter

from formula_corpus import entries, target

from percept_obs import CannotRead, check


def outcome(entry):
    """Tell what the check made of an entry."""
    try:
        right = check(entry.text, target(entry.target)).right
    except CannotRead:
        return "not read"
    except ValueError:
        return "does not fit"
    return {True: "judged right", False: "judged wrong", None: "cannot tell"}[right]


def test_right_formulas_are_read_and_judged_right():
    found = {entry: outcome(entry) for entry in entries("right")}
    counts = Counter(found.values())
    print(f"\n{len(found)} right formulas: {dict(counts)}")
