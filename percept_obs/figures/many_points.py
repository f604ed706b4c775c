"""Figures of many points: the error and its decay, and depth errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from percept_obs.figures import axis, given, look, words
from percept_obs.figures.base import Drawing, canvas, figure, legend_above
from percept_obs.points import PointsRun
from percept_obs.points.gramian import DecayBound


@figure("there is no run, one has no truth, or its error is not positive where it is fitted")
def error_norm(
    runs: PointsRun | Sequence[PointsRun],
    labels: Sequence[str] | None = None,
    bound: DecayBound | None = None,
    fitted: tuple[float, float] = (-np.inf, np.inf),
    ax: Axes | None = None,
) -> Drawing:
    """Norm of each run's error, with the exponential fitted to it, and what the proof guarantees of the first one.

    Parameters
    ----------
    runs : PointsRun or sequence of PointsRun
        On recordings with a truth.
    bound : DecayBound, optional
        Of the first run's observer, a multiple of the identity for P.
    fitted : two times
        Between which the exponential is fitted, in seconds.

    Examples
    --------
    >>> from percept_obs import Camera, figures, luenberger, record, track
    >>> from percept_obs.points.scenarios import moving_body
    >>> recording = record(moving_body(1), 4, Camera(0.1))
    >>> run = track(recording, luenberger(recording.view), recording.truth[0] + 0.1)
    >>> print(figures.error_norm(run).text.split(". ")[-1])
    Luenberger, constant P: from 0.17 to 0.095 in 4 s, decaying at 0.111 per second.
    """
    runs = given.several(runs, PointsRun, "track()")
    names = given.labels_for(labels, [run.observer.name for run in runs])
    rates = [run.decay_rate(*fitted) for run in runs]
    ax = canvas(ax, 3.6)
    yield "Norm of the error over time, on a logarithmic axis."
    for number, (run, name, rate) in enumerate(zip(runs, names, rates, strict=True)):
        own = look.style(number)
        ax.plot(run.time, run.deviation, color=own["color"], linewidth=1.5, label=f"{name}: {rate:.2g} per s")
        part = np.flatnonzero((run.time >= fitted[0]) & (run.time <= fitted[1]))
        middle = np.exp(np.mean(np.log(run.deviation[part])) - rate * (run.time[part] - run.time[part].mean()))
        ax.plot(run.time[part], middle, color=own["color"], linewidth=1, linestyle=own["linestyle"])
        yield (
            f"{name}: from {run.deviation[0]:.2g} to {run.deviation[-1]:.2g} in {run.time[-1] - run.time[0]:.3g} s, "
            f"decaying at {rate:.3g} per second."
        )
    if bound is not None:
        steps = np.sqrt(np.cumprod([1.0, *bound.contraction]))
        ends = [*bound.time, bound.time[-1] + bound.window]
        at = float(np.interp(bound.time[0], runs[0].time, runs[0].deviation))
        name = f"bound: {bound.rate:.2g} per s"
        ax.plot(ends, at * steps, label=name, color=look.BLACK, linewidth=1.2, linestyle=":")
        yield f"The proof guarantees {bound.rate:.2g} per second over windows of {bound.window:g} s."
    yield axis.log(ax, np.concatenate([run.deviation for run in runs]), "the errors")
    ax.set(xlabel="time (s)", ylabel=r"norm of the error $|\rho|$")
    legend_above(ax)
    return [ax]


@figure("there is none, or a name has none")
def depth_errors(errors: Mapping[str, ArrayLike], after: float, ax: Axes | None = None) -> Drawing:
    """Relative errors of depths, each one and their median, for several ways of estimating them.

    Parameters
    ----------
    errors : mapping of names to arrays
        From `percept_obs.studies.comparison.relative_distance_errors`; infinite where an estimate is behind the camera.
    after : float
        Seconds since first sight, for the words.

    Examples
    --------
    >>> from percept_obs import figures
    >>> print(figures.depth_errors({"mine": [0.01, 0.03, 0.02]}, after=2).text.split(". ")[-1])
    mine: 3 sightings, median 2.0%, at most 3.0%.
    """
    known = {name: np.asarray(values, dtype=float).ravel() for name, values in errors.items()}
    if not known or not all(len(values) and not np.isnan(values).any() for values in known.values()):
        raise ValueError("each name needs relative errors, of at least one sighting and without NaN")
    ax = canvas(ax, 1.0 + 0.5 * len(known))
    ax.grid(False, axis="y")
    seen = words.finite(np.concatenate(list(known.values())))
    low, high = max(seen.min(initial=1.0), 1e-4), max(seen.max(initial=0.0), 1.0)
    yield f"Relative errors of the depth {after:g} s after first sight, on a logarithmic axis."
    for row, (name, values) in enumerate(known.items()):
        median = float(np.median(values))
        shown, middle = np.clip(values, low, 2 * high), float(np.clip(median, low, 2 * high))
        ax.plot(shown, np.full_like(shown, row), color=look.SKY, linestyle="", marker="|", markersize=12)
        ax.plot(middle, row, color=look.VERMILLION, marker="o")
        ax.annotate(f"{median:.1%}", (middle, row), (0, 8), textcoords="offset points")
        behind = int(np.isinf(values).sum())
        worst = f"{behind} of them behind the camera" if behind else f"at most {values.max():.1%}"
        yield f"{name}: {len(values)} sightings, median {median:.1%}, {worst}."
    ax.set_xscale("log")
    ax.set_xlim(low / 1.5, 3 * high)
    ax.set_yticks(range(len(known)), list(known))
    ax.set_ylim(len(known) - 0.5, -0.7)
    ax.axvline(1.0, color=look.GREY, linewidth=0.8, linestyle=":")
    ax.set_xlabel(f"relative error of the depth after {after:g} s; the dots are medians")
    return [ax]
