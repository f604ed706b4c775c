"""Answers to exercises are judged and dots are no answer; students' copies hold no solution and no answer."""

import math

import pytest

from percept_obs import PerspectiveSystem, affine, pinhole
from percept_obs.exercises import COPIES, choose, derive, reach, stub, students_copy

SYSTEM = PerspectiveSystem(affine(), pinhole())
THIRD = "y3' = -y3 (a31 y1 + a32 y2 + a33 + b3 y3)"


def cell(kind, source, *tags):
    return {"cell_type": kind, "metadata": {"tags": list(tags)} if tags else {}, "source": source.splitlines(True)}


NOTEBOOK = {
    "metadata": {},
    "cells": [
        cell("markdown", "**Question.** Why?\n\n<details><summary>Answer</summary>\n\nSo.\n\n</details>\n\nGo on.\n"),
        cell("markdown", "Derive it.", "exercise"),
        cell("markdown", "<details><summary>Hint</summary>\n\nLook.\n\n</details>", "hint"),
        cell("code", "# the reason\nfactor = 2\nmine = 3 * factor", "solution"),
        cell("code", "mine", "exercise"),
        cell("markdown", "Because.", "solution"),
    ],
}


def sources(notebook):
    return ["".join(cell["source"]) for cell in notebook["cells"]]


def test_students_get_stubs_hints_and_no_answers():
    assert sources(students_copy(NOTEBOOK)) == [
        "**Question.** Why?\n\n*Write your answer here, then compare it with the teachers' copy.*\n\nGo on.\n",
        "Derive it.",
        "<details><summary>Hint</summary>\n\nLook.\n\n</details>",
        "mine = ...  # your answer",
        "mine",
        "*Write your answer here.*",
    ]


def test_teachers_get_everything_and_copying_changes_nothing():
    before = sources(NOTEBOOK)
    students_copy(NOTEBOOK)
    assert sources(COPIES["teachers"](NOTEBOOK)) == sources(NOTEBOOK) == before


@pytest.mark.parametrize("solution", ["", "print(1)", "a.b = 1", "a = 1\na"])
def test_a_solution_without_a_name_for_its_answer_is_refused(solution):
    with pytest.raises(ValueError, match="giving the answer a name"):
        stub(solution)


def test_dots_are_no_answer():
    never = {"a": True, "b": False}
    for attempt in (derive(..., SYSTEM), choose(..., "Seen.", **never), reach(..., lambda gain: {}, error=1)):
        assert attempt.right is None
        assert "Seen" not in str(attempt)


def test_a_formula_is_reviewed_and_a_missing_line_is_asked_for():
    assert derive(THIRD, SYSTEM, "y3'").right is True
    wrong = derive(THIRD.replace("+ b3", "- b3"), SYSTEM, "y3'")
    assert wrong.right is False
    assert "sign" in str(wrong.hint(3))
    other = derive(THIRD, SYSTEM, "y1'")
    assert other.right is False
    assert "y1'" in str(other)
    assert "y1', y2'" in str(derive(THIRD, SYSTEM))


def test_a_prediction_is_compared_with_the_experiment():
    assert choose(" B", "Seen.", a=False, b=True).right is True
    wrong = choose("a", "Seen.", a=False, b=True)
    assert wrong.right is False
    assert str(wrong) == "You said a, the experiment says b. Seen."
    with pytest.raises(ValueError, match="'c' is no option; choose one of 'a', 'b'"):
        choose("c", "Seen.", a=False, b=True)
    for options in ({"a": False, "b": False}, {"a": True, "b": True}):
        with pytest.raises(ValueError, match="exactly one option"):
            choose("a", "Seen.", **options)


@pytest.mark.parametrize(("time", "right"), [(1.9, True), (2.1, False), (math.inf, False), (math.nan, False)])
def test_gains_reach_what_is_asked_for(time, right):
    attempt = reach(5, lambda gain: {"time": time, "error": 0.1, "more": 9.0}, time=2, error=0.2)
    assert attempt.right is right
    assert f"time {time:.3g} (2 is allowed)" in str(attempt)
    with pytest.raises(ValueError, match="gives no rms; it gives error"):
        reach(5, lambda gain: {"error": 1.0}, rms=2)


def test_an_attempt_shows_itself():
    assert choose("a", "Seen.", a=True)._repr_markdown_() == "✓ Yes, a. Seen."
    assert choose("a", "Seen.", a=False, b=True)._repr_markdown_().startswith("✗ You said a")
    assert not choose(..., "Seen.", a=True)._repr_markdown_().startswith(("✓", "✗"))
