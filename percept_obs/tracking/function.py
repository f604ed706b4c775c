"""An observer given as a Python function, such as a particle filter, for what no equation holds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from percept_obs.compile import Array, Language, vectorised
from percept_obs.compile.equations import Equations
from percept_obs.compile.integrator import step
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.motion import Motion
from percept_obs.tracking.following import DoesNotFit, Start, follow, named_start, require_match
from percept_obs.tracking.grid import TimeGrid, known_signals
from percept_obs.tracking.run import Run
from percept_obs.validation import bar, checked

NOT_IN_THE_PAGE = "the {} observer is a Python function, which the page cannot run; let it follow with track"
"""Refusal of live labs."""


@checked
@dataclass(frozen=True, eq=False)
class FunctionObserver:
    """Observer as a function of its state, for what no equation holds; it runs in Python alone, sample by sample.

    Parameters
    ----------
    name : str
        In tables and messages.
    form : PartitionedSystem
        The system; ``n`` coordinates in the order of ``form.coordinates``, with lengths by the recording's unit.
    start : function of the wanted estimates, shape (n,)
        Returns the state at the first sample, an array of any shape.
    step : function of (state, sample, seconds, known)
        Returns the next state, of the same shape.  ``sample`` has the measured outputs at the step's end, shape (n1,),
        NaN where one was lost; it is None where all were.  ``known`` has the parameters of motion and surface by their
        names, in the middle of the step.
    estimate : function of the state
        Returns estimates of the coordinates, shape (n,).
    covariance : function of the state, optional
        Returns the covariance of the estimate that it claims, shape (n, n).

    Raises
    ------
    ValueError
        In `track`, if a function fails, or returns another shape or a negative variance; what is not finite diverged.

    See Also
    --------
    percept_obs.tracking.transition : The system's own step, for such functions.
    Observer : Observers as equations, which every language of the package runs.

    Examples
    --------
    >>> import numpy as np
    >>> from percept_obs import FunctionObserver, PerspectiveSystem, affine, pinhole, record, scenarios, track
    >>> from percept_obs.tracking import transition
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> moved = transition(form)
    >>> def step(state, sample, seconds, known):
    ...     state = moved(state, seconds, known)
    ...     return state if sample is None else np.array([*sample, state[2]])
    >>> copy = FunctionObserver("copy", form, np.copy, step, np.copy)
    >>> seen = record(scenarios.ma2005_eq35(), 2)
    >>> run = track(seen, copy, {"y3": seen.truth[0, 2]})
    >>> bool(abs(run.error[-1, 2]) < 1e-6)
    True
    """

    name: str
    form: PartitionedSystem
    start: Callable[[Array], Array]
    step: Callable[[Array, Array | None, float, Mapping[str, float]], Array]
    estimate: Callable[[Array], Array]
    covariance: Callable[[Array], Array] | None = None
    gains: ClassVar[tuple[()]] = ()
    unobservable: ClassVar[tuple[()]] = ()
    equations: ClassVar[Equations] = Equations((), ())
    """None, as tables ask for them."""

    def refusal(self, form: PartitionedSystem) -> str:
        """Return no reason against any form: whether it fits is found by `track`, with a recording."""
        return ""

    def __call__(self, form: PartitionedSystem) -> FunctionObserver:
        """Return the observer itself, so that tables can call it like a family."""
        return self


@dataclass(frozen=True, eq=False)
class FunctionRun(Run):
    """Run of a `FunctionObserver`, whose state is the estimate, with the covariances that it claims."""

    claimed: Array | None = None

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the estimate that the observer claims, shape (K, n, n); raises ValueError without."""
        if self.claimed is None:
            raise ValueError(f"the {self.observer.name} observer claims no covariance; give it a function covariance=")
        return self.claimed / np.outer(self.recording.scale, self.recording.scale)


