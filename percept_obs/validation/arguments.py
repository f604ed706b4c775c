"""Arguments of public functions, checked where they come in: their annotations say what is expected."""

from __future__ import annotations

import inspect
import reprlib
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import is_dataclass
from functools import cache, wraps
from numbers import Real
from operator import is_
from types import FunctionType, MappingProxyType, NoneType
from typing import Any, TypeVar, get_type_hints

import numpy as np
from numpy.typing import NDArray

from percept_obs.validation.environment import load_pandas
from percept_obs.validation.kinds import Kind, kind_of, with_article
from percept_obs.validation.plain import are_numbers, in_order, labels, plain, unit_of
from percept_obs.validation.travel import travels

Thing = TypeVar("Thing", bound=Callable[..., Any])

PACKAGE = __name__.partition(".")[0]

CHANGED = MappingProxyType(
    {
        "rigid": "; write rigid(camera_angular_velocity=w_c, ...) with w_c as the camera turns, which is minus what "
        "angular_velocity was"
    }
)
"""What else to say of a call that fits no longer."""

LATER = MappingProxyType({"pd": load_pandas})
"""Modules that annotations name, loaded when a function that needs them is called."""


class WrongKind(TypeError, ValueError):
    """An argument is of another kind than the function takes: a TypeError to Python, a ValueError as all of ours.

    See Also
    --------
    percept_obs.TooMuchWork : Raised where the kind is right, and the number too large.

    Examples
    --------
    >>> from percept_obs import Camera
    >>> Camera("0.1")
    Traceback (most recent call last):
    ...
    percept_obs.validation.arguments.WrongKind: Camera(): period is the text '0.1'; expected a real number
    """


def checked(thing: Thing) -> Thing:
    """Check the arguments of a function, or of a class's public methods, against their annotations.

    A call with another kind raises `WrongKind`, which names the argument, what came, what was expected and, for the
    usual slips, what to write instead.  What means the kind becomes one: see `percept_obs.validation.plain`.
    """
    if not isinstance(thing, type):
        return _guarded(thing, thing.__qualname__.removesuffix(".__init__"), thing)
    if is_dataclass(thing):
        travels(thing)
    for name, member in list(vars(thing).items()):
        if name == "__init__" or not name.startswith("_"):
            title = thing.__name__ if name == "__init__" else f"{thing.__name__}.{name}"
            if isinstance(member, FunctionType):
                # fields that a dataclass inherits are annotated in other modules
                annotated = thing if name == "__init__" and is_dataclass(thing) else member
                setattr(thing, name, _guarded(member, title, annotated))
            elif isinstance(member, classmethod | staticmethod):
                setattr(thing, name, type(member)(_guarded(member.__func__, title, member.__func__)))
    return thing


def _guarded(function: Any, name: str, annotated: Any) -> Any:
    passed: set[tuple[Any, ...]] = set()

    @cache
    def expected() -> tuple[inspect.Signature, dict[str, Kind], bool]:
        """Signature and kinds, read at the first call, for annotations may name what is defined later."""
        signature = inspect.signature(function)
        later = {name: load() for name, load in LATER.items() if f"{name}." in str(signature)}
        hints = get_type_hints(annotated, localns=later, include_extras=True)
        kinds = {key: kind_of(hint) for key, hint in hints.items() if key in signature.parameters}
        return signature, kinds, all(kind.by_type for kind in kinds.values())

    @wraps(function)
    def called(*args: Any, **kwargs: Any) -> Any:
        types = (*map(_type_of, args), *kwargs, *map(_type_of, kwargs.values()))
        if types in passed:
            return function(*args, **kwargs)
        signature, kinds, by_type = expected()
        bound = _bound(name, signature, args, kwargs)
        found = {
            key: _taken(name, kinds[key], signature.parameters[key], value)
            for key, value in bound.arguments.items()
            if key in kinds
        }
        as_given = all(value is bound.arguments[key] for key, value in found.items())
        bound.arguments |= found
        if as_given and all(isinstance(each, str) or _decides(each, by_type) for each in types):
            passed.add(types)
        return function(*bound.args, **bound.kwargs)

    return called


def _bound(
    name: str, signature: inspect.Signature, args: tuple[Any, ...], kwargs: dict[str, Any]
) -> inspect.BoundArguments:
    try:
        return signature.bind(*args, **kwargs)
    except TypeError as error:
        takes = [str(p.replace(annotation=p.empty)) for p in signature.parameters.values() if p.name != "self"]
        raise WrongKind(f"{name}(): {error}; it takes {name}({', '.join(takes)}){CHANGED.get(name, '')}") from None


def _taken(function: str, kind: Kind, parameter: inspect.Parameter, value: Any) -> Any:
    """Argument as the function takes it, the same one if it is so already; `WrongKind` if it is none."""
    if parameter.kind is parameter.VAR_KEYWORD:
        found: Any = {name: _made(function, name, each, kind, parameter) for name, each in value.items()}
        return value if all(map(is_, found.values(), value.values())) else found
    if parameter.kind is parameter.VAR_POSITIONAL:
        found = tuple(_made(function, parameter.name, each, kind, parameter) for each in value)
        return value if all(map(is_, found, value)) else found
    return _made(function, parameter.name, value, kind, parameter)


def _made(function: str, name: str, value: Any, kind: Kind, parameter: inspect.Parameter | None = None) -> Any:
    found = kind.made(value)
    if not kind.fits(found):
        raise WrongKind(_message(function, name, value, kind, parameter))
    if found is not value and not isinstance(found, Mapping):
        _by_place(f"{function}(): {name}", value)
    return found


