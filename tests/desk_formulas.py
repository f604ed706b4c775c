"""Lines for the desk, right and wrong, as people spell them, and how Python and the page judge them."""

import base64
import random
import re
from itertools import product

import sympy as sp
from javascript import run_script
from lab_settings import FRONT

from percept_obs.checking.explaining import plain
from percept_obs.checking.slips import MISTAKES, siblings_in, slips_in
from percept_obs.compile import in_letters
from percept_obs.labs.desk.answers import MARKS, alone, entry_of
from percept_obs.labs.desk.settings import LONGEST_LINE
from percept_obs.labs.desk.sheets import PARTS, sheet_of
from percept_obs.labs.desk.systems import MOTIONS, OBSERVERS, system_of
from percept_obs.labs.desk.texts import sheet_name
from percept_obs.labs.shared.printed import file_of
from percept_obs.labs.shared.surfaces import SURFACES

LARGEST = 60
"""Largest number of operations of a formula that is multiplied out."""


def sheets():
    """All sheets that the desk offers, by their names in the page, each with its line's letters."""
    found = {}
    for motion, surface, part in product(MOTIONS, SURFACES, PARTS):
        system = system_of(motion, surface)
        for outputs, observer in product(system.output_choices, OBSERVERS):
            name = sheet_name(f"{motion} {surface}", outputs, observer, part)
            found.setdefault(name, (system, outputs, observer, part))
    return found


def lines(count, seed):
    """Yield so many lines: sheet, its name, row, text; half of them hold a slip."""
    draw, offered = random.Random(seed), sheets()
    names = draw.sample(sorted(offered), min(len(offered), max(6, count // 40)))
    made = {name: sheet_of(*offered[name]) for name in names}
    for _ in range(count):
        name = draw.choice(names)
        sheet = made[name]
        row = draw.randrange(len(sheet.goal.lines))
        formula = in_letters(sheet.goal.lines[row].formula)
        if draw.random() < 0.5:
            found = list(slips_in(formula, siblings_in(sheet.letters), MISTAKES))
            formula = draw.choice(found).formula if found else formula + 1
        text = spelled(formula, sheet.goal.lines[row].name, draw)
        if len(text) <= LONGEST_LINE:
            yield sheet, name, row, text


def spelled(formula, name, draw):
    """Return a formula as somebody might type it."""
    if formula.count_ops() < LARGEST:
        formula = draw.choice([lambda e: e, sp.expand, sp.expand, sp.together, sp.factor])(formula)
    text = draw.choice([plain, plain, str, compact, sp.latex, sp.latex, small_indices, undecided])(formula)
    if draw.random() < 0.1:  # wrong more often than right
        at = draw.randrange(len(text))
        text = (
            text[:at] + draw.choice(["", "(", ")", "+", "-", "2", "y1", "^", "/", "{", "q", "\\", "ε"]) + text[at + 1 :]
        )
    if re.fullmatch(r"\w+'?", name) and draw.random() < 0.3:
        text = f"{name} = {text}"
    return text


def compact(formula):
    """Letters side by side, as in a31y1."""
    return re.sub(r"(?<=\d) (?=[a-z])", "", plain(formula))


def small_indices(formula):
    """Indices and powers as small signs of Unicode, with a dot for each product."""
    text = re.sub(
        r"(?<=[a-z])\d+", lambda found: found[0].translate(str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")), str(formula)
    )
    return text.replace("**2", "²").replace("*", "·").replace("-", "−")


def undecided(formula):
    """A formula that begins with another sum that is nothing."""
    return f"y1 - (y1 + 3/4) + 0.75 + {plain(formula)}"


def by_python(sheet, row, text):
    """Mark of a line, and whether it is refused."""
    entry = entry_of(sheet, row, text)
    judged = alone(sheet, row, text)
    return {"mark": MARKS[judged.verdict] if judged else "", "refused": bool(entry.refusal)}


def by_the_page(node, chosen):
    """Marks of lines, given as name, row and text, as the page finds them, and the lines as MathML."""
    return [
        {"mark": line["mark"], "refused": bool(line["refusal"]), "markup": line["markup"]}
        for line in _run(node, lines=chosen)["judged"]
    ]


def answers_of_the_page(node, *desks):
    """Answers of the page itself to the settings of desks."""
    settings = [(next(iter(desk.sheets), _name(desk.settings)), desk.settings) for desk in desks]
    return _run(node, settings=settings, own={name: each for desk in desks for name, each in desk.sheets.items()})[
        "answers"
    ]


def _name(settings):
    motion, surface, outputs, observer, part = map(settings.get, ("motion", "surface", "outputs", "observer", "part"))
    return sheet_name(f"{motion} {surface}", outputs, observer, part)


def _run(node, **task):
    texts = base64.b64encode(file_of("desk_lab").read_bytes()).decode()
    return run_script(node, FRONT / "tests/run_desk.js", {"texts": texts, **task})
