"""Integration of switching observers: chatter at fixed steps, and ever shorter steps of adaptive solvers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from percept_obs.compile import Array, Indices
from percept_obs.compile.integrator import step_grid
from percept_obs.observers.base import Observer, with_point
from percept_obs.recording import Recording, Scenario
from percept_obs.tracking.following import track
from percept_obs.validation import checked, load_pandas, positive

if TYPE_CHECKING:
    import pandas as pd


TOLERANCE = 1e-6
"""Relative and absolute tolerance of the adaptive solver."""


@checked
def chatter(
    recording: Recording,
    observer: Observer,
    steps: Sequence[float],
    start: Mapping[str, float] | Sequence[float] | None = None,
    after: float = 0.0,
) -> pd.DataFrame:
    """Errors of an observer that knows the exact signal, at several steps of integration.

    The remaining errors are those of the integration: a step across the jump of a sign pushes the wrong way for a part
    of the step, so that the estimate never comes to rest on the switching surface.  With the step h and the size gamma
    of the sign,

    - a sign in the rate of the estimate (the sliding mode observer) leaves errors proportional to gamma h;
    - a sign in the rate of its rate (the range identification observer) makes the estimate oscillate: a crossing feeds
      in the energy gamma h v for the speed v, and the damping c takes c v^3 / gamma, which balance at
      v = gamma sqrt(h / c).  The hidden part is read from that speed, so its error is proportional to sqrt(h).

    Parameters
    ----------
    recording : Recording
        From a simulation.
    observer : Observer
    steps : sequence of float
        Longest steps in seconds; a sample always ends one.
    start : see `track`
    after : float
        Seconds from which on errors count.

    Returns
    -------
    pandas.DataFrame
        One row a step: step (s, the longest that was taken), and the root mean square error of each coordinate.

    Raises
    ------
    ValueError
        If there is no step, one is not positive, or `after` lies outside the recording.

    See Also
    --------
    effort : steps of an adaptive solver

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole, record, scenarios, smo
    >>> observer = smo(PerspectiveSystem(affine(), pinhole()).measure("y1", "y2"), switch="sign")
    >>> table = chatter(record(scenarios.ma2005_eq35(), 2), observer, [0.01, 0.005], after=1)
    >>> table["step"].round(4).tolist()
    [0.01, 0.005]
    """
    pd = load_pandas()
    if not len(steps):
        raise ValueError("there are no steps to compare; give some, in seconds")
    if not 0 <= after < recording.time[-1] - recording.time[0]:
        raise ValueError(f"after is {after} s; it must be from 0 on and shorter than the recording")
    names = [symbol.name for symbol in observer.form.coordinates]
    begin, end = recording.time[0] + after, recording.time[-1]
    rows = []
    for step in steps:
        run = track(recording, observer, start, "exact", step=step)
        taken = float(np.diff(step_grid(recording.time, step)[0]).max())
        rows.append({"step": taken} | {name: run.rms(begin, end, name) for name in names})
    return pd.DataFrame(rows)


@dataclass(frozen=True, eq=False)
class Effort:
    """Steps and evaluations of an adaptive solver.

    Parameters
    ----------
    time : array of shape (N + 1,)
        The ends of its steps in seconds.
    evaluations : array of shape (N + 1,)
        Evaluations of the right-hand side by then.
    finished : bool
        True if it reached the end within the allowed evaluations.

    See Also
    --------
    effort : Computes it.
    percept_obs.figures.chatter : Draws it.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole, scenarios, smo
    >>> form = PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> observers = [smo(form, switch=switch) for switch in ("fraction", "sign")]
    >>> [effort(scenarios.ma2005_eq35(), each, 0.5, most=2000).finished for each in observers]
    [True, False]
    """

    time: Array
    evaluations: Indices
    finished: bool

    @property
    def steps(self) -> Array:
        """Lengths of the steps in seconds, shape (N,)."""
        return np.diff(self.time)


@checked
def effort(
    scenario: Scenario,
    observer: Observer,
    duration: float,
    start: Mapping[str, float] | None = None,
    most: int = 20_000,
) -> Effort:
    """Return the steps of an adaptive Runge-Kutta solver (RK45) for point and observer, without noise and resets.

    At each crossing of a jump the solver finds an error that its order does not explain, and shortens the step until
    the jump weighs no more than its tolerance of 1e-6.  Once the observer slides, crossings never end (Filippov 1988).

    Parameters
    ----------
    scenario : Scenario
        With a constant motion.
    observer : Observer
    duration : float
        Seconds.
    start : mapping of coordinate names to estimates, optional
    most : int
        Evaluations after which it gives up.

    Raises
    ------
    ValueError
        If the duration or the number of evaluations is not positive.

    See Also
    --------
    chatter : errors at fixed steps

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole, scenarios, smo
    >>> observer = smo(PerspectiveSystem(affine(), pinhole()).measure("y1", "y2"))
    >>> effort(scenarios.ma2005_eq35(), observer, 0.5).finished
    True
    """
    from scipy.integrate import RK45

    positive(duration=duration, most=most)
    point = scenario.coordinates([0.0])[0]
    known = dict(zip((symbol.name for symbol in scenario.surface.coordinates), point.tolist(), strict=True))
    outputs = {name: known[name] for name in observer.form.measured}
    inside = observer.initial_state(outputs, start or {}, scenario.motion.values | dict(observer.form.values))
    form = observer.form
    outside = [known[symbol.name] for symbol in (*form.x1, *form.x2)]
    flow = with_point(observer).lambdify(scenario.motion)
    solver = RK45(flow, 0.0, [*outside, *inside], duration, rtol=TOLERANCE, atol=TOLERANCE)
    times, evaluations = [0.0], [solver.nfev]
    while solver.status == "running" and solver.nfev < most:
        solver.step()
        times.append(float(solver.t))
        evaluations.append(int(solver.nfev))
    return Effort(np.array(times), np.array(evaluations), solver.status == "finished")
