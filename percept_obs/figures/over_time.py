"""Figures of several runs over time: a coordinate with its errors, and the distance in metres."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures import axis, curves, given, look, words
from percept_obs.figures.base import Array, Drawing, figure, legend_above, rows
from percept_obs.observability.bound import Bound
from percept_obs.recording import Recording
from percept_obs.studies.consistency import claimed_distance
from percept_obs.system.surfaces import ImagingSurface
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import TOLERANCE


@figure("runs, labels or axes do not fit each other, or the truth or the coordinate is not known")
def runs_over_time(
    runs: Run | Sequence[Run],
    labels: Sequence[str] | None = None,
    coordinate: str | None = None,
    axes: Sequence[Axes] | None = None,
    tolerance: float = TOLERANCE,
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
    tolerance : float
        Bound on the relative error of the distance, for the verdicts.
    bound : Bound, optional
        From `cramer_rao` on the same truth: the least standard deviation, drawn under the errors.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, figures, ibo, pinhole, record, scenarios, track
    >>> run = track(record(scenarios.ma2005_eq35(), 20), ibo(PerspectiveSystem(affine(), pinhole())))
    >>> print(figures.runs_over_time(run).text.split(": ", 2)[2])
    Converged: the relative error of the distance stays within 10 % after 1.91 s.
    """
    runs = given.runs_of_one_point(runs)
    labels = given.labels_for(labels, _descriptions(runs))
    recording, view = runs[0].recording, runs[0].recording.view
    if recording.truth is None:
        raise ValueError(
            "the recording has no truth to compare with; distance(runs) and signals(run) draw runs without one"
        )
    names = [symbol.name for symbol in view.coordinates]
    coordinate = coordinate or names[-1]
    if coordinate not in names:
        raise ValueError(f"there is no coordinate {coordinate!r}; there are {', '.join(names)}")
    column, said = names.index(coordinate), words.coordinate(coordinate, view)
    upper, lower = rows(axes, [2.2, 2.0], ["the estimates", "the errors"])
    truth = recording.truth[:, column]
    estimates = np.array([run.estimate[:, column] for run in runs])
    errors = np.abs(truth - estimates)
    looks = [look.style(number) for number in range(len(runs))]
    upper.plot(recording.elapsed, truth, **look.TRUTH)
    curves.draw(upper, recording.elapsed, estimates, _with_divergence(runs, labels), looks)
    curves.draw_errors(lower, recording.elapsed, errors, labels, looks)
    least = curves.draw_bound(lower, recording, bound, coordinate) if bound is not None else ""
    upper.set_ylabel(words.label(coordinate, view))
    lower.set_ylabel(f"|error of {words.letter(coordinate)}|")
    outside = axis.linear(upper, truth, estimates, f"the estimates of {said}")
    yield (
        f"{said} over {words.times(runs[0])}: the truth, {words.span(truth)}, the estimates of {_counted(runs)}, "
        "and below them the absolute errors on a logarithmic axis."
    )
    for name, run, each in zip(labels, runs, looks, strict=True):
        claim = curves.draw_claim_of_coordinate(upper, run, column, each["color"])
        yield words.joined(f"{name}:", words.story(run, tolerance), claim)
    yield outside
    yield axis.log(lower, errors, "the errors")
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
    """
    runs = given.runs_of_one_point(runs)
    labels = given.labels_for(labels, _descriptions(runs))
    recording = runs[0].recording
    word, symbol = words.depth_or_range(recording.view)
    estimates = np.array([np.where(np.isfinite(run.distance), run.distance, np.nan) for run in runs])
    known = _known_distances(recording)
    reference = reference or next(iter(known), None)
    if reference is not None and reference not in known:
        raise ValueError(f"there is no reference {reference!r}; there are {', '.join(known) or 'none'}")
    parts = [f"the {word}", *(["its relative error"] if reference else [])]
    upper, *lower = rows(axes, [2.2, 1.8][: len(parts)], parts)
    for name, values in known.items():
        upper.plot(recording.elapsed, values, **(look.TRUTH if name == "truth" else look.dots(values, label=name)))
    looks = [look.style(number) for number in range(len(runs))]
    curves.draw(upper, recording.elapsed, estimates, _with_divergence(runs, labels), looks)
    if np.isnan(estimates).all():
        upper.text(0.5, 0.5, "no estimate in front of the camera", ha="center", transform=upper.transAxes)
    upper.set_ylabel(f"{word} ${symbol}$ (m)")
    firm = known[reference] if reference else axis.bulk(estimates)
    errors = 100 * np.abs(estimates / firm - 1) if reference else np.full_like(estimates, np.nan)
    outside = axis.linear(upper, firm, estimates, f"the estimated {word}", reach=0.5)
    yield f"Estimated {word} in metres over {words.times(runs[0])}, {_counted(runs)}."
    for name, values in known.items():
        yield f"By the {name} it is {words.span(values)} m."
    for name, run, error, each in zip(labels, runs, errors, looks, strict=True):
        yield words.joined(f"{name}:", _distance_story(run, error), _draw_claim(upper, run, each["color"]))
    yield outside
    legend_above(upper)
    for ax in lower:
        curves.draw_errors(ax, recording.elapsed, errors, labels, looks)
        ax.set_ylabel("relative error (%)")
        yield f"Below, the errors relative to the {reference}, in per cent on a logarithmic axis."
        yield axis.log(ax, errors, "the relative errors", highest=1000, ticks="{x:g}")
    return [upper, *lower]


def _known_distances(recording: Recording) -> dict[str, Array]:
    """The true distance, if there is one, and what else measured it."""
    truth = {} if recording.truth is None else {"truth": recording.distance}
    return {**truth, **recording.distances}


def _draw_claim(ax: Axes, run: Run, colour: str) -> str:
    """Draw the interval that the observer claims for the distance, and say it; nothing if it claims none."""
    if run.observer.covariance is None or not isinstance(run.recording.view, ImagingSurface):
        return ""
    low, high = claimed_distance(run)
    told = curves.draw_claim(ax, run, low, high, _known_distances(run.recording).get("truth"), colour)
    unbounded = int(np.isposinf(high).sum())
    reason = "it has no upper end, as the interval of the inverse distance reaches zero"
    return words.joined(told, f"In {unbounded} of {len(high)} samples {reason}." if unbounded else "")


def _counted(runs: Sequence[Run]) -> str:
    return "1 run" if len(runs) == 1 else f"{len(runs)} runs"


def _descriptions(runs: Sequence[Run]) -> list[str]:
    """What tells the runs apart: observers, measured outputs and differing gains."""
    kinds = [f"{run.observer.name} ({', '.join(run.measured)})" for run in runs]
    gains = [{gain.name: gain.value for gain in run.observer.gains} for run in runs]
    found = []
    for kind, own in zip(kinds, gains, strict=True):
        others = [other for other, same in zip(gains, kinds, strict=True) if same == kind]
        differing = [f"{name} {value:g}" for name, value in own.items() if any(o.get(name) != value for o in others)]
        found.append(", ".join([kind, *differing]))
    return found


def _with_divergence(runs: Sequence[Run], labels: Sequence[str]) -> list[str]:
    """Labels that say when a curve ends, and why."""
    ends = ["" if run.diverged_at is None else f", diverged at {run.diverged_at:.3g} s" for run in runs]
    return [f"{name}{end}" for name, end in zip(labels, ends, strict=True)]


def _distance_story(run: Run, error: Array) -> str:
    later = words.finite(error[len(error) // 2 :])
    behind = int((~np.isfinite(run.distance)).sum())
    return words.joined(
        words.story(run),
        f"Over the last half its median relative error is {np.median(later):.2g} %." if later.size else "",
        f"{behind} of {len(run.elapsed)} estimates are not in front of the camera: gaps." if behind else "",
    )
