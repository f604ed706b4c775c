"""The observer that estimates constants: generalised parameter estimation, dynamic regressor extension and mixing."""

import sympy as sp

from percept_obs.observers.family import Derived, family
from percept_obs.observers.gains import Gain, grid
from percept_obs.observers.known_motion import NeedsMotion, motion_on_surface, on_surface, symmetric, upper
from percept_obs.observers.parts import NOISE_GAIN, hats, sigma2
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.perspective import gradients_on
from percept_obs.system.surfaces import POINT

gamma, forgetting, mu = sp.symbols("gamma l mu", real=True)

LOST = "how fast old samples lose their weight"
LITTLE = "square of the determinant of the information below which an estimate hardly moves"


def no_equation(form: CanonicalForm) -> NeedsMotion | None:
    """Return an error if the form has no motion on a surface of two outputs, or hidden outputs enter B."""
    if (found := on_surface(form)) is not None:
        return found
    surface = motion_on_surface(form)[2]
    image = surface.image_coordinates
    if len(image) != 2:
        return NeedsMotion(f"the {surface.name} has {len(image)} outputs; use one with 2")
    if unknown := _annihilator(form).free_symbols & {*image} - {*form.x1}:
        names = ", ".join(sorted(map(str, unknown)))
        return NeedsMotion(f"{names} must be measured as well, for the equation of the point on its ray needs it here")
    return None


@family(
    name="GPEBO",
    title="Generalised parameter estimation-based observer (GPEBO) with DREM",
    source="Ortega et al. 2020",
    needs="both outputs, or one on a flat image; the motion",
    claim="exponential with the rate gamma, from any start and from infinity, once D^2 is far larger than mu",
    gains=(
        Gain(gamma, "gain", 10, 1, 100, "1/s", "rate of the constants' estimates", gamma > 0, "errors must shrink"),
        Gain(forgetting, "forgetting", 0.1, 0, 2, "1/s", LOST, forgetting >= 0, "the past would grow"),
        Gain(mu, "caution", 1e-12, 1e-20, 1e-6, "m^4 s^6", LITTLE, mu > 0, "D may be 0"),
        NOISE_GAIN,
    ),
    candidates=grid(gain=(5, 20), forgetting=(0.1, 0.5), caution=(1e-15, 1e-12), noise_variance=(1e-5, 1e-4)),
    objection_of=no_equation,
)
def gpebo(form: CanonicalForm) -> Derived:
    """Generalised parameter estimation-based observer (GPEBO), with dynamic regressor extension and mixing (DREM).

    The motion turns the state into constants: with Phi' = A Phi and xi' = A xi + b, xi(0) = 0, the point is
    X = (Phi (q1, q2, 1) + rho xi) / rho.  Phi(0) = (dm/dy, m) of the first sample, so that q1, q2 and rho are what is
    missing to the first image, and the first inverse distance; a start at infinity is rho = 0.  The gradients B of the
    measured outputs annihilate the ray, so that each output gives an equation that is linear in theta = (q1, q2, rho)::

        phi theta = r,  phi = B (Phi e1, Phi e2, xi) / |Phi|,  r = -B Phi e3 / |Phi|
        Q' = phi^T phi - sigma^2 N - l Q,  Y' = phi^T r - sigma^2 n - l Y
        thetahat' = gamma D (adj(Q) Y - D thetahat) / (mu + D^2),  D = det Q

    Without noise Y = Q theta, so that each constant's error shrinks with the rate gamma D^2 / (mu + D^2) by itself.
    N and n are the bias of squared noise: sums of (dphi/dy)^T dphi/dy and (dphi/dy)^T dr/dy over the measured outputs.
    Division by |Phi| keeps a motion that grows from outweighing what was seen before.

    See Also
    --------
    identifier_based

    Notes
    -----
    R. Ortega, A. Bobtsov, N. Nikolaev, J. Schiffer, D. Dochain, Generalized parameter estimation-based observers, 2020
    (arXiv:2003.10952); S. Aranovskiy, A. Bobtsov, R. Ortega, A. Pyrkin, Performance enhancement of parameter
    estimators via dynamic regressor extension and mixing, IEEE Trans. Automatic Control 62(7), 2017.  There theta is
    X(0), which is infinite for a start at infinity.

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole, record, scenarios, track
    >>> from percept_obs.observers import gpebo
    >>> observer = gpebo(PerspectiveSystem(affine(), pinhole()).measure("y1"))
    >>> print(f"{track(record(scenarios.ma2005_eq35(), 5), observer).settling_time(0.1):.1f} s")
    2.9 s
    """
    A, b, surface = motion_on_surface(form)
    Phi = sp.ImmutableMatrix(3, 3, sp.symbols("Phi1:4(1:4)", real=True))
    xi, Y, theta = (sp.ImmutableMatrix(sp.symbols(names, real=True)) for names in ("xi1:4", "Y1:4", "q1:3 rho"))
    Q = symmetric("Q")
    both = _annihilator(form) * Phi[:, :2].row_join(xi).row_join(-Phi[:, 2])  # (phi, r) |Phi|
    square = both.T * both - sigma2 * sum((both.diff(y).T * both.diff(y) for y in form.x1), sp.zeros(4))
    square /= sum(entry**2 for entry in Phi)
    D = Q.det(method="berkowitz")
    constants = gamma * D / (mu + D**2) * (Q.adjugate() * Y - D * theta)

    def state(Phi: sp.Matrix, xi: sp.Matrix, Q: sp.Matrix, Y: sp.Matrix, theta: sp.Matrix) -> tuple[sp.Expr, ...]:
        return (*Phi, *xi, *upper(Q), *Y, *theta)

    flow = state(A * Phi, A * xi + b, square[:3, :3] - forgetting * Q, square[:3, 3] - forgetting * Y, constants)
    ray, zero = sp.ImmutableMatrix(surface.ray), sp.zeros(3)
    frame = ray.jacobian(surface.image_coordinates).row_join(ray)
    seen = dict(zip(surface.coordinates, hats(surface.coordinates), strict=True))
    first = sp.ImmutableMatrix([0, 0, seen[surface.inverse_distance]])
    start = state(frame.subs(seen, simultaneous=True), zero[:, 0], zero, zero[:, 0], first)
    point = dict(zip(POINT, Phi[:, :2].row_join(xi) * theta + Phi[:, 2], strict=True))  # times rho
    estimate = (*(entry.xreplace(point) for entry in surface.image), theta[2] / surface.distance.xreplace(point))
    order = [surface.coordinates.index(x) for x in (*form.x1, *form.x2)]
    return Derived(state(Phi, xi, Q, Y, theta), flow, start, tuple(estimate[k] for k in order))


def _annihilator(form: CanonicalForm) -> sp.ImmutableMatrix:
    """Gradients of the measured outputs on the ray, shape (n1, 3), which are orthogonal to it."""
    surface = motion_on_surface(form)[2]
    return gradients_on(surface).extract([surface.image_coordinates.index(y) for y in form.x1], [0, 1, 2])
