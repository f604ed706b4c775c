"""Chwa 2019: the assumptions, Theorem 1 (i) to (iii), and what the text says without a formula."""

from __future__ import annotations

from functools import cache
from itertools import combinations

import numpy as np
import sympy as sp
from scipy.integrate import simpson

from percept_obs.compile import vectorised
from percept_obs.observers.integral_sliding_mode import a, b, gamma, integral_sliding_mode, k1, k2
from percept_obs.papers.base import column, identities, reader
from percept_obs.papers.chwa2019_cases import MOTION, ORDERS, determinants, nonsingular
from percept_obs.papers.chwa2019_observer import CASE_G, GAINS, attracts, error_dynamics, rest
from percept_obs.papers.chwa2019_observer import ENTRIES as OBSERVER
from percept_obs.papers.chwa2019_results import followed
from percept_obs.papers.entries import Check, Entry, Finding, Known, Printed, Values, Verdict, at, judged, not_checkable
from percept_obs.structure import COROLLARIES, scaled_dynamics
from percept_obs.structure.dynamics import OUTPUTS, d_s
from percept_obs.structure.scenarios import chwa2019_experiment

y1, y2, ybar3 = OUTPUTS
TURNING = MOTION[:3]
s_e, s, t = sp.symbols("s_e s t", real=True)
y3 = sp.Symbol("y3", real=True)
Omega2 = sp.MatrixSymbol("Omega2", sp.Integer(3), sp.Integer(1))
STEP = 1e-3
"""Step of explicit Euler, in seconds."""


def of_columns(*names: str, axes: str = "123") -> sp.Expr:
    """Determinant of some columns of Omega1 ("1i") and Omega3 ("3k")."""
    matrices = {"1": scaled_dynamics().camera, "3": scaled_dynamics().object}
    place = {letter: int(axis) - 1 for letter, axis in zip("ijk", axes, strict=True)}
    return sp.Matrix.hstack(*(matrices[name[0]][:, place[name[1]]] for name in names)).det()


def columns_independent(*names: str) -> Check:
    """Check the determinant of some columns of Omega1 and Omega3, for any order of the axes."""

    def check(printed: Printed) -> Finding:
        """Determinant of the named columns of Omega1 and Omega3, up to a sign a power of ybar3, for any order."""
        outcomes = [sp.cancel(of_columns(*names, axes=axes) / ybar3**4) in (1, -1) for axes in ORDERS]
        return judged(all(outcomes), Verdict.FALSE, {"orders of the axes": len(outcomes)})

    return check


def known_scale() -> Values:
    """Inverse depth with the scale known."""
    return {y3: d_s * ybar3}


def does_not_turn() -> Values:
    """Omega_2 of a camera and object that do not turn."""
    return {Omega2: (scaled_dynamics().rotation * column(*TURNING)).xreplace(dict.fromkeys(TURNING, sp.S.Zero))}


def largest_until(since: float) -> tuple[float, float]:
    """Largest |e_s| and rate of it in 4 s from a time on, in IV.A with s = 0."""
    run = followed("IV.A", 25.0, 0.005)
    part = (run.time >= since) & (run.time < since + 4)
    error = run.recording.outputs[part] - run.state[part, :3]
    return float(np.abs(error).max()), float(np.abs(np.gradient(error, 0.005, axis=0)).max())


def errors_vanish(printed: Printed) -> Finding:
    """Theorem 1 (iii) in IV.A: the largest e_s and rate of e_s in 4 s from 1, 5 and 20 s on; s is 0 there."""
    sizes = {since: largest_until(since) for since in (1, 5, 20)}
    numbers = {f"|e_s| from {since} s on": size[0] for since, size in sizes.items()}
    numbers |= {f"its rate from {since} s on": size[1] for since, size in sizes.items()}
    falls = all(sizes[1][k] > sizes[5][k] > sizes[20][k] for k in (0, 1)) and sizes[20][0] < 0.3 * sizes[1][0]
    return judged(falls, Verdict.FALSE, numbers)


def square_integrable(printed: Printed) -> Finding:
    """Theorem 1 (ii) in IV.A: the largest e_s, and the integral of its square up to 5, 10, 20 s, which levels off."""
    run = followed("IV.A", 25.0, 0.005)
    square = np.square(run.recording.outputs - run.state[:, :3]).sum(axis=1)
    numbers = {"largest |e_s|": float(np.sqrt(square.max()))}
    gathered = [float(simpson(square[run.time <= k], dx=0.005)) for k in (5, 10, 20)]
    numbers |= dict(zip((f"integral up to {k} s" for k in (5, 10, 20)), gathered, strict=True))
    return judged(gathered[2] - gathered[1] < 0.1 * gathered[0], Verdict.FALSE, numbers)


