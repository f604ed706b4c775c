"""A field says what it takes, a press what it has changed, and nothing is red while Python computes."""

import pytest
from lab_alone import DRAWN
from lab_browser import RESET, UNFOLD, control

from percept_obs.labs import observer_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SIZE = {"width": 1000, "height": 700}


def drawn(page):
    page.wait_for_function(DRAWN)


def test_a_number_out_of_range_is_told_what_the_field_takes(show):
    page = show(observer_lab("ma2005_eq35"), viewport=SIZE)
    page.evaluate(UNFOLD)
    for name, text, told in (
        ("period number", "7", "a number from 0.001 to 1"),
        ("seed number", "1.5", "a whole number"),
        ("identifier_based noise_variance number", "-3", ">= 0"),
        ("A a11", "5000", "from -1000 to 1000"),
    ):
        page.fill(control(name), text)
        page.keyboard.press("Tab")
        assert told in page.inner_text(".range:not([hidden])"), name
        assert page.input_value(control(name)) != text
        page.evaluate(RESET)
        drawn(page)
        page.fill(control(name), "0.5" if name != "seed number" else "3")
        assert page.locator(".range:not([hidden])").count() == 0
        page.evaluate(RESET)
        drawn(page)


def test_a_press_that_changes_the_true_world_says_so(show):
    page = show(structure_lab(duration=3.0, period=0.01, step=0.01), viewport=SIZE)
    page.click(control("more"))
    page.click(control("corollary 3"))
    drawn(page)
    told = page.inner_text(".notice")
    assert told.startswith("Corollary 3. Changed: ")
    assert "the camera's velocity" in told
    assert "what is unknown" in told
    assert "the observers" not in told
    assert told.endswith("All else is as it was.")


def test_while_python_computes_nothing_is_red(show):
    page = show(observer_lab("ma2005_eq35"), viewport=SIZE)
    page.fill(control("noise size"), "0.001")
    page.wait_for_selector(".silence:not([hidden])")
    assert "has not answered yet" in page.inner_text(".silence")
    colour = "(s) => getComputedStyle(document.querySelector(s)).color"
    assert page.evaluate(colour, ".silence") == page.evaluate(colour, "figcaption")
