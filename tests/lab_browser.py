"""The observer lab in a real JupyterLab: opening it, moving it, and reading what it draws."""

import json
import time

import nbformat
import numpy as np
from jupyter_harness import open_notebook, run_all

from percept_obs.labs.observer_lab import observer_lab

KERNEL = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}

OPEN = """
import json, pathlib
from percept_obs.labs.observer_lab import observer_lab
lab = observer_lab({arguments})
def keep(change):
    pathlib.Path("state.new").write_text(json.dumps(lab.settings))
    pathlib.Path("state.new").replace("state.json")
lab.observe(keep, "analysis")
lab
"""

RESTED = """() => [...(window.perceptObsLabs ?? [])].length > 0 && [...window.perceptObsLabs].every(
    (lab) => lab.shown && lab.shown.settings === lab.settings && !lab.pending && lab.resting === null
        && lab.link.waitingFor === null)"""

HANDED_OVER = """() => [...(window.perceptObsLabs ?? [])].length > 0 && [...window.perceptObsLabs].every(
    (lab) => lab.kernels.whole.size === lab.widget.get("parts").length)"""

STATE = """(which) => {
    const lab = [...window.perceptObsLabs][which];
    const numbers = (values) => Array.from(values, (v) => (Number.isFinite(v) ? v : null));
    return {
        settings: lab.settings,
        runs: Object.fromEntries(lab.shown.runs.map((run) => [run.name, numbers(run.estimate)])),
        divergedAt: Object.fromEntries(lab.shown.runs.map((run) => [run.name, run.divergedAt])),
        drawn: Object.fromEntries(Object.entries(lab.drawn).map(([name, { lines }]) =>
            [name, lines.map((line) => ({ name: line.name, values: numbers(line.values) }))])),
        verdicts: [...lab.view.root.querySelectorAll(".verdicts li")].map((item) => item.textContent),
        labels: [...lab.view.root.querySelectorAll("figure:not([hidden]) canvas")].map((c) => c.ariaLabel),
        problems: [...lab.view.root.querySelectorAll(".problem:not([hidden])")].map((p) => p.textContent),
        waiting: !lab.view.root.querySelector(".waiting").hidden,
        notice: lab.view.root.querySelector(".notice").textContent,
        silent: !lab.view.root.querySelector(".silence").hidden,
    };
}"""


def write_notebook(folder, name, *cells):
    """A notebook of code cells in the server's folder."""
    notebook = nbformat.v4.new_notebook(metadata=KERNEL, cells=[nbformat.v4.new_code_cell(c) for c in cells])
    nbformat.write(notebook, folder / name)


def open_lab(page, folder, name="lab.ipynb", arguments=""):
    """Show a notebook with one lab, run it, and wait until page and Python have come to rest."""
    write_notebook(folder, name, OPEN.format(arguments=arguments))
    open_notebook(page, name)
    run_all(page)
    rested(page)


def handed_over(page, patience=120):
    """Wait until every lab has all parts of its model."""
    page.wait_for_function(HANDED_OVER, timeout=1000 * patience)


def rested(page, patience=30):
    """Wait until every lab shows its latest settings and Python has answered."""
    page.wait_for_function(RESTED, timeout=1000 * patience)


def state(page, which=0):
    """What a lab of the page shows: settings, estimates, lines drawn, words."""
    return page.evaluate(STATE, which)


def assert_python_has(folder, settings, patience=10):
    """The kernel's lab comes to have these settings; it writes them down a moment after the page has its answer."""
    kept, deadline = {}, time.monotonic() + patience
    while {key: kept.get(key) for key in settings} != settings and time.monotonic() < deadline:
        time.sleep(0.05)
        if (folder / "state.json").exists():
            kept = json.loads((folder / "state.json").read_text())
    assert {key: kept.get(key) for key in settings} == settings


def assert_equals_python(shown, tolerance=1e-9):
    """What is drawn are the numbers of a Python run of the same settings."""
    runs = observer_lab(**shown["settings"]).run()
    assert list(shown["runs"]) == list(runs)
    for name, run in runs.items():
        estimate = _array(shown["runs"][name]).reshape(-1, 3)
        np.testing.assert_allclose(estimate, run.estimate, rtol=0, atol=tolerance)
        assert f"{run.observer.name}: {run.verdict()}" in shown["verdicts"]
        drawn = {line["name"]: _array(line["values"]) for line in shown["drawn"]["error"]}
        hidden = [run.observer.form.coordinates.index(s) for s in run.observer.form.x2]
        error = np.abs(run.error[:, hidden]).max(axis=1)
        np.testing.assert_allclose(drawn[f"{run.observer.name} error"], error, rtol=0, atol=tolerance)


def centre(page, selector):
    """The middle of an element on the screen."""
    box = page.locator(selector).first.bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def control(name):
    """Selector of a control by its name."""
    return f"[data-control='{name}']"


def _array(values):
    return np.array([np.nan if v is None else v for v in values])
