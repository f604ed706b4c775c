"""The faces of the labs: few words and controls at first, large pictures, no label on another, answers that hold."""

import io

import numpy as np
import pytest
from first_screens import COUNTS, READY, SIZES, asked, at_the_end, first_screen, overlaps
from lab_alone import DRAWN, opened
from lab_browser import control, painted
from matplotlib.image import imread
from sample_sizes import across, sampled

from percept_obs.labs import observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LABS = {"observer": observer_lab, "points": points_lab, "structure": structure_lab}
QUESTIONS = "() => [...window.perceptObsLabs][0].first.questions.all.map(({ name }) => name)"
HOLDS = """() => { const [{ first }] = window.perceptObsLabs;
    return [first.questions.open.holds(first.scene), first.spoken]; }"""
EVERY = 200
RANDOM = sampled(7, EVERY)
"""Random settings in which labels are looked at."""
VARY = """([seed]) => {
    const [lab] = window.perceptObsLabs;
    let state = seed;
    const random = () => (state = (state * 16807) % 2147483647) / 2147483647;
    for (let k = 0; k < 5; k++) random();
    const ranges = [...lab.first.body.querySelectorAll(".handy input[type=range], .handy input[type=checkbox]")];
    for (const box of ranges) {
        if (box.type === "checkbox") { if (random() < 0.5) box.click(); continue; }
        const [low, high, step] = [box.min, box.max, box.step].map(Number);
        box.value = low + Math.round((random() * (high - low)) / step) * step;
        box.dispatchEvent(new Event("input", { bubbles: true }));
    }
    for (const handle of lab.first.handles) {
        if (!handle.at) continue;
        handle.move(handle.at.map((value) => value + (random() - 0.5) * handle.nudge * 60));
    }
    lab.first.setWhy(random() < 0.3);
    lab.state.cursor = random() * lab.first.clock.end;
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
                page.evaluate("() => [...window.perceptObsLabs][0].first.again()")


CHANGE = """([seed]) => {
    const [lab] = window.perceptObsLabs;
    let state = seed;
    const random = () => (state = (state * 16807) % 2147483647) / 2147483647;
    for (let k = 0; k < 5; k++) random();
    const pick = (list) => list[Math.floor(random() * list.length)];
    if (random() < 0.3) lab.reset();
    const kinds = ["range", "checkbox", "radio", "select-one"];
    const controls = [...lab.view.root.querySelectorAll(".side [data-control]")];
    for (let k = 0; k < 6; k++) {
        const box = pick(controls);
        if (!box.isConnected || box.disabled || !kinds.includes(box.type) || box.closest("[hidden]")) continue;
        if (box.type === "range") box.value = Number(box.min) + random() * (box.max - box.min);
        else if (box.type === "select-one") box.value = pick([...box.options].filter((o) => !o.disabled)).value;
        else box.click();
        for (const type of ["input", "change"]) box.dispatchEvent(new Event(type, { bubbles: true }));
    }
    const { duration, period, step = period } = lab.settings;
    const finest = Math.min(period, step);  // a long recording at a short period only takes long
    if (duration > 4000 * finest) lab.change({ duration: Math.max(1, 4000 * finest) }, true);
    if (random() < 0.3) lab.keep();
    lab.planes[1].see({ turn: 6 * random() - 3, tilt: 3 * random() - 1.5 }, 0.5 + 2 * random());
    lab.rest();
    window.part = random();
}"""
"""Change some controls of the workbench, and the look of its scene."""
LATER = """() => { const [lab] = window.perceptObsLabs; const { low, high } = lab.span;
    if (Number.isFinite(high)) lab.point(low + window.part * (high - low)); }"""
KNOWN = """() => { const [lab] = window.perceptObsLabs;
    return [...lab.first.questions.all.map(({ name }) => name), ...Object.keys(lab.model.scenarios ?? {})]; }"""
SHOW = """(name) => {
    const [lab] = window.perceptObsLabs;
    const question = lab.first.questions.all.find((each) => each.name === name);
    lab.reset();
    if (question) lab.change(question.after(lab.model), true);
    else lab.chooseScenario(name);
    lab.rest();
}"""
"""Show what answers a question, or a scenario."""


def each_picture(page):
    """Show the pictures of the workbench one by one where there is room for one only."""
    for tab in page.locator(".eyes .tabs button:visible").all() or [None]:
        if tab:
            tab.click()
            painted(page)
        yield


@pytest.mark.parametrize("name", LABS)
def test_no_label_of_the_workbench_covers_another_or_is_cut(name, browser):
    page = opened(browser, LABS[name]())
    page.set_default_timeout(15_000)
    page.wait_for_function(DRAWN)
    known = page.evaluate(KNOWN)
    for k, (width, height) in enumerate(SIZES.values()):
        page.set_viewport_size({"width": width, "height": height})
        shown = [(SHOW, each) for each in (known if RANDOM == EVERY else known[k::3])]
        seeds = range(1, RANDOM + 1) if RANDOM == EVERY else range(k + 1, RANDOM + 1, 3)
        for act, argument in [*shown, *((CHANGE, [1000 * seed + 7]) for seed in seeds)]:
            page.evaluate(act, argument)
            page.wait_for_function(DRAWN)
            page.evaluate(LATER)
            for _ in each_picture(page):
                page.wait_for_function(DRAWN)
                assert overlaps(page) == [], (width, argument)
    page.close()


HIGH = 120
"""Least height of a picture in pixels."""


@pytest.mark.parametrize(("name", "kept"), across([*LABS], [False, True]))
def test_every_picture_is_high_and_not_of_one_colour(name, kept, browser, tmp_path):
    lab = LABS[name]()
    lab.save(tmp_path / "lab.html")
    still = {"reduced_motion": "reduce"}
    page = browser.new_page(**still) if kept else opened(browser, lab, face="first", **still)
    if kept:
        page.goto((tmp_path / "lab.html").as_uri())
    page.wait_for_function(READY)
    at_the_end(page)
    counted = []
    for face in ("first", "workbench"):
        page.evaluate("(face) => [...window.perceptObsLabs][0].turn(face)", face)
        for width, height in [SIZES["cell"]] if kept else SIZES.values():
            page.set_viewport_size({"width": width, "height": height})
            painted(page)
            page.wait_for_function(DRAWN)
            for _ in each_picture(page):
                pictures = page.locator("figure:visible:has(canvas)").all()
                counted.append(len(pictures))
                for picture in pictures:
                    assert picture.bounding_box()["height"] >= HIGH, (face, width, picture.get_attribute("class"))
                    pixels = imread(io.BytesIO(picture.screenshot()))[..., :3].reshape(-1, 3)
                    assert (abs(pixels - pixels[0]).max(axis=1) > 0.2).mean() > 0.005
    assert min(counted) >= 3
    page.close()


PLAYED = "() => { const [{ first }] = window.perceptObsLabs; return !first.clock.playing && !first.clock.secret; }"
AT_THE_END = "() => { const [{ first }] = window.perceptObsLabs; return first.clock.present() === first.clock.end; }"
NOW = "() => { const [lab] = window.perceptObsLabs; return [lab.settings, lab.state.cursor]; }"


@pytest.mark.parametrize("name", LABS)
def test_it_plays_once_by_itself_and_not_where_less_motion_is_asked_for(name, browser):
    with first_screen(browser, LABS[name]()) as page:
        page.wait_for_function("() => [...window.perceptObsLabs][0].first.clock.playing")
        page.wait_for_function(
            "() => { const [{ first }] = window.perceptObsLabs; return !first.clock.playing && !first.clock.secret; }"
        )
        assert page.evaluate(
            "() => { const [{ first }] = window.perceptObsLabs; return first.clock.present() === first.clock.end; }"
        )
    with first_screen(browser, LABS[name](), reduced_motion="reduce") as page:
        page.wait_for_function("() => ![...window.perceptObsLabs][0].first.clock.secret")
        assert page.evaluate(
            "() => { const [{ first }] = window.perceptObsLabs; return first.clock.present() === first.clock.end; }"
        )


@pytest.mark.parametrize("name", LABS)
def test_the_workbench_is_one_press_away_and_back_with_the_same_settings_and_time(name, browser):
    with first_screen(browser, LABS[name]()) as page:
        at_the_end(page)
        before = page.evaluate(
            "() => { const [lab] = window.perceptObsLabs; return [lab.settings, lab.state.cursor]; }"
        )
        page.click(control("workbench"))
        page.wait_for_function(DRAWN)
        assert page.locator(".stage").is_visible()
        assert not page.locator(".first-screen").is_visible()
        page.click(control("first screen"))
        page.wait_for_function(DRAWN)
        assert page.locator(".first-screen").is_visible()
        after = page.evaluate(NOW)
        assert after == before


@pytest.fixture
def page(browser):
    with first_screen(browser, observer_lab()) as page:
        at_the_end(page)
        yield page


SEEN = """() => { const [{ first, settings, shown }] = window.perceptObsLabs;
    const { y, place, foe } = first.seen; const last = shown.truth.length - 3;
    return { y, place, foe, settings, truth: Array.from(shown.truth.slice(last)) }; }"""


@pytest.mark.parametrize("time", [0.0, 2.0, 4.0])
def test_a_hand_moves_what_it_sees_now(page, time):
    page.evaluate("(time) => { const [lab] = window.perceptObsLabs; lab.point(time); lab.paint(); }", time)
    before = page.evaluate(SEEN)
    box = page.locator(control("first foe")).bounding_box()
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
    moved = page.locator(control("first foe")).bounding_box()
    assert [moved["x"] + 22, moved["y"] + 22] == pytest.approx([x - 40, y + 30], abs=1.5)  # under the finger
    page.focus(control("first distance"))
    page.keyboard.press("ArrowUp")
    page.wait_for_function(DRAWN)
    farther = page.evaluate(SEEN)
    assert np.linalg.norm(farther["place"]) > np.linalg.norm(after["place"])
    np.testing.assert_allclose(farther["y"], after["y"], atol=1e-9)
    page.evaluate("() => [...window.perceptObsLabs][0].undo()")
    page.wait_for_function(DRAWN)
    np.testing.assert_allclose(page.evaluate(SEEN)["place"], after["place"], atol=1e-9)


def test_the_focus_of_expansion_on_the_point_hides_its_distance(page):
    page.evaluate("() => { const [{ first }] = window.perceptObsLabs; first.steer(first.seen.y); }")
    page.evaluate("() => [...window.perceptObsLabs][0].rest()")
    page.wait_for_function(DRAWN)
    near, here, far = page.evaluate("() => [...window.perceptObsLabs][0].first.seen.copies")
    np.testing.assert_allclose([near, here, far], 0, atol=1e-7)
    assert "too near" in page.inner_text(".says").lower() or "Not found" in page.inner_text(".says")


def test_the_chart_and_the_keys_of_the_play_button_move_the_time(page):
    box = page.locator(".first-screen .scrub").bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 30)
    middle = page.evaluate("() => [...window.perceptObsLabs][0].state.cursor")
    assert 1.5 < middle < 2.5
    page.focus(control("first play"))
    page.keyboard.press("ArrowRight")
    assert page.evaluate("() => [...window.perceptObsLabs][0].state.cursor") > middle
    page.keyboard.press("Home")
    assert page.evaluate("() => [...window.perceptObsLabs][0].state.cursor") == 0


TEXTS_OF = """(view) => [...window.perceptObsLabs][0].first[view].texts.map(({ text }) => text)"""
HATCHES = """() => { const [lab] = window.perceptObsLabs; const { first } = lab; let count = 0;
    for (const view of first.views) view.hatched = () => count++;
    lab.stale = true;
    lab.draw();
    for (const view of first.views) delete view.hatched;
    return count; }"""


def test_nothing_gives_an_answer_away(page):
    page.evaluate("() => [...window.perceptObsLabs][0].first.questions.ask('straight')")
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
BACK = """() => { const [lab] = window.perceptObsLabs; const [x, y, z] = lab.settings.X0;
    lab.change({ X0: [x, y, -z] }, true);
    lab.turn("first");
    lab.paint();  // of the settings before, for those of now are computed beside the page
    return [lab.late, lab.view.root.querySelector(".problem").hidden]; }"""


def test_what_cannot_be_seen_is_said_of_present_settings_only(browser):
    with first_screen(browser, observer_lab()) as page:
        page.evaluate(BEHIND, [-3])
        page.locator(".problem", has_text="starts behind the camera").wait_for()
        page.evaluate("() => [...window.perceptObsLabs][0].turn('workbench')")
        page.locator(".problem").first.wait_for(state="hidden")
        page.wait_for_function("() => [...window.perceptObsLabs][0].latest.beside")
        assert page.evaluate(BACK) == [True, True]


def test_a_picture_has_whole_pixels(browser):
    """A part of one would move lines, and not the axes that are drawn below them once for many pictures."""
    with first_screen(browser, observer_lab()) as page:
        resized = """() => { const [{ first }] = window.perceptObsLabs; first.image.resize(300.4, 200.6);
            return first.image.size; }"""
        assert page.evaluate(resized) == {"width": 300, "height": 201}
