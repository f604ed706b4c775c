"""Values that travel: pickle and copy keep what a value was made of, and leave what it keeps of its work."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

import numpy as np

Kind = TypeVar("Kind", bound=type)


def travels(kind: Kind) -> Kind:
    """Let the values of a class, or its errors, be pickled and copied; read-only arrays and mappings stay so."""
    kind.__reduce__, kind.__copy__ = _reduced, _copied  # type: ignore[assignment, attr-defined]
    return kind


def _reduced(value: Any) -> tuple[Any, ...]:
    return _made, (type(value), {name: _sealed(part) for name, part in _parts(value).items()})


def _copied(value: Any) -> Any:
    return _made(type(value), _parts(value))


def _parts(value: Any) -> dict[str, Any]:
    kind, args = type(value), {"args": value.args} if isinstance(value, BaseException) else {}
    kept = {k: part for k, part in vars(value).items() if not isinstance(getattr(kind, k, None), cached_property)}
    return kept | args


def _made(kind: Any, parts: dict[str, Any]) -> Any:
    value = kind.__new__(kind)
    for name, part in parts.items():
        object.__setattr__(value, name, part)
    return value


class _Sealed(NamedTuple):
    """Part that pickle would unseal, and the function that seals it again."""

    seal: Callable[[Any], Any]
    part: Any

    def __reduce__(self) -> tuple[Any, ...]:
        return self.seal, (self.part,)


def _sealed(part: Any) -> Any:
    if isinstance(part, MappingProxyType):
        return _Sealed(_mapping, {key: _sealed(each) for key, each in part.items()})
    return _Sealed(_array, part) if isinstance(part, np.ndarray) and not part.flags.writeable else part


def _mapping(part: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    return MappingProxyType(part)


def _array(part: Any) -> Any:
    part.setflags(write=False)
    return part


@dataclass(frozen=True)
class Chain:
    """One function after another; unlike a closure it travels, if they do."""

    first: Callable[..., Any]
    then: Callable[[Any], Any]

    def __call__(self, *given: Any) -> Any:
        """Return the second function of the first one's result."""
        return self.then(self.first(*given))
