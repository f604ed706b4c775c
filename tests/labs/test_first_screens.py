"""The faces of the labs: few words and controls at first, large pictures, no label on another, answers that hold."""

import io

import numpy as np
import pytest
from first_screens import COUNTS, READY, SIZES, STILL, asked, at_the_end, first_screen, overlaps
from lab_alone import DRAWN, opened
from lab_browser import control, painted
from matplotlib.image import imread
from sample_sizes import across, sampled

from percept_obs.labs import observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LABS = {"observer": observer_lab, "points": points_lab, "structure": structure_lab}
QUESTIONS = "() => [...window.perceptObsLabs][0].screen.questions.all.map(({ name }) => name)"
HOLDS = """() => { const [{ screen }] = window.perceptObsLabs;
    return [screen.questions.open.holds(screen.scene), screen.spoken]; }"""
EVERY = 200
RANDOM = sampled(7, EVERY)
"""Random settings in which labels are looked at."""
VARY = """([seed]) => {
    const [lab] = window.perceptObsLabs;
    let state = seed;
    const random = () => (state = (state * 16807) % 2147483647) / 2147483647;
    for (let k = 0; k < 5; k++) random();
    const ranges = [...lab.screen.body.querySelectorAll(".handy input[type=range], .handy input[type=checkbox]")];
    for (const box of ranges) {
        if (box.type === "checkbox") { if (random() < 0.5) box.click(); continue; }
        const [low, high, step] = [box.min, box.max, box.step].map(Number);
        box.value = low + Math.round((random() * (high - low)) / step) * step;
        box.dispatchEvent(new Event("input", { bubbles: true }));
    }
    for (const handle of lab.screen.handles) {
        if (!handle.at) continue;
        handle.move(handle.at.map((value) => value + (random() - 0.5) * handle.nudge * 60));
    }
    lab.screen.setWhy(random() < 0.3);
    lab.state.cursor = random() * lab.screen.clock.end;
    return lab.rest();
}"""


@pytest.mark.parametrize(("name", "size"), across([*LABS], [*SIZES]))
def test_it_opens_with_few_words_and_controls_and_large_pictures(name, size, browser):
    with first_screen(browser, LABS[name](), SIZES[size]) as page:
        found = [page.evaluate(COUNTS)]
        at_the_end(page)
        found.append(page.evaluate(COUNTS))
        print(name, size, found)
        for counts in found:
            assert counts["controls"] <= 12
            assert counts["words"] <= 60
            assert counts["share"] >= 0.7
        assert page.evaluate("document.documentElement.scrollWidth") <= SIZES[size][0]


@pytest.mark.parametrize("name", LABS)
def test_what_an_answer_claims_holds_in_the_picture(name, browser):
    with first_screen(browser, LABS[name](), reduced_motion="reduce") as page:
        for question in page.evaluate(QUESTIONS):
            asked(page, question)
            holds, said = page.evaluate(HOLDS)
            assert holds, question
            assert len(said.split()) <= 25, said
            assert overlaps(page) == [], question
            page.click(control("done"))
            page.wait_for_function(DRAWN)


@pytest.mark.parametrize(("name", "size"), across([*LABS], [*SIZES]))
def test_no_label_covers_another_or_is_cut(name, size, browser):
    with first_screen(browser, LABS[name](), SIZES[size]) as page:
        for seed in range(1, RANDOM + 1):
            page.evaluate(VARY, [1000 * seed])
            at_the_end(page) if seed % 3 == 0 else page.wait_for_function(DRAWN)
            assert overlaps(page) == [], seed
            if seed % 5 == 0:
                page.evaluate("() => [...window.perceptObsLabs][0].screen.again()")


HIGH = 110
"""Least height of a picture in pixels."""


