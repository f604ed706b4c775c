"""Charts name their events, hold still under the hand, open with the whole run, and can be zoomed and picked apart."""

import math

import pytest
from lab_alone import DRAWN
from lab_browser import centre, control, painted

from percept_obs.labs import observer_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SPAN = "() => { const { low, high } = [...window.perceptObsLabs][0].span; return [low, high]; }"
SCALES = "() => Object.values([...window.perceptObsLabs][0].time.scales).map(({ low, high, log }) => [low, high, log])"
WRITTEN = """async () => {
    const pen = CanvasRenderingContext2D.prototype;
    const own = pen.fillText;
    const written = [];
    pen.fillText = function (text, ...place) { written.push(text); return own.call(this, text, ...place); };
    const [lab] = window.perceptObsLabs;
    lab.schedule();
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
    pen.fillText = own;
    return written;
}"""
KEPT = """() => {
    const [{ theme }] = window.perceptObsLabs;
    const one = new OffscreenCanvas(1, 1).getContext("2d");
    one.fillStyle = theme.kept;
    one.fillRect(0, 0, 1, 1);
    const pixels = (pen, { width, height }) => new Uint32Array(pen.getImageData(0, 0, width, height).data.buffer);
    const [colour] = pixels(one, one.canvas);
    const canvas = document.querySelector("figure.chart:not([hidden]) canvas");
    return pixels(canvas.getContext("2d"), canvas).filter((pixel) => pixel === colour).length;
}"""
BIAS = {"outputs": ["y1"], "noise": {"kind": "uniform", "size": 0.01}, "seed": 1}
ZERO = {"mode": "zero", "values": [0.0, 0.0, 0.0]}
TURNING = [[0.0, 0.0, 0.1], [0.0, 0.0, 0.0], [-0.1, 0.0, 0.0]]
CROSSING = {"A": TURNING, "b": [0.0, 0.0, 0.8], "X0": [-2.0, 0.0, 2.0], "duration": 12.0}


@pytest.fixture
def page(show):
    return show(observer_lab("ma2005_eq35"))


def test_resets_the_tolerance_the_circle_and_what_is_off_the_scale_are_named(show):
    cases = {"2330 resets": {**BIAS, "start": ZERO}, "unobservable circle": CROSSING, "1.91 s": {}, "799": {}}
    for text, settings in cases.items():
        page = show(observer_lab("ma2005_eq35", **settings))
        assert text in page.evaluate(WRITTEN)


def test_the_lines_of_a_kept_run_come_go_and_change_with_it(show):
    page = show(observer_lab(pictures=["error"], duration=8.0))
    page.evaluate("() => { for (const fold of document.querySelectorAll('details')) fold.open = true; }")
    counted = [page.evaluate(KEPT)]
    for act in ("keep", "keep", "observer sliding_mode", "keep"):
        page.click(control(act))
        page.wait_for_function(DRAWN)
        counted.append(page.evaluate(KEPT))
    none, one, forgotten, unchanged, two = counted
    assert none == forgotten == unchanged == 0
    assert two > one > 0


def test_an_empty_chart_says_why_and_before_a_window_is_full_the_excitation_is_that_so_far(show):
    still = [[0.0] * 3] * 3
    page = show(observer_lab(A=still, b=[0.0, 0.0, 0.8], X0=[0.0, 0.0, 2.0], duration=12.0, window=2.0))
    assert "infinite in all of this time: no distance was found" in page.evaluate(WRITTEN)
    page = show(observer_lab("ma2005_eq35"))
    assert "since the first sample" in page.evaluate(WRITTEN)
    begun = page.evaluate("""() => {
        const [{ shown: { excitation: { begun, time, smallest } } }] = window.perceptObsLabs;
        return [begun.time.length, begun.time[0], begun.smallest.at(-1), time[0], smallest[0]];
    }""")
    assert begun[:2] == [1001, 0]
    assert begun[2] == pytest.approx(begun[4], rel=1e-12)
    assert begun[3] == pytest.approx(10)


