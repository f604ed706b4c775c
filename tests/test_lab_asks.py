"""A lab asks before it shows, takes a prediction, says what a press has changed, what a field takes, and undoes all."""

import pytest
from lab_alone import DRAWN
from lab_browser import UNFOLD, control

from percept_obs.labs import observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LABS = {"observer": (observer_lab, "foe"), "points": (points_lab, "hide")}
SIZE = {"width": 1000, "height": 700}
SETTINGS = "() => [...window.perceptObsLabs][0].settings"
SKETCH = "() => document.querySelector('.sketched path').getAttribute('d') ?? ''"
RIGHT = "() => { const [lab] = window.perceptObsLabs; return lab.parts.presets[0].right; }"


def drawn(page):
    page.wait_for_function(DRAWN)


@pytest.mark.parametrize("name", LABS)
def test_a_prediction_is_made_by_keys_judged_and_undone(show, name):
    make, first = LABS[name]
    page = show(make(), viewport=SIZE)
    right = page.evaluate(RIGHT)
    assert page.locator(".question").is_visible()
    assert page.inner_text(".answer") == ""
    opening = page.evaluate(SETTINGS)
    page.focus(control(f"predict {first} 0"))
    page.keyboard.press("Space")
    for _ in range(right):
        page.keyboard.press("ArrowDown")
    assert page.is_checked(control(f"predict {first} {right}"))
    page.focus(control(f"act {first} 0"))
    page.keyboard.press("Enter")
    drawn(page)
    assert page.inner_text(".answer").startswith("You predicted it.")
    assert page.inner_text(".changes").startswith("Changed: ")
    assert page.inner_text(control("way back")) == "Back to my settings"
    page.keyboard.press("Control+z")
    drawn(page)
    assert page.evaluate(SETTINGS) == opening
    assert page.inner_text(".answer") == ""
    for _ in range(max(right, 1) if right else 1):
        page.keyboard.press("Control+z")
    page.keyboard.press("Control+Shift+z")
    assert page.locator(".predictions input:checked").count() == 1


def test_a_wrong_prediction_is_told_the_right_one(show):
    page = show(observer_lab("ma2005_eq35"), viewport=SIZE)
    page.check(control("predict foe 2"))
    page.click(control("act foe 0"))
    assert page.inner_text(".answer").startswith("Not what you predicted: For a moment only.")


def test_a_question_stands_over_its_own_settings_and_an_answer_says_when_it_is_of_others(show):
    page = show(observer_lab("ma2005_eq35"), viewport=SIZE)
    opening = page.evaluate(SETTINGS)
    page.click(control("preset bias"))
    page.click(control("act bias 0"))
    drawn(page)
    assert page.inner_text(".since") == ""
    page.fill(control("identifier_based gain number"), "4")
    drawn(page)
    assert "moved something since" in page.inner_text(".since")
    assert page.inner_text(".changes") == ""
    page.click(control("preset gain"))
    drawn(page)
    assert page.evaluate(SETTINGS) == opening
    assert page.inner_text(".answer") == ""
    assert page.inner_text(".since") == ""


def test_an_error_is_sketched_by_pointer_and_by_keys_and_stays_to_be_compared(show):
    page = show(observer_lab("ma2005_eq35"), viewport=SIZE)
    page.click(control("preset drop"))
    drawn(page)
    assert page.evaluate(SKETCH) == ""
    page.click(control("sketch drop"))
    box = page.locator(control("sketch")).bounding_box()
    x, y = box["x"] + 60, box["y"] + 20
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 150, y + 40, steps=6)
    page.mouse.up()
    by_hand = page.evaluate(SKETCH)
    assert by_hand.count("L") == 32
    assert page.locator(control("sketch")).is_hidden()
    page.click(control("sketch drop"))
    for key in ("ArrowRight", "ArrowRight", "ArrowDown", "ArrowDown", "Enter"):
        page.keyboard.press(key)
    by_keys = page.evaluate(SKETCH)
    assert by_keys != by_hand
    page.click(control("act drop 0"))
    drawn(page)
    assert page.evaluate(SKETCH).count("L") == 32
    for _ in range(3):
        page.click(control("undo"))
        drawn(page)
    assert page.evaluate(SKETCH) == ""


def test_a_number_out_of_range_is_told_what_the_field_takes(show):
    page = show(observer_lab("ma2005_eq35"), viewport=SIZE)
    page.evaluate(UNFOLD)
    for name, text, told in (
        ("noise size number", "7", "a number from 0 to 1"),
        ("seed number", "1.5", "a whole number"),
        ("identifier_based gain number", "-3", "G > 0"),
        ("A a11", "5000", "from -1000 to 1000"),
    ):
        page.fill(control(name), text)
        page.keyboard.press("Tab")
        assert told in page.inner_text(".range:not([hidden])"), name
        assert page.input_value(control(name)) != text
        page.click(control("reset"))
        drawn(page)
        page.fill(control("identifier_based gain number"), "9")
        page.fill(control(name), "0.5" if name != "seed number" else "3")
        assert page.locator(".range:not([hidden])").count() == 0
        page.click(control("reset"))
        drawn(page)


def test_a_press_that_changes_the_true_world_says_so(show):
    page = show(structure_lab(duration=3.0), viewport=SIZE)
    page.click(control("topic cases"))
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
    page.fill(control("noise size number"), "0.001")
    page.wait_for_selector(".silence:not([hidden])")
    assert "has not answered yet" in page.inner_text(".silence")
    colour = "(s) => getComputedStyle(document.querySelector(s)).color"
    assert page.evaluate(colour, ".silence") == page.evaluate(colour, ".reading")
