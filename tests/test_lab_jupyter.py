"""Labs in JupyterLab: they follow the hand, tell the kernel, outlive it, and stand side by side."""

import pytest
from jupyter_harness import jupyterlab, lab_page, log_entries, open_notebook, run_all, wait_until
from lab_browser import (
    OPEN,
    UNFOLD,
    assert_equals_python,
    assert_python_has,
    control,
    drag_by_mouse,
    end_kernel,
    open_lab,
    open_unfolded,
    painted,
    rested,
    state,
    write_notebook,
)
from structure_settings import assert_same_structure_runs
from test_desk import RIGHT
from test_lab_layout import WALK

from percept_obs.labs import structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

FOE = control("foe")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("notebooks")


@pytest.fixture(scope="module")
def server(folder, tmp_path_factory):
    with jupyterlab(folder, tmp_path_factory.mktemp("server")) as running:
        yield running


@pytest.fixture(scope="module")
def browser_page(chromium, server, tmp_path_factory):
    with lab_page(chromium, server, tmp_path_factory.mktemp("browser")) as page:
        page.set_default_timeout(15_000)
        yield page


@pytest.fixture(scope="module")
def lab(browser_page, folder):
    """A page with one lab that the tests of this module share."""
    open_lab(browser_page, folder)
    return browser_page


def test_the_hand_moves_the_picture_and_the_kernel_hears_of_it(fresh, folder):
    before = state(fresh)
    drag_by_mouse(fresh, FOE)
    rested(fresh)
    after = state(fresh)
    assert after["settings"]["b"] != before["settings"]["b"]
    assert_equals_python(after)
    assert_python_has(folder, after["settings"])
    assert not log_entries(fresh)


def test_pictures_are_in_view_whichever_control_has_the_focus(fresh):
    fresh.set_viewport_size({"width": 1280, "height": 800})
    painted(fresh)
    rested(fresh)
    found = fresh.evaluate(WALK)
    fresh.set_viewport_size({"width": 1280, "height": 900})
    assert found["wrong"] == []
    assert found["walked"] > 60


def test_keys_stay_in_the_lab(fresh):
    fresh.focus(FOE)
    cells = fresh.locator(".jp-Cell").count()
    for key in ("a", "b", "d", "d", "x", "m", "Enter", "Escape"):
        fresh.keyboard.press(key)
    assert fresh.locator(".jp-Cell").count() == cells
    assert fresh.locator(".jp-MarkdownCell").count() == 0


def test_python_may_set_the_settings_and_says_what_is_wrong(browser_page, folder, server):
    page = browser_page
    cells = [
        OPEN.format(arguments=""),
        "lab.settings = {**lab.settings, 'outputs': ['y2'], 'observers': ['extended_kalman']}",
        "type(lab).analyse = lambda self: 1 / 0",
    ]
    write_notebook(folder, "set.ipynb", *cells)
    open_notebook(page, "set.ipynb")
    run_all(page)
    page.wait_for_function("[...window.perceptObsLabs][0].shown?.settings.outputs[0] === 'y2'", timeout=120_000)
    assert_equals_python(state(page))
    page.evaluate(UNFOLD)
    page.fill(control("seed number"), "3")
    page.wait_for_selector(".percept-obs-error:not([hidden])")
    assert "ZeroDivisionError" in page.inner_text(".percept-obs-error:not([hidden])")
    shown = state(page)
    assert shown["settings"]["seed"] == 3


def test_two_labs_live_side_by_side_and_a_cell_replaces_its_own(browser_page, folder):
    page = browser_page
    second = "other = observer_lab(outputs=['y1'])\nother"
    write_notebook(folder, "two.ipynb", OPEN.format(arguments=""), second, "print('open:', other.comm is not None)")
    open_unfolded(page, "two.ipynb")
    first, other = state(page, 0), state(page, 1)
    page.locator(control("seed number")).nth(1).fill("9")
    rested(page)
    assert state(page, 0) == first
    assert state(page, 1)["settings"] == {**other["settings"], "seed": 9}
    run_all(page)
    page.wait_for_function("document.querySelectorAll('.percept-lab').length === 2")
    page.wait_for_function("window.perceptObsLabs.size === 2")
    rested(page)
    assert state(page, 1)["settings"] == other["settings"]


def test_the_lab_outlives_its_kernel_and_says_so(browser_page, folder, server):
    page = browser_page
    open_lab(page, folder, "dead.ipynb")
    end_kernel(page, server, "dead.ipynb")
    page.fill(control("identifier_based gain number"), "4")
    page.wait_for_selector(".silence:not([hidden])")
    assert "Python has not answered yet" in page.inner_text(".silence")
    page.check(control("outputs y1"))
    page.check(control("observer spica"))
    page.wait_for_function(
        "() => { const [l] = window.perceptObsLabs; return l.shown.runs.length === 2 && !l.pending; }"
    )
    shown = state(page)
    assert shown["settings"]["outputs"] == ["y1"]
    assert_equals_python(shown)


