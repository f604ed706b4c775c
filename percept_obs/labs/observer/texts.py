"""What the page needs to simulate and to observe: texts and formulas of the point, the surfaces, the observers.

Printed when the package is built, see printing.py; one form, observer or surface can be printed by itself.
"""

from collections.abc import Iterable
from functools import lru_cache
from types import MappingProxyType

import sympy as sp

from percept_obs.compile import definitions, function_source
from percept_obs.labs.shared.equations import equations_of
from percept_obs.labs.shared.markup import formula, markup
from percept_obs.labs.shared.observer_texts import kernel_for_the_page, observer_for_the_page, with_all_gains
from percept_obs.labs.shared.offered import SURFACES
from percept_obs.labs.shared.printed import Parts, Texts
from percept_obs.observability.pointwise import instantaneous
from percept_obs.observers import OBSERVERS, Observer
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import POINT

BY_NAME = {make.key: make for make in OBSERVERS}

WAYS = MappingProxyType({name: make.switches or ("",) for name, make in BY_NAME.items()})
"""Ways in which each observer switches, its own first; one without a name for those that do not."""

OWN_SWITCH = MappingProxyType({name: ways[0] for name, ways in WAYS.items() if ways[0]})
"""The switch that each observer that switches has unless another is chosen."""

MOTION = affine()


def key_of(surface: str, outputs: Iterable[str]) -> str:
    """Name of a form: what is seen, and what of it is measured."""
    return f"{surface} {'+'.join(outputs)}"


@lru_cache
def system_of(surface: str) -> PerspectiveSystem:
    """Affine motion seen on a surface."""
    return PerspectiveSystem(MOTION, SURFACES[surface]())


@lru_cache
def form_of(surface: str, outputs: tuple[str, ...]) -> CanonicalForm:
    """The canonical form of affine motion on a surface."""
    return system_of(surface).measure(*outputs)


@lru_cache(maxsize=256)
def observer_of(surface: str, outputs: tuple[str, ...], name: str, way: str = "") -> Observer:
    """An observer with its default gains, and its own way to switch unless another is named."""
    switch = {"switch": way or OWN_SWITCH[name]} if name in OWN_SWITCH else {}
    return BY_NAME[name](form_of(surface, outputs), **switch)


def ways_of(name: str) -> dict[str, Observer]:
    """The observer for all image coordinates, in every way in which it switches."""
    return {way: observer_of("pinhole", ("y1", "y2"), name, way) for way in WAYS[name]}


def with_every_gain(name: str) -> Observer:
    """The observer that has the gains of every way in which it switches."""
    return with_all_gains(ways_of(name))


@lru_cache
def model_for_the_page() -> Texts:
    """What does not depend on the form: the point's loop, the surfaces, the observers."""
    return {
        "rates": function_source(MOTION.parameters, tuple(MOTION.A.row_join(MOTION.b))),
        "surfaces": {name: _surface_for_the_page(name) for name in SURFACES},
        "observers": {name: _observer_for_the_page(name) for name in BY_NAME},
    }


def _surface_for_the_page(name: str) -> Texts:
    system = system_of(name)
    surface, shape = system.surface, system.surface.parameters
    return {
        "coordinates": [s.name for s in surface.coordinates],
        "shape": [s.name for s in shape],
        "outputs": system.output_choices,
        "project": function_source((*POINT, *shape), (*surface.image, surface.distance)),
        "ray": function_source((*surface.image_coordinates, *shape), surface.ray),
        "foe": function_source((*system.parameters,), tuple(system.foe)),
    }


def _observer_for_the_page(name: str) -> Texts:
    make = BY_NAME[name]
    ways = ways_of(name)
    return observer_for_the_page(ways, {way: equations_of(make, **({"switch": way} if way else {})) for way in ways})


@lru_cache
def form_for_the_page(surface: str, outputs: tuple[str, ...]) -> Texts:
    """A form, and the loops of its observers; one that does not exist is among the `refused`, with the reason."""
    form = form_of(surface, outputs)
    names = [s.name for s in form.coordinates]
    letters = {s.name: s for s in form.parameters}
    threshold = sp.Symbol("threshold", real=True)
    found, circle = instantaneous(form), None
    if found.growth is not None:
        centre, radius = found.circle(threshold)
        circle = function_source((*form.parameters, threshold), (*centre, radius))
    kernels: dict[str, Texts] = {}
    refused: dict[str, str] = {}
    for name, ways in WAYS.items():
        if refusal := BY_NAME[name].refusal(form):
            refused[name] = refusal
        else:
            kernels[name] = {way: kernel_for_the_page(observer_of(surface, outputs, name, way)) for way in ways}
    return {
        "measured": [names.index(s.name) for s in form.x1],
        "hidden": [names.index(s.name) for s in form.x2],
        "w": function_source((*form.x1, *form.parameters), tuple(form.w)),
        "circle": circle,
        "formulas": [
            formula(f"<msup>{markup(sp.Symbol('w'))}<mi>T</mi></msup>", form.w.T, letters),
            formula(sp.Symbol("phi"), form.phi, letters),
            formula(sp.Symbol("g"), form.g, letters),
            *(formula(letter, value, letters) for letter, value in definitions(form.rate).items()),
        ],
        "observers": kernels,
        "refused": refused,
    }


def texts_for_the_page() -> Parts:
    """Everything that the lab offers: the model's own texts, and every form."""
    yield "", model_for_the_page()
    for surface in SURFACES:
        for outputs in system_of(surface).output_choices:
            yield f"forms/{key_of(surface, outputs)}", form_for_the_page(surface, outputs)
