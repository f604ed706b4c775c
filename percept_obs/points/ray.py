"""Error of one point across and along its ray: why a constant P has a best size, and the fastest decay."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import sympy as sp

from percept_obs.compile import Array
from percept_obs.points.block import point_block
from percept_obs.points.form import PointsForm
from percept_obs.system.derivation import Derivation, equals
from percept_obs.system.surfaces import pinhole
from percept_obs.validation import checked, numbers


@dataclass(frozen=True)
class RayError:
    """The error of a point, z' = M z, in axes that turn with its ray: z = (across, along).

    Parameters
    ----------
    gain : symbol
        k, the correction of the error across the ray, in 1/s: (1 + |y|^2) / P.
    turning : symbol
        omega, the rate in rad/s at which the ray turns against the known rotation.
    matrix : matrix of shape (2, 2)
        The matrix M.

    See Also
    --------
    ray_error : Derives it.

    Examples
    --------
    >>> from percept_obs.points.ray import ray_error
    >>> error = ray_error()
    >>> error.best_gain, error.best_decay, error.over_gain
    (2*omega, omega, omega**2/k)
    """

    gain: sp.Symbol
    turning: sp.Symbol
    matrix: sp.ImmutableMatrix

    @cached_property
    def eigenvalues(self) -> tuple[sp.Expr, sp.Expr]:
        """Eigenvalues of M; of a large gain, the fast one and the slow one."""
        fast, slow = sorted(
            self.matrix.eigenvals(multiple=True), key=lambda value: sp.limit(value / self.gain, self.gain, sp.oo)
        )
        return fast, slow

    @cached_property
    def best_gain(self) -> sp.Expr:
        """The gain at which the eigenvalues meet: critical damping."""
        fast, slow = self.eigenvalues
        (best,) = sp.solve((fast - slow) ** 2, self.gain)
        return best

    @property
    def best_decay(self) -> sp.Expr:
        """Rate at which errors decay at the best gain; no constant gain is faster."""
        return -self.eigenvalues[1].subs(self.gain, self.best_gain)

    @property
    def over_gain(self) -> sp.Expr:
        """Asymptotic rate for a gain that is far too large."""
        return sp.limit(-self.eigenvalues[1] * self.gain, self.gain, sp.oo) / self.gain

    def derivation(self) -> Derivation:
        """From the error's rate to the best gain, step by step."""
        k, omega = sp.latex(self.gain), sp.latex(self.turning)
        formulas = {
            "In axes across and along the ray, which turns, the error obeys:": (
                equals(r"\dot z", sp.latex(self.matrix) + r"\, z")
            ),
            "Its rates are:": r",\quad ".join(map(sp.latex, self.eigenvalues)),
            "They meet, and the slow one is fastest, at:": equals(k, self.best_gain),
            "Errors then decay at the rate:": sp.latex(self.best_decay),
            "A larger gain holds the estimate on the ray and lets nothing along it; the rate tends to:": (
                rf"{sp.latex(self.over_gain)} \quad ({k} \gg {omega})"
            ),
        }
        return Derivation.of(formulas)


@lru_cache(maxsize=1)
def ray_error() -> RayError:
    """Return the error of a point, from its block, in the plane in which its ray turns.

    The point is seen at y(t) = (y1(t), 0) by a pinhole, the camera turns in the same plane at a known rate, and P is a
    multiple of the identity.

    Raises
    ------
    ArithmeticError
        If the error has another form, which would be a mistake in the package.

    See Also
    --------
    ray_turning : Numbers for omega along a run.

    Examples
    --------
    >>> from percept_obs.points.ray import ray_error
    >>> ray_error().matrix
    Matrix([
    [   -k, -omega],
    [omega,      0]])
    """
    block, t = point_block(pinhole()), sp.Symbol("t", real=True)
    y1 = sp.Function(block.y[0].name, real=True)(t)
    known, inverse, gain, turning = sp.symbols("a Q k omega", positive=True)
    B = block.B.subs(dict(zip(block.y, (y1, 0), strict=True)))
    (ray,) = B.nullspace()
    turn = sp.Matrix([[0, 0, known], [0, 0, 0], [-known, 0, 0]])
    axes = sp.Matrix.hstack(turn * ray, known * ray) / (known * sp.sqrt(ray.dot(ray)))  # across, along
    # z = axes^T rho turns with the ray, so the rate of the axes is taken off the error's own
    M = (axes.T * (turn * axes - axes.diff(t) - inverse * B.T * B * axes)).applyfunc(sp.cancel)
    corrected, against = -M[0, 0], M[1, 0]
    named = sp.ImmutableMatrix([[-gain, -turning], [turning, 0]])
    if (M - named.subs({gain: corrected, turning: against})).expand() != sp.zeros(2):
        raise ArithmeticError("the error about the ray has another form; is the ray the kernel of B?")
    return RayError(gain, turning, named)


@checked
def ray_turning(form: PointsForm, times: Array, states: Array) -> Array:
    """Return the rate in rad/s at which the input v turns the ray of each point, shape (K, p).

    It is v_k across the ray, over the range.

    Parameters
    ----------
    form : PointsForm
    times : array of shape (K,)
        Seconds.
    states : array of shape (K, n)
        True states.

    See Also
    --------
    ray_error : Decay of errors at this rate.

    Examples
    --------
    >>> from percept_obs.points.ray import ray_turning
    >>> from percept_obs.points.scenarios import moving_body
    >>> scene, times = moving_body(1), np.array([0.0, 10.0])
    >>> ray_turning(scene.form, times, scene.coordinates(times)).round(3).tolist()
    [[0.488], [0.157]]
    """
    times, states = numbers(times, "the times", "K"), numbers(states, "the states", "K", form.states)
    points, velocities = form.locate(states), form.locate(form.coefficients(times)[1])
    across = np.linalg.norm(np.cross(points, velocities), axis=-1)
    return np.asarray(across / (points**2).sum(axis=-1))
