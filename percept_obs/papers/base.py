"""A paper's ledger: what is printed, what the package derives, and the verdict that follows from both."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache, cached_property
from typing import Any, ClassVar

import sympy as sp
from sympy.core.relational import Relational
from sympy.matrices.exceptions import ShapeError

Printed = tuple[sp.Basic, ...]
Values = dict[sp.Basic, sp.Basic]


class Verdict(StrEnum):
    """What a computation says about a printed statement."""

    HOLDS = "holds"
    MISPRINT = "misprint"
    FALSE = "false as stated"
    NOT_CHECKABLE = "not checkable"


@dataclass(frozen=True)
class Finding:
    """The result of a check: a verdict, and the numbers that it rests on."""

    verdict: Verdict
    numbers: Mapping[str, float] = field(default_factory=dict)


Check = Callable[[Printed], Finding]


def judged(holds: bool, otherwise: Verdict = Verdict.MISPRINT, numbers: Mapping[str, float] | None = None) -> Finding:
    """The finding of a check that holds or not."""
    return Finding(Verdict.HOLDS if holds else otherwise, numbers or {})


@dataclass(frozen=True, eq=False)
class Entry:
    """A printed statement and how it is judged.

    Parameters
    ----------
    place : str
        Number of the equation, such as "(4)", or a few words that name the statement.
    page, section : str
        Where it stands.
    says : str
        What it says, in a few words.
    printed : tuple of sympy relations
        The formulas as they are printed; empty where the statement has none.
    check : function of the printed formulas
        Computes the finding.
    expected : Verdict
        The verdict that is recorded.
    note : str
        How the print was read, what is wrong, or why nothing can be computed.
    correction : mapping of expressions to expressions
        What is to be put in the place of what, in a misprint.
    """

    place: str
    page: str
    section: str
    says: str
    printed: Printed
    check: Check
    expected: Verdict
    note: str = ""
    correction: Values = field(default_factory=dict)

    @property
    def number(self) -> int | None:
        """Number of the equation, if it has one."""
        digits = re.fullmatch(r"\((\d+)\)", self.place)
        return int(digits[1]) if digits else None

    @cached_property
    def finding(self) -> Finding:
        """What the check finds in the printed formulas."""
        return self.check(self.printed)

    @property
    def corrected(self) -> Printed:
        """The printed formulas with the correction put in."""
        return tuple(formula.xreplace(self.correction) for formula in self.printed)

    @cached_property
    def agrees(self) -> bool:
        """Whether the computed verdict is the recorded one, and a misprint's correction is none."""
        if self.finding.verdict != self.expected:
            return False
        mended = (Verdict.HOLDS, Verdict.NOT_CHECKABLE)
        return self.expected != Verdict.MISPRINT or self.check(self.corrected).verdict in mended

    def _repr_latex_(self) -> str:
        lines = r" \\ ".join(sp.latex(formula) for formula in self.printed)
        return rf"$\displaystyle \begin{{gathered}}{lines}\end{{gathered}}$"


@dataclass(frozen=True, eq=False)
class Ledger:
    """All entries of one paper: the numbered equations by number, then what is stated beside them by page.

    Parameters
    ----------
    paper : str
        Authors and year.
    entries : tuple of Entry
    """

    paper: str
    entries: tuple[Entry, ...]

    def __post_init__(self) -> None:
        if len({entry.place for entry in self.entries}) != len(self.entries):
            raise ValueError(f"two entries of {self.paper} have the same place")
        ordered = sorted(self.entries, key=lambda e: (e.number is None, e.number or 0, int(e.page)))
        object.__setattr__(self, "entries", tuple(ordered))

    def __getitem__(self, place: str) -> Entry:
        for entry in self.entries:
            if entry.place == place:
                return entry
        raise KeyError(f"{self.paper} has no entry {place!r}; it has {', '.join(e.place for e in self.entries)}")


def column(*entries: Any) -> sp.ImmutableMatrix:
    """A column of numbers."""
    return sp.ImmutableMatrix(entries)


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


class _Scalar(sp.Function):
    """A number made of matrices; ``doit`` works out its value once the matrices are explicit."""

    shown: ClassVar[str]
    value: ClassVar[Callable[..., sp.Expr]]

    def _eval_is_commutative(self) -> bool:
        return True

    def _eval_is_extended_real(self) -> bool:
        return True

    def doit(self, **hints: Any) -> sp.Expr:
        parts = [part.doit(**hints) for part in self.args]
        if all(isinstance(part, sp.MatrixBase) for part in parts):
            return self.value(*parts)
        return self.func(*parts)

    def _latex(self, printer: Any, exp: str = "") -> str:
        text = self.shown % tuple(map(printer.doprint, self.args))
        return rf"{text}^{{{exp}}}" if exp else text


