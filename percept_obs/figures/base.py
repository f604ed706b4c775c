"""What all figures share: a picture with its text, one palette, and axes in one hand."""

from __future__ import annotations

import base64
import html
import io
import os
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.figure
import numpy as np
import sympy as sp
from matplotlib.axes import Axes
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike, NDArray

from percept_obs.studies.consistency import claimed_interval
from percept_obs.system.surfaces import POINT, ImagingSurface
from percept_obs.system.view import View
from percept_obs.tracking.run import Run

Array = NDArray[np.float64]

ROUND_OFF = 1e-16
"""Below it, what should be positive is round-off; no logarithmic axis goes further down."""

WIDTH = 7.2  # inches, a notebook's column
SCREEN, SHARP = 96, 144  # dots an inch: as a browser counts them, and as the picture has them

# Okabe and Ito's palette, without its yellow, which is too faint for a line on white.
BLACK, BLUE, VERMILLION, GREEN = "#000000", "#0072B2", "#D55E00", "#009E73"
PURPLE, ORANGE, SKY = "#CC79A7", "#E69F00", "#56B4E9"
GREY, LIGHT, PALE = "0.45", "0.9", "0.93"

LINES = ("--", "-.", (0, (1, 1)), (0, (5, 1, 1, 1, 1, 1)))
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
COLOURS = (VERMILLION, BLUE, GREEN, PURPLE, ORANGE)

TRUTH: dict[str, Any] = {"color": BLACK, "linestyle": "-", "linewidth": 1.2, "label": "truth"}
ESTIMATE: dict[str, Any] = {"color": VERMILLION, "linestyle": "--", "linewidth": 1.6, "label": "estimate"}
SAMPLES: dict[str, Any] = {
    "color": SKY,
    "linestyle": "",
    "marker": ".",
    "alpha": 0.6,
    "label": "samples",
}

SMOOTHING = 160
"""Noisy errors are averaged over the duration divided by this."""

CLAIM = r"$\pm 2\sigma$ claimed"
"""Name of the band that an observer's covariance claims."""

NARROWEST = 0.4
"""Least ratio of the two sides of the image that is shown."""

START: dict[str, Any] = {"marker": "o", "linestyle": "", "markerfacecolor": "white", "label": "start"}
END: dict[str, Any] = {"marker": "s", "linestyle": "", "label": "end"}

DESCRIPTION = {".png": "Description", ".svg": "Description", ".pdf": "Subject"}


