"""Labs in a real JupyterLab: opening them, moving them, and reading what they draw."""

import json
import time
from types import MappingProxyType

import numpy as np
import pytest
from jupyter_harness import open_notebook, run_all
from lab_settings import FRONT, as_array, assert_follows_python, runs
from needs import missing
from points_settings import run_of
from sample_sizes import sampled
from structure_settings import assert_same_structure_runs, structure_runs_of

from percept_obs.labs.observer.lab import observer_lab
from percept_obs.labs.structure.lab import structure_lab
from percept_obs.structure import ImpossibleChoice
from percept_obs.system.surfaces import BehindCamera

KERNEL = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}

OPEN = """
import json, pathlib
from percept_obs.labs import observer_lab
lab = observer_lab({arguments})
def keep(change):
    pathlib.Path("state.new").write_text(json.dumps(lab.settings), "utf-8")
    pathlib.Path("state.new").replace("state.json")
lab.observe(keep, "analysis")
lab
"""
EVENTS = sampled(100, 10_000)
"""Random events in each lab, about one for each control."""


def usable(page):
    """Names of the controls of the first lab that can be used now."""
    return set(page.evaluate("tests.controls()"))


def used_at_random(page, seed, wanted=frozenset(), count=EVENTS, most=20_000):
    """Names of the controls that random events used, a few more for wanted ones that are left; nothing goes wrong."""
    used = set()
    for more in range(4):
        left = sorted(wanted - used) if more else []
        if more and not left:
            break
        if more:
            page.evaluate("tests.reset()")  # what could be used at the start can be used again
            rested(page, 60)
        found = page.evaluate(
            "(given) => tests.events(...given)", [seed + 1000 * more, 100 if more else count, most, left]
        )
        assert found["wrong"] == [], found["wrong"]
        used |= set(found["used"])
    rested(page, 60)
    return used


def write_notebook(folder, name, *cells):
    """A notebook of code cells in the server's folder."""
    code = [
        {"cell_type": "code", "id": f"c{k}", "metadata": {}, "source": c, "execution_count": None, "outputs": []}
        for k, c in enumerate(cells)
    ]
    notebook = {"nbformat": 4, "nbformat_minor": 5, "metadata": KERNEL, "cells": code}
    (folder / name).write_text(json.dumps(notebook), "utf-8")


def open_lab(page, folder, name="lab.ipynb", arguments="", lab="observer_lab"):
    """Show a notebook with one lab, run it, and wait until page and Python have come to rest; the drawer unfolded."""
    write_notebook(folder, name, OPEN.replace("observer_lab", lab).format(arguments=arguments))
    open_unfolded(page, name)


def open_unfolded(page, name):
    """Show a notebook, run it, wait until all has come to rest, and unfold the drawers of its labs."""
    open_notebook(page, name)
    run_all(page)
    rested(page)
    page.evaluate("tests.unfold()")


def rested(page, patience=30):
    """Wait until every lab shows its latest settings and Python has answered."""
    page.wait_for_function("() => tests.rested()", timeout=1000 * patience)


def painted(page):
    """Wait until what has changed is laid out and handed to the screen, and what that changes as well."""
    page.evaluate("tests.painted()")


def state(page, which=0):
    """Settings, estimates, lines and words of a lab of the page."""
    return page.evaluate("(which) => tests.state(which)", which)


def assert_fits(page, width):
    """In a cell of so many pixels nothing of the lab is cut."""
    page.evaluate("(width) => tests.width(width)", f"{width}px")
    painted(page)
    assert page.evaluate("tests.outside()") == []
    page.evaluate("tests.width('')")


def assert_own_colours(page):
    """In the dark the lab draws in other colours."""
    light = page.evaluate("tests.colours()")
    page.evaluate("document.body.dataset.jpThemeLight = 'false'")
    page.wait_for_function("(light) => tests.colours() && tests.colours() !== light", arg=light)
    page.evaluate("document.body.dataset.jpThemeLight = 'true'")
    page.wait_for_function("(light) => tests.colours() === light", arg=light)


def assert_has(lab, settings):
    """The lab in Python has these settings."""
    assert json.loads(json.dumps(lab.settings)) == settings


def assert_python_has(folder, settings, patience=10):
    """The kernel's lab comes to have these settings; it writes them down a moment after the page has its answer."""
    kept, deadline = {}, time.monotonic() + patience
    while {key: kept.get(key) for key in settings} != settings and time.monotonic() < deadline:
        time.sleep(0.05)
        if (folder / "state.json").exists():
            kept = json.loads((folder / "state.json").read_text("utf-8"))
    assert {key: kept.get(key) for key in settings} == settings


def assert_equals_python(shown, tolerance=1e-9):
    """Compare what is drawn with a Python run of the same settings."""
    runs = observer_lab(**shown["settings"]).run()
    assert list(shown["runs"]) == list(runs)
    for name, run in runs.items():
        estimate = as_array(shown["runs"][name]).reshape(-1, 3)
        np.testing.assert_allclose(estimate, run.estimate, rtol=0, atol=tolerance)
        assert f"{run.observer.name}: {run.verdict()}" in shown["verdicts"]
        if "error" in shown["drawn"]:
            drawn = {line["name"]: as_array(line["values"]) for line in shown["drawn"]["error"]}
            error = 100 * np.where(np.isfinite(run.relative_error), run.relative_error, np.nan)
            there = (
                drawn["estimate" if len(runs) == 1 else name] if name in drawn or len(runs) == 1 else drawn["estimate"]
            )
            np.testing.assert_allclose(there, error, rtol=1e-6, atol=2000 * tolerance)


