"""A class's notebooks in one table: read, compared with what was given, and marked; nothing that a student wrote runs.

An answer is the literal in its cell: text, numbers, or a list or dictionary of them, found in the source.
"""

from __future__ import annotations

import ast
import csv
import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from percept_obs.exercises.attempts import WRITTEN
from percept_obs.exercises.copies import students_copy
from percept_obs.exercises.individual import OURS, individual, same_name
from percept_obs.exercises.marking import LONGEST, answered, lesson, marks, programs, run
from percept_obs.exercises.models import notebooks
from percept_obs.validation import bar, read_json
from percept_obs.validation.plain import is_real

if TYPE_CHECKING:
    import pandas as pd

LARGEST = 50_000_000
"""Largest size of a notebook in bytes."""

POINTS = " (points)"
"""End of the names of columns that a teacher fills in."""

UNFIT = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff]")
"""Characters that files or spreadsheets do not take."""

COUNTS = ("attempts", "hints", "minutes")


@dataclass(frozen=True)
class Student:
    """Row of a roster, or a folder that is in none."""

    name: str
    folder: Path | None
    due: datetime | None = None
    listed: bool = True


@dataclass(frozen=True)
class Job:
    """Notebook that a student handed in: whose copy it is, cells altered where they should not be, answers, columns."""

    copy: str
    altered: list[str]
    notebook: Mapping[str, Any]
    answers: dict[str, Any]
    columns: dict[str, Any]


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

    rows, jobs = [], []
    for student in students(folder, roster):
        row: dict[str, Any] = {"student": student.name, "handed in": "missing", "copy": "", "altered": "", "faults": ""}
        mine: dict[str, Job] = {}
        try:
            files = handed_in(student.folder) if student.folder else []
        except Exception as error:
            files, row["faults"] = [], f"{_why(error)}; "
        for file in files:
            try:
                name, cells, said, shown = read(file)
                job = compared(student.name, name, cells, said, run_code)
            except Exception as error:  # whatever is in it, the others are marked
                row["faults"] += f"{file.name}: {_why(error)}; "
                continue
            row["faults"] += f"{file.name}: the newest of several copies, and marked; " * (name in mine)
            for task, *counts in WRITTEN.findall(shown):
                for what, count in zip(COUNTS, map(int, counts), strict=True):
                    if (label := f"{name[:2]} {task} {what}") in job.columns:
                        job.columns[label] = max(job.columns[label] or 0, count)
            late = (file.lstat().st_mtime - student.due.timestamp()) / 3600 if student.due else 0
            row["handed in"] = f"late by {late:.1f} h" if late > 0 else "yes"
            mine[name] = job
        row["handed in"] += "" if student.listed else ", not in the roster"
        row["copy"] = "; ".join(f"{name[:2]}: {job.copy}" for name, job in mine.items())
        row["altered"] = "; ".join(f"{name[:2]}: {', '.join(job.altered)}" for name, job in mine.items() if job.altered)
        rows.append(row)
        jobs.append(mine)
    names = sorted({name for mine in jobs for name in mine})
    for name in names:
        _mark(name, [mine[name] for mine in jobs if name in mine])
    for row, mine in zip(rows, jobs, strict=True):
        columns = {
            key: entry for name in names for key, entry in (mine[name].columns if name in mine else blank(name)).items()
        }
        row["right"] = sum(entry == "right" for key, entry in columns.items() if key.count(" ") == 1)
        row |= {what: sum(entry or 0 for key, entry in columns.items() if key.endswith(f" {what}")) for what in COUNTS}
        row |= columns
    return pd.DataFrame(rows).map(harmless)


def _mark(name: str, jobs: Sequence[Job]) -> None:
    """Write marks into the columns of those who answered tasks of a notebook."""
    try:
        names = lesson(notebooks()[name]) if any(job.answers for job in jobs) else {}
    except Exception as error:  # the notebook is ours, and its data or a package may be missing here
        for job in jobs:
            job.columns.update({f"{name[:2]} {task}": f"unread: no run here: {error}" for task in job.answers})
        return
    for job in bar(jobs, name):
        for task, right, reply in marks(job.notebook, names, job.answers) if job.answers else ():
            job.columns[f"{name[:2]} {task}"] = {True: "right", False: "wrong", None: f"unread: {reply}"}[right]


def harmless(entry: Any) -> Any:
    """Return a table's entry made safe: odd characters escaped, and a quote before what a spreadsheet might run."""
    if not isinstance(entry, str):
        return entry
    plain = UNFIT.sub(lambda found: found[0].encode("unicode_escape").decode(), entry[:LONGEST])
    return f"'{plain}" if plain.startswith(("=", "+", "-", "@", "＝", "＋", "－", "＠", "\t")) else plain


