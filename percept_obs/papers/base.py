"""Prints of the papers and derivations of the package in the same letters, compared with each other."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from typing import Any

import sympy as sp
from sympy.core.function import UndefinedFunction
from sympy.core.relational import Relational
from sympy.matrices.exceptions import ShapeError

from percept_obs.checking.deciding import rational, same
from percept_obs.checking.points import key
from percept_obs.checking.reading import FUNCTIONS as READ_FUNCTIONS
from percept_obs.checking.reading import read
from percept_obs.papers.entries import Check, Finding, Printed, Values, Verdict
from percept_obs.papers.scalars import FUNCTIONS, Scalar


def column(*entries: Any) -> sp.ImmutableMatrix:
    """A column of numbers."""
    return sp.ImmutableMatrix(entries)


def reader(*letters: Any, **terms: Any) -> Callable[[str], Printed]:
    """Make a reader of prints that are typed as text.

    Equations are separated by semicolons and may go on over several lines.  A letter with a prime is a rate; of vectors
    there are ``norm(e)``, ``norm1(e)``, ``inner(e, x)`` and ``signs(e)``, of matrices ``lambda_min(P)``.

    Parameters
    ----------
    *letters : symbols and functions, or tuples of them
        Vectors, matrices and positive numbers; every other word is a real number.
    **terms
        Expressions that stand in several prints, by the name that stands there.

    Examples
    --------
    >>> reader(vectors("e x", sp.Integer(2)))("y1' = b1 y2 + norm(e); y1^2 < b1")
    (Eq(ydot1, b1*y2 + Norm(e)), y1**2 < b1)
    """
    flat = [each for group in letters for each in (group if isinstance(group, tuple) else (group,))]
    functions = FUNCTIONS | {each.__name__: each for each in flat if isinstance(each, UndefinedFunction)}
    given = {each.name: each for each in flat if not isinstance(each, UndefinedFunction)}

    def read_all(text: str) -> Printed:
        numbers = {word: sp.Symbol(word, real=True) for word in re.findall(r"[A-Za-z]\w*", text)}
        words = {word: number for word, number in numbers.items() if word not in functions and word not in WORDS}
        known = {key(name): term for name, term in terms.items()}
        letters = (words | given).values()
        known = {key(each.name): each for letter in letters for each in (dot(letter), letter)} | known
        parts = " ".join(text.split()).split(";")
        lines = (line for part in parts for line in read(part, known, list(known), functions).lines)
        return tuple(equal(known[line.name], line.formula) if line.name else line.formula for line in lines)

    return read_all


def vectors(names: str, size: sp.Symbol) -> tuple[sp.MatrixSymbol, ...]:
    """Letters of vectors of the same size, from names with blanks between."""
    return tuple(sp.MatrixSymbol(name, size, 1) for name in names.split())


def exactly(values: Mapping[sp.Symbol, float]) -> dict[sp.Symbol, sp.Rational]:
    """The short decimals that numbers were typed as, as fractions."""
    return {symbol: sp.Rational(str(value)) for symbol, value in values.items()}


def dot(symbol: Any) -> Any:
    """The symbol of a time derivative: ydot1 for y1."""
    name = re.sub(r"(\d*)$", r"dot\1", symbol.name, count=1)
    if isinstance(symbol, sp.MatrixSymbol):
        return sp.MatrixSymbol(name, *symbol.shape)
    return sp.Symbol(name, real=True)


def equal(left: Any, right: Any) -> sp.Eq:
    """The equation ``left = right`` as it is printed, not evaluated."""
    return sp.Eq(left, right, evaluate=False)


def less(left: Any, right: Any) -> sp.StrictLessThan:
    """The inequality ``left < right`` as it is printed, not evaluated."""
    return sp.StrictLessThan(left, right, evaluate=False)


def at_most(left: Any, right: Any) -> sp.LessThan:
    """The inequality ``left <= right`` as it is printed, not evaluated."""
    return sp.LessThan(left, right, evaluate=False)


WORDS = {*READ_FUNCTIONS, "lambda_min", "pi"}
"""Words that stand for no number."""


def explicit(expression: sp.Basic, values: Values | None = None) -> Any:
    """An expression with values put in and matrices multiplied out."""
    result = expression.xreplace(values or {})
    known = [inverse for inverse in result.atoms(sp.Inverse) if isinstance(inverse.arg, sp.MatrixBase)]
    # In the field of rational functions, for elimination of expressions simplifies at each step.
    result = result.xreplace({i: i.arg.to_DM(field=True).inv().to_Matrix() for i in known}).doit()
    return result.as_explicit() if isinstance(result, sp.MatrixExpr) else result


def vanishes(*expressions: sp.Expr) -> bool:
    """Return True if expressions are identically zero.

    Rational ones are decided as `percept_obs.checking` does it.  For others, one point where it is not zero refutes an
    identity, and the algebra, which takes longer, proves it.
    """
    quick = [e for e in expressions if rational(e) and _told_apart(e)]
    if not all(same(e, sp.S.Zero) for e in quick):
        return False
    rest = [e for e in expressions if e not in quick]
    return not any(map(_is_refuted, rest)) and all(map(_is_proven, rest))


def _told_apart(expression: sp.Expr) -> bool:
    """Return True if all letters of an expression have names of different meaning."""
    return len({key(symbol.name) for symbol in expression.free_symbols}) == len(expression.free_symbols)


def _somewhere(expression: sp.Expr) -> sp.Expr:
    """The expression's value at some rational point."""
    symbols = sorted(expression.free_symbols, key=str)
    point = {symbol: sp.Rational(sp.prime(k + 3), 3 + k) for k, symbol in enumerate(symbols)}
    return expression.xreplace(point).doit()


