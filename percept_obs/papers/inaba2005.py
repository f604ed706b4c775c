"""Inaba, Abdursul and Ghosh 2005: what its statements are compared with."""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from math import prod
from typing import Any

import numpy as np
import sympy as sp
from numpy.linalg import inv, norm
from scipy.integrate import cumulative_simpson, simpson

from percept_obs.compile import Array
from percept_obs.papers.base import Matrix, Values, column, filled_in, matrix, named, paired, real, vanishes
from percept_obs.papers.entries import NOT_CHECKABLE, Told
from percept_obs.papers.letters import Print
from percept_obs.points import PointsForm, PointsScenario, constant, luenberger, point_block, rigid_body, scheduled
from percept_obs.points.gramian import gramian, linear_gramian
from percept_obs.points.luenberger import LuenbergerObserver
from percept_obs.points.lyapunov_matrix import LyapunovMatrix
from percept_obs.points.manoeuvre import PATH, TURNING, Manoeuvre
from percept_obs.points.scenarios import along_the_line_of_sight, moving_body
from percept_obs.recording import Camera, record
from percept_obs.system.motion import TIME, cross, linear
from percept_obs.system.surfaces import POINT, pinhole
from percept_obs.tracking import track

BLOCK = point_block(pinhole())
PLACES = Matrix([[2, -1, 3], [5, 4, -2], [1, 7, 6]]), Matrix([[3, 2, -5], [-4, 1, 8], [6, 5, 9]])
"""Places of points on a body, of which no minor vanishes by chance."""
y_sup = sp.Symbol("y_sup", positive=True)
t, s, tau = real("t s tau")


@cache
def observer(points: int, states: int) -> LuenbergerObserver:
    """The package's observer; with two points the points' places are numbers, that proofs stay short."""
    blocks = [matrix("c", 3, states)] if points == 1 else PLACES
    return luenberger(PointsForm(linear(states=states), [block[:, :states] for block in blocks]))


@cache
def known(points: str, states: str) -> Values:
    """Values where the images are letters of their own."""
    made = observer(int(points), int(states))
    form, estimate, truth = made.form, column(*made.estimate), column(*made.form.state)
    values = {"x": truth, "xhat": estimate, "v": form.motion.b, "A": form.motion.A, "C": form.stacked, "B": form.B}
    values |= {"E": form.E(made.estimate), "y": column(*form.y), "P^-1": made.inverse, "K": made.gain}
    values |= {"x'": form.motion.A * truth + form.motion.b, "xhat'": made.flow, "varphi": made.flow}
    values |= {"r": made.gain * (column(*form.y) - form.H(made.estimate))}
    values |= {"rho": column(*made.error), "rho'": made.error_dynamics()}
    return {letter: Matrix(value) for letter, value in values.items()}


def rays(form: PointsForm) -> Values:
    """Images of the state's points, by their letters."""
    return paired(form.y, form.H(form.state))


@cache
def seen(points: str, states: str) -> Values:
    """Values where the images are those of the state, and rho is its error."""
    form = observer(int(points), int(states)).form
    images = form.H(form.state)
    values = {letter: value.xreplace(rays(form)) for letter, value in known(points, states).items()}
    xi, xihat = form.stacked * values["x"], form.stacked * values["xhat"]
    values |= {"y": images, "rho": values["x"] - values["xhat"], "xi": xi, "xihat": xihat}
    places = [f"{row}{k + 1}" for k in range(form.points) for row in (1, 2, 3)]
    for name, entries in (("xi_", xi), ("xihat_", xihat)):
        values |= named((f"{name}{place}" for place in places), entries)
    values |= named((f"y_{place}" for place in places if place[0] != "3"), images)
    for k, C in enumerate(form.C):
        values |= {f"C{k + 1}": C, f"y{k + 1}": images[2 * k : 2 * k + 2, :]}
    return values


def at_the_truth() -> Values:
    """Rate of the estimate and correction where it is the truth, and phi as the rate of that."""
    made, values = observer(1, 2), seen("1", "2")
    agreed = paired(made.estimate, made.form.state)
    return {"xhat'": values["xhat'"].xreplace(agreed), "varphi": values["x'"], "r": values["r"].xreplace(agreed)}


