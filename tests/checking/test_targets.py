"""Every exercise of the field can be checked by the name that a student gives it, and a slip in it is wrong."""

import re

import pytest
import sympy as sp
from refusals import refuses

from percept_obs import PerspectiveSystem, affine, check, ibo, instantaneous, luenberger, pinhole
from percept_obs.checking import target_of
from percept_obs.observers import ekf
from percept_obs.papers import CHWA2019, INABA2005, LEDGERS, MA2005, Verdict
from percept_obs.points.scenarios import moving_body
from percept_obs.structure import COROLLARIES

SYSTEM = PerspectiveSystem(affine(), pinhole())
FIRST, BOTH = SYSTEM.measure("y1"), SYSTEM.measure("y1", "y2")
IBO, KALMAN = ibo(BOTH), ekf(BOTH)
SUM = "(b1 - b3 y1) e1 + (b2 - b3 y2) e2"
JACOBIAN = (
    "F = [[a11 - a33 - 2 a31 yhat1 - a32 yhat2 - b3 yhat3, a12 - a32 yhat1, b1 - b3 yhat1],"
    "[a21 - a31 yhat2, a22 - a33 - a31 yhat1 - 2 a32 yhat2 - b3 yhat3, b2 - b3 yhat2],"
    "[-a31 yhat3, -a32 yhat3, -a31 yhat1 - a32 yhat2 - a33 - 2 b3 yhat3]]"
)
BALANCE = f"""V = (e1^2 + e2^2 + e3^2) / 2
V' = -G A (e1^2 + e2^2) + (1 + G^2 P) e3 ({SUM}) - (a31 y1 + a32 y2 + a33) e3^2 - b3 e3^2 (2 y3 - e3)"""
IBO_IN_PRINT = "yhat3' = -G^2 P ((b1 - b3 y1) e1 + (b2 - b3 y2) e2) - (a31 y1 + a32 y2 + a33) yhat3 - b3 yhat3^2"

EXERCISES = {
    "velocity": (SYSTEM, "Z' = a31 X + a32 Y + a33 Z + b3"),
    "Jacobian of the system": (SYSTEM, JACOBIAN.replace("hat", "").replace("F", "J")),
    "w of one output": (FIRST, "w = [a12 - a32 y1, b1 - b3 y1]"),
    "entry of w": (BOTH, "w2 = b2 - b3 y2"),
    "phi": (FIRST, "phi = a13 + (a11 - a33) y1 - a31 y1^2"),
    "Jacobian of the filter": (KALMAN, JACOBIAN),
    "measured error": (IBO, "edot1 = -G A e1 + (b1 - b3 y1) e3"),
    "hidden error": (IBO, f"e3' = G^2 P ({SUM}) - (a31 y1 + a32 y2 + a33) e3 - b3 (2 y3 e3 - e3^2)"),
    "Lyapunov function": (IBO, BALANCE),
    "without the noise term": (IBO, "yhat1' = G A (y1 - yhat1) + (b1 - b3 y1) yhat3 + a13 + (a11 - a33) y1"
    " + a12 y2 - a31 y1^2 - a32 y1 y2"),
    "condition": (instantaneous(BOTH), "(b1 - b3 y1)^2 + (b2 - b3 y2)^2 > 0"),
    "case": (COROLLARIES[0], "det = ybar3^4 v_c1"),
    "case's g": (COROLLARIES[4], "g = [ybar3 v_p1 d_s - y1 ybar3 v_p3 d_s, ybar3 v_p2 d_s - y2 ybar3 v_p3 d_s,"
    " -ybar3^2 v_p3 d_s]"),
    "Lyapunov inequality": (INABA2005[15], "A^T P + P A + Pdot <= 0"),
    "bound of a matrix": (INABA2005["S below its bound"], "S <= (1 + y_sup^2) I; 0 <= S"),
    "another form": (INABA2005["S(y)"], "S = B^T B"),
    "exponential bound": (INABA2005["Theorem 3.4 (ii)"], "norm(rho) <= beta exp(-alpha (t - t0)) norm(rho0)"),
    "Gramian of w": (MA2005[14], r"\int_{t}^{t+\rho} w(\tau) w(\tau)^T d\tau \ge \beta I"),
    "row of table 1": (CHWA2019["Table 1"], "det1 = -ybar3^4 v_c1"),
    "sliding motion": (MA2005["(26) is stable"], "e2' = -alpha w w^T e2"),
    "rate of an energy": (INABA2005["rate of V"], "Vdot = inner(rho, (A^T P + P A + Pdot) rho)"
    " - 2 inner(rho, C^T B^T B C rho); Vdot <= -2 norm(B C rho)^2"),
}  # fmt: skip
each_exercise = pytest.mark.parametrize(("thing", "text"), EXERCISES.values(), ids=EXERCISES)


@each_exercise
def test_an_exercise_is_right_by_its_name(thing, text):
    assert check(text, thing).right


