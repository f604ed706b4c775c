"""Results of settings, kept by the settings that were read to make them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

from percept_obs.labs.shared.schema import Settings

F = TypeVar("F", bound=Callable[..., Any])

KEPT = 4
"""Number of results that are kept of a function."""


class _Noted(dict[str, Any]):
    """Settings that note the names of those that are read."""

    def __init__(self, settings: Settings) -> None:
        super().__init__(settings)
        self.names: set[str] = set()

    def __getitem__(self, name: str) -> Any:
        self.names.add(name)
        return super().__getitem__(name)


def kept_by_reads(function: F) -> F:
    """Keep the last results of a function of settings and other arguments, so that no setting is forgotten in a key.

    A result is used again where the settings that it read have the same values, and the other arguments are the same
    objects.

    >>> made = kept_by_reads(lambda settings: [settings["a"]])
    >>> first = made({"a": 1, "b": 2})
    >>> made({"a": 1, "b": 3}) is first, made({"a": 2, "b": 2}) is first
    (True, False)
    """
    kept: deque[tuple[_Noted, tuple[Any, ...], Any]] = deque(maxlen=KEPT)

    @wraps(function)
    def call(settings: Settings, *others: Any) -> Any:
        for noted, inputs, value in kept:
            alike = all(one is other for one, other in zip(inputs, others, strict=True))
            # What is read is read of the settings that came, so that who notes their reads notes these.
            if alike and all(settings[name] == dict.__getitem__(noted, name) for name in noted.names):
                return value
        noted = _Noted(settings)
        value = function(noted, *others)
        if isinstance(settings, _Noted):
            settings.names |= noted.names
        kept.append((noted, others, value))
        return value

    return cast(F, call)
