"""Two labs are alive in every front end: they draw, follow mouse and keys, and outlive Python.

JupyterLab and the site are tried in all runs, by tests of their own; ALL_SAMPLES=1 tries every front end that is there.
"""

import re
import shutil
from contextlib import ExitStack
from importlib.util import find_spec
from pathlib import Path

import pytest
from browsers import OPTIONS, knowing
from browsers import playwright as playwright_here
from front_ends import TRIALS, in_a_saved_file, in_jupyterlab, in_marimo, in_notebook, in_voila, marimo
from jupyter_harness import jupyterlab
from lab_alone import stated_policy
from needs import missing

from percept_obs.labs.shared.lab import BUNDLE
from percept_obs.site.front_ends import BROWSERS, FRONT_ENDS, INSTALL, POLICY, RULES, TRIED, page

OPEN = {
    "JupyterLab": (in_jupyterlab, "jupyterlab", "jupyter"),
    "Notebook 7": (in_notebook, "notebook", "jupyter"),
    "Voila": (in_voila, "voila", "jupyter"),
    "marimo": (in_marimo, "marimo", "marimo_apps"),
    "saved file": (in_a_saved_file, "percept_obs", "folder"),
}
"""For each: the function that opens it, the module that it needs, and the fixture to open it with."""
EVERYWHERE = [
    pytest.param(f"{end} in {browser}", marks=[pytest.mark.night] * (f"{end} in {browser}" != "saved file in Chromium"))
    for browser in BROWSERS
    for end in OPEN
]


@pytest.fixture(scope="module")
def playwright():
    with playwright_here() as playwright:
        yield playwright


@pytest.fixture(scope="module")
def browsers(request, playwright):
    """Opens a browser by its name, once."""

    def chromium():
        path = request.getfixturevalue("chromium")
        return playwright.chromium.launch(executable_path=path, args=list(OPTIONS))

    def firefox():
        if Path(playwright.firefox.executable_path).exists():
            return playwright.firefox.launch()
        own = shutil.which("firefox-esr") or shutil.which("firefox")
        if not own:
            missing("firefox", "Firefox is missing; get it with: python -m playwright install firefox")
        # Spoken to by WebDriver BiDi, of which Playwright asks for as much as the Firefox of its day knows.
        return playwright.firefox.launch(channel="moz-firefox", executable_path=own)

    opened = {}
    ways = {"Chromium": chromium, "Firefox": firefox}
    yield lambda name: opened.get(name) or opened.setdefault(name, knowing(ways[name]()))
    for browser in opened.values():
        browser.close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("pages")


@pytest.fixture(scope="module")
def jupyter(tmp_path_factory):
    """One server, which serves JupyterLab, Notebook 7 and Voila."""
    with jupyterlab(tmp_path_factory.mktemp("notebooks"), tmp_path_factory.mktemp("server")) as server:
        yield server


@pytest.fixture(scope="module")
def marimo_apps(tmp_path_factory):
    """Starts a server of the example app, a new one each time, for a test ends it."""
    with ExitStack() as servers:
        yield lambda: servers.enter_context(marimo(tmp_path_factory.mktemp("marimo")))


@pytest.fixture(scope="module", params=EVERYWHERE)
def shown(request, browsers, tmp_path_factory):
    """Labs in a front end, in a browser."""
    name, _, browser = request.param.partition(" in ")
    open_in, module, resource = OPEN[name]
    if find_spec(module) is None:
        missing(module, f"{name} is missing; get it with: {INSTALL[name]}")
    given = request.getfixturevalue(resource)
    page = browsers(browser).new_page(viewport={"width": 1280, "height": 900}, base_url=getattr(given, "url", None))
    page.set_default_timeout(30_000)
    try:
        yield open_in(page, given)
    finally:
        page.context.close()  # else one that did not open goes on saving its notebook


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.parametrize("what", TRIED)
def test_a_lab_is_alive(shown, what):
    TRIALS[what](shown)


def test_the_table_says_what_is_tried():
    known = {name: set(cells.values()) for name, cells in FRONT_ENDS.items()}
    assert {name for name, ways in known.items() if ways - set(RULES)} == {*OPEN, "this site"}
    assert set(RULES) <= set().union(*known.values())
    assert list(TRIALS) == list(TRIED)
    assert {row.count("|") for row in page().splitlines() if row.startswith("|")} == {len(TRIED) + 3}
    assert {row.split(" | ")[0][2:] for row in page().splitlines() if " | nobody | " in row} == {
        "JupyterLite",
        "VS Code",
        "Colab",
    }


def test_the_bundle_keeps_the_rules():
    text = BUNDLE.read_text("utf-8")
    assert len(re.findall(r"\bimport\s*[({*]", text)) == len(re.findall(r"createObjectURL\(", text)) - 1 == 1
    evaluates, fetches = r"\beval\s*\(|\bFunction\s*\(", r"\bfetch\(|XMLHttpRequest|WebSocket|importScripts"
    assert not re.search(f"{evaluates}|{fetches}|msg:custom", text)


def test_the_policy_is_that_of_readme():
    assert stated_policy() == POLICY
