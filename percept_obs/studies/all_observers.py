"""Every observer on a set of recordings in one call: gains chosen on one part, errors reported on the other."""

from __future__ import annotations

import html
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from percept_obs.compile import choose
from percept_obs.observers import OBSERVERS, Observer
from percept_obs.observers.family import Family
from percept_obs.recording import Recording
from percept_obs.recording.footage import Footage
from percept_obs.studies.comparison import Follow
from percept_obs.studies.least_squares import moving_window_least_squares
from percept_obs.studies.likelihood import MOST, STARTS, tune_by_likelihood
from percept_obs.studies.tuning import Estimate, Gains, choose_and_report, evenly, own_length, side_by_side
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.signal import slack_of
from percept_obs.tracking.following import track
from percept_obs.tracking.function import FunctionObserver
from percept_obs.tracking.run import Run
from percept_obs.validation import bar, checked

if TYPE_CHECKING:
    import pandas as pd

Split = Literal["alternating", "earlier and later"]

LEAST_SQUARES = "least squares on 2 s"
"""Label of the batch estimate in the table; it has no gains."""

MOST_CHOOSING = 50
"""Most recordings on which gains are chosen: their errors scatter less than those of different gains differ."""

MOST_JUDGED = 20
"""Most runs of an observer that are judged where there is no truth, at a tenth of a second each."""

SMALLEST = 1e-5
"""A gain that may be 0 is searched from this share of its largest value on, for the search is over its logarithm."""


@dataclass(frozen=True, eq=False, repr=False)
class AllObservers:
    """Errors of every observer on a set of recordings; a notebook shows them as a table.

    Parameters
    ----------
    table : pandas.DataFrame
        One row for an observer, a reference and a time, as of `choose_and_report`.
    choosing, reporting : sequences of Recording
        Those on which gains were chosen, and those on which errors are reported.
    left_out : mapping of names to reasons
        Recordings and times that could not be used; the table says why an observer could not be run.
    start : mapping of coordinate names to values
        Estimates at the first sample, for every observer.
    notes : tuple of str
        Sentences on what was sampled, and on what stands for a truth where there is none.

    See Also
    --------
    all_observers : Makes it.

    Examples
    --------
    >>> from percept_obs import Camera, Uniform, record, scenarios
    >>> from percept_obs.observers import de_luca
    >>> seen = [record(scenarios.ma2005_eq35(), seconds, Camera(0.05, Uniform(0.01))) for seconds in (3, 3, 0.5)]
    >>> print(*all_observers(seen, candidates={de_luca: [{}]}).left_out.values())
    it lasts 0.5 s, and the first error is asked for after 1 s
    """

    table: pd.DataFrame
    choosing: Sequence[Recording]
    reporting: Sequence[Recording]
    left_out: Mapping[str, str]
    start: Mapping[str, float]
    notes: tuple[str, ...] = ()

    @property
    def side_by_side(self) -> pd.DataFrame:
        """The table as text, one row an observer; see `percept_obs.studies.tuning.side_by_side`."""
        return side_by_side(self.table)

    def _sentences(self) -> Iterator[str]:
        begin = ", ".join(f"{name} = {value:.3g}" for name, value in self.start.items())
        what = "differences" if self.table["trusted"].notna().any() else "errors"
        yield (
            f"Relative {what} of the distance, the median and in brackets the 90 % quantile: gains chosen on "
            f"{len(self.choosing)} recordings, {what} on {len(self.reporting)} others. Every observer starts at "
            f"{begin or 'its own start'}"
        )
        yield from self.notes
        yield from (f"Left out: {name}, for {reason}" for name, reason in self.left_out.items())

    def __repr__(self) -> str:
        return "\n".join([self.side_by_side.to_string(), *self._sentences()])

    def _repr_html_(self) -> str:
        lines = "".join(f"<p>{html.escape(line)}</p>" for line in self._sentences())
        return f"{self.side_by_side.to_html()}{lines}"


