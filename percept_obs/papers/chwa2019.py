"""Chwa 2019: what its equations and statements are compared with."""

import math
from collections.abc import Iterable
from functools import cache
from itertools import combinations, permutations
from typing import Any

import numpy as np
import sympy as sp
from scipy.integrate import simpson

from percept_obs.checking import Target
from percept_obs.checking.lines import EQUATION, Line
from percept_obs.compile import vectorised
from percept_obs.observers import Observer, ismo
from percept_obs.observers.integral_sliding_mode import a, b, gamma, k1, k2
from percept_obs.papers import CHWA2019
from percept_obs.papers.base import Matrix, Values, column, exactly, is_identity, named, paired, real, vanishes
from percept_obs.papers.entries import DEPENDS, NOT_CHECKABLE, Told
from percept_obs.papers.letters import Print
from percept_obs.recording import record
from percept_obs.structure import COROLLARIES, Corollary, ScaledDepthCamera, StructureScenario, scaled_dynamics
from percept_obs.structure.dynamics import OUTPUTS, d_s
from percept_obs.structure.pixels import CHWA_CAMERA, SignalToNoise
from percept_obs.structure.scenarios import chwa2019_experiment, chwa2019_simulation
from percept_obs.system.forms import CanonicalForm
from percept_obs.system.motion import rigid
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import pinhole
from percept_obs.system.surfaces.base import POINT, Z
from percept_obs.tracking import Run, track

MOTION = rigid().parameters
ROTATION, CAMERA, OBJECT = MOTION[:3], MOTION[3:6], MOTION[6:]
ORDERS = tuple(map("".join, permutations("123")))
TURNING = real("w1:4")
"""The paper's w, minus the package's w_c."""
MINUS = {w_c: -w for w_c, w in zip(ROTATION, TURNING, strict=True)}
SYSTEM = PerspectiveSystem(rigid(chwa_rotation=TURNING, camera_velocity=CAMERA, point_velocity=OBJECT), pinhole())
y1, y2, ybar3 = OUTPUTS
t = real("t")


def letters(name: str) -> Matrix:
    """A column of three letters, such as a1, a2, a3."""
    return column(*real(f"{name}1:4"))


# Section II: relative motion.
def in_motion() -> Values:
    """Values of a point, its pixel and its motion in the camera's frame."""
    camera = Matrix(3, 3, lambda i, j: real(f"A_c{i + 1}{j + 1}") if i < 2 else int(j == 2))
    motion, point = SYSTEM.motion, column(*POINT)
    pixel = camera * point / (camera * point)[2]
    values = {"p": pixel.applyfunc(sp.cancel), "A_c": camera, "m": column(*SYSTEM.surface.image, 1), "mbar": point}
    values |= {"mbar'": motion.A * point + motion.b, "w_cross": motion.A, "w": column(*TURNING), "v_r": motion.b}
    return values | {"v_c": column(*CAMERA), "v_p": column(*OBJECT)}


@cache
def from_the_pose() -> Values:
    """Values for a camera with axes Q and centre in F*, and the point x_O; to first order in t, from any attitude."""

    def cross(vector: Matrix) -> Matrix:
        return SYSTEM.motion.A.xreplace(paired(TURNING, vector))

    rate, start = letters("a"), cross(letters("k"))
    attitude = (sp.eye(3) - start).inv() * (sp.eye(3) + start)  # any rotation but half turns
    R = (sp.eye(3) + t * cross(rate)) * attitude
    offset, place = letters("f") + t * letters("df"), letters("q") + t * letters("dq")
    Q, centre = R.T, -R.T * offset
    seen = Q.T * (place - centre)
    turning = (Q.T * Q.diff(t)).subs(t, 0)
    values = {"mbar": seen, "mbar'": seen.diff(t), "R": R, "x_f": offset, "x_O": place, "w": rate}
    values |= {"w_cross": cross(rate), "w_camera": column(turning[2, 1], turning[0, 2], turning[1, 0])}
    values |= {name: Q.T * path.diff(t) for name, path in (("v_c", centre), ("v_p", place), ("v_r", place - centre))}
    return {name: Matrix(value.subs(t, 0)) for name, value in values.items()}