def test_time_opens_with_the_whole_run_and_zooms_by_keys_wheel_and_drag(page):
    assert page.evaluate(SPAN) == [0, 80]
    page.focus(control("cursor"))
    page.keyboard.press("+")
    assert page.evaluate(SPAN) == [0, 40]
    page.keyboard.press("0")
    assert page.evaluate(SPAN) == [0, 80]
    x, y = centre(page, "figure.chart:not([hidden]) canvas")
    page.mouse.move(x, y)
    page.keyboard.down("Control")
    page.mouse.wheel(0, -300)
    page.keyboard.up("Control")
    page.wait_for_function("() => [...window.perceptObsLabs][0].span.high < 79")
    page.keyboard.press("0")
    page.mouse.down()
    page.mouse.move(x + 80, y, steps=4)
    page.mouse.up()
    low, high = page.evaluate(SPAN)
    assert 30 < low < 45
    assert 5 < high - low < 20
    page.mouse.dblclick(x, y)
    assert page.evaluate(SPAN) == [0, 80]
    page.click(control("zoom in"))
    assert page.evaluate(SPAN) != [0, 80]
    page.click(control("reset"))
    page.wait_for_function(DRAWN)
    assert page.evaluate(SPAN) == [0, 80]


def test_axes_hold_still_while_the_hand_is_down_and_the_foe_stays_where_it_is_let_go(page):
    before = page.evaluate(SCALES), page.evaluate("[...window.perceptObsLabs][0].planes[0].square")
    x, y = centre(page, control("foe"))
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 60, y - 30, steps=6)
    page.wait_for_timeout(400)
    assert (page.evaluate(SCALES), page.evaluate("[...window.perceptObsLabs][0].planes[0].square")) == before
    held = centre(page, control("foe"))
    page.mouse.up()
    page.wait_for_function(DRAWN)
    painted(page)
    assert math.dist(held, centre(page, control("foe"))) < 3


def test_the_bound_and_its_map_are_chosen_by_keys_and_told_in_words(show):
    page = show(observer_lab(noise=BIAS["noise"], duration=20.0))
    page.click("summary:has-text('Charts')")
    for name in ("bound error", "bound map"):
        page.focus(control(name))
        page.keyboard.press("Space")
    page.wait_for_function(DRAWN)
    resolution = "() => [...window.perceptObsLabs][0].map.found?.resolution"
    page.wait_for_function(f"{resolution} === 144")
    assert page.inner_text(".legend").split("\n")[-1] == "bound"
    assert "no unbiased observer has a smaller root mean square error" in page.inner_text(".why")
    told = page.get_attribute(".image-plane canvas", "aria-label")
    assert "Map of the bound for points at 5 m, seen for 2 s: the distance to" in told
    assert "least error in % after 2 s, at 5 m" in page.evaluate(WRITTEN)
    page.mouse.move(*centre(page, control("foe")))
    page.mouse.down()
    page.mouse.move(*(place + 30 for place in centre(page, control("foe"))), steps=4)
    page.wait_for_function(f"{resolution} === 48")
    page.mouse.up()
    page.fill(control("noise size number"), "0")
    page.keyboard.press("Enter")
    page.wait_for_function(DRAWN)
    page.wait_for_function(f"{resolution} === undefined")
    assert "There is no bound without noise" in page.inner_text(".why")
    assert "bound" not in page.inner_text(".legend")


def test_the_line_that_the_legend_points_at_stands_out(show):
    page = show(observer_lab(observers=["identifier_based", "sliding_mode", "extended_kalman"]))
    faint = """() => {
        const pen = CanvasRenderingContext2D.prototype;
        const own = pen.stroke;
        let count = 0;
        pen.stroke = function (...path) { if (this.globalAlpha < 0.15) count += 1; return own.apply(this, path); };
        const [lab] = window.perceptObsLabs;
        lab.schedule();
        lab.paint();
        pen.stroke = own;
        return count;
    }"""
    assert page.evaluate(faint) == 0
    page.hover(".line-name:has-text('sliding mode')")
    assert page.evaluate(faint) >= 6
    page.mouse.move(5, 5)
    assert page.evaluate(faint) == 0
    page.focus(".line-name:has-text('truth')")
    assert page.evaluate(faint) >= 6
