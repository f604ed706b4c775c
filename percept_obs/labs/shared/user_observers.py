"""What somebody brings to a lab: an observer as equations, under a name that settings, page and copied code know."""

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


@dataclass(frozen=True, eq=False)
class OwnObserver:
    """An observer that somebody brought.

    Parameters
    ----------
    name : str
        By which settings know it, and as Python calls it.
    make : function of a form
    form : PartitionedSystem, optional
        The only one that it is made for, if it was brought ready made.
    """

    name: str
    make: Callable[..., Observer]
    form: PartitionedSystem | None = None

    @property
    def switches(self) -> tuple[str, ...]:
        """Ways in which it switches, its own first."""
        return self.make.switches if isinstance(self.make, Family) else ()

    @property
    def constant_motion(self) -> bool:
        """Whether it is known to hold for a constant motion only."""
        if isinstance(self.make, Family):
            return self.make.constant_motion
        return self.form is not None and self.make(self.form).constant_motion

    def refusal(self, form: PartitionedSystem) -> str:
        """Why there is no such observer of this form, or none that the page can run."""
        if self.form is not None and not same_system(self.form, form):
            return (
                f"it was made for {', '.join(self.form.measured)} measured on the "
                f"{self.form.view.name if self.form.view else 'system'} with the parameters "
                f"{', '.join(map(str, self.form.parameters))}; bring a function of a form instead, "
                f"def {self.name}(form)"
            )
        try:  # what somebody wrote can be asked in no other way
            made = self(form)
            kernel_for_the_page(made)
        except NotCompilable as error:
            return f"the page cannot run it: {error}"
        except ValueError as error:
            return str(error)
        return ""

    def __call__(self, form: PartitionedSystem, **options: Any) -> Observer:
        """The observer of this form; a ValueError if there is none."""
        return _made(self.make, form, tuple(options.items()), self.name)

    def for_the_page(self) -> Texts:
        """How copied code calls it, and what it must import or add."""
        return {"call": self.name if self.form is not None else f"{self.name}(form)", **origin(self.make, self.name)}


Maker = Family | OwnObserver
"""What makes observers of forms: a family of the package, or what somebody brought."""


@lru_cache(maxsize=64)
def _made(make: Callable[..., Observer], form: PartitionedSystem, options: Any, name: str) -> Observer:
    made = make(form, **dict(options))
    if not isinstance(made, Observer):
        raise ValueError(f"{name} gave {type(made).__name__} for a form; it must give an Observer")
    if not same_system(made.form, form):
        raise ValueError(f"{name} gave an observer of another form than it was given; pass that form on to Observer")
    return made


def same_system(one: PartitionedSystem, other: PartitionedSystem) -> bool:
    """Whether two forms are of the same system with the same coordinates measured, however they are written."""
    if one is other:
        return True
    if (one.x1, one.x2, one.parameters, one.coordinates) != (other.x1, other.x2, other.parameters, other.coordinates):
        return False
    return bool((one.rate - other.rate).expand().is_zero_matrix)


def origin(value: object, name: str) -> Texts:
    """From which module code can import what has this name; none if it must be added by hand."""
    module = sys.modules.get(getattr(value, "__module__", None) or "")
    there = module is not None and module.__name__ != "__main__" and getattr(module, name, None) is value
    return {"name": name, "module": module.__name__ if there and module else ""}


def brought(
    values: Sequence[Any], ours: Mapping[str, Callable[..., Observer]]
) -> tuple[list[str], dict[str, OwnObserver]]:
    """Observers that were asked for: the names of all, and those that are not the lab's, by their names.

    Parameters
    ----------
    values : sequence of names, functions of a form, or observers
    ours : mapping of names to what makes observers
        What the lab has.

    Raises
    ------
    ValueError
        If one is none of these, or two have one name.

    Examples
    --------
    >>> from percept_obs import ibo
    >>> brought(["sliding_mode", ibo], {"identifier_based": ibo})
    (['sliding_mode', 'identifier_based'], {})
    """
    names: list[str] = []
    own: dict[str, OwnObserver] = {}
    names_of = {make: name for name, make in ours.items()}
    if isinstance(values, str) or not isinstance(values, Sequence):
        raise ValueError(f"observers is {values!r}; it must be a list of names, functions of a form, or observers")
    for value in values:
        if isinstance(value, str) or (callable(value) and value in names_of):
            names.append(value if isinstance(value, str) else names_of[value])
            continue
        if isinstance(value, Observer):
            name = free(value.name, {*ours, *own}, "my_observer")
            own[name] = OwnObserver(name, lambda form, observer=value: observer, value.form)
        elif callable(value):
            name = named(getattr(value, "__name__", ""), "my_observer")
            if name in ours or name in own:
                raise ValueError(f"there is an observer {name} already; give yours another name")
            own[name] = OwnObserver(name, value)
        else:
            raise ValueError(f"{value!r} is no observer; bring its name, a function of a form, or an Observer")
        names.append(name)
    return names, own


def of_an_observer(make: Maker, ways: Mapping[str, Observer]) -> Texts:
    """What is known about an observer, with its equations: for any w, phi and g, or else as they are in `ways`."""
    if make in IN_MATRICES or not make.refusal(abstract_form()):
        return observer_for_the_page(
            ways, {way: equations_of(make, **({"switch": way} if way else {})) for way in ways}
        )
    return observer_for_the_page(ways, {way: equations_in_scalars(observer) for way, observer in ways.items()})


def observers_for_the_page(form: PartitionedSystem, makers: Mapping[str, Maker]) -> Texts:
    """The loops of a form's observers, and why it has no others."""
    kernels: dict[str, Texts] = {}
    refused: dict[str, str] = {}
    for name, make in makers.items():
        if refusal := make.refusal(form):
            refused[name] = refusal
        else:
            ways = make.switches or ("",)
            made = {way: make(form, **({"switch": way} if way else {})) for way in ways}
            kernels[name] = {way: kernel_for_the_page(observer) for way, observer in made.items()}
    return {"observers": kernels, "refused": refused}


def named(text: str, otherwise: str) -> str:
    """A name of Python's made of a text."""
    found = re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_").lower()
    return found if found.isidentifier() and not keyword.iskeyword(found) else otherwise


def free(text: str, taken: Collection[str], otherwise: str) -> str:
    """A name made of a text that is none of those taken."""
    name = named(text, otherwise)
    return name if name not in taken else free(f"my_{name}", taken, otherwise)
