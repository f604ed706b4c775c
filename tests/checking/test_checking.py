"""A formula in any form is accepted, a slip is refused, found and named, and the step in which it happened."""

import re
from dataclasses import replace

import pytest
import sympy as sp
from derivations import cases, equivalent, few_cases, reviewed
from examples import AFFINE, BOTH, MOTIONS, ONE
from refusals import refuses
from sample_sizes import sampled

from percept_obs import PerspectiveSystem, check, ekf, ibo, instantaneous, pinhole, plane
from percept_obs.checking import CannotRead, Verdict, target_of
from percept_obs.papers import INABA2005, MA2005
from percept_obs.structure import StructureAndMotion
from percept_obs.system.derivation import Derivation

RATE = "y1' = a13 + (a11 - a33) y1 + a12 y2 - a31 y1^2 - a32 y1 y2 + (b1 - b3 y1) y3"
RIGID = PerspectiveSystem(MOTIONS["rigid"], pinhole())
TURN = {w: -w for w in RIGID.parameters[:3]}
FORMS, SLIPS, PAIRS = sampled(20, 300), sampled(20, 300), sampled(8, 100)


def accepted(seeds, among):
    """Rewrites that were not accepted."""
    made = ((seed, *equivalent(seed, among)) for seed in seeds)
    return [(seed, case.name, how) for seed, how, mine, case in made if check(mine, case.target).right is not True]


def test_equivalent_forms_are_accepted():
    assert accepted(range(300, 330), few_cases()) == []


@pytest.mark.slow
def test_many_equivalent_forms_are_accepted():
    assert accepted(range(FORMS), cases()) == []


def shares(count, slips, among):
    """Shares of formulas with slips that were refused, with the right line, term and slip."""
    found = [reviewed(seed, slips, among) for seed in range(count)]
    for one in found:
        if not (one.refused and one.line and one.term and (one.slip or slips > 1)):
            print(one.about)
    return {name: sum(getattr(one, name) for one in found) / count for name in ("refused", "line", "term", "slip")}


@pytest.mark.slow
def test_slips_in_all_that_is_derived_are_refused_found_and_named():
    told = shares(SLIPS, 1, cases())
    assert told["refused"] == told["line"] == 1
    assert told["term"] >= 0.98
    assert told["slip"] >= 0.95


@pytest.mark.slow
def test_pairs_of_slips_are_refused_and_found():
    told = shares(PAIRS, 2, cases())
    assert told["refused"] == 1
    assert told["term"] >= 0.85


@pytest.mark.parametrize(
    ("right", "wrong", "said"),
    [
        ("(b1 - b3 y1)", "(b1 + b3 y1)", ["the sign of b3 y1 is wrong", "b3 y1 y3: you have +1, it is -1", "step 5"]),
        ("a12 y2", "a21 y2", ["the index: a21 stands where a12 belongs in a21 y2", "step 5"]),
        (
            "- a31 y1^2 - a32 y1 y2 + (b1 - b3 y1) y3",
            "+ a33 y1 + b1 y3",
            ["step 4", "the derivative of y1 = X/Z with respect to Z was left out"],
        ),
    ],
    ids=["wrong sign", "swapped index", "forgotten derivative of 1/Z"],
)
def test_mistakes_of_students_are_named_with_their_step(right, wrong, said):
    assert right in RATE
    review = check(RATE.replace(right, wrong), AFFINE)
    assert review.right is False
    assert all(words in str(review.hint(3)) for words in said)
    assert not any(words in str(review.hint(2)) for words in said)


