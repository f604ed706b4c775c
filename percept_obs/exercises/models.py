"""Model answers to the questions of the notebooks, each shown once somebody has written an answer of their own."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Mapping
from functools import cache
from hashlib import sha256
from importlib import resources
from pathlib import Path
from typing import Any

from percept_obs.exercises.answers import Attempt
from percept_obs.validation import checked

_INSTALLED = resources.files("percept_obs") / "notebooks"
FOLDER = _INSTALLED if _INSTALLED.is_dir() else Path(__file__).parents[2] / "notebooks"
"""Folder of the notebooks: inside an installed package, beside it in a checkout."""

FOLDED = re.compile(r"<details><summary>.*?</summary>(.*?)</details>", re.DOTALL)
"""An answer as a notebook folds it."""

UNWRITTEN = "Answer first, in your own words: put them in quotes in the place of the dots. Then run this cell."


def notebooks() -> dict[str, Any]:
    """Return the notebooks by the names of their files, in order."""
    files = (each for each in FOLDER.iterdir() if each.name.endswith(".ipynb"))
    return {file.name: json.loads(file.read_bytes()) for file in sorted(files, key=lambda file: file.name)}


def cells_of(notebook: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the cells of a notebook; a ValueError if it is none."""
    cells = notebook.get("cells") if isinstance(notebook, Mapping) else None
    if not isinstance(cells, list):
        raise ValueError("this is no notebook; give what json.loads makes of an .ipynb file, which has a list of cells")
    kinds: dict[str, Any] = {"cell_type": str, "metadata": Mapping, "source": (str, list)}
    for number, cell in enumerate(cells, 1):
        if not isinstance(cell, Mapping) or not all(isinstance(cell.get(name), kind) for name, kind in kinds.items()):
            raise ValueError(f"cell {number} is none of a notebook; give it a cell_type, its metadata and its source")
    return cells


def statements(code: str) -> list[ast.stmt]:
    """Return the statements of a cell; a ValueError if it is no Python."""
    try:
        return ast.parse(code).body
    except SyntaxError as error:
        raise ValueError(f"this is no Python ({error}); mend it:\n{code}") from None


def answers_in(cell: Mapping[str, Any]) -> list[str]:
    """Return the answers that a cell of a notebook gives in words."""
    tags, text = cell["metadata"].get("tags", ()), "".join(cell["source"])
    if cell["cell_type"] != "markdown" or "hint" in tags:
        return []
    return [text] if "solution" in tags else [found.strip() for found in FOLDED.findall(text)]


def key_of(answer: str) -> str:
    """Return the key under which a model answer is asked for."""
    return sha256(answer.encode()).hexdigest()[:8]


@checked
def model_answer(mine: Any, key: str) -> Attempt:
    """Show a model answer, to be compared with one's own.

    Parameters
    ----------
    mine : str or ...
        One's own answer, in words; "no" is one.
    key : str
        Key of the question, as the students' copy of a notebook has it.

    Returns
    -------
    Attempt

    See Also
    --------
    students_copy : Puts it in place of the answers.

    Examples
    --------
    >>> print(model_answer(..., "0"))
    Answer first, in your own words: put them in quotes in the place of the dots. Then run this cell.
    """
    if not isinstance(mine, str) or not re.search(r"\w", mine):
        return Attempt(None, UNWRITTEN)
    found = _answers().get(key)
    if found is None:
        return Attempt(
            None, "There is no such answer: this copy is of another version. Make a new one: percept-obs lab."
        )
    return Attempt(None, found if found.startswith("**A model answer.**") else f"**A model answer.** {found}")


@cache
def _answers() -> dict[str, str]:
    """Model answers of all notebooks by their keys."""
    cells = (cell for notebook in notebooks().values() for cell in notebook["cells"])
    return {key_of(answer): answer for cell in cells for answer in answers_in(cell)}
