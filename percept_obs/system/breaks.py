"""Times at which expressions of time jump, have a kink or a pole, so that steps can end there."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import sympy as sp
from sympy.core.relational import Relational

from percept_obs.compile import vectorised

INTERVALS, HALVINGS, MOST = 20_000, 34, 10_000
"""Intervals that are searched for a break, halvings of one that has it, and most breaks that are told."""


@lru_cache(maxsize=64)
def breaks_of(time: sp.Symbol, expressions: tuple[sp.Expr, ...], until: float) -> tuple[float, ...]:
    """Times from 0 on between which expressions of time are smooth: one just before each break, and one just after it.

    They are found to 1e-10 of an interval; none where there are more than `MOST`, or where other symbols decide.

    >>> t = sp.Symbol("t", real=True)
    >>> np.round(breaks_of(t, (sp.sign(t - sp.Rational(1, 3)),), 2.0), 9).tolist()
    [0.333333333, 0.333333333]
    """
    turned = {
        (sp.Abs, sp.sign, sp.Heaviside): lambda node: node.args[0],
        (sp.tan,): lambda node: sp.cos(node.args[0]),
        (Relational,): lambda node: node.lhs - node.rhs,
        (sp.Pow,): lambda node: node.base if node.exp.could_extract_minus_sign() else sp.S.One,
    }
    found = {rule(node) for kinds, rule in turned.items() for node in sp.Tuple(*expressions).atoms(*kinds)}
    switches = [each for each in found if each.free_symbols == {time}]
    if not switches or not until > 0:
        return ()
    values, times = vectorised((time,), switches), np.linspace(0, until, INTERVALS + 1)
    with np.errstate(all="ignore"):
        # a break is where what decides on a branch changes its sign; bisect all breaks at once
        signs = np.sign(values(times))
        which, k = np.nonzero((signs[:, 1:] != signs[:, :-1]) & np.isfinite(signs[:, 1:] + signs[:, :-1]))
        low, high, before = times[k], times[k + 1], signs[which, k]
        for _ in range(HALVINGS if len(k) <= MOST else 0):
            middle = (low + high) / 2
            early = np.sign(values(middle))[which, np.arange(len(k))] == before
            low, high = np.where(early, middle, low), np.where(early, high, middle)
    return tuple(np.unique([low, high]).tolist()) if len(k) <= MOST else ()
