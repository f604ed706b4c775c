"""A state in motion whose points a camera may see."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from percept_obs.compile import Array
from percept_obs.compile.integrator import EACH, PLANT_STEP, instants
from percept_obs.points.form import PointsForm
from percept_obs.points.kernel import advance, arrays, choose
from percept_obs.recording import Scene, step_grid
from percept_obs.system.motion import Motion


class LeavesEveryBound(ValueError):
    """The state grows without end, so that nothing can be recorded of it."""


@dataclass(frozen=True, eq=False)
class PointsScenario(Scene):
    """A state in motion whose points a camera may see.

    Parameters
    ----------
    name : str
    form : PointsForm
        With numbers for its motion.
    state : sequence of n numbers
        The state at time 0.
    duration : float
        In seconds.
    source : str
        Where the set-up comes from.

    Raises
    ------
    ValueError
        If the state has another size or is not finite, or the duration is not positive.
    """

    name: str
    form: PointsForm
    state: Sequence[float]
    duration: float
    source: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "state", self._check("state", self.state, self.form.names))

    @property
    def view(self) -> PointsForm:
        """The form."""
        return self.form

    @property
    def known_motion(self) -> Motion:
        """The form's motion."""
        return self.form.motion

    def coordinates(self, times: ArrayLike) -> Array:
        """States at times from 0 on that do not decrease, shape (K, n), integrated with steps of `PLANT_STEP` at most.

        Raises
        ------
        LeavesEveryBound
            If the state grows beyond all bounds before.
        """
        times = np.asarray(times, dtype=float)
        form = self.form
        grid, index = step_grid(np.concatenate([[0.0], times]), PLANT_STEP)
        count = len(grid) - 1
        unseen = np.full((count, EACH + 1, form.points, len(form.image_coordinates)), np.nan)
        loop = arrays(form, np.arange(form.states), np.arange(form.points))
        known, any_P, none = form.numbers(instants(grid)), np.eye(form.states)[None], np.zeros((1, 1))
        law, language = (False, 0.0, 0.0, none), choose(None, count * form.states)
        path, _, diverged = advance(
            loop, law, np.array(self.state), none, np.diff(grid), known, any_P, unseen, language
        )
        if diverged is not None:
            raise LeavesEveryBound(
                f"the state of {self.name!r} leaves every bound at {grid[diverged]:.4g} s; shorten the duration"
            )
        return path[index[1:]]
