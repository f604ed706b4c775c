"""A map over two settings holds at every place what Python computes there, follows the hand, and leads to the place."""

import json
import re
import subprocess
from functools import lru_cache

import numpy as np
import pytest
from lab_alone import DRAWN, answered, opened, stated_policy
from lab_browser import control, serious_violations
from lab_settings import FRONT, NOISY, whole_model

from percept_obs import Camera, PerspectiveSystem, Uniform, affine, ensemble, ibo, pinhole, scenarios
from percept_obs.labs import observer_lab, structure_lab
from percept_obs.labs.observer.lab import runs
from percept_obs.validation import modules

FOLLOWED, DIVERGED, IMPOSSIBLE = 1, 2, 3
GAIN = "gains.identifier_based.gain"
PLACES = 25
FINER = 128
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
    task = json.dumps({"model": whole_model(lab), "tasks": tasks, "kind": lab.kind})
    script = FRONT / "tests/run_cells.js"
    answer = subprocess.run([node, script], input=task, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr
    return json.loads(answer.stdout)


def somewhere(rng, far=1):
    """Middles of random cells of the finest map, as shares of the way along both axes, and beyond the first."""
    return ((rng.integers((far * FINER, FINER), size=(PLACES, 2)) + 0.5) / FINER).tolist()


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
    return {p: {**t, **f} for p, t, f in zip(PAIRS, tasks, in_the_page(node, observer_lab(), tasks), strict=True)}


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


@pytest.mark.node
@pytest.mark.slow
def test_an_ensemble_computes_the_same_map(of_pairs):
    import xarray as xr

    cells = of_pairs["gain and noise"]["cells"]
    gains, noises = (
        xr.DataArray(list(column), dims="place") for column in zip(*(c["place"] for c in cells), strict=True)
    )
    observer = ibo(PerspectiveSystem(affine(), pinhole()).measure("y1", "y2"))
    camera = Camera(noise=Uniform(0.01), dropout=0.1)
    over = {"gain": gains, "noise": noises}
    found = ensemble(scenarios.ma2005_eq35(), observer, over, seeds=[3], duration=10.0, camera=camera)
    settling = np.array([float(cell["settling"]) for cell in cells])
    settling[settling > 9.0] = np.inf  # an ensemble counts what stays inside for less than a tenth as not converged
    np.testing.assert_allclose(settling, found.settling_time.values.ravel(), rtol=1e-9)
    np.testing.assert_allclose([float(c["error"]) for c in cells], found.judged.values.ravel(), rtol=1e-9)


def filled_in(lab, settings, found):
    """What Python fills in at places of the finest map, asked as often as it takes."""
    rows, numbers = [cell["row"] for cell in found["cells"]], []
    while rows:
        lab.set_state({"map_asked": {"serial": len(rows), "settings": settings, "names": found["names"], "rows": rows}})
        assert lab.map_found["serial"] == len(rows), lab.map_found
        numbers.append(np.frombuffer(lab.map_found["values"]).reshape(-1, 3))
        rows = rows[len(numbers[-1]) :]
    return np.concatenate(numbers)


def assert_the_same(cells, numbers):
    kinds, settling, errors = numbers.T
    np.testing.assert_array_equal(kinds, [cell["kind"] for cell in cells])
    runs = kinds == FOLLOWED
    for python, name in ((settling, "settling"), (errors, "error")):
        page = np.array([float(cell[name]) for cell in cells])
        np.testing.assert_allclose(python[runs], page[runs], rtol=1e-9, atol=1e-12)


@pytest.mark.node
@pytest.mark.slow
@pytest.mark.parametrize("pair", PAIRS)
def test_python_fills_100_places_of_the_finest_map_as_the_page_would(of_pairs, pair):
    pytest.importorskip("numba")
    found = of_pairs[pair]
    assert_the_same(found["cells"], filled_in(observer_lab(), found["settings"], found))


HARDER = {
    "it leaves": (
        observer_lab,
        {
            **{"observers": ["extended_kalman"], "duration": 6.0},
            "over": {"observer": "extended_kalman", "across": "b.2", "up": "X0.2"},
        },
        {FOLLOWED, IMPOSSIBLE},
    ),
    "it diverges": (
        observer_lab,
        {
            **{"over": {"across": GAIN, "up": "gains.identifier_based.lyapunov"}, "noise": NOISY},
            "gains": {"identifier_based": {"bound": 1e200}},
        },
        {FOLLOWED, DIVERGED},
    ),
    "the motion varies": (
        observer_lab,
        {"motion": "b3 = b3 + 0.1 sin(t)", "over": {"across": "noise.size", "up": GAIN}},
        {FOLLOWED},
    ),
    "structure": (
        structure_lab,
        {"noise": {"kind": "uniform", "size": 1e-4, "depth": 0.0}, "over": {"across": "v_p.0", "up": "bias"}},
        {FOLLOWED},
    ),
}


@pytest.mark.node
@pytest.mark.slow
@pytest.mark.parametrize("case", HARDER)
def test_python_fills_what_does_not_go_side_by_side_as_the_page_would(node, case):
    pytest.importorskip("numba")
    make, changes, kinds = HARDER[case]
    lab = make(**{"duration": 2.0, "period": 0.02, **changes})
    shares = somewhere(np.random.default_rng(1), far=2 if case == "it diverges" else 1)
    (found,) = in_the_page(node, lab, [{"settings": lab.settings, "shares": shares}])
    assert {cell["kind"] for cell in found["cells"]} == kinds
    assert_the_same(found["cells"], filled_in(lab, lab.settings, found))


BAD = {
    "names is 'gain'": {"names": "gain"},
    "names is \\['foe.0'\\]": {"names": ["foe.0"]},
    "names is \\['__class__'\\]": {"names": ["__class__"]},
    "believed.b.0 cannot differ": {"names": ["believed.b.0"]},
    "rows 2 1 is nan; it must be a number": {"rows": [[1.0], [float("nan")]]},
    "rows 1 1 is .__import__": {"rows": [["__import__('os')"]]},
    "a row of the map has 2 numbers": {"rows": [[1.0, 2.0]]},
    "must be a list of 1 to 1024": {"rows": [[1.0]] * 1025},
    "gain = -1 is out of range": {"rows": [None, [-1.0]]},
    "there is no setting canary": {"settings": {"canary": 1}},
    "a map is of one observer": {"settings": {"observers": ["identifier_based", "de_luca"]}},
    "holds no two samples": {"settings": {"duration": 0.5, "period": 1.0}},
    "there is no setting more": {"more": 1},
    "numba is missing; get it with": {},
}


@pytest.mark.parametrize("sentence", BAD)
def test_a_message_that_makes_no_sense_is_answered_with_a_sentence(sentence, monkeypatch):
    lab = plain_lab()
    if not BAD[sentence]:
        monkeypatch.setattr(modules, "find_spec", lambda name: None)
    asked = {"serial": 7, "settings": {}, "names": [GAIN], "rows": [[2.0]], **BAD[sentence]}
    before = lab.settings
    lab.set_state({"map_asked": {}})
    lab.set_state({"map_asked": asked})
    assert lab.map_found["serial"] == 7
    assert re.search(sentence, lab.map_found["refusal"])
    assert (lab.settings, lab.error) == (before, "")


@lru_cache(maxsize=1)
def plain_lab():
    return observer_lab()


WHOLE = "() => [...window.perceptObsLabs][0].planes[2].sweep.whole"
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
    page.wait_for_function(WHOLE)
    page.wait_for_function(TOLD, arg="64 by 64")
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
    assert page.evaluate("[...window.perceptObsLabs][0].planes[2].sweep.whole")  # it is the same map
    page.select_option(control("map up"), "foe.0")
    page.select_option(control("map shows"), "error")
    page.wait_for_function(WHOLE)
    page.wait_for_function(TOLD, arg="Error at the end")
    assert serious_violations(page, ("",)) == []
    page.select_option(control("map shows"), "nothing")
    assert not page.is_visible(MAP)
    assert page.evaluate("[...window.perceptObsLabs][0].planes[2].worker") is None
    page.close()


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.parametrize("where", ["worker", "page"])
def test_a_map_follows_the_hand_beside_the_page_and_in_it(browser, where):
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
    page.close()


SWEEP = "[...window.perceptObsLabs][0].planes.find(({ sweep }) => sweep).sweep"
FINEST = f"() => {SWEEP}.finest === {FINER}"
BUTTON = control("map finer")


@pytest.mark.browser
@pytest.mark.slow
def test_python_is_asked_for_a_finer_map_and_not_heard_when_it_is_late(browser, monkeypatch):
    pytest.importorskip("numba")
    lab = observer_lab(noise=NOISY, duration=2.0, over={"shows": "settling"})
    with answered(browser, lab, viewport={"width": 1280, "height": 800}) as page:
        page.wait_for_function(WHOLE)
        assert (page.inner_text(BUTTON), "64 × 64" in page.inner_text(".run-there")) == ("Finer map", True)
        with monkeypatch.context() as without:
            without.setattr(modules, "find_spec", lambda name: None)
            page.click(BUTTON)
            page.wait_for_function("() => /numba is missing; get it/.test(document.querySelector('.notice').innerText)")
        assert page.inner_text(BUTTON) == "Finer map"
        page.evaluate("() => { window.held = []; }")
        page.click(BUTTON)
        page.wait_for_function("() => window.held.some((found) => found.map_found?.values)")
        assert "stop" in page.inner_text(BUTTON)
        page.evaluate("() => { const [lab] = window.perceptObsLabs; lab.change({ seed: 5 }, true); }")
        page.wait_for_function(f"() => {SWEEP}.settings.seed === 5 && {SWEEP}.whole")
        page.evaluate("() => { const late = window.held; window.held = null; late.forEach(window.heard); }")
        assert page.evaluate(f"{SWEEP}.found.levels.map(({{ cells }}) => cells).includes({FINER})") is False
        page.focus(BUTTON)
        page.keyboard.press("Enter")
        page.wait_for_function(FINEST)
        assert not page.is_visible(BUTTON)
        assert not page.is_visible(".notice")
        page.wait_for_function(f"() => document.querySelector('{MAP}').ariaLabel.includes('128 by 128 places')")
        assert "128 × 128 places" in page.inner_text(".run-there")
        assert (lab.map_asked, lab.error) == ({}, "")
        page.focus(PLACE)
        page.keyboard.press("ArrowRight")
        page.keyboard.press("Enter")
        page.wait_for_function(DRAWN)
        share = np.log(settings_of(page)["gains"]["identifier_based"]["gain"]) / np.log(30)
        cell = int(np.log(10) / np.log(30) * FINER) + 1
        assert share == pytest.approx((cell + 0.5) / FINER, abs=1e-4)
        assert page.evaluate(f"{SWEEP}.finest") == FINER  # it is the same map


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


AIMED = "([...window.perceptObsLabs][0].planes[2].there)"
TRACE = ".there path"


@pytest.mark.browser
@pytest.mark.slow
def test_the_run_at_the_pointer_is_drawn_as_python_tracks_it(browser):
    page = page_of(browser, observer_lab(noise=NOISY, duration=2.0, over={"shows": "settling"}))
    page.wait_for_function(WHOLE)
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


@pytest.mark.browser
@pytest.mark.slow
def test_the_run_at_the_cursor_is_drawn_without_a_worker(browser):
    lab = structure_lab(duration=1.0, period=0.02, step=0.02, over={"shows": "settling"})
    page = page_of(browser, lab, policy=f"{stated_policy()}; worker-src 'none'")
    page.wait_for_function("() => [...window.perceptObsLabs][0].planes[2].sweep.found")
    page.focus(PLACE)
    page.keyboard.press("ArrowUp")
    page.wait_for_function(f"() => document.querySelector('{TRACE}').getAttribute('d').startsWith('M')")
    page.keyboard.press("Escape")
    page.wait_for_function(f"() => document.querySelector('{TRACE}').getAttribute('d') === ''")
    page.close()