def from_a_patch() -> Values:
    """From a plane's homography R + t n^T / d, with d_s one over the depth at the start."""
    turn, shift, normal = Matrix(3, 3, real("r1:10")), letters("s"), letters("n")
    point = column(*POINT)
    homography = turn + shift * normal.T / (normal.T * point)[0]
    return {"y3": 1 / (turn * point + shift)[2], "d_s": 1 / Z, "ybar3": 1 / (homography * (point / Z))[2]}


def in_the_image(*rate: str) -> Values:
    """Coordinates of a point's image, or their rate."""
    return {"y'": SYSTEM.rate} if rate else {"y": column(*SYSTEM.surface.image, 1 / SYSTEM.surface.distance)}


def all_have_full_rank(p: Print) -> Told:
    """Ranks of the three matrices at a point."""
    dynamics = scaled_dynamics()
    here = paired(OUTPUTS, (sp.Rational(2, 5), sp.Rational(1, 3), sp.Rational(1, 7)))
    ranks = [int(part.subs(here).rank()) for part in (dynamics.camera, dynamics.rotation, dynamics.object)]
    lost = (dynamics.rotation * column(y1, y2, 1)).expand().is_zero_matrix
    return min(ranks) == 3 or not lost, ranks


def bounded_by_velocities(p: Print) -> Told:
    """A static point 5 m ahead, towards which the camera moves at 1 m/s: |g| of corollary 1 with d_s = 4."""
    choice = COROLLARIES[0].choice()
    static = paired((*CAMERA, y1, y2, d_s), (0, 0, 1, 0, 0, 4))
    g_now = (choice.form.w.T * column(*choice.theta)).subs(static).subs(ybar3, 1 / (4 * (5 - t)))
    size = max(abs(entry) for entry in g_now if entry)
    sizes = [size.subs(t, sp.Rational(time)) for time in ("0", "4.5", "4.9", "4.99")]
    return all(p.put(p[0], {"g_norm": value, "gamma": 15}) == sp.true for value in sizes), sizes


# Section III: the observer, of one entry, for the paper's functions act on each.
@cache
def observer() -> Observer:
    """The package's observer of one measured entry whose rate is Omega + g."""
    ybar, g, Omega = real("ybar g Omega")
    form = CanonicalForm((ybar,), (g,), (Omega,), (ybar, g), w=column(1), phi=column(Omega), g=column(0))
    return ismo(form, "sign")


GAINS = exactly(observer().gain_values)
CASE_G = 0.05 * 10.4 * 0.23
"""The largest entry of g in the experiment's first case, in 1/s."""
e_s, e_sI, s_e, s, v, g, s_e0 = real("e_s e_sI s_e s v g s_e0")


@cache
def equations() -> Values:
    """Values of the observer's letters; e_s, e_sI and v stay as they are."""
    made, (ybar, Omega) = observer(), real("ybar Omega")
    kept = paired(made.equations.state, (ybar - e_s, e_sI, a + b * t, v))
    estimate, integral, _, pseudo = (entry.xreplace(kept) for entry in made.equations.flow)
    (switched,) = (node.args[0] for node in pseudo.atoms(sp.sign))
    values = {"yhat": ybar - e_s, "yhat'": estimate, "ghat": estimate - Omega, "e_sI'": integral}
    return values | {"s_e": sp.expand(estimate - Omega).coeff(k1), "v'": pseudo, "u": pseudo, "s": switched}


