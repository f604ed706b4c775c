"""Values of an expression at a point: exactly, modulo a prime, or with sixty digits.

Modulo a prime the rules of arithmetic hold, so that what is the same function has the same value.  The primes are
chosen so that the rules of other functions hold as well:

- a square has one root that is a square itself; taken as *the* root it is multiplicative, as roots of positive
  numbers are, and with "is a square" for "is positive" so are absolute value and sign;
- ``PRIME - 1`` is a multiple of ``GROWTH``, so that some g has g^GROWTH = 1: then g^a, with a taken modulo GROWTH,
  is an exponential;
- ``PRIME + 1`` is a multiple of ``ANGLE``: likewise there are a cosine and a sine, with their sums of angles.

(G. H. Gonnet, "Determining equivalence of expressions in random polynomial time", STOC 1984.)
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Mapping
from functools import cache, lru_cache
from typing import Any

import mpmath
import sympy as sp
from sympy.core.relational import Relational

from percept_obs.compile import Intermediate

PRIME = 315613022149747294991914860978434342099
ANGLE = 1312494765889401371
GROWTH = 1849897281939139319

DIGITS = 60
ACCENTS = r"(?<=[A-Za-z0-9])(?:hat|bar|tilde|dot)"


class NoValue(ArithmeticError):
    """The expression has no value at the point: a denominator vanishes, or a root does not exist."""


@lru_cache(maxsize=4096)
def key(name: str) -> str:
    """One spelling of a letter's name: v_c1 and v_{c1} are the same letter, and so are yhat1, y1hat and y_1hat."""
    plain = re.sub(r"[_{}\s\\]", "", name)
    marks = re.findall(ACCENTS, plain)
    return re.sub(ACCENTS, "", plain) + "".join(sorted(marks, key=ACCENTS.index))


@lru_cache(maxsize=1 << 14)
def _drawn(seed: int, name: str) -> int:
    """A number of sixty bits that follows from a seed and a name."""
    return random.Random(f"{seed} {name}").getrandbits(60) + 1


