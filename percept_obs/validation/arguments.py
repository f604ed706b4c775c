"""Arguments of public functions, checked once where they come in: their annotations say what is expected."""

from __future__ import annotations

import inspect
import reprlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, is_dataclass
from functools import cached_property, wraps
from importlib import import_module
from numbers import Real
from types import FunctionType, MappingProxyType, NoneType
from typing import Any, TypeVar, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray

from percept_obs.validation.kinds import (
    Kind,
    are_numbers,
    classes,
    depends_on_entries,
    elements,
    fits,
    is_real,
    with_article,
    words,
)

Thing = TypeVar("Thing", bound=Callable[..., Any])

EXAMPLES = MappingProxyType(
    {
        "Bound": "cramer_rao(recording, form)",
        "Camera": "Camera(period=0.01)",
        "Clock": "Clock(zero=0, tick=1e-3)",
        "CanonicalForm": 'PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")',
        "Consistency": "check_consistency(run)",
        "DepthSource": "GivenDepth()",
        "Family": "ibo",
        "ImagingSurface": "pinhole()",
        "LuenbergerObserver": "luenberger(form)",
        "Motion": "affine(A, b) or rigid(w, v_c, v_p)",
        "Observer": "ibo(form)",
        "PartitionedSystem": 'PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")',
        "PerspectiveSystem": "PerspectiveSystem(affine(), pinhole())",
        "PixelCamera": "PixelCamera((720, 720), (320, 240))",
        "PointsForm": "PointsForm(affine(A, b), np.eye(3))",
        "Poses": 'read_tum("poses.txt")',
        "Quadratic": "Quadratic(0.1)",
        "Recording": "record(scenarios.ma2005_eq35())",
        "Run": "track(recording, ibo(form))",
        "Scenario": "scenarios.ma2005_eq35()",
        "Scene": "scenarios.ma2005_eq35()",
        "StructureAndMotion": 'StructureAndMotion(("v_c1",))',
        "Uniform": "Uniform(0.01)",
    }
)
"""What makes a value of a class, by the name of the class."""

PACKAGE = __name__.partition(".")[0]

LATER = MappingProxyType({"pd": "pandas"})
"""Modules that annotations name and that are loaded where they are needed only."""


class WrongKind(TypeError, ValueError):
    """An argument is of another kind than the function takes: a TypeError to Python, a ValueError as all of ours."""


def checked(thing: Thing) -> Thing:
    """A function, or a class with its public methods, whose arguments are of their annotated kinds when it is called.

    A call with another kind raises `WrongKind`, which names the argument, what came, what was expected and, for the
    usual slips, what to write instead.  Numbers of sympy and fractions become floats where floats are expected.
    """
    if not isinstance(thing, type):
        return _guarded(thing, thing.__name__)
    for name, member in list(vars(thing).items()):
        if name == "__init__" or not name.startswith("_"):
            whole = thing.__name__ if name == "__init__" else f"{thing.__name__}.{name}"
            if isinstance(member, FunctionType):
                # what a dataclass inherits is annotated in other modules
                of_fields = thing if name == "__init__" and is_dataclass(thing) else None
                setattr(thing, name, _guarded(member, whole, of_fields))
            elif isinstance(member, classmethod | staticmethod):
                setattr(thing, name, type(member)(_guarded(member.__func__, whole)))
    return thing


def _guarded(function: Any, name: str, annotated: Any = None) -> Any:
    arguments, passed = _Arguments(function, name, annotated or function), set[tuple[Any, ...]]()

    @wraps(function)
    def called(*args: Any, **kwargs: Any) -> Any:
        types = (*map(_type_of, args), *kwargs, *map(_type_of, kwargs.values()))
        if types in passed:
            return function(*args, **kwargs)
        given = arguments.checked(args, kwargs)
        if all(isinstance(each, str) or _tells_all(each, arguments) for each in types):
            passed.add(types)
        return function(*given.args, **given.kwargs)

    return called


def _only_a_float_fits(value: Any, kind: Any) -> bool:
    """Whether a number of another type stands for a float, rather than for itself in a formula or an array."""
    alternatives = {kind, *get_args(kind)}
    return float in alternatives and not any(fits(value, each) for each in alternatives - {kind, float})


def _type_of(value: Any) -> Any:
    """The type of a value, or of an array's entries; an array of one number stands for it."""
    return value.dtype if type(value) is np.ndarray and value.ndim else type(value)


def _tells_all(kind: Any, arguments: _Arguments) -> bool:
    """Whether the type of a value alone decides of which kind it is, so that it is looked at once."""
    if isinstance(kind, np.dtype):
        return kind.kind in "biuf" and arguments.look_at_no_entries
    return kind in (float, np.float64, bool, str, NoneType) or kind.__module__.partition(".")[0] == PACKAGE


