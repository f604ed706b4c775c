"""Decide in bounded time, without simplifying anything, whether two formulas are the same."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from math import prod
from typing import Any

import sympy as sp
from sympy.concrete.expr_with_limits import ExprWithLimits
from sympy.core.relational import Relational
from sympy.polys.fields import sfield

from percept_obs.checking.limits import extent
from percept_obs.checking.points import NoValue, Point, key
from percept_obs.checking.proving import dimension, identical, ratio
from percept_obs.checking.sampling import Place, places, region, sample

POINTS, TRIALS, LARGEST, FEW = 12, 60, 2000, 150
"""Places that must agree for a "yes"; seeds tried; terms of a small formula; parts of one sampled thoroughly."""
MATRICES = (sp.MatrixBase, sp.MatrixExpr)


def explicit(formula: sp.Basic) -> sp.Basic:
    """Return a formula with matrices entry by entry, sigma^2 as a power of sigma, and bound letters renamed.

    Where the size n of a matrix is a letter, it is written out with two rows, m with three: an identity of matrices of
    that size.
    """
    sizes = sizes_of(*formula.atoms(sp.MatrixSymbol))
    return on_sides(lambda side: _explicit(side, sizes), formula)


def on_sides(function: Callable[[Any], Any], formula: Any) -> Any:
    """Apply a function to a formula, or to both sides of a relation, which stays as it is written."""
    if isinstance(formula, Relational):
        return formula.func(*map(function, formula.args), evaluate=False)
    return function(formula)


def sizes_of(*matrices: sp.MatrixSymbol) -> dict[sp.Symbol, sp.Integer]:
    """Return numbers for the letters that are sizes of matrices."""
    letters = {s for m in matrices for size in m.shape for s in size.free_symbols}
    return {size: sp.Integer(2 + k % 2) for k, size in enumerate(sorted(letters, key=str, reverse=True))}


def _explicit(formula: sp.Basic, sizes: Mapping[sp.Symbol, sp.Integer]) -> sp.Basic:
    powers = {s: _power(s) for s in formula.atoms(sp.Symbol) if re.fullmatch(r"\w+\^\d+", s.name)}
    formula = formula.xreplace(powers) if powers else formula
    formula = formula.as_dummy() if formula.atoms(ExprWithLimits) else formula
    formula = formula.xreplace(sizes) if sizes else formula
    entries = {m: entries_of(m, "{}[{},{}]", 0) for m in formula.atoms(sp.MatrixSymbol)}
    formula = formula.xreplace(entries).doit() if entries else formula
    return formula.as_explicit() if isinstance(formula, sp.MatrixExpr) else formula


def entries_of(matrix: sp.MatrixExpr, pattern: str, first: int, name: str = "") -> sp.ImmutableMatrix:
    """Return a matrix of real letters, named by a pattern of name, row and column, which are counted from `first`."""
    name = name or matrix.name
    return sp.ImmutableMatrix(
        *matrix.shape, lambda i, j: sp.Symbol(pattern.format(name, i + first, j + first), real=True)
    )


def _power(symbol: sp.Symbol) -> sp.Expr:
    stem, _, exponent = symbol.name.partition("^")
    return sp.Symbol(stem, **symbol.assumptions0) ** int(exponent)


def rational(formula: sp.Basic) -> bool:
    """Return True for letters, fractions, sums, products and whole powers."""
    return all(
        node.is_Symbol or node.is_Rational or node.is_Add or node.is_Mul or (node.is_Pow and node.exp.is_Integer)
        for node in sp.preorder_traversal(formula)
    )


def points(*formulas: sp.Basic, opaque: bool = False) -> Iterator[Point]:
    """Yield random points at which all formulas have a value; `TRIALS` are tried."""
    for seed in range(TRIALS):
        point = Point(seed, opaque=opaque)
        with suppress(NoValue):
            for formula in formulas:
                point(formula)
            yield point


@dataclass(frozen=True)
class Decision:
    """Answer to a claim: its truth, None if it cannot be told, if that is proved, and the values for which it holds.

    A "no" is always certain.  A "yes" that is not proved is one of values at random places of all sizes.
    """

    truth: bool | None
    proved: bool = True
    where: str = ""

    @property
    def words(self) -> str:
        """Words about a "yes", such as "right for |y1| < 1"; empty if it holds everywhere and is proved."""
        if self.truth and not self.proved:
            found = "compared at random values of all sizes, not proved"
            return f"right for {self.where}: {found}" if self.where else found
        return f"right for {self.where} only" if self.where else ""


def decided(one: sp.Expr, other: sp.Expr) -> Decision:
    """Decide whether two expressions are the same function of their letters, which are matched by name.

    Rational functions of moderate size are compared as quotients of polynomials, larger ones and those with roots,
    exponentials, angles and signs exactly at a secret point.  What is not proved so is compared at random places all
    over the real domain, with sixty digits and more; nobody can know these places.  So are the borders at which signs
    change, where formulas may jump.
    """
    if one == other:
        return Decision(True)
    found = identical(one, other)
    if rational(one) and rational(other):
        # identical at a secret point but by a tiny chance; small ones are compared by all their terms as well
        if found and small(one, other):
            own = {s: sp.Symbol(key(s.name)) for s in one.free_symbols | other.free_symbols}
            _, (left, right) = sfield([one.xreplace(own), other.xreplace(own)])
            found = bool(left == right)
        return Decision(found)
    # without such parts, different values at the secret point mean different functions
    if found is False and not one.has(*_NUMBERS) and not other.has(*_NUMBERS):
        return Decision(False)
    # where formulas jump they may be equal on all branches and differ on the borders, which places can show;
    # logarithms and roots of different parts may have values at different places
    same_parts = _inside(one) == _inside(other)
    if found and same_parts and not one.has(*_JUMPS) and not other.has(*_JUMPS):
        return Decision(True)
    compared = sample(one, other, thorough=found is None and extent(one).parts + extent(other).parts < FEW)
    if compared.different:
        return Decision(False, where=region(compared.same, compared.different, one, other))
    # proof and places disagree, or too few places have values: nothing can be told
    if found is False or len(compared.same) < POINTS:
        return Decision(found or None)
    where = "" if found and same_parts else region(compared.same, compared.nowhere, one, other)
    return Decision(True, bool(found), where)


def _inside(formula: sp.Expr) -> set[sp.Basic]:
    """Return what stands in logarithms and roots, which have no value everywhere."""
    return {p.args[0] for p in formula.atoms(sp.log, sp.Pow) if isinstance(p, sp.log) or p.exp.is_integer is False}


_JUMPS = (sp.sign, sp.Heaviside, sp.Piecewise, sp.floor, sp.ceiling)
_NUMBERS = (sp.NumberSymbol, sp.I, sp.Abs, sp.Max, sp.Min, *_JUMPS)
"""Parts with which a "no" of `identical` is not certain, for it does not know all relations between them."""


def same(one: sp.Expr, other: sp.Expr) -> bool | None:
    """Return True if two expressions are the same function of their letters by name; None if it cannot be told.

    >>> x = sp.Symbol("x", real=True)
    >>> same((x + 1) ** 2, x**2 + 2 * x + 1), same(sp.sin(2 * x), 2 * sp.sin(x)), same(x * sp.sign(x), abs(x))
    (True, False, True)
    """
    return decided(one, other).truth


def proportional(one: sp.Expr, other: sp.Expr, positive: bool = False) -> bool | None:
    """Return True if one expression is a number, not zero, times the other."""
    # the secret point gives the only candidate for the number
    number = ratio(one, other)
    if number:
        found = decided(one, number * other)
        if found.truth is not None:
            return found.truth and (number > 0 or not positive)
    if rational(one) and rational(other):
        return False if one != 0 and other != 0 else one == other
    # the number may be no fraction, such as pi: then the quotient must be the same at all places
    first = None
    for letters in islice(places(one, other), 2 * POINTS):
        place = Place(letters)
        with suppress(NoValue):
            a, b = place(one), place(other)
            if min(abs(a), abs(b)) < 1e-40:
                if max(abs(a), abs(b)) > 1e-30:
                    return False
                continue
            if first is not None and abs(a / b - first) > 1e-25 * abs(first):
                return False
            first = a / b
    return None if first is None else not positive or first > 0


def same_zeros(one: sp.Expr, other: sp.Expr, nonzero: Iterable[sp.Symbol] = ()) -> bool | None:
    """Return True if two rational functions vanish at the same real points; None if it cannot be told.

    Factors that never vanish do not count, nor do exponents.

    Of irreducible polynomials that take both signs, only multiples of each other vanish at the same real points
    (Bochnak, Coste and Roy, "Real Algebraic Geometry", theorem 4.5.1); of those that do not, such as sums of squares,
    others may, and then it cannot be told.
    """
    if proportional(one, other):
        return True
    if other == 0:
        return False  # which vanishes everywhere
    one, other = (_squared(e) for e in (one, other))
    if proportional(one, other):
        return True
    first, second = (_vanishing(e, set(nonzero)) for e in (one, other))
    if first is None or second is None:
        return None
    alone = [f for f in first if not any(_vanish_together(f, g) for g in second)]
    alone += [g for g in second if not any(_vanish_together(f, g) for f in first)]
    if not alone:
        return True
    if any(_apart(*pair) for pair in ((one, other), (other, one))):
        return False
    # a factor that takes both signs vanishes where no other one does; one that does not may vanish nowhere
    values = ([Place(at)(polynomial) for at in places(polynomial)] for polynomial in alone)
    return False if any(min(found) < 0 < max(found) for found in values) else None


def _squared(expression: sp.Expr) -> sp.Expr:
    """Return a polynomial with the same zeros for a root of one, or for a sum of absolute values of some."""
    if expression.is_Pow and expression.exp == sp.S.Half:
        return _squared(expression.base)
    terms = [term.as_coeff_Mul() for term in sp.Add.make_args(expression)]
    if all(c > 0 and isinstance(e, sp.Abs) for c, e in terms):
        return sp.Add(*(e.args[0] ** 2 for _, e in terms))
    return expression


def _apart(one: sp.Expr, other: sp.Expr) -> bool:
    """Return True if a sum of squares is surely zero at a point where another expression is not."""
    at: dict[sp.Symbol, sp.Expr] = {}
    for base in _squares(one):
        base = base.subs(at)
        letter = next((s for s in sorted(base.free_symbols, key=str) if base.diff(s, 2) == 0), None)
        if letter is None:
            return False
        solved = {letter: sp.cancel(-base.subs(letter, 0) / base.diff(letter))}
        at = {s: e.subs(solved) for s, e in at.items()} | solved
    value = other.subs(at)
    return bool(at) and rational(value) and bool(sp.together(value) != 0) and ratio(value, sp.S.One) != 0


def _vanishing(expression: sp.Expr, nonzero: set[sp.Symbol]) -> list[sp.Expr] | None:
    """Return the factors of a rational function's numerator that may be zero, each once."""
    if not rational(expression) or not small(expression):
        return None
    _, factors = sp.factor_list(sp.numer(sp.together(expression)))
    return [f for f, _ in factors if f not in nonzero and not _positive(f)]


