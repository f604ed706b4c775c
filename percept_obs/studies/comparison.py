"""Observers on the same recordings: one table with a row for each run, what it sums up to, and its words."""

from __future__ import annotations

import html
import math
import re
import time
import warnings
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from percept_obs.compile import Array, choose
from percept_obs.observability import cramer_rao
from percept_obs.observers.base import Observer
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.signal import from_the_start, slack_of
from percept_obs.system.view import refuse_several
from percept_obs.tracking.following import AnyObserver, StepTooLong, track
from percept_obs.tracking.run import Run
from percept_obs.tracking.verdict import TOLERANCE
from percept_obs.validation import bar, checked, load_pandas, numbers, once

__all__ = ["Comparison", "compare", "over_bound", "relative_distance_errors"]

if TYPE_CHECKING:
    import pandas as pd

Follow = Callable[[Recording, Observer], Run]
"""Function that runs an observer on a recording, such as ``lambda r, o: track(r, o, start)``."""

Estimate = Callable[[Recording], Run]

Columns = Mapping[str, Callable[[Run], float]]
"""Further numbers of a run, by the names of their columns, such as ``{"nis": lambda run: np.nanmean(run.nis)}``."""

ABOUT = ("observer", "gains", "at_edge", "recording", "resets", "diverged_at", "refusal", "warning")
"""Columns that are no measures."""

AT_A_TIME = re.compile(r"(.+) (\S+) s")
"""Names of columns that have relative errors, or claims of them, some seconds after the first sample."""

ENDS = {"": 0.5, "_low": 0.16, "_high": 0.84}
"""Quantiles of a measure, by what stands behind its name."""

MOST = 0.9
"""Quantile of errors at a time that stands next to their median."""


@checked
@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """Runs of observers on recordings; a notebook shows one line an observer.

    Parameters
    ----------
    table : pandas.DataFrame
        One row for a run: observer, recording, resets, diverged_at (s since the first sample, infinite if it does not),
        cost (seconds of computing for a second of data), warning (that the steps were too long, if they were), and
        what was asked for: of `compare`, of `percept_obs.studies.all_observers.all_observers`, or further columns.  An
        observer that cannot follow has one row with the reason as refusal, which is empty for the others.
    choosing, reporting : sequences of Recording
        Those on which gains were chosen, if they were, and those of the runs.
    left_out : mapping of names to reasons
        Recordings and times that could not be used.
    start : mapping of coordinate names to values
        Estimates at the first sample, for every observer.
    notes : tuple of str
        Sentences on what was sampled, and on what stands for a truth where there is none.

    Raises
    ------
    ValueError
        If the table lacks one of its columns.

    See Also
    --------
    compare, percept_obs.studies.all_observers.all_observers : Make it.
    percept_obs.figures.comparison : Draws it.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> found = compare([record(make(), 5) for make in (scenarios.ma2005_eq35, scenarios.planar)], [ibo(form)])
    >>> found.summary[["runs", "failed", "diverged"]].values.tolist()
    [[2, 0, 0]]
    """

    table: pd.DataFrame
    choosing: Sequence[Recording] = ()
    reporting: Sequence[Recording] = ()
    left_out: Mapping[str, str] = field(default_factory=dict)
    start: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if missing := {*ABOUT, "cost"} - {"gains", "at_edge"} - {*self.table}:
            raise ValueError(f"the table has no column {', '.join(sorted(missing))}, as those of compare() have")

    @property
    def summary(self) -> pd.DataFrame:
        """One row an observer, over its runs.

        runs, reset and diverged are numbers of runs; failed those that have not settled, and behind those without an
        estimate in front of the camera at the time with the most.  Errors at a time have the median, and the 90 %
        quantile as NAME_most; other measures the median with the 16 % and 84 % quantiles as NAME_low and NAME_high.
        trusted is a share; over_bound the root mean square over the runs that settle, if two do, and over_bound_scatter
        its standard deviation over sets of as many runs.
        """
        found = {label: _summed(rows) for label, rows in self.table.groupby("observer", sort=False)}
        return load_pandas().DataFrame.from_dict(found, orient="index")

    @property
    def side_by_side(self) -> pd.DataFrame:
        """The summary as text, with a remark.

        usable after is the first time from which on the 90 % quantile of the first reference is within 10 %.  The
        remark has the gains, those at an edge of their candidates, steps that are too long, or why the observer cannot
        follow.
        """
        groups = self.table.groupby("observer", sort=False)
        rows = zip(self.summary.iterrows(), groups, strict=True)
        lines = {label: _line(row, of_one.iloc[0], of_one["warning"]) for (label, row), (_, of_one) in rows}
        return load_pandas().DataFrame.from_dict(lines, orient="index")

    def _sentences(self) -> Iterator[str]:
        if self.choosing:
            begin = ", ".join(f"{name} = {value:.3g}" for name, value in self.start.items())
            what = "differences" if "trusted" in self.table else "errors"
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


