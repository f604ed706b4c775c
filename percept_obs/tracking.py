"""Tracking: an observer follows a recording."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from percept_obs.compile import Table, solve, vectorised
from percept_obs.equations import Symbols
from percept_obs.motion import Motion
from percept_obs.observers.base import Observer
from percept_obs.recording import Recording, halves, step_grid
from percept_obs.recovery import elapsed, first_innovation

Array = NDArray[np.float64]
Hold = Literal["zero", "first", "exact"]

LONGEST_STEP = 0.01
"""Longest step, in seconds, with which an observer is integrated unless asked otherwise."""


SETTLED_PART = 0.1
"""Part of a run, at its end, over which an estimate must have stayed within the tolerance to be called converged."""

VERDICTS = MappingProxyType(
    {
        "diverged": "diverged at {time} s: the estimate grew beyond all bounds; choose smaller gains or shorter steps",
        "followed": "followed {time} s; no truth to compare with",
        "outside": "not converged: the error of {hidden} ends at {error}, outside {tolerance}",
        "late": (
            "not converged yet: the error of {hidden} is within {tolerance} only since {time} s, too short before the "
            "end to be sure of"
        ),
        "converged": "converged: the error of {hidden} stays within {tolerance} after {time} s",
        "reset once": "; driven to the bound and reset once, at {time} s",
        "reset often": "; driven to the bound and reset {count} times, first at {time} s",
        "gap": "; no estimate from {begin} to {end} s, for {reason}",
        "more gaps": ", and in {count} more gaps",
    }
)
"""What a verdict says, by what happened; live labs use the same words."""


class DoesNotFit(ValueError):
    """An observer cannot follow this recording."""


LARGEST_STEP_RATE = 2.0
"""Largest product of a step and a decay rate: explicit Euler's limit of stability; Runge-Kutta's is 2.78."""


TOO_LONG = (
    "from {time} s on, the {name} observer's fastest part decays with {rate}/s, too fast for a step of {step} s: their "
    "product must stay below {limit}; {remedy}, or take steps below {shorter} s"
)
"""What is said of an observer whose steps are too long; live labs use the same words."""


class StepTooLong(UserWarning):
    """The steps become too long for the fastest part of an observer, which will then chatter."""


@dataclass(frozen=True, eq=False)
class Run:
    """An observer's estimates at the samples of a recording.

    Parameters
    ----------
    recording : Recording
    observer : Observer
    estimate : array of shape (K, n)
        Estimates of the surface's coordinates; NaN from `diverged_at` on.
    state : array of shape (K, s)
        The observer's state.
    resets : array
        Times, in seconds, at which the estimate was reset.
    diverged_at : float or None
        When the state stopped being finite, in seconds.
    hold : "zero", "first" or "exact"
        How samples were held between them.
    lacking : array of shape (K,) of int
        Which of `Observer.gaps` leaves the hidden coordinates without an estimate, counted from 1; 0 where none does.
    """

    recording: Recording
    observer: Observer
    estimate: Array
    state: Array
    resets: Array
    diverged_at: float | None
    hold: Hold
    lacking: NDArray[np.int_]

    @property
    def time(self) -> Array:
        """Times of the samples in seconds, shape (K,)."""
        return self.recording.time

    @property
    def truth(self) -> Array:
        """True coordinates, shape (K, n).

        Raises
        ------
        ValueError
            If the recording has none.
        """
        if self.recording.truth is None:
            raise ValueError("the recording has no truth to compare with; give it one, or look at the innovation")
        return self.recording.truth

    @cached_property
    def error(self) -> Array:
        """Truth minus estimate, shape (K, n)."""
        return self.truth - self.estimate

    @cached_property
    def innovation(self) -> Array:
        """Samples minus estimates of the measured outputs, shape (K, n1); NaN where a sample was lost."""
        names = [symbol.name for symbol in self.observer.form.coordinates]
        measured = self.observer.form.measured
        columns = [self.recording.names.index(name) for name in measured]
        return self.recording.outputs[:, columns] - self.estimate[:, [names.index(name) for name in measured]]

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the estimate that the observer claims, shape (K, n, n).

        Raises
        ------
        ValueError
            If the observer claims none.
        """
        observer = self.observer
        if observer.covariance is None:
            raise ValueError(f"the {observer.name} observer claims no covariance; the extended Kalman filter does")
        entries = vectorised(observer.equations.state, list(observer.covariance))(*self.state.T)
        return np.stack(entries, axis=-1).reshape(len(self.state), *observer.covariance.shape)

    @cached_property
    def normalised_innovation(self) -> Array:
        """Squared innovation before the update, over the variance that was claimed for it, shape (K,).

        Its mean is the number of measured outputs if the claims are right; NaN where a sample was lost.
        With the residual r after the update, its covariance R - P and r = R S^-1 (innovation), the squared innovation
        is r^T (R - P)^-1 r.

        Raises
        ------
        ValueError
            If the observer claims no covariance or has no measurement update.
        """
        measured = self._columns(self.observer.form.measured)
        claimed = self.covariance[:, measured][:, :, measured]
        variance = dict((gain.name, gain.value) for gain in self.observer.gains).get("noise_variance")
        if variance is None or not self.observer.equations.update:
            raise ValueError(f"the {self.observer.name} observer has no measurement update")
        residual = self.innovation[:, :, None]
        left = variance * np.eye(len(measured)) - claimed
        return (np.swapaxes(residual, 1, 2) @ np.linalg.solve(left, residual))[:, 0, 0]

    @cached_property
    def points(self) -> Array:
        """Estimated positions in metres, shape (K, 3); see `distance` for those that are not finite."""
        known = np.isfinite(self.estimate).all(axis=1, keepdims=True)
        return np.where(known, self.recording.surface.locate(self.estimate), np.nan)

    @cached_property
    def distance(self) -> Array:
        """Estimated depth or range in metres, shape (K,).

        Infinite where the estimated inverse distance is not positive, so that the point would not be in front of the
        camera; NaN where there is no finite estimate, as from `diverged_at` on.
        """
        inverse = self.recording.surface.inverse(self.estimate)
        none = np.where(np.isfinite(inverse), np.inf, np.nan)
        return np.divide(1, inverse, out=none, where=np.isfinite(inverse) & (inverse > 0))

    @cached_property
    def gaps(self) -> list[tuple[float, float]]:
        """Times in seconds of every gap's first and last sample, where the hidden coordinates have no estimate.

        Their estimates are NaN there, although the observer runs on; `reasons` says why.
        """
        return [(float(self.time[k]), float(self.time[end - 1])) for k, end in self._stretches]

    @property
    def reasons(self) -> list[str]:
        """Why each of the `gaps` is there."""
        return [self.observer.gaps[self.lacking[k] - 1].reason for k, _ in self._stretches]

    @cached_property
    def _stretches(self) -> list[tuple[int, int]]:
        """First sample of every gap, and the first one after it."""
        edges = np.flatnonzero(np.diff(self.lacking, prepend=0, append=0))
        return [(int(k), int(end)) for k, end in pairwise(edges) if self.lacking[k]]

    def settling_time(self, tolerance: float = 0.05, *names: str) -> float:
        """When the error entered the tolerance for good.

        Parameters
        ----------
        tolerance : float
            Bound on the error's absolute value; positive.
        *names : str
            Coordinates that count; the hidden ones when left out.

        Returns
        -------
        float
            Seconds since the first sample; infinite if the error is outside at the end.
        """
        if not tolerance > 0:
            raise ValueError(f"the tolerance is {tolerance}; it must be positive")
        outside: NDArray[np.bool_] = ~np.all(np.abs(self.error[:, self._columns(names)]) < tolerance, axis=1)
        if outside[-1]:
            return math.inf
        last = np.flatnonzero(outside)
        return float(self.time[last[-1] + 1] - self.time[0]) if len(last) else 0.0

    def rms(self, begin: float = -math.inf, end: float = math.inf, *names: str) -> float:
        """Root mean square of the error between two times, over the hidden coordinates or those named."""
        part = (self.time >= begin) & (self.time <= end)
        if not part.any():
            raise ValueError(f"no sample lies between {begin} and {end} s")
        return float(np.sqrt(np.mean(self.error[part][:, self._columns(names)] ** 2)))

    def verdict(self, tolerance: float = 0.05) -> str:
        """What happened, in words.

        An estimate has converged if its error stayed within the tolerance for at least the last tenth of the run.
        """
        if self.diverged_at is not None:
            return VERDICTS["diverged"].format(time=f"{self.diverged_at:.3g}")
        besides = ""
        if len(self.resets):
            which = "reset once" if len(self.resets) == 1 else "reset often"
            besides = VERDICTS[which].format(count=len(self.resets), time=f"{self.resets[0]:.3g}")
        for reason in dict.fromkeys(self.reasons):
            gaps = [gap for gap, why in zip(self.gaps, self.reasons, strict=True) if why == reason]
            begin, end = (f"{time:.3g}" for time in gaps[0])
            besides += VERDICTS["gap"].format(begin=begin, end=end, reason=reason)
            if len(gaps) > 1:
                besides += VERDICTS["more gaps"].format(count=len(gaps) - 1)
        length = float(self.time[-1] - self.time[0])
        if self.recording.truth is None:
            return VERDICTS["followed"].format(time=f"{length:.3g}") + besides
        settled = self.settling_time(tolerance)
        if math.isinf(settled):
            which = "outside"
        else:
            which = "converged" if length - settled >= SETTLED_PART * length else "late"
        words = VERDICTS[which].format(
            hidden=", ".join(self.observer.form.hidden),
            error=f"{float(np.abs(self.error[-1, self._columns(())]).max()):.2g}",
            tolerance=f"{tolerance:g}",
            time=f"{settled:.3g}",
        )
        return words + besides

    def _columns(self, names: Sequence[str]) -> list[int]:
        known = [symbol.name for symbol in self.observer.form.coordinates]
        unknown = [name for name in names if name not in known]
        if unknown:
            raise ValueError(f"there is no coordinate {', '.join(unknown)}; there are {', '.join(known)}")
        return [known.index(name) for name in names or self.observer.form.hidden]

    def __repr__(self) -> str:
        return f"<Run of the {self.observer.name} observer on {self.recording.source}: {self.verdict()}>"