def _vanish_together(one: sp.Expr, other: sp.Expr) -> bool | None:
    """Return True if two polynomials surely have the same zeros: multiples, or squares of bases with the same span."""
    if proportional(one, other):
        return True
    bases = _squares(one), _squares(other)
    # a sum of squares vanishes where all bases do, and bases with the same span vanish together
    return all(bases) and len({dimension(*part) for part in (*bases, bases[0] + bases[1])}) == 1


def _squares(polynomial: sp.Expr) -> list[sp.Expr]:
    """Return polynomials whose squares, times positive numbers, add up to this one; nothing if none are found."""
    bases, rest = [], sp.expand(polynomial)
    for letter in sorted(rest.free_symbols, key=str):
        # complete the square in one letter after the other; what is left must be 0
        parts = sp.Poly(rest, letter).all_coeffs()
        if len(parts) == 3 and parts[0].is_positive and parts[0].is_number:
            bases.append(letter + parts[1] / (2 * parts[0]))
            rest = sp.expand(parts[2] - parts[1] ** 2 / (4 * parts[0]))
    return bases if rest == 0 else []


def square_apart(mine: sp.Expr, true: sp.Expr) -> tuple[tuple[int, ...], sp.Expr, sp.Expr] | None:
    """Return the only square of a sum of squares that differs: the place of its base, the base, and the true one."""
    squares = [(k, e.base) for k, e in enumerate(mine.args) if e.is_Pow and e.exp == 2] if mine.is_Add else []
    bases = _squares(true) if rational(true) and small(true) else []
    if len(squares) != len(getattr(mine, "args", ())) or len(squares) != len(bases):
        return None
    mine_left = [(k, base) for k, base in squares if not any(proportional(base, other) for other in bases)]
    true_left = [base for base in bases if not any(proportional(base, other) for _, other in squares)]
    if len(mine_left) != 1 or len(true_left) != 1:
        return None
    ((k, base),), (other,) = mine_left, true_left
    terms = set(sp.Add.make_args(sp.expand(base)))
    shared = [len(terms & set(sp.Add.make_args(sp.expand(sign * other)))) for sign in (1, -1)]
    return (k, 0), base, other if shared[0] >= shared[1] else -other


