"""The one language of marks: the same thing has the same colour, line and mark in every figure and in every lab.

The labs take it from here as well: ``percept_obs.labs.printing`` writes it into the page's sources.
"""

import json
from collections.abc import Mapping, Sized
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from percept_obs.compile import Array

WIDTH = 7.2  # inches, a notebook's column

# Okabe and Ito's palette, without its yellow, which is too faint for a line on white.
BLACK, BLUE, VERMILLION, GREEN = "#000000", "#0072B2", "#D55E00", "#009E73"
PURPLE, ORANGE, SKY = "#CC79A7", "#E69F00", "#56B4E9"
GREY, LIGHT, PALE = "0.45", "0.9", "0.93"


@dataclass(frozen=True)
class Tone:
    """A colour in figures, and in labs on white and on black, where small letters in it must be readable."""

    figure: str
    light: str
    dark: str


CURVES = (
    Tone(BLUE, "#0a5fbf", "#6cb2ff"),
    Tone(VERMILLION, "#b04a00", "#ffa35c"),
    Tone(GREEN, "#0b7a5c", "#4fd0a8"),
    Tone(PURPLE, "#a3267f", "#ff8ed2"),
    Tone(ORANGE, "#6b6a00", "#d9d44e"),
)
"""Colours of the first curves that are compared."""

MORE_CURVES = tuple(
    zip(
        ("#6a3fc4", "#00738a", "#8a5a2b", "#50647a", "#cf1f1f", "#3d7a00", "#2f3fa0"),
        ("#b9a0ff", "#52d6ec", "#dcae84", "#a9bed6", "#ff6b5e", "#a5dd6b", "#9fb0ff"),
        strict=True,
    )
)
"""Colours of further curves in the labs, on white and on black; figures begin anew."""

NAMED: Mapping[str, Tone] = MappingProxyType(
    {
        "sample": Tone(SKY, "#86b7d8", "#42708f"),
        "warning": Tone(VERMILLION, "#a8323e", "#ff8a93"),
        "noise": Tone(ORANGE, "#a87900", "#e8bd4a"),
        "kept": Tone(PURPLE, "#7d6b99", "#b9a5d9"),
    }
)
"""Colours of samples, of warnings (the focus of expansion too), of noise, and of a kept run."""

DASHES = (
    *((7, 4), (10, 3, 2, 3), (2, 3), (9, 3, 2, 3, 2, 3), (16, 4), (4, 2, 4, 7), (2, 7), (16, 3, 5, 3)),
    *((13, 3, 2, 3, 7, 3), (5, 2, 5, 8), (11, 2), (3, 6, 9, 6)),
)
"""Dashes of the same curves, in pixels along a line two pixels wide."""

PATTERNS: Mapping[str, tuple[int, ...]] = MappingProxyType(
    {"SOLID": (), "KEPT": (1, 3), "FIT": (5, 3), "BOUND": (1, 5), "QUIET": (4, 2)}
)
"""Dashes of the truth, a kept run, a fit, a bound, and a run without noise."""

LINES: tuple[Any, ...] = ("--", "-.", *((0, tuple(length / 2 for length in dash)) for dash in DASHES[2:4]))
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
COLOURS = tuple(tone.figure for tone in CURVES)

TRUTH: dict[str, Any] = {"color": BLACK, "linestyle": "-", "linewidth": 1.2, "label": "truth"}
ESTIMATE: dict[str, Any] = {"color": COLOURS[0], "linestyle": LINES[0], "linewidth": 1.6, "label": "estimate"}
SAMPLES: dict[str, Any] = {
    **{"color": NAMED["sample"].figure, "linestyle": "", "marker": ".", "alpha": 0.6},
    "label": "samples",
}
BOUND: dict[str, Any] = {"color": GREY, "linestyle": "-", "linewidth": 2.0, "zorder": 1.5}
START: dict[str, Any] = {"marker": "o", "linestyle": "", "markerfacecolor": "white", "label": "start"}
END: dict[str, Any] = {"marker": "s", "linestyle": "", "label": "end"}
UNSEEN = NAMED["warning"].figure
FOCUS: dict[str, Any] = {
    **{"color": UNSEEN, "marker": "D", "linestyle": "", "markersize": 8},
    **{"markerfacecolor": "none", "markeredgewidth": 1.6},
}


def style(number: int) -> dict[str, Any]:
    """Line, marker and colour of one of several curves; any of the three tells neighbours apart."""
    return {
        "linestyle": LINES[number % len(LINES)],
        "marker": MARKERS[number % len(MARKERS)],
        "color": COLOURS[number % len(COLOURS)],
    }


def styles(curves: Sized) -> list[dict[str, Any]]:
    """Line, marker and colour of each of several curves."""
    return [style(number) for number in range(len(curves))]


def dots(values: Array, **others: Any) -> dict[str, Any]:
    """The look of samples, smaller where there are many."""
    return {**SAMPLES, "markersize": 3 if len(values) > 1000 else 5, **others}


def for_the_page() -> str:
    """The page's module ``draw/looks.js``: dashes, and the colours of both themes as a style sheet."""
    pairs = [*((tone.light, tone.dark) for tone in CURVES), *MORE_CURVES]
    named = {f"line-{k}": pair for k, pair in enumerate(pairs)} | {n: (t.light, t.dark) for n, t in NAMED.items()}
    rules = [
        f"{where} {{ {' '.join(f'--lab-{name}: {pair[theme]};' for name, pair in named.items())} }}"
        for theme, where in enumerate((".percept-lab", ".percept-lab.dark"))
    ]
    for k in range(len(pairs)):
        rules.append(f".percept-lab .swatch-{k} {{ stroke: var(--lab-line-{k}); }}")
        rules.append(f".percept-lab .point-{k} {{ color: var(--lab-line-{k}); }}")
    told = {"DASHES": DASHES, **PATTERNS, "COLOURS": "\n".join(rules)}
    lines = [f"export const {name} = {json.dumps(value)};" for name, value in told.items()]
    return "\n".join(["// Printed by percept_obs/figures/look.py, which says what they mean.", *lines, ""])