def _summed(rows: pd.DataFrame) -> dict[str, float]:
    """Row of the summary for one observer."""
    followed = rows[rows["refusal"] == ""]
    measures = {name: followed[name].dropna().to_numpy(dtype=float) for name in rows if name not in {*ABOUT, "outcome"}}
    found: dict[str, float] = {"runs": len(followed)}
    if "settling_time" in measures:
        found["failed"] = int(np.isinf(measures["settling_time"]).sum())
    if errors := [values for name, values in measures.items() if _is_error(name)]:
        found["behind"] = max(int(np.isinf(values).sum()) for values in errors)
    found["reset"] = int((followed["resets"] > 0).sum())
    found["diverged"] = int(np.isfinite(followed["diverged_at"].astype(float)).sum())
    for name, values in measures.items():
        if name == "trusted":
            found[name] = float(values.mean()) if len(values) else math.nan
        elif name == "over_bound":
            found |= dict(zip((name, f"{name}_scatter"), _root_mean_square(values), strict=True))
        elif AT_A_TIME.fullmatch(name):
            found[name] = float(np.median(values)) if len(values) else math.nan
            found[f"{name}_most"] = _by_rank(values, MOST)
        else:
            found |= {name + end: _by_rank(values, share) for end, share in ENDS.items()}
    return found


def _by_rank(values: Array, share: float) -> float:
    """Quantile by rank, for infinite values have no mean."""
    return float(np.quantile(values, share, method="nearest")) if len(values) else math.nan


def _root_mean_square(values: Array) -> tuple[float, float]:
    """Root mean square of the finite values, two or more, and its scatter by leaving out one after the other."""
    squares = values[np.isfinite(values)] ** 2
    count = len(squares)
    if count < 2:
        return (math.inf if len(values) else math.nan), math.nan
    without = np.sqrt((squares.sum() - squares) / (count - 1))
    return math.sqrt(squares.mean()), math.sqrt((count - 1) * np.mean((without - without.mean()) ** 2))


def _is_error(name: str) -> bool:
    """True for the name of errors at a time."""
    return bool(AT_A_TIME.fullmatch(name)) and not name.startswith("claimed ")


