"""A map over two settings holds at every place what Python computes there, follows the hand, and leads to the place."""

import numpy as np
import pytest
from javascript import run_script
from lab_alone import DRAWN, opened, stated_policy
from lab_browser import control, serious_violations
from lab_settings import FRONT, NOISY, runs, whole_model

from percept_obs.labs import observer_lab, structure_lab

FOLLOWED, DIVERGED = 1, 2
GAIN = "gains.identifier_based.gain"
PLACES = 25
CELLS = 128
PAIRS = {
    "gain and noise": {"over": {"across": GAIN, "up": "noise.size"}},
    "two gains": {"over": {"across": GAIN, "up": "gains.identifier_based.lyapunov"}},
    "a filter's gain and the focus of expansion": {
        "over": {"across": "gains.extended_kalman.noise_variance", "up": "foe.0"},
        "observers": ["extended_kalman"],
    },
    "where the point starts": {"over": {"across": "seen.0", "up": "seen.2"}, "surface": "sphere"},
}


def in_the_page(node, lab, tasks):
    """What the page says became of runs at places of maps."""
    task = {"model": whole_model(lab), "tasks": tasks, "kind": lab.kind}
    return run_script(node, FRONT / "tests/run_cells.js", task)


def somewhere(rng):
    """Middles of random cells of the finest map, as shares of the way along both axes."""
    return ((rng.integers(CELLS, size=(PLACES, 2)) + 0.5) / CELLS).tolist()


@pytest.fixture(scope="module")
def of_pairs(node):
    """Settings at random places of maps, with what the page says became of their runs."""
    rng = np.random.default_rng(0)
    tasks = []
    for changes in PAIRS.values():
        observer = changes.get("observers", ["identifier_based"])[0]
        shared = {"noise": NOISY, "seed": 3, "duration": 10.0, "dropout": 0.1}
        settings = observer_lab(**{**shared, **changes, "over": {"observer": observer, **changes["over"]}}).settings
        tasks.append({"settings": settings, "shares": somewhere(rng)})
    return {
        p: {**t, **f}
        for p, t, f in zip(PAIRS, tasks, in_the_page(node, observer_lab("ma2005_eq35"), tasks), strict=True)
    }


@pytest.mark.node
@pytest.mark.slow
@pytest.mark.parametrize("pair", PAIRS)
def test_100_random_places_are_what_python_tracks(of_pairs, pair):
    found = of_pairs[pair]
    assert (found["across"], found["up"]) == tuple(PAIRS[pair]["over"].values())
    followed = 0
    for cell in found["cells"]:
        (run,) = runs(cell["settings"]).values()
        assert cell["kind"] == (FOLLOWED if run.diverged_at is None else DIVERGED)
        if run.diverged_at is None:
            followed += 1
            outcome = run.outcome()
            assert float(cell["settling"]) == pytest.approx(outcome.settled, rel=1e-9)
            assert float(cell["error"]) == pytest.approx(outcome.final, rel=1e-9, nan_ok=True)
    assert followed > PLACES / 2
    assert len({cell["settling"] for cell in found["cells"]}) > 3


FILLED = "() => [...window.perceptObsLabs][0].planes[2].sweep.whole"
MAP = ".settings-map canvas"
TOLD = "(part) => document.querySelector('.settings-map canvas').ariaLabel.includes(part)"
PLACE = control("map place")


def page_of(browser, lab, **options):
    page = opened(browser, lab, viewport={"width": 1280, "height": 800}, answers=lambda told: {}, **options)
    page.wait_for_function(DRAWN)
    return page


def settings_of(page):
    return page.evaluate("[...window.perceptObsLabs][0].settings")


