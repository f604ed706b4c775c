"""The figure of a comparison: how soon observers settle and how large their errors are, over many recordings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from percept_obs.figures import look
from percept_obs.figures.base import Drawing, canvases, figure
from percept_obs.figures.words import finite
from percept_obs.studies.comparison import summary

if TYPE_CHECKING:
    import pandas as pd

PANELS = {"settling_time": "settling time (s)", "rms": "rms error of 1/distance (1/m)"}

RUN: dict[str, Any] = {"color": look.SKY, "linestyle": "", "marker": "|", "markersize": 12}
SPREAD: dict[str, Any] = {"color": look.BLACK, "linewidth": 1.6, "marker": "|", "markersize": 6}
MEDIAN: dict[str, Any] = {"color": look.BLACK, "linestyle": "", "marker": "o", "markersize": 5}
NONE: dict[str, Any] = {"color": look.VERMILLION, "linestyle": "", "marker": "X", "markersize": 8}
KEY = {"a run": RUN, "median": MEDIAN, "16 to 84 % of the runs": SPREAD, "none: half of the runs fail, or more": NONE}


@figure("the table is empty or not from `compare`, or there are not two axes")
def comparison(table: pd.DataFrame, axes: Sequence[Axes] | None = None) -> Drawing:
    """Settling time and root mean square error of every observer: each run, the median, and 16 to 84 % of the runs.

    A run that does not settle has no settling time, and one that diverged has no error: what they lack stands at the
    right edge, and how many they are beside the observer's name.

    Parameters
    ----------
    table : pandas.DataFrame
        From `percept_obs.studies.comparison.compare`.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, ibo, pinhole, record, scenarios
    >>> from percept_obs.studies.comparison import compare
    >>> observer = ibo(PerspectiveSystem(affine(), pinhole()))
    >>> table = compare([record(scenarios.ma2005_eq35(), 5)], [observer])
    >>> print(figures.comparison(table).text.split(". ")[0])
    Settling time and rms error of every observer, on logarithmic axes
    """
    if not len(table) or not {"observer", *PANELS} <= set(table.columns):
        raise ValueError("the table has no runs; compare(recordings, observers) makes one that has")
    found = summary(table)
    pair = canvases(axes, ["settling time", "error"], 1.3 + 0.42 * len(found), ncols=2, sharey=True)
    for ax, (column, title) in zip(pair, PANELS.items(), strict=True):
        _draw(ax, table, found, column)
        ax.set_xlabel(title)
        ax.set_yticks(range(len(found)), [f"{label}\n{_counts(row)}" for label, row in found.iterrows()])
        ax.set_ylim(len(found) - 0.5, -0.5)
    whole: Any = pair[0].get_figure(root=True)
    whole.legend(
        handles=[Line2D([], [], label=name, **looks) for name, looks in KEY.items()],
        loc="outside upper center" if whole.get_layout_engine() else "upper center",
        ncols=2,
        frameon=False,
    )
    yield "Settling time and rms error of every observer, on logarithmic axes."
    for label, row in found.iterrows():
        yield f"{label}: {_counts(row)}; {_medians(row)}."
    return pair


def _draw(ax: Axes, table: pd.DataFrame, found: pd.DataFrame, column: str) -> None:
    ax.grid(False, axis="y")
    ax.set_xscale("log")
    seen = finite(table[column])
    seen = seen[seen > 0]
    low, high = (seen.min(), seen.max()) if seen.size else (0.1, 1.0)
    margin = max((high / low) ** 0.08, 1.2)
    edge = high * margin
    ax.set_xlim(low / margin, edge * margin**0.7)
    for place, (label, row) in enumerate(found.iterrows()):
        # what is 0 has no logarithm, and what is infinite no place
        own = np.clip(finite(table.loc[table["observer"] == label, column]), low, edge)
        low_end, middle, high_end = (np.clip(row[column + end], low, edge) for end in ("_low", "", "_high"))
        ax.plot(own, np.full_like(own, place), **RUN)
        ax.plot([low_end, high_end], [place, place], **SPREAD)
        ax.plot(middle, place, **(MEDIAN if np.isfinite(row[column]) else NONE))


def _counts(row: pd.Series) -> str:
    """How many runs failed, were reset or diverged."""
    counts = [f"{row['failed']:.0f} of {row['runs']:.0f} fail"]
    counts += [f"{row[name]:.0f} {how}" for name, how in (("reset", "reset"), ("diverged", "diverge")) if row[name]]
    return ", ".join(counts)


def _medians(row: pd.Series) -> str:
    """Medians and quantiles, in words."""
    told = []
    for column, what, unit in (("settling_time", "settling time", "s"), ("rms", "rms error", "1/m")):
        values = (row[column + end] for end in ("", "_low", "_high"))
        middle, low, high = (f"{value:.2g} {unit}" if np.isfinite(value) else "none" for value in values)
        told.append(f"{what} {middle} in the median, {low} to {high} for 16 to 84 % of the runs")
    return "; ".join(told)
