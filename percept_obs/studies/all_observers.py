"""Every observer on a set of recordings in one call: gains chosen on one part, errors reported on the other."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from typing import Any, Literal

import numpy as np

from percept_obs.compile import choose
from percept_obs.observability.windows import information_along
from percept_obs.observers import OBSERVERS, Observer
from percept_obs.observers.family import Family
from percept_obs.recording import Recording
from percept_obs.recording.footage import Footage
from percept_obs.studies.comparison import ABOUT, Columns, Comparison, Estimate, Follow, error_at, number_of, rows_of
from percept_obs.studies.least_squares import moving_window_least_squares
from percept_obs.studies.tuning import MOST, STARTS, best_setting, tune_by_likelihood
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.signal import from_the_start, slack_of
from percept_obs.system.surfaces import ImagingSurface
from percept_obs.tracking.following import DoesNotFit, require_match, track
from percept_obs.tracking.function import FunctionObserver
from percept_obs.tracking.run import Run
from percept_obs.validation import bar, checked, load_pandas, once

__all__ = ["all_observers"]

Gains = Mapping[str, float]
Candidates = Mapping[Family | FunctionObserver, Sequence[Gains]]
Split = Literal["alternating", "earlier and later"]

LEAST_SQUARES = "least squares on 2 s"
"""Label of the batch estimate in the table; it has no gains."""

MOST_CHOOSING = 50
"""Most recordings on which gains are chosen: their errors scatter less than those of different gains differ."""

MOST_JUDGED = 20
"""Most runs of an observer that are judged where there is no truth, at a tenth of a second each."""

SMALLEST = 1e-5
"""A gain that may be 0 is searched from this share of its largest value on, for the search is over its logarithm."""

USUAL_SPEED = 0.2
"""Root mean square of |w|, in lengths a second, that the candidates' gains are made for."""


