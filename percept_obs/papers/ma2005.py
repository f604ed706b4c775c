"""Ma, Chen and Moore 2005: what its equations and statements are compared with."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.linalg import inv, norm
from scipy.linalg import expm, solve_continuous_lyapunov

from percept_obs.compile import Array, vectorised
from percept_obs.observability import instantaneous, windowed
from percept_obs.observers import Observer, ibo, smo
from percept_obs.observers.identifier_based import A, G, P
from percept_obs.observers.parts import M, gamma, hats, sigma2
from percept_obs.observers.sliding_mode import alpha, alpha1, delta
from percept_obs.papers import MA2005
from percept_obs.papers.base import Matrix, Values, column, exactly, matrix, named, paired, real, vanishes
from percept_obs.papers.entries import DEPENDS, NOT_CHECKABLE, Told
from percept_obs.papers.letters import Print
from percept_obs.papers.scalars import Inner
from percept_obs.recording import Camera, Recording, Scenario, Uniform, record
from percept_obs.recording.scenarios import ma2005_eq35, ma2005_eq36
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.motion import affine
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import POINT, chained, pinhole, plane
from percept_obs.system.surfaces.base import X, Y, Z
from percept_obs.tracking import Run, track

SYSTEM = PerspectiveSystem(affine(), pinhole())
SYSTEMS = {"pinhole": SYSTEM, "chained": PerspectiveSystem(affine(), chained())}
MOTION = SYSTEM.motion
BOTH, FIRST, SECOND = (SYSTEM.measure(*outputs) for outputs in (("y1", "y2"), ("y1",), ("y2",)))
FORMS = {"both": BOTH, "first": FIRST, "second": SECOND}
OBSERVERS = {"IBO": ibo, "SMO": smo}
EQ35 = ma2005_eq35()
EXAMPLES = {35: EQ35, 36: ma2005_eq36()}
SPEED = MOTION.A * column(*POINT) + MOTION.b
RATES = paired(SYSTEM.coordinates, SYSTEM.rate)
y1, y2, y3 = SYSTEM.coordinates
r1, r2, c = real("r1 r2 c")


# The moving point, and how it is seen.
def velocity() -> Values:
    """Rate of the moving point."""
    return named(POINT, SPEED, "'")


def seen(surface: str) -> Values:
    """Image and inverse distance of a point, by the letters of the coordinates."""
    system = SYSTEMS[surface]
    return named(system.coordinates, (*system.surface.image, 1 / system.surface.distance))


def rates(surface: str) -> Values:
    """Rates of a surface's coordinates."""
    return named(SYSTEMS[surface].coordinates, SYSTEMS[surface].rate, "'")


def on_the_plane(*normal: str) -> Values:
    """Projection and outputs on the plane n . X = 1, scaled until (0, 0, 1) is its own image, as in print."""
    surface = plane(outputs=3)
    scale = 1 / surface.image[2].subs(paired(POINT, (0, 0, 1)))
    values = (*(scale * entry for entry in surface.image), surface.distance, *surface.image, 1 / surface.distance)
    chosen = paired(plane().parameters, map(sp.Integer, normal)) if normal else {}
    return named("X_p Y_p Z_p l_p y_g1 y_g2 y_g3 y_g4", (sp.cancel(value.xreplace(chosen)) for value in values))


def ranks(output: tuple[sp.Symbol, ...], motion: Values, here: Values) -> list[int]:
    """Rank of outputs with their first derivatives, and with their second ones, at a point."""
    derivative = known = column(*output)
    found = []
    for _ in range(2):
        derivative = derivative.jacobian(SYSTEM.coordinates) * SYSTEM.rate.xreplace(motion)
        known = known.col_join(derivative)
        found.append(int(known.jacobian(SYSTEM.coordinates).subs(here).rank()))
    return found


def identified_together(p: Print) -> Told:
    """The rate of y2 in a plane that the motion keeps, and the rank of y1 with two derivatives at some point of it."""
    leaves = (SPEED[1] - c * SPEED[2]).subs(Y, c * Z)
    unknown = (MOTION.A[1, 0], MOTION.A[1, 2], MOTION.b[1])
    (solution,) = sp.linsolve(sp.Poly(leaves, X, Z).coeffs(), unknown)
    kept = paired(unknown, solution)
    listed = paired(MOTION.parameters, map(sp.Integer, (-2, 4, -6, 1, -2, 3, 3, -4, 4, 5, 2, 3)))
    here = {x: kept.get(x, x).subs(c, 2).subs(listed) for x in MOTION.parameters}
    rank = ranks((y1,), here, {y1: sp.Rational(1, 3), y2: 2, y3: sp.Rational(2, 5)})[-1]
    return p.hold({"y2'": RATES[y2].xreplace(kept | {y2: c})}) and rank == 3, [rank]


def turned_axes(p: Print) -> Told:
    """(34): with the new coefficients the pinhole's rate is that of the chained projection."""
    if set(p.given) != {"a", "b"}:
        return False
    renamed = paired((*MOTION.A, *MOTION.b), (*p.given["a"], *p.given["b"]))
    return vanishes(*(SYSTEM.rate.xreplace(renamed) - SYSTEMS["chained"].rate))


# The observers.
def range_terms() -> Values:
    """What the RIO estimates: w y3, with the true y3 and with its estimate."""
    return named("f1 f2 fhat1 fhat2", (*BOTH.w.T * y3, *BOTH.w.T * hats((y3,))[0]))


