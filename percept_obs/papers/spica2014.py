"""Spica, Robuffo Giordano and Chaumette 2014: structure from a camera's motion, of a point and of a sphere.

R. Spica, P. Robuffo Giordano, F. Chaumette, Active structure from motion: application to point, sphere, and cylinder,
IEEE Trans. Robotics 30(6), 2014.  The size as an output is also in arXiv:2401.17117.

The print was not at hand.  What stands here is that a sphere's size is seen as well as its direction, and what follows
from it, in the letters of this package: places are names, and "holds" says that the statement is true.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import sympy as sp

from percept_obs.observability import cramer_rao
from percept_obs.observers import extended_kalman
from percept_obs.papers.base import dot, identities, is_identity, reader
from percept_obs.papers.entries import Finding, Known, Printed, Values, at, judged
from percept_obs.recording import Camera, Gaussian, record, scenarios
from percept_obs.system.apparent_size import r, s, sized
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import pinhole
from percept_obs.tracking.following import track

SYSTEM = PerspectiveSystem(affine(), sized(pinhole()))
FORM = SYSTEM.measure("y1", "y2", "s")
CENTRE = sp.symbols("p1:4", real=True)
W = sp.symbols("w1:4", real=True)
NOISE = 1e-3
reads = reader(r)


@cache
def derived() -> Values:
    """Rates of image, size and inverse depth; w; the sphere's centre over its radius, with its rate."""
    y1, y2, _, y3 = SYSTEM.coordinates
    centre = sp.Matrix([y1 / s, y2 / s, 1 / s])
    moved = centre.jacobian(SYSTEM.coordinates) * SYSTEM.rate
    found = zip((*map(dot, SYSTEM.coordinates), *W, *CENTRE), (*SYSTEM.rate, *FORM.w, *centre), strict=True)
    return dict(found) | dict(zip(map(dot, CENTRE), moved, strict=True)) | {r: s / y3}


def at_the_focus(printed: Printed) -> Finding:
    """Rows of w at the focus of expansion, those of the image and that of the size."""
    there = dict(zip(SYSTEM.coordinates, SYSTEM.foe, strict=False))
    left = dict(zip(W, FORM.w.subs(there).applyfunc(sp.cancel), strict=True))
    return judged(all(is_identity(line, left) for line in printed))


def straight_on(printed: Printed) -> Finding:
    """Straight at a point 11 m away, 4 s, an extended Kalman filter from 6 m: with the size and without, 10 seeds."""
    position = 11 * np.array([0.16, -0.04, 1.0])
    straight = replace(scenarios.drive(), position=tuple(position), surface=sized(pinhole(), radius=0.3))
    films = [record(straight, camera=Camera(0.05, Gaussian(NOISE)), seed=seed) for seed in range(10)]
    numbers = {}
    for names in (("y1", "y2"), ("y1", "y2", "s")):
        observer = extended_kalman(SYSTEM.measure(*names), noise_variance=NOISE**2, hidden_variance=0.01)
        runs = [track(film, observer, [0.16, -0.04, 0.3 / 11, 1 / 6]) for film in films]
        error = float(np.median([run.relative_error[-1] for run in runs]))
        what = "with the size" if "s" in names else "without it"
        numbers[f"error of the distance {what}"] = error
        numbers[f"the bound of it {what}"] = float(cramer_rao(films[0], observer.form).relative[-1])
    with_size, blind = (numbers[f"error of the distance {what}"] for what in ("with the size", "without it"))
    return judged(with_size < 0.05 and blind > 0.3, numbers=numbers)


ENTRIES = (
    at("apparent size", "", "", "how the size s = r/Z at which a sphere is seen changes")(
        reads("s' = -s (a31 y1 + a32 y2 + a33 + b3 y3)"), identities(derived), "r is constant, and not in it"
    ),
    at("growth", "", "", "the size grows as the inverse depth does")(reads("s' / s = y3' / y3"), identities(derived)),
    at("w", "", "", "what the inverse depth is multiplied by in the rates of y1, y2 and s")(
        reads("w1 = b1 - b3 y1; w2 = b2 - b3 y2; w3 = -b3 s"), identities(derived)
    ),
    at("at the FOE", "", "", "at the focus of expansion, where the image says nothing of the distance, the size does")(
        reads("w1 = 0; w2 = 0; w3 = -b3 s"), at_the_focus, "while b3 is not 0"
    ),
    at("scaled centre", "", "", "the sphere's centre over its radius is seen as a whole")(
        reads("p1 = y1 / s; p2 = y2 / s; p3 = 1 / s"), identities(derived), known=Known.DEFINITION
    ),
    at("constant 1/r", "", "", "its rate is linear in the constant 1/r, times the whole translation")(
        reads(
            """p1' = a11 p1 + a12 p2 + a13 p3 + b1 / r; p2' = a21 p1 + a22 p2 + a23 p3 + b2 / r;
            p3' = a31 p1 + a32 p2 + a33 p3 + b3 / r"""
        ),
        identities(derived),
        "so any translation shows r, in any direction",
    ),
    at("straight on", "", "", "a camera that approaches a sphere finds its distance")(
        (), straight_on, "noise 0.001, sphere of 0.3 m; without the size nothing is learnt", known=Known.RUNS
    ),
)

PAPER = "Spica, Robuffo Giordano and Chaumette 2014 (content, not print)"
PARTS = (ENTRIES,)
