"""Texts of every choice of unknowns for the page: formulas, reasons for refusals, loops of observers.

Omega_g is Omega3 times a matrix of known signals, whatever the choice.  The loops are printed with that matrix as
parameters, so that one for each number of unknowns serves every choice.  Printed when the package is built.
"""

from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from itertools import combinations, permutations, product
from types import MappingProxyType
from typing import Any

import sympy as sp

from percept_obs import observers
from percept_obs.compile import function_source
from percept_obs.labs.shared.equations import equations_of
from percept_obs.labs.shared.markup import formula, markup
from percept_obs.labs.shared.observer_texts import kernel_for_the_page, observer_for_the_page, point_for_the_page
from percept_obs.labs.shared.printed import Parts, Texts
from percept_obs.observers import Observer, integral_sliding_mode
from percept_obs.observers.integral_sliding_mode import IDEAL
from percept_obs.structure import COROLLARIES, QUANTITIES, ImpossibleChoice, StructureAndMotion, scaled_dynamics
from percept_obs.structure.scenarios import chwa2019_experiment
from percept_obs.system.forms import CanonicalForm, partition
from percept_obs.system.motion import rigid
from percept_obs.system.surfaces import POINT, pinhole

MOTION = rigid()
_ROTATION, CAMERA, OBJECT = (MOTION.parameters[k : k + 3] for k in (0, 3, 6))
BLOCKS = MappingProxyType(
    {letter: sp.ImmutableMatrix(block) for letter, block in (("w_c", _ROTATION), ("v_c", CAMERA), ("v_p", OBJECT))}
)
"""Blocks of a motion by the letters that its expressions may name."""
LARGEST = 3
"""Largest number of unknowns."""

ISMO_WAYS = {
    "ideal": ("ideal switch", IDEAL),
    "layer": ("boundary layer", "hyperbolic tangent"),
    "sign": ("sign", "sign"),
}
OBSERVERS: Mapping[str, tuple[str, Callable[..., Observer]]] = MappingProxyType(
    {key: (f"ISMO, {way}", partial(integral_sliding_mode, switch=switch)) for key, (way, switch) in ISMO_WAYS.items()}
    | {make.key: (make.name, make) for make in observers.OBSERVERS if make.for_structure}
)
"""Titles and functions of the lab's observers, by their names in settings."""

SWING = sp.symbols("constant amplitude rate phase t", real=True)


def swinging(
    constant: Any, amplitude: Any, rate: Any, phase: Any, time: Any, sin: Callable[[Any], Any] = sp.sin
) -> Any:
    """A component of a velocity that swings around a constant."""
    return constant + amplitude * sin(rate * time + phase)


PHASES = {"v_c": (sp.pi / 2, 0, 0), "v_p": (0, sp.pi / 2, 0)}
"""Phases of the swinging components, so that the camera circles and the object wanders."""


def key_of(unknown: tuple[str, ...] | list[str], earlier: bool) -> str:
    """Name of what is unknown: its quantities, and whether d_s is known from an earlier stage only."""
    kept = ["earlier"] if earlier and "d_s" not in unknown else []
    return " ".join([*(name for name in QUANTITIES if name in unknown), *kept])


@lru_cache
def general_form(count: int) -> CanonicalForm:
    """The form of any choice with so many unknowns: what multiplies theta in d_s (v_p - v_c) stands as parameters."""
    theta = sp.symbols(f"theta1:{count + 1}", real=True)
    M = sp.ImmutableMatrix(3, count, sp.symbols(f"M1:4(1:{count + 1})", real=True))
    m = sp.ImmutableMatrix(sp.symbols("m1:4", real=True))
    dynamics = scaled_dynamics()
    moved = dynamics.rotation * sp.ImmutableMatrix(_ROTATION) + dynamics.object * (M * sp.ImmutableMatrix(theta) + m)
    outputs = StructureAndMotion(QUANTITIES[:1]).image_coordinates
    rate = sp.ImmutableMatrix([*moved.expand(), *sp.zeros(count, 1)])
    names = [symbol.name for symbol in outputs]
    return partition((*outputs, *theta), rate, names, (*_ROTATION, *M, *m)).canonical_form()


@lru_cache
def observer_of(name: str, count: int = LARGEST) -> Observer:
    """An observer of any choice with so many unknowns."""
    return OBSERVERS[name][1](general_form(count))


def model_for_the_page() -> Texts:
    """Texts that depend on no choice: the point's loop, the pinhole, the observers, the refused choices."""
    surface = pinhole()
    return {
        **point_for_the_page(MOTION),
        "project": function_source(POINT, (*surface.image, surface.distance)),
        "swinging": function_source(SWING, (swinging(*SWING),)),
        "phases": {name: [float(phase) for phase in phases] for name, phases in PHASES.items()},
        "observers": {
            name: {**observer_for_the_page({"": observer_of(name)}, {"": equations_of(make)}), "title": title}
            for name, (title, make) in OBSERVERS.items()
        },
        "quantities": QUANTITIES,
        "refused": refused(),
        "corollaries": [
            {
                **{"number": c.number, "section": c.section, "camera": c.camera, "object": c.object},
                **{"words": str(c), "settings": case_of(c.number)},
            }
            for c in COROLLARIES
        ],
    }


def refused() -> dict[str, str]:
    """Choices that are refused whatever the velocities are, with the reasons."""
    found: Texts = {}
    for count in range(len(QUANTITIES) + 1):
        for unknown in combinations(QUANTITIES, count):
            try:
                StructureAndMotion(unknown)
            except ImpossibleChoice as error:
                found |= {key_of(unknown, earlier): str(error) for earlier in (False, True)}
    return found