@cache
def in_vectors(outputs: str) -> Values:
    """The canonical form's and the IBO's letters, as columns and matrices."""
    form = FORMS[outputs]
    equations = ibo(form).equations
    k = len(form.x1)
    state, flow = column(*equations.state), column(*equations.flow).subs(sigma2, 0)
    y = (s for s in form.coordinates if s.name in form.measured)
    values = {"x1": column(*form.x1), "x2": column(*form.x2), "y": column(*y), "w": form.w, "phi": form.phi}
    values |= {"x1'": column(*map(RATES.get, form.x1)), "x2'": column(*map(RATES.get, form.x2)), "xhat": state}
    values |= {"ghat": form.g.xreplace(paired(form.x2, hats(form.x2))), "xhatplus": column(*equations.reset)}
    values |= {"xhat1": state[:k, :], "xhat2": state[k:, :], "xhat1'": flow[:k, :], "xhat2'": flow[k:, :]}
    return values | {"g": form.g, "A": Matrix(A * sp.eye(k)), "P": Matrix(P * sp.eye(k))}


@cache
def in_coordinates(name: str, outputs: str) -> Values:
    """Rates and resets of an observer's states, and the errors, entry by entry."""
    form = FORMS[outputs]
    equations = OBSERVERS[name](form).equations
    state, flow = equations.state, [entry.subs(sigma2, 0) for entry in equations.flow]
    # The package gives all outputs the same delta and alpha1; in print they carry the output's index.
    for k, (output, estimate) in enumerate(zip(form.x1, hats(form.x1), strict=True), 1):
        own, size = {delta: real(f"delta{k}"), alpha1: real(f"alpha{k}")}, sp.Abs(output - estimate)
        flow = [entry.xreplace({size + delta: size + own[delta]}) for entry in flow]
        flow = [entry.xreplace(own) if s.name == f"lambda{k}" else entry for s, entry in zip(state, flow, strict=True)]
    after = (symbol.name.replace("hat", "hatplus") for symbol in state)
    values = named(state, flow, "'") | dict(zip(after, equations.reset, strict=False))
    values |= {line.lhs: line.rhs for line in MA2005["e1, e2, e3"].printed}
    return values | {"alphatilde": RATES[y2].xreplace(paired(form.x2, hats(form.x2)))}


def ibo_mended(outputs: str) -> Values:
    """The package's observer, with A and P of the opposite signs, as in the mended (11)."""
    return {letter: value.xreplace({A: -A, P: -P}) for letter, value in in_coordinates("IBO", outputs).items()}


def error_is_the_package_s(p: Print) -> Told:
    """With the printed errors put in, the package's error dynamics are true rate less estimated rate."""
    observer = ibo(BOTH)
    rate = (column(*BOTH.rate) - column(*observer.equations.flow)).subs(sigma2, 0)
    derived = observer.error_dynamics().subs(sigma2, 0).subs({line.lhs: line.rhs for line in p}, simultaneous=True)
    return vanishes(*(derived - rate))


def feeds_back(p: Print) -> Told:
    """(11): the package's flow but for the signs of A and P, and whether Hurwitz A and P > 0 make it stable."""
    typed = [in_vectors(outputs) for outputs in ("first", "both")]
    other = [values | {name: -values[name] for name in "AP"} for values in typed]
    # The smallest case decides: n1 = n2 = 1, w = 1, phi = g = 0, A = -1, P = 1/2, so that Q = 1.
    one, estimates, error = column(1), hats((y1, y2)), column(r1, r2)
    small = {"w": one, "phi": 0 * one, "ghat": 0 * one, "A": -one, "P": one / 2, G: sp.Integer(10)}
    small |= named("x1 x2 xhat1 xhat2", map(column, (y1, y2, *estimates)))
    rate = column(y2, 0) - column(*(p.put(line.rhs, small)[0] for line in p[:2]))
    slope = rate.subs(paired(estimates, column(y1, y2) - error)).jacobian(error)
    largest = max(map(sp.re, slope.eigenvals(multiple=True)))
    return largest < 0 and (p.hold(*typed) or p.hold(*other)), [largest]


def reset_condition(p: Print) -> Told:
    """(12): the package compares the squares of both sides, neither of which is negative."""
    equations = ibo(FIRST).equations
    positive = {s: sp.Symbol(s.name, positive=True) for s in (M, gamma)}
    pairs = zip(p[0].args, equations.reset_condition.args, strict=True)
    sides = [p.put(side, {"xhat": column(*equations.state)}) - sp.sqrt(square) for side, square in pairs]
    return isinstance(p[0], sp.GreaterThan) and vanishes(*(side.xreplace(positive) for side in sides))


def reset_leads_out(p: Print) -> Told:
    """A reset leads out of its own condition for just the ratios that the print admits."""
    equations = ibo(FIRST).equations
    square, bound = equations.reset_condition.args
    square = sp.cancel(square.subs(paired(equations.state, equations.reset), simultaneous=True))
    ratios = [sp.Rational(k, 100) for k in (50, 99, 100, 101, 200)]
    out = [(square >= bound).subs({gamma: ratio, M: 10}) == sp.false for ratio in ratios]
    return [p[0].subs(gamma, ratio) == sp.true for ratio in ratios] == out


def switching_term(p: Print) -> Told:
    """Remark 1: the package's switching term, and its limit on both sides of zero."""
    left, right = p[0].args
    values = p.letters.values(in_coordinates("SMO", "first"))
    term = values[p["yhat1'"]].coeff(p["lambda1"])
    limits = (left.subs(p["e1"], value).doit() - right.subs(p["e1"], value) for value in (-2, 3))
    return vanishes(left.args[0].xreplace(values) - term, *limits)


# The appendix.
@cache
def of_size(n1: int, n2: int) -> Values:
    """The appendix's letters as matrices of a size."""
    shapes = {"A P": (n1, n1), "w wbar": (n2, n1), "e1 xi1 phi x1": (n1, 1), "e2 xi2 g ghat x2": (n2, 1)}
    words = ((name, shape) for names, shape in shapes.items() for name in names.split())
    return {name: matrix(name.removesuffix("bar"), *shape) for name, shape in words}


def of_any_size() -> list[Values]:
    """The appendix's letters in three sizes."""
    return [of_size(1, 1), of_size(2, 1), of_size(1, 2)]