@cache
def error_dynamics() -> Values:
    """Rates of s_e, s and of the energies under the observer."""
    values = equations()
    sliding = values["s"].xreplace({e_sI: s_e - e_s})
    terms = {e_sI: s_e - e_s, v: s - (sliding - v)}
    estimate, u, integral = (values[name].xreplace(terms) for name in ("ghat", "u", "e_sI'"))
    rate = g - estimate + integral
    s_rate = u + sliding.diff(s_e) * rate + sliding.diff(t)
    found = {"ghat": estimate, "u": u, "s_e'": rate, "s'": s_rate}
    return found | {"Vdot1": s_e * rate, "Vdot2": s * s_rate, "Vdot": s_e * rate + s * s_rate}


def starts() -> Values:
    """The package's start, which makes s_e zero, and the v that makes s zero whatever s_e(0) is."""
    made, values = observer(), equations()
    estimate, integral, slope, pseudo = made.equations.state
    start = paired(made.equations.state, made.start)
    if (start[slope], start[pseudo]) != (a, 0):
        return {}
    v0 = (v - values["s"]).subs({t: 0, e_sI: s_e0 - e_s})
    return {"e_s0": real("ybar") - estimate, "e_sI0": start[integral], "v0": v0}


def rest(time: float) -> float:
    """Where s_e comes to rest while s = 0, for a g that stays and the listed gains."""
    return float(sp.nsolve(error_dynamics()["s_e'"].subs(GAINS | {s: 0, t: time, g: CASE_G}), s_e, 0))


def rate_at_zero(p: Print) -> Told:
    """Rate of s_e where s_e = s = 0: it is g, so that s_e leaves zero at once."""
    rate = error_dynamics()["s_e'"].subs({s_e: 0, s: 0})
    return vanishes(rate), (rate.subs(g, CASE_G), rest(10))


def attracts(p: Print) -> Told:
    """Rate of |s| next to s = 0, where |g| <= gamma and |s_e| < gamma / k1 = k2; s_e never leaves that."""
    rate, of_se = error_dynamics()["s'"], error_dynamics()["s_e'"]
    beside = [(sign * rate).subs(sp.sign(s), sign).subs(GAINS | {s: 0}) for sign in (1, -1)]
    edge = [(sign * of_se).subs(GAINS | {s: 0, s_e: sign}) for sign in (1, -1)]
    grid = np.meshgrid(np.linspace(-0.999, 0.999, 41), np.linspace(-15, 15, 41), (0.0, 1.0, 10.0, 100.0))
    largest, outwards = (max(map(np.max, vectorised((s_e, g, t), found)(*grid))) for found in (beside, edge))
    return largest < 0 and outwards <= 0, [largest]


def stays_outside(p: Print) -> Told:
    """Where s_e comes to rest and the printed bound, for a g that stays: inside, at all times."""
    bound, condition = p
    pairs = [(rest(time), p.put(bound.rhs, {**GAINS, "t": time, "alpha": CASE_G / 15})) for time in (1, 10, 100)]
    outside = (condition.subs(paired((s_e, p["esbar"]), pair)) == sp.true for pair in pairs)
    return all(outside), np.ravel(pairs)


def decreases_outside(p: Print) -> Told:
    """(21): the bound is where the last term of (20) changes its sign."""
    bound, decrease = p
    turning = sp.tanh(p["SLOPE"] * bound.rhs).rewrite(sp.exp)
    at_the_bound = vanishes(sp.powsimp(sp.cancel(turning)) - p["alpha"])
    energy = {p["Vdot"]: CHWA2019[20].printed[0].rhs}
    more = is_identity(decrease, energy, p["gamma abs(s_e) (tanh(SLOPE abs(s_e)) - alpha)"])
    return at_the_bound and more and bound.lhs == p["esbar"]


def rests_at_what(p: Print) -> Told:
    """Where s_e comes to rest for a g that stays: it falls as 1 / (a + b t), so its square has an integral."""
    scaled = [rest(time) * (1 + 0.1 * time) for time in (10, 100, 1000)]
    return scaled[2] < 1.1 * scaled[1] and scaled[2] < 1, scaled


