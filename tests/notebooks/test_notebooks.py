"""Each notebook runs top to bottom, survives every control, pins a number, and names its pictures."""

import ast
import json
import re
from itertools import pairwise

import nbformat
import numpy as np
import pytest
from jupyter_harness import execute, silent_pictures
from nbclient.exceptions import CellExecutionError
from nbformat.v4 import new_code_cell, new_notebook
from notebook_exercises import FAILING, asked, code, read
from notebook_runs import run
from places import NOTEBOOKS
from sample_sizes import sampled
from utias_cut import whole

from percept_obs.labs.observer.lab import observer_lab
from percept_obs.recording import scenarios

NAMES = sorted(path.name for path in NOTEBOOKS.glob("*.ipynb"))


def run_alone(program, folder):
    """Run a notebook of one cell."""
    execute(new_notebook(cells=[new_code_cell(program)]), folder)


@pytest.mark.parametrize("name", NAMES)
def test_nothing_of_a_run_is_stored(name):
    notebook = read(name)
    about = notebook["metadata"]
    assert set(about) <= {"kernelspec", "language_info"}
    assert about["kernelspec"]["name"] == "python3"
    assert set(about.get("language_info", ())) <= {"name"}
    for cell in notebook["cells"]:
        assert not re.fullmatch(r"[0-9a-f]{8}", cell["id"]), "an id by which a cell is known, not a random one"
        assert not cell.get("outputs")
        assert cell.get("execution_count") is None
        assert set(cell["metadata"]) <= {"tags", "percept_obs"}


@pytest.mark.parametrize("name", NAMES)
def test_a_number_is_pinned(name):
    trees = [ast.parse(source) for source in code(read(name))]
    assert any(isinstance(node, ast.Assert) for tree in trees for node in ast.walk(tree))


def test_each_notebook_leads_to_the_next():
    texts = {name: "".join("".join(cell["source"]) for cell in read(name)["cells"][-1:]) for name in NAMES}
    for name, following in pairwise(NAMES):
        assert f"]({following})" in texts[name], f"the end of {name} has no link to {following}"


def test_the_first_notebook_lists_all_others():
    text = json.dumps(read("00_start.ipynb"))
    assert re.findall(r"\*\*\]\((\w+\.ipynb)\)", text) == NAMES[1:]


@pytest.mark.parametrize("name", NAMES)
def test_links_lead_to_notebooks(name):
    text = "".join("".join(cell["source"]) for cell in read(name)["cells"] if cell["cell_type"] == "markdown")
    assert set(re.findall(r"\]\(([^):]*\.ipynb)\)", text)) <= set(NAMES)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES[::-1])  # the longer ones first
def test_it_runs_with_what_it_asks_for_and_every_control_moves(name, ran):
    assert ran(name).fault == ""
    assert silent_pictures(ran(name).notebook, ran(name).widgets) == []


@pytest.mark.night
@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in NAMES if "load_utias" in "".join(code(read(name)))])
def test_it_runs_with_the_whole_recording_too(name, tmp_path):
    """It takes the night: every run has the notebooks with the cut that comes with the package."""
    one = run(name, tmp_path, whole())
    assert one.fault == ""
    assert silent_pictures(one.notebook, one.widgets) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in NAMES if asked(read(name))][: sampled(1, None)])
def test_a_missing_module_is_one_sentence_and_no_other_cell_runs(name, tmp_path):
    """One notebook, for each asks by the same function; all of them with ALL_SAMPLES=1."""
    notebook = nbformat.read(NOTEBOOKS / name, as_version=4)
    for cell in notebook.cells:
        cell.metadata.tags = ["raises-exception"]  # and yet the next ones are sent
    execute(notebook, tmp_path, absent=asked(notebook))
    (first,), *others = [outputs for cell in notebook.cells if (outputs := cell.get("outputs"))]
    assert (first.output_type, first.traceback) == ("error", [first.evalue])
    assert re.match(rf"{', '.join(asked(notebook))} is missing, .*%pip install \"percept-obs\[course\]\"", first.evalue)
    said = ["".join(part.text for part in parts) for parts in others]  # a busy kernel sends a line in two parts
    assert said == [f"{first.evalue}\n"] * (len(code(notebook)) - 1)


