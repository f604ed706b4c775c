"""Kinds of values: what an annotation admits, as a test, in words, and by an example."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from numbers import Integral
from types import FunctionType, MappingProxyType, MethodType, NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from percept_obs.validation.limits import limit_range
from percept_obs.validation.plain import are_numbers, columns, is_real, is_table, labels, listed, plain, single, unit_of

EXAMPLES = MappingProxyType(
    {
        "Bound": "cramer_rao(recording, form)",
        "BoundMap": "bound_map(system)",
        "Camera": "Camera(period=0.01)",
        "Clock": "Clock(zero=0, tick=1e-3)",
        "CanonicalForm": 'PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")',
        "Consistency": "check_consistency(run)",
        "Diagnosis": "diagnose(recordings)",
        "DepthSource": "GivenDepth()",
        "Family": "ibo",
        "ImagingSurface": "pinhole()",
        "LuenbergerObserver": "luenberger(form)",
        "Motion": "affine(A, b) or rigid(camera_velocity=v_c)",
        "Observer": "ibo(form)",
        "Observability": "how_observable(recording, system)",
        "PartitionedSystem": 'PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")',
        "PerspectiveSystem": "PerspectiveSystem(affine(), pinhole())",
        "PixelCamera": "PixelCamera((720, 720), (320, 240))",
        "PointsForm": "PointsForm(affine(A, b), np.eye(3))",
        "Poses": 'read_tum("poses.txt")',
        "Recording": "record(scenarios.ma2005_eq35())",
        "Run": "track(recording, ibo(form))",
        "Scenario": "scenarios.ma2005_eq35()",
        "Scene": "scenarios.ma2005_eq35()",
        "Sensitivity": "sensitivity(recording, observer)",
        "StructureAndMotion": 'StructureAndMotion(("v_c1",))',
        "Uniform": "Uniform(0.01)",
    }
)
"""Code that makes a value of a class, by the name of the class."""


@dataclass(frozen=True)
class Kind:
    """A kind of values; it also annotates what no class stands for, as ``Annotated[..., Kind(...)]``."""

    label: str  # name in messages
    fits: Callable[[Any], bool]
    example: str = ""  # code that makes such a value
    by_type: bool = False  # whether the type of a value, or of an array's entries, decides
    entries: tuple[Kind, ...] = ()  # kinds of a sequence's entries
    made: Callable[[Any], Any] = lambda value: value  # a value as the function takes it, of what means one


def _array(value: Any) -> Any:
    return value if isinstance(value, int | float) else plain(value)


def _column(value: Any) -> Any:
    """Numbers one after another, where a column of them came."""
    found = _array(value)
    return found.ravel() if isinstance(found, np.ndarray) and found.shape[1:] == (1,) else found


def _table(value: Any) -> Any:
    """Columns by their names, or an array."""
    found = columns(value) if is_table(value) else None
    return plain(value) if found is None else {name: plain(column) for name, column in found.items()}


def _float(value: Any) -> Any:
    """Number as a float, but for those of Python and numpy, which stay."""
    if isinstance(value, int | float | np.integer) and not isinstance(value, np.timedelta64):
        return value
    found = single(value)
    return float(found) if is_real(found) else value


def _integer(value: Any) -> Any:
    """Whole number as an int, also 3.0."""
    found = value if isinstance(value, int) else single(value)
    return int(found) if _is_integer(found) or (isinstance(found, float) and found.is_integer()) else value


def _text(value: Any) -> Any:
    """Name that a symbol stands for."""
    return value.name if isinstance(value, sp.Symbol) else value


def _is_expression(value: Any) -> bool:
    return isinstance(value, sp.Expr) or is_real(value)


def _are_expressions(value: Any) -> bool:
    if unit_of(value) is not None:
        return False
    try:
        entries = np.array(value.tolist() if isinstance(value, sp.MatrixBase) else value, dtype=object).ravel()
    except (ValueError, TypeError):
        return False
    return all(map(_is_expression, entries))


def _is_integer(value: Any) -> bool:
    return isinstance(value, Integral) and is_real(value) and abs(int(value)) < 2**63


def takes(value: Any, count: int) -> bool:
    """Return True for what can be called with so many arguments; what hides its arguments is believed."""
    if not isinstance(value, FunctionType | MethodType):
        return callable(value)
    try:
        inspect.signature(value).bind(*range(count))
    except TypeError:
        return False
    return True


Entries = Annotated[Any, Kind("an array of real numbers or of sympy expressions", _are_expressions)]
Coefficients = Annotated[
    Any,
    Kind(
        "an array of real numbers, a function of time, or an array of sympy expressions",
        lambda v: are_numbers(v) or callable(v) or _are_expressions(v),
        made=lambda v: v if _are_expressions(v) else plain(v),
    ),
]
"""Coefficients of a motion."""

ARRAY = Kind("an array of real numbers", are_numbers, "np.array([0.0, 1.0])", True, made=_array)
TIMES = Kind("an array of times in seconds", are_numbers, "t - t[0]", True, made=_column)
Times = Annotated[ArrayLike, TIMES]
TABLE = Kind(
    "an array of real numbers or a table", lambda v: are_numbers(v) or is_table(v), ARRAY.example, True, made=_table
)

FLOAT = Kind("a real number", lambda v: is_real(v) and v == v, by_type=True, made=_float)
INTEGER = Kind("a whole number", _is_integer, by_type=True, made=_integer)
NOTHING = Kind("None", lambda v: v is None, by_type=True)
_KINDS: Mapping[Any, Kind] = {
    float: FLOAT,
    int: INTEGER,
    bool: Kind("True or False", lambda v: isinstance(v, bool | np.bool_), by_type=True),
    str: Kind("text", lambda v: isinstance(v, str), by_type=True, made=_text),
    ArrayLike: ARRAY,
    NDArray[np.bool_]: Kind("an array of True and False", lambda v: np.asarray(v).dtype == bool, by_type=True),
    sp.Expr: Kind("a real number or a sympy expression", _is_expression, by_type=True),
    sp.ImmutableMatrix: Kind("a sympy matrix", lambda v: isinstance(v, sp.MatrixBase), by_type=True),
    NoneType: NOTHING,
}
_ARRAYS = (np.ndarray, get_origin(NDArray[np.float64]))  # the second is an alias of the first from Python 3.12 on


@cache
def kind_of(annotation: Any) -> Kind:
    """Kind of values that an annotation admits; built once, for reading annotations takes longer than a check."""
    origin, inside = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return next(each for each in annotation.__metadata__ if isinstance(each, Kind))
    if annotation in _KINDS or origin in _ARRAYS:
        return _KINDS.get(annotation, ARRAY)
    if origin in (Union, UnionType):
        return _union(inside)
    if origin is Literal:
        names = ", ".join(map(repr, inside))
        return Kind(f"one of {names}", lambda v: isinstance(v, str) and v in inside)
    if origin is Callable and inside[0] is not Ellipsis:
        count = len(inside[0])
        label = f"a function of {count} argument{'s' * (count != 1)}"
        return Kind(label, lambda v: takes(v, count), by_type=True)
    if origin is Callable:
        return Kind("a function", callable, by_type=True)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return _mapping(*map(kind_of, inside))
    if isinstance(origin, type) and issubclass(origin, Iterable):
        return _sequence(origin, inside)
    return _instance(origin or annotation)


def _union(inside: tuple[Any, ...]) -> Kind:
    arrays = set(get_args(ArrayLike))
    if arrays and arrays <= set(inside):  # members of ArrayLike, which also admit complex numbers and text
        inside = (ArrayLike, *(each for each in inside if each not in arrays))
    kinds = tuple(map(kind_of, inside))
    in_turn = sorted(kinds, key=lambda kind: kind is FLOAT)  # an exact number stays one where this is asked for

    def fits(value: Any) -> bool:
        return any(kind.fits(value) for kind in kinds)

    def made(value: Any) -> Any:
        given = listed(value) if isinstance(value, Iterator) and not fits(value) else value
        found = (kind.made(given) for kind in [kind for kind in in_turn if kind.fits(given)] or in_turn)
        return next(filter(fits, found), value)

    return Kind(
        " or ".join(dict.fromkeys(kind.label for kind in kinds if kind is not NOTHING)),
        fits,
        next((kind.example for kind in kinds if kind.example), ""),
        all(kind.by_type for kind in kinds),
        tuple(entry for kind in kinds for entry in kind.entries),
        made,
    )


def _mapping(key: Kind, entry: Kind) -> Kind:
    def fits(value: Any) -> bool:
        found = columns(value)
        return found is not None and all(key.fits(k) and entry.fits(v) for k, v in found.items())

    def made(value: Any) -> Any:
        if isinstance(value, Mapping) and fits(value):
            return value
        found = columns(value)
        named = {key.made(k): entry.made(v) for k, v in (found or {}).items()}
        return value if found is None or len(named) < len(found) else named

    return Kind(f"a mapping from {key.label} to {entry.label}", fits, entry.example, made=made)


def _sequence(origin: type, inside: tuple[Any, ...]) -> Kind:
    """Kind of sequences and other iterables; arrays are sequences, and text is not."""
    entry, of_floats = kind_of(inside[0]), inside[0] is float and inside[1:] in ((), (Ellipsis,))
    admitted = (Sequence, np.ndarray, sp.MatrixBase, sp.Tuple) if issubclass(origin, Sequence) else Iterable

    def fits(value: Any) -> bool:
        if of_floats and issubclass(origin, Sequence):
            return are_numbers(value) and np.ndim(value) == 1
        if not isinstance(value, admitted) or isinstance(value, str | bytes | Mapping):
            return False
        limit_range(value)
        if not hasattr(value, "__len__"):
            return True  # looking into it would use it up
        if isinstance(value, np.ndarray) and not value.ndim:
            return False
        if origin is tuple and inside[-1] is not Ellipsis:
            each = list(value)
            return len(each) == len(inside) and all(kind_of(a).fits(e) for a, e in zip(inside, each, strict=True))
        return all(map(entry.fits, value))

    def made(value: Any) -> Any:
        if fits(value) and not labels(value):
            return value
        given = listed(value) if isinstance(value, Iterator) else value
        found = plain(given)
        if of_floats:
            row = isinstance(found, np.ndarray) and found.ndim == 2 and 1 in found.shape
            return found.ravel() if row else found
        each = found if isinstance(found, np.ndarray) else listed(given)
        return [entry.made(e) for e in each] if isinstance(each, list | np.ndarray) else value

    size = f" of {len(inside)}" if origin is tuple and inside[-1] is not Ellipsis else ""
    return Kind(f"a sequence{size}, each entry {entry.label}", fits, entry.example, entries=(entry,), made=made)


def _instance(cls: Any) -> Kind:
    if cls is Any:
        return Kind("anything", lambda _: True, by_type=True)
    if not isinstance(cls, type):
        return Kind(with_article(getattr(cls, "__name__", str(cls))), lambda _: True, by_type=True)
    public = {name for name in dir(cls) if name[0] != "_"}

    def has_members(value: Any) -> bool:
        return not isinstance(value, type) and public <= set(dir(value))

    fits = has_members if getattr(cls, "_is_protocol", False) else lambda value: isinstance(value, cls)
    return Kind(with_article(cls.__name__), fits, EXAMPLES.get(cls.__name__, ""), by_type=True)


_ROW = kind_of(Sequence[float])
NAMED = replace(
    _ROW,
    fits=lambda v: all(map(is_real, v.values())) if isinstance(v, Mapping) else _ROW.fits(v),
    made=lambda v: columns(v) if labels(v) else _ROW.made(v),
)
"""Numbers one after another, or by their names."""


def with_article(name: str) -> str:
    """Name of a class as a noun."""
    return f"an {name}" if name[0] in "AEIOaeio" else f"a {name}"