@checked
def all_observers(
    recordings: Sequence[Recording],
    split: Split = "alternating",
    start: Mapping[str, float] | None = None,
    after: Sequence[float] = (1.0, 2.0, 3.0),
    references: Sequence[str] | None = None,
    candidates: Candidates | None = None,
    max_tracks: int | None = None,
    choosing: Sequence[Recording] = (),
    form: PartitionedSystem | None = None,
    length: float | None = None,
    columns: Columns | None = None,
    **settings: Any,
) -> Comparison:
    """Choose every observer's gains on some recordings of single points, and report its errors on others.

    Parameters
    ----------
    recordings : sequence of Recording
        At least two that fit together: with the outputs, the imaging surface and the kind of motion of the first one.
    split : "alternating" or "earlier and later"
        Choose gains on every other recording, from the first one on; or on the half that begins earlier, which is
        stricter where neighbours see the same movement.  Of many recordings 50 are enough to choose on, evenly sampled.
    start : mapping of coordinate names to values, optional
        Estimates at the first sample; twice the median distance of the recordings to choose on when left out.
    after : sequence of float
        Seconds since the first sample at which errors are looked at; those that recordings last.
    references : sequence of str, optional
        "truth", or names of measured distances, of which a recording has one; gains are chosen by the first of them.
        Those of a film, or the truth, when left out.
    candidates : mapping of families to their gains, optional
        Those with the least sum of median errors are chosen; the candidates in every observer's own file when left out.
    max_tracks : int, optional
        Most recordings to use, evenly sampled.
    choosing : sequence of Recording, optional
        Recordings to choose on, which the `split` takes of the others when left out.
    form : PartitionedSystem, optional
        What the observers observe, with fewer outputs, say; all that was recorded when left out.
    length : float, optional
        The recordings' unit of length for all observers, see `Recording`; one by which their gains fit when left out.
    columns : mapping of names to functions of a run, optional
        Further numbers, see `compare`.
    **settings
        Passed to `track`, such as ``hold`` and ``step``.

    Returns
    -------
    Comparison
        Its table has gains (those chosen, by the length), at_edge (names of gains at the smallest or largest of their
        candidates, beyond which better ones may lie) and, for every reference and time, relative errors of the
        distance, such as "truth 2 s": infinite without an estimate in front of the camera, NaN for recordings that end
        earlier.  Least squares on 2 s, which have no gains, stand beside the observers of all outputs.

    Raises
    ------
    ValueError
        If fewer than two recordings can be used, or none of the times, one is given twice, or options contradict.
    DoesNotFit
        If the first recording has another view, other outputs or another motion than the form.

    See Also
    --------
    percept_obs.studies.comparison.compare : Observers with gains as they are.
    percept_obs.studies.tuning.best_setting : Chooses the gains of one.

    Notes
    -----
    Where no recording has a truth, the extended Kalman filter is tuned by its likelihood, and its distance stands for
    the true one: other observers have the gains with which they agree best with it, and the table has differences from
    it.  It also has the relative standard deviations that observers claim, such as "claimed 2 s", and for 20 runs at
    most whether `Run.trust` trusts them.

    Examples
    --------
    >>> from percept_obs import Camera, Uniform, record, scenarios
    >>> from percept_obs.observers import de_luca, spica
    >>> camera = Camera(period=0.05, noise=Uniform(0.01))
    >>> seen = [record(scenarios.ma2005_eq35(), seconds, camera, k) for k, seconds in enumerate((3, 3, 3, 3, 0.5))]
    >>> found = all_observers(seen, candidates={make: make.candidates[:1] for make in (de_luca, spica)})
    >>> found.summary.index.tolist()
    ['De Luca', 'Spica', 'least squares on 2 s']
    >>> print(*found.left_out.values())
    it lasts 0.5 s, and the first error is asked for after 1 s
    """
    if references is None:
        references = recordings.references if isinstance(recordings, Footage) else ("truth",)
    if not len(recordings):
        raise ValueError("there are no recordings; give at least two, one to choose gains on and one to report on")
    if not len(references) or not len(after):
        raise ValueError(f"{len(references)} references and {len(after)} times after: at least one of each is needed")
    if not all(math.isfinite(seconds) and seconds >= 0 for seconds in after):
        raise ValueError(f"after is {list(after)!r}; the times must be finite and not negative, in seconds")
    once(after=after, references=references)
    if len(choosing) and split != "alternating":
        raise ValueError("choosing says which recordings to choose on, and so does split; give one of the two")
    if max_tracks is not None and max_tracks < 2:
        raise ValueError(f"max_tracks is {max_tracks}; two are needed, one to choose gains on and one to report on")
    if len({id(each) for each in (*choosing, *recordings)}) < len(choosing) + len(recordings):
        raise ValueError(
            "a recording is given twice, or in both halves: its errors would be too small if gains were chosen on it"
        )
    tried = dict[Family | FunctionObserver, Sequence[Gains]]({make: make.candidates for make in OBSERVERS})
    tried = tried if candidates is None else dict(candidates)
    if not tried or not all(map(len, tried.values())):
        raise ValueError("every observer needs at least one candidate for its gains")
    given = [*choosing, *recordings]
    first = given[0]
    if form is None:
        form = PerspectiveSystem(first.motion, first.imaging_surface).partition(*first.names)
    require_match(form, first, first.motion)
    blind = tuple(references) == ("truth",) and all(each.truth is None for each in given)
    reasons = [_why_not(each, form, first, () if blind else references, min(after)) for each in given]
    left_out = {
        f"recording {number} ({each.source})": reason
        for number, (each, reason) in enumerate(zip(given, reasons, strict=True), 1)
        if reason
    }
    count = len(choosing)
    halves = (choosing, reasons[:count]), (recordings, reasons[count:])
    choosing, reporting = ([each for each, why in zip(*half, strict=True) if not why] for half in halves)
    usable = len(choosing) + len(reporting)
    if usable < 2 or not reporting or (count and not choosing):
        unusable = "; ".join(f"{name}: {reason}" for name, reason in left_out.items())
        raise ValueError(
            f"{usable} of {len(given)} recordings can be used, and two are needed, one to choose gains on "
            f"and one to report on; cut one in two with between(){'; left out: ' + unusable if unusable else ''}"
        )
    notes = []
    if max_tracks is not None and len(reporting) > max_tracks:
        notes.append(f"{max_tracks} of {len(reporting)} recordings were taken, evenly sampled")
        reporting = evenly(reporting, max_tracks)
    if not count:
        half = len(reporting) // 2
        choosing, reporting = _halves(reporting, split)
        if len(choosing) < half:
            notes.append(f"{len(choosing)} recordings, evenly sampled, are enough to choose gains on")
    shorter = min(max(float(each.elapsed[-1]) + slack_of(each.time) for each in half) for half in (choosing, reporting))
    left_out |= {
        f"errors after {seconds:g} s": f"no recording in one of the halves lasts longer than {shorter:.3g} s"
        for seconds in after
        if seconds > shorter
    }
    lasting = [seconds for seconds in after if seconds <= shorter]
    image = first.view.image_coordinates if isinstance(first.view, ImagingSurface) else ()
    whole = form.measured == first.names == tuple(symbol.name for symbol in image)
    batch = {LEAST_SQUARES: moving_window_least_squares} if whole else {}
    if start is None:
        known = [run.distance for run in map(moving_window_least_squares, choosing)] if blind and whole else []
        known += [] if blind else [each.reference(references[0]) for each in choosing]
        distances = np.concatenate([np.empty(0), *known])
        distances = distances[np.isfinite(distances)]
        inverse = first.imaging_surface.inverse_distance.name
        start = {inverse: 1 / (2 * float(np.median(distances)))} if len(distances) else {}
    samples, others = (sum(len(each.time) for each in half) for half in (choosing, reporting))
    most = max([*map(len, tried.values()), len(STARTS) * MOST * blind])
    settings = {"language": choose(None, samples * most + others)} | settings

    def follow(recording: Recording, observer: Observer) -> Run:
        return track(recording, observer, start, **settings)

    length = own_length(form, choosing) if length is None else length
    if blind:
        label, estimate, sentence = _judge(
            [replace(each, unit=length) for each in choosing], form, follow, tried, batch
        )
        count = len(choosing) + len(reporting)
        choosing, reporting = (_with_distance(half, label, estimate, length) for half in (choosing, reporting))
        notes.append(sentence)
        if lost := count - len(choosing) - len(reporting):
            notes.append(f"{lost} recordings are left out, for {label} has no estimate in front of the camera there")
        if first.distances:
            notes.append(f"To compare with what was measured, name references, such as {', '.join(first.distances)}")
        references = (label,)
    ours, theirs = ([replace(each, unit=length) for each in half] for half in (choosing, reporting))
    asked: dict[str, Callable[[Run], float]] = {
        f"{reference} {seconds:g} s": partial(error_at, after=seconds, reference=reference)
        for reference, seconds in product(references, lasting)
    }
    errors = [*asked]
    if blind:
        judged = {id(each) for each in evenly(theirs, MOST_JUDGED)}
        asked |= {f"claimed {seconds:g} s": partial(_claim, seconds=seconds) for seconds in lasting}
        asked["trusted"] = lambda run: float(run.trust().trusted) if id(run.recording) in judged else math.nan
    if clash := {*(columns or {})} & {*ABOUT, *asked, "cost"}:
        raise ValueError(f"columns has {', '.join(sorted(clash))}, which the table has already; take another name")
    asked |= columns or {}

    def measures(run: Run) -> dict[str, float]:
        return {name: number_of(name, of, run) for name, of in asked.items()}

    rows: list[dict[str, Any]] = []
    for make, gains in bar(tried.items(), "choosing gains", unit="observer"):
        refusal = make.refusal(form)
        try:
            settled = [] if refusal else _settled(make, form, gains)
            chosen = best_setting(ours, settled, follow, lasting, references[0]) if settled else None
        except DoesNotFit as error:
            refusal, chosen = str(error), None
        if chosen is None:
            rows.append({"observer": make.name, "refusal": refusal})
            continue
        values = {gain.name: gain.value for gain in chosen.gains if gain.name in gains[0]}
        about = {
            "gains": ", ".join(f"{name} {value:.3g}" for name, value in values.items()),
            "at_edge": ", ".join(_at_edge(values, settled)),
        }
        rows += rows_of(chosen.name, partial(follow, observer=chosen), theirs, measures, about)
    for label, estimate in batch.items():
        rows += rows_of(label, estimate, theirs, measures)
    names = ["observer", "gains", "at_edge", "recording", *asked, "resets", "diverged_at", "cost", "refusal", "warning"]
    table = load_pandas().DataFrame(rows, columns=names)
    table = table.fillna(dict.fromkeys(("gains", "at_edge", "recording", "refusal", "warning"), ""))
    if blind:
        table.loc[table["observer"] == references[0], errors] = np.nan
    return Comparison(table, choosing, reporting, left_out, start, tuple(notes))


