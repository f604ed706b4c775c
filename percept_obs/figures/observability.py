"""Figures of what can be known: measures of observability side by side, and maps of the image."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures import axis, given, look, words
from percept_obs.figures.base import Array, Drawing, figure, legend_above, rows
from percept_obs.observability.measures import Observability


@figure("it is something else, or the number of axes is wrong")
def observability(found: Observability, axes: Sequence[Axes] | None = None) -> Drawing:
    """Each measure over time, one below the other: an instant, windows, derivatives, and the bound.

    Parameters
    ----------
    found : Observability
    """
    given.one(found, Observability, "how_observable(recording, system)")
    begun, hidden = found.recording.time[0], found.form.hidden[-1]
    parts = ["an instant", "windows", "derivatives", "the bound"]
    instant, windows, derivatives, bound = rows(axes, [1.4, 1.8, 1.1, 1.8], parts)
    if found.instant is not None:
        spread = found.instant.eigenvalues
        _draw(instant, found.instant.time - begun, spread[:, -1], 1, "largest eigenvalue of $w w^T$")
        if spread.shape[1] > 1:
            _draw(instant, found.instant.time - begun, spread[:, 0], 0, "smallest")
    else:
        instant.text(0.5, 0.5, "no canonical form, and so no w", ha="center", transform=instant.transAxes)
    instant.set_ylabel("instant")
    if found.excitation is not None:
        _draw(windows, found.excitation.time - begun, found.excitation.smallest, 0, "excitation (window's end)")
    _draw(windows, found.error.time - begun, found.error.smallest, 1, "error Gramian (beginning)")
    ends: dict[str, Any] = {
        "linestyle": "",
        "marker": "o",
        "color": look.GREEN,
        "markersize": 4,
        "label": "by perturbed runs",
    }
    windows.plot(found.empirical.time - begun, np.maximum(found.empirical.smallest, axis.ROUND_OFF), **ends)
    windows.set_ylabel(f"{found.window:g} s windows")
    _draw(derivatives, found.lie.time - begun, found.lie.smallest, 0, "smallest singular value")
    derivatives.set_ylabel("derivatives")
    _draw(bound, found.bound.elapsed, found.bound.of(hidden), 1, f"bound of {words.letter(hidden)}")
    column = [symbol.name for symbol in found.form.coordinates].index(hidden)
    _draw(bound, found.bound.elapsed, found.bound.predicted_deviation[:, column], 0, "without samples")
    bound.set_ylabel("std. deviation")
    for ax in (instant, windows, derivatives, bound):
        _logarithmic(ax)
        legend_above(ax)
    bound.set_xlim(0, found.recording.elapsed[-1])
    yield f"Measures of observability of {', '.join(found.form.measured)} over time, on logarithmic axes."
    for measure in found.measures:
        name, _, says, least, lost = measure.cells
        yield f"{name}: {says}, {least}{f'; not seen: {lost}' if lost else ''}."
    yield " ".join(found.disagreements)
    return [instant, windows, derivatives, bound]


def _draw(ax: Axes, time: Array, values: Array, number: int, name: str) -> None:
    own = look.style(number)
    shown = np.maximum(values, axis.ROUND_OFF)
    ax.plot(time, shown, label=name, color=own["color"], linestyle=own["linestyle"] if number else "-")


def _logarithmic(ax: Axes) -> None:
    """A logarithmic axis over at most twelve powers of ten."""
    every = np.concatenate([np.ravel(np.asarray(line.get_ydata(), dtype=float)) for line in ax.lines] or [np.ones(1)])
    high = 3 * float(every.max())
    ax.set_yscale("log")
    ax.set_ylim(max(float(every.min()) / 3, 1e-12 * high), high)
    ax.minorticks_off()
