"""Labs in a real JupyterLab: opening them, moving them, and reading what they draw."""

import json
import time
from pathlib import Path
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

WIDTH = "(width) => { document.querySelector('.percept-lab').parentElement.style.width = width; }"

COLOURS = "() => [...window.perceptObsLabs][0].theme?.lines.join()"

PAINTED = """async () => {
    for (let k = 0; k < 3; k++) await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
}"""

OUTSIDE = """() => {
    const lab = document.querySelector('.percept-lab');
    return [...lab.querySelectorAll('canvas, .actions, .control')].filter(
        (e) => e.getBoundingClientRect().right > lab.getBoundingClientRect().right + 1).map((e) => e.className);
}"""
"""Elements that are wider than their lab."""

RESTED = """() => [...(window.perceptObsLabs ?? [])].length > 0 && [...window.perceptObsLabs].every(
    (lab) => lab.shown && lab.shown.settings === lab.settings && !lab.pending && lab.resting === null
        && lab.link.waitingFor === null && lab.link.sent?.settings === lab.settings
        && lab.settled !== false)"""

STATE = """(which) => {
    const lab = [...window.perceptObsLabs][which];
    const { settings, shown, screen, state, view: { root } } = lab;
    const numbers = (values) => Array.from(values, (v) => (Number.isFinite(v) ? v : null));
    const runs = shown.runs ?? [{ ...shown, name: "points" }];  // many points are one run
    const by = (pick) => Object.fromEntries(runs.map((run) => [run.name, pick(run)]));
    const charts = { first: screen.chart, ...Object.fromEntries(state.view.charts.map((n) => [n, screen.charts[n]])) };
    const drawn = Object.entries(charts).filter(([, { chart }]) => chart && !shown.problem);
    const of = (pick) => Object.fromEntries(drawn.map(([name, { chart }]) => [name, pick(chart)]));
    const told = shown.problem ? { verdicts: [], reasons: [] } : lab.told();
    const verdicts = told.verdicts.map(({ title, text }) => `${title}: ${text}`);
    const said = (selector) => [...root.querySelectorAll(selector)].map((node) => node.textContent);
    return {
        settings,
        runs: by((run) => numbers(run.estimate)),
        divergedAt: by((run) => run.divergedAt),
        drawn: of(({ lines }) => lines.map(({ id, values }) => ({ name: id, values: numbers(values) }))),
        bars: of(({ bars }) => bars?.rows.flat().length ?? 0),
        verdicts,
        words: [...verdicts, ...told.reasons, ...(lab.answered()?.sentences ?? [])].join(" "),
        labels: screen.views.filter(({ figure }) => !figure.hidden).map(({ canvas }) => canvas.ariaLabel),
        problems: said(".problem:not([hidden])"),
        notice: root.querySelector(".notice").textContent,
        silent: !root.querySelector(".silence").hidden,
    };
}"""

FUZZ = Path(__file__).with_name("lab_fuzz.js").read_text("utf-8")
EVENTS = sampled(100, 10_000)
"""Random events in each lab, about one for each control."""
MOVED = sampled(4, 1)
"""One in so many controls that the Tab key reaches is moved by its keys."""

UNFOLD = """() => {
    for (const lab of window.perceptObsLabs) {
        const { drawer } = lab;
        for (const fold of lab.view.root.querySelectorAll("details")) fold.open = true;
        if (!drawer || drawer.unfolded) continue;
        const show = drawer.show.bind(drawer);
        drawer.unfolded = true;
        drawer.show = () => {
            show();
            drawer.body.hidden = false;
            drawer.panel.show();
            for (const fold of drawer.folds) fold.open = true;
            if (lab.shown?.whole && !lab.shown.problem) for (const group of drawer.groups) group.show?.();
        };
        lab.state.amend({ view: { ...lab.state.view, more: "words" } });
        lab.looked();
    }
}"""
"""Open the drawers with all their groups at once, so that every control can be tried."""
RESET = "() => [...window.perceptObsLabs][0].screen.again()"
"""Put the first lab back to its opening, as its button does."""

USABLE = """() => [...[...window.perceptObsLabs][0].view.root.querySelectorAll("[data-control]")]
    .filter((control) => !control.disabled && control.checkVisibility()).map((control) => control.dataset.control)"""


def usable(page):
    """Names of the controls of the first lab that can be used now."""
    return set(page.evaluate(USABLE))


