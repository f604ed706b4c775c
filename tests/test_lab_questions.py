"""Three questions are answered by moving things in the observer lab: four acts at most, the reason in a picture."""

import pytest
from lab_alone import DRAWN
from lab_browser import centre, control

from percept_obs.labs import observer_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

ARROWS = """() => {
    const [lab] = window.perceptObsLabs;
    const found = lab.planes[0].parts.arrowsOf(lab.shown, { sample: 0, part: 0, next: 0 }, lab.theme);
    return found[0].velocities;
}"""
FOE_TO_POINT = """() => {
    const [lab] = window.perceptObsLabs;
    const [{ at, scale }] = lab.planes[0].handles;
    const [y1, y2] = lab.shown.truth;
    return [(y1 - at[0]) * scale, (at[1] - y2) * scale];
}"""
LATE = """() => {
    const [{ shown: { runs: [{ error }] } }] = window.perceptObsLabs;
    const late = Array.from(error.slice(error.length / 2)).sort((a, b) => a - b);
    return late[Math.floor(late.length / 2)];
}"""
SETTLING = "() => [...window.perceptObsLabs][0].shown.runs[0].settling"


@pytest.fixture
def page(show):
    page = show(observer_lab("ma2005_eq35"))
    page.click(control("way back"))  # the question is closed: here nobody is asked
    return page


@pytest.fixture
def shot(page, tmp_path, request):
    """Take the next picture of the screen, once the lab has come to rest."""
    count = iter(range(9))

    def take(moving=False):
        if not moving:
            page.wait_for_function(DRAWN)
        page.wait_for_timeout(150)
        file = tmp_path / f"{request.node.name.removeprefix('test_')}_{next(count)}.png"
        page.screenshot(path=file)
        assert file.stat().st_size > 20_000

    take()
    return take


def test_why_the_focus_of_expansion_hides_the_distance(page, shot):
    near, _, far = page.evaluate(ARROWS)
    assert abs(near[0] - far[0]) > 0.1  # copies at other distances move otherwise: so the distance shows
    x, y = centre(page, control("foe"))
    right, down = page.evaluate(FOE_TO_POINT)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + right, y + down, steps=8)
    page.mouse.up()
    shot()
    near, _, far = page.evaluate(ARROWS)
    assert abs(near[0] - far[0]) + abs(near[1] - far[1]) < 0.02
    page.focus(control("cursor"))
    for _ in range(6):
        page.keyboard.press("ArrowRight")
    shot()


def test_why_y1_alone_fails_with_noise(page, shot):
    page.check(control("outputs y1"))
    shot()
    page.fill(control("noise size number"), "0.02")
    page.keyboard.press("Tab")
    shot()
    assert page.evaluate(SETTLING) == float("inf")
    page.click(control("topic causes"))
    page.wait_for_selector(".causes li")
    told = page.locator(".causes li").all_inner_texts()
    for cause in ("y1 and y2", "without noise", "bias of noise", "bound", "half the gain", "exact signal"):
        assert any(cause in line for line in told), cause
    assert any("without noise: converged" in line for line in told)
    assert any("bias of noise taken out: converged" in line for line in told)
    shot()
    page.click(control("swing"))  # what y1 does not tell at an instant
    shot(moving=True)


def test_why_more_gain_is_worse_with_noise(page, shot):
    page.click(control("zoom in"))
    shot()
    page.fill(control("noise size number"), "0.003")
    page.keyboard.press("Tab")
    shot()
    page.click(control("keep"))
    before = page.evaluate(LATE)
    page.fill(control("identifier_based gain number"), "60")
    page.keyboard.press("Tab")
    shot()
    assert page.evaluate(LATE) > 3 * before
