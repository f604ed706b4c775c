"""Search for changes that mend a formula: single slips by the difference they make, pairs by the sum of two."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import chain, islice, takewhile
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.checking.deciding import points, same_zeros, small
from percept_obs.checking.lines import VALUE, ZEROS, Line
from percept_obs.checking.places import aligned, at, place_of, put, term_places
from percept_obs.checking.points import NoValue, Point
from percept_obs.checking.slips import MENDS, Slip, factored, family, siblings_in, slips_in, symbols_in

Values = np.ndarray[Any, Any]
ORDER = (
    *("sign", "left out", "letter", "exponent", "missing", "factor", "superfluous", "other letter", "left-out factor"),
    "replaced",
)
"""Kinds of slips, the likeliest first: of several changes that mend a line, the first one is named."""
KINDS_IN_ALL_TERMS = ("throughout", "swapped", "sign throughout", "signs", "transpose", "twins", "twin")
"""Kinds of slips that are made in all terms of a line."""


@dataclass(frozen=True)
class Spot:
    """Term or sum of a formula, outside of functions: its place, its values, and the formula's derivative by it."""

    path: tuple[int, ...]
    node: sp.Expr
    value: Values
    outer: Values


@dataclass(frozen=True)
class Search:
    """Search for changes that mend one line, until the clock of this thread shows `until`."""

    mine: sp.Expr
    line: Line
    letters: frozenset[sp.Symbol]
    until: float

    @property
    def over(self) -> bool:
        """True once the time is up."""
        return time.thread_time() > self.until

    @cached_property
    def places(self) -> list[Point]:
        """Points at which values are compared."""
        return list(islice(points(self.mine, self.line.formula, opaque=True), 3))

    def values(self, e: sp.Expr) -> Values | None:
        """Return the values of an expression at all points; None where one is missing or not finite."""
        try:
            found = np.array([point(e) for point in self.places])
        except NoValue:
            return None
        return found if np.isfinite(found).all() else None

    @cached_property
    def terms(self) -> tuple[sp.Expr, ...]:
        """Terms of my formula."""
        return sp.Add.make_args(self.mine)

    @cached_property
    def lacking(self) -> Values:
        """Values of the true formula less mine."""
        true, mine = self.values(self.line.formula), self.values(self.mine)
        return np.full(len(self.places), np.nan) if true is None or mine is None else true - mine

    @cached_property
    def changes(self) -> list[tuple[Values, Slip]]:
        """Every single slip with the values that it adds to the formula."""
        siblings = siblings_in(self.letters | symbols_in(self.mine))
        found: list[tuple[Values, Slip]] = []
        for k, term in enumerate(self.terms):
            start = (k,) if self.mine.is_Add else ()
            before = self.values(term)
            others = chain(_other_functions(term), self.other_letters(term))
            for slip in chain(factored(term, MENDS), slips_in(term, siblings, MENDS), others):
                if self.over:
                    return found
                after = self.values(slip.formula)
                if before is not None and after is not None:
                    named = replace(slip, path=(*start, *slip.path), term=slip.term if slip.path else term)
                    found.append((after - before, named))
        whole = self.line.formula
        # every term of the true formula may be missing, as it is written or multiplied out
        expanded = sp.expand(whole) if small(whole) else whole
        for term in dict.fromkeys((*sp.Add.make_args(expanded), *sp.Add.make_args(whole))):
            if (added := self.values(term)) is not None:
                found.append((added, Slip("missing", sp.S.Zero, term, (), term, term)))
        return found

    def other_letters(self, term: sp.Expr) -> Iterator[Slip]:
        """Yield a term with a letter of the same index for another, as v_p1 for v_c1."""
        for a in sorted(term.free_symbols, key=str):
            for b in sorted(self.letters - {a}, key=str):
                differ = [x + y for x, y in zip(a.name, b.name, strict=False) if x != y]
                if len(a.name) == len(b.name) > 2 and len(differ) == 1 and differ[0].isalpha():
                    path = place_of(a, term)
                    yield Slip("other letter", a, b, path, term, put(term, path, b))

    def mends(self, added: Values, slip: Slip) -> bool:
        """Return True if a slip, which adds these values, makes the line right."""
        if self.line.kind == VALUE:
            return close(added, self.lacking)
        if self.line.kind == ZEROS:
            old = self.terms[slip.path[0] if self.mine.is_Add else 0] if slip.kind != "missing" else sp.S.Zero
            return bool(same_zeros(self.mine - old + slip.formula, self.line.formula))
        true = np.array([point(self.line.formula) for point in self.places])
        # an equation or inequality is right up to a number, so its ratio to the true one must be constant
        changed = true - self.lacking + added
        return bool(np.all(changed != 0)) and close(changed * true[0], true * changed[0])

    def single(self) -> Slip | None:
        """Return the plainest single change that mends the formula."""
        # of a relation, which is the same times a number, as it is written if that will do
        ways = [_as_mistake(slip) for added, slip in self.changes if close(added, self.lacking)]
        for added, slip in self.changes if not ways and self.line.kind != VALUE else ():
            if self.over and self.line.kind == ZEROS:
                break
            if self.mends(added, slip):
                ways.append(_as_mistake(slip))
        # a term that is there only once all is multiplied out is named last
        written = [Slip("missing", sp.S.Zero, t, (), t, t) for t in sp.Add.make_args(self.line.formula)]
        late = [slip for slip in ways if slip.kind == "missing" and slip not in written]
        if self.line.kind != ZEROS and len(late) == len(ways):
            ways = [*self.by_ratio(), *(ways or [*self.missing_inside(), *self.in_its_place()])]
        return min(ways, key=lambda s: (s in late, ORDER.index(s.kind), len(s.path)), default=None)

    def array(self, parts: Sequence[sp.Expr]) -> Values | None:
        """Return the values of several expressions, one in a row."""
        found = [self.values(part) for part in parts]
        return None if any(one is None for one in found) else np.array(found)

    @cached_property
    def spots(self) -> list[Spot]:
        """All terms and sums outside of functions."""
        u = sp.Symbol("one more", real=True)
        one, whole = self.values(u), self.values(self.mine)
        found: list[Spot] = []
        for path, node in takewhile(lambda _: not self.over, term_places(self.mine)):
            # outside of functions the formula is linear in the node, so one difference gives its derivative
            moved, now = self.values(put(self.mine, path, node + u)), self.values(node)
            if moved is not None and now is not None and one is not None:
                found.append(Spot(path, node, now, (moved - whole) / one))
        return found

    @cached_property
    def factors(self) -> list[tuple[sp.Expr, Values]]:
        """Factors that a term may lack, with their values: letters, roots, functions, sums, 2 and a sign."""
        parts: dict[sp.Expr, None] = dict.fromkeys((sp.Integer(-1), sp.Integer(2), sp.S.Half))
        parts |= dict.fromkeys(sorted(self.letters, key=str))
        for node in chain(*map(sp.preorder_traversal, (self.mine, self.line.formula))):
            if node.is_Function or (node.is_Pow and not node.exp.is_Integer):
                parts[node] = None
            elif node.is_Mul and node.args:
                parts |= dict.fromkeys(f for f in node.args if f.is_Add)
        found = ((part, self.values(part)) for part in parts)
        return [(part, value) for part, value in found if value is not None]

    def by_ratio(self) -> Iterator[Slip]:
        """Yield terms with a wrong factor, found from the ratio that they lack: a number or a quotient of letters."""
        for spot in self.spots:
            path, node = spot.path, spot.node
            with np.errstate(all="ignore"):
                # a wrong factor turns the node v into v r, and what lacks is outer v (r - 1)
                ratio = self.lacking / spot.outer / spot.value + 1
            if not np.all(np.isfinite(ratio)):
                continue
            number = Fraction(float(ratio[0].real)).limit_denominator(1000)
            if close(ratio, float(number) + 0 * ratio) and number != 1:
                (slip,) = factored(node, replace(MENDS, factors=(sp.Rational(number.numerator, number.denominator),)))
                yield _as_mistake(replace(slip, path=path))
            elif _rounded(ratio) in self.ratios:
                right, wrong = self.ratios[_rounded(ratio)]
                letter = -right if right.could_extract_minus_sign() else right
                # a factor that is missing or one too many has 1 on the other side
                if 1 in (letter, wrong):
                    kind = "left-out factor"
                else:
                    letters = letter.is_Symbol and wrong.is_Symbol
                    kind = "letter" if letters and family(letter) == family(wrong) else "other letter"
                yield Slip(kind, wrong, right, path, node, put(self.mine, path, node * right / wrong))

    def missing_inside(self) -> Iterator[Slip]:
        """Yield terms of the true formula that are missing in one of my brackets."""
        sums = [node for node in sp.preorder_traversal(self.line.formula) if node.is_Add]
        # a bracket may have been multiplied out, so that its terms are looked for in both ways
        terms = dict.fromkeys(chain.from_iterable((*e.args, *(sp.expand(e).args if small(e) else ())) for e in sums))
        known = {_rounded(c * v): c * e for e in terms for c in (-1, 1) if (v := self.values(e)) is not None}
        for spot in self.spots:
            with np.errstate(all="ignore"):
                term = known.get(_rounded(self.lacking / spot.outer)) if spot.node.is_Add and spot.path else None
            if term is not None:
                changed = put(self.mine, spot.path, spot.node + term)
                yield Slip("missing", sp.S.Zero, term, spot.path, spot.node, changed)

    def in_its_place(self) -> Iterator[Slip]:
        """Yield the one part that differs where both formulas have the same structure."""
        path, mine, true = aligned(self.mine, self.line.formula)
        changed = put(self.mine, path, true)
        if not path or not close(self.values(changed), self.values(self.line.formula)):
            return
        kind, lost = "replaced", sp.Add.make_args(true - mine)
        quotient = true / mine if mine != 0 else true
        if quotient == -1:
            yield Slip("sign", mine, true, path, mine, changed)
        elif quotient.is_Symbol:
            yield Slip("left-out factor", sp.S.One, quotient, path, mine, changed)
        # the part has a term too many and one too few: perhaps one term with a wrong letter
        if len(lost) == 2:
            known = {t.as_coeff_Mul()[1] for t in sp.Add.make_args(mine)}
            lacking, extra = sorted(lost, key=lambda t: t.as_coeff_Mul()[1] in known)
            one = Slip("missing", sp.S.Zero, lacking, path, lacking, changed)
            yield from (
                way[0] for way in _as_a_letter(one, Slip("superfluous", -extra, sp.S.Zero, path, -extra, changed))
            )
        if (true.is_Add and mine in true.args) or (true.is_Add and mine.is_Add and set(mine.args) < set(true.args)):
            kind, mine, true = "missing", sp.S.Zero, true - mine
        elif mine.is_Add and (true in mine.args or (true.is_Add and set(true.args) < set(mine.args))):
            kind, mine, true = "superfluous", mine - true, sp.S.Zero
        elif mine.is_Add and true.is_Add:  # only what differs
            both = set(mine.args) & set(true.args)
            mine, true = (sp.Add(*(t for t in e.args if t not in both)) for e in (mine, true))
        yield Slip(kind, mine, true, path, at(self.mine, path), changed)

    @cached_property
    def ratios(self) -> dict[tuple[float, ...], tuple[sp.Expr, sp.Expr]]:
        """Quotients of two factors, or of a factor and 1, by their values."""
        one = (sp.S.One, np.ones(len(self.places)))
        factors = [one, *((f, values) for f, values in self.factors if not f.is_number)]
        squares = [(f**2, values**2) for f, values in factors if f.is_Symbol]
        with np.errstate(all="ignore"):
            # plainer ones last, for they take the place of the others
            pairs = [(a, x, b, y) for a, x in reversed(factors) for b, y in reversed(factors) if _are_mistaken(a, b)]
            pairs.sort(key=lambda pair: sp.S.One in (pair[0], pair[2]))
            return {_rounded(x): (a, sp.S.One) for a, x in squares} | {
                _rounded(c * x / y): (c * a, b) for a, x, b, y in pairs for c in (-1, 1)
            }

    def pair(self) -> tuple[Slip, ...]:
        """Return two changes that mend the formula together: in different terms, or in one."""
        if self.line.kind != VALUE:
            return ()
        # two changes in different terms add up: look the rest of each up by its rounded values, not all pairs
        by_value: dict[tuple[float, ...], list[Slip]] = {}
        for added, slip in self.changes:
            by_value.setdefault(_rounded(added), []).append(slip)
        ways = []
        for added, slip in self.changes:
            for other in by_value.get(_rounded(self.lacking - added), ()):
                if other is not slip and (not slip.path or not other.path or slip.path[0] != other.path[0]):
                    ways.append((_as_mistake(slip), _as_mistake(other)))
        # a term too many and one that is missing are one term replaced, which is told only if nothing else mends
        plain_ways = [two for two in ways if {slip.kind for slip in two} != {"superfluous", "missing"}]
        if plain_ways:
            best = min(plain_ways, key=lambda two: sum(ORDER.index(slip.kind) for slip in two))
            return next((one for two in plain_ways for one in _as_a_letter(*two)), None) or best
        twice = next(self._twice_in_a_term(), ())
        if twice or not ways:
            return twice
        old, new = sorted(min(ways, key=lambda two: len(str(two))), key=lambda slip: slip.kind == "missing")
        return (replace(old, kind="replaced", after=new.after),)

    def _twice_in_a_term(self) -> Iterator[tuple[Slip, ...]]:
        siblings = siblings_in(self.letters | symbols_in(self.mine))
        for k, term in enumerate(self.terms):
            start = (k,) if self.mine.is_Add else ()
            before = self.values(term)
            if before is None:
                continue
            for first in chain(factored(term, MENDS), slips_in(term, siblings, MENDS)):
                if self.over:
                    return
                for second in chain(factored(first.formula, MENDS), slips_in(first.formula, siblings, MENDS)):
                    after = self.values(second.formula)
                    if after is not None and close(after - before, self.lacking):
                        # the second one's place is that of a term which the first one has changed, or moved
                        paths = first.path, place_of(second.term, term) if second.path else ()
                        yield tuple(
                            _as_mistake(replace(slip, path=(*start, *path), term=slip.term if slip.path else term))
                            for slip, path in zip((first, second), paths, strict=True)
                        )