def _line(row: pd.Series, first: pd.Series, warned: pd.Series) -> dict[str, str]:
    """Row of `Comparison.side_by_side` for one observer, from its row of the summary and its first run."""
    measures = [name for name in first.index if name not in {*ABOUT, "outcome", "trusted", "cost"}]
    errors, claims = [n for n in measures if _is_error(n)], [n for n in measures if n.startswith("claimed ")]
    said = {
        name: "–" if np.isnan(row[name]) else f"{row[name]:.1%} ({row[f'{name}_most']:.0%})".replace("inf%", "none")
        for name in errors
    }
    if errors and not claims:
        said["usable after"] = _usable(row, errors)
    said |= {name: f"{row[name]:.0f}" for name in ("failed", "behind", "reset", "diverged") if name in row}
    for name in measures:
        if name in claims:
            said[name] = "–" if np.isnan(row[name]) else f"{row[name]:.1%}"
        elif name == "over_bound":
            said[name] = f"{row[name]:.3g} +- {row[f'{name}_scatter']:.2g}"
        elif name not in errors:
            said[name] = f"{row[name]:.2g} ({row[f'{name}_low']:.2g} to {row[f'{name}_high']:.2g})"
    if "trusted" in row:
        said["trusted at the end"] = "–" if np.isnan(row["trusted"]) else f"{row['trusted']:.1%}"
    said["cost"] = f"{1e6 * row['cost']:.0f} us/s"
    if first["refusal"]:
        return dict.fromkeys(said, "–") | {"remark": f"cannot: {first['refusal']}"}
    edge = first.get("at_edge", "") and f"; at the edge of what was tried: {first['at_edge']}"
    return said | {"remark": "; ".join(filter(None, [first.get("gains", "") + edge, *warned[warned != ""][:1]]))}


def _usable(row: pd.Series, errors: Sequence[str]) -> str:
    """Time from which on the errors of the first reference are small; what grows again does not count before."""
    reference = errors[0].rsplit(" ", 2)[0]
    mine = sorted((float(name.split()[-2]), row[f"{name}_most"]) for name in errors if name.startswith(f"{reference} "))
    late = [k for k, (_, error) in enumerate(mine) if not error <= TOLERANCE]
    begin = late[-1] + 1 if late else 0
    return f"{mine[begin][0]:g} s" if begin < len(mine) else f"not within {mine[-1][0]:g} s"


@checked
def compare(
    recordings: Sequence[Recording],
    observers: Mapping[str, AnyObserver] | Sequence[AnyObserver],
    start: Mapping[str, float] | Sequence[float] | None = None,
    tolerance: float = TOLERANCE,
    after: float = 0.0,
    coordinates: Sequence[str] = (),
    columns: Columns | None = None,
    **settings: Any,
) -> Comparison:
    """Run every observer on every recording, so that all see the same noise.

    Parameters
    ----------
    recordings : sequence of Recording
        With a truth.
    observers : mapping of labels to Observer, or sequence of Observer
        A sequence is labelled with the observers' names.
    start : see `track`
    tolerance : float
        Bound on the relative error of the distance, or on the absolute errors of the `coordinates`; see `Run.outcome`.
    after : float
        Seconds since the first sample from which on errors count for their root mean square and their largest value.
    coordinates : sequence of str, optional
        Such as ("y3",), whose absolute errors are to stay within the tolerance instead.
    columns : mapping of names to functions of a run, optional
        Further numbers, such as ``{"over_bound": over_bound(form)}``.
    **settings
        Passed to `track`, such as ``hold`` and ``believed``.

    Returns
    -------
    Comparison
        Its table has, with errors of the inverse distance in 1/m, outcome (a kind of `Outcome`), settling_time (s,
        infinite if it has not converged), final, rms and worst (from `after` on).

    Raises
    ------
    ValueError
        If recordings or observers are none, recur or do not fit, one has no truth or several points, or a column is
        taken or gives no number.

    See Also
    --------
    percept_obs.studies.all_observers.all_observers : every observer, with gains that are chosen
    percept_obs.ensemble : many runs of one observer

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ekf, ibo, pinhole, record, scenarios
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> compare([record(scenarios.ma2005_eq35(), 5)], [ibo(form), ekf(form)]).summary["failed"].tolist()
    [0, 0]
    """
    if not isinstance(observers, Mapping):
        names = [observer.name for observer in observers]
        if len(set(names)) != len(names):
            raise ValueError(f"observers have the same name ({', '.join(names)}); pass a mapping of labels to them")
        observers = dict(zip(names, observers, strict=True))
    if not len(recordings) or not observers:
        raise ValueError(f"{len(recordings)} recordings and {len(observers)} observers: at least one of each is needed")
    once(recordings=recordings)
    for recording in recordings:
        refuse_several("a comparison", recording.view)
    if clash := {*(columns or {})} & {*ABOUT, "outcome", "settling_time", "final", "rms", "worst", "cost"}:
        raise ValueError(f"columns has {', '.join(sorted(clash))}, which the table has already; take another name")
    settings = {"language": choose(None, sum(len(recording.time) for recording in recordings))} | settings
    follow = {label: partial(track, observer=each, start=start, **settings) for label, each in observers.items()}
    brief = recordings[0].between(*recordings[0].time[:2].tolist())
    for run in bar(follow.values(), "compiling"):
        run(brief)  # so that the cost is without compiling

    def measures(run: Run) -> dict[str, Any]:
        outcome = run.outcome(tolerance, *coordinates)
        error = np.abs(run.recording.imaging_surface.inverse(run.error))
        late = error[from_the_start(run.elapsed, after)]
        if not len(late):
            raise ValueError(f"no sample of {run.recording.source!r} lies {after} s or more after its first one")
        errors = {"final": error[-1], "rms": math.sqrt(np.mean(late**2)), "worst": late.max()}
        return {
            "outcome": outcome.kind,
            "settling_time": outcome.settled if outcome.converged else math.inf,
            # a run that diverged has no error
            **{name: math.inf if math.isnan(value) else float(value) for name, value in errors.items()},
            **{name: number_of(name, of, run) for name, of in (columns or {}).items()},
        }

    rows = [row for label, run in follow.items() for row in rows_of(label, run, recordings, measures)]
    return Comparison(load_pandas().DataFrame(rows), reporting=recordings)


