"""Faults of notebooks and texts that can be known without running anything."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator, Mapping
from importlib.util import find_spec
from itertools import pairwise
from posixpath import join, normpath
from typing import Any

from percept_obs.exercises import stub
from percept_obs.site.exercises import OF_A_NOTEBOOK, words_of_a_page
from percept_obs.site.front import STEPS
from percept_obs.site.pages import MODULES, slug

TAGS = frozenset({"slide", "exercise", "hint", "solution", "notebook"})
"""Tags of cells; the site and the copies for students know no others."""


def faults_of(
    notebooks: Mapping[str, Mapping[str, Any]], texts: Mapping[str, str], names: Mapping[str, Any], run: Collection[str]
) -> Iterator[str]:
    """Yield what is wrong with notebooks and texts, each in a sentence that begins with its place.

    Names are what the texts have substituted, see `named`; modules are asked for by notebooks that are to be run.
    """
    from jinja2 import Environment, StrictUndefined, TemplateError

    pages = {*texts, *(f"{folder}/index.md" for folder in ("notebooks", "ledger", "reference"))}
    pages |= {*(f"notebooks/{name}" for name in notebooks), *(f"reference/{slug(m)}.rst" for m in MODULES)}
    for name, notebook in notebooks.items():
        cells = [(cell, "".join(cell["source"]), {*cell["metadata"].get("tags", ())}) for cell in notebook["cells"]]
        words = "\n\n".join(text for cell, text, _ in cells if cell["cell_type"] == "markdown")
        words = words_of_a_page(words)
        for fault in (*_in_cells(cells, name in run), *_in_words(words, "notebooks", pages)):
            yield f"notebooks/{name}: {fault}"
        if not any(name[:2] in numbers for numbers in STEPS.values()):
            yield f"notebooks/{name}: no step of the first page has it; name it in percept_obs/site/front.py"
    for path, text in texts.items():
        try:
            words = Environment(undefined=StrictUndefined).from_string(text).render(names)
            yield from (f"{path}: {fault}" for fault in _in_words(words, "", pages))
        except TemplateError as error:
            yield f"{path}: {error.message}"


def _in_cells(cells: list[tuple[Mapping[str, Any], str, set[str]]], run: bool) -> Iterator[str]:
    tasks = [text for _, text, tags in cells if "exercise" in tags and text.startswith("**")]
    if not all(text.startswith(f"**Exercise {k}") for k, text in enumerate(tasks, 1)):
        yield "its exercises are not **Exercise 1**, **Exercise 2** and so on"
    if cells[0][0]["cell_type"] != "markdown" or not cells[0][1].startswith("# "):
        yield "its first cell is no title, such as: # Two observers"
    if not any("slide" in tags for _, _, tags in cells):
        yield 'it has no slides; give the cells that are to be shown the tag "slide"'
    for cell, text, tags in cells:
        if tags - TAGS:
            yield f"cell {cell['id']} has the tag {', '.join(tags - TAGS)}; known are {', '.join(sorted(TAGS))}"
        if cell["cell_type"] == "code":
            try:
                ast.parse(re.sub(r"^[%!].*", "", text, flags=re.MULTILINE))
                if "solution" in tags:
                    stub(text)
            except (SyntaxError, ValueError) as error:
                yield f"cell {cell['id']}: {error}"
            for name in re.findall(r"^ *(?:import|from(?=.* import)) (\w+)", text, re.MULTILINE) if run else ():
                if find_spec(name) is None:
                    yield f"cell {cell['id']} needs {name}; get it with: python -m pip install 'percept-obs[course]'"


def _in_words(text: str, folder: str, pages: Collection[str]) -> Iterator[str]:
    text = re.sub(r"^---\n.*?^---\n|^(`{3,}).*?^\1|`[^`\n]*`", "", text, flags=re.DOTALL | re.MULTILINE)
    levels = [len(marks) for marks in re.findall(r"^(#+) ", text, re.MULTILINE)]
    if levels.count(1) != 1 or any(later > level + 1 for level, later in pairwise(levels)):
        yield f"its headings have the levels {levels}; a page has one title, and no level is left out"
    for said in OF_A_NOTEBOOK.finditer(text):
        yield f"a page cannot keep “{said[0]}”; mark it: <!-- notebook -->...<!-- page: what a page can do -->"
    for target in re.findall(r"\]\((?!\w+:|/ledger/)([^)\s#]+\.(?:md|ipynb|rst))\b", text):
        if normpath(join("/", folder, target))[1:] not in pages:
            yield f"a link leads to {target}, which is not there"
    if re.search(r'!\[\s*\]|<img(?![^>]*\balt="\s*[^"\s])', text):
        yield "a picture has no alternative text"
