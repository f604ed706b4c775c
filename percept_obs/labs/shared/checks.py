"""Settings that come from the page or from a user are refused with a reason when they make no sense."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from percept_obs.observers import Observer


def one_of(settings: Mapping[str, Any], key: str, known: Iterable[str]) -> str:
    """The value of a setting that must be one of the known ones."""
    value, names = settings[key], list(known)
    if value not in names:
        raise ValueError(f"{key} is {value!r}; it must be one of {', '.join(names)}")
    return str(value)


def some_of(settings: Mapping[str, Any], key: str, known: Iterable[str]) -> list[str]:
    """The value of a setting that must name at least one of the known ones, each once."""
    values, names = settings[key], list(known)
    if not values or len(set(values)) != len(values) or not set(values) <= set(names):
        raise ValueError(f"{key} is {values!r}; name at least one of {', '.join(names)}, each once")
    return list(values)


def number(settings: Mapping[str, Any], key: str, low: float, high: float) -> float:
    """The value of a setting that must be a number from low to high."""
    value = settings[key]
    fits = isinstance(value, int | float) and not isinstance(value, bool) and low <= value <= high
    if not fits:
        raise ValueError(f"{key} is {value!r}; it must be a number from {low:g} to {high:g}")
    return float(value)


def numbers(settings: Mapping[str, Any], key: str, shape: tuple[int, ...], bound: float = 1e3) -> None:
    """Refuse a setting that is not a block of numbers of this shape."""
    try:
        array = np.array(settings[key], dtype=float)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    if array.shape != shape or not (np.abs(array) <= bound).all():
        raise ValueError(f"{key} is {settings[key]!r}; it must be {shape} numbers between -{bound:g} and {bound:g}")


def whole_number(settings: Mapping[str, Any], key: str = "seed") -> None:
    """Refuse a seed that is not a whole number of 32 bits."""
    seed = settings[key]
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**32:
        raise ValueError(f"{key} is {seed!r}; it must be a whole number from 0 to 2^32 - 1")


def known_names(settings: Iterable[str], known: Iterable[str]) -> None:
    """Refuse settings that do not exist."""
    names = list(known)
    unknown = sorted(set(settings) - set(names))
    if unknown:
        raise ValueError(f"there is no setting {', '.join(unknown)}; there are {', '.join(names)}")


def gains_of(
    given: Mapping[str, Mapping[str, float]], observers: Mapping[str, Observer]
) -> dict[str, dict[str, float]]:
    """The gains of all observers, those given and the others' own, by the observers' names and their own."""
    unknown = sorted(set(given) - set(observers))
    if unknown:
        raise ValueError(f"there is no observer {', '.join(unknown)}; there are {', '.join(observers)}")
    whole = {name: observer.with_gains(**given.get(name, {})) for name, observer in observers.items()}
    return {name: {gain.name: gain.value for gain in observer.gains} for name, observer in whole.items()}
