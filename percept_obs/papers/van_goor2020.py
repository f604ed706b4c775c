"""Van Goor, Hamel and Mahony 2020: a filter of an error that a symmetry of the system leaves as it is.

P. van Goor, T. Hamel, R. Mahony, Equivariant filter (EqF), 2020, arXiv:2006.08276.

The print was not at hand: what stands here is what the paper is about, for one point seen as a direction, in the
package's letters, so places are names.
"""

from __future__ import annotations

import sympy as sp

from percept_obs.observers import equivariant_filter
from percept_obs.papers.base import vanishes
from percept_obs.papers.entries import Finding, Printed, at, judged
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import pinhole

MOTION = affine()
OBSERVER = equivariant_filter(PerspectiveSystem(MOTION, pinhole()))
STATE, FLOW = OBSERVER.equations.state, OBSERVER.equations.flow
G, RATE = (sp.ImmutableMatrix(3, 3, entries[:9]) for entries in (STATE, FLOW))
SCALED = sp.ImmutableMatrix(3, 3, lambda i, j: sp.Symbol("a", positive=True) * int(i == j))
E3, d = sp.ImmutableMatrix([0, 0, 1]), sp.ImmutableMatrix(sp.symbols("d1:4", real=True))
s = sp.Symbol("s", positive=True)


def inverse_range(printed: Printed) -> Finding:
    """P' = -w x p - v: eta = p/|p| and z = 1/|p| have these rates."""
    p, w, v = (sp.ImmutableMatrix(sp.symbols(f"{letter}1:4", real=True)) for letter in "pwv")
    size = sp.sqrt(p.dot(p))
    eta, z, velocity = p / size, 1 / size, -w.cross(p) - v
    turned = (p / size).jacobian(p) * velocity + w.cross(eta) + z * (v - eta * eta.dot(v))
    return judged(vanishes(*turned, (sp.ImmutableMatrix([z]).jacobian(p) * velocity)[0] - z**2 * eta.dot(v)))


def follows_the_point(printed: Printed) -> Finding:
    """The estimate G e3 of the scaled rotation moves as the point does, at a scaled turn of none."""
    here = dict(zip(STATE, SCALED, strict=False))
    rate = (RATE * E3).xreplace(here)
    return judged(vanishes(*(rate - MOTION.A * SCALED * E3 - MOTION.b)))


def linear_error(printed: Printed) -> Finding:
    """The error d of p = G (e3 + d) obeys d' = F d exactly: F is read from the rate of the covariance."""
    here = dict(zip(STATE, SCALED, strict=False))
    inverse, rate = SCALED.inv(), RATE.xreplace(here)
    moved = inverse * (MOTION.A * SCALED * (E3 + d) + MOTION.b - rate * (E3 + d))
    F = moved.jacobian(d)
    S = sp.ImmutableMatrix(3, 3, lambda i, j: STATE[9 + (0, 1, 2, 1, 3, 4, 2, 4, 5)[3 * i + j]])
    spread = F * S + S * F.T
    flow = [entry.xreplace(here).subs(sp.Symbol("Q", real=True), 0) for entry in FLOW[9:]]
    misses = [spread[i, j] - flow[k] for k, (i, j) in enumerate([(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)])]
    return judged(vanishes(*(moved - F * d), *misses))


def third_order(printed: Printed) -> Finding:
    """A direction turned by s: C d = 1/2 (etahat x d) x (etahat + eta) misses eta - etahat by s^3/12, not by s^2."""
    across = sp.ImmutableMatrix([1, 0, 0])
    eta = sp.cos(s) * E3 + sp.sin(s) * across
    miss = eta - E3 - E3.cross(s * across).cross(E3 + eta) / 2
    plain = eta - E3 - s * across
    orders = [
        min(sp.series(e, s, 0, 6).removeO().as_poly(s).monoms()[-1][0] for e in m if e != 0) for m in (miss, plain)
    ]
    return judged(orders == [3, 2] and vanishes(*(E3.cross(E3).cross(E3 + eta))), numbers=dict(order=float(orders[0])))


ENTRIES = (
    at("direction and inverse range", "", "", "how they move")((), inverse_range),
    at("lifted system", "", "", "a scaled rotation whose image moves as the point does")((), follows_the_point),
    at("error", "", "", "its linearisation does not depend on the error: F and the Riccati equation")((), linear_error),
    at("output", "", "", "the equivariant linearisation has an error of the third order, and no part along the ray")(
        (), third_order
    ),
)

PAPER = "van Goor, Hamel and Mahony 2020 (content, not print)"
PARTS = (ENTRIES,)