def _why(error: Exception) -> str:
    return str(error) or type(error).__name__


def filled_in(table: pd.DataFrame, earlier: pd.DataFrame) -> pd.DataFrame:
    """Return a table with what a teacher has written into an earlier one: points, and columns of his own."""
    own = [name for name in earlier if name not in table or name.endswith(POINTS)]
    keys = (each.groupby("student").cumcount().rename("same name") for each in (earlier, table))
    of_earlier, of_table = ([each["student"], key] for each, key in zip((earlier, table), keys, strict=True))
    kept = earlier.set_index(of_earlier)[own].reindex(list(zip(*of_table, strict=True))).fillna("")
    return table.assign(**{name: kept[name].to_numpy() for name in own})


def name_of(folder: Path) -> str:
    """Return the name of a folder; bytes that are no UTF-8, as a zip of Windows brings them, are read as Latin-1."""
    return folder.name.translate({0xDC00 + byte: chr(byte) for byte in range(128, 256)})


def handed_in(folder: Path) -> list[Path]:
    """Return the notebooks in a folder, the newest last; a ValueError or OSError says why there are none."""
    if folder.is_symlink():
        raise ValueError("its folder is a link to another one")
    next(folder.iterdir(), None)  # raises where the search would be silent
    files = (f for f in folder.rglob("*") if f.suffix.lower() == ".ipynb" and ".ipynb_checkpoints" not in f.parts)
    if not (found := sorted(files, key=lambda f: f.lstat().st_mtime)):
        raise ValueError("its folder holds no notebook, a file that ends in .ipynb")
    return found


def students(folder: Path, roster: Path | None) -> list[Student]:
    """Return the students of a roster, and whoever else has handed in."""
    folders = sorted(f for f in folder.iterdir() if f.is_dir()) if folder.is_dir() else []
    if not folders:
        what = "" if folder.is_dir() else "is not there: it "
        raise ValueError(f"{folder} {what}holds no folders; put each student's notebooks into one with the name")
    if roster is None:
        return [Student(name_of(f), f) for f in folders]
    try:
        with open(roster, encoding="utf-8-sig", newline="") as file:
            rows = [{key: (entry or "").strip() for key, entry in row.items() if key} for row in csv.DictReader(file)]
    except (UnicodeDecodeError, csv.Error) as error:
        raise ValueError(f"{roster} cannot be read; save it as CSV in UTF-8: {error}") from None
    names = [same_name(row.get("student", "")) for row in rows]
    if not rows or "" in names or len(set(names)) < len(names):
        raise ValueError(f"{roster} needs a first line with the word student, commas between, below it each name once")
    found = []
    for row in rows:
        known = same_name(row.get("folder") or row["student"])
        own = (f for f in folders if same_name(name_of(f)) == known or same_name(name_of(f)).startswith(f"{known}_"))
        try:
            due = datetime.fromisoformat(row["due"]) if row.get("due") else None
        except ValueError:
            raise ValueError(f"{row['student']} is due at {row['due']!r}; write it as 2026-03-01T12:00") from None
        found.append(Student(row["student"], next(own, None), due))
    return found + [Student(name_of(f), f, None, False) for f in folders if all(s.folder != f for s in found)]


def read(file: Path) -> tuple[str, dict[str, str], str, str]:
    """Return a handed-in notebook's name, its cells by their ids, the student that it names, and its outputs.

    A ValueError says why it is none of the course's.
    """
    if file.is_symlink() or not file.is_file() or file.lstat().st_size > LARGEST:
        raise ValueError(f"not a plain file of at most {LARGEST // 10**6} MB")
    try:
        notebook = read_json(file)
    except ValueError as error:
        raise ValueError(f"no notebook, for {_why(error)}") from None
    cells = notebook.get("cells") if isinstance(notebook, dict) else None
    if not isinstance(cells, list) or not all(isinstance(cell, dict) for cell in cells):
        raise ValueError("not a notebook")
    sources = [(str(c.get("id")), c.get("source", "")) for c in cells]
    texts = {key: "".join(map(str, text)) if isinstance(text, list) else str(text) for key, text in sources}
    name = max(_ids(), key=lambda name: len(_ids()[name] & set(texts)))
    if len(_ids()[name] & set(texts)) < len(_ids()[name]) / 3:
        raise ValueError("none of the course's notebooks, or its cells have lost their ids")
    said = notebook.get("metadata")
    ours = said.get(OURS) if isinstance(said, dict) else None
    shown = " ".join(str(cell.get("outputs", "")) for cell in cells)
    return name, texts, str(ours.get("student", "")) if isinstance(ours, dict) else "", shown


