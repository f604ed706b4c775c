"""Aidala and Hammel 1983: bearings-only tracking in modified polar coordinates.

V. J. Aidala, S. E. Hammel, Utilization of modified polar coordinates for bearings-only tracking, IEEE Trans. Automatic
Control 28(3), 283-294, 1983.

The print was not at hand.  What stands here is what the paper is about, as the literature after it states it; not the
paper's own numbers of equations, and not its own wording.  So places are names, and "holds" says that the statement is
true, not that it was printed without a slip.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from percept_obs.observability.lie import lie_derivatives
from percept_obs.papers.base import dot, identities, reader
from percept_obs.papers.entries import Finding, Printed, Values, at, judged
from percept_obs.system.bearings import ACCELERATION, bearings_only
from percept_obs.system.forms import PartitionedSystem

reads = reader()


@cache
def form() -> PartitionedSystem:
    """The form with the bearing measured, derived from the Cartesian state."""
    return bearings_only().partition("y3")


@cache
def derived() -> Values:
    """Rates of the coordinates."""
    system = form()
    return {dot(x): rate for x, rate in zip((*system.x1, *system.x2), system.rate, strict=True)}


def decoupled(printed: Printed) -> Finding:
    """Without acceleration 1/R is in no rate of the others; with it, it is in two."""
    y4, steady = form().coordinates[-1], dict.fromkeys(ACCELERATION, sp.S.Zero)
    others = [rate for x, rate in derived().items() if x != dot(y4)]
    straight, turning = (sum(e.xreplace(at_).has(y4) for e in others) for at_ in (steady, {}))
    return judged(straight == 0 and turning == 2)


def manoeuvre(printed: Printed) -> Finding:
    """Rank of the differentials of the Lie derivatives, on a straight course and with an acceleration."""
    state = dict(zip(form().coordinates, (0.3, 0.02, -0.01, 0.002), strict=True))
    ranks = []
    for acceleration in ((0.0, 0.0), (1.0, 0.5)):
        values = state | dict(zip(ACCELERATION, acceleration, strict=True))
        ranks.append(lie_derivatives(form()).ranks_at(values)[-1])
    return judged(ranks == [3, 4], numbers={"rank, straight": ranks[0], "rank, accelerating": ranks[1]})


ENTRIES = (
    at("modified polar coordinates", "", "", "how bearing rate, closing rate, bearing and inverse range move")(
        reads(
            """y1' = -2 y1 y2 - y4 (a_x cos(y3) - a_y sin(y3)); y2' = y1^2 - y2^2 - y4 (a_x sin(y3) + a_y cos(y3));
            y3' = y1; y4' = -y2 y4"""
        ),
        identities(derived),
    ),
    at("decoupling", "", "", "on a straight course what is not observable is decoupled from what is")((), decoupled),
    at("manoeuvre", "", "", "the range is observable only once the own ship accelerates")((), manoeuvre),
)

PAPER = "Aidala and Hammel 1983 (content, not print)"
PARTS = (ENTRIES,)
