"""Prints of the papers and what the package derives in the same letters, compared with each other."""

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any, TypeAlias

import sympy as sp
from sympy.matrices.exceptions import ShapeError

from percept_obs.checking.deciding import same
from percept_obs.papers.scalars import Scalar

Values = dict[Any, Any]
Matrix: TypeAlias = sp.ImmutableMatrix


def real(names: str) -> Any:
    """Real letters."""
    return sp.symbols(names, real=True)


def column(*entries: Any) -> Matrix:
    """A column of numbers."""
    return Matrix(entries)


def matrix(name: str, rows: int, columns: int = 1) -> Matrix:
    """A matrix with letters as entries."""
    return Matrix(rows, columns, lambda i, j: sp.Symbol(f"{name}_{i + 1}{j + 1}", real=True))


def paired(letters: Iterable[Any], values: Iterable[Any]) -> Values:
    """Values by letters, of which there are as many."""
    return dict(zip(letters, values, strict=True))


def named(letters: str | Iterable[Any], values: Iterable[Any], mark: str = "") -> Values:
    """Values by the names of letters; the mark ``'`` makes them rates."""
    names = letters.split() if isinstance(letters, str) else letters
    return paired((f"{name}{mark}" for name in names), values)


def exactly(values: Mapping[sp.Symbol, float]) -> dict[sp.Symbol, sp.Rational]:
    """The short decimals that numbers were typed as."""
    return {symbol: sp.Rational(str(value)) for symbol, value in values.items()}


def explicit(expression: sp.Basic, values: Values | None = None) -> Any:
    """An expression with values put in and matrices multiplied out."""
    result = expression.xreplace(values or {})
    known = [inverse for inverse in result.atoms(sp.Inverse) if isinstance(inverse.arg, sp.MatrixBase)]
    # In the field of rational functions, for elimination of expressions simplifies at each step.
    result = result.xreplace({i: i.arg.to_DM(field=True).inv().to_Matrix() for i in known}).doit()
    return result.as_explicit() if isinstance(result, sp.MatrixExpr) else result


def vanishes(*expressions: sp.Expr) -> bool:
    """Return True if expressions are identically zero, as `percept_obs.checking` decides it; norms are letters."""
    return all(same(_in_letters(expression), sp.S.Zero) for expression in expressions)


def _in_letters(expression: sp.Expr) -> sp.Expr:
    """An expression whose letters and norms have names that differ, with sech^2 = 1 - tanh^2."""
    expression = sp.sympify(expression).replace(sp.sech, lambda x: sp.sqrt(1 - sp.tanh(x) ** 2))
    expression = expression.xreplace({part: _opaque(part) for part in expression.atoms(Scalar)})
    letters = sorted(expression.free_symbols, key=str)
    return expression.xreplace({s: sp.Symbol(f"s{k}", **s.assumptions0) for k, s in enumerate(letters)})


@cache
def _opaque(part: sp.Basic) -> sp.Dummy:
    return sp.Dummy(real=True)


def filled_in(expression: sp.Basic, values: Values) -> Any:
    """An expression worked out with values put in; None where a matrix is left without one or sizes do not fit.

    Norms and integrals of matrices without a value stay as they are, each a number of its own.
    """
    try:
        result = expression.xreplace(values)
        numbers = (part for part in result.atoms(Scalar, sp.Integral) if part.has(sp.MatrixSymbol))
        result = result.xreplace({part: _opaque(part) for part in numbers})
        return None if result.atoms(sp.MatrixSymbol) else explicit(result)
    except (ShapeError, TypeError):  # matrices that do not fit, or a matrix and a number
        return None


def is_identity(relation: sp.Basic, values: Values, drops: sp.Expr = sp.S.Zero) -> bool:
    """Return True if sides agree identically once values are put in, those of a bound with what it drops."""
    if not isinstance(relation, sp.LessThan if drops != 0 else sp.Eq | sp.LessThan):
        return False
    left, right, more = (filled_in(part, values) for part in (*relation.args, drops))
    if left is None or right is None or more is None:
        return False
    try:
        difference = right - left if more == 0 else right - left - more
    except (ShapeError, TypeError):
        return False
    return vanishes(*difference) if isinstance(difference, sp.MatrixBase) else vanishes(difference)
