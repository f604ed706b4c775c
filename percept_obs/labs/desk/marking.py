"""What is said of a sheet: each line as mathematics, what a step has come to, and as many hints as are open."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp

from percept_obs.checking import CannotRead, Review, Verdict
from percept_obs.checking.explaining import sentences
from percept_obs.checking.matching import Judged, judged
from percept_obs.checking.reading import Reading
from percept_obs.checking.review import CANNOT_BE_TOLD, HINTS
from percept_obs.labs.desk.sheets import Sheet
from percept_obs.labs.desk.typed import typed_markup
from percept_obs.labs.shared.markup import markup

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
    """What somebody typed in a line.

    Parameters
    ----------
    markup : str
        It as MathML.
    reading : Reading or None
        It as a formula, unless it cannot be read.
    refusal : str
        Why not.
    position : int
        Where, counted in characters from 0.
    """

    markup: str
    reading: Reading | None = None
    refusal: str = ""
    position: int = 0


@lru_cache(maxsize=1024)
def entry_of(sheet: Sheet, row: int, text: str) -> Entry:
    """What is typed in a line of a sheet."""
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
    """The verdict on a line by itself; None if it cannot be read."""
    reading = entry_of(sheet, row, text).reading
    return judged([reading], sheet.numbered)[0] if reading else None


def review_of(sheet: Sheet, step: int, texts: Mapping[int, str]) -> Review:
    """What is found of a step's lines, in the light of wrong ones in steps before."""
    here = sheet.rows(step)
    known = {row: alone(sheet, row, texts[row]) for row in sorted(texts) if row < here.stop}
    lines = [line for row, line in known.items() if line and row in here]
    if any(line.verdict == Verdict.WRONG for line in lines):
        rows = [row for row, line in known.items() if line and (row in here or line.verdict == Verdict.WRONG)]
        readings = [entry.reading for row in rows if (entry := entry_of(sheet, row, texts[row])).reading]
        lines = [line for line in judged(readings, sheet.numbered) if line.row in here]
    return Review(sheet.numbered, tuple(lines))


def state_of(sheet: Sheet, step: int, texts: Mapping[int, str]) -> dict[str, Any]:
    """How far a step has come: how many of its lines are given, and whether these are right."""
    rows = sheet.rows(step)
    given = [row for row in rows if row in texts]
    verdicts = [line.verdict if (line := alone(sheet, row, texts[row])) else None for row in given]
    mark = "wrong" if Verdict.WRONG in verdicts else "right" if verdicts and None not in verdicts else ""
    return {"mark": mark, "given": len(given), "asked": len(rows)}


def summary_of(review: Review, asked: int) -> str:
    """The verdict on a step in a sentence that names no line."""
    count = len(review.lines)
    wrong = sum(line.verdict == Verdict.WRONG for line in review.lines)
    if not count:
        return ""
    if wrong:
        return (
            "Not right yet."
            if count == 1
            else f"{wrong} of {count} lines {'is' if wrong == 1 else 'are'} not right yet."
        )
    notes = sorted({line.note for line in review.lines if line.note})
    if any(line.verdict == Verdict.CARRIED for line in review.lines):
        return f"Right from there on: {'; '.join(notes)}."
    if review.right is None:
        return CANNOT_BE_TOLD
    begun = "Right" if count == asked else f"Right so far, {count} of {asked} lines"
    return "; ".join([begun, *notes]) + "."


def hints_of(review: Review, hints: int) -> dict[int, dict[str, Any]]:
    """What open hints say, by the row of a line: its mark, and sentences."""
    told = {}
    everything_right = review.right is not False
    for k, line in enumerate(review.lines):
        mark = MARKS[line.verdict] if hints or everything_right else ""
        said = list(_sentences(review, k, hints)) if hints else []
        told[line.row] = {"mark": mark, "told": said}
    return told


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


def offered(review: Review, hints: int) -> tuple[int, str]:
    """The next hint that can be asked for, and what it says; 0 if there is none."""
    if not any(line.verdict == Verdict.WRONG for line in review.lines):
        return 0, ""
    following = hints + 1
    if following == 1 and len(review.lines) == 1:
        following = 2  # the only line is the wrong one
    return (following, HINTS[following - 1]) if following <= len(HINTS) else (0, "")
