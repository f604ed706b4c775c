"""A lab that nbconvert saved in a page is whole: every observer and every output work where there is no Python."""

import json
import re
import subprocess
import sys

import pytest
from jupyter_harness import NOTEBOOKS
from lab_browser import assert_equals_python, control, state
from lab_settings import ALL, KEYS

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SAVED = re.compile(r'<script type="application/vnd.jupyter.widget-state\+json">(.*?)</script>', re.DOTALL)

SHOW = """async ({ state, buffers }) => {
    for (const { path, data } of buffers) {
        state[path[0]] = new DataView(Uint8Array.from(atob(data), (c) => c.charCodeAt(0)).buffer);
    }
    const model = {
        get: (name) => state[name],
        set: (name, value) => (state[name] = value),
        save_changes: () => { throw new Error("there is no Python"); },
        on: () => {},
        off: () => {},
    };
    const text = new Blob([state._esm], { type: "text/javascript" });
    const bundle = await import(URL.createObjectURL(text));
    await bundle.default.render({ model, el: document.body });
}"""

DRAWN = "() => { const [lab] = window.perceptObsLabs; return lab.shown?.settings === lab.settings && !lab.pending; }"
FOUND = """() => { const [lab] = window.perceptObsLabs; return {
    runs: lab.shown.runs.filter((run) => run.estimate.some((v) => Number.isFinite(v))).map((run) => run.name),
    refused: Object.keys(lab.kernels.refused(lab.settings)),
}; }"""


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """What the page of notebook 00 keeps of its lab."""
    folder = tmp_path_factory.mktemp("page")
    command = [sys.executable, "-m", "nbconvert", "--to", "html", "--execute", "--output-dir", str(folder)]
    subprocess.run([*command, NOTEBOOKS / "00_start.ipynb"], check=True, capture_output=True, cwd=folder)
    (text,) = SAVED.findall((folder / "00_start.html").read_text())
    (lab,) = [widget for widget in json.loads(text)["state"].values() if "_esm" in widget["state"]]
    return lab


@pytest.fixture
def page(chromium, saved):
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
        page = browser.new_page(offline=True)
        page.evaluate(SHOW, saved)
        page.wait_for_function(DRAWN)
        yield page
        browser.close()


def test_every_observer_with_every_output_on_every_surface(page):
    for key in KEYS:
        surface, outputs = key.split(" ")
        page.select_option(control("surface"), surface)
        page.check(control(f"outputs {outputs}"))
        for name in ALL:
            box = page.locator(control(f"observer {name}"))
            if box.is_enabled():
                box.check()
        page.wait_for_function(DRAWN)
        found = page.evaluate(FOUND)
        assert {*found["runs"], *found["refused"]} == set(ALL), key
        assert page.locator(".problem:not([hidden])").count() == 0
    assert "There is no Python here" in page.inner_text(".silence")


def test_what_it_draws_is_what_python_computes(page):
    page.check(control("outputs y1"))
    page.check(control("observer extended_kalman"))
    page.select_option(control("surface"), "chained")
    page.wait_for_function(DRAWN)
    assert_equals_python(state(page))
