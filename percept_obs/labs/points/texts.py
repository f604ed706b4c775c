"""Texts from which the page simulates and observes many points: layouts, the block of a point, coefficients."""

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np
import sympy as sp

from percept_obs.compile import function_source
from percept_obs.labs.shared.markup import dotted, formula, markup, row
from percept_obs.labs.shared.printed import Parts, Texts
from percept_obs.labs.shared.samples import is_sampled, refuse_unfit, samples_for_the_page
from percept_obs.labs.shared.typed_motion import Typed
from percept_obs.points import PointsForm, body_with_origin, independent_points, point_block, rigid_body
from percept_obs.points.kernel import arrays
from percept_obs.points.manoeuvre import PATH, SHARES, SPIN, TURNING, Manoeuvre, Vectors, velocities
from percept_obs.system.motion import TIME, rigid
from percept_obs.system.surfaces import pinhole

MOST_POINTS = 12
LETTERS = {name: sp.Symbol(letter) for name, letter in (("turning", "alpha"), ("spin", "beta"), ("input", "gamma"))}
"""Letters of a manoeuvre's shares in the equations."""

SURFACE = pinhole()

_LETTERS = ("w_c", "v_c", "w_b")
BLOCKS = MappingProxyType({name: sp.ImmutableMatrix(sp.symbols(f"{name}1:4", real=True)) for name in _LETTERS})
"""Vectors that may be given over time: angular velocity and velocity of the camera, angular velocity of the body."""


def _own_motion(points: int, turning: Any, velocity: Any, _: Any = None) -> PointsForm:
    """Points that rest in the world; a body's angular velocity does not concern them."""
    return independent_points(rigid(camera_angular_velocity=turning, camera_velocity=velocity), points)


STATES: Mapping[str, Callable[..., PointsForm]] = MappingProxyType(
    {"body": rigid_body, "independent": _own_motion, "origin": body_with_origin}
)
"""States to choose from: functions of the number of points and of velocities, as `rigid_body` takes them."""


def form_of(state: str, points: int, manoeuvre: Manoeuvre, typed: Typed | None = None) -> PointsForm:
    """The form of a state whose camera and body move by a manoeuvre, or as expressions of time say."""
    moved = tuple(manoeuvre.velocities)
    return STATES[state](points, *(typed_velocities(typed, moved) if typed else moved))


def state_of(form: PointsForm, places: Any) -> np.ndarray:
    """The smallest state, shape (n,), whose points are at places of shape (p, 3), in metres in the camera's frame."""
    return np.linalg.pinv(form.blocks.reshape(-1, form.states)) @ np.ravel(places)


@lru_cache(maxsize=1)
def model_for_the_page() -> Texts:
    """Texts that do not depend on the settings."""
    block = point_block(SURFACE)
    distance = sp.Symbol("distance", real=True)
    place = tuple(entry * distance for entry in SURFACE.ray)
    return {
        "states": {name: _state_for_the_page(name) for name in STATES},
        "block": {"N": _numbers(block.N), "l": _numbers(block.l)[0]},
        "point": block.source("javascript"),
        "locate": function_source((*SURFACE.image_coordinates, distance), place),
        "equations": _equations(),
        "letters": {symbol.name: markup(LETTERS.get(symbol.name, symbol)) for symbol in SHARES},
        "mostPoints": MOST_POINTS,
    }


def texts_for_the_page() -> Parts:
    """Texts of the lab by their places."""
    yield "", model_for_the_page()


@lru_cache
def general_form(state: str) -> PointsForm:
    """The form of a state with as many points as there may be, in symbols for the velocities."""
    return STATES[state](MOST_POINTS, *BLOCKS.values())


def coefficients_for_the_page(state: str, moved: Vectors) -> str:
    """The coefficients of a state as a function of time and a manoeuvre's shares, for velocities of these."""
    known = dict(zip((s for vector in BLOCKS.values() for s in vector), (e for v in moved for e in v), strict=True))
    expressions = general_form(state).layout.expressions
    return function_source((TIME, *SHARES), tuple(expression.xreplace(known) for expression in expressions))


def typed_velocities(typed: Typed, moved: Vectors) -> Vectors:
    """Velocities of a manoeuvre, changed as expressions of time say."""
    base = dict(zip(typed.symbols, (e for vector in moved for e in vector), strict=True))
    entries = tuple(entry.xreplace(base) for entry in typed.expressions)
    return entries[:3], entries[3:6], entries[6:]


def _state_for_the_page(name: str) -> Texts:
    """The layouts of a state for each number of points, and its coefficients as a function of time."""
    form = general_form(name)
    extra = form.states - 3 * MOST_POINTS
    return {
        "coefficients": coefficients_for_the_page(name, velocities()),
        "width": len(form.layout.expressions),
        "layouts": [_layout(form, 3 * points + extra, points) for points in range(1, MOST_POINTS + 1)],
    }


