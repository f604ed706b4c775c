"""The lab of many points follows the hand in JupyterLab, survives any order of events, and is open to keyboards."""

import numpy as np
import pytest
from conftest import missing
from jupyter_harness import jupyterlab, lab_page, log_entries
from lab_browser import (
    OPEN,
    assert_python_has,
    centre,
    control,
    open_unfolded,
    rested,
    usable,
    used_at_random,
    write_notebook,
)
from lab_settings import FRONT
from points_settings import as_array

from percept_obs.labs.points.lab import points_lab, run_of
from percept_obs.labs.points.settings import MOST_POINTS

pytestmark = [pytest.mark.browser, pytest.mark.slow]

CELL = OPEN.replace("observer_lab", "points_lab")
SHORT = "duration=8.0, window=4.0"
MOST_SAMPLES = 800
WIDTH = "(width) => { document.querySelector('.percept-lab').parentElement.style.width = width; }"
POINT = control("point 2")

STATE = """(which) => {
    const lab = [...window.perceptObsLabs][which];
    const numbers = (values) => Array.from(values, (v) => (Number.isFinite(v) ? v : null));
    const { root } = lab.view;
    return {
        settings: lab.settings,
        estimate: numbers(lab.shown.estimate),
        divergedAt: lab.shown.divergedAt,
        drawn: Object.fromEntries(Object.entries(lab.drawn).map(([name, { lines, bars }]) =>
            [name, { bars: bars.length, lines: lines.map((l) => ({ name: l.name, values: numbers(l.values) })) }])),
        words: root.querySelector(".words").textContent,
        labels: [...root.querySelectorAll("figure:not([hidden]) canvas")].map((c) => c.ariaLabel),
        problems: [...root.querySelectorAll(".problem:not([hidden])")].map((p) => p.textContent),
    };
}"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("notebooks")


@pytest.fixture(scope="module")
def lab(chromium, folder, tmp_path_factory):
    """A page with two labs, the first of which the tests of this module share."""
    homes = [tmp_path_factory.mktemp(name) for name in ("server", "browser")]
    with jupyterlab(folder, homes[0]) as server, lab_page(chromium, server, homes[1]) as page:
        page.set_default_timeout(15_000)
        other = "other = points_lab(state='independent', duration=4.0, window=2.0)\nother"
        write_notebook(folder, "two.ipynb", CELL.format(arguments=SHORT), other)
        open_unfolded(page, "two.ipynb")
        yield page


@pytest.fixture
def fresh(lab):
    lab.locator(control("reset")).first.click()
    rested(lab)
    lab.locator(POINT).first.scroll_into_view_if_needed()
    return lab


def state(page, which=0):
    """What a lab of the page shows."""
    return page.evaluate(STATE, which)


def assert_equals_python(shown, tolerance=1e-9):
    """What is drawn are the numbers of a Python run of the same settings."""
    run = run_of(shown["settings"])
    assert shown["divergedAt"] == run.diverged_at
    assert run.verdict() in shown["words"]
    told, expected = as_array(shown["estimate"]), run.state.ravel()
    size = np.fmax(1, np.abs(expected))
    growing = 1 if run.diverged_at is None else 1e6
    np.testing.assert_allclose(told / size, expected / size, rtol=0, atol=growing * tolerance)
    if "error" in shown["drawn"] and run.diverged_at is None:
        (error,) = [line for line in shown["drawn"]["error"]["lines"] if line["name"] == "error"]
        np.testing.assert_allclose(as_array(error["values"]), run.deviation, rtol=1e-9, atol=tolerance)


def drag_by_mouse(page):
    x, y = centre(page, POINT)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 12, y - 9, steps=4)
    page.mouse.up()


def drag_by_touch(page):
    x, y = centre(page, POINT)
    session = page.context.new_cdp_session(page)
    for kind, step in (("touchStart", 0), ("touchMove", 4), ("touchMove", 9), ("touchEnd", None)):
        points = [] if step is None else [{"x": x + step, "y": y - step}]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    session.detach()


def drag_by_keys(page):
    page.locator(POINT).first.focus()
    for key in ("ArrowRight", "ArrowUp", "Shift+ArrowUp", "ArrowDown"):
        page.keyboard.press(key)


@pytest.mark.parametrize("drag", [drag_by_mouse, drag_by_touch, drag_by_keys])
def test_a_point_follows_the_hand_and_keeps_its_depth(fresh, folder, drag):
    before = state(fresh)
    drag(fresh)
    rested(fresh)
    after = state(fresh)
    (one, moved, three), (first, old, third) = after["settings"]["points"], before["settings"]["points"]
    assert (one, three) == (first, third)
    assert moved[:2] != old[:2]
    assert moved[2] == pytest.approx(old[2])
    assert after["drawn"] != before["drawn"]
    assert after["words"] != before["words"]
    assert after["labels"] != before["labels"]
    assert_equals_python(after)
    assert_python_has(folder, after["settings"])


def test_a_key_changes_the_depth_and_keeps_the_image(fresh):
    (_, before, _) = state(fresh)["settings"]["points"]
    fresh.locator(POINT).first.focus()
    for _ in range(4):
        fresh.keyboard.press("+")
    rested(fresh)
    (_, after, _) = state(fresh)["settings"]["points"]
    assert after[2] == pytest.approx(before[2] + 0.2)
    np.testing.assert_allclose(np.divide(after[:2], after[2]), np.divide(before[:2], before[2]), rtol=1e-9)


def test_points_are_added_and_removed(fresh):
    add = fresh.locator(control("add point")).first
    for _ in range(MOST_POINTS - 3):
        add.click()
    assert add.is_disabled()
    rested(fresh)
    most = state(fresh)
    assert len(most["settings"]["points"]) == MOST_POINTS
    assert_equals_python(most)
    for _ in range(MOST_POINTS - 1):
        fresh.locator(control("remove 1")).first.click()
    assert fresh.locator(control("remove 1")).first.is_disabled()
    rested(fresh)
    one = state(fresh)
    assert len(one["settings"]["points"]) == 1
    assert len(one["estimate"]) * MOST_POINTS == len(most["estimate"])
    assert_equals_python(one)


def test_a_point_is_hidden_for_a_while(fresh):
    before = state(fresh)
    fresh.locator(control("hide 2")).first.check()
    fresh.locator(control("hidden from 2")).first.fill("2")
    fresh.locator(control("hidden to 2")).first.fill("5.6")
    rested(fresh)
    shown = state(fresh)
    assert shown["settings"]["hidden"] == [None, [2, 5.6], None]
    assert "Point 2 was hidden from 2 to 5.6 s" in shown["words"]
    assert (before["drawn"]["error"]["bars"], shown["drawn"]["error"]["bars"]) == (0, 1)
    assert_equals_python(shown)
    fresh.locator(control("hidden to 2")).first.fill("1")
    assert fresh.locator(control("hidden to 2")).first.get_attribute("aria-invalid") == "true"
    assert state(fresh)["settings"]["hidden"] == [None, [2, 5.6], None]
    fresh.locator(control("hide 2")).first.uncheck()
    rested(fresh)
    assert state(fresh)["drawn"] == before["drawn"]


def test_another_p_is_chosen(fresh):
    estimates = [state(fresh)["estimate"]]
    for kind in ("scheduled", "lyapunov", "riccati"):
        fresh.locator(control("weight")).first.select_option(kind)
        fresh.locator(control("size number")).first.fill("0.05")
        rested(fresh)
        shown = state(fresh)
        assert shown["settings"]["weight"] == kind
        assert shown["estimate"] not in estimates
        assert_equals_python(shown, 1e-7)  # the page moves the points by steps, and a small P is stiff
        estimates.append(shown["estimate"])


def test_the_motion_is_changed_and_what_is_lost_is_said(fresh):
    fresh.locator(control("no input")).first.click()
    rested(fresh)
    lost = state(fresh)
    assert "(14) fails" in lost["words"]
    assert "images do not tell its scale" in lost["words"]
    assert_equals_python(lost)
    fresh.locator(control("velocity X number")).first.fill("0.4")
    rested(fresh)
    assert "images do not tell its scale" not in state(fresh)["words"]
    fresh.locator(control("state origin")).first.check()
    rested(fresh)
    shown = state(fresh)
    assert "3 directions are not seen: o_x - d1_x" in shown["words"]
    assert_equals_python(shown)


def test_a_preset_asks_shows_keeps_and_leads_back(fresh):
    fresh.locator(control("seed number")).first.fill("7")
    rested(fresh)
    before = state(fresh)
    fresh.locator(control("preset riccati")).first.click()
    assert "follows a Riccati equation" in fresh.locator(".question").first.inner_text()
    assert state(fresh)["settings"] == {**points_lab().settings, "hold": "exact"}
    fresh.locator(control("act riccati 0")).first.click()
    rested(fresh)
    shown = state(fresh)
    assert "relative error of the points' positions stays within 10 % after 1" in shown["words"]
    assert shown["drawn"]["error"]["lines"][0]["name"] == "kept error"
    fresh.locator(control("way back")).first.click()
    rested(fresh)
    assert state(fresh) == before


def test_one_lab_leaves_the_other_alone(fresh):
    other = state(fresh, 1)
    drag_by_keys(fresh)
    rested(fresh)
    assert state(fresh, 1) == other
    assert other["settings"]["state"] == "independent"
    assert_equals_python(other)


def test_every_control_is_reached_by_keyboard(fresh):
    wanted = set(
        fresh.evaluate("""() => [...document.querySelector('.percept-lab').querySelectorAll('[data-control]')]
            .filter((c) => c.checkVisibility() && !c.disabled && (c.type !== "radio" || c.checked))
            .map((c) => c.dataset.control)""")
    )
    reached = set()
    fresh.locator(control("point 1")).first.focus()
    for _ in range(2 * len(wanted)):
        name = fresh.evaluate("""() => {
            const { activeElement } = document;
            return activeElement.closest(".percept-lab") === document.querySelector(".percept-lab")
                ? activeElement.dataset.control ?? "" : null;
        }""")
        if name is None:
            break
        reached.add(name)
        fresh.keyboard.press("Tab")
    assert wanted - reached == set()
    assert {"point 1", "remove 2", "hide 3", "add point", "size", "aim", "cursor"} <= reached


def test_axe_finds_nothing_serious(fresh):
    axe = FRONT / "node_modules/axe-core/axe.min.js"
    if not axe.exists():
        missing(f"axe-core is missing: run npm ci in {FRONT}.")
    fresh.evaluate("document.querySelectorAll('.percept-lab details').forEach((d) => (d.open = true))")
    fresh.locator(control("hide 1")).first.check()
    fresh.locator(control("preset hide")).first.click()
    fresh.evaluate(axe.read_text())
    for width in ("", "400px"):
        fresh.evaluate(WIDTH, width)
        found = fresh.evaluate("axe.run(document.querySelector('.percept-lab'))")
        serious = [v for v in found["violations"] if v["impact"] in ("serious", "critical")]
        assert [(v["id"], [n["html"] for n in v["nodes"]]) for v in serious] == []
        assert len(found["passes"]) > 10
        outside = fresh.evaluate("""() => {
            const lab = document.querySelector('.percept-lab');
            return [...lab.querySelectorAll('canvas, fieldset, .actions, .control')].filter(
                (e) => e.getBoundingClientRect().right > lab.getBoundingClientRect().right + 1).length;
        }""")
        assert outside == 0
    fresh.evaluate(WIDTH, "")


def test_each_picture_says_in_words_what_it_shows(fresh):
    fresh.locator(control("picture points")).first.check()
    rested(fresh)
    labels = state(fresh)["labels"][:6]
    expected = {
        "Image plane": ("point 1 goes from y1 0, y2 0.48", "its estimate ends at"),
        "Scene": ("point 1 goes from depth 2.5 to", "its estimate ends at"),
        "Norm of the error": ("error: from 1.25",),
        "Depth": ("true depth of point 1: from 2.5", "depth of point 3: from 1.5"),
        "Error of each point": ("error of point 2",),
        "Smallest eigenvalue": ("smallest eigenvalue: from",),
    }
    for start, parts in expected.items():
        (label,) = [text for text in labels if text.startswith(start)]
        assert all(part in label for part in parts), label


def test_random_events_break_nothing_and_reset_restores_everything(fresh, folder):
    opening, wanted = state(fresh), usable(fresh)
    assert wanted - used_at_random(fresh, 1, wanted, most=MOST_SAMPLES) == set()
    shown = state(fresh)
    assert shown["problems"] == []
    assert_python_has(folder, shown["settings"])
    assert points_lab(**shown["settings"]).settings == shown["settings"]
    assert_equals_python(shown, 1e-6)
    fresh.locator(control("reset")).first.click()
    rested(fresh, 60)
    assert state(fresh) == opening
    assert_equals_python(state(fresh))
    assert not log_entries(fresh)
