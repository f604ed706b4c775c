"""The loop's text: one classical Runge-Kutta loop, written once, printed in Python and in JavaScript.

The loop is unrolled down to scalars, so that the Python text runs as it is and numba compiles the same text.
Whatever a user may want to move (motion, gains, noise, start) is an argument; only a new structure compiles.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import lru_cache
from typing import Any, Literal

import sympy as sp
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.logic.boolalg import Boolean, BooleanFunction
from sympy.printing.precedence import PRECEDENCE
from sympy.printing.pycode import PythonCodePrinter

from percept_obs.compile.equations import Equations

LARGEST_SQUARED_STATE = 1e300
"""A state whose squared norm exceeds this, or is not a number, has diverged."""

LARGEST_PRODUCT = 8
"""Integer powers up to this are printed as products, the same in every language."""

_FUNCTIONS = {
    sp.sin: "sin",
    sp.cos: "cos",
    sp.tan: "tan",
    sp.exp: "exp",
    sp.log: "log",
    sp.tanh: "tanh",
    sp.cosh: "cosh",
    sp.sinh: "sinh",
    sp.atan2: "atan2",
}


class NotCompilable(ValueError):
    """An expression that would not mean the same in every language."""


@lru_cache(maxsize=512)
def source(equations: Equations, language: Literal["python", "javascript"] = "python") -> str:
    """Text of the loop for these equations.

    Parameters
    ----------
    equations : Equations
    language : "python" or "javascript"

    Returns
    -------
    str
        A function ``run(start, steps, measured, parameters, samples, gains, varying, states, resets)`` on flat
        arrays laid out as in `Table`.  It fills states and resets, and returns the index of the row at
        which the state was no longer finite, or -1.

    Raises
    ------
    NotCompilable
        If an expression would not mean the same in both languages.
    """
    n, m, p = len(equations.state), len(equations.measured), len(equations.parameters)
    text = Text(language)
    names = {
        symbol: sp.Symbol(f"{letter}{k}", real=True)
        for letter, group in (
            ("x", equations.state),
            ("y", equations.measured),
            ("p", equations.parameters),
            ("g", equations.gains),
        )
        for k, symbol in enumerate(group)
    }

    fixed: dict[sp.Expr, sp.Symbol] = {}
    known_gains = {names[symbol] for symbol in equations.gains}
    variables = [names[symbol] for symbol in (*equations.state, *equations.measured)]

    def prepared(expressions: Sequence[sp.Expr]) -> list[sp.Expr]:
        """The expressions in the loop's names, with what depends on gains only taken out."""
        renamed = [sp.sympify(e).xreplace(names) for e in expressions]
        refuse_what_differs(renamed)
        return [_take_out(_nested(e, variables), known_gains, fixed) for e in renamed]

    flow, reset = prepared(equations.flow), prepared(equations.reset)
    update = [prepared(block) for block in equations.update]
    (condition,) = prepared([equations.reset_condition])

    def load_parameters(row: str) -> None:
        if p:
            with text.block("if", "varying"):
                for k in range(p):
                    text.assign(f"p{k}", f"parameters[({row})*{p} + {k}]")

    def hold(stage: int) -> None:
        for k in range(m):
            text.assign(f"y{k}", f"measured[k*{3 * m} + {stage * m + k}]")

    def stage(advance: str) -> None:
        for k in range(n):
            text.assign(f"x{k}", f"s{k} + {advance}*d{k}" if advance else f"s{k}")
        text.formulas(flow, "d")

    def replace_state(expressions: Sequence[sp.Expr]) -> None:
        for k in range(n):
            text.assign(f"x{k}", f"s{k}")
        text.formulas(expressions, "s")

    def updates(row: str) -> None:
        for k, block in enumerate(update):
            value = f"samples[({row})*{m} + {k}]"
            with text.block("if", f"{value} == {value}"):
                text.assign(f"y{k}", value)
                replace_state(block)

    def keep() -> None:
        for k in range(n):
            text.store(f"states[row + {k}]" if k else "states[row]", f"s{k}")

    with text.function(
        "run", ["start", "steps", "measured", "parameters", "samples", "gains", "varying", "states", "resets"]
    ):
        for letter, group, count in (
            ("s", "start", n),
            ("g", "gains", len(equations.gains)),
            ("p", "parameters", p),
        ):
            for k in range(count):
                text.assign(f"{letter}{k}", f"{group}[{k}]")
        for expression, symbol in fixed.items():
            text.assign(symbol.name, text.print(expression))
        text.assign("row", "0")
        updates("0")
        keep()
        with text.loop("k", "steps"):
            text.assign("h", "steps[k]")
            text.assign("half", "0.5*h")
            text.assign("sixth", "h/6.0")
            load_parameters("2*k")
            hold(0)
            stage("")
            for k in range(n):
                text.assign(f"q{k}", f"d{k}")
            load_parameters("2*k + 1")
            for middle in range(2):
                if not middle:
                    hold(1)
                stage("half")
                for k in range(n):
                    text.assign(f"q{k}", f"q{k} + 2.0*d{k}")
            load_parameters("2*k + 2")
            hold(2)
            stage("h")
            for k in range(n):
                text.assign(f"s{k}", f"s{k} + sixth*(q{k} + d{k})")
            updates("k + 1")
            if equations.reset:
                for k in range(n):
                    text.assign(f"x{k}", f"s{k}")
                with text.block("if", text.print(condition)):
                    text.formulas(reset, "s")
                    text.store("resets[k + 1]", "1.0")
            text.assign("size", " + ".join(f"s{k}*s{k}" for k in range(n)))
            with text.block("unless", f"size < {LARGEST_SQUARED_STATE!r}"):
                text.leave("k + 1")
            text.assign("row", f"row + {n}")
            keep()
        text.leave("-1")
    return str(text)


