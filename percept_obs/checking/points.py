"""Values of an expression at random points, with sixty digits or as floats."""

from __future__ import annotations

import random
import re
from functools import cache, lru_cache
from typing import Any

import mpmath
import sympy as sp
from sympy.core.relational import Relational

from percept_obs.compile import Intermediate

DIGITS = 60
ACCENTS = r"(?<=[A-Za-z0-9])(?:hat|bar|tilde|dot)"
KINKED = (sp.Abs, sp.sign, sp.Piecewise, sp.Max, sp.Min, sp.floor, sp.ceiling)
"""Functions with kinks or jumps: formulas with them may agree at many points and differ elsewhere."""


class NoValue(ArithmeticError):
    """The expression has no value at the point: a denominator vanishes, or a root does not exist."""


@lru_cache(maxsize=4096)
def key(name: str) -> str:
    """Return one spelling of a letter's name: v_c1 and v_{c1} are the same letter, yhat1, y1hat and y_1hat too."""
    plain = re.sub(r"[_{}\s\\]", "", name)
    marks = re.findall(ACCENTS, plain)
    return re.sub(ACCENTS, "", plain) + "".join(sorted(marks, key=ACCENTS.index))


@lru_cache(maxsize=1 << 14)
def _random(seed: int, name: str) -> tuple[int, int]:
    """Return sixty random bits and a sign that follow from a seed and a name."""
    draw = random.Random(f"{seed} {name}")
    return draw.getrandbits(60), draw.choice((-1, 1))


class Point:
    """Point at which expressions have real or complex values; letters get theirs by their names and the seed.

    If exact, it computes with sixty digits rather than with floats.  If opaque, integrals, derivatives and functions
    with kinks get random values as well: equal ones for equal arguments.
    """

    def __init__(self, seed: int, exact: bool = False, opaque: bool = False) -> None:
        self.seed, self.exact, self.opaque = seed, exact, opaque
        self.mp = _sixty_digits() if exact else mpmath.fp
        self.known: dict[sp.Basic, Any] = {}

    def __call__(self, expression: sp.Basic) -> Any:
        """Return the value; raise `NoValue` where there is none."""
        value = self.known.get(expression)
        if value is None:
            try:
                value = self._value(expression)
            except (ZeroDivisionError, OverflowError, ValueError):  # a pole, in mpmath
                raise NoValue from None
            self.known[expression] = value
        return value

    def _value(self, e: sp.Basic) -> Any:
        if e.is_Symbol:
            return self._drawn(key(e.name))
        if e.is_Rational:
            return self.mp.mpf(int(e.p)) / int(e.q)
        if e.is_Add:
            return sum(map(self, e.args))
        if e.is_Mul:
            product = self(e.args[0])
            for factor in e.args[1:]:
                product = product * self(factor)
            return product
        if e.is_Pow:
            return self(e.base) ** int(e.exp) if e.exp.is_Integer else self.mp.power(self(e.base), self(e.exp))
        if e.is_Float:
            return self(sp.Rational(str(e)))
        if e is sp.I:
            return self.mp.j
        if isinstance(e, sp.NumberSymbol):
            return self.mp.mpf(str(e.n(DIGITS + 5)))
        if isinstance(e, Intermediate):
            return self(e.written_out)
        if e.func in _FUNCTIONS and not (self.opaque and isinstance(e, sp.Abs | sp.sign)):
            return getattr(self.mp, _FUNCTIONS[e.func])(*map(self, e.args))
        return self._opaque(e) if self.opaque and e.args else self._special(e)

    def _opaque(self, e: sp.Basic) -> Any:
        """Return a random value for a function with kinks, an integral, ..., the same one for equal arguments."""
        if isinstance(e, sp.Abs | sp.sign):
            _, sign = _random(self.seed, f"sign {self._name(e.args[0])}")  # its square is 1, as that of the true one
            return sign * self(e.args[0]) if isinstance(e, sp.Abs) else sign
        return self._drawn(f"{e.func.__name__} {[self._name(part) for part in e.args]}")

    def _name(self, e: sp.Basic) -> str:
        """Return a text that is equal for equal arguments of a function."""
        if not e.args:
            return key(str(e))
        if isinstance(e, Relational | sp.Tuple):
            return f"{e.func.__name__} {[self._name(part) for part in e.args]}"
        return f"{complex(self(e)):.10e}"

    def _special(self, e: sp.Basic) -> Any:
        """Return the value of branches, extrema or an integral, as sympy finds it."""
        parts = e.free_symbols | e.atoms(Intermediate)
        try:
            value = e.xreplace({part: sp.Float(self.mp.nstr(self(part), DIGITS), DIGITS) for part in parts})
            return self.mp.convert(value.evalf(DIGITS))
        except TypeError:  # it has no value, or a complex one is compared
            raise NoValue from None

    def _drawn(self, name: str) -> Any:
        bits, sign = _random(self.seed, name)
        return sign * (self.mp.mpf(bits) / 2**60 + 0.2)


_FUNCTIONS = {
    **{f: f.__name__ for f in (sp.exp, sp.log, sp.sin, sp.cos, sp.tan, sp.sinh, sp.cosh, sp.tanh, sp.sech)},
    **{f: f.__name__ for f in (sp.asin, sp.acos, sp.atan, sp.atan2, sp.sign)},
    sp.Abs: "fabs",
}


@cache
def _sixty_digits() -> Any:
    context = mpmath.mp.clone()
    context.dps = DIGITS
    return context