@dataclass(frozen=True)
class _Arguments:
    """What a function takes; looked up when it is called first, for annotations may name what comes later."""

    function: Callable[..., Any]
    name: str
    annotated: Any

    @cached_property
    def signature(self) -> inspect.Signature:
        return inspect.signature(self.function)

    @cached_property
    def kinds(self) -> dict[str, Any]:
        later = {name: import_module(module) for name, module in LATER.items() if f"{name}." in str(self.signature)}
        hints = get_type_hints(self.annotated, localns=later, include_extras=True)
        return {key: kind for key, kind in hints.items() if key in self.signature.parameters}

    @cached_property
    def look_at_no_entries(self) -> bool:
        """Whether no kind depends on how many entries an array has or what they are."""
        return not any(depends_on_entries(kind) for kind in self.kinds.values())

    def checked(self, args: tuple[Any, ...], kwargs: dict[str, Any]) -> inspect.BoundArguments:
        try:
            given = self.signature.bind(*args, **kwargs)
        except TypeError as error:
            takes = [str(p.replace(annotation=p.empty)) for p in self.signature.parameters.values() if p.name != "self"]
            raise WrongKind(f"{self.name}(): {error}; it takes {self.name}({', '.join(takes)})") from None
        for key, value in given.arguments.items():
            if key not in self.kinds:
                continue
            kind, place = self.kinds[key], self.signature.parameters[key].kind
            if place is place.VAR_KEYWORD:
                each_named = value.items()
            else:
                each_named = ((key, each) for each in (value if place is place.VAR_POSITIONAL else [value]))
            for name, each in each_named:
                if not fits(each, kind):
                    raise WrongKind(self._complaint(name, each, kind, given, place is place.VAR_POSITIONAL))
            if is_real(value) and not isinstance(value, int | float | np.number) and _only_a_float_fits(value, kind):
                given.arguments[key] = float(value)
        return given

    def _complaint(self, key: str, value: Any, kind: Any, given: inspect.BoundArguments, one_by_one: bool) -> str:
        others = ((k, v) for k, v in given.arguments.items() if k in self.kinds and k != key)
        swapped = next((k for k, v in others if fits(value, self.kinds[k]) and fits(v, kind)), "")
        remedy = f"{key} and {swapped} are swapped" if swapped and self.kinds[swapped] is not Any else ""
        if one_by_one and isinstance(value, Sequence) and not isinstance(value, str):
            remedy = f"pass its entries one by one: {self.name}({', '.join(map(repr, value))})"
        return sentence(self.name, key, value, kind, remedy)


def sentence(function: str, argument: str, value: Any, kind: Any, remedy: str = "") -> str:
    """What is said of an argument of the wrong kind."""
    remedy = remedy or _remedy(value, kind)
    return f"{function}(): {argument} is {came(value)}; expected {words(kind)}" + (f": {remedy}" if remedy else "")


def refuse_kind(function: str, argument: str, value: Any, kind: Any) -> None:
    """Raise `WrongKind` if a value is not of a kind, where no signature tells it."""
    if not fits(value, kind):
        raise WrongKind(sentence(function, argument, value, kind))


def numbers(value: Any, what: str, *shape: int | str) -> NDArray[np.float64]:
    """An array of real numbers; text is not read, and nothing is dropped.

    Parameters
    ----------
    value : array
    what : str
        What it is given for.
    *shape : int or str
        Its last dimensions, as numbers or letters; any when left out.

    Raises
    ------
    WrongKind
        If it is something else.
    ValueError
        If it has another shape.
    """
    if not (isinstance(value, np.ndarray) and value.dtype == np.float64) and not are_numbers(value):
        raise WrongKind(f"{what} is {came(value)}; expected real numbers")
    array = np.asarray(value, dtype=float)
    last = array.shape[-len(shape) :] if shape else ()
    if len(last) != len(shape) or any(isinstance(s, int) and s != found for s, found in zip(shape, last, strict=True)):
        wanted = ", ".join(map(str, ("...", *shape)))
        raise ValueError(f"{what} have the shape {array.shape}; expected ({wanted})")
    return array


def came(value: Any) -> str:
    """A value in words, in short."""
    if value is None or isinstance(value, bool):
        return str(value)
    if isinstance(value, str):
        return f"the text {reprlib.repr(value)}"
    if isinstance(value, complex | np.complexfloating):
        return f"the complex number {value}"
    if isinstance(value, Real):
        return f"the number {value}"
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape} and type {value.dtype}"
    if isinstance(value, list | tuple | dict | set | bytes):
        return f"the {type(value).__name__} {reprlib.repr(value)}"
    if callable(value) and hasattr(value, "__name__"):
        return f"the {'class' if isinstance(value, type) else 'function'} {value.__name__}"
    return with_article(type(value).__name__)


def _remedy(value: Any, kind: Any) -> str:
    """What to write instead, for the usual slips."""
    if isinstance(value, FunctionType) or hasattr(value, "__signature__"):
        needed = [p.name for p in inspect.signature(value).parameters.values() if p.default is p.empty and p.kind < 2]
        return f"call it: {value.__name__}({', '.join(needed)})"
    if any(fits(value, entry) for entry in elements(kind)):
        return "put it into a list"
    example = next((EXAMPLES[name] for name in classes(kind) if name in EXAMPLES), "")
    named = next((k.example for k in (*getattr(kind, "__metadata__", ()),) if isinstance(k, Kind)), "")
    return f"pass for example {example or named}" if example or named else ""


def positive(**values: float) -> None:
    """Refuse numbers that are not positive and finite, each by its name.

    Examples
    --------
    >>> positive(seconds=2.0, distance=0.0)
    Traceback (most recent call last):
    ValueError: distance is 0.0; it must be positive and finite
    """
    for name, value in values.items():
        if not 0 < value < float("inf"):
            raise ValueError(f"{name} is {value}; it must be positive and finite")
