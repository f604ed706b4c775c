"""Chwa 2019, sections IV to VI: the seven corollaries, each for any order of the axes."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, partial
from itertools import permutations

import sympy as sp

from percept_obs.checking import Target
from percept_obs.checking.lines import EQUATION, Line
from percept_obs.papers.base import column, equal, identities, is_identity, reader, vanishes, vectors
from percept_obs.papers.entries import Check, Entry, Finding, Printed, Values, Verdict, at, judged
from percept_obs.structure import COROLLARIES, Corollary, scaled_dynamics
from percept_obs.structure.dynamics import OUTPUTS, d_s
from percept_obs.system.motion import rigid

ORDERS = tuple(map("".join, permutations("123")))
_, _, ybar3 = OUTPUTS
MOTION = rigid().parameters
TURNING, CAMERA, OBJECT = MOTION[:3], MOTION[3:6], MOTION[6:]

# Numbers
v_ci, v_cj, v_ck, v_pi, v_pj, v_pk = sp.symbols("v_ci v_cj v_ck v_pi v_pj v_pk", real=True)
vhat_ci, vhat_cj, vhat_ck, vhat_pi, vhat_pj, vhat_pk = sp.symbols(
    "vhat_ci vhat_cj vhat_ck vhat_pi vhat_pj vhat_pk", real=True
)
dhat_s, yhat3 = sp.symbols("dhat_s yhat3", real=True)
first_unknown, second_unknown = sp.symbols("first_unknown second_unknown", real=True)

# Vectors and matrices
THREE = sp.Integer(3)
Omega, Omega2, g, ghat, v_c, v_p, vhat_c, vhat_p, e_i = vectors("Omega Omega2 g ghat v_c v_p vhat_c vhat_p e_i", THREE)
Omega1i, Omega1j, Omega1k, Omega3i, Omega3j, Omega3k = vectors("Omega1i Omega1j Omega1k Omega3i Omega3j Omega3k", THREE)
Omega1, Omega3, Omega_g = (sp.MatrixSymbol(name, 3, 3) for name in ("Omega1", "Omega3", "Omega_g"))


def side_by_side(*columns: sp.MatrixExpr) -> sp.BlockMatrix:
    """Columns as a matrix."""
    return sp.BlockMatrix([list(columns)])


@cache
def case(number: int, axes: str) -> Values:
    """Values of a corollary's letters, with the axes i, j, k in the given order.

    The estimate of g has letters of its own, and what is estimated from it comes from the package.
    """
    corollary = COROLLARIES[number - 1]
    choice = corollary.choice(axes)
    form, dynamics = choice.form, scaled_dynamics()
    order = [int(axis) - 1 for axis in axes]
    absent = {symbol: sp.S.Zero for symbol in MOTION if symbol.name in choice.zero}
    given = column(*sp.symbols("ghat1:4", real=True))
    theta = form.w.T.adjugate() * given / choice.determinant
    scale = theta[0] if d_s.name in choice.unknown else dhat_s if d_s.name in choice.earlier else sp.S.One
    found = {name: theta[k] / scale for k, name in enumerate(choice.unknown) if name != d_s.name}
    values: Values = {
        Omega: form.phi,
        g: form.w.T * column(*choice.theta),
        ghat: given,
        Omega_g: sp.ImmutableMatrix.hstack(*(form.w.T[:, choice.unknown.index(n)] for n in in_print(corollary, axes))),
        Omega1: dynamics.camera,
        Omega2: dynamics.rotation * column(*TURNING),
        Omega3: dynamics.object,
        e_i: sp.eye(3)[:, order[0]].as_immutable(),
        dhat_s: scale,
        yhat3: scale * ybar3,
    }
    for vector, estimate, part, letters in (
        (v_c, vhat_c, CAMERA, ((v_ci, vhat_ci), (v_cj, vhat_cj), (v_ck, vhat_ck))),
        (v_p, vhat_p, OBJECT, ((v_pi, vhat_pi), (v_pj, vhat_pj), (v_pk, vhat_pk))),
    ):
        values[vector] = column(*part).xreplace(absent)
        estimates = {symbol: found[symbol.name] for symbol in part if symbol.name in found}
        if estimates:
            values[estimate] = column(*part).xreplace(estimates | absent)
        for k, (component, hat) in zip(order, letters, strict=True):
            values[component] = values[vector][k]
            if part[k] in estimates:
                values[hat] = estimates[part[k]]
    for matrix, columns in (
        (dynamics.camera, (Omega1i, Omega1j, Omega1k)),
        (dynamics.object, (Omega3i, Omega3j, Omega3k)),
    ):
        values |= {letter: matrix[:, k].as_immutable() for letter, k in zip(columns, order, strict=True)}
    # What is perpendicular to the object's line.
    return values | dict(zip((first_unknown, second_unknown), (CAMERA[k] for k in order[1:]), strict=True))


def in_print(corollary: Corollary, axes: str) -> list[str]:
    """Names of the unknowns in the paper's order."""
    turned = str.maketrans("ijk", axes)
    return [name if name == d_s.name else name.translate(turned) for name in corollary.unknown]


