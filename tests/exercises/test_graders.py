"""nbgrader and Otter take the notebooks as assignments, cut every solution out, and mark what students hand in."""

import json
import re
import subprocess
import sys
from importlib.util import find_spec
from itertools import product

import nbformat
import pytest
import yaml
from mistakes import MISTAKES
from needs import missing
from notebook_exercises import answer_name, code, read, source, tagged
from places import NOTEBOOKS

from percept_obs import cli
from percept_obs.exercises import GRADERS
from percept_obs.exercises.models import answers_in

NAMES = sorted(path.stem for path in NOTEBOOKS.glob("*.ipynb"))
MARKED = "00_start"
GRADE = """
import json, sys
from otter.api import grade_submission

_, autograder, *copies = sys.argv
for copy in copies:
    results = grade_submission(copy, autograder, quiet=True).results
    print("marks", json.dumps({name: result.score for name, result in results.items()}))
"""


@pytest.fixture(scope="module")
def copies(tmp_path_factory):
    """The folders of the assignments' sources, as the command line writes them."""
    folders = {tool: tmp_path_factory.mktemp(tool) / "source" / "observers" for tool in ("nbgrader", "otter")}
    for tool, folder in folders.items():
        assert cli.main(["lab", "--copy-only", "--for", tool, str(folder)]) == 0
    return folders


@pytest.fixture(params=NAMES)
def name(request):
    return request.param


def opened(path):
    """A notebook that is valid, each of whose cells has a name of its own."""
    notebook = json.loads(path.read_text("utf-8"))
    nbformat.validate(notebook)
    assert len({cell["id"] for cell in notebook["cells"]}) == len(notebook["cells"])
    return notebook


def test_each_exercise_has_a_point_of_nbgrader_and_nothing_else_is_marked(copies, name):
    marks = [
        (cell["cell_type"], cell["metadata"]["nbgrader"])
        for cell in opened(copies["nbgrader"] / f"{name}.ipynb")["cells"]
        if "nbgrader" in cell["metadata"]
    ]
    always = {"schema_version": 3, "task": False}
    answer = {"grade": False, "solution": True, "locked": False}
    check = {"grade": True, "solution": False, "locked": True, "points": 1}
    words = {"grade": True, "solution": True, "locked": False, "points": 1}
    for kind, mark in marks:
        assert re.fullmatch(r"[\w-]+", mark["grade_id"])
        allowed = [words] if kind == "markdown" else [answer, check]
        assert mark in [{**always, "grade_id": mark["grade_id"], **each} for each in allowed]
    assert sum(mark.get("points", 0) for _, mark in marks) == len(tagged(read(f"{name}.ipynb"), "exercise", "markdown"))


def test_each_exercise_is_a_question_of_otter(copies, name):
    config, *cells = opened(copies["otter"] / f"{name}.ipynb")["cells"]
    assert source({"cells": [config]}, 0).startswith("# ASSIGNMENT CONFIG")
    inside, found = [], []
    for cell in cells:
        text = "".join(cell["source"])
        if cell["cell_type"] != "raw":
            if inside:
                found[-1]["kinds"].append((inside[-1], cell["cell_type"]))
            continue
        edge, block = re.match(r"# (BEGIN|END) (QUESTION|SOLUTION|TESTS)$", text, re.MULTILINE).groups()
        if block == "QUESTION" and edge == "BEGIN":
            found.append(yaml.safe_load(text) | {"kinds": []})
        assert inside == (["QUESTION"] if (block == "QUESTION") == (edge == "END") else inside)
        inside = [*inside, block] if edge == "BEGIN" else inside[:-1]
    assert inside == []
    assert len({question["name"] for question in found}) == len(found)
    assert len(found) == len(tagged(read(f"{name}.ipynb"), "exercise", "markdown"))
    for question in found:
        assert question["points"] == 1
        ends = [("SOLUTION", "markdown")] if question["manual"] else [("SOLUTION", "code"), ("TESTS", "code")]
        assert [kind for kind in question["kinds"] if kind[0] != "QUESTION"] == ends


@pytest.mark.parametrize("copy", GRADERS.values(), ids=GRADERS)
def test_no_solution_stands_outside_of_what_is_cut(name, copy):
    notebook = read(f"{name}.ipynb")
    made = copy(notebook)
    words = {source(notebook, k) for k in tagged(notebook, "solution", "markdown")}
    kept = [text for k in range(len(made["cells"])) if (text := source(made, k)) not in words]
    left = re.sub(r"# BEGIN SOLUTION NO PROMPT\n.*?# END SOLUTION", "", "\n".join(kept), flags=re.DOTALL)
    solutions = [source(notebook, k) for k in tagged(notebook, "solution", "code")]
    assert all(solution in "\n".join(kept) and solution not in left for solution in solutions)
    assert not any(answer in left for cell in notebook["cells"] for answer in answers_in(cell))