def reduced(p: Print, A: Array, P: Array, W: Array) -> Array:
    """Matrix of the linear error dynamics that the lines say, for these A, P and w."""
    n2, n1 = W.shape
    state = of_size(n1, n2)
    values = state | named("A P wbar", map(Matrix, (A, P, W)))
    rate = column(*(entry for line in p for entry in p.put(line.rhs, values)))
    return np.array(rate.jacobian(column(*state["xi1"], *state["xi2"])), np.float64)


HURWITZ = np.array([[-1.0, 2.0], [0.0, -2.0]])
# A Hurwitz, P > 0 of its Lyapunov equation with Q = I, and a w that (14) admits.
ONE = (np.array([[-1.0]]), np.array([[0.5]]), np.array([[1.0]]))
TWO = (HURWITZ, solve_continuous_lyapunov(HURWITZ.T, -np.eye(2)), np.array([[1.0, 2.0]]))


def reduced_dynamics_are_stable(p: Print) -> Told:
    """Eigenvalues of (38) with two pairs of a Hurwitz A and the P > 0 of its Lyapunov equation, all to the left."""
    largest = [np.linalg.eigvals(reduced(p, *case)).real.max() for case in (ONE, TWO)]
    return max(largest) < 0, largest


def fulfilled(p: Print, constants: Values, along: Callable[[Array], Values]) -> bool:
    """Return True if all lines hold for errors xi of all directions and several sizes, zero among them."""
    angles = np.linspace(0, np.pi, 19)
    errors = [size * np.array([np.cos(angle), np.sin(angle)]) for size in (0, 0.1, 1, 10) for angle in angles]
    here = (constants | {"norm(xi)": norm(x)} | along(x) for x in errors)
    numbers = ({name: sp.Float(value) for name, value in each.items()} for each in here)
    return all(p.put(line, values) == sp.true for values in numbers for line in p)


def rate_of_V1(values: Values) -> sp.Expr:
    """The rate of xi1^T P xi1 + |xi2|^2 along the mended (38), less xi1^T (A^T P + P A) xi1."""
    p = MA2005[38].corrected
    values = values | {"P": (values["P"] + values["P"].T) / 2}
    values |= named("dxi1 dxi2", (p.put(line.rhs, values) for line in p))
    return p.put(p["2 inner(P xi1, dxi1) + 2 inner(xi2, dxi2) - inner(xi1, (A^T P + P A) xi1)"], values)


TINY = 1e-9


def first_function(p: Print) -> Told:
    """V1 = xi1^T P xi1 + |xi2|^2 along the mended (38), and its d1, d2, d3 for A = -1, P = 1/2, w = 1, rho = 2."""
    F, weight, fall = reduced(MA2005[38].corrected, *ONE), np.diag([0.5, 1.0]), np.diag([1.0, 0.0])
    whole = solve_continuous_lyapunov(F.T, -fall)
    gathered = whole - expm(F * 2).T @ whole @ expm(F * 2)
    d = (0.5, 1.0, np.linalg.eigvalsh(gathered)[0] - TINY)
    quadratic = {"V1": weight, "V1'": -fall, "OVER_A_WINDOW": -gathered}
    holds = fulfilled(p, named("d1 d2 d3", d), lambda x: {name: x @ part @ x for name, part in quadratic.items()})
    return holds and d[2] > 0 and vanishes(*map(rate_of_V1, of_any_size())), d


def second_function(p: Print) -> Told:
    """V2 = xi^T S xi with F^T S + S F = -I for the mended (38), xi' = F xi, with its c1 to c4."""
    S = solve_continuous_lyapunov(reduced(MA2005[38].corrected, *ONE).T, -np.eye(2))
    least, largest = np.linalg.eigvalsh(S)
    c = (least - TINY, largest + TINY, 1 - TINY, 2 * largest + TINY)
    constants = named("c1 c2 c3 c4", c)
    return fulfilled(p, constants, lambda x: {"V2": x @ S @ x, "V2'": -x @ x, "norm(dV2)": norm(2 * S @ x)}), c


def choice_of_gain(p: Print) -> Told:
    """The rate of V2 along (40) with the bounds (39) and (13), and the gain at which it changes sign."""
    bound, choice = p
    # g enters (40) over G^3; (13) bounds its change by alpha0 |e2|, and e2 = G^2 xi2.
    derived = p["-c3 norm(xi)^2 + c4 norm(xi) alpha0 G^2 norm(xi) / G^3"]
    kinds = isinstance(bound, sp.LessThan) and isinstance(choice, sp.StrictGreaterThan)
    same = vanishes(bound.rhs - derived, derived.subs(G, choice.rhs))
    return kinds and same and (bound.lhs, choice.lhs) == (p["V2'"], G)


# The sliding mode observer's proof.
lam = real("lambda")


def smallest_form() -> CanonicalForm:
    """A canonical form with one measured and one hidden coordinate."""
    p, q, w, phi = real("p q w phi")
    g = column(sp.Function("g", real=True)(q))
    return CanonicalForm((p,), (q,), (w, phi), (p, q), w=column(w), phi=column(phi), g=g)


def with_g_left_out(form: CanonicalForm) -> CanonicalForm:
    """The form with g = 0, so that (25) is true."""
    return replace(form, g=Matrix.zeros(*form.g.shape))


SMALL = smallest_form()
SMALLEST = with_g_left_out(SMALL)


@cache
def errors(form: CanonicalForm, layer: bool = False) -> Values:
    """The SMO's error dynamics, with the boundary layer or as it vanishes, away from e1 = 0."""
    observer = smo(form)
    form = observer.form.canonical_form()
    letter = paired(form.coordinates, observer.error)
    rate = paired(observer.error, observer.error_dynamics().subs(sigma2, 0))
    e1, e2 = (column(*map(letter.get, part)) for part in (form.x1, form.x2))
    values = {"e1": e1, "e2": e2, "e1'": column(*map(rate.get, e1)), "e2'": column(*map(rate.get, e2))}
    ghat = form.g.subs({s: s - letter[s] for s in form.x2}, simultaneous=True)
    same = {s: lam for s in observer.equations.state if s.name.startswith("lambda")}
    values = {name: value.subs(same) for name, value in (values | {"w": form.w, "g": form.g, "ghat": ghat}).items()}
    signs = {sp.Abs(error): error / sp.sign(error) for error in e1}  # |e| = e / sgn(e)
    return values if layer else {name: value.subs(delta, 0).xreplace(signs) for name, value in values.items()}


