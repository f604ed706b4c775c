"""Arrows of the image's motion, the true one and that of typed lines: at a point, over the picture, term by term."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np
import sympy as sp

from percept_obs.compile import Array, vectorised
from percept_obs.labs.desk.sheets import Sheet
from percept_obs.labs.desk.systems import number_of
from percept_obs.system.perspective import PerspectiveSystem

Formula: TypeAlias = sp.Expr | None
_SIDE = np.linspace(-0.9, 0.9, 7)
FIELD = np.array([(y1, y2) for y2 in _SIDE for y1 in _SIDE])
"""Places in the image at which pairs of arrows stand."""

MOST_TERMS = 24
"""Largest number of beginnings of a line that are shown."""

_OPEN, _CLOSE, _AFTER = "([{", ")]}", "+-*/^=({[,"


def picture_of(
    sheet: Sheet, step: int, mine: Mapping[int, Formula], system: PerspectiveSystem, point: Sequence[float]
) -> dict[str, Any] | None:
    """Motion of the image by the typed lines of a step, and as it is.

    Parameters
    ----------
    sheet : Sheet
    step : int
        Counted from 1.
    mine : mapping of rows to formulas
        What is typed in this step; None for what cannot be read.
    system : PerspectiveSystem
    point : three floats
        y1, y2 and the inverse distance.

    Returns
    -------
    dict or None
        Motions in 1/s: "true" and "mine" at the point, and "field" with both at the places of `FIELD`; "mine" has None
        for what is not typed or has no value.  "foe" has the true and the typed place where that is what is asked for.
        None for what is no motion of an image, or cannot be drawn in a plane.
    """
    lines = sheet.goal.lines
    image = [k for k, line in enumerate(lines) if line.name in sheet.image]
    if len(image) != 2:
        return None
    own = [_followed(sheet, step, mine, row) for row in image]
    true = [lines[row].formula for row in image]
    places = np.column_stack([FIELD, np.full(len(FIELD), point[2])])
    rows = sheet.rows(step)
    asked = [lines[row].name for row in rows] == [name.removesuffix("'") for name in sheet.image]
    return {
        "names": [lines[row].name for row in image],
        "true": [_numbers(f, system, np.array([point]))[0] for f in true],
        "mine": [_numbers(f, system, np.array([point]))[0] for f in own],
        "field": {
            "places": FIELD.round(6).tolist(),
            "true": [_numbers(f, system, places) for f in true],
            "mine": [_numbers(f, system, places) for f in own],
        },
        "foe": asked
        and {
            "true": [_numbers(lines[row].formula, system, np.array([point]))[0] for row in rows],
            "mine": [_numbers(mine.get(row), system, np.array([point]))[0] for row in rows],
        },
    }


def grown_of(
    sheet: Sheet, row: int, formulas: Mapping[int, Formula], system: PerspectiveSystem, point: Sequence[float]
) -> list[dict[str, Any]]:
    """Beginnings of a line of the image's motion: their ends in the text, their motions, and how far they miss.

    Parameters
    ----------
    formulas : mapping of ends to formulas
        Beginnings of the line that can be read.

    Returns
    -------
    list of dict
        "end", counted in characters; "at", the motion at the point; "field", that over the picture; and "miss", the
        root mean square of the difference from the true motion over the picture, as a part of that of the true one.
    """
    places = np.column_stack([FIELD, np.full(len(FIELD), point[2])])
    true = _values(sheet.goal.lines[row].formula, system, places)
    found = []
    for end, formula in formulas.items():
        mine = _values(formula, system, places)
        miss = float(np.sqrt(np.mean((mine - true) ** 2) / np.mean(true**2))) if true.any() else np.nan
        at, field = _numbers(formula, system, np.array([point]))[0], _listed(mine)
        found.append({"end": end, "at": at, "field": field, "miss": miss if np.isfinite(miss) else None})
    return found


def ends_of(text: str) -> list[int]:
    """Places in a text at which a term of the outermost sum ends; the last one is the text's own.

    Examples
    --------
    >>> text = "-a + (b - c) y1 - d"
    >>> [text[:end] for end in ends_of(text)]
    ['-a', '-a + (b - c) y1', '-a + (b - c) y1 - d']
    """
    depth, before, ends = 0, "=", []
    for k, letter in enumerate(text):
        depth += (letter in _OPEN) - (letter in _CLOSE)
        if letter in "+-" and depth == 0 and before not in _AFTER:
            ends.append(len(text[:k].rstrip()))
        before = before if letter.isspace() else letter
    return [*ends[: MOST_TERMS - 1], len(text)]


def _followed(sheet: Sheet, step: int, mine: Mapping[int, Formula], row: int) -> Formula:
    """Motion that follows from the lines of a step, of which what is not typed is taken from the truth."""
    rows = sheet.rows(step)
    if row in rows:
        return mine.get(row)
    if not mine or None in mine.values() or row not in sheet.goal.result or not sheet.derivation[step - 1].leads_on:
        return None
    return _onward(sheet, step, tuple(mine.get(k, sheet.goal.lines[k].formula) for k in rows), row)


@lru_cache(maxsize=256)
def _onward(sheet: Sheet, step: int, values: tuple[sp.Expr, ...], row: int) -> sp.Expr:
    return sheet.derivation[step - 1].onward(values)[sheet.goal.result[row]]


def _values(formula: Formula, system: PerspectiveSystem, places: Array) -> Array:
    """Numbers of a formula at places (n, 3); not a number where it has none, or holds other letters."""
    letters = {s: number_of(s, system) for s in system.parameters}
    if formula is None or not formula.free_symbols <= {*system.coordinates, *letters}:
        return np.full(len(places), np.nan)
    with np.errstate(all="ignore"):
        (found,) = vectorised(system.coordinates, [formula], letters)(*places.T)
    return np.where(np.isfinite(found), found, np.nan)


def _numbers(formula: Formula, system: PerspectiveSystem, places: Array) -> list[float | None]:
    return _listed(_values(formula, system, places))


def _listed(values: Array) -> list[float | None]:
    return [float(f"{value:.9g}") if np.isfinite(value) else None for value in values]