@each_exercise
def test_an_exercise_with_another_sign_is_wrong(thing, text):
    """The last sign of a term turns round, or the last exponent of a formula without one grows."""
    signs = [m.start() for m in re.finditer(r"(?<=\w|\)) [-+] ", text)]
    if signs:
        k = signs[-1] + 1
        wrong = text[:k] + {"+": "-", "-": "+"}[text[k]] + text[k + 1 :]
    else:
        wrong = (
            text.replace("v_c1", "v_c2")
            .replace("B^T B", "B^T B + B^T B")
            .replace("alpha", "2 alpha")
            .replace(r"\beta", r"2 \beta")
        )
    assert wrong != text
    assert not check(wrong, thing).right


def test_a_term_whose_gain_is_zero_may_be_typed_as_well():
    term = "+ 2 G^2 P b3 sigma^2" if IBO.equations.flow[2].expand().coeff(sp.Symbol("sigma^2", real=True)) else ""
    whole = dict(zip(("yhat1", "yhat2", "yhat3"), IBO.equations.flow, strict=True))["yhat3"]
    assert term
    assert check({"yhat3'": whole}, IBO).right
    assert check({"yhat3'": whole.subs(sp.Symbol("sigma^2", real=True), 0)}, IBO).right
    assert check({"yhat3'": whole + sp.Symbol("sigma", real=True)}, IBO).right is False
    assert not target_of(IBO.with_gains(noise_variance=1e-4)).idle


def test_letters_are_known_by_definition():
    known = {str(letter): value for letter, value in target_of(IBO).relations.items()}
    y1, y3, yhat1 = sp.symbols("y1 y3 yhat1", real=True)
    assert (known["X"], known["e1"], known["w1"]) == (y1 / y3, y1 - yhat1, BOTH.w[0])
    assert {"Xdot", "Z"} <= set(map(str, target_of(SYSTEM).relations))


def test_own_lines_for_known_letters_are_definitions():
    assert check("e1 = y1 - yhat1; e2 = y2 - yhat2; " + IBO_IN_PRINT, IBO).right
    assert check("e1 = yhat1 - y1; e2 = yhat2 - y2; " + IBO_IN_PRINT.replace("= -G", "= G"), IBO).right
    assert check("e1 = yhat1 - y1; e2 = y2 - yhat2; " + IBO_IN_PRINT, IBO).right is False


def test_the_error_of_many_points_is_checked_line_by_line():
    observer = luenberger(moving_body(1).form, 1.0)
    rate = dict(zip(observer.error, observer.error_dynamics(), strict=True))
    ((letter, value), *_) = rate.items()
    assert check({f"{letter}'": value}, observer).right
    assert check({f"{letter}'": -value}, observer).right is False
    assert check({f"{observer.estimate[0]}'": observer.flow[0]}, observer).right


@pytest.mark.slow
def test_integrals_of_matrices_are_compared_as_they_stand():
    entry = MA2005[14]

    def right(text):
        return check(entry.letters.read(text)[0], entry).right

    assert right(r"\int_{t}^{t + rho} w w^T d s >= beta I")
    assert right(r"2 \int_{t}^{t + rho} w w^T d s >= 2 beta I")
    assert right(r"\int_{t}^{t + rho} w w^T d s >= 2 beta I") is False
    assert right(r"\int_{0}^{rho} w w^T d tau >= beta I") is False
    assert right("rho w w^T >= beta I") is False
    (printed,) = INABA2005[14].printed
    assert check(printed, INABA2005[14]).right


def test_a_statement_that_is_not_true_says_so_where_it_is_typed_as_printed():
    review = check("(b1 - b3 y1)^2 + (b2 - b3 y2)^2 > 0; (b1 - b3 y1)^2 + (a12 - a32 y1)^2 > 0", MA2005[20])
    assert review.right
    assert "it is false as stated" in review.summary


@pytest.mark.slow
def test_every_entry_with_a_formula_is_a_target_and_every_other_one_says_why():
    for ledger in LEDGERS:
        for entry in ledger.entries:
            if entry.printed or entry.asked:
                assert entry.target.lines, entry.place
                assert bool(entry.target.note) == (
                    bool(entry.printed) and entry.expected in (Verdict.FALSE, Verdict.DEPENDS)
                )
            else:
                with pytest.raises(ValueError, match="a statement without a formula"):
                    entry.target  # noqa: B018


test_what_cannot_be_compared_says_why = refuses(
    lambda text, thing: check(text, thing),
    ("V' = -G A e1^2", IBO, "V' needs a V"),
    ("V = (e1^2 + e2^2 + e3^2) / 2; V' <= -G A e1^2", IBO, "go on with V' = ..."),
    ("b1 - b3 y1 > 0", instantaneous(BOTH), "has both signs"),
    ("P >= delta", INABA2005["P bounded below"], "write delta times the identity, delta I"),
    ("q = b1 - b3 y1", FIRST, "definitions only"),
    ("y1 = 1", MA2005["figure 3"], "a statement without a formula"),
    ("S = B B^T", INABA2005["S(y)"], "does not fit: S are asked for"),
)
