"""Every lab follows the hand, survives any order of events, and is open to keyboards and screen readers."""

import pytest
from lab_alone import DRAWN, opened
from lab_browser import (
    EVENTS,
    UNFOLD,
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
from lab_settings import ALL
from sample_sizes import across

from percept_obs.labs import observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

MAKE = {"observer": observer_lab, "structure": structure_lab, "points": points_lab}
OPENING = {
    "observer": {"duration": 20.0},
    "structure": {"duration": 3.0, "period": 0.01, "step": 0.005},
    "points": {"duration": 8.0, "window": 4.0},
}
HANDLE = {"observer": "foe", "structure": "ybar", "points": "point 2"}
"""The handle that is dragged."""
MOVED = {
    "observer": lambda settings: (settings["b"][:2], settings["b"][2:]),
    "structure": lambda settings: (settings["ybar"][:2], settings["ybar"][2:]),
    "points": lambda settings: (settings["points"][1][:2], [settings["points"][k][2] for k in range(3)]),
}
MOST_SAMPLES = {"observer": 4000, "structure": 4000, "points": 800}
WIDE_OPEN = {
    "observer": {"duration": 2.0, "observers": ["identifier_based", "sliding_mode"], "pictures": ["error", "inverse"]},
    "structure": {"period": 0.02, "step": 0.01, "duration": 1.0, "observers": ["ideal", "layer"]},
    "points": {"duration": 2.0, "hidden": [None, None, [0.5, 1.0]]},
}
"""Short runs with controls of every kind."""
MORE = {"observer": ["believed"], "structure": ["swings"], "points": []}
LINES = {
    "observer": ("distance", ALL[1:], 1 + len(ALL)),
    "structure": ("range", ["layer", "extended_kalman", "identifier_based"], 5),
    "points": ("points", [], 3),
}
"""A chart, observers to add, and how many lines it has then."""
PICTURES = {
    "observer": (
        ["outputs", "inverse"],
        {
            "Image plane": ("the point goes from y1 0.4, y2 0.6", "estimate ends at", "focus of expansion at y1 1.67"),
            "Scene": ("the point goes from 2.5 m", "estimate begins infinitely far away"),
            "Image coordinates": ("true y1: from 0.4",),
            "Inverse distance": ("true y3: from 0.4",),
            "Distance": ("true distance: from 2.5",),
            "Relative error": ("identifier-based error",),
            "Excitation": ("smallest eigenvalue", "excitation: from"),
        },
    ),
    "structure": (
        ["innovation"],
        {
            "Image plane": ("the point goes from y1 0.32",),
            "Scene, seen from the side": ("the point goes from",),
            "Innovation over time": ("innovation: from",),
        },
    ),
    "points": (
        ["points"],
        {
            "Image plane": ("point 1 goes from y1 0, y2 0.48", "its estimate ends at"),
            "Scene": ("point 1 goes from depth 2.5 to", "its estimate ends at"),
            "Norm of the error": ("error: from 1.25",),
            "Depth": ("true depth of point 1: from 2.5", "depth of point 3: from 1.5"),
            "Error of each point": ("error of point 2",),
            "Smallest eigenvalue": ("smallest eigenvalue: from",),
        },
    ),
}


@pytest.fixture(scope="module", params=MAKE)
def kind(request):
    return request.param


@pytest.fixture(scope="module")
def python(kind):
    """The lab in Python."""
    return MAKE[kind](**OPENING[kind])


DRAGS = [drag_by_mouse, drag_by_touch, drag_by_keys]


@pytest.mark.parametrize(("kind", "drag"), across([*MAKE], DRAGS), indirect=["kind"])
def test_what_is_dragged_follows_the_hand(fresh, python, kind, drag):
    before = state(fresh)
    drag(fresh, control(HANDLE[kind]))
    rested(fresh)
    after = state(fresh)
    (moved, rest), (old, old_rest) = MOVED[kind](after["settings"]), MOVED[kind](before["settings"])
    assert moved != old
    assert rest == pytest.approx(old_rest)
    for what in ("runs", "labels", "drawn"):
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


def test_each_picture_says_in_words_what_it_shows(fresh, kind):
    more, expected = PICTURES[kind]
    for name in more:
        fresh.check(control(f"picture {name}"))
    rested(fresh)
    labels = state(fresh)["labels"]
    for start, parts in expected.items():
        (label,) = [text for text in labels if text.startswith(start)]
        assert all(part in label for part in parts), label


def test_lines_are_told_apart_without_colour(fresh, kind):
    chart, more, count = LINES[kind]
    for name in more:
        fresh.check(control(f"observer {name}"))
    fresh.check(control(f"picture {chart}"))
    fresh.click(control("keep"))
    rested(fresh)
    dashes = fresh.evaluate(f"""() => [...window.perceptObsLabs][0].drawn.{chart}.lines
        .filter((line) => !line.name.startsWith("kept")).map((line) => line.dash.join(" "))""")
    assert len(dashes) == len(set(dashes)) == count


def test_every_control_is_reached_and_moved_by_keyboard(browser, kind):
    page = opened(browser, MAKE[kind](**WIDE_OPEN[kind]))
    page.wait_for_function(DRAWN)
    page.evaluate(UNFOLD)
    for name in MORE[kind]:
        page.check(control(name))
    reached = set(moved_by_keyboard(page, "point 1" if kind == "points" else HANDLE[kind]))
    assert len(reached) > (40 if kind == "points" else 60)
    if kind == "points":
        assert {"point 1", "remove 2", "hide 3", "add point", "size", "aim", "cursor"} <= reached
    page.wait_for_function(DRAWN)
    page.close()


def test_a_number_stands_in_the_topic_that_its_setting_names(fresh, kind):
    placed = {name: setting.topic for name, setting in MAKE[kind].schema.items() if setting.topic}
    assert len(placed) > 3
    for name, topic in placed.items():
        assert fresh.locator(f".topic.{topic} {control(name)}").count(), f"{name} is not in the topic {topic}"


def test_random_events_break_nothing_and_reset_restores_everything(fresh, python, kind):
    opening, wanted = state(fresh), usable(fresh)
    assert wanted - used_at_random(fresh, 11, wanted, EVENTS, MOST_SAMPLES[kind]) == set()
    shown = state(fresh)
    assert_has(python, shown["settings"])
    assert MAKE[kind](**shown["settings"]).settings == shown["settings"]
    assert shown["problems"] == []
    assert_is_python(kind, shown, following=True)
    fresh.click(control("reset"))
    rested(fresh, 60)
    assert state(fresh) == opening
    assert_is_python(kind, opening)
