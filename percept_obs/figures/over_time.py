"""Figures of several runs over time: a coordinate with its errors, and the distance in metres."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from percept_obs.figures.base import (
    TRUTH,
    Array,
    Figure,
    bulk,
    claim_of_coordinate,
    depth_or_range,
    dots,
    draw_claim,
    draw_curves,
    draw_errors,
    drawn,
    finite,
    label,
    legend_above,
    letter,
    linear_axis,
    log_axis,
    rows,
    span,
    style,
    words,
)
from percept_obs.figures.labels import labels_for, list_of_runs, same_point, story, time_in_words
from percept_obs.recording import Recording
from percept_obs.studies.consistency import claimed_distance
from percept_obs.system.surfaces import ImagingSurface
from percept_obs.tracking.run import Run


def compare(
    runs: Run | Sequence[Run],
    labels: Sequence[str] | None = None,
    coordinate: str | None = None,
    axes: Sequence[Axes] | None = None,
    tolerance: float = 0.05,
) -> Figure:
    """One coordinate as several observers estimate it, and their errors.

    Around the estimates of an observer that claims a covariance there is a band of two standard deviations to either
    side.

    Parameters
    ----------
    runs : Run or sequence of Run
        On one recording, or on several of the same point, such as with and without noise.
    labels : sequence of str, optional
        One for each run; observers' names, measured outputs and differing gains when left out.
    coordinate : str, optional
        Such as "y1"; the inverse distance when left out.
    axes : two axes, optional
        For the estimates and for the errors; new ones when left out.
    tolerance : float
        Bound on the hidden coordinates' errors, for the verdicts.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If there are no runs, they followed different points, the truth is not known, there is no such coordinate,
        or the number of labels or axes is wrong.
    """
    runs = list_of_runs(runs)
    same_point(runs)
    labels = labels_for(runs, labels, _descriptions(runs))
    shown = _with_divergence(runs, labels)
    recording, surface = runs[0].recording, runs[0].recording.view
    if recording.truth is None:
        raise ValueError(
            "the recording has no truth to compare with; distance(runs) and signals(run) draw runs without one"
        )
    names = [symbol.name for symbol in surface.coordinates]
    coordinate = coordinate or names[-1]
    if coordinate not in names:
        raise ValueError(f"there is no coordinate {coordinate!r}; there are {', '.join(names)}")
    column = names.index(coordinate)
    upper, lower = rows(axes, [2.2, 2.0], ["the estimates", "the errors"])
    truth = recording.truth[:, column]
    estimates = np.array([run.estimate[:, column] for run in runs])
    errors = np.abs(truth - estimates)
    looks = [style(number) for number in range(len(runs))]
    upper.plot(recording.time, truth, **TRUTH)
    draw_curves(upper, recording.time, estimates, shown, looks)
    draw_errors(lower, recording.time, errors, labels, looks)
    upper.set_ylabel(label(coordinate, surface))
    lower.set_ylabel(f"|error of {letter(coordinate)}|")
    said = words(coordinate, surface)
    outside = linear_axis(upper, truth, estimates, f"the estimates of {said}")
    claims = [claim_of_coordinate(upper, run, column, look["color"]) for run, look in zip(runs, looks, strict=True)]
    legend_above(upper)
    return drawn(
        (upper, lower),
        [
            f"{said} over {time_in_words(runs[0])}: the truth, {span(truth)}, the estimates of {_counted(runs)}, "
            "and below them the absolute errors on a logarithmic axis.",
            *(
                f"{name}: {story(run, tolerance)} {claim}".rstrip()
                for name, run, claim in zip(labels, runs, claims, strict=True)
            ),
            outside,
            log_axis(lower, errors, "the errors"),
        ],
    )


def distance(
    runs: Run | Sequence[Run],
    labels: Sequence[str] | None = None,
    reference: str | None = None,
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """Depth or range in metres, and its relative error.

    Whatever else measured the distance, the recording's `distances`, is drawn as dots.  For an observer that claims a
    covariance there is a band of all distances whose inverse lies within two standard deviations of the estimate;
    where these reach zero, the band has no upper end.

    Parameters
    ----------
    runs : Run or sequence of Run
        On one recording, or on several of the same point.
    labels : sequence of str, optional
        One for each run; observers' names, measured outputs and differing gains when left out.
    reference : str, optional
        What the errors are relative to: "truth", or the name of one of the recording's `distances`.  The truth when
        left out or, if the recording has none, the first of the distances.
    axes : two axes, optional
        For the distance and for the error; new ones when left out.  Without any reference there is no error, and
        one is enough.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If there are no runs, they followed different points, there is no such reference, or the number of labels or
        axes is wrong.
    """
    runs = list_of_runs(runs)
    same_point(runs)
    labels = labels_for(runs, labels, _descriptions(runs))
    shown = _with_divergence(runs, labels)
    recording = runs[0].recording
    word, symbol = depth_or_range(recording.view)
    estimates = np.array([np.where(np.isfinite(run.distance), run.distance, np.nan) for run in runs])
    known = _known_distances(recording)
    reference = reference or next(iter(known), None)
    if reference is not None and reference not in known:
        raise ValueError(f"there is no reference {reference!r}; there are {', '.join(known) or 'none'}")
    contents = [f"the {word}", *(["its relative error"] if reference else [])]
    upper, *lower = rows(axes, [2.2, 1.8][: len(contents)], contents)
    for name, values in known.items():
        upper.plot(recording.time, values, **(TRUTH if name == "truth" else dots(values, label=name)))
    looks = [style(number) for number in range(len(runs))]
    draw_curves(upper, recording.time, estimates, shown, looks)
    if np.isnan(estimates).all():
        upper.text(0.5, 0.5, "no estimate in front of the camera", ha="center", transform=upper.transAxes)
    upper.set_ylabel(f"{word} ${symbol}$ (m)")
    firm = known[reference] if reference else bulk(estimates)
    outside = linear_axis(upper, firm, estimates, f"the estimated {word}", reach=0.5)
    claims = [_claim_of_distance(upper, run, look["color"]) for run, look in zip(runs, looks, strict=True)]
    legend_above(upper)
    errors = 100 * np.abs(estimates / firm - 1) if reference else np.full_like(estimates, np.nan)
    sentences = [
        f"Estimated {word} in metres over {time_in_words(runs[0])}, {_counted(runs)}.",
        *(f"By the {name} it is {span(values)} m." for name, values in known.items()),
        *(f"{name}: {_distance_story(*each)}" for name, *each in zip(labels, runs, errors, claims, strict=True)),
        outside,
    ]
    for ax in lower:
        draw_errors(ax, recording.time, errors, labels, looks)
        ax.set_ylabel("relative error (%)")
        sentences.append(f"Below, the errors relative to the {reference}, in per cent on a logarithmic axis.")
        sentences.append(log_axis(ax, errors, "the relative errors", highest=1000, ticks="{x:g}"))
    return drawn((upper, *lower), sentences)


def _known_distances(recording: Recording) -> dict[str, Array]:
    """The true distance, if there is one, and what else measured it."""
    truth = {} if recording.truth is None else {"truth": 1 / recording.view.inverse(recording.truth)}
    return {**truth, **recording.distances}


def _claim_of_distance(ax: Axes, run: Run, colour: str) -> str:
    """The same for the distance."""
    if run.observer.covariance is None or not isinstance(run.recording.view, ImagingSurface):
        return ""
    low, high = claimed_distance(run)
    words = draw_claim(ax, run, low, high, _known_distances(run.recording).get("truth"), colour)
    unbounded = int(np.isposinf(high).sum())
    if not unbounded:
        return words
    return (
        f"{words} In {unbounded} of {len(high)} samples it has no upper end, as the interval of the inverse distance "
        "reaches zero."
    )


def _counted(runs: Sequence[Run]) -> str:
    return "1 run" if len(runs) == 1 else f"{len(runs)} runs"


def _descriptions(runs: Sequence[Run]) -> list[str]:
    """What tells the runs apart: observers, measured outputs and differing gains."""
    kinds = [f"{run.observer.name} ({', '.join(run.observer.form.measured)})" for run in runs]
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


def _distance_story(run: Run, error: Array, claim: str) -> str:
    later = finite(error[len(error) // 2 :])
    behind = int((~np.isfinite(run.distance)).sum())
    sentences = [
        story(run),
        f"Over the last half its median relative error is {np.median(later):.2g} %." if later.size else "",
        f"{behind} of {len(run.time)} estimates are not in front of the camera: gaps." if behind else "",
        claim,
    ]
    return " ".join(filter(None, sentences))
