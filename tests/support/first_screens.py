"""Labs in pages of their own: opening them, asking a question, and reading what pictures say."""

from contextlib import contextmanager

from lab_alone import DRAWN, opened
from lab_browser import control

SIZES = {"cell": (830, 600), "wide": (1240, 680), "phone": (390, 760)}


@contextmanager
def first_screen(browser, lab, size=SIZES["cell"], **options):
    """A page with a lab that has drawn; no error of the page is left unseen."""
    wrong = []
    moving = {"reduced_motion": "no-preference", **options}
    page = opened(browser, lab, viewport=dict(zip(("width", "height"), size, strict=True)), **moving)
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.set_default_timeout(15_000)
    page.wait_for_function("() => tests.ready()")
    yield page
    assert wrong == []
    page.close()


def at_the_end(page):
    """Show the end of the run at once, as if it had been played."""
    page.evaluate("tests.finish()")
    page.wait_for_function(DRAWN)
    page.evaluate("tests.still()")


def asked(page, name, answer=0):
    """Ask a question, answer it, and show the end of the run."""
    page.evaluate("(name) => tests.ask(name)", name)
    page.click(control(f"answer {answer}"))
    page.wait_for_function(DRAWN)
    at_the_end(page)
    page.wait_for_function("() => tests.watched()")


def overlaps(page):
    """Texts of the pictures that are cut or not reported, and pairs that cover each other."""
    return page.evaluate("tests.overlaps()")