@dataclass(frozen=True, eq=False, repr=False)
class Figure:
    """A figure and its text equivalent.

    In Jupyter it shows itself as a picture whose alternative text is `text`.

    Parameters
    ----------
    figure : matplotlib Figure
    axes : tuple of matplotlib Axes
        The axes that were drawn on.
    text : str
        What a reader sees in it, in words and numbers.
    """

    figure: matplotlib.figure.Figure
    axes: tuple[Axes, ...]
    text: str

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the picture to a file, in the format that its ending names; the text becomes its description.

        Raises
        ------
        ValueError
            If matplotlib cannot write that format.
        """
        key = DESCRIPTION.get(Path(path).suffix.lower())
        self.figure.savefig(path, dpi=2 * SHARP, metadata={key: self.text} if key else None)

    def _repr_html_(self) -> str:
        picture = io.BytesIO()
        self.figure.savefig(picture, format="png", dpi=SHARP)
        if "matplotlib.pyplot" in sys.modules:
            # Axes may be pyplot's; it would show their figure a second time.
            sys.modules["matplotlib.pyplot"].close(self.figure)
        return (
            f'<img alt="{html.escape(self.text)}" width="{round(SCREEN * self.figure.get_figwidth())}" '
            'style="max-width: 100%; height: auto" '
            f'src="data:image/png;base64,{base64.b64encode(picture.getvalue()).decode()}">'
        )

    def __repr__(self) -> str:
        return f"<Figure: {self.text}>"


def drawn(axes: Sequence[Axes], sentences: Iterable[str]) -> Figure:
    """Gather what was drawn and what is to be said about it."""
    figure: Any = axes[0].get_figure(root=True)
    return Figure(figure, tuple(axes), " ".join(filter(None, sentences)))


def style(number: int) -> dict[str, Any]:
    """Line, marker and colour of one of several curves; any of the three tells neighbours apart."""
    return {
        "linestyle": LINES[number % len(LINES)],
        "marker": MARKERS[number % len(MARKERS)],
        "color": COLOURS[number % len(COLOURS)],
    }


def dots(values: Array, **look: Any) -> dict[str, Any]:
    """The look of samples, smaller where there are many."""
    return {**SAMPLES, "markersize": 3 if len(values) > 1000 else 5, **look}


def new_axes(height: float, **kind: Any) -> Axes:
    """One pair of axes, in a figure that pyplot does not know."""
    figure = matplotlib.figure.Figure(figsize=(WIDTH, height), layout="constrained")
    with matplotlib.rc_context({"grid.color": LIGHT}):  # three-dimensional axes take it from there only
        axes: Axes = figure.add_subplot(**kind)
    return axes


def rows(axes: Sequence[Axes] | None, heights: Sequence[float], content: Sequence[str]) -> list[Axes]:
    """Axes one above the other that share their time: those given, or new ones.

    Raises
    ------
    ValueError
        If their number is not that of the rows.
    """
    if axes is None:
        figure = matplotlib.figure.Figure(figsize=(WIDTH, sum(heights) + 0.9), layout="constrained")
        axes = list(figure.subplots(len(heights), sharex=True, height_ratios=heights, squeeze=False)[:, 0])
        figure.align_ylabels(axes)
    stack: list[Axes] = list(np.ravel(np.asarray(axes, dtype=object)))
    if len(stack) != len(heights):
        raise ValueError(f"axes= has {len(stack)} axes; {len(heights)} are needed, for {', '.join(content)}")
    for ax in stack:
        tidy(ax)
    stack[-1].set_xlabel("time (s)")
    return stack


def tidy(ax: Axes) -> None:
    """Take away what is not data, and put the rest into the background."""
    ax.grid(True, color=LIGHT, linewidth=0.8)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
    ax.spines[["bottom", "left"]].set_color(GREY)
    ax.tick_params(color=GREY)


def note(ax: Axes, words: str) -> None:
    """A remark in small letters above the axes, on the right."""
    ax.set_title(words, loc="right", fontsize="small", color=GREY)


def legend_above(ax: Axes, centred: bool = False, fitting: int = 80) -> None:
    """Name the curves above the axes, where they hide nothing, in as many columns as fit into so many letters."""
    lengths = [8 + len(name.replace("$", "")) for name in ax.get_legend_handles_labels()[1]]
    columns = len(lengths)
    while columns > 1 and sum(max(part) for part in np.array_split(lengths, columns)) > fitting:
        columns -= 1
    legend = ax.legend(
        loc="lower center" if centred else "lower left",
        bbox_to_anchor=(0.5 if centred else 0, 1),
        ncols=columns,
        frameon=False,
        borderaxespad=0.2,
        handlelength=2.6,
        columnspacing=1.4,
    )
    for handle in legend.get_lines():
        if handle.get_marker() == ".":
            handle.set(markersize=8, alpha=1)


def limits(firm: ArrayLike, loose: ArrayLike = (), reach: float = 2.0) -> tuple[float, float]:
    """Ends of an axis that holds all firm values, and those loose ones that are at most some spans away from them."""
    firm, loose = finite(firm), finite(loose)
    low, high = (firm.min(), firm.max()) if firm.size else (0.0, 1.0)
    span = max(high - low, 1e-3 * abs(high), 1e-12)
    near = loose[(loose >= low - reach * span) & (loose <= high + reach * span)]
    low, high = near.min(initial=low), near.max(initial=high)
    margin = 0.06 * max(high - low, span)
    return low - margin, high + margin


def linear_axis(ax: Axes, firm: Array, loose: Array, what: str, reach: float = 2.0) -> str:
    """Let the axis follow the firm values, and say how many of the loose ones it leaves out."""
    ends = limits(firm, loose, reach)
    ax.set_ylim(*ends)
    return _left_out(loose, ends, what)


def log_axis(ax: Axes, values: Array, what: str, highest: float = np.inf, ticks: str = "") -> str:
    """A logarithmic axis without the spikes: towards zero where an error changes its sign, and before divergence."""
    seen = finite(values)
    seen = seen[seen > 0]
    low, high = np.percentile(seen, [3, 99.9], method="lower") if seen.size else (ROUND_OFF, 1.0)
    bottom = max(10.0 ** np.floor(np.log10(low)), ROUND_OFF)
    ax.set_ylim(bottom, max(10 * bottom, min(2 * high, highest)))  # first: there may be nothing to scale
    ax.set_yscale("log")
    ax.minorticks_off()
    if ticks:
        ax.yaxis.set_major_formatter(ticks)
    return _left_out(values, (-np.inf, ax.get_ylim()[1]), what)


def _left_out(values: Array, ends: tuple[float, float], what: str) -> str:
    """Say how many values are not on the axis."""
    seen = finite(values)
    outside = seen[(seen < ends[0]) | (seen > ends[1])]
    return f"Outside the axis: {outside.size} of {what}, {span(outside)}." if outside.size else ""


def finite(values: ArrayLike) -> Array:
    """The values that are neither NaN nor infinite, in one row."""
    array = np.asarray(values, dtype=float).ravel()
    return array[np.isfinite(array)]


def depth_or_range(surface: View) -> tuple[str, str]:
    """The word for a surface's distance, and its letter."""
    if not isinstance(surface, ImagingSurface):
        return "depth", "Z"
    if surface.distance.is_Symbol:
        return "depth", str(surface.distance)
    slopes = [surface.distance.diff(axis) for axis in POINT]
    straight = all(slope.free_symbols.isdisjoint(POINT) for slope in slopes)
    return ("depth", "l") if straight else ("range", "R")


