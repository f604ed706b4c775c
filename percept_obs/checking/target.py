"""The target of a check: lines with names, the letters that may stand in them, and the steps to them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import count, product
from typing import Any

import sympy as sp

from percept_obs.checking.deciding import explicit, on_sides, same
from percept_obs.checking.lines import Line, of_matrices, typed
from percept_obs.checking.matrices import Matrices, in_entries
from percept_obs.checking.points import key
from percept_obs.checking.reading import Definition, Functions, Reading, Text, read
from percept_obs.checking.spelling import LABELS
from percept_obs.compile import intermediates
from percept_obs.observers.parts import hats
from percept_obs.system.derivation import Derivation, Step
from percept_obs.system.motion import rigid
from percept_obs.system.surfaces import plane
from percept_obs.validation import checked, travels


@cache
def _conventions() -> tuple[Convention, ...]:
    turn, normal, d = rigid().parameters[:3], plane().parameters, sp.Symbol("d", real=True)
    world = "your angular velocity turns the world, that of the package is the camera's: w_c has the other sign"
    return (
        Convention(world, {w: -w for w in turn}),
        Convention("your image plane is n . X = d, that of the package n . X = 1", {n: n / d for n in normal}),
    )


@dataclass(frozen=True)
class Convention:
    """Another choice that is no error, and how the letters change with it."""

    words: str
    changes: Mapping[sp.Symbol, sp.Expr] = field(hash=False)


@travels
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
        Entries of the letters of matrices that may be typed, and numbers of the letters that are sizes of them.
    relations : mapping of letters to expressions
        Letters that are known by definition, such as X = y1 / y3 or e1 = y1 - yhat1: they can be read.
    elsewhere : function, optional
        Returns names of other surfaces, and the lines on them.
    idle : tuple of Line
        All lines with the terms whose gains are 0 by default, if there are such terms; see `asked`.
    others : mapping of names to functions of a text
        Targets of lines that may be typed instead, such as "e1dot", the error's rate of an observer.
    functions : mapping of names to functions
        Functions that may be typed besides the usual ones, such as "norm".
    note : str
        What is to be said of a right formula.
    defines : bool
        The lines define their letters, so that no other convention is allowed.

    See Also
    --------
    target_of : Makes it.
    percept_obs.check : Compares with it.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole
    >>> from percept_obs.checking import target_of
    >>> target = target_of(PerspectiveSystem(affine(), pinhole()))
    >>> target.read("y3' = -b3 y3^2").lines[0].formula
    -b3*y3**2
    """

    lines: tuple[Line, ...]
    pool: frozenset[sp.Symbol] = frozenset()
    derivation: Callable[[], Derivation] | None = None
    nonzero: frozenset[sp.Symbol] = frozenset()
    blocks: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    matrices: Matrices = field(default_factory=dict)
    relations: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)
    elsewhere: Callable[[], Mapping[str, tuple[Line, ...]]] | None = None
    idle: tuple[Line, ...] = ()
    others: Mapping[str, Callable[[Text], Target]] = field(default_factory=dict)
    functions: Functions = field(default_factory=dict)
    note: str = ""
    defines: bool = False

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
        used = set().union(self.pool, *(line.formula.free_symbols for line in (*self.lines, *self.idle)))
        known = {key(s.name): s for s in sorted(used, key=str)}
        return {key(s.name): s for s in _neighbours(used) if not self.pool} | known

    @cached_property
    def conventions(self) -> tuple[Convention, ...]:
        """Other choices that are no errors here."""
        letters = set(self.letters.values())
        return tuple(c for c in _conventions() if set(c.changes) <= letters and not self.defines)

    def signed(self, text: Text) -> Target:
        """Return the target with errors of the sign that a text gives them, e1 = yhat1 - y1, and a note on it."""
        error = {key(f"{s.name}dot"): s for s in self.letters.values() if key(f"{s.name}dot") in self.rows}
        known = dict(self.relations)
        given = {r.name: r.formula.xreplace(known) for r in text.lines if key(f"{r.name}dot") in error}
        if not any(same(formula, -self.letters[name]) for name, formula in given.items()):
            return self
        turned = {s: -s for s in error.values() if not same(given.get(key(s.name), -s), s)}
        lines = (replace(each, formula=each.formula.xreplace(turned)) for each in self.lines)
        lines = (replace(each, formula=-each.formula) if error.get(each.key) in turned else each for each in lines)
        relations = {s: e.xreplace(turned) for s, e in self.relations.items()}
        return replace(
            self, lines=tuple(lines), relations=relations, note="with your error, the estimate less the truth"
        )

    def asked(self, text: Text) -> Target:
        """Return the target that a text is about: that of its names, one with gains that are 0 by default, or this."""
        names = [line.name for line in text.lines if line.name in self.others]
        elsewhere = not any(line.name in self.rows for line in text.lines)
        if names and elsewhere:
            return self.others[names[-1]](text)
        if elsewhere and "Vdot" in self.others and any(d.name == "V" for d in text.definitions):
            raise ValueError(
                "V is there without its rate: go on with V' = ...; a bound on it is not compared here, for it depends "
                "on what else is known, but those of the papers are entries of their ledgers, such as MA2005[31]"
            )
        letters, full = ({s for line in lines for s in line.formula.free_symbols} for lines in (self.lines, self.idle))
        typed_ = {s for line in text.lines for s in line.formula.free_symbols}
        return replace(self, lines=self.idle, idle=()) if (full - letters) & typed_ else self

    def read(self, mine: Any) -> Text:
        """Return what is read of text, sympy, or a list or a mapping of either."""
        if isinstance(mine, str):
            found = self._defined(read(mine, *self.known, self.functions))
            written = (replace(r, formula=in_entries(r.formula, self.matrices)) for r in found.lines)
            return self._alone(replace(found, lines=tuple(part for r in written for part in _entry_by_entry(r))))
        if isinstance(mine, Mapping):
            parts = {name: self.read(part) for name, part in mine.items()}
            named = [
                replace(r, name=r.name or (f"step{name}" if isinstance(name, int) else typed(str(name))))
                for name, part in parts.items()
                for r in part.lines
            ]
            return Text(tuple(named), tuple(d for part in parts.values() for d in part.definitions))
        if isinstance(mine, Sequence) and all(isinstance(part, str) for part in mine):
            return self.read(";\n".join(mine))
        if isinstance(mine, Sequence) and not isinstance(mine, bytes):
            texts = [self.read(part) for part in mine]
            return Text(
                tuple(r for part in texts for r in part.lines), tuple(d for part in texts for d in part.definitions)
            )
        return Text(self._of_sympy(mine))

    def _alone(self, text: Text) -> Text:
        """Take the only formula of a text for what is asked, if that is one formula or matrix, whatever its name."""
        if text.lines or not text.definitions or len({line.whole for line in self.lines}) > 1:
            return text
        *rest, last = text.definitions
        formula = in_entries(last.formulas[-1], self.matrices)
        return replace(text, lines=(Reading("", formula, last.at),), definitions=tuple(rest))

    def _of_sympy(self, mine: Any) -> tuple[Reading, ...]:
        """Return the lines of an expression, a matrix or a relation."""
        if isinstance(mine, bool) or not isinstance(mine, sp.Basic | sp.MatrixBase | int | float):
            raise ValueError(f"a {type(mine).__name__} is no formula; give text, sympy, or a list or mapping of them")
        formula = sp.sympify(mine, strict=True)
        if formula.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
            raise ValueError(f"the formula {formula} has no finite value; look for a division by zero")
        if isinstance(formula, sp.Eq) and (formula.lhs.is_Symbol or isinstance(formula.lhs, sp.MatrixSymbol)):
            return (Reading(key(formula.lhs.name), self.own(formula.rhs)),)
        return tuple(_entry_by_entry(Reading("", self.own(formula))))

    @property
    def known(self) -> tuple[dict[str, Any], list[str]]:
        """Letters that may be typed, by their keys, and names that may stand on the left of a line besides."""
        extra = {s.name: s for c in self.conventions for e in c.changes.values() for s in e.free_symbols}
        matrices = {key(m.name): m for m in self.matrices if isinstance(m, sp.MatrixSymbol)}
        named = {key(each.letter.name): each for each in intermediates(line.formula for line in self.lines)}
        related = {key(s.name): s for s in self.relations}
        return extra | named | related | self.letters | matrices, [*self.rows, *self.blocks, *self.others, *LABELS]

    def _defined(self, found: Text) -> Text:
        """Take somebody's lines for letters that are known by definition as definitions, and put them in."""
        mine = {*self.rows, *self.blocks}
        related = {key(s.name): s for s in self.relations if key(s.name) not in mine}
        own = {related[r.name]: r.formula for r in found.lines if r.name in related}
        lines = [r for r in found.lines if r.name not in related]
        if not own or not lines:
            return found
        used = set().union(*(r.formula.free_symbols for r in lines))
        more = (Definition(key(s.name), (formula,), s in used) for s, formula in own.items())
        put = (replace(r, formula=on_sides(lambda side: side.xreplace(own), r.formula)) for r in lines)
        return Text(tuple(put), (*found.definitions, *more))

    @checked
    def own(self, formula: sp.Basic | sp.MatrixBase) -> sp.Basic:
        """Return a formula of sympy in the target's own letters, matched by name."""
        formula = explicit(in_entries(formula, self.matrices))
        own = {s: self.letters.get(key(s.name), s) for s in formula.free_symbols}
        return on_sides(lambda side: side.xreplace(own), formula)


