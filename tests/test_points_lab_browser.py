"""The lab of many points follows the hand, survives any order of events, and is open to keyboards."""

import numpy as np
import pytest
from lab_browser import assert_points_are_python, control, rested, state

from percept_obs.labs.points.lab import points_lab
from percept_obs.labs.points.settings import MOST_POINTS

pytestmark = [pytest.mark.browser, pytest.mark.slow]

POINT = control("point 2")


@pytest.fixture(scope="module")
def python():
    """The lab in Python."""
    return points_lab(duration=8.0, window=4.0, face="workbench")


def test_a_key_changes_the_depth_and_keeps_the_image(fresh):
    (_, before, _) = state(fresh)["settings"]["points"]
    fresh.locator(POINT).focus()
    for _ in range(4):
        fresh.keyboard.press("+")
    rested(fresh)
    (_, after, _) = state(fresh)["settings"]["points"]
    assert after[2] == pytest.approx(before[2] + 0.2)
    np.testing.assert_allclose(np.divide(after[:2], after[2]), np.divide(before[:2], before[2]), rtol=1e-9)


def test_points_are_added_and_removed(fresh):
    fresh.fill(control("duration number"), "1")
    add = fresh.locator(control("add point")).first
    for _ in range(MOST_POINTS - 3):
        add.click()
    assert add.is_disabled()
    rested(fresh)
    most = state(fresh)
    assert len(most["settings"]["points"]) == MOST_POINTS
    assert_points_are_python(most)
    for _ in range(MOST_POINTS - 1):
        fresh.locator(control("remove 1")).click()
    assert fresh.locator(control("remove 1")).is_disabled()
    rested(fresh)
    one = state(fresh)
    assert len(one["settings"]["points"]) == 1
    assert len(one["runs"]["points"]) * MOST_POINTS == len(most["runs"]["points"])
    assert_points_are_python(one)


def test_a_point_is_hidden_for_a_while(fresh):
    before = state(fresh)
    fresh.locator(control("hide 2")).check()
    fresh.locator(control("hidden from 2")).fill("2")
    fresh.locator(control("hidden to 2")).fill("5.6")
    rested(fresh)
    shown = state(fresh)
    assert shown["settings"]["hidden"] == [None, [2, 5.6], None]
    assert "Point 2 was hidden from 2 to 5.6 s" in shown["words"]
    assert (before["bars"]["error"], shown["bars"]["error"]) == (0, 1)
    assert_points_are_python(shown)
    fresh.locator(control("hidden to 2")).fill("1")
    assert fresh.locator(control("hidden to 2")).get_attribute("aria-invalid") == "true"
    assert state(fresh)["settings"]["hidden"] == [None, [2, 5.6], None]
    fresh.locator(control("hide 2")).uncheck()
    rested(fresh)
    assert state(fresh)["drawn"] == before["drawn"]


def test_p_is_typed_as_a_diagonal_and_what_does_not_fit_is_said(fresh):
    def typed(name, text):
        fresh.locator(control(name)).fill(text)
        fresh.locator(control(name)).press("Enter")

    def shown(name, text):
        typed(name, text)
        fresh.wait_for_function(
            "([name, text]) => [...perceptObsLabs][0].settings[name] === text", arg=[name, f"P = {text}"]
        )
        rested(fresh)
        return state(fresh)

    fresh.locator(control("weight")).select_option("riccati")
    assert_points_are_python(shown("P0", "[P, P, P/4]"), 1e-7)
    fresh.locator(control("weight")).select_option("typed")
    assert_points_are_python(shown("P", "[1, 2, 3]"))
    typed("P", "[[1, 2, 0], [t, 1, 0], [0, 0, 1]]")
    said = fresh.locator("[data-control=P] ~ [role=status]")
    said.wait_for()
    assert "it must be a number or a diagonal" in said.inner_text()
    typed("P", "[1, 1, 1 - t]")
    fresh.wait_for_function("() => document.body.innerText.includes('It must be positive at all times')")
    fresh.locator(control("undo")).click()
    rested(fresh)


def test_the_motion_is_changed_and_what_is_lost_is_said(fresh):
    fresh.locator(control("no input")).click()
    rested(fresh)
    lost = state(fresh)
    assert "(14) fails" in lost["words"]
    assert "images do not tell its scale" in lost["words"]
    assert_points_are_python(lost)
    fresh.locator(control("velocity X number")).fill("0.4")
    rested(fresh)
    assert "images do not tell its scale" not in state(fresh)["words"]
    fresh.locator(control("state origin")).check()
    rested(fresh)
    shown = state(fresh)
    assert "3 directions are not seen: o_x - d1_x" in shown["words"]
    assert_points_are_python(shown)


def test_a_handle_is_pressed_whose_point_goes_with_the_next_picture(fresh):
    last = len(state(fresh)["settings"]["points"])
    fresh.evaluate(
        """async (last) => {
            const [lab] = window.perceptObsLabs;
            const handle = (k) => document.querySelector(`[data-control="point ${k}"]`);
            lab.paint = () => {};  // the picture is late
            handle(1).focus();
            handle(1).dispatchEvent(new KeyboardEvent("keydown", { key: "Delete", bubbles: true }));
            while (lab.latest.shown.settings !== lab.settings) {
                await new Promise((resolve) => setTimeout(resolve, 10));
                lab.compute();
            }
            delete lab.paint;
            lab.pending = true;
            handle(last).dispatchEvent(new PointerEvent("pointerdown", { pointerId: 3, bubbles: true }));
            handle(last).dispatchEvent(new PointerEvent("pointerup", { pointerId: 3, bubbles: true }));
        }""",
        last,
    )
    rested(fresh)
    assert len(state(fresh)["settings"]["points"]) == last - 1
