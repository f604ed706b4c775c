"""The reasons are in the pictures: what one output cannot tell apart, what noise adds, where the FOE is at a time."""

import numpy as np
import pytest
from lab_alone import DRAWN
from lab_browser import control

from percept_obs.labs import observer_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

NOISE = {"kind": "uniform", "size": 0.02}
WRITTEN = """() => {
    const [lab] = window.perceptObsLabs;
    const found = [];
    const own = CanvasRenderingContext2D.prototype.fillText;
    CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
        found.push([text, x, y, this.textAlign, this.measureText(text).width, this.canvas.parentElement?.className]);
        return own.call(this, text, x, y);
    };
    lab.stale = true;
    lab.draw();
    CanvasRenderingContext2D.prototype.fillText = own;
    return found;
}"""
PUT = "([time]) => { const [lab] = window.perceptObsLabs; lab.point(time); lab.paint(); }"
SHARES = """() => {
    const [{ shown: { shares, runs } }] = window.perceptObsLabs;
    const late = (all) => Array.from(all).slice(all.length / 2).sort((a, b) => a - b)[Math.floor(all.length / 4)];
    const [quiet, error] = [shares.quiet, runs[0].error].map((values) => Array.from(values));
    return { quiet, error, late: late(shares.added), lateQuiet: late(quiet) };
}"""


@pytest.fixture
def opened(show):
    """Shows observer labs of Ma's motion."""
    return lambda **settings: show(observer_lab("ma2005_eq35", **settings))


def names_of(page, *parts):
    """The words with one of these parts that a picture writes, with their places and widths."""
    return [found for found in page.evaluate(WRITTEN) if any(part in found[0] for part in parts)]


def test_one_output_is_drawn_with_points_that_it_cannot_tell_apart(opened):
    page = opened(outputs=["y1"])
    alike = page.evaluate("""() => { const [lab] = window.perceptObsLabs; const [plane] = lab.planes;
        return plane.parts.alikeOf(lab.shown, { sample: 300, part: 0 }, plane.square); }""")
    copies = alike["copies"]
    assert len({round(copy["place"][0], 9) for copy in copies}) == 1
    np.testing.assert_allclose([copy["velocity"][0] for copy in copies], copies[0]["velocity"][0], atol=1e-7)
    assert np.ptp([copy["velocity"][1] for copy in copies]) > 0.01  # what y2 would tell
    assert max(c["distance"] for c in copies) > 2 * min(c["distance"] for c in copies)
    assert names_of(page, "look the same to y1 now")
    page.click(control("outputs y1+y2"))
    page.wait_for_function(DRAWN)
    assert not names_of(page, "look the same to y1 now")


def test_an_error_is_drawn_with_what_noise_adds_and_with_the_same_run_without_noise(opened):
    page = opened(outputs=["y1"], noise=NOISE)
    assert {"what noise adds", "without noise"} <= {name[0] for name in names_of(page, "nois")}
    shares = page.evaluate(SHARES)
    assert shares["late"] > 10 * shares["lateQuiet"]
    both = opened(noise=NOISE).evaluate(SHARES)
    assert both["late"] < shares["late"] / 5
    more = opened(noise=NOISE, gains={"identifier_based": {"gain": 60.0}}).evaluate(SHARES)
    assert more["late"] > 3 * both["late"]
    quiet = [np.flatnonzero(np.array(found["quiet"]) < 0.5)[0] for found in (more, both)]
    assert quiet[0] < quiet[1] / 2  # more gain is faster
    still = opened()
    error = still.evaluate("() => Array.from([...window.perceptObsLabs][0].shown.runs[0].error)")
    assert both["quiet"] == error
    assert still.evaluate("() => [...window.perceptObsLabs][0].shown.shares") is None


def test_the_innovation_is_drawn_against_the_noise(opened):
    page = opened(outputs=["y1"], noise=NOISE, pictures=["innovation", "error"])
    lines = page.evaluate("""() => { const [{ drawn, shown }] = window.perceptObsLabs;
        const k = 4000;
        return { drawn: drawn.innovation.lines.map(({ name, values }) => [name, values[values.length > 2 ? k : 0]]),
            is: shown.outputs[2 * k] - shown.runs[0].estimate[3 * k] }; }""")
    found = dict(lines["drawn"][:1])
    assert list(found.values()) == [pytest.approx(lines["is"], abs=1e-12)]
    assert sorted(value for name, value in lines["drawn"] if name == "noise") == [-0.02, 0.02]