def _positive(polynomial: sp.Expr) -> bool:
    """Return True if all terms are positive, one of them a number: 1 + y1^2."""
    terms = sp.Poly(polynomial).terms()
    signs = {c > 0 for _, c in terms}
    even = all(power % 2 == 0 for powers, _ in terms for power in powers)
    return even and len(signs) == 1 and any(not any(powers) for powers, _ in terms)


def size(e: sp.Basic) -> int:
    """Return an upper bound of the number of terms once brackets are multiplied out."""
    if e.is_Add:
        return sum(map(size, e.args))
    if e.is_Mul:
        return prod(map(size, e.args))
    return size(e.base) ** abs(int(e.exp)) if e.is_Pow and e.exp.is_Integer else 1


def small(*formulas: sp.Expr) -> bool:
    """Return True if formulas have few terms once brackets are multiplied out and denominators cleared."""
    # each denominator multiplies all terms once it is cleared
    below = {1 / power for e in formulas for power in e.atoms(sp.Pow) if power.exp.is_Integer and power.exp < 0}
    return sum(map(size, formulas)) * prod(map(size, below)) <= LARGEST


def letters_in_a_row(value: sp.Basic) -> int:
    """Return how many letters of matrices the longest product in a value has."""
    if not isinstance(value, sp.MatrixExpr):
        return 0
    parts = [letters_in_a_row(part) for part in value.args]
    return 1 if value.is_symbol else sum(parts) if isinstance(value, sp.MatMul) else max(parts, default=0)