def own_state_for_the_page(form: PointsForm) -> Texts:
    """Return the layout and coefficients of a user's form as texts; raise ValueError if the page cannot move it."""
    motion, n = form.motion, form.states
    rows, columns = form.layout.rows, form.layout.columns
    if n % 3 or form.points > MOST_POINTS or ((columns < n) & (rows // 3 != columns // 3)).any():
        raise ValueError(
            f"the form has {n} states and {form.points} points; the lab moves vectors of three states, each by itself, "
            f"of at most {MOST_POINTS} points: order the states so that A has only blocks of 3 x 3 on its diagonal"
        )
    sampled = is_sampled(motion)
    if sampled:
        refuse_unfit(motion)
    given = motion.parameters if sampled else (TIME, *SHARES)
    numbers = {symbol: sp.Float(value, 17) for symbol, value in motion.values.items()}
    expressions = tuple(expression.xreplace(numbers) for expression in form.layout.expressions)
    left = sorted(map(str, set().union(*(e.free_symbols for e in expressions)) - set(given)))
    if left:
        raise ValueError(
            f"the form's motion has no expression in time for {', '.join(left)}; give numbers, samples with their "
            "times, or expressions of TIME"
        )
    if form.surface != SURFACE:
        raise ValueError(f"the form is seen on the {form.surface.name}; the lab of many points has a pinhole")
    return {
        "coefficients": function_source(given, expressions),
        "width": len(expressions),
        "layouts": [*[None] * (form.points - 1), _layout(form, n, form.points)],
        **({"samples": samples_for_the_page(motion)} if sampled else {}),
    }


def _layout(form: PointsForm, states: int, points: int) -> Texts:
    """Return places of the entries of [A, v] and C_k for the first states and points, and the states' names."""
    found = arrays(form, np.arange(states), np.arange(points))
    plain = {name: getattr(found, name).tolist() for name in found._fields if name not in ("shape", "block")}
    return {**plain, "names": list(form.names[:states])}


def _numbers(matrix: sp.ImmutableMatrix) -> list[list[float]]:
    return np.array(matrix, dtype=float).tolist()


def _equations() -> list[Texts]:
    """The observer, its error, the bookkeeping of P, and what is known of the motion, as MathML."""
    n, m = sp.symbols("n m", integer=True, positive=True)
    x, v, e, rho = (sp.MatrixSymbol(name, size, 1) for name, size in (("xhat", n), ("v", n), ("e", m), ("rho", n)))
    A, P, P0, S = (sp.MatrixSymbol(name, n, n) for name in ("A", "P", "P_0", "S"))
    B, C = sp.MatrixSymbol("B", m, m), sp.MatrixSymbol("C", m, n)
    forgetting, decrease = sp.symbols("lambda q", positive=True)
    kept = {"forgetting": forgetting, "decrease": decrease}
    K = P.I * C.T * B.T
    block = point_block(SURFACE)
    observer = [
        formula(dotted(x), A * x + v + K * e),
        row("for each point", formula(sp.Symbol("B_k"), block.B), ",", formula(sp.Symbol("e_k"), block.innovation)),
    ]
    computed = [
        row("Lyapunov", formula(dotted(P), -A.T * P - P * A - decrease * sp.Identity(n), kept)),
        row("Riccati", formula(dotted(P), -A.T * P - P * A + S - forgetting * (P - P0), kept)),
    ]
    return [
        {"title": "The observer", "lines": observer},
        {"title": "Its error", "lines": [formula(dotted(rho), A * rho - K * B * C * rho)]},
        {"title": "P, where it is computed", "lines": computed},
        {"title": "The motion of camera and body", "lines": _motion_in_lines()},
    ]


def _motion_in_lines() -> list[str]:
    """Equations of the known motion of camera and body, with a letter for each share."""
    letters = {symbol.name: LETTERS.get(symbol.name, symbol) for symbol in SHARES}
    constant = [letters[f"v_c{k}"] for k in (1, 2, 3)]
    w_c, r, v_c = sp.symbols("w_c r v_c")
    times = [dotted(r), "<mo>+</mo>", markup(w_c), "<mo>×</mo>", markup(r)]
    return [
        formula(w_c, _share(letters["turning"], TURNING), letters),
        row("input", formula(r, _decimal(sp.Matrix(PATH)))),
        row(
            f"{markup(v_c)}<mo>=</mo><mo>-</mo>",
            markup(letters["input"], letters),
            "<mo>(</mo>",
            *times,
            "<mo>)</mo><mo>+</mo>",
            markup(sp.Matrix(constant), letters),
        ),
        row("body", formula(sp.Symbol("w_b"), _share(letters["spin"], SPIN), letters)),
    ]


def _share(letter: sp.Symbol, vector: tuple[sp.Expr, ...]) -> sp.MatMul:
    return sp.MatMul(letter, _decimal(sp.Matrix(vector)), evaluate=False)


def _decimal(matrix: sp.Matrix) -> sp.Matrix:
    """Fractions as decimals, which are easier to read in a matrix."""
    fractions = [number for number in matrix.atoms(sp.Rational) if not number.is_integer]
    return matrix.xreplace({number: sp.Float(number, 3) for number in fractions})
