"""What an axis holds, and in words what it leaves out."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from percept_obs.figures.base import Array
from percept_obs.figures.words import finite, span

ROUND_OFF = 1e-16
"""Below it, what should be positive is round-off; no logarithmic axis goes further down."""

NARROWEST = 0.4
"""Least ratio of the sides of a picture in space or in the image."""


def limits(firm: ArrayLike, loose: ArrayLike = (), reach: float = 2.0) -> tuple[float, float]:
    """Ends of an axis that holds all firm values, and those loose ones that are at most some spans away from them."""
    firm, loose = finite(firm), finite(loose)
    low, high = (firm.min(), firm.max()) if firm.size else (0.0, 1.0)
    constant = high - low <= 1e-3 * abs(high)
    span = max(abs(high) / 2 if constant else high - low, 1e-12)  # of what stays, its size
    near = loose[(loose >= low - reach * span) & (loose <= high + reach * span)]
    low, high = near.min(initial=low), near.max(initial=high)
    margin = 0.06 * max(high - low, span)
    return low - margin, high + margin


def linear(ax: Axes, firm: Array, loose: Array, what: str, reach: float = 2.0) -> str:
    """Let the axis follow the firm values, and say how many of the loose ones it leaves out."""
    ends = limits(firm, loose, reach)
    ax.set_ylim(*ends)
    return _left_out(loose, ends, what)


def log(ax: Axes, values: Array, what: str, highest: float = np.inf, ticks: str = "") -> str:
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


def not_a_strip(*ends: tuple[float, float]) -> list[tuple[float, float]]:
    """Limits, the nearer ones drawn apart until no side is much shorter than another."""
    longest = max(high - low for low, high in ends)
    missing = [max(0.0, NARROWEST * longest - (high - low)) / 2 for low, high in ends]
    return [(low - m, high + m) for (low, high), m in zip(ends, missing, strict=True)]


def complete(rows: Array) -> Array:
    """The rows without a gap."""
    return rows[np.isfinite(rows).all(axis=1)]


def bulk(values: Array) -> Array:
    """The values without the smallest and the largest twentieth, which may be a transient."""
    seen = np.sort(finite(values))
    return seen[len(seen) // 20 : len(seen) - len(seen) // 20]
