"""One browser for all tests of a room, in whose pages `window.tests` has what the scripts beside this file say."""

from contextlib import ExitStack, contextmanager
from pathlib import Path

import needs

FILES = ("page", "pictures", "beside", "events", "widths")
SCRIPTS = "\n".join(Path(__file__).with_name(f"{name}.js").read_text("utf-8") for name in FILES)
OPTIONS = ("--no-sandbox", "--disable-gpu")
_open = ExitStack()
_kept = {}


@contextmanager
def playwright():
    """Playwright: that of the tests' browser while it is open, else one that ends with the block."""
    from playwright.sync_api import sync_playwright

    if "playwright" in _kept:
        yield _kept["playwright"]
        return
    if why := needs.playwright_lacks():
        advice = "Debian: sudo apt-get install libatomic1 chromium-headless-shell."
        needs.missing("chromium", f"Playwright does not start. {advice} It says: {why}")
    with sync_playwright() as own:
        yield own


def knowing(browser):
    """A browser, or a context of one, whose new pages know `window.tests`."""
    new_page = browser.new_page

    def new_page_that_knows(**options):
        page = new_page(**options)
        page.add_init_script(SCRIPTS)
        page.goto("about:blank")
        return page

    browser.new_page = new_page_that_knows
    return browser


def shared(chromium):
    """The browser of this process, at the path of Chromium."""
    if "browser" not in _kept:
        _kept["playwright"] = _open.enter_context(playwright())
        opened = _kept["playwright"].chromium.launch(executable_path=chromium, args=list(OPTIONS))
        _open.callback(opened.close)
        _kept["browser"] = knowing(opened)
    return _kept["browser"]


def enter(room):
    """Close the browser unless tests of this room share it; a test that is tried again finds it open."""
    if room is None or _kept.setdefault("room", room) != room:
        close()


def close():
    """End the browser of this process, beside which no other loop of asyncio can run."""
    _open.close()
    _kept.clear()
