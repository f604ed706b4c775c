"""Chaumette and Hutchinson 2006: image-based visual servoing of points, and the depth that it needs.

F. Chaumette, S. Hutchinson, Visual servo control, part I: basic approaches, IEEE Robotics & Automation Magazine 13(4),
82-90, 2006.

The print was not at hand.  What stands here is what the paper is about, by content: places are names, and "holds" says
that the statement is true, not that it was printed without a slip.  The camera moves with v and turns with omega, in
its own frame; the point is at rest.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import sympy as sp

from percept_obs.compile import vectorised
from percept_obs.papers.base import dot, identities, reader
from percept_obs.papers.entries import Finding, Known, Printed, Values, Verdict, at, judged
from percept_obs.studies.servoing import GOAL, INTERACTION, SYSTEM, VELOCITIES, servo, starts

x, y, Z = sp.symbols("x y Z", real=True)
VELOCITY = sp.symbols("v_x v_y v_z", real=True)
TURNING = sp.symbols("omega_x omega_y omega_z", real=True)
reads = reader()
RATIOS = (1 / 4, 1 / 2, 1, 2, 4)
"""Believed depths over true ones."""


@cache
def derived() -> Values:
    """Rates of the image of a point at rest, by the velocities of the camera."""
    letters = dict(zip(SYSTEM.coordinates, (x, y, 1 / Z), strict=True))
    velocities = sp.ImmutableMatrix([*VELOCITY, *TURNING])
    rates = INTERACTION.xreplace(letters) * velocities
    return dict(zip((dot(x), dot(y)), (rate.expand() for rate in rates), strict=True))


def decays_exponentially(printed: Printed) -> Finding:
    """Three points, L of full rank: e' = -lambda e with the true depth; four near the goal: e = (1 - lambda T)^k e0."""
    stacked = _matrix(GOAL[:3])
    exact = np.abs(stacked @ np.linalg.pinv(stacked) - np.eye(6)).max()
    run = servo([[0.02, 0.01, 0.05, 0.0, 0.02, 0.1]], "true", noise=0.0, duration=3.0)
    size = np.linalg.norm(run.image_error[0], axis=1)
    off = float(np.abs(size / size[0] / (1 - run.time[1]) ** np.arange(len(size)) - 1).max())
    return judged(
        exact < 1e-9 and off < 0.05, numbers={"largest part off e' = -lambda e": exact, "of four, by run": off}
    )


def stays_stable_near_the_goal(printed: Printed) -> Finding:
    """Poles of e' = -lambda L(Z) L(c Z)^+ e on the six directions that four points can move in, for c = 1/4 to 4."""
    L, slowest = _matrix(GOAL), {}
    for ratio in RATIOS:
        believed = np.linalg.pinv(_matrix(GOAL, ratio))
        slowest[f"slowest pole, depth wrong by {ratio:g}"] = float(np.linalg.eigvals(-believed @ L).real.max())
    return judged(max(slowest.values()) < 0, numbers=slowest)


def settles_from_many_starts(printed: Printed) -> Finding:
    """Share of 40 starts, up to 2 m farther and tilted, that arrive with the depth of the goal, within 10 s."""
    arrived = {depth: servo(starts(40), depth).arrived_at() for depth in ("true", "constant")}
    share = {depth: float(np.isfinite(times).mean()) for depth, times in arrived.items()}
    shares = {f"share that arrives, {depth} depth": value for depth, value in share.items()}
    for depth, times in arrived.items():
        shares[f"median time in s, {depth} depth"] = float(np.median(times[np.isfinite(times)]))
    quarter = float(np.isfinite(servo(starts(40), "constant", ratio=1 / 4).arrived_at()).mean())
    shares["share that arrives, a quarter of it"] = quarter
    depends = min(share.values()) > 0.9 and quarter < 0.5
    return judged(False, Verdict.DEPENDS if depends else Verdict.FALSE, shares)


def _matrix(points: np.ndarray, ratio: float = 1.0) -> np.ndarray:
    """Interaction matrices of points one below the other, with a depth that is wrong by a factor."""
    seen = np.column_stack([points[:, :2] / points[:, 2:], 1 / (ratio * points[:, 2])])
    rows = vectorised(SYSTEM.coordinates, list(INTERACTION))(*seen.T)
    return np.stack(rows, axis=-1).reshape(-1, len(VELOCITIES))


ENTRIES = (
    at("interaction matrix", "", "", "the image's rate, linear in the camera's velocities")(
        reads(
            """[x', y'] = [[-1/Z, 0, x/Z, x y, -(1 + x^2), y], [0, -1/Z, y/Z, 1 + y^2, -x y, -x]]
            [v_x, v_y, v_z, omega_x, omega_y, omega_z]"""
        ),
        identities(derived),
    ),
    at("exponential decrease", "", "", "the law v = -lambda L^+ e with the true depth")(
        (), decays_exponentially, "exactly for three points in general position; else near the goal", known=Known.RUNS
    ),
    at("approximation", "", "", "L at the goal, or with a wrong depth, near the goal")(
        (), stays_stable_near_the_goal, "for a square of 0.4 m at 1 m and commands without delay", known=Known.RUNS
    ),
    at("from afar", "", "", "the same approximation away from the goal")(
        (),
        settles_from_many_starts,
        "on the depth: these starts arrive within 10 s with that of the goal, but not with a quarter of it",
        Verdict.DEPENDS,
        known=Known.RUNS,
    ),
)

PAPER = "Chaumette and Hutchinson 2006 (content, not print)"
PARTS = (ENTRIES,)
