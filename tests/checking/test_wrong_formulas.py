"""Wrong formulas are refused, their wrong term is found, and the slip is named."""

import time
from dataclasses import dataclass
from functools import cache

import pytest
from derivations import is_found
from formula_corpus import entries, target
from sample_sizes import sampled

from percept_obs import check
from percept_obs.checking.explaining import wrong_terms


@dataclass(frozen=True)
class Found:
    """Words of a review of a wrong formula, and the seconds of computing that it took."""

    refused: bool
    located: bool
    named: bool
    seconds: float
    said: str


@cache
def found(entry):
    """Review of an entry of the corpus."""
    asked = target(entry.target)
    start = time.process_time()
    try:
        review = check(entry.text, asked)
    except ValueError as error:
        return Found(False, False, False, time.process_time() - start, str(error))
    where, said = (str(review.hint(k)) for k in (2, 3))
    seconds = time.process_time() - start
    located = review.right is False and _located(entry, review, where, asked)
    return Found(review.right is False, located, located and entry.slip in said, seconds, said)


def _located(entry, review, where, asked):
    marked = [term for k, found in review.explanations.items() for _, term in wrong_terms(found, review.lines[k].mine)]
    if entry.term in ("missing", "all"):
        return entry.term in where if entry.term == "missing" else not marked
    head = "\n".join(entry.text.splitlines()[:-1])
    terms = [asked.read(f"{head}\n{term}").lines[-1].formula for term in entry.term.split(";")]
    return all(is_found(term, marked) for term in terms)


def shares(chosen):
    """Shares of entries that are refused, located and named."""
    all_found = [found(entry) for entry in chosen]
    told = ("refused", "located", "named")
    return {name: sum(getattr(one, name) for one in all_found) / len(all_found) for name in told}


@pytest.mark.slow
def test_wrong_formulas_are_refused_located_and_named():
    """Every fourth one; all of them with ALL_SAMPLES=1."""
    wrong = entries("wrong")[:: sampled(4, 1)]
    own = [entry for entry in wrong if "own surface" in entry.target]
    for entry in wrong:
        one = found(entry)
        if not (one.refused and one.located and one.named):
            print(f"\n{entry}\n{one}")
    print(f"\n{len(wrong)} wrong formulas: {shares(wrong)}\n{len(own)} on own surfaces: {shares(own)}")
    print(f"longest {max(found(entry).seconds for entry in wrong):.1f} s")
    told, on_own = shares(wrong), shares(own)
    assert told["refused"] == 1
    assert told["located"] >= 0.9
    assert told["named"] >= 0.8
    assert on_own["named"] >= 0.7
