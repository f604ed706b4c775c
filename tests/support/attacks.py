"""Formulas that are nearly the same, and hostile texts: families of each, from which tests draw."""

import random
from fractions import Fraction

import sympy as sp

x, y, z = sp.symbols("y1 y2 y3", real=True)


def attacks():
    """Yield a family's name and two formulas that are not the same for all real letters, though they look it."""
    yield from (("fixed points", *pair) for pair in _fixed_points())
    yield from (("primes", *pair) for pair in _primes())
    yield from (("branches", *pair) for pair in _branches())
    yield from (("scales", *pair) for pair in _scales())
    yield from (("borders", *pair) for pair in _borders())


def _fixed_points():
    """Add what vanishes at points that follow from numbers and names, at small numbers and at usual fractions."""
    for letter in (x, y, z):
        for count in (3, 12, 20):
            drawn = [random.Random(f"{seed} {letter.name}") for seed in range(count)]
            drawn = [(draw.getrandbits(60), draw.choice((-1, 1))) for draw in drawn]
            values = [sign * (sp.Rational(bits, 2**60) + sp.Rational(1, 5)) for bits, sign in drawn]
            vanishing = sp.Mul(*(letter - value for value in values))
            yield x + vanishing, x
            yield sp.sin(x) + vanishing * sp.sqrt(1 + y**2), sp.sin(x)
            yield sp.Abs(x) + vanishing, sp.Abs(x)
        whole = sp.Mul(*(letter - k for k in range(-12, 13)))
        yield y + whole, y
        yield sp.tanh(y) + whole, sp.tanh(y)
        yield y + sp.Mul(*(letter - sp.Rational(Fraction(sp.prime(k + 3), 3 + k)) for k in range(12))), y


def _primes():
    """Add a multiple of a prime, and what vanishes modulo one."""
    known = (2**31 - 1, 2**61 - 1, 2**89 - 1, 2**127 - 1, 10**9 + 7, 10**9 + 9, 998244353, 2**64 - 59, 2**521 - 1)
    for prime in known:
        yield x + prime * y, x
        yield x * y + prime * sp.exp(z), x * y
        yield sp.sqrt(1 + x**2) + prime * y**2, sp.sqrt(1 + x**2)
    for prime in (2, 3, 5, 7, 11, 13):
        yield x**prime - x + y, y
    yield x + sp.prod(known) * y, x


def _branches():
    """Inverse functions and roots, on the wrong branch somewhere."""
    for u in (x, 2 * x, x + 1, x * y, x / 3):
        yield sp.asin(sp.sin(u)), u
        yield sp.acos(sp.cos(u)), u
        yield sp.atan(sp.tan(u)), u
        yield sp.sqrt(1 - sp.sin(u) ** 2), sp.cos(u)
        yield sp.sqrt(1 - sp.cos(u) ** 2), sp.sin(u)
        yield sp.sqrt(sp.cosh(u) ** 2 - 1), sp.sinh(u)
    for c in (-1, 0, 2, 100, sp.Rational(1, 7)):
        yield sp.sqrt(sp.expand((x - c) ** 2)), c - x
        yield sp.sqrt(sp.expand((x - c) ** 2)), x - c
        yield sp.sqrt(sp.expand((x * y - c) ** 2)), x * y - c
        yield sp.sqrt(sp.expand((x - c) ** 2 * (1 + y**2))), (x - c) * sp.sqrt(1 + y**2)
    yield sp.atan2(y, x), sp.atan(y / x)
    yield sp.sqrt(x**2 + 2 * x * y + y**2), sp.Abs(x) + sp.Abs(y)
    yield sp.Abs(x + y), sp.Abs(x) + sp.Abs(y)
    yield sp.Max(x, y) * sp.Max(x, z), sp.Max(x**2, x * y, x * z, y * z)


def _scales():
    """Differ only where letters are very small or very large, or by very little."""
    for k in (3, 30, 300, 3000):
        yield sp.tanh(k * x), sp.tanh(sp.Rational(5, 3) * k * x)
        yield x + sp.exp(-k), x
        yield sp.atan(x) + sp.exp(-k), sp.atan(x)
        yield sp.sqrt(1 + x**2) + sp.exp(-k), sp.sqrt(1 + x**2)
        yield sp.tanh(k * x), sp.sign(x)
        yield 1 / (1 + sp.exp(-k * x)), sp.Heaviside(x)
        yield sp.log(1 + sp.exp(k * x)) / k, sp.Max(x, 0)
    for k in (6, 12, 30, 60):
        small = sp.Rational(1, 10**k)
        yield x * (1 + small), x
        yield sp.sin(x) + small, sp.sin(x)
        yield sp.sqrt(x**2 + small), sp.Abs(x)
        yield sp.Abs(x) + small * sp.Abs(y), sp.Abs(x)
    for k in (2, 5, 9):
        yield sp.sign(x - 10**k), -sp.S.One
        yield sp.Max(x, -(10**k)), x
        yield sp.Max(x, y + 10**k), y + 10**k
        yield sp.Piecewise((x, x < 10**k), (0, True)), x
        yield sp.Piecewise((0, sp.Abs(x) < sp.Rational(1, 10**k)), (x, True)), x


