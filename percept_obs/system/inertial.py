"""Camera and IMU: a landmark, the camera's speed and gravity in its own frame, with biases of the IMU as states."""

from functools import cache

import sympy as sp

from percept_obs.system.motion import Motion, bound, cross
from percept_obs.system.state_view import StateView
from percept_obs.validation import Coefficients, Times, checked

w, a, p, v, g, b_w, b_a, u, q, c = (
    sp.ImmutableMatrix(sp.symbols(f"{name}1:4", real=True))
    for name in ("w", "a", "p", "v", "g", "b_w", "b_a", "u", "q", "c")
)
y1, y2, y3 = sp.symbols("y1:4", real=True)


@checked
def imu(
    angular_velocity: Coefficients | None = None,
    specific_force: Coefficients | None = None,
    times: Times | None = None,
) -> Motion:
    """Return the motion that an IMU knows: its angular velocity w in rad/s and specific force a in m/s^2.

    Parameters
    ----------
    angular_velocity, specific_force : arrays of shape (3,) or (K, 3), functions of time, optional
        In the camera's axes; symbols when left out.  The specific force is the acceleration without gravity.
    times : array of shape (K,), optional
        Times in seconds of samples.

    See Also
    --------
    camera_with_imu : The view of it.

    Examples
    --------
    >>> imu().b.T
    Matrix([[a1, a2, a3]])
    """
    return bound("IMU's", cross(-w), a, [(angular_velocity, w), (specific_force, a)], times)


@cache
def camera_with_imu() -> StateView:
    """Return the view of a landmark by a camera with an IMU, whose biases are not known.

    With the landmark p, the camera's velocity v and gravity g in the camera's frame::

        p' = -(w - b_w) x p - v,  v' = -(w - b_w) x v + (a - b_a) + g,  g' = -(w - b_w) x g

    (Hamel and Samson 2017 without biases.)  Measured are y1 = p1/p3 and y2 = p2/p3; hidden are u = v/p3, q = g/p3,
    c = b_a/p3, b_w and y3 = 1/p3: over the depth, so that u' has a y3 + q - c, linear in what has a scale.  Without
    acceleration in the world y3, q and c scaled alike make the same pictures.

    See Also
    --------
    imu : The motion.

    Examples
    --------
    >>> camera_with_imu().partition("y1", "y2").canonical_form().hidden[-1]
    'y3'
    """
    W = cross(b_w - w)
    rate = (*(W * p - v), *(W * v + a - b_a + g), *(W * g), *sp.zeros(6, 1))
    state, shares = (*p, *v, *g, *b_w, *b_a), ((u, v), (q, g), (c, b_a))
    over_depth = {s: e / p[2] for share, vector in shares for s, e in zip(share, vector, strict=True)}
    rest = over_depth | {s: s for s in b_w} | {y3: 1 / p[2]}
    back = (y1 / y3, y2 / y3, 1 / y3, *(u / y3), *(q / y3), *b_w, *(c / y3))
    usual = dict.fromkeys(q, 3.0) | dict.fromkeys(b_w, 0.01) | dict.fromkeys(c, 0.03) | {y3: 0.3}
    image = {y1: p[0] / p[2], y2: p[1] / p[2]}
    powers = (1,) * 9 + (0,) * 3 + (1,) * 3
    guess = dict(zip(q, -a / 2, strict=True)) | dict.fromkeys(c, 0) | {y3: sp.Rational(1, 2)}  # 2 m away
    return StateView("camera with an IMU", state, rate, imu(), image, rest, back, powers, usual, (), guess)
