"""Image, scene and charts show one time, which is played and scrubbed without computing anything again."""

import pytest
from lab_alone import DRAWN, opened
from lab_browser import centre, control

from percept_obs.labs import observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LABS = {
    "observer": observer_lab,
    "structure": lambda: structure_lab(duration=3.0, period=0.01, step=0.01),
    "points": points_lab,
}
COUNT = """() => {
    const [lab] = window.perceptObsLabs;
    window.runs = 0;
    window.charts = 0;
    for (const engine of lab.results.engines) {
        for (const name of ["run", "completed"]) {
            const own = engine[name].bind(engine);
            engine[name] = (...given) => { window.runs += 1; return own(...given); };
        }
    }
    const draw = lab.drawCharts.bind(lab);
    lab.drawCharts = () => { window.charts += 1; draw(); };
}"""
PLAYED = """async () => {
    const [lab] = window.perceptObsLabs;
    const play = document.querySelector('[data-control="play"]');
    const [began, from] = [performance.now(), lab.state.cursor];
    play.click();
    while (lab.state.cursor - from < 0.2 && performance.now() - began < 10000) {
        await new Promise((resolve) => requestAnimationFrame(resolve));
    }
    play.click();
    return [lab.state.cursor - from, (performance.now() - began) / 1000];
}"""
TIME = "() => [...window.perceptObsLabs][0].state.cursor"
PIXELS = """(name) => {
    const canvas = document.querySelector(`figure.${name} canvas`);
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let [hash, dark] = [0, 0];
    for (let k = 0; k < data.length; k += 4) {
        hash = (Math.imul(hash, 31) + data[k] + 7 * data[k + 1] + 13 * data[k + 2] + 17 * data[k + 3]) | 0;
        if (data[k + 3]) dark += 1;
    }
    return [hash, dark];
}"""
DRAWN_AT = "(time) => { const [l] = window.perceptObsLabs; return !l.pending && l.state.cursor === time; }"


@pytest.fixture(params=LABS)
def page(browser, request):
    page = opened(browser, LABS[request.param]())
    page.wait_for_function(DRAWN)
    yield page
    page.close()


def test_the_scene_turns_by_hand_and_by_keys_and_says_how(page):
    eye = page.locator(control("scene"))
    frame = page.evaluate(PIXELS, "scene")
    assert frame[1] > 1000
    page.focus(control("scene"))
    page.keyboard.press("ArrowLeft")
    page.wait_for_function(DRAWN)
    turned = page.evaluate(PIXELS, "scene")
    assert turned != frame
    assert "turned 49 degrees" in eye.get_attribute("aria-valuetext")
    page.keyboard.press("+")
    page.keyboard.press("Home")
    page.wait_for_function(DRAWN)
    assert page.evaluate(PIXELS, "scene") == frame
    x, y = centre(page, control("scene"))
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 40, y - 20, steps=3)
    page.mouse.up()
    page.wait_for_function(DRAWN)
    assert page.evaluate(PIXELS, "scene") not in (frame, turned)
    label = page.locator("figure.scene canvas").get_attribute("aria-label")
    assert " m" in label
    assert "estimate" in label


def test_play_moves_image_scene_and_charts_and_computes_nothing(page):
    page.evaluate(COUNT)
    before = {name: page.evaluate(PIXELS, name) for name in ("image-plane", "scene")}
    mark = page.locator("figure.chart:not([hidden]) .now").first
    at = mark.bounding_box()["x"]
    played, elapsed = page.evaluate(PLAYED)
    assert 0.2 <= played <= elapsed  # a slow page skips time, and never runs ahead
    shown = page.evaluate(TIME)
    page.wait_for_timeout(100)
    assert page.evaluate(TIME) == shown
    for name, pixels in before.items():
        assert page.evaluate(PIXELS, name) != pixels, name
    assert mark.bounding_box()["x"] > at
    assert f"At {shown:.2g}"[:5] in page.inner_text(".reading")
    runs, charts = page.evaluate("[window.runs, window.charts]")
    assert runs == 0
    assert charts < 3  # words of another length may have changed the page's width


def test_keys_step_pause_and_leap_to_the_ends(page):
    page.evaluate(COUNT)
    low, high = page.evaluate("() => { const { low, high } = [...window.perceptObsLabs][0].span; return [low, high]; }")
    page.focus(control("cursor"))
    page.keyboard.press("End")
    page.wait_for_function(DRAWN_AT, arg=high)
    page.keyboard.press("Home")
    page.wait_for_function(DRAWN_AT, arg=low)
    page.keyboard.press("ArrowRight")
    assert page.evaluate(TIME) == pytest.approx(low + (high - low) / 40)
    page.focus(control("scene"))
    page.keyboard.press(" ")
    page.wait_for_function("() => [...window.perceptObsLabs][0].view.playing()")
    page.keyboard.press(" ")
    assert not page.evaluate("[...window.perceptObsLabs][0].view.playing()")
    assert page.evaluate("window.runs") == 0


def test_with_reduced_motion_nothing_moves_by_itself(browser):
    page = opened(browser, observer_lab("ma2005_eq35"), reduced_motion="reduce")
    page.wait_for_function(DRAWN)
    assert page.get_attribute(control("play"), "aria-label") == "Step"
    page.click(control("play"))
    page.wait_for_timeout(200)
    first = page.evaluate(TIME)
    assert first == pytest.approx(page.evaluate("[...window.perceptObsLabs][0].span.high") / 40)
    page.wait_for_timeout(200)
    assert page.evaluate(TIME) == first
    page.close()