def _borders():
    """Differ only where two sides are equal: strictness, and values where a function jumps."""
    for c in (0, 1, sp.Rational(-3, 2), y, y**2):
        for less, at_most in ((sp.StrictLessThan, sp.LessThan), (sp.StrictGreaterThan, sp.GreaterThan)):
            one, other = less(x, c, evaluate=False), at_most(x, c, evaluate=False)
            yield one, other
            yield other, one
            yield less(c, x, evaluate=False), one
            yield sp.Piecewise((1, one), (0, True)), sp.Piecewise((1, other), (0, True))
        if c in (0, 1, y):
            yield sp.sign(x - c) ** 2, sp.S.One
            yield sp.Heaviside(x - c), sp.Piecewise((1, x > c), (0, True))
            yield sp.sign(x - c), sp.Piecewise((1, x >= c), (-1, True))
            yield 2 * sp.Heaviside(x - c) - 1, sp.Piecewise((1, x >= c), (-1, True))


def hostile():
    """Yield texts that are meant to take long, each with definitions, as a line for y1'."""
    for k, (name, text) in enumerate((n, t) for n, family in HOSTILE.items() for t in family()):
        draw = random.Random(k)
        more = "".join(f"\nr{j} = {draw.randint(2, 9)} a1{j} y{j}" for j in (1, 2, 3))
        yield name, f"{text.strip()}{more if 'y1dot = ' not in text else ''}"


def _chain(step, count, last="y1' = q{n}"):
    lines = ["q0 = y1 + b1", *(f"q{k} = {step.replace('p', f'q{k - 1}')}" for k in range(1, count + 1))]
    return "\n".join([*lines, last.format(n=count)])


def _chains():
    steps = ("p + 1/(p + b1)", "p p", "p p + b2", "p^2 - p", "p/(1 + p^2)", "sqrt(p^2 + p + 1)", "p + exp(p)")
    yield from (_chain(step, count) for step in steps for count in (3, 5, 7, 12, 19, 40))


def _towers():
    for function in ("exp", "sin", "cosh", "tanh", "log", "sqrt", "abs", "atan"):
        yield from (f"q = {function}({inner})\ny1' = " + f"{function}(" * n + "q" + ")" * n
                    for n, inner in ((2, "y1"), (5, "y1 + 9"), (30, "b1 y1"), (6, "9")))  # fmt: skip


def _matrices():
    square = "[[y1, y2], [y2, b1]]"
    for n in (2, 6, 8, 20, 60):
        yield f"q = {square}\ny1' = [1, 0]^T " + "q " * n + "[1, 0]"
        yield f"q = {square} {square}\ny1' = [1, 0]^T " + f"{square} " * n + "q [1, 0]"
    for n in (3, 6, 9):
        rows = ", ".join(f"[{', '.join(f'y1^{i} + a12 b{1 + j % 3}' for j in range(n))}]" for i in range(n))
        yield f"q = [{rows}]\ny1' = [{', '.join('1' * n)}]^T q q q [{', '.join('1' * n)}]"


def _wide():
    terms = {
        "sin({k} q)": 250, "1/(q + {k} b1)": 400, "sqrt(q^2 + {k})": 250, "abs(q - {k} b1)": 250, "exp({k} q)": 250,
        "q^{m}/(1 + {k} y2^{m})": 150, "tanh({k} q) y2": 200, "sign(q - {k})": 250, "a11 q y2": 700, "asin(q/{k})": 200,
        "log(q^2 + {k})": 200, "(q + {k})^{m}": 300,
    }  # fmt: skip
    for term, most in terms.items():
        for count in (20, most // 2, most):
            written = (term.format(k=k, m=k % 20) for k in range(1, count + 1))
            yield f"q = y1 + a12\ny1' = {' + '.join(written)}"
    for count in (5, 20, 60):
        yield f"q = y1 + a12\ny1' = {' '.join(f'(q + {k} y2 + b1)' for k in range(count))}"
        yield f"q = y1 + a12\ny1' = {' '.join(f'sqrt(q^2 + {k} y2^2)' for k in range(count))}"


def _long():
    for mark in ("\u0307", "\u0302", "_1", "'", "̄̇"):
        yield from (f"q = y1{mark * n}\ny1' = q" for n in (3, 60, 4000))
    for letter in ("y1", "abcdefghij", "a", "y1y2", "dy", "\\hat"):
        yield from (f"q = {letter * n}\ny1' = q" for n in (4, 19, 8000 // len(letter)))
    for digits in (9, 15, 400):
        yield f"q = {'9' * digits}\ny1' = q^20 y1"
        yield f"q = {'9' * digits}\nqq = q q q q\ny1' = sqrt(qq qq qq) y1"
        yield f"q = exp({'9' * digits})\ny1' = exp(q) + abs(exp(q) - q)"
        yield f"q = 1/{'9' * digits}\ny1' = {' + '.join(['q y1^2'] * 200)}"


def _brackets():
    for n in (5, 39, 41, 2000):
        yield f"q = y1\ny1' = {'(' * n}q{')' * n}"
        yield f"q = y1\ny1' = {'(' * n}q"
        yield f"q = y1\ny1' = {'[' * n}q{']' * n}"
        yield f"q = y1\ny1' = {'1/(1 + ' * n}q{')' * n}"
        yield f"q = y1\ny1' = {'|' * n} q {'|' * n}"
        yield f"q = y1\ny1' = {'-' * n}q"
        yield f"q = y1\ny1' = {'q/' * n}b1"
    for n in (3, 30, 300):
        branches = r" \\ ".join(rf"{k} q & \text{{for}} q > {k}" for k in range(n))
        yield rf"q = y1; y1' = \begin{{cases}} {branches} \\ 0 & \text{{otherwise}} \end{{cases}}"
        yield "q = y1\n" + "y1' = q\n" * n
        yield "\n".join(f"q{k} = q{k + 1}" for k in range(n)) + f"\nq{n} = q0\ny1' = q1"


HOSTILE = {
    "chains": _chains,
    "towers": _towers,
    "matrices": _matrices,
    "wide": _wide,
    "long": _long,
    "brackets": _brackets,
}