def no_correction(p: Print) -> Told:
    """The package's correction where the estimate is the truth."""
    found = filled_in(p[0].lhs, p.letters.values(at_the_truth()))
    return p[0].rhs == p["O"] and p[0].lhs in (p["r"], p["-r"]) and vanishes(*found)


def needs_no_integral(p: Print) -> Told:
    """The package's observer: as many states as x has, and the slope of their rate in v(t), which is the identity."""
    made = observer(1, 2)
    return len(made.estimate) == 2 and made.flow.jacobian(made.form.motion.b) == sp.eye(2)


def images_and_where(p: Print) -> Told:
    """(2): the images are the pinhole's, and lose their meaning just where the condition is broken."""
    images, *conditions = p
    points = {p["xi"]: column(*(p[f"xi_{i}{k}"] for k in (1, 2) for i in (1, 2, 3)))}
    where = [images.rhs.xreplace({condition.lhs: condition.rhs}).has(sp.zoo) for condition in conditions]
    distances = {condition.lhs for condition in conditions if isinstance(condition, sp.Ne)}
    return Print((images,), p.letters).hold(points) and all(where) and len(distances) == 2


def error_is_the_package_s(p: Print) -> Told:
    """(8): with the printed error put in, the package's error dynamics are true rate less estimated rate."""
    values, made = seen("1", "2"), observer(1, 2)
    here = filled_in(p[0].rhs, p.letters.values(values))
    if here is None or p[0].lhs != p["rho"]:
        return False
    rate = known("1", "2")["rho'"].xreplace(rays(made.form)).xreplace(paired(made.error, here))
    return vanishes(*(rate - values["x'"] + values["xhat'"]))


# The assumptions, and what they say about observability.
def stable_both_ways(p: Print) -> Told:
    """Assumption 3.1 (i) for x' = -x, which is Lyapunov stable: its transition matrix both ways in time."""
    decay = p[0].replace(p["Transition"], sp.Lambda((t, s), sp.exp(s - t))).subs(p["b"], 1)
    ways = ({t: 10, s: 0}, {t: 0, s: 10})
    return all(decay.subs(way) == sp.true for way in ways), [decay.lhs.subs(way) for way in ways]


def gathers(p: Print, what: str) -> Told:
    """The integrand is the square of what an error e of the start, later Phi e, does to points or scaled images."""
    (line,) = p
    made = observer(1, 2)
    form, transition, e = made.form, matrix("Phi", 2, 2), matrix("e", 2)
    effect = form.stacked * transition * e
    if what == "images":
        off = paired(made.estimate, column(*form.state) - transition * e)
        effect = made.scaled_innovation.xreplace(off).xreplace(rays(form))
    values = p.letters.values({"Phi": transition, "C": form.stacked, "B": form.B.xreplace(rays(form))})
    integrand = filled_in(line.lhs.function, values) if isinstance(line.lhs, sp.Integral) else None
    if integrand is None or integrand.shape != (2, 2):
        return False
    # An integrand of 1 makes T of the integral.
    whole = sp.Integral(1, *line.lhs.limits).doit() == p["T"]
    square = vanishes((e.T * integrand * e)[0] - sum(entry**2 for entry in effect))
    bound = p["epsilon I" if what == "images" else "epsilontilde I"]
    return isinstance(line, sp.GreaterThan) and whole and square and line.rhs == bound


def not_needed(p: Print) -> Told:
    """Remark 3.2 for x' = -x + v at rest: (14) fails along the line of sight, and the error along it decays."""
    made, point = observer(1, 2), column(1, 2)
    form = made.form
    letters = (*form.state, *made.error, *form.motion.parameters[:4], *form.stacked)
    values = paired(letters, (*point, *point, *-sp.eye(2), 1, 0, 0, 0, 0, 1))
    parts = (form.B * form.stacked * point, made.error_dynamics())
    gathered, rate = (part.xreplace(rays(form)).xreplace(values) for part in parts)
    return gathered.is_zero_matrix and rate == -point and NOT_CHECKABLE, (gathered.norm(), rate[0])