def _settled(make: Family | FunctionObserver, form: PartitionedSystem, gains: Sequence[Gains]) -> list[Any]:
    """Observers with each of some gains, derived once if these are numbers of the same equations."""
    first, names = make(form, **gains[0]), gains[0].keys()
    alike = all(each.keys() == names for each in gains)
    if alike and isinstance(first, Observer) and names <= {gain.name for gain in first.gains}:
        return [first.with_gains(**each) for each in gains]
    return [make(form, **each) for each in gains]


def _halves(recordings: list[Recording], split: Split) -> tuple[list[Recording], list[Recording]]:
    """Recordings to choose gains on, and those to report on."""
    if split == "alternating":
        apart = max(2, math.ceil(len(recordings) / MOST_CHOOSING))
        return recordings[::apart], [each for k, each in enumerate(recordings) if k % apart]
    earlier, half = sorted(recordings, key=lambda recording: float(recording.time[0])), len(recordings) // 2
    return evenly(earlier[:half], MOST_CHOOSING), earlier[half:]


def _with_distance(recordings: Sequence[Recording], label: str, estimate: Estimate, length: float) -> list[Recording]:
    """Recordings with an estimated distance among those measured; those without any estimate are left out."""
    found = []
    for each in bar(recordings, label):
        distance = estimate(replace(each, unit=length)).distance
        known = np.where(np.isfinite(distance), distance, np.nan)
        found += [replace(each, distances={**each.distances, label: known})] if np.isfinite(known).any() else []
    return found


