"""A lab in a page of its own, without JupyterLab; Python answers it if it is asked to."""

import base64
import json
import re
from contextlib import contextmanager
from pathlib import Path

from lab_browser import rested
from lab_settings import FRONT
from places import NOTEBOOKS

PAGE = '<!doctype html><meta charset="utf-8"><title>A lab</title><body><script type="module" src="/start.js"></script>'
START = Path(__file__).with_name("alone.js").read_text("utf-8")
DRAWN = "() => tests.drawn()"
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
        "/start.js": ("text/javascript", START.replace("STATE_OF_THE_LAB", json.dumps(told))),
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
    page.evaluate("tests.unfold()")
    yield page
    assert wrong == []
    assert page.evaluate("window.refused") == []
    page.close()
