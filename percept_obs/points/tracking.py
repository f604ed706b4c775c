"""A Luenberger-type observer follows a recording of many points."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from percept_obs.compile import Array, Flags, Indices, Language
from percept_obs.compile.integrator import EACH
from percept_obs.points.form import PointsForm
from percept_obs.points.kernel import advance, arrays, choose
from percept_obs.points.luenberger import LuenbergerObserver
from percept_obs.points.lyapunov_matrix import LyapunovMatrix
from percept_obs.points.run import PointsRun
from percept_obs.system.motion import Motion
from percept_obs.tracking.following import DoesNotFit, Start, follow, named_start
from percept_obs.tracking.grid import TimeGrid
from percept_obs.validation import checked, positive, require_definite

KEPT = 100
"""Approximate number of samples at which P is kept for its conditions."""


@checked
@dataclass(frozen=True)
class FirstSight:
    """Start of several points: at first sight each is put on its ray.

    The states that no point seen before uses are set by the depth, and P starts anew for these.

    Parameters
    ----------
    depth : float
        In metres.
    absence : float
        Seconds out of sight after which a point begins anew.

    Raises
    ------
    ValueError
        If one of them is not positive, or the depth is not finite.

    See Also
    --------
    track : Takes it as a start.

    Examples
    --------
    >>> from percept_obs import Camera, FirstSight, luenberger, record, track
    >>> from percept_obs.points.scenarios import moving_body
    >>> recording = record(moving_body(2), 2, Camera(0.1))
    >>> run = track(recording, luenberger(recording.view), FirstSight(depth=3.0))
    >>> run.distance[0].round(3).tolist()
    [3.0, 3.0]
    """

    depth: float
    absence: float = math.inf

    def __post_init__(self) -> None:
        positive(depth=self.depth)
        if not self.absence > 0:
            raise ValueError(f"the absence is {self.absence}; it must be positive")


@follow.register
def _follow_points(
    observer: LuenbergerObserver,
    grid: TimeGrid,
    start: FirstSight | Start,
    believed: Motion | None,
    language: Language | None,
) -> PointsRun:
    form, recording, time = observer.form, grid.recording, grid.recording.time
    if believed is not None:
        raise DoesNotFit("this observer believes in the motion of its form; make it of a form with another motion")
    if not form.fits(recording.view):
        raise DoesNotFit(
            f"the observer was made for {form.name}, but the recording shows {recording.view.name}; derive the "
            "observer for the recording's points and surface"
        )
    sight = start if isinstance(start, FirstSight) else None
    named = {} if isinstance(start, FirstSight) else named_start(start, form.state)
    x = np.array([named.get(name, 0.0) for name in form.names])
    if not np.isfinite(x).all():
        raise ValueError(f"the start is not finite; expected {form.states} finite numbers: {', '.join(form.names)}")
    began = np.zeros_like(recording.seen)
    for sighting in recording.sightings(sight.absence) if sight else ():
        began[sighting.first, sighting.point] = True
    # P at every sample would fill the memory; the conditions need it now and then
    kept = np.unique(np.linspace(0, len(time) - 1, KEPT).round().astype(int))
    images = grid.held(filled=False)
    images = np.broadcast_to(images, (len(images), EACH + 1, *images.shape[2:]))
    language = choose(language, len(grid.times) * form.states)
    task = _Task(observer, grid, form.numbers(grid.instants), images, began, sight, kept, language)
    state, P = np.full((len(time), form.states), np.nan), np.zeros((len(kept), form.states, form.states))
    ends = []
    for states, points in _independent(form, observer.P):
        state[:, states], P[:, states[:, None], states], end = _follow(task, states, points, x[states])
        ends.append(end)
    diverged_at = min((end for end in ends if end is not None), default=None)
    if diverged_at is not None:
        state[time >= diverged_at] = np.nan
        P, kept = P[time[kept] < diverged_at], kept[time[kept] < diverged_at]
    observable = np.zeros(len(time), dtype=int)
    return PointsRun(recording, observer, state, state, diverged_at, grid.hold, np.empty(0), observable, began, kept, P)


@dataclass(frozen=True, eq=False)
class _Task:
    """An observer and its tables, for all groups of states."""

    observer: LuenbergerObserver
    grid: TimeGrid
    coefficients: Array
    images: Array
    began: Flags
    sight: FirstSight | None
    kept: Indices
    language: Language


def _independent(form: PointsForm, matrix: LyapunovMatrix) -> list[tuple[Indices, Indices]]:
    """Groups of states, and their points, that neither A, nor C, nor P couples with each other."""
    from scipy.sparse.csgraph import connected_components

    layout, n = form.layout, form.states
    coupled = matrix.couples.copy()
    within = layout.columns < n
    coupled[layout.rows[within], layout.columns[within]] = True
    used = (form.blocks != 0).any(axis=1)
    # the images of a point couple all states that its C_k uses
    coupled |= used.T @ used
    count, label = connected_components(coupled, directed=False)
    owner = label[used.argmax(axis=1)]
    return [(np.flatnonzero(label == k), np.flatnonzero(owner == k)) for k in range(count)]


def _follow(task: _Task, states: Indices, points: Indices, x: Array) -> tuple[Array, Array, float | None]:
    """Estimates of a group at all samples, P at the kept ones, and the time at which the estimate diverged."""
    matrix, grid, index = task.observer.P, task.grid, task.grid.index
    time, block = grid.recording.time, np.ix_(states, states)
    P, n = matrix.start[block].copy(), len(states)
    pull = matrix.forgetting * P - matrix.decrease[block]
    loop = arrays(task.observer.form, states, points)
    law = (matrix.computed, matrix.information, matrix.forgetting, pull)
    stops = np.union1d(task.kept, np.flatnonzero(task.began[:, points].any(axis=1)))
    inverses: Array = np.zeros((1, 1, 1))
    state, at_kept = np.full((len(time), n), np.nan), np.full((len(task.kept), n, n), np.nan)
    # the loop runs from stop to stop, where P is kept or points begin
    for first, last in zip(stops, [*stops[1:], None], strict=True):
        if task.sight is not None and task.began[first, points].any():
            x, P = _begin(task, task.sight, int(first), states, points, x, P)
        at_kept[task.kept == first] = P if matrix.computed else matrix.at(time[first])[0][block]
        state[first] = x
        if last is None:
            break
        steps = slice(index[first], index[last])
        rows = slice(EACH * steps.start, EACH * steps.stop + 1)
        if not matrix.computed and (first == stops[0] or not matrix.constant):
            given = matrix.at(grid.instants[rows])[:, block[0], block[1]]
            require_definite("P at some time", (given + given.swapaxes(1, 2)) / 2)
            inverses = np.asarray(np.linalg.inv(given), dtype=float)
        known = task.coefficients if len(task.coefficients) == 1 else task.coefficients[rows]
        images = task.images[steps][:, :, points]
        path, P, diverged = advance(loop, law, x, P, grid.steps[steps], known, inverses, images, task.language)
        state[first : last + 1] = path[index[first : last + 1] - index[first]]
        x = path[-1]
        if diverged is not None:
            return state, at_kept, float(grid.times[index[first] + diverged])
    return state, at_kept, None


def _begin(
    task: _Task, sight: FirstSight, sample: int, states: Indices, points: Indices, x: Array, P: Array
) -> tuple[Array, Array]:
    """Estimate and P with the points that begin at a sample put on their rays."""
    recording, form = task.grid.recording, task.observer.form
    # a point that was out of sight for longer than the absence counts as never seen
    recent = recording.time[:sample] >= recording.time[sample] - sight.absence
    new = task.began[sample, points]
    others = recording.seen[:sample][recent][:, points].any(axis=0) & ~new
    C = form.blocks[points][:, :, states]
    # states that a point in sight uses are known already, and are left as they are
    free = (C[new] != 0).any(axis=(0, 1)) & ~(C[others] != 0).any(axis=(0, 1))
    if not free.any():
        return x, P
    images = recording.outputs[sample, points[new]]
    goal = form.surface.locate(np.column_stack([images, np.full(len(images), 1 / sight.depth)]))
    rows = C[new].reshape(-1, len(states))
    x, P = x.copy(), P.copy()
    # several states may make up one point, or several points share one: least squares, with the least norm
    x[free] = np.linalg.lstsq(rows[:, free], goal.ravel() - rows[:, ~free] @ x[~free], rcond=None)[0]
    # what P says of states that begin anew, and of their relation to others, is forgotten
    P[free] = P[:, free] = 0
    P[np.ix_(free, free)] = task.observer.P.start[np.ix_(states[free], states[free])]
    return x, P
