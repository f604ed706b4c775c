"""The target of a check: lines with names, the letters that may stand in them, and the steps to them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, singledispatch
from itertools import count, product
from typing import Any

import sympy as sp
from lark import Token
from sympy.core.relational import Relational
from sympy.logic.boolalg import Boolean

from percept_obs.checking.deciding import entries_of, explicit, on_sides, sizes_of, written_out
from percept_obs.checking.points import key
from percept_obs.checking.reading import Reading, read, words_of
from percept_obs.compile import intermediates
from percept_obs.compile.equations import Equations
from percept_obs.observability.pointwise import InstantaneousObservability
from percept_obs.observers import Observer
from percept_obs.observers.parts import hats
from percept_obs.structure import QUANTITIES, StructureAndMotion
from percept_obs.system.derivation import Derivation, Step
from percept_obs.system.forms import CanonicalForm, PartitionedSystem
from percept_obs.system.motion import rigid
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import POINT, plane

VALUE, EQUATION, INEQUALITY, ZEROS = "value", "equation", "inequality", "zeros"


@dataclass(frozen=True)
class Line:
    """Line of a target.

    The name is the left side as it is typed, "y1'", or words; empty if it has none.  The formula is the right side; of
    other equations and inequalities the left side less the right one.  Equations are the same up to a number,
    inequalities up to a positive one; of "zeros" it only matters where the formula is zero.
    """

    name: str
    formula: sp.Expr
    kind: str = VALUE

    @property
    def key(self) -> str:
        """Name as `read` returns it."""
        return typed(self.name)


@cache
def _conventions() -> tuple[Convention, ...]:
    turn, normal, d = rigid().parameters[:3], plane().parameters, sp.Symbol("d", real=True)
    world = "your angular velocity is the camera's, that of the package turns the world: w has the other sign"
    return (
        Convention(world, {w: -w for w in turn}),
        Convention("your image plane is n . X = d, that of the package n . X = 1", {n: n / d for n in normal}),
    )


def typed(name: str) -> str:
    """Return a name in letters and digits, with "dot" for a prime; empty for words."""
    if not re.fullmatch(r"[\w^]+'*", name):
        return ""
    return key(name.replace("'", "dot"))


@dataclass(frozen=True)
class Convention:
    """Another choice that is no error, and how the letters change with it."""

    words: str
    changes: Mapping[sp.Symbol, sp.Expr] = field(hash=False)


@dataclass(frozen=True, eq=False)
class Target:
    """The formulas that somebody's derivation is compared with.

    Parameters
    ----------
    lines : tuple of Line
    pool : set of symbols
        Letters that may stand in the lines, besides those that do.
    derivation : function, optional
        Returns the derivation whose result are the lines.
    nonzero : set of symbols
        Letters that are not zero.
    blocks : mapping of names to rows
        Lines that can be typed together: those of step 5 as "step5".
    matrices : mapping of letters to matrices
        Entries of the letters of matrices that may be typed.

    See Also
    --------
    target_of : Makes it.
    percept_obs.check : Compares with it.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.checking import target_of
    >>> target = target_of(PerspectiveSystem(affine(), pinhole()))
    >>> target.read("y3' = -b3 y3^2")[0].formula
    -b3*y3**2
    """

    lines: tuple[Line, ...]
    pool: frozenset[sp.Symbol] = frozenset()
    derivation: Callable[[], Derivation] | None = None
    nonzero: frozenset[sp.Symbol] = frozenset()
    blocks: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    matrices: Mapping[sp.MatrixExpr, sp.ImmutableMatrix] = field(default_factory=dict)

    @cached_property
    def steps(self) -> tuple[tuple[int, Step], ...]:
        """Steps that lead to the lines, with their numbers."""
        steps = enumerate(self.derivation() if self.derivation else (), 1)
        return tuple((number, step) for number, step in steps if step.leads_on)

    @cached_property
    def result(self) -> dict[int, int]:
        """Row in the derivation's result of each line that is in it."""
        if not self.steps:
            return {}
        number, step = self.steps[-1]
        rows = self.blocks.get(f"step{number}", range(len(self.lines)))
        # the last step of a canonical form finds a part of its rate only
        whole = len(rows) == step.onward(list(step.values.values())).rows
        return dict(zip(rows, count(), strict=False)) if whole else {}

    @cached_property
    def rows(self) -> dict[str, int]:
        """Row of each name."""
        return {line.key: row for row, line in enumerate(self.lines) if line.key}

    @cached_property
    def letters(self) -> dict[str, sp.Symbol]:
        """All letters by their names without underscores: those of the lines, the pool, and their hats."""
        used = set().union(self.pool, *(line.formula.free_symbols for line in self.lines))
        known = {key(s.name): s for s in sorted(used, key=str)}
        return {key(s.name): s for s in _neighbours(used) if not self.pool} | known

    @cached_property
    def conventions(self) -> tuple[Convention, ...]:
        """Other choices that are no errors here."""
        letters = set(self.letters.values())
        return tuple(convention for convention in _conventions() if set(convention.changes) <= letters)

    def read(self, mine: Any) -> list[Reading]:
        """Return readings of text, sympy, or a list or a mapping of either."""
        if isinstance(mine, str):
            found = read(mine, *self._known)
            return [replace(r, formula=written_out(r.formula, self.matrices)) for r in found]
        if isinstance(mine, Mapping):
            return [
                replace(r, name=r.name or (f"step{name}" if isinstance(name, int) else typed(str(name))))
                for name, part in mine.items()
                for r in self.read(part)
            ]
        if isinstance(mine, Sequence) and all(isinstance(part, str) for part in mine):
            return self.read("\n".join(mine))
        if isinstance(mine, Sequence):
            return [reading for part in mine for reading in self.read(part)]
        if not isinstance(mine, sp.Basic | sp.MatrixBase | int | float):
            raise ValueError(f"a {type(mine).__name__} is no formula; give text, sympy, or a list or mapping of them")
        formula = sp.sympify(mine, strict=True)
        if formula.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
            raise ValueError(f"the formula {formula} has no finite value; look for a division by zero")
        if isinstance(formula, sp.Eq) and (formula.lhs.is_Symbol or isinstance(formula.lhs, sp.MatrixSymbol)):
            return [Reading(key(formula.lhs.name), self.own(formula.rhs))]
        whole = self.own(formula)
        if isinstance(whole, Relational) and isinstance(whole.lhs, sp.MatrixBase):
            return [Reading("", whole.func(*sides, evaluate=False)) for sides in zip(*whole.args, strict=True)]
        return [Reading("", whole)]

    def words(self, text: str) -> list[Token]:
        """Return the tokens of a text, with the letters of this target told apart."""
        return words_of(text, *self._known)

    @property
    def _known(self) -> tuple[dict[str, Any], list[str]]:
        """Letters that are read, and further names for the left of a line."""
        extra = {s.name: s for c in self.conventions for e in c.changes.values() for s in e.free_symbols}
        matrices = {key(m.name): m for m in self.matrices if m.is_symbol}
        named = {key(each.letter.name): each for each in intermediates(line.formula for line in self.lines)}
        return extra | named | self.letters | matrices, [*self.rows, *self.blocks, *_LABELS]

    def own(self, formula: sp.Basic) -> sp.Basic:
        """Return a formula of sympy in the target's own letters, matched by name."""
        formula = explicit(written_out(formula, self.matrices))
        own = {s: self.letters.get(key(s.name), s) for s in formula.free_symbols}
        return on_sides(lambda side: side.xreplace(own), formula)