def track(
    recording: Recording,
    observer: Observer,
    start: Mapping[str, float] | Sequence[float] | None = None,
    hold: Hold = "zero",
    believed: Motion | None = None,
    step: float = LONGEST_STEP,
    language: Literal["python", "numba"] | None = None,
) -> Run:
    """Let an observer follow a recording.

    Parameters
    ----------
    recording : Recording
    observer : Observer
        On the recording's surface, with measured outputs that the recording has.
    start : mapping of coordinate names to values, or n values, optional
        Estimates at the first sample.  What is left out starts from the first sample (measured) or at the
        observer's own start (hidden).
    hold : "zero", "first" or "exact"
        What the observer takes for the outputs between samples: the last sample; a line to the next one, which a
        running system does not have yet, so that it looks one sample ahead; or the exact signal without noise,
        known in simulations only.  A lost sample prolongs the hold.  Estimates at the samples use no later one with
        the line either, but those between would have to wait for it.
    believed : Motion, optional
        The motion that the observer believes in; the recording's own when left out.
    step : float
        Longest integration step in seconds; a sample always ends one.
    language : "python" or "numba", optional
        See `solve`.

    Returns
    -------
    Run

    Raises
    ------
    DoesNotFit
        If surface, outputs or motion do not fit the observer.
    ValueError
        If the start, the hold or the step make no sense.

    Warns
    -----
    StepTooLong
        If the fastest part of the observer becomes too fast for the steps.
    """
    form = observer.form
    believed = believed or recording.motion
    _refuse_misfits(recording, observer, believed, hold, step)
    columns = [recording.names.index(name) for name in form.measured]
    samples = recording.outputs[:, columns]
    grid, index = step_grid(recording.time, step)
    _warn_of_long_steps(observer, grid)
    known = _known(recording, believed, grid)
    initial = observer.initial_state(
        dict(zip(form.measured, samples[0].tolist(), strict=True)),
        _named(start, form.coordinates),
        dict(zip(form.parameters, known[0].tolist(), strict=True)),
    )
    table = Table(
        np.diff(grid), _held(recording, columns, grid, index, hold), known, _arriving(samples, index, len(grid))
    )
    trace = solve(observer.equations, initial, table, [gain.value for gain in observer.gains], language)
    states = trace.states[index]
    at_samples = known if len(known) == 1 else known[2 * index]
    inputs = (*states.T, *(_last_sample(column) for column in samples.T), *at_samples.T)
    estimate, lacking = _estimates(observer, inputs, recording.time - recording.time[0], samples[0])
    return Run(
        recording,
        observer,
        estimate,
        states,
        grid[trace.resets],
        None if trace.diverged is None else float(grid[trace.diverged]),
        hold,
        lacking,
    )


