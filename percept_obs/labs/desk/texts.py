"""Texts with which the page judges plain lines by itself: every system's sheets, and words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import product

import sympy as sp

from percept_obs.checking.explaining import plain
from percept_obs.checking.points import key
from percept_obs.compile import in_letters
from percept_obs.labs.desk.answers import HINTS, SAID
from percept_obs.labs.desk.sheets import PARTS, Sheet, label_of, name_of, sheet_of
from percept_obs.labs.desk.systems import MOTIONS, OBSERVERS, numbers_of, system_of
from percept_obs.labs.shared.markup import markup
from percept_obs.labs.shared.printed import Parts, Texts
from percept_obs.labs.shared.surfaces import SURFACES
from percept_obs.system.derivation import Step
from percept_obs.system.perspective import PerspectiveSystem


def texts_for_the_page() -> Parts:
    """Yield the choices that the page shows, and all sheets, by their places."""
    yield (
        "",
        {
            "surfaces": {name: system_of("affine", name).output_choices for name in SURFACES},
            "motions": list(MOTIONS),
            "observers": {name: make.name for name, make in OBSERVERS.items()},
            "parts": PARTS,
            "said": SAID | {"hints": HINTS},
        },
    )
    done: set[str] = set()
    letters: Texts = {}
    for motion, surface, part in product(MOTIONS, SURFACES, PARTS):
        system = system_of(motion, surface)
        for outputs, observer in product(system.output_choices, OBSERVERS):
            name = sheet_name(f"{motion} {surface}", outputs, observer, part)
            if name not in done:
                done.add(name)
                sheet = sheet_for_the_page(system, outputs, observer, part)
                letters |= sheet.pop("markup", {})
                yield f"sheets/{name}", sheet
    yield "markup/letters", dict(sorted(letters.items()))


def sheet_name(whose: str, outputs: Iterable[str], observer: str, part: str) -> str:
    """Return the name by which the page finds a sheet; it holds what the sheet depends on."""
    chosen = {"rate": (), "form": (" ".join(outputs),)}.get(part, (" ".join(outputs), observer))
    return ", ".join((whose, part, *chosen))


def sheet_for_the_page(system: PerspectiveSystem, outputs: tuple[str, ...], observer: str, part: str) -> Texts:
    """Return a sheet as plain data: what is given, what is asked for, and the letters to say it in."""
    title = {"title": f"{system.motion.name} motion on the {system.surface.name} surface"}
    try:
        sheet = sheet_of(system, outputs, observer, part)
    except ValueError as error:
        return title | {"problem": str(error)}
    return title | printed(sheet, numbers_of(system) if len(sheet.image) == 2 else {})


def printed(sheet: Sheet, numbers: Mapping[sp.Symbol, float]) -> Texts:
    """Return a sheet that can be filled in as plain data, with the numbers at which motions are drawn."""
    goal = sheet.goal
    letters, _ = goal.known
    symbols = {name: getattr(each, "letter", each) for name, each in letters.items()}
    meant = {name: each.written_out for name, each in letters.items() if hasattr(each, "letter")}
    meant |= {key(symbol.name): value for symbol, value in goal.relations.items()}
    changes = [(c.words, {key(s.name): _text(e) for s, e in c.changes.items()}) for c in goal.conventions]
    return {
        "given": sheet.given,
        "known": sorted(symbols),
        "markup": {name: markup(symbol) for name, symbol in symbols.items()},
        "meant": {name: _text(value) for name, value in meant.items()},
        "steps": [_step(sheet, number) for number in range(1, len(sheet.derivation) + 1)],
        "image": sheet.image,
        "numbers": {key(s.name): number for s, number in numbers.items()},
        "conventions": [{"words": words, "changes": each} for words, each in changes],
    }


def _step(sheet: Sheet, number: int) -> Texts:
    step, rows = sheet.derivation[number - 1], sheet.rows(number)
    reason = step.reason.rstrip(":")
    lines = [sheet.goal.lines[row] for row in rows]
    return {
        "reason": reason,
        "name": name_of(reason),
        "lines": [
            {"name": line.name, "key": line.key, "label": label_of(line.name), "formula": _text(line.formula)}
            for line in lines
        ],
        "onward": _onward(sheet, step, len(rows)),
    }


def _onward(sheet: Sheet, step: Step, count: int) -> dict[int, str]:
    """Return the derivation's result in a step's lines, named q1, q2, ..., by its rows; empty if it is not known."""
    if not step.leads_on:
        return {}
    values = sp.symbols(f"q1:{count + 1}", real=True)
    found = step.onward(values)
    return {row: _text(found[k]) for row, k in sheet.goal.result.items()}


def _text(formula: sp.Basic) -> str:
    return plain(in_letters(formula))
