"""Tracking: an observer follows a recording."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, singledispatch
from typing import Annotated, Any

import numpy as np
import sympy as sp

from percept_obs.compile import Array, Indices, Language, Table, choose, solve, vectorised
from percept_obs.compile.equations import Equations, Expressions, Symbols
from percept_obs.compile.integrator import EACH, LARGEST_STEP_RATE, LONGEST_STEP
from percept_obs.compile.rows import Rows, by_row
from percept_obs.observers.base import Observer, state_at_start
from percept_obs.observers.inversion import Unobservable, elapsed, first_innovation
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.motion import Motion
from percept_obs.system.state_view import StateView
from percept_obs.system.view import refuse_several
from percept_obs.tracking.grid import Hold, TimeGrid, known_signals, time_grid
from percept_obs.tracking.run import Run
from percept_obs.tracking.smoothing import Belief, doubts_of, once_observable
from percept_obs.validation import Kind, checked, limit, numbers, of_kind, positive, require_definite, warn

Start = Mapping[str, float] | Sequence[float] | None


class DoesNotFit(ValueError):
    """An observer cannot follow this recording.

    See Also
    --------
    track : Raises it before the run begins.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios, sphere, track
    >>> flat = ibo(PerspectiveSystem(affine(), pinhole()))
    >>> track(record(scenarios.ma2005_eq35(sphere()), 1), flat)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    percept_obs.tracking.following.DoesNotFit: the system was made for the pinhole surface, ...
    """


class StepTooLong(UserWarning):
    """The steps become too long for the fastest part of an observer, which will then chatter."""


TOO_LONG = (
    "from {time} s on, the {name} observer's fastest part decays with {rate}/s, too fast for a step of {step} s: their "
    "product must stay below {limit}; {remedy}, or take steps below {shorter} s"
)
"""Message of `StepTooLong`, also of live labs."""


AnyObserver = Annotated[
    Any, Kind("an observer of a form", lambda o: follow.dispatch(type(o)) is not follow.dispatch(object), "ibo(form)")
]
"""Any observer that `follow` can run."""


@checked
def track(
    recording: Recording,
    observer: AnyObserver,
    start: Any = None,
    hold: Hold = "zero",
    believed: Motion | None = None,
    step: float = LONGEST_STEP,
    language: Language | None = None,
    longest_hold: float = math.inf,
) -> Run:
    """Let an observer follow a recording.

    Parameters
    ----------
    recording : Recording
        Of one point or of several.
    observer : Observer, FunctionObserver, or LuenbergerObserver for several points
        On the recording's surface, with measured outputs that the recording has.
    start : mapping of coordinate names to values, n values, Belief, or FirstSight, optional
        Estimates at the first sample.  What is left out starts from the first sample (measured) or at the
        observer's own start (hidden).  The extended Kalman filter may start from a `Belief`, with a covariance.  Left
        out for a camera with an IMU, it starts when a smoother of all samples so far knows the distance to 5 %,
        and it has no estimate before.  Several points may start at their `FirstSight`.
    hold : "zero", "first" or "exact"
        Signal that stands for the outputs between samples: the last sample; a line to the next one, which a running
        system does not have yet, so that it looks one sample ahead; or the exact signal without noise, known in
        simulations only.  A lost sample prolongs the hold of a single point; one of several points is then not seen
        until its next sample.  Estimates at the samples use no later one with the line either, but those between
        would have to wait for it.
    believed : Motion, optional
        The motion that the observer believes in; the recording's own when left out.
    step : float
        Longest integration step in seconds; a sample always ends one.
    language : "python" or "numba", optional
        See `solve`.
    longest_hold : float
        Seconds after a sample from which on one of several points is not seen until its next one.

    Returns
    -------
    Run
        A `PointsRun` for several points.

    Raises
    ------
    DoesNotFit
        If view, outputs or motion do not fit the observer, or the first sample of a single point was lost.
    ValueError
        If the start, the hold or a time make no sense.
    TooMuchWork
        If there are too many steps.

    Warns
    -----
    StepTooLong
        If the fastest part of the observer becomes too fast for the steps.

    See Also
    --------
    percept_obs.studies.comparison.compare : Several observers on several recordings.
    ensemble : Many runs with noise of their own.

    Notes
    -----
    The corrections of many points grow with 1 + |y|^2.  A point that passes close beside the camera has images without
    bound, so that no step is short enough: record it with a camera of finite `reach`.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ibo, pinhole, record, scenarios, track
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> track(record(scenarios.ma2005_eq35(), 20), ibo(form)).settling_time() < 5
    True
    """
    if hold == "exact" and recording.signal is None:
        raise DoesNotFit("the exact signal between samples is known in simulations only; hold them 'zero' or 'first'")
    positive(step=step)
    if not longest_hold > 0:
        raise ValueError(f"the longest_hold is {longest_hold}; it must be positive, in seconds")
    length = float(recording.elapsed[-1])
    form, own = observer.form, getattr(observer, "equations", None)
    states = len(own.state) or len(form.coordinates) if own is not None else int(form.states)
    steps = max(length / step, len(recording.time))
    limit(
        steps * (states + 2 * recording.outputs[0].size),
        f"numbers, from {steps:.3g} steps",
        "track a shorter part, recording.between(begin, end), or take longer steps",
    )
    return follow(observer, time_grid(recording, step, hold, longest_hold), start, believed, language)


@singledispatch
def follow(observer: Any, grid: TimeGrid, start: Any, believed: Motion | None, language: Language | None) -> Run:
    """Let an observer follow a recording on a grid; each kind of observer registers its own function."""
    raise DoesNotFit(f"an observer is needed, such as ibo(form), not {observer!r}")


@follow.register
def _follow_one_point(
    observer: Observer, grid: TimeGrid, start: Start | Belief, believed: Motion | None, language: Language | None
) -> Run:
    form, recording = observer.form, grid.recording
    observer, believed = observer.suited_to(recording.effective_variance), believed or recording.motion
    _require_fit(grid, observer, believed)
    if start is None and isinstance(form.view, StateView) and form.view.guess and observer.equations.update:
        return _once_observable(observer, grid, believed, language)
    belief, plain = (start, None) if isinstance(start, Belief) else (None, start)
    places = [recording.names.index(name) for name in form.measured]
    adjacent = places == list(range(places[0], places[0] + len(places)))
    columns: Any = slice(places[0], places[0] + len(places)) if adjacent else places  # a slice copies nothing
    samples = recording.outputs[:, columns]
    _warn_of_long_steps(observer, grid)
    times = grid.instants if believed.constants is None else grid.times[:1]  # many instants take long
    known = known_signals(believed, recording.view, times, recording.unit)
    named = named_start(plain, form.coordinates)
    if named and recording.unit != 1:
        units = dict(zip(map(str, recording.view.coordinates), recording.scale.tolist(), strict=True))
        named = {name: value * units.get(name, 1.0) for name, value in named.items()}
    outputs = dict(zip(form.measured, samples[0].tolist(), strict=True))
    initial = state_at_start(observer, outputs, named, zip(form.parameters, known[0].tolist(), strict=True))
    if belief:
        initial = _state_of(observer, belief, recording.scale)
    arriving = np.empty((0, len(form.measured)))
    if observer.equations.update:
        arriving = np.array(samples)
        if not grid.one_step_a_sample:
            arriving = np.full((len(grid.times), len(form.measured)), np.nan)
            arriving[grid.index] = samples
        arriving[0, [bool(belief) or name not in named for name in form.measured]] = np.nan  # the start uses these
    table = Table(grid.steps, grid.held(filled=True)[..., columns], known, arriving)
    language = choose(language, len(grid.steps), observer.equations)
    trace = solve(observer.equations, initial, table, [gain.value for gain in observer.gains], language)
    states = trace.states if grid.one_step_a_sample else trace.states[grid.index]
    at_samples = known if len(known) == 1 else known[EACH * grid.index]
    filled = recording.last_outputs[:, columns]
    estimate, unobservable = _estimates(observer, states, filled, at_samples, recording.elapsed, language)
    diverged_at = None if trace.diverged is None else float(grid.times[trace.diverged])
    resets = grid.times[trace.resets.nonzero()[0]]
    scaled = estimate if recording.unit == 1 else estimate / recording.scale  # a copy takes a fifth of a short run
    return Run(recording, observer, scaled, states, diverged_at, grid.hold, resets, unobservable)


def _state_of(observer: Observer, belief: Belief, scale: Array) -> Array:
    """State of a filter that consists of the estimate and its covariance."""
    if observer.covariance is None or not {*observer.estimate, *observer.covariance} >= {*observer.equations.state}:
        raise DoesNotFit(f"the {observer.name} observer cannot start from a covariance; the extended Kalman filter can")
    n = len(observer.estimate)
    estimate = numbers(belief.estimate, "values of the belief", n)
    P = numbers(belief.covariance, "values of the belief's covariance", n, n)
    require_definite("the belief's covariance", P, semi=True)
    if not np.isfinite(estimate).all():
        raise ValueError("the belief's estimate is not finite; correct it")
    estimate, covariance = estimate * scale, P * np.outer(scale, scale)
    at = dict(zip((*observer.estimate, *observer.covariance), [*estimate, *covariance.ravel()], strict=True))
    return np.array([at[symbol] for symbol in observer.equations.state])


def _once_observable(observer: Observer, grid: TimeGrid, believed: Motion, language: Language | None) -> Run:
    """Run of a filter that starts when the samples tell the scale."""
    form, recording, count = observer.form, grid.recording, len(grid.recording.time)
    variance = next(gain.value for gain in observer.gains if gain.name == "noise_variance")
    known, noise = replace(recording, motion=believed), np.full(len(form.measured), variance)
    first, belief = once_observable(form, known, noise, doubts_of(observer, believed, recording.unit)) or (count, None)
    late = replace(
        observer, unobservable=(Unobservable(sp.false, f"the samples did not tell {recording.view.judged} yet"),)
    )
    estimate, states = np.full((count, len(form.coordinates)), np.nan), np.full((count, len(observer.start)), np.nan)
    diverged_at, resets = None, np.empty(0)
    if belief is not None:
        at = grid.index[first]
        rest = recording.between(recording.time[first], recording.time[-1])
        later = TimeGrid(rest, grid.times[at:], grid.index[first:] - at, grid.hold, grid.longest_hold)
        run = _follow_one_point(observer, later, belief, believed, language)
        estimate[first:], states[first:], diverged_at, resets = run.estimate, run.state, run.diverged_at, run.resets
    unknown = (np.arange(count) < first).astype(int)
    return Run(recording, late, estimate, states, diverged_at, grid.hold, resets, unknown)


def _estimates(
    observer: Observer, states: Array, samples: Array, known: Array, time: Array, language: Language
) -> tuple[Array, Indices]:
    """Estimates, NaN for unobservable coordinates, and the number of the condition that hides them, at each sample.

    They follow from state, outputs and parameters at the samples, and the seconds since the first one.
    """
    form, state, width = observer.form, observer.equations.state, len(observer.estimate)
    which = np.zeros(len(time), dtype=int)
    first = state.index(observer.estimate[0]) if observer.estimate[0] in state else 0
    if not observer.unobservable and observer.estimate == state[first : first + width]:
        return states[:, first : first + width], which
    tables, numbers = [states, samples, time[:, None]], [gain.value for gain in observer.gains]
    if len(known) > 1:
        tables.append(known)
    else:
        numbers += known[0].tolist()
    evaluate, innovations = _evaluator(
        observer.equations, form, observer.estimate, observer.unobservable, len(known) > 1, language
    )
    if innovations:  # the first innovations are constants, and follow from the estimate at the first sample
        (row,) = evaluate([table[:1] for table in tables], np.array([*numbers, *np.zeros(innovations)]))
        numbers += (samples[0] - row[[form.coordinates.index(symbol) for symbol in form.x1]]).tolist()
    found = evaluate(tables, np.array(numbers))
    estimate = found[:, :width]
    if observer.unobservable:
        which = found[:, width].astype(int)
        estimate[np.ix_(which != 0, [form.coordinates.index(symbol) for symbol in form.x2])] = np.nan
    return estimate, which


@lru_cache(maxsize=512)
def _evaluator(
    equations: Equations,
    form: PartitionedSystem,
    estimate: Expressions,
    unobservable: tuple[Unobservable, ...],
    varying: bool,
    language: Language,
) -> tuple[Rows, int]:
    """Function of state, outputs, elapsed time and varying parameters for the estimate and the condition's number.

    Its constants are the gains, the other parameters, and as many first innovations as are returned with it.
    """
    tables = (equations.state, form.x1, (elapsed,), *([form.parameters] if varying else []))
    which = sp.Piecewise(*((k, where.condition) for k, where in enumerate(unobservable, 1)), (0, True))
    first = tuple(first_innovation(form)) if which.has(*first_innovation(form)) else ()
    constants = (*equations.gains, *(() if varying else form.parameters), *first)
    return by_row(tables, constants, (*estimate, *([which] if unobservable else [])), language), len(first)


def _warn_of_long_steps(observer: Observer, grid: TimeGrid) -> None:
    """Warn before the run, from gains and times alone, when a step will no longer resolve the observer."""
    if observer.fastest is None:
        return
    since = grid.times - grid.times[0]
    (rate,) = vectorised((elapsed,), [observer.fastest.rate], observer.gain_values)(since[1:])
    late = np.flatnonzero(rate * grid.steps >= LARGEST_STEP_RATE)
    if len(late):
        k = late[0]
        message = TOO_LONG.format(
            time=f"{since[k]:.3g}",
            name=observer.name,
            rate=f"{rate[k]:.4g}",
            step=f"{grid.steps[k]:.3g}",
            limit=f"{LARGEST_STEP_RATE:g}",
            remedy=observer.fastest.remedy,
            shorter=f"{LARGEST_STEP_RATE / rate.max():.2g}",
        )
        warn(StepTooLong(message))


def _require_fit(grid: TimeGrid, observer: Observer, believed: Motion) -> None:
    """Raise DoesNotFit unless an observer can follow a recording with the motion that it believes in."""
    form, recording = observer.form, grid.recording
    require_match(form, recording, believed)
    lost = [n for n in form.measured if math.isnan(recording.outputs[0, recording.names.index(n)])]
    if lost:
        raise DoesNotFit(
            f"the first sample of {', '.join(lost)} was lost, but the {observer.name} observer starts from it; begin "
            "where all measured outputs are seen: recording.between(begin, end)"
        )
    if grid.longest_hold < math.inf:
        raise DoesNotFit(f"the {observer.name} observer needs its outputs at all times; leave longest_hold out")
    if recording.unit != 1:
        believed.refuse_unit(recording.unit)
    if observer.constant_motion and believed.signal is not None and not believed.signal.constant:
        raise DoesNotFit(
            f"the {observer.name} observer needs a motion with constant coefficients, but the one that it is to "
            "believe varies; use an observer with an innovation"
        )


def require_match(form: PartitionedSystem, recording: Recording, motion: Motion) -> None:
    """Raise DoesNotFit unless a form has the recording's view, its outputs, and the parameters of a motion."""
    view = recording.view
    refuse_several("the form", view, DoesNotFit)
    if form.view is None or not form.view.fits(view):
        made, seen = (f" {dict(values)}" if values else "" for values in (form.values, view.values))
        raise DoesNotFit(
            f"the system was made for {f'the {form.view.name} surface' if form.view else 'no view'}{made}, but the "
            f"recording was seen as {view.name}{seen}; use the same view"
        )
    missing = [name for name in form.measured if name not in recording.names]
    if missing:
        raise DoesNotFit(
            f"the system measures {', '.join(form.measured)}, but the recording has only "
            f"{', '.join(recording.names)}; measure less: system.measure({', '.join(map(repr, recording.names))})"
        )
    expected = (*motion.parameters, *view.parameters)
    if form.parameters != expected:
        raise DoesNotFit(
            f"the system was derived for a motion with {', '.join(map(str, form.parameters)) or 'numbers only'}, the "
            f"given one has {', '.join(map(str, expected)) or 'numbers only'}; use the same kind of motion for both"
        )


def named_start(start: Start, coordinates: Symbols) -> dict[str, float]:
    """Estimates at the start by the names of their coordinates."""
    if start is None:
        return {}
    start = of_kind("track", "start", start, Start)
    names = [symbol.name for symbol in coordinates]
    if isinstance(start, Mapping):
        if unknown := sorted(set(start) - set(names)):
            raise ValueError(f"the start has no coordinate {', '.join(unknown)}; give estimates of {', '.join(names)}")
        return {name: float(value) for name, value in start.items()}
    if len(start) != len(names):
        raise ValueError(f"the start has {len(start)} values; expected {len(names)}: {', '.join(names)}")
    return dict(zip(names, map(float, start), strict=True))
