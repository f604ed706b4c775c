"""Copies of a notebook: the students' without solutions and answers, the teachers' with everything.

The cells of an exercise are known by their tags: ``exercise``, ``hint`` and ``solution``.
"""

from __future__ import annotations

import ast
import json
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from percept_obs.exercises.models import FOLDED, answers_in, cells_of, key_of, statements
from percept_obs.validation import checked

Notebook = Mapping[str, Any]
"""A notebook as its file has it."""

OWN_WORDS = "*Answer in the cell below, in your own words; then it shows a model answer.*"

ASKED = """from percept_obs.exercises import model_answer

model_answer(..., "{}")  # your answer, in quotes, for the dots"""

CHECK = "-check"
"""End of the names of cells that check an answer; before it stands the name of the answer's cell."""


@checked
def stub(solution: str) -> str:
    """Return the stub of a solution: its answer's name, and dots for the answer.

    Parameters
    ----------
    solution : str
        Code that ends by giving the answer a name.

    Raises
    ------
    ValueError
        If the code does not end so, or is no Python.

    See Also
    --------
    students_copy : Puts stubs in place of solutions.

    Examples
    --------
    >>> stub('prediction = "b"')
    'prediction = ...  # your answer'
    """
    match statements(solution):
        case [*_, ast.Assign(targets=[ast.Name(id=name)])]:
            return f"{name} = ...  # your answer"
    raise ValueError(f"a solution ends by giving the answer a name, answer = ...; this does not:\n{solution}")


def students_copy(notebook: Notebook) -> dict[str, Any]:
    """Return a notebook without its solutions and answers; hints stay, and model answers can be asked for.

    Parameters
    ----------
    notebook : mapping
        As its file has it; it is not changed.

    Raises
    ------
    ValueError
        If it is no notebook, or a solution does not end by giving the answer a name.

    See Also
    --------
    stub : Takes the place of a solution.

    Examples
    --------
    >>> cell = {"cell_type": "code", "metadata": {"tags": ["solution"]}, "source": ["gain = 5"]}
    >>> students_copy({"cells": [cell]})["cells"][0]["source"]
    ['gain = ...  # your answer']
    """
    cells = [copied for cell in cells_of(notebook) for copied in _for_students(cell)]
    return {**notebook, "cells": cells}


COPIES: Mapping[str, Callable[[Notebook], dict[str, Any]]] = {"students": students_copy, "teachers": dict}
"""Functions that copy a notebook, by its readers; teachers get everything."""


def _for_students(cell: Notebook) -> Iterator[dict[str, Any]]:
    """Yield a cell as students get it: after each question a cell that shows the model answer to who has answered."""
    answers, text = answers_in(cell), "".join(cell["source"])
    if not answers:
        tags = cell["metadata"].get("tags", ())
        if "solution" in tags:
            text = stub(text)
        elif cell["cell_type"] == "code" and "exercise" in tags and cell.get("id", "").endswith(CHECK):
            text = _tallied(text, cell["id"].removesuffix(CHECK))
        yield {**cell, "source": text.splitlines(keepends=True)}
        return
    parts = ["", ""] if text == answers[0] else FOLDED.split(text)[::2]
    for k, part in enumerate(parts):
        last = k == len(answers)
        words = part.strip() if last else f"{part}{OWN_WORDS}".strip()
        if words:
            yield _cell(cell, "markdown", words, f"-{k + 1}" if k else "")
        if not last:
            yield _cell(cell, "code", ASKED.format(key_of(answers[k])), f"-answer-{k + 1}")


def _tallied(check: str, task: str) -> str:
    """Return a check that counts its attempts."""
    lines = check.splitlines(keepends=True)
    begin = statements(check)[-1].lineno - 1
    reply = "".join(lines[begin:]).strip()
    return f"from percept_obs.exercises import tally\n\n{''.join(lines[:begin])}tally({reply}, {json.dumps(task)})"


def _cell(cell: Notebook, kind: str, text: str, mark: str) -> dict[str, Any]:
    """Return a cell of a kind that stands where another one did."""
    extra: dict[str, Any] = {"execution_count": None, "outputs": []} if kind == "code" else {}
    named = {"id": f"{cell['id']}{mark}"} if "id" in cell else {}
    plain = {"cell_type": kind, "metadata": {} if kind == "code" else cell["metadata"], **named, **extra}
    return plain | {"source": text.splitlines(keepends=True)}