@pytest.mark.parametrize(("name", "kept"), across([*LABS], [False, True]))
def test_every_picture_is_high_and_not_of_one_colour(name, kept, browser, tmp_path):
    lab = LABS[name](charts=[next(iter(LABS[name].looks["charts"].names))])
    lab.save(tmp_path / "lab.html")
    page = browser.new_page(reduced_motion="reduce") if kept else opened(browser, lab)
    if kept:
        page.goto((tmp_path / "lab.html").as_uri())
    page.wait_for_function(READY)
    at_the_end(page)
    for width, height in [SIZES["cell"]] if kept else SIZES.values():
        page.set_viewport_size({"width": width, "height": height})
        painted(page)
        page.wait_for_function(DRAWN)
        pictures = page.locator("figure:visible:has(canvas)").all()
        assert len(pictures) == 4
        for picture in pictures:
            assert picture.bounding_box()["height"] >= HIGH, (width, picture.get_attribute("class"))
            pixels = imread(io.BytesIO(picture.screenshot()))[..., :3].reshape(-1, 3)
            assert (abs(pixels - pixels[0]).max(axis=1) > 0.2).mean() > 0.005
    page.close()


PLAYED = "() => { const [{ screen }] = window.perceptObsLabs; return !screen.clock.playing && !screen.clock.secret; }"
AT_THE_END = "() => { const [{ screen }] = window.perceptObsLabs; return screen.clock.present() === screen.clock.end; }"
NOW = "() => { const [lab] = window.perceptObsLabs; return [lab.settings, lab.state.cursor]; }"


@pytest.mark.parametrize("name", LABS)
def test_it_plays_once_by_itself_and_not_where_less_motion_is_asked_for(name, browser):
    with first_screen(browser, LABS[name]()) as page:
        page.wait_for_function("() => [...window.perceptObsLabs][0].screen.clock.playing")
        page.wait_for_function(PLAYED)
        assert page.evaluate(AT_THE_END)
    with first_screen(browser, LABS[name](), reduced_motion="reduce") as page:
        page.wait_for_function("() => ![...window.perceptObsLabs][0].screen.clock.secret")
        assert page.evaluate(AT_THE_END)


OPENED = """(more) => { const [lab] = window.perceptObsLabs;
    lab.look({ more, charts: more ? Object.keys(lab.parts.charts).slice(0, 2) : [] }); }"""


@pytest.mark.parametrize("name", LABS)
def test_the_drawer_keeps_settings_time_and_rows_and_covers_nothing(name, browser):
    with first_screen(browser, LABS[name](), SIZES["wide"], reduced_motion="reduce") as page:
        at_the_end(page)
        rows = (
            "() => ['.says', '.views', '.time'].map((row) => document.querySelector(row).getBoundingClientRect().top)"
        )
        before = page.evaluate(NOW), page.evaluate(rows)
        page.click(control("more"))
        page.wait_for_function(DRAWN)
        painted(page)
        assert page.locator(".drawer").is_visible()
        assert (page.evaluate(NOW), page.evaluate(rows)) == before
        screen, drawer = (page.locator(part).bounding_box() for part in (".screen", ".drawer"))
        assert drawer["x"] >= screen["x"] + screen["width"]
        page.set_viewport_size({"width": 390, "height": 760})
        painted(page)
        screen, drawer = (page.locator(part).bounding_box() for part in (".screen", ".drawer"))
        assert drawer["y"] >= screen["y"] + screen["height"]
        page.click(control("more"))
        assert page.locator(".drawer").is_hidden()


@pytest.mark.parametrize(("name", "size"), across([*LABS], [*SIZES]))
def test_with_drawer_and_charts_open_no_label_covers_another_or_is_cut(name, size, browser):
    with first_screen(browser, LABS[name](), SIZES[size], reduced_motion="reduce") as page:
        page.evaluate(OPENED, "charts")
        for seed in range(1, RANDOM + 1):
            page.evaluate(VARY, [1000 * seed + 7])
            page.wait_for_function(DRAWN)
            painted(page)
            assert overlaps(page) == [], seed


