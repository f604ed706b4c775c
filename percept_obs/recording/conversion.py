"""Conversion of a recording to another imaging surface."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from percept_obs.compile import Array
from percept_obs.recording.recording import Recording
from percept_obs.system.surfaces import ImagingSurface
from percept_obs.validation import Chain, checked


@checked
def seen_on(recording: Recording, surface: ImagingSurface) -> Recording:
    """Convert a recording to another imaging surface, through the rays along which the point was seen.

    Parameters
    ----------
    recording : Recording
        Of one point, with all image coordinates of its surface.
    surface : ImagingSurface
        With numbers for its shape.

    Returns
    -------
    Recording
        Samples and truth are NaN where the surface does not see the point.  Measured distances become those of the
        surface, such as ranges in place of depths.  The noise is carried over, so that it is no longer the same
        everywhere in the image, and its variance is not known.

    Raises
    ------
    ValueError
        If an image coordinate was not measured, for then the rays are not known.

    See Also
    --------
    record : Simulates a recording on any surface.

    Examples
    --------
    >>> from percept_obs import record, scenarios, seen_on, sphere
    >>> recording = record(scenarios.ma2005_eq35(), 20)
    >>> round(float(recording.distance[0]), 3), round(float(seen_on(recording, sphere()).distance[0]), 3)
    (2.5, 3.082)
    """
    before = recording.imaging_surface
    names = tuple(symbol.name for symbol in before.image_coordinates)
    missing = [name for name in names if name not in recording.names]
    if missing:
        raise ValueError(
            f"the recording has no {', '.join(missing)}, so its rays are not known; measure all of {', '.join(names)}"
        )
    if surface.radii:
        raise ValueError(f"rays say nothing of the size that the {surface.name} sees; convert to it without the size")
    order = [recording.names.index(name) for name in names]
    convert = partial(_image, surface, before, order)
    truth, signal = recording.truth, recording.signal
    lengths = surface.distances(before.along(recording.outputs[:, order]))
    return replace(
        recording,
        outputs=convert(recording.outputs),
        names=tuple(symbol.name for symbol in surface.image_coordinates),
        view=surface,
        truth=None if truth is None else _seen(surface, before.locate(truth)),
        signal=None if signal is None else Chain(signal, convert),
        noise_variance=recording.noise_variance if surface.fits(before) else None,
        distances={name: values * lengths for name, values in recording.distances.items()},
        source=f"{recording.source}, seen on the {surface.name}",
    )


def _image(surface: ImagingSurface, before: ImagingSurface, order: list[int], outputs: Array) -> Array:
    return _seen(surface, before.along(outputs[:, order]))[:, :-1]


def _seen(surface: ImagingSurface, points: Array) -> Array:
    """Return coordinates, shape (K, n), of points of shape (K, 3); NaN where they are not known or not seen."""
    coordinates = np.full((len(points), len(surface.coordinates)), np.nan)
    known = np.flatnonzero(np.isfinite(points).all(axis=-1))
    seen = known[surface.sees(points[known])]
    coordinates[seen] = surface.project(points[seen])
    return coordinates
