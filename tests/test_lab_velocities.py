"""The arrows in the image are velocities of the point and of its copies, and fall together where nothing is told."""

import numpy as np
import pytest
from lab_alone import DRAWN, opened
from lab_browser import control

from percept_obs.labs import observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SWINGING = {"v_c_swing": [0.3, 0.2, -0.1], "v_p": [0.1, 0.0, 0.05], "w_c": [0.1, -0.2, 0.3]}
LABS = {
    "observer": lambda: observer_lab("ma2005_eq35"),
    "sphere": lambda: observer_lab(surface="sphere"),
    "plane": lambda: observer_lab(surface="plane", normal=[0.2, -0.1, 0.9]),
    "structure": lambda: structure_lab(**SWINGING),
    "points": lambda: points_lab(spin=0.4),
    "origin": lambda: points_lab(state="origin", spin=0.4),
}
ARROWS = """() => {
    const [lab] = window.perceptObsLabs;
    const { shown, theme, planes: [plane] } = lab;
    const k = Math.floor(shown.time.length / 3);
    const rows = shown.images ?? shown.image ?? shown.truth;
    const width = shown.images ? 2 * shown.points : 3;
    const arrows = plane.parts.arrowsOf(shown, { sample: k, part: 0 }, theme);
    const seconds = shown.time[k + 1] - shown.time[k - 1];
    const step = (c) => (rows[(k + 1) * width + c] - rows[(k - 1) * width + c]) / seconds;
    return arrows.map(({ place, velocities }, p) => {
        const at = [0, 1].map((c) => rows[k * width + 2 * p + c]);
        return { place, at, velocities, moved: [0, 1].map((c) => step(2 * p + c)) };
    });
}"""
STILL = [[0.0] * 3] * 3
UNSEEN = {
    "one output": lambda: observer_lab(outputs=["y1"]),
    "no input": lambda: points_lab(input=0.0),
    "no known velocity": lambda: structure_lab(v_c=[0.0, 0.0, 0.0]),
}
SWUNG = """() => {
    const [lab] = window.perceptObsLabs;
    const [, scene] = lab.planes;
    const { moved } = scene.parts.unseenOf(lab.shown, { sample: 50, part: 0 }, lab.theme);
    return [-1, 0, 1].map((amount) => moved(amount).map(({ image, place }) => [image, place]));
}"""


def arrows_of(browser, lab):
    page = opened(browser, lab)
    page.wait_for_function(DRAWN)
    found = page.evaluate(ARROWS)
    page.close()
    return found


@pytest.mark.parametrize("name", LABS)
def test_the_point_s_own_arrow_is_the_velocity_of_its_image_and_its_copies_have_others(browser, name):
    arrows = arrows_of(browser, LABS[name]())
    assert arrows
    for arrow in arrows:
        near, own, far = arrow["velocities"]
        assert arrow["place"] == pytest.approx(arrow["at"], rel=1e-9)
        assert own == pytest.approx(arrow["moved"], rel=2e-2, abs=2e-3)
        assert near != pytest.approx(far, rel=1e-2)


def test_at_the_focus_of_expansion_and_without_input_all_arrows_fall_together(browser):
    staying = observer_lab(A=STILL, b=[0.1, 0.0, 0.8], X0=[0.25, 0.0, 2.0], duration=3.0)
    for lab in (staying, points_lab(input=0.0)):
        for arrow in arrows_of(browser, lab):
            near, own, far = arrow["velocities"]
            assert near == pytest.approx(own, abs=1e-6)
            assert far == pytest.approx(own, abs=1e-6)


@pytest.mark.parametrize("name", UNSEEN)
def test_what_is_not_seen_is_moved_and_what_is_measured_stands_still(browser, name):
    lab = UNSEEN[name]()
    page = opened(browser, lab)
    page.wait_for_function(DRAWN)
    swung = page.evaluate(SWUNG)
    for copies in zip(*swung, strict=True):
        images, places = ([copy[k] for copy in copies] for k in (0, 1))
        seen = [0] if name == "one output" else [0, 1]
        for image, place in zip(images, places, strict=True):
            assert [image[c] for c in seen] == pytest.approx([images[1][c] for c in seen], abs=1e-9)
            assert image == pytest.approx([place[0] / place[2], place[1] / place[2]])
            if name == "one output":
                assert rate_of_y1(place, lab.settings) == pytest.approx(rate_of_y1(places[1], lab.settings))
        depths = [place[2] for place in places]
        assert max(depths) > 1.2 * min(depths)
    page.click(control("swing"))
    page.wait_for_function("() => Math.abs([...window.perceptObsLabs][0].planes[1].swing.amount) > 0.2")
    page.click(control("swing"))
    assert page.evaluate("[...window.perceptObsLabs][0].planes[1].swing.amount") is None
    page.close()


def rate_of_y1(place, settings):
    """The rate of X / Z where X' = A X + b."""
    velocity = np.asarray(settings["A"]) @ place + settings["b"]
    return (velocity[0] - place[0] / place[2] * velocity[2]) / place[2]


def test_where_everything_is_told_there_is_nothing_unseen_to_move_and_with_reduced_motion_it_moves_by_steps(browser):
    for lab in (observer_lab("ma2005_eq35"), points_lab(), structure_lab(duration=3.0)):
        page = opened(browser, lab)
        page.wait_for_function(DRAWN)
        assert page.locator(control("swing")).is_hidden()
        page.close()
    page = opened(browser, points_lab(input=0.0), reduced_motion="reduce")
    page.wait_for_function(DRAWN)
    page.click(control("swing"))
    first = page.evaluate("[...window.perceptObsLabs][0].planes[1].swing.amount")
    page.wait_for_timeout(150)
    assert page.evaluate("[...window.perceptObsLabs][0].planes[1].swing.amount") == first > 0.5
    page.close()