@pytest.mark.parametrize(
    ("mine", "true", "said"),
    [
        ("a + b c", "a - b c", "the sign of b c is wrong"),
        ("a (b - 2 c)", "a (b - c)", "-2 c should be -c: the factor is wrong"),
        ("a + y1 yhat2", "a + y1 y2", "the hat: yhat2 stands where y2 belongs in y1 yhat2"),
        ("a + sqrt(b^3 + c)", "a + sqrt(b^2 + c)", "the exponent 3 should be 2 in b^3"),
        ("tanh(a) + b", "tanh(a + c) + b", "the term c is missing in a"),
        ("a/(b + c + 1)", "a/(b + c)", "the term 1 is one too many"),
        ("a (b + c)", "a (b + c + a b)", "the term a^2 b is missing"),
        ("a + b + c", "a + b", "the term c is one too many"),
        ("a + b", "a + b c", "b should be b c"),
        ("a + b^2 + c", "a + b d + c", "b stands where d belongs in b^2"),
        ("-a - b", "a + b", "all signs of -a - b are turned"),
        ("y1^2 - y2 (1 + y1)", "y2^2 - y1 (1 + y2)", "y1 and y2 are swapped"),
        ("y1^2 + y1 (1 + y1)", "y2^2 + y2 (1 + y2)", "the index: y1 stands everywhere where y2 belongs"),
        ("a12 y1 + a12^2", "a21 y1 + a21^2", "a12 stands everywhere where a21 belongs"),
        ("a12 y1 + a31 y2 + a12 a31", "a21 y1 + a13 y2 + a21 a13", "as in the transposed matrix"),
        ("a + 2 b - sin(c)", "a + b + sin(c)", "the sign of -sin(c) is wrong"),
        ("a22 y1 - a33 y1 + a33 y1 + b", "a22 y1 - a33 y1 + a22 y2 + b", "a33 y1: you have 0, it is -1"),
        ("2 y1^2 + b", "y1^2 + y2^2 + b", "the index: y1 stands where y2 belongs in y1^2"),
    ],
)
def test_each_kind_of_slip_is_named(mine, true, said):
    known = "y1 y2 yhat1 yhat2 a b c d a12 a21 a13 a31 a22 a33"
    target = replace(target_of(f"f = {true}"), pool=frozenset(sp.symbols(known, real=True)))
    assert said in str(check(f"f = {mine}", target).hint(3))


def test_a_step_is_not_blamed_for_what_is_right_elsewhere():
    other = sp.Eq(sp.Symbol("ydot2"), AFFINE.rate[1])
    told = str(check([RATE.replace("(b1 - b3 y1)", "(b1 + b3 y1)"), other], AFFINE).hint(3))
    assert "step 5" not in told
    assert "step 7" in told


def test_hints_open_one_by_one():
    wrong = "y3' = -y3 (a31 y1 + a32 y2 + a33 - b3 y3)"
    review = check([RATE, wrong], AFFINE)
    assert "✗" not in str(review)
    assert "✗ y3'" in str(review.hint(1))
    assert "look at" not in str(review.hint(1))
    assert "look at -b3 y3" in str(review.hint(2))
    assert r"\boxed{b_{3} y_{3}}" in review.hint(2)._repr_markdown_()
    assert r"\boxed" not in review.hint(1)._repr_markdown_()
    assert "the sign of $- b_{3} y_{3}$ is wrong" in review.hint(3)._repr_markdown_()
    with pytest.raises(ValueError, match="there is no hint 4"):
        review.hint(4)


def test_a_right_line_shows_itself_as_mathematics():
    shown = check(RATE, AFFINE)._repr_markdown_()
    assert shown.startswith("**Right: y1'.**")
    assert r"\dot{y_{1}} = " in shown


def test_a_strange_name_is_no_markup():
    strange, plain = sp.symbols("<b>*a*$|`[x](y), y_3")
    shown = check(strange + plain, strange + 2 * plain).hint(2)._repr_markdown_()
    assert "y_{3}" in shown
    assert not re.search(r"[<`|]|\*a", shown)


def test_letters_are_matched_by_name():
    y3, b3 = sp.Symbol("y_3"), sp.Symbol("b_3", positive=True)
    a31, a32, a33, y1, y2 = sp.symbols("a31 a32 a33 y1 y2", complex=True)
    assert check({"y3'": -y3 * (a31 * y1 + a32 * y2 + a33 + b3 * y3)}, AFFINE).right
    assert check({"y3'": -y3 * (a31 * y1 + a32 * y2 + a33 - b3 * y3)}, AFFINE).right is False


