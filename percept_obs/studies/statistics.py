"""Statistics of a run of an ensemble: the expressions to accumulate for any observer, and what the sums give."""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType

import numpy as np
import sympy as sp

from percept_obs.compile import Array
from percept_obs.compile.batch_loop import COLUMNS, Statistics
from percept_obs.observers.base import Observer
from percept_obs.observers.inversion import elapsed, first_innovation
from percept_obs.tracking.verdict import stays

OUTCOMES = ("converged", "late", "outside", "behind", "none", "diverged")
"""Kinds of `Outcome`, in the order of their numbers."""

CONVERGED, LATE, OUTSIDE, BEHIND, NONE, DIVERGED = range(6)

STATISTICS = MappingProxyType(
    {
        "status": ("1", "what became of the run"),
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
"""Unit and meaning of each statistic; the bound needs a prior, NEES a covariance, NIS a measurement update as well."""


def accumulated(observer: Observer, coordinates: Sequence[str] = (), scale: Sequence[float] = ()) -> Statistics:
    """Expressions to accumulate during a run: relative error of the distance, or absolute errors of coordinates.

    The scale has the factors of the coordinates by the unit of length in which the observer runs, see `Recording`.
    """
    form, units = observer.form, [sp.S.One if factor == 1 else sp.Float(factor) for factor in scale]
    units = units or [sp.S.One for _ in form.coordinates]
    estimate = {x: e / unit for x, e, unit in zip(form.coordinates, observer.estimate, units, strict=True)}
    truth = {symbol: sp.Symbol(f"true_{symbol.name}", real=True) for symbol in form.coordinates}
    inverse = form.coordinates[-1]
    named = [symbol for symbol in form.coordinates if symbol.name in coordinates]
    samples = tuple(sp.Symbol(f"sample_{x.name}", real=True) for x in form.x1)
    places = [form.coordinates.index(x) for x in form.x1]
    means = []
    if observer.covariance is not None:
        into = sp.diag(*(1 / unit for unit in units))
        P = into * sp.Matrix(observer.covariance) * into
        means.append(_normalised(P, [truth[s] - estimate[s] for s in form.coordinates]))  # NEES
        variance = {gain.name: gain.symbol for gain in observer.gains}.get("noise_variance")
        if variance is not None and observer.equations.update:
            residual = [sample - estimate[x] for sample, x in zip(samples, form.x1, strict=True)]
            # the residual after an update has the covariance R - P; see `Run.whitened`
            means.append(_normalised(variance * sp.eye(len(places)) - P.extract(places, places), residual))  # NIS
    return Statistics(
        truth=tuple(truth.values()),
        elapsed=elapsed,
        begun=tuple(first_innovation(form)) if observer.unobservable else (),
        first=tuple(x - estimate[x] for x in form.x1) if observer.unobservable else (),
        hidden=sp.Or(*(where.condition for where in observer.unobservable)),
        judged=tuple(sp.Abs(truth[s] - estimate[s]) for s in named)
        or (sp.Abs(truth[inverse] / estimate[inverse] - 1),),
        behind=sp.false if named else sp.Le(estimate[inverse], 0),
        error=sp.Abs(truth[inverse] - estimate[inverse]),
        means=tuple(means),
        samples=samples if observer.covariance is not None and observer.equations.update else (),
        measured=tuple(places),
    )


def _normalised(P: sp.Matrix, e: list[sp.Expr]) -> sp.Expr:
    """e^T P^-1 e, by Gaussian elimination, whose expressions are shorter than those of an inverse."""
    P, e, total = P.as_mutable(), list(e), sp.S.Zero
    for k in range(len(e)):
        total += e[k] ** 2 / P[k, k]
        for i in range(k + 1, len(e)):
            share = P[i, k] / P[k, k]
            e[i] -= share * e[k]
            for j in range(k + 1, len(e)):
                P[i, j] -= share * P[k, j]
    return total


def statistics_of(sums: Array, elapsed: Array, grid: Array, late: int) -> dict[str, Array]:
    """Statistics of L runs, by their names in `STATISTICS`, from sums of `percept_obs.compile.batch.run_batch`.

    Seconds elapsed are those from the first sample to each and, of the grid, to the ends of the steps; `late` is the
    first sample whose error counts.
    """
    column = dict(zip(COLUMNS, sums.T, strict=False))
    last, judged, squares = len(elapsed) - 1, column["judged"], column["squares"]
    outside, diverged = column["outside"].astype(int), column["diverged"].astype(int)
    settled = np.where(outside < last, elapsed[np.minimum(outside + 1, last)], np.inf)
    outcome = np.select(
        [diverged > 0, stays(settled, elapsed[-1]), outside < last],
        [DIVERGED, CONVERGED, LATE],
        np.select([np.isnan(judged), np.isinf(judged)], [NONE, BEHIND], OUTSIDE),
    )

    def known(values: Array) -> Array:
        """Errors, infinite where a run that diverged has none."""
        return np.where(np.isfinite(values), values, np.inf)

    found = {
        "outcome": outcome.astype(float),
        "settling_time": np.where(outcome == CONVERGED, settled, np.inf),
        "judged": judged,
        "final": known(column["final"]),
        "rms": known(np.sqrt(squares / (last + 1 - late))),
        "worst": np.where(np.isfinite(squares), column["worst"], np.inf),
        "resets": column["resets"],
        "diverged_at": np.where(diverged > 0, grid[diverged], np.inf),
    }
    means = sums[:, len(COLUMNS) :]  # sum and number of each
    with np.errstate(invalid="ignore"):
        found |= dict(zip(("nees", "nis"), (means[:, 0::2] / means[:, 1::2]).T, strict=False))
    return found
