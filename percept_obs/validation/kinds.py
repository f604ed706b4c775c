"""Kinds of values, as annotations name them: whether a value is of one, and what it is called in words."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from numbers import Integral, Real
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

HUGE = 10**308
"""Whole numbers and fractions from here on are no floats any more."""


@dataclass(frozen=True)
class Kind:
    """A kind that no class stands for; it annotates ``Annotated[..., Kind(...)]``."""

    words: str
    fits: Callable[[Any], bool]
    example: str = ""


def are_numbers(value: Any) -> bool:
    """Whether numpy makes an array of real numbers of it, without reading text or dropping imaginary parts."""
    if isinstance(value, str | bytes | Mapping | np.ma.MaskedArray) or callable(value):
        return False
    try:
        array = np.asarray(value)
    except (ValueError, TypeError):  # ragged
        return False
    return array.dtype.kind in "biuf" or (array.dtype.kind == "O" and all(map(is_real, array.ravel())))


def is_real(value: Any) -> bool:
    """Whether it is a real number of Python, numpy or sympy; True and False are none."""
    if isinstance(value, np.ndarray):
        return not value.ndim and value.dtype.kind in "iuf"
    if isinstance(value, sp.Expr):
        return bool(value.is_number and value.is_extended_real)
    if isinstance(value, bool) or not isinstance(value, Real):
        return False
    return isinstance(value, float | np.number) or _within(value, HUGE)


def _within(value: Any, bound: int) -> bool:
    return bool(-bound < value < bound)


def _is_coefficient(value: Any) -> bool:
    return are_numbers(value) or callable(value) or _are_expressions(value)


def _are_expressions(value: Any) -> bool:
    try:
        entries = np.array(value.tolist() if isinstance(value, sp.MatrixBase) else value, dtype=object).ravel()
    except (ValueError, TypeError):
        return False
    return all(isinstance(entry, sp.Expr) or is_real(entry) for entry in entries)


Coefficients = Annotated[
    Any, Kind("an array of real numbers, a function of time, or an array of sympy expressions", _is_coefficient)
]
"""What a motion is given by."""
Entries = Annotated[Any, Kind("an array of real numbers or of sympy expressions", _are_expressions)]
Expression = Annotated[Any, Kind("a real number or a sympy expression", lambda v: isinstance(v, sp.Expr) or is_real(v))]

_SCALARS: Mapping[Any, Kind] = {
    float: Kind("a real number", is_real),
    int: Kind("a whole number", lambda v: isinstance(v, Integral) and not isinstance(v, bool) and _within(v, 2**63)),
    bool: Kind("True or False", lambda v: isinstance(v, bool | np.bool_)),
    ArrayLike: Kind("an array of real numbers", are_numbers),
    sp.Expr: Kind("a real number or a sympy expression", lambda v: isinstance(v, sp.Expr) or is_real(v)),
    sp.ImmutableMatrix: Kind("a sympy matrix", lambda v: isinstance(v, sp.MatrixBase)),
    NoneType: Kind("None", lambda v: v is None),
    None: Kind("None", lambda v: v is None),
}


@cache
def _named(kind: Any) -> Kind | None:
    if get_origin(kind) is Annotated:
        return next((extra for extra in kind.__metadata__ if isinstance(extra, Kind)), None)
    arrays = (np.ndarray, get_origin(NDArray[np.float64]))  # the second is an alias of the first from Python 3.12 on
    return _SCALARS[ArrayLike] if get_origin(kind) in arrays else _SCALARS.get(kind)


def _alternatives(inside: tuple[Any, ...]) -> tuple[Any, ...]:
    """The kinds of a union; those that make up numpy's ArrayLike stand for real numbers, not for complex or text."""
    arrays = set(get_args(ArrayLike))
    if not arrays or not arrays <= set(inside):
        return inside
    return (ArrayLike, *(each for each in inside if each not in arrays))


@cache
def _made_of(kind: Any) -> tuple[Any, tuple[Any, ...]]:
    """What a kind was made by and of what: looking into annotations takes longer than looking at a value."""
    origin, inside = get_origin(kind), get_args(kind)
    return origin, _alternatives(inside) if origin in (Union, UnionType) else inside


