"""The observer lab does what it promises: it follows the hand, tells Python, and leads back."""

import pytest
from lab_browser import RESET, assert_equals_python, assert_has, control, drag_by_mouse, rested, state

from percept_obs.labs import observer_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

FOE = control("foe")


@pytest.fixture(scope="module")
def python():
    """The lab in Python, with a run that is long enough."""
    return observer_lab(duration=20.0)


def test_an_observer_that_is_impossible_is_dropped_and_says_why(fresh):
    fresh.check(control("observer range_identification"))
    fresh.uncheck(control("observer identifier_based"))
    rested(fresh)
    fresh.fill(control("outputs"), "0")
    rested(fresh)
    shown = state(fresh)
    assert shown["settings"]["observers"] == ["identifier_based"]
    assert "measure every image coordinate" in shown["notice"]
    box = fresh.locator(control("observer range_identification"))
    assert box.is_disabled()
    assert "measure every image coordinate" in fresh.inner_text(".refusal:not([hidden])")
    assert_equals_python(shown)
    fresh.fill(control("outputs"), "1")
    rested(fresh)
    assert box.is_enabled()
    assert state(fresh)["notice"] == ""


def test_what_is_known_of_an_observer_is_told_beside_it(fresh):
    about = fresh.locator(control("about spica"))
    about.click()
    assert about.get_attribute("aria-expanded") == "true"
    known = fresh.locator(".known:not([hidden])").inner_text()
    assert all(part in known for part in ("Spica and Robuffo Giordano 2013", "Needs", "Claim", "Lambda > 0"))
    about.click()


@pytest.mark.parametrize("surface", ["chained", "plane", "sphere", "unified"])
def test_every_surface_is_there_with_the_outputs_that_it_allows(fresh, surface):
    fresh.fill(control("outputs"), "2")
    fresh.select_option(control("surface"), surface)
    rested(fresh)
    shown = state(fresh)
    only_both = surface in ("sphere", "unified")
    assert shown["settings"]["outputs"] == (["y1", "y2"] if only_both else ["y2"])
    assert ("needs y1 and y2" in shown["notice"]) == only_both
    assert fresh.locator(control("outputs")).is_hidden() == only_both
    assert_equals_python(shown)
    drag_by_mouse(fresh, FOE)
    rested(fresh)
    assert_equals_python(state(fresh))


def test_a_number_that_is_not_allowed_is_refused_where_it_was_typed(fresh):
    field = fresh.locator(control("identifier_based bound number"))
    before = state(fresh)["settings"]["gains"]["identifier_based"]["bound"]
    field.fill("-3")
    assert field.get_attribute("aria-invalid") == "true"
    assert state(fresh)["settings"]["gains"]["identifier_based"]["bound"] == before
    field.fill("12.5")
    rested(fresh)
    assert state(fresh)["settings"]["gains"]["identifier_based"]["bound"] == 12.5


def test_the_lab_ends_on_the_last_of_many_events(fresh, python):
    slider = control("gain")
    fresh.evaluate(
        """async (selector) => {
            const slider = document.querySelector(selector);
            for (let k = 0; k < 40; k++) {
                slider.value = String(0.5 + k / 40);
                slider.dispatchEvent(new Event("input", { bubbles: true }));
                await new Promise((resolve) => setTimeout(resolve, 25));
            }
        }""",
        slider,
    )
    rested(fresh)
    last = fresh.evaluate("(selector) => Number(document.querySelector(selector).value)", slider)
    shown = state(fresh)
    assert shown["settings"]["gains"]["identifier_based"]["gain"] == pytest.approx(10**last, rel=1e-2)
    assert_equals_python(shown)
    assert_has(python, shown["settings"])


def test_a_drag_is_one_step_back_and_forth_by_keys_and_by_buttons(fresh):
    fresh.focus(FOE)
    fresh.keyboard.press("ArrowUp")  # from now on no sentence asks for a first move
    rested(fresh)
    before = state(fresh)
    drag_by_mouse(fresh, FOE)
    rested(fresh)
    dragged = state(fresh)
    fresh.fill(control("identifier_based bound number"), "4")
    rested(fresh)
    fresh.keyboard.press("Control+z")
    rested(fresh)
    assert state(fresh) == dragged
    fresh.keyboard.press("Control+z")
    rested(fresh)
    assert state(fresh) == before
    fresh.click(control("redo"))
    rested(fresh)
    assert state(fresh) == dragged
    fresh.keyboard.press("Control+Shift+z")
    rested(fresh)
    assert state(fresh)["settings"]["gains"]["identifier_based"]["bound"] == 4
    assert fresh.get_attribute(control("redo"), "aria-disabled") == "true"
    for _ in range(2):
        fresh.click(control("undo"))
    rested(fresh)
    assert state(fresh) == before
    assert_equals_python(before)


def test_a_slider_lights_up_its_letter(fresh):
    fresh.focus(control("b1"))
    assert fresh.locator(".formulas .lit").count() > 0


def test_a_kernel_text_that_fails_to_load_is_told(fresh):
    fresh.evaluate("""() => {
        const [lab] = window.perceptObsLabs;
        lab.model.forms["pinhole y2"].observers.sliding_mode.fraction.run = "function run( {";
        const { groups, waiting } = lab.kernels.modules;
        for (const kept of [groups, waiting]) kept.delete("pinhole y2 sliding_mode fraction");
        lab.change({ outputs: ["y2"], observers: ["sliding_mode"] }, true);
    }""")
    fresh.wait_for_selector(".problem:not([hidden])")
    # Pictures of the settings before may still come, and say nothing of these.
    fresh.evaluate("""() => {
        const [lab] = window.perceptObsLabs;
        lab.spoken = -Infinity;
        lab.paint();
    }""")
    assert "could not be loaded" in fresh.inner_text(".problem:not([hidden])")
    fresh.evaluate(RESET)
    rested(fresh)
    assert state(fresh)["problems"] == []