def rests_at_what(printed: Printed) -> Finding:
    """Where s_e comes to rest for a g that stays: it falls as 1 / (a + b t), so its square has an integral."""
    scaled = [rest(time, CASE_G) * (1 + 0.1 * time) for time in (10.0, 100.0, 1000.0)]
    numbers = dict(zip((f"s_e (a + b t) at {k} s" for k in (10, 100, 1000)), scaled, strict=True))
    return judged(scaled[2] < 1.1 * scaled[1] and scaled[2] < 1, Verdict.FALSE, numbers)


def three_of_seven(printed: Printed) -> Finding:
    """Ranks of the rate's slope in each three of d_s, v_c and v_p, the others known, at a point of no special kind."""
    dynamics = scaled_dynamics()
    unknown = (d_s, *MOTION[3:])
    symbols = sorted(dynamics.rate.free_symbols, key=str)
    here = {symbol: sp.Rational(sp.prime(k + 4), 7 + k) for k, symbol in enumerate(symbols)}
    slope = dynamics.rate.jacobian(unknown).subs(here)
    lost = [names for names in combinations(range(7), 3) if slope[:, list(names)].rank() < 3]
    first = [unknown.index(sp.Symbol(name, real=True)) for name in ("d_s", "v_c1", "v_p1") if name != "d_s"]
    named = (0, *first) in lost
    numbers = {"threes": 35, "of them without a solution": len(lost), "rank for d_s, v_cx, v_px": 2 if named else 3}
    return judged(not named, Verdict.FALSE, numbers)


def gains_of(printed: Printed) -> Finding:
    """Number of the five gains that stand in the printed (8) to (14)."""
    lines = {entry.place: entry.printed for entry in OBSERVER if entry.number in range(8, 15)}
    numbers = {f"gains in {place}": len({k1, k2, gamma, a, b} & symbols_of(*line)) for place, line in lines.items()}
    return judged(numbers["gains in (12)"] == 5, Verdict.FALSE, numbers)


def symbols_of(*lines: sp.Basic) -> set[sp.Basic]:
    """All symbols in formulas."""
    return set().union(*(line.free_symbols for line in lines))


def known_range(printed: Printed) -> Finding:
    """Number of the cases with a known range that estimate d_s."""
    inside = [d_s.name in corollary.unknown for corollary in COROLLARIES if corollary.section.startswith("VI.")]
    return judged(all(inside), Verdict.FALSE, {"cases of VI": len(inside), "of them estimate d_s": sum(inside)})


@cache
def spread_by_euler(second_surface: bool) -> float:
    """Spread of d_s from 1 to 2 s in IV.A by explicit Euler, with v from (12), or v = -gamma sgn(s_e) without s."""
    setup, run = chwa2019_experiment("IV.A"), followed("IV.A", 2.0, STEP)
    form = setup.choice.form
    made = integral_sliding_mode(form, "sign")
    state, flow = list(made.equations.state), [*made.equations.flow, made.estimate[3]]
    if not second_surface:
        surfaces = [x - state[k] + state[3 + k] for k, x in enumerate(form.x1)]
        flow = [
            entry.xreplace({v: -gamma * sp.sign(se) for v, se in zip(state[7:], surfaces, strict=True)})
            for entry in flow
        ]
    rate = vectorised((*form.x1, *state), flow, {**made.gain_values, **setup.motion.values})
    images = run.truth[:, :3]
    start = dict(zip((*form.x1, *state[:3]), (*images[0], 0, 0, 0), strict=True))
    now = np.array(
        [float(sp.sympify(entry).subs(start).subs(made.gain_values)) for entry in (*[0] * 3, *made.start[3:])]
    )
    found = []
    for image in images:
        *rates, scale = rate(*image, *now)
        now = now + STEP * np.array(rates, dtype=float)
        found.append(float(scale))
    return float(np.std(np.array(found)[run.time >= 1]))


def chatters(printed: Printed) -> Finding:
    """Spread of d_s from 1 to 2 s in IV.A, by explicit Euler with 1 ms: with the second surface, and with one only."""
    with_it, without = spread_by_euler(True), spread_by_euler(False)
    numbers = {"spread of d_s without the second surface": without, "with it": with_it}
    return judged(with_it < without / 50, Verdict.FALSE, numbers)


def beyond_in_each_entry(printed: Printed) -> Finding:
    """(21) for three entries and g = gamma / 2: all beyond the bound, where it holds; one only, where it need not."""
    at = GAINS | {t: 0, s: 0, sp.Symbol("g", real=True): GAINS[gamma] / 2}
    edge = sp.atanh(sp.Rational(1, 2))
    rate_of_V, numbers = error_dynamics()[sp.Symbol("Vdot", real=True)], {}
    for name, entries in (("all beyond", (1, 2, 3)), ("one beyond", (1, sp.S.Half, sp.S.Half))):
        rate = sum(rate_of_V.subs(at | {s_e: entry * edge}) for entry in entries)
        bound = sum(-GAINS[k1] * (entry * edge) ** 2 for entry in entries)
        numbers[f"rate of V less its bound, {name}"] = float(rate - bound)
    first, second = numbers.values()
    return judged(first <= 1e-9 and second > 0, Verdict.FALSE, numbers)


