"""Plain lines for the desk, right and with a single slip, and how Python and the page judge them."""

import base64
import random
from functools import cache
from itertools import product

import sympy as sp
from javascript import run_script
from lab_settings import FRONT
from sample_sizes import sampled

from percept_obs.checking.explaining import plain
from percept_obs.checking.slips import MISTAKES, siblings_in, slips_in
from percept_obs.compile import in_letters
from percept_obs.labs.desk.settings import LONGEST_LINE
from percept_obs.labs.desk.sheets import PARTS, sheet_of
from percept_obs.labs.desk.systems import MOTIONS, OBSERVERS, system_of
from percept_obs.labs.desk.texts import sheet_name
from percept_obs.labs.shared.printed import file_of
from percept_obs.labs.shared.surfaces import SURFACES

SPELLINGS = (plain, str, lambda formula: plain(formula).replace("_", ""), lambda formula: plain(sp.expand(formula)))
SYSTEMS = sampled([("rigid", "pinhole")], list(product(MOTIONS, SURFACES)))
LARGEST = 60
"""Largest number of operations of a formula that is multiplied out, and so spelled in the last way."""


@cache
def sheets():
    """All sheets of the `SYSTEMS`, by their names in the page, but those for which there is no observer."""
    found = {}
    for (motion, surface), part in product(SYSTEMS, PARTS):
        system = system_of(motion, surface)
        for outputs, observer in product(system.output_choices, OBSERVERS):
            name = sheet_name(f"{motion} {surface}", outputs, observer, part)
            if name not in found:
                try:
                    found[name] = sheet_of(system, outputs, observer, part)
                except ValueError:
                    continue
    return found


def lines(count, seed):
    """Yield so many lines of all sheets, each as sheet, its name, row, text and slip; half of them hold a slip."""
    draw, offered = random.Random(seed), sheets()
    rows = [(name, row) for name, sheet in offered.items() for row in range(len(sheet.goal.lines))]
    for name, row in draw.sample(rows, min(count, len(rows))):
        sheet = offered[name]
        formula = in_letters(sheet.goal.lines[row].formula)
        made = list(slips_in(formula, siblings_in(sheet.letters), MISTAKES)) if draw.random() < 0.5 else []
        slip = draw.choice(made) if made else None
        spelling = draw.choice(SPELLINGS[: 4 if formula.count_ops() < LARGEST else 3])
        text = spelling(slip.formula if slip else formula)
        if len(text) <= LONGEST_LINE:
            yield sheet, name, row, text, slip.kind if slip else ""


def answers_of_the_page(node, *desks):
    """Answers of the page itself to the settings of desks."""
    chosen = [each.settings for each in desks]
    names = [sheet_name(f"{s['motion']} {s['surface']}", s["outputs"], s["observer"], s["part"]) for s in chosen]
    settings = [(next(iter(desk.sheets), name), desk.settings) for desk, name in zip(desks, names, strict=True)]
    own = {name: each for desk in desks for name, each in desk.sheets.items()}
    return in_the_page(node, settings=settings, own=own)["answers"]


def in_the_page(node, **task):
    """Return the page's marks and mathematics of "lines", and by how much each beginning of "grown" lines misses."""
    texts = base64.b64encode(file_of("desk_lab").read_bytes()).decode()
    return run_script(node, FRONT / "tests/run_desk.js", {"texts": texts, **task})
