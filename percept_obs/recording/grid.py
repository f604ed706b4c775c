"""The grid of steps between samples."""

from __future__ import annotations

import numpy as np

from percept_obs.compile import Array, Indices


def step_grid(times: Array, longest: float) -> tuple[Array, Indices]:
    """Divide the intervals between times into equal steps no longer than given.

    Returns
    -------
    grid : array
        Times of all steps' ends, from ``times[0]`` to ``times[-1]``.
    index : array of shape (len(times),)
        Where the times stand in the grid.
    """
    intervals = np.diff(times)
    counts = np.where(intervals > 0, np.maximum(1, np.ceil(intervals / longest - 1e-9)), 0).astype(int)
    index = np.concatenate([[0], np.cumsum(counts)])
    owner = np.repeat(np.arange(len(counts)), counts)
    inside = np.arange(index[-1]) - index[owner] + 1
    grid = np.concatenate([times[:1], times[owner] + intervals[owner] * (inside / counts[owner])])
    grid[index] = times
    return grid, index
