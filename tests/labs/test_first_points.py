"""The screen of many points: marks are dragged and hidden, the estimate starts elsewhere, a copy stays unseen."""

import numpy as np
import pytest
from first_screens import asked, at_the_end, first_screen
from lab_alone import DRAWN
from lab_browser import control

from percept_obs.labs import points_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SEEN = """() => { const [{ screen, settings, shown }] = window.perceptObsLabs;
    const { places, found, copy, inWorld, foundInWorld, copyInWorld, hidden, off } = screen.seen;
    return { places, found, copy, inWorld, foundInWorld, copyInWorld, hidden, off, settings,
        errors: shown.errors.map((error) => Array.from(error)) }; }"""
SHOW = "(time) => { const [lab] = window.perceptObsLabs; lab.screen.clock.pause(); lab.point(time); lab.paint(); }"


@pytest.fixture
def page(browser):
    with first_screen(browser, points_lab()) as page:
        at_the_end(page)
        yield page


def seen(page):
    page.wait_for_function(DRAWN)
    return page.evaluate(SEEN)


def middle(page, name):
    box = page.locator(control(name)).bounding_box()
    return np.array([box["x"] + 22, box["y"] + 22])


def drag(page, name, x, y):
    """Drag a handle, and return by how many pixels it moved while it was held."""
    before = middle(page, name)
    page.mouse.move(*before)
    page.mouse.down()
    page.mouse.move(before[0] + x, before[1] + y, steps=6)
    page.wait_for_function(DRAWN)
    moved = middle(page, name) - before
    page.mouse.up()
    return moved


def images(places):
    return [[x / z, y / z] for x, y, z in places]


LATE = """() => { const [lab] = window.perceptObsLabs;
    const { points, hidden } = lab.settings;
    lab.change({ points: points.slice(0, 1), hidden: hidden.slice(0, 1) }, true);
    lab.screen.aim(0, [0.1, 0.1]);  // of three marks, which are still drawn
    lab.screen.hide(2);
    return [lab.settings.points.length, lab.settings.hidden.length]; }"""


def test_marks_of_a_body_that_is_drawn_late_are_left_alone(page):
    assert page.evaluate(LATE) == [1, 1]


@pytest.mark.parametrize("time", [0.0, 3.3, 10.0])
@pytest.mark.parametrize("mark", [0, 2])
def test_a_mark_is_moved_at_the_depth_that_it_has_now_and_the_others_stay(page, time, mark):
    page.evaluate(SHOW, time)
    before = seen(page)
    picture = page.locator(".view.image").bounding_box()
    inwards = 30 if middle(page, f"mark {mark + 1}")[0] < picture["x"] + picture["width"] / 2 else -30
    moved = drag(page, f"mark {mark + 1}", inwards, 20)
    np.testing.assert_allclose(moved, [inwards, 20], atol=1.5)  # under the finger
    after = seen(page)
    assert after["places"][mark][2] == pytest.approx(before["places"][mark][2])
    others = [k for k in range(3) if k != mark]
    np.testing.assert_allclose(*[[x["places"][k] for k in others] for x in (after, before)], atol=1e-9)


def test_a_mark_that_is_pressed_is_hidden_from_now_on_and_shown_again(page):
    page.evaluate(SHOW, 4.0)
    page.click(control("mark 2"))
    after = seen(page)
    assert after["hidden"] == [False, True, False]
    assert after["settings"]["hidden"][1] == pytest.approx([4.0, 11.0])
    assert after["settings"]["hidden"][0] is None
    page.evaluate(SHOW, 6.0)
    page.focus(control("mark 2"))
    page.keyboard.press("Enter")
    assert seen(page)["settings"]["hidden"][1] == pytest.approx([4.0, 6.0])
    page.evaluate(SHOW, 10.0)
    page.keyboard.press(" ")
    assert seen(page)["settings"]["hidden"][1] == pytest.approx([0.0, 11.0])


def test_the_estimate_starts_where_it_is_dragged_along_its_error(page):
    page.evaluate(SHOW, 0.0)
    before = seen(page)
    drag(page, "estimate", 0, -12)
    after = seen(page)
    assert after["settings"]["error"] < before["settings"]["error"]
    ways = [np.subtract(x["foundInWorld"][0], x["inWorld"][0]) / x["settings"]["error"] for x in (before, after)]
    np.testing.assert_allclose(*ways, atol=1e-9)


def test_a_copy_that_is_dragged_moves_no_image_at_any_time(page):
    asked(page, "travel")
    before = seen(page)
    moved = drag(page, "copy", 0, 30)
    assert moved[1] > 15
    for time in (0.0, 4.1, 10.0):
        page.evaluate(SHOW, time)
        after = seen(page)
        np.testing.assert_allclose(images(after["copy"]), images(after["places"]), atol=1e-6)
    assert np.abs(np.subtract(after["copyInWorld"], before["copyInWorld"])).max() > 0.3
    page.focus(control("copy"))
    page.keyboard.press("ArrowUp")
    assert np.abs(np.subtract(seen(page)["copyInWorld"], after["copyInWorld"])).max() > 0.1


def test_a_copy_of_what_is_hidden_moves_freely_and_what_is_seen_stays(page):
    asked(page, "one")
    moved = drag(page, "copy", -20, 15)
    np.testing.assert_allclose(moved, [-20, 15], atol=1.5)
    after = seen(page)
    np.testing.assert_allclose(after["copyInWorld"][0], after["inWorld"][0], atol=1e-6)


def test_there_is_no_copy_where_everything_is_seen_and_the_camera_travels(page):
    assert seen(page)["copy"] is None
    page.locator(control("travel")).fill("0")
    assert seen(page)["copy"] is not None
    assert page.inner_text(".says").startswith("Still")


def test_it_opens_with_a_body_that_is_found_and_as_far_off_as_python_says(page):
    run = points_lab().run()
    nose, left, right = np.moveaxis((run.estimate - run.truth).reshape(-1, 3, 3), 1, 0)
    off = np.linalg.norm([nose, nose + left, nose + right], axis=2)
    assert off[:, 0].mean() > 2
    assert off[:, -1].mean() < 0.05
    after = seen(page)
    np.testing.assert_allclose(after["errors"], off, atol=1e-6)
    assert after["off"] == pytest.approx(off[:, -1].mean(), abs=1e-6)
    assert page.inner_text(".says").startswith("Found")


def test_the_world_rests_while_the_camera_travels(page):
    found = []
    for time in (0.0, 2.34, 10.0):
        page.evaluate(SHOW, time)
        found.append(seen(page)["inWorld"])
    np.testing.assert_allclose(found[1:], [found[0]] * 2, atol=1e-6)
    assert found[0] == pytest.approx(np.array(points_lab().settings["points"]), abs=1e-9)


@pytest.mark.parametrize(
    "settings",
    [
        {"state": "origin"},
        {"state": "independent", "spin": 0.5},
        {"points": [[0.0, 1.2, 2.5]]},
        {"points": [[0.3 * k, 1.2, 2.5 + 0.1 * k] for k in range(12)]},
        {"period": 0.27, "size": 0.001},
    ],
    ids=["origin", "independent", "one", "twelve", "diverges"],
)
def test_any_other_settings_are_shown_as_well(settings, browser):
    with first_screen(browser, points_lab(duration=4.0, **settings)) as page:
        at_the_end(page)
        assert page.evaluate(
            "() => [...window.perceptObsLabs][0].screen.views.slice(0, 3).every(({ texts }) => texts.length > 0)"
        )
        assert seen(page)["copy"] is None