def sliding(rest: str = "") -> list[Values]:
    """The SMO's error dynamics for all outputs; without g, if there is a rest."""
    return [errors(with_g_left_out(form) if rest else form) for form in FORMS.values()]


def with_energy(form: CanonicalForm, layer: bool = False, p: Print | None = None) -> Values:
    """(26) and the rate along it of the energy that (27) begins with."""
    values, p = errors(with_g_left_out(form), layer), p or MA2005["(27)"].printed
    energy, error, rate = p.put(p[0].rhs, values), *(values["e1" + x].col_join(values["e2" + x]) for x in ("", "'"))
    return values | {"V1'": (column(energy).jacobian(error) * rate)[0]}


def energy_balance(p: Print) -> Told:
    """(27): every line is the rate of the printed energy along (26)."""
    definition, *lines = p
    squares = {p["inner(e1, e1)"], p["inner(e2, e2)"]}
    if definition.lhs != p["V1"] or not definition.rhs.atoms(Inner) <= squares:
        return False
    return Print(tuple(lines), p.letters).hold(*(with_energy(form, p=p) for form in FORMS.values()))


def in_the_layer() -> list[Values]:
    """(26) and its energy with the boundary layer, for either output."""
    return [with_energy(form, layer=True) for form in (FIRST, SECOND)]


def can_grow(p: Print, layer: str = "") -> Told:
    """At e1 = 0.01, e2 = -1, w = 1 the energy grows, and the faster the larger alpha and lambda are."""
    values = with_energy(SMALL, bool(layer))
    start = paired((*values["e1"], *values["e2"], *SMALL.w, delta), (sp.Rational(1, 100), -1, 1, sp.Rational(1, 5)))
    growth, refuted = [], []
    for gain in (5, 50, 500):
        here = {name: values[name].subs(start | {alpha: gain, lam: gain}) for name in ("V1'", "e1", "e2", "w")}
        refuted.append(sp.And(*(p.put(line, here) for line in p)) == sp.false)
        growth.append(here["V1'"])
    return not all(refuted), growth


def where_g_is_the_same(p: Print) -> Told:
    """Conditions on the coefficients of (4), with both outputs, for g not to depend on x2."""
    values = errors(BOTH)
    needed = sp.Poly((values["g"] - values["ghat"])[0], *BOTH.coordinates, *values["e2"]).coeffs()
    zero = dict.fromkeys((*MOTION.A[2, :], MOTION.b[2]), sp.S.Zero)
    same = p.hold({name: value.xreplace(zero) for name, value in values.items()} | {"O": sp.zeros(1, 1)})
    just_these = {s for part in needed for s in part.free_symbols} == set(zero)
    return just_these and same and DEPENDS, [len(needed)]


def on_the_surface() -> sp.Expr:
    """Rate of e2 on e1 = 0, where the switching term equals w^T e2, over e2; n1 = n2 = 1, g = 0."""
    values = errors(SMALLEST)
    return (values["e2'"] - alpha * SMALL.w * values["e1'"])[0].expand() / values["e2"][0]


def stable_nearby(p: Print) -> Told:
    """(26) for n1 = n2 = 1, w = 1, alpha = 5, lambda = 1: the rate of e2 on e1 = 0, and the largest there is."""
    values, listed = errors(SMALLEST), {SMALL.w[0]: 1, alpha: 5, lam: 1}
    rate = on_the_surface().subs(listed)
    fastest = abs(values["e2'"][0].subs(listed).subs(values["e1"][0], 1))
    return rate < 0 < fastest and DEPENDS, (rate, 5 / fastest, 50 / fastest)


def energy_over_a_window(p: Print) -> Told:
    """(29): the chain along the sliding motion e1 = 0 of (26), with w = alpha = 1, over 2 s."""
    tau = real("tau")
    hidden = sp.exp(on_the_surface().subs({alpha: 1, SMALL.w[0]: 1}) * tau)
    path = {"E1": sp.S.Zero, "E2": hidden, "W": sp.S.One, "rateV": sp.diff(hidden**2 / 2, tau)}
    excited = sp.integrate(path["W"] ** 2, (tau, 0, 2))
    constants = p.letters.values(named("t window beta lambdabar alphabar", (0, 2, excited, 1, 1)))

    def worth(side: sp.Expr) -> float:
        for name, value in path.items():
            side = side.replace(p[name], sp.Lambda(tau, value))
        return float(side.subs(constants).doit())

    members = [worth(p[0].lhs), *(worth(line.rhs) for line in p[:3])]
    left, first, second, right = members
    return left <= first + 1e-9 and first <= second + 1e-9 and abs(second - right) < 1e-9, members