def test_more_gain_is_drawn_as_larger_steps_for_innovations_that_are_as_large(opened):
    gains = [{"identifier_based": {"gain": gain}} for gain in (60.0, 10.0)]
    both = {"noise": {"kind": "uniform", "size": 0.01}, "duration": 8.0}
    pictures = ["innovation", "step", "error"]
    page = opened(**both, pictures=pictures, gains=gains[0], kept={**both, "gains": gains[1]})
    sizes = page.evaluate("""() => {
        const [{ drawn }] = window.perceptObsLabs;
        const size = ({ values }) => Math.hypot(...Array.from(values).slice(400)) / 20;
        return ["innovation", "step"].map((name) => {
            const of = (begins) => drawn[name].lines.find((line) => line.name.startsWith(begins));
            return size(of("identifier")) / size(of("kept"));
        });
    }""")
    assert 0.9 < sizes[0] < 1.3
    assert 25 < sizes[1] < 36
    page.set_viewport_size({"width": 1280, "height": 800})
    assert len(names_of(page, "kept run")) == 3  # on top of both, and what noise adds to it


def test_a_mark_on_an_axis_says_no_time_that_is_not_on_it(opened):
    page = opened()
    for _ in range(4):
        page.click(control("zoom in"))
    page.fill(control("noise size number"), "0.003")
    page.fill(control("identifier_based gain number"), "60")
    page.keyboard.press("Tab")
    page.wait_for_function(DRAWN)
    assert page.evaluate("() => [...window.perceptObsLabs][0].span.high") < 10
    assert not names_of(page, "80 s")  # too late to be sure of, so it is no event


def test_the_estimate_leaves_a_point_at_the_focus_of_expansion_in_sight(opened):
    handle = opened().evaluate("() => getComputedStyle(document.querySelector('.handle'), '::before').backgroundColor")
    assert handle == "rgba(0, 0, 0, 0)"


def test_the_key_of_the_map_covers_nothing_of_the_image(opened):
    page = opened(noise=NOISE, bound=["map"])
    right = page.evaluate("""() => { const [{ planes: [plane] }] = window.perceptObsLabs;
        const { square, handles: [{ at, scale, node }] } = plane;
        const [x] = node.style.transform.match(/[-\\d.]+/g).map(Number);
        return x + (square.centre[0] + square.half - at[0]) * scale; }""")
    numbers = [found for found in page.evaluate(WRITTEN) if found[0] in ("0.01", "100") and found[5] == "image-plane"]
    assert len(numbers) == 2
    assert all(x > right for _, x, *_ in numbers)


def test_the_focus_of_expansion_of_a_motion_that_varies_is_drawn_at_the_time_shown(opened):
    page = opened(motion="b1 = cos(t); b2 = 0; b3 = 1", A=[[0.0] * 3] * 3, X0=[0, 0, 40], duration=6)
    named = []
    for time in (0.0, 1.0, 1.5, 3.0):
        page.evaluate(PUT, [time])
        named += names_of(page, "FOE now")  # where it lies in the picture
        seen = page.evaluate(
            """([time]) => { const [lab] = window.perceptObsLabs;
            return lab.planes[0].parts.focusAt(lab.shown, { sample: Math.round(time / 0.01), part: 0 }).foe; }""",
            [time],
        )
        assert seen == pytest.approx([np.cos(time), 0], abs=1e-9)
    assert named
    assert np.isfinite([found[1:3] for found in named]).all()


LOOK = """() => { const [{ span, theme }] = window.perceptObsLabs; return [span.low, span.high, theme.picked]; }"""


def test_zoom_and_the_line_that_stands_out_are_steps_of_the_history(opened):
    page = opened()
    undo, redo = control("undo"), control("redo")
    first = page.evaluate(LOOK)
    page.click(control("zoom in"))
    page.wait_for_function("() => [...window.perceptObsLabs][0].state.held === null")  # else it is the same step
    page.click(control("zoom in"))
    near = page.evaluate(LOOK)
    assert near[1] - near[0] == pytest.approx((first[1] - first[0]) / 4)
    page.click(f"{control('line')} >> nth=1")
    page.mouse.move(640, 700)
    page.evaluate("() => document.activeElement.blur()")
    assert page.evaluate(LOOK)[2] is not None
    page.click(undo)
    page.wait_for_function(DRAWN)
    assert page.evaluate(LOOK) == [*near[:2], None]
    assert page.locator(f'{control("line")}[aria-pressed="true"]').count() == 0
    page.click(undo)
    page.click(undo)
    page.wait_for_function(DRAWN)
    assert page.evaluate(LOOK) == first
    for _ in range(3):
        page.click(redo)
    page.wait_for_function(DRAWN)
    assert page.evaluate(LOOK)[:2] == near[:2]
    assert page.evaluate(LOOK)[2] is not None
    page.click(control("undo"))
    page.fill(control("noise size number"), "0.01")
    page.keyboard.press("Tab")
    page.click(undo)
    page.wait_for_function(DRAWN)
    assert page.evaluate(LOOK)[:2] == near[:2]  # a setting that is undone leaves the time in sight
