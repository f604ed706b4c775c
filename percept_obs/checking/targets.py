"""Targets of all that the package derives, and of formulas of one's own."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial, singledispatch
from itertools import accumulate, pairwise
from typing import Any

import sympy as sp

from percept_obs.checking import relations
from percept_obs.checking.deciding import explicit
from percept_obs.checking.lines import EQUATION, ZEROS, Line, lines_of
from percept_obs.checking.reading import Text, read, words_of
from percept_obs.checking.target import Target
from percept_obs.compile.equations import Equations
from percept_obs.observability.pointwise import InstantaneousObservability
from percept_obs.observers import Observer
from percept_obs.observers.parts import hats
from percept_obs.points import LuenbergerObserver
from percept_obs.structure import QUANTITIES, Corollary, StructureAndMotion
from percept_obs.system.derivation import Derivation, Step
from percept_obs.system.forms import CanonicalForm, PartitionedSystem
from percept_obs.system.motion import Motion
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import POINT, SURFACES
from percept_obs.validation.arguments import described


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
    if isinstance(thing, Sequence) and not isinstance(thing, Derivation | bytes):
        return _joined(map(target_of, thing))
    if isinstance(getattr(thing, "target", None), Target):
        return thing.target
    if hasattr(thing, "derivation") and callable(thing.derivation) and not isinstance(thing, type):
        return target_of(thing.derivation())
    raise ValueError(
        f"nothing can be compared with {described(thing)}; give a system, a form, an observer, a step of a "
        "derivation, an observability condition, or a formula"
    )


def _called(name: str, target: Target) -> Target:
    """Name a target; of several lines the names are numbered."""
    many = len(target.lines) > 1
    named = (replace(line, name=f"{name}{k if many else ''}") for k, line in enumerate(target.lines, 1))
    return replace(target, lines=tuple(named))


def _joined(targets: Iterable[Target]) -> Target:
    if not (lines := tuple(line for part in targets for line in part.lines)):
        raise ValueError("nothing can be compared, for there is no formula; give one, such as y1' = b1")
    return Target(lines)


def _rates(symbols: Sequence[sp.Symbol], values: Iterable[sp.Expr]) -> tuple[Line, ...]:
    return tuple(Line(f"{s.name}'", explicit(value)) for s, value in zip(symbols, values, strict=True))


@target_of.register
def _(thing: Target) -> Target:
    return thing


@target_of.register
def _(thing: PerspectiveSystem) -> Target:
    pool = frozenset((*thing.coordinates, *thing.parameters, *POINT))
    lines = _rates(thing.coordinates, thing.rate)
    moves = dict.fromkeys((f"{s.name}dot" for s in POINT), partial(_moves, thing.motion))
    slope = dict.fromkeys("FJ", partial(_jacobian, thing.jacobian, pool))
    known = relations.of_system(thing)
    return Target(
        lines, pool, thing.derivation, relations=known, elsewhere=partial(_other_surfaces, thing), others=moves | slope
    )


def _other_surfaces(system: PerspectiveSystem) -> dict[str, tuple[Line, ...]]:
    """Return the lines of the rates on all other surfaces without parameters, by the surfaces' names."""
    others = {s.name: s for make in SURFACES if not (s := make()).parameters and not s.fits(system.surface)}
    systems = {name: replace(system, surface=surface) for name, surface in others.items()}
    return {name: _rates(other.coordinates, other.rate) for name, other in systems.items()}


@target_of.register
def _(thing: PartitionedSystem) -> Target:
    lines = _rates((*thing.x1, *thing.x2), thing.rate)
    return Target(lines, _letters(thing), relations=relations.of_form(thing))


@target_of.register
def _(thing: CanonicalForm) -> Target:
    lines, known = _rates((*thing.x1, *thing.x2), thing.rate), relations.of_form(thing)
    parts = dict.fromkeys((*relations.parts(thing), *_PARTS, "wT"), partial(_parts, thing))
    return Target(lines, _letters(thing), thing.derivation, relations=known, others=parts)