def information() -> Values:
    """S and B of two points, and the characteristic polynomial of S."""
    images = [paired(BLOCK.y, real(f"y_1{k} y_2{k}")) for k in (1, 2)]
    S, B = (sp.diag(*(part.xreplace(image) for image in images)).as_immutable() for part in (BLOCK.S, BLOCK.B))
    values = {"S": S, "B": B, "det(lambda I3 - S)": (real("lambda") * sp.eye(6) - S).det(method="berkowitz")}
    return values | {f"y{k + 1}": column(*image.values()) for k, image in enumerate(images)}


def eigenvalues(*edge: str) -> Values:
    """Eigenvalues of one point's block, by the package, smallest first; or where an image is at its edge."""
    image = paired(BLOCK.y, (y_sup, sp.S.Zero) if edge else real("y_11 y_21"))
    found = (sp.factor(value.xreplace(image)) for value in BLOCK.eigenvalues())
    first, second, third = sorted(found, key=lambda value: (sp.count_ops(value), str(value)))
    values = {"lambda1": first, "lambda2": second, "lambda3": third, "y1": column(*image.values())}
    # S is at most its largest eigenvalue, so (14) divided by that bounds the Gramian of (C, A).
    epsilon = sp.Symbol("epsilon", positive=True)
    return values | {"lambda_max": third, "norm(B)": sp.sqrt(third), "epsilontilde": epsilon / third}


def bounded_as_a_matrix(p: Print) -> Told:
    """(1 + y_sup^2) I - S has no negative eigenvalue where |y| = y_sup, and one that is zero: no smaller bound does."""
    block = BLOCK.S.xreplace(paired(BLOCK.y, (y_sup, sp.S.Zero)))
    at = {sp.Symbol("p", integer=True, positive=True): sp.S.One}
    sides = [side.xreplace(at).xreplace({sp.MatrixSymbol("S", 3, 3): block}) for line in p for side in line.args]
    gaps = tuple(set((p.put(sides[k + 1], {}) - p.put(sides[k], {})).eigenvals()) for k in (0, 2))
    kinds = all(isinstance(line, sp.LessThan) for line in p)
    return kinds and gaps == ({sp.S.Zero, y_sup**2, 1 + y_sup**2}, {sp.S.Zero, sp.S.One, 1 + y_sup**2})


def seen_of_itself() -> Matrix:
    """B C x of a state whose images are those in B."""
    form = observer(1, 2).form
    return form.B.xreplace(rays(form)) * form.stacked * column(*form.state)


def in_a_cone(p: Print) -> Told:
    """|y|^2 <= y_sup^2, multiplied by xi_3^2: the points of a cone, on both sides of the camera."""
    x = real("xi_1:4")
    image = [entry.xreplace(paired(POINT, x)) for entry in pinhole().image]
    cone = (y_sup**2 - sum(entry**2 for entry in image)) * x[2] ** 2
    return vanishes(cone - (y_sup**2 * x[2] ** 2 - x[0] ** 2 - x[1] ** 2))


# The proof of Theorem 3.4.
@cache
def error_dynamics() -> Values:
    """The package's error dynamics, with theta for what they have besides A rho, and letters for P and its rate."""
    made = observer(1, 2)
    weight, rate = (matrix(name, 2, 2).subs(real(f"{name}_21"), real(f"{name}_12")) for name in ("P", "Pdot"))
    inverse = paired(made.inverse, weight.inv())
    error, motion = column(*made.error), made.form.motion.A
    error_rate = made.error_dynamics().xreplace(inverse)
    energy_rate = (error.T * weight * error).jacobian(error) * error_rate + error.T * rate * error
    values = {"rho": error, "A": motion, "B": made.form.B, "C": made.form.stacked, "P": weight, "Pdot": rate}
    return values | {"rho'": error_rate, "theta": motion * error - error_rate, "Vdot": energy_rate[0]}


def energy_does_not_grow(p: Print) -> Told:
    """(15): it is what the rate of rho^T P rho has besides what is seen."""
    (line,), values = p, p.letters.values(error_dynamics())
    rho, left = values[p["rho"]], filled_in(line.lhs, values)
    if left is None or not isinstance(line, sp.LessThan) or line.rhs != p["O"]:
        return False
    return vanishes((rho.T * left * rho)[0] - p.put(p["Vdot + 2 norm(B C rho)^2"], error_dynamics()))


