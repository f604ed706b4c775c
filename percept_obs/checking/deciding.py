"""Whether two formulas say the same, decided in bounded time and without simplifying anything."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from fractions import Fraction
from functools import lru_cache
from itertools import islice
from typing import Any

import sympy as sp
from sympy.concrete.expr_with_limits import ExprWithLimits
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational

from percept_obs.checking.points import PRIME, ModularPoint, NoValue, RealPoint

POINTS, TRIALS = 3, 60
MATRICES = (sp.MatrixBase, sp.MatrixExpr)
KINKED = (sp.Abs, sp.sign, sp.Piecewise, sp.Max, sp.Min, sp.floor, sp.ceiling)


def explicit(formula: sp.Basic) -> sp.Basic:
    """A formula with matrices of letters written out, letters such as sigma^2 as powers, and bound letters renamed.

    Where the size n of a matrix is a letter, it is written out with two rows, m with three: an identity of matrices of
    that size.
    """
    if isinstance(formula, Relational):
        sizes, sides = sizes_of(*formula.atoms(sp.MatrixSymbol)), formula.args
        return formula.func(*(_explicit(side, sizes) for side in sides), evaluate=False)
    return _explicit(formula, sizes_of(*formula.atoms(sp.MatrixSymbol)))


def sizes_of(*matrices: sp.MatrixSymbol) -> dict[sp.Symbol, sp.Integer]:
    """Numbers for the letters that are sizes of matrices."""
    letters = {s for m in matrices for size in m.shape for s in size.free_symbols}
    return {size: sp.Integer(2 + k % 2) for k, size in enumerate(sorted(letters, key=str, reverse=True))}


def _explicit(formula: sp.Basic, sizes: Mapping[sp.Symbol, sp.Integer]) -> sp.Basic:
    powers = {s: _power(s) for s in formula.atoms(sp.Symbol) if "^" in s.name}
    formula = formula.xreplace(powers) if powers else formula
    formula = formula.as_dummy() if formula.atoms(ExprWithLimits) else formula
    if formula.atoms(sp.MatrixSymbol):
        formula = formula.xreplace(sizes)
        letters = {m: sp.ImmutableMatrix(*m.shape, _letters(m)) for m in formula.atoms(sp.MatrixSymbol)}
        formula = formula.xreplace(letters).doit()
    return formula.as_explicit() if isinstance(formula, sp.MatrixExpr) else formula


def _letters(matrix: sp.MatrixSymbol) -> Callable[[int, int], sp.Symbol]:
    return lambda i, j: sp.Symbol(f"{matrix.name}[{i},{j}]", real=True)


def _power(symbol: sp.Symbol) -> sp.Expr:
    stem, _, exponent = symbol.name.partition("^")
    return sp.Symbol(stem, **symbol.assumptions0) ** int(exponent)


def rational(formula: sp.Basic) -> bool:
    """Whether a formula holds nothing but letters, fractions, sums, products and whole powers."""
    return all(
        node.is_Symbol or node.is_Rational or node.is_Add or node.is_Mul or (node.is_Pow and node.exp.is_Integer)
        for node in sp.preorder_traversal(formula)
    )


def points(*formulas: sp.Basic) -> Iterator[ModularPoint]:
    """Points modulo the prime at which all formulas have values; at most `TRIALS` are tried."""
    for seed in range(TRIALS):
        point = ModularPoint(seed)
        try:
            for formula in formulas:
                point(formula)
        except NoValue:
            continue
        yield point


def same(one: sp.Expr, other: sp.Expr) -> bool | None:
    """Whether two expressions are the same function of their letters; letters are matched by name.

    Rational functions are compared at three points modulo a prime of 128 bits.  A "no" is certain.  A "yes" is wrong
    with a probability below (d / 2^60)^3, with d the degree of the difference's numerator: below 2^-150 for d = 1000;
    and a value of sixty digits must bear it out, so that no multiple of the prime passes for zero.  Roots, exponentials
    and circular functions follow their rules modulo the prime as well; there several values bear each answer out.

    Returns
    -------
    bool, or None
        None if it cannot be told.

    Examples
    --------
    >>> x = sp.Symbol("x")
    >>> same((x + 1) ** 2, x**2 + 2 * x + 1), same(sp.sin(2 * x), 2 * sp.sin(x)), same(sp.sqrt(x**2), abs(x))
    (True, False, True)
    """
    if one == other:
        return True
    plain = rational(one) and rational(other)
    count = POINTS if plain else 2 * POINTS
    seen = [point(one) == point(other) for point in islice(points(one, other), count)]
    if plain and not all(seen):
        return False
    nearby = _nearly_same(one, other, 1 if plain else 4 * POINTS)
    if nearby is False:
        return False
    if seen and all(seen):
        return True
    return True if nearby and not any(e.has(*KINKED) for e in (one, other)) else None


def _nearly_same(one: sp.Expr, other: sp.Expr, count: int) -> bool | None:
    """Whether so many values of sixty digits agree to forty; None if there are too few."""
    found = 0
    first, second = _unevaluated(one), _unevaluated(other)
    letters = first | second if set(first.values()) == set(second.values()) else {}
    for seed in range(TRIALS):
        point = RealPoint(seed, letters)
        try:
            a, b = point(one), point(other)
        except NoValue:
            continue
        scale, difference = max(abs(a), abs(b), 1), abs(a - b)
        if difference > 1e-25 * scale:
            return False
        found += difference < 1e-40 * scale
        if found == count:
            return True
    return None


def _unevaluated(formula: sp.Expr) -> dict[sp.Basic, str]:
    """Integrals and functions without a name of their own: by what they are, the same for the same ones."""
    parts = formula.atoms(ExprWithLimits, AppliedUndef, sp.Derivative)
    point = next(points(*parts), None)
    return {part: f"value {point(part)}" for part in parts} if point else {}


def proportional(one: sp.Expr, other: sp.Expr, positive: bool = False) -> bool | None:
    """Whether one expression is a number, not zero, times the other."""
    ratio: int | None = None
    for point, _ in zip(points(one, other), range(POINTS), strict=False):
        a, b = point(one), point(other)
        if a == 0 or b == 0:
            return a == b
        now = a * pow(b, -1, PRIME) % PRIME
        if ratio not in (None, now):
            return False if rational(one) and rational(other) else None
        ratio = now
    number = None if ratio is None else fraction_of(ratio)
    return None if number is None else (number > 0 or not positive)


def fraction_of(value: int) -> Fraction | None:
    """The short fraction that a number modulo the prime stands for, if there is one."""
    (r0, s0), (r1, s1) = (PRIME, 0), (value % PRIME, 1)
    while r1 > 10**6:
        (r0, s0), (r1, s1) = (r1, s1), (r0 - r0 // r1 * r1, s0 - r0 // r1 * s1)
    return Fraction(r1, s1) if 0 < abs(s1) <= 10**6 else None


def same_zeros(one: sp.Expr, other: sp.Expr, nonzero: Iterable[sp.Symbol] = ()) -> bool | None:
    """Whether two rational functions vanish at the same real points: up to factors that never do, and to exponents.

    Of irreducible polynomials that take both signs, only multiples of each other vanish at the same real points
    (Bochnak, Coste and Roy, "Real Algebraic Geometry", theorem 4.5.1); of those that do not, such as sums of squares,
    others may, and then it cannot be told.
    """
    if proportional(one, other):
        return True
    first, second = (_vanishing(e, set(nonzero)) for e in (one, other))
    if first is None or second is None:
        return None
    alone = [f for f in first if not any(proportional(f, g) for g in second)]
    alone += [g for g in second if not any(proportional(f, g) for f in first)]
    if not alone:
        return True
    return False if any(map(_takes_both_signs, alone)) else None


def _takes_both_signs(polynomial: sp.Expr) -> bool:
    values = [RealPoint(seed)(polynomial) for seed in range(TRIALS)]
    return min(values) < 0 < max(values)


def _vanishing(expression: sp.Expr, nonzero: set[sp.Symbol]) -> list[sp.Expr] | None:
    """The factors of a rational function's numerator that may be zero, each once."""
    if not rational(expression) or size(expression) > 2000:
        return None
    _, factors = sp.factor_list(sp.numer(sp.together(expression)))
    return [f for f, _ in factors if f not in nonzero and not _positive(f)]


