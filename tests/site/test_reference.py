"""Every public name is complete by numpydoc's validation, and what docstrings refer to and raise exists."""

import builtins
import inspect
from importlib import import_module
from pydoc import locate

import pytest
from numpydoc.docscrape import NumpyDocString
from numpydoc.validate import validate

import percept_obs
from percept_obs.site.pages import public

EXCEPT = {"ES01": "one sentence may say all"}
"""Checks of numpydoc that are left out, each with the reason."""

PLACES = {f"{module}.{names[0]}": value for module, values in public().items() for names, value in values}
MEMBERS = {f"{place}.{name}" for place, value in PLACES.items() if inspect.isclass(value) for name in dir(value)}
"""Attributes and methods that the reference shows besides, by their address."""
MADE = ("CanonicalForm", "PartitionedSystem", "Review")
"""Classes whose parts the package makes, so that nothing is refused before a method is called."""


def sections_of(value):
    """Sections of a docstring, by their titles."""
    return NumpyDocString(inspect.getdoc(value) or "")


def raised(value, section):
    """Errors or warnings that a docstring names; None for one that there is not."""
    known = {place.rpartition(".")[2]: each for place, each in PLACES.items()}
    known |= vars(builtins) | vars(import_module(value.__module__))
    return [known.get(name, locate(name)) for entry in sections_of(value)[section] for name in entry.type.split(", ")]


def takes_arguments(name):
    value = getattr(percept_obs, name)
    is_error = inspect.isclass(value) and issubclass(value, Exception)
    return callable(value) and not is_error and bool(inspect.signature(value).parameters)


@pytest.mark.parametrize("name", percept_obs.__all__)
def test_a_public_name_is_complete(name):
    errors = validate(f"percept_obs.{name}")["errors"]
    assert [error for error in errors if error[0] not in EXCEPT] == []


@pytest.mark.parametrize("name", [name for name in percept_obs.__all__ if takes_arguments(name)])
def test_what_a_wrong_argument_raises_is_written(name):
    value = getattr(percept_obs, name)
    errors = raised(value, "Raises")
    assert errors
    if name not in MADE:
        with pytest.raises(tuple(errors)):
            value(**dict.fromkeys(inspect.signature(value).parameters, object()))


def test_errors_and_warnings_that_are_named_exist():
    for value in filter(callable, PLACES.values()):
        for section, kind in (("Raises", Exception), ("Warns", Warning)):
            assert all(inspect.isclass(each) and issubclass(each, kind) for each in raised(value, section)), value


def test_what_is_to_be_seen_also_has_a_place_in_the_reference():
    for place, value in PLACES.items():
        for name in (name for names, _ in sections_of(value)["See Also"] for name, _ in names):
            addresses = {name, f"{place.rpartition('.')[0]}.{name}", f"percept_obs.{name}"}
            assert addresses & (PLACES.keys() | MEMBERS), f"{place} refers to {name}"
