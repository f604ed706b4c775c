"""Explain a wrong formula: the slip, the term in which it is, the step in which it happened."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
import sympy as sp
from sympy.polys.fields import sfield

from percept_obs.checking.deciding import points, rational, small
from percept_obs.checking.lines import VALUE, ZEROS
from percept_obs.checking.search import THROUGHOUT, Search, at, close
from percept_obs.checking.slips import MISTAKES, Slip, factored, siblings_in, slips_in
from percept_obs.checking.target import Target

SECONDS = 1.2
"""Time limit of the search for slips; what was found by then is reported."""


@dataclass(frozen=True)
class Difference:
    """A product of letters whose coefficient differs: yours, and the true one."""

    product: sp.Expr
    mine: sp.Expr
    true: sp.Expr


@dataclass(frozen=True)
class Explanation:
    """Slips that mend a wrong line, and the steps of the derivation in which they can have happened.

    A slip "missing" has nothing before, and "throughout" concerns all terms; `wrong` numbers my terms that hold a
    product with a wrong coefficient.  `apart` has the steps of each of two slips by itself.
    """

    slips: tuple[Slip, ...] = ()
    differences: tuple[Difference, ...] = ()
    wrong: tuple[int, ...] = ()
    steps: tuple[str, ...] = ()
    apart: tuple[tuple[str, ...], ...] = ()


def explained(mine: sp.Expr, row: int, target: Target, right: Mapping[int, sp.Expr]) -> Explanation:
    """Explain a wrong line, a row of the target.

    No step is blamed that would have spoiled the lines that are right as well.
    """
    line = target.lines[row]
    search = Search(mine, line, frozenset(target.letters.values()), time.thread_time() + SECONDS)
    if not search.places:
        return Explanation()
    one = search.single()
    everywhere = None if one else search.throughout()
    steps = tuple(_steps(search, row, target, right)) if line.kind == VALUE else ()
    differences, wrong = ((), ()) if line.kind == ZEROS else compared(mine, line.formula)
    found = tuple(filter(None, (one, everywhere)))
    if found or steps:
        return Explanation(found, differences, wrong, steps)
    found = _left_out(search, differences, wrong) or search.pair()
    return Explanation(found, differences, wrong, steps, tuple(_apart(search, found, row, target)))


def _left_out(search: Search, differences: Sequence[Difference], wrong: Sequence[int]) -> tuple[Slip, ...]:
    """Return the terms that lack one and the same factor, as a bracket does behind which it was forgotten."""
    extra = {d.product: d.mine for d in differences if d.true == 0}
    lacking = {d.product: d.true for d in differences if d.mine == 0}
    if search.line.kind != VALUE or not extra or len(extra) + len(lacking) < len(differences):
        return ()
    for product in lacking:
        factor = product / next(iter(extra))
        if {p * factor: c for p, c in extra.items()} != lacking:
            continue
        mended = sum(term * (factor if k in wrong else 1) for k, term in enumerate(search.terms))
        if close(search.values(mended), search.values(search.line.formula)):
            terms = [((k,) if search.mine.is_Add else (), search.terms[k]) for k in wrong]
            return tuple(Slip("left-out factor", sp.S.One, factor, at, t, t * factor) for at, t in terms)
    return ()


def _apart(search: Search, slips: Sequence[Slip], row: int, target: Target) -> Iterator[tuple[str, ...]]:
    """Yield the steps in which each of two slips in different terms can have happened, with the other one mended."""
    at = [slip.path[0] if slip.path and search.mine.is_Add else None for slip in slips]
    if len(slips) != 2 or at[0] == at[1] or any(slip.kind in ("replaced", *THROUGHOUT) for slip in slips):
        return
    for other, place in zip(reversed(slips), reversed(at), strict=True):
        alone = search.mine - (0 if place is None else search.terms[place]) + other.formula
        steps = _steps(replace(search, mine=alone, until=time.thread_time() + SECONDS), row, target, {})
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
    return str(e).replace("**", "^").replace("*", " ")


def wrong_terms(found: Explanation, mine: sp.Expr) -> list[tuple[tuple[int, ...], sp.Expr]]:
    """Return the places of wrong terms and the terms; a missing term has no place."""
    places: dict[tuple[int, ...], sp.Expr] = {}
    for path in [slip.path for slip in found.slips if slip.path or slip.kind not in ("missing", *THROUGHOUT)]:
        # up from the slip to the term in which it is
        while path and not at(mine, path[:-1]).is_Add:
            path = path[:-1]
        places[path] = at(mine, path)
    if not found.slips:
        indices = [(k,) for k in found.wrong] if mine.is_Add else [()]
        places |= {path: at(mine, path) for path in indices}
    return [(path, term) for path, term in places.items() if not any(path[:n] in places for n in range(len(path)))]


def sentences(found: Explanation, mine: sp.Expr, show: Callable[[sp.Basic], str]) -> tuple[list[str], ...]:
    """Return three lists of sentences: where to look, what is wrong, in which step; `show` prints formulas."""
    terms = [show(term) for _, term in wrong_terms(found, mine)]
    places = [f"look at {', '.join(terms)}"] if terms else []
    lacking = [d for d in found.differences if d.mine == 0]
    if any(slip.kind == "missing" for slip in found.slips) or (not found.slips and lacking):
        places.append("something is missing")
    slips = [_sentence(slip, show) for slip in found.slips]
    slips += [f"{show(d.product)}: you have {_signed(d.mine)}, it is {_signed(d.true)}" for d in found.differences[:6]]
    steps = [f"{'or' if k else 'it comes out so'} if in step {step}" for k, step in enumerate(found.steps)]
    for which, each in zip(("first", "second"), found.apart, strict=False):
        steps += [f"{'or' if k else f'the {which} slip comes out so'} if in step {step}" for k, step in enumerate(each)]
    return places or ["look at what all terms share"], slips, steps


def _signed(number: sp.Expr) -> str:
    return f"{'+' if number.is_positive else ''}{number}"


def _sentence(slip: Slip, show: Callable[[sp.Basic], str]) -> str:
    before, after, kind = show(slip.before), show(slip.after), slip.kind
    where = f" in {show(slip.term)}" if slip.term not in (slip.before, slip.after) and kind not in THROUGHOUT else ""
    if kind in ("letter", "other letter", "throughout"):
        hats = {"hat" in getattr(side, "name", "") for side in (slip.before, slip.after)}
        what = "the hat: " if len(hats) == 2 else "the index: " if kind != "other letter" else ""
        return f"{what}{before} stands {'everywhere ' if kind == 'throughout' else ''}where {after} belongs{where}"
    if kind == "left-out factor":
        return f"{show(slip.term)} should be {show(slip.term * slip.after / slip.before)}"
    return {
        "sign": f"all signs of {before} are turned" if slip.before.is_Add else f"the sign of {before} is wrong",
        "left out": f"{before} should be {after}: an inverse or a transpose is missing",
        "exponent": f"the exponent {before} should be {after}{where}",
        "missing": f"the term {after} is missing{where}",
        "factor": f"{before} should be {after}: the factor is wrong",
        "replaced": f"{before} should be {after}",
        "superfluous": f"the term {before} is one too many",
        "swapped": f"{before} and {after} are swapped",
        "sign throughout": f"{before} has the wrong sign everywhere",
        "signs": f"{before} have the wrong sign everywhere, as in a cross product with the other sign",
        "transpose": f"indices are swapped, as in the transposed matrix: {before} stands where {after} belongs",
    }[kind]


def compared(mine: sp.Expr, true: sp.Expr) -> tuple[tuple[Difference, ...], tuple[int, ...]]:
    """Return products whose coefficients differ, and the numbers of my terms that hold one.

    Denominators are cleared first; nothing is found in formulas that are too large to multiply out.
    """
    if not small(mine, true):
        return (), ()
    parts = [*sp.Add.make_args(mine), true]
    letters = _letters_for_functions(parts)
    field, elements = sfield([part.xreplace(letters) for part in parts])
    common = field.ring.one
    for element in elements:
        common = common.lcm(element.denom)
    polynomials = [element.numer * (common.quo(element.denom)) for element in elements]
    *own, target = [dict(p.terms()) for p in polynomials]
    total = dict(sum(polynomials[:-1], field.ring.zero).terms())
    back = {letter: function for function, letter in letters.items()}
    differ = [m for m in {**target, **total} if total.get(m, 0) != target.get(m, 0)]
    found = [
        Difference(
            sp.Mul(*(g**k for g, k in zip(field.symbols, m, strict=True))).xreplace(back),
            *(sp.sympify(field.domain.to_sympy(side.get(m, field.domain.zero))) for side in (total, target)),
        )
        for m in differ
    ]
    wrong = tuple(k for k, part in enumerate(own) if any(m in part for m in differ))
    return tuple(found), wrong


def _letters_for_functions(parts: Sequence[sp.Expr]) -> dict[sp.Expr, sp.Symbol]:
    """Return a letter for every root and function, the same one for equal values."""
    if all(map(rational, parts)):
        return {}
    point = next(points(*parts, opaque=True), None)
    outermost: dict[sp.Expr, sp.Symbol] = {}

    def visit(node: sp.Basic) -> None:
        if node.is_Symbol or node.is_Rational:
            return
        if node.is_Add or node.is_Mul or (node.is_Pow and node.exp.is_Integer):
            for part in node.args:
                visit(part)
        else:
            outermost[node] = sp.Symbol(f"f{complex(point(node)):.10e}" if point else f"f{node}")

    for part in parts:
        visit(part)
    return outermost
