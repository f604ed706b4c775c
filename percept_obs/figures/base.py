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
from numpy.typing import ArrayLike, NDArray

from percept_obs.recording import Recording
from percept_obs.surfaces import POINT, ImagingSurface
from percept_obs.tracking import Run
from percept_obs.views import View

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


def recording_of(data: Run | Recording) -> Recording:
    """The recording itself, or the one that a run followed.

    Raises
    ------
    ValueError
        If it is neither.
    """
    if not isinstance(data, Run | Recording):
        raise ValueError(f"a Run or a Recording is needed, not {data!r}; record() or track() makes one")
    return data.recording if isinstance(data, Run) else data


def list_of_runs(runs: Run | Sequence[Run]) -> list[Run]:
    """One run or several as a list.

    Raises
    ------
    ValueError
        If there is none, or something else among them.
    """
    found = list(runs) if isinstance(runs, Iterable) else [runs]
    if not found:
        raise ValueError("there are no runs to draw; give at least one, such as track(recording, observer)")
    for run in found:
        if not isinstance(run, Run):
            raise ValueError(f"a Run is needed, not {run!r}; track(recording, observer) makes one")
    return found


def same_point(runs: Sequence[Run]) -> None:
    """Refuse runs that did not follow the same point.

    Raises
    ------
    ValueError
        If times, surfaces or truths differ.
    """
    first = runs[0].recording
    for number, run in enumerate(runs[1:], 2):
        other = run.recording
        same = {
            "surfaces": other.surface.fits(first.surface),
            "times": np.array_equal(other.time, first.time),
            "truths": _equal(other.truth, first.truth),
        }
        differing = [what for what, alike in same.items() if not alike]
        if differing:
            raise ValueError(
                f"run {number} followed another point than run 1: their {' and '.join(differing)} differ; draw runs on "
                "one recording, or one figure for each"
            )


def _equal(one: Array | None, other: Array | None) -> bool:
    return one is other if one is None or other is None else np.array_equal(one, other)


def labels_for(items: Sequence[object], labels: Sequence[str] | None, otherwise: Sequence[str]) -> list[str]:
    """The labels if they are given, else the others, numbered if they repeat.

    Raises
    ------
    ValueError
        If there is not one for each item.
    """
    if labels is None:
        repeated = len(set(otherwise)) < len(otherwise)
        return [f"{name} [{k}]" if repeated else name for k, name in enumerate(otherwise, 1)]
    if isinstance(labels, str) or len(labels) != len(items):
        raise ValueError(f"labels= is {labels!r}; a list of {len(items)} is needed, one for each curve")
    return list(labels)


def span(values: ArrayLike) -> str:
    """The range of values, in words."""
    seen = finite(values)
    if not seen.size:
        return "nowhere finite"
    return f"from {seen.min():.3g} to {seen.max():.3g}" if seen.min() < seen.max() else f"{seen[0]:.3g}"


def story(run: Run, tolerance: float = 0.05) -> str:
    """What happened to a run, in sentences: its verdict, resets, divergence and lost samples."""
    if not tolerance > 0:
        raise ValueError(f"the tolerance is {tolerance}; it must be positive")
    verdict, diverged = run.verdict(tolerance), run.diverged_at is not None
    resets = "once" if len(run.resets) == 1 else f"{len(run.resets)} times"
    columns = [run.recording.names.index(name) for name in run.observer.form.measured]
    lost = int(np.isnan(run.recording.outputs[:, columns]).any(axis=1).sum())
    missing = int(np.isnan(run.estimate).any(axis=1).sum())
    sentences = [
        f"{verdict[0].upper()}{verdict[1:]}.",
        f"Before that it was reset {resets}." if diverged and len(run.resets) else "",
        f"From there on {missing} estimates are missing: the curve ends." if missing else "",
        f"{lost} of {len(run.time)} samples were lost." if lost else "",
    ]
    return " ".join(filter(None, sentences))
