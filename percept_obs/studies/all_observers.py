"""Every observer on a set of recordings in one call: gains chosen on one part, errors reported on the other."""

from __future__ import annotations

import html
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from percept_obs.compile import choose
from percept_obs.observers import OBSERVERS, Observer
from percept_obs.observers.family import Family
from percept_obs.recording import Recording
from percept_obs.studies.least_squares import moving_window_least_squares
from percept_obs.studies.tuning import Gains, choose_and_report, side_by_side
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.signal import slack_of
from percept_obs.tracking.following import track
from percept_obs.tracking.run import Run
from percept_obs.validation import checked

if TYPE_CHECKING:
    import pandas as pd

Split = Literal["alternating", "earlier and later"]

LEAST_SQUARES = "least squares on 2 s"
"""Label of the batch estimate in the table; it has no gains."""


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

    @property
    def side_by_side(self) -> pd.DataFrame:
        """The table as text, one row an observer; see `percept_obs.studies.tuning.side_by_side`."""
        return side_by_side(self.table)

    def _sentences(self) -> Iterator[str]:
        yield (
            f"Relative errors of the distance, the median and in brackets the 90 % quantile: gains chosen on "
            f"{len(self.choosing)} recordings, errors on {len(self.reporting)} others. Every observer starts at "
            + ", ".join(f"{name} = {value:.3g}" for name, value in self.start.items())
        )
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
    references: Sequence[str] = ("truth",),
    candidates: Mapping[Family, Sequence[Gains]] | None = None,
    **settings: Any,
) -> AllObservers:
    """Run every observer on a set of recordings of single points, and say what could not be run and why.

    Parameters
    ----------
    recordings : sequence of Recording
        At least two that fit together: with the outputs, the imaging surface and the kind of motion of the first one.
    split : "alternating" or "earlier and later"
        Choose gains on every other recording, from the first one on; or on the half that begins earlier, which is
        stricter where neighbours see the same movement.
    start : mapping of coordinate names to values, optional
        Estimates at the first sample; twice the median distance of the recordings to choose on when left out.
    after : sequence of float
        Seconds since the first sample at which errors are looked at; those that recordings last.
    references : sequence of str
        "truth", or names of measured distances; gains are chosen by the first of them.
    candidates : mapping of families to their gains, optional
        The candidates in every observer's own file when left out.
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
    if not len(recordings):
        raise ValueError("there are no recordings; give at least two, one to choose gains on and one to report on")
    if not len(references) or not len(after):
        raise ValueError(f"{len(references)} references and {len(after)} times after: at least one of each is needed")
    if not all(math.isfinite(seconds) and seconds >= 0 for seconds in after):
        raise ValueError(f"after is {list(after)!r}; the times must be finite and not negative, in seconds")
    if split not in get_args(Split):
        raise ValueError(f"the split {split!r} is none of {' and '.join(map(repr, get_args(Split)))}")
    first = recordings[0]
    system = PerspectiveSystem(first.motion, first.imaging_surface)
    form = system.partition(*first.names)
    reasons = [_why_not(each, form, first, references, min(after)) for each in recordings]
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
    if split == "alternating":
        choosing, reporting = usable[::2], usable[1::2]
    else:
        usable.sort(key=lambda recording: float(recording.time[0]))
        choosing, reporting = usable[: len(usable) // 2], usable[len(usable) // 2 :]
    shorter = min(max(float(each.elapsed[-1]) + slack_of(each.time) for each in half) for half in (choosing, reporting))
    left_out |= {
        f"errors after {seconds:g} s": f"no recording in one of the halves lasts longer than {shorter:.3g} s"
        for seconds in after
        if seconds > shorter
    }
    if start is None:
        distances = np.concatenate([each.reference(references[0]) for each in choosing])
        start = {first.imaging_surface.inverse_distance.name: 1 / (2 * float(np.nanmedian(distances)))}
    tried = {make: make.candidates for make in OBSERVERS} if candidates is None else candidates
    steps = sum(len(each.time) for each in choosing) * max(map(len, tried.values()), default=0)
    settings = {"language": choose(None, steps)} | settings

    def follow(recording: Recording, observer: Observer) -> Run:
        return track(recording, observer, start, **settings)

    whole = first.names == tuple(symbol.name for symbol in first.imaging_surface.image_coordinates)
    batch = {LEAST_SQUARES: moving_window_least_squares} if whole else {}
    lasting = [seconds for seconds in after if seconds <= shorter]
    table = choose_and_report(choosing, reporting, form, follow, tried, batch, lasting, references)
    return AllObservers(table, choosing, reporting, left_out, start)


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
    if unknown := [name for name in references if np.isnan(recording.reference(name)).all()]:
        return f"its {' and '.join(unknown)} is known at no sample"
    if recording.elapsed[-1] < shortest - slack_of(recording.time):
        return f"it lasts {recording.elapsed[-1]:.3g} s, and the first error is asked for after {shortest:g} s"
    return ""
