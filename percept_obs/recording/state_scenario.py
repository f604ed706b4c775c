"""Simulation of a state that no imaging surface sees."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from percept_obs.compile import Array, Table, solve
from percept_obs.compile.equations import Equations
from percept_obs.compile.integrator import PLANT_STEP, instants, step_grid
from percept_obs.recording.camera import Scene
from percept_obs.recording.path import times_of
from percept_obs.system.motion import Motion
from percept_obs.system.state_view import StateView
from percept_obs.validation import NAMED, Times, checked, set_fields


@checked
@dataclass(frozen=True, eq=False)
class StateScenario(Scene):
    """A state in motion, seen in a `StateView`.

    Parameters
    ----------
    name : str
    seen : StateView
    motion : Motion
        With numbers, of the view's kind.
    state : array of shape (n,)
        At time 0.
    duration : float
        In seconds.
    measured : Motion, optional
        As an observer knows the motion, such as by an IMU; the motion itself when left out.
    constants : function of times, optional
        Entries of the state that the true motion does not have, such as biases of what was measured: an array of
        shape (K, q) for the last q entries, which are 0 for the true motion.
    source : str

    Raises
    ------
    ValueError
        If the state is not finite, the duration not positive, or the motion without numbers or not of the view.

    See Also
    --------
    record : Simulates a recording of it.

    Examples
    --------
    >>> from percept_obs import record
    >>> from percept_obs.recording.scenarios import own_ship_turns
    >>> record(own_ship_turns(), 20).names
    ('y3',)
    """

    name: str
    seen: StateView
    motion: Motion
    state: Annotated[Sequence[float], NAMED]
    duration: float
    measured: Motion | None = None
    constants: Callable[[Array], Array] | None = None
    source: str = ""
    unit: float = 1.0

    def __post_init__(self) -> None:
        if self.motion.parameters != self.seen.motion.parameters:
            raise ValueError(f"the {self.motion.name} motion is none of {self.seen.name}; give {self.seen.motion.name}")
        set_fields(self, state=self._check("state", self.state, [symbol.name for symbol in self.seen.state]))

    @property
    def view(self) -> StateView:
        """The view."""
        return self.seen

    @property
    def known_motion(self) -> Motion:
        """Motion as an observer knows it."""
        return self.measured or self.motion

    def coordinates(self, times: Times) -> Array:
        """Return true coordinates at times from 0 on that do not decrease, shape (K, n)."""
        times, motion = times_of(times, len(self.state)), self.motion
        breaks = np.asarray(() if motion.signal is None else motion.signal.breaks(times[-1]), dtype=float)
        ends = np.union1d(times, [0.0, *breaks[(breaks > 0) & (breaks < times[-1])]])
        grid, index = step_grid(ends, PLANT_STEP)
        known = motion.known(0.0) if motion.constants is not None else motion.known(instants(grid))
        table = Table(np.diff(grid), np.empty((len(grid) - 1, 1, 0)), known, np.empty((0, 0)))
        equations = Equations(self.seen.state, self.seen.rate, (), motion.parameters)
        path = solve(equations, self.state, table, (), "python").states
        states = path[index[np.searchsorted(ends, times)]]
        if self.constants is not None:
            found = np.asarray(self.constants(times), dtype=float)
            states[:, -found.shape[1] :] = found
        return self.seen.project(states)
