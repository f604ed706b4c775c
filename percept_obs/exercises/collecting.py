"""A class's notebooks in one table: read, compared with what was given, and marked; nothing that a student wrote runs.

An answer is the literal in its cell: text, numbers, or a list or dictionary of them, found in the source.
"""

from __future__ import annotations

import ast
import csv
import json
import math
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from percept_obs.exercises.attempts import WRITTEN
from percept_obs.exercises.copies import students_copy
from percept_obs.exercises.individual import OURS, individual, same_name
from percept_obs.exercises.marking import LONGEST, Job, marks, named, programs, run
from percept_obs.exercises.models import notebooks
from percept_obs.validation.kinds import is_real

if TYPE_CHECKING:
    import pandas as pd

LARGEST = 50_000_000
"""Bytes of a notebook."""


@dataclass(frozen=True)
class _Student:
    """Row of a roster."""

    name: str
    folder: Path | None
    due: datetime | None = None
    listed: bool = True


@dataclass
class _HandedIn:
    """A notebook that a student handed in, compared with the copy that was given."""

    stem: str
    late: float  # hours
    copy: str
    altered: list[str]
    added: int
    job: Job
    unread: dict[str, str]
    texts: dict[str, str]
    counts: dict[str, tuple[int, int, int]]
    marks: dict[str, tuple[bool | None, str]] = field(default_factory=dict)


def collect(folder: Path, roster: Path | None = None, run_code: bool = False) -> pd.DataFrame:
    """Return a table of a class: a row a student, with marks, attempts, texts, and columns that a teacher fills in.

    Parameters
    ----------
    folder : Path
        Holds a folder a student, with the notebooks that were handed in.
    roster : Path, optional
        CSV file with the column student; and, if need be, folder, and due, such as 2026-03-01T12:00.
    run_code : bool
        Whether the cell of an answer that is no literal is run, in a process of its own with limits.

    Raises
    ------
    ValueError
        If there is no folder of a student, or the roster cannot be read.

    See Also
    --------
    individual : Makes the copies.

    Examples
    --------
    >>> collect(Path("submitted"), Path("roster.csv"))  # doctest: +SKIP
    """
    import pandas as pd

    students = _students(folder, _roster(roster) if roster else None)
    found: dict[str, list[_HandedIn]] = {}
    faults: dict[str, list[str]] = {}
    for student in students:
        handed, faults[student.name] = _handed_in(student, run_code)
        found[student.name] = list(handed.values())
    every = [each for handed in found.values() for each in handed]
    for each, verdicts in zip(every, marks([each.job for each in every]), strict=True):
        each.marks = verdicts
    names = sorted({each.job.notebook for each in every})
    rows = [_row(student, found[student.name], faults[student.name], names) for student in students]
    return pd.DataFrame(rows).map(harmless)


def harmless(entry: Any) -> Any:
    """Return an entry that no spreadsheet takes for a formula."""
    return f"'{entry}" if isinstance(entry, str) and entry.startswith(("=", "+", "-", "@", "\t", "\r")) else entry


def filled_in(table: pd.DataFrame, earlier: pd.DataFrame) -> pd.DataFrame:
    """Return a table with what a teacher has written into an earlier one: the rubric, and columns of his own."""
    own = [name for name in earlier if name not in table or name.endswith(POINTS)]
    kept = earlier.set_index("student")[own].reindex(table["student"]).fillna("")
    return table.assign(**{name: kept[name].to_numpy() for name in own})


POINTS = " (points)"
"""End of the names of columns for a teacher."""


def _roster(path: Path) -> list[dict[str, str]]:
    with open(path, encoding="utf-8-sig", newline="") as file:
        rows = [{k: (v or "").strip() for k, v in row.items() if k} for row in csv.DictReader(file)]
    names = [same_name(row.get("student", "")) for row in rows]
    if not rows or "" in names or len(set(names)) < len(names):
        raise ValueError(f"{path} needs a column student with a name in each row, each once; its first line names it")
    return rows


def _students(folder: Path, roster: Sequence[Mapping[str, str]] | None) -> list[_Student]:
    """Return the students of a roster, and whoever else has handed in."""
    if not folder.is_dir():
        raise ValueError(f"{folder} is no folder; name the one that holds a folder for each student")
    folders = sorted(each for each in folder.iterdir() if each.is_dir() and not each.is_symlink())
    if not folders:
        raise ValueError(f"{folder} holds no folder; put each student's notebooks into one with the student's name")
    students = []
    for row in roster or ():
        known = same_name(row.get("folder", "") or row["student"])
        own = [f for f in folders if same_name(f.name) == known or same_name(f.name).startswith(f"{known}_")]
        try:
            due = datetime.fromisoformat(row["due"]) if row.get("due") else None
        except ValueError:
            raise ValueError(f"{row['student']} is due at {row['due']!r}; write it as 2026-03-01T12:00") from None
        students.append(_Student(row["student"], own[0] if own else None, due))
    taken = {student.folder for student in students}
    return students + [_Student(f.name, f, None, roster is None) for f in folders if f not in taken]


