"""Every lab follows the hand, survives any order of events, and is open to keyboards and screen readers."""

import pytest
from lab_alone import DRAWN, opened
from lab_browser import (
    EVENTS,
    assert_fits,
    assert_has,
    assert_is_python,
    assert_own_colours,
    control,
    drag_by_keys,
    drag_by_mouse,
    drag_by_touch,
    moved_by_keyboard,
    rested,
    serious_violations,
    state,
    usable,
    used_at_random,
)

from percept_obs.labs import observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

MAKE = {"observer": observer_lab, "structure": structure_lab, "points": points_lab}
OPENING = {
    "observer": {"duration": 20.0},
    "structure": {"duration": 3.0, "period": 0.01, "step": 0.005},
    "points": {"duration": 8.0, "window": 4.0},
}
HANDLE = {"observer": "foe", "structure": "camera", "points": "mark 2"}
"""The handle that is dragged, and the setting that it moves."""
MOVED = {"observer": "b", "structure": "v_c", "points": "points"}
MOST_SAMPLES = {"observer": 4000, "structure": 4000, "points": 800}
WIDE_OPEN = {
    "observer": {"duration": 2.0, "observers": ["identifier_based", "sliding_mode"], "charts": ["error", "inverse"]},
    "structure": {"period": 0.02, "step": 0.01, "duration": 1.0, "observers": ["ideal", "layer"]},
    "points": {"duration": 2.0, "hidden": [None, None, [0.5, 1.0]]},
}
"""Short runs with controls of every kind."""
MORE = {"observer": ["believed"], "structure": ["swings"], "points": []}
TOLD = {
    "observer": {"Relative error": ("estimate: from", "bound: from"), "Inverse distance": ("true: from 0.4",)},
    "structure": {"Innovation": ("estimate: from",), "Image coordinates": ("y1 true: from",)},
    "points": {"Relative error of each point": ("point 2: from",), "Depth of each point": ("point 1: from 2.5",)},
}
"""Charts below the first by their titles, and what they say in words."""


@pytest.fixture(scope="module", params=MAKE)
def kind(request):
    return request.param


@pytest.fixture(scope="module")
def python(kind):
    """The lab in Python."""
    return MAKE[kind](**OPENING[kind])


DRAGS = [drag_by_mouse, drag_by_touch, drag_by_keys]


@pytest.mark.parametrize("drag", DRAGS)
def test_what_is_dragged_follows_the_hand(fresh, python, kind, drag):
    before = state(fresh)
    drag(fresh, control(HANDLE[kind]))
    rested(fresh)
    after = state(fresh)
    assert {name for name, value in after["settings"].items() if value != before["settings"][name]} >= {MOVED[kind]}
    for what in ("runs", "drawn"):
        assert after[what] != before[what]
    assert_is_python(kind, after)
    assert_has(python, after["settings"])


def test_axe_finds_nothing_serious(fresh):
    assert serious_violations(fresh) == []


def test_the_lab_fits_its_cell(fresh):
    for width in (400, 640, 1000):
        assert_fits(fresh, width)


def test_dark_and_light_have_their_own_colours(fresh):
    assert_own_colours(fresh)


def test_each_chart_says_in_words_what_it_shows(fresh, kind):
    if kind == "observer":
        fresh.fill(control("noise size"), "0.003")
    for box in fresh.locator("[data-control^='chart ']").all():
        box.check()
    rested(fresh)
    labels = state(fresh)["labels"]
    for start, parts in TOLD[kind].items():
        (label,) = [text for text in labels if text.startswith(f"{start}:")]
        assert all(part in label for part in parts), label


@pytest.mark.night
def test_every_control_is_reached_and_moved_by_keyboard(browser, kind):
    """It takes the night for its fifty seconds: controls are of few kinds, and each kind has tests of its own."""
    page = opened(browser, MAKE[kind](**WIDE_OPEN[kind]))
    page.wait_for_function(DRAWN)
    page.evaluate("tests.unfold()")
    for name in MORE[kind]:
        page.check(control(name))
    reached = set(moved_by_keyboard(page))
    assert len(reached) > 40
    if kind == "points":
        assert {"mark 1", "remove 2", "hide 3", "add point", "gain", "aim", "more"} <= reached
    page.wait_for_function(DRAWN)
    page.close()


def test_random_events_break_nothing_and_reset_restores_everything(fresh, python, kind):
    opening, wanted = state(fresh), usable(fresh)
    assert wanted - used_at_random(fresh, 11, wanted, EVENTS, MOST_SAMPLES[kind]) == set()
    shown = state(fresh)
    assert_has(python, shown["settings"])
    assert MAKE[kind](**shown["settings"]).settings == shown["settings"]
    assert shown["problems"] == []
    assert_is_python(kind, shown, following=True)
    fresh.evaluate("tests.reset()")
    rested(fresh, 60)
    assert state(fresh) == opening
    assert_is_python(kind, opening)
