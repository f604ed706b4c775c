"""Ortega, Bobtsov, Nikolaev, Schiffer and Dochain 2020: observers that estimate constants, mixed by DREM.

R. Ortega, A. Bobtsov, N. Nikolaev, J. Schiffer, D. Dochain, Generalized parameter estimation-based observers, 2020,
arXiv:2003.10952; with the mixing of S. Aranovskiy, A. Bobtsov, R. Ortega, A. Pyrkin, IEEE Trans. Automatic Control
62(7), 2017.

The print was not at hand: what stands here is what the papers are about, in the package's letters, so places are names.
"""

from __future__ import annotations

import sympy as sp

from percept_obs.observers import gpebo
from percept_obs.observers.gpebo import forgetting, gamma, mu
from percept_obs.observers.parts import sigma2
from percept_obs.papers.base import vanishes
from percept_obs.papers.entries import Finding, Known, Printed, at, judged
from percept_obs.recording import Camera, record
from percept_obs.recording.scenarios import ma2005_eq35
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import pinhole
from percept_obs.tracking.following import track

MOTION = affine()
SYSTEM = PerspectiveSystem(MOTION, pinhole())
OBSERVER = gpebo(SYSTEM.measure("y1", "y2"))
STATE = OBSERVER.equations.state
RATES = dict(zip(STATE, OBSERVER.equations.flow, strict=True))
PHI, XI = sp.ImmutableMatrix(3, 3, STATE[:9]), sp.ImmutableMatrix(STATE[9:12])
Q, Y = sp.ImmutableMatrix(STATE[12:18]), sp.ImmutableMatrix(STATE[18:21])
THETA = sp.ImmutableMatrix(sp.symbols("theta1:4", real=True))
POINT = (PHI * sp.ImmutableMatrix([THETA[0], THETA[1], 1]) + THETA[2] * XI) / THETA[2]


def moves_as_the_point(printed: Printed) -> Finding:
    """With constant theta, the rate of X = (Phi (q1, q2, 1) + rho xi) / rho is A X + b."""
    known = STATE[:12]
    rate = POINT.jacobian(known) * sp.ImmutableMatrix([RATES[s] for s in known])
    return judged(vanishes(*(rate - MOTION.A * POINT - MOTION.b)))


def normal_equations(printed: Printed) -> Finding:
    """Where the image is that of X, Q theta = Y stays true: both sides have the same rate."""
    seen = dict(zip(OBSERVER.form.x1, (POINT[0] / POINT[2], POINT[1] / POINT[2]), strict=True))
    a, b, c, d, e, f = Q
    square = sp.ImmutableMatrix([[a, b, c], [b, d, e], [c, e, f]])
    rates = [sp.ImmutableMatrix([RATES[s].subs(sigma2, 0) for s in part]) for part in (Q, Y)]
    rate = square.xreplace(dict(zip(Q, rates[0], strict=True))) * THETA - rates[1]
    left = rate + forgetting * (square * THETA - Y)
    return judged(vanishes(*(entry.subs(seen) for entry in left)))


def decays_by_itself(printed: Printed) -> Finding:
    """With Y = Q theta each constant's error has the rate -gamma D^2 / (mu + D^2), whatever the others are."""
    a, b, c, d, e, f = Q
    square = sp.ImmutableMatrix([[a, b, c], [b, d, e], [c, e, f]])
    D, put = square.det(), dict(zip(Y, square * THETA, strict=True))
    share = gamma * D**2 / (mu + D**2)
    misses = [RATES[s].xreplace(put) - share * (t - s) for s, t in zip(STATE[21:], THETA, strict=True)]
    return judged(vanishes(*misses))


def from_one_output(printed: Printed) -> Finding:
    """Ma's example (35), y1 alone, without noise: the distance settles within 10 % from 1/Z = 0 and from 1."""
    film, one = record(ma2005_eq35(), 10, Camera(0.01)), gpebo(SYSTEM.measure("y1"))
    numbers = {f"settles at s, from {y3}": track(film, one, {"y3": y3}).settling_time(0.1) for y3 in (0.0, 1.0)}
    return judged(max(numbers.values()) < 5, numbers=numbers)


ENTRIES = (
    at("constants", "", "", "the state is known but for constants")((), moves_as_the_point),
    at("regression", "", "", "the outputs are linear in the constants")((), normal_equations),
    at("mixing", "", "", "each constant has an equation of its own")((), decays_by_itself),
    at("one output", "", "", "the constants are found from one output")(
        (), from_one_output, "not an example of these papers", known=Known.RUNS
    ),
)

PAPER = "Ortega, Bobtsov, Nikolaev, Schiffer and Dochain 2020 (content, not print)"
PARTS = (ENTRIES,)