@pytest.mark.browser
@pytest.mark.slow
def test_a_map_is_shown_pointed_at_gone_to_and_undone_by_keys_and_by_hand(browser):
    page = page_of(browser, observer_lab(noise=NOISY, duration=2.0))
    assert not page.is_visible(MAP)
    assert page.evaluate("[...window.perceptObsLabs][0].planes[2].worker") is None
    page.click("summary:has-text('Map over two settings')")
    page.wait_for_function("() => [...window.perceptObsLabs][0].planes[2].sweep.present")  # before it is chosen
    page.focus(control("map shows"))
    page.keyboard.press("ArrowDown")
    page.wait_for_function(FILLED)
    page.wait_for_function(TOLD, arg="128 by 128")
    label = page.get_attribute(MAP, "aria-label")
    assert "Settling time, identifier-based over gain in 1/s from 1 to 30 and noise, bound or σ from 0 to 0.05" in label
    assert "the same seed everywhere" in page.inner_text(".run-there")
    before = settings_of(page)
    page.focus(PLACE)
    page.keyboard.press("Shift+ArrowRight")
    told = page.wait_for_function(
        "() => { const t = document.querySelector('.aim').ariaValueText; return /gain in/.test(t) && t; }"
    ).json_value()
    page.keyboard.press("Enter")
    page.wait_for_function(DRAWN)
    there = settings_of(page)
    gain = there["gains"]["identifier_based"]["gain"]
    assert told.startswith(f"gain in 1/s {gain}, noise, bound or σ {there['noise']['size']}: ")
    verdict = page.inner_text(".verdicts")
    assert (told.split("after ")[1].split(" s")[0] if "after" in told else "outside") in verdict
    assert gain > before["gains"]["identifier_based"]["gain"]
    page.keyboard.press("Control+z")
    assert settings_of(page) == before
    box = page.locator(PLACE).bounding_box()
    page.mouse.click(box["x"] + 0.25 * box["width"], box["y"] + 0.75 * box["height"])
    page.wait_for_function(DRAWN)
    assert settings_of(page)["noise"]["size"] == pytest.approx(0.0125, abs=0.0005)
    assert page.evaluate(FILLED)  # it is the same map
    page.select_option(control("map up"), "foe.0")
    page.select_option(control("map shows"), "error")
    page.wait_for_function(FILLED)
    page.wait_for_function(TOLD, arg="Error at the end")
    assert serious_violations(page, ("",)) == []
    page.select_option(control("map shows"), "nothing")
    assert not page.is_visible(MAP)
    assert page.evaluate("[...window.perceptObsLabs][0].planes[2].worker") is None
    page.close()


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.parametrize("where", ["worker", "page"])
def test_a_map_follows_the_hand_and_the_cursor_beside_the_page_and_in_it(browser, where):
    policy = None if where == "worker" else f"{stated_policy()}; worker-src 'none'"
    lab = structure_lab(duration=1.0, period=0.02, step=0.02, over={"shows": "settling"})
    page = page_of(browser, lab, policy=policy)
    page.wait_for_function("() => [...window.perceptObsLabs][0].planes[2].sweep.found")
    found = page.evaluate("""async () => {
        const [lab] = window.perceptObsLabs;
        const { sweep } = lab.planes[2];
        const maps = new Set();
        for (let k = 0; k < 60; k++) {
            lab.change({ w: [0, 0, 0.01 * k] });
            await new Promise((resolve) => requestAnimationFrame(resolve));
            if (sweep.found) maps.add(sweep.found);
        }
        return maps.size;
    }""")
    assert found > 3
    page.wait_for_function("() => [...window.perceptObsLabs][0].planes[2].sweep.present")
    page.focus(PLACE)
    page.keyboard.press("ArrowUp")
    page.wait_for_function(f"() => document.querySelector('{TRACE}').getAttribute('d').startsWith('M')")
    page.keyboard.press("Escape")
    page.wait_for_function(f"() => document.querySelector('{TRACE}').getAttribute('d') === ''")
    page.close()


@pytest.mark.browser
@pytest.mark.slow
def test_a_late_picture_still_has_the_map_of_settings_before_whose_axis_means_nothing_now(browser):
    believed = {"A": [[0.0] * 3] * 3, "b": [0.4, 0.2, 0.3]}
    page = page_of(
        browser, observer_lab(duration=1.0, believed=believed, over={"shows": "settling", "across": "believed.b.0"})
    )
    page.wait_for_function("() => [...window.perceptObsLabs][0].planes[2].sweep.present")
    problem = page.evaluate("""() => {
        const [lab] = window.perceptObsLabs;
        lab.planes[2].aim = [0.5, 0.5];
        lab.compute = () => false;  // what the next settings show is not there yet
        lab.change({ believed: null });
        lab.paint();
        delete lab.compute;
        return lab.view.root.querySelector(".problem:not([hidden])")?.textContent ?? "";
    }""")
    assert problem == ""
    page.close()


AIMED = "([...window.perceptObsLabs][0].planes[2].pointerRun)"
TRACE = ".there path"


@pytest.mark.browser
@pytest.mark.slow
def test_the_run_at_the_pointer_is_drawn_as_python_tracks_it(browser):
    page = page_of(browser, observer_lab(noise=NOISY, duration=2.0, over={"shows": "settling"}))
    page.wait_for_function(FILLED)
    box = page.locator(PLACE).bounding_box()
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.4 * box["height"])
    page.wait_for_function(f"() => {AIMED}.found && {AIMED}.found.key === {AIMED}.wanted.key")
    found = page.evaluate(f"({{ settings: {AIMED}.wanted.follow, errors: Array.from({AIMED}.found.errors) }})")
    assert found["settings"]["noise"]["size"] == pytest.approx(0.03, abs=0.001)
    (run,) = runs(settings_of(page) | found["settings"]).values()
    np.testing.assert_allclose(found["errors"], run.relative_error, rtol=1e-9)
    assert page.get_attribute(TRACE, "d").startswith("M")
    page.mouse.move(2, 2)
    page.wait_for_function(f"() => document.querySelector('{TRACE}').getAttribute('d') === ''")
    page.evaluate("() => { const [lab] = window.perceptObsLabs; lab.change({ pictures: ['distance'] }, true); }")
    page.wait_for_function(DRAWN)
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.4 * box["height"])
    assert page.evaluate(f"{AIMED}.wanted") is None, "a chart that is not shown asks for nothing"
    page.close()
