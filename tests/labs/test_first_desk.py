"""The desk opens with a line that is typed and judged by itself; little stands there, and it is large."""

import re

import pytest
from lab_browser import control, rested
from sample_sizes import across
from test_desk_browser import LINE, at_desk, text_of

from percept_obs.labs import derivation_desk
from percept_obs.labs.desk.settings import EXAMPLE

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SIZES = [(830, 600), (1240, 680), (390, 760)]
(TYPED,) = EXAMPLE["typed"].values()
PUT = "() => tests.first().replay.put(%d)"
MINE = "() => tests.first().replay.motions(tests.first().answer.picture).mine[0]"
WHOLE = "() => tests.first().replay.at === null"


@pytest.mark.parametrize(("size", "scheme"), across(SIZES, ["light", "dark"]))
def test_it_opens_with_few_words_and_controls_and_large_pictures(browser, size, scheme):
    viewport = dict(zip(("width", "height"), size, strict=True))
    for page in at_desk(browser, derivation_desk(), viewport=viewport, color_scheme=scheme):
        assert "A𝐗+b" in text_of(page, ".premises")
        assert text_of(page, ".slip") == "+b3 y1"
        shown = page.evaluate("tests.desk()")
        assert len(re.findall("[A-Za-z]{2,}", shown["words"])) <= 60, shown["words"]
        assert shown["controls"] <= 12
        assert shown["across"] <= size[0]
        assert page.evaluate("tests.overlaps()") == []
        for picture, least in [(".view.motion", 240), (".view.misses", 100)]:
            assert page.locator(picture).bounding_box()["height"] >= least


@pytest.mark.parametrize("width", [1240, 390])
def test_a_line_is_typed_by_itself_and_judged_while_it_grows(browser, width):
    options = {"viewport": {"width": width, "height": 760}, "reduced_motion": "no-preference"}
    for page in at_desk(browser, derivation_desk(), **options):
        page.evaluate(PUT % len("a13 + (a11 - a33) y1 + a"))
        page.wait_for_function(f"() => document.querySelector({LINE!r}).value.endsWith('+ a')")
        assert text_of(page, ".as-typed").endswith("y1")  # up to the last whole term
        assert page.locator(".mark:visible").count() == 0
        assert "brings the blue arrow nearer" in text_of(page, ".says")
        assert "so far misses by" in page.get_attribute(".view.misses canvas", "aria-label")
        page.click(control("play"))
        page.wait_for_function(WHOLE, timeout=20_000)
        rested(page)
        assert page.locator(LINE).input_value() == TYPED
        assert text_of(page, ".says") == "Not right yet. Mend the marked term."


def test_who_mends_the_slip_sees_both_arrows_fall_together(browser):
    for page in at_desk(browser, derivation_desk(), reduced_motion="reduce"):
        page.fill(LINE, TYPED.replace("+ b3", "- b3"))
        rested(page)
        assert "both arrows are one" in text_of(page, ".says")
        assert "misses nothing" in page.get_attribute(".view.misses canvas", "aria-label")
        page.fill(LINE, "a13 + (a11 - a33) y1 + a12 (")  # the arrow of what stands there stays
        rested(page)
        assert page.evaluate(MINE) is not None
        page.fill(LINE, TYPED)
        page.focus(control("point"))
        for _ in range(60):  # to y1 = 0, where b3 y1 y3 is nothing
            page.keyboard.press("ArrowRight")
        rested(page)
        assert text_of(page, ".says").endswith("Here the slip hides: the arrows agree.")
