"""Sheets of the desk: the steps of a derivation, a line for each formula, and the goal."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise

import sympy as sp

from percept_obs.checking import Target, target_of
from percept_obs.checking.deciding import explicit
from percept_obs.checking.lines import Line
from percept_obs.compile import definitions, in_letters
from percept_obs.labs.desk.systems import OBSERVERS, observer_of
from percept_obs.labs.shared.equations import equations_of
from percept_obs.labs.shared.markup import dotted, formula, listed, markup, row
from percept_obs.system.derivation import Derivation, Step, rates
from percept_obs.system.motion import Motion, affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import POINT

PARTS = {"rate": "the image's motion", "form": "w, φ and g", "observer": "an observer", "error": "its error dynamics"}
"""Parts of a derivation, each of which needs those before it."""

NAMES = {
    "The point moves": "Moving point",
    "It is seen": "Its image",
    "Image and distance say": "Its ray",
    "Derivatives of": "Derivatives",
    "The velocity": "Its velocity",
    "Image coordinates": "Image motion",
    "The focus of expansion": "Focus of expansion",
    "What multiplies": "w",
    "What is left": "φ",
    "How the hidden": "g",
    "The error": "Error dynamics",
}
"""Short names of steps, by how their reasons begin."""


def name_of(reason: str) -> str:
    """Return the short name of a step; its reason without the explanation, if it has none."""
    return next((name for start, name in NAMES.items() if reason.startswith(start)), reason.partition(",")[0])


def label_of(name: str) -> str:
    """Return the name of a line as MathML; empty for words."""
    stem = name.removesuffix("'")
    if " " in name:
        return ""
    return dotted(sp.Symbol(stem)) if stem != name else markup(sp.Symbol(name))


@dataclass(frozen=True, eq=False)
class Sheet:
    """A derivation to fill in."""

    given: list[str]  # known formulas as MathML
    derivation: Derivation  # the values of its steps are to be filled in
    goal: Target  # target of the lines, one for each value
    image: tuple[str, ...] = ()  # names of the lines that are the image's motion

    @cached_property
    def numbered(self) -> Target:
        """The goal with a name of its own for each line."""
        lines = (replace(line, name=f"line{k}") for k, line in enumerate(self.goal.lines))
        return replace(self.goal, lines=tuple(lines))

    @cached_property
    def letters(self) -> list[sp.Symbol]:
        """Letters that occur in the lines."""
        used = {s for line in self.goal.lines for s in in_letters(line.formula).free_symbols}
        return sorted(used, key=str)

    def rows(self, step: int) -> range:
        """Return the rows of a step, which is counted from 1."""
        start = sum(len(before.values) for before in self.derivation[: step - 1])
        return range(start, start + len(self.derivation[step - 1].values))


@lru_cache(maxsize=64)
def sheet_of(system: PerspectiveSystem, outputs: tuple[str, ...], observer: str, part: str) -> Sheet:
    """Return the derivation to fill in; a ValueError says if there is no such observer for these outputs."""
    return _MAKE[part](system, outputs, observer)


def _rate(system: PerspectiveSystem, outputs: tuple[str, ...], observer: str) -> Sheet:
    surface = system.surface
    seen = {s.name: e for s, e in zip(surface.coordinates, (*surface.image, 1 / surface.distance), strict=True)}
    steps = [step for step in system.derivation() if step.values]
    # what is only written in another form is asked for once
    kept = steps[:1] + [step for before, step in pairwise(steps) if list(step.values) != list(before.values)]
    given = [
        _moving(system.motion),
        row(*listed(formula(sp.Symbol(name), e) for name, e in seen.items())),
        *_named_in(surface.ray),
    ]
    image = tuple(f"{s.name}'" for s in surface.image_coordinates)
    return _sheet(given, kept, target_of(system), image)


def _moving(motion: Motion) -> str:
    """Return the motion of a point; in short where all letters are free."""
    if (motion.A, motion.b) == (affine().A, affine().b):
        return f"<mrow>{dotted(sp.Symbol('𝐗'))}<mo>=</mo><mi>A</mi><mi>𝐗</mi><mo>+</mo><mi>b</mi></mrow>"
    return formula(dotted(sp.Matrix(POINT)), sp.MatAdd(sp.MatMul(motion.A, sp.Matrix(POINT)), motion.b))


def _form(system: PerspectiveSystem, outputs: tuple[str, ...], observer: str) -> Sheet:
    form = system.measure(*outputs)
    return _sheet(_known(system, outputs), [step for step in form.derivation() if step.values], target_of(form))


def _observer(system: PerspectiveSystem, outputs: tuple[str, ...], observer: str) -> Sheet:
    made = observer_of(system, outputs, observer)
    step = Step(
        f"The {made.name} observer, written out for this system:", "", _flow(made.equations.state, made.equations.flow)
    )
    return _sheet([*_known(system, outputs), *_in_letters(observer)], [step], target_of(made))


def _error(system: PerspectiveSystem, outputs: tuple[str, ...], observer: str) -> Sheet:
    made = observer_of(system, outputs, observer)
    step = Step("The error e, the truth less the estimate:", "", _flow(made.error, made.error_dynamics()))
    return _sheet([*_known(system, outputs), *_in_letters(observer)], [step], target_of(made))


_MAKE = {"rate": _rate, "form": _form, "observer": _observer, "error": _error}


def _flow(symbols: Iterable[sp.Symbol], values: Iterable[sp.Expr]) -> Mapping[str, sp.Expr]:
    return rates(symbols, map(explicit, values))


def _sheet(given: list[str], steps: list[Step], letters: Target, image: tuple[str, ...] = ()) -> Sheet:
    derivation = Derivation(tuple(steps))
    lines = tuple(Line(name, value) for step in steps for name, value in step.values.items())
    goal = replace(target_of(derivation), lines=lines, pool=letters.pool | set(letters.letters.values()))
    return Sheet(given, derivation, goal, image)


def _known(system: PerspectiveSystem, outputs: tuple[str, ...]) -> list[str]:
    measured = [markup(s) for s in system.coordinates if s.name in outputs]
    hidden = [markup(s) for s in system.coordinates if s.name not in outputs]
    return [
        *(formula(dotted(s), rate) for s, rate in zip(system.coordinates, system.rate, strict=True)),
        *_named_in(system.rate),
        row("measured", *listed(measured), "; hidden", *listed(hidden)),
    ]


def _named_in(expressions: Iterable[sp.Expr]) -> list[str]:
    """Return the definitions of letters for roots; they may be typed."""
    return [formula(letter, value) for letter, value in definitions(expressions).items()]


def _in_letters(observer: str) -> list[str]:
    return list(equations_of(OBSERVERS[observer])[-1]["lines"])
