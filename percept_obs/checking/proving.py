"""Prove formulas identical, by exact values of both at a secret point modulo a secret prime."""

from __future__ import annotations

import secrets
from contextlib import suppress
from functools import cache, lru_cache
from typing import Any

import sympy as sp
from sympy.core.relational import Relational
from sympy.ntheory import isprime, sqrt_mod
from sympy.polys.matrices import DomainMatrix

from percept_obs.checking.limits import extent, heed
from percept_obs.checking.points import key
from percept_obs.compile import Intermediate

PARTS, TRIALS, BRANCHES = 5040, 60, 6
"""Fractions of angles have denominators that divide PARTS; points that are tried; most roots and kinks on a branch."""
OPAQUE = "opaque"
"""Begins the key of a value that was drawn for a function without known relations."""
CONDITIONS = (sp.And, sp.Or, sp.Not)


class Unproved(Exception):
    """A formula that has no exact value."""


class _Again(Exception):
    """A point at which a denominator vanishes, or a root does not exist."""


@cache
def _prime() -> int:
    """Return a secret prime of 127 bits, modulo which there are roots of unity."""
    while True:
        # 2 PARTS divides p - 1, so that the field has a root of unity of that order
        p = 2 * PARTS * (2**112 + secrets.randbits(112)) + 1
        if isprime(p):
            return p