def test_updates_and_resets_of_observers_are_targets():
    filter, bounded = ekf(ONE).equations, ibo(ONE).equations
    assert check(["yhat1 + P11 (y1 - yhat1)/(P11 + R)", *filter.update[0][1:]], filter.update[0]).right
    wrong = check(["yhat1 - P11 (y1 - yhat1)/(P11 + R)", *filter.update[0][1:]], filter.update[0])
    assert "the sign" in str(wrong.hint(3))
    assert check("M^2 gamma^2 <= yhat1^2 + yhat2^2 + yhat3^2", bounded.reset_condition).right
    assert check("yhat1 M/sqrt(yhat1^2 + yhat2^2 + yhat3^2)", bounded.reset[0]).right


def test_lines_may_use_letters_of_their_own():
    assert check("q = a31 y1 + a32 y2 + a33\ny3' = -q y3 - b3 y3^2", AFFINE).right
    assert check("qq = a31 y1 + a32 y2 + a33; y3' = -qq y3 + b3 y3^2", AFFINE).right is False
    assert check("q = a31 y1 + a32 y2 + a33 + b3 y3\n-q y3", BOTH.g).right, "q is not given by itself"
    assert check("q = -a31 y1 - a32 y2\n- a33 - b3 y3\nq y3", BOTH.g).right, "the second line goes on with the first"


def test_what_follows_from_a_wrong_line_is_right_from_there_on():
    lines = "y3' = -y3 (a31 y1 + a32 y2 + a33 - b3 y3) = -a31 y1 y3 - a32 y2 y3 - a33 y3 + b3 y3^2"
    assert [line.verdict for line in check(lines, AFFINE).lines] == [Verdict.WRONG, Verdict.CARRIED]
    velocity = ["a11 y1 + a12 y2 + a13 + b1 y3", "a21 y1 + a22 y2 + a23 + b2 y3", "a31 y1 + a32 y2 + a33 - b3 y3"]
    wrong = {5: f"[{', '.join(velocity)}]", "y3'": f"-y3 ({velocity[2]})"}
    review = check(wrong, AFFINE.derivation())
    assert [line.verdict for line in review.lines] == [Verdict.RIGHT, Verdict.RIGHT, Verdict.WRONG, Verdict.CARRIED]
    assert "this follows from your “The velocity, times the inverse distance”" in str(review.hint(1))
    again = check(wrong | {"y3'": f"y3 ({velocity[2]})"}, AFFINE.derivation())
    assert again.lines[-1].verdict == Verdict.WRONG


def test_parts_of_a_form_are_checked_together():
    right = {2: ONE.w.T, 3: ONE.phi, 4: ONE.g}
    assert check(right, ONE.derivation()).right
    wrong = check(right | {4: -ONE.g}, ONE.derivation())
    assert [line.verdict for line in wrong.lines] == [Verdict.RIGHT] * 3 + [Verdict.WRONG] * 2
    assert "step" not in str(wrong.hint(3))
    told = str(check({"y1'": ONE.rate[0] - 2 * ONE.phi[0]}, ONE).hint(3))
    assert "step 3" in told


def test_conventions_are_no_errors():
    camera = check([sp.Eq(sp.Symbol(f"ydot{k}"), rate.xreplace(TURN)) for k, rate in enumerate(RIGID.rate, 1)], RIGID)
    assert camera.right
    assert "your angular velocity turns the world" in camera.summary
    system = PerspectiveSystem(MOTIONS["affine"], plane())
    further = {n: n / sp.Symbol("d") for n in system.surface.parameters}
    distance = check({"y1'": system.rate[0].xreplace(further)}, system)
    assert distance.right
    assert "n . X = d" in distance.summary
    phi = RIGID.measure("y1").phi
    assert check(-phi, phi).right is False, "with one letter of three it may as well be a slip"
    mixed = check({"y1'": RIGID.rate[0], "y2'": RIGID.rate[1].xreplace(TURN)}, RIGID)
    assert mixed.right is False
    assert "as in a cross product with the other sign" in str(mixed.hint(3))


