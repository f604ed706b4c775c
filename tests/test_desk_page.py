"""The page judges lines by itself, and as Python does: with the same grammar, by values at points that nobody knows."""

from collections import Counter
from html import unescape

import pytest
from desk_formulas import by_python, by_the_page, lines
from sample_sizes import sampled

pytestmark = pytest.mark.node

RATE, SPHERE = "affine pinhole, rate", "affine sphere, rate"
FORMULAS = sampled(240, 10_000)
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
    shown = [(one["markup"], unescape(other["markup"])) for one, other in zip(python, page, strict=True) if one["mark"]]
    assert [pair for pair in shown if unescape(pair[0]) != pair[1]] == []
    counted = Counter(line["mark"] for line in python)
    print(counted)
    assert min(counted["right"], counted["wrong"], counted[""]) > FORMULAS / 20  # all three are tried


RIGHT = "a11 y1 + a12 y2 + a13 + b1 y3 - y1 (a31 y1 + a32 y2 + a33 + b3 y3)"


@pytest.mark.parametrize(
    "text",
    [
        f"{RIGHT} + sin(y1)^2 + cos(y1)^2 - 1",
        f"{RIGHT} + cosh(y1 y2)^2 - sinh(y1 y2)^2 - 1",
        f"{RIGHT} + sqrt(y1^2 y2^2) - |y1| |y2|".replace("|y1|", "abs(y1)").replace("|y2|", "abs(y2)"),
        f"{RIGHT} + sqrt(1 + y1^2) sqrt(1 + y1^2) - 1 - y1^2",
        f"{RIGHT} + sin(2 y1) - 2 sin(y1) cos(y1)",
        f"{RIGHT} + exp(y1 + y2) - exp(y1) exp(y2)",
    ],
)
def test_what_is_the_same_by_a_relation_of_functions_is_right(node, text):
    assert marks(node, [text]) == ["right"]


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


@pytest.mark.parametrize("name", NOTHING)
def test_no_attack_on_the_decision_is_called_right(node, name):
    assert marks(node, [f"{RIGHT} + {NOTHING[name]}", f"{RIGHT} + ({NOTHING[name]}) b3"]) in (
        [["wrong"] * 2, ["unknown"] * 2]
    )
