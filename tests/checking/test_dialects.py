"""Each dialect is rewritten to the plain form as its examples say, and what is asked back or told is told plainly."""

import pytest
from examples import AFFINE
from formula_corpus import target

from percept_obs import CannotRead, check
from percept_obs.checking.dialects import dialects, plain, symbols

EXAMPLES = [(dialect, *example) for dialect in dialects() for example in dialect.examples]
RATE = "-(a31 y1 + a32 y2 + a33) y3 - b3 y3^2"


@pytest.mark.parametrize(("dialect", "typed", "form"), EXAMPLES, ids=lambda each: getattr(each, "name", str(each)[:20]))
def test_a_dialect_is_known_and_rewritten(dialect, typed, form):
    source = symbols.rewritten(typed)
    assert dialect.mark.search(source.text)
    assert dialect.rewritten(source).text.strip() == form


@pytest.mark.parametrize(
    ("text", "left"),
    [
        ("Mit Z = 1/y3 folgt", "Z = 1/y3"),
        ("On a donc y3 = 2 pour tout t >= 0", "y3 = 2"),
        ("y3 = 2 (Vorzeichen beachten!)", "y3 = 2"),
        ("y1; import os", "y1;"),
        ("y1 if b1 else y3", "y1 if b1 else y3"),
        ("y1: 2 + 2", "y1= 2 + 2"),
        ("y3 = b1 speed y1", "y3 = b1 speed y1"),
        ("y3 = b1 y1 speed", "y3 = b1 y1 speed"),
        ("speed = b1; y3 = speed y1", "speed = b1; y3 = speed y1"),
    ],
)
def test_prose_is_what_no_formula_contains(text, left):
    source, _ = plain(text, {"y1", "y3", "b1", "Z"}.__contains__)
    assert " ".join(source.text.split()) == left
    assert len(source.origin) == len(source.text)


def test_the_dialect_is_said():
    assert check("dy3 = -(a31*y(1) + a32*y(2) + a33)*y(3) - b3*y(3)^2;", AFFINE).dialects == ("MATLAB",)
    assert check(f"y3' = {RATE}", AFFINE).dialects == ()


@pytest.mark.parametrize(
    ("text", "name", "said"),
    [
        ("(b1 + b3 y1)^2 + (b2 - b3 y2)^2 > 0", "pinhole y1+y2 condition", "the sign of"),
        ("(b1 - b3 y1)^2 + (b2 - b3 y1)^2 > 0", "pinhole y1+y2 condition", "y1 stands where y2 belongs"),
        ("(b2 - b3 y1)^2 + (b1 - b3 y2)^2 > 0", "pinhole y1+y2 condition", "are swapped"),
        ("(b1 - b3 y1)^2 + (b2 - b3 y2)^2 = 0", "pinhole y1+y2 condition", "write > 0 or != 0"),
        ("[[0, w3, -w2], [-w3, 0, w1], [w2, -w1, 0]]", "ledger chwa2019 (4)", "transpose of the one asked for"),
        ("[[0, -w3, w2], [w3, 0, -w1], [-w2, -w1, 0]]", "ledger chwa2019 (4)", "entry (3, 2)"),
        ("2x = 5y", "formula x = 2y", "5 y/2 should be 2 y: the factor is wrong"),
        ("e1 = yhat1 - y1; e1' = (b1 - b3 y1) e3 + G A e1", "ibo", "the sign of"),
    ],
)
def test_a_slip_is_named(text, name, said):
    review = check(text, target(name))
    assert review.right is False
    assert said in str(review.hint(3))


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("b1 != b3 y1 or b2 != b3 y2", "pinhole y1+y2 condition"),
        ("[b1 - b3 y1, b2 - b3 y2] != 0", "pinhole y1+y2 condition"),
        ("|b1 - b3 y1| + |b2 - b3 y2| > 0", "pinhole y1+y2 condition"),
        ("sqrt((b1 - b3 y1)^2 + (b2 - b3 y2)^2) > 0", "pinhole y1+y2 condition"),
        ("e1 = yhat1 - y1; e3 = yhat3 - y3; e1' = (b1 - b3 y1) e3 - G A e1", "ibo"),
        ("2x = 4y", "formula x = 2y"),
        ("f = max(y1, y2)", "formula f = (y1 + y2 + |y1 - y2|)/2"),
        (RATE, "pinhole"),
    ],
)
def test_another_form_is_right(text, name):
    assert check(text, target(name)).right


def test_the_sign_of_an_error_is_the_writers():
    review = check("e1 = yhat1 - y1; e3 = yhat3 - y3; e1' = (b1 - b3 y1) e3 - G A e1", target("ibo"))
    assert "with your error, the estimate less the truth" in review.summary


@pytest.mark.parametrize(
    ("text", "name", "where"),
    [("log(y1) + log(y2)", "log(y1 y2)", "y1 > 0"), ("sqrt(y1) sqrt(y2)", "sqrt(y1 y2)", "y1 > 0")],
)
def test_what_has_no_value_everywhere_says_where_it_is_right(text, name, where):
    review = check(text, name)
    assert review.right
    assert where in review.summary


def test_what_is_not_read_is_shown_with_what_would_be():
    with pytest.raises(CannotRead, match=r"\\fraq is not read, did you mean \\frac\?"):
        check(r"y3' = \fraq{1}{2}", AFFINE)
    with pytest.raises(CannotRead, match="the line V' is not asked for here; asked for are"):
        check(r"\dot V = -y3^2", AFFINE)
