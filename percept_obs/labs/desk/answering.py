"""All that the desk says of a sheet at once: its steps, the lines of the one that is shown, hints and the witness."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from percept_obs.labs.desk.marking import entry_of, hints_of, offered, review_of, state_of, summary_of
from percept_obs.labs.desk.sheets import Sheet
from percept_obs.labs.desk.witness import witness_of
from percept_obs.labs.shared.markup import dotted, markup
from percept_obs.labs.shared.schema import Settings
from percept_obs.system.perspective import PerspectiveSystem


def said_of(sheet: Sheet, settings: Settings, system: PerspectiveSystem) -> Settings:
    """What is said of a sheet with these settings, as plain data for the page."""
    part, steps = settings["part"], range(1, len(sheet.derivation) + 1)
    step = min(settings["step"], len(steps))
    names = [(number, name) for number in steps for name in sheet.derivation[number - 1].values]
    keys = [f"{part} {number} {name}" for number, name in names]
    texts = {row: text for row, key in enumerate(keys) if (text := settings["typed"].get(key, "")).strip()}
    rows, review = sheet.rows(step), review_of(sheet, step, texts)
    hints = int(settings["hints"].get(f"{part} {step}", 0))
    hint, says = offered(review, hints)
    told = hints_of(review, hints)
    reasons = [sheet.derivation[number - 1].reason.rstrip(":") for number in steps]
    return {
        "given": sheet.given,
        "letters": sheet.letters,
        "steps": [{"reason": reasons[k - 1], **state_of(sheet, k, texts)} for k in steps],
        "step": step,
        "lines": [
            {"key": keys[row], "name": names[row][1], "label": _label(names[row][1]), **_line(sheet, row, texts, told)}
            for row in rows
        ],
        "words": summary_of(review, len(rows)),
        "right": review.right if review.lines else None,
        "hint": hint,
        "says": says,
        "witness": witness_of(sheet, rows, texts, system, settings["point"]),
    }


def _line(sheet: Sheet, row: int, texts: Mapping[int, str], told: Mapping[int, Settings]) -> Settings:
    """What is said of a line."""
    if row not in texts:
        return {"markup": "", "mark": "", "told": []}
    entry = entry_of(sheet, row, texts[row])
    if entry.reading is None:
        return {"markup": entry.markup, "mark": "", "told": [], "refusal": entry.refusal, "position": entry.position}
    return {"markup": entry.markup, **told[row]}


def _label(name: str) -> str:
    """The name of a line as MathML; empty for words."""
    stem = name.removesuffix("'")
    if " " in name:
        return ""
    return dotted(sp.Symbol(stem)) if stem != name else markup(sp.Symbol(name))
