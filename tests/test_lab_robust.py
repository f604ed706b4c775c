"""The observer lab survives any order of events, keeps its memory, and is open to keyboards and screen readers."""

import pytest
from jupyter_harness import jupyterlab, lab_page, log_entries
from lab_browser import (
    EVENTS,
    WIDTH,
    assert_equals_python,
    assert_moved_by_keyboard,
    assert_python_has,
    control,
    open_lab,
    reached_by_keyboard,
    rested,
    serious_violations,
    state,
    usable,
    used_at_random,
)
from lab_settings import ALL, assert_follows_python
from test_lab_layout import WALK

from percept_obs.labs.observer.lab import runs
from percept_obs.system.surfaces import BehindCamera

pytestmark = [pytest.mark.browser, pytest.mark.slow]

CHUNKS, SAMPLES = 2, 4000
COLOURS = "() => { const [lab] = window.perceptObsLabs; return [lab.theme.ink, ...lab.theme.lines]; }"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("notebooks")


@pytest.fixture(scope="module")
def lab(chromium, folder, tmp_path_factory):
    """A page with one lab that the tests of this module share."""
    homes = [tmp_path_factory.mktemp(name) for name in ("server", "browser")]
    with jupyterlab(folder, homes[0]) as server, lab_page(chromium, server, homes[1]) as page:
        page.set_default_timeout(15_000)
        open_lab(page, folder)
        yield page


@pytest.fixture
def fresh(lab):
    lab.click(control("reset"))
    rested(lab)
    return lab


def test_random_events_break_nothing_and_reset_restores_everything(fresh, folder):
    opening, unused = state(fresh), usable(fresh)
    for seed in range(CHUNKS):
        wanted = unused if seed == CHUNKS - 1 else set()
        unused -= used_at_random(fresh, seed, wanted, EVENTS // CHUNKS, SAMPLES)
        shown = state(fresh)
        assert_python_has(folder, shown["settings"])
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
    assert not log_entries(fresh)


def test_a_thousand_moves_do_not_fill_the_memory(fresh):
    """A run's estimates are 48 kB here; kept at every move they would fill five times what is allowed."""
    fresh.fill(control("duration number"), "20")
    session = fresh.context.new_cdp_session(fresh)

    def used():
        session.send("HeapProfiler.collectGarbage")
        usage = session.send("Runtime.getHeapUsage")
        return (usage["usedSize"] + usage.get("backingStorageSize", 0)) / 1e6

    move = """async (count) => {
        const [lab] = window.perceptObsLabs;
        for (let k = 0; k < count; k++) {
            lab.moveFoe([1.6 + 0.1 * Math.sin(k / 9), 0.8]);
            await new Promise((resolve) => requestAnimationFrame(resolve));
        }
    }"""
    fresh.evaluate(move, 100)
    rested(fresh)
    before = used()
    fresh.evaluate(move, 1000)
    rested(fresh)
    assert used() - before < 10


def test_axe_finds_nothing_serious(fresh):
    fresh.click(control("preset drop"))
    assert serious_violations(fresh) == []


def test_every_control_is_reached_and_moved_by_keyboard(fresh):
    fresh.fill(control("duration number"), "5")
    fresh.check(control("believed"))
    fresh.select_option(control("start"), "chosen")
    for name in ("sliding_mode", "extended_kalman", "immersion_and_invariance"):
        fresh.check(control(f"observer {name}"))
    rested(fresh)
    assert_moved_by_keyboard(fresh, reached_by_keyboard(fresh, "foe"))
    rested(fresh)


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
    fresh.evaluate(WIDTH, f"{width}px")
    fresh.wait_for_timeout(200)
    assert (
        fresh.evaluate("""() => {
        const lab = document.querySelector('.percept-lab');
        return [...lab.querySelectorAll('canvas, fieldset, .actions, .control')].filter(
            (e) => e.getBoundingClientRect().right > lab.getBoundingClientRect().right + 1).length;
    }""")
        == 0
    )
    fresh.evaluate(WIDTH, "")


def test_in_jupyterlab_pictures_are_in_view_whichever_control_has_the_focus(fresh):
    fresh.set_viewport_size({"width": 1280, "height": 800})
    fresh.wait_for_timeout(300)
    found = fresh.evaluate(WALK)
    fresh.set_viewport_size({"width": 1280, "height": 900})
    assert found["wrong"] == []
    assert found["walked"] > 60


def test_a_kernel_text_that_fails_to_load_is_told(fresh):
    fresh.evaluate("""() => {
        const [lab] = window.perceptObsLabs;
        lab.model.forms["pinhole y2"].observers.sliding_mode.fraction.run = "function run( {";
        const { groups, waiting } = lab.kernels.modules;
        for (const kept of [groups, waiting]) kept.delete("pinhole y2 sliding_mode fraction");
        lab.change({ outputs: ["y2"], observers: ["sliding_mode"] }, true);
    }""")
    fresh.wait_for_selector(".problem:not([hidden])")
    assert "could not be loaded" in fresh.inner_text(".problem:not([hidden])")
    fresh.click(control("reset"))
    rested(fresh)
    assert state(fresh)["problems"] == []


def test_dark_and_light_have_their_own_colours(fresh):
    light = fresh.evaluate(COLOURS)
    fresh.evaluate("document.body.dataset.jpThemeLight = 'false'")
    fresh.wait_for_timeout(200)
    dark = fresh.evaluate(COLOURS)
    fresh.evaluate("document.body.dataset.jpThemeLight = 'true'")
    assert light[1] != dark[1]