def _are_mistaken(a: sp.Expr, b: sp.Expr) -> bool:
    """Return True for two factors that may be mistaken for each other as a whole, and do not differ inside."""
    return a != b and (a.is_Symbol or b.is_Symbol or a.func != b.func)


FUNCTIONS = {sp.sin: sp.cos, sp.cos: sp.sin, sp.sinh: sp.cosh, sp.cosh: sp.sinh}


def _other_functions(term: sp.Expr) -> Iterator[Slip]:
    """Yield a term with a sine for a cosine, and the like."""
    for node in dict.fromkeys(e for e in sp.preorder_traversal(term) if e.func in FUNCTIONS):
        path, other = place_of(node, term), FUNCTIONS[node.func](*node.args)
        yield Slip("other letter", node, other, path, term, put(term, path, other))


def _as_a_letter(one: Slip, other: Slip) -> Iterator[tuple[Slip]]:
    """Yield two slips as one wrong letter, which made its term equal to another one or cancel it."""
    for lost, merged in ((one, other), (other, one)):
        wrong = merged.before - merged.after
        if lost.kind == "missing" and merged.kind in ("missing", "factor", "superfluous"):
            for a in lost.after.free_symbols:
                for b in wrong.free_symbols - {a}:
                    if family(a) == family(b) and lost.after.xreplace({a: b}) == wrong:
                        yield (Slip("letter", b, a, merged.path, wrong, lost.after),)


def close(a: Values | None, b: Values | None) -> bool:
    """Return True if values agree to nine digits."""
    if a is None or b is None:
        return False
    return bool(np.all(np.abs(a - b) <= 1e-9 * np.maximum(1, np.abs(b))))


def _rounded(values: Values) -> tuple[float, ...]:
    return tuple(np.round(values, 7) + 0.0)


def _as_mistake(slip: Slip) -> Slip:
    """Return a change as the mistake that it mends: a term that must be dropped was superfluous."""
    return replace(slip, kind="superfluous") if slip.kind == "dropped" else slip
