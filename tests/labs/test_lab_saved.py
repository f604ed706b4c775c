"""A saved lab is whole without Python: in the page of a notebook, and in one of its own that opens from a disk."""

import re

import pytest
from ipywidgets.embed import dependency_state, embed_data
from lab_alone import DRAWN
from lab_browser import assert_equals_python, control, state
from lab_settings import ALL, KEYS

from percept_obs.labs import observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LABS = [observer_lab, points_lab, lambda: structure_lab(duration=3.0, period=0.01, step=0.01)]


@pytest.fixture
def page(browser):
    """A page with what a notebook's page keeps of a lab, as nbconvert writes it."""
    lab = observer_lab(duration=2.0)  # what there is does not depend on how long it runs
    kept = dependency_state([lab], drop_defaults=False)
    saved = embed_data(views=[lab], state=kept)["manager_state"]["state"]
    page = browser.new_page(offline=True, reduced_motion="reduce")
    page.evaluate("(saved) => tests.showSaved(saved)", saved[lab.model_id])
    page.wait_for_function(DRAWN)
    page.evaluate("tests.unfold()")
    yield page
    page.close()


def test_every_observer_with_every_output_on_every_surface(page):
    for key in KEYS:
        surface, outputs = key.split(" ")
        page.select_option(control("surface"), surface)
        page.wait_for_function(DRAWN)
        if page.is_visible(control("outputs")):  # with one choice there is nothing to choose
            page.fill(control("outputs"), {"y1": "0", "y1+y2": "1", "y2": "2"}[outputs])
        assert "+".join(page.evaluate("tests.first().settings.outputs")) == outputs
        page.evaluate("tests.tickAll()")
        page.wait_for_function(DRAWN)
        assert {*page.evaluate("tests.observers()")} == set(ALL), key
        assert page.locator(".problem:not([hidden])").count() == 0
    assert "There is no Python here" in page.inner_text(".silence")


def test_what_it_draws_is_what_python_computes(page):
    page.fill(control("outputs"), "0")
    page.check(control("observer extended_kalman"))
    page.select_option(control("surface"), "chained")
    page.wait_for_function(DRAWN)
    assert_equals_python(state(page))


@pytest.fixture
def from_disk(browser, tmp_path):
    """Opens a lab's own page from the disk, without a network; the second value lists what left the page."""

    def opened(lab):
        lab.save(tmp_path / "lab.html")
        asked = []
        page = browser.new_page(offline=True, viewport={"width": 1280, "height": 800})
        page.on("request", lambda request: asked.append(request.url))
        page.on("pageerror", lambda error: asked.append(str(error)))
        page.goto((tmp_path / "lab.html").as_uri())
        page.wait_for_function(DRAWN)
        return page, [url for url in asked[1:] if not url.startswith("blob:")]

    return opened


@pytest.mark.parametrize("make", LABS)
def test_a_page_of_its_own_is_small_asks_for_nothing_and_is_printed_without_controls(make, from_disk, tmp_path):
    page, asked = from_disk(make())
    assert asked == []
    assert (tmp_path / "lab.html").stat().st_size < 430_000
    assert page.locator(".silence").is_hidden()
    page.emulate_media(media="print")
    found = page.evaluate("tests.onPaper()")
    assert found["pressed"] == 0
    assert found["pictures"] > 2
    assert found["said"] >= 1
    assert len(re.findall(rb"/Type\s*/Page\b", page.pdf(format="A4"))) <= 2
    page.close()


def test_it_computes_beside_the_page_though_the_page_is_a_file(from_disk):
    page, asked = from_disk(points_lab())
    page.evaluate("() => tests.first().change({ spin: 0.5 }, true)")
    page.wait_for_function("() => tests.first().latest.beside")
    page.wait_for_function(DRAWN)
    assert asked == []
    page.close()


@pytest.mark.parametrize("place", ["folder", "none/lab.html"])
def test_a_place_that_cannot_be_written_is_refused(place, tmp_path):
    (tmp_path / "folder").mkdir()
    with pytest.raises(ValueError, match=r"name a file in a folder that is there"):
        points_lab().save(tmp_path / place)