def beyond_in_each_entry(p: Print) -> Told:
    """(21) for three entries and g = gamma / 2: all beyond the bound, where it holds; one only, where it need not."""
    at = GAINS | {t: 0, s: 0, g: GAINS[gamma] / 2}
    edge, rate, excess = sp.atanh(sp.Rational(1, 2)), error_dynamics()["Vdot"].subs(at), []
    for entries in ((1, 2, 3), (1, sp.S.Half, sp.S.Half)):
        bound = sum(-GAINS[k1] * (entry * edge) ** 2 for entry in entries)
        excess.append(sp.N(sum(rate.subs(s_e, entry * edge) for entry in entries) - bound))
    return excess[0] <= 1e-9 and excess[1] > 0, excess


def gains() -> Values:
    """The package's gains."""
    return dict(GAINS)


def gains_of(p: Print) -> Told:
    """Number of the five gains that stand in the printed (8) to (14)."""
    lines = (CHWA2019[k].printed for k in range(8, 15))
    counts = [len({k1, k2, gamma, a, b} & {s for line in each for s in line.free_symbols}) for each in lines]
    return counts[12 - 8] == 5, counts


# Sections IV to VI: the corollaries.
@cache
def case(number: str, left_out: str = "") -> list[Values]:
    """Values of a corollary's letters; the estimate of g has its own, and the package finds all others from it."""
    cases = [_case(corollary(number), axes) for axes in ORDERS]
    return [{letter: value for letter, value in values.items() if letter != left_out} for values in cases]


def _case(corollary: Corollary, axes: str) -> Values:
    choice, dynamics = corollary.choice(axes), scaled_dynamics()
    form, order, turned = choice.form, [int(axis) - 1 for axis in axes], str.maketrans("ijk", axes)
    unknown = [name if name == d_s.name else name.translate(turned) for name in corollary.unknown]
    absent = {symbol: sp.S.Zero for symbol in MOTION if symbol.name in choice.zero}
    ghat, dhat_s = letters("ghat"), real("dhat_s")
    theta = form.w.T.adjugate() * ghat / choice.determinant
    scale = theta[0] if d_s.name in choice.unknown else dhat_s if d_s.name in choice.earlier else sp.S.One
    found = {name: theta[k] / scale for k, name in enumerate(choice.unknown) if name != d_s.name}
    values = {"ybar'": dynamics.rate.xreplace(absent | MINUS), "Omega": form.phi.xreplace(MINUS), "ghat": ghat}
    values |= {"g": form.w.T * column(*choice.theta), "dhat_s": scale, "yhat3": scale * ybar3, "w": column(*TURNING)}
    values |= {"Omega_g": Matrix.hstack(*(form.w.T[:, choice.unknown.index(name)] for name in unknown))}
    values |= {"Omega2": -dynamics.rotation * column(*TURNING), "e_i": sp.eye(3)[:, order[0]].as_immutable()}
    for letter, omega, part, block in (("c", 1, CAMERA, dynamics.camera), ("p", 3, OBJECT, dynamics.object)):
        estimates = {symbol: found[symbol.name] for symbol in part if symbol.name in found}
        values |= {f"Omega{omega}": block, f"v_{letter}": column(*part).xreplace(absent)}
        values |= {f"vhat_{letter}": column(*part).xreplace(estimates | absent)} if estimates else {}
        for k, axis in zip(order, "ijk", strict=True):
            values |= {f"v_{letter}{axis}": values[f"v_{letter}"][k], f"Omega{omega}{axis}": block[:, k].as_immutable()}
            values |= {f"vhat_{letter}{axis}": estimates[part[k]]} if part[k] in estimates else {}
    # What is perpendicular to the object's line.
    return values | named(("first_unknown", "second_unknown"), (CAMERA[k] for k in order[1:]))


def corollary(number: str) -> Corollary:
    """The corollary of this number."""
    return COROLLARIES[int(number) - 1]


