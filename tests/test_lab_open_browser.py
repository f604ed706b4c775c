"""A motion is typed in the page: Python reads it, the page follows; a bad one, or no Python, is told in a sentence."""

import pytest
from lab_alone import DRAWN, following
from lab_browser import control
from test_lab_open import CALM, MOTION, cubic, slanted

from percept_obs.labs import observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SETTINGS = "() => [...window.perceptObsLabs][0].settings"
FIELD = control("motion")
SAID = f".expression:has({FIELD}) .refusal"


def type_in(page, text):
    page.locator(FIELD).evaluate("(box) => box.closest('details') && (box.closest('details').open = true)")
    page.fill(FIELD, text)
    page.press(FIELD, "Enter")


@pytest.mark.parametrize(
    ("make", "text", "bad"),
    [
        (observer_lab, "b1 = b1 + 0.2 sin(2t)", "b1 = 0.2 sni(2t)"),
        (structure_lab, "v_c1 = -0.22 - 0.1 sin(2t)", "v_c1 = -0.22 - 0.1 sni(2t)"),
        (points_lab, "w_c3 = 0.5 cos(t)", "w_c3 = 0.5 sni(t)"),
    ],
)
def test_a_typed_motion_takes_effect_and_a_bad_one_is_told_with_its_place(show, make, text, bad):
    lab = make(duration=4.0)
    page = show(lab, answers=following(lab))
    before = page.evaluate("() => Array.from([...window.perceptObsLabs][0].shown.truth)")
    type_in(page, bad)
    page.wait_for_selector(SAID, state="visible")
    assert '"sni" is no letter here' in page.inner_text(SAID)
    assert page.get_attribute(FIELD, "aria-invalid") == "true"
    assert page.locator(FIELD).evaluate("(box) => box.selectionStart") == bad.index("sni")
    assert page.evaluate(SETTINGS)["motion"] == ""
    type_in(page, text)
    page.wait_for_function(f"() => ({SETTINGS})().motion === {text!r}")
    page.wait_for_function(DRAWN)
    assert page.locator(SAID).is_hidden()
    assert page.evaluate("() => Array.from([...window.perceptObsLabs][0].shown.truth)") != before
    page.wait_for_function(f"() => [...window.perceptObsLabs][0].link.sent.settings.motion === {text!r}")
    assert lab.settings["motion"] == text
    assert lab.error == ""
    page.click(control("undo"))
    page.wait_for_function(f"() => ({SETTINGS})().motion === ''")


def test_without_python_the_field_says_so_and_the_lab_goes_on(show):
    lab = observer_lab(observers=[cubic], surface=slanted, motion=MOTION, duration=4.0, **CALM)
    page = show(lab)
    assert page.locator(control("cubic hidden_gain")).count() == 1
    type_in(page, "b1 = t")
    page.wait_for_selector(SAID, state="visible", timeout=8000)
    assert "Python reads what is typed, and it does not answer" in page.inner_text(SAID)
    page.evaluate("() => [...window.perceptObsLabs][0].change({ b: [0.2, 0.1, 0.1] }, true)")
    page.wait_for_function(DRAWN)
    assert page.evaluate("() => window.refused") == []
