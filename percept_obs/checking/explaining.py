"""Explain a wrong formula: the slip, the term in which it is, the step in which it happened."""

import re
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
import sympy as sp

from percept_obs.checking.deciding import square_apart
from percept_obs.checking.differences import Difference, compared
from percept_obs.checking.factors import bracket, terms_lacking_a_factor, terms_of_a_forgotten_bracket
from percept_obs.checking.limits import left
from percept_obs.checking.lines import VALUE, ZEROS, Line
from percept_obs.checking.places import at, leaves_apart
from percept_obs.checking.search import KINDS_IN_ALL_TERMS, Search, close
from percept_obs.checking.slips import MISTAKES, Slip, factored, is_symbol, siblings_in, slips_in
from percept_obs.checking.target import Target
from percept_obs.checking.throughout import change_of_all_terms, confusion, slip_in_all_copies, swap_in_a_bracket

MOST_TERMS = 12
"""Largest number of wrong terms that are listed."""
SECONDS = 1.2
"""Time limit of the search for slips; what was found by then is reported."""
NO_VALUES = "this has no values that can be compared; look for a division by zero, or for powers of powers"
MANY = "there are more than two slips, or a larger one"


@dataclass(frozen=True)
class Explanation:
    """Slips that mend a wrong line, and the steps of the derivation in which they can have happened.

    A slip "missing" has nothing before, and "throughout" concerns all terms; `wrong` numbers my terms that hold a
    product with a wrong coefficient.  `apart` has the steps of each of two slips by itself.  `whole` says what is wrong
    with the line as a whole, if there is a sentence for it, and `bracket` is one that may be missing.
    """

    slips: tuple[Slip, ...] = ()
    differences: tuple[Difference, ...] = ()
    wrong: tuple[int, ...] = ()
    steps: tuple[str, ...] = ()
    apart: tuple[tuple[str, ...], ...] = ()
    whole: str = ""
    bracket: sp.Expr | None = None


def explained(mine: sp.Expr, row: int, target: Target, right: Mapping[int, sp.Expr]) -> Explanation:
    """Explain a wrong line, a row of the target.

    No step is blamed that would have spoiled the lines that are right as well.
    """
    line = target.lines[row]
    if line.kind == ZEROS and (parts := square_apart(mine, line.formula)):  # of a sum of squares the one that differs
        place, part, true = parts
        inner = explained(part, 0, Target((Line("", true),), frozenset(target.letters.values())), {})
        if inner.slips and inner.whole != MANY:
            slips = tuple(replace(slip, path=(*place, *slip.path)) for slip in inner.slips)
            return Explanation(slips, bracket=inner.bracket)
    search = Search(mine, line, frozenset(target.letters.values()), time.thread_time() + min(SECONDS, 0.6 * left()))
    if not search.places:
        return Explanation(whole=NO_VALUES)
    if whole := confusion(search, row, target):
        return Explanation(whole=whole)
    found, whole = _found(search, target)
    steps = tuple(_steps(search, row, target, right)) if line.kind == VALUE else ()
    differences, wrong = ((), ()) if line.kind == ZEROS else compared(mine, line.formula)
    if not found and (missing := _missing(search, differences)):
        found = (missing,)
    if found or steps:
        lacks = bool(found) and found[0].kind == "left-out factor" and found[0].before == 1
        return Explanation(found, differences, wrong, steps, (), whole, bracket(found, search) if lacks else None)
    found = search.pair()
    apart = leaves_apart(found[0].before, found[0].after) if found and found[0].kind == "replaced" else []
    if not found or len(apart) > 2:
        whole = MANY
    if len(apart) == 2 and all(is_symbol(side) for pair in apart for side in pair):
        found = tuple(replace(found[0], kind="letter", before=a, after=b, term=found[0].before) for a, b in apart)
    return Explanation(found, differences, wrong, steps, tuple(_apart(search, found, row, target)), whole)


def _found(search: Search, target: Target) -> tuple[tuple[Slip, ...], str]:
    """Return the plainest changes that mend a line, and the convention that it follows besides."""
    # of zeros each single change takes long to compare
    if search.line.kind == ZEROS and (everywhere := change_of_all_terms(search)):
        return (everywhere,), ""
    one = search.single()
    # where all signs of a sum are turned, as by two letters swapped, the letters say more
    weak = one and (one.kind == "replaced" or (one.kind == "sign" and not one.path and one.before.is_Add))
    if one and not weak:
        return (one,), ""
    everywhere = change_of_all_terms(search) or swap_in_a_bracket(search)
    if one and one.kind == "sign" and (not everywhere or everywhere.kind != "twins"):
        return (one,), ""
    if everywhere or search.line.kind != VALUE:
        return (everywhere,) if everywhere else (), ""
    for convention in target.conventions:
        changes = dict(convention.changes)
        if len(search.line.formula.free_symbols & set(changes)) > 1:
            line = replace(search.line, formula=search.line.formula.xreplace(changes))
            one_more = Search(search.mine, line, search.letters, search.until).single()
            if one_more and one_more.kind != "replaced":
                return (one_more,), convention.words
    terms = terms_lacking_a_factor(search) or terms_of_a_forgotten_bracket(search) or slip_in_all_copies(search)
    return terms or ((one,) if one else ()), ""


