"""Camera and IMU: landmarks, speed and gravity in the body's frame, moved by angular velocity and specific force."""

from __future__ import annotations

import sympy as sp

from percept_obs.compile.integrator import LONGEST_STEP
from percept_obs.points.bodies import form_of, placed
from percept_obs.points.form import PointsForm
from percept_obs.points.lyapunov_matrix import LyapunovMatrix, riccati
from percept_obs.system.inertial import a, w
from percept_obs.system.motion import bound, cross
from percept_obs.validation import Coefficients, Times, checked, positive


@checked
def camera_imu(
    points: int = 1,
    turning: Coefficients | None = None,
    force: Coefficients | None = None,
    times: Times | None = None,
) -> PointsForm:
    """Return the form of landmarks at rest, seen by a camera with an IMU: x = (p_1, ..., p_n, v, g).

    With the angular velocity w and the specific force a that an IMU in the camera measures::

        p_k' = -w x p_k - v,    v' = -w x v + a + g,    g' = -w x g

    Parameters
    ----------
    points : int
        n landmarks.
    turning, force : arrays of shape (3,) or (K, 3), functions of time, optional
        w in rad/s and a in m/s^2; symbols when left out.
    times : array of shape (K,), optional
        Times in seconds of samples.

    Raises
    ------
    ValueError
        If there is no point, or samples are not finite or have another shape.

    See Also
    --------
    trusting : Chooses P of its observer.
    percept_obs.system.inertial.camera_with_imu : With both biases, of one point.

    Notes
    -----
    T. Hamel and C. Samson, Riccati observers for the nonstationary PnP problem, arXiv:1606.07735.  Where a = -g, the
    world speed is constant, and p and v scaled alike make the same pictures.

    Examples
    --------
    >>> from percept_obs.points import camera_imu
    >>> camera_imu(2).names[6:]
    ('v_x', 'v_y', 'v_z', 'g_x', 'g_y', 'g_z')
    """
    positive(points=points)
    turned, one, v = cross(-w), sp.ImmutableMatrix(sp.eye(3)), points
    blocks = {(k, k): turned for k in range(points + 2)} | {(k, v): -one for k in range(points)} | {(v, v + 1): one}
    names = [*(f"p{k + 1}" for k in range(points)), "v", "g"]
    A, b = placed(len(names), blocks), placed(len(names), {(v, 0): a}, columns=1)
    motion = bound("camera and IMU", A, b, [(turning, w), (force, a)], times)
    return form_of(motion, names, [[k] for k in range(points)], None)


MEMORY = 20.0
"""Seconds after which images are forgotten."""


@checked
def trusting(noise: float, period: float, distance: float, spread: float) -> LyapunovMatrix:
    """Return P of `riccati` that trusts a start as far as it is known, against images with their noise.

    P counts information in what images with 1 m^2 of noise tell in a second.  So a start with the standard deviation
    `spread` has P = period (noise distance / spread)^2, and a larger P holds on to the start.  It is kept above a
    hundredth of a step: images add a step's worth to P in the first one, whose gain would otherwise be too large.

    Parameters
    ----------
    noise : float
        Standard deviation of the image coordinates.
    period : float
        Seconds between images.
    distance : float
        Of the points, in metres, roughly.
    spread : float
        Standard deviation of the start, in metres and metres a second.

    Raises
    ------
    ValueError
        If a number is not positive.

    See Also
    --------
    riccati : Makes it.

    Examples
    --------
    >>> from percept_obs.points import trusting
    >>> print(f"{float(trusting(noise=1e-3, period=0.02, distance=4, spread=2).start):.0e}")
    1e-04
    """
    positive(noise=noise, period=period, distance=distance, spread=spread)
    return riccati(max(period * (noise * distance / spread) ** 2, LONGEST_STEP / 100), 1 / MEMORY)
