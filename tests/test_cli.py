"""`percept-obs lab` hands out the notebooks, overwrites nothing and opens the first; mistakes exit with 2."""

import json
import re
import subprocess
import sys
from importlib import util
from types import SimpleNamespace

import pytest

from percept_obs import cli


def shipped_as(name):
    """A notebook of one cell, as a file."""
    cell = {"cell_type": "markdown", "metadata": {}, "source": [f"as shipped: {name}"]}
    return json.dumps({"cells": [cell]}, indent=1) + "\n"


@pytest.fixture
def shipped(tmp_path, monkeypatch):
    folder = tmp_path / "shipped"
    folder.mkdir()
    for name in ("00_start.ipynb", "01_next.ipynb", "not_a_notebook.txt"):
        (folder / name).write_text(shipped_as(name))
    monkeypatch.setattr(cli, "notebooks", lambda: folder)
    return folder


@pytest.fixture
def launches(monkeypatch):
    """Every start of a program, as (command, directory); none is really started."""
    seen = []

    class Program:
        def __init__(self, command, cwd):
            seen.append((command, cwd))
            self.interrupts = 1

        def __enter__(self):
            return self

        def __exit__(self, *exception):
            pass

        def wait(self):
            if self.interrupts:
                self.interrupts -= 1
                raise KeyboardInterrupt
            return 7

    monkeypatch.setattr(subprocess, "Popen", Program)
    return seen


def test_the_shipped_notebooks_are_found():
    assert (cli.notebooks() / cli.FIRST_NOTEBOOK).is_file()


def test_notebooks_are_copied_into_a_new_folder(shipped, launches, tmp_path, capsys):
    mine = tmp_path / "new" / "mine"
    assert cli.main(["lab", "--copy-only", str(mine)]) == 0
    assert {file.name: file.read_text() for file in mine.iterdir()} == {
        "00_start.ipynb": shipped_as("00_start.ipynb"),
        "01_next.ipynb": shipped_as("01_next.ipynb"),
    }
    assert capsys.readouterr().out.splitlines() == [
        f"copied  {mine / '00_start.ipynb'}",
        f"copied  {mine / '01_next.ipynb'}",
    ]
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


def test_a_second_call_keeps_what_the_user_wrote_and_brings_back_what_is_gone(shipped, tmp_path, capsys):
    cli.main(["lab", "--copy-only", str(tmp_path)])
    (tmp_path / "00_start.ipynb").write_text("mine")
    (tmp_path / "01_next.ipynb").unlink()
    capsys.readouterr()

    assert cli.main(["lab", "--copy-only", str(tmp_path)]) == 0
    assert (tmp_path / "00_start.ipynb").read_text() == "mine"
    assert (tmp_path / "01_next.ipynb").read_text() == shipped_as("01_next.ipynb")
    assert capsys.readouterr().out.splitlines() == [
        f"kept    {tmp_path / '00_start.ipynb'}",
        f"copied  {tmp_path / '01_next.ipynb'}",
    ]


def test_without_a_name_the_folder_is_made_here(shipped, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["lab", "--copy-only"]) == 0
    assert (tmp_path / "percept_obs_notebooks" / "00_start.ipynb").is_file()


@pytest.mark.parametrize(("below", "reason"), [("", "notes.txt is a file"), ("deeper", "notes.txt")])
def test_a_file_is_not_a_folder(shipped, launches, tmp_path, capsys, below, reason):
    file = tmp_path / "notes.txt"
    file.write_text("mine")
    assert cli.main(["lab", str(file / below)]) == 2
    assert reason in capsys.readouterr().err
    assert file.read_text() == "mine"
    assert launches == []


def test_a_package_without_notebooks_says_so(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(cli, "notebooks", lambda: tmp_path / "gone")
    assert cli.main(["lab", str(tmp_path / "mine")]) == 2
    assert "gone" in capsys.readouterr().err
    assert not (tmp_path / "mine").exists()


def test_jupyterlab_opens_the_first_notebook_and_outlives_control_c(launches, shipped, tmp_path, monkeypatch):
    monkeypatch.setattr(cli.os, "geteuid", lambda: 1000, raising=False)
    assert cli.main(["lab", str(tmp_path)]) == 7
    [(command, directory)] = launches
    assert command[:3] == [sys.executable, "-m", "jupyterlab"]
    assert command[3:] == ["--ServerApp.root_dir=.", "--LabApp.default_url=/lab/tree/00_start.ipynb"]
    assert directory == tmp_path


def test_no_browser_and_root_are_passed_on(shipped, launches, tmp_path, monkeypatch):
    monkeypatch.setattr(cli.os, "geteuid", lambda: 0, raising=False)
    cli.main(["lab", "--no-browser", str(tmp_path)])
    [(command, _)] = launches
    assert command[-2:] == ["--no-browser", "--allow-root"]


def test_a_missing_jupyterlab_is_named_and_how_to_get_it(shipped, launches, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(util, "find_spec", lambda name: None)
    assert cli.main(["lab", str(tmp_path)]) == 1
    assert "pip install jupyterlab" in capsys.readouterr().err
    assert launches == []
    assert (tmp_path / "00_start.ipynb").is_file()


@pytest.mark.parametrize(("holds", "code"), [(True, 0), (False, 1)])
def test_check_prints_the_report_and_fails_when_an_equation_does(monkeypatch, capsys, holds, code):
    papers = SimpleNamespace(
        find=lambda places, paper: (), judge=lambda ledgers: holds, report=lambda ledgers: "the ledger", page=None
    )
    monkeypatch.setitem(sys.modules, "percept_obs.papers", papers)
    assert cli.main(["check"]) == code
    printed = capsys.readouterr().out
    assert printed.startswith("the ledger\n")
    assert re.search(r"0 judged in \d+\.\d s", printed)


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
        (["38", "--html", "."], "cannot write the page"),
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