def _missing(search: Search, differences: Sequence[Difference]) -> Slip | None:
    """Return the one missing product, if all that differs is absent from my line and factors into one product."""
    if search.line.kind != VALUE or not differences or any(d.mine != 0 for d in differences):
        return None
    term = sp.factor_terms(sp.factor(sp.Add(*(d.true * d.product for d in differences))))
    return None if term.is_Add else Slip("missing", sp.S.Zero, term, (), term, search.line.formula)


def _apart(search: Search, slips: Sequence[Slip], row: int, target: Target) -> Iterator[tuple[str, ...]]:
    """Yield the steps in which each of two slips in different terms can have happened, with the other one mended."""
    at = [slip.path[0] if slip.path and search.mine.is_Add else None for slip in slips]
    if len(slips) != 2 or at[0] == at[1] or any(slip.kind in ("replaced", *KINDS_IN_ALL_TERMS) for slip in slips):
        return
    for other, place in zip(reversed(slips), reversed(at), strict=True):
        alone = search.mine - (0 if place is None else search.terms[place]) + other.formula
        steps = _steps(Search(alone, search.line, search.letters, search.until + SECONDS / 3), row, target, {})
        yield tuple(steps)


def _steps(search: Search, row: int, target: Target, right: Mapping[int, sp.Expr]) -> Iterator[str]:
    """Yield the steps of the derivation in which one slip leads to my line and to the lines that are right.

    What follows from a step is linear in each of its values, which tells where to look; then it is worked out.
    """
    row_of = target.result
    if row not in row_of:
        return
    siblings = siblings_in(search.letters)
    moved = sp.Symbol("moved", real=True)
    unit = search.values(moved)
    if unit is None:
        return
    wanted = [(row_of[row], search.lacking)]
    wanted += [(row_of[other], 0 * unit) for other in right if other != row and other in row_of]
    for number, step in target.steps:
        names, values = list(step.values), list(step.values.values())
        truth = step.onward(values)
        for k, value in enumerate(values):
            if search.over:
                return
            shifted = step.onward([*values[:k], value + moved, *values[k + 1 :]])
            before, effects = search.values(value), []
            for r, lacking in wanted:
                after, true = search.values(shifted[r]), search.values(truth[r])
                if after is None or true is None or before is None:
                    break
                effects.append(((after - true) / unit, lacking))
            if len(effects) < len(wanted) or not np.any(np.abs(effects[0][0]) > 1e-9):
                continue
            slips = chain(factored(value, MISTAKES), slips_in(value, siblings, MISTAKES))
            slip = next(
                (
                    slip
                    for slip in slips
                    if (now := search.values(slip.formula)) is not None
                    and all(close(effect * (now - before), -lacking) for effect, lacking in effects)
                ),
                None,
            )
            if slip and close(
                search.values(step.onward([*values[:k], slip.formula, *values[k + 1 :]])[row_of[row]]),
                search.values(search.mine),
            ):
                yield f"{number} “{step.reason.rstrip(':')}”, {_said(names[k], slip)}"
                break


def _said(name: str, slip: Slip) -> str:
    """Describe a slip in a step."""
    what = plain(slip.before)
    if slip.kind == "dropped":
        return f"{name} was left out" if not slip.path else f"in {name} the term {what} was left out"
    if slip.kind == "sign":
        return f"in {name} the sign of {what} was turned"
    return f"in {name} {what} became {plain(slip.after)}"


def plain(e: sp.Basic) -> str:
    """Return an expression as it may be typed."""
    text = str(e).replace("**", "^").replace("*", " ")
    text = re.sub(r"\\int\\limits_\{(.*?)\}\^\{(.*?)\} (.*?)\\, d\\?(\w+)", r"int_\1^\2 \3 d\4", text)
    return re.sub(r"\b([A-Za-z]\w*?)inv_(\d+)", r"(\1^-1)_\2", re.sub(r"[{}\\]", "", text) if "int_" in text else text)


def wrong_terms(found: Explanation, mine: sp.Expr) -> list[tuple[tuple[int, ...], sp.Expr]]:
    """Return the places of wrong terms and the terms; a missing term has no place."""
    places: dict[tuple[int, ...], sp.Expr] = {}
    for path in [slip.path for slip in found.slips if slip.path or slip.kind not in ("missing", *KINDS_IN_ALL_TERMS)]:
        # up from the slip to the term in which it is
        while path and not at(mine, path[:-1]).is_Add:
            path = path[:-1]
        places[path] = at(mine, path)
    some = bool(found.wrong) and mine.is_Add and len(found.wrong) < len(mine.args)
    if not found.slips or (some and any(slip.kind in KINDS_IN_ALL_TERMS for slip in found.slips)):
        indices = [(k,) for k in found.wrong] if mine.is_Add else [()]
        places |= {path: at(mine, path) for path in indices}
    return [(path, term) for path, term in places.items() if not any(path[:n] in places for n in range(len(path)))]