def test_several_observers_are_named_in_pictures_and_chart_and_one_is_chosen_by_its_line(browser):
    three = ["identifier_based", "sliding_mode", "extended_kalman"]
    with first_screen(browser, observer_lab(observers=three), SIZES["wide"], reduced_motion="reduce") as page:
        at_the_end(page)
        texts = (
            "() => [...window.perceptObsLabs][0].screen.views.map(({ texts }) => texts.map(({ text }) => text).join())"
        )
        _, world, chart, *_ = page.evaluate(texts)
        for title in ("identifier-based", "sliding mode", "extended Kalman"):
            assert title in world
            assert title in chart
        where = page.evaluate("""() => { const { screen: { chart } } = [...window.perceptObsLabs][0];
            const line = chart.chart.lines.find(({ run }) => run === "sliding_mode");
            const k = line.time.findIndex((time) => time > 0.9);
            const { left, top } = chart.figure.getBoundingClientRect();
            return [left + chart.x(line.time[k]), top + chart.y(line.values[k])]; }""")
        page.mouse.click(*where)
        page.wait_for_function(DRAWN)
        assert page.evaluate("() => [...window.perceptObsLabs][0].screen.scene.chosen.name") == "sliding_mode"
        page.click(control("more"))
        assert page.get_attribute(control("choose sliding_mode"), "aria-pressed") == "true"
        page.click(control("undo"))
        page.wait_for_function(DRAWN)
        assert page.evaluate("() => [...window.perceptObsLabs][0].screen.scene.chosen.name") == "identifier_based"


def test_values_are_read_under_the_pointer_and_time_zooms_by_keys_wheel_and_buttons(browser):
    span = "() => { const { low, high } = [...window.perceptObsLabs][0].span; return [low, high]; }"
    with first_screen(browser, observer_lab("ma2005_eq35"), SIZES["wide"], reduced_motion="reduce") as page:
        assert page.evaluate(span) == [0, 10]
        assert page.inner_text(control("all of the time")) == "10 of 80 s, show all"
        box = page.locator(".time .scrub").bounding_box()
        page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 40)
        page.wait_for_function("() => [...window.perceptObsLabs][0].screen.peek !== null")
        page.evaluate(STILL)
        read = page.evaluate("() => [...window.perceptObsLabs][0].screen.chart.texts.map(({ text }) => text).join()")
        assert "4.89 s · estimate 6.95 m, true 6.95 m" in read
        page.click(control("all of the time"))
        assert page.evaluate(span) == [0, 80]
        page.focus(control("play"))
        page.keyboard.press("Home")
        page.keyboard.press("+")
        assert page.evaluate(span) == [0, 40]
        page.keyboard.press("0")
        assert page.evaluate(span) == [0, 80]
        page.mouse.wheel(0, -300)
        page.wait_for_function(
            "() => { const { high, low } = [...window.perceptObsLabs][0].span; return high - low < 60; }"
        )


@pytest.fixture
def page(browser):
    with first_screen(browser, observer_lab()) as page:
        at_the_end(page)
        yield page


SEEN = """() => { const [{ screen, settings, shown }] = window.perceptObsLabs;
    const { y, place, foe } = screen.seen; const last = shown.truth.length - 3;
    return { y, place, foe, settings, truth: Array.from(shown.truth.slice(last)) }; }"""


@pytest.mark.parametrize("time", [0.0, 2.0, 4.0])
def test_a_hand_moves_what_it_sees_now(page, time):
    page.evaluate("(time) => { const [lab] = window.perceptObsLabs; lab.point(time); lab.paint(); }", time)
    before = page.evaluate(SEEN)
    box = page.locator(control("foe")).bounding_box()
    x, y = box["x"] + 22, box["y"] + 22
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 40, y + 30, steps=6)
    page.mouse.up()
    page.wait_for_function(DRAWN)
    after = page.evaluate(SEEN)
    np.testing.assert_allclose(after["place"], before["place"], atol=1e-9)  # the present stays
    assert after["foe"] != before["foe"]
    assert np.linalg.norm(after["settings"]["b"]) == pytest.approx(np.linalg.norm(before["settings"]["b"]))
    moved = page.locator(control("foe")).bounding_box()
    assert [moved["x"] + 22, moved["y"] + 22] == pytest.approx([x - 40, y + 30], abs=1.5)  # under the finger
    page.focus(control("distance"))
    page.keyboard.press("ArrowUp")
    page.wait_for_function(DRAWN)
    farther = page.evaluate(SEEN)
    assert np.linalg.norm(farther["place"]) > np.linalg.norm(after["place"])
    np.testing.assert_allclose(farther["y"], after["y"], atol=1e-9)
    page.evaluate("() => [...window.perceptObsLabs][0].undo()")
    page.wait_for_function(DRAWN)
    np.testing.assert_allclose(page.evaluate(SEEN)["place"], after["place"], atol=1e-9)


