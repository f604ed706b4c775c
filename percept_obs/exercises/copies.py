"""Copies of a notebook: the students' without solutions and answers, the teachers' with everything.

The cells of an exercise are known by their tags: ``exercise``, ``hint`` and ``solution``.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping
from typing import Any

Notebook = Mapping[str, Any]
"""A notebook as its file has it."""

OWN_WORDS = "*Write your answer here.*"
COMPARED = "*Write your answer here, then compare it with the teachers' copy.*"
ANSWER = re.compile(r"<details>.*?</details>", re.DOTALL)


def stub(solution: str) -> str:
    """Return the stub of a solution: its answer's name, and dots for the answer.

    Parameters
    ----------
    solution : str
        Code that ends by giving the answer a name.

    Raises
    ------
    ValueError
        If the code does not end so.

    See Also
    --------
    students_copy : Puts stubs in place of solutions.

    Examples
    --------
    >>> stub('prediction = "b"')
    'prediction = ...  # your answer'
    """
    match ast.parse(solution).body:
        case [*_, ast.Assign(targets=[ast.Name(id=name)])]:
            return f"{name} = ...  # your answer"
    raise ValueError(f"a solution ends by giving the answer a name, answer = ...; this does not:\n{solution}")


def students_copy(notebook: Notebook) -> dict[str, Any]:
    """Return a notebook without its solutions and the folded answers to its questions; hints stay.

    Parameters
    ----------
    notebook : mapping
        As its file has it; it is not changed.

    Raises
    ------
    ValueError
        If a solution does not end by giving the answer a name.

    See Also
    --------
    stub : Takes the place of a solution.

    Examples
    --------
    >>> cell = {"cell_type": "code", "metadata": {"tags": ["solution"]}, "source": ["gain = 5"]}
    >>> students_copy({"cells": [cell]})["cells"][0]["source"]
    ['gain = ...  # your answer']
    """
    return {**notebook, "cells": [_for_students(cell) for cell in notebook["cells"]]}


COPIES: Mapping[str, Callable[[Notebook], dict[str, Any]]] = {"students": students_copy, "teachers": dict}
"""Functions that copy a notebook, by its readers; teachers get everything."""


def _for_students(cell: Notebook) -> dict[str, Any]:
    tags, text = cell["metadata"].get("tags", ()), "".join(cell["source"])
    if "solution" in tags:
        text = stub(text) if cell["cell_type"] == "code" else OWN_WORDS
    elif cell["cell_type"] == "markdown" and "hint" not in tags:
        text = ANSWER.sub(COMPARED, text)
    return {**cell, "source": text.splitlines(keepends=True)}
