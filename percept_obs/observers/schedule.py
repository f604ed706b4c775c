"""Gains over time: an expression of the seconds since the first sample in a gain's place."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.compile import vectorised
from percept_obs.observers.base import Observer
from percept_obs.observers.inversion import elapsed
from percept_obs.validation import checked, expression, positive

clock = sp.Symbol("tau", real=True)
"""State of an observer that counts the seconds since the first sample."""

INSTANTS = 1001
"""Number of times at which a gain's condition is tested."""


@checked
def scheduled(observer: Observer, until: float = 100.0, **gains: Any) -> Observer:
    """Return an observer with gains that are expressions of `TIME`, the seconds t since the first sample.

    Each takes its gain's place in the equations, which get one state more, tau' = 1 from 0, so that every language of
    the package runs them.

    Parameters
    ----------
    observer : Observer
        With gains that stay.
    until : float
        Seconds up to which each gain is checked, at 1001 times, to be finite and to fulfil its condition.
    **gains : sympy expressions in `TIME`, by the gains' names
        Never text, which sympy would run as code.

    Returns
    -------
    Observer
        With a state more, and without those gains.

    Raises
    ------
    ValueError
        If there is no such gain, it is no expression of t alone, it violates its condition before `until`, or the
        observer relies on its staying the same.

    See Also
    --------
    Observer.with_gains : Gains that stay.
    percept_obs.points.scheduled : P of many points over time.

    Examples
    --------
    >>> import sympy as sp
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios, scheduled, track
    >>> from percept_obs.system.motion import TIME
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> quick_then_calm = scheduled(ibo(form), gain=2 + 8 * sp.exp(-TIME))
    >>> quick_then_calm.equations.state, quick_then_calm.name
    ((yhat1, yhat2, yhat3, tau), 'identifier-based, gain over time')
    >>> track(record(scenarios.ma2005_eq35(), 20), quick_then_calm).settling_time() < 5
    True
    """
    known = {gain.name: gain for gain in observer.gains}
    if not gains or (unknown := sorted(set(gains) - set(known))):
        which = f"no gain {', '.join(unknown)}" if gains else "no gain given to change"
        raise ValueError(f"the {observer.name} observer has {which}; it has {', '.join(known)}")
    positive(until=until)
    at, rule = np.linspace(0, until, INSTANTS), {}
    for name, value in gains.items():
        gain, value = known[name], expression(value, name)
        if value.free_symbols - {elapsed}:
            raise ValueError(f"{name} = {value} depends on other things than t; give an expression of TIME alone")
        with np.errstate(all="ignore"):
            (numbers,) = vectorised((elapsed,), [value])(at)
        allowed = np.isfinite(numbers) & (vectorised((gain.symbol,), [gain.condition])(numbers)[0] != 0)
        if not allowed.all():
            k = int(np.argmin(allowed))
            raise ValueError(
                f"{name} = {value} is {numbers[k]:.4g} at t = {at[k]:.4g} s; it must be finite and {gain.condition} "
                f"from 0 to {until:g} s{'; ' * bool(gain.reason)}{gain.reason}"
            )
        rule[gain.symbol] = value
    fastest, conditions = observer.fastest, [where.condition for where in observer.unobservable]
    for solved in (*conditions, *([fastest.rate] if fastest else [])):
        if solved.has(elapsed) and (same := sorted(str(symbol) for symbol in rule if solved.has(symbol))):
            raise ValueError(f"the {observer.name} observer knows its limits for constant {', '.join(same)} only")
    inside = {symbol: value.xreplace({elapsed: clock}) for symbol, value in rule.items()}
    eq = observer.equations
    eq = replace(
        eq,
        state=(*eq.state, clock),
        flow=(*eq.flow, sp.S.One),
        update=tuple((*block, clock) for block in eq.update),
        reset=(*eq.reset, clock) if eq.reset else (),
    ).xreplace(inside)
    return replace(
        observer,
        name=f"{observer.name}, {' and '.join(gains)} over time",
        equations=replace(eq, gains=tuple(symbol for symbol in eq.gains if symbol not in rule)),
        estimate=tuple(entry.xreplace(inside) for entry in observer.estimate),
        gains=tuple(gain for gain in observer.gains if gain.symbol not in rule),
        start=(*(e.xreplace({s: v.subs(elapsed, 0) for s, v in rule.items()}) for e in observer.start), sp.S.Zero),
        covariance=observer.covariance and observer.covariance.xreplace(inside),
        unobservable=tuple(replace(w, condition=w.condition.xreplace(inside)) for w in observer.unobservable),
        fastest=fastest and replace(fastest, rate=fastest.rate.xreplace(rule)),
    )
