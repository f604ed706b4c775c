"""Smoother of a whole run: least squares on samples and motion, each with its noise, and what they tell of scale."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.compile import Array, vectorised
from percept_obs.recording import Recording
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.motion import Motion
from percept_obs.system.state_view import StateView
from percept_obs.tracking.linearised import linearisation, outputs_of, positions
from percept_obs.validation import checked


@dataclass(frozen=True)
class Limits:
    """When a smoother stops, and from where on pictures show where the scale comes from."""

    most: int = 10  # linearisations: about four are needed where there is something to find,
    few: int = 3  # and so many for a point at infinity: what does not explain the pictures then never will
    near: float = 0.05  # deviations by which the end may still move
    stride: float = 0.5  # largest step, as a share of the largest inverse distance or of its usual size
    wide: float = 1e3  # deviation of a hidden coordinate of which nothing is known before
    averaged: int = 15  # samples whose innovations are averaged
    chance: float = 1e-7  # probability that they are so large by chance
    sure: float = 0.05  # relative deviation at which a filter takes over: at 0.1 it went astray in 4 of 24 runs
    pause: float = 0.5  # seconds after which it is asked again


LIMITS = Limits()


@checked
@dataclass(frozen=True, eq=False)
class Belief:
    """Start of a filter: an estimate of all coordinates at the first sample, that sample in it, and its covariance.

    Parameters
    ----------
    estimate : array of shape (n,)
        In the order of the form's coordinates.
    covariance : array of shape (n, n)

    See Also
    --------
    percept_obs.track : Takes it as a start.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, ekf, pinhole, record, scenarios, track
    >>> seen, form = record(scenarios.ma2005_eq35(), 2), PerspectiveSystem(affine(), pinhole()).measure("y1", "y2")
    >>> run = track(seen, ekf(form), Belief(seen.truth[0], 1e-4 * np.eye(3)))
    >>> bool(run.relative_error[-1] < 1e-3)
    True
    """

    estimate: Array
    covariance: Array


@dataclass(frozen=True, eq=False)
class Smoothed:
    """Most likely states at the samples, shape (K, n), the covariance of the last one, and the NIS of each sample.

    It arrived if a further linearisation would change nothing.
    """

    states: Array
    covariance: Array
    nis: Array
    arrived: bool

    @property
    def last(self) -> Belief:
        """The last state."""
        return Belief(self.states[-1], self.covariance)

    @property
    def deviation(self) -> float:
        """Relative standard deviation of the last inverse distance; infinite if that is not positive or not found."""
        inverse = float(self.states[-1, -1]) if self.arrived else 0.0
        return math.sqrt(max(float(self.covariance[-1, -1]), 0.0)) / inverse if inverse > 0 else math.inf


def doubts_of(observer: Any, motion: Motion, unit: float) -> dict[str, float]:
    """Densities of the noise of a motion: those that are known, or that an observer assumes of a signal if larger.

    The observer's are by a unit of length.
    """
    gains = {gain.name: gain.value for gain in observer.gains}
    of = {0: gains.get("turning_noise", 0.0), 1: gains.get("velocity_noise", 0.0) * unit**2}
    assumed = (of[length] for length in motion.lengths)
    least = dict(zip((symbol.name for symbol in motion.parameters), assumed, strict=True))
    return {n: max(least.get(n, 0.0), motion.densities.get(n, 0.0)) for n in least | {**motion.densities}}


def usual_start(form: PartitionedSystem, recording: Recording, noise: Array) -> tuple[Array, Array]:
    """States at the samples, shape (K, n), from which a smoother starts, and the covariance of the first of them.

    They are the samples, the view's guess of the scale, and 0; the noise has the variance of each measured output.
    What is guessed or usual is so by the recording's unit of length.
    """
    view, measured = form.view, positions(form, form.measured)
    usual, guess = (view.usual, view.guess) if isinstance(view, StateView) else ({}, {})
    motion, samples = recording.motion, outputs_of(form, recording)
    known = motion.known(recording.time) / np.float_power(recording.unit, motion.lengths)
    found = vectorised(motion.parameters, [sp.sympify(guess.get(s, 0)) for s in form.coordinates])
    states = np.stack(found(*np.broadcast_to(known, (len(samples), known.shape[1])).T), axis=-1) / recording.scale
    first = samples[np.isfinite(samples).argmax(axis=0), range(len(measured))]
    states[:, measured] = np.where(np.isfinite(samples), samples, first)
    deviations = np.array([usual.get(symbol, 1.0 if usual else LIMITS.wide) for symbol in form.coordinates])
    deviations /= recording.scale
    deviations[measured] = np.sqrt(noise)
    return states, np.diag(deviations**2)


@np.errstate(all="ignore")  # what leaves every range of numbers ends as NaN
def smoothed(
    form: PartitionedSystem,
    recording: Recording,
    states: Array,
    covariance: Array,
    noise: Array,
    doubt: Mapping[str, float],
    most: int = LIMITS.most,
) -> Smoothed:
    """Return the most likely states, from some states at the samples and the covariance of the first of them.

    The noise has the variance of each output, the doubt the densities of the motion's, as `doubts_of` returns them.
    It is an iterated Kalman smoother (Bell, The iterated Kalman smoother as a Gauss-Newton method, SIAM J. Optimization
    4(3), 1994) in the form of Bryson and Frazier, which inverts no covariance of a state.
    """
    along, samples = linearisation(form, recording, doubt), outputs_of(form, recording)
    count, n = states.shape
    begin, whole, measured = states[0], math.sqrt(covariance[-1, -1]), positions(form, form.measured)
    nis, arrived = np.full(count, np.nan), False
    for _ in range(most):
        at, x, P, kept = along(states), begin, covariance, []
        for k in range(count):
            if k:
                Phi = at.transitions[k - 1]
                x = at.arrivals[k - 1] + Phi @ (x - states[k - 1])
                P = Phi @ P @ Phi.T + at.spreads[k - 1]
            rows = measured[at.seen[k]]
            weight = np.linalg.inv(P[np.ix_(rows, rows)] + np.diag(noise[at.seen[k]]))
            gain, left = P[:, rows] @ weight, samples[k, at.seen[k]] - x[rows]
            kept.append((x, P, rows, weight @ left, gain))
            nis[k] = left @ weight @ left if len(rows) else np.nan
            x, P = x + gain @ left, P - gain @ P[rows]
            P = (P + P.T) / 2
        found, pull = np.empty_like(states), np.zeros(n)
        for k in reversed(range(count)):
            before, spread, rows, pulled, gain = kept[k]
            pull[rows] -= pulled + gain.T @ pull
            found[k] = before - spread @ pull
            pull = at.transitions[k - 1].T @ pull if k else pull
        step, size = found - states, max(float(np.abs(states[:, -1]).max()), whole)
        far = float(np.abs(step[:, -1]).max()) / (LIMITS.stride * size) if size else 0.0
        states = states + step / max(far, 1.0)
        ends = np.sqrt(np.maximum(np.diagonal(P), 0.0))
        arrived = far <= 1 and bool((np.abs(step[-1]) <= LIMITS.near * ends + np.finfo(float).eps).all())
        if arrived or not np.isfinite(states).all():
            break
    return Smoothed(states, P, nis, arrived)


def shows_scale(form: PartitionedSystem, recording: Recording, noise: Array, doubt: Mapping[str, float]) -> int | None:
    """Return the first sample at which a point at infinity does not explain the pictures, or None.

    There all coordinates are 0 that have the scale in them.  A camera at constant speed sees nothing else, whatever
    the distance: in a filter that knows its biases nearly, such pictures would speak for a far point.
    """
    from scipy.stats import chi2

    states, covariance = usual_start(form, recording, noise)
    at_infinity = [form.coordinates.index(s) for s in getattr(form.view, "guess", ()) or form.coordinates[-1:]]
    states[:, at_infinity] = covariance[at_infinity] = 0.0
    found = smoothed(form, recording, states, covariance, noise, doubt, LIMITS.few).nis[1:]
    number = min(LIMITS.averaged, len(found))
    means = np.convolve(np.nan_to_num(found), np.ones(number) / number, "valid")
    size = number * len(form.measured)
    too_large = np.flatnonzero(means > chi2.isf(LIMITS.chance, size) / number)
    return int(too_large[0]) + number if len(too_large) else None


def once_observable(
    form: PartitionedSystem, recording: Recording, noise: Array, doubt: Mapping[str, float]
) -> tuple[int, Belief] | None:
    """Return the first sample from which on a filter finds the scale, and its start there; None if there is none.

    It uses no later sample.
    """
    first = shows_scale(form, recording, noise, doubt)
    if first is None:
        return None
    time = recording.time
    for end in np.arange(time[first], time[-1], LIMITS.pause):
        part = recording.between(time[0], end)
        found = smoothed(form, part, *usual_start(form, part, noise), noise, doubt)
        if found.deviation < LIMITS.sure and shows_scale(form, part, noise, doubt) is not None:
            return len(part.time) - 1, found.last
    return None