@target_of.register
def _(thing: Observer) -> Target:
    pool = target_of(thing.equations).pool | _letters(thing.form)
    others: dict[str, Callable[[Text], Target]] = {
        **dict.fromkeys((f"{e.name}dot" for e in thing.error), partial(_errors, thing)),
        **dict.fromkeys("FJ", partial(_slope, thing)),
        "Vdot": partial(_energy, thing),
    }
    known = relations.of_observer(thing)
    return _default(Target(target_of(thing.equations).lines, pool, relations=known, others=others), thing)


def _default(target: Target, observer: Observer) -> Target:
    """Leave out terms whose gains are 0 by default; they may be typed."""
    off = {explicit(gain): sp.S.Zero for gain, value in observer.gain_values.items() if value == 0}
    off |= {base: sp.S.Zero for power in off for base in power.free_symbols}
    lines = tuple(replace(line, formula=line.formula.xreplace(off)) for line in target.lines)
    return target if lines == target.lines else replace(target, lines=lines, idle=target.lines)


def _moves(motion: Motion, text: Text) -> Target:
    """Return the target of a point's velocity."""
    velocity = motion.A * sp.ImmutableMatrix(POINT) + motion.b
    return Target(_rates(POINT, velocity), frozenset((*POINT, *motion.parameters)))


def _parts(form: CanonicalForm, text: Text) -> Target:
    """Return the target of w, phi and g, whole or entry by entry."""
    entries = relations.parts(form)
    names = list(entries)
    blocks = {part: tuple(k for k, name in enumerate(names) if name.rstrip("0123456789") == part) for part in _PARTS}
    lines = tuple(Line(name, entry) for name, entry in entries.items())
    return Target(lines, _letters(form), blocks=blocks | {"wT": blocks["w"]})


_PARTS = ("w", "phi", "g")


def _errors(observer: Observer, text: Text) -> Target:
    """Return the target of an observer's error dynamics, in terms of truth and error."""
    form, eq = observer.form, observer.equations
    lines = _rates(observer.error, observer.error_dynamics())
    pool = frozenset((*observer.error, *form.coordinates, *form.parameters, *eq.parameters, *eq.gains))
    truth = zip(hats(form.coordinates), form.coordinates, observer.error, strict=True)
    known = {yhat: y - e for yhat, y, e in truth} | dict(relations.of_form(form))
    pool = frozenset(explicit(s) for s in pool if "^" not in s.name)
    others: dict[str, Callable[[Text], Target]] = {"Vdot": partial(_energy, observer)}
    return _default(Target(lines, pool, relations=known, others=others), observer)


def _slope(observer: Observer, text: Text) -> Target:
    """Return the target of the Jacobian of an observer's estimates, without that of its other states."""
    eq, estimates = observer.equations, hats((*observer.form.x1, *observer.form.x2))
    if not set(estimates) <= set(eq.state):
        raise ValueError(f"the {observer.name} observer has other states than estimates; look at observer.jacobian()")
    slope = sp.ImmutableMatrix([eq.flow[eq.state.index(s)] for s in estimates]).jacobian(estimates)
    return _default(_jacobian(lambda: slope, target_of(eq).pool, text), observer)


def _jacobian(derive: Callable[[], sp.MatrixBase], pool: frozenset[sp.Symbol], text: Text) -> Target:
    slope = derive()
    lines = tuple(Line(f"F{i + 1}{j + 1}", explicit(slope[i, j])) for i in range(slope.rows) for j in range(slope.cols))
    return Target(lines, pool, blocks=dict.fromkeys("FJ", tuple(range(len(lines)))))


