"""Notebooks as assignments of nbgrader and of Otter, which cut the solutions out and mark what students hand in.

Both tools read marks in a notebook, and these are made from its tags.  Neither tool is imported.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from percept_obs.exercises.copies import Notebook, stub, students_copy

CUT = "{}\n# BEGIN SOLUTION NO PROMPT\n{}\n# END SOLUTION"
"""A stub and a solution that both tools cut out."""

TEST = "assert reply.right, reply"

CONFIG = """# ASSIGNMENT CONFIG
requirements: ["percept-obs[course]"]
export_cell:
  pdf: false"""
"""Otter's settings: what the notebooks need, and no PDF of an answer, which needs LaTeX."""

PARTS = {
    ("markdown", "exercise"): "task",
    ("code", "solution"): "solution",
    ("code", "exercise"): "check",
    ("markdown", "solution"): "model",
}
"""Parts of an exercise, by the kinds and tags of their cells."""


def _nbgrader(notebook: Notebook) -> dict[str, Any]:
    """Return a notebook as the source of an assignment of nbgrader, a point for each exercise."""
    return {**notebook, "cells": [made for cell in notebook["cells"] for made in _for_nbgrader(cell)]}


def _otter(notebook: Notebook) -> dict[str, Any]:
    """Return a notebook as the source of an assignment of Otter, a question of one point for each exercise."""
    cells = notebook["cells"]
    made = [each for k, cell in enumerate(cells) for each in _for_otter(cell, cells[k:])]
    return {**notebook, "cells": [_raw("otter-config", CONFIG), *made]}


GRADERS: Mapping[str, Callable[[Notebook], dict[str, Any]]] = {"nbgrader": _nbgrader, "otter": _otter}
"""Functions that make an assignment of a notebook, by the tool that marks it."""


def _for_nbgrader(cell: Notebook) -> Iterator[dict[str, Any]]:
    """Yield a cell with nbgrader's marks."""
    part, source = _part(cell), "".join(cell["source"])
    if part == "solution":
        yield _marked(cell, CUT.format(stub(source), source), solution=True)
    elif part == "check":
        yield _marked(cell, "".join(_halves(source)) + f"display(reply)\n{TEST}", grade=True, locked=True, points=1)
    elif part == "model":
        yield _marked(cell, source, solution=True, grade=True, points=1)
    else:
        yield from students_copy({"cells": [cell]})["cells"]


def _marked(cell: Notebook, source: str, **marks: Any) -> dict[str, Any]:
    plain = {"schema_version": 3, "grade": False, "solution": False, "locked": False, "task": False}
    return _with(cell, source, metadata=cell["metadata"] | {"nbgrader": {**plain, "grade_id": cell["id"], **marks}})


def _for_otter(cell: Notebook, onward: Sequence[Notebook]) -> Iterator[dict[str, Any]]:
    """Yield a cell between Otter's marks; a task's have the name and kind of the next solution among cells `onward`."""
    part, source, name = _part(cell), "".join(cell["source"]), cell.get("id", "")
    end = _raw(f"{name}-end", "# END QUESTION")
    if part == "task":
        answer = next(each for each in onward if _part(each) in ("solution", "model"))
        manual = str(_part(answer) == "model").lower()
        yield _raw(f"{name}-begin", f"# BEGIN QUESTION\nname: {answer['id']}\npoints: 1\nmanual: {manual}")
        yield _with(cell, source)
    elif part == "solution":
        yield from _block("SOLUTION", _with(cell, CUT.format(stub(source), source)))
    elif part == "check":
        # What a test of Otter names is forgotten after it, and later cells need what stands before the reply.
        before, reply = _halves(source)
        if before:
            yield _with(cell, before)
        yield from _block("TESTS", _with(cell, reply + TEST, id=f"{name}-test"))
        yield end
    elif part == "model":
        yield from _block("SOLUTION", _with(cell, source))
        yield end
    else:
        yield from students_copy({"cells": [cell]})["cells"]


def _block(kind: str, cell: dict[str, Any]) -> list[dict[str, Any]]:
    begin, end = (_raw(f"{cell['id']}-{edge.lower()}-{kind.lower()}", f"# {edge} {kind}") for edge in ("BEGIN", "END"))
    return [begin, cell, end]


def _part(cell: Notebook) -> str:
    """Return the part that a cell has in an exercise; none for a hint, or outside of one."""
    tags = cell["metadata"].get("tags", ())
    return next((part for (kind, tag), part in PARTS.items() if kind == cell["cell_type"] and tag in tags), "")


def _halves(check: str) -> tuple[str, str]:
    """Return what a check does before its reply, and the line that names the reply."""
    match ast.parse(check).body:
        case [*_, ast.Expr() as last]:
            lines = check.splitlines(keepends=True)
            return "".join(lines[: last.lineno - 1]), f"reply = {''.join(lines[last.lineno - 1 :]).strip()}\n"
    raise ValueError(f"a check ends with its reply, such as reach(gain, ...); this does not:\n{check}")


def _with(cell: Notebook, source: str, **others: Any) -> dict[str, Any]:
    return {**cell, "source": source.splitlines(keepends=True), **others}


def _raw(name: str, source: str) -> dict[str, Any]:
    return _with({"cell_type": "raw", "id": name, "metadata": {}}, source)
