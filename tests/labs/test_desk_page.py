"""The page judges plain lines by numbers as Python does, and what each term does to a picture is seen in it."""

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
import sympy as sp
from desk_formulas import answers_of_the_page, in_the_page, lines, sheets
from hostile_formulas import HOSTILE
from sample_sizes import sampled
from test_desk import MISTAKES, as_tree

from percept_obs import PerspectiveSystem, plane, rigid
from percept_obs.checking.explaining import plain
from percept_obs.compile import in_letters
from percept_obs.labs import derivation_desk
from percept_obs.labs.desk.answers import MARKS, SAID, alone
from percept_obs.labs.desk.settings import EXAMPLE
from percept_obs.labs.desk.systems import INVERSE, numbers_of, system_of

pytestmark = pytest.mark.node

RATE, ROW = "affine pinhole, rate", 21
RIGHT = "a11 y1 + a12 y2 + a13 + b1 y3 - y1 (a31 y1 + a32 y2 + a33 + b3 y3)"
((KEY, TYPED),) = EXAMPLE["typed"].items()


def marks(node, texts):
    """The marks of texts for the line of y1'; "unread" for what is no plain arithmetic."""
    found = in_the_page(node, lines=[(RATE, ROW, text) for text in texts])["judged"]
    return [line["mark"] if line["read"] else "unread" for line in found]


@pytest.mark.slow
def test_python_and_the_page_judge_plain_lines_alike_and_no_wrong_one_is_right(node):
    chosen = list(lines(sampled(60, 10_000), seed=26))
    page = in_the_page(node, lines=[(name, row, text) for _, name, row, text, _ in chosen])["judged"]
    python = [MARKS[alone(sheet, row, text).verdict] for sheet, _, row, text, _ in chosen]
    told = zip(chosen, python, page, strict=True)
    assert [(line[1:4], one, other["mark"]) for line, one, other in told if one != other["mark"]] == []
    assert {mark for (*_, slip), mark in zip(chosen, python, strict=True) if not slip} == {"right"}
    assert min(Counter(python)["right"], Counter(python)["wrong"]) > len(chosen) / 4
    assert {kind for *_, kind in chosen} >= {"sign", "factor", "letter", "dropped"}  # an index is a letter
    for piece in (piece for line in page for piece in line["pieces"]):
        as_tree(piece)  # is well formed


THE_SAME = ["y1^(-2) y1^2 - 1", "sin(y1)^2 + cos(y1)^2 - 1"]
THE_SAME += ["(y1 + y2)^2 - y1^2 - 2 y1 y2 - y2^2", "exp(y1 + y2) - exp(y1) exp(y2)"]
NOT_NOTHING = {
    "far too small": "0.000000001 * 0.000000001 y1",
    "far away": "exp(-100 - y1^2)",
    "another branch of a root": "sqrt(1 - sin(y1)^2) - cos(y1)",
    "a root that turns far away": "sqrt(y1^2 - 2000 y1 + 1000000) - 1000 + y1",
    "without a sign": "sqrt(y1^2) - y1",
    "zeros at whole numbers": " ".join(f"(y1 + {k}) (y1 - {k})" for k in range(9)),
}


def test_what_is_the_same_is_right_and_no_attack_on_the_numbers_is(node):
    assert set(marks(node, [f"{RIGHT} + {text}" for text in THE_SAME])) == {"right"}
    for factor in ("", " b3"):
        found = marks(node, [f"{RIGHT} + ({text}){factor}" for text in NOT_NOTHING.values()])
        assert set(found) <= {"wrong", "unknown"}, dict(zip(NOT_NOTHING, found, strict=True))


def test_python_reads_what_is_no_plain_arithmetic_and_the_page_says_so(node):
    texts = ["\\frac{y1}{2}", "y1*np.sin(y2)", "y_{1}", "y1²", "the rate of y1", "a/b c", "y1 = y2", "constructor"]
    texts += ["__proto__", "toString", "y1.constructor", "sin y1", "2 3 y1", "y1^y2"]
    texts += ["y1^(y2)", "y1^(1/0)", "y1^(2-3)"]
    assert set(marks(node, texts)) == {"unread"}
    desks = [derivation_desk(step=6, typed={KEY: text}) for text in [*texts, "a13 + (", RIGHT]]
    found = [answer["lines"][0].get("refusal") for answer in answers_of_the_page(node, *desks)]
    assert found == [SAID["python"]] * len(texts) + [SAID["unfinished"], None]


def test_hostile_texts_are_answered_and_stop_early(node):
    many = [
        "(" * 4000,
        "y1" * 2000,
        "(y1+y2)" * 600,
        "y1^" * 1500,
        "+".join(["y1"] * 1500),
        "sin(" * 30 + "y1" + ")" * 30,
    ]
    found = marks(node, [RIGHT, *many, *(text for text in HOSTILE if text.strip())])
    assert found[0] == "right"
    assert set(found[1:]) == {"unread", "wrong", "unknown"}


SLIPS = {
    "sign": (TYPED, "+b3 y1", "b3 y1 has the wrong sign"),
    "letter": (RIGHT.replace("a12", "a21"), "+a21 y2", "a21 y2 does not belong here"),
    "factor": (RIGHT.replace("a13", "2 a13"), "+2 a13", "2 a13 is 2 times what it should be"),
    "in front of a bracket": (RIGHT.replace("y1 (", "y2 ("), "−y2 (a31 y1+a32 y2+a33+b3 y3)", "does not belong here"),
}