def fits(value: Any, kind: Any) -> bool:
    """Whether a value is of an annotated kind."""
    named = _named(kind)
    if named:
        return named.fits(value)
    origin, inside = _made_of(kind)
    if origin in (Union, UnionType):
        return any(fits(value, each) for each in inside)
    if origin is Literal:
        return isinstance(value, type(inside[0])) and not isinstance(value, bool)
    if origin is Callable:
        return callable(value)
    if origin is not None and issubclass(origin, Mapping):
        return isinstance(value, Mapping) and all(fits(k, inside[0]) and fits(v, inside[1]) for k, v in value.items())
    if origin is not None and issubclass(origin, Iterable):
        return _each_fits(value, origin, inside)
    if isinstance(origin, type):
        return isinstance(value, origin)
    if kind is Any or not isinstance(kind, type):
        return True
    if getattr(kind, "_is_protocol", False):
        return not isinstance(value, type) and {name for name in dir(kind) if name[0] != "_"} <= set(dir(value))
    return isinstance(value, kind)


def _each_fits(value: Any, origin: type, inside: tuple[Any, ...]) -> bool:
    """Whether a value is a sequence of a kind; arrays are sequences, and text is none."""
    if inside[0] is float and issubclass(origin, Sequence) and inside[1:] in ((), (Ellipsis,)):
        return are_numbers(value) and np.ndim(value) == 1
    several = (Sequence, np.ndarray, sp.MatrixBase, sp.Tuple) if issubclass(origin, Sequence) else Iterable
    if not isinstance(value, several) or isinstance(value, str | bytes | Mapping):
        return False
    if not hasattr(value, "__len__"):
        return True  # looking into it would use it up
    if isinstance(value, np.ndarray) and not value.ndim:
        return False
    if origin is tuple and inside[-1] is not Ellipsis:
        entries = list(value)
        return len(entries) == len(inside) and all(map(fits, entries, inside))
    return all(fits(entry, inside[0]) for entry in value)


def depends_on_entries(kind: Any) -> bool:
    """Whether an array may be of a kind by its shape or its entries, and not by their type alone."""
    if _named(kind) is not None:
        return kind is not ArrayLike and get_origin(kind) is Annotated
    origin, inside = _made_of(kind)
    if origin in (Union, UnionType):
        return any(map(depends_on_entries, inside))
    return isinstance(origin, type) and issubclass(origin, Iterable)


def words(kind: Any) -> str:
    """What an annotated kind is called."""
    named = _named(kind)
    if named:
        return named.words
    origin, inside = _made_of(kind)
    if origin in (Union, UnionType):
        return " or ".join(dict.fromkeys(words(each) for each in inside if each is not NoneType))
    if origin is Literal:
        return "one of " + ", ".join(map(repr, inside))
    if origin is Callable:
        return "a function"
    if origin is not None and issubclass(origin, Mapping):
        return f"a mapping from {words(inside[0])} to {words(inside[1])}"
    if origin is not None and issubclass(origin, Iterable):
        return f"a sequence, each entry {words(inside[0])}"
    return "text" if kind is str else with_article(getattr(kind, "__name__", str(kind)))


def with_article(name: str) -> str:
    """A class's name as a noun."""
    return f"an {name}" if name[0] in "AEIO" else f"a {name}"


def elements(kind: Any) -> tuple[Any, ...]:
    """The kinds of the entries of the sequences that an annotated kind is or may be."""
    origin, inside = get_origin(kind), get_args(kind)
    if origin in (Union, UnionType):
        return tuple(entry for each in inside for entry in elements(each))
    return inside[:1] if isinstance(origin, type) and issubclass(origin, Iterable) and origin is not np.ndarray else ()


def classes(kind: Any) -> tuple[str, ...]:
    """Names of the classes that an annotated kind mentions."""
    if isinstance(kind, type) and not get_args(kind):
        return (kind.__name__,)
    return tuple(name for each in get_args(kind) for name in classes(each))
