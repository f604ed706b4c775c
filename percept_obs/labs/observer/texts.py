"""Texts and formulas of the point, the surfaces and the observers, from which the page simulates and observes.

Printed when the package is built, see printing.py; those of a user when the lab opens, see registry.py.
"""

from collections.abc import Collection, Iterable, Mapping
from functools import lru_cache
from types import MappingProxyType

import sympy as sp

from percept_obs.compile import definitions, function_source
from percept_obs.labs.shared.markup import dotted, formula, markup
from percept_obs.labs.shared.observer_texts import point_for_the_page
from percept_obs.labs.shared.printed import Parts, Texts
from percept_obs.labs.shared.surfaces import SURFACES
from percept_obs.labs.shared.user_observers import Maker, loops_for_the_page, texts_of_observer
from percept_obs.observability.pointwise import instantaneous
from percept_obs.observers import OBSERVERS, Observer
from percept_obs.system.apparent_size import sized
from percept_obs.system.forms import CanonicalForm, PartitionedSystem
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import POINT, ImagingSurface

BY_NAME = {make.key: make for make in OBSERVERS}

WAYS = MappingProxyType({name: make.switches or ("",) for name, make in BY_NAME.items()})
"""Switches of each observer, its own first; an empty name for an observer without."""

OWN_SWITCH = MappingProxyType({name: ways[0] for name, ways in WAYS.items() if ways[0]})
"""Default switch of each observer that has several."""

MOTION = affine()
BLOCKS = MappingProxyType({"A": MOTION.A, "b": MOTION.b})
"""Blocks of a motion by the letters that its expressions may name."""


SIZE = ("y1", "y2", "s")
"""Outputs of the pinhole with the apparent size of a sphere."""
OF_SIZE = ("identifier_based", "extended_kalman")
"""Observers that are printed for it: all others would make the file a seventh larger."""
OF_THE_PINHOLE = ("gpebo", "equivariant_filter")
"""Observers of many states, which are printed for the pinhole only: on all surfaces they take a fifth of the file."""
RADIUS = 1.2
"""Radius of the sphere in metres; no observer knows it."""


def key_of(surface: str, outputs: Iterable[str]) -> str:
    """Name of a form: what is seen, and what of it is measured."""
    return f"{surface} {'+'.join(outputs)}"


@lru_cache
def system_on(surface: ImagingSurface) -> PerspectiveSystem:
    """Affine motion seen on a surface."""
    return PerspectiveSystem(MOTION, surface)


@lru_cache(maxsize=64)
def form_on(surface: ImagingSurface, outputs: tuple[str, ...]) -> PartitionedSystem:
    """Affine motion on a surface, in the canonical form if there is one."""
    system = system_on(sized(surface) if outputs == SIZE else surface).partition(*outputs)
    return system if system.culprits else system.canonical_form()


@lru_cache(maxsize=256)
def observer_on(make: Maker, surface: ImagingSurface, outputs: tuple[str, ...], way: str = "") -> Observer:
    """An observer with its default gains, and its default switch unless another is named."""
    switch = {"switch": way or make.switches[0]} if make.switches else {}
    return make(form_on(surface, outputs), **switch)


def system_of(surface: str) -> PerspectiveSystem:
    """Affine motion seen on a surface of the package."""
    return system_on(SURFACES[surface]())


def form_of(surface: str, outputs: tuple[str, ...]) -> CanonicalForm:
    """The canonical form of affine motion on a surface of the package."""
    return form_on(SURFACES[surface](), outputs).canonical_form()


@lru_cache
def model_for_the_page() -> Texts:
    """Texts that do not depend on the form: the point's loop, the surfaces, the observers."""
    pinhole = SURFACES["pinhole"]()
    ways = {n: {way: observer_on(BY_NAME[n], pinhole, ("y1", "y2"), way) for way in each} for n, each in WAYS.items()}
    return {
        **point_for_the_page(MOTION),
        "surfaces": {
            name: surface_for_the_page(make(), system_of(name).output_choices) for name, make in SURFACES.items()
        },
        "radius": RADIUS,
        "observers": {name: texts_of_observer(make, ways[name]) for name, make in BY_NAME.items()},
    }