def perturbed_energy(p: Print) -> Told:
    """(31) for n1 = n2 = 1: the first line against the chain rule, the others against (30) and (13)."""
    first, second, third = p
    # (24) less (26) is the change of g, in the hidden part only.
    full, kept = errors(SMALL), errors(SMALLEST)
    change = full["e2'"] - kept["e2'"] - p.put(p["g - ghat"], full)
    by_chain_rule = vanishes(*change) and full["e1'"] == kept["e1'"]
    here = {"dV2": column(r1, r2), "V_24": p["V_26"] + r2 * c, "g1 - ghat1": c}
    left, right = p.put(first.lhs, here), p.put(first.rhs, here)
    if isinstance(first, sp.Eq):
        holds = vanishes(right - left)
    else:
        # s |c| is at least r2 c if the difference of the squares is not negative.
        holds = sp.expand((right - p["V_26"]) ** 2 - (r2 * c) ** 2).is_nonnegative
    bound = "alpha0 norm(x2 - xhat2)"
    bounds = {"V_26": "-c3 norm(e)^2", "norm(dV2)": "c4 norm(e)", "abs(g1 - ghat1)": bound, "g1 - ghat1": bound}
    # The hidden error is at most the whole one.
    whole = {p["norm(x2 - xhat2)"]: p["norm(e)"]}
    steps = second.rhs - first.rhs.xreplace(p.letters.values(bounds)), third.rhs - second.rhs.xreplace(whole)
    at = {r1: 3, r2: 4, c: 1, p["V_26"]: 0}
    return by_chain_rule and holds and vanishes(*steps), (left.subs(at), right.subs(at))


def contradicts_itself(p: Print, *vanishing: str) -> bool:
    """Return True if the lines cannot all hold where these letters are zero."""
    return bool(sp.And(*(p.put(line, dict.fromkeys(vanishing, sp.S.Zero)) for line in p)).simplify() == sp.false)


def lyapunov_function(p: Print) -> Told:
    """(30) and (39): strict inequalities contradict each other where all norms are zero; the rest is cited."""
    return not contradicts_itself(p, "norm(e)", "norm(dV2)", "V2'") and NOT_CHECKABLE


def large_against_the_start(p: Print) -> Told:
    """Rate of e1 on both sides of e1 = 0 for n1 = n2 = 1: towards it just where lambda is more than |w^T e2|."""
    values = errors(SMALL)
    (rate,), (error,), (hidden,), (w,) = values["e1'"], values["e1"], values["e2"], SMALL.w
    return vanishes(*(rate.subs(sp.sign(error), side) - w * hidden + side * lam for side in (1, -1))), (1, 10)


# Assumptions, and what they say about observability.
def lipschitz(p: Print) -> Told:
    """(13): g is a polynomial, so its slope is bounded in a ball; the constant for (35), y1 alone."""
    if contradicts_itself(p, "norm(g - gz)", "norm(x2 - z2)"):
        return False, (0, 0)
    return True, {"alpha0 of (35)": lipschitz_constant(FIRST)}


def lipschitz_constant(form: CanonicalForm) -> float:
    """A bound on the slope of g in x2 for (35), where no coordinate is beyond gamma M."""
    gains = ibo(form).gain_values
    ball = gains[M] * gains[gamma]
    slope = form.g.jacobian(form.x2).xreplace(exactly(EQ35.motion.values))
    polynomials = [sp.Poly(entry, *SYSTEM.coordinates) for entry in slope]
    return math.hypot(*(sum(abs(float(c)) * ball ** sum(powers) for powers, c in p.terms()) for p in polynomials))


def circle() -> Values:
    """Centre and radius of the circle, if its centre is the focus of expansion."""
    centre, size = instantaneous(BOTH).circle(sp.Symbol("epsilon", positive=True))
    return named("o1 o2 r", (*centre, size)) if centre == tuple(SYSTEM.foe) else {}


def an_instant_suffices(p: Print, outputs: str) -> Told:
    """The condition is the package's measure; and whether the rank of w w^T lets it be fulfilled anywhere."""
    line, positive = p
    form, measure = FORMS[outputs], instantaneous(FORMS[outputs])
    gap = p.put(line.lhs, {"w": form.w}) - line.rhs - (measure.determinant - p["epsilon"])
    if not (isinstance(line, sp.StrictGreaterThan) and vanishes(gap) and positive.doit() == sp.true):
        return False
    return measure.suffices, (measure.rank, len(form.x2))


def smallest_of_rank_one(p: Print) -> Told:
    """(19): both matrices are right; the smallest eigenvalue of the second is 0 everywhere."""
    both, first = p
    entries = named("abar bbar", FIRST.w)
    difference = p.put(first.lhs.args[0], entries) - instantaneous(FIRST).information
    if not vanishes(*difference, both.lhs - instantaneous(BOTH).determinant):
        return False
    smallest = p.put(first.lhs, entries)
    return not vanishes(smallest), [smallest]


def same_sums(p: Print) -> Told:
    """Operations in the two sums of (20), and the size and rank of the matrices of (17) and (18)."""
    both, first = (line.lhs.count_ops() for line in MA2005[20].printed)
    of_first = instantaneous(FIRST)
    return both == first and not of_first.suffices and DEPENDS, (both, first, len(FIRST.x2), of_first.rank)


def stronger_than_excitation(p: Print) -> Told:
    """Constant w: least eigenvalues of the printed w^T w and of w w^T, which persistency of excitation gathers."""
    products = (product for w in (np.ones((2, 1)), np.ones((1, 2))) for product in (w.T @ w, w @ w.T))
    least = [round(np.linalg.eigvalsh(product)[0], 9) for product in products]
    alone, as_meant, both, excited = least
    return alone > as_meant == both == 0 < excited and DEPENDS, least


# The examples.
def example(number: str) -> Values:
    """Velocity and start of an example."""
    scenario = EXAMPLES[int(number)]
    start = named("X_0 Y_0 Z_0", (sp.Rational(str(value)) for value in scenario.position))
    speed = scenario.motion.A * column(*POINT) + scenario.motion.b
    return named(POINT, speed.xreplace(exactly(scenario.motion.values)), "'") | start


def seen_at_the_start() -> Values:
    """Coordinates of the point's start."""
    start = paired(POINT, real("X_0 Y_0 Z_0"))
    return named("y_01 y_02 y_03", (value.xreplace(start) for value in seen("pinhole").values()))


def gains(name: str) -> Values:
    """The package's gains of an observer, by their letters."""
    values = exactly(OBSERVERS[name](FIRST).gain_values)
    return dict(values) | {"delta1": values.get(delta)}