def _entry_by_entry(reading: Reading) -> Iterable[Reading]:
    """Yield the equations of an equation of matrices; other readings as they are."""
    formula = reading.formula
    if isinstance(formula, sp.Eq | sp.Ne) and any(isinstance(side, sp.MatrixBase) for side in formula.args):
        pairs = (formula.func(*sides, evaluate=False) for sides in zip(*of_matrices(formula).args, strict=True))
        # a matrix is not zero where some entry is not
        some = isinstance(formula, sp.Ne) and len(of_matrices(formula).lhs) > 1
        yield from (
            [replace(reading, name="", formula=sp.Or(*pairs, evaluate=False))]
            if some
            else (replace(reading, name="", formula=pair) for pair in pairs)
        )
    else:
        yield reading


def _neighbours(letters: set[sp.Symbol]) -> Iterable[sp.Symbol]:
    """Yield letters that differ from these in an index or a hat."""
    for symbol in sorted(letters, key=str):
        stem = symbol.name.rstrip("0123456789")
        indices = min(len(symbol.name) - len(stem), 2)
        names = ["".join((stem, *chosen)) for chosen in product("123", repeat=indices)]
        for other in [sp.Symbol(name, **symbol.assumptions0) for name in names]:
            yield from (other, *hats((other,)))