def _positive(polynomial: sp.Expr) -> bool:
    """Whether all terms are positive, one of them a number: 1 + y1^2."""
    terms = sp.Poly(polynomial).terms()
    signs = {c > 0 for _, c in terms}
    even = all(power % 2 == 0 for powers, _ in terms for power in powers)
    return even and len(signs) == 1 and any(not any(powers) for powers, _ in terms)


@lru_cache(maxsize=1 << 14)
def degree(e: sp.Basic) -> int:
    """How high the powers of letters are, at most."""
    inner = [degree(part) for part in e.args] or [1]
    if e.is_Pow and e.exp.is_Rational:
        return inner[0] * max(1, abs(int(e.exp.p)))
    return sum(inner) if e.is_Mul else max(inner)


def size(e: sp.Basic) -> int:
    """How many terms there are at most once brackets are multiplied out."""
    if e.is_Add:
        return sum(map(size, e.args))
    if e.is_Mul:
        product = 1
        for factor in e.args:
            product *= size(factor)
        return product
    return size(e.base) ** abs(int(e.exp)) if e.is_Pow and e.exp.is_Integer else 1


def letters_in_a_row(value: sp.Basic) -> int:
    """How many letters of matrices are multiplied in a value; those of a sum are as many as in its longest term."""
    if not isinstance(value, sp.MatrixExpr):
        return 0
    parts = [letters_in_a_row(part) for part in value.args]
    return 1 if value.is_symbol else sum(parts) if isinstance(value, sp.MatMul) else max(parts, default=0)


def written_out(formula: Any, matrices: Mapping[sp.MatrixExpr, sp.ImmutableMatrix]) -> Any:
    """A formula, or a relation, with matrices in the place of their letters."""
    if not matrices or not formula.atoms(sp.MatrixSymbol):
        return formula
    if isinstance(formula, Relational):
        return formula.func(*(written_out(side, matrices) for side in formula.args), evaluate=False)
    formula = formula.xreplace(matrices).doit(integrals=False)
    return formula.as_explicit() if isinstance(formula, sp.MatrixExpr) else formula