def stable_at_zero(p: Print, name: str) -> Told:
    """The package has these numbers; with them the error dynamics are stable at 0 for n1 = n2 = 1, w = 1, g = 0."""
    made = OBSERVERS[name](SMALLEST)
    here = {line.lhs: line.rhs for line in p} | dict.fromkeys((*made.error, sigma2), 0)
    here |= {SMALL.w[0]: 1, delta: p.given.get("delta1", 0)}
    here |= {s: p.given["lambda0"] for s in made.equations.state if s.name.startswith("lambda")}
    slope = made.error_dynamics()[:2, :].jacobian(made.error).subs(here)
    largest = max(map(sp.re, slope.eigenvals(multiple=True)))
    return largest < 0, [largest]


# Runs.
OUTPUTS = {"y1 alone": FIRST, "y1 and y2": BOTH}
SEEDS = (0, 1, 2)
PERIOD = 0.01
"""Seconds between samples; the paper does not tell them."""


def on_path(scenario: Scenario, *expressions: sp.Expr) -> Array:
    """Values of expressions along an example's path, a row each."""
    truth = scenario.coordinates(np.arange(0, scenario.duration, PERIOD))
    return np.stack(vectorised(SYSTEM.coordinates, list(expressions), scenario.motion.values)(*truth.T))


@cache
def through_the_foe() -> Recording:
    """The motion of (35) without noise, from a start at the focus of expansion."""
    position = [5 * EQ35.motion.values[x] for x in MOTION.b]
    return record(Scenario("through the focus of expansion", EQ35.motion, position, 10.0, pinhole()))


@cache
def one_direction_seen() -> Run:
    """The IBO where a12 = b1 = 1 and all else is 0: w = (1, 1), so that only y2 + y3 is seen."""
    motion = affine([[0, 1, 0], [0, 0, 0], [0, 0, 0]], [1, 0, 0])
    recording = record(Scenario("only y2 + y3 is seen", motion, (-8, 3, 8), 10.0, pinhole()))
    return track(recording, ibo(FIRST), (0, 0, 0))


def unseen() -> tuple[Values, Array]:
    """Motion in which y2 - y3 is not seen, and the error of that at start and end."""
    run = one_direction_seen()
    return exactly(run.recording.motion.values), run.error[[0, -1], 1] - run.error[[0, -1], 2]


def excitation(p: Print) -> Told:
    """(14): the proofs integrate |w^T e2|^2, so it bounds the matrix of that quadratic form, by a matrix."""
    gathered = p[0].lhs.function
    for form in (FIRST, BOTH):
        e2, integrand = matrix("e", len(form.x2)), p.put(gathered, {"w": form.w})
        seen = sum(entry**2 for entry in form.w.T * e2)
        if integrand.shape != (len(e2), len(e2)) or not vanishes((e2.T * integrand * e2)[0] - seen):
            values, error = unseen()
            return False, (p.put(gathered, {"w": FIRST.w.subs(values)})[0], *error)
    return p[0].rhs == p["beta I"]


def not_at_every_instant(p: Print) -> Told:
    """Through the focus of expansion the printed bound fails at an instant, and every window is excited."""
    (line,) = p
    if not vanishes(line.lhs - instantaneous(BOTH).determinant):
        return False
    recording = through_the_foe()
    least = vectorised(BOTH.x1, [line.lhs], recording.motion.values)(*recording.outputs.T)[0].min()
    gathered = windowed(BOTH, recording, 1.0).least
    return not least < 1e-12 < 1e-2 < gathered, (least, gathered)


def range_at_the_foe(p: Print) -> Told:
    """Ranks for a point of (35) that passes the focus of expansion and one that stays there, and a run from there."""
    passing = exactly(EQ35.motion.values)
    motions = passing, passing | dict.fromkeys(MOTION.A, sp.S.Zero)
    foes = (paired(BOTH.x1, SYSTEM.foe.xreplace(motion)) | {y3: sp.Rational(2, 3)} for motion in motions)
    (first, second), (_, never) = (ranks(BOTH.x1, *pair) for pair in zip(motions, foes, strict=True))
    settles = track(through_the_foe(), ibo(BOTH), (0, 0, 0)).settling_time(0.05, "y3")
    depends = (first, second, never) == (2, 3, 2) and math.isfinite(settles)
    return depends and DEPENDS, (first, second, never, settles)


def larger_of_rank_one(p: Print) -> Told:
    """(20): the second sum is the larger eigenvalue; it is 2 where a direction is never seen."""
    both, first = (line.lhs for line in p)
    if not vanishes(first - instantaneous(FIRST).information.trace(), both - instantaneous(BOTH).determinant):
        return False
    motion, (start, end) = unseen()
    return not (first.subs(motion) > 0 and abs(end - start) < 1e-9 < abs(start)), (first.subs(motion), start, end)


def state_is_bounded(p: Print) -> Told:
    """Assumption 1: the largest norms of y in 80 s of both examples."""
    bound = ibo(FIRST).gain_values[M]
    largest = [on_path(scenario, column(*SYSTEM.coordinates).norm()).max() for scenario in EXAMPLES.values()]
    return all(p.separates("norm(x)", norm, 1.01 * bound, {"M": bound}) for norm in largest), largest


def w_is_bounded(p: Print) -> Told:
    """Assumption 1: the largest norms of w and of its rate in 80 s of (35), y1 alone."""
    rate = FIRST.w.jacobian(SYSTEM.coordinates) * SYSTEM.rate
    largest = on_path(EQ35, FIRST.w.norm(), rate.norm()).max(axis=1)
    return np.isfinite(largest).all(), largest


def constants_are_given(p: Print) -> Told:
    """Return True if (35) admits it: on e1 = 0, e2' = -alpha |w|^2 e2, so (30) asks c3 / c4 <= alpha |w|^2."""
    least = (on_path(EQ35, BOTH.w.norm()) ** 2).min()
    listed, wanted = smo(BOTH).gain_values[alpha] * least, lipschitz_constant(BOTH)
    return listed > wanted or DEPENDS, (wanted, listed, wanted / least)


