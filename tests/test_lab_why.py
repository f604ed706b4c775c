"""The arrows in the image are velocities of the point and of its copies, and fall together where nothing is told."""

import pytest
from lab_alone import DRAWN, opened

from percept_obs.labs import observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SWINGING = {"v_c_swing": [0.3, 0.2, -0.1], "v_p": [0.1, 0.0, 0.05], "w": [0.1, -0.2, 0.3]}
LABS = {
    "observer": lambda: observer_lab(),
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
    const arrows = plane.arrowsOf(shown, { sample: k, part: 0 }, theme);
    const seconds = shown.time[k + 1] - shown.time[k - 1];
    const step = (c) => (rows[(k + 1) * width + c] - rows[(k - 1) * width + c]) / seconds;
    return arrows.map(({ place, velocities }, p) => {
        const at = [0, 1].map((c) => rows[k * width + 2 * p + c]);
        return { place, at, velocities, moved: [0, 1].map((c) => step(2 * p + c)) };
    });
}"""
STILL = [[0.0] * 3] * 3


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