def test_the_focus_of_expansion_on_the_point_hides_its_distance(page):
    page.evaluate("() => { const [{ screen }] = window.perceptObsLabs; screen.steer(screen.seen.y); }")
    page.evaluate("() => [...window.perceptObsLabs][0].rest()")
    page.wait_for_function(DRAWN)
    near, here, far = page.evaluate("() => [...window.perceptObsLabs][0].screen.seen.copies")
    np.testing.assert_allclose([near, here, far], 0, atol=1e-7)
    assert "too near" in page.inner_text(".says").lower() or "Not found" in page.inner_text(".says")


def test_the_chart_and_the_keys_of_the_play_button_move_the_time(page):
    box = page.locator(".time .scrub").bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 30)
    middle = page.evaluate("() => [...window.perceptObsLabs][0].state.cursor")
    assert 1.5 < middle < 2.5
    page.focus(control("play"))
    page.keyboard.press("ArrowRight")
    assert page.evaluate("() => [...window.perceptObsLabs][0].state.cursor") > middle
    page.keyboard.press("Home")
    assert page.evaluate("() => [...window.perceptObsLabs][0].state.cursor") == 0


TEXTS_OF = """(view) => [...window.perceptObsLabs][0].screen[view].texts.map(({ text }) => text)"""
HATCHES = """() => { const [lab] = window.perceptObsLabs; const { screen } = lab; let count = 0;
    for (const view of screen.views) view.hatched = () => count++;
    screen.draw(lab.shown, lab.ghost, lab.theme);
    for (const view of screen.views) delete view.hatched;
    return count; }"""


def test_nothing_gives_an_answer_away(page):
    page.evaluate("() => [...window.perceptObsLabs][0].screen.questions.ask('straight')")
    page.wait_for_function(DRAWN)
    assert page.evaluate(HATCHES) == 0
    page.click(control("answer 2"))
    page.wait_for_function(DRAWN)
    at_the_end(page)
    assert page.evaluate(HATCHES) == 2


def test_a_point_that_leaves_the_picture_is_told_and_pointed_at(browser):
    with first_screen(browser, observer_lab("ma2005_eq35", duration=20.0)) as page:
        at_the_end(page)
        page.evaluate("() => { const [lab] = window.perceptObsLabs; lab.point(10); lab.paint(); }")
        assert page.inner_text(".says").startswith("The point has left the picture")
        assert "the point" in page.evaluate(TEXTS_OF, "image")


@pytest.mark.parametrize("time", [1.0, 2.0, 4.0])
def test_both_arrows_and_a_name_stay_on_a_phone(time, browser):
    with first_screen(browser, observer_lab(), SIZES["phone"]) as page:
        at_the_end(page)
        page.evaluate("(time) => { const [lab] = window.perceptObsLabs; lab.point(time); lab.paint(); }", time)
        assert {"seen", "expected", "seen as expected"} & set(page.evaluate(TEXTS_OF, "image"))


BEHIND = """([z]) => { const [lab] = window.perceptObsLabs; const [x, y] = lab.settings.X0;
    lab.change({ X0: [x, y, z] }, true); }"""


def test_what_cannot_be_seen_is_said_while_it_is_so(browser):
    with first_screen(browser, observer_lab()) as page:
        page.evaluate(BEHIND, [-3])
        page.locator(".problem", has_text="starts behind the camera").wait_for()
        page.evaluate(BEHIND, [3])
        page.locator(".problem").first.wait_for(state="hidden")


def test_a_picture_has_whole_pixels(browser):
    """A part of one would move lines, and not the axes that are drawn below them once for many pictures."""
    with first_screen(browser, observer_lab()) as page:
        resized = """() => { const [{ screen }] = window.perceptObsLabs; screen.image.resize(300.4, 200.6);
            return screen.image.size; }"""
        assert page.evaluate(resized) == {"width": 300, "height": 201}
