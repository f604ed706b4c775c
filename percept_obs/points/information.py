"""Information in the samples about many points at the end of a run, by least squares."""

from __future__ import annotations

import math
from itertools import accumulate

import numpy as np

from percept_obs.compile import Array, Flags
from percept_obs.compile.integrator import by_step, instants, step
from percept_obs.points.form import PointsForm
from percept_obs.recording import Recording
from percept_obs.tracking.information import FINEST, ROUNDING, Fit

LARGEST_TABLE = 4_000_000
"""Largest number of entries of the table of transitions; with more samples only every second, third, ... is used."""

PASSES = 4
"""Number of passes of least squares, each weighted by the distances that the one before found."""


def many_points(form: PointsForm, recording: Recording) -> Fit:
    """Least squares on the images: B C (Phi x + c) = 0 for the state x at the end, over the distance of each point."""

    def fit(first: int, guesses: list[Array]) -> tuple[Array, float, Array, float]:
        every = max(1, (len(recording.time) - first) * form.states**2 // LARGEST_TABLE)
        used = np.arange(len(recording.time) - 1, first - 1, -every)  # backwards from the end
        outputs = recording.outputs[used]
        maps = transitions(form, recording.time[used])
        # products of the steps: from the end back to each sample, of (x, 1)
        back = np.stack([*accumulate(maps, lambda at, map_: map_ @ at, initial=np.eye(form.states + 1))])[:, :-1]
        m = outputs.shape[-1]
        rows = form.rows(outputs).reshape(len(used), form.points, m, form.states) @ back[:, None]
        l = form.surface_numbers[1]
        x, finest = np.zeros(form.states), FINEST * float(np.nanmax(np.abs(outputs), initial=FINEST))
        weight = np.ones((len(used), form.points))
        for _ in range(PASSES):
            flat = (weight[..., None, None] * rows).reshape(-1, form.states + 1)
            product = flat.T @ flat
            M, b = product[:-1, :-1], product[:-1, -1]
            values, vectors = np.linalg.eigh(M)
            # directions that no image shows are left at 0; `_worst` says if a point depends on them
            determined = values > ROUNDING**2 * values[-1]
            x = -vectors[:, determined] @ ((vectors[:, determined].T @ b) / values[determined])
            depth = form.locate(back @ np.append(x, 1.0)) @ l
            seen = np.isfinite(outputs).all(axis=-1)
            if not (depth[seen] > 0).all():
                break
            # B C x is the error of an image times the distance, which is known only after a pass
            weight = 1 / np.where(seen, depth, 1.0)
        free = m * int(seen.sum()) - form.states
        residual = product[-1, -1] + 2 * x @ b + x @ M @ x
        own = recording.noise_variance or 0.0
        shared = (recording.effective_variance or 0.0) - own  # by all points, so that many on one body do not lessen it
        known_noise = math.sqrt(own + shared * max(1.0, 3 * form.points / form.states))
        # no camera is better than `finest`, and residuals of few samples may be small by chance
        noise = max(math.sqrt(max(residual, 0.0) / free), finest, known_noise) if free > 0 else math.nan
        if free < 1 or not (depth[seen] > 0).all():
            return x, math.inf, np.full(m, noise), 0.0
        return x, _worst(form, x, values, vectors, determined, noise), np.full(m, noise), 0.0

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
    if (spread[:, ~determined] > ROUNDING).any():
        return math.inf
    off = noise * np.sqrt((spread[:, determined] ** 2 / values[determined]).sum(axis=1))
    return float((off / np.linalg.norm(form.locate(x), axis=-1)).max())
