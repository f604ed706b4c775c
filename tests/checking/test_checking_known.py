"""Known relations count, and so do labels and definitions: nothing that was typed is passed over."""

import pytest
from examples import AFFINE, ONE

from percept_obs import check, ibo

RIGHT = "y3' = -(a31 y1 + a32 y2 + a33) y3 - b3 y3^2"


@pytest.mark.parametrize(
    ("mine", "target", "said"),
    [
        ("y3' = -(a31 X + a32 Y + a33 Z + b3)/Z^2", AFFINE, "now write it with y1, y2, y3"),
        ("y3' = -Z'/Z^2", AFFINE, "now write out Z, Z'"),
        ("y1' = X'/Z - X Z'/Z^2", AFFINE, "now write out X, X', Z, Z'"),
        ("y1' = phi + w1 y2 + w2 y3", ONE, "now write out phi, w1, w2"),
        ("yhat1' = phi + w1 yhat2 + w2 yhat3 + G A e1", ibo(ONE), "now write out e1, phi, w1, w2"),
    ],
)
def test_a_line_with_letters_that_are_known_by_definition_is_right(mine, target, said):
    review = check(mine, target)
    assert review.right
    assert said in review.summary
    wrong = check(mine.replace("-", "+") if "-" in mine else mine.replace("phi", "2 phi"), target)
    assert wrong.right is False


def test_a_wrong_line_with_known_letters_is_explained():
    told = str(check("y3' = -(a31 X + a32 Y + a33 Z - b3)/Z^2", AFFINE).hint(3))
    assert "the sign of" in told
    assert "b3" in told


def test_a_definition_that_no_line_uses_is_asked_about():
    review = check(f"{RIGHT}\ny2d = 5 y1 - 77 b3", AFFINE)
    assert review.right is None
    assert review.summary == "The rest is right, but no line uses y2d: is it left over, or is it meant to be y2'?"
    assert check("q = a31 y1 + a32 y2 + a33\ny3' = -q y3 - b3 y3^2", AFFINE).right
    assert check(f"{RIGHT.replace('b3', 'b2')}\nq = 5", AFFINE).right is False


def test_a_line_that_says_what_a_letter_is_counts_and_a_wrong_one_does_not():
    assert check(f"y3 = 1/Z\n{RIGHT}", AFFINE).summary == "Right: y3'."
    with pytest.raises(ValueError, match="the line y3 is none of those asked for"):
        check(f"y3 = 2/Z\n{RIGHT}", AFFINE)


def test_a_part_of_a_form_under_the_name_of_another_part_is_refused():
    assert check("w = [a12 - a32 y1, b1 - b3 y1]", ONE.w).right
    assert check("[a12 - a32 y1, b1 - b3 y1]", ONE.w).right
    with pytest.raises(ValueError, match="the line g is none of those asked for: w"):
        check("g = [a12 - a32 y1, b1 - b3 y1]", ONE.w)
    assert check("g = [a12 - a32 y1, b1 - b3 y1]", ONE).right is False


def test_a_number_for_a_column_is_refused_with_the_size_of_the_column():
    with pytest.raises(ValueError, match="w has 2 entries; write it as a column"):
        check("w = b1 - b3 y1", ONE)


def test_a_wrong_line_without_values_is_explained_too():
    assert "this has no values that can be compared" in str(
        check("y1' = exp(exp(exp(exp(exp(exp(y1))))))", AFFINE).hint(3)
    )
