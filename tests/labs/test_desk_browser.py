"""The desk judges while one types, by hand, by keyboard and by ear, with Python and without."""

import json

import pytest
from lab_alone import opened
from lab_browser import control, rested, serious_violations
from test_desk import MISTAKES, RIGHT

from percept_obs.labs import derivation_desk
from percept_obs.labs.desk.answers import HINTS, SAID

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LINE = '[data-control="line rate 6 y1\'"]'
HEARD = ".unseen[role=status]"
GO_ON_TYPING = "() => { [...window.perceptObsLabs][0].rest = () => {}; }"  # the pause after the last letter never ends
PAUSE = "() => { const [lab] = window.perceptObsLabs; delete lab.rest; lab.rest(); }"


@pytest.fixture
def page(browser):
    """A desk at the step of the image's motion, which Python answers."""
    yield from at_desk(browser, derivation_desk(step=6))


def at_desk(browser, desk, **options):
    def answers(message):
        desk.set_state(message)
        return json.loads(json.dumps({"sheets": desk.sheets, "analysis": desk.analysis, "error": desk.error}))

    page, wrong = opened(browser, desk, answers=answers, **options), []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.set_default_timeout(10_000)
    rested(page)
    yield page
    assert page.evaluate("window.refused") == wrong == []
    page.close()


def text_of(page, selector):
    """Text of an element, with formulas as letters side by side."""
    return page.locator(selector).first.text_content().replace("\u2062", " ")


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_typed_at_the_desk_are_named_with_the_step_hint_by_hint(page, name):
    text, slip, step = MISTAKES[name]
    page.locator(LINE).press_sequentially(f"y1' = {text}", delay=1)
    rested(page)
    assert ("4 terms are missing" if name == "forgotten" else "Not right yet.") in text_of(page, ".says")
    assert page.locator(".told li, .slip").count() == 0
    for hint in HINTS[1:]:
        assert text_of(page, control("hint")) == hint
        page.click(control("hint"))
        rested(page)
    assert page.locator(".slip").count() == (name != "forgotten")
    for told in (slip, step):
        assert told in text_of(page, ".told")
        assert told in text_of(page, HEARD)
    assert not page.locator(control("hint")).is_visible()


def test_half_a_line_is_not_shouted_at_and_python_reads_what_the_page_does_not(page):
    page.evaluate(GO_ON_TYPING)
    page.locator(LINE).press_sequentially(RIGHT, delay=1)
    page.locator(".mark.right").wait_for()
    page.locator(LINE).press_sequentially(" + q", delay=1)
    page.get_by_text("not complete yet").wait_for()
    assert page.locator(f"{LINE}[aria-invalid=true]").count() == 0
    page.evaluate(PAUSE)
    rested(page)
    assert text_of(page, ".state mark") == "q"
    assert '"q" is no letter here' in text_of(page, ".state")
    assert text_of(page, HEARD).startswith('y1\': "q" is no letter here')
    page.fill(LINE, "\\frac{y_1}{2} + a_{13}")
    rested(page)
    assert page.locator(".as-typed mfrac").count() == 1  # as Python has read it
    assert page.evaluate("() => [...window.perceptObsLabs][0].answer.picture.mine[0]") is not None


def test_by_keyboard_alone(page):
    page.focus(control("step 1"))
    names = []
    while "more" not in names:
        names.append(page.evaluate("document.activeElement.dataset.control"))
        page.keyboard.press("Tab")
    assert names.index("step 6") < names.index("line rate 6 y1'") < names.index("point") < names.index("more")
    page.focus(LINE)
    page.keyboard.type("b3 y1 y2")
    page.keyboard.press("Enter")
    rested(page)
    page.focus(control("hint"))
    for _ in range(3):
        page.keyboard.press("Enter")
        rested(page)
    assert page.evaluate("document.activeElement.dataset.control") == "line rate 6 y1'"  # the button has gone
    for _ in range(4):
        page.keyboard.press("Control+z")
    rested(page)
    assert page.locator(LINE).input_value() == ""
    page.focus(control("point"))
    page.keyboard.press("ArrowLeft")
    rested(page)
    assert "y1 = 0.39" in page.get_attribute(".view.motion canvas", "aria-label")


def test_the_drawer_changes_what_is_asked_and_a_name_takes_the_place_of_choices(page):
    page.click(control("more"))
    page.locator(f"{control('more')}[aria-expanded=true]").wait_for()
    page.select_option(control("part"), "form")
    rested(page)
    assert page.locator(".steps button").count() == 3
    page.select_option(control("surface"), "sphere")
    page.fill(control("student"), "Ada")
    page.keyboard.press("Enter")
    rested(page)
    assert not page.locator(control("surface")).is_visible()
    assert text_of(page, ".premises").startswith("affine motion on the chained surface, y2 measured")


@pytest.mark.parametrize("width", [1280, 390])
def test_without_python_lines_are_judged_and_what_only_python_reads_is_said(browser, tmp_path, width):
    derivation_desk(step=6, student="Ada").save(tmp_path / "desk.html")
    page, wrong = browser.new_page(offline=True, viewport={"width": width, "height": 800}), []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.goto((tmp_path / "desk.html").as_uri())
    page.on("request", lambda request: request.url.startswith("blob:") or wrong.append(request.url))
    page.fill(LINE, "a11 y1 + a13 y2")
    page.locator(".says", has_text="Right so far: 4 terms are missing.").wait_for()
    page.fill(LINE, "a11 y1 + a13 y2 - a22 y1 - a23 y1 y2 + b1 y3 - b2 y1 y3")
    page.locator(".mark.right").wait_for()
    assert page.locator(LINE.replace("y1", "y2")).is_visible()  # the next line is asked for
    page.fill(LINE, "a11 y1 + a13 y2 - a22 y1 - a23 y1 y2 + b1 y3 + b2 y1 y3")
    page.locator(".mark.wrong").wait_for()
    assert (text_of(page, ".slip"), text_of(page, ".told")) == ("+b2 y1 y3", "b2 y1 y3 has the wrong sign")
    page.fill(LINE, "\\frac{y1}{2}")
    page.locator(f"{LINE}[aria-invalid=true]").wait_for()
    assert SAID["python"] in text_of(page, ".state")
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    page.click(control("more"))
    page.fill(control("student"), "Grace")
    page.keyboard.press("Enter")
    page.locator(".problem", has_text="Only Python derives this system").wait_for()
    assert wrong == []
    page.close()


@pytest.mark.parametrize(("part", "scheme"), [("rate", "light"), ("rate", "dark"), ("error", "dark")])
def test_axe_finds_nothing_serious(browser, scheme, part):
    typed = {"rate 6 y1'": MISTAKES["wrong sign"][0], "rate 6 y2'": "a21 y1 + (", "rate 6 y3'": "-y3 (a31 y1 + b3 y3)"}
    desk = derivation_desk(step=6, part=part, typed=typed, hints={"rate 6": 4}, more="choices")
    for page in at_desk(browser, desk, color_scheme=scheme):
        assert serious_violations(page) == []
