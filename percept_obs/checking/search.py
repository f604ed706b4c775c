"""Search for changes that mend a formula: single slips by the difference they make, pairs by the sum of two."""

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import chain, islice, takewhile
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.checking.deciding import points, same_zeros, small
from percept_obs.checking.lines import VALUE, ZEROS, Line
from percept_obs.checking.points import NoValue, Point
from percept_obs.checking.slips import MENDS, Slip, factored, family, siblings_in, slips_in, symbols_in

Values = np.ndarray[Any, Any]
ORDER = (
    *("sign", "left out", "letter", "exponent", "missing", "factor", "superfluous", "other letter", "left-out factor"),
    "replaced",
)
THROUGHOUT = ("throughout", "swapped", "sign throughout", "signs", "transpose")


@dataclass(frozen=True)
class Search:
    """Search for changes that mend one line, until a time on the clock."""

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
            for slip in chain(factored(term, MENDS), slips_in(term, siblings, MENDS)):
                if self.over:
                    return found
                after = self.values(slip.formula)
                if before is not None and after is not None:
                    named = replace(slip, path=(*start, *slip.path), term=slip.term if slip.path else term)
                    found.append((after - before, named))
        whole = self.line.formula
        expanded = sp.expand(whole) if small(whole) else whole
        for term in dict.fromkeys((*sp.Add.make_args(expanded), *sp.Add.make_args(whole))):
            if (added := self.values(term)) is not None:
                found.append((added, Slip("missing", sp.S.Zero, term, (), term, term)))
        return found

    def mends(self, added: Values, slip: Slip) -> bool:
        """Return True if a slip, which adds these values, makes the line right."""
        if self.line.kind == VALUE:
            return close(added, self.lacking)
        if self.line.kind == ZEROS:
            old = self.terms[slip.path[0] if self.mine.is_Add else 0] if slip.kind != "missing" else sp.S.Zero
            return bool(same_zeros(self.mine - old + slip.formula, self.line.formula))
        true = np.array([point(self.line.formula) for point in self.places])
        changed = true - self.lacking + added
        return bool(np.all(changed != 0)) and close(changed * true[0], true * changed[0])

    def single(self) -> Slip | None:
        """Return the plainest single change that mends the formula."""
        ways = []
        for added, slip in self.changes:
            if self.over and self.line.kind == ZEROS:
                break
            if self.mends(added, slip):
                ways.append(_named(slip))
        if not ways and self.line.kind == VALUE:
            ways = [*self.by_ratio(), *self.in_its_place()]
        return min(ways, key=lambda slip: (ORDER.index(slip.kind), len(slip.path)), default=None)

    def by_ratio(self) -> Iterator[Slip]:
        """Yield terms with a wrong factor, found from the ratio that they lack: a number or a quotient of letters."""
        u = sp.Symbol("one more", real=True)
        one = self.values(u)
        for path, node in takewhile(lambda _: not self.over, _term_places(self.mine)):
            moved = self.values(put(self.mine, path, node + u))
            now = self.values(node)
            if moved is None or now is None or one is None:
                continue
            with np.errstate(all="ignore"):
                ratio = self.lacking * one / (moved - self.values(self.mine)) / now + 1
            if not np.all(np.isfinite(ratio)):
                continue
            number = Fraction(float(ratio[0].real)).limit_denominator(1000)
            if close(ratio, float(number) + 0 * ratio) and number != 1:
                (slip,) = factored(node, replace(MENDS, factors=(sp.Rational(number.numerator, number.denominator),)))
                yield _named(replace(slip, path=path))
            elif _rounded(ratio) in self.ratios:
                right, wrong = self.ratios[_rounded(ratio)]
                letter = -right if right.could_extract_minus_sign() else right
                if 1 in (letter, wrong):
                    kind = "left-out factor"
                else:
                    kind = "letter" if family(letter) == family(wrong) else "other letter"
                yield Slip(kind, wrong, right, path, node, put(self.mine, path, node * right / wrong))

    def in_its_place(self) -> Iterator[Slip]:
        """Yield the one part that differs where both formulas have the same structure."""
        path, mine, true = _aligned(self.mine, self.line.formula)
        changed = put(self.mine, path, true)
        if not path or not close(self.values(changed), self.values(self.line.formula)):
            return
        kind = "replaced"
        if (true.is_Add and mine in true.args) or (true.is_Add and mine.is_Add and set(mine.args) < set(true.args)):
            kind, mine, true = "missing", sp.S.Zero, true - mine
        elif mine.is_Add and (true in mine.args or (true.is_Add and set(true.args) < set(mine.args))):
            kind, mine, true = "superfluous", mine - true, sp.S.Zero
        yield Slip(kind, mine, true, path, at(self.mine, path), changed)

    @cached_property
    def ratios(self) -> dict[tuple[float, ...], tuple[sp.Expr, sp.Expr]]:
        """Quotients of two letters, or of a letter and 1, by their values."""
        letters = [sp.S.One, *sorted(self.letters, key=str)]
        values = [np.array([point(s) for point in self.places]) for s in letters]
        return {
            _rounded(c * x / y): (c * a, b)
            for a, x in zip(letters, values, strict=True)
            for b, y in zip(letters, values, strict=True)
            for c in (1, -1)
            if a != b
        }

    def throughout(self) -> Slip | None:
        """Return one change in all terms: a transpose, signs of letters, a letter for another, two letters swapped."""
        true, mine = self.values(self.line.formula), self.mine
        candidates: list[tuple[str, sp.Basic, sp.Basic, sp.Expr]] = []
        used = sorted(mine.free_symbols, key=str)
        flips = {a: b for a in used if (b := _transposed(a, self.letters))}
        if len(flips) > 1:
            candidates.append(("transpose", *next(iter(flips.items())), mine.xreplace(flips)))
        by_family: dict[object, list[sp.Symbol]] = {}
        for a in used:
            by_family.setdefault(family(a), []).append(a)
        for group in by_family.values():
            if len(group) > 1:
                turned = mine.xreplace({a: -a for a in group})
                candidates.append(("signs", sp.Tuple(*group), sp.Tuple(*(-a for a in group)), turned))
        for a in used:
            candidates.append(("sign throughout", a, -a, mine.xreplace({a: -a})))
            for b in sorted(self.letters - {a}, key=str):
                if family(a) == family(b):
                    candidates.append(("throughout", a, b, mine.xreplace({a: b})))
                    if b in mine.free_symbols and str(a) < str(b):
                        candidates.append(("swapped", a, b, mine.xreplace({a: b, b: a})))
        for kind, before, after, changed in takewhile(lambda _: not self.over, candidates):
            if close(self.values(changed), true):
                return Slip(kind, before, after, (), mine, changed)
        return None

    def pair(self) -> tuple[Slip, ...]:
        """Return two changes that mend the formula together: in different terms, or in one."""
        if self.line.kind != VALUE:
            return ()
        by_value: dict[tuple[float, ...], list[Slip]] = {}
        for added, slip in self.changes:
            by_value.setdefault(_rounded(added), []).append(slip)
        ways = []
        for added, slip in self.changes:
            for other in by_value.get(_rounded(self.lacking - added), ()):
                if other is not slip and (not slip.path or not other.path or slip.path[0] != other.path[0]):
                    ways.append((_named(slip), _named(other)))
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
                        paths = first.path, _place_of(second.term, term) if second.path else ()
                        yield tuple(
                            _named(replace(slip, path=(*start, *path), term=slip.term if slip.path else term))
                            for slip, path in zip((first, second), paths, strict=True)
                        )


