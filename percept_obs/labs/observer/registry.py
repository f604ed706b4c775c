"""Surfaces and observers of an observer lab: those of the package, and those of the user."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Any

import sympy as sp

from percept_obs.labs.observer.texts import (
    BY_NAME,
    MOTION,
    form_for_the_page,
    form_on,
    key_of,
    observer_on,
    surface_for_the_page,
)
from percept_obs.labs.shared.printed import Parts, Texts, part, with_texts
from percept_obs.labs.shared.surfaces import SURFACES
from percept_obs.labs.shared.user_observers import (
    Maker,
    UserObserver,
    free_name,
    loops_for_the_page,
    origin,
    texts_of_observer,
)
from percept_obs.observers import Observer
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.surfaces import ImagingSurface

LAB = "observer_lab"
FALLBACK = "identifier_based"
"""The observer that takes the place of those that are refused."""


@dataclass(frozen=True, eq=False)
class Registry:
    """Surfaces and observers by their names."""

    user_surfaces: Mapping[str, ImagingSurface]  # with numbers
    user_observers: Mapping[str, UserObserver]
    asked: tuple[str, ...]  # the package's observers that are printed on the user's surfaces; all take many seconds
    origins: Mapping[str, Texts]  # imports of the user's surfaces in copied code

    @cached_property
    def surfaces(self) -> dict[str, ImagingSurface]:
        """All imaging surfaces by their names."""
        return {name: make() for name, make in SURFACES.items()} | dict(self.user_surfaces)

    @cached_property
    def observers(self) -> dict[str, Maker]:
        """All functions of forms that give observers, by their names."""
        return {**BY_NAME, **self.user_observers}

    def outputs(self, surface: str) -> list[list[str]]:
        """Choices of outputs on a surface; on a user's surface also those without a canonical form."""
        if surface not in self.user_surfaces:
            return [list(names) for names in part(LAB)["surfaces"][surface]["outputs"]]
        names = [s.name for s in self.surfaces[surface].image_coordinates]
        return [list(chosen) for count in range(len(names), 0, -1) for chosen in combinations(names, count)]

    def form(self, surface: str, outputs: Iterable[str]) -> PartitionedSystem:
        """The form of affine motion on a surface."""
        return form_on(self.surfaces[surface], tuple(outputs))

    def observer(self, surface: str, outputs: Iterable[str], name: str, way: str = "") -> Observer:
        """An observer with its default gains."""
        return observer_on(self.observers[name], self.surfaces[surface], tuple(outputs), way)

    def examples(self, name: str) -> dict[str, Observer]:
        """An observer with each of its switches, of the first form that it fits."""
        make = self.observers[name]
        surfaces = [*self.user_surfaces, *SURFACES]
        places = [(surface, outputs) for surface in surfaces for outputs in self.outputs(surface)]
        for surface, outputs in places:
            if not make.refusal(self.form(surface, outputs)):
                return {way: self.observer(surface, outputs, name, way) for way in make.switches or ("",)}
        raise ValueError(f"{name} cannot be used in this lab: {make.refusal(self.form(*places[0]))}")

    def refused(self, surface: str, outputs: Iterable[str]) -> dict[str, str]:
        """Observers that a form does not have, with the reasons."""
        return dict(self.part(f"forms/{key_of(surface, outputs)}")["refused"])

    def part(self, place: str = "") -> Texts:
        """Printed texts at a place."""
        return self._added[place] if place in self._added else part(LAB, place)

    @cached_property
    def packed(self) -> bytes:
        """All texts of the page, compressed."""
        return with_texts(LAB, self._added)

    def for_the_page(self) -> Texts:
        """Calls and imports of the user's observers and surfaces in copied code."""
        return {name: make.for_the_page() for name, make in self.user_observers.items()} | dict(self.origins)

    @cached_property
    def _added(self) -> dict[str, Texts]:
        """Texts as they come back from JSON, so that they have the page's types."""
        return {place: json.loads(json.dumps(texts)) for place, texts in self._print()}

    def _print(self) -> Parts:
        """Texts of the user's surfaces and observers, in the places of the package's."""
        if not (self.user_surfaces or self.user_observers):
            return
        model = part(LAB)
        surfaces = {n: surface_for_the_page(s, map(tuple, self.outputs(n))) for n, s in self.user_surfaces.items()}
        observers = {n: texts_of_observer(make, self.examples(n)) for n, make in self.user_observers.items()}
        added = {"surfaces": model["surfaces"] | surfaces, "observers": model["observers"] | observers}
        yield "", model | added
        for surface in self.surfaces:
            for outputs in self.outputs(surface):
                place = f"forms/{key_of(surface, outputs)}"
                form = self.form(surface, outputs)
                if surface in self.user_surfaces:
                    yield place, self._on_user_surface(form)
                elif self.user_observers:
                    printed, loops = part(LAB, place), loops_for_the_page(form, self.user_observers)
                    yield place, {**printed, **{name: printed[name] | loops[name] for name in loops}}

    def _on_user_surface(self, form: PartitionedSystem) -> Texts:
        wanted = {n: make for n, make in self.observers.items() if n in (*self.asked, FALLBACK, *self.user_observers)}
        texts = form_for_the_page(form, wanted)
        for name in [name for name in BY_NAME if name not in wanted]:
            texts["refused"][name] = BY_NAME[name].refusal(form) or (
                f"on a surface of your own it is printed when the lab opens; open it with observers=[..., {name!r}]"
            )
        return texts


