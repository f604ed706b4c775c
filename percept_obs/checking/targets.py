"""Targets of all that the package derives, and of formulas of one's own."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import singledispatch
from typing import Any

import sympy as sp

from percept_obs.checking import relations
from percept_obs.checking.deciding import explicit
from percept_obs.checking.lines import ZEROS, Line, lines_of
from percept_obs.checking.reading import read, words_of
from percept_obs.checking.target import Target
from percept_obs.compile.equations import Equations
from percept_obs.observability.pointwise import InstantaneousObservability
from percept_obs.observers import Observer
from percept_obs.structure import QUANTITIES, StructureAndMotion
from percept_obs.system.derivation import Derivation, Step
from percept_obs.system.forms import CanonicalForm, PartitionedSystem
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import POINT


@singledispatch
def target_of(thing: Any) -> Target:
    """Return the target of a check.

    Parameters
    ----------
    thing : anything that the package derives, formula, sequence or mapping of them
        As `percept_obs.check` takes it.

    Raises
    ------
    ValueError
        If no formula can be compared with it.

    See Also
    --------
    percept_obs.check

    Examples
    --------
    >>> from percept_obs.checking import target_of
    >>> target_of("f = a yhat1 + b").lines[0].formula
    a*yhat1 + b
    """
    if isinstance(thing, str):
        names = {str(t) for t in words_of(thing) if t.type == "NAME"}
        # sympy reads an accent before the index
        spelled = {name: re.sub(r"(\d+)((?:hat|bar|tilde|dot)+)$", r"\2\1", name) for name in names}
        named = {name: sp.Symbol(spelling, real=True) for name, spelling in spelled.items()}
        return _joined(Target(tuple(lines_of(r.name, r.formula))) for r in read(thing, named).lines)
    if isinstance(thing, Mapping):
        return _joined(_called(str(name), target_of(part)) for name, part in thing.items())
    if isinstance(thing, Sequence) and not isinstance(thing, Derivation):
        return _joined(map(target_of, thing))
    if isinstance(getattr(thing, "target", None), Target):
        return thing.target
    if hasattr(thing, "derivation") and callable(thing.derivation):
        return target_of(thing.derivation())
    raise ValueError(
        f"nothing can be compared with a {type(thing).__name__}; give a system, a form, an observer, a step of a "
        "derivation, an observability condition, or a formula"
    )


def _called(name: str, target: Target) -> Target:
    """Name a target; of several lines the names are numbered."""
    many = len(target.lines) > 1
    named = (replace(line, name=f"{name}{k if many else ''}") for k, line in enumerate(target.lines, 1))
    return replace(target, lines=tuple(named))


def _joined(targets: Iterable[Target]) -> Target:
    return Target(tuple(line for part in targets for line in part.lines))


def _rates(symbols: Sequence[sp.Symbol], values: Iterable[sp.Expr]) -> tuple[Line, ...]:
    return tuple(Line(f"{s.name}'", explicit(value)) for s, value in zip(symbols, values, strict=True))


@target_of.register
def _(thing: Target) -> Target:
    return thing


@target_of.register
def _(thing: PerspectiveSystem) -> Target:
    pool = frozenset((*thing.coordinates, *thing.parameters, *POINT))
    return Target(
        _rates(thing.coordinates, thing.rate), pool, derivation=thing.derivation, relations=relations.of_system(thing)
    )


@target_of.register
def _(thing: PartitionedSystem) -> Target:
    steps = thing.derivation if isinstance(thing, CanonicalForm) else None
    return Target(
        _rates((*thing.x1, *thing.x2), thing.rate), _letters(thing), steps, relations=relations.of_form(thing)
    )


@target_of.register
def _(thing: Observer) -> Target:
    full = target_of(thing.equations)
    off = {explicit(gain): sp.S.Zero for gain, value in thing.gain_values.items() if value == 0}
    off |= {base: sp.S.Zero for power in off for base in power.free_symbols}
    lines = tuple(replace(line, formula=line.formula.xreplace(off)) for line in full.lines)
    pool = full.pool | _letters(thing.form)
    return Target(lines, pool, relations=relations.of_observer(thing), idle=full.lines if lines != full.lines else ())


@target_of.register
def _(thing: Equations) -> Target:
    pool = frozenset((*thing.state, *thing.measured, *thing.parameters, *thing.gains))
    return Target(_rates(thing.state, thing.flow), frozenset(explicit(s) for s in pool if "^" not in s.name))


def _letters(form: PartitionedSystem) -> frozenset[sp.Symbol]:
    return frozenset((*form.x1, *form.x2, *form.parameters))


@target_of.register
def _(thing: InstantaneousObservability) -> Target:
    return Target((Line("", thing.determinant, ZEROS),), _letters(thing.form))


@target_of.register
def _(thing: StructureAndMotion) -> Target:
    scale = sp.Symbol(QUANTITIES[0], real=True)
    pool = _letters(thing.form) | {sp.Symbol(name, real=True) for name in QUANTITIES}
    return Target((Line("", thing.determinant, ZEROS),), pool, nonzero=frozenset({scale}))


@target_of.register
def _(thing: Step) -> Target:
    if not thing.values:
        raise ValueError(f"the step {thing.reason!r} has no formula of its own; check the one after it")
    return Target(tuple(Line(name, value) for name, value in thing.values.items()))


@target_of.register
def _(thing: Derivation) -> Target:
    lines: list[Line] = []
    blocks = {}
    for number, step in enumerate(thing, 1):
        blocks[f"step{number}"] = tuple(range(len(lines), len(lines) + len(step.values)))
        lines += [Line(name, value) for name, value in step.values.items()]
    if not lines:
        raise ValueError("the derivation has no formulas of its own to compare with; give one of its results")
    return Target(tuple(lines), derivation=lambda: thing, blocks=blocks)


@target_of.register(sp.Basic)
@target_of.register(sp.MatrixBase)
def _(thing: sp.Basic) -> Target:
    return Target(tuple(lines_of("", explicit(thing))))
