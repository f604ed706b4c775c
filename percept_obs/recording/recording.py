"""Recordings: what a camera leaves behind, and the grid of steps between its samples."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import BehindCamera, ImagingSurface, pinhole
from percept_obs.system.view import View

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Recording:
    """Samples of a point's image, and what is known about the camera's and the point's motion.

    Parameters
    ----------
    time : array of shape (K,)
        Seconds, strictly increasing.
    outputs : array of shape (K, m)
        Samples of the image coordinates; NaN where one was lost.  The first row is complete.
    names : tuple of str
        Names of the outputs, such as ("y1", "y2").
    surface : View
        Where they were seen: an imaging surface, or what was derived from several image points.
    motion : Motion
        Known motion, with numbers for all times.
    truth : array of shape (K, n), optional
        True coordinates of the surface: image coordinates and inverse distance.
    signal : function of times, optional
        The outputs without noise at any time, shape (T, m), if they are known.
    noise_variance : float, optional
        Variance of the noise in each output.
    distances : mapping of names to arrays of shape (K,), optional
        Independent measurements of the depth or range in metres.
    source : str
        Where the recording comes from, its settings and its seed.
    """

    time: Array
    outputs: Array
    names: tuple[str, ...]
    surface: View
    motion: Motion
    truth: Array | None = None
    signal: Callable[[Array], Array] | None = None
    noise_variance: float | None = None
    distances: Mapping[str, Array] = field(default_factory=dict)
    source: str = ""

    def __post_init__(self) -> None:
        time = _readonly(self.time)
        outputs = _readonly(self.outputs)
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "outputs", outputs)
        object.__setattr__(self, "names", tuple(self.names))
        if time.ndim != 1 or len(time) < 2:
            raise ValueError(f"the recording has times of shape {time.shape}; at least two samples are needed")
        if outputs.shape != (len(time), len(self.names)) or not self.names:
            raise ValueError(
                f"the recording has outputs of shape {outputs.shape}; expected {(len(time), len(self.names))}: "
                f"one row a time, one column for each of {', '.join(self.names) or 'at least one name'}"
            )
        if not np.isfinite(time).all() or not (np.diff(time) > 0).all():
            k = int(np.argmin(np.diff(time) > 0)) if np.isfinite(time).all() else int(np.argmin(np.isfinite(time)))
            raise ValueError(
                f"the recording's times must increase strictly and be finite; look at row {k + 1}, "
                f"{time[k]!r} s: sort the rows and remove repeated ones"
            )
        known = [symbol.name for symbol in self.surface.image_coordinates]
        if len(set(self.names)) != len(self.names) or not set(self.names) <= set(known):
            raise ValueError(
                f"the recording names the outputs {', '.join(self.names)}; those of the {self.surface.name} are "
                f"{', '.join(known)}, each once"
            )
        valueless = [str(symbol) for symbol in self.surface.parameters if symbol not in self.surface.values]
        if valueless:
            raise ValueError(
                f"the {self.surface.name} has no values for {', '.join(valueless)}; give them numbers first"
            )
        if np.isinf(outputs).any() or not np.isfinite(outputs[0]).all():
            raise ValueError("outputs are finite, or NaN where a sample was lost; the first row must be complete")
        if self.truth is not None:
            truth = _readonly(self.truth)
            object.__setattr__(self, "truth", truth)
            if truth.shape != (len(time), len(self.surface.coordinates)) or not np.isfinite(truth).all():
                raise ValueError(
                    f"the truth has shape {truth.shape}; expected {(len(time), len(self.surface.coordinates))}, "
                    f"finite: {', '.join(map(str, self.surface.coordinates))}"
                )
            inverse = self.surface.inverse(truth)
            if not (inverse > 0).all():
                k = int(np.argmin(inverse > 0))
                raise BehindCamera(
                    f"the true inverse distance is {inverse[k]:.4g} at {time[k]:.4g} s; only points in front of the "
                    "camera, at positive inverse distances, are seen"
                )
        distances = {name: _readonly(values) for name, values in self.distances.items()}
        object.__setattr__(self, "distances", MappingProxyType(distances))
        for name, values in distances.items():
            if values.shape != time.shape or not (np.isfinite(values) & (values > 0)).all():
                raise ValueError(f"the distances {name!r} must be {len(time)} positive numbers, one a sample")
        self.motion.known(time[[0, -1]])

    @property
    def imaging_surface(self) -> ImagingSurface:
        """The surface, where rays and distances are needed.

        Raises
        ------
        ValueError
            If the recording was not seen on an imaging surface.
        """
        if not isinstance(self.surface, ImagingSurface):
            raise ValueError(f"this needs image coordinates alone, but the recording shows the {self.surface.name}")
        return self.surface

    @property
    def points(self) -> Array | None:
        """True positions in metres, shape (K, 3), if the truth is known."""
        return None if self.truth is None else self.surface.locate(self.truth)

    def between(self, begin: float, end: float) -> Recording:
        """The part of the recording with begin <= time <= end."""
        keep = (self.time >= begin) & (self.time <= end)
        return replace(
            self,
            time=self.time[keep],
            outputs=self.outputs[keep],
            truth=None if self.truth is None else self.truth[keep],
            distances={name: values[keep] for name, values in self.distances.items()},
        )

    @classmethod
    def from_csv(
        cls,
        path: str | os.PathLike[str],
        motion: Motion,
        surface: ImagingSurface | None = None,
        time: str = "time",
    ) -> Recording:
        """Read a recording from a table with a header.

        Parameters
        ----------
        path : path
            A column of times in seconds, columns named like the outputs (y1, y2), and if the truth is known a
            column with the name of the inverse distance (y3 for the pinhole) beside all of the outputs.  Empty
            cells are lost samples.
        motion : Motion
            Known motion, with numbers.
        surface : ImagingSurface, optional
            The pinhole when left out.
        time : str
            Name of the column of times.

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        ValueError
            If a column is missing, a cell is not a number, or the rows are no recording.
        """
        import pandas as pd

        surface = surface or pinhole()
        rows = pd.read_csv(path)
        names = tuple(s.name for s in surface.image_coordinates if s.name in rows)
        if time not in rows or not names:
            raise ValueError(
                f"{os.fspath(path)} has the columns {', '.join(map(str, rows.columns))}; it needs {time!r} and "
                f"at least one of {', '.join(s.name for s in surface.image_coordinates)}"
            )
        inverse = surface.inverse_distance.name
        try:
            values = rows[[time, *names, *([inverse] if inverse in rows else [])]].to_numpy(dtype=float)
        except ValueError as error:
            raise ValueError(f"{os.fspath(path)} has a cell that is not a number: {error}") from None
        if not len(values):
            raise ValueError(f"{os.fspath(path)} has a header and no rows; at least two samples are needed")
        complete = inverse in rows and len(names) == len(surface.image_coordinates)
        return cls(
            values[:, 0],
            values[:, 1 : 1 + len(names)],
            names,
            surface,
            motion,
            truth=values[:, 1:] if complete else None,
            source=os.fspath(path),
        )


def step_grid(times: Array, longest: float) -> tuple[Array, NDArray[np.int_]]:
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


def halves(grid: Array) -> Array:
    """The grid with the middles of its steps put between."""
    both = np.empty(2 * len(grid) - 1)
    both[::2] = grid
    both[1::2] = (grid[:-1] + grid[1:]) / 2
    return both


def _readonly(values: ArrayLike) -> Array:
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array
