"""Lines of a program in Python or in JavaScript, with formulas that mean the same in both."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, Literal

import sympy as sp
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.logic.boolalg import Boolean
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.pycode import PythonCodePrinter

from percept_obs.compile.intermediate import Intermediate, common_subexpressions, intermediates

Printed = Literal["python", "javascript"]
Notation = Literal["python", "javascript", "many"]

LARGEST_PRODUCT = 8
"""Powers of numbers or of roots up to this are printed as products, the same in every language."""

FUNCTIONS = (
    *(sp.sin, sp.cos, sp.tan, sp.asin, sp.acos, sp.atan, sp.atan2),
    *(sp.exp, sp.log, sp.tanh, sp.cosh, sp.sinh),
)
"""Functions that have the same name in sympy, Python and JavaScript."""

BUILT = (sp.Add, sp.Mul, sp.Symbol, sp.Abs, sp.sign, sp.NumberSymbol, sp.Piecewise, ExprCondPair, Boolean, Intermediate)
KNOWN = (*BUILT, *FUNCTIONS)
"""Kinds of expressions that mean the same in every language, besides numbers and some powers."""


class NotCompilable(ValueError):
    """An expression that would not mean the same in every language."""


def refuse_what_differs(expressions: Sequence[sp.Basic]) -> None:
    """Refuse expressions that a language does not know, or would evaluate in a branch that is not taken."""
    named = [each.written_out for each in intermediates(expressions)]
    for expression in (*expressions, *named):
        for node in sp.preorder_traversal(expression):
            # languages raise to other powers with different rounding, or cannot at all
            power_fits = isinstance(node, sp.Pow) and (2 * node.exp).is_Integer and abs(node.exp) <= LARGEST_PRODUCT
            finite = node.is_number and node.is_finite and (node.is_Rational or node.is_Float)
            if not (power_fits or finite or isinstance(node, KNOWN)):
                raise NotCompilable(f"{node} cannot be printed alike in Python and JavaScript; write it otherwise")
            if isinstance(node, sp.Piecewise):
                inside = [part for branch in node.args for part in sp.preorder_traversal(branch)]
                products = [part for part in inside if part.is_Pow and part.exp.is_Integer and part.exp > 0]
                if any(isinstance(part, sp.log | sp.Pow) and part not in products for part in inside):
                    raise NotCompilable(
                        f"a branch of {node} divides or takes a root; common subexpressions would be evaluated "
                        "where the branch is not taken, so move the division out of the branch"
                    )


class _Printer(PythonCodePrinter):
    """Arithmetic as Python and JavaScript share it, with the names of one of them."""

    def __init__(self, notation: Mapping[str, str]) -> None:
        super().__init__({"fully_qualified_modules": False})
        self.notation = notation

    def _print_Pow(self, expr: sp.Pow, **_: Any) -> str:
        base, exponent = expr.base, expr.exp
        factors = [self.parenthesize(base, PRECEDENCE["Pow"])] * int(abs(exponent))
        # half powers are products times a root
        if not exponent.is_Integer:
            factors.append(f"{self.notation['math']}.sqrt({self._print(base)})")
            if len(factors) == 1:
                return factors[0] if exponent > 0 else f"(1.0/{factors[0]})"
        product = "*".join(factors)
        return f"({product})" if exponent > 0 else f"(1.0/({product}))"

    def _print_Rational(self, expr: sp.Rational) -> str:
        return f"({expr.p}.0/{expr.q}.0)"

    def _print_Integer(self, expr: sp.Integer) -> str:
        return f"{int(expr)}.0"

    def _print_Float(self, expr: sp.Float) -> str:
        return repr(float(expr))

    def _print_NumberSymbol(self, expr: sp.NumberSymbol) -> str:
        return repr(float(expr))

    _print_Pi = _print_Exp1 = _print_NumberSymbol

    def _print_Function(self, expr: sp.Function) -> str:
        name = expr.func.__name__
        called = self.notation.get(name, f"{self.notation['math']}.{name}")
        return f"{called}({', '.join(map(self._print, expr.args))})"

    def _print_Abs(self, expr: sp.Abs) -> str:
        return f"{self.notation['abs']}({self._print(expr.args[0])})"

    def _print_sign(self, expr: sp.sign) -> str:
        inner = self._print(expr.args[0])
        return self._choice(f"{inner} > 0.0", "1.0", self._choice(f"{inner} < 0.0", "-1.0", "0.0"))

    def _print_Piecewise(self, expr: sp.Piecewise) -> str:
        *branches, (last, condition) = expr.args
        if condition != sp.true:
            raise NotCompilable(f"{expr} is not defined everywhere; end it with (expression, True)")
        text = self._print(last)
        # the first condition that holds counts, so that the last branch is the innermost choice
        for branch, condition in reversed(branches):
            text = self._choice(self._print(condition), self._print(branch), text)
        return text

    def _choice(self, condition: str, then: str, otherwise: str) -> str:
        return self.notation["choice"].format(condition, then, otherwise)

    def _print_And(self, expr: sp.And) -> str:
        return "(" + f" {self.notation['and']} ".join(map(self._print, expr.args)) + ")"

    def _print_Or(self, expr: sp.Or) -> str:
        return "(" + f" {self.notation['or']} ".join(map(self._print, expr.args)) + ")"

    def _print_Relational(self, expr: sp.Rel) -> str:
        return f"({self._print(expr.lhs)} {expr.rel_op} {self._print(expr.rhs)})"


for _function in FUNCTIONS:
    setattr(_Printer, f"_print_{_function.__name__}", _Printer._print_Function)


_NOTATIONS = {
    "python": {"math": "math", "abs": "abs", "choice": "({1} if {0} else {2})", "and": "and", "or": "or"},
    "many": {"math": "math", "abs": "abs", "choice": "where({0}, {1}, {2})", "and": "&", "or": "|"}
    | {"exp": "exp", "tanh": "tanh"},
    "javascript": {"math": "Math", "abs": "Math.abs", "choice": "({0} ? {1} : {2})", "and": "&&", "or": "||"},
}


class Text:
    """Lines of a program in Python or in JavaScript; for many runs see `percept_obs.compile.many_runs`."""

    def __init__(self, language: Notation) -> None:
        if language not in _NOTATIONS:
            raise ValueError(f"the language {language!r} is neither 'python' nor 'javascript'")
        self.python = language != "javascript"
        self.print = _Printer(_NOTATIONS[language]).doprint
        self.lines: list[str] = []
        self.depth = 0
        self.assigned: dict[str, None] = {}
        self.printed: dict[tuple[sp.Expr, ...], tuple[list[tuple[str, str]], list[str]]] = {}

    def __str__(self) -> str:
        lines = list(self.lines)
        if not self.python:
            lines.insert(1, f"  let {', '.join(self.assigned)};")
        return "\n".join(lines) + "\n"

    def line(self, text: str) -> None:
        """Add a line, indented."""
        self.lines.append(("    " if self.python else "  ") * self.depth + text)

    def assign(self, name: str, expression: str) -> None:
        """Add a line that assigns a local variable."""
        self.assigned[name] = None
        self.store(name, expression)

    def copy(self, targets: str, values: str, count: int) -> None:
        """Add lines that assign values0, values1, ... to targets0, targets1, ..."""
        for k in range(count):
            self.assign(f"{targets}{k}", f"{values}{k}")

    def store(self, place: str, expression: str) -> None:
        """Add a line that assigns an entry of an array."""
        self.line(f"{place} = {expression}" + ("" if self.python else ";"))

    def formulas(self, expressions: Sequence[sp.Expr], targets: str) -> None:
        """Add lines that assign expressions to targets0, targets1, ..., after their common subexpressions."""
        key = tuple(expressions)
        if key not in self.printed:
            shared, results = common_subexpressions(expressions, sp.numbered_symbols("c", real=True))
            self.printed[key] = [(s.name, self.print(e)) for s, e in shared], [self.print(e) for e in results]
        named, formulas = self.printed[key]
        for name, formula in named:
            self.assign(name, formula)
        for k, formula in enumerate(formulas):
            self.replace(f"{targets}{k}", formula)

    def leave(self, value: str) -> None:
        """Add a line that returns a value."""
        self.line(f"return {value}" + ("" if self.python else ";"))

    @contextmanager
    def _indented(self, python: str, javascript: str) -> Iterator[None]:
        self.line(python + ":" if self.python else javascript + " {")
        self.depth += 1
        yield
        self.depth -= 1
        if not self.python:
            self.line("}")

    def function(self, name: str, arguments: str) -> Any:
        """Open a function."""
        return self._indented(f"def {name}({arguments})", f"function {name}({arguments})")

    def loop(self, index: str, over: str) -> Any:
        """Open a loop over an array's indices."""
        return self._indented(
            f"for {index} in range(len({over}))", f"for (let {index} = 0; {index} < {over}.length; {index}++)"
        )

    def block(self, word: Literal["if", "unless"], condition: str) -> Any:
        """Open a block under a condition."""
        if word == "unless":
            return self._indented(f"if not {condition}", f"if (!({condition}))")
        return self._indented(f"if {condition}", f"if ({condition})")

    def only(self, condition: str) -> Any:
        """Open a block in which `replace` counts where a condition holds."""
        return self.block("if", condition)

    def replace(self, name: str, expression: str) -> None:
        """Assign a local variable; inside `only` where its condition holds."""
        self.assign(name, expression)
