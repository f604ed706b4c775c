"""Figures of many points: their paths in the image, the error and its decay, what windows show, and depth errors."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from percept_obs.figures.base import (
    BLACK,
    COLOURS,
    GREY,
    ROUND_OFF,
    SKY,
    VERMILLION,
    Figure,
    drawn,
    finite,
    legend_above,
    letter,
    limits,
    log_axis,
    new_axes,
    span,
    style,
    tidy,
)
from percept_obs.figures.labels import labels_for
from percept_obs.observability.gramian import DecayBound, Gramian, true_images
from percept_obs.points import PointsRun
from percept_obs.points.form import points_form
from percept_obs.recording import Recording


def points_in_image(data: PointsRun | Recording, ax: Axes | None = None) -> Figure:
    """Paths of all points in the image, and dashed what an observer makes of them, each from its first sight on.

    Parameters
    ----------
    data : PointsRun or Recording
        Seen on a surface with two image coordinates.
    ax : axes, optional
        New ones when left out.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If it is something else, no point is seen, or the image has not two coordinates.
    """
    if not isinstance(data, PointsRun | Recording):
        raise ValueError(f"a PointsRun or a Recording is needed, not {data!r}; record() or track() makes one")
    recording = data.recording if isinstance(data, PointsRun) else data
    form = points_form(recording)
    if len(form.image_coordinates) != 2 or not recording.seen.any():
        raise ValueError("no point is seen in two image coordinates; record some points in front of the camera")
    ax = ax or new_axes(5.2)
    tidy(ax)
    seen = true_images(recording)
    estimate = np.full_like(seen, np.nan)
    if isinstance(data, PointsRun):
        estimate = data.view.outputs(data.estimate)
    for k in range(form.points):
        colour, shown = COLOURS[k % len(COLOURS)], np.flatnonzero(recording.seen[:, k])
        if not len(shown):
            continue
        ax.plot(*seen[:, k].T, color=colour, linewidth=1.4)
        ax.plot(*estimate[shown[0] :, k].T, color=colour, linewidth=1.2, linestyle="--")
        ax.plot(*seen[shown[0], k], color=colour, marker="o", markerfacecolor="white")
        ax.annotate(str(k + 1), seen[shown[0], k], (5, 5), textcoords="offset points", color=colour)
    kind = "measured" if recording.truth is None else "true"
    for name, look in ((kind, "-"), ("estimate", "--"))[: 1 + isinstance(data, PointsRun)]:
        ax.plot([], [], color=BLACK, linestyle=look, label=name)
    ax.plot([], [], color=BLACK, linestyle="", marker="o", markerfacecolor="white", label="first sight")
    ax.set_xlim(limits(seen[..., 0], estimate[..., 0], reach=0.3))
    ax.set_ylim(limits(seen[..., 1], estimate[..., 1], reach=0.3))
    y1, y2 = (letter(y.name) for y in form.image_coordinates)
    ax.set(aspect="equal", xlabel=y1, ylabel=y2)
    legend_above(ax, centred=True, fitting=66)
    lost = 1 - recording.seen.mean(axis=0)
    gone = [f"point {k + 1} for {share:.0%} of the time" for k, share in enumerate(lost) if share > 0]
    sentences = [
        f"{kind.capitalize()} paths of {form.points} points in the image: y1 is {span(seen[..., 0])}, y2 "
        f"{span(seen[..., 1])}.",
        f"Out of sight: {', '.join(gone)}." if gone else "All of them are seen at all times.",
        f"Estimates, dashed: {data.verdict()}." if isinstance(data, PointsRun) else "",
    ]
    return drawn((ax,), sentences)


def error_norm(
    runs: PointsRun | Sequence[PointsRun],
    labels: Sequence[str] | None = None,
    bound: DecayBound | None = None,
    fitted: tuple[float, float] = (-np.inf, np.inf),
    ax: Axes | None = None,
) -> Figure:
    """Norm of each run's error, with the exponential fitted to it, and what the proof guarantees of the first one.

    Parameters
    ----------
    runs : PointsRun or sequence of PointsRun
        On recordings with a truth.
    labels : sequence of str, optional
        One for each; the observers' names when left out.
    bound : DecayBound, optional
        Of the first run's observer, a multiple of the identity for P.
    fitted : two times
        Between which the exponential is fitted, in seconds.
    ax : axes, optional
        New ones when left out.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If there is no run, one has no truth, or its error is not positive where it is fitted.
    """
    given = [runs] if isinstance(runs, PointsRun) else list(runs) if isinstance(runs, Iterable) else []
    if not given or not all(isinstance(run, PointsRun) for run in given):
        raise ValueError(f"a PointsRun or several are needed, not {runs!r}; track() makes one")
    names = labels_for(given, labels, [run.observer.name for run in given])
    rates = [run.decay_rate(*fitted) for run in given]
    ax = ax or new_axes(3.6)
    tidy(ax)
    sentences = ["Norm of the error over time, on a logarithmic axis."]
    for number, (run, name, rate) in enumerate(zip(given, names, rates, strict=True)):
        look = style(number)
        ax.plot(run.time, run.deviation, color=look["color"], linewidth=1.5, label=f"{name}: {rate:.2g} per s")
        part = np.flatnonzero((run.time >= fitted[0]) & (run.time <= fitted[1]))
        middle = np.exp(np.mean(np.log(run.deviation[part])) - rate * (run.time[part] - run.time[part].mean()))
        ax.plot(run.time[part], middle, color=look["color"], linewidth=1, linestyle=look["linestyle"])
        sentences.append(
            f"{name}: from {run.deviation[0]:.2g} to {run.deviation[-1]:.2g} in {run.time[-1] - run.time[0]:.3g} s, "
            f"decaying at {rate:.3g} per second."
        )
    if bound is not None:
        steps = np.sqrt(np.cumprod([1.0, *bound.contraction]))
        ends = [*bound.time, bound.time[-1] + bound.window]
        at = float(np.interp(bound.time[0], given[0].time, given[0].deviation))
        ax.plot(ends, at * steps, color=BLACK, linewidth=1.2, linestyle=":", label=f"bound: {bound.rate:.2g} per s")
        sentences.append(f"The proof guarantees {bound.rate:.2g} per second over windows of {bound.window:g} s.")
    sentences.append(log_axis(ax, np.concatenate([run.deviation for run in given]), "the errors"))
    ax.set(xlabel="time (s)", ylabel=r"norm of the error $|\rho|$")
    legend_above(ax)
    return drawn((ax,), sentences)


def gramian(found: Gramian | Sequence[Gramian], labels: Sequence[str] | None = None, ax: Axes | None = None) -> Figure:
    """Smallest eigenvalue of the windowed Gramian over the window's beginning; the text tells its verdict.

    Parameters
    ----------
    found : Gramian or sequence of Gramian
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
        If there is none, or something else among them.
    """
    given = [found] if isinstance(found, Gramian) else list(found) if isinstance(found, Iterable) else []
    if not given or not all(isinstance(one, Gramian) for one in given):
        raise ValueError(f"a Gramian or several are needed, not {found!r}; points.gramian.gramian() makes one")
    names = labels_for(given, labels, [f"{one.window:g} s window" for one in given])
    ax = ax or new_axes(3.2)
    tidy(ax)
    sentences = ["Smallest eigenvalue of the Gramian over the beginning of its window, on a logarithmic axis."]
    for number, (one, name) in enumerate(zip(given, names, strict=True)):
        look, shown = style(number), np.maximum(one.smallest, ROUND_OFF)
        ax.plot(one.time, shown, color=look["color"], linestyle="-" if number == 0 else look["linestyle"], label=name)
        ax.plot(one.time[shown.argmin()], shown.min(), color=look["color"], marker=look["marker"])
        sentences.append(f"{name}: {one.verdict()}.")
    every = np.maximum(np.concatenate([one.smallest for one in given]), ROUND_OFF)
    ax.set_yscale("log")
    ax.set_ylim(every.min() / 3, 3 * every.max())
    ax.minorticks_off()
    ax.set(xlabel="beginning of the window (s)", ylabel="smallest eigenvalue")
    legend_above(ax)
    return drawn((ax,), sentences)


def depth_errors(errors: Mapping[str, ArrayLike], after: float, ax: Axes | None = None) -> Figure:
    """Relative errors of depths, each one and their median, for several ways of estimating them.

    Parameters
    ----------
    errors : mapping of names to arrays
        Relative errors, such as from `PointsRun.depth_errors`; infinite where an estimate is behind the camera.
    after : float
        Seconds since first sight, for the words.
    ax : axes, optional
        New ones when left out.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If there is none, or a name has none.
    """
    given = {name: np.asarray(values, dtype=float).ravel() for name, values in errors.items()}
    if not given or not all(len(values) and not np.isnan(values).any() for values in given.values()):
        raise ValueError("each name needs relative errors, of at least one sighting and without NaN")
    ax = ax or new_axes(1.0 + 0.5 * len(given))
    tidy(ax)
    ax.grid(False, axis="y")
    seen = finite(np.concatenate(list(given.values())))
    low, high = max(seen.min(initial=1.0), 1e-4), max(seen.max(initial=0.0), 1.0)
    sentences = [f"Relative errors of the depth {after:g} s after first sight, on a logarithmic axis."]
    for place, (name, values) in enumerate(given.items()):
        shown, middle = np.clip(values, low, 2 * high), float(np.median(values))
        ax.plot(shown, np.full_like(shown, place), color=SKY, linestyle="", marker="|", markersize=12)
        ax.plot(np.clip(middle, low, 2 * high), place, color=VERMILLION, marker="o")
        ax.annotate(f"{middle:.1%}", (np.clip(middle, low, 2 * high), place), (0, 8), textcoords="offset points")
        behind = int(np.isinf(values).sum())
        sentences.append(
            f"{name}: {len(values)} sightings, median {middle:.1%}"
            + (f", {behind} of them behind the camera." if behind else f", at most {values.max():.1%}.")
        )
    ax.set_xscale("log")
    ax.set_xlim(low / 1.5, 3 * high)
    ax.set_yticks(range(len(given)), list(given))
    ax.set_ylim(len(given) - 0.5, -0.7)
    ax.axvline(1.0, color=GREY, linewidth=0.8, linestyle=":")
    ax.set_xlabel(f"relative error of the depth after {after:g} s; the dots are medians")
    return drawn((ax,), sentences)
