"""The equivariant filter: direction and range as a scaled rotation, which a correction turns and scales."""

from functools import lru_cache

import sympy as sp

from percept_obs.observers.extended_kalman import EXACT, GIVEN, NEVER, P1, Q, R
from percept_obs.observers.family import Derived, family
from percept_obs.observers.gains import Gain, grid
from percept_obs.observers.known_motion import NeedsMotion, motion_on_surface, on_surface, symmetric, upper
from percept_obs.observers.parts import first_seen, hats
from percept_obs.system.forms import CanonicalForm, NeedsMoreOutputs
from percept_obs.system.motion import cross
from percept_obs.system.perspective import gradients_on
from percept_obs.system.surfaces import POINT

PR, least = sp.symbols("P0r y_min", real=True)

DOUBT = "variance per second of direction and relative range by which the motion is doubted"
FAR, INFINITE = "inverse distance that stands for a start farther away", "a range must be finite"


def needs_all(form: CanonicalForm) -> ValueError | None:
    """Return an error if the form has no motion on a plain surface, or an image coordinate is hidden."""
    if (found := on_surface(form)) is not None:
        return found
    surface = motion_on_surface(form)[2]
    if len(form.x2) > 1:
        return NeedsMoreOutputs(form)
    if surface.distance not in POINT:
        return NeedsMotion(
            f"the filter's equations on the {surface.name} are too long to compile; use a surface whose distance is a "
            "coordinate of the point, such as the pinhole, or the extended Kalman filter"
        )
    return None


@family(
    name="equivariant",
    title="Equivariant filter (EqF)",
    source="van Goor, Hamel and Mahony 2020",
    needs="all image coordinates of the pinhole or alike; the motion",
    claim="local; the estimate stays in front of the camera, as no correction turns a range around",
    gains=(
        Gain(R, "noise_variance", 1e-4 / 3, 1e-7, 1e-2, "1", "variance of the noise in each output", R > 0, EXACT),
        Gain(Q, "process_noise", 0, 0, 1e-2, "1/s", DOUBT, Q >= 0, "it is a variance"),
        Gain(P1, "measured_variance", 1, 1e-4, 10, "1", GIVEN, P1 > 0, NEVER),
        Gain(PR, "range_variance", 1, 0.01, 10, "1", "variance of the logarithm of the first range", PR > 0, NEVER),
        Gain(least, "least_inverse", 0.1, 0.001, 1, "1/m", FAR, least > 0, INFINITE),
    ),
    candidates=grid(noise_variance=(1.6e-5, 6.4e-5, 2.6e-4, 1e-3), process_noise=(0, 1e-5, 1e-4)),
    objection_of=needs_all,
)
@lru_cache(maxsize=8)  # it takes a fifth of a second
def equivariant_filter(form: CanonicalForm) -> Derived:
    """Equivariant filter (EqF): the extended Kalman filter of an error that the point's symmetries leave as it is.

    The point is X = G (e3 + d) with a scaled rotation G, whose third column is the estimate, and with the error d:
    across the ray in the first two entries, along it in the third, all relative to the range.  With the generator
    c^ = c3 I + [e3 x c]x of the scaled rotation that moves e3 by c, and the covariance S of d::

        G' = G u^,  u = G^-1 (A G e3 + b)
        S' = F S + S F^T + Q I,  F = G^-1 A G - u^

    Without a correction d' = F d holds exactly.  At a sample of each measured output y_j in turn, with the mean of the
    gradients of y_j at the estimate and at the measured ray, at one distance, for h (times G; 0 along the ray)::

        k = S h^T / (h S h^T + R),  c = k (y_j - yhat_j),  G <- G (I + c^/2)^2,  S <- S - k h S

    (I + c^/2)^2 is the exponential of c^ to the second order, and scales by a square, so that a range stays positive.
    With the mean of both gradients h d misses a direction that is turned by s by s^3/12, with either one by s^2.

    See Also
    --------
    extended_kalman

    Notes
    -----
    P. van Goor, T. Hamel, R. Mahony, Equivariant filter (EqF), 2020 (arXiv:2006.08276); its gains and its linearised
    output are those of a continuous measurement, here they are taken at samples.  Range zero and infinity cannot be
    left, so a start beyond 1 / `least_inverse` begins there.  On Ma's example (35) its basin is not wider than that of
    the extended Kalman filter, and after a start ten times too near it claims too much
    (`tests/studies/basin_study.py`).

    Examples
    --------
    >>> from percept_obs import PerspectiveSystem, affine, pinhole, record, scenarios, track
    >>> from percept_obs.observers import equivariant_filter
    >>> observer = equivariant_filter(PerspectiveSystem(affine(), pinhole()))
    >>> track(record(scenarios.ma2005_eq35(), 5), observer).settling_time(0.1) < 1
    True
    """
    A, b, surface = motion_on_surface(form)
    y, e3, one = surface.image_coordinates, sp.ImmutableMatrix([0, 0, 1]), sp.ImmutableMatrix(sp.eye(3))
    G, S = sp.ImmutableMatrix(3, 3, sp.symbols("G1:4(1:4)", real=True)), symmetric("S")
    inverse = G.T / (G.T * G)[2, 2]
    moved = generator(inverse * (A * G * e3 + b))
    F = inverse * A * G - moved
    flow = (*(G * moved), *upper(F * S + S * F.T + Q * one))

    here = dict(zip(POINT, G * e3, strict=True))
    image = sp.ImmutableMatrix([*surface.image, 1 / surface.distance])
    slopes, seen = image.jacobian(POINT).xreplace(here), image.xreplace(here)
    updates = []
    for k in map(y.index, form.x1):
        # other outputs have samples of their own, before or after this one
        at_sample = gradients_on(surface)[k, :].xreplace({y[j]: seen[j] for j in range(len(y)) if j != k})
        h = ((slopes[k, :] + at_sample * seen[len(y)]) / 2 * G[:, :2]).row_join(sp.zeros(1))
        gain = S * h.T / ((h * S * h.T)[0] + R)
        half = one + generator(gain * (y[k] - seen[k])) / 2
        updates.append((*(G * half * half), *upper(S - gain * h * S)))

    hat = dict(zip(surface.coordinates, hats(surface.coordinates), strict=True))
    ray = sp.ImmutableMatrix(surface.ray)
    size, wanted = sp.sqrt(ray.dot(ray)), hat[surface.inverse_distance]
    axis = cross(e3.cross(ray / size))
    turn = one + axis + axis**2 / (1 + ray[2] / size)
    across = (turn.T * (ray / size).jacobian(y))[:2, :]
    spread = across * sp.diag(*(P1 + (R - P1) * flag for flag in first_seen(y))) * across.T
    nearest = (wanted + least + sp.Abs(wanted - least)) / 2  # the larger of both
    start = tuple(e.xreplace(hat) for e in (*(turn * size / nearest), *upper(sp.diag(spread, PR))))
    order = [surface.coordinates.index(x) for x in (*form.x1, *form.x2)]
    J, estimate = (slopes * G).extract(order, [0, 1, 2]), tuple(seen[k] for k in order)
    return Derived((*G, *upper(S)), flow, start, estimate, tuple(updates), covariance=J * S * J.T)


def generator(c: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """Return c^ = c3 I + [e3 x c]x, the generator of the scaled rotation that moves e3 by c."""
    return sp.ImmutableMatrix([[c[2], 0, c[0]], [0, c[2], c[1]], [-c[0], -c[1], c[2]]])