def _nested(expression: sp.Basic, variables: Sequence[sp.Symbol]) -> sp.Basic:
    """Nest sums as in Horner's scheme: the variable that most terms share is multiplied last."""
    if not isinstance(expression, sp.Add):
        return expression.func(*(_nested(e, variables) for e in expression.args)) if expression.args else expression
    powers = [term.as_powers_dict() for term in expression.args]
    sharing = {
        v: {k for k, power in enumerate(powers) if sp.S(power.get(v, 0)).is_Integer and power.get(v, 0) > 0}
        for v in variables
    }
    shared = max(variables, key=lambda v: len(sharing[v]), default=None)
    if shared is None or len(sharing[shared]) < 2:
        return sp.Add(*(_nested(term, variables) for term in expression.args))
    inside = sp.Add(*(expression.args[k] / shared for k in sorted(sharing[shared])))
    outside = sp.Add(*(term for k, term in enumerate(expression.args) if k not in sharing[shared]))
    return shared * _nested(inside, variables) + _nested(outside, variables)


def _take_out(expression: sp.Basic, gains: set[sp.Symbol], fixed: dict[sp.Expr, sp.Symbol]) -> sp.Basic:
    """Replace the parts that depend on gains only by names, which `fixed` collects."""
    if not expression.args or not expression.free_symbols & gains:
        return expression
    if isinstance(expression, sp.Expr) and expression.free_symbols <= gains:
        return fixed.setdefault(expression, sp.Symbol(f"f{len(fixed)}", real=True))
    if isinstance(expression, sp.Mul | sp.Add):
        fixed_parts = [e for e in expression.args if e.free_symbols and e.free_symbols <= gains]
        if len(fixed_parts) > 1:
            together = expression.func(*fixed_parts)
            rest = [e for e in expression.args if e not in fixed_parts]
            expression = expression.func(fixed.setdefault(together, sp.Symbol(f"f{len(fixed)}", real=True)), *rest)
    return expression.func(*(_take_out(e, gains, fixed) for e in expression.args))


def refuse_what_differs(expressions: Sequence[sp.Basic]) -> None:
    """Refuse what a language would not know, or would evaluate in a branch that is not taken."""
    for expression in expressions:
        for node in sp.preorder_traversal(expression):
            power_fits = isinstance(node, sp.Pow) and (
                (node.exp.is_Integer and abs(node.exp) <= LARGEST_PRODUCT) or abs(node.exp) == sp.Rational(1, 2)
            )
            plain = (sp.Add, sp.Mul, sp.Symbol, sp.Abs, sp.sign, sp.Piecewise, ExprCondPair, sp.Rel, Boolean)
            known = isinstance(node, (*plain, BooleanFunction)) or node.func in _FUNCTIONS
            finite = node.is_number and node.is_finite and (node.is_Rational or node.is_Float)
            constant = isinstance(node, sp.NumberSymbol)
            if not (power_fits or known or finite or constant):
                raise NotCompilable(f"{node} cannot be printed alike in Python and JavaScript; write it otherwise")
            if isinstance(node, sp.Piecewise):
                for branch in node.args:
                    if any(
                        isinstance(part, sp.log) or (isinstance(part, sp.Pow) and not _is_product(part))
                        for part in sp.preorder_traversal(branch)
                    ):
                        raise NotCompilable(
                            f"a branch of {node} divides or takes a root; common subexpressions would be evaluated "
                            "where the branch is not taken, so move the division out of the branch"
                        )


def _is_product(power: sp.Pow) -> bool:
    return bool(power.exp.is_Integer and power.exp > 0)


