"""Maps of the image: the bound on the distance of a point that is first seen at each place."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import sympy as sp

from percept_obs.compile import Array, vectorised
from percept_obs.compile.integrator import LONGEST_STEP, step_along, step_grid
from percept_obs.observability.bound import HIDDEN_VARIANCE
from percept_obs.observability.measures import NOISE_VARIANCE
from percept_obs.system.motion import Motion
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import POINT, ImagingSurface
from percept_obs.validation import checked, limit, positive

Expressions = tuple[sp.Expr, ...]
Range = tuple[float, float]

PHI = sp.ImmutableMatrix(3, 3, lambda i, j: sp.Symbol(f"Phi{i + 1}{j + 1}", real=True))
MOVED = sp.ImmutableMatrix(sp.symbols("d1:4", real=True))
START = sp.ImmutableMatrix(sp.symbols("X0 Y0 Z0", real=True))
INFORMATION = sp.symbols("J11 J12 J13 J22 J23 J33", real=True)

PLACE = (*PHI, *MOVED, *START)
"""Symbols of a point at an instant: X = Phi X0 + d, for a motion X' = A X + b."""


@dataclass(frozen=True)
class MapKernel:
    """Formulas of a map at one place of the image, as expressions.

    For a point that begins at X0, with P0 the variance of hidden coordinates and R that of the noise::

        J = begin / P0 + (sum of gather over the samples, the first one included) / R
        relative standard deviation = finish, at the last sample
        not known where a distance is not positive on the way
    """

    begin: Expressions  # of X0: the prior's share of the six entries of J, on and above its diagonal, row by row
    gather: Expressions  # of `PLACE`: a sample's share of the six entries, and the distance
    finish: sp.Expr  # of J's entries and `PLACE`: the relative standard deviation of the distance


@lru_cache(maxsize=64)
def map_kernel(surface: ImagingSurface, measured: tuple[str, ...]) -> MapKernel:
    """Derive a map's formulas for a surface and measured outputs, from the image and the distance of a point."""
    X = PHI * START + MOVED
    names = [symbol.name for symbol in surface.image_coordinates]
    seen = [e for name, e in zip(names, surface.image, strict=True) if name in measured]
    hidden = [e for name, e in zip(names, surface.image, strict=True) if name not in measured]
    at_point = dict(zip(POINT, X, strict=True))
    at_start = dict(zip(POINT, START, strict=True))

    def upper(rows: sp.ImmutableMatrix) -> Expressions:
        """Entries of rows^T rows on and above the diagonal."""
        square = rows.T * rows
        return tuple(square[i, j] for i in range(3) for j in range(i, 3))

    # what is not measured, and the inverse distance, are known at first by the prior alone
    prior = sp.ImmutableMatrix([*hidden, 1 / surface.distance]).jacobian(POINT).xreplace(at_start)
    rows = sp.ImmutableMatrix(seen).jacobian(POINT).xreplace(at_point) * PHI
    slope = sp.ImmutableMatrix([surface.distance]).jacobian(POINT).xreplace(at_point) * PHI
    # slope J^-1 slope^T with J = L D L^T: less is lost to rounding than with determinants
    a, b, c, d, e, f = INFORMATION
    along, below = b / a, c / a
    second = d - along * b
    across = (e - below * b) / second
    third = f - below * c - across**2 * second
    z1, z2, z3 = slope[0], slope[1] - along * slope[0], slope[2] - below * slope[0]
    variance = z1**2 / a + z2**2 / second + (z3 - across * z2) ** 2 / third
    distance = surface.distance.xreplace(at_point)
    return MapKernel(upper(prior), (*upper(rows), distance), sp.sqrt(variance) / distance)


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
    WrongKind
        If an argument is of another kind.

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

    def at(self, y1: float, y2: float) -> float:
        """Relative standard deviation at the nearest place."""
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
    period: float = 0.05,
    noise_variance: float = NOISE_VARIANCE,
    hidden_variance: float = HIDDEN_VARIANCE,
) -> BoundMap:
    """Cramer-Rao bound of the distance, at each place of the image where a point is first seen.

    A point in space moves linearly, so that information about its start adds up without linearisation.  At each place
    the bound is that of `cramer_rao`.

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
    period : float
        Seconds between samples.
    noise_variance : float
        Of each measured output.
    hidden_variance : float
        Of each hidden coordinate before the first sample, as the inverse distance in 1/m^2.

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
    positive(
        seconds=seconds,
        distance=distance,
        period=period,
        noise_variance=noise_variance,
        hidden_variance=hidden_variance,
    )
    for name, ends in {"y1": y1, "y2": y2}.items():
        if not (np.isfinite(ends).all() and ends[0] < ends[1]):
            raise ValueError(f"the image ends at {name} = {ends}; give two finite numbers, the smaller one first")
    if resolution < 2:
        raise ValueError(f"the resolution is {resolution}; a map has two places or more along a side")
    samples = seconds / period
    limit(
        samples * resolution**2,
        "places and samples",
        "lower the resolution or the seconds, or lengthen the period",
        1e8,
    )
    count = int(np.floor(samples + 1e-9)) + 1
    columns, rows = np.linspace(*y1, resolution), np.linspace(*y2, resolution)
    places = np.stack([each.ravel() for each in np.meshgrid(columns, rows)], axis=-1)
    points = surface.locate(np.hstack([places, np.full((len(places), 1), 1 / distance)]))
    kernel, values = map_kernel(surface, measured), surface.values
    Phi, moved = displacements(motion, period * np.arange(count, dtype=float))
    with np.errstate(all="ignore"):
        J = np.array(vectorised(tuple(START), list(kernel.begin), values)(*points.T)) / hidden_variance
        gather, last = vectorised(PLACE, list(kernel.gather), values), (*Phi[-1].ravel(), *moved[-1], *points.T)
        seen = np.ones(len(points), dtype=bool)
        for k in range(count):
            *share, away = gather(*Phi[k].ravel(), *moved[k], *points.T)
            # one pass over the samples for all places at once, so that memory does not grow with the samples
            J += np.array(share) / noise_variance
            seen &= away > 0
        (relative,) = vectorised((*INFORMATION, *PLACE), [kernel.finish], values)(*J, *last)
    if np.isnan(relative[seen]).any():
        raise ValueError(
            f"at a distance of {distance} m the images tell less than rounding takes away; take a shorter distance, "
            "more seconds or a smaller noise_variance"
        )
    relative = np.where(seen, relative, np.nan).reshape(resolution, resolution)
    if not np.isfinite(relative).any():
        raise ValueError(
            f"no place of the image has a bound: points seen from y1 = {y1}, y2 = {y2} at a distance of {distance} m "
            f"come behind the camera within seconds = {seconds}, or noise_variance = {noise_variance} or "
            f"hidden_variance = {hidden_variance} is beyond all measure; give other numbers"
        )
    return BoundMap(system, measured, columns, rows, relative, float(period * (count - 1)), distance)


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
