"""States of bodies in a moving camera's frame: independent points, a rigid body, and one with an unseen origin."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.points.form import PointsForm
from percept_obs.system.motion import Motion, at_rest_if_left_out, bound, cross
from percept_obs.system.surfaces import ImagingSurface, pinhole
from percept_obs.validation import Coefficients, Times, checked, limit

MOST_POINTS = 200
"""Most points of a body: sympy places their blocks within a few seconds."""


@checked
def independent_points(motion: Motion, points: int, surface: ImagingSurface | None = None) -> PointsForm:
    """Return the form of points that share a known motion only: x = (X_1, ..., X_p), with X_k' = A X_k + b.

    The 3 p states are X1_x, X1_y, X1_z, X2_x, ...

    Parameters
    ----------
    motion : Motion
        Of a single point, from `affine` or `rigid`.
    points : int
        Number p.
    surface : ImagingSurface, optional
        The pinhole when left out.

    Raises
    ------
    ValueError
        If there is no point, or the motion is not that of a point.

    See Also
    --------
    rigid_body : Points that move together in an unknown shape.

    Examples
    --------
    >>> from percept_obs import affine
    >>> from percept_obs.points import independent_points
    >>> independent_points(affine(), 2).names
    ('X1_x', 'X1_y', 'X1_z', 'X2_x', 'X2_y', 'X2_z')
    """
    _check_count(points)
    if motion.A.shape != (3, 3):
        raise ValueError(f"the motion has {motion.A.shape[0]} states; that of a single point has 3")
    A = placed(points, {(k, k): motion.A for k in range(points)})
    b = placed(points, {(k, 0): motion.b for k in range(points)}, columns=1)
    many = replace(motion, name=f"{motion.name}, {points} points", A=A, b=b)
    return form_of(many, [f"X{k + 1}" for k in range(points)], [[k] for k in range(points)], surface)


@checked
def rigid_body(
    points: int,
    camera_angular_velocity: Coefficients | None = None,
    camera_velocity: Coefficients | None = None,
    body_angular_velocity: Coefficients | None = None,
    point_velocity: Coefficients | None = None,
    times: Times | None = None,
    surface: ImagingSurface | None = None,
) -> PointsForm:
    """Return the form of a rigid body in a moving camera's frame: x = (r, d_2, ..., d_p), point and offsets from it.

    With the angular velocities w_c of the camera and w_b of the body and the velocities v_c of the camera and v_p of
    the body's first point, all in the world and written in the camera's axes::

        r' = -w_c x r + v_p - v_c,    d_k' = (w_b - w_c) x d_k,    X_1 = r,  X_k = r + d_k

    The 3 p states are r_x, r_y, r_z, d2_x, ...

    Parameters
    ----------
    points : int
        Number p.
    camera_angular_velocity, camera_velocity, body_angular_velocity, point_velocity : arrays of shape (3,) or (K, 3), \
