"""The labs under the strict content policy that README states: scripts from `blob:`, inline styles, nothing else."""

import base64
import json
import re

import pytest
from jupyter_harness import NOTEBOOKS
from lab_settings import FRONT

from percept_obs.labs import observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LABS = {"observer": observer_lab, "structure": structure_lab, "points": points_lab}
PAGE = '<!doctype html><meta charset="utf-8"><title>A lab</title><body><script type="module" src="/start.js"></script>'
START = """
import bundle from "/lab.js";
window.refused = [];
document.addEventListener("securitypolicyviolation", (event) => window.refused.push(event.violatedDirective));
const bytes = Uint8Array.from(atob(STATE.texts), (c) => c.charCodeAt(0));
const state = { ...STATE, texts: new DataView(bytes.buffer) };
const model = {
    get: (name) => state[name], set: (name, value) => (state[name] = value), save_changes() {}, on() {}, off() {},
};
bundle.render({ model, el: document.body });
"""
DRAWN = """() => {
    const [lab] = window.perceptObsLabs ?? [];
    return lab?.shown && lab.shown.settings === lab.settings && !lab.pending;
}"""


def stated_policy():
    """The policy that README says is enough."""
    return re.search(r"`(default-src[^`]*)`", (NOTEBOOKS.parent / "README.md").read_text())[1]


@pytest.fixture(scope="module")
def browser(chromium):
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"])
        yield browser
        browser.close()


def opened(browser, lab, policy):
    """A page with a lab and nothing else, served under a policy."""
    told = {name: getattr(lab, name) for name in ("kind", "model", "settings", "summary", "analysis", "error")}
    told["texts"] = base64.b64encode(lab.texts).decode()
    files = {
        "/": ("text/html", PAGE),
        "/start.js": ("text/javascript", f"const STATE = {json.dumps(told)};\n{START}"),
        "/lab.js": ("text/javascript", (FRONT / "lab.js").read_text()),
    }
    page = browser.new_page()
    headers = {"Content-Security-Policy": policy}

    def answer(route):
        kind, body = files[route.request.url.removeprefix("http://lab.test")]
        route.fulfill(body=body, content_type=kind, headers=headers)

    page.route("http://lab.test/**", answer)
    page.goto("http://lab.test/")
    return page


@pytest.mark.parametrize("name", LABS)
def test_a_lab_works_under_the_policy_that_readme_states(browser, name):
    page = opened(browser, LABS[name](), stated_policy())
    page.wait_for_function(DRAWN)
    assert page.locator("canvas").count() > 2
    assert page.evaluate("window.refused") == []
    page.close()


def test_a_policy_that_forbids_blobs_is_named_in_the_lab(browser):
    page = opened(browser, observer_lab(), stated_policy().replace(" blob:", ""))
    page.wait_for_function("() => window.refused.length")
    page.locator(".problem:not([hidden])").first.wait_for()
    assert "must allow scripts from blob:" in page.locator(".problem:not([hidden])").first.inner_text()
    page.close()
