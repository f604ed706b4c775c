"""Formulas as people type them, with short names of their targets: `tests/data/formulas/*.toml`."""

import re
import tomllib
from dataclasses import dataclass
from functools import cache

import sympy as sp
from examples import MOTIONS
from places import DATA

from percept_obs import PerspectiveSystem, instantaneous, observers, pinhole
from percept_obs.checking import target_of
from percept_obs.papers import CHWA2019, INABA2005, MA2005
from percept_obs.points.scenarios import moving_body
from percept_obs.structure import COROLLARIES
from percept_obs.system import surfaces
from percept_obs.system.surfaces.base import ImagingSurface, X, Y, Z

FOLDER = DATA / "formulas"
PAPERS = {"ma2005": MA2005, "inaba2005": INABA2005, "chwa2019": CHWA2019}
SURFACES = {make.__name__: make for make in surfaces.SURFACES}
y1, y2, k = sp.symbols("y1 y2 k", real=True)
R, square = sp.sqrt(X**2 + Y**2 + Z**2), y1**2 + y2**2
OWN = {
    "1": ImagingSurface("facing X", (Y / X, Z / X), X, (1, y1, y2)),
    "2": ImagingSurface("tilted", (X / (Y + Z), Y / (Y + Z)), Y + Z, (y1, y2, 1 - y2)),
    "3": ImagingSurface("stretched", (2 * X / Z, Y / Z), Z, (y1 / 2, y2, 1)),
    "4": ImagingSurface("turned", (X / (Z + k * X), Y / (Z + k * X)), Z + k * X, (y1, y2, 1 - k * y1)),
    "5": ImagingSurface("bent", (X / Z + k * (Y / Z) ** 2, Y / Z), Z, (y1 - k * y2**2, y2, 1)),
    "6": ImagingSurface(
        "stereographic",
        (X / (R + Z), Y / (R + Z)),
        R,
        (2 * y1 / (1 + square), 2 * y2 / (1 + square), (1 - square) / (1 + square)),
    ),
    "7": ImagingSurface("hemisphere", (X / R, Y / R), R, (y1, y2, sp.sqrt(1 - square))),
    "8": ImagingSurface(
        "cylinder", (sp.atan(X / Z), Y / sp.sqrt(X**2 + Z**2)), sp.sqrt(X**2 + Z**2), (sp.sin(y1), y2, sp.cos(y1))
    ),
    "9": ImagingSurface(
        "roll", (X / sp.sqrt(Y**2 + Z**2), Y / sp.sqrt(Y**2 + Z**2)), sp.sqrt(Y**2 + Z**2), (y1, y2, sp.sqrt(1 - y2**2))
    ),
}


@dataclass(frozen=True)
class Entry:
    """Text that somebody typed, and what is true of it.

    Of a wrong one `term` is the wrong term and `slip` what the third hint must say; what has two meanings is `asked`
    back in these words.
    """

    text: str
    target: str
    family: str
    right: bool = True
    term: str = ""
    slip: str = ""
    asked: str = ""


@cache
def entries(name):
    """Entries of a file: "right", "wrong" or "asked"."""
    found = tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))["formula"]
    return tuple(Entry(**entry) for entry in found)


@cache
def prints():
    """Numbered equations of the papers as they are printed, by paper and place."""
    found = tomllib.loads((FOLDER / "prints.toml").read_text(encoding="utf-8"))["print"]
    return {f"{each['paper']} {each['place']}": each["text"] for each in found}


@cache
def target(name):
    """Target that a short name stands for.

    Rates of an image: "pinhole", "rigid sphere", "own surface 2"; then the outputs that are measured, "y1" or "y1+y2",
    and a part: "w", "phi", "g", "jacobian", "derivation", "condition".  Flow of an observer, of the pinhole with both
    outputs if not said: "ibo", "ekf y1".  Further "points B", "chwa case 1", "chwa case 1 form", "ledger ma2005 (15)";
    "formula f = a + b" is one of one's own.
    """
    kind, _, rest = name.partition(" ")
    if kind == "formula":
        return target_of(rest)
    if kind == "ledger":
        paper, _, place = rest.partition(" ")
        return target_of(PAPERS[paper][place])
    if kind == "points":
        return target_of(_part(moving_body().form, rest.split()))
    if kind == "chwa":
        choice = COROLLARIES[int(rest.split()[1]) - 1].choice()
        return target_of(choice.form if rest.endswith("form") else choice)
    motion, words = MOTIONS["rigid" if kind == "rigid" else "affine"], name.removeprefix("rigid ").split()
    if words[:2] == ["own", "surface"]:
        surface, words = OWN[words[2]], words[3:]
    elif family := getattr(observers, words[0], None):
        outputs = words[1] if words[1:] else "y1+y2"
        return target_of(family(PerspectiveSystem(motion, pinhole()).measure(*outputs.split("+"))))
    else:
        surface, words = SURFACES[words[0]](), words[1:]
    return target_of(_part(PerspectiveSystem(motion, surface), words))


def _part(thing, words):
    for word in words:
        if re.fullmatch(r"y\d(\+y\d)*", word):
            thing = thing.measure(*word.split("+"))
        elif word == "condition":
            thing = instantaneous(thing)
        else:
            thing = getattr(thing, word)
            thing = thing() if callable(thing) else thing
    return thing
