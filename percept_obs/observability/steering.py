"""Active vision: turn a camera's velocity so that the images tell more of the distance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
import sympy as sp

from percept_obs.compile import Table, solve
from percept_obs.compile.equations import Equations
from percept_obs.compile.integrator import EACH, LONGEST_STEP
from percept_obs.recording import Scenario
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.motion import Motion
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.signal import OverTime, Signal
from percept_obs.system.surfaces import POINT, ImagingSurface
from percept_obs.validation import checked, positive

kappa = sp.Symbol("kappa", real=True)

VELOCITIES = (("v_c1", "v_c2", "v_c3"), ("b1", "b2", "b3"))
"""Names of the velocity that is steered, of a rigid and of an affine motion."""


@checked
@dataclass(frozen=True)
class Steering:
    """Excitation of a form as a function of the velocity, and its gradient.

    Parameters
    ----------
    system : PerspectiveSystem
        All of its image coordinates are measured.
    velocity : tuple of three symbols
        Parameters of the motion that may be chosen.

    Raises
    ------
    ValueError
        If there is no canonical form with all image coordinates measured.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, pinhole, rigid, steering
    >>> found = steering(PerspectiveSystem(rigid(), pinhole()))
    >>> found.velocity
    (v_c1, v_c2, v_c3)
    >>> found.excitation
    (-v_c1 + v_c3*y1 + v_p1 - v_p3*y1)**2 + (-v_c2 + v_c3*y2 + v_p2 - v_p3*y2)**2
    """

    system: PerspectiveSystem
    velocity: tuple[sp.Symbol, ...]

    @cached_property
    def form(self) -> CanonicalForm:
        """Canonical form with all image coordinates measured; the inverse distance alone is hidden."""
        return self.system.measure(*(symbol.name for symbol in self.system.surface.image_coordinates))

    @property
    def excitation(self) -> sp.Expr:
        """The eigenvalue of w w^T, which is |w|^2 with one hidden coordinate."""
        return sum((entry**2 for entry in self.form.w), sp.S.Zero)

    @cached_property
    def matrix(self) -> sp.ImmutableMatrix:
        """W of |w|^2 = v^T W v, if w is linear in the velocity; its largest eigenvector is the best direction."""
        return sp.ImmutableMatrix(sp.hessian(self.excitation, self.velocity) / 2)

    @cached_property
    def gradient(self) -> sp.ImmutableMatrix:
        """Derivative of the excitation with respect to the velocity, a column."""
        return sp.ImmutableMatrix([self.excitation]).jacobian(self.velocity).T

    @cached_property
    def turning(self) -> sp.ImmutableMatrix:
        """The gradient without its part along the velocity, which would change the speed."""
        v = sp.ImmutableMatrix(self.velocity)
        return self.gradient - v * (v.T * self.gradient)[0] / (v.T * v)[0]

    def _repr_latex_(self) -> str:
        v = sp.latex(sp.Matrix(self.velocity))
        rate = rf"\frac{{d}}{{dt}} {v} = \kappa \left(1 - \frac{{v v^T}}{{v^T v}}\right) {sp.latex(self.gradient)}"
        return rf"$\displaystyle \sigma^2 = {sp.latex(self.excitation)},\quad {rate}$"


@checked
def steering(system: PerspectiveSystem, velocity: Sequence[str] | None = None) -> Steering:
    """Derive the turn of a velocity by which the excitation grows fastest; it needs no distance.

    Parameters
    ----------
    system : PerspectiveSystem
        All of its image coordinates are measured.
    velocity : sequence of three str, optional
        Parameters of the motion that may be chosen; the camera's velocity of a rigid motion and b of an affine one
        when left out.

    Returns
    -------
    Steering

    Raises
    ------
    ValueError
        If the motion has no such parameters.

    See Also
    --------
    steered : A scenario that is steered so.

    Notes
    -----
    Spica, Robuffo Giordano and Chaumette, Active structure from motion, IEEE Trans. Robotics 30 (2014), steer by the
    same eigenvalue.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole, steering
    >>> steering(PerspectiveSystem(affine(), pinhole())).gradient[0].expand()
    2*b1 - 2*b3*y1
    """
    known = {symbol.name: symbol for symbol in system.motion.parameters}
    names = next((each for each in VELOCITIES if set(each) <= set(known)), ()) if velocity is None else tuple(velocity)
    if len(set(names)) != len(POINT) or not set(names) <= set(known):
        raise ValueError(
            f"the velocity has the names {', '.join(names) or 'none'}; give three of the motion's parameters, which "
            f"are {', '.join(known) or 'none'}"
        )
    return Steering(system, tuple(known[name] for name in names))


@checked
def steered(
    scenario: Scenario, gain: float = 5.0, velocity: Sequence[str] | None = None, step: float = LONGEST_STEP
) -> Scenario:
    """Steer a scenario's velocity towards more excitation, at the same speed.

    With the velocity v, v' = kappa (1 - v v^T / v^T v) d|w|^2 / dv.  It depends on the image and not on the distance,
    so that a camera can do it; here it sees the image without noise.

    Parameters
    ----------
    scenario : Scenario
        With a constant motion, whose velocity is that of the beginning and not zero.
    gain : float
        kappa in 1/s; positive.
    velocity : sequence of three str, optional
        See `steering`.
    step : float
        Seconds from one integration step to the next.

    Returns
    -------
    Scenario

    Raises
    ------
    ValueError
        If the motion varies or has no such parameters, the velocity is zero, or a number is not positive.

    See Also
    --------
    steering : The law in symbols.

    Examples
    --------
    >>> from percept_obs import Camera, Gaussian, PerspectiveSystem, Scenario, affine, cramer_rao, pinhole, record
    >>> from percept_obs import steered
    >>> ahead = Scenario("ahead", affine([[0.0] * 3] * 3, [0, 0, -0.3]), (0.2, 0.1, 4), 5, pinhole())
    >>> system = PerspectiveSystem(affine(), pinhole())
    >>> seen = [record(each, camera=Camera(0.05, Gaussian(0.01))) for each in (ahead, steered(ahead))]
    >>> straight, turned = (cramer_rao(each, system).relative[-1] for each in seen)
    >>> bool(straight > 2 * turned)
    True
    """
    from scipy.interpolate import CubicSpline

    motion, surface = scenario.motion, scenario.surface
    positive(gain=gain, step=step)
    if not motion.parameters or set(motion.values) != set(motion.parameters):
        raise ValueError(f"the {motion.name} motion varies or has no parameters; steer a constant affine(A, b)")
    found = steering(PerspectiveSystem(replace(motion, signal=None), surface), velocity)
    begin = [motion.values[symbol] for symbol in found.velocity]
    if not np.any(begin):
        raise ValueError("the velocity is zero, and turning does not change that; give the camera a speed")
    equations = _closed_loop(motion.A, motion.b, motion.parameters, surface, found.velocity)
    count = int(np.ceil(scenario.duration / step - 1e-9)) + 1  # one step more than the duration needs
    fixed = [{**motion.values, **surface.values}[symbol] for symbol in equations.parameters]
    table = Table(np.full(count, step), np.empty((count, EACH + 1, 0)), np.array([fixed]), np.empty((count + 1, 0)))
    trace = solve(equations, [*scenario.position, *begin], table, [gain])
    if trace.diverged is not None:
        when = f"{trace.diverged * step:.3g} s"
        raise ValueError(
            f"steered with gain = {gain} the motion leaves every bound after {when}; take a smaller gain, or a shorter "
            "duration of the scenario"
        )
    rows = np.tile([motion.values[symbol] for symbol in motion.parameters], (count + 1, 1))
    rows[:, [motion.parameters.index(symbol) for symbol in found.velocity]] = trace.states[:, 3:]
    smooth = CubicSpline(step * np.arange(count + 1, dtype=float), rows)
    moving = replace(motion, signal=Signal(OverTime(lambda times: np.asarray(smooth(times)))))
    return replace(scenario, name=f"{scenario.name}, steered", motion=moving)


@lru_cache(maxsize=32)
def _closed_loop(
    A: sp.ImmutableMatrix,
    b: sp.ImmutableMatrix,
    parameters: tuple[sp.Symbol, ...],
    surface: ImagingSurface,
    velocity: tuple[sp.Symbol, ...],
) -> Equations:
    """Equations of a point and of the velocity that its image steers."""
    found = Steering(PerspectiveSystem(Motion("steered", A, b, parameters), surface), velocity)
    seen = dict(zip(surface.image_coordinates, surface.image, strict=True))
    turning = (kappa * found.turning).xreplace(seen)
    others = tuple(symbol for symbol in found.system.parameters if symbol not in velocity)
    return Equations((*POINT, *velocity), (*(A * sp.ImmutableMatrix(POINT) + b), *turning), (), others, (kappa,))