_LABELS = ("w", "wT", "phi", "g", "J", "Jm", "x", "x1", "x2", "xdot", "x1dot", "x2dot", "y", "ydot", "nablal")


def _neighbours(letters: set[sp.Symbol]) -> Iterable[sp.Symbol]:
    """Yield letters that differ from these in an index or a hat."""
    for symbol in sorted(letters, key=str):
        stem = symbol.name.rstrip("0123456789")
        indices = min(len(symbol.name) - len(stem), 2)
        names = ["".join((stem, *chosen)) for chosen in product("123", repeat=indices)]
        for other in [sp.Symbol(name, **symbol.assumptions0) for name in names]:
            yield from (other, *hats((other,)))


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
        return _joined(Target(tuple(_line(r.name, r.formula))) for r in read(thing, named))
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
    return Target(_rates(thing.coordinates, thing.rate), pool, derivation=thing.derivation)


@target_of.register
def _(thing: PartitionedSystem) -> Target:
    steps = thing.derivation if isinstance(thing, CanonicalForm) else None
    return Target(_rates((*thing.x1, *thing.x2), thing.rate), _letters(thing), derivation=steps)


@target_of.register
def _(thing: Observer) -> Target:
    target = target_of(thing.equations)
    return replace(target, pool=target.pool | _letters(thing.form))


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
    return Target(tuple(_line("", explicit(thing))))