def small_denominators(p: Print) -> Told:
    """Slope of the estimate of y3 in those of f1 and f2: one over the root of the denominator, on (35) where least."""
    w1, w2 = BOTH.w
    f1, f2, yhat3 = real("f1 f2 yhat3")
    both = (f1**2 + f2**2) / (w1**2 + w2**2)
    # of the root of both, which is y3's estimate
    slope = sum((both.diff(f) / (2 * yhat3)) ** 2 for f in (f1, f2)).xreplace({f1: w1 * yhat3, f2: w2 * yhat3})
    one, two = on_path(EQ35, w1**2, w1**2 + w2**2).min(axis=1) ** -0.5
    return vanishes(slope - 1 / (w1**2 + w2**2)) and one > 10 * two, (one, two)


def rate_is_bounded(p: Print) -> Told:
    """Largest |e1'| = |w^T e2 - s| of the SMO in the runs on both examples, and |w| (1 + gamma) M + lambda for each."""
    found: list[float] = []
    for scenario in EXAMPLES.values():
        run = track(record(scenario, camera=Camera(PERIOD)), smo(BOTH), [0, 0, 0])
        w = np.stack(vectorised(SYSTEM.coordinates, list(BOTH.w), scenario.motion.values)(*run.truth.T))
        gains, error, grown = run.observer.gain_values, run.error[:, :2], run.state[:, 3:]
        pull = grown * error / (np.abs(error) + gains[delta])
        edge = norm(w, axis=0).max() * (1 + gains[gamma]) * gains[M] + norm(grown.max(axis=0))
        found += [norm(w.T * run.error[:, 2:] - pull, axis=1).max(), edge]
    return found[0] <= found[1] and found[2] <= found[3], found


# The figures.
def noise() -> float:
    """The printed noise."""
    return float(MA2005["noise"].printed[0].rhs)


def followed_by(observer: Observer, recording: Recording, **options: Any) -> Run:
    """Run of an observer from the printed start."""
    return track(recording, observer, list(map(float, MA2005["start"].printed[0].rhs)), **options)


@cache
def recorded(number: int, seed: int, period: float = PERIOD) -> Recording:
    """Recording of an example with the printed noise."""
    return record(EXAMPLES[number], camera=Camera(period, Uniform(noise())), seed=seed)


@cache
def followed(number: int, name: str, outputs: str, seed: int, period: float = PERIOD) -> Run:
    """Run of an observer on an example, by its outputs."""
    return followed_by(OBSERVERS[name](OUTPUTS[outputs]), recorded(number, seed, period))


def settling(number: int, name: str, outputs: str) -> list[float]:
    """When the hidden error has entered 0.05 for good, with each seed; infinite if it never does."""
    hidden = OUTPUTS[outputs].hidden
    return [followed(number, name, outputs, seed).settling_time(0.05, *hidden) for seed in SEEDS]


def converge(p: Print, number: str, *runs: str) -> Told:
    """When the hidden errors have entered 0.05 for good, with three seeds."""
    times = [max(settling(int(number), *run.split(": "))) for run in runs]
    return all(map(math.isfinite, times)), times