def as_matrices(side: sp.Expr, values: dict[str, sp.Lambda]) -> sp.MatrixBase:
    """A side of (22) with matrices, of which Phi stands before the vector that it moves."""
    if isinstance(side, sp.Add):
        first, *rest = (as_matrices(part, values) for part in side.args)
        return sum(rest, first)
    if isinstance(side, sp.Integral):
        inside = as_matrices(side.function, values)
        return inside.applyfunc(lambda e: sp.integrate(sp.powsimp(sp.expand(e)), *side.limits))
    if isinstance(side, sp.Mul):
        ordered = sorted(side.args, key=lambda part: (not part.is_number, str(part.func) != "Phi"))
        return prod((part if part.is_number else as_matrices(part, values) for part in ordered), start=sp.S.One)
    return values[str(side.func)](*side.args)


def variation_of_constants(p: Print) -> Told:
    """(22) for one state whose A varies, and for two states whose A at two times do not commute."""
    if not isinstance(p[0], sp.Eq):
        return False
    for k in "12":
        motion, rho, theta = (p[f"{name}{k}"] for name in ("A", "RHO", "THETA"))
        values = {"rho": sp.Lambda(t, rho), "theta": sp.Lambda(t, theta), "Phi": sp.Lambda((t, s), p[f"PHI{k}"])}
        left, right = (as_matrices(side, values) for side in p[0].args)
        gaps = (*(rho.diff(t) - motion * rho + theta), *(left - right))
        if not vanishes(*(sp.powsimp(sp.expand(gap)) for gap in gaps)):
            return False
    return True


def exchanged(p: Print) -> Told:
    """(23): the exchange of integrals for |B C rho|^2 = exp(-t) and two t0, and what its bounds drop."""
    definition, swap, bound, last = p
    Q1, t0, T, seen_ = (p[name] for name in ("Q1", "t0", "T", "seen"))
    kinds = [type(line) for line in p] == [sp.Eq, sp.Eq, sp.LessThan, sp.LessThan]
    if not kinds or any(line.lhs != Q1 for line in (definition, swap, bound)):
        return False
    for start in (0, 1):
        exact = math.exp(-start) * (1 - math.exp(-2))
        dropped = float(sp.integrate((2 - (tau - start)) * sp.exp(-tau), (tau, start, start + 2)))
        for side, less in ((definition.rhs, 0), (swap.rhs, 0), (bound.rhs, dropped), (last.lhs, dropped)):
            worth = _worth(side.replace(seen_, sp.Lambda(t, sp.exp(-t))).subs({t0: start, T: 2}))
            if not math.isclose(worth - exact, less, abs_tol=1e-12):
                return False
    # With (19) the last line is an equality for gamma1 = T |P(t0)| / 2.
    values = p.letters.values({"gamma1": T * p["norm(P0)"] / 2})
    total = {p[r"\int_{t0}^{\infty} seen(t) d t"]: p["norm(P0) norm(rho0)^2 / 2"]}
    return vanishes((last.rhs - last.lhs).xreplace(total).xreplace(values))


@cache
def _worth(side: sp.Expr) -> float:
    number = side.doit()
    return float(number) if number.is_number else math.nan


# Runs.
WINDOW = 8.0
PERIOD = 0.01
DURATION = 40.0
"""T of (14), between samples, and of an example, in seconds; |rho| is then below 1e-3 of its start."""

body, receding = cache(moving_body), cache(along_the_line_of_sight)
WEAKENING = Matrix(-sp.eye(2) / (2 * (1 + TIME)))
UNITS = np.diag([2.0, 1.0, 0.5])
OFF = (0.3, 0.0, 0.0)
"""rho at the start of the stretched example, along the largest eigenvector of P."""


@cache
def fading() -> PointsScenario:
    """A point that is kept at (2 sin t, 0, 2) while A = -I / (2 (1 + t)), and P = (1 + t) I meets (15)."""
    sideways = sp.Matrix([2 * sp.sin(TIME), 2])
    motion = linear(WEAKENING, sideways.diff(TIME) - WEAKENING * sideways)
    return PointsScenario("fading", PointsForm(motion, [[[1, 0], [0, 0], [0, 1]]]), (0.0, 2.0), DURATION)


