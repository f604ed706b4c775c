"""Answers of the desk to a sheet: verdicts and hints; pictures and mathematics are the page's own, of plain lines."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp

from percept_obs.checking import CannotRead, Review, Verdict
from percept_obs.checking.differences import compared
from percept_obs.checking.explaining import plain, sentences
from percept_obs.checking.matching import Judged, judged
from percept_obs.checking.reading import Reading
from percept_obs.checking.review import CANNOT_BE_TOLD
from percept_obs.compile import in_letters
from percept_obs.labs.desk.sheets import Sheet
from percept_obs.labs.shared.markup import markup
from percept_obs.labs.shared.schema import Settings

Words = list[dict[str, str]]
"""A sentence in pieces of text and of MathML."""

HINTS = ("Show the wrong line", "Mark the wrong term", "Say what is wrong", "Say in which step")
"""Labels of the button that gives the next hint, in the order of the hints."""
MARKS = {
    Verdict.RIGHT: "right",
    Verdict.CONVENTION: "right",
    Verdict.WRONG: "wrong",
    Verdict.CARRIED: "carried",
    Verdict.CANNOT_TELL: "unknown",
}


SAID: dict[str, Any] = {
    "begun": "Right so far: a term is missing.",
    "begun many": "Right so far: {count} terms are missing.",
    "wrong": "Not right yet.",
    "wrong one": "1 of {asked} lines is not right yet.",
    "wrong many": "{count} of {asked} lines are not right yet.",
    "carried": "Right from there on{notes}.",
    "follows": "this follows from your “{reason}”, which is wrong",
    "unknown": CANNOT_BE_TOLD,
    "right": "Right{notes}.",
    "right so far": "Right so far, {count} of {asked} lines{notes}.",
    "python": "Python reads this: open the desk in a notebook",
    "unfinished": "something is missing at the end",
    "slips": {
        "sign": "{term} has the wrong sign",
        "factor": "{term} is {times} times what it should be",
        "other": "{term} does not belong here: look at its letters, and at their powers",
    },
    "says": {
        "opening": "How does the image move? Watch a line being derived.",
        "growing": "Each right term brings the blue arrow nearer to the true one.",
        "place": "Where does distance drop out of the motion? A ring shows the place that you type.",
        "empty": "Type what you derive: a blue arrow shows the motion that it means.",
        "lines": "Type the lines of this step, one after the other.",
        "agreed": "Right, here and everywhere: both arrows are one. Type the next line.",
        "calm": "Go on: what is not right is told when you pause.",
        "unread": "A line cannot be read: the place is marked.",
        "next": "Go on to the next step.",
        "last": "This is the last step.",
        "hidden": "Here the slip hides: the arrows agree.",
        "marked": "Mend the marked term.",
        "hints": "Hints open one by one.",
    },
    "unknown system": "Only Python derives this system: open the desk in a notebook, or clear the name.",
    "one formula": "one formula is asked for here, without other equations or relations",
    "other line": "this is the line for {name}; type its right side only",
}
"""Words of a verdict, which the page says as well."""


@dataclass(frozen=True)
class Entry:
    """A line that somebody typed."""

    reading: Reading | None = None  # the line as a formula, unless it cannot be read
    refusal: str = ""  # reason why it cannot be read
    position: int = 0  # place of that, counted in characters from 0


@lru_cache(maxsize=1024)
def entry_of(sheet: Sheet, row: int, text: str) -> Entry:
    """Read a line of a sheet."""
    goal, line = sheet.goal, sheet.goal.lines[row]
    try:
        readings = goal.read(text).lines
    except CannotRead as error:
        return Entry(None, str(error).partition("\n")[0], error.position)
    names = {reading.name for reading in readings}
    formulas = [
        r.formula for r in readings if isinstance(r.formula, sp.Expr) and not isinstance(r.formula, sp.MatrixBase)
    ]
    if len(readings) != 1 or not formulas:
        return Entry(None, SAID["one formula"], len(text))
    if names - {"", line.key}:
        return Entry(None, SAID["other line"].format(name=line.name))
    return Entry(Reading(f"line{row}", formulas[0]))


@lru_cache(maxsize=1024)
def alone(sheet: Sheet, row: int, text: str) -> Judged | None:
    """Return the verdict on a line by itself; None if it cannot be read."""
    reading = entry_of(sheet, row, text).reading
    return judged([reading], sheet.numbered)[0] if reading else None


def review_of(sheet: Sheet, step: int, texts: Mapping[int, str]) -> Review:
    """Check the lines of a step; they may follow from wrong ones in steps before."""
    return _review(sheet, step, tuple(texts.items()))


@lru_cache(maxsize=64)  # so that a slip is looked for once
def _review(sheet: Sheet, step: int, typed: tuple[tuple[int, str], ...]) -> Review:
    texts, here = dict(typed), sheet.rows(step)
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


def summary_of(sheet: Sheet, review: Review, asked: int) -> str:
    """Return the verdict on a step in a sentence that names no line."""
    count = len(review.lines)
    wrong = sum(line.verdict == Verdict.WRONG for line in review.lines)
    if not count:
        return ""
    missing = [missing_in(sheet, line) for line in review.lines if line.verdict == Verdict.WRONG]
    if missing and all(missing):
        return SAID["begun" if sum(missing) == 1 else "begun many"].format(count=sum(missing))
    if wrong:
        which = "wrong" if count == 1 else "wrong one" if wrong == 1 else "wrong many"
        return SAID[which].format(count=wrong, asked=count)
    notes = sorted({line.note for line in review.lines if line.note})
    if any(line.verdict == Verdict.CARRIED for line in review.lines):
        return SAID["carried"].format(notes=f": {'; '.join(notes)}")
    if review.right is None:
        return SAID["unknown"]
    told = "".join(f"; {note}" for note in notes)
    return SAID["right" if count == asked else "right so far"].format(count=count, asked=asked, notes=told)


def missing_in(sheet: Sheet, line: Judged) -> int:
    """Return how many terms a line lacks that is right as far as it goes; 0 for any other."""
    return 0 if line.mine == 0 else _missing(line.mine, sheet.goal.lines[line.row].formula)


@lru_cache(maxsize=1024)
def _missing(mine: sp.Expr, true: sp.Expr) -> int:
    differences, _ = compared(mine, true)
    return len(differences) if all(difference.mine == 0 for difference in differences) else 0


def hints_of(sheet: Sheet, review: Review, hints: int) -> dict[int, dict[str, Any]]:
    """Return the mark and the open hints of each line, by its row."""
    wrong = [line for line in review.lines if line.verdict == Verdict.WRONG]
    begun = {line.row for line in wrong if missing_in(sheet, line)} if hints < 2 else set()
    marked = hints or review.right is not False or len(begun) == len(wrong)
    return {
        line.row: {
            "mark": ("begun" if line.row in begun else MARKS[line.verdict]) if marked else "",
            "told": list(_sentences(sheet, review, k, hints)) if hints else [],
        }
        for k, line in enumerate(review.lines)
    }


def _sentences(sheet: Sheet, review: Review, k: int, hints: int) -> Iterator[Words]:
    line = review.lines[k]
    if hints > 1 and line.verdict == Verdict.WRONG and k in review.explanations:
        shown: list[str] = []

        def show(e: sp.Basic) -> str:
            shown.append(markup(e))
            return f"\0{len(shown) - 1}\0"

        for said in sentences(review.explanations[k], line.mine, show)[: hints - 1]:
            yield from (_pieces(_by_names(sheet, sentence), shown) for sentence in said)
    elif line.note:
        yield [{"text": line.note}]


def _by_names(sheet: Sheet, sentence: str) -> str:
    """Return a sentence with the names of lines in place of their numbers."""
    return re.sub(r"\bline(\d+)\b", lambda m: sheet.goal.lines[int(m[1])].name, sentence)


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
    if following == len(HINTS) and not any(e.steps or any(e.apart) for e in review.explanations.values()):
        return 0, ""
    return (following, HINTS[following - 1]) if following <= len(HINTS) else (0, "")


def answer_to(sheet: Sheet, settings: Settings) -> Settings:
    """Return the answer to a sheet with these settings, as plain data for the page."""
    part, steps = settings["part"], range(1, len(sheet.derivation) + 1)
    step = min(settings["step"], len(steps))
    keys = [f"{part} {number} {name}" for number in steps for name in sheet.derivation[number - 1].values]
    texts = {row: text for row, key in enumerate(keys) if (text := settings["typed"].get(key, "")).strip()}
    rows, review = sheet.rows(step), review_of(sheet, step, texts)
    hints = int(settings["hints"].get(f"{part} {step}", 0))
    hint, says = next_hint(review, hints)
    found = hints_of(sheet, review, hints)
    return {
        "steps": [state_of(sheet, number, texts) for number in steps],
        "lines": [_line(sheet, row, texts, found) for row in rows],
        "words": summary_of(sheet, review, len(rows)),
        "right": review.right if review.lines else None,
        "hint": hint,
        "says": says,
    }


def _line(sheet: Sheet, row: int, texts: Mapping[int, str], hinted: Mapping[int, Settings]) -> Settings:
    """Return the answer to a line."""
    entry = entry_of(sheet, row, texts[row]) if row in texts else Entry()
    if entry.reading:
        return {**hinted[row], "plain": plain(in_letters(entry.reading.formula))}
    told = {"refusal": entry.refusal, "position": entry.position} if entry.refusal else {}
    return {"mark": "", "told": []} | told