def _handed_in(student: _Student, run_code: bool) -> tuple[dict[str, _HandedIn], list[str]]:
    """Return a student's notebooks, the last one of each, and what cannot be read."""
    found, faults = {}, []
    files = (f for f in student.folder.rglob("*.ipynb") if ".ipynb_checkpoints" not in f.parts) if student.folder else ()
    for file in sorted(files, key=lambda f: f.lstat().st_mtime):
        try:
            notebook = _read(file)
            cells = {cell["id"]: cell["source"] for cell in notebook["cells"]}
            name = max(notebooks(), key=lambda name: len(_ids()[name] & set(cells)))
            if len(_ids()[name] & set(cells)) < len(_ids()[name]) / 3:
                raise ValueError("none of the course's notebooks")
            found[name] = _compared(student, name, notebook, cells, file.lstat().st_mtime, run_code)
        except (OSError, ValueError, RecursionError, MemoryError) as error:
            faults.append(f"{file.name}: {str(error) or type(error).__name__}")
    return found, faults


@cache
def _ids() -> dict[str, set[str]]:
    return {name: {cell["id"] for cell in students_copy(shipped)["cells"]} for name, shipped in notebooks().items()}


def _read(file: Path) -> dict[str, Any]:
    """Return a notebook that somebody wrote, with its cells as text; a ValueError says why it is none."""
    if file.is_symlink() or not file.is_file() or file.lstat().st_size > LARGEST:
        raise ValueError(f"not a plain file of at most {LARGEST // 10**6} MB")
    notebook = json.loads(file.read_bytes())
    cells = notebook.get("cells") if isinstance(notebook, dict) else None
    if not isinstance(cells, list) or not all(isinstance(cell, dict) for cell in cells):
        raise ValueError("not a notebook")
    read = []
    for k, cell in enumerate(cells):
        source = cell.get("source", "")
        text = "".join(map(str, source)) if isinstance(source, list) else str(source)
        read.append({"id": str(cell.get("id", k)), "source": text.replace("\r\n", "\n").strip()})
    said = notebook.get("metadata")
    ours = said.get(OURS) if isinstance(said, dict) else None
    shown = " ".join(str(cell.get("outputs", "")) for cell in cells)
    return {"cells": read, "student": str(ours.get("student", "")) if isinstance(ours, dict) else "", "shown": shown}


def _compared(
    student: _Student, name: str, notebook: Mapping[str, Any], cells: Mapping[str, str], written: float, run_code: bool
) -> _HandedIn:
    shipped, claimed = notebooks()[name], same_name(notebook["student"])
    copy = "own" if claimed == same_name(student.name) else f"of {notebook['student']}" if claimed else "common"
    task_name = student.name if claimed else ""
    mine = individual(shipped, student.name) if claimed else shipped
    given = {cell["id"]: "".join(cell["source"]).strip() for cell in students_copy(mine)["cells"]}
    checks = [(task, check) for task, _, check in programs(mine) if task]
    free = {f"{cell['id']}-answer-1": cell["id"].removesuffix("-model") for cell, _ in _questions(shipped)}
    open_ = {task for task, _ in checks} | {id for id in given if "-answer-" in id}
    altered = [id if id in cells else f"{id} (gone)" for id in given if id not in open_ and cells.get(id) != given[id]]
    answers, unread = {}, {}
    for task, check in checks:
        source, answer = cells.get(task, ""), named(check)
        try:
            value = literal(source, answer)
            if value is None and run_code:
                value = literal(f"{answer} = {run(source, answer, mine, task)}", answer)
            if value is ...:
                unread[task] = "empty"
            elif value is None or not _fits(value, check):
                raise ValueError("its cell gives no plain text or number")
            else:
                answers[task] = value
        except ValueError as error:
            unread[task] = f"unread: {error}"
    counts: dict[str, tuple[int, int, int]] = {}
    for task, *numbers in WRITTEN.findall(notebook["shown"]):
        counts[task] = max(counts.get(task, (0, 0, 0)), tuple(int(n[:6]) for n in numbers))
    late = (written - student.due.timestamp()) / 3600 if student.due else 0.0
    texts = {task: _text(cells.get(id, "")) for id, task in free.items()}
    extra = len(notebook["cells"]) - len(set(cells) & set(given))
    job = Job(task_name, name, answers)
    return _HandedIn(name[:2], late, copy, altered, extra, job, unread, texts, counts)


