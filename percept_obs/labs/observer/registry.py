"""What one observer lab offers: surfaces and observers of the package, and those that somebody brings to it."""

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
from percept_obs.labs.shared.observer_texts import with_all_gains
from percept_obs.labs.shared.printed import Parts, Texts, part, with_texts
from percept_obs.labs.shared.surfaces import SURFACES
from percept_obs.labs.shared.user_observers import (
    Maker,
    OwnObserver,
    free,
    observers_for_the_page,
    of_an_observer,
    origin,
)
from percept_obs.observers import Observer
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.surfaces import ImagingSurface

LAB = "observer_lab"
EVERYWHERE = "identifier_based"
"""The observer that takes the place of those that are refused."""


@dataclass(frozen=True, eq=False)
class Offer:
    """Surfaces and observers by their names.

    Parameters
    ----------
    own_surfaces : mapping of names to imaging surfaces with numbers
    own_observers : mapping of names to observers
    asked : names of observers
        Of the package's observers only these are printed on own surfaces, for all of them take many seconds.
    added : mapping of names to texts
        Where copied code finds the own surfaces.
    """

    own_surfaces: Mapping[str, ImagingSurface]
    own_observers: Mapping[str, OwnObserver]
    asked: tuple[str, ...]
    added: Mapping[str, Texts]

    @property
    def brought(self) -> bool:
        """Whether there is anything that is not the package's."""
        return bool(self.own_surfaces or self.own_observers)

    @cached_property
    def surfaces(self) -> dict[str, ImagingSurface]:
        """All imaging surfaces by their names."""
        return {name: make() for name, make in SURFACES.items()} | dict(self.own_surfaces)

    @cached_property
    def observers(self) -> dict[str, Maker]:
        """All that makes observers, by their names."""
        return {**BY_NAME, **self.own_observers}

    @cached_property
    def own_switch(self) -> dict[str, str]:
        """The switch that each observer that switches has unless another is chosen."""
        return {name: make.switches[0] for name, make in self.observers.items() if make.switches}

    def outputs(self, surface: str) -> list[list[str]]:
        """What may be measured on a surface; of an own one also what gives no canonical form."""
        if surface not in self.own_surfaces:
            return [list(names) for names in part(LAB)["surfaces"][surface]["outputs"]]
        names = [s.name for s in self.surfaces[surface].image_coordinates]
        return [list(chosen) for count in range(len(names), 0, -1) for chosen in combinations(names, count)]

    def form(self, surface: str, outputs: Iterable[str]) -> PartitionedSystem:
        """The form of affine motion on a surface."""
        return form_on(self.surfaces[surface], tuple(outputs))

    def observer(self, surface: str, outputs: Iterable[str], name: str, way: str = "") -> Observer:
        """An observer with its default gains."""
        return observer_on(self.observers[name], self.surfaces[surface], tuple(outputs), way)

    def with_every_gain(self, name: str) -> Observer:
        """The observer that has the gains of every way in which it switches."""
        return with_all_gains(self.examples(name))

    def examples(self, name: str) -> dict[str, Observer]:
        """An observer in every way in which it switches, of the first form that it has."""
        make = self.observers[name]
        places = [(surface, tuple(outputs)) for surface in self._own_first() for outputs in self.outputs(surface)]
        for surface, outputs in places:
            if not make.refusal(self.form(surface, outputs)):
                return {way: self.observer(surface, outputs, name, way) for way in make.switches or ("",)}
        surface, outputs = places[0]
        raise ValueError(f"{name} cannot be used in this lab: {make.refusal(self.form(surface, outputs))}")

    def refused(self, surface: str, outputs: Iterable[str]) -> dict[str, str]:
        """Observers that a form does not have, with the reasons."""
        return dict(self.part(f"forms/{key_of(surface, outputs)}")["refused"])

    def part(self, place: str = "") -> Texts:
        """What is printed at a place."""
        return self._added[place] if place in self._added else part(LAB, place)

    @cached_property
    def packed(self) -> bytes:
        """All texts of the page, compressed."""
        return with_texts(LAB, self._added)

    def for_the_page(self) -> Texts:
        """How copied code names what was brought."""
        return {name: make.for_the_page() for name, make in self.own_observers.items()} | dict(self.added)

    @cached_property
    def _added(self) -> dict[str, Texts]:
        """As it comes back from JSON, so that it is of the kinds that the page has."""
        return {place: json.loads(json.dumps(texts)) for place, texts in self._printed_now()}

    def _own_first(self) -> list[str]:
        return [*self.own_surfaces, *SURFACES]

    def _printed_now(self) -> Parts:
        """The texts of what was brought: its own, and the package's with it."""
        if not self.brought:
            return
        model = part(LAB)
        surfaces = {n: surface_for_the_page(s, map(tuple, self.outputs(n))) for n, s in self.own_surfaces.items()}
        observers = {name: of_an_observer(make, self.examples(name)) for name, make in self.own_observers.items()}
        yield (
            "",
            model
            | {
                "surfaces": model["surfaces"] | surfaces,
                "observers": model["observers"] | observers,
            },
        )
        for surface in self.surfaces:
            for outputs in self.outputs(surface):
                place = f"forms/{key_of(surface, outputs)}"
                form = self.form(surface, outputs)
                if surface in self.own_surfaces:
                    yield place, self._of_own_surface(form)
                elif self.own_observers:
                    yield place, _joined(part(LAB, place), observers_for_the_page(form, self.own_observers))

    def _of_own_surface(self, form: PartitionedSystem) -> Texts:
        wanted = {name: make for name, make in self.observers.items() if name in (*self.asked, EVERYWHERE)}
        wanted |= self.own_observers
        left = {name: make for name, make in BY_NAME.items() if name not in wanted}
        told = form_for_the_page(form, wanted)
        for name, make in left.items():
            told["refused"][name] = make.refusal(form) or (
                f"on a surface of your own it is printed when the lab opens; open it with observers=[..., {name!r}]"
            )
        return told


