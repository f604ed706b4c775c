"""Integration steps along a recording, and the known signals at the instants of every step."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from percept_obs.compile import Array, Indices
from percept_obs.compile.integrator import STEP_ROUNDING, by_step, instants, step_grid
from percept_obs.recording import Recording
from percept_obs.system.motion import Motion
from percept_obs.system.view import View

Hold = Literal["zero", "first", "exact"]


@dataclass(frozen=True, eq=False)
class TimeGrid:
    """Integration steps along a recording: times of their N + 1 ends, and the index of the K samples among them.

    The signal stands for the outputs between samples by the `hold`, see `track`; after `longest_hold` seconds a sample
    is no longer held.
    """

    recording: Recording
    times: Array
    index: Indices
    hold: Hold
    longest_hold: float

    @cached_property
    def steps(self) -> Array:
        """Lengths of the steps in seconds, shape (N,)."""
        return self.recording.intervals if self.one_step_a_sample else np.diff(self.times)

    @property
    def one_step_a_sample(self) -> bool:
        """True if each step leads from a sample to the next."""
        return len(self.times) == len(self.recording.time)

    @cached_property
    def instants(self) -> Array:
        """Times at which the steps need known signals, shape (N EACH + 1,)."""
        return instants(self.times)

    def held(self, filled: bool) -> Array:
        """Outputs at the instants of every step, shape (N, EACH + 1, ...), or (N, 1, ...) if they last for the step.

        Lost samples are bridged by their neighbours if filled, else NaN.
        """
        recording, time = self.recording, self.recording.time
        outputs = _bridged(recording, self.hold) if filled else recording.outputs
        if self.hold == "zero" and self.one_step_a_sample and self.longest_hold == math.inf:
            return outputs[:-1, None]  # a view: nothing is copied
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
            since = self.times[:-1] - time[interval] if self.hold != "first" else np.diff(time)[interval]
            held[since >= self.longest_hold] = np.nan
        return np.asarray(held)


def time_grid(recording: Recording, step: float, hold: Hold, longest_hold: float) -> TimeGrid:
    """Divide a recording into steps no longer than given, one from each sample to the next where that is short."""
    if recording.longest_interval <= step * (1 + STEP_ROUNDING):
        return TimeGrid(recording, recording.time, np.arange(len(recording.time)), hold, longest_hold)
    return TimeGrid(recording, *step_grid(recording.time, step), hold, longest_hold)


def known_signals(motion: Motion, view: View, times: Array, unit: float = 1.0) -> Array:
    """Parameters of motion and view at some times by a unit of length, shape (T, p), or (1, p) if all are constant."""
    rows = motion.known(times) if motion.constants is None else motion.constants
    shape = [view.values[symbol] for symbol in view.parameters]
    rows = np.hstack([rows, np.tile(np.array(shape, dtype=float), (len(rows), 1))]) if shape else rows
    powers = [*motion.lengths, *view.lengths[len(view.coordinates) :]]
    return rows if unit == 1 else rows / np.float_power(unit, powers)


def _bridged(recording: Recording, hold: Hold) -> Array:
    """Outputs with lost samples replaced by the last one, or on the line between their neighbours."""
    if hold != "first":
        return recording.last_outputs
    columns = []
    for column in recording.outputs.T:
        seen = np.isfinite(column)
        columns.append(np.interp(recording.time, recording.time[seen], column[seen]) if seen.any() else column)
    return np.stack(columns, axis=-1)
