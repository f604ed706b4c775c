"""The desk in a page does what it promises: slips named while one types, calmly, by hand, by keyboard and by ear."""

import json

import pytest
from lab_alone import opened
from lab_browser import control, moved_by_keyboard, rested, serious_violations
from test_desk import MISTAKES, RIGHT

from percept_obs.labs import derivation_desk

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LINE = '[data-control="line rate 6 y1\'"]'
HEARD = ".unseen[role=status]"
WORDS = ".sheet-words"
MOVED = ".view.motion canvas"
GO_ON_TYPING = "() => { [...window.perceptObsLabs][0].rest = () => {}; }"  # the pause after the last letter never ends
PAUSE = "() => { const [lab] = window.perceptObsLabs; delete lab.rest; lab.rest(); }"


@pytest.fixture
def page(browser):
    """A desk at the step of the image's rates."""
    yield from at_desk(browser, derivation_desk(step=6, face="workbench"))


def at_desk(browser, desk, **options):
    def answers(message):
        desk.set_state(message)
        return json.loads(json.dumps({"sheets": desk.sheets, "analysis": desk.analysis, "error": desk.error}))

    page = opened(browser, desk, answers=answers, face=desk.face, **options)
    page.set_default_timeout(10_000)
    rested(page)
    yield page
    assert page.evaluate("window.refused") == []
    page.close()


def text_of(page, selector):
    """Text of an element, with formulas as letters side by side."""
    return page.locator(selector).first.text_content().replace("\u2062", " ")


@pytest.mark.parametrize("name", MISTAKES)
def test_three_mistakes_typed_at_the_desk_are_named_with_the_step(page, name):
    text, slip, step = MISTAKES[name]
    page.locator(LINE).press_sequentially(f"y1' = {text}", delay=1)
    rested(page)
    begun = "Right so far: 4 terms are missing."
    assert text_of(page, WORDS) == (begun if name == "forgotten" else "Not right yet.")
    assert page.locator(".told li").count() == 0
    for hint in ("which term", "which slip", "which step"):
        assert text_of(page, control("hint")) == f"Hint: {hint}"
        page.click(control("hint"))
        rested(page)
    told = text_of(page, ".told")
    assert slip in told
    assert step in told
    assert slip in text_of(page, HEARD)
    assert not page.locator(control("hint")).is_visible()


def test_a_right_line_is_right_while_it_is_typed_and_half_a_line_is_not_shouted_at(page):
    page.evaluate(GO_ON_TYPING)
    page.locator(LINE).press_sequentially(RIGHT, delay=1)
    page.locator(".mark.right").wait_for()
    assert text_of(page, WORDS) == "Right so far, 1 of 3 lines."
    page.locator(LINE).press_sequentially(" + q", delay=1)
    page.get_by_text("not complete yet").wait_for()
    assert page.locator(f"{LINE}[aria-invalid=true]").count() == 0
    page.evaluate(PAUSE)
    rested(page)
    assert page.locator(f"{LINE}[aria-invalid=true]").count() == 1
    assert text_of(page, ".state mark") == "q"
    assert '"q" is no letter here' in text_of(page, ".state")
    assert page.locator(HEARD).text_content().startswith('y1\': "q" is no letter here')


def test_a_late_answer_is_never_shown_for_newer_text(page):
    page.locator(LINE).fill(RIGHT)
    rested(page)
    shown = text_of(page, ".as-typed")
    page.evaluate("window.held = []")
    page.keyboard.insert_text(" y")  # at once: letters one by one may be told one by one
    page.wait_for_function("() => window.held.length === 1")
    page.keyboard.insert_text("1")
    page.wait_for_function("() => window.held.length === 2")
    page.evaluate("window.held.forEach(({ analysis }, k) => { analysis.words = ['early', 'late'][k]; })")
    page.evaluate("window.heard(window.held[0])")  # of the text before the last letter
    page.wait_for_function("() => ![...window.perceptObsLabs][0].pending")
    assert text_of(page, ".as-typed") == shown + " y1"  # by the page itself
    page.locator(WORDS).get_by_text("Not right yet.").wait_for()
    assert not page.get_by_text("early").is_visible()
    page.evaluate("window.heard(window.held[1])")
    page.evaluate("window.held = null")
    rested(page)
    assert text_of(page, WORDS) == "late"


def test_by_keyboard_alone(page):
    page.focus(control("part"))
    names = moved_by_keyboard(page, "part", {})
    assert (
        names.index("step 6") < names.index("line rate 6 y1'") < names.index("line rate 6 y2'") < names.index("point")
    )
    page.focus(control("step 6"))
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    page.keyboard.type("b3 y1 y2")
    rested(page)
    assert page.locator(LINE).input_value() == "b3 y1 y2"
    for _ in range(3):
        page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.dataset.control") == "hint"
    page.keyboard.press("Enter")
    rested(page)
    assert page.locator(".told li").count() > 0
    page.keyboard.press("Enter")
    rested(page)
    assert page.evaluate("document.activeElement.dataset.control") == "line rate 6 y3'"  # the button has gone
    for _ in range(3):
        page.keyboard.press("Control+z")
    rested(page)
    assert page.locator(LINE).input_value() == ""
    page.keyboard.press("Control+Shift+Z")
    rested(page)
    assert page.locator(LINE).input_value() == "b3 y1 y2"
    page.focus(control("point"))
    before = page.get_attribute(MOVED, "aria-label")
    page.keyboard.press("ArrowLeft")
    rested(page)
    assert "y1 = 0.39" in page.get_attribute(MOVED, "aria-label") != before


@pytest.mark.parametrize(
    ("part", "scheme", "face"),
    [("rate", "light", "first"), ("rate", "dark", "workbench"), ("error", "dark", "workbench")],
)
def test_axe_finds_nothing_serious(browser, scheme, part, face):
    typed = {"rate 6 y1'": MISTAKES["wrong sign"][0], "rate 6 y2'": "a21 y1 + (", "rate 6 y3'": "-y3 (a31 y1 + b3 y3)"}
    desk = derivation_desk(face=face, step=6, part=part, typed=typed, hints={"rate 6": 4})
    for page in at_desk(browser, desk, color_scheme=scheme):
        assert serious_violations(page) == []


def test_all_fits_in_400_pixels(browser):
    typed = {"rate 6 y1'": MISTAKES["wrong sign"][0]}
    cases = [{"step": 4}, {"step": 6}, {"part": "form", "outputs": ["y1"]}, {"part": "observer", "outputs": ["y1"]}]
    for case in cases:
        desk = derivation_desk(face="workbench", **case, typed=typed, hints={"rate 6": 3})
        for page in at_desk(browser, desk, viewport={"width": 400, "height": 800}):
            assert page.evaluate("document.documentElement.scrollWidth") <= 400
            seen = page.locator(".sheet textarea, .actions button, .steps button").all()
            boxes = [box.bounding_box() for box in seen]
            assert all(box["x"] >= 0 and box["x"] + box["width"] <= 400 for box in boxes)


def test_choices_change_what_is_asked_and_a_name_takes_their_place(page):
    page.select_option(control("part"), "form")
    rested(page)
    assert page.locator(".steps button").count() == 3
    page.select_option(control("surface"), "sphere")
    rested(page)
    assert "sphere" in text_of(page, ".whose")
    page.fill(control("student"), "Ada")
    page.keyboard.press("Enter")
    rested(page)
    assert not page.locator(control("surface")).is_visible()
    assert text_of(page, ".whose") == "affine motion on the chained surface, y2 measured"
    page.click(control("reset"))
    rested(page)
    assert page.locator(control("surface")).is_visible()
