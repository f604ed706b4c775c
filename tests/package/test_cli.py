"""`percept-obs lab` hands out the notebooks, overwrites nothing and opens the first; mistakes exit with 2."""

import json
import re
import subprocess
import sys
from contextlib import nullcontext
from importlib import util
from types import SimpleNamespace

import pytest

from percept_obs import cli


def shipped_as(name):
    """A notebook of one cell, as a file."""
    cell = {"cell_type": "markdown", "metadata": {}, "source": [f"as shipped: {name}"]}
    return json.dumps({"cells": [cell]}, indent=1) + "\n"


@pytest.fixture(autouse=True)
def shipped(tmp_path, monkeypatch):
    folder = tmp_path / "shipped"
    folder.mkdir()
    for name in ("00_start.ipynb", "01_next.ipynb", "not_a_notebook.txt"):
        (folder / name).write_text(shipped_as(name))
    monkeypatch.setattr("percept_obs.exercises.models.FOLDER", folder)
    return folder


@pytest.fixture
def launches(monkeypatch):
    """Every start of a program, as (command, directory); none is really started."""
    seen = []

    class Program(nullcontext):
        def __init__(self, command, cwd):
            super().__init__(self)
            seen.append((command, cwd))
            self.waits = iter([KeyboardInterrupt])

        def wait(self):
            for interrupt in self.waits:
                raise interrupt
            return 7

    monkeypatch.setattr(subprocess, "Popen", Program)
    return seen


def test_notebooks_are_copied_and_a_second_call_keeps_what_the_user_wrote(launches, tmp_path, capsys):
    first, second = (tmp_path / "new" / "mine" / name for name in ("00_start.ipynb", "01_next.ipynb"))
    assert cli.main(["lab", "--copy-only", str(first.parent)]) == 0
    assert {file.name: file.read_text() for file in first.parent.iterdir()} == {
        name: shipped_as(name) for name in ("00_start.ipynb", "01_next.ipynb")
    }
    assert capsys.readouterr().out.splitlines() == [f"copied  {first}", f"copied  {second}"]
    first.write_text("mine")
    second.unlink()
    assert cli.main(["lab", "--copy-only", str(first.parent)]) == 0
    assert first.read_text() == "mine"
    assert second.read_text() == shipped_as("01_next.ipynb")
    assert capsys.readouterr().out.splitlines() == [f"kept    {first}", f"copied  {second}"]
    assert launches == []


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ([], "gain = ...  # your answer"),
        (["--for", "students"], "gain = ...  # your answer"),
        (["--for", "teachers"], "gain = 5"),
    ],
)
def test_only_teachers_get_the_solutions(options, text, shipped, tmp_path):
    cell = {"cell_type": "code", "metadata": {"tags": ["solution"]}, "source": ["gain = 5"]}
    (shipped / "00_start.ipynb").write_text(json.dumps({"cells": [cell]}))
    assert cli.main(["lab", "--copy-only", *options, str(tmp_path / "mine")]) == 0
    (copied,) = json.loads((tmp_path / "mine" / "00_start.ipynb").read_text())["cells"]
    assert "".join(copied["source"]) == text


def test_without_a_name_the_folder_is_made_here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["lab", "--copy-only"]) == 0
    assert (tmp_path / "percept_obs_notebooks" / "00_start.ipynb").is_file()


@pytest.mark.parametrize(
    ("command", "below", "reason"),
    [("lab", "", "notes.txt is a file"), ("lab", "deeper", "notes.txt"), ("site", "", "notes.txt is a file; name a")],
)
def test_a_file_is_not_a_folder(launches, tmp_path, capsys, command, below, reason):
    file = tmp_path / "notes.txt"
    file.write_text("mine")
    assert cli.main([command, str(file / below)]) == 2
    assert reason in capsys.readouterr().err
    assert file.read_text() == "mine"
    assert launches == []


def test_a_package_without_notebooks_says_so(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("percept_obs.exercises.models.FOLDER", tmp_path / "gone")
    assert cli.main(["lab", str(tmp_path / "mine")]) == 2
    assert "gone" in capsys.readouterr().err
    assert not (tmp_path / "mine").exists()


@pytest.mark.parametrize(("user", "options"), [(1000, []), (0, ["--no-browser"])])
def test_jupyterlab_opens_the_first_notebook_and_outlives_control_c(launches, tmp_path, monkeypatch, user, options):
    monkeypatch.setattr(cli.os, "geteuid", lambda: user, raising=False)
    assert cli.main(["lab", *options, str(tmp_path)]) == 7
    first = ["--ServerApp.root_dir=.", "--LabApp.default_url=/lab/tree/00_start.ipynb"]
    command = [sys.executable, "-m", "jupyterlab", *first, *options, *([] if user else ["--allow-root"])]
    assert launches == [(command, tmp_path)]


def test_a_missing_jupyterlab_is_named_before_anything_is_copied(launches, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(util, "find_spec", lambda name: None)
    assert cli.main(["lab", str(tmp_path / "mine")]) == 1
    assert 'pip install "percept-obs[course]"' in capsys.readouterr().err
    assert launches == []
    assert not (tmp_path / "mine").exists()


@pytest.mark.parametrize(("holds", "code"), [(True, 0), (False, 1)])
def test_check_prints_the_report_and_fails_when_an_equation_does(monkeypatch, capsys, holds, code):
    papers = SimpleNamespace(
        find=lambda places, paper: (), judge=lambda ledgers: holds, report=lambda ledgers: "the ledger", page=None
    )
    monkeypatch.setitem(sys.modules, "percept_obs.papers", papers)
    assert cli.main(["check"]) == code
    assert re.match(r"the ledger\n\n0 judged in \d+\.\d s", capsys.readouterr().out)


def test_check_prints_one_equation_with_its_parts_and_writes_a_page(tmp_path, capsys):
    page = tmp_path / "page.html"
    assert cli.main(["check", "38", "--paper", "Ma", "--html", str(page)]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("Ma, Chen and Moore 2005, (38)")
    assert "1 judged in" in printed
    assert "<caption>(38)" in page.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["figure 99"], "there is no 'figure 99'"),
        (["--paper", "Khalil"], "no paper is called 'Khalil'"),
        (["38", "--html", "."], "cannot write '.'; name a file"),
    ],
)
def test_check_refuses_what_is_not_there_and_exits_with_2(capsys, arguments, message):
    assert cli.main(["check", *arguments]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.slow
def test_the_module_runs_as_a_program():
    run = [sys.executable, "-m", "percept_obs.cli"]
    asked = subprocess.run([*run, "--help"], capture_output=True, text=True, check=False)
    assert asked.returncode == 0
    assert "check" in asked.stdout


@pytest.mark.parametrize("arguments", [[], ["labs"], ["lab", "--copyonly"]])
def test_a_wrong_command_exits_with_2(arguments, capsys):
    with pytest.raises(SystemExit) as stop:
        cli.main(arguments)
    assert stop.value.code == 2
    assert "usage: percept-obs" in capsys.readouterr().err