@cache
def stretched() -> PointsScenario:
    """The body with x = U^-1 r and C = U: |r| is kept by the motion alone, so that P = U^2 meets (15) with equality."""
    scale, w, path = sp.diag(2, 1, sp.S.Half).inv(), -sp.Matrix(TURNING), sp.Matrix(PATH)
    motion = linear(scale * cross(w) * scale.inv(), scale * (path.diff(TIME) - w.cross(path)))
    start = (inv(UNITS) @ body(1).state).tolist()
    return PointsScenario("one point in other units", PointsForm(motion, UNITS), start, body(1).duration)


@cache
def followed(
    scenario: PointsScenario,
    P: LyapunovMatrix | None = None,
    off: tuple[float, ...] = (0.3, -0.2, 0.5, 0.2, -0.1, 0.3),
) -> Any:
    """An example from a start that is off by this; P is the identity when left out."""
    recording = record(scenario, DURATION, Camera(PERIOD))
    start = [x - e for x, e in zip(scenario.state, off, strict=False)]
    return track(recording, luenberger(scenario.form, P or constant()), start, hold="first")


@cache
def transition(A: Matrix) -> Array:
    """Phi(t, 0) at the samples, shape (K, n, n): states that nothing drives."""
    n, time = A.rows, np.arange(0, DURATION + PERIOD / 2, PERIOD)
    side_by_side = linear(sp.diag(*[A] * n), sp.zeros(n * n, 1))
    form = PointsForm(side_by_side, [np.kron(unit, np.eye(3)[:, -n:]) for unit in np.eye(n)])
    columns = PointsScenario("unit starts", form, np.eye(n).ravel().tolist(), DURATION).coordinates(time)
    return columns.reshape(-1, n, n).transpose(0, 2, 1)


def on_both_examples(p: Print) -> Told:
    """(13): the largest image coordinates of both examples."""
    images = [record(scenario, 20.0, Camera(PERIOD)).outputs for scenario in map(body, (1, 2))]
    largest = [norm(of_one, axis=-1).max() for of_one in images]
    return all(p.separates("norm(y)", size, math.inf, {}) for size in largest), largest