def _estimates(
    observer: Observer, inputs: Sequence[Array], time: Array, first: Array
) -> tuple[Array, NDArray[np.int_]]:
    """Estimates at the samples, NaN for the hidden coordinates in a gap, and in which gap each sample lies.

    Parameters
    ----------
    observer : Observer
    inputs : arrays of shape (K,)
        State, outputs and parameters at the samples.
    time : array of shape (K,)
        Seconds since the first sample.
    first : array of shape (n1,)
        The first sample.
    """
    form = observer.form
    symbols = (*observer.equations.state, *form.x1, *form.parameters)
    measured, hidden = (np.array([form.coordinates.index(symbol) for symbol in x]) for x in (form.x1, form.x2))
    lacking = np.zeros(len(time), dtype=int)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore", under="ignore"):
        estimate = np.stack(vectorised(symbols, observer.estimate, observer.gain_values)(*inputs), axis=-1)
        if observer.gaps:
            symbols = (*symbols, elapsed, *first_innovation(form))
            conditions = [gap.condition for gap in observer.gaps]
            begun = np.broadcast_to(first - estimate[0, measured], (len(time), len(measured)))
            found = vectorised(symbols, conditions, observer.gain_values)(*inputs, time, *begun.T)
            for k, holds in reversed(list(enumerate(found, 1))):
                lacking[holds != 0] = k
            estimate[np.ix_(lacking > 0, hidden)] = np.nan
    return estimate, lacking


