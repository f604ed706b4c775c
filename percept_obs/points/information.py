"""Information in the samples about many points at the end of a run, by least squares."""

from __future__ import annotations

import math
from itertools import accumulate

import numpy as np

from percept_obs.compile import Array, Flags
from percept_obs.compile.integrator import by_step, instants, step
from percept_obs.points.form import PointsForm
from percept_obs.recording import Recording
from percept_obs.tracking.information import LIMITS, Fit, looks_like_noise

LARGEST_TABLE = 4_000_000
"""Most entries of the table of transitions; of more samples, every so many are taken."""

PASSES = 4
"""Passes of least squares, each weighted by the distances that the one before found."""


def many_points(form: PointsForm, recording: Recording) -> Fit:
    """Least squares on the images: B C (Phi x + c) = 0 for the state x at the end, over the distance of each point."""

    def fit(first: int, guesses: list[Array]) -> tuple[Array, float, float, float]:
        every = max(1, (len(recording.time) - first) * form.states**2 // LARGEST_TABLE)
        used = np.arange(len(recording.time) - 1, first - 1, -every)  # backwards from the end
        outputs = recording.outputs[used]
        maps = transitions(form, recording.time[used])
        back = np.stack([*accumulate(maps, lambda at, map_: map_ @ at, initial=np.eye(form.states + 1))])[:, :-1]
        m = outputs.shape[-1]
        rows = form.rows(outputs).reshape(len(used), form.points, m, form.states) @ back[:, None]
        l = form.surface_numbers[1]
        x, finest = np.zeros(form.states), LIMITS.finest * float(np.nanmax(np.abs(outputs), initial=LIMITS.finest))
        weight = np.ones((len(used), form.points))
        for _ in range(PASSES):
            flat = (weight[..., None, None] * rows).reshape(-1, form.states + 1)
            product = flat.T @ flat
            M, b = product[:-1, :-1], product[:-1, -1]
            values, vectors = np.linalg.eigh(M)
            determined = values > LIMITS.rounding**2 * values[-1]
            x = -vectors[:, determined] @ ((vectors[:, determined].T @ b) / values[determined])
            depth = form.locate(back @ np.append(x, 1.0)) @ l
            seen = np.isfinite(outputs).all(axis=-1)
            if not (depth[seen] > 0).all():
                break
            weight = 1 / np.where(seen, depth, 1.0)
        free = m * int(seen.sum()) - form.states
        residual = product[-1, -1] + 2 * x @ b + x @ M @ x
        own = recording.noise_variance or 0.0
        shared = (recording.effective_variance or 0.0) - own  # by all points, so that many on one body do not lessen it
        known_noise = math.sqrt(own + shared * max(1.0, 3 * form.points / form.states))
        left = math.sqrt(max(residual, 0.0) / max(free, 1))
        if free < 1 or not (depth[seen] > 0).all():
            return x, math.inf, 0.0, 0.0
        worst = _worst(form, x, values, vectors, determined, max(left, finest, known_noise))
        alike = not known_noise or looks_like_noise(left, 0.0, known_noise)
        return x, worst, 0.0 if alike else worst * math.sqrt(free), 0.0

    return fit


def transitions(form: PointsForm, time: Array) -> Array:
    """Maps of the state and 1 from each time to the next, shape (T - 1, n + 1, n + 1), by one step each."""
    places, n = instants(time), form.states
    rate = np.zeros((len(places), n + 1, n + 1))
    rate[:, :n, :n], rate[:, :n, n] = form.coefficients(places)
    rate = by_step(rate)
    return step(np.eye(n + 1), np.diff(time)[:, None, None], lambda instant, map_: rate[:, instant] @ map_)


def _worst(form: PointsForm, x: Array, values: Array, vectors: Array, determined: Flags, noise: float) -> float:
    """Standard deviation of the position of the point that is known least, relative to its distance."""
    spread = np.linalg.norm(form.blocks @ vectors, axis=1)  # of each point along each direction of the state
    if (spread[:, ~determined] > LIMITS.rounding).any():
        return math.inf
    off = noise * np.sqrt((spread[:, determined] ** 2 / values[determined]).sum(axis=1))
    return float((off / np.linalg.norm(form.locate(x), axis=-1)).max())
