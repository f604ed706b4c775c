"""A numeric witness: what a typed formula gives at a point, and what it should be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from typing import Any

import sympy as sp

from percept_obs.labs.desk.marking import alone
from percept_obs.labs.desk.sheets import Sheet
from percept_obs.labs.desk.systems import number_of
from percept_obs.system.perspective import PerspectiveSystem


def witness_of(
    sheet: Sheet, rows: Sequence[int], texts: Mapping[int, str], system: PerspectiveSystem, point: Sequence[float]
) -> dict[str, Any] | None:
    """The motion of the image at a point, by the typed lines and by the true ones.

    Parameters
    ----------
    sheet : Sheet
    rows : sequence of int
        Lines of the step that is shown.
    texts : mapping of rows to texts
    system : PerspectiveSystem
    point : three floats
        y1, y2 and the inverse distance.

    Returns
    -------
    dict or None
        "true" and "mine" in 1/s, with None for what is not typed or has no value; None if these lines are no image's
        motion, or it cannot be drawn in a plane.
    """
    lines = sheet.goal.lines
    image = [row for name in sheet.image for row in rows if lines[row].name == name]
    if len(image) != 2:
        return None
    coordinates = dict(zip(system.coordinates, point, strict=True))
    numbers = {s: number_of(s, system) for s in system.parameters} | coordinates
    typed = {row: alone(sheet, row, texts[row]) for row in image if row in texts}
    mine = [value(line.mine, numbers) if (line := typed.get(row)) else None for row in image]
    return {
        "names": [lines[row].name for row in image],
        "true": [value(lines[row].formula, numbers) for row in image],
        "mine": mine,
    }


def value(formula: sp.Expr, numbers: Mapping[sp.Symbol, float]) -> float | None:
    """A formula's number; None where it has none."""
    found = formula.xreplace({s: sp.Float(x) for s, x in numbers.items()}).evalf()
    return float(found) if found.is_real and isfinite(found) else None
