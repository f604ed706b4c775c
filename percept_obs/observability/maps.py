"""Maps of the image: the bound on the distance of a point that is first seen at each place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import sympy as sp

from percept_obs.compile import Array, vectorised
from percept_obs.compile.integrator import LONGEST_STEP, step_along, step_grid
from percept_obs.observability.bound import HIDDEN_VARIANCE
from percept_obs.observability.measures import NOISE_VARIANCE
from percept_obs.system.motion import Motion
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import POINT
from percept_obs.validation import checked, limit, numbers, positive

Range = tuple[float, float]

PERIOD = 0.05
"""Seconds between samples."""


@checked
@dataclass(frozen=True, eq=False, repr=False)
class BoundMap:
    """Cramer-Rao bound over the image, from `bound_map`.

    Parameters
    ----------
    system : PerspectiveSystem
        Of the points, with numbers.
    measured : tuple of str
        Outputs that are measured.
    y1, y2 : arrays of shapes (W,) and (H,)
        Image coordinates of the map's columns and rows.
    relative : array of shape (H, W)
        Least relative standard deviation of the distance; NaN where a point comes behind the camera.
    seconds, distance : float
        Time in seconds after which the bound holds, and distance in metres of the points at the beginning.

    Raises
    ------
    ValueError
        If an argument is of another kind or shape.

    See Also
    --------
    bound_map : Makes it.
    percept_obs.figures.bound_map : Draws it.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, bound_map, pinhole
    >>> forwards = PerspectiveSystem(affine([[0.0] * 3] * 3, [0, 0, -0.5]), pinhole())
    >>> found = bound_map(forwards, resolution=21)
    >>> [round(found.at(y1, 0), 3) for y1 in (0.0, 0.5, 1.0)]
    [6.25, 0.027, 0.014]
    """

    system: PerspectiveSystem
    measured: tuple[str, ...]
    y1: Array
    y2: Array
    relative: Array
    seconds: float
    distance: float

    def __post_init__(self) -> None:
        numbers(self.relative, "values of relative", len(self.y2), len(self.y1))
        positive(places=self.relative.size, seconds=self.seconds, distance=self.distance)

    def at(self, y1: float, y2: float) -> float:
        """Relative standard deviation at the nearest place; raises ValueError outside of the map."""
        for name, place, ends in (("y1", y1, self.y1), ("y2", y2, self.y2)):
            if not ends.min() - 1e-9 <= place <= ends.max() + 1e-9:
                raise ValueError(f"{name} is {place}; the map goes from {ends.min():g} to {ends.max():g}")
        return float(self.relative[np.argmin(np.abs(self.y2 - y2)), np.argmin(np.abs(self.y1 - y1))])

    def __repr__(self) -> str:
        low, high = np.nanmin(self.relative), np.nanmax(self.relative)
        return (
            f"<BoundMap of {', '.join(self.measured)} after {self.seconds:g} s, at {self.distance:g} m: the distance "
            f"to {100 * low:.3g} % at best and {100 * high:.3g} % at worst>"
        )


@checked
def bound_map(
    system: PerspectiveSystem,
    seconds: float = 2.0,
    distance: float = 5.0,
    measured: tuple[str, ...] | None = None,
    y1: Range = (-1.0, 1.0),
    y2: Range = (-1.0, 1.0),
    resolution: int = 200,
    noise_variance: float = NOISE_VARIANCE,
) -> BoundMap:
    """Cramer-Rao bound of the distance, at each place of the image where a point is first seen.

    A point in space moves linearly, so that information about its start adds up without linearisation.  At each place
    the bound is that of `cramer_rao`, without a prior and with a sample every 0.05 s.

    Parameters
    ----------
    system : PerspectiveSystem
        With numbers, on a surface with two image coordinates.
    seconds : float
        Time over which the points are seen.
    distance : float
        Depth or range of all points at the beginning, in metres.
    measured : tuple of str, optional
        Outputs that are measured; both when left out.
    y1, y2 : pairs of floats
        Ends of the image.
    resolution : int
        Places along either side.
    noise_variance : float
        Of each measured output.

    Returns
    -------
    BoundMap
        A place for each of `resolution` columns and rows.

    Raises
    ------
    ValueError
        If the system has no numbers or not two image coordinates, an output is not there, or a number is no time,
        distance, variance or range.

    See Also
    --------
    cramer_rao : The bound along one recording.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, bound_map, pinhole
    >>> forwards = PerspectiveSystem(affine([[0.0] * 3] * 3, [0, 0, -0.5]), pinhole())
    >>> found = bound_map(forwards, resolution=51)
    >>> found.at(0, 0) > 10 * found.at(0.8, 0.8)
    True
    """
    surface, motion = system.surface, system.motion
    names = tuple(symbol.name for symbol in surface.image_coordinates)
    measured = names if measured is None else tuple(measured)
    if not measured or len(set(measured)) != len(measured) or not set(measured) <= set(names):
        raise ValueError(f"measured is {measured}; name at least one of {', '.join(names)}, each once")
    if len(names) != 2:
        raise ValueError(f"the {surface.name} has {len(names)} image coordinates; a map is of two")
    positive(seconds=seconds, distance=distance, noise_variance=noise_variance)
    if seconds < PERIOD:
        raise ValueError(f"seconds is {seconds}; give at least {PERIOD}, the time from one sample to the next")
    for name, ends in {"y1": y1, "y2": y2}.items():
        if not (np.isfinite(ends).all() and ends[0] < ends[1]):
            raise ValueError(f"the image ends at {name} = {ends}; give two finite numbers, the smaller one first")
    if resolution < 2:
        raise ValueError(f"the resolution is {resolution}; a map has two places or more along a side")
    samples = seconds / PERIOD
    limit(samples * resolution**2, "places and samples", "lower the resolution or the seconds", 1e8)
    count = int(np.floor(samples + 1e-9)) + 1
    columns, rows = np.linspace(*y1, resolution), np.linspace(*y2, resolution)
    places = np.stack([each.ravel() for each in np.meshgrid(columns, rows)], axis=-1)
    points = surface.locate(np.hstack([places, np.full((len(places), 1), 1 / distance)]))
    image = dict(zip(names, surface.image, strict=True))
    hidden = [entry for name, entry in image.items() if name not in measured]

    def slopes(expressions: list[sp.Expr], points: Array) -> Array:
        """Derivatives of q expressions by the point, shape (N, q, 3)."""
        entries = vectorised(POINT, [e.diff(axis) for e in expressions for axis in POINT], surface.values)(*points.T)
        return np.stack(entries, axis=-1).reshape(len(points), -1, 3)

    def told(rows: Array, variance: float) -> Array:
        """Information on the start, shape (N, 3, 3), of numbers with these derivatives by it."""
        return rows.swapaxes(1, 2) @ rows / variance

    with np.errstate(all="ignore"):
        # what is not measured, and the inverse distance, are known at first by the prior alone
        information = told(slopes([*hidden, 1 / surface.distance], points), HIDDEN_VARIANCE)
        seen = np.ones(len(points), dtype=bool)
        # one pass over the samples for all places at once, so that memory does not grow with the samples
        for Phi, moved in zip(*displacements(motion, PERIOD * np.arange(count, dtype=float)), strict=True):
            at = points @ Phi.T + moved
            information += told(slopes([image[name] for name in measured], at) @ Phi, noise_variance)
            seen &= surface.distances(at) > 0
        information, along = information[seen], (slopes([surface.distance], at) @ Phi)[seen]
        regular = np.linalg.det(information) > 0
    if not regular.all():
        raise ValueError(
            f"at a distance of {distance} m the images tell less than rounding takes away; take a shorter distance, "
            "more seconds or a smaller noise_variance"
        )
    variance = (along @ np.linalg.solve(information, along.swapaxes(1, 2)))[:, 0, 0]
    relative = np.full((resolution, resolution), np.nan)
    relative[seen.reshape(relative.shape)] = np.sqrt(variance) / surface.distances(at[seen])
    if not np.isfinite(relative).any():
        raise ValueError(
            f"no place of the image has a bound: points seen from y1 = {y1}, y2 = {y2} at a distance of {distance} m "
            f"come behind the camera within seconds = {seconds}, or noise_variance = {noise_variance} is beyond all "
            "measure; give other numbers"
        )
    return BoundMap(system, measured, columns, rows, relative, PERIOD * (count - 1), distance)


def displacements(motion: Motion, times: Array) -> tuple[Array, Array]:
    """Phi and d of X(t) = Phi X(0) + d at times from 0 on, shapes (K, 3, 3) and (K, 3)."""
    evaluate = vectorised(motion.parameters, [*motion.A, *motion.b])

    def rate(time: Array, state: Array) -> Array:
        A, b = np.split(np.ravel(evaluate(*motion.known(float(time))[0])), [9])
        moved = A.reshape(3, 3) @ state
        moved[:, 3] += b
        return moved

    # the steps of the page, which then draws the same numbers where the distance is hardly observable
    grid, index = step_grid(times, LONGEST_STEP)
    state = np.eye(3, 4)
    found = [state]
    for begin, h in zip(grid[:-1], np.diff(grid), strict=True):
        state = step_along(state, begin, h, rate)
        found.append(state)
    whole = np.array(found)[index]
    return whole[:, :, :3], whole[:, :, 3]