def surface_for_the_page(surface: ImagingSurface, outputs: Iterable[tuple[str, ...]]) -> Texts:
    """Functions of a surface: image, ray, focus of expansion, flow."""
    outputs = tuple(outputs)
    system = system_on(surface)
    shape = surface.parameters
    return {
        "coordinates": [s.name for s in surface.coordinates],
        "shape": [s.name for s in shape],
        "outputs": (*outputs, SIZE) if surface == SURFACES["pinhole"]() else outputs,
        "project": function_source((*POINT, *shape), (*surface.image, surface.distance)),
        "ray": function_source((*surface.image_coordinates, *shape), surface.ray),
        "foe": function_source((*system.parameters,), tuple(system.foe)),
        "flow": function_source(
            (*system.coordinates, *system.parameters), (*system.rate, *system.rate.jacobian(system.coordinates))
        ),
    }


def form_for_the_page(form: PartitionedSystem, makers: Mapping[str, Maker]) -> Texts:
    """A form with the loops of its observers, and the reasons why others are refused."""
    names = [s.name for s in form.coordinates]
    letters = {s.name: s for s in form.parameters}
    formulas: Texts = {"w": None, "circle": None, "formulas": [formula(dotted(s), e, letters) for s, e in _rates(form)]}
    if not form.culprits:
        formulas = _of_canonical(form.canonical_form(), letters)
    return {
        "measured": [names.index(s.name) for s in form.x1],
        "hidden": [names.index(s.name) for s in form.x2],
        **formulas,
        **loops_for_the_page(form, makers),
    }


def _rates(form: PartitionedSystem) -> Iterable[tuple[sp.Symbol, sp.Expr]]:
    return zip((*form.x1, *form.x2), form.rate, strict=True)


def _of_canonical(form: CanonicalForm, letters: Mapping[str, sp.Symbol]) -> Texts:
    threshold = sp.Symbol("threshold", real=True)
    found, circle = instantaneous(form), None
    if found.growth is not None and len(form.x1) == 2:
        centre, radius = found.circle(threshold)
        circle = function_source((*form.parameters, threshold), (*centre, radius))
    return {
        "w": function_source((*form.x1, *form.parameters), tuple(form.w)),
        "circle": circle,
        "formulas": [
            formula(f"<msup>{markup(sp.Symbol('w'))}<mi>T</mi></msup>", form.w.T, letters),
            formula(sp.Symbol("phi"), form.phi, letters),
            formula(sp.Symbol("g"), form.g, letters),
            *(formula(letter, value, letters) for letter, value in definitions(form.rate).items()),
        ],
    }


def texts_for_the_page() -> Parts:
    """Texts of the model and of every form, by their places."""
    yield "", model_for_the_page()
    for surface in SURFACES:
        for outputs in system_of(surface).output_choices:
            left_out = () if surface == "pinhole" and "y1" in outputs else OF_THE_PINHOLE
            yield _printed(surface, outputs, left_out, "the page has it on the pinhole with y1; track runs it here")
    few = "with the size the page has the identifier-based observer and the EKF only"
    yield _printed("pinhole", SIZE, BY_NAME.keys() - {*OF_SIZE}, few)


def _printed(surface: str, outputs: tuple[str, ...], left_out: Collection[str], why: str) -> tuple[str, Texts]:
    """Place and texts of a form; who is left out, and has no reason of its own, is refused for this one."""
    form = form_of(surface, outputs)
    texts = form_for_the_page(form, {name: make for name, make in BY_NAME.items() if name not in left_out})
    texts["refused"] |= {name: BY_NAME[name].refusal(form) or why for name in sorted(left_out)}
    return f"forms/{key_of(surface, outputs)}", texts
