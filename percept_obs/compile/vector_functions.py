"""Functions without a branch or a table, so that a processor's vector instructions take many arguments together.

This text stands before each loop for a batch, where numba compiles it; so it needs nothing but numpy.
Errors are below 5e-16 of the value.
"""

import math

import numpy as np


def where(condition: bool, this: float, that: float) -> float:
    """Return the first value where the condition is true, else the second; both have been computed."""
    return this if condition else that


def some(condition: bool) -> bool:
    """Return True if a condition holds in one of the runs."""
    return condition


def parts(z: float) -> tuple[float, float, float]:
    """Return 2^k, P and Q with e^(2z) = 2^k (Q + P) / (Q - P), for z = k log(2) / 2 + r from -354 to 354.

    P / Q is tanh(r) by Lambert's continued fraction, r / (1 + r^2 / (3 + r^2 / (5 + ... r^2 / 13))).
    """
    big = 1.5 * 2.0**52 + 1023.0  # there are no fractions above: k + 1023, the exponent of 2^k, stands in the last bits
    shifted = np.float64(z * 2.8853900817779268 + big)
    k = shifted - big
    # log(2) / 2 in two parts; k times the first has no rounding
    r = (z - k * 0.3465735901845619) - k * 9.5410746463529385e-11
    u = r * r
    P = r * (135135.0 + u * (17325.0 + u * (378.0 + u)))
    Q = 135135.0 + u * (62370.0 + u * (3150.0 + u * 28.0))
    return np.int64(shifted.view(np.int64) << 52).view(np.float64), P, Q


def exp(x: float) -> float:
    """e^x, 0 below 3e-308 and infinite above 8e307."""
    # arguments are cut off where `parts` would leave the range of a float's exponent
    power, P, Q = parts(where(x < -708.0, -354.0, where(x > 709.0, 354.5, x / 2.0)))
    return where(x > 709.0, math.inf, where(x < -708.0, 0.0, power * ((Q + P) / (Q - P))))


def tanh(x: float) -> float:
    """The hyperbolic tangent, (e^(2x) - 1) / (e^(2x) + 1)."""
    # beyond 22 tanh is 1 to the last bit
    power, P, Q = parts(where(x < -22.0, -22.0, where(x > 22.0, 22.0, x)))
    more, less = power + 1.0, power - 1.0
    return (less * Q + more * P) / (more * Q + less * P)
