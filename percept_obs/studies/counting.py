"""What is counted of a run while it goes on: the expressions for any observer, and what the counts say."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType

import numpy as np
import sympy as sp

from percept_obs.compile import Array
from percept_obs.compile.batch_loop import COLUMNS, MovingPoint, Statistics
from percept_obs.observers.base import Observer
from percept_obs.observers.inversion import elapsed, first_innovation
from percept_obs.system.surfaces import POINT, ImagingSurface

OUTCOMES = ("converged", "late", "outside", "behind", "none", "diverged")
"""Kinds of `Outcome`, in the order of their numbers."""

STATISTICS = MappingProxyType(
    {
        "outcome": ("1", "what became of the error"),
        "settling_time": ("s", "time from which on the error stays within the tolerance"),
        "judged": ("1", "what the tolerance bounds, at the end"),
        "final": ("1/m", "error of the inverse distance at the end"),
        "rms": ("1/m", "root mean square of this error after the transient"),
        "worst": ("1/m", "its largest value after the transient"),
        "resets": ("1", "number of resets"),
        "diverged_at": ("s", "time at which the estimate grew beyond all bounds"),
        "bound": ("1/m", "least rms error after the transient that the noise leaves to any unbiased observer"),
        "nees": ("1", "mean normalised estimation error squared after the transient"),
        "nis": ("1", "mean normalised innovation squared after the transient"),
    }
)
"""What is known of every run: its unit and what it is.

The bound needs a prior, the two after it a covariance, and the very last a measurement update.
"""


def watched(observer: Observer, coordinates: Sequence[str] = ()) -> Statistics:
    """What is looked at of an observer of a point: its relative error of the distance, or coordinates' absolute one."""
    form, estimate = observer.form, dict(zip(observer.form.coordinates, observer.estimate, strict=True))
    truth = {symbol: sp.Symbol(f"true_{symbol.name}", real=True) for symbol in form.coordinates}
    inverse = form.coordinates[-1]
    named = [symbol for symbol in form.coordinates if symbol.name in coordinates]
    judged = tuple(sp.Abs(truth[s] - estimate[s]) for s in named) or (sp.Abs(truth[inverse] / estimate[inverse] - 1),)
    behind = sp.false if named else sp.Le(estimate[inverse], 0)
    hidden = sp.Or(*(where.condition for where in observer.unobservable))
    return Statistics(
        tuple(truth.values()),
        elapsed,
        tuple(first_innovation(form)) if observer.unobservable else (),
        tuple(x - estimate[x] for x in form.x1) if observer.unobservable else (),
        hidden,
        judged,
        behind,
        sp.Abs(truth[inverse] - estimate[inverse]),
        _squares(observer, [truth[s] - estimate[s] for s in form.coordinates]),
        _samples(observer) if observer.covariance is not None and observer.equations.update else (),
        tuple(form.coordinates.index(x) for x in form.x1),
    )


def moving(surface: ImagingSurface) -> MovingPoint:
    """How a point is seen on a surface while it moves."""
    coordinates = (*surface.image, 1 / surface.distance)
    return MovingPoint(POINT, surface.parameters, coordinates, surface.distance)


def _samples(observer: Observer) -> tuple[sp.Symbol, ...]:
    """Symbols of the samples that arrive."""
    return tuple(sp.Symbol(f"sample_{x.name}", real=True) for x in observer.form.x1)


def _squares(observer: Observer, error: list[sp.Expr]) -> tuple[sp.Expr, ...]:
    """The normalised estimation error squared and, with a measurement update, the normalised innovation squared."""
    if observer.covariance is None:
        return ()
    found = (_normalised(sp.Matrix(observer.covariance), error),)
    form, variance = observer.form, {gain.name: gain.symbol for gain in observer.gains}.get("noise_variance")
    if variance is None or not observer.equations.update:
        return found
    places = [form.coordinates.index(x) for x in form.x1]
    residual = [sample - observer.estimate[k] for k, sample in zip(places, _samples(observer), strict=True)]
    left = variance * sp.eye(len(places)) - sp.Matrix(observer.covariance).extract(places, places)
    return (*found, _normalised(left, residual))


def _normalised(P: sp.Matrix, e: list[sp.Expr]) -> sp.Expr:
    """e^T P^-1 e, by the steps of an elimination."""
    P, e, total = P.as_mutable(), list(e), sp.S.Zero
    for k in range(len(e)):
        total += e[k] ** 2 / P[k, k]
        for i in range(k + 1, len(e)):
            share = P[i, k] / P[k, k]
            e[i] -= share * e[k]
            for j in range(k + 1, len(e)):
                P[i, j] -= share * P[k, j]
    return total


def told(counts: Array, elapsed: Array, grid: Array, late: int, means: Sequence[str], part: float) -> dict[str, Array]:
    """What counts of runs say.

    Parameters
    ----------
    counts : array of shape (L, number of counts)
        From `percept_obs.compile.batch.run_batch`.
    elapsed : array of shape (K,)
        Seconds from the first sample to each.
    grid : array of shape (N + 1,)
        Seconds from the first sample to the ends of the steps.
    late : int
        Sample from which on errors counted.
    means : sequence of str
        Names of the means that were counted.
    part : float
        Share of the run at its end in which the error must have stayed within the tolerance to have converged.

    Returns
    -------
    mapping of names of `STATISTICS` to arrays of shape (L,)
    """
    column = dict(zip(COLUMNS, counts.T, strict=False))
    last, length = len(elapsed) - 1, float(elapsed[-1])
    outside, judged, diverged = column["outside"].astype(int), column["judged"], column["diverged"].astype(int)
    inside = outside < last
    settled = np.where(inside, elapsed[np.minimum(outside + 1, last)], np.inf)
    kind = np.where(length - settled >= part * length, OUTCOMES.index("converged"), OUTCOMES.index("late"))
    ends = np.where(np.isnan(judged), OUTCOMES.index("none"), OUTCOMES.index("outside"))
    ends = np.where(np.isinf(judged), OUTCOMES.index("behind"), ends)
    kind = np.where(inside, kind, ends)
    kind = np.where(diverged > 0, OUTCOMES.index("diverged"), kind)
    converged = kind == OUTCOMES.index("converged")
    squares = column["squares"]
    found = {
        "outcome": kind.astype(float),
        "settling_time": np.where(converged, settled, np.inf),
        "judged": judged,
        "final": _known(column["final"]),
        "rms": _known(np.sqrt(squares / (last + 1 - late))),
        "worst": np.where(np.isfinite(squares), column["worst"], np.inf),
        "resets": column["resets"],
        "diverged_at": np.where(diverged > 0, grid[diverged], np.inf),
    }
    sums = counts[:, len(COLUMNS) :]
    with np.errstate(invalid="ignore"):
        found |= {name: sums[:, 2 * k] / sums[:, 2 * k + 1] for k, name in enumerate(means)}
    return found


def _known(values: Array) -> Array:
    """Errors, infinite where a diverged run has none."""
    return np.where(np.isfinite(values), values, np.inf)