def _is_refuted(expression: sp.Expr) -> bool:
    """Return True if an expression, as it stands, has a rational value other than zero."""
    if expression.has(Scalar):
        return False
    value = _somewhere(expression)
    return bool(value.is_Rational and value != 0)


def _is_proven(expression: sp.Expr) -> bool:
    expanded = sp.expand(expression)
    expanded = expanded.xreplace({scalar: sp.Dummy(real=True) for scalar in expanded.atoms(Scalar)})
    if expanded == 0:
        return True
    somewhere = _somewhere(expanded)
    if somewhere.is_number and abs(sp.N(somewhere, 30)) > 1e-20:
        return False
    return bool(sp.expand(sp.fraction(sp.together(expanded))[0]) == 0)


def filled_in(expression: sp.Basic, values: Values) -> Any:
    """An expression worked out with values put in; None where a matrix is left without one or sizes do not fit."""
    try:
        result = expression.xreplace(values)
        return None if result.atoms(sp.MatrixSymbol) else explicit(result)
    except (ShapeError, TypeError):  # matrices that do not fit, or a matrix and a number
        return None


def is_identity(equation: sp.Basic, values: Values) -> bool:
    """Return True if an equation's sides agree identically once values are put in."""
    if not isinstance(equation, sp.Eq):
        return False
    left, right = (filled_in(side, values) for side in equation.args)
    if left is None or right is None:
        return False
    try:
        difference = left - right
    except (ShapeError, TypeError):
        return False
    return vanishes(*difference) if isinstance(difference, sp.MatrixBase) else vanishes(difference)


def identities(*derivations: Callable[[], Values]) -> Check:
    """A check that holds when every printed equation is an identity in every derivation's values."""

    @cache
    def holds(equation: sp.Basic, derive: Callable[[], Values]) -> bool:
        return is_identity(equation, derive())

    def check(printed: Printed) -> Finding:
        """Put what the package derives in the place of each letter: both sides must be the same for all values."""
        values = derivations[0]()
        lines = ((line.lhs, values[line.lhs]) for line in printed if line.lhs in values)
        agree = all(holds(equation, derive) for derive in derivations for equation in printed)
        return Finding(Verdict.HOLDS if agree else Verdict.MISPRINT, derived=tuple(lines))

    return check


def separates(relation: sp.Basic, quantity: sp.Basic, below: float, above: float, values: Values) -> bool:
    """Return True if a printed bound admits a quantity's value below it and excludes one above it."""
    outcomes = [relation.xreplace({quantity: sp.Float(v), **values}).doit() for v in (below, above)]
    return outcomes == [sp.true, sp.false]


def strict_at_zero(printed: Printed, at_zero: Values) -> bool:
    """Return True if inequalities contradict themselves where all of their norms are zero."""
    return sp.And(*(formula.xreplace(at_zero).doit() for formula in printed)).simplify() == sp.false


def weakened(printed: Iterable[sp.Basic]) -> dict[sp.Basic, sp.Basic]:
    """The correction that turns every strict inequality into a weak one."""
    return {r: at_most(r.lhs, r.rhs) for r in printed if isinstance(r, Relational)}
