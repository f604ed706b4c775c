"""The base of all figures: a picture with its text equivalent, axes in one style, and checks of the data."""

from __future__ import annotations

import base64
import html
import inspect
import io
import os
import sys
from collections.abc import Callable, Generator, Iterable, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import matplotlib
import matplotlib.figure
import numpy as np
from matplotlib.axes import Axes

from percept_obs.compile import Array as Array
from percept_obs.figures.look import GREY, LIGHT, WIDTH
from percept_obs.recording import Recording
from percept_obs.system.view import refuse_several
from percept_obs.tracking.run import Run
from percept_obs.validation import checked, to_write, whole
from percept_obs.validation.kinds import with_article

P = ParamSpec("P")
T = TypeVar("T")
Drawing = Generator[str, None, Sequence[Axes]]
"""Yields sentences about what is drawn, which may be empty, and returns the axes."""

SCREEN, SHARP = 96, 144  # dots an inch: as a browser counts them, and as the picture has them
DESCRIPTION = {".png": "Description", ".svg": "Description", ".pdf": "Subject"}

COMMON = {
    "labels": """
labels : sequence of str, optional
    Names of the curves, one for each; what tells them apart when left out.""",
    "axes": """
axes : sequence of axes, optional
    One for each part, from the top or from the left; new ones when left out.""",
    "ax": """
ax : axes, optional
    New ones when left out.""",
}
"""Docstrings of common parameters."""


@checked
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
        Text equivalent: what a reader sees in it, in words and numbers.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, ibo, pinhole, record, scenarios, track
    >>> run = track(record(scenarios.ma2005_eq35(), 2), ibo(PerspectiveSystem(affine(), pinhole())))
    >>> figure = figures.signals(run)
    >>> len(figure.axes)
    4
    >>> figure.text.partition(".")[0]
    'Outputs and estimates of the identifier-based observer over 0 to 2 s, with y1, y2 measured and y3 hidden'
    """

    figure: matplotlib.figure.Figure
    axes: tuple[Axes, ...]
    text: str

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the picture to a file, in the format that its ending names; the text becomes its description.

        Raises
        ------
        ValueError
            If matplotlib cannot write that format, or the path is a folder.
        """
        target = to_write(path)
        key = DESCRIPTION.get(target.suffix.lower())
        with whole(target if target.suffix else target.with_suffix(".png")) as other:
            self.figure.savefig(other, dpi=2 * SHARP, metadata={key: self.text} if key else None)

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


def figure(refuses: str) -> Callable[[Callable[P, Drawing]], Callable[P, Figure]]:
    """Make a Figure of what a function draws and says; its ValueError is described by `refuses`, after "If".

    Common parameters, Returns and Raises are added to its docstring.
    """

    def of(draw: Callable[P, Drawing]) -> Callable[P, Figure]:
        guarded = checked(draw)

        @wraps(draw)
        def drawn(*args: P.args, **kwargs: P.kwargs) -> Figure:
            axes: list[Axes] = []

            def sentences() -> Generator[str]:
                axes.extend((yield from guarded(*args, **kwargs)))

            text = " ".join(filter(None, sentences()))
            return Figure(root_figure(axes[0]), tuple(axes), text)

        signature = inspect.signature(draw)
        vars(drawn)["__signature__"] = signature.replace(return_annotation="Figure")
        common = "".join(text for name, text in COMMON.items() if name in signature.parameters)
        end = f"\n\nReturns\n-------\nFigure\n\nRaises\n------\nValueError\n    If {refuses}."
        own, mark, example = inspect.cleandoc(draw.__doc__ or "").partition("\n\nExamples\n")
        drawn.__doc__ = f"{own}{common}{end}{mark}{example}"
        return drawn

    return of


def canvas(ax: Axes | None, height: float, **kind: Any) -> Axes:
    """Return the axes, or new ones of a height in inches in a figure that pyplot does not know."""
    if ax is None:
        new = matplotlib.figure.Figure(figsize=(WIDTH, height), layout="constrained")
        with matplotlib.rc_context({"grid.color": LIGHT}):  # three-dimensional axes take it from there only
            ax = new.add_subplot(**kind)
    if ax.name != "3d":
        _tidy(ax)
    return ax


