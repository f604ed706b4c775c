"""Named intermediate results, such as a root: equations carry the name, and kernels compute it once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import Any

import sympy as sp


class Intermediate(sp.Function):
    """A function, such as a root, that formulas name instead of writing it out, which would make each of them long.

    A subclass defines its `value`, and an `equation` that it solves, from which its derivatives follow in terms of
    itself, without another root.

    Examples
    --------
    >>> class root(Intermediate):
    ...     @staticmethod
    ...     def value(x):
    ...         return sp.sqrt(1 + x**2)
    ...
    ...     @staticmethod
    ...     def equation(root, x):
    ...         return root**2 - 1 - x**2
    >>> x = sp.Symbol("x", real=True)
    >>> root(x).diff(x), root(x).subs(x, 3)
    (x/root, sqrt(10))
    """

    @staticmethod
    def value(*letters: sp.Expr) -> sp.Expr:
        """Return its value as an expression."""
        raise NotImplementedError

    @staticmethod
    def equation(*letters: sp.Expr) -> sp.Expr:
        """Return an expression in the function's value and arguments that is 0 where the value is right."""
        raise NotImplementedError

    @classmethod
    def eval(cls, *letters: sp.Expr) -> sp.Expr | None:
        """Return its number, if all arguments are numbers."""
        return cls.value(*letters) if all(letter.is_number for letter in letters) else None

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Derivative by an argument, counted from 1."""
        kind: Any = type(self)
        own, letters, derivatives = _derivatives(kind, len(self.args))
        return derivatives[argindex - 1].xreplace({own: self, **dict(zip(letters, self.args, strict=True))})

    @property
    def written_out(self) -> sp.Expr:
        """Value, as an expression of the arguments."""
        return self.value(*self.args)

    @property
    def letter(self) -> sp.Symbol:
        """Letter in formulas, with a hat where the arguments are estimates."""
        name, free = type(self).__name__, [argument for argument in self.args if not argument.is_number]
        if any("hat" in symbol.name for symbol in self.free_symbols):
            name += "hat"
        elif not all(argument.is_Symbol for argument in free):
            name += f"({', '.join(map(str, free))})"
        return sp.Symbol(name, real=True)

    def _eval_is_real(self) -> bool:
        return True

    def _sympystr(self, printer: Any) -> str:
        return str(printer._print(self.letter))

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        text = printer._print(self.letter)
        return text if exp is None else f"{text}^{{{exp}}}"


@lru_cache
def _derivatives(kind: Any, count: int) -> tuple[sp.Symbol, tuple[sp.Symbol, ...], tuple[sp.Expr, ...]]:
    """Symbols of itself and of its arguments, and its derivatives by these, from its equation."""
    own, *letters = (sp.Dummy(real=True) for _ in range(count + 1))
    equation = kind.equation(own, *letters)
    return own, tuple(letters), tuple(-sp.cancel(equation.diff(x) / equation.diff(own)) for x in letters)


def intermediates(expressions: Iterable[sp.Basic]) -> list[Intermediate]:
    """Intermediate results in expressions, each after those that it depends on."""
    return list(dict.fromkeys(_inside(expressions)))


def _inside(expressions: Iterable[sp.Basic]) -> Iterator[Intermediate]:
    found = sp.Tuple(*expressions).atoms(Intermediate)
    for each in sorted(found, key=sp.default_sort_key):
        # inner results first, so that each one stands after those that it needs
        yield from _inside([each.written_out])
        yield each


def written_out(expression: sp.Basic) -> sp.Basic:
    """Expression with the values of intermediate results."""
    while found := expression.atoms(Intermediate):
        expression = expression.xreplace({each: each.written_out for each in found})
    return expression


def in_letters(expression: sp.Basic) -> sp.Basic:
    """Expression with a letter for each intermediate result, to be read, not computed."""
    return expression.xreplace({each: each.letter for each in expression.atoms(Intermediate)})


def definitions(expressions: Iterable[sp.Basic]) -> dict[sp.Symbol, sp.Expr]:
    """Values of the intermediate results in expressions, by their letters."""
    return {each.letter: in_letters(each.written_out) for each in intermediates(expressions)}


def common_subexpressions(
    expressions: Iterable[sp.Expr], names: Iterator[sp.Symbol] | None = None
) -> tuple[list[tuple[sp.Symbol, sp.Expr]], list[sp.Expr]]:
    """Take intermediate results and common subexpressions out: values to compute first, in order, and what is left."""
    expressions = list(expressions)
    names = names or sp.numbered_symbols("shared")
    known: dict[sp.Basic, sp.Symbol] = {}
    first: list[tuple[sp.Symbol, sp.Expr]] = []
    for each in intermediates(expressions):
        shared, (value,) = sp.cse([each.written_out.xreplace(known)], symbols=names)
        # later results may use this one by its name
        known[each] = next(names)
        first += [*shared, (known[each], value)]
    shared, left = sp.cse([e.xreplace(known) for e in expressions], symbols=names)
    return [*first, *shared], left
