"""Match lines with those of the target, and judge each: right, wrong, right by another convention or from there on."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

import sympy as sp
from sympy.core.relational import Relational

from percept_obs.checking.deciding import Decision, decided, on_sides, proportional, same, same_zeros, small
from percept_obs.checking.limits import TooLong, limited
from percept_obs.checking.lines import EQUATION, INEQUALITY, VALUE, ZEROS, condition, primed, relation_lines
from percept_obs.checking.points import key
from percept_obs.checking.reading import Reading, Text
from percept_obs.checking.target import Target


class Verdict(StrEnum):
    """The verdict on a line.

    See Also
    --------
    percept_obs.Review : The verdicts on all lines.
    """

    RIGHT = "right"
    WRONG = "wrong"
    CARRIED = "right from there on"
    CONVENTION = "right, with another convention"
    CANNOT_TELL = "cannot tell"


STRICT = "the two sides are never equal: write < or >"
WEAK = "the two sides may be equal: write <= or >="
LONGEST_LIST = 4
"""Most letters that a note lists to write a formula with; if there are more, it lists those to write out."""
NOT_ZERO = "where this is 0 the condition fails: write > 0 or != 0"
ZERO = "this is to be 0, and not to differ from it: write = 0"
NEGATED = "all entries of your matrix have the other sign"
TRANSPOSED = "your matrix is the transpose of the one asked for"
SAID = {INEQUALITY: (STRICT, WEAK), ZEROS: (NOT_ZERO, ZERO)}
"""Sentences for a weak sign where a strict one is asked for, and for a strict one in place of a weak one."""


@dataclass(frozen=True, eq=False)
class Judged:
    """My line, the target's row that it should be, and its verdict.

    The note says which convention, which earlier line was wrong, or what is wrong with all lines; `at` is where the
    line stands in the text, -1 if it was none.
    """

    row: int
    mine: sp.Expr
    verdict: Verdict
    note: str = ""
    at: int = -1


def judged(readings: Sequence[Reading], target: Target) -> tuple[Judged, ...]:
    """Return each line with its verdict."""
    readings, known = _with_definitions_put_in(readings, target)
    assigned = _assigned(readings, target)
    lines = [_judged(formula, target, row, strict) for row, formula, strict in assigned]
    if len(lines) == len(readings):
        lines = [replace(line, at=r.at) for line, r in zip(lines, readings, strict=True)]
    found = _carried(_by_convention(_turned(lines, readings, assigned, target), target), target)
    return tuple(_noted(line, known) if line.verdict == Verdict.RIGHT else line for line in found)


def _with_definitions_put_in(readings: Sequence[Reading], target: Target) -> tuple[list[Reading], str]:
    """Return lines with what X, e1 or w1 are by definition put in, and a note on how to write them instead.

    A line that says no more than that, such as y3 = 1/Z, is left out.
    """
    readings = [r for r in readings if not _is_known(r, target)] or readings
    own = set().union(*(line.formula.free_symbols for line in target.lines))
    typed = set().union(*(r.formula.free_symbols for r in readings))
    known = {s: e for s, e in target.relations.items() if s in typed - own}
    if not known:
        return list(readings), ""
    letters = sorted({str(s) for e in known.values() for s in e.free_symbols})
    many = len(letters) > LONGEST_LIST
    how = (
        f"write out {', '.join(sorted(primed(str(s)) for s in known))}"
        if many
        else f"write it with {', '.join(letters)}"
    )
    put_in = [replace(r, formula=on_sides(lambda side: side.xreplace(known), r.formula)) for r in readings]
    return put_in, f"now {how}"


def _is_known(reading: Reading, target: Target) -> bool:
    letter = target.letters.get(reading.name)
    named = letter is not None and reading.name not in target.rows and reading.name not in target.blocks
    used = set(target.relations) & reading.formula.free_symbols
    return bool(
        named and (used or reading.formula == letter) and same(reading.formula.xreplace(dict(target.relations)), letter)
    )


def _noted(line: Judged, note: str) -> Judged:
    return replace(line, note="; ".join(filter(None, (line.note, note))))


def _judged(mine: sp.Expr, target: Target, row: int, strict: bool | None) -> Judged:
    """Return a line with its verdict, and how or where that holds; the line may be strict, a < b, or not, a <= b."""
    try:
        found = limited(lambda: _decided(mine, target, row))
    except TooLong as error:
        return Judged(row, mine, Verdict.CANNOT_TELL, str(error))
    verdict, line = _as_verdict(found), target.lines[row]
    if verdict == Verdict.RIGHT and line.kind in SAID and strict is not None and strict != line.strict:
        return Judged(row, mine, Verdict.WRONG, SAID[line.kind][0 if line.strict else 1])
    return Judged(row, mine, verdict, found.words)


def _verdict(mine: sp.Expr, target: Target, row: int) -> Verdict:
    try:
        return _as_verdict(limited(lambda: _decided(mine, target, row)))
    except TooLong:
        return Verdict.CANNOT_TELL


def _as_verdict(found: Decision) -> Verdict:
    return Verdict.CANNOT_TELL if found.truth is None else Verdict.RIGHT if found.truth else Verdict.WRONG


def _decided(mine: sp.Expr, target: Target, row: int) -> Decision:
    line = target.lines[row]
    if line.kind == VALUE:
        return decided(mine, line.formula)
    if line.kind == ZEROS:
        return Decision(same_zeros(mine, line.formula, target.nonzero))
    return Decision(proportional(mine, line.formula, positive=line.kind == INEQUALITY))


def _assigned(readings: Sequence[Reading], target: Target) -> list[tuple[int, sp.Expr, bool | None]]:
    """Return for each formula its row in the target, its expression, and if it is strict; None of an equation."""
    count, rows = len(target.lines), target.rows
    assigned: list[tuple[int, sp.Expr, bool | None]] = []
    unnamed = [r for r in readings if r.name not in rows and r.name not in target.blocks]
    start = 0
    nameless = range(count) if len(unnamed) == count else [k for k, line in enumerate(target.lines) if not line.key]
    for reading in readings:
        name, formula = reading.name, reading.formula
        _refuse_another_name(name, target)
        if formula == 0 and len(target.blocks.get(name, ())) > 1:
            formula = sp.ImmutableMatrix.zeros(len(target.blocks[name]), 1)
        if isinstance(formula, sp.MatrixBase):
            names = name.split(",")
            if all(part in rows for part in names) and len(names) == len(formula):
                block: Sequence[int] = [rows[part] for part in names]
            else:
                forms = [rows for key, rows in target.blocks.items() if key in (name, f"{name}, another form")]
                forms = [rows for rows in forms if _all_right(formula, target, rows)] or forms
                block = forms[0] if forms else range(start, min(start + len(formula), count))
                start += len(formula) if name not in target.blocks else 0
            if len(block) != len(formula):
                raise ValueError(f"a matrix with {len(formula)} entries does not fit: {_asked(target)} are asked for")
            entries = formula.T if name == "wT" else formula
            assigned += [(row, entry, None) for row, entry in zip(block, entries, strict=True)]
            continue
        if name in rows:
            # of lines with the same name, such as a formula that is printed in two forms, the one that is meant
            twins = (k for k, line in enumerate(target.lines) if line.key == name)
            row = next((k for k in twins if _verdict(formula, target, k) == Verdict.RIGHT), rows[name])
        elif count == 1:
            row = 0
            if name in target.letters and target.lines[0].kind == ZEROS:
                formula = target.letters[name] - formula
        elif name in target.blocks and len(target.blocks[name]) == 1:
            (row,) = target.blocks[name]
        elif name in target.blocks:
            raise ValueError(
                f"{name} has {len(target.blocks[name])} entries; write it as a column, {name} = [..., ...]"
            )
        elif len(unnamed) == len(nameless):
            row, start = nameless[start], start + 1
        elif not name and (near := _nearest(formula, target)) is not None:
            row = near
        else:
            what = f"the line {name}" if name else "a line without a name"
            raise ValueError(f"{what} is none of those asked for: {_asked(target)}; begin it with its name and =")
        strict = relation_lines(formula)[0].strict if isinstance(formula, Relational) else None
        assigned.append((row, _scalar(formula, target, row), strict))
    return assigned


def _nearest(formula: sp.Basic, target: Target) -> int | None:
    """Return the row that a line without a name equals, or with which it shares most terms; None if with none."""
    if not isinstance(formula, sp.Expr):
        fits = [k for k, line in enumerate(target.lines) if line.kind in SAID]
        return next((k for k in fits if _verdict(_scalar(formula, target, k), target, k) == Verdict.RIGHT), None)
    if not small(formula, *(line.formula for line in target.lines)):
        return None
    terms = set(sp.Add.make_args(sp.expand(formula)))
    rows = [set(sp.Add.make_args(sp.expand(line.formula))) for line in target.lines]
    shared = [len(terms & row) / max(len(terms), len(row)) for row in rows]
    return shared.index(max(shared)) if max(shared) > 1 / 3 else None


def _refuse_another_name(name: str, target: Target) -> None:
    """Refuse a line that names another part of a form than the one that is asked for."""
    stems = {re.sub(r"T$|\d+$", "", part) for part in name.split(",")}
    if name and target.blocks and not any(line.name for line in target.lines) and not stems <= set(target.blocks):
        raise ValueError(
            f"the line {name} is none of those asked for: {', '.join(target.blocks)}; call it so, or leave its name out"
        )


def _all_right(matrix: sp.MatrixBase, target: Target, rows: Sequence[int]) -> bool:
    return len(matrix) == len(rows) and all(
        _verdict(entry, target, row) == Verdict.RIGHT for entry, row in zip(matrix, rows, strict=True)
    )


def _asked(target: Target) -> str:
    named = dict.fromkeys(line.whole for line in target.lines if line.name)
    return ", ".join(named or [f"{len(target.lines)} lines in a row"])


def _turned(
    lines: list[Judged],
    readings: Sequence[Reading],
    assigned: Sequence[tuple[int, sp.Expr, bool | None]],
    target: Target,
) -> list[Judged]:
    """Add a note to lines that are wrong only because a matrix is transposed."""
    if (
        len(readings) != 1
        or not isinstance(readings[0].formula, sp.MatrixBase)
        or not any(line.verdict == Verdict.WRONG for line in lines)
    ):
        return lines
    for note, matrix in ((TRANSPOSED, readings[0].formula.T), (NEGATED, -readings[0].formula)):
        entries = zip(matrix, (row for row, *_ in assigned), strict=True)
        if all(_verdict(entry, target, row) == Verdict.RIGHT for entry, row in entries):
            return [replace(line, note=note) if line.verdict == Verdict.WRONG else line for line in lines]
    return lines


def _scalar(formula: sp.Basic, target: Target, row: int) -> sp.Expr:
    """Return a line as an expression, comparable with the target's line."""
    kind = target.lines[row].kind
    if isinstance(formula, sp.And | sp.Or) or (kind == ZEROS and isinstance(formula, Relational)):
        weak = isinstance(formula, sp.Eq | sp.GreaterThan | sp.LessThan)
        return condition(sp.Ne(*formula.args, evaluate=False) if weak else formula)
    letter = next((s for s in formula.free_symbols if key(s.name) == target.lines[row].key), None)
    if kind == VALUE and letter and isinstance(formula, sp.Eq):  # 2 x = 4 y, where x = 2 y is asked for
        gap = formula.lhs - formula.rhs
        slope = gap.diff(letter)
        if slope != 0 and not slope.has(letter):
            return -gap.subs(letter, 0) / slope
    if isinstance(formula, Relational):
        (line,) = relation_lines(formula)
        if line.kind not in (kind, VALUE) and kind in (EQUATION, INEQUALITY, VALUE):
            raise ValueError(f"an expression is asked for, not the relation {formula}")
        return line.formula
    return formula