def never_reset(name: str) -> list[int]:
    """How many of five runs on (35), y1 alone, are without a reset, for noise drawn every 10 ms and every 1 s."""
    clean, found = record(EQ35, camera=Camera(PERIOD)), []
    for held in (1, 100):
        count = 0
        for seed in range(5):
            drawn = np.random.default_rng(seed).uniform(-noise(), noise(), (len(clean.time) // held + 1, 2))
            noisy = replace(clean, outputs=clean.outputs + np.repeat(drawn, held, axis=0)[: len(clean.time)])
            count += not len(followed_by(OBSERVERS[name](FIRST), noisy).resets)
        found.append(count)
    return found


def first_figure(p: Print) -> Told:
    """Runs of both observers with y1 alone; and of the SMO where noise is drawn less often."""
    settled, _ = converge(p, "35", "IBO: y1 alone", "SMO: y1 alone")
    numbers = []
    for name in OBSERVERS:
        seeded = [followed(35, name, "y1 alone", seed) for seed in SEEDS]
        numbers += [min(len(run.resets) for run in seeded), min(np.abs(run.error[-1, 1:]).max() for run in seeded)]
    free = never_reset("SMO")
    return settled or max(free) >= 3, (*numbers, *free)


def second_figure(p: Print) -> Told:
    """Runs of the IBO with both outputs, which settle, and with y1 alone, where it depends on the noise."""
    settled, times = converge(p, "35", "IBO: y1 and y2")
    free = never_reset("IBO")
    return settled and list(map(bool, free)) == [False, True] and DEPENDS, (*times, *free)


def similar(p: Print) -> Told:
    """Settling times of both observers with y1 alone on (36), and their errors from 20 s on, with three seeds."""
    ibo, smo = (max(settling(36, name, "y1 alone")) for name in OBSERVERS)
    late = []
    for name in OBSERVERS:
        errors = (run.error[run.time > 20, 1:] for run in (followed(36, name, "y1 alone", seed) for seed in SEEDS))
        late.append(max(np.sqrt(np.square(error).mean()) for error in errors))
    return abs(ibo - smo) < 0.1 * ibo, (ibo, smo, *late)


def slower_with_one_output(p: Print) -> Told:
    """Section 5: on (36) each observer settles later with y1 alone, with every seed."""
    times = np.array([settling(36, name, outputs) for name in OBSERVERS for outputs in OUTPUTS])
    return (times[::2] > times[1::2]).all(), times.max(axis=1)


def estimate_is_bounded(p: Print) -> Told:
    """The bound in the run that is reset most: y1 alone on (35)."""
    run = followed(35, "IBO", "y1 alone", 0)
    largest, resets = float(norm(run.state, axis=1).max()), len(run.resets)
    return resets and p.separates("norm(xhat)", largest, 2 * largest, run.observer.gain_values), (largest, resets)


def resets_at_every_step(p: Print) -> Told:
    """The share of resets that are followed by another one in the next step, for the printed ratio and for 1.01."""
    observer, step = ibo(FIRST), 0.001
    condition = observer.equations.reset_condition.subs(gamma, p[0].rhs)
    as_printed = replace(observer, equations=replace(observer.equations, reset_condition=condition))
    runs = (followed_by(each, recorded(35, 0).between(0, 46), step=step) for each in (as_printed, observer))
    printed, usual = (np.mean(np.diff(run.resets) < 1.5 * step) for run in runs)
    return not usual < 0.01 < 0.99 < printed, (printed, usual)


def positive_definite(p: Print) -> Told:
    """The Lyapunov equation with the listed A and P; and the signs that it asks for, put into (11) on (35)."""
    equation, positive = p
    A, P = (MA2005["IBO list"].printed.given[name] for name in "AP")
    Q = -p.put(equation.lhs, {"A1": column(A), "P1": column(P)})[0]
    as_asked = ibo(BOTH, injection=-float(A), lyapunov=-float(P))
    resets = len(followed_by(as_asked, recorded(35, 0)).resets)
    return p.put(positive, {"P": P}) == sp.true and Q > 0, (P, Q, resets)


# What the text says without a formula.
def film(example: int, period: float) -> Recording:
    """The first 20 s of an example, without noise."""
    return record(replace(EXAMPLES[example], duration=20.0), camera=Camera(period))


def numbers_of(example: int) -> list[Array]:
    """A and b of an example, as numbers."""
    motion = EXAMPLES[example].motion
    return [np.array(part.subs(motion.values).tolist(), dtype=float).squeeze() for part in (motion.A, motion.b)]


def inhibits_chattering(p: Print) -> Told:
    """Mean |e1| that is left of (26) by explicit Euler with the sign and with e1 / (|e1| + delta); slope of that."""
    left = []
    for values in (errors(SMALLEST), errors(SMALLEST, layer=True)):
        gains = {alpha: 5.0, lam: 1.0, delta: 0.2, SMALL.w[0]: 1.0}
        rate = vectorised((*values["e1"], *values["e2"]), [*values["e1'"], *values["e2'"]], gains)
        error, sizes = np.array([0.1, 0.05]), []
        for _ in range(2000):
            error = error + PERIOD * np.array([float(entry) for entry in rate(*error)])
            sizes.append(abs(error[0]))
        left.append(np.mean(sizes[-100:]))
    x = sp.Symbol("x", positive=True)
    slope = sp.limit((x / (x + delta)).diff(x), x, 0)
    return left[1] < 1e-3 * left[0] and slope == 1 / delta, left


def any_start_of_lambda(p: Print) -> Told:
    """When the SMO's hidden errors have entered 0.05 on (36), y1 alone, no noise; or how often it is reset."""
    settled, last = [], []
    for first, period in ((0.01, 0.01), (10, 0.01), (100, 0.001), (100, 0.01)):
        run = track(film(36, period), smo(FIRST, switching_gain=first), [0.0] * 3)
        settled.append(run.settling_time(0.05, *FIRST.hidden))
        last.append(np.abs(run.error[-1, 1:]).max())
    depends = list(map(math.isfinite, settled)) == [True, True, True, False]
    return depends and DEPENDS, (*settled[:3], last[3])


def spread(example: int, form: CanonicalForm) -> float:
    """Relative change of the IBO's y3 from 5 s on, rms, for 1 % in each row of A and each of b."""
    seen, observer = film(example, 0.02), ibo(form)
    first = list(map(float, seen.truth[0]))  # type: ignore[index]
    exact = track(seen, observer, first)
    late, total = seen.time > 5, 0.0
    for row in range(3):
        for part in (0, 1):
            wrong = numbers_of(example)
            wrong[part][row] *= 1.01
            run = track(replace(seen, motion=affine(*(each.tolist() for each in wrong))), observer, first)
            total += np.mean(((run.state - exact.state)[late, 2] / exact.truth[late, 2]) ** 2)
    return math.sqrt(total)


def more_severe(p: Print) -> Told:
    """Relative change of y3's estimate for 1 % in the motion's parameters, with one output and with both."""
    both36, one36, both35, one35 = found = [spread(k, form) for k in (36, 35) for form in (BOTH, FIRST)]
    return both36 < one36 < 1.2 * both36 and one35 > both35, found


def deviation(outputs: int, *normal: float) -> float:
    """Least relative deviation of the depth after 1 s of (35), for equal noise in the outputs of a plane."""
    A, b = numbers_of(35)
    motion = np.block([[A, b[:, None]], [np.zeros((1, 4))]])
    surface = plane(normal, outputs=outputs)
    slope = vectorised(POINT, list(sp.Matrix(surface.image).jacobian(POINT)), surface.values)
    information, point = np.zeros((3, 3)), np.array(EQ35.position)
    for time in np.arange(0, 1 + PERIOD / 2, PERIOD):
        whole = expm(motion * time)
        now = whole[:3, :3] @ point + whole[:3, 3]
        rows = np.array([float(e) for e in slope(*now)]).reshape(outputs, 3) @ whole[:3, :3]
        information += rows.T @ rows
    least = whole[2, :3] @ inv(information) @ whole[2, :3] * noise() ** 2 / 3
    return float(np.sqrt(least) / now[2])


def third_output(p: Print) -> Told:
    """Remark 2: Cramer-Rao bounds of the depth after 1 s of (35), 101 samples, with equal noise in each output."""
    tilted, other = (0.8, 0.5, 1.0), (-0.2, 0.0, 1.0)
    planes = ((2, 0.0, 0.0, 1.0), (2, *tilted), (3, *tilted), (2, *other), (3, *other))
    usual, two, three, _, better = found = [deviation(*each) for each in planes]
    return three < 0.95 * two and better < usual < three and DEPENDS, found
