"""Notebooks as a page can keep them: exercises with a field and a folded answer, and words of what a page can do.

A field is made by the page's script, before the folded answer; without the script the answer is unfolded by hand.
"""

from __future__ import annotations

import ast
import re
import tomllib
from copy import deepcopy
from dataclasses import replace
from importlib import resources
from typing import TYPE_CHECKING, Any

from percept_obs.checking import Review
from percept_obs.checking.lines import VALUE
from percept_obs.exercises.models import answers_in
from percept_obs.labs.desk.answers import SAID
from percept_obs.labs.desk.sheets import Sheet
from percept_obs.labs.desk.texts import printed
from percept_obs.labs.shared.saved import inside
from percept_obs.system.derivation import Derivation, Step

if TYPE_CHECKING:
    import nbformat

SHEET = "application/json"
"""Kind of output in which a review, while a notebook runs, leaves what the page judges by."""

WORDS = tomllib.loads((resources.files("percept_obs.site") / "texts/said.toml").read_text("utf-8"))
OF_A_NOTEBOOK = re.compile(WORDS["of_a_notebook"])
MARKED = re.compile(r"<!-- notebook -->.*?<!-- page:?(.*?)-->", re.DOTALL)
"""Words of a notebook, and what its page says instead, which a notebook does not show."""

NEEDED = re.compile(r"^(from percept_obs\.exercises import .*|needs\(.*\))\n*", re.MULTILINE)
"""Lines of code that only ask for what exercises need."""

KINDS = {"derive": "formula", "choose": "choice", "reach": "values"}
"""Kinds of fields, by the function that checks the answer."""


def sheet_of(review: Review) -> dict[str, Any]:
    """Return what the page judges typed lines by, as the desk does; nothing where numbers do not decide."""
    asked = [review.target.lines[row] for row in sorted({line.row for line in review.lines})]
    if review.right is not True or any(line.kind != VALUE for line in asked):
        return {}
    named = tuple(replace(line, name=line.name or "answer") for line in asked)
    step = Step("", "", {line.name: line.formula for line in named})
    sheet = Sheet([], Derivation((step,)), replace(review.target, lines=named, derivation=None))
    return {**printed(sheet, {}), "title": "", "said": SAID | WORDS["said"]}


def words_of_a_page(text: str) -> str:
    """Return what a page says in place of a notebook's text.

    >>> words_of_a_page("Look. <!-- notebook -->Run the cell.<!-- page: Move the point. -->")
    'Look. Move the point.'
    """
    text = MARKED.sub(lambda found: found[1].strip(), text)
    for pattern, instead in WORDS["instead"].items():
        text = re.sub(pattern, instead, text)
    return text


def on_a_page(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """Return a notebook, which has all answers, as its page shows it; where it was run, with what the checks say."""
    from nbformat.v4 import new_markdown_cell

    page = deepcopy(notebook)
    cells, page.cells, solution = page.cells, [], ""
    for cell in cells:
        tags = cell.metadata.get("tags", [])
        if cell.cell_type == "markdown":
            cell.source = words_of_a_page(cell.source)
            if "solution" in tags:
                words = cell.source.removeprefix("**A model answer.** ")
                cell = new_markdown_cell(WORDS["folded"].format(kind="words", data="", words=words))
            elif answers_in(cell):
                cell.source = cell.source.replace("<details>", '<details class="asked" data-kind="words">')
        elif "solution" in tags:
            solution = cell.source
        elif "exercise" in tags:
            cell = new_markdown_cell(_folded(solution, cell))
        else:
            cell.source = NEEDED.sub("", cell.source)
            for output in cell.get("outputs", []):
                output.get("data", {}).pop(SHEET, None)  # which only an exercise shows
        if "notebook" not in tags and cell.source and cell.source != solution:
            page.cells.append(cell)
    return page


def _folded(solution: str, check: nbformat.NotebookNode) -> str:
    """Return the folded answer to an exercise that a notebook checks: the answer, what the check says, and why."""
    asked, given = (ast.parse(code).body[-1].value for code in (check.source, solution))  # type: ignore[attr-defined]
    shown = [output["data"] for output in check.outputs if "text/markdown" in output.get("data", {})][-1:]
    reply = "".join("".join(data["text/markdown"]) for data in shown)
    reply = re.sub(r"^✓ ?(Yes, )?", "", reply, flags=re.MULTILINE)
    why = " ".join(re.findall(r"^# (.*)", solution, re.MULTILINE))
    words, data, kind = [reply, why and f"*Why:* {why}"], "", KINDS[asked.func.id]
    if kind == "choice":
        data = f'data-right="{given.value}" data-options="{" ".join(option.arg for option in asked.keywords)}"'
        words[0] = reply or f"**{given.value}.**"
    elif kind == "formula":
        words[0] = "\n\n".join(re.findall(r"\$\$.*?\$\$", reply, re.DOTALL))
        words.insert(0, "\n".join(("```text", *(line.value for line in getattr(given, "elts", [given])), "```")))
        if sheet := shown and shown[0].get(SHEET):
            words.insert(0, f'<script type="application/json">{inside(sheet)}</script>')
    else:
        words.insert(0, "```python\n{}\n```".format(re.sub(r"^#.*\n", "", solution, flags=re.MULTILINE)))
    return WORDS["folded"].format(kind=kind, data=data, words="\n\n".join(filter(None, words)))
