"""A name gives the same tasks everywhere and two names hardly ever do; a class is marked without running its code."""

import json
import os
import re
import sys
from collections import Counter
from datetime import datetime

import pandas as pd
import pytest
from course_class import STUDENTS, at_ends, differences, hand_out, solved

from percept_obs import cli
from percept_obs.checking import check
from percept_obs.exercises import Attempt, attempts, choose, derive, individual, students_copy, tally
from percept_obs.exercises.collecting import collect, harmless, literal, said_in
from percept_obs.exercises.individual import OURS
from percept_obs.exercises.marking import lesson, marks, run
from percept_obs.exercises.models import notebooks
from percept_obs.site.exam import exam

START = "00_start.ipynb"
ALIKE = {"05 which-velocity-task", "08 which-step-task"}
"""Tasks with too few versions: where an expression is zero, which a factor does not change, and the name of a slip."""


def exercises(notebook):
    """The cells of each exercise of a notebook, by the name of its task's cell; no questions in words."""
    found, task = {}, []
    for cell in notebook["cells"]:
        tags = cell["metadata"].get("tags", ())
        if cell["cell_type"] == "markdown" and "exercise" in tags:
            task = found.setdefault(cell["id"], [])
        if {"exercise", "hint", "solution"} & set(tags):
            task.append(cell)
    return {name: cells for name, cells in found.items() if any(cell["cell_type"] == "code" for cell in cells)}


def source(notebook, name):
    return next("".join(cell["source"]) for cell in notebook["cells"] if cell.get("id") == name)


PINNED = {
    "Ada": "-6 11 c 11 0.01025",
    " ada": "-6 11 c 11 0.01025",
    "Ben": "8 3 d 9 0.00875",
    "Zoë": "-1 11 b 8.8 0.00934",
    "Zoe\u0308": "-1 11 b 8.8 0.00934",
    "李明": "4 5 b 8.2 0.00827",
    "4711": "-4 -5 c 10.1 0.01012",
    "O'Neil": "-8 5 d 8.5 0.00836",
    "José": "12 -8 d 8.7 0.00842",
    "Ангелина": "6 -11 a 10.5 0.00905",
}


@pytest.mark.parametrize("student", PINNED)
def test_a_name_gives_the_same_tasks_on_every_machine_and_in_every_version(student):
    own = individual(notebooks()[START], student)
    rate = re.search(r"\((-?\d+) b1\) y3 - \((-?\d+) b3\) y1 y3", source(own, "quotient")).groups()
    choice = re.search(r'"(\w)"', source(own, "second")).groups()
    numbers = (
        re.search(r"within ([\d.]+) %", source(own, "second-task"))[1],
        re.search(r"Uniform\(([\d.]+)\)", source(own, "gain-check"))[1],
    )
    assert " ".join((*rate, *choice, *numbers)) == PINNED[student]