@cache
def _ids() -> dict[str, set[str]]:
    return {name: {cell["id"] for cell in students_copy(shipped)["cells"]} for name, shipped in notebooks().items()}


def blank(name: str) -> dict[str, Any]:
    """Return a table's columns for a notebook that was not handed in."""
    columns: dict[str, Any] = {}
    for task in (task for task, *_ in programs(notebooks()[name]) if task):
        label = f"{name[:2]} {task}"
        columns |= {label: "missing", f"{label} answer": ""} | {f"{label} {what}": None for what in COUNTS}
    for task, criteria in questions(name):
        label = f"{name[:2]} {task}"
        columns |= {f"{label} text": ""} | {f"{label}: {criterion}{POINTS}": "" for criterion in criteria}
    return columns


def questions(name: str) -> Iterator[tuple[str, list[str]]]:
    """Yield a notebook's questions that are answered in words, and the criteria for their answers."""
    for cell in notebooks()[name]["cells"]:
        if cell["cell_type"] == "markdown" and "solution" in cell["metadata"].get("tags", ()):
            yield cell["id"].removesuffix("-model"), cell["metadata"].get(OURS, {}).get("rubric", ["answer"])


def compared(student: str, name: str, cells: Mapping[str, str], said: str, run_code: bool) -> Job:
    """Return what a student handed in, compared with what was given; its answers are to be marked."""
    own = bool(same_name(said))
    copy = "common" if not own else "own" if same_name(said) == same_name(student) else f"of {said}"
    mine = individual(notebooks()[name], student) if own else notebooks()[name]
    given = {cell["id"]: "".join(cell["source"]) for cell in students_copy(mine)["cells"]}
    checks = {task: check for task, _, check in programs(mine) if task}
    same = {key for key, text in given.items() if _plain(text) == _plain(cells.get(key, ""))}
    free = {key for key in given if key in checks or "-answer-" in key}
    altered = [key if key in cells else f"{key} (gone)" for key in given if key not in same | free]
    answers, part = {}, blank(name)
    for task, check in checks.items():
        try:
            value = literal(cells.get(task, ""), answered(check)[1])
            if value is None and run_code:
                value = literal(f"answer = {run(cells[task], mine, task)}", "answer")
            if value is not ... and not _fits(value, answered(check)[0]):
                raise ValueError("its cell gives no plain text or number")
        except Exception as error:
            part[f"{name[:2]} {task}"] = f"unread: {_why(error)}"
            continue
        part[f"{name[:2]} {task}"] = "empty"  # until it is marked
        if value is not ...:
            answers[task] = value
            part[f"{name[:2]} {task} answer"] = str(value)
    for task, _ in questions(name):
        try:
            part[f"{name[:2]} {task} text"] = said_in(cells.get(f"{task}-model-answer-1", ""))
        except Exception as error:
            part[f"{name[:2]} {task} text"] = f"unread: {_why(error)}"
    return Job(copy, altered, mine, answers, part)


def _plain(text: str) -> str:
    """Return a cell's text without a call of `hint` at its end, which a student may add."""
    return re.sub(r"\.hint\(\d\)\s*$", "", text.replace("\r\n", "\n").strip())


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
    """Return the last value that a program gives to a name, without running it: dots if none, None if no literal."""
    value: Any = ...
    for statement in _parsed(source):
        if isinstance(statement, ast.Assign) and name in map(ast.unparse, statement.targets):
            try:
                value = ast.literal_eval(statement.value)
            except (ValueError, TypeError, RecursionError, MemoryError):
                value = None
    return value


def said_in(source: str) -> str:
    """Return the sentence that a program hands to `model_answer`, without running it."""
    calls = (node for part in _parsed(source) for node in ast.walk(part) if isinstance(node, ast.Call) and node.args)
    asked = (call for call in calls if isinstance(call.func, ast.Name) and call.func.id == "model_answer")
    try:
        said = [ast.literal_eval(call.args[0]) for call in asked]
    except (ValueError, TypeError, RecursionError, MemoryError):
        raise ValueError("its cell gives no plain text") from None
    return next((text for text in said if isinstance(text, str)), "")


def _fits(value: Any, function: str) -> bool:
    """Return True for an answer of the kind that a check takes: text, or numbers, or a few of either."""
    if isinstance(value, dict):
        return all(isinstance(key, str) for key in value) and _fits(list(value.values()), function)
    if isinstance(value, list | tuple):
        return len(value) <= 20 and not any(isinstance(v, list | tuple | dict) or not _fits(v, function) for v in value)
    return is_real(value) and abs(value) < 1e12 if function == "reach" else isinstance(value, str)
