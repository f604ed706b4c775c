"""The table of known signals: what an observer may know at the instants of its steps."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from percept_obs.compile import Array, Indices
from percept_obs.compile.integrator import STEP_ROUNDING, by_step, instants, step_grid
from percept_obs.recording import Recording

Hold = Literal["zero", "first", "exact"]


@dataclass(frozen=True, eq=False)
class TimeGrid:
    """A recording, laid out in steps for an observer that follows it.

    Parameters
    ----------
    recording : Recording
    grid, index : arrays of shapes (N + 1,) and (K,)
        Ends of the steps in seconds, and where the samples stand among them, as from `step_grid`.
    hold : "zero", "first" or "exact"
        What is taken for the outputs between samples.
    longest_hold : float
        Seconds after a sample from which on it is not held.
    """

    recording: Recording
    grid: Array
    index: Indices
    hold: Hold
    longest_hold: float

    @cached_property
    def steps(self) -> Array:
        """Lengths of the steps in seconds, shape (N,)."""
        return self.recording.intervals if self._a_step_a_sample else np.diff(self.grid)

    @cached_property
    def elapsed(self) -> Array:
        """Seconds from the first sample to the ends of the steps, shape (N + 1,)."""
        return self.recording.elapsed if self._a_step_a_sample else self.grid - self.grid[0]

    @cached_property
    def instants(self) -> Array:
        """The times at which the steps look at known signals, shape (N EACH + 1,)."""
        return instants(self.grid)

    def at_samples(self, rows: Array) -> Array:
        """Those of rows at the steps' ends, shape (N + 1, ...), that stand at the samples, shape (K, ...)."""
        return rows if self._a_step_a_sample else rows[self.index]

    @property
    def _a_step_a_sample(self) -> bool:
        return len(self.grid) == len(self.recording.time)

    def arriving(self, samples: Array) -> Array:
        """Samples of shape (K, m) at the steps' ends at which they arrive, NaN at the others, shape (N + 1, m)."""
        if self._a_step_a_sample:
            return samples.copy()
        arriving = np.full((len(self.grid), samples.shape[1]), np.nan)
        arriving[self.index] = samples
        return arriving

    def held(self, filled: bool) -> Array:
        """Outputs at the instants of every step, shape (N, EACH + 1, ...), or (N, 1, ...) if they last for the step.

        Parameters
        ----------
        filled : bool
            Whether lost samples are bridged by their neighbours; otherwise what is not seen is NaN.
        """
        recording, time = self.recording, self.recording.time
        outputs = _bridged(recording, self.hold) if filled else recording.outputs
        if self.hold == "zero" and self._a_step_a_sample and self.longest_hold == math.inf:
            return outputs[:-1, None]
        interval = np.repeat(np.arange(len(time) - 1), np.diff(self.index))
        before = outputs[interval][:, None]
        if self.hold == "zero":
            held = before
        elif self.hold == "first":
            begin, length = time[interval], np.diff(time)[interval]
            share = (by_step(self.instants) - begin[:, None]) / length[:, None]
            share = share.reshape(*share.shape, *(1,) * (outputs.ndim - 1))
            held = (1 - share) * before + share * outputs[interval + 1][:, None]
        else:
            assert recording.signal is not None
            held = by_step(recording.signal(self.instants))
            held = np.where(np.isnan(before), np.nan, held)
        if self.longest_hold < math.inf:
            since = self.grid[:-1] - time[interval] if self.hold != "first" else np.diff(time)[interval]
            held[since >= self.longest_hold] = np.nan
        return np.asarray(held)


def time_grid(recording: Recording, step: float, hold: Hold, longest_hold: float) -> TimeGrid:
    """A recording in steps no longer than given, one from each sample to the next where that is short enough."""
    if recording.longest_interval <= step * (1 + STEP_ROUNDING):
        return TimeGrid(recording, recording.time, recording.places, hold, longest_hold)
    return TimeGrid(recording, *step_grid(recording.time, step), hold, longest_hold)


def _bridged(recording: Recording, hold: Hold) -> Array:
    """The outputs with lost samples replaced: by the last one, or on the line between their neighbours."""
    if hold != "first":
        return recording.last_outputs
    columns = []
    for column in recording.outputs.T:
        there = np.isfinite(column)
        columns.append(np.interp(recording.time, recording.time[there], column[there]) if there.any() else column)
    return np.stack(columns, axis=-1)