def test_the_rules_of_a_task_name_places_that_are_there():
    for name, notebook in notebooks().items():
        for task, cells in exercises(notebook).items():
            text = "\n".join("".join(cell["source"]) for cell in cells)
            rules = cells[0]["metadata"].get(OURS, {})
            assert rules or f"{name[:2]} {task}" in ALIKE, task
            for number, (low, high, _, *places) in rules.get("numbers", {}).items():
                assert float(low) <= float(number) <= float(high)
                assert all(place.replace("{}", number) in text for place in places), (task, number)
            solution = next("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
            assert all(re.search(rf"\b{letter}\b", solution) for letter in rules.get("letters", {})), task


@pytest.mark.slow
def test_two_of_forty_students_share_a_task_in_under_one_of_a_hundred_pairs():
    assert len(set(STUDENTS)) == 40
    for name, notebook in notebooks().items():
        own = [exercises(individual(notebook, student)) for student in STUDENTS]
        for task in own[0]:
            counts = Counter(json.dumps([cell["source"] for cell in each[task]]) for each in own).values()
            shared = sum(count * (count - 1) // 2 for count in counts)
            assert (shared < 780 / 100) is (f"{name[:2]} {task}" not in ALIKE), (name, task, shared)


@pytest.mark.slow
@pytest.mark.parametrize("name", [START, "12_the_limit.ipynb", "13_maps_and_basins.ipynb"])
@pytest.mark.parametrize("end", [0, -1])
def test_own_solutions_pass_own_checks_at_both_ends_of_every_range(name, end, monkeypatch):
    shipped = notebooks()[name]
    names = lesson(shipped)
    monkeypatch.setattr(sys.modules["percept_obs.exercises.individual"], "drawn", at_ends(end))
    own = individual(shipped, "Ada")
    assert [task for task, _, reply in solved(own, names) if not reply.right] == []
    assert own["cells"] != shipped["cells"]


def test_letters_with_factors_are_derived_and_others_refused():
    target = "f = G w + b"
    assert derive("f = 3 G w - 2 b", target, letters={"G": 3, "b": -2}).right
    wrong = derive("f = 3 G w + 2 b", target, letters={"G": 3, "b": -2})
    assert wrong.right is False
    assert "sign" in str(wrong.hint(3))
    with pytest.raises(ValueError, match="an empty name"):
        individual(notebooks()[START], "  ")


def test_attempts_and_hints_are_counted_and_dots_are_none(monkeypatch):
    monkeypatch.setattr(attempts, "_COUNTS", {})
    assert "attempt" not in tally(choose(..., "Seen.", a=True), "t")._repr_markdown_()
    tally(Attempt(False, "No."), "t")
    reply = tally(check("y1' = b1 y1", "y1' = b1 y1 + b2"), "t")
    assert reply.right is False
    assert attempts.WRITTEN.findall(reply.hint(2)._repr_markdown_()) == [("t", "2", "2", "0")]
    assert attempts.WRITTEN.findall(tally(Attempt(True, "Yes."), "other")._repr_markdown_()) == [
        ("other", "1", "0", "0")
    ]


@pytest.mark.parametrize(
    ("cell", "value"),
    [
        ("gain = 8", 8),
        ("gain = 3\ngain = {'gain': -0.5}", {"gain": -0.5}),
        ('# mine\ngain = "y1\' = b1"  # done', "y1' = b1"),
        ("gain = ...", ...),
        ("", ...),
        ("other = 8", ...),
        ("gain = 2 * 4", None),
        ("gain = open('x', 'w')", None),
        ("gain = f'{1}'", None),
    ],
)
def test_an_answer_is_the_last_literal_of_its_cell(cell, value):
    assert literal(cell, "gain") == value


@pytest.mark.parametrize("cell", ["!touch x", "gain = (", "\x00", "gain = " + "(" * 900, "x" * 5000])
def test_a_cell_that_cannot_be_read_is_refused(cell):
    with pytest.raises(ValueError, match="is no Python" if len(cell) < 5000 else "more than 4000 characters"):
        literal(cell, "gain")


def test_a_sentence_is_read_and_no_spreadsheet_takes_it_for_a_formula():
    assert said_in('model_answer("Only" " motion.", "8a6c4be0")') == "Only motion."
    assert said_in("model_answer()") == said_in("model_answer(..., '8')") == ""
    for cell, why in (("model_answer(str(1), '8')", "no plain text"), ("!x", "is no Python")):
        with pytest.raises(ValueError, match=why):
            said_in(cell)
    assert [harmless(entry) for entry in ("=1+1", "@x", "so", -3)] == ["'=1+1", "'@x", "so", -3]


@pytest.mark.slow
def test_a_class_gets_the_marks_that_were_put_in_and_nothing_of_it_runs(tmp_path, capsys):
    folder, mark, roster = tmp_path / "class", tmp_path / "intruder", tmp_path / "roster.csv"
    given, expected = hand_out(folder, [START], STUDENTS[:20], mark=mark)
    os.utime(folder / "Ada" / START, (0, datetime(2026, 3, 1, 15).timestamp()))
    rows = [f"{name}, , {'2026-03-01T12:00' if name == 'Ada' else ''}" for name in STUDENTS[:19]]
    roster.write_text("\n".join(["student,folder,due", *rows, "Missing,,"]), encoding="utf-8")
    output = tmp_path / "marks.csv"
    command = ["collect", str(folder), "-o", str(output), "--roster", str(roster)]
    assert cli.main(command) == 0
    assert capsys.readouterr().out == f"18 yes, 1 late, 1 missing, 1 yes, not in the roster: see {output}\n"
    table = pd.read_csv(output, keep_default_na=False, encoding="utf-8-sig")
    assert not mark.exists()
    assert differences(table, expected) == []
    rows = table.set_index("student")
    assert rows.loc["Ada", "handed in"] == "late by 3.0 h"
    assert rows.loc["Missing", "handed in"] == rows.loc["Missing", "00 gain"] == "missing"
    assert rows.loc[STUDENTS[19], "handed in"] == "yes, not in the roster"
    for student, kind in given.items():
        row = rows.loc[student]
        assert row["copy"] == ("00: of " + student + "'s friend" if kind == "copied" else "00: own")
        assert bool(row["altered"]) is (kind in ("altered", "copied"))
        assert ("broken.ipynb" in row["faults"] and "endless.ipynb" in row["faults"]) is (kind == "hostile")
        assert row["right"] == sum(row[f"00 {task}"] == "right" for task in ("quotient", "second", "gain"))
        assert row["attempts"] == (6 if kind == "altered" else 0)
        assert row["00 one-picture text"].startswith("'=cmd" if kind == "hostile" else "Only motion")
    (points,) = [name for name in table if name.startswith("00 one-picture: all points")]
    table.assign(**{points: "2", "seen on": "Monday"}).to_csv(output, index=False, encoding="utf-8-sig")
    assert cli.main(command) == 0
    again = pd.read_csv(output, dtype=str, keep_default_na=False, encoding="utf-8-sig")
    assert set(again[points]) == {"2"}
    assert set(again["seen on"]) == {"Monday"}


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="has no such limits")
def test_code_runs_only_if_asked_for_and_with_limits(tmp_path):
    shipped, mark = notebooks()[START], tmp_path / "mark"
    copy = students_copy(shipped)
    for cell in copy["cells"]:
        if cell["id"] == "gain":
            cell["source"] = [f"open({str(mark)!r}, 'w')\nimport math\ngain = math.sqrt(64)"]
    (tmp_path / "class" / "Ada").mkdir(parents=True)
    (tmp_path / "class" / "Ada" / START).write_text(json.dumps(copy))
    assert collect(tmp_path / "class")["00 gain"].item().startswith("unread")
    assert not mark.exists()
    table = collect(tmp_path / "class", run_code=True)
    assert table["00 gain"].item() == "right"
    assert table["copy"].item() == "00: common"
    assert mark.exists()
    for cell in ("gain = bytearray(10**11)", "import sys; sys.exit()", "import os; os.kill(os.getpid(), 9)"):
        with pytest.raises(ValueError, match="did not come to an end"):
            run(cell, shipped, "gain")


@pytest.mark.parametrize(
    ("files", "roster", "said"),
    [
        ((), None, "holds no folders"),
        (("Ada",), "name\nAda", "needs a first line with the word student"),
        (("Ada",), "student\nAda\nada ", "each name once"),
        (("Ada",), "student,due\nAda,soon", "Ada is due at 'soon'; write it as 2026-03-01T12:00"),
    ],
)
def test_a_folder_or_a_roster_that_cannot_be_read_is_refused(files, roster, said, tmp_path):
    for name in files:
        (tmp_path / "class" / name).mkdir(parents=True)
    if roster:
        (tmp_path / "roster.csv").write_text(roster)
    with pytest.raises(ValueError, match=said):
        collect(tmp_path / "class", tmp_path / "roster.csv" if roster else None)


@pytest.mark.slow
def test_the_largest_and_smallest_numbers_end_every_check_of_the_first_notebook():
    shipped = notebooks()[START]
    names = lesson(shipped)
    for value in (1e11, -1e11, 0, 1e-11):
        assert {task: right for task, right, _ in marks(shipped, names, {"gain": value})}["gain"] is not True


@pytest.mark.slow
def test_versions_of_the_exam_differ_and_their_solutions_are_computed(tmp_path):
    assert cli.main(["exam", "2026A", str(tmp_path)]) == 0
    questions, solutions = ((tmp_path / f"exam_2026A_{name}.md").read_text() for name in ("questions", "solutions"))
    assert not re.search("<details>|>>> ", questions)
    assert questions.count("\n**") == solutions.count("\n**") == 8
    b1, b3 = map(float, re.search(r"b = \(([\d.]+), 0, ([\d.]+)\)\$ m/s. Where", questions).groups())
    assert f"[{round(b1 / b3, 3)}, 0.0]" in solutions
    share = float(re.search(r"moves ([\d.]+) % faster", questions)[1])
    assert f"{2 * (1 + share / 100):.1f} m instead of 2 m" in solutions
    assert {"'consistent'", ", conservative"} <= set(re.findall("'consistent'|, conservative", solutions))
    assert exam("2026A")[0] == questions != exam("2026B")[0]
    assert cli.main(["exam", "../x"]) == 2
