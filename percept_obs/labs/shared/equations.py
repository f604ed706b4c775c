"""Observers' equations in the letters of the papers, for w, phi and g of any system, as MathML."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import combinations
from typing import Any

import sympy as sp

from percept_obs.labs.shared.markup import after, dotted, formula, listed, markup, row
from percept_obs.observers import Observer, equivariant_filter, extended_kalman, gpebo, linear_approximation
from percept_obs.observers.inversion import elapsed
from percept_obs.observers.parts import hats
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import pinhole

Matrices = dict[str, Any]
"""Right-hand sides by what they give: a letter, its rate (x') or its value after an update (x+)."""


def equations_of(make: Callable[..., Observer], **switch: str) -> list[dict[str, Any]]:
    """An observer's equations as MathML, a line each: with all terms, and without those of gains that may be 0.

    They are to be tried in their order; the last ones are without zeros.
    """
    if make in IN_MATRICES:
        observer = make(PerspectiveSystem(affine(), pinhole()).measure("y1", "y2"))
        lines = partial(IN_MATRICES[make], {gain.name: gain.symbol for gain in observer.gains})
        return _without_zeros(observer, lines)
    return equations_in_scalars(make(abstract_form(), **switch))


def equations_in_scalars(observer: Observer) -> list[dict[str, Any]]:
    """Equations of an observer as `equations_of` gives them, written out for its form."""
    return _without_zeros(observer, partial(in_scalars, observer))


def _without_zeros(observer: Observer, lines: Callable[..., list[str]]) -> list[dict[str, Any]]:
    optional = {gain.name: gain.symbol for gain in observer.gains if gain.value == 0}
    sizes = sorted({len(optional), max(len(optional) - 1, 0), 0}, reverse=True)  # all, all but one, and none
    subsets = [names for size in sizes for names in combinations(optional, size)]
    return [{"zero": list(names), "lines": lines(zero=[optional[name] for name in names])} for names in subsets]


def abstract_form() -> CanonicalForm:
    """One measured and one hidden coordinate, with functions that stand for any system's w, phi and g."""
    x1, x2 = sp.symbols("x1 x2", real=True)
    blocks = (("w", (x1,)), ("phi", (x1,)), ("g", (x1, x2)))
    w, phi, g = (sp.ImmutableMatrix([[sp.Function(name, real=True)(*of)]]) for name, of in blocks)
    return CanonicalForm((x1,), (x2,), (), (x1, x2), w=w, phi=phi, g=g)


def in_scalars(observer: Observer, zero: Sequence[sp.Symbol] = ()) -> list[str]:
    """A line for each of an observer's equations, without the terms of gains that are 0."""
    form, equations = observer.form, observer.equations
    letters = {gain.name: gain.symbol for gain in observer.gains}
    derived = {
        hat: estimate
        for hat, estimate in zip(hats(form.coordinates), observer.estimate, strict=True)
        if hat not in equations.state
    }
    short = {estimate: hat for hat, estimate in derived.items() if estimate not in form.x1}
    flow = [rate.subs(dict.fromkeys(zero, 0)).subs(short) for rate in equations.flow]
    lines = [formula(dotted(s), rate, letters) for s, rate in zip(equations.state, flow, strict=True)]
    lines += [formula(hat, estimate, letters) for hat, estimate in derived.items()]
    starts = zip(equations.state, observer.start, strict=True)
    begun = [formula(s, value, letters) for s, value in starts if value in letters.values()]
    if begun:
        lines.append(row("at the start", *listed(begun)))
    for where in observer.unobservable:
        if where.condition.has(elapsed):  # long, and of no use by hand
            lines.append(row(f"no estimate while {where.reason}"))
        else:
            lines.append(row("no estimate where", markup(where.condition, letters)))
    if equations.reset:
        changed = [(s, new) for s, new in zip(equations.state, equations.reset, strict=True) if s != new]
        after_it = [formula(after(s), new, letters) for s, new in changed]
        lines.append(row("when", markup(equations.reset_condition, letters), "then", *listed(after_it)))
    return lines


def kalman_equations(x: Any, P: Any, F: Any, f: Any, c: Any, y: Any, Q: Any, R: Any) -> Matrices:
    """The extended Kalman filter for an output y = c^T x: flow, innovation, its variance s, gain k, update."""
    k, e, s = (sp.MatrixSymbol(letter, *shape) for letter, shape in (("k", x.shape), ("e", (1, 1)), ("s", (1, 1))))
    return {
        "x'": f,
        "P'": F * P + P * F.T + Q,
        "e": y - c.T * x,
        "s": c.T * P * c + R,
        "k": P * c * s**-1,
        "x+": x + k * e,
        "P+": P - k * c.T * P,
    }


def cascade_equations(x: Any, P: Any, F: Any, f: Any, C: Any, y: Any, W: Any, Q: Any, R: Any) -> Matrices:
    """One filter of the linear approximation observer: innovation, gain K, flow."""
    K, e = sp.MatrixSymbol("K", x.shape[0], y.shape[0]), sp.MatrixSymbol("e", *y.shape)
    return {"e": y - C * x, "K": P * C.T / R, "x'": F * x + f + K * e, "P'": F * P + P * F.T + Q * W - K * C * P}


def _kalman_lines(letters: Mapping[str, sp.Symbol], zero: Sequence[sp.Symbol] = ()) -> list[str]:
    n = sp.Symbol("n", integer=True, positive=True)
    x, F, P, c = (sp.MatrixSymbol(name, n, width) for name, width in (("xhat", 1), ("F", n), ("P", n), ("c", 1)))
    # f names the system's rate as a whole, (w^T x2 + phi, g)
    rate, y = sp.MatrixSymbol("f", n, 1), sp.MatrixSymbol("y", 1, 1)
    noises = (("process_noise", sp.Identity(n)), ("hidden_process_noise", sp.MatrixSymbol("I_2", n, n)))
    moved = (("turning_noise", sp.MatrixSymbol("G_w", n, 3)), ("velocity_noise", sp.MatrixSymbol("G_v", n, 3)))
    densities = [*noises, *((q, G * G.T) for q, G in moved)]
    Q = sum((letters[q] * ones for q, ones in densities if letters[q] not in zero), sp.ZeroMatrix(n, n))
    R = sp.MatrixSymbol(letters["noise_variance"].name, 1, 1)
    rows = kalman_equations(x, P, F, rate, c, y, Q, R)
    at_estimate = sp.Function("f")(sp.Symbol("xhat"))
    ones = formula(sp.Symbol("I_2"), sp.diag(0, 1))
    jacobians = [
        each
        for q, G in moved
        for each in ("with", formula(G, sp.Derivative(at_estimate, sp.Symbol(G.name[-1]))))
        if letters[q] not in zero
    ]
    hidden = [] if letters["hidden_process_noise"] in zero else ["with", ones, "for measured and hidden"]
    start = sp.diag(letters["measured_variance"], letters["hidden_variance"])
    return [
        row(formula(dotted(x), at_estimate), "with", formula(F, sp.Derivative(at_estimate, sp.Symbol("xhat")))),
        row(formula(dotted(P), rows["P'"], letters), *hidden, *jacobians),
        row("at a sample of an output", formula("<mi>y</mi>", c.T * sp.MatrixSymbol("x", n, 1))),
        row(formula("<mi>e</mi>", rows["e"]), ",", formula("<mi>s</mi>", rows["s"], letters)),
        row(formula("<mi>k</mi>", rows["k"]), ",", formula(after(x), rows["x+"]), ",", formula(after(P), rows["P+"])),
        row("at the start", formula(P, start, letters)),
    ]


def _cascade_lines(letters: Mapping[str, sp.Symbol], zero: Sequence[sp.Symbol] = ()) -> list[str]:
    n, m = sp.symbols("n m", integer=True, positive=True)
    x, F, P = (sp.MatrixSymbol(f"{s}_i", n, width) for s, width in (("xhat", 1), ("F", n), ("P", n)))
    rate, C, y = sp.MatrixSymbol("f_0", n, 1), sp.MatrixSymbol("C", m, n), sp.MatrixSymbol("y", m, 1)
    Q, R, P0 = (letters[name] for name in ("process_weight", "measurement_weight", "start_weight"))
    W = sp.MatrixSymbol("W", n, n)
    rows = cascade_equations(x, P, F, rate, C, y, W, Q, R)
    J, before = sp.Function("J"), sp.Symbol("xhat_i-1")
    frozen = sp.Matrix([[0, sp.Symbol("w^T")], [0, (J(0) + J(before)) / 2]])
    return [
        row("for i = 1, 2, ...:", formula(dotted(x), rows["x'"]), ",", formula("<mi>e</mi>", rows["e"])),
        row(formula(F, frozen), ",", formula(sp.Symbol("J"), sp.Derivative(sp.Function("g")(X2), X2)), ",", _OFFSET),
        row(formula("<mi>K</mi>", rows["K"], letters), ",", formula(dotted(P), rows["P'"], letters)),
        row(
            "at the start",
            formula(P, P0 * W, letters),
            "with",
            formula(W, sp.diag(1, letters["hidden_weight"]), letters),
        ),
    ]


def constants_equations(Phi: Any, xi: Any, A: Any, b: Any, phi: Any, r: Any, Q: Any, Y: Any, lost: Any) -> Matrices:
    """The observer of constants without bias of noise: rates of Phi and xi, from the motion, and of Q and Y."""
    return {"Phi'": A * Phi, "xi'": A * xi + b, "Q'": phi.T * phi - lost * Q, "Y'": phi.T * r - lost * Y}


def turning_equations(G: Any, S: Any, F: Any, u: Any, h: Any, k: Any, half: Any, Q: Any, R: Any) -> Matrices:
    """The equivariant filter, for an output with the slope h: flow, variance s of the innovation, gain k, update."""
    s = sp.MatrixSymbol("s", 1, 1)
    return {
        "G'": G * u,
        "S'": F * S + S * F.T + Q,
        "s": h * S * h.T + R,
        "k": S * h.T * s**-1,
        "G+": G * half**2,
        "S+": S - k * h * S,
    }


def _constants_lines(letters: Mapping[str, sp.Symbol], zero: Sequence[sp.Symbol] = ()) -> list[str]:
    n = sp.Symbol("n", integer=True, positive=True)
    Phi, A, Q, adj = (sp.MatrixSymbol(name, 3, 3) for name in ("Phi", "A", "Q", "Q^*"))
    xi, b, Y, theta = (sp.MatrixSymbol(name, 3, 1) for name in ("xi", "b", "Y", "thetahat"))
    phi, r, D = sp.MatrixSymbol("phi", n, 3), sp.MatrixSymbol("r", n, 1), sp.Symbol("D")
    rows = constants_equations(Phi, xi, A, b, phi, r, Q, Y, letters["forgetting"])
    if (variance := letters["noise_variance"]) not in zero:
        rows["Q'"] -= variance * sp.MatrixSymbol("N", 3, 3)
        rows["Y'"] -= variance * sp.MatrixSymbol("n", 3, 1)
    share, rho = letters["gain"] * D / (letters["caution"] + D**2), sp.Symbol("rho")
    point, constants = sp.Matrix(sp.symbols("q1 q2 1")), sp.Matrix(sp.symbols("q1 q2 rho"))
    return [
        row(formula(dotted(Phi), rows["Phi'"]), ",", formula(dotted(xi), rows["xi'"])),
        row("the point", formula("<mi>X</mi>", Phi * point / rho + xi), "with", formula(sp.Symbol("theta"), constants)),
        row("the ray's normals B give", formula(phi * sp.MatrixSymbol("theta", 3, 1), r)),
        row(formula(dotted(Q), rows["Q'"], letters), ",", formula(dotted(Y), rows["Y'"], letters)),
        row(formula(dotted(theta), share * (adj * Y - D * theta), letters)),
    ]


def _turning_lines(letters: Mapping[str, sp.Symbol], zero: Sequence[sp.Symbol] = ()) -> list[str]:
    G, S, F, u, C, A, one = (sp.MatrixSymbol(name, 3, 3) for name in ("G", "S", "F", "U", "C", "A", "I"))
    h, k, R = sp.MatrixSymbol("h", 1, 3), sp.MatrixSymbol("k", 3, 1), letters["noise_variance"]
    Q = sp.ZeroMatrix(3, 3) if letters["process_noise"] in zero else letters["process_noise"] * one
    rows = turning_equations(G, S, F, u, h, k, one + C / 2, Q, sp.MatrixSymbol(R.name, 1, 1))
    return [
        row(formula(dotted(G), rows["G'"]), ",", formula(dotted(S), rows["S'"], letters)),
        row(formula(F, G**-1 * A * G - u), ", U moves the estimate, G's last column, as the motion does"),
        row(formula("<mi>s</mi>", rows["s"], letters), ",", formula("<mi>k</mi>", rows["k"])),
        row("at a sample of an output", formula(after(G), rows["G+"]), ",", formula(after(S), rows["S+"])),
        row("C turns and scales by k times the innovation"),
        row(
            "at the start", formula(S, sp.diag(*[letters["measured_variance"]] * 2, letters["range_variance"]), letters)
        ),
        row("and an inverse distance of at least", markup(letters["least_inverse"], letters)),
    ]


X2 = sp.Symbol("x2")
_OFFSET = formula(sp.Symbol("f_0"), sp.Matrix([sp.Symbol("phi"), sp.Function("g")(0)]))
"""Definition of f_0, the rate of (x1, x2) at x2 = 0."""
IN_MATRICES: Mapping[Callable[..., Observer], Callable[..., list[str]]] = {
    extended_kalman: _kalman_lines,
    linear_approximation: _cascade_lines,
    gpebo: _constants_lines,
    equivariant_filter: _turning_lines,
}
"""For observers with a matrix as their state: the function that writes their equations in matrices."""
