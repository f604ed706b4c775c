"""Limits of the work that one call may ask for, checked before the work begins."""

from __future__ import annotations

from typing import Any

MOST_NUMBERS = 10_000_000
"""Numbers that one call may keep: with what is computed from them they take about 1 GiB."""

MOST_TERMS = 20_000
"""Entries of symbolic matrices that one derivation may have: about half a minute of sympy."""


class TooMuchWork(ValueError):
    """A call would take more memory or time than is allowed; nothing of it has begun.

    See Also
    --------
    percept_obs.ensemble : Runs that are counted while they run need no memory each.

    Examples
    --------
    >>> from percept_obs import record, scenarios
    >>> record(scenarios.ma2005_eq35(), 1e9)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    percept_obs.validation.limits.TooMuchWork: this would be 9e+11 numbers, from 1e+11 samples, and at most ...
    """


def limit(amount: float, unit: str, remedy: str, most: float = MOST_NUMBERS) -> None:
    """Raise `TooMuchWork` before it begins for more than `most` units such as "numbers of 3 states at 1e+09 instants".

    The remedy says what to change.
    """
    if not amount <= most:
        raise TooMuchWork(f"this would be {amount:.3g} {unit}, and at most {most:.3g} are allowed; {remedy}")


def limit_range(value: Any) -> None:
    """Raise `TooMuchWork` for a range with more than `MOST_NUMBERS` entries, before anybody looks into it."""
    if isinstance(value, range):
        limit((value.stop - value.start) / value.step, "entries of a range", "give fewer")
