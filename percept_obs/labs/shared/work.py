"""Limits on what Python computes for the sentences of a lab, so that the kernel answers within about a second."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from percept_obs.compile import Array, vectorised
from percept_obs.labs.shared.samples import is_sampled, times_of
from percept_obs.labs.shared.typed_motion import INSTANTS
from percept_obs.recording.camera import TOO_SHORT
from percept_obs.system.motion import Motion

MOST_WORK = 300_000
"""Steps times states that Python computes in about a second."""

CALL_WORK = 16
"""Cost of one call of a varying motion by scipy's solver, in the unit of `MOST_WORK`, for a recording's two paths."""

CALLS_PER_SAMPLE = 15
"""Least calls of a sampled motion by a solver between two samples."""

MOMENT = 1e-5
"""Seconds over which a rate is differenced, far less than the period of any motion that Python can follow."""


def motion_work(motion: Motion, duration: float, period: float) -> float:
    """Cost of moving a point for `duration` seconds and sampling it every `period`, in the unit of `MOST_WORK`."""
    rows = motion.known(np.linspace(0, duration, INSTANTS))
    A = np.stack(vectorised(motion.parameters, tuple(motion.A))(*rows.T), axis=-1)
    fastest = float(np.abs(A.reshape(-1, 3, 3)).sum(axis=2).max())
    work = 0.4 * duration * (1 / period + 4 * fastest)
    if motion.signal is None or motion.signal.constant:
        return work
    return work + CALL_WORK * solver_calls(motion.known, duration, fastest, motion)


def solver_calls(known: Callable[[Array], Array] | None, duration: float, fastest: float, motion: Motion) -> float:
    """Estimate how often a solver calls a varying motion over a duration in seconds, at least some times a sample.

    `known` gives the numbers that may swing fast, and `fastest` is the largest sum of the absolute values of a row of
    A.
    """
    frequency = 0.0
    if known is not None:
        times = np.linspace(0, duration, INSTANTS)
        rows = known(times)
        rates = np.abs(known(times[:-1] + MOMENT) - rows[:-1]).max(axis=0) / MOMENT
        frequency = float((rates / np.maximum(np.abs(rows).max(axis=0), 1e-12)).max())  # about, in rad/s
    samples = int((times_of(motion) < duration).sum()) if is_sampled(motion) else 0
    return max(duration * (60 + 47 * fastest + 18 * frequency), CALLS_PER_SAMPLE * samples)


def too_much(work: float, duration: float = np.inf, period: float = 0.0) -> str:
    """Reason why Python does not compute a run; empty if it does."""
    if duration < period:
        return TOO_SHORT.format(duration=f"{duration:g}", period=f"{period:g}")
    slower = "slow it down, lengthen the period or shorten the duration"
    return f"Python says nothing on so fast or long a motion; {slower}." if work > MOST_WORK else ""


def within_reach(steps: float, states: Mapping[str, float], before: float = 0.0) -> tuple[list[str], list[str]]:
    """Names of the observers that Python has time to run, by their numbers of states, and a sentence on the others."""
    names, work = [], before
    for name, count in states.items():
        if work + steps * count <= MOST_WORK:
            names.append(name)
            work += steps * count
    beyond = ", ".join(name.replace("_", " ") for name in states if name not in names)
    if not beyond:
        return names, []
    remedy = "show fewer observers, lengthen the period or shorten the duration"
    return names, [f"Python says nothing on {beyond}, for {steps:.2g} steps would take it too long; {remedy}."]
