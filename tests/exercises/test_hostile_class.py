"""Whatever one student hands in, that student has a row which says why, and the others are marked as before."""

import json
import os
import subprocess
import sys

import pandas as pd
import pytest
from course_class import hand_out

from percept_obs import cli
from percept_obs.exercises import students_copy
from percept_obs.exercises.collecting import collect, filled_in, harmless
from percept_obs.exercises.models import notebooks

START = "00_start.ipynb"
NO_JSON = "cannot be read as JSON"


def notebook(cell="", source=None, encoding="utf-8", **metadata):
    """Bytes of a student's notebook, in which a cell has another source."""
    copy = students_copy(notebooks()[START])
    cells = [{**each, "source": source} if each["id"] == cell else each for each in copy["cells"]]
    return json.dumps({**copy, "cells": cells, "metadata": metadata}).encode(encoding)


def answer(source):
    return {START: notebook("gain", source)}


def deep_folder(place):
    """More folders inside each other than Python calls functions."""
    here = os.getcwd()
    os.chdir(place)
    for _ in range(1200):
        os.mkdir("d")
        os.chdir("d")
    os.chdir(here)


HOSTILE = {
    "empty": ({START: b""}, "faults", NO_JSON),
    "binary": ({START: bytes(range(256)) * 9}, "faults", NO_JSON),
    "cut off": ({START: b'{"cells": ['}, "faults", NO_JSON),
    "deep": ({START: b"[" * 100_000}, "faults", NO_JSON),
    "long number": ({START: b'{"cells": [], "n": ' + b"9" * 5000 + b"}"}, "faults", NO_JSON),
    "NUL": ({START: b'{"cells": \x00}'}, "faults", NO_JSON),
    "large": ({START: b" " * 50_000_001}, "faults", "at most 50 MB"),
    "not finite": ({START: b'{"cells": NaN}'}, "faults", "not a notebook"),
    "list": ({START: b"[1, 2]"}, "faults", "not a notebook"),
    "cells of text": ({START: b'{"cells": ["a", null]}'}, "faults", "not a notebook"),
    "cells of nothing": ({START: b'{"cells": [{}, {"id": [], "source": null}]}'}, "faults", "have lost their ids"),
    "none": ({"answers.txt": b"8"}, "faults", "holds no notebook"),
    "folders": (deep_folder, "faults", "recursion" if sys.version_info < (3, 12) else "holds no notebook"),
    "link": (lambda place: (place.rmdir(), place.symlink_to(place.parent)), "faults", "is a link"),
    "folder as file": (lambda place: (place / START).mkdir(), "faults", "not a plain file"),
    "pipe": (lambda place: os.mkfifo(place / START), "faults", "not a plain file"),
    "circle": (lambda place: (place / START).symlink_to(place / START), "faults", "not a plain file"),
    "twice": ({"a.ipynb": notebook(), "b.IPYNB": notebook()}, "faults", "newest of several copies"),
    "name\udce9": ({"\udce9\n.ipynb": b""}, "faults", NO_JSON),
    "=name": ({START: b""}, "faults", NO_JSON),
    "marked": ({START: b"\xef\xbb\xbf" + notebook("gain", "gain = 1")}, "00 gain", "wrong"),
    "UTF-16": ({START: notebook("gain", "gain = 1", "utf-16")}, "00 gain", "wrong"),
    "of another": ({START: notebook(percept_obs={"student": "\ud800" + "x" * 10**6})}, "copy", "00: of \\ud800x"),
    "metadata": ({START: notebook("quotient", [None, 1e999], percept_obs=[])}, "00 quotient", "empty"),
    "surrogate": ({START: notebook("quotient", "rate = '\\ud800'")}, "00 quotient", "unread"),
    "written surrogate": (answer("gain = '\ud800'"), "00 gain", "is no Python"),
    "hexadecimal": (answer("gain = 0x" + "f" * 3900), "00 gain", "no plain text or number"),
    "unhashable": (answer("gain = {[]: 1}"), "00 gain", "no plain text or number"),
    "deep name": (answer(f"gain = x{'.y' * 1900} = 1"), "00 gain", "wrong"),
    "minus": (answer(f"gain = {'-' * 3900}1"), "00 gain", "unread"),
    "negations": (answer(f"gain = {'not ' * 900}1"), "00 gain", "unread"),
    "long": (answer("gain = 1" + " " * 4000), "00 gain", "more than 4000 characters"),
    "not text": (answer({"gain": [8]}), "00 gain", "empty"),
    "nothing": (answer(None), "00 gain", "empty"),
    "sentence": (
        {START: notebook("one-picture-model-answer-1", "model_answer({[]: 1})")},
        "00 one-picture text",
        "no plain text",
    ),
}
"""What is handed in, files or a function of the folder, and the column that says why, with its words."""
READ_AS = {"name\udce9": "nameé", "=name": "'=name"}


@pytest.fixture(scope="module")
def handed_in(tmp_path_factory):
    folder = tmp_path_factory.mktemp("hostile") / "class"
    hand_out(folder, [START], ["Good"], ("right",))
    alone = collect(folder)
    for student, (files, *_) in HOSTILE.items():
        place = folder / student
        place.mkdir()
        if callable(files):
            files(place)
        else:
            for name, content in files.items():
                (place / name).write_bytes(content)
    yield folder, alone
    subprocess.run(["rm", "-rf", folder], check=True)  # Python does not remove folders that are that deep


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="its file names have no bytes")
def test_all_have_a_row(handed_in, capfdbinary):
    folder, alone = handed_in
    output = folder.parent / "marks\udce9.csv"
    for _ in range(2):  # the second one reads what the first one wrote
        assert cli.main(["collect", str(folder), "-o", str(output)]) == 0
    assert b"marks\\udce9.csv" in capfdbinary.readouterr().out
    rows = pd.read_csv(output, dtype=str, keep_default_na=False, encoding="utf-8-sig").set_index("student")
    assert len(rows) == len(HOSTILE) + 1
    told = {student: rows.loc[READ_AS.get(student, student), column] for student, (_, column, _) in HOSTILE.items()}
    assert {student: told[student] for student, (*_, words) in HOSTILE.items() if words not in told[student]} == {}
    assert rows.map(len).max().max() < 32_768  # characters of a cell in Excel
    good = alone.fillna("").astype(str).iloc[0]
    assert {name for name in good.index if name != "student" and rows.loc["Good", name] != good[name]} == set()


def test_a_table_is_filled_in_where_two_have_one_name():
    earlier = pd.DataFrame({"student": ["Ada", "Ada", "Ben"], "00: all (points)": ["1", "2", "3"]})
    again = filled_in(pd.DataFrame({"student": ["Ada", "Ben", "Ada", "Cyd"]}), earlier)
    assert again["00: all (points)"].tolist() == ["1", "3", "2", ""]


def test_an_entry_is_one_that_files_take():
    assert [*map(harmless, ("a\x00b\ud800", "＝1", "é\n\t", "-" * 9000))] == [
        "a\\x00b\\ud800",
        "'＝1",
        "é\n\t",
        "'" + "-" * 4000,
    ]


@pytest.mark.parametrize("content", [b"student\nJos\xe9", b"student\n" + b"x" * 200_000])
def test_a_roster_that_cannot_be_read_is_named(content, tmp_path):
    (tmp_path / "class" / "Ada").mkdir(parents=True)
    (tmp_path / "roster.csv").write_bytes(content)
    with pytest.raises(ValueError, match=r"roster\.csv cannot be read; save it as CSV in UTF-8"):
        collect(tmp_path / "class", tmp_path / "roster.csv")
