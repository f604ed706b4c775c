"""A reader without Python reaches every answer: fields, folded answers, formulas judged, and words of a page."""

import json
import re

import nbformat
import pytest
from lab_settings import FRONT
from places import NOTEBOOKS

from percept_obs import PerspectiveSystem, affine, check, pinhole
from percept_obs.exercises.models import answers_in, notebooks
from percept_obs.site import _texts
from percept_obs.site.exercises import OF_A_NOTEBOOK, SHEET, WORDS, inside, on_a_page, sheet_of, words_of_a_page
from percept_obs.site.slides import slides_of

SYSTEM = PerspectiveSystem(affine(), pinhole())
RIGHT = "y3' = -y3 (a31 y1 + a32 y2 + a33 + b3 y3)"
ANSWER = "Only motion tells."


def whole(name):
    return nbformat.reads(json.dumps(notebooks()[name]), as_version=4)


def sources(notebook, kind):
    return [cell.source for cell in notebook.cells if cell.cell_type == kind]


def test_every_answer_is_on_a_page():
    asked = folded = checked = 0
    for name, notebook in notebooks().items():
        answers = [answer for cell in notebook["cells"] for answer in answers_in(cell)]
        page = "\n".join(sources(on_a_page(whole(name)), "markdown"))
        for answer in answers:
            assert words_of_a_page(answer).removeprefix("**A model answer.** ") in page
        asked += len(answers)
        folded += page.count('<details class="asked" data-kind="words"')
        checked += len(re.findall('<details class="asked" data-kind="(?:formula|choice|values)"', page))
    solutions = [
        cell
        for notebook in notebooks().values()
        for cell in notebook["cells"]
        if cell["cell_type"] == "code" and "solution" in cell["metadata"].get("tags", ())
    ]
    print(f"{folded} of {asked} answers in words, {checked} of {len(solutions)} that are checked")
    assert folded == asked > 100
    assert checked == len(solutions) > 40


@pytest.mark.parametrize("name", sorted(path.name for path in NOTEBOOKS.glob("*.ipynb")))
def test_a_page_and_its_slides_say_and_show_nothing_that_only_a_notebook_can_keep(name):
    page = on_a_page(whole(name))
    for shown in (page, slides_of(page)):
        assert not OF_A_NOTEBOOK.findall("\n\n".join(sources(shown, "markdown")))
        assert not re.search(
            r"percept_obs\.exercises|\b(model_answer|tally|needs)\(", "\n".join(sources(shown, "code"))
        )


def test_no_text_says_what_only_a_notebook_can_keep():
    for path, text in _texts(exam=True):
        assert path.endswith((".css", ".toml")) or not OF_A_NOTEBOOK.search(text), path


@pytest.mark.parametrize(
    "words",
    ["press <kbd>Shift</kbd>+<kbd>Enter</kbd>", "Run this cell.", "click into the grey box", "restart the kernel"],
)
def test_the_law_knows_such_words(words):
    assert OF_A_NOTEBOOK.search(words)
    assert not OF_A_NOTEBOOK.search(words_of_a_page(f"<!-- notebook -->{words}<!-- page: Drag the point. -->"))


def test_a_cell_with_the_tag_of_notebooks_is_left_out():
    cells = [nbformat.v4.new_markdown_cell(text) for text in ("kept", "left out")]
    cells[1].metadata.tags = ["notebook"]
    assert sources(on_a_page(nbformat.v4.new_notebook(cells=cells)), "markdown") == ["kept"]


def test_only_a_formula_that_numbers_decide_is_judged_on_a_page():
    (line,) = sheet_of(check(RIGHT, SYSTEM))["steps"][0]["lines"]
    assert line["name"] == "y3'"
    assert sheet_of(check("y3' = y3", SYSTEM)) == {}, "a wrong one tells nothing of the right one"
    assert sheet_of(check("1 + y3", "1 + y3 = 0")) == {}, "of a place where something is zero factors do not matter"


@pytest.fixture
def exercises(browser, tmp_path):
    """A page of three exercises, opened from a disk without a network."""
    sheet = f'<script type="{SHEET}">{inside(sheet_of(check(RIGHT, SYSTEM)))}</script>'
    kinds = [
        ("words", "", ANSWER),
        ("choice", 'data-right="b" data-options="a b c"', ANSWER),
        ("formula", "", f"{sheet}\n{ANSWER}"),
    ]
    shown = "".join(WORDS["folded"].format(kind=kind, data=data, words=words) for kind, data, words in kinds)
    script = (FRONT / "exercises.js").read_text("utf-8")
    (tmp_path / "page.html").write_text(
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Exercises</title><main>{shown}</main>'
        f"<script>{script}</script>",
        "utf-8",
    )

    def opened(**options):
        page = browser.new_page(offline=True, **options)
        page.goto((tmp_path / "page.html").as_uri())
        return page

    return opened


@pytest.mark.browser
def test_an_answer_unfolds_by_keys_once_something_is_typed(exercises):
    page = exercises()
    assert page.get_by_text(ANSWER).count() == 3
    assert not any(each.is_visible() for each in page.get_by_text(ANSWER).all())
    field, compare = page.get_by_label("Your answer, in a sentence").last, page.get_by_role("button", name="Compare")
    field.focus()
    field.press("Control+Enter")
    assert compare.first.is_disabled()
    page.keyboard.type("I think so.")
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    assert page.get_by_text(ANSWER).first.is_visible()
    page.get_by_role("button", name="c", exact=True).press("Enter")
    assert page.get_by_text("You said c, the experiment says b.").is_visible()
    page.get_by_role("button", name="b", exact=True).press("Space")
    assert page.get_by_text("✓ Yes, b.").is_visible()
    page.close()


@pytest.mark.browser
def test_a_formula_is_judged_while_it_is_typed(exercises):
    page = exercises()
    field, found = (
        page.locator("[data-kind=formula]").locator("xpath=preceding-sibling::div[1]").locator("textarea"),
        (page.locator(".found")),
    )
    for text, said in (
        (RIGHT, "✓ right"),
        ("-y3 (b3 y3 + a33 + a32 y2 + a31 y1)", "✓ right"),
        (f'"{RIGHT}"', "✓ right"),
        ("-y3 (a31 y1 + a32 y2 + a33 - b3 y3)", "✗ not right yet; "),
        ("-a31 y1 y3 - a32 y2 y3", "… right so far"),
        ("-y3 (a31 y1 + ", "something is missing at the end"),
        ("import os", "a page reads plain arithmetic only"),
    ):
        field.fill(text)
        found.get_by_text(said).wait_for()
    field.fill(RIGHT)
    field.press("Enter")
    assert page.get_by_text(ANSWER).last.is_visible()
    page.close()


@pytest.mark.browser
def test_without_a_script_an_answer_is_unfolded_by_hand(exercises):
    page = exercises(java_script_enabled=False)
    assert page.get_by_role("textbox").count() == 0
    page.locator("summary").first.press("Enter")
    assert page.get_by_text(ANSWER).first.is_visible()
    page.close()


@pytest.mark.browser
def test_paper_shows_the_answers_that_were_unfolded(exercises):
    page = exercises()
    page.get_by_role("button", name="b", exact=True).click()
    page.emulate_media(media="print")
    assert [each.is_visible() for each in page.get_by_text(ANSWER).all()] == [False, True, False]
    page.close()
