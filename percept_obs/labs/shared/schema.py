"""Schema of a lab's settings: Python checks with it, the page reads it, the docstring lists it.

A kind reads a value as plain data, or raises a ValueError with the setting's name and what is expected.
"""

from __future__ import annotations

import reprlib
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field, fields
from numbers import Real
from operator import itemgetter
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.observers import Observer
from percept_obs.validation import plain
from percept_obs.validation.plain import in_order, labels

Settings = dict[str, Any]

UNREAD = ("opening", "about", "reason", "partial", "longest", "observer")
"""Fields of a kind of setting that only Python reads; the page is not sent them."""


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A kind of setting."""

    opening: Any = None  # the value to open with
    label: str = ""  # the page's words for it
    unit: str = ""
    about: str = ""  # its meaning, for the docstring of the lab
    topic: str = ""  # the group of the drawer that shows it, unless the lab's panel places it itself

    @property
    def expected(self) -> str:
        """Description of the values that are allowed."""
        return self._expected()

    def read(self, name: str, value: object) -> Any:
        """The value as plain data, or a ValueError that says what is expected of the setting with this name."""
        if not in_order(names := labels(value)):
            raise ValueError(f"{name} has the labels {', '.join(names)}; give a list, in the order of {self.expected}")
        value = value if isinstance(value, list | tuple) else plain(value)  # None in a list is a choice
        value = value.tolist() if isinstance(value, np.ndarray | np.generic) else value
        if not self._allows(value):
            raise ValueError(f"{name} is {reprlib.repr(value)}; it must be {self.expected}")
        return self._read(name, value)

    def for_the_page(self) -> Settings:
        """Plain data: the kind's name, and what the page reads of its fields that say something."""
        plain = {field.name: _plain(getattr(self, field.name)) for field in fields(self) if field.name not in UNREAD}
        said = {name: value for name, value in plain.items() if not (value is None or value is False or value == "")}
        return {"kind": type(self).__name__.lower(), **said}

    def _expected(self) -> str:
        raise NotImplementedError

    def _allows(self, value: Any) -> bool:
        raise NotImplementedError

    def _read(self, name: str, value: Any) -> Any:
        return value


@dataclass(frozen=True)
class Number(Kind):
    """A number that opens with a value and may be anything from `low` to `high`."""

    opening: float = 0.0
    low: float = -1e3
    high: float = 1e3
    usual: tuple[float, float] | None = None  # the part of the range that a slider has
    step: float | None = None  # a slider's; it is logarithmic without one
    whole: bool = False
    nonzero: bool = False
    reason: str = ""  # for a bound, in the error message

    def _expected(self) -> str:
        kind = "a whole number" if self.whole else "a number"
        bounds = [f"{bound:g}" if bound < 1e6 else str(bound) for bound in (self.low, self.high)]
        more = f"{', not 0' if self.nonzero else ''}{self.reason and f'; {self.reason}'}"
        return f"{kind} from {' to '.join(bounds)}{more}"

    def _allows(self, value: Any) -> bool:
        if not isinstance(value, Real) or isinstance(value, bool) or not self.low <= float(value) <= self.high:
            return False
        return not (self.whole and float(value) % 1) and not (self.nonzero and value == 0)

    def _read(self, name: str, value: Any) -> float:
        return int(value) if self.whole else float(value) + 0.0  # no -0.0


@dataclass(frozen=True)
class Choice(Kind):
    """One of several names; `reason` says why there are no others."""

    opening: str = ""
    names: Sequence[str] = ()
    reason: str = ""

    def _expected(self) -> str:
        return f"one of {', '.join(self.names)}{self.reason and f'; {self.reason}'}"

    def _allows(self, value: Any) -> bool:
        return isinstance(value, str) and value in self.names


