"""The observer lab survives any order of events, keeps its memory, and is open to keyboards and screen readers."""

import pytest
from lab_alone import DRAWN, opened
from lab_browser import (
    EVENTS,
    UNFOLD,
    assert_equals_python,
    assert_fits,
    assert_has,
    assert_own_colours,
    control,
    moved_by_keyboard,
    rested,
    serious_violations,
    state,
    usable,
    used_at_random,
)
from lab_settings import ALL, assert_follows_python

from percept_obs.labs.observer.lab import observer_lab, runs
from percept_obs.system.surfaces import BehindCamera

pytestmark = [pytest.mark.browser, pytest.mark.slow]

CHUNKS, SAMPLES = 2, 4000


@pytest.fixture(scope="module")
def python():
    """The lab in Python, with a run that is long enough."""
    return observer_lab(duration=20.0)


def test_random_events_break_nothing_and_reset_restores_everything(fresh, python):
    opening, unused = state(fresh), usable(fresh)
    for seed in range(CHUNKS):
        wanted = unused if seed == CHUNKS - 1 else set()
        unused -= used_at_random(fresh, seed, wanted, EVENTS // CHUNKS, SAMPLES)
        shown = state(fresh)
        assert_has(python, shown["settings"])
        assert shown["problems"] == []
        if shown["runs"]:
            told = {n: {"estimate": e, "divergedAt": shown["divergedAt"][n]} for n, e in shown["runs"].items()}
            assert_follows_python(shown["settings"], told)
        else:
            with pytest.raises(BehindCamera):
                runs(shown["settings"])
    assert unused == set()
    fresh.click(control("reset"))
    rested(fresh, 60)
    assert state(fresh) == opening
    assert_equals_python(state(fresh))


def test_axe_finds_nothing_serious(fresh):
    fresh.click(control("preset drop"))
    assert serious_violations(fresh) == []


def test_every_control_is_reached_and_moved_by_keyboard(browser):
    observers = ["identifier_based", "sliding_mode", "extended_kalman", "immersion_and_invariance"]
    page = opened(browser, observer_lab(duration=2.0, observers=observers, pictures=["error", "inverse"]))
    page.wait_for_function(DRAWN)
    page.evaluate(UNFOLD)
    page.check(control("believed"))
    page.select_option(control("start"), "chosen")
    assert len(moved_by_keyboard(page, "foe")) > 100
    page.wait_for_function(DRAWN)
    page.close()


def test_each_picture_says_in_words_what_it_shows(fresh):
    for name in ("outputs", "inverse"):
        fresh.check(control(f"picture {name}"))
    rested(fresh)
    labels = state(fresh)["labels"]
    expected = {
        "Image plane": ("the point goes from y1 0.4, y2 0.6", "estimate ends at", "focus of expansion at y1 1.67"),
        "Scene": ("the point goes from 2.5 m", "estimate begins infinitely far away"),
        "Image coordinates": ("true y1: from 0.4",),
        "Inverse distance": ("true y3: from 0.4",),
        "Distance": ("true distance: from 2.5",),
        "Relative error": ("identifier-based error",),
        "Excitation": ("smallest eigenvalue", "excitation: from"),
    }
    assert len(labels) == len(expected)
    for start, parts in expected.items():
        (label,) = [text for text in labels if text.startswith(start)]
        assert all(part in label for part in parts), label


def test_causes_are_told_of_settings_whose_functions_are_not_there_yet(fresh):
    fresh.evaluate("""() => {
        const [lab] = window.perceptObsLabs;
        lab.change({ outputs: ["y2"], observers: ["spica"], surface: "chained" }, true);
        document.querySelector(".causes").closest("details").open = false;
        document.querySelector(".causes").closest("details").open = true;
    }""")
    rested(fresh)
    fresh.wait_for_selector(".causes li:has-text('with y1 and y2 measured')")


def test_lines_are_told_apart_without_colour(fresh):
    for name in ALL[1:]:
        fresh.check(control(f"observer {name}"))
    fresh.click(control("keep"))
    rested(fresh)
    dashes = fresh.evaluate("""() => [...window.perceptObsLabs][0].drawn.distance.lines
        .filter((line) => !line.name.startsWith("kept")).map((line) => line.dash.join(" "))""")
    assert len(dashes) == len(set(dashes)) == 1 + len(ALL)


@pytest.mark.parametrize("width", [400, 640, 1000])
def test_the_lab_fits_its_cell(fresh, width):
    assert_fits(fresh, width)


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
        Object.assign(lab, { stale: true, spoken: -Infinity });
        lab.paint();
    }""")
    assert "could not be loaded" in fresh.inner_text(".problem:not([hidden])")
    fresh.click(control("reset"))
    rested(fresh)
    assert state(fresh)["problems"] == []


def test_dark_and_light_have_their_own_colours(fresh):
    assert_own_colours(fresh)