def powers_of_ybar3(determinants: Iterable[sp.Expr]) -> Told:
    """Return True if each determinant is ybar3^4 but for its sign, and how many there are."""
    outcomes = [sp.cancel(determinant / ybar3**4) in (1, -1) for determinant in determinants]
    return all(outcomes), {"orders of the axes": len(outcomes)}


def nonsingular(p: Print, number: str, *needed: str) -> Told:
    """The corollary's determinant, for any order of the axes: a power of ybar3 and d_s times the named velocity."""
    found = []
    for axes, choice in ((axes, corollary(number).choice(axes)) for axes in ORDERS):
        velocities = (real(name.translate(str.maketrans("ijk", axes))) for name in needed)
        scale = sp.S.One if d_s.name in (*choice.unknown, *choice.earlier) else d_s**3
        found.append(choice.determinant / sp.Mul(scale, *velocities))
    return powers_of_ybar3(found)


def of_columns(*names: str, axes: str = "123") -> sp.Expr:
    """Determinant of some columns of Omega1 ("1i") and Omega3 ("3k")."""
    matrices = {"1": scaled_dynamics().camera, "3": scaled_dynamics().object}
    return sp.Matrix.hstack(*(matrices[name[0]][:, int(axes["ijk".index(name[1])]) - 1] for name in names)).det()


def independent(p: Print, *names: str) -> Told:
    """Determinant of the named columns of Omega1 and Omega3, up to a sign a power of ybar3, for any order."""
    return powers_of_ybar3(of_columns(*names, axes=axes) for axes in ORDERS)


def determinants(*columns: str) -> Target:
    """Target of determinants, each up to a number: of the corollaries, of Omega1 and Omega3, or of some columns."""
    dynamics = scaled_dynamics()
    found = {f"det{c.number}": c.choice().determinant for c in COROLLARIES}
    if columns == ("Omega1", "Omega3"):
        found = {"det1": dynamics.camera.det(), "det3": dynamics.object.det()}
    elif columns:
        found = {"det": of_columns(*columns)}
    return Target(tuple(Line(name, value, EQUATION) for name, value in found.items()))


def cells(p: Print) -> Told:
    """Table 1: what of v_p is free in each case, and which determinants vanish where the camera stands still."""
    still = dict.fromkeys(CAMERA, sp.S.Zero)
    free = {c.section: 3 - len(c.zero) for c in COROLLARIES}
    lost = {c.section for c in COROLLARIES if vanishes(c.choice().determinant.xreplace(still))}
    # semigeneral: still first, then general; dynamic: the camera moves, but where d_s is known already
    semigeneral = free["IV.A"] == 0 and free["IV.B"] == 3
    general = all(free[section] > 0 for section in free if not section.startswith("IV"))
    return semigeneral and general and lost == {"IV.A", "V.A", "V.B"}, list(free.values())


def one_more_dimension(p: Print) -> Told:
    """Remark 2: unknown components of v_p for as many unknown ones of v_c, with an unknown range and a known one."""
    unknown = [corollary(number).unknown for number in "3546"]  # with an unknown range and a known one, twice
    camera, object_ = ([sum(name.startswith(letter) for name in each) for each in unknown] for letter in ("v_c", "v_p"))
    more = [object_[k + 1] - object_[k] for k in (0, 2)]
    return camera[::2] == camera[1::2] and more == [1, 1], object_


def known_range(p: Print) -> Told:
    """Number of the cases with a known range that estimate d_s."""
    inside = [d_s.name in c.unknown for c in COROLLARIES if c.section.startswith("VI.")]
    return all(inside), (len(inside), sum(inside))


def does_not_turn() -> Values:
    """What the camera's turning adds where it does not turn."""
    return {"Omega2": scaled_dynamics().rotation * sp.zeros(3, 1)}


