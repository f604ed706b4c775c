"""What the page needs to simulate and to observe: texts and formulas of the point, the surfaces, the observers.

Kept apart from the widgets, so that another process can print it: see printing.py.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from types import MappingProxyType

import sympy as sp

from percept_obs.compile import function_source, source
from percept_obs.compile.equations import Equations
from percept_obs.labs.shared.equations import equations_of
from percept_obs.labs.shared.kernels import Texts, kernel_for_the_page, observer_for_the_page
from percept_obs.labs.shared.markup import formula, markup
from percept_obs.observability.pointwise import instantaneous
from percept_obs.observers import OBSERVERS, Observer
from percept_obs.system import surfaces
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import POINT

SURFACES = {make.__name__: make for make in surfaces.SURFACES}
BY_NAME = {make.key: make for make in OBSERVERS}

WAYS = MappingProxyType({name: make.switches or ("",) for name, make in BY_NAME.items()})
"""Ways in which each observer switches, its own first; one without a name for those that do not."""

OWN_SWITCH = MappingProxyType({name: ways[0] for name, ways in WAYS.items() if ways[0]})
"""The switch that each observer that switches has unless another is chosen."""

MOTION = affine()


def key_of(surface: str, outputs: Iterable[str]) -> str:
    """Name of a structure: what is seen, and what of it is measured."""
    return f"{surface} {'+'.join(outputs)}"


@lru_cache
def system_of(surface: str) -> PerspectiveSystem:
    """Affine motion seen on a surface."""
    return PerspectiveSystem(MOTION, SURFACES[surface]())


@lru_cache
def keys() -> tuple[str, ...]:
    """Names of all structures that a lab offers."""
    return tuple(key_of(surface, outputs) for surface in SURFACES for outputs in system_of(surface).output_choices)


@lru_cache
def form_of(surface: str, outputs: tuple[str, ...]) -> CanonicalForm:
    """The canonical form of affine motion on a surface."""
    return system_of(surface).measure(*outputs)


@lru_cache(maxsize=256)
def observer_of(surface: str, outputs: tuple[str, ...], name: str, way: str = "") -> Observer:
    """An observer with its default gains, and its own way to switch unless another is named.

    Raises
    ------
    ValueError
        If it does not exist for this structure.
    """
    switch = {"switch": way or OWN_SWITCH[name]} if name in OWN_SWITCH else {}
    return BY_NAME[name](form_of(surface, outputs), **switch)


def ways_of(name: str) -> dict[str, Observer]:
    """The observer for all image coordinates, in every way in which it switches."""
    return {way: observer_of("pinhole", ("y1", "y2"), name, way) for way in WAYS[name]}


@lru_cache
def model_for_the_page() -> Texts:
    """What does not depend on the structure: the point's loop, the surfaces, the observers."""
    rate = MOTION.A * sp.ImmutableMatrix(POINT) + MOTION.b
    return {
        "plant": source(Equations(POINT, tuple(rate), (), MOTION.parameters), "javascript"),
        "surfaces": {name: _surface_for_the_page(name) for name in SURFACES},
        "observers": {name: _observer_for_the_page(name) for name in BY_NAME},
    }


def _surface_for_the_page(name: str) -> Texts:
    system = system_of(name)
    surface, shape = system.surface, system.surface.parameters
    return {
        "outputs": system.output_choices,
        "coordinates": [s.name for s in surface.coordinates],
        "shape": [s.name for s in shape],
        "project": function_source((*POINT, *shape), (*surface.image, surface.distance)),
        "ray": function_source((*surface.image_coordinates, *shape), surface.ray),
        "foe": function_source((*system.parameters,), tuple(system.foe)),
    }


def _observer_for_the_page(name: str) -> Texts:
    make = BY_NAME[name]
    ways = ways_of(name)
    return observer_for_the_page(ways, {way: equations_of(make, **({"switch": way} if way else {})) for way in ways})


@lru_cache
def structure_for_the_page(
    surface: str, outputs: tuple[str, ...], observers: tuple[tuple[str, str], ...] | None = None
) -> Texts:
    """What depends on the structure: its form, and the loops of observers of it.

    Parameters
    ----------
    surface : str
    outputs : tuple of str
    observers : tuple of pairs of an observer's name and its way to switch, optional
        All of them when left out.

    Returns
    -------
    dict
        An observer that does not exist for this structure is among the `refused`, with the reason.
    """
    form = form_of(surface, outputs)
    names = [s.name for s in form.coordinates]
    letters = {s.name: s for s in form.parameters}
    threshold = sp.Symbol("threshold", real=True)
    try:
        centre, radius = instantaneous(form).circle(threshold)
        circle = function_source((*form.parameters, threshold), (*centre, radius))
    except ValueError:
        circle = None
    if observers is None:
        observers = tuple((name, way) for name, ways in WAYS.items() for way in ways)
    kernels: dict[str, Texts] = {}
    refused: dict[str, str] = {}
    for name, way in observers:
        refusal = BY_NAME[name].refusal(form)
        if refusal:
            refused[name] = refusal
        else:
            kernels.setdefault(name, {})[way] = kernel_for_the_page(observer_of(surface, outputs, name, way))
    return {
        "measured": [names.index(s.name) for s in form.x1],
        "hidden": [names.index(s.name) for s in form.x2],
        "w": function_source((*form.x1, *form.parameters), tuple(form.w)),
        "circle": circle,
        "formulas": [
            formula(f"<msup>{markup(sp.Symbol('w'))}<mi>T</mi></msup>", form.w.T, letters),
            formula(sp.Symbol("phi"), form.phi, letters),
            formula(sp.Symbol("g"), form.g, letters),
        ],
        "observers": kernels,
        "refused": refused,
    }


def texts_of(key: str) -> Texts:
    """Texts of the structure with this name, for all observers."""
    surface, outputs = key.split(" ")
    return structure_for_the_page(surface, tuple(outputs.split("+")))
