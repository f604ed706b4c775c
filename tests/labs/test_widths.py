"""Every lab fits windows of all widths, and what can be pressed can be reached; what does not fit is found."""

import pytest
from widths import WIDTHS, assert_fits

from percept_obs.labs import derivation_desk, observer_lab, points_lab, structure_lab

pytestmark = pytest.mark.browser

LABS = {
    "observer": observer_lab,
    "structure": lambda: structure_lab(duration=3.0, period=0.01, step=0.01),
    "points": lambda: points_lab(duration=30.0),
    "desk": derivation_desk,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", LABS)
def test_a_saved_lab_fits_its_window(browser, tmp_path, name):
    page = browser.new_page(offline=True)
    LABS[name]().save(tmp_path / "lab.html")
    page.goto((tmp_path / "lab.html").as_uri())
    page.wait_for_function("() => tests.allDrawn()")
    looked = assert_fits(page, name)  # with each group of its drawer
    print(f"{name}: {len(WIDTHS)} widths, {looked} controls reached")
    page.close()


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ('<p style="width: 900px">words</p>', "the page is 9"),
        ('<div style="width: 300px; overflow: auto"><p style="width: 900px">words</p></div>', None),
        ('<button>b</button><div style="position: fixed; inset: 0"></div>', "is covered by div"),
        ('<button style="position: fixed; left: -200px">b</button>', "is outside of the window"),
        ('<button style="position: fixed; left: -9px">b</button>', "is cut by the window"),
        ('<a href="#" style="position: absolute; left: 795px">a long link</a>', "the page is"),
        (
            '<div style="overflow: hidden; width: 9px"><button style="margin-left: 99px">b</button></div>',
            "is cut by div",
        ),
        ("<button hidden>b</button><details><summary>s</summary><button>b</button></details>", None),
        ('<label>a box<input type="checkbox"></label>', None),
    ],
)
def test_what_does_not_fit_is_found(browser, body, said):
    page = browser.new_page(viewport={"width": 800, "height": 600})
    page.set_content(f"<!doctype html><body>{body}")
    wrong = page.evaluate("tests.fits()")["wrong"]
    assert wrong == [] if said is None else any(said in each for each in wrong), wrong
    page.close()
