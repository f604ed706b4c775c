"""De Luca, Oriolo and Robuffo Giordano 2008: the depth of a point feature, observed by a camera that moves.

A. De Luca, G. Oriolo, P. Robuffo Giordano, Feature depth observation for image-based visual servoing: theory and
experiments, Int. J. Robotics Research 27(10), 1093-1116, 2008, doi:10.1177/0278364908096706.

The print was not at hand.  What stands here is what the paper is about, as its abstract and the literature after it
state it, in the letters of visual servoing; not the paper's own numbers of equations, and not its own wording.  So
places are names, pages stand only where the abstract says it, and "holds" says that the statement is true, not that it
was printed without a slip.

The camera moves with v and turns with omega, in its own frame; the point is at rest.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from percept_obs.observers import de_luca, identifier_based
from percept_obs.observers.de_luca import H, Lam
from percept_obs.observers.parts import sigma2
from percept_obs.papers.base import dot, identities, is_identity, reader, vanishes
from percept_obs.papers.entries import Finding, Known, Printed, Values, Verdict, at, judged
from percept_obs.recording import Camera, Scenario, record
from percept_obs.system.motion import rigid
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import pinhole
from percept_obs.tracking.following import track

FORM = PerspectiveSystem(rigid(), pinhole()).measure("y1", "y2")
OBSERVER = de_luca(FORM)

STATE = x, y, chi = sp.symbols("x y chi", real=True)
ESTIMATE = xhat, yhat, chihat = sp.symbols("xhat yhat chihat", real=True)
ERROR = e_x, e_y, e_chi = sp.symbols("e_x e_y e_chi", real=True)
VELOCITY = v_x, v_y, v_z = sp.symbols("v_x v_y v_z", real=True)
TURNING = omega_x, omega_y, omega_z = sp.symbols("omega_x omega_y omega_z", real=True)
OMEGA = Omega1, Omega2 = sp.symbols("Omega1 Omega2", real=True)
PIXELS = x_p, y_p = sp.symbols("x_p y_p", real=True)
f = sp.Symbol("f", positive=True)
gamma, t, T = sp.symbols("gamma t T", positive=True)
reads = reader(f)

# The package's point may move as well.
LETTERS: Values = dict(
    zip(
        (*FORM.coordinates, *OBSERVER.equations.state, *OBSERVER.error, *FORM.parameters),
        (*STATE, *ESTIMATE, *ERROR, *TURNING, *VELOCITY, 0, 0, 0),
        strict=True,
    )
)


@cache
def derived() -> Values:
    """Rates of the point, of its estimate and of the error, and what the inverse depth is multiplied by."""
    rates = zip((*STATE, *ERROR), (*FORM.rate, *OBSERVER.error_dynamics()), strict=True)
    return {dot(s): sp.expand(rate.xreplace(LETTERS)) for s, rate in rates} | dict(
        zip(OMEGA, FORM.w.xreplace(LETTERS), strict=True)
    )


@cache
def observed() -> Values:
    """Rates of the observer's estimate."""
    flow = zip(ESTIMATE, OBSERVER.equations.flow, strict=True)
    return {dot(s): rate.xreplace(LETTERS) for s, rate in flow}


def in_pixels() -> Values:
    """Rates of the image, f times as large, of a camera that turns on the spot."""
    still = dict.fromkeys(VELOCITY, sp.S.Zero) | {x: x_p / f, y: y_p / f}
    return {dot(p): f * derived()[dot(s)].xreplace(still) for p, s in zip(PIXELS, STATE, strict=False)}


def turning_shows_the_focal_length(printed: Printed) -> Finding:
    """The image's rate where the camera turns only: it has f in it and no depth."""
    rates = in_pixels().values()
    told = all(rate.has(f) and not rate.has(chi) for rate in rates)
    return judged(told and all(is_identity(line, in_pixels()) for line in printed))


def along_the_ray(printed: Printed) -> Finding:
    """Velocities for which what the inverse depth is multiplied by vanishes: all of them, and no others."""
    given = {line.lhs: line.rhs for line in printed}
    just_these = set(given) == {v_x, v_y} and all(
        vanishes(derived()[o] + line.lhs - line.rhs) for o, line in zip(OMEGA, printed, strict=True)
    )
    return judged(just_these and vanishes(*(derived()[o].xreplace(given) for o in OMEGA)))


def excites(printed: Printed) -> Finding:
    """Constant Omega, g left out: errors with H = 5, Lambda = 10 decay just where the printed integral is > 0."""
    (line,) = printed
    constant = line.lhs.xreplace(dict(zip(PATH, OMEGA, strict=True))).doit()
    gathered = T * sum(o**2 for o in OMEGA)
    slope = sp.Matrix([[-H, 0, Omega1], [0, -H, Omega2], [-Lam * Omega1, -Lam * Omega2, 0]])
    same = vanishes(constant - gathered) and isinstance(line, sp.GreaterThan) and line.rhs == gamma
    slowest = {}
    for speed in (0, 1, 2):
        values = {Omega1: sp.Rational(3 * speed, 10), Omega2: sp.Rational(2 * speed, 5), H: 5, Lam: 10}
        slowest[speed] = max(float(sp.re(pole)) for pole in slope.subs(values).eigenvals(multiple=True))
    numbers = {f"slowest pole, |Omega| = {speed / 2}": pole for speed, pole in slowest.items()}
    return judged(same and slowest[2] < slowest[1] < slowest[0] == 0, numbers=numbers)


