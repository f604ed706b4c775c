"""Figures of what windows of time tell: of excitation, of the state of several points, and of a filter's claims."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures import axis, given, look, words
from percept_obs.figures.base import Drawing, canvas, figure, legend_above
from percept_obs.observability.windows import Excitation
from percept_obs.points.gramian import Gramian
from percept_obs.studies.consistency import Consistency


@figure("there is none, one has no finite value, or the number of labels is wrong")
def excitation(
    excitations: Excitation | Sequence[Excitation], labels: Sequence[str] | None = None, ax: Axes | None = None
) -> Drawing:
    """Smallest eigenvalue of the information in a window, over the window's end, with its least value marked.

    Parameters
    ----------
    excitations : Excitation or sequence of Excitation

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, pinhole, record, scenarios, windowed
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> found = windowed(form, record(scenarios.ma2005_eq35(), 20), 5)
    >>> print(figures.excitation(found).text.split(". ")[-1])
    5 s window: the least is 0.485, at 20 s, the largest 7.2.
    """
    found = given.several(excitations, Excitation, "windowed(form, recording)")
    if not all(np.isfinite(one.smallest).any() for one in found):
        raise ValueError("an excitation has no finite value; were samples lost in a recording without the truth?")
    windows = [f"{one.window:g} s" for one in found]
    names = given.labels_for(labels, [f"{window} window" for window in windows])
    ax = canvas(ax, 3.2)
    yield "Smallest eigenvalue of the integral of w w^T over a window, on a logarithmic axis."
    for number, (one, name) in enumerate(zip(found, names, strict=True)):
        time, shown = _draw(ax, one, name, number)
        yield f"{name}: {_told(ax, one, time, shown)}"
    # A fifth of the axis stays free below, for what is written there.
    low, high = _logarithmic(ax, found)
    ax.set_ylim(low * min(0.3, (low / high) ** 0.2), 2 * high)
    ax.set_xlabel(f"end of the {windows[0]} window (s)" if len(set(windows)) == 1 else "end of the window (s)")
    ax.set_ylabel(r"smallest eigenvalue of $\int w\,w^{\mathsf{T}}dt$")
    if labels is not None or len(found) > 1:
        legend_above(ax)
    return [ax]


@figure("there is none, something else is among them, or the number of labels is wrong")
def gramian(found: Gramian | Sequence[Gramian], labels: Sequence[str] | None = None, ax: Axes | None = None) -> Drawing:
    """Smallest eigenvalue of the windowed Gramian over the window's beginning; the text tells its verdict.

    Parameters
    ----------
    found : Gramian or sequence of Gramian

    Examples
    --------
    >>> from percept_obs import Camera, figures, record
    >>> from percept_obs.points.gramian import gramian
    >>> from percept_obs.points.scenarios import moving_body
    >>> found = gramian(record(moving_body(1), 5, Camera(0.1)), 2)
    >>> print(figures.gramian(found).text.split("; ")[1])
    least is seen in the 2 s from 0 s on, mainly of r_z, r_y, r_x.
    """
    found = given.several(found, Gramian, "points.gramian.gramian()")
    names = given.labels_for(labels, [f"{one.window:g} s window" for one in found])
    ax = canvas(ax, 3.2)
    yield "Smallest eigenvalue of the Gramian over the beginning of its window, on a logarithmic axis."
    for number, (one, name) in enumerate(zip(found, names, strict=True)):
        _draw(ax, one, name, number)
        yield f"{name}: {one.verdict()}."
    low, high = _logarithmic(ax, found)
    ax.set_ylim(low / 3, 3 * high)
    ax.set(xlabel="beginning of the window (s)", ylabel="smallest eigenvalue")
    legend_above(ax)
    return [ax]


@figure("it is something else")
def consistency(found: Consistency, ax: Axes | None = None) -> Drawing:
    """Normalised innovations over time, with their moving average and the interval that it should keep to.

    Parameters
    ----------
    found : Consistency

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, check_consistency, ekf, figures, pinhole
    >>> from percept_obs import record, scenarios, track
    >>> recording = record(scenarios.ma2005_eq35(), 20, Camera(0.02, Gaussian(0.01)))
    >>> run = track(recording, ekf(PerspectiveSystem(affine(), pinhole()), noise_variance=1e-4))
    >>> print(figures.consistency(check_consistency(run, after=5)).text.split(". ")[1])
    Consistent: the innovations are as large as the filter claims
    """
    given.one(found, Consistency, "check_consistency(run)")
    ax = canvas(ax, 3.2)
    low, high = found.interval(found.samples)
    ax.axhspan(low, high, color=look.GREEN, alpha=0.2, linewidth=0, label=f"{100 * found.confidence:g} % interval")
    ax.axhline(found.outputs, color=look.BLACK, linewidth=1, linestyle="--", label="expected mean")
    ax.plot(found.time, found.nis, **look.dots(found.nis, label="samples"))
    name = f"mean of {found.samples} samples"
    ax.plot(found.average_time, found.averages, color=look.BLUE, linewidth=1.6, label=name)
    ax.set_xlim(found.time[0], found.time[-1])
    ax.set(xlabel="time (s)", ylabel="normalised innovation")
    verdict = found.verdict()
    yield f"Normalised innovations from {found.time[0]:.4g} to {found.time[-1]:.4g} s."
    yield f"{verdict[0].upper()}{verdict[1:]}."
    firm = np.array([low, high, *found.averages, 0.0])
    yield axis.linear(ax, firm, found.nis, "the normalised innovations", reach=1.0)
    legend_above(ax)
    return [ax]


def _draw(ax: Axes, one: Excitation | Gramian, name: str, number: int) -> tuple[float, float]:
    """Draw smallest eigenvalues with their least one; return its time and the value at which it is drawn."""
    own: dict[str, Any] = look.style(number)
    shown = np.maximum(one.smallest, axis.ROUND_OFF)
    ax.plot(one.time, shown, label=name, color=own["color"], linestyle=own["linestyle"] if number else "-")
    at = int(np.nanargmin(one.smallest))
    ax.plot(one.time[at], shown[at], color=own["color"], marker=own["marker"])
    return float(one.time[at]), float(shown[at])


def _logarithmic(ax: Axes, found: Sequence[Excitation | Gramian]) -> tuple[float, float]:
    """Let the axis be logarithmic; return the smallest and the largest value that is drawn."""
    ax.set_yscale("log")
    ax.minorticks_off()
    every = np.maximum(words.finite(np.concatenate([one.smallest for one in found])), axis.ROUND_OFF)
    return float(every.min()), float(every.max())


def _told(ax: Axes, one: Excitation, at: float, shown: float) -> str:
    """Write the least value beside its mark, and say it with the largest one and with what is not drawn."""
    least = np.nanmin(one.smallest)
    late = at > one.time[0] + 0.85 * (one.time[-1] - one.time[0])
    ha, right = ("right", 4) if late else ("center", 0)
    ax.annotate(f"least {least:.2g}", (at, shown), (right, -7), textcoords="offset points", ha=ha, va="top")
    clipped, missing = int((one.smallest < axis.ROUND_OFF).sum()), int(np.isnan(one.smallest).sum())
    return words.joined(
        f"the least is {least:.3g}, at {at:.3g} s, the largest {np.nanmax(one.smallest):.3g}.",
        f"Round-off: {clipped} values below {axis.ROUND_OFF:g} are drawn there." if clipped else "",
        f"Unknown: {missing} of {len(one.time)} windows, which are gaps." if missing else "",
    )