@pytest.mark.slow
def test_an_error_in_a_callback_fails_the_test(tmp_path):
    with pytest.raises(CellExecutionError) as failure:
        run_alone(FAILING, tmp_path)
    for message in (
        *(f"ArithmeticError: {name}" for name in ("observed", "clicked", "interactive", "put off")),
        "UserWarning: a warning",
        "the lab says: shown to the student only",
        "how is a ColorPicker moved?",
    ):
        assert message in str(failure.value)


@pytest.mark.slow
def test_a_warning_of_a_cell_fails_the_test(tmp_path):
    with pytest.raises(CellExecutionError, match="UserWarning"):
        run_alone("import warnings; warnings.warn('a warning')", tmp_path)


def shown(data, **metadata):
    """A code cell and what it displayed."""
    output = {"output_type": "display_data", "data": data, "metadata": metadata}
    return {"cell_type": "code", "id": "c", "source": "", "outputs": [output]}


def words(source):
    """A cell of text."""
    return {"cell_type": "markdown", "id": "m", "source": source}


PNG, NAMED = {"image/png": "AAAA"}, '<img alt="what it shows" src="a.png">'


@pytest.mark.parametrize(
    ("cell", "complaints"),
    [
        (words("![what it shows](a.png)"), []),
        (words("![ ](a.png)"), ["m: ![] without a text"]),
        (words('<img src="a.png">'), ["m: <img> without alt"]),
        (shown({"text/html": NAMED} | PNG), []),
        (shown({"text/html": '<p><img alt=" "></p>'}), ["c: <img> without alt"]),
        (shown({"text/html": "<svg></svg>"}), ["c: <svg> without aria-label"]),
        (shown(PNG), ["c: image/png without alt"]),
        (shown(PNG, **{"image/png": {"alt": "what it shows"}}), []),
    ],
)
def test_a_picture_without_a_text_is_found(cell, complaints):
    assert silent_pictures({"cells": [cell]}, {}) == complaints


@pytest.mark.parametrize(
    ("state", "complaints"),
    [
        ({"_model_name": "HTMLModel", "value": NAMED}, []),
        ({"_model_name": "HTMLModel", "value": "<img>"}, ["HTMLModel: <img> without alt"]),
        (
            {"_model_name": "ImageModel", "value": b""},
            ["ImageModel: no alternative text; put an <img> into HTML"],
        ),
    ],
)
def test_a_widget_without_a_text_is_found(state, complaints):
    assert silent_pictures({"cells": []}, {"an id": state}) == complaints


NOISE, STRONG = {"kind": "uniform", "size": 0.0025}, {"identifier_based": {"gain": 30}}
DRIVE = scenarios.drive()
STRAIGHT = -np.linalg.norm(observer_lab().settings["b"]) * np.array(DRIVE.position) / np.linalg.norm(DRIVE.position)


def driven(**changes):
    """The run of the first notebook's lab with other settings."""
    lab = observer_lab()
    lab.settings = {**lab.settings, **changes}
    (run,) = lab.run().values()
    return run


@pytest.mark.parametrize(
    ("changes", "seconds"),
    [
        ({}, 2.25),
        ({"b": STRAIGHT.tolist()}, np.inf),
        ({"outputs": ["y1"]}, 2.55),
        ({"outputs": ["y2"]}, np.inf),
        ({"gains": STRONG}, 0.80),
    ],
)
def test_what_the_first_notebook_answers_is_so(changes, seconds):
    assert driven(**changes).settling_time() == pytest.approx(seconds, abs=0.005)


def test_with_noise_more_gain_arrives_as_early_and_follows_the_noise():
    quiet, noisy, calm = driven(gains=STRONG), driven(gains=STRONG, noise=NOISE), driven(noise=NOISE)
    first = [run.time[run.relative_error < 0.1][0] for run in (quiet, noisy)]
    assert first[1] == pytest.approx(first[0], abs=0.1)
    late = quiet.time > 3
    quiet, noisy, calm = (np.sqrt(np.mean(run.relative_error[late] ** 2)) for run in (quiet, noisy, calm))
    assert noisy > 2 * calm
    assert noisy > 10 * quiet