class _Printer(PythonCodePrinter):
    """Arithmetic in the notation that Python and JavaScript share; what differs is in the words."""

    def __init__(self, words: Mapping[str, str]) -> None:
        super().__init__({"fully_qualified_modules": False})
        self.words = words

    def _print_Pow(self, expr: sp.Pow, **_: Any) -> str:
        base, exponent = expr.base, expr.exp
        if abs(exponent) == sp.Rational(1, 2):
            root = f"{self.words['math']}.sqrt({self._print(base)})"
            return root if exponent > 0 else f"(1.0/{root})"
        product = "*".join([self.parenthesize(base, PRECEDENCE["Pow"])] * abs(int(exponent)))
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
        return f"{self.words['math']}.{_FUNCTIONS[expr.func]}({', '.join(map(self._print, expr.args))})"

    def _print_Abs(self, expr: sp.Abs) -> str:
        return f"{self.words['abs']}({self._print(expr.args[0])})"

    def _print_sign(self, expr: sp.sign) -> str:
        inner = self._print(expr.args[0])
        return self._choice(f"{inner} > 0.0", "1.0", self._choice(f"{inner} < 0.0", "-1.0", "0.0"))

    def _print_Piecewise(self, expr: sp.Piecewise) -> str:
        *branches, (last, condition) = expr.args
        if condition != sp.true:
            raise NotCompilable(f"{expr} is not defined everywhere; end it with (expression, True)")
        text = self._print(last)
        for branch, condition in reversed(branches):
            text = self._choice(self._print(condition), self._print(branch), text)
        return text

    def _choice(self, condition: str, then: str, otherwise: str) -> str:
        return self.words["choice"].format(condition, then, otherwise)

    def _print_And(self, expr: sp.And) -> str:
        return "(" + f" {self.words['and']} ".join(map(self._print, expr.args)) + ")"

    def _print_Or(self, expr: sp.Or) -> str:
        return "(" + f" {self.words['or']} ".join(map(self._print, expr.args)) + ")"

    def _print_Relational(self, expr: sp.Rel) -> str:
        return f"({self._print(expr.lhs)} {expr.rel_op} {self._print(expr.rhs)})"


for _function in _FUNCTIONS:
    setattr(_Printer, f"_print_{_function.__name__}", _Printer._print_Function)


_WORDS = {
    "python": {"math": "math", "abs": "abs", "choice": "({1} if {0} else {2})", "and": "and", "or": "or"},
    "javascript": {"math": "Math", "abs": "Math.abs", "choice": "({0} ? {1} : {2})", "and": "&&", "or": "||"},
}


class Text:
    """Lines of a program in one of two languages."""

    def __init__(self, language: str) -> None:
        if language not in _WORDS:
            raise ValueError(f"the language {language!r} is neither 'python' nor 'javascript'")
        self.python = language == "python"
        self.print = _Printer(_WORDS[language]).doprint
        self.lines: list[str] = []
        self.depth = 0
        self.assigned: dict[str, None] = {}

    def __str__(self) -> str:
        lines = list(self.lines)
        if not self.python:
            lines.insert(1, f"  let {', '.join(self.assigned)};")
        return "\n".join(lines) + "\n"

    def line(self, text: str) -> None:
        """Add a line, indented."""
        self.lines.append(("    " if self.python else "  ") * self.depth + text)

    def assign(self, name: str, expression: str) -> None:
        """Give a local variable a value."""
        self.assigned[name] = None
        self.store(name, expression)

    def store(self, place: str, expression: str) -> None:
        """Give a place in an array a value."""
        self.line(f"{place} = {expression}" + ("" if self.python else ";"))

    def formulas(self, expressions: Sequence[sp.Expr], targets: str) -> None:
        """Assign the expressions to targets0, targets1, ..., common subexpressions first."""
        shared, results = sp.cse(expressions, symbols=sp.numbered_symbols("c", real=True))
        for symbol, expression in shared:
            self.assign(symbol.name, self.print(expression))
        for k, expression in enumerate(results):
            self.assign(f"{targets}{k}", self.print(expression))

    def leave(self, value: str) -> None:
        """Return a value."""
        self.line(f"return {value}" + ("" if self.python else ";"))

    @contextmanager
    def _indented(self, python: str, javascript: str) -> Iterator[None]:
        self.line(python + ":" if self.python else javascript + " {")
        self.depth += 1
        yield
        self.depth -= 1
        if not self.python:
            self.line("}")

    def function(self, name: str, arguments: Sequence[str]) -> Any:
        """The function that the lines inside make up."""
        head = f"{name}({', '.join(arguments)})"
        return self._indented(f"def {head}", f"function {head}")

    def loop(self, index: str, over: str) -> Any:
        """The loop over an array's indices."""
        return self._indented(
            f"for {index} in range(len({over}))", f"for (let {index} = 0; {index} < {over}.length; {index}++)"
        )

    def block(self, word: Literal["if", "unless"], condition: str) -> Any:
        """What is done only under a condition."""
        if word == "unless":
            return self._indented(f"if not {condition}", f"if (!({condition}))")
        return self._indented(f"if {condition}", f"if ({condition})")