def used_at_random(page, seed, wanted=frozenset(), count=EVENTS, most=20_000):
    """Names of the controls that random events used, a few more for wanted ones that are left; nothing goes wrong."""
    used = set()
    for more in range(4):
        left = sorted(wanted - used) if more else []
        if more and not left:
            break
        if more:
            page.evaluate(RESET)  # what could be used at the start can be used again
            rested(page, 60)
        found = page.evaluate(FUZZ, [seed + 1000 * more, 100 if more else count, most, left])
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
    page.evaluate(UNFOLD)


def rested(page, patience=30):
    """Wait until every lab shows its latest settings and Python has answered."""
    page.wait_for_function(RESTED, timeout=1000 * patience)


def painted(page):
    """Wait until what has changed is laid out and handed to the screen, and what that changes as well."""
    page.evaluate(PAINTED)


def state(page, which=0):
    """Settings, estimates, lines and words of a lab of the page."""
    return page.evaluate(STATE, which)


def assert_fits(page, width):
    """In a cell of so many pixels nothing of the lab is cut."""
    page.evaluate(WIDTH, f"{width}px")
    painted(page)
    assert page.evaluate(OUTSIDE) == []
    page.evaluate(WIDTH, "")


def assert_own_colours(page):
    """In the dark the lab draws in other colours."""
    light = page.evaluate(COLOURS)
    page.evaluate("document.body.dataset.jpThemeLight = 'false'")
    page.wait_for_function(f"(light) => {{ const now = ({COLOURS})(); return now && now !== light; }}", arg=light)
    page.evaluate("document.body.dataset.jpThemeLight = 'true'")
    page.wait_for_function(f"(light) => ({COLOURS})() === light", arg=light)


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

LISTEN = """() => {
    window.moved = false;
    window.value = (node) => `${node.value} ${node.checked}`;
    document.addEventListener("keyup", ({ target }) => {
        window.moved ||= target !== window.focused || target.opening !== value(target);
    }, true);
}"""
FOCUSED = """async () => {
    await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
    const node = document.activeElement;
    node.opening ??= value(node);
    const [there, back] = [Boolean(node.closest(".percept-lab")), node.opening === value(node)];
    const found = { name: node.dataset.control ?? "", kind: node.type, there, back, moved };
    Object.assign(window, { focused: node, moved: false });
    return found;
}"""


def moved_by_keyboard(page, moves=MappingProxyType(MOVES)):
    """Names of the controls on which the Tab key comes by, all that can be used, one in `MOVED` moved by keys."""
    page.evaluate(UNFOLD)
    wanted = set(
        page.evaluate("""() => [...document.querySelectorAll('.percept-lab [data-control]')]
            .filter((c) => c.checkVisibility() && !c.disabled && (c.type !== "radio" || c.checked))
            .map((c) => c.dataset.control)""")
    )
    reached = []
    page.evaluate(LISTEN)
    page.locator(".percept-lab [data-control]:visible").first.focus()
    for _ in range(2 * len(wanted)):
        now = page.evaluate(FOCUSED)
        if reached and not now["there"]:
            break
        reached.append(now["name"])
        there, back = moves.get(now["kind"], ("", ""))
        if there and len(reached) % MOVED == 0:
            page.keyboard.press(there)
            page.keyboard.press(back)
            moved = page.evaluate(FOCUSED)
            assert moved["moved"], now["name"]
            if not moved["back"]:  # it stood at its end
                page.keyboard.press(there)
        page.keyboard.press("Tab")
    assert sorted(wanted - set(reached)) == []
    return reached


VIOLATIONS = """async () => {
    // Of rules that hold only one place is told: thousands of places would take longer than the search.
    const { passes, violations } = await axe.run(".percept-lab", { resultTypes: ["violations"] });
    const serious = violations.filter(({ impact }) => ["serious", "critical"].includes(impact));
    return [passes.length, serious.map(({ id, nodes }) => [id, nodes.map(({ html }) => html)])];
}"""


def serious_violations(page, widths=("", "400px")):
    """Serious and critical findings of axe-core inside the lab, everything open, at some widths."""
    axe = FRONT / "node_modules/axe-core/axe.min.js"
    if not axe.exists():
        missing("node", f"axe-core is missing: run npm ci in {FRONT}.")
    page.evaluate(UNFOLD)
    page.evaluate(axe.read_text("utf-8"))
    serious = []
    for width in widths:
        page.evaluate(WIDTH, width)
        rules, found = page.evaluate(VIOLATIONS)
        assert rules > 10
        serious += found
    page.evaluate(WIDTH, "")
    return serious
