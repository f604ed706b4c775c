"""Notebooks as a page can keep them: exercises with a field and a folded answer, and words of what a page can do.

A field is made by the page's script, before the folded answer; without the script the answer is unfolded by hand.
"""

from __future__ import annotations

import ast
import re
from copy import deepcopy
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from percept_obs.checking import Review
from percept_obs.checking.lines import VALUE
from percept_obs.exercises.copies import CHECK
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

OF_A_NOTEBOOK = re.compile(
    r"shift(</kbd>)?\s*\+|grey box|\b(run|click into|restart) (\w+ )?(cells?|kernel|check)\b|cell (above|below)|"
    r"one below it|into a box|model_answer|tally\(|place of the dots|dots `\.\.\.`",
    re.IGNORECASE,
)
"""What only a notebook can keep; no page says it."""

MARKED = re.compile(r"<!-- notebook -->.*?<!-- page:?(.*?)-->", re.DOTALL)
"""Words of a notebook, and what its page says instead, which a notebook does not show."""

SAID_BY_ALL = {
    r"Read, then replace the dots .*": "Read, type your answer, and press *Compare*: the model answer unfolds. It may "
    "be wrong as often as you like. A formula is judged while you type; the gains and numbers of an exercise that "
    "tunes can be tried only where Python runs.",
    r" Click into the grey box and press [^:]*:": "",
    r": it is enough to run the cells one after the other\.": ".",
    r"[Cc]hoose before you run the check:": "Choose first:",
    r"Guess, before you run the next cell:": "Guess first:",
    r" Take away a factor 2 in `ray` and run the cell again: it refuses\.": "",
    r" in `observer_lab\([^`]*`( from `percept_obs\.labs`, or sweep some values in code)?": " in the lab of one point",
    r" Type `system` or `[^`]*` into a box of your own\.": "",
    r"So far you ran a cell for each check\.": "So far each check was a cell of Python.",
    r",? (Type|Write) it as text, `[^`]*`\.|, as text: `[^`]*`(?=\.)": "",
}
"""Patterns of what notebooks say without a mark, and the page's words for it."""

FOLDED = """<details class="asked" data-kind="{kind}" {data}><summary>Answer</summary>

{words}

</details>"""

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
    only = "a page reads plain arithmetic only: the exercise's letters, numbers, + - * / ^ and brackets"
    return {**printed(sheet, {}), "title": "", "said": SAID | {"python": only}}


def words_of_a_page(text: str) -> str:
    """Return what a page says in place of a notebook's text.

    >>> words_of_a_page("Look. <!-- notebook -->Run the cell.<!-- page: Move the point. -->")
    'Look. Move the point.'
    """
    text = MARKED.sub(lambda found: found[1].strip(), text)
    for pattern, instead in SAID_BY_ALL.items():
        text = re.sub(pattern, instead, text)
    return text


def on_a_page(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """Return a notebook, which has all answers, as its page shows it; where it was run, with what the checks say."""
    from nbformat.v4 import new_markdown_cell

    page = deepcopy(notebook)
    cells, solution = [], ""
    for cell in page.cells:
        tags = cell.metadata.get("tags", [])
        if "notebook" in tags:
            continue
        if cell.cell_type == "markdown":
            cell.source = words_of_a_page(cell.source)
            if "solution" in tags:
                words = cell.source.removeprefix("**A model answer.** ")
                cell = new_markdown_cell(FOLDED.format(kind="words", data="", words=words))
            elif answers_in(cell):
                cell.source = cell.source.replace("<details>", '<details class="asked" data-kind="words">')
        elif "solution" in tags:
            solution = cell.source
            continue
        elif "exercise" in tags and cell.get("id", "").endswith(CHECK):
            cell = new_markdown_cell(_folded(solution, cell))
        else:
            cell.source = _without_checks(cell.source)
            if not cell.source and not cell.outputs:
                continue
        cells.append(cell)
    page.cells = cells
    return page


def _folded(solution: str, check: nbformat.NotebookNode) -> str:
    """Return the folded answer to an exercise that a notebook checks: why, the answer, and what the check says."""
    call = ast.parse(check.source).body[-1].value  # type: ignore[attr-defined]
    given = ast.parse(solution).body[-1].value  # type: ignore[attr-defined]
    shown = [output["data"] for output in check.outputs if "text/markdown" in output.get("data", {})][-1:]
    reply = "".join("".join(data["text/markdown"]) for data in shown)
    reply = re.sub(r"^✓ ?(Yes, )?", "", reply, flags=re.MULTILINE)
    why = " ".join(re.findall(r"^# (.*)", solution, re.MULTILINE))
    words, data, kind = [reply, why and f"*Why:* {why}"], "", KINDS[call.func.id]
    if kind == "choice":
        data = f'data-right="{given.value}" data-options="{" ".join(option.arg for option in call.keywords)}"'
        words = words if reply else [f"**{given.value}.**", *words]
    elif kind == "formula":
        lines = [line.value for line in getattr(given, "elts", [given])]
        words = ["\n".join(("```", *lines, "```")), *words]
        if sheet := shown and shown[0].get(SHEET):
            words = [f'<script type="application/json">{inside(sheet)}</script>', *words]
    else:
        code = re.sub(r"^#.*\n", "", solution, flags=re.MULTILINE)
        words = [f"```python\n{code}\n```", *words]
    return FOLDED.format(kind=kind, data=data, words="\n\n".join(filter(None, words)))


def _without_checks(code: str) -> str:
    """Return code without the lines that only ask for what an exercise needs."""
    if "percept_obs.exercises" not in code:
        return code
    lines = code.splitlines()
    for statement in reversed(ast.parse(code).body):
        text = ast.unparse(statement)
        if text.startswith(("from percept_obs.exercises", "needs(")):
            del lines[statement.lineno - 1 : statement.end_lineno]
    return "\n".join(lines).strip()