def _judge(
    choosing: Sequence[Recording],
    form: PartitionedSystem,
    follow: Follow,
    tried: dict[Family | FunctionObserver, Sequence[Gains]],
    batch: Mapping[str, Estimate],
) -> tuple[str, Estimate, str]:
    """Label and function of the estimate that stands for a truth, and a sentence; filters in `tried` are tuned."""
    label, estimate, tuned = LEAST_SQUARES, batch.get(LEAST_SQUARES), ""
    for make, candidates in tried.items():
        observer = None if make.refusal(form) or not candidates else make(form, **candidates[0])
        if not isinstance(observer, Observer) or observer.covariance is None or not observer.equations.update:
            continue
        if label != LEAST_SQUARES:  # the first filter judges
            break
        values = {gain.name: {each.get(gain.name, gain.value) for each in candidates} for gain in observer.gains}
        ranges = {
            gain.name: (0.01 * gain.low or SMALLEST * gain.high, gain.high)
            for gain in observer.gains
            if len(values[gain.name]) > 1
        }
        if ranges:
            found = tune_by_likelihood(choosing, observer, ranges, follow)
            observer, tried[make] = found.observer, [{**candidates[0], **found.gains}]
            edge = f" (at the edge of what was tried: {', '.join(found.at_edge)})" if found.at_edge else ""
            tuned = f", tuned by the likelihood of its innovations{edge}"
        label, estimate = observer.name, lambda recording, observer=observer: follow(recording, observer)
    if estimate is None:
        raise ValueError("there is no truth, and no filter or least squares for its place; add a filter to candidates")
    sentence = (
        f"There is no truth: the table has differences from {label}{tuned}; other observers have those gains of their "
        "candidates with which they agree best with it. They agree where all are wrong alike, as with a wrong scale of "
        "the motion. Claimed is one standard deviation, trusted at the end the share of some runs, evenly sampled"
    )
    return label, estimate, sentence


