"""Hand and eye are together: whatever has the focus, the image or the scene and the chart of the error are in view."""

import pytest
from lab_alone import DRAWN
from lab_browser import UNFOLD, control, painted
from sample_sizes import across

from percept_obs.labs import observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LABS = {
    "observer": observer_lab,
    "structure": lambda: structure_lab(duration=3.0, period=0.01, step=0.01),
    "points": lambda: points_lab(duration=30.0),
}
NOTEBOOK = {"width": 848, "height": 679}
"""Size of an output in JupyterLab whose window has 1280 x 800 pixels, with its file browser open."""
SIZES = [NOTEBOOK, {"width": 1000, "height": 700}, {"width": 1280, "height": 800}]

AMONG = """(height) => {
    for (const place of ["before", "after"]) {
        const text = document.createElement("div");
        text.style.height = `${height}px`;
        document.querySelector(".percept-lab")[place](text);
    }
}"""
WALK = """(kept) => {
    const lab = document.querySelector(".percept-lab");
    const box = (node) => node.getBoundingClientRect();
    const screen = { left: 0, top: 0, right: innerWidth, bottom: document.documentElement.clientHeight };
    const inside = (a, b) =>
        a.top >= b.top - 1 && a.bottom <= b.bottom + 1 && a.left >= b.left - 1 && a.right <= b.right + 1;
    const whole = (selector) => {
        const node = lab.querySelector(selector);
        const holder = node.closest(".charts");
        return box(node).height > 60 && inside(box(node), screen) && (!holder || inside(box(node), box(holder)));
    };
    const wrong = [];
    let walked = 0;
    for (const target of lab.querySelectorAll("[data-control]")) {
        if (target.disabled || !target.checkVisibility()) continue;
        target.focus();
        walked += 1;
        const name = target.dataset.control;
        if (document.activeElement !== target) wrong.push(`${name} has no focus`);
        if (!whole("figure.image-plane") && !whole("figure.scene")) wrong.push(`${name}: neither image nor scene`);
        if (!whole(".chart-error")) wrong.push(`${name}: not the error`);
        if (!inside(box(target), screen)) wrong.push(`${name} is not in view itself`);
    }
    return { wrong, walked };
}"""
CUT = """() => {
    const lab = document.querySelector(".percept-lab");
    const { left, right } = lab.getBoundingClientRect();
    const pen = document.createElement("canvas").getContext("2d");
    const own = (node) => node.closest(".formulas, .determinant, .code, svg, math, .unseen, .figure, .handle");
    const cut = [];
    for (const node of lab.querySelectorAll("*")) {
        if (!node.checkVisibility() || own(node)) continue;
        const box = node.getBoundingClientRect();
        const name = node.dataset.control ?? `${node.tagName} ${node.className} ${node.textContent.slice(0, 30)}`;
        if (box.right > right + 1 || box.left < left - 1) cut.push(`${name} leaves the lab`);
        const said = ["BUTTON", "LABEL", "SPAN", "P", "TD", "TH", "INPUT", "SUMMARY"].includes(node.tagName);
        if (said && node.clientWidth && node.scrollWidth > node.clientWidth + 1) {
            cut.push(`${name} is cut: ${node.scrollWidth} of ${node.clientWidth}`);
        }
        if (node.tagName !== "SELECT") continue;
        const style = getComputedStyle(node);
        pen.font = `${style.fontSize} ${style.fontFamily}`;
        const widest = Math.max(...[...node.options].map((option) => pen.measureText(option.text).width));
        if (widest + 20 > node.clientWidth) cut.push(`${name} is cut: ${widest} of ${node.clientWidth}`);
    }
    return cut;
}"""
SMALL = """() => [...document.querySelectorAll(
    ".stage :is([data-control], button, input, select, summary, a)")].flatMap((node) => {
    if (node.disabled || !node.checkVisibility({ visibilityProperty: true })) return [];
    const target = (/checkbox|radio/.test(node.type) && node.closest("label")) || node;
    const { width, height } = target.getBoundingClientRect();
    return Math.min(width, height) < 23.9 ? [`${node.dataset.control ?? node.textContent}: ${width} x ${height}`] : [];
})"""
"""Targets that are too small for a finger: less than 24 pixels."""
TABS = {"observer": ["causes"], "structure": [], "points": []}
"""More tabs beside the pictures than all have."""


@pytest.mark.parametrize(("name", "size"), across([*LABS], SIZES))
def test_pictures_are_in_view_whichever_control_has_the_focus(show, name, size):
    page = show(LABS[name](), viewport=size)
    page.evaluate(AMONG, 900)
    for everything in (False, True):
        if everything:
            page.evaluate(UNFOLD)
            for box in page.locator("[data-control^='picture ']").all():
                box.check()
            page.wait_for_function(DRAWN)
        found = page.evaluate(WALK)
        assert found["wrong"] == []
        assert found["walked"] > (60 if everything else 25)


@pytest.mark.parametrize(("name", "width"), across([*LABS], [400, 285]))
def test_nothing_is_cut_or_small_and_no_control_is_lost_on_a_small_screen(show, name, width):
    page = show(LABS[name](), viewport=NOTEBOOK)
    page.evaluate(UNFOLD)
    wide = """() => [...document.querySelectorAll('.percept-lab [data-control]')]
        .filter((c) => c.checkVisibility()).map((c) => c.dataset.control)"""
    wanted = set(page.evaluate(wide))
    page.set_viewport_size({"width": width, "height": 800})
    painted(page)
    seen = set()
    for view in ("image-plane", "scene"):
        page.click(control(f"tab {view}"))
        for tab in ("controls", *TABS[name], "words", "equations"):
            page.click(control(f"tab {tab}"))
            assert page.get_attribute(control(f"tab {tab}"), "aria-pressed") == "true"
            painted(page)
            assert page.evaluate(CUT) == []
            assert page.evaluate(SMALL) == []
            assert page.evaluate("document.documentElement.scrollWidth") <= width
            seen |= set(page.evaluate(wide))
    assert wanted - seen == set()


@pytest.mark.parametrize("name", LABS)
def test_a_first_screen_that_is_folded_away_rests_and_is_drawn_again_when_it_is_unfolded(show, name):
    page = show(LABS[name](), face="first")
    fold = "(how) => { document.querySelector('.percept-lab').parentElement.style.display = how; }"
    look = (
        "() => { const [{ first, pending }] = window.perceptObsLabs; return [pending, first.image.size?.width > 0]; }"
    )
    for how, seen in (("none", False), ("", True)):
        page.evaluate(fold, how)
        page.evaluate("() => { const [lab] = window.perceptObsLabs; lab.first.clock.finish(); }")
        page.wait_for_function(f"(seen) => ({look})().join() === `false,${{seen}}`", arg=seen)
