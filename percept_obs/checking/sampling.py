"""Compare formulas at random places of many sizes, all over the domain of their letters, and say where they agree."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import Any, NamedTuple

import mpmath
import sympy as sp
from sympy.core.relational import Relational

from percept_obs.checking.limits import TALLEST, heed
from percept_obs.checking.points import KINKED, NoValue, Point, key
from percept_obs.checking.proving import powers

PLACES, TRIALS, DIGITS, MANY_DIGITS = 24, 160, 60, 1200
"""Places that are compared at least, and draws of them at most; digits of formulas in `WRITTEN_OUT`, and of others."""
WRITTEN_OUT = (sp.Integral, sp.Derivative, sp.Sum)
"""Expressions that are computed numerically, which takes long with many digits."""
KINKS = (*KINKED, sp.Heaviside)
_chance = random.SystemRandom()
_SIGNS: dict[type, Callable[[Any], bool]] = {
    sp.StrictLessThan: lambda d: d < 0,
    sp.LessThan: lambda d: d <= 0,
    sp.StrictGreaterThan: lambda d: d > 0,
    sp.GreaterThan: lambda d: d >= 0,
    sp.Eq: lambda d: d == 0,
    sp.Ne: lambda d: d != 0,
}


class Place(Point):
    """Real values of letters, and those of expressions in them, with many digits; NoValue where a part is not real."""

    def __init__(self, letters: dict[str, float], digits: int = DIGITS, real: bool = True) -> None:
        super().__init__(0, exact=True)
        self.letters, self.real, self.mp = letters, real, _digits(digits)

    def _value(self, e: sp.Basic) -> Any:
        heed()
        if e.is_Symbol:
            return self.mp.mpf(self.letters[key(e.name)])
        if isinstance(e, sp.Max | sp.Min):
            value = (max if isinstance(e, sp.Max) else min)(map(self, e.args))
        elif isinstance(e, sp.Heaviside):
            value = (1 + self.mp.sign(self(e.args[0]))) / 2
        elif isinstance(e, sp.Piecewise):
            value = next((self(branch) for branch, condition in e.args if self.holds(condition)), None)
        elif isinstance(e, sp.NumberSymbol):
            value = self.mp.mpf(str(e.n(self.mp.dps + 5)))
        else:
            value = super()._value(e)
        if value is None or not self.mp.isfinite(value) or (value and self.mp.mag(value) > TALLEST):
            raise NoValue
        if self.real and isinstance(value, self.mp.mpc):
            raise NoValue
        return value

    def holds(self, condition: sp.Basic) -> bool:
        """Return True if a condition holds here."""
        if isinstance(condition, Relational):
            return _SIGNS[condition.func](self(condition.lhs - condition.rhs))
        inner = [self.holds(part) for part in condition.args]
        if isinstance(condition, sp.Not):
            return not inner[0]
        return any(inner) if isinstance(condition, sp.Or) else all(inner) and condition != sp.false

    def agree(self, one: sp.Basic, other: sp.Basic) -> bool | None:
        """Return True if two values are the same up to rounding, None if rounding hides it; raise NoValue."""
        a, b = self(one), self(other)
        largest, distance = max(map(abs, self.known.values())), abs(a - b)
        small = self.mp.mpf(10) ** -(self.mp.dps * 2 // 3)
        if distance > small * largest:
            return False
        return True if distance < small**1.25 * largest and small * largest <= max(abs(a), abs(b)) else None


class Sample(NamedTuple):
    """Places at which two formulas agree, differ, and have no value."""

    same: list[Place]
    different: list[Place]
    nowhere: list[Place]


def sample(one: sp.Basic, other: sp.Basic, thorough: bool = False) -> Sample:
    """Compare two formulas at places all over the domain of their letters, until they differ or all places are seen.

    If thorough, it goes on where they differ.
    """
    found = Sample([], [], [])
    digits = DIGITS if one.has(*WRITTEN_OUT) or other.has(*WRITTEN_OUT) else MANY_DIGITS
    # borders are met by chance: in 72 places a border of one letter is missed once in 10^8 times
    enough = PLACES if not (one.has(*KINKS) or other.has(*KINKS)) else 3 * PLACES
    real = not (one.has(sp.I) or other.has(sp.I))
    for number, letters in enumerate(places(one, other)):
        place = Place(letters, real=real)
        try:
            agree = place.agree(one, other)
            if agree is None or (agree and len(found.same) < 2):  # differences may be smaller than rounding
                agree = Place(letters, digits, real).agree(one, other)
        except NoValue:
            found.nowhere.append(place)
            continue
        if agree is not None:
            (found.same if agree else found.different).append(place)
        if (found.different and not thorough) or (min(len(found.same), number) >= enough and not thorough):
            break
    return found


def places(*formulas: sp.Basic) -> Iterator[dict[str, float]]:
    """Yield values of letters: of ordinary and of all sizes, special ones, and those at which a formula has a kink."""
    letters = sorted({s for e in formulas for s in e.free_symbols}, key=str)
    special = [float(x) for e in formulas for n in e.atoms(sp.Rational) if n and abs(n.p) < 10**12 for x in (n, 1 / n)]
    borders = list(dict.fromkeys(u for e in formulas for u in kinks(e) if u.free_symbols))
    for number in range(TRIALS):
        values: dict[str, float] = {}
        for letter in letters:
            # every other place has ordinary values only, at which few formulas overflow
            draw = _chance.random() if number % 2 else 0
            if draw < 0.4:
                value = _chance.uniform(-3, 3)
            elif draw < 0.75:
                value = _chance.choice((-1, 1)) * 10 ** _chance.uniform(-6, 6)
            elif draw < 0.85 or not values:
                value = _chance.choice((-1, 1)) * _chance.choice([1.0, *special]) * _chance.choice((1, 1, 0.999, 1.001))
            else:
                value = _chance.choice([0.0, *values.values()])
            values[key(letter.name)] = _allowed(letter, value)
        if borders and number % 4 > 1:
            # of few digits, so that the border is met exactly
            values = {key(s.name): _allowed(s, _chance.randrange(-192, 193) / 64) for s in letters}
            _move_to_a_border(values, _chance.choice(borders))
        yield values


def _allowed(letter: sp.Symbol, value: float) -> float:
    """Return the value, rounded or with another sign if the letter is an integer or has a sign."""
    value = float(round(value)) if letter.is_integer else value
    if letter.is_nonnegative or letter.is_nonpositive:
        value = abs(value) if letter.is_nonnegative else -abs(value)
        return value or (float(letter.is_nonnegative or -1) if letter.is_nonzero else 0.0)
    return value


def _move_to_a_border(values: dict[str, float], border: sp.Expr) -> None:
    """Change one letter so that an expression in which it is linear is zero, or nearly."""
    letter = _chance.choice(sorted(border.free_symbols, key=str))
    name = key(letter.name)
    try:
        # three values on a line: the expression is linear in the letter, and its zero follows
        at = [Place(values | {name: x})(border) for x in (0.0, 1.0, 2.0)]
    except NoValue:
        return
    if at[1] != at[0] and abs(at[2] - 2 * at[1] + at[0]) < 1e-40 * max(map(abs, at)):
        zero = float(at[0] / (at[0] - at[1]))
        values[name] = _allowed(letter, zero * _chance.choice((1, 1, 1, 1.01, 0.99)))


def kinks(e: sp.Basic) -> Iterator[sp.Expr]:
    """Yield expressions at whose zeros a formula has a kink or jumps, or a root its branch."""
    roots = (node.base for node in e.atoms(sp.Pow) if node.exp.is_Rational and node.exp.q == 2)
    yield from (factor for base in roots for factor, power in powers(base) if abs(power) > 1)
    for node in e.atoms(*KINKS):
        if isinstance(node, sp.Piecewise):
            yield from (r.lhs - r.rhs for r in node.atoms(Relational))
        elif isinstance(node, sp.Max | sp.Min):
            first, *others = node.args
            yield from (first - other for other in others)
        else:
            yield node.args[0]


@cache
def _digits(digits: int) -> Any:
    context = mpmath.mp.clone()
    context.dps = digits
    return context


def region(good: Sequence[Place], bad: Sequence[Place], *formulas: sp.Basic) -> str:
    """Return a condition that holds at good places and fails at bad ones, |y1| < pi/2; empty if none is seen."""
    if len(good) < 5 or len(bad) < 5:
        return ""
    # conditions are looked for in letters and in arguments of functions, the shortest first
    inner = {a for e in formulas for f in e.atoms(sp.Function, sp.Pow) for a in (*f.args, f) if isinstance(a, sp.Expr)}
    letters = {s for e in formulas for s in e.free_symbols}
    constants = {abs(n) for e in formulas for n in e.atoms(sp.Rational)} | {sp.S(n) for n in (0, 1, sp.pi / 2, sp.pi)}
    for q in sorted(letters | {a for a in inner if a.free_symbols}, key=lambda q: (q.count_ops(), str(q))):
        for size, shown in ((float, str(q)), (abs, f"|{q}|")):
            inside, outside = _values(q, good, size), _values(q, bad, size)
            if len(inside) < 5 or len(outside) < 5:
                continue
            for sign, relation in ((1, "<"), (-1, ">")):
                low, high = max(sign * x for x in inside), min(sign * x for x in outside)
                # a single usual number between good and bad places is the border; of several it is not known which
                between = {c for c in (*constants, *(-c for c in constants)) if low <= sign * float(c) <= high}
                if low <= high and len(between) == 1:
                    return f"{shown} {relation} {between.pop()}".replace("**", "^").replace("*", " ")
    # several letters must be positive, as in log(y1) + log(y2)
    needed = [s for s in sorted(letters, key=str) if min(_values(s, good, float)) > 0]
    signs = zip(*(_values(s, bad, float) for s in needed), strict=True)
    return " and ".join(f"{s} > 0" for s in needed) if all(min(each) <= 0 for each in signs) else ""


def _values(q: sp.Expr, places: Sequence[Place], size: Callable[[Any], Any]) -> list[float]:
    found = []
    for place in places:
        try:
            found.append(float(size(place(q))))
        except (NoValue, OverflowError, KeyError):
            continue
    return found