def exponential(p: Print) -> Told:
    """Theorem 3.4 (ii): both examples keep the bound with an alpha just below their rate, and need its beta."""
    numbers, holds = [], True
    for scenario in map(body, (1, 2)):
        run = followed(scenario)
        numbers += [gramian(run.recording, WINDOW).least, run.decay_rate(10, 40)]
        slow = 0.9 * numbers[-1]
        scaled = run.deviation * np.exp(slow * run.time) / run.deviation[0]
        largest = int(scaled.argmax())
        for k in (0, len(scaled) // 2, len(scaled) - 1, largest):
            here = named("t t0 alpha norm(rho) norm(rho0)", (run.time[k] + 3, 3, slow, *run.deviation[[k, 0]]))
            outside = 0.999 * scaled.max() if k == largest else 0
            holds = holds and p.separates("beta", 1.0001 * scaled.max(), outside, here)
    return holds, numbers


def backwards() -> float:
    """Norm of the fading point's Phi(0, t) at the end."""
    return float(norm(inv(transition(WEAKENING)[-1]), 2))


def not_exponential(p: Print) -> Told:
    """A = -I / (2 (1 + t)), P = (1 + t) I: all is met but the bound on Phi backwards, and the rate halves."""
    run = followed(fading(), scheduled(lambda t: 1 + t))
    least = gramian(followed(fading()).recording, WINDOW).least
    early, late = (run.decay_rate(k, 2 * k) for k in (10, 20))
    stable = norm(transition(WEAKENING), 2, axis=(1, 2)).max() <= 1 + 1e-9
    refuted = least > 0.5 and stable and run.conditions().printed_holds and 0.4 < late / early < 0.6
    return not refuted, (least, backwards(), early, late)


# The bounds of the proof.
@cache
def example() -> Any:
    """The run on the stretched example."""
    return followed(stretched(), constant(UNITS**2), OFF)


@cache
def totals() -> Mapping[str, float]:
    """The proof's integrals from 0 to 40 s."""
    run, Phi = example(), transition(stretched().form.motion.A)
    rows = stretched().form.rows(run.recording.outputs)
    samples, back = round(WINDOW / PERIOD), inv(Phi)
    seen = np.einsum("tij,tj->ti", rows, run.error)
    # theta = P^-1 C^T B^T B C rho
    theta = norm(np.einsum("tji,tj->ti", rows, seen) @ inv(UNITS**2), axis=1)
    so_far = cumulative_simpson(theta, dx=PERIOD, initial=0)
    parts = []
    for start in range(0, len(run.time) - samples, 10):
        part = slice(start, start + samples + 1)
        alone = np.einsum("tij,j->ti", Phi[part], back[start] @ run.error[start])
        moved, stays = (np.einsum("tij,tj->ti", rows[part], errors) for errors in (alone, run.error[part]))
        vectors = (moved, stays, moved - stays, 2 * stays - moved, alone - run.error[part])
        squares = [np.square(vector).sum(axis=1) for vector in vectors]
        parts.append([simpson(square, dx=PERIOD) for square in (*squares, (so_far[part] - so_far[start]) ** 2)])
    double = named("MOVED Q1 Q2 difference J1 J2", simpson(parts, dx=10 * PERIOD, axis=0))
    single = {"RHO": run.deviation, "SEEN": norm(seen, axis=1), "J3": theta}
    return double | {name: simpson(size**2, dx=PERIOD) for name, size in single.items()}


@cache
def constants() -> dict[str, sp.Float]:
    """The example's integrals and the constants of the bounds, by their letters."""
    recording, weights = example().recording, np.linalg.eigvalsh(UNITS**2)
    numbers: dict[str, Any] = {**totals(), "epsilon": gramian(recording, WINDOW).least, "T": WINDOW}
    numbers |= {"y_sup": norm(recording.outputs, axis=-1).max(), "C_norm": norm(UNITS, 2), "b": np.linalg.cond(UNITS)}
    numbers |= {"delta": weights[0], "norm(P0)": weights[-1], "gamma": totals()["RHO"] / OFF[0] ** 2}
    numbers |= {"norm(rho0)": OFF[0], "START": np.array(OFF) @ UNITS**2 @ np.array(OFF)}
    return {name: sp.Float(value) for name, value in numbers.items()}


def square_integrable(p: Print) -> Told:
    """The example meets (18) with a gamma than which none is less; where (14) fails none serves: the integral grows."""
    least = float(constants()["gamma"])
    edge = least * OFF[0] ** 2
    # For an error along a state that recedes along its ray, P = I, over |rho(t0)|^2.
    run = followed(receding(), None, (0.04, 0.02, 0.2))
    square = (run.deviation / run.deviation[0]) ** 2
    unseen = [simpson(square[run.time <= k], run.time[run.time <= k]) for k in (20, 40)]
    grows = unseen[1] > 1.9 * unseen[0] > 30
    return grows and p.separates("RHO", 0.999 * edge, 1.001 * edge, constants()), (least, *unseen)


def split_in_two(p: Print) -> Told:
    """The two steps to Q1 and Q2: (14), and |a + b|^2 = 2 |a|^2 + 2 |b|^2 - |a - b|^2, with the example's integrals."""
    values, epsilon = totals(), float(constants()["epsilon"])
    sides = [p.put(side, constants()) for line in p for side in line.args]
    if not all(side.is_number for side in sides) or not all(isinstance(line, sp.LessThan) for line in p):
        return False
    first, second = (total / epsilon for total in (values["MOVED"], values["MOVED"] + values["difference"]))
    expected = (values["RHO"], first, first, second)
    same = all(math.isclose(float(side), value, rel_tol=1e-6) for side, value in zip(sides, expected, strict=True))
    return same and values["RHO"] <= first <= second, (values["RHO"], first, second)


def chain(p: Print) -> Told:
    """Each step's bound is that by the example's matrices, and the example keeps it."""
    here = {name: float(value) for name, value in constants().items()}
    of_B, of_C = 1 + here["y_sup"], norm(UNITS, 2)
    held = simpson(np.linspace(0, WINDOW, 101) ** 2, dx=WINDOW / 100)  # the time for which theta counts, squared
    edges = {
        "Q2": (of_B * of_C) ** 2 * here["J1"],
        "J1": np.linalg.cond(UNITS) ** 2 * here["J2"],
        "J2": held * here["J3"],
        "J3": (norm(inv(UNITS**2), 2) * of_C * of_B) ** 2 * here["SEEN"],
        "SEEN": norm(UNITS**2, 2) * OFF[0] ** 2 / 2,
    }
    outcomes = [[line.lhs for line in p] == [p[name] for name in edges]]
    for line, (name, edge) in zip(p, edges.items(), strict=True):
        outcomes.append(here[name] <= edge * (1 + 1e-4))
        outcomes.append(Print((line,), p.letters).separates(name, 0.9999 * edge, 1.0001 * edge, constants()))
    return all(outcomes), [here[name] / edge for name, edge in edges.items()][:4]


def gamma2_of_the_example(p: Print) -> Told:
    """Gamma2 is what the steps of the chain make of Q2, over |rho(t0)|^2."""
    return True, [p.put(p[0].rhs, constants())]


def from_any_start(p: Print) -> Told:
    """The rate of Phi^T P Phi is Phi^T (A^T P + P A + P') Phi, so |P(t)| <= b^2 |P(t0)|; without b, it may grow."""
    A, P, R, F = (sp.Matrix(2, 2, sp.symbols(f"{name}1:5")) for name in "APRF")
    product = (A * F).T * P * F + F.T * P * (A * F) + F.T * R * F
    same = vanishes(*(product - F.T * (A.T * P + P * A + R) * F))
    grown = 1 + DURATION
    return same and math.isclose(grown, backwards() ** 2, rel_tol=1e-6), (grown, backwards() ** 2)


def integral_is_enough(p: Print) -> Told:
    """Decay of the rest of the integral: F' = -|rho|^2 <= -F / gamma, so F falls at least as exp(-t / gamma)."""
    run = example()
    square = run.deviation**2
    left = simpson(square, dx=PERIOD) - cumulative_simpson(square, dx=PERIOD, initial=0)
    begun = run.time <= 20
    serves = (left / square)[begun].max()
    bound = left[0] * np.exp(-run.time / serves)
    time, size, start = sp.symbols("time size start", positive=True)
    error = size * (1 + start) / (1 + time)
    power = [(sp.integrate(error**2, (time, start, sp.oo)) / size**2).subs(start, k) for k in (0, 100)]
    return (left[begun] <= bound[begun] * (1 + 1e-6)).all(), (serves, *power)


# What the assumptions say about observability.
def nothing_of_another(p: Print) -> Told:
    """Images that two states share: what B C makes of either is 0, so (14), of the difference, leaves none."""
    least = gramian(record(moving_body(1), 16.0), 8.0).least
    return vanishes(*seen_of_itself()) and least > 0.1, [least]


def without_input(p: Print) -> Told:
    """With v = 0 the state is Phi x(t0), of which B C makes 0: (14) fails for any number of points."""
    numbers = []
    for count in (1, 4):
        turns, _, spin = Manoeuvre().velocities
        scenario = replace(moving_body(count), form=rigid_body(count, turns, None, spin))
        recording = record(scenario, 8.0)
        sizes = norm(scenario.coordinates(recording.time), axis=-1)
        numbers += [gramian(recording, 8.0).least, sizes.max() / sizes[0]]
    return vanishes(*seen_of_itself()) and max(map(abs, numbers[::2])) < 1e-9, numbers


def not_enough(p: Print) -> Told:
    """A point that recedes along its line of sight, A = 0: the smallest eigenvalues of both Gramians over 1 s."""
    recording = record(along_the_line_of_sight(), 2.0)
    of_points, of_images = linear_gramian(recording, 1.0).least, gramian(recording, 1.0).least
    return of_points > 0.9 and abs(of_images) < 1e-9, (of_points, of_images)
