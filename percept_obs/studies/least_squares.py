"""Moving-window least squares: the batch estimate that observers are compared with."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from percept_obs.compile import vectorised
from percept_obs.recording import Recording
from percept_obs.recording.reckoning import maps_between
from percept_obs.system.forms import PartitionedSystem
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.signal import slack_of
from percept_obs.tracking.run import Run
from percept_obs.validation import checked, positive, travels

__all__ = ["moving_window_least_squares"]

LARGEST_CONDITION = 1e6
"""Condition number of the normal equations beyond which a window determines no point."""


@travels
@dataclass(frozen=True, eq=False)
class LeastSquares:
    """Least squares in the place of a run's observer."""

    recording: Recording
    window: float
    covariance = None
    gains = ()
    unobservable = ()

    @property
    def name(self) -> str:
        """Name with the length of the window."""
        return f"least squares on {self.window:g} s"

    @cached_property
    def form(self) -> PartitionedSystem:
        """Form with all image coordinates measured."""
        recording = self.recording
        return PerspectiveSystem(recording.motion, recording.imaging_surface).measure(*recording.names)


@checked
def moving_window_least_squares(recording: Recording, window: float = 2.0) -> Run:
    """Return a run of least-squares positions at the end of a window, from all samples in it.

    The point of each sample lies on its ray: the cross product of the ray and the position is zero.  With the known
    affine motion every position is affine in the one at the window's end, so that this is a linear problem.  Estimates
    are 0, so that they have no distance, where the window determines no point in front of the camera.

    Parameters
    ----------
    recording : Recording
        With all image coordinates of its surface.
    window : float
        Seconds.

    Raises
    ------
    ValueError
        If an image coordinate was not recorded or the window is not positive.

    See Also
    --------
    track : Runs an observer.

    Notes
    -----
    Between samples the motion is followed in steps of 1/120 s, each with the coefficients of its middle.

    Examples
    --------
    >>> from percept_obs import Camera, record, scenarios
    >>> run = moving_window_least_squares(record(scenarios.ma2005_eq35(), 3, Camera(0.05)), window=1.0)
    >>> bool(run.relative_error[-1] < 1e-6)
    True
    """
    surface = recording.imaging_surface
    names = tuple(symbol.name for symbol in surface.image_coordinates)
    if recording.names != names:
        raise ValueError(f"least squares need the outputs {', '.join(names)}; there are {', '.join(recording.names)}")
    positive(window=window)
    time, count = recording.time, len(recording.time)
    rays = np.stack(vectorised(surface.image_coordinates, surface.ray, surface.values)(*recording.outputs.T), axis=-1)
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    across_ray = np.nan_to_num(np.eye(3) - rays[:, :, None] * rays[:, None, :])  # a lost sample adds nothing
    spans = np.zeros((count, 4, 4))  # squares of the unknown (X, 1) from the last 1, 2, 4, ... samples before each
    spans[:, :3, :3] = np.swapaxes(across_ray, 1, 2) @ across_ray
    back = np.concatenate([np.eye(4)[None], maps_between(recording.motion, time[::-1])[::-1]])  # over such a span
    samples = np.arange(count)
    counts = samples + 1 - np.searchsorted(time, time - window - slack_of(time))
    squares, reached = np.zeros((count, 4, 4)), samples.copy()
    to_reached = np.broadcast_to(np.eye(4), (count, 4, 4)).copy()
    size = 1
    while size <= counts.max():
        # a window is put together of such spans, as the binary digits of its number of samples say
        ends = np.flatnonzero(counts & size)
        maps, at = to_reached[ends], reached[ends]
        squares[ends] += np.swapaxes(maps, 1, 2) @ spans[at] @ maps
        to_reached[ends], reached[ends] = back[at] @ maps, at - size
        earlier = np.maximum(samples - size, 0)
        spans = spans + np.swapaxes(back, 1, 2) @ spans[earlier] @ back
        back = back[earlier] @ back
        size *= 2
    values = np.linalg.eigvalsh(squares[:, :3, :3])
    good = np.flatnonzero(values[:, 0] * LARGEST_CONDITION > values[:, -1])
    points = np.linalg.solve(squares[good, :3, :3], -squares[good, :3, 3:])[:, :, 0]
    in_front = surface.distances(points) > 0
    estimate = np.zeros((count, len(surface.coordinates)))
    estimate[good[in_front]] = surface.project(points[in_front])
    always = np.zeros(count, dtype=int)
    return Run(recording, LeastSquares(recording, window), estimate, estimate, None, "zero", np.empty(0), always)