def _line(name: str, formula: sp.Basic) -> list[Line]:
    """Return the lines of an expression, a matrix or a relation."""
    if isinstance(formula, sp.MatrixBase):
        return [Line("", entry) for entry in formula]
    if isinstance(formula, Relational):
        return relation_lines(formula)
    if isinstance(formula, sp.And | sp.Or):
        return [Line("", condition(formula), ZEROS)]
    return [Line(name, formula)]


def relation_lines(relation: Relational) -> list[Line]:
    """Return a relation as lines: y = f as a value, f = 0 and f != 0 as a set of zeros, matrices entry by entry."""
    left, right = relation.lhs, relation.rhs
    if isinstance(left, sp.MatrixBase) or isinstance(right, sp.MatrixBase):
        pairs = zip(left, right, strict=True)
        return [line for a, b in pairs for line in relation_lines(relation.func(a, b, evaluate=False))]
    if isinstance(relation, sp.Eq | sp.Ne):
        named = isinstance(relation, sp.Eq) and left.is_Symbol
        if right == 0 and not named:
            return [Line("", left, ZEROS)]
        name = primed(left.name) if named else ""
        return [Line(name, right) if named else Line("", left - right, EQUATION)]
    return [Line("", relation.gts - relation.lts, INEQUALITY)]


def primed(name: str) -> str:
    """Return the name of a rate as it is typed: y1' for ydot1."""
    return re.sub(r"dot(\d*)$", r"\1'", name)


def condition(formula: Boolean) -> sp.Expr:
    """Return the expression that is not zero where a condition of parts that are not zero holds."""
    if isinstance(formula, sp.And):
        return sp.Mul(*map(condition, formula.args))
    if isinstance(formula, sp.Or):
        return sp.Add(*(condition(part) ** 2 for part in formula.args))
    if isinstance(formula, sp.Ne):
        return formula.lhs - formula.rhs
    raise ValueError(f"the condition {formula} cannot be compared; give one of parts that must not be zero, f != 0")


def matrix_target(relations: Iterable[Relational]) -> Target:
    """Return a target whose matrices can be typed by their letters, "xi' = G A xi", and are compared entry by entry.

    The inverse of a letter has entries of its own, for written out it is too long.  Refused are a matrix in several
    forms and integrals: entries do not tell whether those are the same.
    """
    relations = tuple(relations)
    named = [r.lhs for r in relations if isinstance(r.lhs, sp.MatrixSymbol)]
    integrals = sp.Tuple(*relations).atoms(sp.Integral)
    if len(set(named)) < len(named) or any(isinstance(i.function, sp.MatrixExpr) for i in integrals):
        raise ValueError("matrices in several forms, or integrals of them, are not compared; name one of the formulas")
    symbols = sp.Tuple(*relations).atoms(sp.MatrixSymbol)
    sizes = sizes_of(*symbols)
    names = {m: m.name for m in symbols} | {m.inv(): f"{m.name}inv" for m in symbols if m.is_square}
    matrices = {m: entries_of(m.xreplace(sizes), "{}_{}{}", 1, name) for m, name in names.items()}
    lines: list[Line] = []
    blocks = {}
    for relation in relations:
        left, right = relation.args
        if isinstance(relation, sp.Eq) and isinstance(left, sp.MatrixSymbol):
            rows = [Line(f"{primed(left.name)}, row {k}", e) for k, e in enumerate(written_out(right, matrices), 1)]
            blocks[key(left.name)] = tuple(range(len(lines), len(lines) + len(rows)))
            lines += rows
        else:
            lines += relation_lines(written_out(relation, matrices))
    return Target(tuple(lines), blocks=blocks, matrices=matrices)
