"""Functions without a branch or a table, so that a processor's vector instructions take many arguments together.

This text stands before each loop over runs side by side, where numba compiles it; so it needs nothing but numpy.
Errors are about 4e-16 of the value.
"""

import math

import numpy as np


def where(condition: bool, this: float, that: float) -> float:
    """One of two values."""
    return this if condition else that


def some(condition: bool) -> bool:
    """Whether it holds in one of the lanes."""
    return condition


def parts(x: float) -> tuple[float, float]:
    """2^k and e^r - 1 with e^x = 2^k e^r, for x = k log(2) + r from -708 to 709."""
    big = 6755399441055744.0  # 1.5 * 2^52, above which there are no fractions: k stands in the last bits of the sum
    shifted = np.float64(x * 1.4426950408889634 + big)
    k = shifted - big
    r = (x - k * 0.6931471803691238) - k * 1.9082149292705877e-10
    square = r * r  # its terms by pairs, so that few have to wait for others
    low = (1 / 2 + 1 / 6 * r) + square * (1 / 24 + 1 / 120 * r)
    middle = (1 / 720 + 1 / 5040 * r) + square * (1 / 40320 + 1 / 362880 * r)
    high = (1 / 3628800 + 1 / 39916800 * r) + square * (1 / 479001600 + 1 / 6227020800 * r)
    fourth = square * square
    tail = low + fourth * (middle + fourth * high)
    power = np.int64((shifted.view(np.int64) + 1023) << 52).view(np.float64)
    return power, tail * square + r


def exp(x: float) -> float:
    """e^x, 0 below 3e-308 and infinite above 8e307."""
    power, part = parts(where(x < -708.0, -708.0, where(x > 709.0, 709.0, x)))
    return where(x > 709.0, math.inf, where(x < -708.0, 0.0, power * part + power))


def tanh(x: float) -> float:
    """The hyperbolic tangent, by e^(-2 |x|) - 1."""
    size = abs(x)
    power, part = parts(-2.0 * where(size > 22.0, 22.0, size))
    shrunk = power * part + (power - 1.0)
    return math.copysign(shrunk / (shrunk + 2.0), x)
