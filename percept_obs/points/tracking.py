"""A Luenberger-type observer follows a recording of many points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from percept_obs.points.form import PointsForm
from percept_obs.points.kernel import Language, advance, arrays, choose
from percept_obs.points.luenberger import LuenbergerObserver
from percept_obs.points.lyapunov_matrix import Weight
from percept_obs.points.recording import PointsRecording
from percept_obs.points.run import PointsRun
from percept_obs.recording import halves, step_grid
from percept_obs.tracking.following import LONGEST_STEP, DoesNotFit
from percept_obs.tracking.run import Hold

Array = NDArray[np.float64]

KEPT = 100
"""Samples, about, at which P is kept and its conditions are looked at."""


def track_points(
    recording: PointsRecording,
    observer: LuenbergerObserver,
    start: Sequence[float] | None = None,
    depth: float | None = None,
    absence: float = math.inf,
    hold: Hold = "zero",
    longest_hold: float = math.inf,
    step: float = LONGEST_STEP,
    language: Language | None = None,
) -> PointsRun:
    """Let a Luenberger-type observer follow a recording of many points.

    Parameters
    ----------
    recording : PointsRecording
    observer : LuenbergerObserver
        With as many points as the recording.
    start : n numbers, optional
        The estimate at the first sample; 0 when left out, for where the error converges it does so from any start.
    depth : float, optional
        At first sight a point is put on its ray at this depth, in metres, by the states that no point seen before uses,
        and P starts anew for these.  Left out, points have no starts of their own.
    absence : float
        Seconds out of sight after which it is a first sight again.
    hold : "zero", "first" or "exact"
        What the observer takes for the images between samples, as in `track`.  A point whose sample was lost is not
        seen until its next one.
    longest_hold : float
        Seconds after a sample from which on the point is not seen until its next one.
    step : float
        Longest integration step in seconds; a sample always ends one.
    language : "python" or "numba", optional
        Left out, numba if it is installed; a short run does not wait until it has compiled.

    Returns
    -------
    PointsRun

    Raises
    ------
    DoesNotFit
        If numbers of points, surfaces or the hold do not fit.
    ValueError
        If start, depth, a time or the step make no sense, or P becomes singular.

    Notes
    -----
    The corrections grow with 1 + |y|^2.  A point that passes close beside the camera has images without bound, so that
    no step is short enough: record it with a `view`.
    """
    form, weight, time = observer.form, observer.weight, recording.time
    _refuse_misfits(recording, form, hold, depth, absence, longest_hold, step)
    x = np.zeros(form.states) if start is None else np.array(start, dtype=float)
    if x.shape != (form.states,) or not np.isfinite(x).all():
        raise ValueError(
            f"the start has shape {x.shape}; expected {form.states} finite numbers: {', '.join(form.names)}"
        )

    grid, index = step_grid(time, step)
    began = np.zeros_like(recording.seen) if depth is None else _first_sights(recording, absence)
    kept = np.unique(np.linspace(0, len(time) - 1, KEPT).round().astype(int))
    task = _Task(
        recording,
        form,
        weight,
        grid,
        index,
        form.values(halves(grid)),
        _held(recording, grid, index, hold, longest_hold),
        began,
        absence,
        depth,
        kept,
        choose(language, len(grid) * form.states),
    )
    state, P = np.full((len(time), form.states), np.nan), np.zeros((len(kept), form.states, form.states))
    ends = []
    for states, points in _independent(form, weight):
        state[:, states], P[:, states[:, None], states], end = _follow(task, states, points, x[states])
        ends.append(end)
    diverged_at = min((end for end in ends if end is not None), default=None)
    if diverged_at is not None:
        state[time >= diverged_at] = np.nan
        P, kept = P[time[kept] < diverged_at], kept[time[kept] < diverged_at]
    return PointsRun(recording, observer, state, began, kept, P, diverged_at, hold)


@dataclass(frozen=True, eq=False)
class _Task:
    """What is to be followed, at which steps."""

    recording: PointsRecording
    form: PointsForm
    weight: Weight
    grid: Array
    index: NDArray[np.int_]
    coefficients: Array
    held: Array
    began: NDArray[np.bool_]
    absence: float
    depth: float | None
    kept: NDArray[np.intp]
    language: Language


def _independent(form: PointsForm, weight: Weight) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """States, and the points that they make, that nothing couples with the others: neither A, nor C, nor P."""
    layout, n = form.layout, form.states
    coupled = weight.couples.copy()
    within = layout.columns < n
    coupled[layout.rows[within], layout.columns[within]] = True
    used = (form.blocks != 0).any(axis=1)
    coupled |= used.T @ used
    count, label = connected_components(coupled, directed=False)
    owner = np.where(used.any(axis=1), label[used.argmax(axis=1)], -1)
    return [(np.flatnonzero(label == k), np.flatnonzero(owner == k)) for k in range(count)]


def _follow(
    task: _Task, states: NDArray[np.intp], points: NDArray[np.intp], x: Array
) -> tuple[Array, Array, float | None]:
    """Estimates at all samples, P at the kept ones, and when the estimate diverged."""
    weight, time, grid, index = task.weight, task.recording.time, task.grid, task.index
    block = np.ix_(states, states)
    P, n = weight.start[block].copy(), len(states)
    pull = weight.forgetting * P - weight.decrease[block]
    loop = arrays(task.form, states, points)
    law = (weight.computed, weight.information, weight.forgetting, pull)
    stops = np.union1d(task.kept, np.flatnonzero(task.began[:, points].any(axis=1)))
    inverses = np.zeros((1, 1, 1))
    state, at_kept = np.full((len(time), n), np.nan), np.full((len(task.kept), n, n), np.nan)
    for first, last in zip(stops, [*stops[1:], None], strict=True):
        if task.began[first, points].any():
            x, P = _begin(task, int(first), states, points, x, P)
        at_kept[task.kept == first] = P if weight.computed else weight.at(time[first])[0][block]
        state[first] = x
        if last is None:
            break
        part = slice(index[first], index[last])
        rows = slice(2 * part.start, 2 * part.stop + 1)
        if not weight.computed and (first == stops[0] or not weight.constant):
            inverses = _inverses(weight.at(halves(grid)[rows])[:, block[0], block[1]])
        path, P, diverged = advance(
            loop,
            law,
            x,
            P,
            np.diff(grid)[part],
            task.coefficients if len(task.coefficients) == 1 else task.coefficients[rows],
            inverses,
            task.held[part][:, :, points],
            task.language,
        )
        state[first : last + 1] = path[index[first : last + 1] - index[first]]
        x = path[-1]
        if diverged is not None:
            return state, at_kept, float(grid[index[first] + diverged])
    return state, at_kept, None


def _refuse_misfits(
    recording: PointsRecording,
    form: PointsForm,
    hold: str,
    depth: float | None,
    absence: float,
    longest_hold: float,
    step: float,
) -> None:
    seen = recording.form
    if form.points != seen.points or not form.surface.fits(seen.surface):
        raise DoesNotFit(
            f"the observer was made for {form.points} points on the {form.surface.name}, but the recording has "
            f"{seen.points} on the {seen.surface.name}; derive the observer for the recording's points and surface"
        )
    if hold not in ("zero", "first", "exact"):
        raise ValueError(f"the hold {hold!r} is none of 'zero', 'first' and 'exact'")
    if hold == "exact" and recording.signal is None:
        raise DoesNotFit("the exact signal between samples is known in simulations only; hold them 'zero' or 'first'")
    for name, value in (("depth", depth), ("absence", absence), ("longest_hold", longest_hold), ("step", step)):
        if value is not None and not value > 0:
            raise ValueError(f"the {name} is {value}; it must be positive")
    if not math.isfinite(step):
        raise ValueError(f"the step is {step} s; it must be finite")


def _held(recording: PointsRecording, grid: Array, index: NDArray[np.int_], hold: Hold, longest: float) -> Array:
    """Images at the start, the middle and the end of every step, shape (N, 3, p, m); NaN where a point is not seen."""
    outputs, time = recording.outputs, recording.time
    interval = np.repeat(np.arange(len(time) - 1), np.diff(index))
    before, after = outputs[interval], outputs[interval + 1]
    if hold == "zero":
        held = np.repeat(before[:, None], 3, axis=1)
    elif hold == "first":
        begin, length = time[interval], np.diff(time)[interval]
        places = np.stack([grid[:-1], (grid[:-1] + grid[1:]) / 2, grid[1:]], axis=1)
        share = ((places - begin[:, None]) / length[:, None])[..., None, None]
        held = (1 - share) * before[:, None] + share * after[:, None]
    else:
        assert recording.signal is not None
        exact = recording.signal(halves(grid))
        held = np.stack([exact[:-1:2], exact[1::2], exact[2::2]], axis=1)
        held = np.where(np.isnan(before[:, None]), np.nan, held)
    since = grid[:-1] - time[interval] if hold != "first" else np.diff(time)[interval]
    held[since >= longest] = np.nan
    return np.asarray(held)


def _first_sights(recording: PointsRecording, absence: float) -> NDArray[np.bool_]:
    """Where a point is seen for the first time, or again after an absence, shape (K, p)."""
    began = np.zeros_like(recording.seen)
    for sighting in recording.sightings(absence):
        began[sighting.first, sighting.point] = True
    return began


def _begin(
    task: _Task, sample: int, states: NDArray[np.intp], points: NDArray[np.intp], x: Array, P: Array
) -> tuple[Array, Array]:
    """The estimate and P with the points that begin at a sample on their rays."""
    recording, form = task.recording, task.form
    recent = recording.time[:sample] >= recording.time[sample] - task.absence
    new = task.began[sample, points]
    others = recording.seen[:sample][recent][:, points].any(axis=0) & ~new
    C = form.blocks[points][:, :, states]
    free = (C[new] != 0).any(axis=(0, 1)) & ~(C[others] != 0).any(axis=(0, 1))
    if not free.any() or task.depth is None:
        return x, P
    images = recording.outputs[sample, points[new]]
    goal = form.surface.locate(np.column_stack([images, np.full(len(images), 1 / task.depth)]))
    rows = C[new].reshape(-1, len(states))
    x, P = x.copy(), P.copy()
    x[free] = np.linalg.lstsq(rows[:, free], goal.ravel() - rows[:, ~free] @ x[~free], rcond=None)[0]
    P[free] = P[:, free] = 0
    P[np.ix_(free, free)] = task.weight.start[np.ix_(states[free], states[free])]
    return x, P


def _inverses(P: Array) -> Array:
    try:
        return np.asarray(np.linalg.inv(P))
    except np.linalg.LinAlgError:
        raise ValueError("P is singular at some time; it must stay positive definite") from None
