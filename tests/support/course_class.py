"""A class that hands in: right, wrong, empty, altered, copied and hostile notebooks, and the marks that they must get.

`python tests/support/course_class.py` makes the copies of 40 students, of two notebooks, collects them, and prints the
seconds, what differs from what was put in, and whether a command of theirs had an effect.  With names, `python
tests/support/course_class.py 03 14`, it runs these notebooks and prints how many of their own solutions pass their own
checks, at both ends of all ranges and for five names.
"""

import copy
import json
import os
import sys
import tempfile
import time
from pathlib import Path

from mistakes import MISTAKES

from percept_obs.exercises import individual, students_copy
from percept_obs.exercises.collecting import collect
from percept_obs.exercises.marking import answered, lesson, programs
from percept_obs.exercises.models import notebooks

STUDENTS = [
    "Ada", "Ben", "Chiara", "Dmitri", "Elif", "Fatima", "Goran", "Hana", "Ines", "Jamal", "Kofi", "Lena", "Minh",
    "Nadia", "Olu", "Paula", "Qiang", "Rosa", "Sven", "Tala", "Uma", "Viktor", "Wanda", "Ximena", "Yusuf", "Zoe",
    "Ana", "Bao", "Carl", "Dina", "Emre", "Femi", "Gita", "Hugo", "Iva", "Jun", "Kaya", "Luca", "Mira", "Noor",
]  # fmt: skip
HOSTILE = (  # each would leave a file if a word of it ran; the answer after it is the right one, or none
    ("import pathlib; pathlib.Path({mark!r}).touch()\n{name} = {answer!r}", "right"),
    ("{name} = __import__('pathlib').Path({mark!r}).touch()", "unread"),
    ("!touch {mark}\n{name} = {answer!r}", "unread"),
    ("%%bash\ntouch {mark}", "unread"),
    ("{name} = " + "(" * 900 + "1" + ")" * 900, "unread"),
    ('{name} = \'__import__("pathlib").Path("{mark}").touch()\'', "unread"),
    ("{name} = ['=cmd|touch {mark}', [[[]]]]", "unread"),
    ("{name} = " + "9" * 3900, "unread"),
    ("{name} = " + "-" * 3900 + "1", "unread"),
    ("{name} = 1e308 * 10", "unread"),
    ("{name} = {{'gain': '__import__(\"pathlib\").Path(\"{mark}\").touch()'}}", "unread"),
    ("{name} = '=HYPERLINK(\"{mark}\")'", "unread"),
    ("{name} = '" + "(" * 3800 + "y1'", "unread"),
    ("class Cheat: right = True\n{name} = Cheat()", "unread"),
    ("{name} = f'{{open({mark!r}, \"w\")}}'", "unread"),
)
BROKEN = ('{"cells": ', '{"cells": {}}', "[" * 100_000, '{"cells": [{"id": "goals", "source": 7}]}', "\x00")


def solved(notebook, names):
    """Yield each task of a notebook with its own solution's answer and the check's reply, after a lesson's names."""
    for cell in (each for each in notebook["cells"] if each["cell_type"] == "code"):
        if "solution" in cell["metadata"].get("tags", ()):
            exec("".join(cell["source"]), names)
        for task, before, check in programs({"cells": [cell]}):
            if task:
                exec(before, names)
                yield task, names[answered(check)[1]], eval(check, names)


def solutions(name, student):
    """The right answers to a student's own tasks, whose solutions need no lesson."""
    notebook, names, found = individual(notebooks()[name], student), {}, {}
    checks = {task: answered(check)[1] for task, _, check in programs(notebook) if task}
    for cell in notebook["cells"]:
        if cell["id"] in checks:
            exec("".join(cell["source"]), names)
            found[cell["id"]] = names[checks[cell["id"]]]
    return found


