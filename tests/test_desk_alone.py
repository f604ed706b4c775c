"""A desk in a page of its own reads and judges without Python, by mouse and by keys, and says what it cannot."""

import pytest
from lab_browser import control, serious_violations
from test_desk import MISTAKES, RIGHT
from test_desk_browser import HEARD, LINE, WORDS, text_of

from percept_obs.labs import derivation_desk

pytestmark = [pytest.mark.browser, pytest.mark.slow]

STANDS = "() => [...(window.perceptObsLabs ?? [])].some((lab) => lab.shown && !lab.pending)"
WRONG = MISTAKES["wrong sign"][0]
ONLY_PYTHON = "Python names the slip: open the desk in a notebook."


@pytest.fixture
def alone(browser, tmp_path):
    """Opens a desk's own page from the disk, without a network; nothing may leave it, and nothing may fail."""
    pages, wrong = [], []

    def opened(width=1280, height=800, **settings):
        derivation_desk(**settings).save(tmp_path / "desk.html")
        page = browser.new_page(offline=True, viewport={"width": width, "height": height}, reduced_motion="reduce")
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.goto((tmp_path / "desk.html").as_uri())
        page.on("request", lambda request: request.url.startswith("blob:") or wrong.append(request.url))
        page.set_default_timeout(10_000)
        page.wait_for_function(STANDS)
        pages.append(page)
        return page

    yield opened
    assert wrong == []
    for page in pages:
        page.close()


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (390, 760)])
def test_right_wrong_and_unreadable_lines_are_told_apart(alone, width, height):
    page = alone(width, height)
    page.fill(LINE, RIGHT)
    page.locator(".mark.right").wait_for()
    assert page.locator(LINE.replace("y1", "y2")).is_visible()  # the next line is asked for
    page.fill(LINE, WRONG)
    page.keyboard.press("Enter")
    page.locator(".mark.wrong").wait_for()
    assert ONLY_PYTHON in text_of(page, ".says")
    assert not page.locator(control("hint")).is_visible()
    page.fill(LINE, f"{RIGHT} + q")
    page.keyboard.press("Enter")
    page.locator(f"{LINE}[aria-invalid=true]").wait_for()
    assert text_of(page, ".state mark") == "q"
    assert '"q" is no letter here' in text_of(page, ".state")
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_by_keys_alone_every_step_is_reached_and_judged(alone):
    page = alone(face="workbench", step=6)
    page.focus(control("step 5"))
    page.keyboard.press("Enter")
    line = page.locator("[data-control^='line rate 5']").nth(2)
    line.focus()
    page.keyboard.type("a31 y1 + a32 y2 + a33 - b3 y3")
    page.keyboard.press("Enter")
    page.locator(".mark.wrong").wait_for()
    assert "not right" in text_of(page, HEARD)
    page.focus(control("step 6"))
    page.keyboard.press("Enter")
    page.locator(LINE.replace("y1", "y3")).focus()
    page.keyboard.type("-y3 (a31 y1 + a32 y2 + a33 - b3 y3)")
    page.keyboard.press("Enter")
    page.locator(".mark.carried").wait_for()
    assert text_of(page, WORDS).startswith("Right from there on: this follows from your “The velocity")


def test_the_first_hint_says_which_line_and_others_are_left_to_python(alone):
    page = alone(face="workbench", step=6, typed={"rate 6 y1'": WRONG, "rate 6 y2'": "a21"})
    assert text_of(page, WORDS) == "2 of 2 lines are not right yet."
    assert text_of(page, control("hint")) == "Hint: which line"
    page.click(control("hint"))
    page.locator(".mark.wrong").first.wait_for()
    assert ONLY_PYTHON in text_of(page, WORDS)
    assert not page.locator(control("hint")).is_visible()


def test_other_systems_are_judged_too_and_one_of_a_name_if_it_was_saved(alone):
    page = alone(face="workbench", step=6)
    page.select_option(control("surface"), "sphere")
    page.select_option(control("part"), "observer")
    page.locator("[data-control^='line observer 1']").first.fill("y1")
    page.locator(".state, .mark").first.wait_for(state="attached")
    assert "sphere" in text_of(page, ".whose")
    page.fill(control("student"), "Grace")
    page.keyboard.press("Enter")
    page.locator(".problem", has_text="Only Python derives this system").wait_for()
    page = alone(face="workbench", step=6, student="Ada")
    page.locator(LINE).fill("a11 y1 + a13 y2 - a22 y1 - a23 y1 y2 + b1 y3 - b2 y1 y3")
    page.locator(".mark.right").wait_for()


@pytest.mark.parametrize("face", ["first", "workbench"])
def test_axe_finds_nothing_serious(alone, face):
    typed = {"rate 6 y1'": WRONG, "rate 6 y2'": "a21 y1 + (", "rate 6 y3'": "-y3 (a31 y1 + b3 y3)"}
    assert serious_violations(alone(face=face, step=6, typed=typed, hints={"rate 6": 1})) == []
