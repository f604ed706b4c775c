"""Lines of a target: formulas, equations, inequalities and sets of zeros, each with its name."""

from __future__ import annotations

import re
from dataclasses import dataclass

import sympy as sp
from sympy.core.relational import Relational
from sympy.logic.boolalg import Boolean

from percept_obs.checking.deciding import points
from percept_obs.checking.points import key

VALUE, EQUATION, INEQUALITY, ZEROS = "value", "equation", "inequality", "zeros"


@dataclass(frozen=True)
class Line:
    """Line that a target asks for: its name, its formula, and how a typed formula is compared with it.

    The name is the left side as it is typed, "y1'", or words; empty if it has none.  The formula is the right side; of
    other equations and inequalities the left side less the right one.  Equations are the same up to a number,
    inequalities up to a positive one, those of matrices as quadratic forms; of "zeros" it only matters where the
    formula is zero.
    """

    name: str
    formula: sp.Expr
    kind: str = VALUE
    strict: bool = False  # of an inequality: < rather than <=; of zeros: not zero rather than zero

    @property
    def key(self) -> str:
        """Name as `read` returns it."""
        return typed(self.name)

    @property
    def whole(self) -> str:
        """Name, or that of the matrix of which the line is an entry: "S" for "S, row 2"."""
        return self.name.partition(", ")[0] if re.search(r", (row|entry) [\d(), ]+$", self.name) else self.name


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
        return [Line("", condition(formula), ZEROS, strict=True)]
    return [Line(name, formula)]


def relation_lines(relation: Relational) -> list[Line]:
    """Return a relation as lines: y = f as a value, f = 0 and f != 0 as a set of zeros, matrices entry by entry."""
    if any(isinstance(side, sp.MatrixBase) for side in relation.args):
        relation = of_matrices(relation)
    left, right = relation.lhs, relation.rhs
    if isinstance(left, sp.MatrixBase):
        if not isinstance(relation, sp.Eq | sp.Ne):
            z = sp.Matrix(sp.symbols(f"z1:{left.rows + 1}", real=True))
            form = (z.T * (relation.gts - relation.lts) * z)[0]
            return [Line("", form, INEQUALITY, strict=_strict(relation))]
        pairs = zip(left, right, strict=True)
        return [line for a, b in pairs for line in relation_lines(relation.func(a, b, evaluate=False))]
    if isinstance(relation, sp.Eq | sp.Ne):
        named = isinstance(relation, sp.Eq) and left.is_Symbol
        if right == 0 and not named:
            return [Line("", left, ZEROS, strict=isinstance(relation, sp.Ne))]
        name = primed(left.name) if named else ""
        return [Line(name, right) if named else Line("", left - right, EQUATION)]
    return [Line("", relation.gts - relation.lts, INEQUALITY, strict=_strict(relation))]


def _strict(relation: Relational) -> bool:
    return isinstance(relation, sp.StrictGreaterThan | sp.StrictLessThan)


def of_matrices(relation: Relational) -> Relational:
    """Return a relation of matrices with 0 as a zero matrix; raise ValueError if the sides' sizes differ."""
    shape = next(side.shape for side in relation.args if isinstance(side, sp.MatrixBase))
    left, right = (sp.ImmutableMatrix.zeros(*shape) if side == 0 else side for side in relation.args)
    for side in (left, right):
        if not isinstance(side, sp.MatrixBase):
            raise ValueError(f"a matrix is compared with the number {side}; write {side} times the identity, {side} I")
        if side.shape != shape:
            raise ValueError(f"matrices of {shape[0]} x {shape[1]} and {side.rows} x {side.cols} are compared")
    return relation.func(left, right, evaluate=False)


def primed(name: str) -> str:
    """Return the name of a rate as it is typed: y1' for ydot1."""
    return re.sub(r"dot(\d*)$", r"\1'", name)


def condition(formula: Boolean) -> sp.Expr:
    """Return an expression that is not zero exactly where a condition holds: f g for f != 0 and g != 0."""
    if isinstance(formula, sp.And):
        return sp.Mul(*map(condition, formula.args))
    if isinstance(formula, sp.Or):
        return sp.Add(*(condition(part) ** 2 for part in formula.args))
    if isinstance(formula, sp.Ne):
        return formula.lhs - formula.rhs
    if isinstance(formula, sp.StrictGreaterThan | sp.StrictLessThan):
        positive = formula.gts - formula.lts
        if all(point(positive) >= 0 for point in points(positive)):
            return positive
        raise ValueError(f"{positive} has both signs, and the condition holds where it is not zero; write != 0")
    raise ValueError(f"the condition {formula} cannot be compared; give one of parts that must not be zero, f != 0")
