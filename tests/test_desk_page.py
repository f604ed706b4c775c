"""The page judges lines by itself, and as Python does: with the same grammar, by values at points that nobody knows."""

from collections import Counter

import numpy as np
import pytest
import sympy as sp
from desk_formulas import answers_of_the_page, by_python, by_the_page, lines
from sample_sizes import sampled
from test_checking_reading import HOSTILE
from test_desk import MISTAKES, as_tree

from percept_obs import PerspectiveSystem, plane, rigid
from percept_obs.labs import derivation_desk
from percept_obs.labs.desk.settings import EXAMPLE, LONGEST_LINE
from percept_obs.labs.desk.systems import number_of, system_of

pytestmark = pytest.mark.node

RATE, SPHERE = "affine pinhole, rate", "affine sphere, rate"
FORMULAS = sampled(120, 10_000)
"""Lines that are judged in both."""


def marks(node, texts, sheet=RATE, row=21):
    """The marks of texts for a line, that of y1' unless said; "refused" for what is no formula."""
    found = by_the_page(node, [(sheet, row, text) for text in texts])
    return ["refused" if line["refused"] else line["mark"] for line in found]


@pytest.mark.slow
def test_python_and_the_page_judge_lines_alike(node):
    chosen = list(lines(FORMULAS, seed=26))
    python = [by_python(sheet, row, text) for sheet, _, row, text in chosen]
    page = by_the_page(node, [(name, row, text) for _, name, row, text in chosen])
    differ = [
        (name, row, text, one, other)
        for (_, name, row, text), one, other in zip(chosen, python, page, strict=True)
        if (one["mark"], one["refused"]) != (other["mark"], other["refused"])
    ]
    assert differ == []
    for line in page:
        as_tree(line["markup"])
    counted = Counter(line["mark"] for line in python)
    print(counted)
    assert min(counted["right"], counted["wrong"], counted[""]) > FORMULAS / 20  # all three are tried


RIGHT = "a11 y1 + a12 y2 + a13 + b1 y3 - y1 (a31 y1 + a32 y2 + a33 + b3 y3)"
THE_SAME = [
    "sin(y1)^2 + cos(y1)^2 - 1",
    "cosh(y1 y2)^2 - sinh(y1 y2)^2 - 1",
    "sqrt(y1^2 y2^2) - abs(y1) abs(y2)",
    "sqrt(1 + y1^2) sqrt(1 + y1^2) - 1 - y1^2",
    "sin(2 y1) - 2 sin(y1) cos(y1)",
    "exp(y1 + y2) - exp(y1) exp(y2)",
]
NOTHING = {
    "a multiple of a large prime": "2305843009213 y1",
    "far too small": "0.000000000001 y1",
    "far too small, beside a function": "0.00000000001^3 y1 + sin(y2) - sin(y2)",
    "a small exponential": "exp(-100)",
    "a smaller one": "exp(-15^2)",
    "another branch": "asin(sin(y1)) - y1",
    "another branch of a root": "sqrt(1 - sin(y1)^2) - cos(y1)",
    "a root that turns": "sqrt(y1^2 - 4 y1 + 4) - 2 + y1",
    "steep": "tanh(300 y1) - tanh(500 y1)",
    "without a sign": "sqrt(y1^2) - y1",
    "a sign": "sign(y1) - 1",
    "nearly": "exp(y1/1000000) - 1 - y1/1000000",
    "zeros at whole numbers": " ".join(f"(y1 + {k}) (y1 - {k})" for k in range(9)),
}


@pytest.mark.slow
def test_what_is_the_same_by_a_relation_of_functions_is_right_and_no_attack_on_the_decision_is(node):
    texts = [*THE_SAME, *NOTHING.values(), *(f"({text}) b3" for text in NOTHING.values())]
    same, plain, times = np.split(marks(node, [f"{RIGHT} + {text}" for text in texts]), [6, 6 + len(NOTHING)])
    assert set(same) == {"right"}
    found = dict(zip(NOTHING, zip(plain, times, strict=True), strict=True))
    assert {
        name: each for name, each in found.items() if each[0] != each[1] or each[0] not in ("wrong", "unknown")
    } == {}