def _warn_of_long_steps(observer: Observer, grid: Array) -> None:
    """Tell before the run, from gains and times alone, when a step will no longer resolve the observer."""
    if observer.fastest is None:
        return
    (rate,) = vectorised((elapsed,), [observer.fastest.rate], observer.gain_values)(grid[1:] - grid[0])
    steps = np.diff(grid)
    late = np.flatnonzero(rate * steps >= LARGEST_STEP_RATE)
    if len(late):
        k = late[0]
        warnings.warn(
            TOO_LONG.format(
                time=f"{grid[k] - grid[0]:.3g}",
                name=observer.name,
                rate=f"{rate[k]:.4g}",
                step=f"{steps[k]:.3g}",
                limit=f"{LARGEST_STEP_RATE:g}",
                remedy=observer.fastest.remedy,
                shorter=f"{LARGEST_STEP_RATE / rate.max():.2g}",
            ),
            StepTooLong,
            stacklevel=3,
        )


def _refuse_misfits(recording: Recording, observer: Observer, believed: Motion, hold: str, step: float) -> None:
    form, surface = observer.form, recording.surface
    if form.surface is None or not form.surface.fits(surface):
        raise DoesNotFit(
            f"the {observer.name} observer was made for the {form.surface.name if form.surface else 'no'} surface "
            f"{dict(form.values)}, but the recording was seen on the {surface.name} {dict(surface.values)}; derive the "
            "observer for the recording's surface"
        )
    missing = [name for name in form.measured if name not in recording.names]
    if missing:
        raise DoesNotFit(
            f"the observer measures {', '.join(form.measured)}, but the recording has only "
            f"{', '.join(recording.names)}; measure less: system.measure({', '.join(map(repr, recording.names))})"
        )
    expected = (*believed.parameters, *surface.parameters)
    if form.parameters != expected:
        raise DoesNotFit(
            f"the observer was derived for a motion with {', '.join(map(str, form.parameters))}, but the motion that "
            f"it is to believe has {', '.join(map(str, expected))}; use the same kind of motion for both"
        )
    if observer.constant_motion and believed.signal is not None and not believed.signal.constant:
        raise DoesNotFit(
            f"the {observer.name} observer needs a motion with constant coefficients, but the one that it is to "
            "believe varies; use an observer with an innovation"
        )
    if hold not in ("zero", "first", "exact"):
        raise ValueError(f"the hold {hold!r} is none of 'zero', 'first' and 'exact'")
    if hold == "exact" and recording.signal is None:
        raise DoesNotFit("the exact signal between samples is known in simulations only; hold them 'zero' or 'first'")
    if not (math.isfinite(step) and step > 0):
        raise ValueError(f"the step is {step} s; it must be positive")