@pytest.mark.parametrize("name", SLIPS)
def test_the_page_marks_the_wrong_term_and_says_what_is_wrong(node, name):
    wrong, marked, said = SLIPS[name]
    (answer,) = answers_of_the_page(node, derivation_desk(step=6, typed={KEY: wrong}))
    (line, *_) = answer["lines"]
    slips = [node for piece in line["pieces"] for node in as_tree(piece).iter("mrow") if node.get("class") == "slip"]
    assert [letters_of(slip) for slip in slips] == [marked]
    assert said in "".join(p["text"] if "text" in p else letters_of(as_tree(p["math"])) for p in line["told"][0])


def letters_of(tree):
    return "".join(tree.itertext()).replace("\u2062", " ")


POINT = [0.2, -0.1, 0.7]
WRONG = {KEY: MISTAKES["wrong sign"][0]}
ALONG = "a31 y1 + a32 y2 + a33 - b3 y3"
DESKS = {
    "wrong": {"step": 6, "point": POINT, "typed": WRONG},
    "in an earlier step": {"step": 5, "typed": {"rate 5 the velocity along Z": ALONG}},
    "its rates": {"step": 6, "typed": WRONG | {"rate 6 y2'": f"a21 y1 + a22 y2 + a23 - y2 ({ALONG}) + b2 y3"}},
    "nowhere": {"step": 6, "point": [0.0, 0.1, 0.7], "typed": {KEY: "1/y1", "rate 6 y2'": "sqrt(-1 - y1^2)"}},
}


def test_the_picture_has_the_numbers_of_the_formulas(node):
    own = derivation_desk(PerspectiveSystem(rigid(), plane((0.1, 0.2, 1.0), outputs=3)), step=6)
    found = answers_of_the_page(node, own, *(derivation_desk(**settings) for settings in DESKS.values()))
    answers = dict(zip(["three outputs", *DESKS], found, strict=True))
    system = system_of("affine", "pinhole")
    numbers = numbers_of(system) | dict(zip(system.coordinates, POINT, strict=True))
    b3, y1, y3 = (numbers[sp.Symbol(name, real=True)] for name in ("b3", "y1", "y3"))
    picture = answers["wrong"]["picture"]
    np.testing.assert_allclose(picture["true"], [float(rate.subs(numbers)) for rate in system.rate[:2]])
    np.testing.assert_allclose(picture["mine"][0], picture["true"][0] + 2 * b3 * y1 * y3)
    apart = np.subtract(picture["field"]["mine"][0], picture["field"]["true"][0])
    np.testing.assert_allclose(apart, 2 * b3 * np.array(picture["field"]["places"])[:, 0] * y3, atol=1e-7)
    assert answers["three outputs"]["picture"] is None
    mine = {name: answer["picture"]["mine"] for name, answer in answers.items() if answer["picture"]}
    np.testing.assert_allclose(mine["in an earlier step"], mine["its rates"])  # it bends the arrow that follows
    assert mine["nowhere"] == [None, None]


def falls(misses):
    """Return True if a line comes nearer with each of its terms; nothing typed misses by all."""
    return all(after < before for before, after in pairwise([1, *misses]))


def test_the_example_comes_nearer_with_each_right_term_and_jumps_away_at_its_slip(node):
    texts = (TYPED.replace("+ b3", "- b3"), TYPED)
    mended, wrong = in_the_page(node, grown=[(RATE, ROW, text, EXAMPLE["point"]) for text in texts])["misses"]
    assert falls(mended) is falls(wrong[:-1]) is True
    assert mended[-1] < 1e-9 < 1.2 * wrong[-2] < wrong[-1]


def image_lines():
    """Yield every line of an image's motion that is drawn, as name, row and terms in the order of print."""
    for name, sheet in sheets().items():
        for row, line in enumerate(sheet.goal.lines):
            if line.name in sheet.image and len(sheet.image) == 2:
                formula = in_letters(line.formula)
                yield name, row, formula.as_ordered_terms()
                if "pinhole" in name or "chained" in name:  # of other surfaces terms cancel when multiplied out
                    yield name, row, sp.expand(formula).as_ordered_terms()


def typed(name, row, terms):
    return name, row, " + ".join(f"({plain(term)})" for term in terms), [0, 0, INVERSE]


@pytest.mark.slow
def test_every_true_line_comes_nearer_with_each_term_and_jumps_away_at_each_turned_sign(node):
    true = list(image_lines())
    turned = [(k, typed(*of, [*terms[:k], -terms[k]])) for *of, terms in true for k in range(len(terms))]
    asked = [*(typed(*line) for line in true), *(line for _, line in turned)]
    found = in_the_page(node, grown=asked)["misses"]
    fall = [falls(misses) for misses in found[: len(true)]]
    jump = [misses[k] > [1, *misses][k] for (k, _), misses in zip(turned, found[len(true) :], strict=True)]
    print(f"{sum(fall)} of {len(fall)} lines fall with each term; {sum(jump)} of {len(jump)} turned signs jump")
    assert len(fall) > sampled(3, 25)
    assert all([*fall, *jump])
