"""The screen of the structure lab: worlds that make one film, ticks that are settings, hands that move both."""

import numpy as np
import pytest
from first_screens import asked, at_the_end, first_screen
from lab_alone import DRAWN
from lab_browser import centre, control

from percept_obs.labs import structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SEEN = """() => { const [{ screen, settings, shown }] = window.perceptObsLabs;
    const { seen, worlds, size, share, spoken } = screen; const { now } = screen.scene;
    const world = (each) => ({ ...worlds.places(each, now), image: worlds.image(each, now) });
    const half = { size: 0.5, share: null }; const true_ = { size: 1, share: null };
    return { unknown: settings.unknown, v_c: settings.v_c, refusal: shown.refusal, spoken, size, share, why: seen.why,
        ratio: Number.isFinite(seen.ratio) ? seen.ratio : null, free: seen.free, settings,
        ratios: seen.ratios && Array.from(seen.ratios, (v) => Number.isFinite(v) ? v : null),
        different: worlds.difference({ size, share: null }), true: world(true_), half: world(half) }; }"""
TIME = "(time) => { const [lab] = window.perceptObsLabs; lab.screen.clock.put(time); lab.paint(); }"


@pytest.fixture
def page(browser):
    with first_screen(browser, structure_lab()) as page:
        at_the_end(page)
        yield page


def ticked(page, *names):
    """Tick boxes, and show what then is seen at the end."""
    for name in names:
        page.click(control(f"{name}"))
    page.wait_for_function(DRAWN)
    at_the_end(page)
    return page.evaluate(SEEN)


def dragged(page, name, dx, dy):
    """Drag a handle; where it was let go, and where it stands."""
    x, y = centre(page, control(name))
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + dx, y + dy, steps=6)
    page.wait_for_function(DRAWN)
    stands = centre(page, control(name))  # a view comes after it only when the hand lets go
    page.mouse.up()
    page.wait_for_function(DRAWN)
    return (x + dx, y + dy), stands


@pytest.mark.parametrize(
    ("names", "unknown", "free"),
    [
        ((), ["d_s", "v_c1", "v_c2", "v_c3"], True),
        (("ahead",), ["d_s", "v_c1", "v_c2"], False),
        (("sideways",), ["d_s", "v_c2", "v_c3"], False),
        (("ahead", "sideways"), ["d_s"], False),
        (("size",), ["v_c1", "v_c2", "v_c3"], False),
        (("size", "ahead", "sideways"), [], False),
        (("rests", "size"), ["v_c1", "v_c2", "v_c3", "v_p1", "v_p2", "v_p3"], True),
        (("rests", "size", "ahead", "sideways"), ["v_p1", "v_p2", "v_p3"], False),
        (("rests", "ahead", "sideways"), ["d_s", "v_p1", "v_p2", "v_p3"], True),
    ],
)
def test_ticks_decide_what_the_observer_seeks_and_its_own_estimate_is_drawn(page, names, unknown, free):
    seen = ticked(page, *names)
    assert seen["unknown"] == unknown
    assert seen["free"] == free
    assert ("annot tell" in seen["spoken"] or "annot be told" in seen["spoken"] or "family" in seen["spoken"]) == free
    if seen["refusal"]:
        assert seen["ratio"] is None
        return
    (run,) = structure_lab(**seen["settings"]).run().values()
    found, true = (run.recording.view.quantities(rows[:, 3:]) for rows in (run.estimate, run.truth))
    if "d_s" in unknown:
        expected = run.distance * run.recording.view.inverse(run.truth)
    else:  # camera against object: the one of the two that is not sought is known
        camera, rest = np.array(seen["v_c"]), np.zeros(3)
        speeds = [
            np.linalg.norm(np.stack(list(q.values()), axis=-1) - (rest if "v_c1" in q else camera), axis=1)
            for q in (found, true)
        ]
        expected = speeds[0] / speeds[1]
    ratios = np.array([np.nan if v is None else v for v in seen["ratios"]])
    np.testing.assert_allclose(ratios, expected, rtol=1e-6)
    assert seen["ratio"] == pytest.approx(1, abs=0.02)
    assert "Found" in seen["spoken"]


def test_all_worlds_make_one_film_and_python_records_it_for_each(page):
    seen = page.evaluate(SEEN)
    assert seen["different"] < 1e-12
    np.testing.assert_allclose(seen["half"]["image"], seen["true"]["image"], atol=1e-12)
    settings = {**seen["settings"], "unknown": ["d_s", "v_c1", "v_c2"]}
    half = {**settings, "scale": 2 * settings["scale"], "v_c": [0.5 * v for v in settings["v_c"]]}
    films = [structure_lab(**each).run()["ideal"].recording.outputs for each in (settings, half)]
    np.testing.assert_allclose(films[0], films[1], atol=1e-12)


def test_a_hand_scales_a_world_and_the_film_stands_still(page):
    before = page.evaluate(SEEN)
    let_go, stands = dragged(page, "world", 24, -31)  # along the line of all sizes
    after = page.evaluate(SEEN)
    assert stands == pytest.approx(let_go, abs=4)
    assert after["size"] > before["size"] + 0.1
    assert after["different"] < 1e-12
    assert after["settings"] == before["settings"]
    page.focus(control("world"))
    page.keyboard.press("ArrowDown")
    page.wait_for_function(DRAWN)
    assert page.evaluate(SEEN)["size"] < after["size"]
    page.click(control("again"))
    page.wait_for_function(DRAWN)
    assert page.evaluate(SEEN)["size"] == 2


def test_a_hand_lets_the_camera_have_come_elsewhere(page):
    ticked(page, "ahead")
    before = page.evaluate(SEEN)
    let_go, stands = dragged(page, "camera", 20, 25)
    after = page.evaluate(SEEN)
    assert stands == pytest.approx(let_go, abs=1.5)
    assert after["v_c"][0] > before["v_c"][0]
    assert after["v_c"][2] < before["v_c"][2]
    np.testing.assert_allclose(after["true"]["object"], before["true"]["object"], atol=1e-6)
    speed = np.subtract(after["true"]["camera"], before["true"]["camera"]) / 4.0
    np.testing.assert_allclose(speed, np.subtract(after["v_c"], before["v_c"]), atol=1e-6)
    assert after["ratio"] == pytest.approx(1, abs=0.05)


def test_nothing_is_found_while_the_known_speed_passes_zero(page):
    asked(page, "zero")
    page.click(control("done"))
    page.wait_for_function(DRAWN)
    asked(page, "zero", 2)
    for time, there in ((1.5, True), (2.1, False), (3.0, True)):
        page.evaluate(TIME, time)
        seen = page.evaluate(SEEN)
        assert (seen["ratio"] is not None) == there, time
        texts = page.evaluate("() => [...window.perceptObsLabs][0].screen.world.texts.map(({ text }) => text)")
        assert any(text.startswith("estimate") for text in texts) == there, time
        charted = page.evaluate("() => [...window.perceptObsLabs][0].screen.chart.texts.map(({ text }) => text)")
        assert any(text.startswith("found") for text in charted) == there, time


def test_the_future_of_an_estimate_is_not_given_away(page):
    page.click(control("ahead"))
    page.wait_for_function(
        "() => { const [lab] = window.perceptObsLabs; return !lab.late && lab.screen.clock.playing; }"
    )
    texts = page.evaluate("() => [...window.perceptObsLabs][0].screen.chart.texts.map(({ text }) => text)")
    assert not any(text.startswith("found") for text in texts)
