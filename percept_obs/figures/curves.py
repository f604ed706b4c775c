"""Axes and curves: limits, errors with their moving root mean square, and bands that an observer claims."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike

from percept_obs.figures import base, describe, look
from percept_obs.figures.base import Array
from percept_obs.observability.bound import Bound
from percept_obs.recording import Recording
from percept_obs.studies.consistency import claimed_interval
from percept_obs.tracking.run import Run

Styles = Sequence[dict[str, Any]]

ROUND_OFF = 1e-16
"""Below it, what should be positive is round-off; no logarithmic axis goes further down."""

NARROWEST = 0.4
"""Least ratio of the sides of a picture in space or in the image."""


def limits(required: ArrayLike, optional: ArrayLike = (), reach: float = 2.0) -> tuple[float, float]:
    """Return an axis's ends around all required values, and optional ones at most `reach` spans away from these."""
    required, optional = describe.finite(required), describe.finite(optional)
    low, high = (required.min(), required.max()) if required.size else (0.0, 1.0)
    constant = high - low <= 1e-3 * abs(high)
    size = max(abs(high) / 2 if constant else high - low, 1e-12)
    near = optional[(optional >= low - reach * size) & (optional <= high + reach * size)]
    low, high = near.min(initial=low), near.max(initial=high)
    margin = 0.06 * max(high - low, size)
    return low - margin, high + margin


def linear(ax: Axes, required: Array, optional: Array, what: str, reach: float = 2.0) -> str:
    """Set the axis's `limits`, and return a sentence on how many of the optional values lie outside."""
    ends = limits(required, optional, reach)
    ax.set_ylim(*ends)
    return _left_out(optional, ends, what)


def log(ax: Axes, values: Array, what: str, highest: float = np.inf, ticks: str = "") -> str:
    """Make the axis logarithmic; return a sentence on what it leaves out: spikes at changes of sign and divergence."""
    seen = describe.finite(values)
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
    """Return a sentence on how many values are not on the axis, and which; empty if all are."""
    seen = describe.finite(values)
    outside = seen[(seen < ends[0]) | (seen > ends[1])]
    return f"Outside the axis: {outside.size} of {what}, {describe.span(outside)}." if outside.size else ""


def widened_limits(*ends: tuple[float, float]) -> list[tuple[float, float]]:
    """Return the limits of a picture's axes, widened until none is shorter than `NARROWEST` of the longest."""
    longest = max(high - low for low, high in ends)
    missing = [max(0.0, NARROWEST * longest - (high - low)) / 2 for low, high in ends]
    return [(low - m, high + m) for (low, high), m in zip(ends, missing, strict=True)]


def rows_without_nan(rows: Array) -> Array:
    """Return the rows that have no NaN, shape (K, n)."""
    return rows[np.isfinite(rows).all(axis=1)]


def estimated_distance(run: Run) -> Array:
    """Return estimated distances, shape (K,); NaN where they are not in front of the camera."""
    return np.where(np.isfinite(run.distance), run.distance, np.nan)


def bulk(values: Array) -> Array:
    """Return the values without the smallest and the largest twentieth, which may be a transient."""
    seen = np.sort(describe.finite(values))
    return seen[len(seen) // 20 : len(seen) - len(seen) // 20]


SMOOTHING = 160
"""Noisy errors are averaged over the duration divided by this."""

CLAIM = r"$\pm 2\sigma$ claimed"
"""Name of the band that an observer's covariance claims."""


def draw(ax: Axes, time: Array, curves: Array, labels: Sequence[str], styles: Styles = ()) -> None:
    """Draw curves in the usual styles or others, with sparse markers, none of which lies on another."""
    step = max(1, len(time) // 8)
    for number, (curve, name, style) in enumerate(zip(curves, labels, styles or look.styles(curves), strict=True)):
        every = (step * number // len(curves), step)
        ax.plot(time, curve, label=name, linewidth=1.5, markersize=5, markevery=every, **style)
    ax.set_xlim(time[0], time[-1])


def draw_errors(ax: Axes, time: Array, errors: Array, labels: Sequence[str], styles: Styles = ()) -> None:
    """Draw every error faintly, and over it a moving root mean square."""
    width = 2 * (len(time) // (2 * SMOOTHING)) + 1
    if width > 1:
        for error, style in zip(errors, styles or look.styles(errors), strict=True):
            ax.plot(time, error, color=style["color"], linewidth=0.5, alpha=0.25)
        errors = np.array([_root_mean_square(error, width) for error in errors])
        note = f"bold: root mean square over {(time[-1] - time[0]) * width / len(time):.1g} s"
        ax.set_title(note, loc="right", fontsize="small", color=look.GREY)
    draw(ax, time, errors, labels, styles)


def draw_bound(ax: Axes, recording: Recording, bound: Bound, coordinate: str) -> str:
    """Draw the least standard deviation of a coordinate under its errors; return a sentence on it."""
    if not base.equal(bound.recording.truth, recording.truth):
        raise ValueError("the bound is along another truth than the runs; draw runs on the recording of the bound")
    least = bound.of(coordinate)
    ax.plot(bound.elapsed, least, label="Cramer-Rao bound", **look.BOUND)
    return (
        "No unbiased observer's root mean square error lies below the Cramer-Rao bound, a grey line from "
        f"{least[0]:.3g} to {least[-1]:.3g}, {', '.join(bound.form.measured)} measured."
    )


def _root_mean_square(values: Array, width: int) -> Array:
    """Return the root mean square of finite values around each, shape (K,); NaN where the value itself is."""
    windows = sliding_window_view(np.pad(values, width // 2, constant_values=np.nan), width)
    count = np.maximum(np.isfinite(windows).sum(axis=1), 1)
    length = np.hypot.reduce(np.nan_to_num(windows), axis=1)  # does not overflow before divergence
    return np.where(np.isnan(values), np.nan, length / np.sqrt(count))


def draw_claim_of_coordinate(ax: Axes, run: Run, column: int, colour: str) -> str:
    """Draw the interval that the observer claims for a coordinate; return a sentence on it, empty if it claims none."""
    if run.observer.covariance is None:
        return ""
    low, high = (end[:, column] for end in claimed_interval(run))
    return draw_claim(ax, run, low, high, None if run.recording.truth is None else run.truth[:, column], colour)


def draw_claim(ax: Axes, run: Run, low: Array, high: Array, truth: Array | None, colour: str) -> str:
    """Draw a claimed band, infinite ends at the axes' edge; return a sentence on its ends and on what it holds."""
    reaching = np.where(np.isposinf(high), ax.get_ylim()[1], high)
    name = "_claim" if CLAIM in ax.get_legend_handles_labels()[1] else CLAIM  # one entry in the legend
    ax.fill_between(run.elapsed, low, reaching, color=colour, alpha=0.2, linewidth=0, zorder=1, label=name)
    claimed = ~np.isnan(low)
    if not claimed.any():
        return ""
    last = np.flatnonzero(claimed)[-1]
    told = f"The band of two claimed standard deviations is from {low[last]:.3g} to {high[last]:.3g} at the end"
    if truth is None:
        return f"{told}."
    held = np.mean((low <= truth) & (truth <= high))
    return f"{told} and holds the truth in {100 * held:.0f} % of the samples."