def test_the_name_of_a_reply_is_free(name):
    assert not re.search(r"\breply\b", "\n".join(code(read(f"{name}.ipynb"))))


def test_a_check_without_a_reply_is_refused():
    cell = {"cell_type": "code", "id": "it", "metadata": {"tags": ["exercise"]}, "source": "reply = 3"}
    for copy in GRADERS.values():
        with pytest.raises(ValueError, match="a check ends with its reply"):
            copy({"cells": [cell]})


def tool(name, *arguments, folder):
    """Run a tool, or skip the test where it is missing."""
    if find_spec(name) is None:
        package = {"otter": "otter-grader"}.get(name, name)
        missing(name, f"{name} is missing; get it with: {sys.executable} -m pip install {package}")
    done = subprocess.run([sys.executable, "-m", name, *arguments], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout


def answers(*kinds):
    """Answers to the exercises of a notebook that are right, wrong or empty."""
    notebook = read(f"{MARKED}.ipynb")
    given = {}
    for k, kind in zip(tagged(notebook, "solution", "code"), kinds, strict=True):
        solution, name = source(notebook, k), notebook["cells"][k]["id"]
        wrong = f"{answer_name(solution)} = {MISTAKES[MARKED][name][0]!r}"
        given |= {name: {"right": solution, "wrong": wrong, "empty": None}[kind]}
    return given


def hand_in(released, target, given):
    """Write a student's copy: what was released, without its lab, with answers."""
    notebook = json.loads(released.read_text("utf-8"))
    notebook["cells"] = [cell for cell in notebook["cells"] if cell.get("id") != "lab"]
    for cell in notebook["cells"]:
        cell["source"] = given.get(cell.get("id")) or cell["source"]
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(json.dumps(notebook), "utf-8")


@pytest.mark.slow
def test_nbgrader_takes_the_notebooks_and_marks_three_students(copies):
    course = copies["nbgrader"].parents[1]
    tool("nbgrader", "generate_assignment", "observers", folder=course)
    released = sorted((course / "release" / "observers").glob("*.ipynb"))
    assert [path.stem for path in released] == NAMES
    for notebook, path in ((read(path.name), path) for path in released):
        text = path.read_text("utf-8")
        assert not any(json.dumps(source(notebook, k))[1:-1] in text for k in tagged(notebook, "solution", "code"))
    students = {"ann": ["right"] * 3, "ben": ["right", "wrong", "empty"], "eva": ["empty"] * 3}
    release = course / "release" / "observers" / f"{MARKED}.ipynb"
    for student, kinds in students.items():
        hand_in(release, course / "submitted" / student / "observers" / release.name, answers(*kinds))
    tool("nbgrader", "autograde", "observers", f"--notebook={MARKED}", folder=course)
    tool("nbgrader", "export", folder=course)
    header, *rows = (line.split(",") for line in (course / "grades.csv").read_text().splitlines())
    marks = {row[header.index("student_id")]: float(row[header.index("score")]) for row in rows}
    assert marks == {student: kinds.count("right") for student, kinds in students.items()}


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_otter_takes_a_notebook_and_its_solutions_pass(copies, name, tmp_path):
    tool("otter", "assign", str(copies["otter"] / f"{name}.ipynb"), str(tmp_path), folder=tmp_path)
    notebook, text = read(f"{name}.ipynb"), (tmp_path / "student" / f"{name}.ipynb").read_text("utf-8")
    assert not any(json.dumps(source(notebook, k))[1:-1] in text for k in tagged(notebook, "solution", "code"))


@pytest.mark.slow
def test_otter_grades_ten_copies(copies, tmp_path):
    path = copies["otter"] / f"{MARKED}.ipynb"
    tool("otter", "assign", "--no-run-tests", str(path), str(tmp_path), folder=tmp_path)
    (autograder,) = (tmp_path / "autograder").glob("*.zip")
    given = list(product(("right", "wrong", "empty"), repeat=3))[:20:2]
    handed_in = [tmp_path / f"student_{k}.ipynb" for k in range(len(given))]
    for target, each in zip(handed_in, given, strict=True):
        hand_in(tmp_path / "student" / path.name, target, answers(*each))
    script = [sys.executable, "-c", GRADE, str(autograder), *map(str, handed_in)]
    printed = subprocess.run(script, cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    marks = [json.loads(line.removeprefix("marks ")) for line in printed.splitlines() if line.startswith("marks ")]
    assert [[mark[name] for name in answers(*each)] for mark, each in zip(marks, given, strict=True)] == [
        [float(kind == "right") for kind in each] for each in given
    ]
