"""What can be known of notebooks and texts without running them is told before the site is built, all at once."""

import json

import pytest

from percept_obs import cli, site
from percept_obs.exercises import models
from percept_obs.site import SiteFault, faults
from percept_obs.site.named import named

NAME = "16_your_own_film.ipynb"
WHOLE = models.notebooks()


TITLE = {"cell_type": "markdown", "id": "title", "metadata": {"tags": ["slide"]}, "source": "# A title"}


def told(run=(), name=NAME, of_texts=None, **changes):
    """Faults of a notebook whose cells, by their names, are changed, beside others, and of texts."""
    notebook = json.loads(json.dumps(WHOLE[NAME]))
    for cell in notebook["cells"]:
        cell.update(changes.get(cell["id"].replace("-", "_"), {}))
    beside = {each: {"cells": [TITLE]} for each in WHOLE if each != NAME} | {name: notebook}
    return [*faults.faults_of(beside, {"guide.md": "# A guide"} | (of_texts or {}), named(beside), run)]


def test_the_course_has_none():
    texts = {path: text for path, text in site._texts(True) if path.endswith(".md")}
    assert [*faults.faults_of(WHOLE, texts, named(WHOLE), [])] == []


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"title": {"source": "Words."}}, "its first cell is no title"),
        ({"goals": {"source": "# A second title"}}, "its headings have the levels [1, 1, "),
        ({"goals": {"source": "#### Deep"}}, "its headings have the levels [1, 4, "),
        ({"goals": {"metadata": {"tags": ["slides"]}}}, "cell goals has the tag slides; known are exercise, hint"),
        ({"goals": {"source": "[there](17_none.ipynb)"}}, "a link leads to 17_none.ipynb, which is not there"),
        ({"goals": {"source": "[there](../guide.md#goals)"}}, None),
        ({"goals": {"source": "Run this cell."}}, "a page cannot keep “Run this cell”"),
        ({"goals": {"source": "<!-- notebook -->Run this cell.<!-- page: Look. -->"}}, None),
        ({"goals": {"source": "[there](../guides.md)"}}, "a link leads to ../guides.md"),
        ({"goals": {"source": "`[there](17_none.ipynb)`"}}, None),
        ({"goals": {"source": "![](a.png)"}}, "a picture has no alternative text"),
        ({"goals": {"source": '<img alt=" " src="a.png">'}}, "a picture has no alternative text"),
        ({"goals": {"source": '<img src="a.png" alt="what it shows">'}}, None),
        ({"twice_task": {"source": "**Exercise 3: predict.**"}}, "its exercises are not **Exercise 1**"),
        ({"twice": {"source": "print(1)"}}, "cell twice: a solution ends by giving the answer a name"),
        ({"read": {"source": "one two"}}, "cell read: invalid syntax"),
        ({"read": {"source": "%matplotlib inline\n!ls"}}, None),
        (
            {"read": {"source": "import no_such.part, os"}, "run": [NAME]},
            "cell read needs no_such; get it with: python -m pip",
        ),
        ({"read": {"source": "from no_such import part"}}, None),  # it is not to be run
        ({"name": "99_lost.ipynb"}, "no step of the first page has it"),
        ({"of_texts": {"new.md": "# New\n\n[there](guides.md)"}}, "new.md: a link leads to guides.md"),
        ({"of_texts": {"new.md": '# New\n\n{{ nb["77"] }}'}}, "new.md: "),
        ({"of_texts": {"new.md": '# New\n\n{{ MA2005["(999)"] }}'}}, "new.md: "),
        ({"of_texts": {"new.md": "# New\n\n{{ nothing }}"}}, "new.md: 'nothing' is undefined"),
        ({"of_texts": {"new.md": "Words."}}, "new.md: its headings have the levels []"),
    ],
)
def test_each_is_told_with_its_place(changes, said):
    found = told(**changes)
    assert found == [] if said is None else any(said in each for each in found), found


def test_a_notebook_without_slides_is_told():
    plain = {cell["id"].replace("-", "_"): {"metadata": {}} for cell in WHOLE[NAME]["cells"]}
    assert told(**plain) == [f'notebooks/{NAME}: it has no slides; give the cells that are to be shown the tag "slide"']


def test_all_are_told_together_before_any_work(monkeypatch, tmp_path, capsys):
    whole = json.loads(json.dumps(WHOLE))
    for name in ("00_start.ipynb", NAME):
        whole[name]["cells"][0]["source"] = "Words."
        whole[name]["cells"][1]["metadata"]["tags"] = ["slides"]
    with pytest.raises(SiteFault) as error:
        site.build(tmp_path / "new", whole)
    assert not capsys.readouterr().out
    assert all(str(error.value).count(said) == 2 for said in ("no title", "the tag slides"))
    monkeypatch.setattr(models, "notebooks", lambda: whole)
    assert cli.main(["site", str(tmp_path / "new")]) == 1
    assert "00_start.ipynb: its first cell is no title" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()