@cache
def _root_of_unity() -> int:
    """Return a primitive root of unity, e^(i pi / PARTS)."""
    p = _prime()
    while True:
        root = pow(secrets.randbelow(p - 2) + 2, (p - 1) // (2 * PARTS), p)
        # 2, 3, 5 and 7 are the prime factors of 2 PARTS: a root of that order is none of a lower one
        if all(pow(root, 2 * PARTS // q, p) != 1 for q in (2, 3, 5, 7)):
            return root


def identical(one: sp.Basic, other: sp.Basic) -> bool | None:
    """Return True if two formulas are identical, False if they differ on all branches, None if it is not proved.

    Letters and whatever is transcendental get secret values in a field of numbers modulo a secret prime of 127 bits;
    exponentials, circular and hyperbolic functions by the multiple that one argument is of another, roots and signs
    with both signs.  An identity of rational functions is one of these values.  Values of formulas that differ agree
    by chance once in 10^25 times, whatever the formulas are, since neither point nor prime is known to anybody.
    """
    for _ in range(TRIALS):
        with suppress(_Again):
            return _on_all_branches(one, other)
    return None


def _on_all_branches(one: sp.Basic, other: sp.Basic) -> bool | None:
    """Compare two formulas at one point, with each choice of signs of their roots and kinks; see `identical`."""
    found: list[bool] = []
    drawn: dict[Any, int] = {}
    branches, complete = 0, True
    while len(found) < 2**branches:
        at = _SecretPoint(len(found), drawn)
        try:
            apart = at.difference(one, other)
            if apart and not at.complete:  # are functions without known relations the same on both sides?
                kept = {name: v for name, v in drawn.items() if not (isinstance(name, tuple) and name[0] == OPAQUE)}
                again = _SecretPoint(len(found), kept)
                complete = complete and again.difference(one, other) == apart
        except Unproved:
            return None
        found.append(apart == 0)
        # how many signs there are is known only once the formulas are evaluated
        branches = max(branches, at.count)
        # signs may depend on each other, so that some branches do not exist: equal on some only proves nothing
        if branches > BRANCHES or len(set(found)) > 1:
            return None
    return True if found[0] else False if complete else None


def ratio(one: sp.Basic, other: sp.Basic) -> sp.Rational | None:
    """Return the short fraction that one formula is of another at a secret point; None if there is none."""
    at = _SecretPoint(0, {})
    with suppress(_Again, Unproved):
        return at.fraction(at.value(one) * at.inverse(at.value(other)))
    return None


def dimension(*rows: sp.Basic) -> int:
    """Return how many of these polynomials are linearly independent."""
    # dependent at one more random point than there are rows: dependent everywhere
    field, points = sp.GF(_prime()), [_SecretPoint(0, {}) for _ in range(len(rows) + 1)]
    values = [[field(at.value(row)) for row in rows] for at in points]
    return int(DomainMatrix(values, (len(values), len(rows)), field).rank())


class _SecretPoint:
    """Exact values at a secret point; the bits of `branch` are the signs of the roots and kinks, as they are met.

    Attributes
    ----------
    complete : bool
        False once a function was met whose relations to others are not known.
    """

    def __init__(self, branch: int, drawn: dict[Any, int]) -> None:
        self.p, self.branch, self.drawn = _prime(), branch, drawn
        self.count, self.complete = 0, True
        self.known: dict[sp.Basic, int] = {}
        self.exponents: dict[bool, list[tuple[int, int]]] = {False: [], True: []}
        self.kinks: list[tuple[int, int]] = []
        self.roots: list[tuple[int, int]] = []

    def value(self, e: sp.Basic) -> int:
        """Return the value of an expression."""
        if e not in self.known:
            heed()
            self.known[e] = self._value(e) % self.p
        return self.known[e]

    def difference(self, one: sp.Basic, other: sp.Basic) -> int:
        """Return the difference of two values."""
        return (self.value(one) - self.value(other)) % self.p

    def inverse(self, number: int) -> int:
        if number % self.p == 0:
            raise _Again
        return pow(number, -1, self.p)

    def draw(self, name: Any) -> int:
        """Return a random number for a letter, the same one each time."""
        return self.drawn.setdefault(name, secrets.randbelow(self.p - 1) + 1)

    def fraction(self, number: int) -> sp.Rational | None:
        """Return the fraction of at most nine digits that a number is."""
        # Euclid's algorithm stopped half way: rational reconstruction of s / u = number modulo p
        (r, s), (t, u) = (self.p, number % self.p), (0, 1)
        while s > 10**9:
            r, s, t, u = s, r % s, u, t - r // s * u
        return sp.Rational(s, u) if 0 < abs(u) <= 10**9 else None

    def _value(self, e: sp.Basic) -> int:
        if e.is_Symbol:
            return self.draw(key(e.name))
        if e.is_Rational:
            return int(e.p) * self.inverse(int(e.q))
        if e.is_Add:
            return sum(map(self.value, e.args))
        if e.is_Mul:
            product = 1
            for factor in e.args:
                product = product * self.value(factor) % self.p
            return product
        if e.is_Pow and e.exp.is_Rational:
            # only square roots are told apart by a sign; of others there may be no root or several
            if e.exp.q > 2:
                raise Unproved
            base = self.value(e.base) if e.exp.q == 1 else self.root(e.base)
            return pow(base if e.exp > 0 else self.inverse(base), abs(int(e.exp.p)), self.p)
        if e.is_Float:
            return self.value(sp.Rational(str(e)))
        if e is sp.I:
            return pow(_root_of_unity(), PARTS // 2, self.p)
        if e is sp.pi:
            return self.draw("pi")
        if e is sp.E or isinstance(e, sp.exp):
            return self.exponential(e.args[0] if e.args else sp.S.One, False)
        if isinstance(e, Intermediate):
            return self.value(e.written_out)
        if type(e) in _CIRCULAR:
            return self.quotient(e, True)
        if type(e) in _HYPERBOLIC:
            return self.quotient(e, False)
        return self.value_by_signs(e)

    def quotient(self, e: sp.Basic, circular: bool) -> int:
        """Return sin, cosh and so on, by exponentials."""
        z, i = self.exponential(e.args[0], circular), self.value(sp.I) if circular else 1
        back = self.inverse(z)
        sine, cosine = (z - back) * self.inverse(2 * i), (z + back) * self.inverse(2)
        above, below = (_CIRCULAR if circular else _HYPERBOLIC)[type(e)]
        return (1, sine, cosine)[above] * self.inverse((1, sine, cosine)[below])

    def exponential(self, e: sp.Expr, circular: bool) -> int:
        """Return exp(e), or exp(i e): a power of an earlier one, a product over terms, or a new value."""
        number, bases = self.value(e), self.exponents[circular]
        if number == 0:
            return 1
        if circular and (part := self.fraction(number * self.inverse(self.draw("pi")))) and PARTS % part.q == 0:
            return pow(_root_of_unity(), int(part * PARTS), self.p)
        for base, root in bases:
            part = self.fraction(number * self.inverse(base))
            if part is not None and PARTS % part.q == 0:
                return pow(root, int(part * PARTS), self.p)
        terms = sp.Add.make_args(sp.expand(e) if extent(e).parts < 100 else e)
        if len(terms) > 1:
            product = 1
            for term in terms:
                product = product * self.exponential(term, circular) % self.p
            return product
        # exp(log(x)) = x is an identity that values drawn at random do not keep
        if e.has(sp.log, sp.I, *_INVERSE):
            self.complete = False
        # the PARTS-th root is drawn, so that exp(e q) is known for every fraction q = n / PARTS
        root = self.draw((circular, number))
        bases.append((number, root))
        return pow(root, PARTS, self.p)

    def sign(self, e: sp.Basic) -> int:
        """Return the sign that an expression has on this branch."""
        if known := _known_sign(e):
            return known
        product = 1
        for factor, power in powers(e):
            # an even power is never negative
            if power % 2:
                product *= _known_sign(factor) or self.kink(self.value(factor))
        return product

    def kink(self, number: int) -> int:
        """Return the sign of a number on this branch; it is chosen once for all multiples of a number."""
        for other, sign in [(1, 1), *self.kinks]:
            part = self.fraction(number * self.inverse(other))
            if part:
                return sign if part > 0 else -sign
        if number == 0:
            raise Unproved
        self.kinks.append((number, self.next_sign()))
        return self.kinks[-1][1]

    def next_sign(self) -> int:
        """Return the sign that this branch gives to the next root or kink, 1 or -1."""
        self.count += 1
        return -1 if self.branch >> (self.count - 1) & 1 else 1

    def root(self, e: sp.Expr) -> int:
        """Return a square root: |f| of a factor f^2, a root of each positive factor, and one of all that is left."""
        product, rest = 1, 1
        for factor, power in powers(e):
            number, half = self.value(factor), int(power) // 2
            # sqrt(f^2) is |f|, not f
            size = self.sign(factor) * number if half else 1
            product = product * pow(size if half >= 0 else self.inverse(size), abs(half), self.p) % self.p
            if power % 2 and _known_sign(factor) == 1:
                product = product * self.plain_root(number) % self.p
            elif power % 2:
                rest = rest * number % self.p
        return product * self.plain_root(rest)

    def plain_root(self, number: int) -> int:
        if number == 1:
            return 1
        if number in (2, 3):  # twice the cosine of pi/4 and of pi/6
            turn = pow(_root_of_unity(), PARTS // (2 * number), self.p)
            return turn + self.inverse(turn)
        for other, root in self.roots:
            part = self.fraction(number * self.inverse(other))
            if part and part > 0 and (whole := sp.sqrt(part)).is_Rational:
                return root * self.value(whole)
        found = sqrt_mod(number, self.p) if number else 0
        if found is None:
            raise _Again
        self.roots.append((number, self.next_sign() * found))
        return self.roots[-1][1]

    def value_by_signs(self, e: sp.Basic) -> int:
        """Return the value of |x|, a sign, a maximum or cases on this branch; of other functions a random one."""
        half = self.inverse(2)
        if isinstance(e, sp.Abs):
            return self.sign(e.args[0]) * self.value(e.args[0])
        if isinstance(e, sp.sign):
            return self.sign(e.args[0])
        if isinstance(e, sp.Heaviside):
            return (1 + self.sign(e.args[0])) * half
        if isinstance(e, sp.Max | sp.Min):
            extreme, *others = sorted(e.args, key=sp.default_sort_key)
            for other in others:
                larger = self.sign(extreme - other) == (1 if isinstance(e, sp.Max) else -1)
                extreme = extreme if larger else other
            return self.value(extreme)
        if isinstance(e, sp.Piecewise):
            for branch, condition in e.args:
                if self.holds(condition):
                    return self.value(branch)
            raise _Again
        if not e.args or not isinstance(e, sp.Expr):
            raise Unproved
        self.complete = False
        # any other function has the same value wherever its arguments have, and no other relation is known
        return self.draw((OPAQUE, e.func.__name__, *map(self.argument_key, e.args)))

    def argument_key(self, e: sp.Basic) -> Any:
        """Return a key that is equal for equal arguments of a function."""
        if isinstance(e, sp.Tuple | Relational):
            return (type(e).__name__, *map(self.argument_key, e.args))
        return self.value(e) if isinstance(e, sp.Expr) else str(e)

    def holds(self, condition: sp.Basic) -> bool:
        """Return True if a condition holds on this branch, away from its border."""
        if isinstance(condition, CONDITIONS):
            inner = list(map(self.holds, condition.args))
            return not inner[0] if isinstance(condition, sp.Not) else (any, all)[condition.func is sp.And](inner)
        if isinstance(condition, sp.Eq | sp.Ne):
            return isinstance(condition, sp.Ne)
        if isinstance(condition, Relational):
            return self.sign(condition.gts - condition.lts) > 0
        return bool(condition == sp.true)


def _known_sign(e: sp.Basic) -> int:
    """Return the sign, 1 or -1, that an expression has wherever it is not zero; 0 if it may have both."""
    if e.is_Rational:
        return 1 if e > 0 else -1
    if e.is_Symbol or e is sp.pi or e is sp.E:
        return 1 if e.is_nonnegative else -1 if e.is_nonpositive else 0
    if e.is_Pow and e.exp.is_Rational:
        even = e.exp.q == 2 or e.exp.p % 2 == 0
        return 1 if even else _known_sign(e.base)
    if e.is_Mul:
        product = 1
        for factor in e.args:
            product *= _known_sign(factor)
        return product
    if e.is_Add:
        signs = set(map(_known_sign, e.args))
        return signs.pop() if len(signs) == 1 else 0
    return int(isinstance(e, sp.exp | sp.cosh | sp.sech | sp.Abs))


@lru_cache(maxsize=1024)
def powers(e: sp.Expr) -> tuple[tuple[sp.Expr, int], ...]:
    """Return the factors of an expression with their exponents."""
    if e.is_Mul:
        return tuple(each for part in e.args for each in powers(part))
    if e.is_Pow and e.exp.is_Integer:
        return tuple((factor, power * int(e.exp)) for factor, power in powers(e.base))
    if e.is_Add and extent(e).parts < 100 and e.is_polynomial():
        content, factors = sp.factor_list(e)
        return (*powers(content), *factors)
    if e.is_Rational and max(abs(e.p), e.q) < 10**12:
        return tuple((sp.Integer(prime), power) for prime, power in sp.factorrat(e).items())
    return ((e, 1),)


_CIRCULAR = {sp.sin: (1, 0), sp.cos: (2, 0), sp.tan: (1, 2), sp.cot: (2, 1), sp.sec: (0, 2), sp.csc: (0, 1)}
_HYPERBOLIC = {sp.sinh: (1, 0), sp.cosh: (2, 0), sp.tanh: (1, 2), sp.coth: (2, 1), sp.sech: (0, 2), sp.csch: (0, 1)}
"""Numerator and denominator of each function: 1, sine, cosine."""
_INVERSE = (sp.asin, sp.acos, sp.atan, sp.atan2)