def _named(start: Mapping[str, float] | Sequence[float] | None, coordinates: Symbols) -> dict[str, float]:
    """Estimates at the start by the names of their coordinates."""
    if start is None or isinstance(start, Mapping):
        return {name: float(value) for name, value in (start or {}).items()}
    names = [symbol.name for symbol in coordinates]
    if len(start) != len(names):
        raise ValueError(f"the start has {len(start)} values; expected {len(names)}: {', '.join(names)}")
    return dict(zip(names, map(float, start), strict=True))


def _held(recording: Recording, columns: list[int], grid: Array, index: NDArray[np.int_], hold: Hold) -> Array:
    """Measured outputs at the start, the middle and the end of every step, shape (N, 3, m)."""
    if hold == "exact" and recording.signal is not None:
        exact = recording.signal(halves(grid))[:, columns]
        return np.stack([exact[:-1:2], exact[1::2], exact[2::2]], axis=1)
    times = halves(grid)
    held = []
    for column in recording.outputs[:, columns].T:
        if hold == "zero":
            interval = np.repeat(np.arange(len(index) - 1), np.diff(index))
            value = _last_sample(column)[interval]
            held.append(np.stack([value, value, value], axis=1))
        else:
            there = np.isfinite(column)
            line = np.interp(times, recording.time[there], column[there])
            held.append(np.stack([line[:-1:2], line[1::2], line[2::2]], axis=1))
    return np.stack(held, axis=2)


def _last_sample(column: Array) -> Array:
    """Each sample, or where it was lost the last one before it."""
    return column[np.maximum.accumulate(np.where(np.isfinite(column), np.arange(len(column)), 0))]


def _known(recording: Recording, believed: Motion, grid: Array) -> Array:
    """Parameters of motion and surface at the starts, middles and ends of the steps."""
    rows = believed.known(halves(grid))
    surface = recording.surface
    shape = [surface.values[symbol] for symbol in surface.parameters]
    return np.hstack([rows, np.broadcast_to(np.array(shape), (len(rows), len(shape)))])


def _arriving(samples: Array, index: NDArray[np.int_], count: int) -> Array:
    """Samples at the steps' ends at which they arrive, NaN at the others."""
    arriving = np.full((count, samples.shape[1]), np.nan)
    arriving[index] = samples
    return arriving
