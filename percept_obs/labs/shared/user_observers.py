"""Observers of a user in a lab, with the texts that the page needs to run, show and copy them."""

from __future__ import annotations

import keyword
import re
import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from percept_obs.compile import NotCompilable
from percept_obs.labs.shared.equations import IN_MATRICES, abstract_form, equations_in_scalars, equations_of
from percept_obs.labs.shared.observer_texts import kernel_for_the_page, observer_for_the_page
from percept_obs.labs.shared.printed import Texts
from percept_obs.observers import Observer
from percept_obs.observers.family import Family
from percept_obs.system.forms import PartitionedSystem
from percept_obs.tracking.function import NOT_IN_THE_PAGE, FunctionObserver
from percept_obs.validation.arguments import described


@dataclass(frozen=True, eq=False)
class UserObserver:
    """An observer of a user, with the interface of `Family`."""

    name: str  # in settings and in Python
    make: Callable[..., Observer]  # of a form
    form: PartitionedSystem | None = None  # the only one that it fits, if it was given as an `Observer`

    @property
    def switches(self) -> tuple[str, ...]:
        """Names of its switches, its own first."""
        return self.make.switches if isinstance(self.make, Family) else ()

    @property
    def constant_motion(self) -> bool:
        """Return True if it is known to need a constant motion."""
        if isinstance(self.make, Family):
            return self.make.constant_motion
        return self.form is not None and self.make(self.form).constant_motion

    def refusal(self, form: PartitionedSystem) -> str:
        """Reason why it does not fit a form, or why the page cannot run it; empty if there is none."""
        if self.form is not None and not same_system(self.form, form):
            return (
                f"it was made for {', '.join(self.form.measured)} measured on the "
                f"{self.form.view.name if self.form.view else 'system'} with the parameters "
                f"{', '.join(map(str, self.form.parameters))}; bring a function of a form instead, "
                f"def {self.name}(form)"
            )
        try:  # a user's function can be asked in no other way
            kernel_for_the_page(self(form))
        except NotCompilable as error:
            return f"the page cannot run it: {error}"
        except ValueError as error:
            return str(error)
        return ""

    def __call__(self, form: PartitionedSystem, **options: Any) -> Observer:
        """The observer of a form; a ValueError if there is none."""
        return _made(self.make, form, tuple(options.items()), self.name)

    def for_the_page(self) -> Texts:
        """Its call in copied code, and its import."""
        return {"call": self.name if self.form is not None else f"{self.name}(form)", **origin(self.make, self.name)}


Maker = Family | UserObserver
"""A function of forms that gives observers."""


@lru_cache(maxsize=64)
def _made(make: Callable[..., Observer], form: PartitionedSystem, options: Any, name: str) -> Observer:
    try:
        made = make(form, **dict(options))
    except ValueError:
        raise
    except Exception as error:
        seen = f"{', '.join(form.measured)} measured on the {form.view.name if form.view else 'system'}"
        raise ValueError(f"{name} fails for {seen}: {type(error).__name__}: {error}") from error
    if not isinstance(made, Observer):
        raise ValueError(f"{name} gave {type(made).__name__} for a form; it must give an Observer")
    if not same_system(made.form, form):
        raise ValueError(f"{name} gave an observer of another form than it was given; pass that form on to Observer")
    return made


def same_system(one: PartitionedSystem, other: PartitionedSystem) -> bool:
    """Return True if two forms are of one system with the same measured coordinates, however they are written."""
    if one is other:
        return True
    if (one.x1, one.x2, one.parameters, one.coordinates) != (other.x1, other.x2, other.parameters, other.coordinates):
        return False
    return bool((one.rate - other.rate).expand().is_zero_matrix)


def origin(value: object, name: str) -> Texts:
    """The module that has a value under this name; an empty one if copied code cannot import it."""
    module = sys.modules.get(getattr(value, "__module__", None) or "")
    there = module is not None and module.__name__ != "__main__" and getattr(module, name, None) is value
    return {"name": name, "module": module.__name__ if there and module else ""}


def read_observers(values: Sequence[Any], known: Mapping[str, Any]) -> tuple[list[str], dict[str, UserObserver]]:
    """Names of the observers that a lab is to open with, and those of the user by their names.

    Values are names, functions of a form, or observers; `known` are the lab's own.

    >>> from percept_obs import ibo
    >>> read_observers(["sliding_mode", ibo], {"identifier_based": ibo})
    (['sliding_mode', 'identifier_based'], {})
    """
    if isinstance(values, str) or not isinstance(values, Sequence):
        raise ValueError(
            f"observers is {described(values)}; it must be a list of names, functions of a form, or observers"
        )
    names: list[str] = []
    users: dict[str, UserObserver] = {}
    name_of = {make: name for name, make in known.items()}
    for value in values:
        if isinstance(value, FunctionObserver):
            raise ValueError(NOT_IN_THE_PAGE.format(value.name))
        if isinstance(value, Observer):
            name = free_name(value.name, {*known, *users}, "my_observer")
            users[name] = UserObserver(name, lambda form, observer=value: observer, value.form)
        elif isinstance(value, str) or (callable(value) and value in name_of):
            name = value if isinstance(value, str) else name_of[value]
        elif callable(value):
            name = identifier(getattr(value, "__name__", ""), "my_observer")
            if name in known or name in users:
                raise ValueError(f"there is an observer {name} already; give yours another name")
            users[name] = UserObserver(name, value)
        else:
            raise ValueError(f"{described(value)} is no observer; bring its name, a function of a form, or an Observer")
        names.append(name)
    return names, users


def texts_of_observer(make: Maker, ways: Mapping[str, Observer]) -> Texts:
    """An observer's facts and equations: for any w, phi and g, or else those of the observers in `ways`."""
    if make in IN_MATRICES or not make.refusal(abstract_form()):
        return observer_for_the_page(ways, {way: equations_of(make, **_switch(way)) for way in ways})
    return observer_for_the_page(ways, {way: equations_in_scalars(observer) for way, observer in ways.items()})


def loops_for_the_page(form: PartitionedSystem, makers: Mapping[str, Maker]) -> Texts:
    """The loops of a form's observers, and the reasons why it has no others."""
    refused = {name: reason for name, make in makers.items() if (reason := make.refusal(form))}
    loops = {
        name: {way: kernel_for_the_page(make(form, **_switch(way))) for way in make.switches or ("",)}
        for name, make in makers.items()
        if name not in refused
    }
    return {"observers": loops, "refused": refused}


def _switch(way: str) -> dict[str, str]:
    return {"switch": way} if way else {}


def identifier(text: str, default: str) -> str:
    """A Python name made of a text, or the default."""
    found = re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_").lower()
    return found if found.isidentifier() and not keyword.iskeyword(found) else default


def free_name(text: str, taken: Collection[str], default: str) -> str:
    """A Python name made of a text that is not taken."""
    name = identifier(text, default)
    return name if name not in taken else free_name(f"my_{name}", taken, default)
