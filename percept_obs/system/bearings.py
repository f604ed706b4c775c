"""Bearings only: a target with constant velocity in modified polar coordinates, seen from a ship that may turn."""

from functools import cache

import sympy as sp

from percept_obs.system.motion import Motion, bound
from percept_obs.system.state_view import StateView
from percept_obs.validation import Coefficients, Times, checked

X, Y, U, V = STATE = sp.symbols("X Y U V", real=True)
y1, y2, y3, y4 = sp.symbols("y1:5", real=True)
ACCELERATION = sp.ImmutableMatrix(sp.symbols("a_x a_y", real=True))


@checked
def own_ship(acceleration: Coefficients | None = None, times: Times | None = None) -> Motion:
    """Return the motion of a target of constant velocity from a ship with a known acceleration.

    The state is place and velocity of the target from the ship: X' = U, Y' = V, U' = -a_x, V' = -a_y.

    Parameters
    ----------
    acceleration : array of shape (2,) or (K, 2), or function of time, optional
        (a_x, a_y) in m/s^2; symbols when left out.
    times : array of shape (K,), optional
        Times in seconds of a sampled acceleration.

    See Also
    --------
    bearings_only : The view of it.

    Examples
    --------
    >>> own_ship().b.T
    Matrix([[0, 0, -a_x, -a_y]])
    """
    A = sp.ImmutableMatrix(4, 4, lambda i, j: int(j == i + 2))
    b = sp.ImmutableMatrix([0, 0, *(-ACCELERATION)])
    return bound("own ship's", A, b, [(acceleration, ACCELERATION)], times)


@cache
def bearings_only() -> StateView:
    """Return the view of a target by its bearing alone, in modified polar coordinates (Aidala and Hammel 1983).

    Measured is the bearing y3 from the axis Y in rad; hidden are its rate y1, y2 = R'/R, and y4 = 1/R.  The range R
    enters with the own acceleration only, so that a straight course never shows it.

    See Also
    --------
    own_ship : The motion.
    percept_obs.recording.scenarios.own_ship_turns : An example.

    Examples
    --------
    >>> form = bearings_only().partition("y3").canonical_form()
    >>> form.w.T, form.hidden
    (Matrix([[1, 0, 0]]), ('y1', 'y2', 'y4'))
    """
    motion, R2 = own_ship(), X**2 + Y**2
    rate = tuple(motion.A * sp.Matrix(STATE) + motion.b)
    rest = {y1: (U * Y - X * V) / R2, y2: (X * U + Y * V) / R2, y4: 1 / sp.sqrt(R2)}
    along, across = sp.Matrix([sp.sin(y3), sp.cos(y3)]), sp.Matrix([sp.cos(y3), -sp.sin(y3)])
    back = (*(along / y4), *((y2 * along + y1 * across) / y4))
    return StateView("bearing alone", STATE, rate, motion, {y3: sp.atan2(X, Y)}, rest, back, (1, 1, 1, 1))
