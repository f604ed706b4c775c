"""Labs in JupyterLab: they follow the hand, tell the kernel, outlive it, and stand side by side."""

import shutil

import numpy as np
import pytest
from jupyter_harness import jupyterlab, lab_page, log_entries, open_notebook, run_all, wait_until
from lab_browser import (
    OPEN,
    assert_equals_python,
    assert_python_has,
    assert_structure_is_python,
    centre,
    control,
    drag_by_mouse,
    end_kernel,
    open_lab,
    open_unfolded,
    rested,
    state,
    write_notebook,
)
from notebook_exercises import FAILING
from places import NOTEBOOKS
from test_desk import RIGHT

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
        page.set_default_timeout(60_000)  # a kernel loads everything first, as where `run_all` waits
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


def test_keys_stay_in_the_lab(fresh):
    fresh.focus(FOE)
    cells = fresh.locator(".jp-Cell").count()
    for key in ("a", "b", "d", "d", "x", "m", "Enter", "Escape"):
        fresh.keyboard.press(key)
    assert fresh.locator(".jp-Cell").count() == cells
    assert fresh.locator(".jp-MarkdownCell").count() == 0


RUN_ALL = ".lm-Menu-item[data-command='runmenu:run-all']"
FIRST = "[...window.perceptObsLabs][0]"


@pytest.mark.night  # on a busy machine the kernel's settings and those of the hand do not come to rest in two minutes
def test_python_may_be_busy_set_the_settings_and_say_what_is_wrong(browser_page, folder):
    page = browser_page
    cells = [
        OPEN.format(arguments=""),
        "import time; time.sleep(2)",
        "lab.settings = {**lab.settings, 'outputs': ['y2'], 'observers': ['extended_kalman']}",
        "type(lab).analyse = lambda self: 1 / 0",
    ]
    write_notebook(folder, "set.ipynb", *cells)
    open_notebook(page, "set.ipynb")
    page.click(".lm-MenuBar-item:has-text('Run')")
    page.click(RUN_ALL)
    page.wait_for_function(f"window.perceptObsLabs?.size && {FIRST}.shown")
    page.wait_for_selector(".percept-lab details", state="attached")
    page.evaluate("tests.unfold()")
    for seed in range(1, 4):  # while the kernel sleeps
        page.fill(control("seed number"), str(seed))
        page.wait_for_function(f"{FIRST}.shown.settings.seed === {seed}")
    # a picture is drawn before all that is said of it is computed
    there = f"{FIRST}.shown?.settings.outputs[0] === 'y2' && {FIRST}.shown.whole && tests.drawn()"
    page.wait_for_function(there, timeout=120_000)
    assert_equals_python(state(page))
    page.fill(control("seed number"), "5")
    page.wait_for_selector(".percept-obs-error:not([hidden])")
    assert "ZeroDivisionError" in page.inner_text(".percept-obs-error:not([hidden])")
    page.wait_for_function(f"{FIRST}.shown.settings.seed === 5")


@pytest.mark.night  # half a minute of computing, for what few do
def test_labs_of_all_kinds_live_side_by_side_and_outlive_their_kernel(browser_page, folder, server):
    page = browser_page
    cells = [
        OPEN.format(arguments=""),
        "import percept_obs.labs as labs\nlabs.structure_lab(duration=3, period=0.01, step=0.01)",
        "from percept_obs.labs import points_lab\npoints_lab(duration=8.0)",  # one opens with its first screen
        "other = observer_lab(outputs=['y1'])\nother",
    ]
    write_notebook(folder, "kinds.ipynb", *cells)
    open_unfolded(page, "kinds.ipynb")
    settings = """() => [...document.querySelectorAll(".percept-lab")].map((root) =>
        [...window.perceptObsLabs].find((lab) => lab.view.root === root).settings)"""  # as they stand in the page
    before = page.evaluate(settings)
    page.locator(control("seed number")).nth(1).fill("9")
    rested(page)
    assert page.evaluate(settings) == [before[0], {**before[1], "seed": 9}, *before[2:]]
    run_all(page)  # each cell replaces its own lab
    page.wait_for_function("document.querySelectorAll('.percept-lab').length === 4")
    page.wait_for_function("window.perceptObsLabs.size === 4")
    rested(page)
    assert page.evaluate(settings) == before
    page.evaluate("tests.unfold()")
    end_kernel(page, server, "kinds.ipynb")
    page.click(control("corollary 6"))
    page.wait_for_selector(".silence:not([hidden])")
    assert "Python has not answered yet" in page.inner_text(".silence:not([hidden])")
    page.fill(f"{control('outputs')} >> nth=0", "0")
    page.check(f"{control('observer spica')} >> nth=0")
    page.wait_for_function("() => [...window.perceptObsLabs].every((lab) => lab.shown.settings === lab.settings)")
    changed = "(lab) => lab.settings.observers?.includes('spica')"
    page.wait_for_function(f"() => [...window.perceptObsLabs].find({changed})?.shown.runs.length === 2")
    page.wait_for_function("() => ![...window.perceptObsLabs].some((lab) => lab.pending)")
    first = page.evaluate(f"() => [...window.perceptObsLabs].findIndex({changed})")
    assert_equals_python(state(page, first))
    drawn = page.evaluate("() => [...window.perceptObsLabs].findIndex((lab) => lab.settings.unknown)")  # in any order
    shown = state(page, drawn)
    assert_structure_is_python(shown)
    assert set(shown["settings"]["unknown"]) != set(before[1]["unknown"])


