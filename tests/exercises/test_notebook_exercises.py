"""Each notebook says what it teaches and has exercises of four kinds, whose students' copies run as the trials do."""

import ast
from contextlib import nullcontext

import pytest
from IPython.core.interactiveshell import InteractiveShell
from mistakes import MISTAKES
from notebook_exercises import answer_name, names_read, read, source, tagged, trials
from places import NOTEBOOKS
from traitlets.config import Config

from percept_obs.exercises import students_copy

NAMES = sorted(path.stem for path in NOTEBOOKS.glob("*.ipynb"))


@pytest.fixture(params=NAMES)
def notebook(request):
    return read(f"{request.param}.ipynb")


def test_goals_time_and_needs_stand_at_the_top(notebook):
    assert notebook["cells"][1]["id"] == "goals"
    for begin in ("**You will learn**", "**Time:** about", "**You need**"):
        assert begin in source(notebook, 1)


def test_there_are_exercises_of_four_kinds(notebook):
    checks = [source(notebook, k) for k in tagged(notebook, "exercise", "code")]
    for kind in ("derive(", "choose(", "reach("):
        assert any(kind in check for check in checks), kind
    assert tagged(notebook, "solution", "markdown")
    assert tagged(notebook, "hint", "markdown")


def test_hints_are_folded_and_only_hints_are_in_an_exercise(notebook):
    for k in tagged(notebook, "hint", "markdown"):
        assert source(notebook, k).startswith("<details><summary>Hint</summary>\n\n")
        assert source(notebook, k).rstrip().endswith("</details>")
    for k in tagged(notebook, "exercise", "markdown"):
        assert "<details>" not in source(notebook, k)


def test_a_check_follows_each_solution_and_nothing_else_reads_an_answer(notebook):
    checks = tagged(notebook, "exercise", "code")
    solutions = tagged(notebook, "solution", "code")
    assert checks == [k + 1 for k in solutions]
    programs = [k for k, cell in enumerate(notebook["cells"]) if cell["cell_type"] == "code"]
    for k in solutions:
        assert isinstance(ast.parse(source(notebook, k + 1)).body[-1], ast.Expr), "it ends with what it shows"
        assigned = {n.id for n in ast.walk(ast.parse(source(notebook, k))) if isinstance(n, ast.Name)}
        assigned -= names_read(source(notebook, k)) - {answer_name(source(notebook, k))}
        assert answer_name(source(notebook, k)) in names_read(source(notebook, k + 1))
        for other in set(programs) - set(checks) - set(solutions):
            assert not assigned & names_read(source(notebook, other))


@pytest.mark.parametrize("name", NAMES)
def test_each_solution_has_three_mistakes(name):
    notebook = read(f"{name}.ipynb")
    solutions = {notebook["cells"][k]["id"] for k in tagged(notebook, "solution", "code")}
    assert set(MISTAKES[name]) == solutions
    assert all(len(mistakes) >= 3 for mistakes in MISTAKES[name].values())


def test_students_copies_hold_no_solution(notebook):
    copy = students_copy(notebook)
    text = "\n".join(source(copy, k) for k in range(len(copy["cells"])))
    for k in tagged(notebook, "solution", "code") + tagged(notebook, "solution", "markdown"):
        assert source(notebook, k) not in text
    assert "<summary>Answer" not in text


@pytest.mark.parametrize(
    ("check", "error", "message"),
    [
        ("reach(mine, lambda m: {'off': abs(m - 5)}, off=1)", None, None),
        ("reach(mine, lambda m: {'off': abs(m - 5)}, off=9)", AssertionError, "^mine = 3$"),  # a mistake passes
        ("reach(mine, lambda m: {'off': abs(m - 5)}, off=-1)", AssertionError, "^mine$"),  # the solution does not
        ("reach(mine + 0, lambda m: {'off': abs(m - 5)}, off=1)", TypeError, None),  # the stub raises
    ],
)
def test_a_trial_can_fail(check, error, message):
    cell = {"cell_type": "code", "id": "gain", "metadata": {"tags": ["solution"]}, "source": "mine = 5"}
    checked = cell | {"metadata": {}, "source": f"from percept_obs.exercises import reach\n{check}"}
    notebook = {"cells": [cell, checked]}
    shell = InteractiveShell(config=Config({"HistoryManager": {"enabled": False}}))
    with pytest.raises(error, match=message) if error else nullcontext():
        for program in (cell["source"], checked["source"], *trials(notebook, {"gain": [3, 7, 12]})[1]):
            shell.run_cell(program, store_history=True).raise_error()