def _by_convention(lines: list[Judged], target: Target) -> list[Judged]:
    """Mark lines that only follow another convention."""
    if not any(line.verdict == Verdict.WRONG for line in lines):
        return lines
    for convention in target.conventions:
        changed = [replace(line, formula=line.formula.xreplace(dict(convention.changes))) for line in target.lines]
        asked = sp.Tuple(*(target.lines[line.row].formula for line in lines))
        # one letter alone with the other sign is a slip
        several = len(asked.free_symbols & set(convention.changes)) > 1
        other = replace(target, lines=tuple(changed))
        if several and all(_verdict(line.mine, other, line.row) == Verdict.RIGHT for line in lines):
            return [
                replace(line, verdict=Verdict.CONVENTION, note=convention.words)
                if line.verdict == Verdict.WRONG
                else line
                for line in lines
            ]
    return lines


def steps(text: Text, lines: Sequence[Judged], target: Target, mine: Any) -> str:
    """Say of somebody's derivation which line is the first wrong one, and if it follows from the one before."""
    places = sorted({r.at for r in text.lines} | {d.at for d in text.definitions})
    if not isinstance(mine, str) or len(places) < 2:
        return ""
    rows = [mine.count("\n", 0, at) for at in places]
    several = sorted(set(rows)) if len(set(rows)) > 1 else []
    number = {
        at: several.index(row) + 1 if several else k for k, (at, row) in enumerate(zip(places, rows, strict=True), 1)
    }
    known = {key(s.name): e for s, e in target.relations.items()}
    for d in text.definitions:
        if d.name in known and same(d.formulas[-1].xreplace(dict(target.relations)), known[d.name]) is False:
            return f"in line {number[d.at]} your {primed(d.name)} is not what is known of it"
    for k, line in enumerate(lines):
        before = [other for other in lines[:k] if other.row == line.row and other.verdict == Verdict.RIGHT]
        if line.verdict == Verdict.WRONG and before and line.at >= 0:
            here, there = number.get(line.at, k + 1), number.get(before[-1].at, k)
            carried = [each for each in lines[k + 1 :] if each.row == line.row]
            rest = "; from there on it is right" * bool(carried and {e.verdict for e in carried} == {Verdict.CARRIED})
            return f"line {here} does not follow from line {there}{rest}"
    return ""


def _carried(lines: list[Judged], target: Target) -> Iterator[Judged]:
    """Mark lines that follow correctly from a wrong one before."""
    for k, line in enumerate(lines):
        before = [other for other in lines[:k] if other.verdict == Verdict.WRONG]
        note = _follows(line, before, lines[:k], target) if line.verdict == Verdict.WRONG and before else ""
        yield replace(line, verdict=Verdict.CARRIED, note=note) if note else line


def _follows(line: Judged, wrong: Sequence[Judged], before: Sequence[Judged], target: Target) -> str:
    """Say from which wrong line this one follows; empty if from none."""
    if any(other.row == line.row and same(other.mine, line.mine) for other in wrong):
        return "this follows from the line before, which is wrong"
    mine = {other.row: other.mine for other in before}
    for number, step in target.steps:
        block = target.blocks.get(f"step{number}", ())
        if line.row in target.result and any(other.row in block for other in wrong) and line.row not in block:
            values = [mine.get(row, target.lines[row].formula) for row in block]
            if same(step.onward(values)[target.result[line.row]], line.mine):
                return f"this follows from your “{step.reason.rstrip(':')}”, which is wrong"
    return ""
