"""Efficiency and settling time of every observer on several scenes, with gains chosen alike."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from percept_obs.compile import Array
from percept_obs.observability import cramer_rao
from percept_obs.observers import OBSERVERS, Observer
from percept_obs.observers.family import Family
from percept_obs.recording import Recording
from percept_obs.studies.comparison import best_setting
from percept_obs.studies.tuning import Gains, own_length
from percept_obs.system.forms import PartitionedSystem
from percept_obs.tracking.following import DoesNotFit, StepTooLong, track
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import TOLERANCE
from percept_obs.validation import bar, checked, load_pandas

__all__ = ["Case", "efficiencies"]

if TYPE_CHECKING:
    import pandas as pd


UNKNOWN = MappingProxyType({"settled": 0, "settling_time": math.inf, "ratio": math.inf, "scatter": math.nan})
"""Numbers of an observer that cannot run."""


@checked
@dataclass(frozen=True, eq=False)
class Case:
    """Recordings of a scene, to choose gains on and to report on.

    Parameters
    ----------
    form : PartitionedSystem
        Which outputs are measured.
    choosing, reporting : sequences of Recording
        With a truth; none in both.
    start : mapping of coordinate names to values
        Estimates at the first sample, for every observer.
    noise_variance : float, optional
        For the bound; the recordings' own when left out.

    See Also
    --------
    efficiencies : Runs every observer on it.

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, pinhole, record, scenarios
    >>> seen = [record(scenarios.ma2005_eq35(), 3, Camera(0.05, Gaussian(0.01)), seed) for seed in range(4)]
    >>> Case(PerspectiveSystem(affine(), pinhole()).measure("y1"), seen[:2], seen[2:]).form.measured
    ('y1',)
    """

    form: PartitionedSystem
    choosing: Sequence[Recording]
    reporting: Sequence[Recording]
    start: Mapping[str, float] = field(default_factory=dict)
    noise_variance: float | None = None


@checked
def efficiencies(
    cases: Mapping[str, Case], candidates: Mapping[Family, Sequence[Gains]] | None = None, **settings: Any
) -> pd.DataFrame:
    """Tune every observer on each case, and put its errors beside the Cramer-Rao bound.

    Parameters
    ----------
    cases : mapping of labels to Case
    candidates : mapping of families to their gains, optional
        The candidates in every observer's own file when left out.  Chosen are those with the least sum of median
        errors of the distance after a quarter, a half and the whole of the shortest recording.
    **settings
        Passed to `track`.

    Returns
    -------
    pandas.DataFrame
        One row for a case and an observer: case, observer, gains (those chosen, by the case's own length), runs,
        settled (number of runs whose distance stays within 10 %), settling_time (median, in s; infinite if half of the
        runs do not settle), ratio (root mean square error of the distance over the bound in the second half of the
        runs that settle, if two do), scatter (its standard deviation over sets of as many runs) and refusal (why it
        cannot run).

    Raises
    ------
    ValueError
        If there is no case, a recording has no truth or no known noise, or does not fit its form.

    See Also
    --------
    percept_obs.efficiency : The ratio at each time.
    percept_obs.figures.efficiencies : Draws the table.

    Notes
    -----
    The bound holds without bias, and for exact motion: errors of a real motion come on top of it.

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, ekf, pinhole, record, scenarios
    >>> seen = [record(scenarios.ma2005_eq35(), 8, Camera(0.05, Gaussian(0.01)), seed) for seed in range(6)]
    >>> case = Case(PerspectiveSystem(affine(), pinhole()).measure("y1"), seen[:2], seen[2:])
    >>> table = efficiencies({"one output": case}, {ekf: [{"noise_variance": 1e-4}]})
    >>> bool(0.5 < table["ratio"][0] < 2)
    True
    """
    pd = load_pandas()
    if not cases:
        raise ValueError("there are no cases; give at least one, by its label")
    tried = dict({make: make.candidates for make in OBSERVERS} if candidates is None else candidates)
    rows: list[dict[str, Any]] = []
    for label, case in cases.items():
        length = own_length(case.form, case.choosing)
        choosing, reporting = (
            [replace(each, unit=length) for each in half] for half in (case.choosing, case.reporting)
        )
        last = min(float(each.elapsed[-1]) for each in (*choosing, *reporting))
        least = _bounds(reporting, case)

        def follow(recording: Recording, observer: Observer, start: Mapping[str, float] = case.start) -> Run:
            return track(recording, observer, start, **settings)

        for make, gains in bar(tried.items(), label, unit="observer"):
            row = {"case": label, "observer": make.name, "gains": "", "runs": len(reporting), **UNKNOWN}
            row["refusal"] = make.refusal(case.form)
            try:
                choice = [] if row["refusal"] else [make(case.form, **each) for each in gains]
                with warnings.catch_warnings(action="ignore", category=StepTooLong):  # it shows in the errors
                    if choice:
                        chosen = best_setting(choosing, choice, follow, (last / 4, last / 2, last))
                        named = {gain.name: gain.value for gain in chosen.gains if gain.name in gains[0]}
                        row["gains"] = ", ".join(f"{name} {value:.3g}" for name, value in named.items())
                        row |= _judged([follow(each, chosen) for each in reporting], least)
            except DoesNotFit as error:
                row["refusal"] = str(error)
            rows.append(row)
    return pd.DataFrame(rows)


def _bounds(recordings: Sequence[Recording], case: Case) -> list[Array]:
    """Least relative standard deviation of the distance at the samples of each recording; equal truths share it."""
    found: list[tuple[Recording, Array]] = []
    for each in recordings:
        for other, relative in found:
            if np.array_equal(np.asarray(each.truth), np.asarray(other.truth)) and np.array_equal(
                each.seen, other.seen
            ):
                found.append((each, relative))
                break
        else:
            found.append((each, cramer_rao(each, case.form, noise_variance=case.noise_variance).relative))
    return [relative for _, relative in found]


def _judged(runs: Sequence[Run], least: Sequence[Array]) -> dict[str, float]:
    """Numbers of the table for the runs of one observer."""
    times = np.array([run.settling_time(TOLERANCE) for run in runs])
    squares = []
    for run, bound in zip(runs, least, strict=True):
        late = (run.elapsed >= run.elapsed[-1] / 2) & np.isfinite(run.distance)
        error = (run.distance / run.recording.reference("truth") - 1)[late] / bound[late]
        squares.append(float(np.mean(error**2)) if late.any() else math.inf)
    found = np.array(squares)[np.isfinite(times)]
    count = len(found)
    numbers = {"settled": count, "settling_time": float(np.quantile(times, 0.5, method="nearest"))}  # not all have one
    if count < 2:
        return numbers
    without = np.sqrt((found.sum() - found) / (count - 1))
    scatter = math.sqrt((count - 1) * np.mean((without - without.mean()) ** 2))
    return numbers | {"ratio": math.sqrt(found.mean()), "scatter": scatter}