@follow.register
def _follow_by_function(
    observer: FunctionObserver, grid: TimeGrid, start: Start, believed: Motion | None, language: Language | None
) -> FunctionRun:
    form, recording, names = observer.form, grid.recording, [symbol.name for symbol in observer.form.coordinates]
    believed = believed or recording.motion
    require_match(form, recording, believed)
    believed.refuse_unit(recording.unit)
    samples = recording.outputs[:, [recording.names.index(name) for name in form.measured]]
    if np.isnan(samples[0]).any():
        raise DoesNotFit(f"the first sample was lost, but the {observer.name} observer starts from it; use between()")
    wanted = dict.fromkeys(names, 0.0) | dict(zip(form.measured, samples[0].tolist(), strict=True))
    given, scale = named_start(start, form.coordinates), dict(zip(names, recording.scale.tolist(), strict=True))
    wanted |= {name: value * scale[name] for name, value in given.items()}
    rows = known_signals(believed, recording.view, recording.time[:-1] + recording.intervals / 2, recording.unit)
    rows = np.broadcast_to(rows, (len(recording.time) - 1, rows.shape[1]))
    n, letters = len(names), list(map(str, form.parameters))
    estimates, diverged = np.full((len(recording.time), n), np.nan), None
    claims = None if observer.covariance is None else np.full((len(recording.time), n, n), np.nan)

    def asked(part: str, shape: tuple[int, ...] | None, *arguments: Any) -> Array:
        """Return the result of one of the observer's functions; NaN if a number is too large or a matrix singular."""
        try:
            with np.errstate(all="ignore"):
                found = np.asarray(getattr(observer, part)(*arguments), dtype=float)
        except (OverflowError, np.linalg.LinAlgError):
            return np.full(shape or (1,), np.nan)
        except Exception as error:
            said = f"{type(error).__name__}: {error}"
            raise ValueError(f"{part} of the {observer.name} observer fails {when}: {said}") from error
        if shape is not None and found.shape != shape:
            raise ValueError(f"{part} of the {observer.name} observer gives shape {found.shape} {when}, not {shape}")
        return found

    state = np.empty(0)
    for k, time in enumerate(bar(recording.elapsed.tolist(), observer.name)):
        when = f"at {time:.4g} s"
        if k:
            sample = None if np.isnan(samples[k]).all() else samples[k]
            known = dict(zip(letters, rows[k - 1].tolist(), strict=True))
            state = asked("step", state.shape, state, sample, float(recording.intervals[k - 1]), known)
        else:
            state = asked("start", None, np.array([wanted[name] for name in names]))
        row = asked("estimate", (n,), state) if np.isfinite(state).all() else np.full(n, np.nan)
        if not np.isfinite(row).all():
            diverged = float(recording.time[k])
            break
        estimates[k] = row
        if claims is not None:
            claims[k] = asked("covariance", (n, n), state)
            if (np.diagonal(claims[k]) < 0).any():
                raise ValueError(f"covariance of the {observer.name} observer has a negative variance {when}")
    none, seen = np.empty(0), np.zeros(len(estimates), dtype=int)
    return FunctionRun(
        recording, observer, estimates / recording.scale, estimates, diverged, grid.hold, none, seen, claims
    )


@checked
def transition(form: PartitionedSystem) -> Callable[[Array, float, Mapping[str, float]], Array]:
    """Return the system's own step, a function of (coordinates, seconds, known) for a `FunctionObserver`.

    It moves coordinates of shape (..., n), many particles or sigma points at once, by one step of the package's
    Runge-Kutta method with the motion held.

    Parameters
    ----------
    form : PartitionedSystem

    Raises
    ------
    ValueError
        By the function, if a parameter of the form is not known.

    See Also
    --------
    FunctionObserver : Has such a step.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, pinhole, rigid
    >>> from percept_obs.tracking import transition
    >>> moved = transition(PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2"))
    >>> still = dict.fromkeys(("w_c1", "w_c2", "w_c3", "v_c1", "v_c2", "v_c3", "v_p1", "v_p2", "v_p3"), 0.0)
    >>> moved([[0.1, 0.2, 0.5], [0.0, 0.0, 1.0]], 0.1, still | {"v_c3": 1.0}).round(3).tolist()
    [[0.105, 0.211, 0.526], [0.0, 0.0, 1.111]]
    """
    rates = dict(zip((*form.x1, *form.x2), form.rate, strict=True))
    function = vectorised((*form.coordinates, *form.parameters), [rates[symbol] for symbol in form.coordinates])

    def moved(coordinates: Array, seconds: float, known: Mapping[str, float]) -> Array:
        if missing := [symbol.name for symbol in form.parameters if symbol.name not in known]:
            raise ValueError(f"known has no {', '.join(missing)}; pass on what the step is given")
        values = [known[symbol.name] for symbol in form.parameters]

        def rate(instant: int, x: Array) -> Array:
            return np.stack(function(*np.moveaxis(x, -1, 0), *values), axis=-1)

        return step(np.asarray(coordinates, dtype=float), np.asarray(seconds), rate)

    return moved