functions of time, optional
        w_c, w_b in rad/s and v_c, v_p in m/s; symbols when all are left out, else 0 for those that are.
    times : array of shape (K,), optional
        Times in seconds of sampled velocities.
    surface : ImagingSurface, optional
        The pinhole when left out.

    Raises
    ------
    ValueError
        If there is no point, shapes do not match, values are not finite or times do not increase.

    See Also
    --------
    independent_points, body_with_origin

    Notes
    -----
    Where instead the velocity is known of the body's point that is momentarily at the camera's centre, all points
    share one rigid motion with the angular velocity w_c - w_b; take `independent_points`.

    Examples
    --------
    >>> from percept_obs.points import rigid_body
    >>> rigid_body(2).names
    ('r_x', 'r_y', 'r_z', 'd2_x', 'd2_y', 'd2_z')
    """
    _check_count(points)
    velocities = (camera_angular_velocity, camera_velocity, body_angular_velocity, point_velocity)
    motion = _body_motion("rigid body", points, velocities, times)
    others = range(1, points)
    return form_of(motion, ["r", *(f"d{k + 1}" for k in others)], [[0], *([0, k] for k in others)], surface)


@checked
def body_with_origin(
    points: int,
    camera_angular_velocity: Coefficients | None = None,
    camera_velocity: Coefficients | None = None,
    body_angular_velocity: Coefficients | None = None,
) -> PointsForm:
    """Return the form of a rigid body about an origin that no point marks: x = (o, d_1, ..., d_p), X_k = o + d_k.

    A warning example: moving the origin one way and all points' places the other changes no image while both turn
    alike, so that three directions of the state are never seen.  `rigid_body` has none of them.  The 3 p + 3 states are
    o_x, o_y, o_z, d1_x, ...

    Parameters
    ----------
    points, camera_angular_velocity, camera_velocity, body_angular_velocity
        See `rigid_body`.  The origin rests in the world, if any of them is given.

    Warns
    -----
    UnseenDirection
        If the body does not turn, so that the directions are lost for good.

    See Also
    --------
    rigid_body : Without unseen directions.

    Examples
    --------
    >>> from percept_obs.points import body_with_origin
    >>> body_with_origin(2).names
    ('o_x', 'o_y', 'o_z', 'd1_x', 'd1_y', 'd1_z', 'd2_x', 'd2_y', 'd2_z')
    """
    _check_count(points)
    velocities = (camera_angular_velocity, camera_velocity, body_angular_velocity, None)
    motion = _body_motion("rigid body with an origin", points + 1, velocities, None)
    others = range(1, points + 1)
    return form_of(motion, ["o", *(f"d{k}" for k in others)], [[0, k] for k in others], None)


def _body_motion(name: str, vectors: int, velocities: tuple[Any, ...], times: Times | None) -> Motion:
    """Motion of one position and of vectors that turn with a body."""
    w_c, v_c, w_b, v_p = (sp.ImmutableMatrix(sp.symbols(f"{n}1:4", real=True)) for n in ("w_c", "v_c", "w_b", "v_p"))
    symbols = (w_c, v_c, w_b, v_p)
    # seen from the camera everything turns against it; offsets turn with the body besides
    place, turning = cross(-w_c), cross(w_b - w_c)
    A = placed(vectors, {(0, 0): place, **{(k, k): turning for k in range(1, vectors)}})
    v = placed(vectors, {(0, 0): v_p - v_c}, columns=1)
    return bound(name, A, v, list(zip(at_rest_if_left_out(*velocities), symbols, strict=True)), times)


def placed(vectors: int, blocks: dict[tuple[int, int], sp.ImmutableMatrix], columns: int = 0) -> sp.ImmutableMatrix:
    """Sparse matrix with blocks of three rows at given positions."""
    entries = {
        (3 * row + i, 3 * column + j): block[i, j]
        for (row, column), block in blocks.items()
        for i in range(3)
        for j in range(block.shape[1])
        if block[i, j] != 0
    }
    return sp.ImmutableSparseMatrix(3 * vectors, columns or 3 * vectors, entries)


def form_of(motion: Motion, vectors: list[str], sums: list[list[int]], surface: ImagingSurface | None) -> PointsForm:
    """Form of points that are sums of the state's vectors."""
    C = np.zeros((len(sums), 3, len(vectors), 3))
    for k, terms in enumerate(sums):
        C[k, :, terms, :] = np.eye(3)
    names = tuple(f"{vector}_{axis}" for vector in vectors for axis in "xyz")
    return PointsForm(motion, C.reshape(len(sums), 3, -1), surface or pinhole(), names)


def _check_count(points: int) -> None:
    """Raise ValueError unless a body may have so many points."""
    if points < 1:
        raise ValueError(f"a body has {points!r} points; it needs a whole number, at least 1")
    limit(points, "points of a body", "take fewer points", MOST_POINTS)
