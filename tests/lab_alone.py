"""Labs alone on a page of their own, without Jupyter: served under a content policy, and drawn by a real browser."""

import base64
import json
import re

from jupyter_harness import NOTEBOOKS
from lab_settings import FRONT

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


def opened(browser, lab, policy=None, **context):
    """A page with a lab and nothing else, served under a policy; by itself under the one that README states."""
    told = {name: getattr(lab, name) for name in ("kind", "model", "settings", "summary", "analysis", "error")}
    told["texts"] = base64.b64encode(lab.texts).decode()
    files = {
        "/": ("text/html", PAGE),
        "/start.js": ("text/javascript", f"const STATE = {json.dumps(told)};\n{START}"),
        "/lab.js": ("text/javascript", (FRONT / "lab.js").read_text()),
    }
    page = browser.new_page(**context)
    headers = {"Content-Security-Policy": policy or stated_policy()}

    def answer(route):
        kind, body = files[route.request.url.removeprefix("http://lab.test")]
        route.fulfill(body=body, content_type=kind, headers=headers)

    page.route("http://lab.test/**", answer)
    page.goto("http://lab.test/")
    return page