def number_of(name: str, of: Callable[[Run], float], run: Run) -> float:
    """Return what a column has of a run; raise ValueError if it is no number."""
    found = of(run)
    if (size := (values := numbers(found, f"column {name!r} of a run")).size) != 1:
        raise ValueError(f"column {name!r} of a run is {size} numbers; let its function return one, such as their mean")
    return found if isinstance(found, int | float | np.number) else values.item()


def rows_of(
    label: str,
    estimate: Estimate,
    recordings: Sequence[Recording],
    measures: Callable[[Run], Mapping[str, Any]],
    about: Mapping[str, str] | None = None,
) -> list[dict[str, Any]]:
    """Return the rows of `Comparison.table` for one observer; no run is kept."""
    rows = []
    for recording in bar(recordings, f"runs of {label}"):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", StepTooLong)
            begin = time.perf_counter()
            run = estimate(recording)
            cost = (time.perf_counter() - begin) / float(recording.elapsed[-1])
        row: dict[str, Any] = {"observer": label, **(about or {}), "recording": recording.source, **measures(run)}
        diverged = math.inf if run.diverged_at is None else run.diverged_at - float(run.time[0])
        row |= {"resets": len(run.resets), "diverged_at": diverged, "cost": cost, "refusal": ""}
        rows.append(row | {"warning": "".join([str(w.message) for w in caught if w.category is StepTooLong][:1])})
    return rows


@checked
def relative_distance_errors(
    runs: Iterable[Run],
    after: float,
    reference: str = "truth",
    absence: float = math.inf,
    points: Collection[int] | None = None,
) -> Array:
    """Return relative errors of the estimated distance, a given time after each point came into sight.

    There is one for each sighting that lasts as long, |estimate - reference| / reference: infinite where the estimate
    is not in front of the camera, NaN where there is none.

    Parameters
    ----------
    runs : iterable of Run
        Of one point or of several, on recordings with a truth or with measured distances.
    after : float
        Seconds since the first sample of a sighting; the first sample from then on whose reference is known counts.
    reference : str
        "truth", or the name of a measured distance of the recordings, such as "stereo".
    absence : float
        Seconds without a sample after which a new sighting begins.
    points : collection of int, optional
        Indices of the points to use; all of them when left out.

    Raises
    ------
    ValueError
        If the time is negative, no sighting lasts as long, or a recording has no such reference or point.

    See Also
    --------
    compare : errors of the inverse distance of several observers, over time

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios, track
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> run = track(record(scenarios.ma2005_eq35(), 5), ibo(form))
    >>> bool(relative_distance_errors([run], after=4)[0] < 0.05)
    True
    """
    if not after >= 0:
        raise ValueError(f"after is {after} s; it must not be negative")
    each = [(run.recording.source, errors_of(run, after, reference, absence, points)) for run in runs]
    errors = [error for _, found in each for error in found]
    if not errors:
        sources = " or ".join(repr(source) for source, _ in each) or "of no run at all"
        raise ValueError(f"no sighting in the recording {sources} lasts {after} s; give a run, or a shorter after")
    return np.array(errors)


