"""README.md is a first screen that a registry shows as well, pictures can be drawn again, one line names the owner."""

import re
import sys
import tomllib
from itertools import pairwise

import browsers
import needs
import pytest
from PIL import Image, ImageChops
from readme import (
    FIGURES,
    FRAMES,
    GALLERY,
    LABS,
    MADE,
    MOVING,
    MOVING_SCREEN,
    OBSERVER_TABLE,
    PICTURES,
    PLAYS,
    PROJECT,
    README,
    ROOT,
    moving_picture,
    observer_table,
    picture,
    repository,
    with_owner,
    with_part,
)
from readme_renderer.markdown import render

from percept_obs import cli

REMEDY = "python tests/support/readme.py pictures writes it again"
TEXT, SHOWN, PROJECT_TEXT = (path.read_text("utf-8") for path in (README, GALLERY, PROJECT))
ADDRESS = "https://github.com/some-body/percept_obs"


def shipped(name):
    """A picture's text in the gallery, and its size."""
    found = re.search(rf"!\[(.*)\]\({PICTURES.name}/{name}\.png\)", SHOWN)
    assert found, REMEDY
    with Image.open(PICTURES / f"{name}.png") as image:
        return found[1], image.size


def test_the_table_has_a_row_for_each_observer():
    text = OBSERVER_TABLE.read_text("utf-8")
    assert with_part(text, "observers", observer_table()) == text, REMEDY


def test_every_picture_has_a_text_and_they_are_light():
    pictures = re.findall(r"!\[(.*?)\]\((.*?)\)", SHOWN)
    assert sorted(GALLERY.parent / file for _, file in pictures) == sorted(PICTURES.iterdir())
    assert all(len(text) > 50 for text, _ in pictures)
    assert sum(file.stat().st_size for file in PICTURES.iterdir()) < 300_000


def test_one_picture_moves_on_and_is_light():
    assert f"![{PLAYS}](" in TEXT, REMEDY
    assert MOVING.stat().st_size < 600_000
    with Image.open(MOVING) as image:
        assert (image.size, image.n_frames) == (MOVING_SCREEN, FRAMES), REMEDY
        assert image.info["loop"] == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_can_be_made_anew(name):
    figure = FIGURES[name]()
    text, size = shipped(name)
    assert text == figure.text, REMEDY
    assert picture(figure).size == size, REMEDY


def test_the_pictures_of_labs_have_their_texts():
    assert {name: shipped(name)[0] for name in LABS} == {name: text for name, (_, text) in LABS.items()}, REMEDY


@pytest.mark.slow
@pytest.mark.browser
def test_the_moving_picture_can_be_made_anew(browser):
    images = moving_picture(browser, count=3)
    assert {image.size for image in images} == {MOVING_SCREEN}
    assert all(ImageChops.difference(*pair).getbbox() for pair in pairwise(images))


def test_readme_is_a_first_screen():
    assert len(TEXT.splitlines()) <= 120


def test_the_files_that_readme_leads_to_exist():
    for path in re.findall(r"\]\(([^):]*)\)", MADE[README](TEXT, "")):
        assert (ROOT / path).exists(), path


@pytest.mark.parametrize("path", MADE, ids=lambda path: path.name)
def test_the_address_is_written_where_it_belongs_and_nowhere_without_one(path):
    text, make = path.read_text("utf-8"), MADE[path]
    assert make(text, repository()) == text, "python tests/support/readme.py writes it again"
    named, unnamed = make(text, ADDRESS), make(text, "")
    assert "some-body" in named
    assert "github.com" not in unnamed
    assert "mybinder.org" not in unnamed
    assert make(named, ADDRESS) == named
    assert make(named, "") == unnamed


def test_one_line_names_the_owner_and_can_name_another():
    project = with_owner(with_owner(PROJECT_TEXT, "nobody"), "some-body")
    assert tomllib.loads(project)["project"]["urls"] == {"Repository": ADDRESS}
    assert len(project.splitlines()) - len(PROJECT_TEXT.splitlines()) == (not repository())
    with pytest.raises(SystemExit, match="is no name of a user on GitHub"):
        with_owner(PROJECT_TEXT, 'a"b')


def test_a_registry_shows_readme():
    """Its renderer takes out what it does not allow, and knows no files beside the text."""
    shown = render(MADE[README](TEXT, ADDRESS))
    sources = re.findall(r'<img [^>]*src="([^"]*)"', shown)
    assert sources == [f"https://raw.githubusercontent.com/some-body/percept_obs/HEAD/.github/{MOVING.name}"]
    assert PLAYS in shown
    links = re.findall(r'href="([^"]*)"', shown)
    assert len(links) > 10
    assert all(link.startswith(("https://", "#")) for link in links)
    assert shown.count("<pre") == 7
    assert "<!--" not in shown


def test_where_playwright_s_node_does_not_start_a_test_is_skipped_and_says_how_to_get_it(monkeypatch):
    monkeypatch.setenv("PLAYWRIGHT_NODEJS_PATH", sys.executable)  # which ends with an error, as without a library
    monkeypatch.delenv("PERCEPT_OBS_MUST_RUN", raising=False)
    monkeypatch.setattr(browsers, "_kept", {})
    monkeypatch.setattr(needs, "playwright_lacks", needs.playwright_lacks.__wrapped__)
    with pytest.raises(pytest.skip.Exception, match=r"apt-get install libatomic1.*SyntaxError"), browsers.playwright():
        pass


def test_the_link_to_binder_opens_what_binder_copies(tmp_path, monkeypatch):
    command = re.search(r"^percept-obs (.*)$", (ROOT / "binder/postBuild").read_text("utf-8"), re.MULTILINE)
    monkeypatch.chdir(tmp_path)
    assert cli.main(command[1].split()) == 0
    linked = re.search(r"mybinder\.org\S*urlpath=lab/tree/([^)\s]*)", MADE[README](TEXT, ADDRESS))
    assert (tmp_path / linked[1]).exists()