def assumption(
    number: int,
    page: str,
    section: str,
    says: str,
    note: str,
    check: Check = not_checkable,
    printed: Printed = (),
    columns: tuple[str, ...] = (),
) -> Entry:
    """Entry of an assumption; one without a check is a definition, one with columns says that they are independent."""
    free = check is not_checkable and not columns
    verdict, known = (Verdict.NOT_CHECKABLE, Known.DEFINITION) if free else (Verdict.HOLDS, Known.DERIVED)
    asks = (lambda: determinants({"det": of_columns(*columns)})) if columns else None
    check = columns_independent(*columns) if columns else check
    return at(f"Assumption {number}", page, section, says)(printed, check, note, verdict, known=known, asks=asks)


reads = reader(Omega2)

ENTRIES = (
    assumption(1, "3", "II", "velocities and their rates are bounded, w is known", "it does not bound g: see there"),
    assumption(2, "6", "IV", "the object stands still first", "then it may move anyhow; how long is left open"),
    assumption(
        3,
        "6",
        "IV.A",
        "one component of v_c is known, not 0",
        "just this is needed: v_c may vary",
        nonsingular(1, "v_ci"),
    ),
    assumption(
        4,
        "7",
        "V.A",
        "the object moves in a plane",
        "one that holds two of the camera's axes",
        printed=reads("v_pk = 0"),
    ),
    assumption(
        5,
        "7",
        "V.A",
        "v_c is known, and v_ck not 0",
        "[Omega3i, Omega3j, Omega1k] has the determinant +-ybar3^4",
        columns=("3i", "3j", "1k"),
    ),
    assumption(
        6,
        "8",
        "V.B",
        "the object moves on a line",
        "along one of the camera's axes",
        printed=reads("v_pj = 0; v_pk = 0"),
    ),
    assumption(
        7,
        "8",
        "V.B",
        "v_ci and v_cj are known, v_cj not 0",
        "[Omega1j, Omega1k, Omega3i] has the determinant +-ybar3^4",
        columns=("1j", "1k", "3i"),
    ),
    at("Assumption 8", "8", "VI", "the range y3, that is d_s, is known")(
        reads("y3 = d_s ybar3"), identities(known_scale), "either gives the other"
    ),
    assumption(9, "9", "VI.A", "v_c is known", "in place of assumptions 3, 5 and 7"),
    assumption(
        10,
        "9",
        "VI.B",
        "v_ck is unknown, v_ci and v_cj are known",
        "[Omega3i, Omega3j, Omega3k] is nonsingular; that v_c is not 0 is not needed, see corollary 6",
        columns=("3i", "3j", "3k"),
    ),
    at("three variables", "4", "II", "three among y3, v_p and v_c can be estimated")(
        (),
        three_of_seven,
        "not any three: v_ci and v_pi of the same axis have parallel columns, as in {d_s, v_cx, v_px}",
        Verdict.FALSE,
    ),
    at("Theorem 1 (i)", "6", "III", "s is bounded")(
        (), attracts, "it starts at 0, and where |g| <= gamma it stays there, with the listed gains"
    ),
    at("Theorem 1 (ii)", "6", "III", "e_s is bounded and square integrable")(
        (), square_integrable, "in IV.A, with s = 0", known=Known.RUNS
    ),
    at("Theorem 1 (iii)", "6", "III", "s, e_s and its rate tend to 0")(
        (), errors_vanish, "in IV.A, with s = 0", known=Known.RUNS
    ),
    at("Barbalat", "6", "III", "s_e is square integrable and so tends to 0")(
        (), rests_at_what, "though not from (21), which fails near 0: s_e falls as 1/(a + b t), for b > 0 only"
    ),
    at("Remark 1", "6", "III", "the second surface inhibits chattering")(
        (),
        chatters,
        "against the same design with v = -gamma sgn(s_e); what is left is about gamma^2 (a + b t) h in ghat",
        known=Known.RUNS,
    ),
    at("(21) for a vector", "6", "III", "the same for each entry")(
        (),
        beyond_in_each_entry,
        "functions and |.| are taken of each entry, and each has to be beyond the bound; g = gamma / 2, s = 0",
    ),
    at("w = 0", "11", "VII.A", "neither simulation nor experiment turns")(
        reads("Omega2 = [0, 0, 0]"),
        identities(does_not_turn),
        "so neither tries Omega2, in which the print has a slip",
    ),
    at("gains in (12)", "13", "VII.B", "the gains stand in (12)")(
        (), gains_of, "(12) has none; (8)-(14) is meant, as in VII.A", Verdict.FALSE
    ),
    at("figure 7", "12", "VII.A", "with a known range d_s is estimated")(
        (),
        known_range,
        "a known range is a known d_s, see assumption 8; the captions of the figure do not name it",
        Verdict.FALSE,
    ),
)