def hand_in(folder, student, name, kind, mark, number=0):
    """Write what a student of a kind hands in, and return what the marks of its tasks must begin with."""
    stem = name.removesuffix(".ipynb")
    owner = f"{student}'s friend" if kind == "copied" else student
    notebook = copy.deepcopy(students_copy(individual(notebooks()[name], owner)))
    answers, expected = solutions(name, owner), {}
    for cell in notebook["cells"]:
        task = cell["id"]
        if task in answers:
            variable = "".join(cell["source"]).split(" ")[0]
            text, expected[task] = f"{variable} = {answers[task]!r}", "right"
            if kind == "wrong":
                text, expected[task] = f"{variable} = {wrong(stem, task, answers[task])!r}", "wrong"
            elif kind == "empty":
                text, expected[task] = f"{variable} = ...  # your answer", "empty"
            elif kind == "copied" and isinstance(answers[task], str):
                expected[task] = "right" if answers[task] == solutions(name, student)[task] else "wrong"
            elif kind == "copied":  # a friend's number may be right for both
                del expected[task]
            elif kind == "hostile":
                text, expected[task] = HOSTILE[number % len(HOSTILE)]
                text = text.format(mark=str(mark), name=variable, answer=answers[task])
            cell["source"] = text.splitlines(keepends=True)
        elif task.endswith("-model-answer-1"):
            said = "=cmd|' /C calc'!A0 of it" if kind == "hostile" else f"Only motion tells it, says {student}."
            cell["source"] = ["".join(cell["source"]).replace("...", repr(said))]
        elif kind == "wrong" and task.endswith("-check"):  # asks for a hint, as it may
            cell["source"] = ["".join(cell["source"]) + ".hint(1)\n"]
        elif kind == "altered" and task.endswith("-check"):
            cell["source"] = ["type('Attempt', (), {'right': True})()"]
            cell["outputs"] = [{"data": {"text/markdown": f"✓ *Task {task[:-6]}: attempt 2, hints 1, minutes 9.*"}}]
    place = folder / student
    place.mkdir(parents=True)
    (place / name).write_text(json.dumps(notebook), encoding="utf-8")
    if kind == "hostile":
        (place / "broken.ipynb").write_text(BROKEN[number % len(BROKEN)])
        os.symlink("/dev/zero", place / "endless.ipynb")
    return {f"{name[:2]} {task}": mark for task, mark in expected.items()}


def wrong(stem, task, right):
    """A typical mistake: another letter than the right one, or one of those that the notebook's exercises refuse."""
    return next(m for m in (*MISTAKES[stem][task], "a") if m != right and (len(str(right)) > 1 or len(str(m)) == 1))


KINDS = ("right", "wrong", "empty", "altered", "copied", "hostile", "hostile", "hostile")


def hand_out(folder, names, students=STUDENTS, kinds=KINDS, mark="/tmp/percept_obs_intruder"):
    """Write what a class hands in, and return its kinds and the marks to expect, by student."""
    given = {student: kinds[k % len(kinds)] for k, student in enumerate(students)}
    return given, {
        student: hand_in(folder, student, names[k // len(kinds) % len(names)], kind, mark, k)
        for k, (student, kind) in enumerate(given.items())
    }


def differences(table, expected):
    """Marks that are not what was put in."""
    rows = table.set_index("student")
    return [
        (student, task, mark, found)
        for student, marks in expected.items()
        for task, mark in marks.items()
        if not (found := rows.loc[student, task]).startswith(mark) and not (mark == "unread" and found == "wrong")
    ]


def at_ends(end):
    """Draw the first choice everywhere, or the last."""
    return lambda student, what, count: range(count)[end]


def pass_everywhere(stem):
    """Print what does not pass of a notebook's own solutions, and how many do."""
    module = sys.modules["percept_obs.exercises.individual"]
    name = next(name for name in notebooks() if name.startswith(stem))
    names, by_name, right = lesson(notebooks()[name]), module.drawn, 0
    ways = {"low": at_ends(0), "high": at_ends(-1)} | dict.fromkeys(STUDENTS[:5], by_name)
    for student, draw in ways.items():
        module.drawn = draw
        for task, answer, reply in solved(individual(notebooks()[name], student), dict(names)):
            right += reply.right is True
            if not reply.right:
                print(name, student, task, answer, reply)
    module.drawn = by_name
    print(name, right, "pass")


if __name__ == "__main__" and len(sys.argv) > 1:
    for stem in sys.argv[1:]:
        pass_everywhere(stem)
elif __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        mark = Path(place, "intruder")
        given, expected = hand_out(Path(place, "class"), ["00_start.ipynb", "08_check_a_derivation.ipynb"], mark=mark)
        began, processor = time.perf_counter(), time.process_time()
        table = collect(Path(place, "class"))
        print(f"{len(table)} students, {sum(map(len, expected.values()))} answers, {len(table.columns)} columns")
        print(f"{time.perf_counter() - began:.1f} s, {time.process_time() - processor:.1f} s of processor time")
        print("differ:", differences(table, expected), "intruder:", mark.exists())