def _aligned(mine: sp.Basic, true: sp.Basic) -> tuple[tuple[int, ...], sp.Basic, sp.Basic]:
    """Return the only part in which two formulas differ: its place, my part, the true part."""
    if mine.func != true.func or not mine.args:
        return (), mine, true
    left = [k for k, part in enumerate(mine.args) if part not in true.args]
    right = [part for part in true.args if part not in mine.args]
    if not (mine.is_Add or mine.is_Mul) and len(mine.args) == len(true.args):
        left = [k for k, (a, b) in enumerate(zip(mine.args, true.args, strict=True)) if a != b]
        right = [true.args[k] for k in left]
    if len(left) != 1 or len(right) != 1:
        return (), mine, true
    path, a, b = _aligned(mine.args[left[0]], right[0])
    return (left[0], *path), a, b


def at(e: Any, path: Sequence[int]) -> Any:
    """Return the part at a place of a formula."""
    for index in path:
        e = e.args[index]
    return e


def _place_of(part: sp.Basic, whole: sp.Basic) -> tuple[int, ...]:
    """Return the first place of a part; that of the whole if there is none."""
    paths: list[tuple[int, ...]] = [()]
    for path in paths:
        node = at(whole, path)
        if node == part:
            return path
        paths += [(*path, k) for k in range(len(node.args))]
    return ()


def put(formula: sp.Basic, path: Sequence[int], new: sp.Basic) -> sp.Basic:
    """Return a formula with another part at a place."""
    if not path:
        return new
    args = list(formula.args)
    args[path[0]] = put(args[path[0]], path[1:], new)
    return formula.func(*args)


def _as_a_letter(one: Slip, other: Slip) -> Iterator[tuple[Slip]]:
    """Yield one wrong letter where the wrong term was merged with another one or cancelled it."""
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


def _named(slip: Slip) -> Slip:
    """Rename a mend: a term to be dropped was superfluous."""
    return replace(slip, kind="superfluous") if slip.kind == "dropped" else slip


def _term_places(
    e: sp.Basic, path: tuple[int, ...] = (), is_term: bool = True
) -> Iterator[tuple[tuple[int, ...], sp.Expr]]:
    """Yield the places of all terms and sums outside of functions."""
    if is_term or e.is_Add:
        yield path, e
    if e.is_Add or e.is_Mul:
        for k, part in enumerate(e.args):
            yield from _term_places(part, (*path, k), bool(e.is_Add))


def _transposed(letter: sp.Symbol, letters: Iterable[sp.Symbol]) -> sp.Symbol | None:
    """Return the letter with its two indices swapped: a21 for a12."""
    name = letter.name
    if len(name) < 3 or not name[-2:].isdigit() or name[-1] == name[-2]:
        return None
    return next((s for s in letters if s.name == name[:-2] + name[-1] + name[-2]), None)