def errors_of(
    run: Run, after: float, reference: str, absence: float = math.inf, points: Collection[int] | None = None
) -> list[float]:
    """Return the `relative_distance_errors` of one run, none if no sighting lasts as long."""
    recording, errors = run.recording, []
    shape = (len(recording.time), -1)
    known = range(recording.seen[0].size)
    used = known if points is None else points
    if not set(used) <= set(known):
        raise ValueError(f"there are no points {sorted(set(used) - set(known))}; there are 0 to {max(known)}")
    distance, estimate = (each.reshape(shape) for each in (recording.reference(reference), run.distance))
    seen = recording.seen.reshape(shape) & np.isfinite(distance)
    for sighting in recording.sightings(absence):
        samples = np.flatnonzero(seen[: sighting.last + 1, sighting.point])
        late = samples[run.time[samples] - run.time[sighting.first] >= after - slack_of(run.time)]
        if len(late) and sighting.point in used:
            place = (late[0], sighting.point)
            errors.append(float(abs(estimate[place] / distance[place] - 1)))
    return errors


def error_at(run: Run, after: float, reference: str) -> float:
    """Return the relative error of the distance of a run: infinite if there is no estimate, NaN if it ends earlier."""
    found = errors_of(run, after, reference)
    return float(np.nan_to_num(found[0], nan=np.inf, posinf=np.inf)) if found else math.nan


@checked
def over_bound(form: PartitionedSystem) -> Callable[[Run], float]:
    """Return a column for `compare`: the distance's rms error over its Cramer-Rao bound, in a run's second half.

    It is infinite for a run whose distance does not stay within 10 % at the end.

    Parameters
    ----------
    form : PartitionedSystem
        Which outputs are measured.

    Returns
    -------
    function of a Run
        That raises ValueError if its recording has no truth or no known noise, or does not fit the form.

    See Also
    --------
    percept_obs.efficiency : The ratio at each time.
    percept_obs.figures.efficiencies : Draws it over the settling time.

    Notes
    -----
    The bound holds without bias, and for exact motion: errors of a real motion come on top of it.  Recordings of one
    scene share it.

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, affine, ekf, pinhole, record, scenarios
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1")
    >>> seen = [record(scenarios.ma2005_eq35(), 8, Camera(0.05, Gaussian(0.01)), seed) for seed in range(4)]
    >>> found = compare(seen, [ekf(form, noise_variance=1e-4)], columns={"over_bound": over_bound(form)})
    >>> bool(0.5 < found.summary.loc["extended Kalman", "over_bound"] < 2)
    True
    """
    known: list[tuple[Recording, Array]] = []

    def alike(one: Recording, other: Recording) -> bool:
        return one is other or (
            one.noise_variance == other.noise_variance
            and np.array_equal(np.asarray(one.truth), np.asarray(other.truth))
            and np.array_equal(one.seen, other.seen)
        )

    def of(run: Run) -> float:
        bound = next((found for other, found in known if alike(other, run.recording)), None)
        if bound is None:
            bound = cramer_rao(run.recording, form).relative
            known.append((run.recording, bound))
        late = (run.elapsed >= run.elapsed[-1] / 2) & np.isfinite(run.distance)
        if not late.any() or not math.isfinite(run.settling_time()):
            return math.inf
        error = (run.distance / run.recording.reference("truth") - 1)[late] / bound[late]
        return math.sqrt(float(np.mean(error**2)))

    return of
