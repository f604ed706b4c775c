"""A lab in a page of its own, without JupyterLab; Python answers it if it is asked to."""

import base64
import json
import re
from contextlib import contextmanager

from lab_browser import UNFOLD, rested
from lab_settings import FRONT
from places import NOTEBOOKS

PAGE = '<!doctype html><meta charset="utf-8"><title>A lab</title><body><script type="module" src="/start.js"></script>'
START = """
import bundle from "/lab.js";
window.refused = [];
document.addEventListener("securitypolicyviolation", (event) => window.refused.push(event.violatedDirective));
const binary = (text) => new DataView(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
const frames = STATE.frames.map((film) => ({ ...film, images: film.images.map(binary) }));
const state = { ...STATE, texts: binary(STATE.texts), frames };
const listeners = {};
const TOLD = ["view", "settings", "summary"];
window.held = null;  // a list, while answers are to be held back
window.heard = (found) => {
    Object.assign(state, found);
    for (const name of Object.keys(found)) for (const hear of listeners[`change:${name}`] ?? []) hear();
};
const model = {
    get: (name) => state[name],
    set: (name, value) => (state[name] = value),
    save_changes: () => window.toPython?.(Object.fromEntries(TOLD.map((name) => [name, state[name] ?? {}])))
        .then((found) => (window.held ? window.held.push(found) : window.heard(found))),
    on: (event, listener) => (listeners[event] ??= []).push(listener),
    off: (event, listener) => (listeners[event] = listeners[event].filter((each) => each !== listener)),
};
bundle.render({ model, el: document.body });
"""
DRAWN = """() => {
    const [lab] = window.perceptObsLabs ?? [];
    return lab?.shown && lab.shown.settings === lab.settings && !lab.pending && lab.settled !== false;
}"""
"""Pictures and words are of the present settings."""


def stated_policy():
    """The policy that the page on labs says is enough."""
    text = (NOTEBOOKS.parent / "percept_obs/site/texts/use_labs.md").read_text("utf-8")
    return re.search(r"`(default-src[^`]*)`", text)[1]


def opened(browser, lab, policy=None, answers=None, **options):
    """A page with a lab and nothing else, served under the stated policy or another; `answers` is for its messages.

    It shows the end of its run at once, unless motion is asked for.
    """
    told = {
        name: getattr(lab, name)
        for name in ("kind", "model", "settings", "view", "summary", "analysis", "error", "written")
    }
    told["texts"] = base64.b64encode(lab.texts).decode()
    films = getattr(lab, "frames", [])
    told["frames"] = [{**f, "images": [base64.b64encode(i).decode() for i in f["images"]]} for f in films]
    bundle = (FRONT / "lab.js").read_text("utf-8")
    told["_esm"] = bundle
    files = {
        "/": ("text/html", PAGE),
        "/start.js": ("text/javascript", f"const STATE = {json.dumps(told)};\n{START}"),
        "/lab.js": ("text/javascript", bundle),
    }
    page = browser.new_page(**{"reduced_motion": "reduce", **options})
    headers = {"Content-Security-Policy": policy or stated_policy()}

    def answer(route):
        kind, body = files[route.request.url.removeprefix("http://lab.test")]
        route.fulfill(body=body, content_type=kind, headers=headers)

    if answers:
        page.expose_function("toPython", answers)
    page.route("http://lab.test/**", answer)
    page.goto("http://lab.test/")
    return page


def following(lab):
    """Return the function that answers the page's messages as Python would."""

    def answers(message):
        lab.set_state(message)
        return {name: getattr(lab, name) for name in ("analysis", "error", "written")}

    return answers


@contextmanager
def answered(browser, lab, **options):
    """A page with a lab at rest that Python answers, the drawer unfolded; no error of the page is left unseen."""
    page, wrong = opened(browser, lab, answers=following(lab), **options), []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.set_default_timeout(15_000)
    rested(page)
    page.evaluate(UNFOLD)
    yield page
    assert wrong == []
    assert page.evaluate("window.refused") == []
    page.close()
