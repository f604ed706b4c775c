"""Figures of what windows of time tell: of excitation, and of a filter's consistency."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures.base import (
    BLACK,
    BLUE,
    GREEN,
    ROUND_OFF,
    Figure,
    dots,
    drawn,
    finite,
    legend_above,
    linear_axis,
    new_axes,
    style,
    tidy,
)
from percept_obs.figures.labels import labels_for
from percept_obs.observability.pointwise import Excitation
from percept_obs.studies.consistency import Consistency


def excitation(
    excitations: Excitation | Sequence[Excitation], labels: Sequence[str] | None = None, ax: Axes | None = None
) -> Figure:
    """Smallest eigenvalue of the information in a window, over the window's end, with its least value marked.

    Parameters
    ----------
    excitations : Excitation or sequence of Excitation
    labels : sequence of str, optional
        One for each; the windows' lengths when left out.
    ax : axes, optional
        New ones when left out.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If there is none, one has no finite value, or the number of labels is wrong.
    """
    given = list(excitations) if isinstance(excitations, Iterable) else [excitations]
    if not given or not all(isinstance(one, Excitation) for one in given):
        raise ValueError(
            f"an Excitation or several are needed, not {excitations!r}; windowed(form, recording) makes one"
        )
    if not all(np.isfinite(one.smallest).any() for one in given):
        raise ValueError("an excitation has no finite value; were samples lost in a recording without the truth?")
    windows = [f"{one.window:g} s" for one in given]
    names = labels_for(given, labels, [f"{window} window" for window in windows])
    ax = ax or new_axes(3.2)
    tidy(ax)
    sentences = ["Smallest eigenvalue of the integral of w w^T over a window, on a logarithmic axis."]
    for number, (one, name) in enumerate(zip(given, names, strict=True)):
        sentences.append(f"{name}: {_draw(ax, one, name, style(number), number == 0)}")
    every = np.maximum(finite(np.concatenate([one.smallest for one in given])), ROUND_OFF)
    ax.set_yscale("log")
    # A fifth of the axis stays free below, for what is written there.
    ax.set_ylim(every.min() * min(0.3, (every.min() / every.max()) ** 0.2), 2 * every.max())
    ax.minorticks_off()
    ax.set_xlabel(f"end of the {windows[0]} window (s)" if len(set(windows)) == 1 else "end of the window (s)")
    ax.set_ylabel(r"smallest eigenvalue of $\int w\,w^{\mathsf{T}}dt$")
    if labels is not None or len(given) > 1:
        legend_above(ax)
    return drawn((ax,), sentences)


def consistency(found: Consistency, ax: Axes | None = None) -> Figure:
    """Normalised innovations over time, with their moving average and the interval that it should keep to.

    Parameters
    ----------
    found : Consistency
    ax : axes, optional
        New ones when left out.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If it is something else.
    """
    if not isinstance(found, Consistency):
        raise ValueError(f"a Consistency is needed, not {found!r}; check_consistency(run) makes one")
    ax = ax or new_axes(3.2)
    tidy(ax)
    low, high = found.interval(found.samples)
    ax.axhspan(low, high, color=GREEN, alpha=0.2, linewidth=0, label=f"{100 * found.confidence:g} % interval")
    ax.axhline(found.outputs, color=BLACK, linewidth=1, linestyle="--", label="expected mean")
    ax.plot(found.time, found.nis, **dots(found.nis, label="samples"))
    name = f"mean of {found.samples} samples"
    ax.plot(found.average_time, found.averages, color=BLUE, linewidth=1.6, label=name)
    firm = np.array([low, high, *found.averages, 0.0])
    left_out = linear_axis(ax, firm, found.nis, "the normalised innovations", reach=1.0)
    ax.set_xlim(found.time[0], found.time[-1])
    ax.set_xlabel("time (s)")
    ax.set_ylabel("normalised innovation")
    legend_above(ax)
    verdict = found.verdict()
    words = f"Normalised innovations from {found.time[0]:.4g} to {found.time[-1]:.4g} s. "
    return drawn((ax,), [f"{words}{verdict[0].upper()}{verdict[1:]}.", left_out])


def _draw(ax: Axes, one: Excitation, name: str, look: dict[str, Any], first: bool) -> str:
    """Draw one curve with its least value, and say what it shows."""
    color, marker = look["color"], look["marker"]
    shown = np.maximum(one.smallest, ROUND_OFF)
    ax.plot(one.time, shown, label=name, linewidth=1.5, color=color, linestyle="-" if first else look["linestyle"])
    at = int(np.nanargmin(one.smallest))
    least = one.smallest[at]
    late = one.time[at] > one.time[0] + 0.85 * (one.time[-1] - one.time[0])
    ax.plot(one.time[at], shown[at], marker=marker, color=color)
    ax.annotate(
        f"least {least:.2g}",
        (one.time[at], shown[at]),
        (4 if late else 0, -7),
        textcoords="offset points",
        ha="right" if late else "center",
        va="top",
    )
    clipped, missing = int((one.smallest < ROUND_OFF).sum()), int(np.isnan(one.smallest).sum())
    sentences = [
        f"the least is {least:.3g}, at {one.time[at]:.3g} s, the largest {np.nanmax(one.smallest):.3g}.",
        f"Round-off: {clipped} values below {ROUND_OFF:g} are drawn there." if clipped else "",
        f"Unknown: {missing} of {len(one.time)} windows, which are gaps." if missing else "",
    ]
    return " ".join(filter(None, sentences))