@pytest.mark.night  # half a minute of computing, for what few do
def test_a_restarted_kernel_leaves_the_lab_alive_and_one_that_has_ended_says_how_it_comes_back(browser_page, folder):
    page = browser_page
    open_lab(page, folder, "again.ipynb")
    page.click(".lm-MenuBar-item:has-text('Kernel')")
    page.click(".lm-Menu-item[data-command='kernelmenu:restart']")
    page.click(".jp-Dialog-button.jp-mod-accept")
    page.wait_for_selector(".jp-Notebook-ExecutionIndicator[data-status=idle]")
    page.fill(control("gain"), "0.6")
    page.wait_for_function(f"{FIRST}.shown.settings.gains.identifier_based.gain === 3.98")
    assert_equals_python(state(page))
    run_all(page)
    page.wait_for_function("window.perceptObsLabs.size === 1")
    rested(page)
    assert state(page)["settings"]["gains"]["identifier_based"]["gain"] == 10
    ended = page.locator(".percept-obs-ended")
    ended.wait_for(state="attached")
    assert ended.is_hidden()
    page.keyboard.press("Control+s")
    wait_until(lambda: "percept-obs-ended" in (folder / "again.ipynb").read_text("utf-8"), "the notebook to be saved")
    (session,) = [s for s in page.request.get("/api/sessions").json() if s["path"] == "again.ipynb"]
    xsrf = next(cookie["value"] for cookie in page.context.cookies() if cookie["name"] == "_xsrf")
    page.request.delete(f"/api/sessions/{session['id']}", headers={"X-XSRFToken": xsrf})
    open_notebook(page, "again.ipynb")
    ended.wait_for(state="visible")
    assert "Run its cell again" in ended.inner_text()
    assert page.get_by_text("model not found").locator("visible=true").count() == 0
    run_all(page)
    page.wait_for_function("window.perceptObsLabs?.size === 1")
    ended.wait_for(state="hidden")


def test_the_kernel_answers_what_is_typed_at_the_desk(browser_page, folder):
    page = browser_page
    open_lab(page, folder, "desk.ipynb", "step=6", "derivation_desk")
    page.locator('[data-control="line rate 6 y1\'"]').press_sequentially(RIGHT, delay=5)
    page.locator(".mark.right").wait_for()
    rested(page)
    assert_python_has(folder, {"typed": {"rate 6 y1'": RIGHT}})
    assert page.locator(".view.motion").bounding_box()["height"] >= 240
    assert page.locator(".view.misses").bounding_box()["height"] >= 100
    assert log_entries(page) == ""


PLAYED = f"() => !{FIRST}.screen.clock.playing && !{FIRST}.screen.clock.secret"
SETTLED = f"() => {FIRST}.shown.runs[0].settling"


@pytest.mark.night  # each thing that it does has a test of its own
def test_the_first_notebook_does_its_experiments_in_jupyterlab(browser_page, folder):
    page = browser_page
    shutil.copy(NOTEBOOKS / "00_start.ipynb", folder)
    open_notebook(page, "00_start.ipynb")
    run_all(page)
    rested(page)
    page.locator(control("play")).scroll_into_view_if_needed()
    page.wait_for_function(PLAYED)
    assert page.inner_text(".says").startswith("Found")
    assert page.evaluate(SETTLED) == pytest.approx(2.25)

    page.mouse.move(*centre(page, control("foe")))
    page.mouse.down()
    page.mouse.move(*centre(page, control("point")), steps=5)
    page.mouse.up()
    rested(page)
    assert page.evaluate(SETTLED) == np.inf
    page.click(control("why"))
    np.testing.assert_allclose(page.evaluate(f"() => {FIRST}.screen.seen.copies"), 0, atol=1e-9)

    page.click(control("again"))
    rested(page)
    for key, seconds in (("Home", 2.55), ("End", np.inf)):  # y1, y2
        page.locator(control("outputs")).press(key)
        rested(page)
        assert page.evaluate(SETTLED) == pytest.approx(seconds)

    page.click(control("again"))
    page.fill(control("gain"), "1.48")
    rested(page)
    assert page.evaluate(f"() => {FIRST}.settings.gains.identifier_based.gain") == 30
    assert page.evaluate(SETTLED) == pytest.approx(0.80)
    page.fill(control("noise size"), "0.0025")
    rested(page)
    assert page.evaluate(SETTLED) > 1.5

    assert_equals_python(state(page))
    assert log_entries(page) == ""


@pytest.mark.night  # the kernel's part of it is held with the notebooks
def test_an_error_in_a_callback_reaches_the_log_console(browser_page, folder):
    page = browser_page
    write_notebook(folder, "failing.ipynb", FAILING + "slider")
    open_notebook(page, "failing.ipynb")
    run_all(page)
    handle = page.locator(".noUi-handle")
    handle.focus()
    handle.press("ArrowRight")
    page.wait_for_function("() => tests.log()")
