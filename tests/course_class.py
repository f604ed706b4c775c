"""A class that hands in: right, wrong, empty, altered and hostile copies, and what their marks must be.

`python tests/course_class.py` gives 40 students the notebooks 00, 08, 12 and 13, ten each, and collects them.
"""

import copy
import json
import shutil
import sys
import tempfile
import time
from pathlib import Path

from mistakes import MISTAKES
from notebook_exercises import answer_name, source, tagged

from percept_obs.exercises import individual, students_copy
from percept_obs.exercises.collecting import collect
from percept_obs.exercises.marking import named, programs
from percept_obs.exercises.models import notebooks

STUDENTS = """Ada Ben Chiara Dmitri Elif Fatima Goran Hana Ines Jamal Kofi Lena Minh Nadia Olu Paula Qiang Rosa Sven Tala
Uma Viktor Wanda Ximena Yusuf Zoe Ana Bao Carl Dina Emre Femi Gita Hugo Iva Jun Kaya Luca Mira Noor""".split()
KINDS = ("right", "wrong", "empty", "altered", "hostile", "late", "another's", "missing")
HOSTILE = (  # what must have no effect; each would leave the file
    'import pathlib; pathlib.Path({mark!r}).touch()\n{name} = {answer!r}',
    "{name} = __import__('pathlib').Path({mark!r}).touch()",
    "!touch {mark}\n{name} = {answer!r}",
    "{name} = " + "(" * 1000 + "1" + ")" * 1000,
    "{name} = '__import__(\"pathlib\").Path(\"{mark}\").touch()'",
    "{name} = ['=cmd|touch {mark}', [[[]]]]",
    "{name} = " + "9" * 3000,
    "{name} = 1e308 * 10",
    "{name} = {{'gain': '__import__(\"pathlib\").Path(\"{mark}\").touch()'}}",
    "{name} = '=HYPERLINK(\"{mark}\")'",
)


def literal_answers(name, student):
    """The solutions of a student's own tasks, as plain text or numbers: the shipped solutions, run."""
    notebook, names, found = individual(notebooks()[name], student), {}, {}
    checks = {task: named(check) for task, _, check in programs(notebook) if task}
    for cell in (each for each in notebook["cells"] if each["cell_type"] == "code"):
        text, task = "".join(cell["source"]), cell["id"]
        if task in checks:
            exec(text, names)
            value = names[checks[task]]
            found[task] = value.item() if hasattr(value, "item") else value
        elif name[:2] in ("12", "15") or cell["metadata"].get("tags") == ["none"]:
            text = next((first for other, first, _ in programs({"cells": [cell]})), "")
            exec(text, names)
    return found


def hand_in(folder, student, name, kind, mark, k=0):
    """Write what a student of a kind hands in, and return what its tasks' marks must be."""
    shipped = notebooks()[name]
    if kind == "missing":
        return dict.fromkeys(MISTAKES[name.removesuffix(".ipynb")], "missing")
    owner = "Somebody Else" if kind == "another's" else student
    notebook = copy.deepcopy(students_copy(individual(shipped, owner)))
    answers = literal_answers(name, student)
    expected = {}
    for cell in notebook["cells"]:
        task = cell.get("id", "")
        if task in answers:
            variable = "".join(cell["source"]).split(" ")[0]
            right = f"{variable} = {answers[task]!r}"
            wrong = f"{variable} = {MISTAKES[name.removesuffix('.ipynb')][task][0]!r}"
            text, expected[task] = {
                "wrong": (wrong, "wrong"),
                "empty": (f"{variable} = ...  # your answer", "empty"),
                "hostile": (HOSTILE[k % len(HOSTILE)].format(mark=str(mark), name=variable, answer=answers[task]), None),
            }.get(kind, (right, "right"))
            cell["source"] = text.splitlines(keepends=True)
        elif task.endswith("-model-answer-1"):
            said = "=cmd|' /C calc'!A0 all of it" if kind == "hostile" else f"Only motion tells it, says {student}."
            cell["source"] = ["".join(cell["source"]).replace("...", repr(said))]
        elif kind == "altered" and task.endswith("-check"):
            cell["source"] = ["type('Attempt', (), {'right': True})()"]
    place = folder / student
    place.mkdir(parents=True)
    (place / name).write_text(json.dumps(notebook), encoding="utf-8")
    return expected
