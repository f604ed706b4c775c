"""Images of a point when its motion is known with an error: misaligned axes, and a scale that drifts."""

from __future__ import annotations

from collections.abc import Callable
from itertools import accumulate

import numpy as np

from percept_obs.compile import Array, vectorised
from percept_obs.compile.integrator import LONGEST_STEP, by_step, instants, step, step_grid
from percept_obs.recording import Recording
from percept_obs.system.motion import coefficients
from percept_obs.system.surfaces import POINT

DOUBTS = (0.1, 0.01, 0.01, 0.01)
"""Standard deviations of the scale's drift over a recording, and of the translation's direction in rad, three axes.

The poses of a hand-held camera or a car hardly ever have axes that are known to better than half a degree.
"""

FAR = 1e3
"""Outputs of a point that is not seen, beyond what any camera sees, so that no fit likes to go there."""

SPLIT = 500
"""Steps into which a window is divided at most, besides those that end at samples: more take long, and add nothing."""


def images_backwards(recording: Recording, first: int, columns: list[int]) -> Callable[[Array], Array]:
    """Return a function from the coordinates at the end and the doubts to some outputs at the samples from `first` on.

    It takes arrays of shape (..., n), and returns arrays of shape (..., K, m).
    The translation b becomes (1 + a s) b + d x b, with the drift a, the direction's error d, and s from -1 at the first
    sample of the recording to 0 at its end.  Images do not change when the point and b are scaled, so that the flow of
    (X, 1, a, d) times the inverse distance gives them, be the point infinitely far away.
    """
    surface, motion, time = recording.imaging_surface, recording.motion, recording.time[first:]
    grid, index = step_grid(time, max(LONGEST_STEP, float(time[-1] - time[0]) / SPLIT))
    places = instants(grid[::-1])
    A, b = coefficients(motion, motion.known(places if motion.constants is None else places[:1]))
    size, names = 4 + len(DOUBTS), [str(symbol) for symbol in surface.image_coordinates]
    rate = np.zeros((len(places), size, size))
    rate[:, :3, :3], rate[:, :3, 3] = A, b / recording.unit
    rate[:, :3, 4] = rate[:, :3, 3] * ((places - places[0]) / recording.elapsed[-1])[:, None]
    rate[:, :3, 5:] = np.cross(np.eye(3), rate[:, None, :3, 3]).swapaxes(1, 2)
    rows = by_step(rate)
    between = step(np.eye(size), np.diff(grid[::-1])[:, None, None], lambda instant, map_: rows[:, instant] @ map_)
    maps = np.stack([*accumulate(between, lambda at, map_: map_ @ at, initial=np.eye(size))])[::-1][index, :3]
    flat = maps.reshape(-1, size).T
    chosen = [surface.image[names.index(recording.names[k])] for k in columns]
    shape = {symbol: surface.values[symbol] for symbol in surface.parameters}
    seen = vectorised((*POINT, *surface.radii), (*chosen, *surface.bounds), shape)
    sizes = [names.index(str(size)) for size in surface.radii.values()]  # a radius at the distance 1 is seen as it is

    def images(x: Array) -> Array:
        image, inverse, doubts = np.split(x, [len(names), len(names) + 1], axis=-1)
        directions = np.concatenate([surface.along(image), inverse, inverse * doubts], axis=-1)
        points = np.moveaxis((directions @ flat).reshape(*x.shape[:-1], -1, 3), -1, 0)
        with np.errstate(all="ignore"):
            found = np.stack(seen(*points, *np.moveaxis(image[..., None, sizes], -1, 0)), axis=-1)
        there = np.isfinite(found).all(axis=-1) & (found[..., len(chosen) :] > 0).all(axis=-1)
        return np.where(there[..., None], found[..., : len(chosen)], FAR)

    return images