def letter(name: str) -> str:
    """The symbol of a coordinate such as y1, for matplotlib."""
    return f"${sp.latex(sp.Symbol(name))}$"


def label(name: str, surface: View) -> str:
    """How an axis names a coordinate: its symbol, what it is and its unit."""
    if not _is_inverse_distance(name, surface):
        return letter(name)
    return f"{letter(name)[:-1]} = 1/{depth_or_range(surface)[1]}$ (1/m)"


def words(name: str, surface: View) -> str:
    """How a sentence names a coordinate."""
    return f"{name} = 1/{depth_or_range(surface)[1]}" if _is_inverse_distance(name, surface) else name


def _is_inverse_distance(name: str, surface: View) -> bool:
    return isinstance(surface, ImagingSurface) and name == surface.inverse_distance.name


def span(values: ArrayLike) -> str:
    """The range of values, in words."""
    seen = finite(values)
    if not seen.size:
        return "nowhere finite"
    return f"from {seen.min():.3g} to {seen.max():.3g}" if seen.min() < seen.max() else f"{seen[0]:.3g}"


def draw_curves(ax: Axes, time: Array, curves: Array, labels: Sequence[str], looks: Sequence[dict[str, Any]]) -> None:
    """Curves with sparse markers, none of which lies on another."""
    step = max(1, len(time) // 8)
    for number, (curve, name, look) in enumerate(zip(curves, labels, looks, strict=True)):
        every = (step * number // len(curves), step)
        ax.plot(time, curve, label=name, linewidth=1.5, markersize=5, markevery=every, **look)
    ax.set_xlim(time[0], time[-1])


def draw_errors(ax: Axes, time: Array, errors: Array, labels: Sequence[str], looks: Sequence[dict[str, Any]]) -> None:
    """Every error faintly, and over it the root mean square of its neighbourhood."""
    width = 2 * (len(time) // (2 * SMOOTHING)) + 1
    if width > 1:
        for error, look in zip(errors, looks, strict=True):
            ax.plot(time, error, color=look["color"], linewidth=0.5, alpha=0.25)
        errors = np.array([_root_mean_square(error, width) for error in errors])
        note(ax, f"bold: root mean square over {(time[-1] - time[0]) * width / len(time):.1g} s")
    draw_curves(ax, time, errors, labels, looks)


def _root_mean_square(values: Array, width: int) -> Array:
    """Of the finite values in a window around each; NaN where the value itself is."""
    windows = sliding_window_view(np.pad(values, width // 2, constant_values=np.nan), width)
    largest = np.fmax(np.fmax.reduce(windows, axis=1), np.finfo(float).tiny)
    parts = np.nan_to_num(windows / largest[:, None]) ** 2
    count = np.maximum(np.isfinite(windows).sum(axis=1), 1)
    return np.where(np.isnan(values), np.nan, largest * np.sqrt(parts.sum(axis=1) / count))


def bulk(values: Array) -> Array:
    """The values without the smallest and the largest twentieth, which may be a transient."""
    seen = np.sort(finite(values))
    return seen[len(seen) // 20 : len(seen) - len(seen) // 20]


def claim_of_coordinate(ax: Axes, run: Run, column: int, colour: str) -> str:
    """Draw the interval that the observer claims for a coordinate, and say it; nothing if it claims none."""
    if run.observer.covariance is None:
        return ""
    low, high = (end[:, column] for end in claimed_interval(run))
    return draw_claim(ax, run, low, high, None if run.recording.truth is None else run.truth[:, column], colour)


def draw_claim(ax: Axes, run: Run, low: Array, high: Array, truth: Array | None, colour: str) -> str:
    """Draw a band whose infinite ends are at the edge of the axes, and say where it ends and what it holds."""
    reaching = np.where(np.isposinf(high), ax.get_ylim()[1], high)
    named = CLAIM in ax.get_legend_handles_labels()[1]
    name = "_claim" if named else CLAIM
    ax.fill_between(run.time, low, reaching, color=colour, alpha=0.2, linewidth=0, zorder=1, label=name)
    claimed = ~np.isnan(low)
    if not claimed.any():
        return ""
    last = np.flatnonzero(claimed)[-1]
    words = f"The band of two claimed standard deviations is from {low[last]:.3g} to {high[last]:.3g} at the end"
    if truth is None:
        return f"{words}."
    held = np.mean((low <= truth) & (truth <= high))
    return f"{words} and holds the truth in {100 * held:.0f} % of the samples."


def not_a_strip(*ends: tuple[float, float]) -> list[tuple[float, float]]:
    """Limits, the nearer ones drawn apart until no side is much shorter than another."""
    longest = max(high - low for low, high in ends)
    missing = [max(0.0, NARROWEST * longest - (high - low)) / 2 for low, high in ends]
    return [(low - m, high + m) for (low, high), m in zip(ends, missing, strict=True)]


def complete(rows: Array) -> Array:
    """The rows without a gap."""
    return rows[np.isfinite(rows).all(axis=1)]