def test_a_restarted_kernel_leaves_the_lab_alive_and_opens_a_new_one(browser_page, folder):
    page = browser_page
    open_lab(page, folder, "again.ipynb")
    page.click(".lm-MenuBar-item:has-text('Kernel')")
    page.click(".lm-Menu-item[data-command='kernelmenu:restart']")
    page.click(".jp-Dialog-button.jp-mod-accept")
    page.wait_for_selector(".jp-Notebook-ExecutionIndicator[data-status=idle]")
    page.fill(control("identifier_based gain number"), "4")
    page.wait_for_function("[...window.perceptObsLabs][0].shown.settings.gains.identifier_based.gain === 4")
    assert_equals_python(state(page))
    run_all(page)
    page.wait_for_function("window.perceptObsLabs.size === 1")
    rested(page)
    assert state(page)["settings"]["gains"]["identifier_based"]["gain"] == 10


def test_a_notebook_whose_kernel_has_ended_says_how_its_lab_comes_back(browser_page, folder):
    page = browser_page
    open_lab(page, folder, "ended.ipynb")
    ended = page.locator(".percept-obs-ended")
    ended.wait_for(state="attached")
    assert ended.is_hidden()
    page.keyboard.press("Control+s")
    wait_until(lambda: "percept-obs-ended" in (folder / "ended.ipynb").read_text(), "the notebook to be saved")
    (session,) = [s for s in page.request.get("/api/sessions").json() if s["path"] == "ended.ipynb"]
    xsrf = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "_xsrf")
    page.request.delete(f"/api/sessions/{session['id']}", headers={"X-XSRFToken": xsrf})
    open_notebook(page, "ended.ipynb")
    ended.wait_for(state="visible")
    assert "Run its cell again" in ended.inner_text()
    assert page.get_by_text("model not found").locator("visible=true").count() == 0
    run_all(page)
    page.wait_for_function("window.perceptObsLabs?.size === 1")
    ended.wait_for(state="hidden")


def test_the_kernel_may_be_busy_while_the_lab_is_moved(browser_page, folder):
    page = browser_page
    write_notebook(folder, "busy.ipynb", OPEN.format(arguments=""), "import time; time.sleep(2)")
    open_notebook(page, "busy.ipynb")
    page.click(".lm-MenuBar-item:has-text('Run')")
    page.click(".lm-Menu-item[data-command='runmenu:run-all']")
    page.wait_for_function("window.perceptObsLabs?.size && [...window.perceptObsLabs][0].shown")
    page.evaluate(UNFOLD)
    for seed in range(1, 6):
        page.fill(control("seed number"), str(seed))
        page.wait_for_function(f"[...window.perceptObsLabs][0].shown.settings.seed === {seed}")
    rested(page)
    assert_python_has(folder, {"seed": 5})
    assert not log_entries(page)


def test_labs_of_two_kinds_live_side_by_side_and_outlive_their_kernel(browser_page, folder, server):
    page = browser_page
    write_notebook(
        folder,
        "kinds.ipynb",
        OPEN.format(arguments=""),
        *(f"from percept_obs.labs import {name}\n{name}()" for name in ("structure_lab", "points_lab")),
    )
    open_unfolded(page, "kinds.ipynb")
    settings = "(which) => [...window.perceptObsLabs][which].settings"
    before = [page.evaluate(settings, which) for which in range(3)]
    page.locator(control("seed number")).nth(1).fill("9")
    rested(page)
    assert [page.evaluate(settings, which) for which in range(3)] == [before[0], {**before[1], "seed": 9}, before[2]]
    end_kernel(page, server, "kinds.ipynb")
    page.click(control("corollary 6"))
    page.wait_for_selector(".silence:not([hidden])")
    page.wait_for_function(
        "() => { const [, lab] = window.perceptObsLabs; return lab.shown.settings === lab.settings; }"
    )
    shown = state(page, 1)
    told = {name: {"estimate": e, "divergedAt": shown["divergedAt"][name]} for name, e in shown["runs"].items()}
    assert_same_structure_runs(structure_lab(**shown["settings"]).settings, told)
    assert set(shown["settings"]["unknown"]) != set(before[1]["unknown"])


def test_the_kernel_answers_what_is_typed_at_the_desk(browser_page, folder):
    page = browser_page
    open_lab(page, folder, "desk.ipynb", "step=6", "derivation_desk")
    page.locator('[data-control="line rate 6 y1\'"]').press_sequentially(RIGHT, delay=5)
    page.locator(".mark.right").wait_for()
    rested(page)
    assert_python_has(folder, {"typed": {"rate 6 y1'": RIGHT}})
    assert log_entries(page) == ""
