"""Colours, lines and markers: the same thing looks the same in every figure."""

from typing import Any

from percept_obs.compile import Array

WIDTH = 7.2  # inches, a notebook's column

# Okabe and Ito's palette, without its yellow, which is too faint for a line on white.
BLACK, BLUE, VERMILLION, GREEN = "#000000", "#0072B2", "#D55E00", "#009E73"
PURPLE, ORANGE, SKY = "#CC79A7", "#E69F00", "#56B4E9"
GREY, LIGHT, PALE = "0.45", "0.9", "0.93"

LINES = ("--", "-.", (0, (1, 1)), (0, (5, 1, 1, 1, 1, 1)))
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
COLOURS = (VERMILLION, BLUE, GREEN, PURPLE, ORANGE)

TRUTH: dict[str, Any] = {"color": BLACK, "linestyle": "-", "linewidth": 1.2, "label": "truth"}
ESTIMATE: dict[str, Any] = {"color": VERMILLION, "linestyle": "--", "linewidth": 1.6, "label": "estimate"}
SAMPLES: dict[str, Any] = {"color": SKY, "linestyle": "", "marker": ".", "alpha": 0.6, "label": "samples"}
BOUND: dict[str, Any] = {"color": GREY, "linestyle": "-", "linewidth": 2.0, "zorder": 1.5}
START: dict[str, Any] = {"marker": "o", "linestyle": "", "markerfacecolor": "white", "label": "start"}
END: dict[str, Any] = {"marker": "s", "linestyle": "", "label": "end"}


def style(number: int) -> dict[str, Any]:
    """Line, marker and colour of one of several curves; any of the three tells neighbours apart."""
    return {
        "linestyle": LINES[number % len(LINES)],
        "marker": MARKERS[number % len(MARKERS)],
        "color": COLOURS[number % len(COLOURS)],
    }


def dots(values: Array, **others: Any) -> dict[str, Any]:
    """The look of samples, smaller where there are many."""
    return {**SAMPLES, "markersize": 3 if len(values) > 1000 else 5, **others}
