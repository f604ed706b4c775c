"""Hamel and Samson 2017: Riccati observers for a camera with an IMU.

T. Hamel, C. Samson, Riccati observers for the nonstationary PnP problem, arXiv:1606.07735.

The print was not at hand.  What stands here is what the paper is about, as the literature after it states it; not the
paper's own numbers of equations, and not its own wording.  So places are names, and "holds" says that the statement is
true, not that it was printed without a slip.

The camera turns with w and feels the specific force a, both in its own frame; the landmark p is at rest.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from percept_obs.papers.base import dot, identities, reader
from percept_obs.papers.entries import Finding, Printed, Values, at, judged
from percept_obs.points import camera_imu
from percept_obs.system.inertial import a, w

reads = reader()


@cache
def derived() -> Values:
    """Rates of landmark, velocity and gravity in the camera's frame."""
    form = camera_imu(1)
    letters = sp.ImmutableMatrix([sp.Symbol(f"{name}{k}", real=True) for name in "pvg" for k in (1, 2, 3)])
    rates = form.motion.A * letters + form.motion.b
    return {dot(x): sp.expand(rate) for x, rate in zip(letters, rates, strict=True)}


def scaled_alike(printed: Printed) -> Finding:
    """Rates at p and v twice as large, gravity and force kept: twice the rates where a = -g, and nowhere else."""
    names = [sp.Symbol(f"{name}{k}", real=True) for name in "pv" for k in (1, 2, 3)]
    gravity = sp.symbols("g1:4", real=True)
    moved = [derived()[dot(x)] for x in names]
    off = [sp.expand(rate.subs({x: 2 * x for x in names}, simultaneous=True) - 2 * rate) for rate in moved]
    unseen = dict(zip(a, (-g for g in gravity), strict=True))
    felt = [sp.expand(e + force + g) for e, force, g in zip(off[3:], a, gravity, strict=True)]
    return judged(not any(off[:3]) and not any(felt) and not any(e.xreplace(unseen) for e in off))


def linear_in_the_state(printed: Printed) -> Finding:
    """A and b hold nothing but w and a."""
    motion = camera_imu(3, bias=True).motion
    return judged(motion.A.free_symbols == set(w) and motion.b.free_symbols == set(a))


ENTRIES = (
    at("motion", "", "", "how landmark, velocity and gravity move in the camera's frame")(
        reads(
            """p1' = w3 p2 - w2 p3 - v1; p2' = w1 p3 - w3 p1 - v2; p3' = w2 p1 - w1 p2 - v3;
            v1' = w3 v2 - w2 v3 + a1 + g1; v2' = w1 v3 - w3 v1 + a2 + g2; v3' = w2 v1 - w1 v2 + a3 + g3;
            g1' = w3 g2 - w2 g3; g2' = w1 g3 - w3 g1; g3' = w2 g1 - w1 g2"""
        ),
        identities(derived),
    ),
    at("linear and time-varying", "", "", "several landmarks, and a bias of the accelerometer")(
        (), linear_in_the_state
    ),
    at("scale", "", "", "without acceleration p and v scaled alike make the same pictures")((), scaled_alike),
)

PAPER = "Hamel and Samson 2017 (content, not print)"
PARTS = (ENTRIES,)