def test_matrices_are_told_from_their_transposes():
    both = sp.Matrix([[0, 1], [-1, 0]]) * sp.Symbol("a11") + sp.Matrix([[0, 0], [0, 1]])
    assert check(both, both).right
    assert "transpose" in str(check(both.T, both).hint(3))
    w = ONE.w
    assert check("w^T = [[a12 - a32 y1, b1 - b3 y1]]", w).right
    assert check("[a12 - a32 y1, b1 - b3 y1]", w).right
    with pytest.raises(ValueError, match="a matrix with 3 entries does not fit"):
        check("[a12, b1, b3]", w)


@pytest.mark.parametrize(
    ("mine", "right"),
    [
        ("ybar3 v_c1 != 0", True),
        ("ybar3 = 0", False),
        ("0 = ybar3 v_c1", False),
        ("-2 d_s v_c1 ybar3^3 (1 + y1^2)", True),
        ("ybar3", False),
        ("ybar3 v_c2", False),
        ("ybar3 v_c1 (y1 - y2)", False),
    ],
)
def test_of_a_condition_only_its_zeros_count(mine, right):
    choice = StructureAndMotion(("d_s", "v_c2", "v_c3"), zero=("v_p1", "v_p2", "v_p3"))
    assert check(mine, choice).right is right


def test_a_condition_with_a_wrong_letter_is_explained():
    choice = StructureAndMotion(("d_s", "v_c2", "v_c3"), zero=("v_p1", "v_p2", "v_p3"))
    assert check(choice.condition, choice).right
    assert "v_c2 stands where v_c1 belongs" in str(check("ybar3 v_c2 != 0", choice).hint(3))
    assert check("(b1 - b3 y1)^2 + (b2 - b3 y2)^2 != 0", instantaneous(BOTH)).right


def test_sums_of_squares_vanish_where_all_squares_do():
    assert check("(b1 - b3 y1)^2 + 2 (b2 - b3 y2)^2", instantaneous(BOTH)).right
    assert check("(b1 - b3 y1)^4 + (b2 - b3 y2)^2", instantaneous(BOTH)).right is None
    assert check("(b1 - b3 y1)^2 - (b2 - b3 y2)^2", instantaneous(BOTH)).right is False


def test_prints_of_the_papers_are_targets():
    entry = MA2005["(4)"]
    assert check(RATE, entry.printed).right
    assert check(RATE.replace("a12 y2", "a22 y2"), entry.printed).right is False
    A, P, n = sp.MatrixSymbol("A", 2, 2), sp.MatrixSymbol("P", 2, 2), sp.Symbol("n", integer=True, positive=True)
    lyapunov = sp.Eq(A.T * P + P * A, -sp.Identity(2), evaluate=False)
    assert check(sp.Eq(P * A + A.T * P, -sp.Identity(2), evaluate=False), lyapunov).right
    assert check(sp.Eq(P * A + A * P, -sp.Identity(2), evaluate=False), lyapunov).right is False
    B = sp.MatrixSymbol("B", n, n)
    assert check((B * B.T).T, B * B.T).right
    assert check(B.T * B, B * B.T).right is False


def test_equations_are_the_same_up_to_a_number_and_inequalities_up_to_a_positive_one():
    x, y = sp.symbols("x y", real=True)
    assert check("2 x = 2 y^2 + 4", sp.Eq(x + 1, y**2 + 3)).right
    assert check("y^2 + 2 = x + 1", sp.Eq(x + 1, y**2 + 3)).right is False
    assert check("2 x < 2 y", x < y).right
    assert check("x > y", x < y).right is False


