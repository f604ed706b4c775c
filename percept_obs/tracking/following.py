"""Tracking: an observer follows a recording."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from percept_obs.compile import Table, solve, vectorised
from percept_obs.compile.equations import Symbols
from percept_obs.observers.base import Observer
from percept_obs.observers.inversion import elapsed, first_innovation
from percept_obs.recording import Recording, halves, step_grid
from percept_obs.system.motion import Motion
from percept_obs.tracking.run import Hold, Run

Array = NDArray[np.float64]

LONGEST_STEP = 0.01
"""Longest step, in seconds, with which an observer is integrated unless asked otherwise."""


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
