"""Every observer on a set of recordings in one call: gains chosen on one part, errors reported on the other."""

from __future__ import annotations

import html
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

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
"""What stands beside the observers: a batch estimate that has no gains."""


@dataclass(frozen=True, eq=False, repr=False)
class AllObservers:
    """What every observer does on a set of recordings; in a notebook it shows itself as a table.

    Parameters
    ----------
    table : pandas.DataFrame
        One row for an observer, a reference and a time, as of `choose_and_report`.
    choosing, reporting : tuples of Recording
        On which gains were chosen, and on which errors are reported.
    left_out : mapping of what to why
        Recordings and times that could not be used; observers that could not be run say why in the table.
    start : mapping of names to values
        Where every observer started.
    """

    table: pd.DataFrame
    choosing: tuple[Recording, ...]
    reporting: tuple[Recording, ...]
    left_out: Mapping[str, str]
    start: Mapping[str, float]

    @property
    def side_by_side(self) -> pd.DataFrame:
        """An observer a row, as text."""
        return side_by_side(self.table)

    def _sentences(self) -> Iterator[str]:
        yield (
            f"Relative errors of the distance, the median and in brackets what nine in ten stay below: gains chosen on "
            f"{len(self.choosing)} recordings, errors on {len(self.reporting)} others. Every observer starts at "
            + ", ".join(f"{name} = {value:.3g}" for name, value in self.start.items())
        )
        yield from (f"Left out: {what}, for {why}" for what, why in self.left_out.items())

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
    """Run every observer on any set of recordings of single points, and say what could not be run and why.

    Parameters
    ----------
    recordings : sequence of Recording
        At least two that fit together: with the outputs, the imaging surface and the kind of motion of the first one.
    split : "alternating" or "earlier and later"
        Gains are chosen on every other recording, from the first one on; or on the half that begins earlier, which is
        stricter where neighbours see the same movement.
    start : mapping of coordinate names to values, optional
        Estimates at the first sample; twice the median distance of the recordings to choose on when left out.
    after : sequence of float
        Seconds since the first sample at which errors are looked at; those that recordings last.
    references : sequence of str
        "truth", or names of measured distances; gains are chosen by the first of them.
    candidates : mapping of families to their gains, optional
        Those of every observer's own file when left out.
    **settings
        Passed to `track`, such as ``hold`` and ``step``.

    Returns
    -------
    AllObservers

    Raises
    ------
    ValueError
        If fewer than two recordings are left, or none of the times.

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
    first = recordings[0]
    system = PerspectiveSystem(first.motion, first.imaging_surface)
    form = system.partition(*first.names)
    whys = [_why_not(each, form, first, references, min(after)) for each in recordings]
    judged = list(zip(range(1, len(recordings) + 1), recordings, whys, strict=True))
    left_out = {f"recording {number} ({each.source})": why for number, each, why in judged if why}
    fit = [each for _, each, why in judged if not why]
    if len(fit) < 2:
        told = "; ".join(f"{what}: {why}" for what, why in left_out.items())
        raise ValueError(
            f"{len(fit)} of {len(recordings)} recordings can be used, and two are needed, one to choose gains on and "
            f"one to report on; cut one in two with between(){'; left out: ' + told if told else ''}"
        )
    choosing, reporting = _parts(fit, split)
    shorter = min(max(float(each.elapsed[-1]) + slack_of(each.time) for each in part) for part in (choosing, reporting))
    lasting = [seconds for seconds in after if seconds <= shorter]
    left_out |= {
        f"errors after {seconds:g} s": f"no recording in one of the parts lasts longer than {shorter:.3g} s"
        for seconds in after
        if seconds > shorter
    }
    inverse = first.imaging_surface.inverse_distance.name
    if start is None:
        distances = np.concatenate([each.reference(references[0]) for each in choosing])
        start = {inverse: 1 / (2 * float(np.nanmedian(distances)))}

    tried = {make: make.candidates for make in OBSERVERS} if candidates is None else candidates
    steps = sum(len(each.time) for each in choosing) * max(map(len, tried.values()), default=0)
    settings = {"language": choose(None, steps)} | settings

    def follow(recording: Recording, observer: Observer) -> Run:
        return track(recording, observer, start, **settings)

    whole = first.names == tuple(symbol.name for symbol in first.imaging_surface.image_coordinates)
    batch = {LEAST_SQUARES: moving_window_least_squares} if whole else {}
    table = choose_and_report(choosing, reporting, form, follow, tried, batch, after=lasting, references=references)
    parts = tuple(choosing), tuple(reporting)
    return AllObservers(table, *parts, MappingProxyType(left_out), MappingProxyType(dict(start)))


def _why_not(
    recording: Recording, form: PartitionedSystem, first: Recording, references: Sequence[str], shortest: float
) -> str:
    """Why a recording cannot stand in the same table as the first one; empty if it can."""
    if recording.outputs.ndim != 2 or recording.names != first.names:
        return f"its outputs are {', '.join(recording.names)}, those of the first {', '.join(first.names)}"
    if form.view is None or not form.view.fits(recording.view):
        return f"it was seen on the {recording.view.name}, the first one on the {first.view.name}"
    if recording.motion.parameters != first.motion.parameters or recording.motion.A != first.motion.A:
        return f"its motion is {recording.motion.name} with other coefficients than that of the first"
    if not np.isfinite(recording.outputs[0]).all():
        return "its first sample was lost, and observers start from it: cut it with between()"
    lacking = [
        r for r in references if not (r in recording.distances or (r == "truth" and recording.truth is not None))
    ]
    if lacking:
        return f"it has no {' and no '.join(lacking)} to compare with; name other references"
    unknown = [name for name in references if np.isnan(recording.reference(name)).all()]
    if unknown:
        return f"its {' and '.join(unknown)} is known at no sample"
    if recording.elapsed[-1] < shortest - slack_of(recording.time):
        return f"it lasts {recording.elapsed[-1]:.3g} s, and the first error is asked for after {shortest:g} s"
    return ""


def _parts(recordings: Sequence[Recording], split: Split) -> tuple[list[Recording], list[Recording]]:
    """Recordings to choose on and to report on."""
    if split == "alternating":
        return list(recordings[::2]), list(recordings[1::2])
    if split == "earlier and later":
        ordered = sorted(recordings, key=lambda recording: float(recording.time[0]))
        return ordered[: len(ordered) // 2], ordered[len(ordered) // 2 :]
    raise ValueError(f"the split {split!r} is none of 'alternating' and 'earlier and later'")
