"""What the page needs to simulate and to observe many points: layouts, the block of one point, known coefficients."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.compile import function_source
from percept_obs.labs.markup import dotted, formula, markup, row
from percept_obs.motion import TIME, rigid
from percept_obs.points import PointsForm, body_with_origin, independent_points, point_block, rigid_body
from percept_obs.points.kernel import arrays
from percept_obs.points.manoeuvre import PATH, SHARES, SPIN, TURNING, Manoeuvre, velocities
from percept_obs.surfaces import pinhole

Texts = dict[str, Any]

MOST_POINTS = 8
SURFACE = pinhole()


def _own_motion(points: int, turning: Any, velocity: Any, _: Any = None) -> PointsForm:
    """Points that rest in the world; a body's angular velocity does not concern them."""
    return independent_points(rigid([-w for w in turning], velocity, [0, 0, 0]), points)


STATES: Mapping[str, Callable[..., PointsForm]] = MappingProxyType(
    {"body": rigid_body, "independent": _own_motion, "origin": body_with_origin}
)
"""States to choose from: functions of the number of points and of velocities, as `rigid_body` takes them."""


def form_of(state: str, points: int, manoeuvre: Manoeuvre) -> PointsForm:
    """The form of a state whose camera and body move by a manoeuvre."""
    return STATES[state](points, *manoeuvre.velocities)


def state_of(form: PointsForm, places: Any) -> np.ndarray:
    """The smallest state whose points are at these places, shape (n,).

    Parameters
    ----------
    form : PointsForm
    places : array of shape (p, 3)
        Metres, in the camera's frame.
    """
    return np.linalg.pinv(form.blocks.reshape(-1, form.states)) @ np.ravel(places)


@lru_cache(maxsize=1)
def model_for_the_page() -> Texts:
    """Everything that does not depend on the settings."""
    block = point_block(SURFACE)
    distance = sp.Symbol("distance", real=True)
    place = tuple(entry * distance for entry in SURFACE.ray)
    return {
        "states": {name: _state_for_the_page(name) for name in STATES},
        "block": {"N": _numbers(block.N), "l": _numbers(block.l)[0]},
        "locate": function_source((*SURFACE.image_coordinates, distance), place),
        "equations": _equations(),
        "mostPoints": MOST_POINTS,
    }


def _state_for_the_page(name: str) -> Texts:
    """The layouts of a state for each number of points, and its coefficients as a function of time."""
    vectors = [sp.ImmutableMatrix(sp.symbols(f"{letter}1:4", real=True)) for letter in ("w_c", "v_c", "w_b")]
    form = STATES[name](MOST_POINTS, *vectors)
    entries = [entry for vector in velocities() for entry in vector]
    known = dict(zip((s for vector in vectors for s in vector), entries, strict=True))
    coefficients = tuple(expression.xreplace(known) for expression in form.layout.expressions)
    extra = form.states - 3 * MOST_POINTS
    return {
        "coefficients": function_source((TIME, *SHARES), coefficients),
        "width": len(coefficients),
        "layouts": [_layout(form, extra, points) for points in range(1, MOST_POINTS + 1)],
    }


def _layout(form: PointsForm, extra: int, points: int) -> Texts:
    """Where a state's coefficients stand when it has so many of the points."""
    states = np.arange(3 * points + extra)
    part = arrays(form, states, np.arange(points))
    numbers = {name: getattr(part, name).tolist() for name in part._fields if name not in ("N", "l")}
    return {**numbers, "names": [form.names[k] for k in states]}


def _numbers(matrix: sp.ImmutableMatrix) -> list[list[float]]:
    return np.array(matrix, dtype=float).tolist()


def _equations() -> list[Texts]:
    """The observer, what is known of the motion, and the bookkeeping of P, as MathML."""
    n, m = sp.symbols("n m", integer=True, positive=True)
    x, v, e = (sp.MatrixSymbol(name, size, 1) for name, size in (("xhat", n), ("v", n), ("e", m)))
    A, P, start = (sp.MatrixSymbol(name, n, n) for name in ("A", "P", "P_0"))
    B, C, S = sp.MatrixSymbol("B", m, m), sp.MatrixSymbol("C", m, n), sp.MatrixSymbol("S", n, n)
    rho, forgetting, decrease = sp.MatrixSymbol("rho", n, 1), sp.Symbol("lambda"), sp.Symbol("q")
    letters = {"forgetting": forgetting, "decrease": decrease}
    turning, spin, size, *constant = SHARES
    shares = dict(zip(("turning", "spin", "input"), (turning, spin, size), strict=True))
    block = point_block(SURFACE)
    path, w = sp.Matrix(PATH), sp.Symbol("w")
    known = [
        formula(w, sp.MatMul(turning, sp.Matrix(TURNING), evaluate=False), shares),
        formula(sp.Symbol("r"), path),
        row(formula(sp.Symbol("v"), _input(size)), "+", markup(sp.Matrix(constant))),
        formula(sp.Symbol("w_b"), sp.MatMul(spin, sp.Matrix(SPIN), evaluate=False), shares),
    ]
    return [
        {
            "title": "The observer",
            "lines": [
                formula(dotted(x), A * x + v + P.I * C.T * B.T * e),
                row("point by point", formula(sp.Symbol("B_k"), block.B)),
                row("without a division", formula(sp.Symbol("e_k"), sp.Matrix(block.y) * sp.Symbol("xi_3"))),
            ],
        },
        {"title": "Its error", "lines": [formula(dotted(rho), (A - P.I * C.T * B.T * B * C) * rho)]},
        {
            "title": "P, where it is computed",
            "lines": [
                row("Lyapunov", formula(dotted(P), -A.T * P - P * A - decrease * sp.Identity(n), letters)),
                row("Riccati", formula(dotted(P), -A.T * P - P * A + S - forgetting * (P - start), letters)),
            ],
        },
        {"title": "What is known of the motion", "lines": known},
    ]


def _input(size: sp.Symbol) -> sp.Expr:
    return size * (sp.Symbol("rdot") - sp.Symbol("W") * sp.Symbol("r"))