class Norm(_Scalar):
    """Euclidean norm of a vector."""

    shown = r"\left\lVert %s \right\rVert"

    @staticmethod
    def value(*matrices: sp.MatrixBase) -> sp.Expr:
        """Root of the sum of squares."""
        return sp.sqrt(sum(entry**2 for entry in matrices[0]))


class SumNorm(_Scalar):
    """Sum of the absolute values of a vector's entries, each written e sgn(e)."""

    shown = r"\left\lVert %s \right\rVert_1"

    @staticmethod
    def value(*matrices: sp.MatrixBase) -> sp.Expr:
        """Sum of e sgn(e)."""
        return sum((entry * sp.sign(entry) for entry in matrices[0]), sp.S.Zero)


class Inner(_Scalar):
    """Inner product a^T b of two vectors."""

    shown = r"\left\langle %s, %s \right\rangle"

    @staticmethod
    def value(*matrices: sp.MatrixBase) -> sp.Expr:
        """Sum of products."""
        (product,) = matrices[0].T * matrices[1]
        return product


class SmallestEigenvalue(_Scalar):
    """Smallest eigenvalue of a symmetric matrix of at most two rows."""

    shown = r"\lambda_{\min}\left\{ %s \right\}"

    @staticmethod
    def value(*matrices: sp.MatrixBase) -> sp.Expr:
        """The entry of one row; of two rows, half of trace less root."""
        matrix = matrices[0]
        if matrix.shape == (1, 1):
            return matrix[0]
        # The trace stays as a sum of squares, from which sympy sees that it is not negative.
        trace, determinant = matrix.trace(), sp.expand(matrix.det())
        return (trace - sp.sqrt(trace**2 - 4 * determinant)) / 2


def explicit(expression: sp.Basic, values: Values | None = None) -> Any:
    """An expression with values put in and matrices multiplied out."""
    result = expression.xreplace(values or {})
    known = [inverse for inverse in result.atoms(sp.Inverse) if isinstance(inverse.arg, sp.MatrixBase)]
    # In the field of rational functions, for elimination of expressions simplifies at each step.
    result = result.xreplace({i: i.arg.to_DM(field=True).inv().to_Matrix() for i in known}).doit()
    return result.as_explicit() if isinstance(result, sp.MatrixExpr) else result


def vanishes(*expressions: sp.Expr) -> bool:
    """Whether expressions are identically zero, decided exactly.

    One point where one of them is not zero refutes the identity; only the algebra, which takes longer, can prove it.
    """
    return not any(map(_is_refuted, expressions)) and all(map(_is_proven, expressions))


def _somewhere(expression: sp.Expr) -> sp.Expr:
    """The expression's value at some rational point."""
    symbols = sorted(expression.free_symbols, key=str)
    point = {symbol: sp.Rational(sp.prime(k + 3), 3 + k) for k, symbol in enumerate(symbols)}
    return expression.xreplace(point).doit()


def _is_refuted(expression: sp.Expr) -> bool:
    """Whether an expression, as it stands, has a rational value other than zero."""
    if expression.has(_Scalar):
        return False
    value = _somewhere(expression)
    return bool(value.is_Rational and value != 0)


def _is_proven(expression: sp.Expr) -> bool:
    expanded = sp.expand(expression)
    expanded = expanded.xreplace({scalar: sp.Dummy(real=True) for scalar in expanded.atoms(_Scalar)})
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
    """Whether an equation's sides agree identically once values are put in."""
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
        return judged(all(holds(equation, derive) for derive in derivations for equation in printed))

    return check


def not_checkable(printed: Printed) -> Finding:
    """The check of what no computation can decide; the entry's note says why."""
    return Finding(Verdict.NOT_CHECKABLE)


def separates(relation: sp.Basic, quantity: sp.Basic, below: float, above: float, values: Values) -> bool:
    """Whether a printed bound admits a quantity's value below it and excludes one above it."""
    outcomes = [relation.xreplace({quantity: sp.Float(v), **values}).doit() for v in (below, above)]
    return outcomes == [sp.true, sp.false]


def strict_at_zero(printed: Printed, at_zero: Values) -> bool:
    """Whether inequalities contradict themselves where all of their norms are zero."""
    return sp.And(*(formula.xreplace(at_zero).doit() for formula in printed)).simplify() == sp.false


def weakened(printed: Iterable[sp.Basic]) -> dict[sp.Basic, sp.Basic]:
    """The correction that turns every strict inequality into a weak one."""
    return {r: at_most(r.lhs, r.rhs) for r in printed if isinstance(r, Relational)}