def _joined(printed: Texts, added: Texts) -> Texts:
    return {**printed, **{name: {**printed[name], **added[name]} for name in ("observers", "refused")}}


def offer_of(surfaces: Sequence[Any], own: Mapping[str, OwnObserver], asked: Sequence[str]) -> tuple[Offer, list[str]]:
    """What a lab offers that is brought these surfaces and observers, and the surfaces' names.

    Parameters
    ----------
    surfaces : sequence of imaging surfaces, or functions that give one
    own : mapping of names to observers
    asked : names of observers that the lab opens with
    """
    found: dict[str, ImagingSurface] = {}
    added: dict[str, Texts] = {}
    names = []
    for given in surfaces:
        surface = given() if callable(given) else given
        if not isinstance(surface, ImagingSurface):
            raise ValueError(f"the surface is {given!r}; bring an ImagingSurface, or a function that gives one")
        known = [
            n for n, make in SURFACES.items() if (surface.image, surface.distance, surface.ray) == _formulas(make())
        ]
        same = [n for n, other in found.items() if other == with_numbers(surface)]
        if known or same:
            names.append((known + same)[0])
            continue
        called = getattr(given, "__name__", surface.name) if callable(given) else surface.name
        name = free(called, {*SURFACES, *found, *own}, "my_surface")
        found[name] = with_numbers(surface)
        added[name] = {"call": f"{name}()" if callable(given) else name, **origin(given, name)}
        names.append(name)
    return Offer(found, own, tuple(asked), added), names


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
    image, ray = (tuple(e.xreplace(numbers) for e in part) for part in (surface.image, surface.ray))
    return replace(surface, image=image, distance=surface.distance.xreplace(numbers), ray=ray, values={})


PACKAGE, _ = offer_of((), {}, ())
"""What every lab offers."""


def refuse_other_motion(own: Mapping[str, OwnObserver]) -> None:
    """Refuse an observer that was made for another motion than the lab's."""
    for name, make in own.items():
        if make.form is not None and make.form.parameters[:12] != MOTION.parameters:
            raise ValueError(
                f"{name} was made for a form with the parameters {', '.join(map(str, make.form.parameters))}; the lab "
                "moves points by affine(), so make it for PerspectiveSystem(affine(), surface)"
            )


def surface_of(own: Mapping[str, OwnObserver]) -> tuple[ImagingSurface, list[str]] | None:
    """The surface and the outputs that the first observer was made for, if one was made for a form."""
    for make in own.values():
        if make.form is not None and isinstance(make.form.view, ImagingSurface):
            return make.form.view, list(make.form.measured)
    return None
