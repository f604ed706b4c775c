"""The lab of many points follows the hand, survives any order of events, and is open to keyboards."""

import pytest
from lab_browser import assert_points_are_python, control, rested, state

from percept_obs.labs.points.lab import points_lab
from percept_obs.labs.points.settings import MOST_POINTS

pytestmark = [pytest.mark.browser, pytest.mark.slow]


@pytest.fixture(scope="module")
def python():
    """The lab in Python."""
    return points_lab(duration=8.0, window=4.0)


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
    fresh.locator(control("hidden from 2 number")).fill("2")
    fresh.locator(control("hidden to 2 number")).fill("5.6")
    rested(fresh)
    shown = state(fresh)
    assert shown["settings"]["hidden"] == [None, [2, 5.6], None]
    assert "Point 2 was hidden from 2 to 5.6 s" in shown["words"]
    assert (before["bars"]["first"], shown["bars"]["first"]) == (0, 1)
    assert_points_are_python(shown)
    fresh.locator(control("hidden to 2 number")).fill("1")
    assert fresh.locator(control("hidden to 2 number")).get_attribute("aria-invalid") == "true"
    assert state(fresh)["settings"]["hidden"] == [None, [2, 5.6], None]
    fresh.locator(control("hide 2")).uncheck()
    rested(fresh)
    assert state(fresh)["drawn"] == before["drawn"]


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
    fresh.locator(control("state")).select_option("origin")
    rested(fresh)
    shown = state(fresh)
    assert "3 directions are not seen: o_x - d1_x" in shown["words"]
    assert_points_are_python(shown)
