"""The faces of the labs: few words and controls at first, large pictures, no label on another or cut, a drawer beside.

What a hand does there, and what then is drawn and said, is tried without a browser: front/tests/hands.test.js.
"""

import io

import pytest
from first_screens import SIZES, asked, at_the_end, first_screen, overlaps
from lab_alone import DRAWN
from lab_browser import control, painted
from matplotlib.image import imread
from sample_sizes import sampled

from percept_obs.labs import observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LABS = {"observer": observer_lab, "points": points_lab, "structure": structure_lab}
RANDOM = sampled(4, 200)
"""Random settings in which labels are looked at, at each size."""
HIGH = 110
"""Least height of a picture in pixels."""
ROWS = "() => ['.says', '.views', '.time'].map((row) => document.querySelector(row).getBoundingClientRect().top)"
NOW = "() => [tests.settings(), tests.first().state.cursor]"
TEXTS = "() => tests.first().screen.image.texts.map(({ text }) => text)"


@pytest.fixture(scope="module", params=LABS)
def page(request, browser):
    """A lab at the end of its run."""
    with first_screen(browser, LABS[request.param](), reduced_motion="reduce") as page:
        at_the_end(page)
        yield page


@pytest.fixture
def at(page):
    """Shows the lab in its opening state at a size by its name."""

    def sized(size):
        width, height = SIZES[size]
        page.set_viewport_size({"width": width, "height": height})
        page.evaluate("tests.look('')")
        page.evaluate("tests.reset()")
        page.wait_for_function(DRAWN)
        at_the_end(page)
        painted(page)
        return page

    return sized


@pytest.mark.parametrize("size", SIZES)
def test_it_opens_with_few_words_and_controls_and_large_pictures(at, size):
    page = at(size)
    counts = page.evaluate("tests.counts()")
    assert counts["controls"] <= 12
    assert counts["words"] <= 60
    assert counts["share"] >= 0.7
    assert page.evaluate("document.documentElement.scrollWidth") <= SIZES[size][0]


@pytest.mark.parametrize("size", SIZES)
def test_no_label_covers_another_or_is_cut_with_the_drawer_or_without(at, size):
    page = at(size)
    for more in ("", "charts"):
        page.evaluate("(more) => tests.look(more)", more)
        for seed in range(1, RANDOM + 1):
            page.evaluate("(seed) => tests.vary(seed)", 1000 * seed + len(more))
            at_the_end(page) if seed % 3 == 0 else page.wait_for_function(DRAWN)
            painted(page)
            assert overlaps(page) == [], (more, seed)


@pytest.mark.parametrize("size", SIZES)
def test_every_picture_is_high_and_not_of_one_colour(at, size):
    page = at(size)
    page.evaluate("tests.look('charts')")
    page.wait_for_function(DRAWN)
    painted(page)
    pictures = page.locator("figure:visible:has(canvas)").all()
    assert len(pictures) == 5
    for picture in pictures:
        assert picture.bounding_box()["height"] >= HIGH, picture.get_attribute("class")
        pixels = imread(io.BytesIO(picture.screenshot()))[..., :3].reshape(-1, 3)
        assert (abs(pixels - pixels[0]).max(axis=1) > 0.2).mean() > 0.005


def test_no_label_covers_another_where_a_question_is_answered(at):
    page = at("cell")
    for question in page.evaluate("() => tests.first().screen.questions.all.map(({ name }) => name)"):
        asked(page, question)
        assert overlaps(page) == [], question
        page.click(control("done"))
        page.wait_for_function(DRAWN)


def test_the_drawer_keeps_settings_time_and_rows_and_covers_nothing(at):
    page = at("wide")
    before = page.evaluate(NOW), page.evaluate(ROWS)
    page.click(control("more"))
    page.wait_for_function(DRAWN)
    painted(page)
    assert page.locator(".drawer").is_visible()
    assert (page.evaluate(NOW), page.evaluate(ROWS)) == before
    screen, drawer = (page.locator(part).bounding_box() for part in (".screen", ".drawer"))
    assert drawer["x"] >= screen["x"] + screen["width"]
    page.set_viewport_size({"width": 390, "height": 760})
    painted(page)
    screen, drawer = (page.locator(part).bounding_box() for part in (".screen", ".drawer"))
    assert drawer["y"] >= screen["y"] + screen["height"]
    page.click(control("more"))
    assert page.locator(".drawer").is_hidden()


def test_it_begins_to_play_by_itself(browser):
    with first_screen(browser, observer_lab()) as page:
        page.wait_for_function("() => tests.first().screen.clock.playing")


def test_both_arrows_and_a_name_stay_on_a_phone(browser):
    with first_screen(browser, observer_lab(), SIZES["phone"]) as page:
        at_the_end(page)
        for time in (1.0, 2.0, 4.0):
            page.evaluate("(time) => tests.point(time)", time)
            assert {"seen", "expected", "seen as expected"} & set(page.evaluate(TEXTS)), time