def three_of_seven(p: Print) -> Told:
    """Ranks of the rate's slope in each three of d_s, v_c and v_p, the others known, at a point of no special kind."""
    rate, unknown = scaled_dynamics().rate, (d_s, *CAMERA, *OBJECT)
    here = {x: sp.Rational(sp.prime(k + 4), 7 + k) for k, x in enumerate(sorted(rate.free_symbols, key=str))}
    slope = rate.jacobian(unknown).subs(here)
    lost = [three for three in combinations(range(7), 3) if slope[:, list(three)].rank() < 3]
    of_one_axis = (0, 1, 4) in lost
    return not of_one_axis, (35, len(lost), 2 if of_one_axis else 3)


# Section VII: runs.
def scaled_start(p: Print) -> Told:
    """ybar(0) follows from y(0) and d_s as (6) has it."""
    given = dict.fromkeys(("y_01", "y_02", "y_03", "d_s"), sp.nan) | p.given
    scaled = [given["y_01"], given["y_02"], given["y_03"] / given["d_s"]]
    return scaled == [given.get(f"ybar_0{k}") for k in (1, 2, 3)]


def begun(place: str) -> dict[str, sp.Expr]:
    """What is printed of a start, by its letters."""
    return CHWA2019[place].printed.given


def start_of_ghat(p: Print) -> Told:
    """ghat(0) is no free choice: (11) with s_e(0) = v(0) = 0 gives gamma tanh(a e_s(0)), here for the simulation."""
    form, given = COROLLARIES[0].choice().form, begun("start of the simulation") | p.given
    made = ismo(form, "sign")
    state = made.equations.state
    scaled, estimate, found = ([given[f"{name}_0{k}"] for k in (1, 2, 3)] for name in ("ybar", "yhat", "ghat"))
    here = paired((*form.x1, *state[:3]), (*scaled, *estimate))
    start = paired(state, (entry.subs(here) for entry in made.start))
    true = (column(*made.equations.flow[:3]) - form.phi).subs(start).subs(here | made.gain_values)
    return list(true) == found, true


def in_metres(p: Print) -> Told:
    """Powers of the unit of length in the coordinates of a point."""
    unit = sp.Symbol("unit", positive=True)
    larger = {x: unit * x for x in POINT}
    coordinates = (*pinhole().image, 1 / pinhole().distance)
    powers = [sp.degree(sp.expand(sp.cancel(unit**2 * e.xreplace(larger) / e)), unit) - 2 for e in coordinates]
    return set(powers) == {1}, powers


def kept_velocity(p: Print) -> Told:
    """Section IV takes v_c of the second step from the first one; the experiment's differ."""
    change = p.given["v_c^IV.B"] - p.given["v_c^IV.A"]
    return change.is_zero_matrix, (p.given["v_p^IV.B"] - change)[:2]


def needs_forward_motion(p: Print) -> Told:
    """Determinants of the two cases that are left out, with v_c3 = 0: only the first one vanishes."""
    given = begun("start of the experiment")
    here = {ybar3: given["ybar_03"], d_s: given["d_s"], CAMERA[2]: 0}
    values = [COROLLARIES[number - 1].choice().determinant.subs(here) for number in (3, 5)]
    return values == [0, 0], values


SECTIONS = ("IV.A", "IV.B", "V.B", "VI.B", "VI.C")
"""The experiment's cases."""


@cache
def velocities() -> Values:
    """Velocities of camera and object in each case of the experiment."""
    values: Values = {}
    for section in SECTIONS:
        motion, name = exactly(chwa2019_experiment(section).motion.values), section.replace(".", "")
        values |= {f"v_c{name}": column(*CAMERA).xreplace(motion), f"v_p{name}": column(*OBJECT).xreplace(motion)}
    return values


