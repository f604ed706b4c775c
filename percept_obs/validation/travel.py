"""Values that travel: pickle and copy keep what a value was made of, and leave what it keeps of its work."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, TypeVar

import numpy as np

Class = TypeVar("Class", bound=type)


def travels(kind: Class) -> Class:
    """Let values of a class, or errors, be pickled and copied; read-only arrays and mappings stay so."""
    kind.__reduce__ = _reduced  # type: ignore[assignment]
    return kind


def _reduced(value: Any) -> tuple[Any, ...]:
    kind, args = type(value), {"args": value.args} if isinstance(value, BaseException) else {}
    parts = {k: part for k, part in vars(value).items() if not isinstance(getattr(kind, k, None), cached_property)}
    mappings = {name: dict(part) for name, part in parts.items() if isinstance(part, MappingProxyType)}
    arrays = {name for name, part in parts.items() if _sealed(part)}
    return _made, (kind, parts | mappings | args, arrays | mappings.keys())


def _made(kind: Any, parts: dict[str, Any], sealed: Collection[str]) -> Any:
    value = kind.__new__(kind)
    for name, part in parts.items():
        object.__setattr__(value, name, _seal(part) if name in sealed else part)
    return value


def _sealed(part: Any) -> bool:
    if isinstance(part, tuple):
        return bool(part) and all(map(_sealed, part))
    return isinstance(part, np.ndarray) and not part.flags.writeable


def _seal(part: Any) -> Any:
    if isinstance(part, tuple):
        return tuple(map(_seal, part))
    if isinstance(part, dict):
        return MappingProxyType({key: _seal(each) for key, each in part.items()})
    if isinstance(part, np.ndarray):
        part.setflags(write=False)
    return part


@dataclass(frozen=True)
class Chain:
    """One function after another; unlike a closure it travels, if they do."""

    first: Callable[..., Any]
    then: Callable[[Any], Any]

    def __call__(self, *given: Any) -> Any:
        """Return the second function of what the first one returns."""
        return self.then(self.first(*given))