def _why_not(
    recording: Recording, form: PartitionedSystem, first: Recording, references: Sequence[str], shortest: float
) -> str:
    """Reason why a recording does not fit into the same table as the first one; empty if it does."""
    if recording.outputs.ndim != 2 or recording.names != first.names:
        return f"its outputs are {', '.join(recording.names)}, those of the first {', '.join(first.names)}"
    if form.view is None or not form.view.fits(recording.view):
        return f"it was seen on the {recording.view.name}, the first one on the {first.view.name}"
    if recording.motion.parameters != first.motion.parameters or recording.motion.A != first.motion.A:
        return f"its motion is {recording.motion.name} with other coefficients than that of the first"
    if not np.isfinite(recording.outputs[0]).all():
        return "its first sample was lost, and observers start from it: cut it with between()"
    there = {*recording.distances, *(["truth"] if recording.truth is not None else [])}
    if lacking := [name for name in references if name not in there]:
        return f"it has no {' and no '.join(lacking)} to compare with; name other references"
    if references and all(np.isnan(recording.reference(name)).all() for name in references):
        return f"its {' and '.join(references)} is known at no sample"
    if recording.elapsed[-1] < shortest - slack_of(recording.time):
        return f"it lasts {recording.elapsed[-1]:.3g} s, and the first error is asked for after {shortest:g} s"
    return ""


def _claim(run: Run, seconds: float) -> float:
    """Relative standard deviation of the distance that an observer claims some seconds after the first sample."""
    late = np.flatnonzero(from_the_start(run.elapsed, seconds))
    if run.observer.covariance is None or not len(late) or not run.estimate[late[0], -1]:
        return math.nan
    return math.sqrt(max(float(run.covariance[late[0], -1, -1]), 0.0)) / abs(float(run.estimate[late[0], -1]))


def evenly(things: Sequence[Any], most: int) -> list[Any]:
    """Return at most so many of some things, evenly sampled."""
    few = np.linspace(0, len(things) - 1, min(most, len(things))).round().astype(int)
    return [things[k] for k in few]


def own_length(form: PartitionedSystem, recordings: Sequence[Recording]) -> float:
    """Length in which the part of |w| with one has the root mean square `USUAL_SPEED`; |b| without a form.

    The error of a hidden coordinate shrinks at a rate that grows with |w|, which depends on how fast the camera moves
    past a point and not on how far away the point is.
    """
    if form.culprits:
        squares = [np.array([recording.motion.speed(recording.time) ** 2]) for recording in recordings]
    else:
        lengths = dict(zip(form.coordinates, recordings[0].view.lengths, strict=False))
        found = [(each, np.diagonal(information_along(form, each), axis1=1, axis2=2)) for each in recordings]
        squares = [each.unit**2 * w[:, [lengths[x] != 0 for x in form.x2]].sum(axis=1) for each, w in found]
    speed = float(np.sqrt(np.mean(np.concatenate(squares))))
    return speed / USUAL_SPEED or 1.0


def _at_edge(chosen: Gains, observers: Sequence[Observer]) -> list[str]:
    """Names of chosen gains that are the smallest or the largest of several that were tried."""
    tried = {name: [g.value for o in observers for g in o.gains if g.name == name] for name in chosen}
    return [n for n, value in chosen.items() if value in (min(tried[n]), max(tried[n])) and len(set(tried[n])) > 1]