@dataclass(frozen=True)
class Names(Kind):
    """Distinct names out of several, at least `least`."""

    opening: Sequence[str] = ()
    names: Sequence[str] = ()
    least: int = 1

    def read(self, name: str, value: object) -> Any:
        """The names as a list; one of them, or symbols, mean theirs."""
        value = [value] if isinstance(value, str | sp.Symbol) else value
        return super().read(name, list(map(str, value)) if isinstance(value, list | tuple) else value)

    def _expected(self) -> str:
        return f"a list with {'at least one' if self.least else 'some'} of {', '.join(self.names)}, each once"

    def _allows(self, value: Any) -> bool:
        if not isinstance(value, list | tuple) or not all(isinstance(v, str) and v in self.names for v in value):
            return False
        return self.least <= len(value) == len(set(value))

    def _read(self, name: str, value: Any) -> list[str]:
        return list(value)


@dataclass(frozen=True)
class Text(Kind):
    """A text of at most `most` characters, which is never run."""

    opening: str = ""
    most: int = 100

    def _expected(self) -> str:
        return f"a text of at most {self.most} characters"

    def _allows(self, value: Any) -> bool:
        return isinstance(value, str) and len(value) <= self.most


@dataclass(frozen=True)
class Flag(Kind):
    """Yes or no."""

    opening: bool = False

    def _expected(self) -> str:
        return "True or False"

    def _allows(self, value: Any) -> bool:
        return isinstance(value, bool)


@dataclass(frozen=True)
class Row(Kind):
    """A list with an entry of each kind: a vector, or a matrix as a row of rows."""

    entries: Sequence[Kind]

    def __post_init__(self) -> None:
        object.__setattr__(self, "opening", [entry.opening for entry in self.entries])

    def _expected(self) -> str:
        kinds = list(dict.fromkeys(entry.expected for entry in self.entries))
        return f"a list of {len(self.entries)}, {f'each {kinds[0]}' if len(kinds) == 1 else '; '.join(kinds)}"

    def _allows(self, value: Any) -> bool:
        return isinstance(value, list | tuple) and len(value) == len(self.entries)

    def _read(self, name: str, value: Any) -> list[Any]:
        if all(isinstance(entry, list | tuple) and len(entry) == 1 for entry in value):  # a column
            value = [entry[0] for entry in value]
        entries = enumerate(zip(self.entries, value, strict=True), 1)
        return [kind.read(f"{name} {kind.label or k}", entry) for k, (kind, entry) in entries]


@dataclass(frozen=True)
class Several(Kind):
    """A list of one to `most` entries of one kind."""

    opening: Sequence[Any] = ()
    of: Kind = field(default_factory=Number)
    most: int = 1

    def _expected(self) -> str:
        return f"a list of 1 to {self.most}, each {self.of.expected}"

    def _allows(self, value: Any) -> bool:
        return isinstance(value, list | tuple) and 1 <= len(value) <= self.most

    def _read(self, name: str, value: Any) -> list[Any]:
        return [self.of.read(f"{name} {k}", entry) for k, entry in enumerate(value, 1)]


@dataclass(frozen=True)
class Group(Kind):
    """Settings by their names; where it is `partial`, those that are left out stay as they open."""

    of: Mapping[str, Kind]
    partial: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "opening", {name: kind.opening for name, kind in self.of.items()})

    def _expected(self) -> str:
        return f"a mapping of {', '.join(self.of)}"

    def _allows(self, value: Any) -> bool:
        return isinstance(value, Mapping)

    def _read(self, name: str, value: Any) -> Settings:
        unknown = ", ".join(sorted(str(key) for key in value if key not in self.of))
        if unknown:
            raise ValueError(f"{name} has no {unknown}; there are {', '.join(self.of)}")
        left = self.opening if self.partial else {}
        return {key: kind.read(f"{name} {key}", value.get(key, left.get(key))) for key, kind in self.of.items()}


