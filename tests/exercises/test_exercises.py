"""Answers to exercises are judged and dots are no answer; students' copies hold no solution and no answer."""

import ast
import math
import re
import sys
from types import SimpleNamespace

import pytest

from percept_obs import PerspectiveSystem, affine, pinhole
from percept_obs.exercises import (
    COPIES,
    NotInstalled,
    choose,
    derive,
    model_answer,
    needs,
    reach,
    stub,
    students_copy,
)
from percept_obs.exercises.models import answers_in, key_of, notebooks

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
    own = "*Answer in the cell below, in your own words; then it shows a model answer.*"
    first, second = (
        f'from percept_obs.exercises import model_answer\n\nmodel_answer(..., "{key_of(answer)}")'
        "  # your answer, in quotes, for the dots"
        for answer in ("So.", "Because.")
    )
    assert sources(students_copy(NOTEBOOK)) == [
        f"**Question.** Why?\n\n{own}",
        first,
        "Go on.",
        "Derive it.",
        "<details><summary>Hint</summary>\n\nLook.\n\n</details>",
        "mine = ...  # your answer",
        "mine",
        own,
        second,
    ]


def test_a_model_answer_follows_an_answer_of_ones_own():
    for notebook in notebooks().values():
        copy = students_copy(notebook)
        assert len({cell["id"] for cell in copy["cells"]}) == len(copy["cells"])
        asked = [re.search(r'model_answer\(\.\.\., "(\w+)"', text) for text in sources(copy)]
        expected = [answer for cell in notebook["cells"] for answer in answers_in(cell)]
        assert expected
        for found, answer in zip(filter(None, asked), expected, strict=True):
            assert answer not in "\n".join(sources(copy))
            for none in (..., "", "...", 7):
                assert model_answer(none, found[1]).reply.startswith("Answer first")
            assert answer.removeprefix("**A model answer.** ") in str(model_answer("No", found[1]))
    assert "another version" in str(model_answer("It stands still there.", "0"))


@pytest.mark.parametrize(
    ("attempt", "said"),
    [
        (lambda: choose("e", "Seen.", a=True, b=False), "'e' is no option. Choose one of 'a', 'b'."),
        (lambda: reach("8", lambda gain: {"time": 6 / gain}, time=1), "a number stands without quotes"),
        (lambda: reach(0, lambda gain: {"time": 6 / gain}, time=1), "cannot run with 0"),
        (lambda: derive("y3' = q y3", SYSTEM, "y3'"), '"q" is no letter here'),
        (lambda: derive(None, SYSTEM, "y3'"), "a NoneType is no formula"),
    ],
)
def test_another_kind_of_answer_is_answered_in_a_sentence(attempt, said):
    found = attempt()
    assert found.right is None
    assert said in str(found)
    assert "A hint needs an answer first." in str(found.hint(1))


def test_a_task_that_asks_one_line_takes_the_right_hand_side_alone():
    assert derive("-y3 (a31 y1 + a32 y2 + a33 + b3 y3)", SYSTEM, "y3'").right


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
    for options in ({"a": False, "b": False}, {"a": True, "b": True}):
        with pytest.raises(ValueError, match="exactly one option"):
            choose("a", "Seen.", **options)


@pytest.mark.parametrize(("time", "right"), [(1.9, True), (2.1, False), (math.inf, False), (math.nan, False)])
def test_gains_reach_what_is_asked_for(time, right):
    attempt = reach(5, lambda gain: {"time": time, "error": 0.1, "more": 9.0}, time=2, error=0.2)
    assert attempt.right is right
    assert f"time {time:.3g} (2 is allowed)" in str(attempt)
    with pytest.raises(ValueError, match="gives no number rms; it gives error"):
        reach(5, lambda gain: {"error": 1.0}, rms=2)


def test_an_attempt_shows_itself():
    assert choose("a", "Seen.", a=True)._repr_markdown_() == "✓ Yes, a. Seen."
    assert choose("a", "Seen.", a=False, b=True)._repr_markdown_().startswith("✗ You said a")
    assert not choose(..., "Seen.", a=True)._repr_markdown_().startswith(("✓", "✗"))


def test_where_a_module_is_missing_only_what_installs_it_runs(monkeypatch):
    shell = SimpleNamespace(ast_transformers=[])
    monkeypatch.setattr("IPython.get_ipython", lambda: shell)
    with pytest.raises(NotInstalled, match="no_such_module is missing"):
        needs("math", "no_such_module")
    (ended,) = shell.ast_transformers
    for written, runs in (("1 / 0", False), ("get_ipython().run_line_magic('pip', 'install it')", True)):
        cell = ast.parse(written)
        assert (ended.visit(cell) is cell) is runs
    monkeypatch.setitem(sys.modules, "no_such_module", SimpleNamespace(__spec__="installed"))
    assert ended.visit(cell := ast.parse("1 / 0")) is cell
