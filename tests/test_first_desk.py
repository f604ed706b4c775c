"""The desk opens with a line that is typed and judged by itself; little stands there, and it is large."""

import io
import re

import pytest
from lab_browser import control, painted, rested
from matplotlib.image import imread
from sample_sizes import across
from test_desk_browser import LINE, at_desk, text_of

from percept_obs.labs import derivation_desk
from percept_obs.labs.desk.settings import EXAMPLE

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SIZES = [(830, 600), (1240, 680), (390, 760)]
(TYPED,) = EXAMPLE["typed"].values()
SHOWN = """() => {
    document.querySelectorAll(".unseen").forEach((node) => node.remove());  // it is heard
    return {
    controls: [...document.querySelectorAll("[data-control]")].filter((node) =>
        node.checkVisibility({ visibilityProperty: true })).map((node) => node.dataset.control),
    words: [document.querySelector(".percept-lab").innerText,
        ...[...window.perceptObsLabs][0].figures.flatMap(({ texts }) => texts.map(({ text }) => text))].join(" "),
    across: document.documentElement.scrollWidth,
    share: [...document.querySelectorAll("figure.view, .as-typed")].filter((node) => node.checkVisibility())
        .reduce((sum, node) => sum + node.offsetWidth * node.offsetHeight, 0)
        / (({ offsetWidth, offsetHeight }) => offsetWidth * offsetHeight)(document.querySelector(".first-screen")) };
}"""
"""The share is that of both pictures and of one's line as mathematics, which the arrows are about."""

OVERLAPS = """() => [...window.perceptObsLabs][0].figures.flatMap(({ texts, width, height }) =>
    texts.flatMap((one, k) => [
    ...texts.slice(k + 1).filter(({ box }) => one.box[0] < box[2] && one.box[2] > box[0] && one.box[1] < box[3]
        && one.box[3] > box[1]).map(({ text }) => [one.text, text]),
    ...(one.box[0] < 0 || one.box[1] < 0 || one.box[2] > width || one.box[3] > height ? [[one.text, "cut"]] : []),
]))"""
PARTS = "() => Object.values([...window.perceptObsLabs][0].answer.grown)[0]"
BOTH = "() => { const { picture } = [...window.perceptObsLabs][0].answer; return [picture.true, picture.mine]; }"
PLAYED = "() => [...window.perceptObsLabs][0].replay.at === null"
STANDS = "() => { const { replay } = [...window.perceptObsLabs][0]; replay.pause(); replay.put(%d); }"


@pytest.fixture
def page(browser):
    """A desk that is opened without any settings, without motion: the line stands there as a whole."""
    yield from at_desk(browser, derivation_desk(), reduced_motion="reduce", viewport={"width": 1240, "height": 760})


@pytest.mark.parametrize(("size", "scheme"), across(SIZES, ["light", "dark"]))
def test_it_opens_with_few_words_and_controls_and_large_pictures(browser, size, scheme):
    width, height = size
    size = {"width": width, "height": height}
    for page in at_desk(browser, derivation_desk(), viewport=size, color_scheme=scheme, reduced_motion="reduce"):
        shown = page.evaluate(SHOWN)
        letters = re.findall("[A-Za-z]{2,}", shown["words"])
        assert len(letters) <= 60, " ".join(letters)
        assert len(shown["controls"]) <= 12, shown["controls"]
        assert shown["across"] <= width
        assert shown["share"] >= 0.7
        assert page.evaluate(OVERLAPS) == []
        for picture, least in [(".view.motion", 240), (".view.misses", 100)]:
            assert page.locator(picture).bounding_box()["height"] >= least


@pytest.mark.parametrize(("face", "step"), across(["first", "workbench"], [1, 4, 6, 7]))
def test_the_picture_is_high_and_not_of_one_colour(browser, step, face):
    for page in at_desk(browser, derivation_desk(face=face, step=step)):
        for width in (390, 700, 830, 1240):
            page.set_viewport_size({"width": width, "height": 700})
            painted(page)
            picture = page.locator(".view.motion")
            assert picture.bounding_box()["height"] >= 120
            pixels = imread(io.BytesIO(picture.screenshot()))[..., :3].reshape(-1, 3)
            assert (abs(pixels - pixels[0]).max(axis=1) > 0.2).mean() > 0.005


