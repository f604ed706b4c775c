"""Figures of runs over time, of the scene in metres, and of a camera's velocity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures import base, curves, describe, look
from percept_obs.figures.base import Array, Drawing, figure, legend_above, rows
from percept_obs.observability.bound import Bound
from percept_obs.recording import Recording
from percept_obs.studies.consistency import claimed_distance
from percept_obs.system.surfaces import ImagingSurface
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import TOLERANCE, diverged

RESIDUALS: tuple[dict[str, Any], ...] = (
    {"color": look.BLUE, "linestyle": "-"},
    {"color": look.GREEN, "linestyle": "-."},
    {"color": look.VERMILLION, "linestyle": "--"},
    {"color": look.PURPLE, "linestyle": ":"},
    {"color": look.ORANGE, "linestyle": (0, (5, 1, 1, 1, 1, 1))},
)
"""Looks of the errors of one run."""

JUDGED: dict[str, Any] = {"color": look.BLACK, "linestyle": "-"}
"""Look of the error that the verdict judges."""


@figure("it is no run, or the number of axes is wrong")
def signals(run: Run, axes: Sequence[Axes] | None = None) -> Drawing:
    """Outputs, estimates and errors of a run over time.

    One row a coordinate, with samples as dots, the truth solid and the estimate dashed, in a band of two claimed
    standard deviations to either side if the observer claims a covariance; in the last row the absolute errors or, if
    the recording has no truth, the absolute innovations.  The black line is the relative error that the verdict judges,
    and the dotted one its tolerance.  Ticks along the top mark resets.

    Parameters
    ----------
    run : Run

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, ibo, pinhole, record, scenarios, track
    >>> run = track(record(scenarios.ma2005_eq35(), 20), ibo(PerspectiveSystem(affine(), pinhole())))
    >>> print(figures.signals(run).text.split(". ")[1])
    Converged: the relative error of the distance stays within 10 % after 1.91 s

    See Also
    --------
    distance : In metres.
    runs_over_time : Several observers.
    """
    (run,) = base.runs_of_one_point(run)
    names = [symbol.name for symbol in run.view.coordinates]
    known = run.recording.truth is not None
    what = "error" if known else "innovation"
    *upper, last = rows(axes, [1.1] * len(names) + [1.6], [*names, f"the {what}"])
    yield (
        f"Outputs and estimates of the {run.observer.name} observer over {describe.times(run)}, with "
        f"{', '.join(run.measured)} measured and {', '.join(run.observer.form.hidden)} hidden."
    )
    yield describe.story(run)
    for column, ax in enumerate(upper):
        yield _coordinate(ax, run, column)
    residuals = np.abs(run.error if known else run.innovation).T
    names = names if known else list(run.measured)
    looks = [RESIDUALS[number % len(RESIDUALS)] for number in range(len(residuals))]
    labels = [describe.letter(name) for name in names]
    if known:  # the tolerance is one of the relative error
        relative = np.where(np.isfinite(run.relative_error), run.relative_error, np.nan)
        residuals, names = np.vstack([residuals, relative]), [*names, f"{run.view.judged}, relative"]
        looks, labels = [*looks, JUDGED], [*labels, names[-1]]
    curves.draw_errors(last, run.elapsed, residuals, labels, looks)
    if known:
        last.axhline(TOLERANCE, color=look.GREY, linewidth=1, linestyle=(0, (2, 2)))
    last.set_ylabel(f"|{what}|")
    yield curves.log(last, residuals, f"the {what}s")
    yield _levels(run, residuals, names, what)
    legend_above(last)
    for ax in (*upper, last):
        _mark_resets_and_divergence(ax, run, named=ax is last)
    legend_above(upper[0])
    return [*upper, last]


def _coordinate(ax: Axes, run: Run, column: int) -> str:
    """Draw samples, truth and estimate of one coordinate; return a sentence on what they are."""
    recording = run.recording
    name = recording.view.coordinates[column].name
    estimate = run.estimate[:, column]
    firm, kind = curves.bulk(estimate), "estimated"
    if name in run.measured:
        firm, kind = recording.outputs[:, recording.names.index(name)], "measured"
        ax.plot(run.elapsed, firm, **look.dots(firm))
    if recording.truth is not None:
        firm, kind = recording.truth[:, column], "true"
        ax.plot(run.elapsed, firm, **look.TRUTH)
    ax.plot(run.elapsed, estimate, **look.ESTIMATE)
    ax.set_ylabel(describe.label(name, recording.view))
    return describe.joined(
        f"The {kind} {describe.coordinate(name, recording.view)} is {describe.span(firm)}.",
        curves.linear(ax, firm, estimate, f"the estimates of {name}"),
        curves.draw_claim_of_coordinate(ax, run, column, look.ESTIMATE["color"]),
    )


def _levels(run: Run, residuals: Array, names: Sequence[str], what: str) -> str:
    """Return the sentence on root mean squares over the last half."""
    late = {name: describe.finite(each[len(run.elapsed) // 2 :]) for name, each in zip(names, residuals, strict=True)}
    levels = [f"{np.sqrt(np.mean(each**2)):.2g} ({name})" for name, each in late.items() if each.size]
    over = f"; root mean square over the last half: {', '.join(levels)}" if levels else ""
    return f"Below them the absolute {what}s on a logarithmic axis{over}."


def _mark_resets_and_divergence(ax: Axes, run: Run, named: bool) -> None:
    ax.set_xlim(run.elapsed[0], run.elapsed[-1])
    if len(run.resets):
        tick: dict[str, Any] = {"color": look.PURPLE, "linewidth": 1, "clip_on": False, "label": "reset"}
        ax.vlines(run.resets - run.time[0], 1, 1.05, transform=ax.get_xaxis_transform(), **tick)
    if run.diverged_at is not None:
        end = run.diverged_at - run.time[0]
        ax.axvspan(end, run.elapsed[-1], color=look.PALE, zorder=0)
        ax.axvline(end, color=look.GREY, linewidth=1)
        aside, ha = (6, "left") if end < run.elapsed[-1] / 2 else (-6, "right")
        place: dict[str, Any] = {"xycoords": ax.get_xaxis_transform(), "textcoords": "offset points", "va": "center"}
        ax.annotate(diverged(end) if named else "", (end, 0.5), (aside, 0), ha=ha, **place)


@figure("runs, labels or axes do not fit each other, or the truth or the coordinate is not known")
def runs_over_time(
    runs: Run | Sequence[Run],
    labels: Sequence[str] | None = None,
    coordinate: str | None = None,
    axes: Sequence[Axes] | None = None,
    bound: Bound | None = None,
) -> Drawing:
    """One coordinate as several observers estimate it, and their errors.

    Around the estimates of an observer that claims a covariance there is a band of two standard deviations to either
    side.

    Parameters
    ----------
    runs : Run or sequence of Run
        On one recording, or on several of the same point, such as with and without noise.
    coordinate : str, optional
        Such as "y1"; the inverse distance when left out.
    bound : Bound, optional
        From `cramer_rao` on the same truth: the least standard deviation, drawn under the errors.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, ibo, pinhole, record, scenarios, track
    >>> run = track(record(scenarios.ma2005_eq35(), 20), ibo(PerspectiveSystem(affine(), pinhole())))
    >>> print(figures.runs_over_time(run).text.split(": ", 2)[2])
    Converged: the relative error of the distance stays within 10 % after 1.91 s.

    See Also
    --------
    distance : Of one run, in metres.
    comparison : Numbers over many runs.
    """
    runs = base.runs_of_one_point(runs)
    labels = base.labels_for(labels, _descriptions(runs))
    recording, view = runs[0].recording, runs[0].recording.view
    if recording.truth is None:
        raise ValueError(
            "the recording has no truth to compare with; distance(runs) and signals(run) draw runs without one"
        )
    names = [symbol.name for symbol in view.coordinates]
    coordinate = coordinate or names[-1]
    if coordinate not in names:
        raise ValueError(f"there is no coordinate {coordinate!r}; there are {', '.join(names)}")
    column, said = names.index(coordinate), describe.coordinate(coordinate, view)
    upper, lower = rows(axes, [2.2, 2.0], ["the estimates", "the errors"])
    truth = recording.truth[:, column]
    estimates = np.array([run.estimate[:, column] for run in runs])
    errors = np.abs(truth - estimates)
    upper.plot(recording.elapsed, truth, **look.TRUTH)
    curves.draw(upper, recording.elapsed, estimates, _with_divergence(runs, labels))
    curves.draw_errors(lower, recording.elapsed, errors, labels)
    least = curves.draw_bound(lower, recording, bound, coordinate) if bound is not None else ""
    upper.set_ylabel(describe.label(coordinate, view))
    lower.set_ylabel(f"|error of {describe.letter(coordinate)}|")
    outside = curves.linear(upper, truth, estimates, f"the estimates of {said}")
    yield (
        f"{said} over {describe.times(runs[0])}: the truth, {describe.span(truth)}, the estimates of {_counted(runs)}, "
        "and below them the absolute errors on a logarithmic axis."
    )
    for name, run, each in zip(labels, runs, look.styles(runs), strict=True):
        claim = curves.draw_claim_of_coordinate(upper, run, column, each["color"])
        yield describe.joined(f"{name}:", describe.story(run), claim)
    yield outside
    yield curves.log(lower, errors, "the errors")
    yield least
    legend_above(upper)
    if least:
        lower.legend(*(part[-1:] for part in lower.get_legend_handles_labels()), loc="upper right", frameon=False)
    return [upper, lower]


@figure("runs, labels or axes do not fit each other, or there is no such reference")
def distance(
    runs: Run | Sequence[Run],
    labels: Sequence[str] | None = None,
    reference: str | None = None,
    axes: Sequence[Axes] | None = None,
) -> Drawing:
    """Depth or range in metres, and its relative error.

    Whatever else measured the distance, the recording's `distances`, is drawn as dots.  For an observer that claims a
    covariance there is a band of all distances whose inverse lies within two standard deviations of the estimate;
    where these reach zero, the band has no upper end.  Without any reference there are no errors, and one row.

    Parameters
    ----------
    runs : Run or sequence of Run
        On one recording, or on several of the same point.
    reference : str, optional
        What the errors are relative to: "truth", or the name of one of the recording's `distances`.  The truth when
        left out or, if the recording has none, the first of the distances.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, ibo, pinhole, record, scenarios, track
    >>> run = track(record(scenarios.ma2005_eq35(), 20), ibo(PerspectiveSystem(affine(), pinhole())))
    >>> print(figures.distance(run).text.split(". ")[1])
    By the truth it is from 1.04 to 7.04 m

    See Also
    --------
    signals : Outputs and coordinates.
    """
    runs = base.runs_of_one_point(runs)
    labels = base.labels_for(labels, _descriptions(runs))
    recording = runs[0].recording
    word, _ = describe.depth_or_range(recording.view)
    estimates = np.array([curves.estimated_distance(run) for run in runs])
    known = _known_distances(recording)
    reference = reference or next(iter(known), None)
    if reference is not None and reference not in known:
        raise ValueError(f"there is no reference {reference!r}; there are {', '.join(known) or 'none'}")
    parts = [f"the {word}", *(["its relative error"] if reference else [])]
    upper, *lower = rows(axes, [2.2, 1.8][: len(parts)], parts)
    for name, values in known.items():
        upper.plot(recording.elapsed, values, **(look.TRUTH if name == "truth" else look.dots(values, label=name)))
    curves.draw(upper, recording.elapsed, estimates, _with_divergence(runs, labels))
    if np.isnan(estimates).all():
        upper.text(0.5, 0.5, "no estimate in front of the camera", ha="center", transform=upper.transAxes)
    upper.set_ylabel(describe.in_metres(recording.view))
    firm = known[reference] if reference else curves.bulk(estimates)
    errors = 100 * np.abs(estimates / firm - 1) if reference else np.full_like(estimates, np.nan)
    outside = curves.linear(upper, firm, estimates, f"the estimated {word}", reach=0.5)
    yield f"Estimated {word} in metres over {describe.times(runs[0])}, {_counted(runs)}."
    for name, values in known.items():
        yield f"By the {name} it is {describe.span(values)} m."
    for name, run, error, each in zip(labels, runs, errors, look.styles(runs), strict=True):
        yield describe.joined(f"{name}:", _distance_story(run, error), _draw_claim(upper, run, each["color"]))
    yield outside
    legend_above(upper)
    for ax in lower:
        curves.draw_errors(ax, recording.elapsed, errors, labels)
        ax.set_ylabel("relative error (%)")
        yield f"Below, the errors relative to the {reference}, in per cent on a logarithmic axis."
        yield curves.log(ax, errors, "the relative errors", highest=1000, ticks="{x:g}")
    return [upper, *lower]


def _known_distances(recording: Recording) -> dict[str, Array]:
    """Return the true distance, if known, and other measurements of it."""
    truth = {} if recording.truth is None else {"truth": recording.distance}
    return {**truth, **recording.distances}


def _draw_claim(ax: Axes, run: Run, colour: str) -> str:
    """Draw the interval that the observer claims for the distance; return a sentence on it, empty if it claims none."""
    if run.observer.covariance is None or not isinstance(run.recording.view, ImagingSurface):
        return ""
    low, high = claimed_distance(run)
    told = curves.draw_claim(ax, run, low, high, _known_distances(run.recording).get("truth"), colour)
    unbounded = int(np.isposinf(high).sum())
    reason = "it has no upper end, as the interval of the inverse distance reaches zero"
    return describe.joined(told, f"In {unbounded} of {len(high)} samples {reason}." if unbounded else "")


def _counted(runs: Sequence[Run]) -> str:
    return "1 run" if len(runs) == 1 else f"{len(runs)} runs"


def _descriptions(runs: Sequence[Run]) -> list[str]:
    """Return labels of runs: observers, measured outputs and differing gains."""
    kinds = [f"{run.observer.name} ({', '.join(run.measured)})" for run in runs]
    gains = [{gain.name: gain.value for gain in run.observer.gains} for run in runs]
    found = []
    for kind, own in zip(kinds, gains, strict=True):
        others = [other for other, same in zip(gains, kinds, strict=True) if same == kind]
        differing = [f"{name} {value:g}" for name, value in own.items() if any(o.get(name) != value for o in others)]
        found.append(", ".join([kind, *differing]))
    return found


def _with_divergence(runs: Sequence[Run], labels: Sequence[str]) -> list[str]:
    """Add the time of divergence to labels."""
    ends = ["" if run.diverged_at is None else f", {diverged(run.diverged_at - run.time[0])}" for run in runs]
    return [f"{name}{end}" for name, end in zip(labels, ends, strict=True)]


def _distance_story(run: Run, error: Array) -> str:
    later = describe.finite(error[len(error) // 2 :])
    behind = int((~np.isfinite(run.distance)).sum())
    return describe.joined(
        describe.story(run),
        f"Over the last half its median relative error is {np.median(later):.2g} %." if later.size else "",
        f"{behind} of {len(run.elapsed)} estimates are not in front of the camera: gaps." if behind else "",
    )