def registry_of(
    surfaces: Sequence[Any], observers: Mapping[str, UserObserver], asked: Sequence[str]
) -> tuple[Registry, list[str]]:
    """The registry of a lab with a user's surfaces and observers, and the names of these surfaces.

    A surface may be a function that gives one; `asked` are the names of the observers that the lab opens with.
    """
    found: dict[str, ImagingSurface] = {}
    origins: dict[str, Texts] = {}
    names = []
    for given in surfaces:
        surface = given() if callable(given) else given
        if not isinstance(surface, ImagingSurface):
            raise ValueError(f"the surface is {given!r}; bring an ImagingSurface, or a function that gives one")
        same = [n for n, make in SURFACES.items() if _formulas(make()) == _formulas(surface)]
        same = same or [n for n, other in found.items() if other == with_numbers(surface)]
        if same:
            names.append(same[0])
            continue
        called = getattr(given, "__name__", surface.name) if callable(given) else surface.name
        name = free_name(called, {*SURFACES, *found, *observers}, "my_surface")
        found[name] = with_numbers(surface)
        origins[name] = {"call": f"{name}()" if callable(given) else name, **origin(given, name)}
        names.append(name)
    return Registry(found, observers, tuple(asked), origins), names


def _formulas(surface: ImagingSurface) -> tuple[Any, ...]:
    return surface.image, surface.distance, surface.ray


def with_numbers(surface: ImagingSurface) -> ImagingSurface:
    """The surface with numbers for its symbols; a ValueError if the lab cannot show it."""
    if len(surface.image) != 2:
        raise ValueError(
            f"the surface {surface.name!r} has {len(surface.image)} image coordinates; the lab draws images with two, "
            "y1 and y2"
        )
    missing = [str(s) for s in surface.parameters if s not in surface.values]
    if missing:
        raise ValueError(f"the surface {surface.name!r} has no values for {', '.join(missing)}; give it values=")
    numbers = {symbol: sp.Float(value, 17) for symbol, value in surface.values.items()}
    image, ray = (tuple(e.xreplace(numbers) for e in vector) for vector in (surface.image, surface.ray))
    return replace(surface, image=image, distance=surface.distance.xreplace(numbers), ray=ray, values={})


def refuse_other_motion(observers: Mapping[str, UserObserver]) -> None:
    """Raise a ValueError for an observer that was made for another motion than the lab's."""
    for name, make in observers.items():
        if make.form is not None and make.form.parameters[:12] != MOTION.parameters:
            raise ValueError(
                f"{name} was made for a form with the parameters {', '.join(map(str, make.form.parameters))}; the lab "
                "moves points by affine(), so make it for PerspectiveSystem(affine(), surface)"
            )


def view_of(observers: Mapping[str, UserObserver]) -> tuple[ImagingSurface, list[str]] | None:
    """The surface and the outputs of the first observer that was made for a form, if there is one."""
    for make in observers.values():
        if make.form is not None and isinstance(make.form.view, ImagingSurface):
            return make.form.view, list(make.form.measured)
    return None
