"""Active vision: turn a camera's velocity so that the images tell more of the distance."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import count

import numpy as np
import sympy as sp

from percept_obs.compile import Array, vectorised
from percept_obs.compile.integrator import LONGEST_STEP
from percept_obs.recording import Scenario
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.signal import OverTime, Signal
from percept_obs.system.surfaces import POINT
from percept_obs.validation import checked, limit

VELOCITIES = (("v_c1", "v_c2", "v_c3"), ("b1", "b2", "b3"))
"""Names of the velocity that is steered, of a rigid and of an affine motion."""

GAIN = 5.0
"""Gain kappa of a steered motion in 1/s."""

MOST_EVALUATIONS = 20_000
"""Largest number of evaluations of a steered motion: a few seconds of computing."""


@checked
@dataclass(frozen=True)
class Steering:
    """Excitation of a form as a function of the velocity, and its gradient, from `steering`.

    Parameters
    ----------
    system : PerspectiveSystem
        All of its image coordinates are measured.
    velocity : tuple of three symbols
        Parameters of the motion that may be chosen.

    Raises
    ------
    ValueError
        If the velocity is no three symbols, or there is no canonical form with all image coordinates measured.

    See Also
    --------
    steered : Steers a scenario by it.

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
    velocity: tuple[sp.Symbol, sp.Symbol, sp.Symbol]

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
def steering(system: PerspectiveSystem) -> Steering:
    """Derive the turn of a velocity by which the excitation grows fastest; it needs no distance.

    Parameters
    ----------
    system : PerspectiveSystem
        All of its image coordinates are measured.  Turned is the camera's velocity of a rigid motion, or b of an
        affine one.

    Returns
    -------
    Steering
        Excitation and its gradient as functions of image and velocity.

    Raises
    ------
    ValueError
        If the motion has neither.

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
    names = next((each for each in VELOCITIES if set(each) <= set(known)), None)
    if names is None:
        raise ValueError(f"the motion's parameters are {', '.join(known) or 'none'}; take a rigid() or affine() motion")
    first, second, third = (known[name] for name in names)
    return Steering(system, (first, second, third))


@checked
def steered(scenario: Scenario) -> Scenario:
    """Steer a scenario's velocity towards more excitation, at the same speed.

    With the velocity v, v' = kappa (1 - v v^T / v^T v) d|w|^2 / dv and kappa = 5/s.  It depends on the
    image and not on the distance, so that a camera can do it; here it sees the image without noise.

    Parameters
    ----------
    scenario : Scenario
        With a constant motion, whose velocity is that of the beginning and not zero.

    Returns
    -------
    Scenario
        With the velocity that was steered as a function of time.

    Raises
    ------
    ValueError
        If the motion varies, the velocity is zero, or it turns too fast.

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
    from scipy.integrate import solve_ivp
    from scipy.interpolate import CubicSpline

    motion, surface = scenario.motion, scenario.surface
    if not motion.parameters or set(motion.values) != set(motion.parameters):
        raise ValueError(f"the {motion.name} motion varies or has no parameters; steer a constant affine(A, b)")
    found = steering(PerspectiveSystem(replace(motion, signal=None), surface))
    start = [motion.values[symbol] for symbol in found.velocity]
    if not np.any(start):
        raise ValueError("the velocity is zero, and turning does not change that; give the camera a speed")
    state = (*POINT, *found.velocity)
    turning = GAIN * found.turning.xreplace(dict(zip(surface.image_coordinates, surface.image, strict=True)))
    fixed = {s: value for s, value in {**motion.values, **surface.values}.items() if s not in found.velocity}
    rate = vectorised(state, [*(motion.A * sp.ImmutableMatrix(POINT) + motion.b), *turning], fixed)
    size = scenario.duration / LONGEST_STEP * len(motion.parameters)
    limit(size, "numbers of a velocity", "take a shorter duration of the scenario")
    times = LONGEST_STEP * np.arange(int(np.ceil(scenario.duration / LONGEST_STEP - 1e-9)) + 2.0)  # beyond the end
    refused = ValueError(
        f"steered, the motion leaves every bound or turns too fast within {scenario.duration:.4g} s; take a shorter "
        "duration of the scenario"
    )
    evaluations = count(1)

    def flow(time: float, x: Array) -> Array:
        if next(evaluations) > MOST_EVALUATIONS:
            raise refused
        return np.array(rate(*x))

    ends, begin = (0.0, float(times[-1])), [*scenario.position, *start]
    with np.errstate(all="ignore"):  # LSODA, for a large speed makes the equations stiff
        path = solve_ivp(flow, ends, begin, "LSODA", times, rtol=1e-9, atol=1e-12)
    if not path.success or not np.isfinite(path.y).all():
        raise refused
    rows = np.tile([motion.values[symbol] for symbol in motion.parameters], (len(times), 1))
    rows[:, [motion.parameters.index(symbol) for symbol in found.velocity]] = path.y[3:].T
    moving = replace(motion, signal=Signal(OverTime(CubicSpline(times, rows))))
    return replace(scenario, name=f"{scenario.name}, steered", motion=moving)