def _by_place(what: str, value: Any) -> None:
    """Refuse labels in another order where numbers are taken by their places."""
    if not in_order(names := labels(value)):
        raise WrongKind(
            f"{what} has the labels {', '.join(names)}, and numbers are taken by their places here; put them in "
            "order, and give .to_numpy() of them"
        )


def _type_of(value: Any) -> Any:
    """Type of a value, or of an array's entries, with its dimensions; NaN is none of its type."""
    if isinstance(value, float) and value != value:
        return object
    return (value.dtype, value.ndim) if type(value) is np.ndarray and value.ndim else type(value)


def _decides(kind: Any, by_type: bool) -> bool:
    """Return True if all values of a type are of the same kind, so that one of them is checked."""
    if isinstance(kind, tuple):
        return kind[0].kind in "biuf" and by_type
    if kind is str:
        return by_type
    return kind in (float, np.float64, bool, NoneType) or kind.__module__.partition(".")[0] == PACKAGE


def _message(function: str, argument: str, value: Any, kind: Kind, parameter: inspect.Parameter | None = None) -> str:
    remedy = f"pass for example {kind.example}" if kind.example else ""
    if parameter and parameter.kind is parameter.VAR_POSITIONAL and isinstance(value, list | tuple):
        remedy = f"pass its entries one by one: {function}({', '.join(map(repr, value))})"
    elif isinstance(value, FunctionType) and "a function of" in kind.label:
        remedy = f"it takes {inspect.signature(value)}"
    elif isinstance(value, FunctionType) or hasattr(value, "__signature__"):
        needed = [p.name for p in inspect.signature(value).parameters.values() if p.default is p.empty and p.kind < 2]
        remedy = f"call it: {value.__name__}({', '.join(needed)})"
    elif unit_of(value) is not None:
        remedy = "pass numbers, in seconds, metres and radians"
    elif "a Motion" in kind.label and callable(getattr(value, "motion", None)):
        remedy = "pass its .motion()"
    elif kind.entries and kind.fits([value]):
        remedy = "put it into a list"
    return f"{function}(): {argument} is {described(value)}; expected {kind.label}" + (remedy and f": {remedy}")


def of_kind(function: str, argument: str, value: Any, annotation: Any) -> Any:
    """Return a value as an annotation has it, where no signature does; raise `WrongKind` if it does not fit."""
    return _made(function, argument, value, kind_of(annotation))


def numbers(value: Any, name: str, *shape: int | str) -> NDArray[np.float64]:
    """Array of real numbers, whose last dimensions are `shape`, as numbers or letters; `name` stands in messages.

    Text is not read, and nothing is dropped: `WrongKind` for anything else, ValueError for another shape.
    """
    found = value if type(value) is np.ndarray else plain(value)
    if not are_numbers(found):
        raise WrongKind(f"{name} is {described(value)}; expected real numbers")
    _by_place(name, value)
    array = np.asarray(found, dtype=float)
    last = array.shape[-len(shape) :] if shape else ()
    if len(last) != len(shape) or any(isinstance(s, int) and s != found for s, found in zip(shape, last, strict=True)):
        wanted = ", ".join(map(str, ("...", *shape)))
        raise ValueError(f"{name} have the shape {array.shape}; expected ({wanted})")
    return array


def described(value: Any) -> str:
    """Short description of a value for a message."""
    if value is None or isinstance(value, bool):
        return str(value)
    if isinstance(value, str):
        return f"the text {reprlib.repr(value)}"
    if isinstance(value, complex | np.complexfloating):
        return f"the complex number {value}"
    if isinstance(value, Real):
        return f"the number {value}"
    if (unit := unit_of(value)) is not None:
        return f"a quantity in {unit or 'no unit'}"
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape} and type {value.dtype}"
    if isinstance(value, list | tuple | dict | set | bytes):
        return f"the {type(value).__name__} {reprlib.repr(value)}"
    if callable(value) and hasattr(value, "__name__"):
        return f"the {'class' if isinstance(value, type) else 'function'} {value.__name__}"
    return with_article(type(value).__name__)


def set_fields(frozen: Any, **values: Any) -> None:
    """Set fields of a frozen value while it is made, from ``__post_init__``."""
    for name, value in values.items():
        object.__setattr__(frozen, name, value)


def one_of(count: int, **places: int) -> None:
    """Refuse places among so many things that are none of them, each by its name."""
    for name, place in places.items():
        if place != int(place) or not 0 <= place < count:
            raise ValueError(f"{name} is {place}; there are {count}, from 0 to {count - 1}")


def once(**values: Iterable[Any]) -> None:
    """Refuse what stands twice in sequences, each by its name."""
    for name, value in values.items():
        if twice := [each for each, count in Counter(value).items() if count > 1]:
            raise ValueError(f"{name} has {', '.join(map(str, twice))} twice; give each once")


def require_definite(what: str, matrices: NDArray[np.float64], semi: bool = False) -> None:
    """Raise ValueError unless matrices are finite, symmetric and positive (semi-)definite."""
    largest = np.abs(matrices).max(initial=1e-300)
    if not np.isfinite(matrices).all() or np.abs(matrices - matrices.swapaxes(-1, -2)).max() > 1e-6 * largest:
        raise ValueError(f"{what} must be a finite symmetric matrix")
    least = float(np.linalg.eigvalsh(matrices).min())
    if least < -1e-9 * largest or (least <= 0 and not semi):
        raise ValueError(f"{what} has the eigenvalue {least:.3g}; it must be positive {'semi' if semi else ''}definite")


def positive(**values: float) -> None:
    """Refuse numbers that are not positive and finite, each by its name."""
    for name, value in values.items():
        if not 0 < value < float("inf"):
            raise ValueError(f"{name} is {value}; it must be positive and finite")