@dataclass(frozen=True)
class Entries(Kind):
    """Values of one kind under at most `most` names of any kind."""

    of: Kind
    most: int = 1
    longest: int = 100

    def __post_init__(self) -> None:
        object.__setattr__(self, "opening", {})

    def _expected(self) -> str:
        return f"a mapping of at most {self.most} names, each to {self.of.expected}"

    def _allows(self, value: Any) -> bool:
        if not isinstance(value, Mapping) or len(value) > self.most:
            return False
        return all(isinstance(name, str) and len(name) <= self.longest for name in value)

    def _read(self, name: str, value: Any) -> Settings:
        return {key: self.of.read(f"{name} {reprlib.repr(key)}", entry) for key, entry in value.items()}


@dataclass(frozen=True, kw_only=True)
class GainsOf(Group):
    """Gains of an observer, which checks them; it is made only for gains other than its own."""

    observer: Callable[[], Observer]

    def _read(self, name: str, value: Any) -> Settings:
        found = super()._read(name, value)
        if found != self.opening:
            self.observer().with_gains(**found)
        return found


@dataclass(frozen=True)
class Optional(Kind):
    """None, or a value of another kind."""

    of: Kind

    def _expected(self) -> str:
        return f"None or {self.of.expected}"

    def read(self, name: str, value: object) -> Any:
        """None, or a value of the other kind."""
        return None if value is None else self.of.read(name, value)


@dataclass(frozen=True)
class Whole(Kind):
    """Settings of the same lab, which the lab reads."""

    def _expected(self) -> str:
        return "a mapping of settings"

    def _allows(self, value: Any) -> bool:
        return isinstance(value, Mapping)

    def _read(self, name: str, value: Any) -> Settings:
        return dict(value)


class Schema(dict[str, Kind]):
    """The settings of a lab: a kind for each, by its name."""

    @property
    def opening(self) -> Settings:
        """Settings to open with."""
        return deepcopy({name: kind.opening for name, kind in self.items()})

    def read(self, settings: object, opening: Settings) -> Settings:
        """Settings as plain data, completed by the opening ones; a ValueError if one is unknown or not of its kind."""
        if not isinstance(settings, Mapping):
            raise ValueError(f"settings are {reprlib.repr(settings)}; they must be a mapping of {', '.join(self)}")
        unknown = ", ".join(sorted(str(name) for name in settings if name not in self))
        if unknown:
            raise ValueError(f"there is no setting {unknown}; there are {', '.join(self)}")
        return {name: kind.read(name, settings.get(name, opening[name])) for name, kind in self.items()}

    def for_the_page(self) -> Settings:
        """The kinds as plain data."""
        return {name: kind.for_the_page() for name, kind in self.items()}

    def listed(self) -> str:
        """A line for each setting, for a docstring."""
        about = {name: kind.about or kind.label or kind.expected for name, kind in self.items()}
        units = {name: f", in {kind.unit}" if kind.unit else "" for name, kind in self.items()}
        return "\n".join(f"{name} : {about[name]}{units[name]}" for name in self)


def only(name: str, *values: str) -> Callable[[Settings], str]:
    """Return the reason of a setting that does something with some values of another one only."""
    named = " or ".join(map(repr, values))
    return lambda whole: "" if whole[name] in values else f"{name} is {whole[name]!r}, not {named}"


def in_run(seconds: Callable[[Settings], float] = itemgetter("window")) -> Callable[[Settings], str]:
    """Return the reason of a setting that does something for no more seconds than the run has."""
    return lambda whole: f"duration is {whole['duration']:g}" if seconds(whole) > whole["duration"] else ""


def vector(entries: Sequence[str], about: str = "", unit: str = "", **kind: Any) -> Row:
    """A row of numbers of one kind, with their labels; it opens with zeros."""
    return Row([Number(label=label, unit=unit, **kind) for label in entries], about=about, unit=unit)


def _plain(value: object) -> Any:
    if isinstance(value, Kind):
        return value.for_the_page()
    if isinstance(value, Mapping):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    return value