@cache
def followed(
    case: str, duration: float, period: float = 1e-3, decibels: float = 0, start: tuple[float, ...] = (0, 0, 0)
) -> tuple[StructureScenario, Run]:
    """A case of the experiment, or the simulation's where the object wanders, and the observer on it; s = 0."""
    setup = chwa2019_simulation("IV.B") if case == "varying" else chwa2019_experiment(case)
    ratio = SignalToNoise(decibels) if decibels else None
    recording = record(setup, duration, ScaledDepthCamera(period, pixels=CHWA_CAMERA, ratio=ratio))
    observer = ismo(setup.choice.form, "ideal")
    run = track(recording, observer, [*start, 0, 0, 0], hold="zero" if decibels else "exact", step=period)
    return setup, run


def pixels(image: Any) -> Any:
    """Pixels of image coordinates (y1, y2), by the printed camera."""
    camera = np.array(CHWA2019["A_c"].printed[0].rhs, dtype=float)
    return image[..., :2] @ camera[:2, :2].T + camera[:2, 2]


def sees_its_point(p: Print) -> Told:
    """The pixel of the simulation's point at the start."""
    given = begun("start of the simulation")
    return NOT_CHECKABLE, pixels(np.array([given["y_01"], given["y_02"]], dtype=float))


def sees_the_experiment(p: Print) -> Told:
    """When each of the experiment's points leaves the image of the only camera that is printed."""
    times, leaves = np.arange(0, 2, 0.001), []
    for section in SECTIONS:
        outside = (pixels(chwa2019_experiment(section).coordinates(times)) >= (640, 480)).any(axis=1)
        leaves.append(times[outside][0] if outside.any() else math.inf)
    return NOT_CHECKABLE, leaves


def robust_at(p: Print) -> Told:
    """Noise of the printed ratio in pixels, and the spread of d_s from 9 to 10 s in IV.A with it and with more."""
    numbers = []
    clean = pixels(chwa2019_experiment("IV.A").coordinates(np.arange(0, 10, 0.01)))
    for decibels in (100, 60):
        _, run = followed("IV.A", 10.0, decibels=decibels)
        numbers += [SignalToNoise(decibels).sigma(clean), run.estimate[run.time > 9, 3].std()]
    return numbers[1] < 0.02 * 10.4, numbers


def found_and_true(case: str, since: float, *until: float) -> Any:
    """Quantities of a case from a time on, as they are found and as they are."""
    setup, run = followed(case, *until)
    return (setup.choice.quantities(x[run.time >= since][:, 3:]) for x in (run.estimate, run.truth))


def found_in_time(p: Print) -> Told:
    """The five cases: the worst error of d_s at 1 s and of a velocity at 1.5 s, with s = 0."""
    scale, speed = [0.0], [0.0]
    for section in SECTIONS:
        found, true = found_and_true(section, 1, 2.0)
        scale += [(np.abs(found[name] - true[name]) / true[name]).max() for name in found if name == d_s.name]
        found, true = found_and_true(section, 1.5, 2.0)
        speed += [np.abs(found[name] - true[name]).max() for name in found if name != d_s.name]
    return max(scale) < 0.005 and max(speed) < 0.01, (max(scale), max(speed))


def may_vary(p: Print) -> Told:
    """Worst error of the object's velocity from 2 s on, over its largest speed, constant or varying."""
    worst = []
    for case, *until in (("IV.B", 10.0, 0.005), ("varying", 30.0, 0.01)):
        found, true = found_and_true(case, 2, *until)
        error = max(np.abs(found[name] - true[name]).max() for name in found)
        worst.append(error / max(np.abs(values).max() for values in true.values()))
    steps = [c.section for c in COROLLARIES if c.earlier]
    return max(worst) < 0.01 and steps == ["IV.B"] and DEPENDS, (*worst, len(steps))