def canvases(axes: Sequence[Axes] | None, parts: Sequence[str], height: float, **layout: Any) -> list[Axes]:
    """Return axes for the parts of a figure, or new ones that `subplots` lays out."""
    if axes is None:
        new = matplotlib.figure.Figure(figsize=(WIDTH, height), layout="constrained")
        axes = np.ravel(new.subplots(**layout, squeeze=False)).tolist()
        new.align_ylabels()
    found: list[Axes] = list(np.ravel(np.asarray(axes, dtype=object)))
    if not len(found) == len(set(found)) == len(parts):
        raise ValueError(f"axes= has {len(set(found))} axes; {len(parts)} are needed, for {', '.join(parts)}")
    for ax in found:
        _tidy(ax)
    return found


def root_figure(ax: Axes) -> Any:
    """Return the figure of the axes, even if they are in a subfigure."""
    return ax.get_figure(root=True)


def rows(axes: Sequence[Axes] | None, heights: Sequence[float], parts: Sequence[str]) -> list[Axes]:
    """Return axes one above the other that share their time; see `canvases`."""
    layout = {"nrows": len(heights), "sharex": True, "height_ratios": heights}
    stack = canvases(axes, parts, sum(heights) + 0.9, **layout)
    stack[-1].set_xlabel("time (s)")
    return stack


def _tidy(ax: Axes) -> None:
    """Remove frames, and put the grid into the background."""
    ax.grid(True, color=LIGHT, linewidth=0.8)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
    ax.spines[["bottom", "left"]].set_color(GREY)
    ax.tick_params(color=GREY)


def legend_above(ax: Axes, centred: bool = False, fitting: int = 80) -> None:
    """Put the legend above the axes, in as many columns as fit into so many letters."""
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


def require_several(data: T | Iterable[T], kind: type[T], source: str) -> list[T]:
    """Return one or several of a kind as a list; the source says what makes one."""
    found: list[Any] = list(data) if isinstance(data, Iterable) else [data]
    if not found or not all(isinstance(each, kind) for each in found):
        raise ValueError(f"{with_article(kind.__name__)} or several are needed, not {data!r}; {source} makes one")
    return found


def recording_and_run(data: Run | Recording) -> tuple[Recording, Run | None]:
    """Return a recording, and the run on it if there is one."""
    return (data.recording, data) if isinstance(data, Run) else (data, None)


def runs_of_one_point(runs: Run | Sequence[Run]) -> list[Run]:
    """Return runs as a list; their times, surfaces and truths must be equal."""
    found = require_several(runs, Run, "track()")
    for run in found:
        refuse_several("this figure", run.recording.view)
    first = found[0].recording
    for number, run in enumerate(found[1:], 2):
        other = run.recording
        same = {
            "surfaces": other.view.fits(first.view),
            "times": np.array_equal(other.time, first.time),
            "truths": equal(other.truth, first.truth),
        }
        differing = [what for what, alike in same.items() if not alike]
        if differing:
            raise ValueError(
                f"run {number} followed another point than run 1: their {' and '.join(differing)} differ; draw runs on "
                "one recording, or one figure for each"
            )
    return found


def equal(one: Any, other: Any) -> bool:
    """Return True if two arrays are equal, or both missing."""
    return one is other if one is None or other is None else np.array_equal(one, other)


def labels_for(labels: Sequence[str] | None, default: Sequence[str]) -> list[str]:
    """Return the labels, or default ones, which are numbered if they repeat."""
    if labels is None:
        repeated = len(set(default)) < len(default)
        return [f"{name} [{k}]" if repeated else name for k, name in enumerate(default, 1)]
    if isinstance(labels, str) or len(labels) != len(default):
        raise ValueError(f"labels= is {labels!r}; a list of {len(default)} is needed, one for each curve")
    if len(set(labels)) < len(labels):
        raise ValueError(f"labels= is {labels!r}; give each curve a label of its own, to tell them apart")
    return list(labels)