def assert_structure_is_python(shown):
    """Compare what is drawn and said of structure and motion with a Python run."""
    told = {name: {"estimate": e, "divergedAt": shown["divergedAt"][name]} for name, e in shown["runs"].items()}
    settings = structure_lab(**shown["settings"]).settings
    if not told:
        with pytest.raises((ImpossibleChoice, BehindCamera)):
            structure_runs_of(settings)
        return
    assert_same_structure_runs(settings, told)
    for run in structure_runs_of(settings).values():
        assert run.verdict(settings["tolerance"]) in [text.partition(": ")[2] for text in shown["verdicts"]]


def assert_points_are_python(shown, tolerance=1e-9):
    """Compare what is drawn of many points with a Python run."""
    run = run_of(shown["settings"])
    assert shown["divergedAt"]["points"] == run.diverged_at
    assert run.verdict() in shown["words"]
    told, expected = as_array(shown["runs"]["points"]), run.state.ravel()
    size = np.fmax(1, np.abs(expected))
    growing = 1 if run.diverged_at is None else 1e6
    np.testing.assert_allclose(told / size, expected / size, rtol=0, atol=growing * tolerance)
    if "error" in shown["drawn"] and run.diverged_at is None:
        (error,) = [line for line in shown["drawn"]["error"] if line["name"] == "estimate"]
        np.testing.assert_allclose(as_array(error["values"]), run.deviation, rtol=1e-9, atol=tolerance)


def assert_is_python(kind, shown, following=False):
    """Compare a lab with Python; after random events, which may be stiff, less closely."""
    if kind == "points":
        assert_points_are_python(shown, 1e-6 if following else 1e-9)
    elif kind == "structure":
        assert_structure_is_python(shown)
    elif not following:
        assert_equals_python(shown)
    elif shown["runs"]:
        told = {n: {"estimate": e, "divergedAt": shown["divergedAt"][n]} for n, e in shown["runs"].items()}
        assert_follows_python(shown["settings"], told)
    else:
        with pytest.raises(BehindCamera):
            runs(shown["settings"])


def centre(page, selector):
    """The middle of an element on the screen."""
    box = page.locator(selector).first.bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def control(name):
    """Selector of a control by its name."""
    return f"[data-control='{name}']"


def end_kernel(page, server, name):
    """End the kernel of a notebook."""
    for session in page.request.get("/api/sessions").json():
        if session["path"] == name:
            cookie = {c["name"]: c["value"] for c in page.context.cookies()}
            headers = {"X-XSRFToken": cookie.get("_xsrf", ""), "Referer": server.url}
            page.request.delete(f"/api/kernels/{session['kernel']['id']}", headers=headers)


def drag_by_mouse(page, handle):
    """Drag a handle of the picture a little to the right and up."""
    x, y = centre(page, handle)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 9, y - 6, steps=4)
    page.mouse.up()


def drag_by_touch(page, handle):
    """Drag a handle with a finger."""
    x, y = centre(page, handle)
    session = page.context.new_cdp_session(page)
    for kind, step in (("touchStart", 0), ("touchMove", 4), ("touchMove", 9), ("touchEnd", None)):
        points = [] if step is None else [{"x": x + step, "y": y - step}]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    session.detach()


def drag_by_keys(page, handle):
    """Move a handle with the arrow keys."""
    page.focus(handle)
    for key in ("ArrowRight", "ArrowUp", "Shift+ArrowUp", "ArrowDown", "ArrowLeft", "ArrowLeft"):
        page.keyboard.press(key)


MOVES = {
    "range": ("ArrowRight", "ArrowLeft"),
    "number": ("ArrowUp", "ArrowDown"),
    "checkbox": ("Space", "Space"),
    "select-one": ("ArrowDown", "ArrowUp"),
    "radio": ("ArrowDown", "ArrowUp"),
}
"""Keys that move a kind of control there and back."""


def moved_by_keyboard(page, moves=MappingProxyType(MOVES)):
    """Names of the controls on which the Tab key comes by, all that can be used and that keys move there and back."""
    page.evaluate("tests.unfold()")
    wanted = set(page.evaluate("tests.stops()"))
    reached = []
    page.evaluate("tests.listen()")
    page.locator(".percept-lab [data-control]:visible").first.focus()
    for _ in range(2 * len(wanted)):
        now = page.evaluate("tests.focused()")
        if reached and not now["there"]:
            break
        reached.append(now["name"])
        there, back = moves.get(now["kind"], ("", ""))
        if there:
            page.keyboard.press(there)
            page.keyboard.press(back)
            moved = page.evaluate("tests.focused()")
            assert moved["moved"], now["name"]
            if not moved["back"]:  # it stood at its end
                page.keyboard.press(there)
        page.keyboard.press("Tab")
    assert sorted(wanted - set(reached)) == []
    return reached


def serious_violations(page, widths=("", "400px")):
    """Serious and critical findings of axe-core inside the lab, everything open, at some widths."""
    axe = FRONT / "node_modules/axe-core/axe.min.js"
    if not axe.exists():
        missing("node", f"axe-core is missing: run npm ci in {FRONT}.")
    page.evaluate("tests.unfold()")
    page.evaluate(axe.read_text("utf-8"))
    serious = []
    for width in widths:
        page.evaluate("(width) => tests.width(width)", width)
        rules, found = page.evaluate("tests.violations()")
        assert rules > 10
        serious += found
    page.evaluate("tests.width('')")
    return serious