def tends_to_g(p: Print) -> Told:
    """Theorem 1 (iv): the largest error of ghat in IV.A, and where the object wanders, in windows that follow."""
    numbers = []
    for case, until, starts, length in (
        ("IV.A", (25.0, 0.005), (1, 5, 20), 4),
        ("varying", (30.0, 0.01), (1, 8, 22), 7),
    ):
        _, run = followed(case, *until)
        form = run.observer.form.canonical_form()
        entries = vectorised(form.x1, list(form.w.T), run.recording.motion.values)(*run.truth[:, :3].T)
        # what the unknowns' errors make of ghat's
        error = np.abs(np.einsum("ijt,tj->ti", np.reshape(entries, (3, 3, -1)), run.error[:, 3:]))
        numbers += [error[(run.time >= k) & (run.time < k + length)].max() for k in starts]
    first, second, still, early, later, moving = numbers
    return first > second > still and early > later > moving and still < 1e-4 and moving < 0.3 * early, numbers


def from_any_place(p: Print) -> Told:
    """When d_s has entered 1 % for good in IV.A, for several yhat(0), and its error at the end; s = 0."""
    times, ends = [], []
    for start in ((0.32, 0.3, 0.05), (0.0, 0.0, 0.0), (3.0, 3.0, 3.0)):
        _, run = followed("IV.A", 1.5, start=start)
        off = np.abs(run.estimate[:, 3] / run.truth[:, 3] - 1)
        times.append(run.time[~(off <= 0.01)][-1])
        ends.append(off[-1])
    return times[2] > 2 * times[0] > 0 and max(ends) < 1e-3 and DEPENDS, (*times, max(ends))


def errors_vanish(p: Print) -> Told:
    """Theorem 1 (iii) in IV.A: the largest e_s and rate of e_s in 4 s from 1, 5 and 20 s on; s is 0 there."""
    _, run = followed("IV.A", 25.0, 0.005)
    windows = [(run.time >= since) & (run.time < since + 4) for since in (1, 5, 20)]
    errors = [run.recording.outputs[part] - run.state[part, :3] for part in windows]
    sizes = [np.abs(error).max() for error in errors]
    rates = [np.abs(np.gradient(error, 0.005, axis=0)).max() for error in errors]
    falls = all(first > second > third for first, second, third in (sizes, rates))
    return falls and sizes[2] < 0.3 * sizes[0], (*sizes, *rates)


def square_integrable(p: Print) -> Told:
    """Theorem 1 (ii) in IV.A: the largest e_s, and the integral of its square up to 5, 10, 20 s, which levels off."""
    _, run = followed("IV.A", 25.0, 0.005)
    square = np.square(run.recording.outputs - run.state[:, :3]).sum(axis=1)
    gathered = [simpson(square[run.time <= k], dx=0.005) for k in (5, 10, 20)]
    return gathered[2] - gathered[1] < 0.1 * gathered[0], (square.max() ** 0.5, *gathered)


def chatters(p: Print) -> Told:
    """Spread of d_s from 1 to 2 s in IV.A, by explicit Euler with 1 ms: with the second surface, and with one only."""
    setup, run = followed("IV.A", 2.0)
    form, spreads = setup.choice.form, []
    made = ismo(form, "sign")
    state, images = made.equations.state, run.truth[:, :3]
    surfaces = (x - state[k] + state[3 + k] for k, x in enumerate(form.x1))
    single = {v: -gamma * sp.sign(surface) for v, surface in zip(state[7:], surfaces, strict=True)}  # without s
    start = paired((*form.x1, *state[:3]), (*images[0], 0, 0, 0))
    for change in (single, {}):
        flow = [entry.xreplace(change) for entry in (*made.equations.flow, made.estimate[3])]
        rate = vectorised((*form.x1, *state), flow, {**made.gain_values, **setup.motion.values})
        begins = (sp.sympify(entry).subs(start).subs(made.gain_values) for entry in (0, 0, 0, *made.start[3:]))
        now, found = np.array(list(map(float, begins))), []
        for image in images:
            *rates, scale = rate(*image, *now)
            now = now + 1e-3 * np.array(rates, dtype=float)
            found.append(float(scale))
        spreads.append(np.std(np.array(found)[run.time >= 1]))
    return spreads[1] < spreads[0] / 50, spreads
