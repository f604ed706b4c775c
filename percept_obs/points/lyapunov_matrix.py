"""Parameter P of the Luenberger-type observer: constant, scheduled, or computed while it runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from percept_obs.compile import Array, Flags
from percept_obs.system.signal import Signal
from percept_obs.validation import Times, checked, numbers, positive, require_definite

DIFFERENCE = 1e-5
"""Half of the time, in seconds, over which a scheduled P is differenced."""


@checked
@dataclass(frozen=True, eq=False)
class LyapunovMatrix:
    """P given over time, or computed by P' = -A^T P - P A + information S - forgetting (P - start) - decrease.

    Parameters
    ----------
    name : str
    start : array of shape (n, n), or a number for its multiple of the identity
        P at the first sample, and of points that begin anew.
    information, forgetting : float
        Unused where P is given.
    decrease : array of shape (n, n), or a number
        Unused where P is given.
    schedule : Signal, optional
        P over time, row by row (or one number), where it is given.

    Raises
    ------
    ValueError
        If the start or the decrease is not finite.

    See Also
    --------
    constant, scheduled, lyapunov, riccati : Make it.
    luenberger : The observer that uses it.

    Examples
    --------
    >>> from percept_obs.points import riccati
    >>> P = riccati(0.1).sized(2)
    >>> P.name, P.forgetting, P.start.tolist()
    ('Riccati', 0.3, [[0.1, 0.0], [0.0, 0.1]])
    """

    name: str
    start: Any
    information: float = 0.0
    forgetting: float = 0.0
    decrease: Any = 0.0
    schedule: Signal | None = None

    def __post_init__(self) -> None:
        for name in ("start", "decrease"):
            if self.schedule is None and not np.isfinite(numbers(getattr(self, name), f"the {name} of P")).all():
                raise ValueError(f"the {name} of P (or P itself) is not finite; give numbers")

    @property
    def computed(self) -> bool:
        """True if P is computed while the observer runs."""
        return self.schedule is None

    @property
    def constant(self) -> bool:
        """True if P is given and constant."""
        return self.schedule is not None and self.schedule.constant

    @property
    def couples(self) -> Flags:
        """Pairs of states that P may couple, shape (n, n)."""
        if self.schedule is None:
            return np.asarray((self.start != 0) | (self.decrease != 0))
        if callable(samples := self._given.samples):
            return np.ones(self.start.shape, dtype=bool)
        return np.any([_square(row, len(self.start)) != 0 for row in samples], axis=0)

    def sized(self, states: int) -> LyapunovMatrix:
        """Return a copy for some states, with matrices in place of numbers, which must be symmetric and definite."""
        positive(states=states)
        if self.schedule is not None:
            rows = self.schedule.at(0.0) if callable(self.schedule.samples) else self.schedule.samples
            for k, row in enumerate(rows):
                if row.size not in (1, states**2):
                    raise ValueError(f"P is scheduled with {row.size} entries; expected 1 or {states} x {states}")
                require_definite(f"P, sample {k},", _square(row, states))
            return replace(self, start=np.eye(states), decrease=np.zeros((states, states)))
        start, decrease = (_square(value, states) for value in (self.start, self.decrease))
        require_definite("P", start)
        require_definite("the decrease of P", decrease, semi=True)
        return replace(self, start=start, decrease=decrease)

    def at(self, times: Times) -> Array:
        """A given P at the given times, shape (T, n, n), or (1, n, n) when constant; ValueError if it is computed."""
        rows = self._given.at(times)
        return np.stack([_square(row, len(self.start)) for row in rows])

    def rate(self, times: Times) -> Array:
        """Derivative of a given P at the given times, shape (T, n, n); ValueError if it is computed."""
        given, times = self._given, np.atleast_1d(np.asarray(times, dtype=float))
        if given.constant:
            return np.zeros((len(times), *self.start.shape))
        low, high = times - DIFFERENCE, times + DIFFERENCE
        if given.times is not None:
            # samples are not known beyond their ends, where the difference becomes one-sided
            low, high = (np.clip(t, given.times[0], given.times[-1]) for t in (low, high))
        return (self.at(high) - self.at(low)) / (high - low)[:, None, None]

    @property
    def _given(self) -> Signal:
        """The schedule; raises ValueError if there is none, or no size."""
        if self.schedule is None or self.start is None:
            why = "is computed while the observer runs" if self.computed else "has no size yet: sized(states) gives one"
            raise ValueError(f"the {self.name} {why}")
        return self.schedule


@checked
def constant(P: ArrayLike = 1.0) -> LyapunovMatrix:
    """Return a P that stays as it is.

    Parameters
    ----------
    P : array of shape (n, n) or float
        Symmetric positive definite; a number stands for its multiple of the identity.

    See Also
    --------
    scheduled, lyapunov, riccati

    Examples
    --------
    >>> from percept_obs.points import constant
    >>> constant(2.0).sized(2).at([0.0]).tolist()
    [[[2.0, 0.0], [0.0, 2.0]]]
    """
    return LyapunovMatrix("constant P", None, schedule=Signal(np.ravel(np.asarray(P, dtype=float))))


@checked
def scheduled(P: Callable[[float], ArrayLike] | ArrayLike, times: Times | None = None) -> LyapunovMatrix:
    """Return P as a function of time, or from samples.

    Parameters
    ----------
    P : function of a time, or array of shape (K, n, n) or (K,)
        Symmetric positive definite; numbers are multiples of the identity.
    times : array of shape (K,), optional
        Times in seconds of the samples, linear between them.

    Raises
    ------
    ValueError
        If samples and times do not fit, or a function has times.

    See Also
    --------
    constant, lyapunov, riccati

    Examples
    --------
    >>> from percept_obs.points import scheduled
    >>> scheduled([1.0, 3.0], times=[0.0, 2.0]).sized(2).at([1.0]).tolist()
    [[[2.0, 0.0], [0.0, 2.0]]]
    """
    if callable(P):
        if times is not None:
            raise ValueError("P is a function of time, and times are those of samples; give one of the two")
        return LyapunovMatrix("scheduled P", None, schedule=Signal(P))
    samples = np.atleast_1d(numbers(P, "P"))
    if not samples.size:
        raise ValueError("P has no samples; give a number or a matrix for each of its times")
    if times is None:
        raise ValueError("samples of P need their times=; a P that stays is constant(P)")
    return LyapunovMatrix("scheduled P", None, schedule=Signal(samples.reshape(len(samples), -1), np.asarray(times)))


@checked
def lyapunov(start: ArrayLike = 1.0, decrease: ArrayLike = 0.0) -> LyapunovMatrix:
    """Return P from the Lyapunov equation P' = -A^T P - P A - decrease, which meets (15) with room for the decrease.

    Parameters
    ----------
    start : array of shape (n, n) or float
        Symmetric positive definite.
    decrease : array of shape (n, n) or float
        Symmetric positive semidefinite.  P stays positive only while the start outweighs what it takes away.

    See Also
    --------
    constant, scheduled, riccati

    Examples
    --------
    >>> from percept_obs.points import lyapunov
    >>> lyapunov(2.0, decrease=0.1).sized(2).decrease.tolist()
    [[0.1, 0.0], [0.0, 0.1]]
    """
    return LyapunovMatrix("Lyapunov", start, decrease=decrease)


@checked
def riccati(start: ArrayLike = 0.01, forgetting: float = 0.3) -> LyapunovMatrix:
    """Return P from P' = -A^T P - P A + S - forgetting (P - start), whose inverse solves a Riccati equation.

    Here S = C^T B^T B C.

    P gathers what the images told, as the information matrix of least squares does, and forgets it exponentially, but
    for its start: so it stays bounded above and, for points out of sight as well, below.

    Parameters
    ----------
    start : array of shape (n, n) or float
        Symmetric positive definite: how much the start is trusted, against images seen for a second.
    forgetting : float
        In 1/s, not negative.

    Raises
    ------
    ValueError
        If the forgetting is negative or not finite.

    See Also
    --------
    constant, scheduled, lyapunov

    Notes
    -----
    Where A^T start + start A = 0, as for rotations and a multiple of the identity, P >= start at all times, and
    A^T P + P A + P' = S - forgetting (P - start) <= S: the weaker condition holds with epsilon = 1, instead of (15).

    Examples
    --------
    >>> from percept_obs.points import riccati
    >>> P = riccati(0.1, forgetting=0.5)
    >>> P.name, P.computed
    ('Riccati', True)
    """
    if not (np.isfinite(forgetting) and forgetting >= 0):
        raise ValueError(f"the forgetting is {forgetting} 1/s; it must be finite and not negative")
    return LyapunovMatrix("Riccati", start, information=1.0, forgetting=float(forgetting))


def _square(value: ArrayLike, states: int) -> Array:
    """Matrix of shape (n, n) from n^2 entries, or from a number times the identity."""
    array = np.asarray(value, dtype=float)
    if array.size == 1:
        return float(array.ravel()[0]) * np.eye(states)
    if array.size != states**2:
        raise ValueError(f"P has shape {array.shape}; expected a number or {(states, states)}")
    return array.reshape(states, states)