def sentences(found: Explanation, mine: sp.Expr, show: Callable[[sp.Basic], str]) -> tuple[list[str], ...]:
    """Return three lists of sentences: where to look, what is wrong, in which step; `show` prints formulas."""
    wrong = wrong_terms(found, mine)
    terms = [show(term) for _, term in wrong[:MOST_TERMS]]
    more = f" and {len(wrong) - MOST_TERMS} others" if len(wrong) > MOST_TERMS else ""
    places = [f"look at {', '.join(terms)}{more}"] if terms else []
    lacking = [d for d in found.differences if d.mine == 0]
    if any(slip.kind == "missing" for slip in found.slips) or (not found.slips and lacking):
        places.append("something is missing")
    slips = [*([found.whole] if found.whole else []), *_slips_said(found, show)]
    slips += [f"{show(d.product)}: you have {_signed(d.mine)}, it is {_signed(d.true)}" for d in found.differences[:6]]
    steps = [f"{'or' if k else 'it comes out so'} if in step {step}" for k, step in enumerate(found.steps)]
    for which, each in zip(("first", "second"), found.apart, strict=False):
        steps += [f"{'or' if k else f'the {which} slip comes out so'} if in step {step}" for k, step in enumerate(each)]
    return places or [f"look at {'the whole line' if found.whole else 'what all terms share'}"], slips, steps


COUNTS = ("no", "one", "two", "three", "four", "five", "six", "seven")


def _slips_said(found: Explanation, show: Callable[[sp.Basic], str]) -> list[str]:
    """Return a sentence on each slip, or one on a factor that several terms lack."""
    slips = found.slips
    if len(slips) > 2 and slips[0].kind == "sign":
        return [f"more than two signs are wrong, those of {', '.join(show(slip.before) for slip in slips)}"]
    if not slips or slips[0].kind not in ("left-out factor", "bracket"):
        return [_sentence(slip, show) for slip in slips]
    first = slips[0]
    if first.kind == "bracket":
        return [f"a bracket is missing: {show(first.before)} should be {show(first.after)}"]
    also = f", or a bracket is missing: {show(found.bracket)}" if found.bracket is not None else ""
    if len(slips) == 1:
        return [_sentence(slip, show) + also for slip in slips]
    count = COUNTS[len(slips)] if len(slips) < len(COUNTS) else str(len(slips))
    if first.after == 1:
        terms = [show(slip.term) for slip in slips]
        return [f"the factor {show(first.before)} is one too many in {count} terms: {', '.join(terms)}"]
    terms = [f"{show(slip.term)} should be {show(slip.term * slip.after)}" for slip in slips]
    return [f"the factor {show(first.after)} is missing in {count} terms: {', '.join(terms)}{also}"]


def _signed(number: sp.Expr) -> str:
    return f"{'+' if number.is_positive else ''}{number}"


def _sentence(slip: Slip, show: Callable[[sp.Basic], str]) -> str:
    before, after, kind = show(slip.before), show(slip.after), slip.kind
    inside = slip.term not in (slip.before, slip.after) and kind not in KINDS_IN_ALL_TERMS
    where = f" in {show(slip.term)}" if inside else ""
    if kind in ("letter", "other letter", "throughout"):
        hats = {"hat" in getattr(side, "name", "") for side in (slip.before, slip.after)}
        what = "the hat: " if len(hats) == 2 else "the index: " if kind != "other letter" else ""
        return f"{what}{before} stands {'everywhere ' if kind == 'throughout' else ''}where {after} belongs{where}"
    if kind == "left-out factor":
        too_many = slip.after in (1, -1)
        which = f"the factor {before} is one too many" if too_many else f"the factor {after} is missing"
        return f"{which}: {show(slip.term)} should be {show(slip.term * slip.after / slip.before)}"
    return {
        "sign": f"all signs of {before} are turned" if slip.before.is_Add else f"the sign of {before} is wrong",
        "left out": f"{before} should be {after}: an inverse or a transpose is missing",
        "exponent": f"the exponent {before} should be {after}{where}",
        "missing": f"the term {after} is missing{where}",
        "factor": f"{before} should be {after}: the factor is wrong",
        "replaced": f"{before} should be {after}",
        "superfluous": f"the term {before} is one too many",
        "swapped": f"{before} and {after} are swapped",
        "twins": f"{before} and {after} are swapped",
        "twin": f"{before} stands everywhere where {after} belongs",
        "sign throughout": f"{before} has the wrong sign everywhere",
        "signs": f"{before} have the wrong sign everywhere, as in a cross product with the other sign",
        "transpose": f"indices are swapped, as in the transposed matrix: {before} stands where {after} belongs",
    }[kind]