def case_of(number: int) -> dict[str, Any]:
    """Settings in which a corollary holds: the paper's values where it states some, and velocities that swing."""
    corollary = COROLLARIES[number - 1]
    stated = corollary.choice()
    fixed: dict[str, Any] = {
        "motion": "",
        "velocities": "set",
        "unknown": list(stated.unknown),
        "earlier": "d_s" in stated.earlier,
        "w_c": [0.0] * 3,
    }
    if number in (3, 5):
        swings = [[0.3, 0.3, -0.1], [0.2, 0.2, 0.1 if number == 5 else 0.0]]
        return fixed | {
            **{"ybar": [0.4, 0.4, 0.05], "scale": 4.0, "v_c": [0.0, 0.0, -0.3], "v_p": [0.0] * 3, "rate": 1.0},
            **{"v_c_swing": swings[0], "v_p_swing": swings[1]},
        }
    case = chwa2019_experiment(corollary.section)
    known = case.motion.known(0.0)[0].tolist()
    return fixed | {
        **{"ybar": [0.32, 0.3, 0.05], "scale": case.scale, "v_c": known[3:6], "v_p": known[6:]},
        **{"v_c_swing": [0.0] * 3, "v_p_swing": [0.0] * 3},
    }


@lru_cache
def corollaries() -> dict[str, tuple[int, tuple[str, ...]]]:
    """By a choice's name: the corollary that states it, and the velocities that it wants to be zero."""
    cases = [(c.number, c.choice("".join(axes))) for c in COROLLARIES for axes in permutations("123")]
    return {key_of(case.unknown, "d_s" in case.earlier): (number, case.zero) for number, case in cases}


def unknowns_for_the_page(unknown: tuple[str, ...], earlier: bool) -> Texts:
    """A choice in formulas, and as a function that turns velocities into the parameters of the general form."""
    choice = StructureAndMotion(unknown, earlier=("d_s",) if earlier else ())
    M, m = choice.translation
    velocities = choice.known_velocity if "d_s" in unknown else ()
    alone = sorted(symbol.name for velocity in velocities for symbol in velocity.free_symbols)
    number, zero = corollaries().get(key_of(unknown, earlier), (None, ()))
    letters = {symbol.name: symbol for symbol in (*choice.form.parameters, *choice.image_coordinates)}
    scale = sp.Symbol("d_s", real=True)
    return {
        "unknown": choice.unknown,
        "scaled": [bool(theta.has(scale)) for theta in choice.theta],
        "square": choice.form.w.is_square,
        "theta": [markup(theta) for theta in choice.theta],
        "signals": function_source((scale, *MOTION.parameters), (*M, *m, *choice.theta)),
        "determinant": _determinant(choice, letters),
        "zeroSet": choice.zero_set,
        "alone": alone,
        "withoutThem": _refusal(unknown, alone) if alone else "",
        "corollary": number,
        "zero": zero,
        "formulas": [
            formula(_OMEGA_G, choice.form.w.T, letters),
            formula(sp.Symbol("Omega"), choice.form.phi, letters),
        ],
    }


_OMEGA_G = "<msub><mi>Ω</mi><mi>g</mi></msub>"


def _refusal(unknown: tuple[str, ...], zero: list[str]) -> str:
    try:
        StructureAndMotion(unknown, tuple(zero))
    except ImpossibleChoice as error:
        return str(error)
    raise AssertionError(f"{unknown} is possible although {zero} are zero")


def _determinant(choice: StructureAndMotion, letters: dict[str, sp.Symbol]) -> str:
    """The determinant as a formula; where it is long, in the differences of the velocities."""
    determinant = choice.determinant
    if choice.form.w.is_square:
        return formula("<mrow><mi>det</mi><mo>&#8289;</mo>" + _OMEGA_G + "</mrow>", determinant, letters)
    differences = sp.symbols("delta1:4", real=True)
    shifted = {c: d + o for c, d, o in zip(CAMERA, differences, OBJECT, strict=True)}
    left = f"<mrow><mi>det</mi><mo>(</mo><msubsup><mi>Ω</mi><mi>g</mi><mi>T</mi></msubsup>{_OMEGA_G}<mo>)</mo></mrow>"
    return formula(left, sp.factor(determinant.xreplace(shifted).expand()), letters)


def form_for_the_page(count: int) -> Texts:
    """The loops of observers for so many unknowns, and what guards the inversion that gives theta."""
    form = general_form(count)
    numerator, determinant = form.cramer
    size = sp.sqrt(sum(entry**2 for entry in numerator))
    return {
        "guard": function_source((*form.x1, *form.parameters), (size, determinant)),
        "observers": {name: kernel_for_the_page(observer_of(name, count)) for name in OBSERVERS},
    }


def texts_for_the_page() -> Parts:
    """Texts of the model, of every choice of unknowns, and of each number of them, by their places."""
    yield "", model_for_the_page()
    done: set[str] = set(refused())
    for count in range(1, LARGEST + 1):
        yield f"forms/{count}", form_for_the_page(count)
        for unknown, earlier in product(combinations(QUANTITIES, count), (False, True)):
            key = key_of(unknown, earlier)
            if key not in done:
                done.add(key)
                yield f"unknowns/{key}", unknowns_for_the_page(unknown, earlier)
