"""Differences of two formulas once they are multiplied out: products of letters whose coefficients differ."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp
from sympy.polys.fields import sfield

from percept_obs.checking.deciding import points, rational, small


@dataclass(frozen=True)
class Difference:
    """A product of letters whose coefficient differs: yours, and the true one."""

    product: sp.Expr
    mine: sp.Expr
    true: sp.Expr


def compared(mine: sp.Expr, true: sp.Expr) -> tuple[tuple[Difference, ...], tuple[int, ...]]:
    """Return products whose coefficients differ, and the numbers of my terms that hold one.

    Denominators are cleared first; nothing is found in formulas that are too large to multiply out.
    """
    if not small(mine, true):
        return (), ()
    parts = [*sp.Add.make_args(mine), true]
    letters = _letters_for_functions(parts)
    field, elements = sfield([part.xreplace(letters) for part in parts])
    # the same factor for all parts leaves their differences in the same products
    common = field.ring.one
    for element in elements:
        common = common.lcm(element.denom)
    polynomials = [element.numer * (common.quo(element.denom)) for element in elements]
    for number, square in _squares(field, letters):
        polynomials = [_reduced(p, number, square) for p in polynomials]
    *own, target = [dict(p.terms()) for p in polynomials]
    # my terms one by one say which of them is wrong, their sum whether one is
    total = dict(sum(polynomials[:-1], field.ring.zero).terms())
    back = {letter: function for function, letter in letters.items()}
    differ = [m for m in {**target, **total} if total.get(m, 0) != target.get(m, 0)]
    found = [
        Difference(
            sp.Mul(*(g**k for g, k in zip(field.symbols, m, strict=True))).xreplace(back),
            *(sp.sympify(field.domain.to_sympy(side.get(m, field.domain.zero))) for side in (total, target)),
        )
        for m in differ
    ]
    wrong = tuple(k for k, part in enumerate(own) if any(m in part for m in differ))
    return tuple(found), wrong


def _letters_for_functions(parts: Sequence[sp.Expr]) -> dict[sp.Expr, sp.Symbol]:
    """Return a letter for every root and function, the same one for equal values."""
    if all(map(rational, parts)):
        return {}
    point = next(points(*parts, opaque=True), None)
    outermost: dict[sp.Expr, sp.Symbol] = {}

    def visit(node: sp.Basic) -> None:
        if node.is_Symbol or node.is_Rational:
            return
        if node.is_Add or node.is_Mul or (node.is_Pow and node.exp.is_Integer):
            for part in node.args:
                visit(part)
        else:
            # equal values at a random point: the same function, however its argument is written
            outermost[node] = sp.Symbol(f"f{complex(point(node)):.10e}" if point else f"f{node}")

    for part in parts:
        visit(part)
    return outermost


def _squares(field: Any, letters: Mapping[sp.Expr, sp.Symbol]) -> Iterator[tuple[int, Any]]:
    """Yield the number of each letter that stands for a root or a sine, and its square as a polynomial."""
    for function, letter in letters.items():
        if isinstance(function, sp.sin):
            square = 1 - sp.cos(*function.args) ** 2
        elif function.is_Pow and function.exp == sp.S.Half:
            square = function.base
        else:
            continue
        square = square.xreplace(letters)
        if square.free_symbols <= set(field.symbols) and square.is_polynomial() and letter in field.symbols:
            yield field.symbols.index(letter), field.ring.from_expr(square)


def _reduced(polynomial: Any, number: int, square: Any) -> Any:
    """Return a polynomial in which a polynomial replaces the square of a letter, given by its number."""
    found = polynomial.ring.zero
    for powers, coefficient in polynomial.terms():
        # x^5 becomes x (x^2)^2, with the square put in
        rest = (*powers[:number], powers[number] % 2, *powers[number + 1 :])
        found += polynomial.ring({rest: coefficient}) * square ** (powers[number] // 2)
    return found