def from_near_and_far(printed: Printed) -> Finding:
    """One approach, two starts: the estimate settles from 1/Z = 0 and leaves all bounds from 5/m, 0.2 m."""
    approach = Scenario(
        "approach",
        rigid(camera_angular_velocity=(0, -0.05, 0), camera_velocity=(0.3, 0.2, 0.1)),
        (0.5, -0.25, 4),
        10,
        pinhole(),
    )
    film = record(approach, camera=Camera(0.01))
    near, far = (track(film, OBSERVER, [0.125, -0.0625, start]) for start in (0, 5))
    recovered = float(abs(near.error[-1, 2]))
    numbers = {"error of 1/Z after 10 s, from 0": recovered, "divergence from 5/m, in s": float(far.diverged_at or 0)}
    depends = recovered < 0.05 and far.diverged_at is not None
    return judged(False, Verdict.DEPENDS if depends else Verdict.FALSE, numbers)


def same_as_ma(printed: Printed) -> Finding:
    """The flow of the IBO, without its reset and its term for noise, is that of the depth observer."""
    gains = {line.lhs: line.rhs for line in printed}
    flow = [rate.subs(sigma2, 0) for rate in identifier_based(FORM).equations.flow]
    pairs = zip(flow, OBSERVER.equations.flow, strict=True)
    return judged(set(gains) == {H, Lam} and vanishes(*(ibo - rate.xreplace(gains) for ibo, rate in pairs)))


tau = sp.Symbol("tau", real=True)
PATH = tuple(sp.Function(o.name, real=True)(tau) for o in OMEGA)
GATHERED = sp.Integral(PATH[0] ** 2 + PATH[1] ** 2, (tau, t, t + T))

ENTRIES = (
    at("feature motion", "", "", "how a point at rest moves in the image")(
        reads(
            """x' = (x v_z - v_x) chi + x y omega_x - (1 + x^2) omega_y + y omega_z;
            y' = (y v_z - v_y) chi + (1 + y^2) omega_x - x y omega_y - x omega_z"""
        ),
        identities(derived),
    ),
    at("interaction matrix", "", "", "the same, linear in the camera's velocities")(
        reads(
            """[x', y'] = [[-chi, 0, x chi, x y, -(1 + x^2), y], [0, -chi, y chi, 1 + y^2, -x y, -x]]
            [v_x, v_y, v_z, omega_x, omega_y, omega_z]"""
        ),
        identities(derived),
    ),
    at("depth dynamics", "", "", "the inverse depth chi = 1/Z as a state that is not measured")(
        reads("chi' = v_z chi^2 + (y omega_x - x omega_y) chi"), identities(derived)
    ),
    at("Omega", "", "", "what chi is multiplied by in the image's rate")(
        reads("Omega1 = x v_z - v_x; Omega2 = y v_z - v_y"), identities(derived)
    ),
    at("depth observer", "", "", "a copy of both, with the image's innovation fed back")(
        reads(
            """xhat' = (x v_z - v_x) chihat + x y omega_x - (1 + x^2) omega_y + y omega_z + H (x - xhat);
            yhat' = (y v_z - v_y) chihat + (1 + y^2) omega_x - x y omega_y - x omega_z + H (y - yhat);
            chihat' = v_z chihat^2 + (y omega_x - x omega_y) chihat
            + Lambda ((x v_z - v_x) (x - xhat) + (y v_z - v_y) (y - yhat))"""
        ),
        identities(observed),
        "with one gain for both outputs; the measured x and y stand in the copy",
        known=Known.IMPLEMENTED,
    ),
    at("error dynamics", "", "", "truth less estimate")(
        reads(
            """e_x' = -H e_x + (x v_z - v_x) e_chi; e_y' = -H e_y + (y v_z - v_y) e_chi;
            e_chi' = (v_z (2 chi - e_chi) + y omega_x - x omega_y) e_chi
            - Lambda ((x v_z - v_x) e_x + (y v_z - v_y) e_y)"""
        ),
        identities(derived),
    ),
    at("persistency of excitation", "", "", "Omega must not vanish for long")(
        (sp.GreaterThan(GATHERED, gamma, evaluate=False),),
        excites,
        "for constant Omega, where it is enough and needed if g is left out",
    ),
    at("motions that show no depth", "1093", "abstract", "which camera motions allow the observation")(
        reads("v_x = x v_z; v_y = y v_z"),
        along_the_ray,
        "Omega = 0 if the camera only turns or moves along the point's ray, (v_x, v_y, v_z) = v_z (x, y, 1)",
    ),
    at("focal length", "1093", "abstract", "other motions show the focal length without the depth")(
        reads(
            """x_p' = x_p y_p omega_x / f - (f + x_p^2 / f) omega_y + y_p omega_z;
            y_p' = (f + y_p^2 / f) omega_x - x_p y_p omega_y / f - x_p omega_z"""
        ),
        turning_shows_the_focal_length,
        "the camera turns only; x_p = f x, y_p = f y",
    ),
    at("asymptotically", "1093", "abstract", "the observer asymptotically recovers the depth")(
        (),
        from_near_and_far,
        "on the start: v_z chihat^2 leads an estimate that begins too near to infinity while the camera approaches",
        Verdict.DEPENDS,
        known=Known.RUNS,
    ),
    at("IBO", "", "", "with these gains it is Ma's identifier-based observer")(
        reads("H = G A; Lambda = -G^2 P"),
        same_as_ma,
        "not a statement of this paper: how it is related to (11) of Ma 2005, which has a reset besides",
    ),
)

PAPER = "De Luca, Oriolo and Robuffo Giordano 2008 (content, not print)"
PARTS = (ENTRIES,)
