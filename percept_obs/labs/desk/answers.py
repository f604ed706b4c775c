"""Answers of the desk to a sheet: steps, lines as mathematics, verdicts, hints, and numbers at a point."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import isfinite
from typing import Any

import sympy as sp

from percept_obs.checking import CannotRead, Review, Verdict
from percept_obs.checking.explaining import sentences
from percept_obs.checking.matching import Judged, judged
from percept_obs.checking.reading import Reading
from percept_obs.checking.review import CANNOT_BE_TOLD, HINTS
from percept_obs.labs.desk.sheets import Sheet
from percept_obs.labs.desk.systems import number_of
from percept_obs.labs.desk.typed import typed_markup
from percept_obs.labs.shared.markup import dotted, markup
from percept_obs.labs.shared.schema import Settings
from percept_obs.system.perspective import PerspectiveSystem

Words = list[dict[str, str]]
"""A sentence in pieces of text and of MathML."""

WRONG = {Verdict.WRONG, Verdict.CARRIED}
MARKS = {
    Verdict.RIGHT: "right",
    Verdict.CONVENTION: "right",
    Verdict.WRONG: "wrong",
    Verdict.CARRIED: "carried",
    Verdict.CANNOT_TELL: "unknown",
}


@dataclass(frozen=True)
class Entry:
    """A line that somebody typed."""

    markup: str  # the line as MathML
    reading: Reading | None = None  # the line as a formula, unless it cannot be read
    refusal: str = ""  # reason why it cannot be read
    position: int = 0  # place of that, counted in characters from 0


@lru_cache(maxsize=1024)
def entry_of(sheet: Sheet, row: int, text: str) -> Entry:
    """Read a line of a sheet."""
    goal, line = sheet.goal, sheet.goal.lines[row]
    try:
        shown = typed_markup(goal.words(text), goal.letters)
    except CannotRead as error:
        return Entry("", None, _first_line(error), error.position)
    try:
        readings = goal.read(text)
    except CannotRead as error:
        return Entry(shown, None, _first_line(error), error.position)
    names = {reading.name for reading in readings}
    formulas = [
        r.formula for r in readings if isinstance(r.formula, sp.Expr) and not isinstance(r.formula, sp.MatrixBase)
    ]
    if len(readings) != 1 or not formulas:
        return Entry(shown, None, "one formula is asked for here, without other equations or relations", len(text))
    if names - {"", line.key}:
        return Entry(shown, None, f"this is the line for {line.name}; type its right side only")
    return Entry(shown, Reading(f"line{row}", formulas[0]))


def _first_line(error: CannotRead) -> str:
    return str(error).partition("\n")[0]


@lru_cache(maxsize=1024)
def alone(sheet: Sheet, row: int, text: str) -> Judged | None:
    """Return the verdict on a line by itself; None if it cannot be read."""
    reading = entry_of(sheet, row, text).reading
    return judged([reading], sheet.numbered)[0] if reading else None


def review_of(sheet: Sheet, step: int, texts: Mapping[int, str]) -> Review:
    """Check the lines of a step; they may follow from wrong ones in steps before."""
    here = sheet.rows(step)
    known = {row: alone(sheet, row, texts[row]) for row in sorted(texts) if row < here.stop}
    lines = [line for row, line in known.items() if line and row in here]
    if any(line.verdict == Verdict.WRONG for line in lines):
        rows = [row for row, line in known.items() if line and (row in here or line.verdict == Verdict.WRONG)]
        readings = [entry.reading for row in rows if (entry := entry_of(sheet, row, texts[row])).reading]
        lines = [line for line in judged(readings, sheet.numbered) if line.row in here]
    return Review(sheet.numbered, tuple(lines))


def state_of(sheet: Sheet, step: int, texts: Mapping[int, str]) -> dict[str, Any]:
    """Return the state of a step: how many of its lines are typed, and whether these are right."""
    rows = sheet.rows(step)
    filled = [row for row in rows if row in texts]
    verdicts = [line.verdict if (line := alone(sheet, row, texts[row])) else None for row in filled]
    mark = "wrong" if Verdict.WRONG in verdicts else "right" if verdicts and None not in verdicts else ""
    return {"mark": mark, "given": len(filled), "asked": len(rows)}


def summary_of(review: Review, asked: int) -> str:
    """Return the verdict on a step in a sentence that names no line."""
    count = len(review.lines)
    wrong = sum(line.verdict == Verdict.WRONG for line in review.lines)
    if not count:
        return ""
    if wrong:
        are = "is" if wrong == 1 else "are"
        return "Not right yet." if count == 1 else f"{wrong} of {count} lines {are} not right yet."
    notes = sorted({line.note for line in review.lines if line.note})
    if any(line.verdict == Verdict.CARRIED for line in review.lines):
        return f"Right from there on: {'; '.join(notes)}."
    if review.right is None:
        return CANNOT_BE_TOLD
    begun = "Right" if count == asked else f"Right so far, {count} of {asked} lines"
    return "; ".join([begun, *notes]) + "."


def hints_of(review: Review, hints: int) -> dict[int, dict[str, Any]]:
    """Return the mark and the open hints of each line, by its row."""
    marked = hints or review.right is not False
    return {
        line.row: {
            "mark": MARKS[line.verdict] if marked else "",
            "told": list(_sentences(review, k, hints)) if hints else [],
        }
        for k, line in enumerate(review.lines)
    }


def _sentences(review: Review, k: int, hints: int) -> Iterator[Words]:
    line = review.lines[k]
    if hints > 1 and line.verdict == Verdict.WRONG and k in review.explanations:
        shown: list[str] = []

        def show(e: sp.Basic) -> str:
            shown.append(markup(e))
            return f"\0{len(shown) - 1}\0"

        for said in sentences(review.explanations[k], line.mine, show)[: hints - 1]:
            yield from (_pieces(sentence, shown) for sentence in said)
    elif line.note:
        yield [{"text": line.note}]


def _pieces(sentence: str, shown: list[str]) -> Words:
    parts = re.split("\0(\\d+)\0", sentence)
    return [{"math": shown[int(part)]} if k % 2 else {"text": part} for k, part in enumerate(parts) if part]


def next_hint(review: Review, hints: int) -> tuple[int, str]:
    """Return the number and the name of the next hint; 0 if there is none."""
    if not any(line.verdict == Verdict.WRONG for line in review.lines):
        return 0, ""
    following = hints + 1
    if following == 1 and len(review.lines) == 1:
        following = 2  # the only line is the wrong one
    return (following, HINTS[following - 1]) if following <= len(HINTS) else (0, "")


def answer_to(sheet: Sheet, settings: Settings, system: PerspectiveSystem) -> Settings:
    """Return the answer to a sheet with these settings, as plain data for the page."""
    part, steps = settings["part"], range(1, len(sheet.derivation) + 1)
    step = min(settings["step"], len(steps))
    names = [(number, name) for number in steps for name in sheet.derivation[number - 1].values]
    keys = [f"{part} {number} {name}" for number, name in names]
    texts = {row: text for row, key in enumerate(keys) if (text := settings["typed"].get(key, "")).strip()}
    rows, review = sheet.rows(step), review_of(sheet, step, texts)
    hints = int(settings["hints"].get(f"{part} {step}", 0))
    hint, says = next_hint(review, hints)
    found = hints_of(review, hints)
    reasons = [sheet.derivation[number - 1].reason.rstrip(":") for number in steps]
    return {
        "given": sheet.given,
        "letters": sheet.letters,
        "steps": [{"reason": reasons[k - 1], **state_of(sheet, k, texts)} for k in steps],
        "step": step,
        "lines": [
            {"key": keys[row], "name": names[row][1], "label": _label(names[row][1]), **_line(sheet, row, texts, found)}
            for row in rows
        ],
        "words": summary_of(review, len(rows)),
        "right": review.right if review.lines else None,
        "hint": hint,
        "says": says,
        "witness": witness_of(sheet, rows, texts, system, settings["point"]),
    }


def _line(sheet: Sheet, row: int, texts: Mapping[int, str], hinted: Mapping[int, Settings]) -> Settings:
    """Return the answer to a line."""
    if row not in texts:
        return {"markup": "", "mark": "", "told": []}
    entry = entry_of(sheet, row, texts[row])
    if entry.reading is None:
        return {"markup": entry.markup, "mark": "", "told": [], "refusal": entry.refusal, "position": entry.position}
    return {"markup": entry.markup, **hinted[row]}


def _label(name: str) -> str:
    """Return the name of a line as MathML; empty for words."""
    stem = name.removesuffix("'")
    if " " in name:
        return ""
    return dotted(sp.Symbol(stem)) if stem != name else markup(sp.Symbol(name))


def witness_of(
    sheet: Sheet, rows: Sequence[int], texts: Mapping[int, str], system: PerspectiveSystem, point: Sequence[float]
) -> dict[str, Any] | None:
    """Return the motion of the image at a point, in 1/s, by the lines that are typed and by the true ones.

    The point is y1, y2 and the inverse distance, and `rows` are the lines of the step that is shown.  None stands for
    what is not typed or has no value, or for all, where these lines are no image's motion or it cannot be drawn in a
    plane.
    """
    lines = sheet.goal.lines
    image = [row for name in sheet.image for row in rows if lines[row].name == name]
    if len(image) != 2:
        return None
    coordinates = dict(zip(system.coordinates, point, strict=True))
    numbers = {s: number_of(s, system) for s in system.parameters} | coordinates
    typed = {row: alone(sheet, row, texts[row]) for row in image if row in texts}
    mine = [_number(line.mine, numbers) if (line := typed.get(row)) else None for row in image]
    return {
        "names": [lines[row].name for row in image],
        "true": [_number(lines[row].formula, numbers) for row in image],
        "mine": mine,
    }


def _number(formula: sp.Expr, numbers: Mapping[sp.Symbol, float]) -> float | None:
    """Return the number of a formula; None where it has none."""
    found = formula.xreplace({s: sp.Float(x) for s, x in numbers.items()}).evalf()
    return float(found) if found.is_real and isfinite(found) else None
