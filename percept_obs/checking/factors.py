"""Find a factor that several terms of a sum lack, and a bracket that is missing."""

from collections.abc import Iterator, Sequence
from functools import cache
from itertools import combinations, takewhile
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.checking.places import at, put
from percept_obs.checking.search import Search, close
from percept_obs.checking.slips import Slip

LARGEST_SUM = 10
"""Most terms of a sum of which every choice is tried; of longer ones two to four terms, and all."""
LONGEST_BRACKET = 7
"""Most terms of a sum in which a forgotten bracket is looked for."""


def terms_lacking_a_factor(search: Search) -> tuple[Slip, ...]:
    """Return a slip for each term of a sum that lacks the same factor, such as -1; nothing if none is found."""
    for spot in takewhile(lambda _: not search.over, search.spots):
        terms = spot.node.args if spot.node.is_Add else ()
        if len(terms) < 2 or (values := search.array(terms)) is None:
            continue
        masks = _choices(len(terms))
        for factor, f in _factors_to_try(search):
            # a term t that lacks the factor f adds t (f - 1) once mended: all choices of terms in one product
            sums = masks @ (values * spot.outer * (f - 1))
            hit = next(iter(np.flatnonzero(_near(sums, search.lacking))), None)
            if hit is None:
                continue
            lacking = [k for k in range(len(terms)) if masks[hit, k]]
            new = sp.Add(*(t * factor if k in lacking else t for k, t in enumerate(terms)))
            whole = put(search.mine, spot.path, new)
            if close(search.values(whole), search.values(search.line.formula)):
                kind = "sign" if factor == -1 else "left-out factor"
                above, below = factor.as_numer_denom() if not factor.is_number else (factor, sp.S.One)
                return tuple(
                    Slip(kind, terms[k] if factor == -1 else below, above, (*spot.path, k), terms[k], whole)
                    for k in lacking
                )
    return ()


def _factors_to_try(search: Search) -> Iterator[tuple[sp.Expr, Any]]:
    """Yield factors that terms may lack, then letters with a minus, then inverses of letters that are one too many."""
    yield from search.factors
    letters = [(letter, f) for letter, f in search.factors if letter in search.mine.free_symbols]
    yield from ((-letter, -f) for letter, f in letters)
    yield from ((1 / letter, 1 / f) for letter, f in letters)


def terms_of_a_forgotten_bracket(search: Search) -> tuple[Slip, ...]:
    """Return a slip for each term that belongs into a forgotten bracket: -a + b c was typed for -(a + b) c."""
    for spot in takewhile(lambda _: not search.over, search.spots):
        terms = spot.node.args if spot.node.is_Add and len(spot.node.args) <= LONGEST_BRACKET else ()
        if len(terms) < 2 or (values := search.array(terms)) is None:
            continue
        for first, last, factor in _bracket_ends(terms):
            f = search.values(factor)
            # -a + t + b c is to be -(a + t + b) c: what each term adds once mended is linear in the choice of terms t
            between = [k for k in range(len(terms)) if k not in (first, last)]
            if f is None:
                continue
            masks = _all_choices(len(between))
            ends = values[first] * (f - 1) - 2 * values[last]
            sums = (masks @ (values[between] * (-f - 1)) if between else 0) + ends
            for hit in np.flatnonzero(_near(np.atleast_2d(sums) * spot.outer, search.lacking)):
                inside = [first, *(k for j, k in enumerate(between) if masks[hit, j]), last]
                before = sp.Add(*(terms[k] for k in inside))
                signed = [-terms[first], *(terms[k] for k in inside[1:-1]), terms[last] / factor]
                after = sp.Mul(-1, factor, sp.Add(*signed), evaluate=False)
                return tuple(Slip("bracket", before, after, (*spot.path, k), terms[k], search.mine) for k in inside)
    return ()


def bracket(slips: Sequence[Slip], search: Search) -> sp.Expr | None:
    """Return the product c (a + b) that was perhaps meant where a + b c is typed, a and b alike; None if none fits."""
    factor, path = slips[0].after, slips[0].path
    parent = at(search.mine, path[:-1])
    if not path or not parent.is_Add or len(slips) > 2 or factor.is_number or factor.could_extract_minus_sign():
        return None
    lacking = [parent.args[slip.path[-1]] for slip in slips]
    similar = [
        rest
        for term in parent.args
        if term not in lacking
        and not (rest := term / factor).has(factor)
        and _factors(rest) <= _factors(lacking[0]) + 1
        if _stems(rest) & _stems(lacking[0]) or rest == 1
    ]
    return (
        sp.Mul(factor, sp.Add(*lacking, min(similar, key=lambda e: len(str(e)))), evaluate=False) if similar else None
    )


def _stems(e: sp.Expr) -> set[str]:
    return {s.name[0] for s in e.free_symbols}


def _factors(e: sp.Expr) -> int:
    return len([f for f in sp.Mul.make_args(e) if not f.is_number])


def _bracket_ends(terms: Sequence[sp.Expr]) -> Iterator[tuple[int, int, sp.Expr]]:
    """Yield the first term -a and the last term b c of a bracket that may be missing, by their numbers, and c."""
    for first, last in combinations(range(len(terms)), 2):
        for a, b in ((first, last), (last, first)):
            if terms[a].could_extract_minus_sign():
                yield from ((a, b, f) for f in sp.Mul.make_args(terms[b]) if not f.is_number)


def _near(sums: Any, lacking: Any) -> Any:
    return np.all(np.abs(sums - lacking) <= 1e-9 * np.maximum(1, np.abs(lacking)), axis=-1)


@cache
def _all_choices(count: int) -> Any:
    return np.array([[n >> k & 1 for k in range(count)] for n in range(2**count)]).reshape(2**count, count)


@cache
def _choices(count: int) -> Any:
    """Return choices of two or more of so many terms, few terms first."""
    if count <= LARGEST_SUM:
        masks = _all_choices(count)
        masks = masks[masks.sum(axis=1) > 1]
        return masks[np.argsort(masks.sum(axis=1), kind="stable")]
    # 2^n choices are too many: people forget a factor in few terms, or in all
    chosen = [c for size in (2, 3, 4) for c in combinations(range(count), size)] if count <= 24 else []
    masks = np.zeros((len(chosen) + 1, count), dtype=int)
    for row, columns in enumerate(chosen):
        masks[row, list(columns)] = 1
    masks[-1] = 1
    return masks