def _energy(observer: Observer, text: Text) -> Target:
    """Return the target of V and its rate along the error dynamics, for the V that the text begins with."""
    found = {d.name: d.formulas[-1] for d in text.definitions}
    if "V" not in found:
        raise ValueError("V' needs a V: begin with its line, such as V = (e1^2 + e2^2 + e3^2) / 2, and then V' = ...")
    form, eq, errors = observer.form, observer.equations, _errors(observer, text)
    V = found["V"].xreplace(dict(errors.relations))
    rates = dict(zip((*form.x1, *form.x2), form.rate, strict=True)) | dict(zip(eq.state, eq.flow, strict=True))
    rates |= dict(zip(observer.error, (line.formula for line in errors.lines), strict=True))
    rate = sp.Add(*(V.diff(s) * explicit(rates[s]) for s in V.free_symbols & set(rates)))
    return replace(errors, lines=(Line("V", V), Line("V'", rate)), idle=(), others={})


@target_of.register
def _(thing: Equations) -> Target:
    pool = frozenset((*thing.state, *thing.measured, *thing.parameters, *thing.gains))
    return Target(_rates(thing.state, thing.flow), frozenset(explicit(s) for s in pool if "^" not in s.name))


def _letters(form: PartitionedSystem) -> frozenset[sp.Symbol]:
    return frozenset((*form.x1, *form.x2, *form.parameters))


@target_of.register
def _(thing: InstantaneousObservability) -> Target:
    return Target((Line("", thing.determinant, ZEROS, strict=True),), _letters(thing.form))


@target_of.register
def _(thing: StructureAndMotion) -> Target:
    scale = sp.Symbol(QUANTITIES[0], real=True)
    pool = _letters(thing.form) | {sp.Symbol(name, real=True) for name in QUANTITIES}
    others = dict.fromkeys(("det", "Omega", "g", "Omegag"), partial(_case, thing, pool))
    return Target((Line("", thing.determinant, ZEROS, strict=True),), pool, nonzero=frozenset({scale}), others=others)


@target_of.register
def _(thing: Corollary) -> Target:
    return target_of(thing.choice())


def _case(choice: StructureAndMotion, pool: frozenset[sp.Symbol], text: Text) -> Target:
    """Return the target of a choice of unknowns: Omega, g and Omega_g of ybar' = Omega + g, and the determinant."""
    form = choice.form
    parts = {"Omega": form.phi, "g": form.w.T * sp.Matrix(choice.theta), "Omegag": form.w.T}
    lines = [Line(f"{name}, entry {k}", e) for name, part in parts.items() for k, e in enumerate(part, 1)]
    ends = [0, *accumulate(len(part) for part in parts.values())]
    blocks = {name: tuple(range(*span)) for name, span in zip(parts, pairwise(ends), strict=True)}
    return Target((*lines, Line("det", choice.determinant, EQUATION)), pool, blocks=blocks)


@target_of.register
def _(thing: LuenbergerObserver) -> Target:
    form = thing.form
    pool = frozenset((*form.y, *form.state, *thing.estimate, *thing.error, *thing.inverse, *form.motion.parameters))
    error = dict(zip(thing.error, (x - xhat for x, xhat in zip(form.state, thing.estimate, strict=True)), strict=True))
    others = dict.fromkeys(
        (f"{rho.name}dot" for rho in thing.error),
        partial(_error_of_points, thing, pool - set(form.state) - set(thing.estimate)),
    )
    return Target(_rates(thing.estimate, thing.flow), pool - set(error), relations=error, others=others)


def _error_of_points(observer: LuenbergerObserver, pool: frozenset[sp.Symbol], text: Text) -> Target:
    return Target(_rates(observer.error, observer.error_dynamics()), pool)


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
    return Target(tuple(lines), derivation=partial(replace, thing), blocks=blocks)


@target_of.register(sp.Basic)
@target_of.register(sp.MatrixBase)
def _(thing: sp.Basic) -> Target:
    lines = tuple(lines_of("", explicit(thing)))
    name = getattr(thing, "called", "")  # the parts of a canonical form know theirs
    return Target(lines, blocks={name: tuple(range(len(lines)))} if name else {})