def test_what_cannot_be_told_is_not_guessed():
    x = sp.Symbol("x", real=True)
    review = check(sp.tanh(sp.Integer(10) ** 12 * (x**2 + 1)) + sp.Max(x, 0), 1 + sp.Max(x, 0))
    assert review.right is None
    assert "cannot be told" in review.summary


def test_latex_of_the_package_is_read():
    observer = ibo(BOTH)
    lines = [rf"\dot{{{sp.latex(s)}}} = {sp.latex(e)}" for s, e in zip(*_flow(observer), strict=True)]
    assert check(lines, observer).right
    assert check(
        r"\frac{d}{dt} \left[\begin{matrix}y_{1}\\y_{2}\\y_{3}\end{matrix}\right] = " + sp.latex(AFFINE.rate), AFFINE
    ).right
    assert check(sp.latex(AFFINE.jacobian()), AFFINE.jacobian()).right
    assert check(AFFINE._repr_latex_(), AFFINE).right
    assert check(observer.equations._repr_latex_().split(r"\\ \left[")[0] + r"\end{aligned}$", observer).right


def _flow(observer):
    return observer.equations.state, observer.equations.flow


test_what_does_not_fit_is_refused = refuses(
    lambda mine, target: check(mine, target),
    ("a11 y1", AFFINE, "a line without a name is none of those asked for: y1', y2', y3'"),
    ("y3 = 1/Z", AFFINE, "the line y3 is none of those asked for"),
    (None, AFFINE, "a NoneType is no formula"),
    (sp.nan, AFFINE, "has no finite value; look for a division by zero"),
    (float("nan"), AFFINE, "has no finite value"),
    (RATE, 3.5, "nothing can be compared with the number 3.5"),
    ("J = 1", Derivation(()), "the derivation has no formulas of its own"),
)


def test_an_entry_of_a_ledger_is_a_target_whose_matrices_are_typed_by_their_letters():
    assert check(RATE, MA2005[4]).right
    assert check("dxi1 = A xi1 + wbar^T xi2; dxi2 = -wbar P xi1", MA2005[38]).right
    assert check("dxi1 = A xi1 + wbar^T xi2; dxi2 = wbar P xi1", MA2005[38]).right is False
    assert check(list(MA2005[38].corrected), MA2005[38]).right
    assert check(list(MA2005[38].printed), MA2005[38]).right is False
    assert check("K = P^-1 C^T B^T E^-1", INABA2005[10]).right
    assert check("K = P^-1 C^T B^T E", INABA2005[10]).right is False
    with pytest.raises(CannotRead, match="the sizes of these matrices do not fit"):
        check("dxi2 = -P wbar xi1", MA2005[38])


test_matrices_that_would_take_long_are_refused = refuses(
    lambda text: check(text, MA2005[38]),
    ("dxi1 = " + "A " * 800 + "xi1", "more than 8 letters of matrices stand in a row"),
    ("dxi1 = " + "(A + P)" * 40 + " xi1", "more than 8 letters of matrices stand in a row"),
    ("dxi1 = (A + P)^-1 xi1", "of a matrix only the transpose is read"),
    ("dxi1 = A^9999 xi1", "of a matrix only the transpose is read"),
    ("dxi1 = sin(A) xi1", "a matrix cannot stand here"),
    error=CannotRead,
)


def test_an_index_may_be_a_greek_letter():
    letter = sp.Symbol("e_chi", real=True)
    assert sp.latex(letter) == r"e_{\chi}"
    assert check(rf"2 {sp.latex(letter)} + 1", 2 * letter + 1).right


def test_two_slips_of_which_the_first_moves_the_second_are_told():
    y2, y3, b1, b3 = sp.symbols("y2 y3 b1 b3", real=True)
    told = str(check(2 * y3 * (b1 - b1 * y2), y3 * (b1 - b3 * y2)).hint(3))
    assert "the index: b1 stands where b3 belongs" in told
    assert "the factor is wrong" in told
