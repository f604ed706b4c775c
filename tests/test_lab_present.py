"""Labs show the present settings: nothing old of an unseen point, and what is far away is at the rim."""

import pytest
from lab_alone import DRAWN
from lab_browser import UNFOLD, centre, control

from percept_obs.labs import observer_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

BEHIND = {
    "observer": (observer_lab, "{ X0: [1, 1.5, -1] }", "start X"),
    "structure": (
        lambda: structure_lab(duration=3.0, period=0.01, step=0.01),
        "{ ybar: [0.3, 0.3, -0.05] }",
        "start ȳ3",
    ),
}
CHANGE = "() => [...window.perceptObsLabs][0].change({}, true)"
B = "() => [...window.perceptObsLabs][0].settings.b"
NAMES = "() => [...window.perceptObsLabs][0].planes[0].texts.map(({ text }) => text)"
SCALES = "() => Object.entries([...window.perceptObsLabs][0].time.scales)"


@pytest.mark.parametrize("name", BEHIND)
def test_of_a_point_behind_the_camera_nothing_old_is_left_and_the_remedy_names_a_control(show, name):
    make, change, named = BEHIND[name]
    page = show(make())
    page.evaluate(CHANGE.replace("{}", change))
    page.wait_for_function(DRAWN)
    page.wait_for_function("() => document.querySelector('.why').textContent.includes('behind the camera')")
    assert named.split()[0] in page.inner_text(".why")
    page.evaluate(UNFOLD)
    assert named in page.inner_text(".panel")
    assert page.locator("figure.chart:not([hidden])").count() == 0
    assert page.locator(".legend li").count() == 0
    assert page.locator(".player").is_hidden()
    assert page.inner_text(".reading") == ""
    drawn = """() => { const c = document.querySelector("figure.scene canvas");
        return c.getContext("2d").getImageData(0, 0, c.width, c.height).data.some((v) => v > 0); }"""
    assert not page.evaluate(drawn)
    if name == "structure":
        assert page.locator(".told .value").text_content() == ""
        assert "−0.05" in page.locator(".told .with-numbers").text_content()


def test_a_focus_of_expansion_at_infinity_stands_at_the_rim_and_is_dragged_back(show):
    page = show(observer_lab(b=[0.5, 0.25, 0.0]))
    handle = page.locator(control("foe"))
    assert handle.is_visible()
    assert "FOE at infinity" in page.evaluate(NAMES)
    page.wait_for_function("() => document.querySelector('.diamond').ariaValueText?.includes('at infinity')")
    assert "focus of expansion is at infinity" in page.inner_text(".why")
    x, y = centre(page, control("foe"))
    middle_x, middle_y = centre(page, "figure.image-plane canvas")
    assert x > middle_x
    assert y < middle_y
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(middle_x, middle_y)
    page.mouse.up()
    page.wait_for_function(DRAWN)
    b1, b2, b3 = page.evaluate(B)
    assert b3 > 0
    assert (b1**2 + b2**2 + b3**2) ** 0.5 == pytest.approx(0.3125**0.5)
    assert "FOE" in page.evaluate(NAMES)


def test_a_number_does_not_move_a_focus_of_expansion_that_has_gone_to_infinity(show):
    """An earlier move may have sent it there, and its number is hidden only at the next picture."""
    page = show(observer_lab("ma2005_eq35"))
    wrong = []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.wait_for_function(DRAWN)
    page.evaluate("""() => {
        const [lab] = window.perceptObsLabs;
        lab.change({ b: [0.5, 0.25, 0] }, true);
        const field = document.querySelector('[data-control="foe y1 number"]');
        field.value = "1";
        field.dispatchEvent(new Event("input", { bubbles: true }));
    }""")
    page.wait_for_function(DRAWN)
    assert wrong == []
    assert page.evaluate(B) == [0.5, 0.25, 0]
    assert page.locator(control("foe y1 number")).is_hidden()


def test_a_lab_has_not_settled_before_its_words_follow_a_step_back(show):
    """Python knows these settings and their picture is there at once, but the words are those of the step before."""
    page = show(observer_lab(duration=5.0))
    page.check(control("outputs y1"))
    page.wait_for_function(DRAWN)
    said, settled = page.evaluate("""() => {
        const [lab] = window.perceptObsLabs;
        lab.undo();
        return [document.querySelector(".verdicts").textContent, lab.settled];
    }""")
    assert not settled
    page.wait_for_function(DRAWN)
    assert page.text_content(".verdicts") != said


def test_without_translation_there_is_no_focus_of_expansion_and_the_lab_says_so(show):
    page = show(observer_lab(b=[0.0, 0.0, 0.0]))
    page.wait_for_function("() => document.querySelector('.why').textContent.includes('Nothing translates')")
    assert page.locator(control("foe")).is_hidden()


@pytest.mark.parametrize("make", [observer_lab, lambda: structure_lab(duration=3.0, period=0.01, step=0.01)])
def test_the_chart_that_names_the_tolerance_shows_it(show, make):
    page = show(make())
    page.click(control("zoom whole"))
    page.wait_for_function(DRAWN)
    (scale,) = [scale for title, scale in page.evaluate(SCALES) if "tolerance 10 %" in title]
    assert scale["low"] < 0.1 < scale["high"]
