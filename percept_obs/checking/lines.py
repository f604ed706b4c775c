"""Lines of a target: formulas, equations, inequalities and sets of zeros, each with its name."""

from __future__ import annotations

import re
from dataclasses import dataclass

import sympy as sp
from sympy.core.relational import Relational
from sympy.logic.boolalg import Boolean

from percept_obs.checking.points import key

VALUE, EQUATION, INEQUALITY, ZEROS = "value", "equation", "inequality", "zeros"


@dataclass(frozen=True)
class Line:
    """Line of a target.

    The name is the left side as it is typed, "y1'", or words; empty if it has none.  The formula is the right side; of
    other equations and inequalities the left side less the right one.  Equations are the same up to a number,
    inequalities up to a positive one; of "zeros" it only matters where the formula is zero.
    """

    name: str
    formula: sp.Expr
    kind: str = VALUE

    @property
    def key(self) -> str:
        """Name as `read` returns it."""
        return typed(self.name)


def typed(name: str) -> str:
    """Return a name in letters and digits, with "dot" for a prime; empty for words."""
    if not re.fullmatch(r"[\w^]+'*", name):
        return ""
    return key(name.replace("'", "dot"))


def lines_of(name: str, formula: sp.Basic) -> list[Line]:
    """Return the lines of an expression, a matrix or a relation."""
    if isinstance(formula, sp.MatrixBase):
        return [Line("", entry) for entry in formula]
    if isinstance(formula, Relational):
        return relation_lines(formula)
    if isinstance(formula, sp.And | sp.Or):
        return [Line("", condition(formula), ZEROS)]
    return [Line(name, formula)]


def relation_lines(relation: Relational) -> list[Line]:
    """Return a relation as lines: y = f as a value, f = 0 and f != 0 as a set of zeros, matrices entry by entry."""
    left, right = relation.lhs, relation.rhs
    if isinstance(left, sp.MatrixBase) or isinstance(right, sp.MatrixBase):
        pairs = zip(left, right, strict=True)
        return [line for a, b in pairs for line in relation_lines(relation.func(a, b, evaluate=False))]
    if isinstance(relation, sp.Eq | sp.Ne):
        named = isinstance(relation, sp.Eq) and left.is_Symbol
        if right == 0 and not named:
            return [Line("", left, ZEROS)]
        name = primed(left.name) if named else ""
        return [Line(name, right) if named else Line("", left - right, EQUATION)]
    return [Line("", relation.gts - relation.lts, INEQUALITY)]


def primed(name: str) -> str:
    """Return the name of a rate as it is typed: y1' for ydot1."""
    return re.sub(r"dot(\d*)$", r"\1'", name)


def condition(formula: Boolean) -> sp.Expr:
    """Return the expression that is not zero where a condition of parts that are not zero holds."""
    if isinstance(formula, sp.And):
        return sp.Mul(*map(condition, formula.args))
    if isinstance(formula, sp.Or):
        return sp.Add(*(condition(part) ** 2 for part in formula.args))
    if isinstance(formula, sp.Ne):
        return formula.lhs - formula.rhs
    raise ValueError(f"the condition {formula} cannot be compared; give one of parts that must not be zero, f != 0")
