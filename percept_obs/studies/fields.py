"""Imaging surfaces compared over a field of view, by the Cramer-Rao bound of the distance in each direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from percept_obs.compile import Array, Flags, vectorised
from percept_obs.observability.maps import displacements
from percept_obs.recording import NO_NOISE, Camera
from percept_obs.system.motion import Motion
from percept_obs.system.surfaces import POINT, ImagingSurface
from percept_obs.tracking.doubts import FAR
from percept_obs.validation import checked, limit, once, positive

__all__ = ["FieldBound", "field_bound"]


@checked
@dataclass(frozen=True, eq=False, repr=False)
class FieldBound:
    """The Cramer-Rao bound of the distance over a field of view.

    Parameters
    ----------
    surface : ImagingSurface
    measured : tuple of str
    angles : array of shape (N,)
        Angles from the optical axis in radians, of columns and rows alike.
    relative : array of shape (N, N)
        Least relative standard deviation of the range of a point that is first seen in this direction; NaN outside of
        the field of view.
    seconds, distance : float
        Seconds for which the points are seen, and their range at the beginning in metres.

    See Also
    --------
    field_bound : Computes it.
    percept_obs.figures.fields : Draws it.

    Examples
    --------
    >>> from percept_obs import affine, pinhole
    >>> forwards = affine([[0.0] * 3] * 3, [0, 0, -0.5])
    >>> found = field_bound(pinhole(), forwards, size=21)
    >>> found.within(0.0, 0.1) > 5 * found.within(0.4, 0.6)
    True
    """

    surface: ImagingSurface
    measured: tuple[str, ...]
    angles: Array
    relative: Array
    seconds: float
    distance: float

    @property
    def median(self) -> float:
        """Median over the field of view."""
        return float(np.nanmedian(self.relative))

    def within(self, low: float, high: float) -> float:
        """Median over the directions between two angles from the optical axis, in radians; ValueError without any."""
        if not 0 <= low <= high <= np.pi:
            raise ValueError(f"the angles are {low} and {high} rad; give a smaller and a larger one, from 0 to pi")
        away = np.hypot(*np.meshgrid(self.angles, self.angles))
        inside = self.relative[(away >= low) & (away <= high)]
        if not np.isfinite(inside).any():
            raise ValueError(f"no direction lies between {low} and {high} rad; they go up to {self.angles[-1]:.3g} rad")
        return float(np.nanmedian(inside))

    def __repr__(self) -> str:
        return (
            f"<FieldBound of {', '.join(self.measured)} on the {self.surface.name}, {self.seconds:g} s: the range to "
            f"{100 * self.median:.3g} % in the middle of all directions, {100 * np.nanmin(self.relative):.3g} to "
            f"{100 * np.nanmax(self.relative):.3g} %>"
        )


@checked
def field_bound(
    surface: ImagingSurface,
    motion: Motion,
    field_of_view: float = np.pi / 2,
    pixels: float = 0.5,
    angle: float | None = None,
    measured: tuple[str, ...] | None = None,
    seconds: float = 2.0,
    distance: float = 5.0,
    period: float = 0.05,
    size: int = 41,
    prior: float = 1.0,
    across: float = 640.0,
) -> FieldBound:
    """Return the Cramer-Rao bound of the range of a point, for each direction in which it is first seen.

    A point in space moves linearly, X(t) = Phi(t) X(0) + d(t), so that the information on X(0) of its images is a sum.
    Images outside of the field of view are not used.

    Parameters
    ----------
    surface : ImagingSurface
        With numbers for its shape; its centre and the field of view must be seen on it.
    motion : Motion
        With numbers, constant or over time.
    field_of_view : float
        Full angle in radians of the cone around the optical axis.
    pixels : float
        Standard deviation of the noise of each output, the same everywhere in the picture.
    angle : float, optional
        Standard deviation in radians across the ray in both directions, as if the ray itself were measured, instead.
    measured : tuple of str, optional
        Outputs that are measured; all of them when left out.
    seconds : float
        Time for which the points are seen.
    distance : float
        Their range at the beginning in metres.
    period : float
        Seconds between samples.
    size : int
        Directions across the field of view.
    prior : float
        Relative standard deviation of a point before the first image, in each direction of space.
    across : float
        Pixels across the field of view.

    Raises
    ------
    ValueError
        If the surface does not see the field of view, the motion has no numbers, an output is not there or twice,
        or a number is not positive.

    See Also
    --------
    percept_obs.bound_map : the bound over the image of one surface
    percept_obs.cramer_rao : the bound along one trajectory

    Examples
    --------
    >>> from percept_obs import affine, pinhole, sphere
    >>> sideways = affine([[0.0] * 3] * 3, [0.5, 0, 0])
    >>> wide = [field_bound(s, sideways, np.radians(150)).median for s in (pinhole(), sphere())]
    >>> wide[0] > wide[1]
    True
    >>> [round(field_bound(s, sideways, angle=0.002, size=9).median, 4) for s in (pinhole(), sphere())]
    [0.0055, 0.0055]
    """
    positive(seconds=seconds, distance=distance, period=period, prior=prior, pixels=pixels, across=across)
    positive(angle=1.0 if angle is None else angle)
    if motion.signal is None:
        raise ValueError(f"the {motion.name} motion has no numbers; give it some, such as affine(A, b)")
    sees = 0 < field_of_view <= surface.field_of_view + 1e-6
    if not (sees and pixel(surface, field_of_view, across=1.0) < FAR):
        raise ValueError(
            f"the field of view is {np.degrees(field_of_view):.4g} degrees; the {surface.name} sees "
            f"{np.degrees(surface.field_of_view):.4g} around its optical axis at most: take a smaller one, in radians"
        )
    names = [symbol.name for symbol in surface.image_coordinates]
    measured = tuple(names) if measured is None else tuple(measured)
    if not measured or not set(measured) <= set(names):
        raise ValueError(f"the {surface.name} has the outputs {', '.join(names)}; {measured} cannot be measured")
    once(measured=measured)
    if size < 3:
        raise ValueError(f"the size is {size}; three directions are needed, to both sides and on the axis")
    times = Camera(period, NO_NOISE).times(seconds)
    limit(len(times) * size**2, "directions and samples", "take fewer directions or a longer period", 1e7)
    angles = field_of_view / 2 * np.linspace(-1, 1, size)
    right, up = np.meshgrid(angles, angles)
    away = np.hypot(right, up)
    share = np.sinc(away / np.pi)
    starts = distance * np.stack([share * right, share * up, np.cos(away)], axis=-1).reshape(-1, 3)
    inside = _inside(starts, field_of_view) & surface.sees(starts)
    starts = starts[inside]
    information = np.eye(3) / (prior * distance) ** 2 + np.zeros((len(starts), 3, 3))
    rows = [surface.image[names.index(name)] for name in measured]
    sigma = pixels * pixel(surface, field_of_view, across)
    gradient = vectorised(POINT, [row.diff(axis) for row in rows for axis in POINT], surface.values)
    for Phi, moved in zip(*displacements(motion, times), strict=True):
        points = starts @ Phi.T + moved
        seen = _inside(points, field_of_view) & surface.sees(points)
        D = np.stack(gradient(*points[seen].T), axis=-1).reshape(-1, len(rows), 3)
        gained = D.swapaxes(1, 2) @ _weights(D, points[seen], sigma, angle) @ D
        information[seen] += Phi.T @ gained @ Phi
    ends = starts @ Phi.T + moved
    lengths = np.linalg.norm(ends, axis=1)
    along = (ends / lengths[:, None]) @ Phi
    variance = np.einsum("ki,ki->k", along, np.linalg.solve(information, along[:, :, None])[:, :, 0])
    relative = np.full(size**2, np.nan)
    relative[inside] = np.sqrt(variance) / lengths
    return FieldBound(surface, measured, angles, relative.reshape(size, size), seconds, distance)


def pixel(surface: ImagingSurface, field_of_view: float, across: float) -> float:
    """Size of a pixel in image coordinates, if `across` of them span the widest side of the field of view."""
    turns = np.linspace(0, 2 * np.pi, 360, endpoint=False)
    # a hair inside, for on the edge itself some surfaces end
    away = field_of_view / 2 * (1 - 1e-9)
    ring = np.stack([np.sin(away) * np.cos(turns), np.sin(away) * np.sin(turns), np.full(360, np.cos(away))], axis=-1)
    return float(np.ptp(surface.project(ring)[:, :2], axis=0).max() / across)


def _weights(D: Array, points: Array, sigma: float, angle: float | None) -> Array:
    """Inverse of the covariance of the outputs' noise, shape (K, m, m) or (m, m)."""
    if angle is None:
        return np.eye(D.shape[1]) / sigma**2
    spread = (angle**2 * np.sum(points**2, axis=1))[:, None, None] * D @ D.swapaxes(1, 2)
    # three outputs depend on each other, so that their noise has no share along one direction
    return np.asarray(np.linalg.pinv(spread, rcond=1e-10, hermitian=True))


def _inside(points: Array, field_of_view: float) -> Flags:
    angle = np.arctan2(np.hypot(points[:, 0], points[:, 1]), points[:, 2])
    return np.asarray(angle <= field_of_view / 2 * (1 + 1e-9))
