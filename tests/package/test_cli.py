"""`percept-obs lab` hands out the notebooks, overwrites nothing; mistakes exit with 2."""

import json
import re
import sys
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


def test_notebooks_are_copied_and_a_second_call_keeps_what_the_user_wrote(tmp_path, capsys):
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


@pytest.mark.parametrize(
    ("command", "below", "reason"),
    [("lab", "", "notes.txt is a file"), ("lab", "deeper", "notes.txt"), ("site", "", "notes.txt is a file; name a")],
)
def test_a_file_is_not_a_folder(tmp_path, capsys, command, below, reason):
    file = tmp_path / "notes.txt"
    file.write_text("mine")
    assert cli.main([command, str(file / below)]) == 2
    assert reason in capsys.readouterr().err
    assert file.read_text() == "mine"


def test_a_package_without_notebooks_says_so(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("percept_obs.exercises.models.FOLDER", tmp_path / "gone")
    assert cli.main(["lab", str(tmp_path / "mine")]) == 2
    assert "gone" in capsys.readouterr().err
    assert not (tmp_path / "mine").exists()


def test_a_missing_jupyterlab_is_named_before_anything_is_copied(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(util, "find_spec", lambda name: None)
    assert cli.main(["lab", str(tmp_path / "mine")]) == 1
    assert 'pip install "percept-obs[course]"' in capsys.readouterr().err
    assert not (tmp_path / "mine").exists()


def test_check_fails_when_an_equation_does(monkeypatch, capsys):
    papers = SimpleNamespace(
        find=lambda places, paper: (), judge=lambda ledgers: False, report=lambda ledgers: "the ledger", page=None
    )
    monkeypatch.setitem(sys.modules, "percept_obs.papers", papers)
    assert cli.main(["check"]) == 1
    assert re.match(r"the ledger\n\n0 judged in \d+\.\d s", capsys.readouterr().out)


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


@pytest.mark.parametrize("arguments", [[], ["labs"], ["lab", "--copyonly"]])
def test_a_wrong_command_exits_with_2(arguments, capsys):
    with pytest.raises(SystemExit) as stop:
        cli.main(arguments)
    assert stop.value.code == 2
    assert "usage: percept-obs" in capsys.readouterr().err
