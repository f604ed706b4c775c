"""README.md says what the package says, its pictures can be drawn again, and one line names the repository."""

import re
import tomllib

import pytest
from PIL import Image
from readme import (
    FIGURES,
    LABS,
    NAMES_THE_REPOSITORY,
    PICTURES,
    README,
    ROOT,
    observer_table,
    picture,
    picture_of_lab,
    repository,
    with_part,
    with_repository,
)

from percept_obs import cli

REMEDY = "python tests/readme.py pictures writes it again"
TEXT = README.read_text("utf-8")


def shipped(name):
    """A picture's text in README.md, and its size."""
    found = re.search(rf"!\[(.*)\]\({(PICTURES / name).relative_to(ROOT)}\.png\)", TEXT)
    assert found, REMEDY
    with Image.open(PICTURES / f"{name}.png") as image:
        return found[1], image.size


def test_the_table_has_a_row_for_each_observer():
    assert with_part(TEXT, "observers", observer_table()) == TEXT, REMEDY


def test_every_picture_has_a_text_and_they_are_light():
    pictures = re.findall(r"!\[(.*?)\]\((.*?)\)", TEXT)
    assert sorted(ROOT / file for _, file in pictures) == sorted(PICTURES.iterdir())
    assert all(len(text) > 50 for text, _ in pictures)
    assert sum(file.stat().st_size for file in PICTURES.iterdir()) < 300_000


@pytest.mark.slow
@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_can_be_made_anew(name):
    figure = FIGURES[name]()
    text, size = shipped(name)
    assert text == figure.text, REMEDY
    assert picture(figure).size == size, REMEDY


@pytest.mark.slow
@pytest.mark.browser
def test_the_pictures_of_labs_can_be_made_anew(browser):
    for name, (make, expected) in LABS.items():
        text, size = shipped(name)
        assert text == expected, REMEDY
        drawn = picture_of_lab(browser, make)
        assert drawn.size == size, REMEDY
        assert len(drawn.getcolors()) > 10, "nothing is drawn"


@pytest.mark.parametrize("path", NAMES_THE_REPOSITORY, ids=lambda path: path.name)
def test_one_line_names_the_repository(path):
    text = path.read_text("utf-8")
    assert repository() in text
    assert with_repository(text) == text, REMEDY


def test_the_link_to_binder_opens_what_binder_copies(tmp_path, monkeypatch):
    command = re.search(r"^percept-obs (.*)$", (ROOT / "binder/postBuild").read_text("utf-8"), re.MULTILINE)
    monkeypatch.chdir(tmp_path)
    assert cli.main(command[1].split()) == 0
    assert (tmp_path / re.search(r"mybinder\.org\S*urlpath=lab/tree/([^)\s]*)", TEXT)[1]).exists()


def test_the_citation_names_the_version_of_the_package():
    version = re.search(r"^version: (.*)$", (ROOT / "CITATION.cff").read_text("utf-8"), re.MULTILINE)
    assert version[1] == tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]


def test_a_repository_that_is_renamed_is_renamed_everywhere(monkeypatch):
    monkeypatch.setattr("readme.repository", lambda: "https://github.com/somebody/observers")
    for path in NAMES_THE_REPOSITORY:
        renamed = with_repository(path.read_text("utf-8"))
        assert repository().removeprefix("https://github.com/") not in renamed
        assert "https://github.com/somebody/observers" in renamed
    assert "https://mybinder.org/v2/gh/somebody/observers/HEAD?" in with_repository(TEXT)