class ModularPoint:
    """A point at which expressions have values modulo a prime; letters get numbers by their names.

    Parameters
    ----------
    seed : int
        The same seed is the same point.
    prime : int
    outer : ModularPoint, optional
        Where functions inside an exponent or an angle get their values.
    """

    def __init__(self, seed: int, prime: int = PRIME, outer: ModularPoint | None = None) -> None:
        self.seed, self.prime, self.outer = seed, prime, outer
        self._known: dict[sp.Basic, int] = {}
        self._inside: dict[int, ModularPoint] = {}

    def __call__(self, expression: sp.Basic) -> int:
        """The value; raises `NoValue` where there is none."""
        known = self._known.get(expression)
        if known is None:
            known = self._known[expression] = self._value(expression) % self.prime
        return known

    def _value(self, e: sp.Basic) -> int:
        if e.is_Symbol:
            return _drawn(self.seed, key(e.name))
        if e.is_Integer:
            return int(e)
        if e.is_Rational:
            return int(e.p) * self._inverse(int(e.q))
        if e.is_Float:
            return self(sp.Rational(str(e)))
        if e.is_Add:
            return sum(map(self, e.args))
        if e.is_Mul:
            product = 1
            for factor in e.args:
                product = product * self(factor) % self.prime
            return product
        if e.is_Pow and e.exp.is_Rational:
            return self._power(self(e.base), e.exp)
        if e in (sp.zoo, sp.nan, sp.oo, -sp.oo):
            raise NoValue
        if isinstance(e, Intermediate):
            return self(e.written_out)
        if self.outer is not None:
            return _drawn(self.seed, f"inside {self.outer(e)}")
        known = _MODULAR.get(e.func)
        return known(self, e.args[0]) if known else self._unknown(e)

    def _inverse(self, value: int) -> int:
        if value % self.prime == 0:
            raise NoValue
        return pow(value, -1, self.prime)

    def _power(self, base: int, exponent: sp.Rational) -> int:
        p, q = int(exponent.p), int(exponent.q)
        while q % 2 == 0:
            base, q = self._root(base), q // 2
        if q > 1:
            try:
                base = pow(base, pow(q, -1, self.prime - 1), self.prime)
            except ValueError:  # there is no such root modulo this prime
                raise NoValue from None
        return pow(base, p, self.prime) if p >= 0 else pow(self._inverse(base), -p, self.prime)

    def _root(self, value: int) -> int:
        """The root that is a square itself."""
        root = pow(value, (self.prime + 1) // 4, self.prime)
        if (root * root - value) % self.prime:
            raise NoValue
        return root

    def sign(self, argument: sp.Expr) -> int:
        """1 for squares, -1 for other numbers, 0 for 0."""
        symbol = pow(self(argument), (self.prime - 1) // 2, self.prime)
        return -1 if symbol == self.prime - 1 else symbol

    def exponential(self, argument: sp.Expr) -> int:
        """g^argument."""
        return pow(_growth(), self._in(GROWTH)(argument), self.prime)

    def turned(self, argument: sp.Expr) -> tuple[int, int]:
        """Cosine and sine."""
        return _power_of(_angle(), self._in(ANGLE)(argument))

    def ratio(self, above: int, below: int) -> int:
        """A quotient."""
        return above * self._inverse(below)

    def _in(self, prime: int) -> ModularPoint:
        return self._inside.setdefault(prime, ModularPoint(self.seed, prime, self))

    def _unknown(self, e: sp.Basic) -> int:
        """A function without rules: equal arguments, equal values."""
        name = e.name if isinstance(e, sp.MatrixSymbol) else e.func.__name__
        return _drawn(self.seed, f"{name} {[self(part) for part in e.args]}")


def _hyperbolic(combine: Callable[[ModularPoint, int, int], int]) -> Callable[[ModularPoint, sp.Expr], int]:
    return lambda point, x: combine(point, point.exponential(x), point.exponential(-x))


_MODULAR: dict[Any, Callable[[ModularPoint, sp.Expr], int]] = {
    sp.exp: lambda point, x: point.exponential(x),
    sp.cos: lambda point, x: point.turned(x)[0],
    sp.sin: lambda point, x: point.turned(x)[1],
    sp.tan: lambda point, x: point.ratio(*reversed(point.turned(x))),
    sp.cosh: _hyperbolic(lambda point, up, down: point.ratio(up + down, 2)),
    sp.sech: _hyperbolic(lambda point, up, down: point.ratio(2, up + down)),
    sp.sinh: _hyperbolic(lambda point, up, down: point.ratio(up - down, 2)),
    sp.tanh: _hyperbolic(lambda point, up, down: point.ratio(up - down, up + down)),
    sp.sign: lambda point, x: point.sign(x),
    sp.Abs: lambda point, x: point.sign(x) * point(x),
}


def _times(a: tuple[int, int], b: tuple[int, int]) -> tuple[int, int]:
    """Product of complex numbers modulo the prime."""
    return (a[0] * b[0] - a[1] * b[1]) % PRIME, (a[0] * b[1] + a[1] * b[0]) % PRIME


def _power_of(number: tuple[int, int], exponent: int) -> tuple[int, int]:
    result = (1, 0)
    for bit in bin(exponent)[2:]:
        result = _times(result, result)
        if bit == "1":
            result = _times(result, number)
    return result


@cache
def _growth() -> int:
    return pow(3, (PRIME - 1) // GROWTH, PRIME)


@cache
def _angle() -> tuple[int, int]:
    """A number on the unit circle, of order ANGLE: the conjugate of 2 + i over it has length one."""
    inverse = pow(5, -1, PRIME)
    return _power_of((3 * inverse % PRIME, -4 * inverse % PRIME), (PRIME + 1) // ANGLE)


class RealPoint:
    """A point at which expressions have real or complex values of sixty digits.

    Parameters
    ----------
    seed : int
        The same seed is the same point.
    letters : mapping of expressions to names, optional
        What has no value of its own, such as an integral, and is treated as a letter.
    """

    def __init__(self, seed: int, letters: Mapping[sp.Basic, str] | None = None) -> None:
        self.seed, self.mp, self.letters = seed, _sixty_digits(), letters or {}
        self._known: dict[sp.Basic, Any] = {}

    def __call__(self, expression: sp.Basic) -> Any:
        """The value; raises `NoValue` where there is none."""
        if expression not in self._known:
            try:
                self._known[expression] = self._value(expression)
            except (ZeroDivisionError, OverflowError, ValueError):  # mpmath's words for a pole
                raise NoValue from None
        return self._known[expression]

    def _value(self, e: sp.Basic) -> Any:
        if e.is_Symbol or e in self.letters:
            name = self.letters.get(e) or key(e.name)
            size = self.mp.mpf(_drawn(self.seed, name)) / 2**60
            return (size + 0.2) * (-1) ** _drawn(self.seed, f"sign of {name}")
        if e.is_Rational:
            return self.mp.mpf(int(e.p)) / int(e.q)
        if e.is_Float:
            return self(sp.Rational(str(e)))
        if e is sp.I:
            return self.mp.j
        if isinstance(e, sp.NumberSymbol):
            return self.mp.mpf(str(e.n(DIGITS + 5)))
        if e.is_Add:
            return self.mp.fsum(map(self, e.args))
        if e.is_Mul:
            return self.mp.fprod(map(self, e.args))
        if e.is_Pow:
            return self.mp.power(self(e.base), self(e.exp))
        if isinstance(e, sp.Piecewise):
            for branch, condition in e.args:
                if self._holds(condition):
                    return self(branch)
        if e.func in (sp.Max, sp.Min):
            return (max if e.func is sp.Max else min)(map(self._real, e.args))
        if isinstance(e, Intermediate):
            return self(e.written_out)
        if e.func in _REAL:
            return getattr(self.mp, _REAL[e.func])(*map(self, e.args))
        if isinstance(e, sp.Integral) and [len(limit) for limit in e.limits] == [3]:
            return self._integrated(e)
        raise NoValue

    def _integrated(self, e: sp.Integral) -> Any:
        """A definite integral over one variable, by quadrature; no value where that does not settle."""
        variable, low, high = e.limits[0]

        def integrand(value: Any) -> Any:
            inside = RealPoint(self.seed, self.letters)
            inside._known[variable] = value
            return inside(e.function)

        value, error = self.mp.quad(integrand, [self(low), self(high)], error=True)
        if not error < 1e-45:
            raise NoValue
        return value

    def _real(self, e: sp.Basic) -> Any:
        value = self(e)
        if isinstance(value, self.mp.mpc):
            raise NoValue
        return value

    def _holds(self, condition: sp.Basic) -> bool:
        if condition in (sp.true, sp.false):
            return condition == sp.true
        if isinstance(condition, sp.And | sp.Or):
            return (all if isinstance(condition, sp.And) else any)(map(self._holds, condition.args))
        if isinstance(condition, sp.Not):
            return not self._holds(condition.args[0])
        if not isinstance(condition, Relational):
            raise NoValue
        left, right = map(self._real, condition.args)
        return bool(condition.func(*(sp.Integer(x) for x in ((left > right) - (left < right), 0))))


_REAL = {
    f: f.__name__.lower()
    for f in (
        sp.exp,
        sp.log,
        sp.sin,
        sp.cos,
        sp.tan,
        sp.sinh,
        sp.cosh,
        sp.tanh,
        sp.sech,
        sp.asin,
        sp.acos,
        sp.atan,
        sp.atan2,
    )
} | {sp.Abs: "fabs", sp.sign: "sign"}


@cache
def _sixty_digits() -> Any:
    context = mpmath.mp.clone()
    context.dps = DIGITS
    return context