def _questions(notebook: Mapping[str, Any]) -> Iterator[tuple[Mapping[str, Any], list[str]]]:
    """Yield the cells of model answers, with the criteria by which answers are judged."""
    for cell in notebook["cells"]:
        if cell["cell_type"] == "markdown" and "solution" in cell["metadata"].get("tags", ()):
            yield cell, cell["metadata"].get(OURS, {}).get("rubric", ["answer"])


def _parsed(source: str) -> list[ast.stmt]:
    if len(source) > LONGEST:
        raise ValueError(f"more than {LONGEST} characters")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of what a student escapes in a text
        try:
            return ast.parse(source).body
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            raise ValueError("its cell is no Python") from None


def literal(source: str, name: str) -> Any:
    """Return the last literal to which a program sets a name, without running it: dots if there is none.

    None if what it is set to is no literal; a ValueError if the program cannot be read.
    """
    value: Any = ...
    for statement in _parsed(source):
        if isinstance(statement, ast.Assign) and any(isinstance(t, ast.Name) and t.id == name for t in statement.targets):
            try:
                value = ast.literal_eval(statement.value)
            except (ValueError, TypeError, SyntaxError, RecursionError, MemoryError):
                value = None
    return value


def _text(source: str) -> str:
    """Return the sentence that a program hands to `model_answer`, without running it."""
    try:
        calls = [node for statement in _parsed(source) for node in ast.walk(statement) if isinstance(node, ast.Call)]
        said = [ast.literal_eval(call.args[0]) for call in calls if call.args and ast.unparse(call.func) == "model_answer"]
    except ValueError:
        return ""
    return next((text for text in said if isinstance(text, str)), "")


def _fits(value: Any, check: str) -> bool:
    """Whether an answer is of the kind that a check takes: text, or finite numbers and what holds them."""
    if isinstance(value, list | tuple | dict):
        keys = all(isinstance(key, str) for key in value) if isinstance(value, dict) else True
        parts = list(value.values()) if isinstance(value, dict) else value
        return keys and len(parts) <= 20 and all(not isinstance(v, list | tuple | dict) and _fits(v, check) for v in parts)
    if check.startswith("reach("):
        return is_real(value) and abs(value) < 1e12 and math.isfinite(value)
    return isinstance(value, str)


def _row(student: _Student, handed: Sequence[_HandedIn], faults: list[str], names: Sequence[str]) -> dict[str, Any]:
    """Return a row of the table, whose columns are the same for all students."""
    by_name = {each.job.notebook: each for each in handed}
    late = max((each.late for each in handed), default=0.0)
    state = "missing" if not handed else f"late by {late:.1f} h" if late > 0 else "yes"
    told: Callable[[Callable[[_HandedIn], str]], str] = lambda what: "; ".join(
        f"{each.stem}: {words}" for each in handed if (words := what(each))
    )
    row: dict[str, Any] = {
        "student": student.name,
        "handed in": state if student.listed else f"{state}, not in the roster",
        "copy": told(lambda each: each.copy),
        "altered": told(lambda each: ", ".join(each.altered)),
        "cells added": sum(each.added for each in handed),
        "cannot be read": "; ".join(faults),
    }
    totals = dict.fromkeys(("right", "tasks", "attempts", "hints", "minutes"), 0)
    row |= totals
    for name in names:
        shipped, one = notebooks()[name], by_name.get(name)
        for task in (task for task, *_ in programs(shipped) if task):
            right, reply = one.marks.get(task, (None, "")) if one else (None, "")
            said = one.unread.get(task) if one else "missing"
            words = said or {True: "right", False: "wrong", None: f"unread: {reply}"}[right]
            counts = one.counts.get(task, (None, None, None)) if one else (None, None, None)
            label = f"{name[:2]} {task}"
            row |= {label: words, f"{label} answer": str(one.job.answers.get(task, "")) if one else ""}
            row |= dict(zip((f"{label} {what}" for what in ("attempts", "hints", "minutes")), counts, strict=True))
            for what, count in zip(totals, (right is True, 1, *counts), strict=True):
                row[what] += count or 0
        for cell, criteria in _questions(shipped):
            task = cell["id"].removesuffix("-model")
            row[f"{name[:2]} {task}"] = one.texts.get(task, "") if one else ""
            row |= dict.fromkeys((f"{name[:2]} {task}: {criterion}{POINTS}" for criterion in criteria), "")
    return row