@checked
def all_observers(
    recordings: Sequence[Recording],
    split: Split = "alternating",
    start: Mapping[str, float] | None = None,
    after: Sequence[float] = (1.0, 2.0, 3.0),
    references: Sequence[str] | None = None,
    candidates: Mapping[Family | FunctionObserver, Sequence[Gains]] | None = None,
    max_tracks: int | None = None,
    **settings: Any,
) -> AllObservers:
    """Run every observer on a set of recordings of single points, and say what could not be run and why.

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
        The candidates in every observer's own file when left out.
    max_tracks : int, optional
        Most recordings to use, evenly sampled.
    **settings
        Passed to `track`, such as ``hold`` and ``step``.

    Returns
    -------
    AllObservers

    Raises
    ------
    ValueError
        If fewer than two recordings can be used, or none of the times.

    See Also
    --------
    percept_obs.studies.tuning.choose_and_report : takes both halves as they are given

    Notes
    -----
    Where no recording has a truth, the extended Kalman filter is tuned by its likelihood, and its distance stands for
    the true one: other observers have the gains with which they agree best with it, and the table has differences from
    it.  It also has what observers claim, and the share of runs, of 20 at most, that `Run.trust` trusts.

    Examples
    --------
    >>> from percept_obs import Camera, Uniform, record, scenarios
    >>> from percept_obs.observers import de_luca, spica
    >>> camera = Camera(period=0.05, noise=Uniform(0.01))
    >>> seen = [record(scenarios.ma2005_eq35(), 3, camera, seed) for seed in range(4)]
    >>> found = all_observers(seen, candidates={make: make.candidates[:1] for make in (de_luca, spica)})
    >>> sorted(set(found.table["observer"]))
    ['De Luca', 'Spica', 'least squares on 2 s']
    """
    if references is None:
        references = recordings.references if isinstance(recordings, Footage) else ("truth",)
    if not len(recordings):
        raise ValueError("there are no recordings; give at least two, one to choose gains on and one to report on")
    if not len(references) or not len(after):
        raise ValueError(f"{len(references)} references and {len(after)} times after: at least one of each is needed")
    if not all(math.isfinite(seconds) and seconds >= 0 for seconds in after):
        raise ValueError(f"after is {list(after)!r}; the times must be finite and not negative, in seconds")
    if split not in get_args(Split):
        raise ValueError(f"the split {split!r} is none of {' and '.join(map(repr, get_args(Split)))}")
    if max_tracks is not None and max_tracks < 2:
        raise ValueError(f"max_tracks is {max_tracks}; two are needed, one to choose gains on and one to report on")
    first = recordings[0]
    system = PerspectiveSystem(first.motion, first.imaging_surface)
    form = system.partition(*first.names)
    blind = tuple(references) == ("truth",) and all(each.truth is None for each in recordings)
    reasons = [_why_not(each, form, first, () if blind else references, min(after)) for each in recordings]
    left_out = {
        f"recording {number} ({each.source})": reason
        for number, (each, reason) in enumerate(zip(recordings, reasons, strict=True), 1)
        if reason
    }
    usable = [each for each, reason in zip(recordings, reasons, strict=True) if not reason]
    if len(usable) < 2:
        unusable = "; ".join(f"{name}: {reason}" for name, reason in left_out.items())
        raise ValueError(
            f"{len(usable)} of {len(recordings)} recordings can be used, and two are needed, one to choose gains on "
            f"and one to report on; cut one in two with between(){'; left out: ' + unusable if unusable else ''}"
        )
    notes = []
    if max_tracks is not None and len(usable) > max_tracks:
        notes.append(f"{max_tracks} of {len(usable)} recordings were taken, evenly sampled")
        usable = evenly(usable, max_tracks)
    if split == "alternating":
        apart = max(2, math.ceil(len(usable) / MOST_CHOOSING))
        choosing = usable[::apart]
        reporting = [each for k, each in enumerate(usable) if k % apart]
    else:
        usable.sort(key=lambda recording: float(recording.time[0]))
        choosing, reporting = evenly(usable[: len(usable) // 2], MOST_CHOOSING), usable[len(usable) // 2 :]
    if len(choosing) < len(usable) // 2:
        notes.append(f"{len(choosing)} recordings, evenly sampled, are enough to choose gains on")
    shorter = min(max(float(each.elapsed[-1]) + slack_of(each.time) for each in half) for half in (choosing, reporting))
    left_out |= {
        f"errors after {seconds:g} s": f"no recording in one of the halves lasts longer than {shorter:.3g} s"
        for seconds in after
        if seconds > shorter
    }
    whole = first.names == tuple(symbol.name for symbol in first.imaging_surface.image_coordinates)
    batch = {LEAST_SQUARES: moving_window_least_squares} if whole else {}
    if start is None:
        known = [run.distance for run in map(moving_window_least_squares, choosing)] if blind and whole else []
        known += [] if blind else [each.reference(references[0]) for each in choosing]
        distances = np.concatenate([np.empty(0), *known])
        distances = distances[np.isfinite(distances)]
        inverse = first.imaging_surface.inverse_distance.name
        start = {inverse: 1 / (2 * float(np.median(distances)))} if len(distances) else {}
    tried: dict[Family | FunctionObserver, Sequence[Gains]] = {make: make.candidates for make in OBSERVERS}
    tried = tried if candidates is None else dict(candidates)
    samples, others = (sum(len(each.time) for each in half) for half in (choosing, reporting))
    most = max([*map(len, tried.values()), len(STARTS) * MOST * blind])
    settings = {"language": choose(None, samples * most + others)} | settings

    def follow(recording: Recording, observer: Observer) -> Run:
        return track(recording, observer, start, **settings)

    lasting = [seconds for seconds in after if seconds <= shorter]
    length = own_length(form, choosing)
    if blind:
        units = [replace(each, unit=length) for each in choosing]
        label, estimate, sentence = _judge(units, form, follow, tried, batch)
        count = len(choosing) + len(reporting)
        choosing, reporting = (_with_distance(half, label, estimate, length) for half in (choosing, reporting))
        notes.append(sentence)
        if lost := count - len(choosing) - len(reporting):
            notes.append(f"{lost} recordings are left out, for {label} has no estimate in front of the camera there")
        if first.distances:
            notes.append(f"To compare with what was measured, name references, such as {', '.join(first.distances)}")
        references = (label,)
    judged = MOST_JUDGED if blind else 0
    table = choose_and_report(choosing, reporting, form, follow, tried, batch, lasting, references, length, judged)
    if blind:
        table.loc[table["observer"] == references[0], ["median", "nine_in_ten"]] = np.nan
    return AllObservers(table, choosing, reporting, left_out, start, tuple(notes))


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
