"""Settings that come from the page or from a user are refused with a reason when they make no sense."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np


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
