"""Numbers of other libraries as numpy's: gaps as NaN, durations in seconds, rotations as quaternions, no units."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Set, ValuesView
from decimal import Decimal
from fractions import Fraction
from itertools import islice
from numbers import Real
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.validation.limits import limit, limit_range

LARGEST_FLOAT = 10**308
"""Integers and fractions from here on do not become floats."""

MOST_LABELS = 20
"""Labels beyond so many name no coordinates."""

MOST_LISTED = 1_000_000
"""Most entries that are taken one after another."""

GAPS = ("NoneType", "NAType", "NaTType", "MaskedConstant")
"""Types of what stands where a number is missing."""


def are_numbers(value: Any) -> bool:
    """Return True if numpy makes an array of real numbers of a value without reading text or dropping anything."""
    if type(value) is np.ndarray and value.dtype.kind in "iuf":
        return True
    if isinstance(value, str | bytes | Mapping | np.ma.MaskedArray) or callable(value) or unit_of(value) is not None:
        return False
    limit_range(value)
    try:
        array = np.asarray(value)
    except (ValueError, TypeError, RuntimeError):  # ragged, or a tensor that keeps its gradient
        return False
    return array.dtype.kind in "iuf" or (array.dtype.kind == "O" and all(map(is_real, array.ravel())))


def is_real(value: Any) -> bool:
    """Return True for a real number of Python, numpy or sympy, but not for True and False."""
    if isinstance(value, np.ndarray):
        return type(value) is np.ndarray and not value.ndim and value.dtype.kind in "iuf"
    if isinstance(value, sp.Expr):
        return bool(value.is_number and value.is_extended_real)
    if isinstance(value, Decimal):
        return value.is_finite() and -LARGEST_FLOAT < value < LARGEST_FLOAT
    if isinstance(value, bool | np.timedelta64) or not isinstance(value, Real):  # numpy has durations among integers
        return False
    return not isinstance(value, int | Fraction) or bool(-LARGEST_FLOAT < value < LARGEST_FLOAT)


def plain(value: Any) -> Any:
    """Return numbers as numpy's, however they are kept; what is none of numbers comes back as it is.

    Gaps become NaN, durations seconds, rotations of scipy quaternions, and quantities without a dimension numbers.
    """
    if value is None or isinstance(value, str | bytes | Mapping) or callable(value):
        return value
    limit_range(value)
    found = listed(value) if isinstance(value, Iterator | Set | ValuesView) else value
    if unit_of(found) is not None:
        found = list(map(_without_unit, found)) if isinstance(found, list | tuple) else _without_unit(found)
    if unit_of(found) is not None:
        return value
    for method in ("detach", "as_quat", "to_numpy"):
        found = getattr(found, method)() if hasattr(found, method) else found
    try:
        array: Any = found if isinstance(found, np.ndarray) else np.asarray(found)
        if array.dtype.kind == "O":
            entries = np.array(list(map(_number, array.flat)), dtype=float)
            array = entries.reshape(array.shape + entries.shape[1:])
    except (ValueError, TypeError):  # ragged, or none of numbers
        return value
    if array.dtype.kind == "m" and np.datetime_data(array.dtype)[0] != "generic":
        array = array / np.timedelta64(1, "s")
    if array.dtype.kind not in "iuf":
        return value
    if isinstance(array, np.ma.MaskedArray):
        array = np.ma.filled(array.astype(float), np.nan)
    return np.asarray(array) if array.ndim else array[()]


def _number(entry: Any) -> Any:
    """Number or quaternion that an entry of an array stands for; TypeError if for none."""
    if type(entry).__name__ in GAPS:
        return np.nan
    if hasattr(entry, "total_seconds"):
        return entry.total_seconds()
    if hasattr(entry, "as_quat"):
        return entry.as_quat()
    if isinstance(entry, np.ndarray) and entry.ndim == 1 and are_numbers(entry):
        return entry
    if not is_real(entry):
        raise TypeError("no number")
    return float(entry)


def single(value: Any) -> Any:
    """Return the only number of an array, or the number that another type stands for; anything else as it is."""
    if isinstance(value, list | tuple | Iterator | Set):
        return value
    found = plain(value)
    found = found.ravel()[0] if isinstance(found, np.ndarray) and found.size == 1 else found
    return float(str(found)) if isinstance(found, np.floating) and not isinstance(found, float) else found


def unit_of(value: Any) -> Any:
    """Return the unit of a quantity, or of quantities in a list, as pint and astropy have it; None without one."""
    if isinstance(value, list | tuple):
        return unit_of(value[0]) if len(value) else None
    if hasattr(value, "magnitude") and hasattr(value, "units"):
        return value.units
    return value.unit if hasattr(value, "to_value") and hasattr(value, "unit") else None


def _without_unit(value: Any) -> Any:
    """Return the number of a quantity without a dimension, such as 3 mm/m; any other value as it is."""
    try:
        return value.m_as("") if hasattr(value, "m_as") else value.to_value("")
    except (TypeError, ValueError):  # it has a dimension
        return value


def listed(value: Any) -> Any:
    """Return a list of what can be gone through in an order; anything else as it is."""
    if isinstance(value, str | bytes | Mapping | set | frozenset) or not isinstance(value, Iterable):
        return value
    if isinstance(value, np.ndarray) and not value.ndim:
        return value
    found = list(islice(value, MOST_LISTED + 1))
    limit(len(found), "entries one after another", "give an array, or fewer", MOST_LISTED)
    return found


def columns(value: Any) -> Mapping[Any, Any] | None:
    """Return the columns of a table, or the entries of a labelled series, by their names; None if it has none."""
    if isinstance(value, Mapping):
        return value
    if isinstance(value, np.ndarray):
        return {name: value[name] for name in value.dtype.names} if value.dtype.names else None
    if hasattr(value, "columns"):
        return {name: value[name] for name in value.columns}
    if hasattr(value, "coords") and (names := labels(value)):
        return {name: value.values[..., place] for place, name in enumerate(names)}
    return dict(value.items()) if hasattr(value, "items") and hasattr(value, "index") else None


def labels(value: Any) -> list[str]:
    """Return the names of the entries of a row, where a table, a series or an array of xarray has a few; else none."""
    names: Any = getattr(value, "index", ()) if hasattr(value, "items") else ()
    names = getattr(value, "columns", names)
    if hasattr(value, "coords") and hasattr(value, "dims") and len(value.dims):
        names = value.coords[value.dims[-1]].values if value.dims[-1] in value.coords else ()
    if callable(names) or len(names) > MOST_LABELS or not all(isinstance(name, str | tuple) for name in names):
        return []
    return [name if isinstance(name, str) else " ".join(map(str, name)) for name in names]


def in_order(names: list[str]) -> bool:
    """Return True if names follow each other as x, y, z or y1, y2, y10."""
    padded = [re.sub(r"\d+", lambda digits: digits[0].zfill(9), name.lower()) for name in names]
    return padded == sorted(padded)


def is_table(value: Any) -> bool:
    """Return True for a table whose columns have names and are numbers."""
    found = columns(value) or {}
    if not found or len(found) < len(getattr(value, "columns", ())):  # none, or a name stands twice
        return False
    return all(isinstance(n, str) and are_numbers(plain(column)) for n, column in found.items())