@pytest.mark.slow
def test_a_formula_stands_as_it_was_typed_complete_or_not_and_nothing_becomes_a_part_of_the_page(node):
    begun = ["a11 (", "a11 +", "y1^", "/", ")", "((y1)", "sqrt(y1", "\\frac{y1}{", "y1' =", "= y1", "|", "^^", "x < y1"]
    texts = [*begun, *(text for text in HOSTILE if text.strip() and len(text) <= LONGEST_LINE)]
    known = {"math", "mrow", "mi", "mn", "mo", "msub", "msup", "msubsup", "mover", "mfrac", "msqrt"}
    whole, *lines = by_the_page(node, [(RATE, 21, text) for text in ["b1y3 + a11 y1^2/(2 y2)", *texts]])
    for text, line in zip(texts, lines, strict=True):
        assert line["refused"] or line["mark"] == "unknown", text
        assert {part.tag for part in as_tree(line["markup"]).iter()} <= known
    tree, signs = as_tree(whole["markup"]), lines[len(begun) - 1]["markup"]
    assert "".join(tree.itertext()) == "b1\u2062y3+a11\u2062y122\u2062y2"  # the fraction needs no brackets
    assert [len(list(tree.iter(tag))) for tag in ("mfrac", "msubsup", "msub")] == [1, 1, 4]
    assert signs == "<mrow><mi>x</mi><mo>&#60;</mo><msub><mi>y</mi><mi>1</mi></msub></mrow>"


POINT = [0.2, -0.1, 0.7]
WRONG = {"rate 6 y1'": MISTAKES["wrong sign"][0]}
ALONG = "a31 y1 + a32 y2 + a33 - b3 y3"
DESKS = {
    "wrong": {"step": 6, "point": POINT, "typed": WRONG},
    "form": {"part": "form"},
    "in an earlier step": {"step": 5, "typed": {"rate 5 the velocity along Z": ALONG}},
    "its rates": {"step": 6, "typed": WRONG | {"rate 6 y2'": f"a21 y1 + a22 y2 + a23 - y2 ({ALONG}) + b2 y3"}},
    "empty": {"step": 5},
    "nowhere": {"step": 6, "point": [0.0, 0.1, 0.7], "typed": {"rate 6 y1'": "1/y1", "rate 6 y2'": "sqrt(-1 - y1^2)"}},
    "example": EXAMPLE,
    "mended": EXAMPLE | {"typed": {name: text.replace("+ b3", "- b3") for name, text in EXAMPLE["typed"].items()}},
}


@pytest.fixture(scope="module")
def answers(node):
    """Answers of the page to desks, by their names; three outputs are no picture."""
    own = derivation_desk(PerspectiveSystem(rigid(), plane((0.1, 0.2, 1.0), outputs=3)), step=6)
    desks = [own, *(derivation_desk(**settings) for settings in DESKS.values())]
    return dict(zip(["three outputs", *DESKS], answers_of_the_page(node, *desks), strict=True))


def test_the_witness_has_the_numbers_of_the_formulas(answers):
    system = system_of("affine", "pinhole")
    numbers = {s: number_of(s, system) for s in system.parameters} | dict(zip(system.coordinates, POINT, strict=True))
    true = [float(rate.subs(numbers)) for rate in system.rate[:2]]
    b3, y1, y3 = (numbers[sp.Symbol(name, real=True)] for name in ("b3", "y1", "y3"))
    picture = answers["wrong"]["picture"]
    np.testing.assert_allclose(picture["true"], true)
    np.testing.assert_allclose(picture["mine"][0], true[0] + 2 * b3 * y1 * y3)
    assert picture["mine"][1] is None
    apart = np.subtract(picture["field"]["mine"][0], picture["field"]["true"][0])
    np.testing.assert_allclose(apart, 2 * b3 * np.array(picture["field"]["places"])[:, 0] * y3, atol=1e-7)
    assert answers["form"]["picture"] is answers["three outputs"]["picture"] is None


def test_a_slip_in_an_earlier_step_bends_the_arrow_that_follows_from_it(answers):
    mine = {name: answer["picture"]["mine"] for name, answer in answers.items() if answer["picture"]}
    np.testing.assert_allclose(mine["in an earlier step"], mine["its rates"])
    assert mine["empty"] == mine["nowhere"] == [None, None]  # nothing is typed, or it has no value


def test_each_term_of_the_example_is_judged_and_the_whole_misses_by_its_slip(answers):
    parts, right = (next(iter(answers[name]["grown"].values())) for name in ("example", "mended"))
    (text,) = EXAMPLE["typed"].values()
    assert [text[: part["end"]] for part in parts][:2] == ["a13", "a13 + (a11 - a33) y1"]
    assert parts[-1]["end"] == len(text)
    assert parts[-1]["miss"] > 0.5
    assert right[-1]["miss"] < 1e-9