def holds_in(number: int) -> Check:
    """A check that holds when every printed equation is an identity in a corollary, for any order of the axes."""
    return identities(*(partial(case, number, axes) for axes in ORDERS))


def scale_from_what_is_known(printed: Printed) -> Finding:
    """(23), where the camera's velocity is to stand for its known component only, not for its estimate."""
    without = [{letter: v for letter, v in case(1, axes).items() if letter != vhat_c} for axes in ORDERS]
    return judged(all(is_identity(line, values) for values in without for line in printed))


def nonsingular(number: int, *needed: str) -> Check:
    """A check that a corollary's determinant is zero just where ybar3, or the named velocity on its axis, is.

    The determinant must be, up to its sign and powers of d_s and ybar3, that velocity, or nothing where none is named.
    """

    def check(printed: Printed) -> Finding:
        """The corollary's determinant, for any order of the axes: a power of ybar3 and d_s times the named velocity."""
        outcomes = []
        for axes in ORDERS:
            choice = COROLLARIES[number - 1].choice(axes)
            velocities = [sp.Symbol(name.translate(str.maketrans("ijk", axes)), real=True) for name in needed]
            scale = sp.S.One if d_s.name in (*choice.unknown, *choice.earlier) else d_s**3
            rest = sp.cancel(choice.determinant / (scale * ybar3**4 * sp.Mul(*velocities)))
            outcomes.append(rest in (1, -1))
        return judged(all(outcomes), Verdict.FALSE, {"orders of the axes": len(outcomes)})

    return check


def cells(printed: Printed) -> Finding:
    """Table 1: what of v_p is free in each case, and which determinants vanish where the camera stands still."""
    still = dict.fromkeys(CAMERA, sp.S.Zero)
    free, lost = {}, {}
    for corollary in COROLLARIES:
        free[corollary.section] = 3 - len(corollary.zero)
        lost[corollary.section] = vanishes(corollary.choice().determinant.xreplace(still))
    # semigeneral: still first, then general; dynamic: the camera has to move, but where d_s is known already
    semigeneral = free["IV.A"] == 0 and free["IV.B"] == 3
    general = all(free[section] > 0 for section in free if not section.startswith("IV"))
    dynamic = {section for section, vanishing in lost.items() if vanishing} == {"IV.A", "V.A", "V.B"}
    numbers = {f"components of v_p, {section}": count for section, count in free.items()}
    return judged(semigeneral and general and dynamic, Verdict.FALSE, numbers)


def one_more_dimension(printed: Printed) -> Finding:
    """Remark 2: unknown components of v_p for as many unknown ones of v_c, with an unknown range and a known one."""

    def unknown(number: int, letter: str) -> int:
        return sum(name.startswith(letter) for name in COROLLARIES[number - 1].unknown)

    numbers: dict[str, float] = {}
    gains = []
    for without, with_it in ((3, 5), (4, 6)):
        camera = [unknown(number, "v_c") for number in (without, with_it)]
        object_ = [unknown(number, "v_p") for number in (without, with_it)]
        gains.append(camera[0] == camera[1] and object_[1] == object_[0] + 1)
        names = (f"of v_p, {camera[0]} of v_c unknown, range {word}" for word in ("unknown", "known"))
        numbers |= dict(zip(names, object_, strict=True))
    return judged(all(gains), Verdict.FALSE, numbers)


def determinants(named: Mapping[str, sp.Expr]) -> Target:
    """Target of determinants, each up to a number."""
    return Target(tuple(Line(name, value, EQUATION) for name, value in named.items()))


def solvable(number: int, page: str, note: str, *needed: str) -> Entry:
    """Statement of a corollary about its determinant: it vanishes where the named velocity does, or nowhere."""
    says = f"solvable if {needed[0]} is not 0" if needed else "always solvable"
    section, check = COROLLARIES[number - 1].section, nonsingular(number, *needed)
    return at(f"corollary {number}", page, section, says)((), check, note, asks=lambda: COROLLARIES[number - 1])


INVERSE_G = Omega_g.inv() * ghat
AXES = "for any order of the axes"

reads = reader(
    (Omega, Omega2, g, ghat, v_c, v_p, vhat_c, vhat_p, e_i, Omega1i, Omega1j, Omega1, Omega3, Omega_g),
    INVERSE_G=INVERSE_G,
)