def test_a_line_is_typed_by_itself_and_judged_while_it_grows(browser):
    for page in at_desk(browser, derivation_desk(), viewport={"width": 1240, "height": 760}):
        page.evaluate(STANDS % len("a13 + (a11 - a33) y1 + a"))
        page.wait_for_function(f"() => document.querySelector({LINE!r}).value.endsWith('+ a')")
        assert text_of(page, ".as-typed").endswith("y1")  # up to the last whole term
        assert page.locator(".mark:visible").count() == 0
        assert "bends the blue arrow" in text_of(page, ".says")
        assert "so far misses by 66 %" in page.get_attribute(".view.misses canvas", "aria-label")
        page.click(control("first play"))
        page.wait_for_function(PLAYED, timeout=20_000)
        rested(page)
        assert page.locator(LINE).input_value() == TYPED
        assert "misses the true one" in text_of(page, ".says")
        assert text_of(page, ".pill") == "Type here"


def test_who_mends_the_slip_sees_both_arrows_fall_together(page):
    page.fill(LINE, TYPED.replace("+ b3", "- b3"))
    rested(page)
    assert "both arrows are one" in text_of(page, ".says")
    assert "misses nothing" in page.get_attribute(".view.misses canvas", "aria-label")
    assert page.locator(LINE.replace("y1", "y2")).is_visible()  # the next line is asked for
    true, mine = page.evaluate(BOTH)
    assert mine[0] == pytest.approx(true[0])


def test_a_line_that_cannot_be_read_yet_keeps_the_arrow_of_what_stands_there(page):
    page.fill(LINE, "a13 + (a11 - a33) y1 + a12 (")
    rested(page)
    mine = page.evaluate("() => [...window.perceptObsLabs][0].motions().mine[0]")
    assert mine == pytest.approx(page.evaluate(PARTS)[1]["at"])
    assert "so far misses by 66 %" in page.get_attribute(".view.misses canvas", "aria-label")
    assert text_of(page, ".says") == "A line cannot be read yet: the place is marked."


def test_what_the_sentence_says_of_arrows_is_so(browser):
    for step, typed in [
        (1, {"rate 1 X'": "a11 X + a12 Y + a13 Z + b1"}),
        (7, {"rate 7 y1": "b1/b3"}),
        (3, {"rate 3 X": "y1/y3"}),
    ]:
        for page in at_desk(browser, derivation_desk(step=step, typed=typed), reduced_motion="reduce"):
            true, mine = page.evaluate(BOTH)
            assert ("both arrows are one" in text_of(page, ".says")) is (mine == pytest.approx(true))


def test_hints_open_one_by_one_and_a_sign_says_that_python_is_at_work(page):
    page.evaluate("window.held = []")
    page.click(control("hint"))
    page.get_by_text("Python is looking").wait_for()
    page.evaluate("() => { window.held.forEach(window.heard); window.held = null; }")
    rested(page)
    assert not page.get_by_text("Python is looking").is_visible()
    for name in ("which slip", "which step"):
        assert text_of(page, control("hint")) == f"Hint: {name}"
        page.click(control("hint"))
        rested(page)
    assert "in step 5" in text_of(page, ".told")


def test_where_a_slip_hides_the_sentence_says_so(page):
    page.focus(control("point"))
    for _ in range(50):  # to y1 = 0, where b3 y1 y3 is nothing
        page.keyboard.press("ArrowRight")
    rested(page)
    assert text_of(page, ".says").startswith("Here the slip hides")


def test_a_long_line_is_shown_to_its_end(page):
    long = " + ".join([TYPED] * 4)
    page.fill(LINE, long)
    rested(page)
    field = page.locator(LINE)
    assert field.evaluate("(node) => node.scrollHeight <= node.clientHeight + 1 && node.clientHeight > 60")
    page.keyboard.press("Enter")
    assert field.input_value() == long


def test_keys_go_through_what_was_typed_and_the_workbench_is_one_press_away(page):
    page.focus(control("first play"))
    page.keyboard.press("Home")
    page.wait_for_function(f"() => document.querySelector({LINE!r}).value === ''")
    page.keyboard.press("Enter")  # where motion is not wanted a term is a step
    page.wait_for_function(f"() => document.querySelector({LINE!r}).value === 'a13'")
    page.keyboard.press("End")
    page.click(control("workbench"))
    assert page.locator(LINE).input_value() == TYPED
    page.locator(control("part")).wait_for()
    cut = "(node) => node.scrollWidth > node.clientWidth"
    assert not any(box.evaluate(cut) for box in page.locator(".choices-of-desk select").all())
    page.click(control("workbench"))
    assert not page.locator(control("part")).is_visible()