ENTRIES = (
    at("Table 1", "5", "III", "which section is for which motions")(
        (),
        cells,
        "dynamic: the determinant vanishes where the camera stands still; IV.B has d_s from IV.A",
        asks=lambda: determinants({f"det{c.number}": c.choice().determinant for c in COROLLARIES}),
    ),
    at("(22)", "6", "IV.A", "static object")(reads("Omega = Omega2; g = Omega1 v_c d_s"), holds_in(1)),
    at("(23)", "6", "IV.A", "d_s from one known component of v_c")(
        reads("[dhat_s] = (e_i^T v_c)^-1 e_i^T Omega1^-1 ghat; [dhat_s] = e_i^T Omega1^-1 ghat / v_ci"),
        scale_from_what_is_known,
        AXES,
    ),
    at("(24)", "6", "IV.A", "inverse depth")(reads("yhat3 = dhat_s ybar3"), holds_in(1)),
    at("(25)", "7", "IV.A", "the camera's velocity")(reads("vhat_c = Omega1^-1 ghat / dhat_s"), holds_in(1)),
    solvable(1, "6", f"determinant +-ybar3^4 v_ci, {AXES}", "v_ci"),
    at("(26)", "7", "IV.B", "object in general motion")(
        reads("Omega = Omega1 v_c d_s + Omega2; g = Omega3 v_p d_s"), holds_in(2)
    ),
    at("(27)", "7", "IV.B", "the object's velocity")(reads("vhat_p = Omega3^-1 ghat / dhat_s"), holds_in(2)),
    solvable(2, "7", "determinant -ybar3^4; it takes d_s > 0 and the camera's velocity of now"),
    at("(28)", "7", "V.A", "object on a plane, camera known")(
        (
            *reads("Omega = Omega2; g = Omega_g [d_s, v_pi d_s, v_pj d_s]"),
            equal(Omega_g, side_by_side(Omega1 * v_c, Omega3i, Omega3j)),
        ),
        holds_in(3),
        AXES,
    ),
    at("(29)", "7", "V.A", "d_s and the object's velocity")(
        reads("[dhat_s, vhat_pi dhat_s, vhat_pj dhat_s] = INVERSE_G"), holds_in(3)
    ),
    solvable(3, "7", f"determinant +-ybar3^4 v_ck, {AXES}", "v_ck"),
    at("(30)", "8", "V.B", "object on a line, camera partly known")(
        (
            *reads("Omega = Omega2; g = Omega_g [d_s, v_ck d_s, v_pi d_s]"),
            equal(Omega_g, side_by_side(Omega1i * v_ci + Omega1j * v_cj, Omega1k, Omega3i)),
        ),
        holds_in(4),
        AXES,
    ),
    at("(31)", "8", "V.B", "d_s and both unknown velocities")(
        reads("[dhat_s, vhat_ck dhat_s, vhat_pi dhat_s] = INVERSE_G"), holds_in(4)
    ),
    solvable(4, "8", f"determinant +-ybar3^4 v_cj, {AXES}; v_ci drops out of it", "v_cj"),
    at("(32)", "9", "VI.A", "range and camera known")(
        reads("Omega = Omega1 v_c d_s + Omega2; g = Omega3 d_s v_p"), holds_in(5)
    ),
    at("(33)", "9", "VI.A", "the object's velocity")(reads("vhat_p = Omega3^-1 ghat / d_s"), holds_in(5)),
    solvable(5, "9", "determinant -d_s^3 ybar3^4"),
    at("(34)", "10", "VI.B", "range known, object on a plane")(
        (
            *reads("Omega = Omega1i v_ci d_s + Omega1j v_cj d_s + Omega2; g = Omega_g [v_ck, v_pi, v_pj]"),
            equal(Omega_g, side_by_side(Omega1k * d_s, Omega3i * d_s, Omega3j * d_s)),
        ),
        holds_in(6),
        AXES,
    ),
    at("(35)", "10", "VI.B", "the unknown velocities")(reads("[vhat_ck, vhat_pi, vhat_pj] = INVERSE_G"), holds_in(6)),
    solvable(6, "10", f"determinant +-d_s^3 ybar3^4, {AXES}"),
    at("Assumption 11", "10", "VI.C", "which of v_c are unknown")(
        reads("[first_unknown, second_unknown] = [v_ci, v_ck]"),
        holds_in(7),
        "v_cj in place of v_ci, which is known and along the object's line (as scanned)",
        Verdict.MISPRINT,
        correction={v_ci: v_cj},
    ),
    at("(36)", "11", "VI.C", "range known, object on a line")(
        (
            *reads("Omega = Omega1i v_ci d_s + Omega2; g = Omega_g [v_cj, v_ck, v_pi]"),
            equal(Omega_g, side_by_side(Omega1j * d_s, Omega1k * d_s, Omega3i * d_s)),
        ),
        holds_in(7),
        AXES,
    ),
    at("(37)", "11", "VI.C", "the unknown velocities")(reads("[vhat_cj, vhat_ck, vhat_pi] = INVERSE_G"), holds_in(7)),
    solvable(7, "11", f"determinant +-d_s^3 ybar3^4, {AXES}"),
    at("Remark 2", "11", "VI.C", "a known range frees one more component of v_p")((), one_more_dimension),
)
